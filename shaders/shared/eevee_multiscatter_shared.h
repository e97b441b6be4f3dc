// SPDX-License-Identifier: MIT
// Light that the microfacets of a GGX surface reflect more than once (Kulla and Conty Estevez 2017, "Revisiting Physically Based
// Shading at Imageworks"). A lobe of its own reflects the light that ggx_lobe loses, and the diffuse part reflects the rest.
// Both are products of a function of the light and the same function of the viewer, so that they are reciprocal.
#ifndef EEVEE_MULTISCATTER_SHARED_H
#define EEVEE_MULTISCATTER_SHARED_H

#include "shared/eevee_bsdf_shared.h"

SHARED_BEGIN

/** Texels along each axis of `multiscatter_table`. */
#define MULTISCATTER_TABLE_SIZE 32

/** Directional albedo of ggx_lobe for one direction of the viewer, or of the light. */
struct LobeAlbedo {
  /** 1 - the albedo for Fresnel terms of 1: the part of the light that meets a second microfacet. In [0, 1]. */
  float missing;
  /** Mean of Schlick's fifth power over the reflected light, in [0, 1]. */
  float schlick;
};

/**
 * Place in a table of albedos, in [0, 1]². \a alpha: in [ALPHA_MIN, 1]. \a cosine: of a direction, in [0, 1]. At grazing angles
 * the albedo is a function of cosine / alpha, and elsewhere of the cosine, so y is a sum of both.
 */
SHARED_FUNCTION vec2 multiscatter_place(float alpha, float cosine)
{
  float least = sqrt(ALPHA_MIN);
  float grazing = cosine * (1.0f + 2.0f * alpha) / max(cosine + 2.0f * alpha, 1e-9f);
  return vec2((sqrt(alpha) - least) / max(1.0f - least, 1e-9f), 0.625f * grazing + 0.375f * cosine);
}

/** 1 - cos / √(a² + cos²), as a product that does not cancel. LobeAlbedo::missing is 0.06 to 2.4 times this. */
SHARED_FUNCTION float missing_scale(float alpha, float cosine)
{
  float root = sqrt(alpha * alpha + cosine * cosine);
  return alpha * alpha / (root * (root + cosine));
}

/**
 * The albedo for one direction. \a texel: of a table of albedos, at multiscatter_place. x: `missing` divided by missing_scale.
 * y: 1 - cosine - the fifth root of `schlick`.
 */
SHARED_FUNCTION LobeAlbedo lobe_albedo(vec4 texel, float alpha, float cosine)
{
  float m = clamp(1.0f - cosine - texel.y, 0.0f, 1.0f);
  float m2 = m * m;
  LobeAlbedo albedo;
  albedo.missing = min(texel.x * missing_scale(alpha, cosine), 1.0f);
  albedo.schlick = m2 * m2 * m;
  return albedo;
}

/** The mean albedo over all directions, weighted by their cosines. z: `missing` divided by alpha². w: `schlick`. */
SHARED_FUNCTION LobeAlbedo mean_albedo(vec4 texel, float alpha)
{
  LobeAlbedo albedo;
  albedo.missing = texel.z * alpha * alpha;
  albedo.schlick = texel.w;
  return albedo;
}

/** Part of the light that the lobe reflects. */
SHARED_FUNCTION vec3 single_albedo(LobeAlbedo albedo, vec3 f0, float f90)
{
  return (f0 + (vec3(f90) - f0) * albedo.schlick) * (1.0f - albedo.missing);
}

/**
 * Part of LobeAlbedo::missing that leaves the surface after all: F² E (1 + F (1 - E) + F² (1 - E)² + …) with the mean Fresnel
 * reflectance F and the mean albedo E = 1 - \a mean_missing. 1 for Fresnel terms of 1. \a f0, \a f90: in [0, 1].
 */
SHARED_FUNCTION vec3 multiscatter_color(vec3 f0, float f90, float mean_missing)
{
  // The mean of Schlick's fifth power over all directions, weighted by their cosines, is 1 / 21.
  vec3 fresnel = f0 + (vec3(f90) - f0) * vec3(1.0f / 21.0f);
  return fresnel * fresnel * (1.0f - mean_missing) / max(vec3(1.0f) - fresnel * mean_missing, vec3(1e-9f));
}

/** Part of the light that both lobes leave, in the channel that they reflect most. \a color: multiscatter_color. */
SHARED_FUNCTION float unreflected(LobeAlbedo albedo, vec3 f0, float f90, vec3 color)
{
  vec3 reflected = single_albedo(albedo, f0, f90) + color * albedo.missing;
  return max(1.0f - max(max(reflected.x, reflected.y), reflected.z), 0.0f);
}

/** Multiple scattering towards one viewer. */
struct Multiscatter {
  /** GGX alpha of the surface. */
  float alpha;
  /** For the direction of the viewer, and its mean over all directions. */
  LobeAlbedo view;
  LobeAlbedo mean;
  /** \see multiscatter_color */
  vec3 color;
  /** BRDF of the lobe of multiple scattering, 1/sr, divided by LobeAlbedo::missing of the light. */
  vec3 lobe;
  /** Part of the light that the diffuse part receives, divided by `unreflected` of the light. */
  float diffuse;
};

/** \a texel: of a table of albedos, for \a alpha and \a cos_v. */
SHARED_FUNCTION Multiscatter make_multiscatter(vec4 texel, float alpha, float cos_v, vec3 f0, float f90)
{
  Multiscatter result;
  result.alpha = alpha;
  result.view = lobe_albedo(texel, alpha, cos_v);
  result.mean = mean_albedo(texel, alpha);
  result.color = multiscatter_color(f0, f90, result.mean.missing);
  result.lobe = result.color * (INV_PI * result.view.missing / result.mean.missing);
  // Fresnel terms of 1 leave nothing, and the quotient is 0 / 0.
  float mean_left = max(unreflected(result.mean, f0, f90, result.color), 1e-6f);
  result.diffuse = unreflected(result.view, f0, f90, result.color) / mean_left;
  return result;
}

/**
 * Mean albedo over a lamp. \a center: for the mean direction of its light. \a form_factor: of the lamp, in [0, 1]; at 1 the lamp fills
 * the sky, and the result is the mean over all directions.
 */
SHARED_FUNCTION LobeAlbedo albedo_over_lamp(LobeAlbedo center, LobeAlbedo mean, float form_factor)
{
  LobeAlbedo albedo;
  albedo.missing = center.missing + (mean.missing - center.missing) * form_factor;
  albedo.schlick = center.schlick + (mean.schlick - center.schlick) * form_factor;
  return albedo;
}

/** BRDF of diffuse reflection and of multiple scattering, 1/sr. \a light: albedo for the direction of the light. */
SHARED_FUNCTION vec3 smooth_brdf(Multiscatter multiscatter, LobeAlbedo light, vec3 diffuse, vec3 f0, float f90)
{
  float kept = multiscatter.diffuse * unreflected(light, f0, f90, multiscatter.color);
  return multiscatter.lobe * light.missing + diffuse * (INV_PI * kept);
}

SHARED_END

#endif
