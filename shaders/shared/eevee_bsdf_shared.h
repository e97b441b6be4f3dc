// SPDX-License-Identifier: MIT
#ifndef EEVEE_BSDF_SHARED_H
#define EEVEE_BSDF_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

SHARED_CONSTANT float PI = 3.14159265358979f;
SHARED_CONSTANT float INV_PI = 0.318309886183791f;

/** Least alpha. For a smaller one, the lobe of a lamp without size is narrower than floats can resolve. */
SHARED_CONSTANT float ALPHA_MIN = 1e-3f;

/** GGX distribution of microfacet normals, 1/sr (Walter et al. 2007, eq. 33). */
SHARED_FUNCTION float ggx_distribution(float cos_h, float alpha)
{
  float a2 = alpha * alpha;
  // 1 - cos² + a²·cos², written as a sum so that it does not cancel when both terms are small.
  float t = (1.0f - cos_h) * (1.0f + cos_h) + a2 * cos_h * cos_h;
  return a2 / (PI * t * t);
}

/** Smith's masking G1 of one direction, divided by twice its cosine. G1 = 2·cos / (cos + √(a² + (1 - a²)·cos²)). */
SHARED_FUNCTION float ggx_masking_over_2cos(float cosine, float alpha)
{
  float a2 = alpha * alpha;
  return 1.0f / (cosine + sqrt(a2 + (1.0f - a2) * cosine * cosine));
}

/**
 * Microfacet lobe without Fresnel, 1/sr: D·G1(l)·G1(v) / (4·cos(l)·cos(v)). Masking and shadowing are separable, as in
 * Cycles. All cosines are in (0, 1].
 */
SHARED_FUNCTION float ggx_lobe(float cos_l, float cos_v, float cos_h, float alpha)
{
  return ggx_distribution(cos_h, alpha) * ggx_masking_over_2cos(cos_l, alpha) * ggx_masking_over_2cos(cos_v, alpha);
}

/** The same as ggx_masking_over_2cos, for \a direction in the axes of anisotropic_ggx_lobe. */
SHARED_FUNCTION float anisotropic_masking_over_2cos(vec3 direction, vec2 alphas)
{
  vec3 stretched = vec3(alphas.x * direction.x, alphas.y * direction.y, direction.z);
  return 1.0f / (direction.z + sqrt(dot(stretched, stretched)));
}

/**
 * The same as ggx_lobe, with an alpha for each of two axes in the surface (Burley 2012, Physically Based Shading at Disney; Heitz 2014).
 * The unit vectors are in the axes of \a alphas and the normal, z, which is in (0, 1].
 */
SHARED_FUNCTION float anisotropic_ggx_lobe(vec3 to_light, vec3 to_viewer, vec3 half_vector, vec2 alphas)
{
  vec3 shrunk = vec3(half_vector.x / alphas.x, half_vector.y / alphas.y, half_vector.z);
  float t = dot(shrunk, shrunk);
  return anisotropic_masking_over_2cos(to_light, alphas) * anisotropic_masking_over_2cos(to_viewer, alphas) /
         (PI * alphas.x * alphas.y * t * t);
}

/** Alphas of a lobe whose least alpha is \a alpha, along its rougher axis and across it (KHR_materials_anisotropy). */
SHARED_FUNCTION vec2 anisotropic_alphas(float alpha, float anisotropy)
{
  return vec2(alpha + (1.0f - alpha) * (anisotropy * anisotropy), alpha);
}

/** Variance of a place in a square of one pixel along an axis, px². The pixel filter spreads the squares of the pixels. */
SHARED_CONSTANT float PIXEL_VARIANCE = 1.0f / 12.0f;
/** Largest variance of normals under a pixel, along each of two axes: neighbours that differ by more are those of an edge. */
SHARED_CONSTANT float NORMAL_VARIANCE_MAX = 0.09f;

/**
 * Alpha of the mean of the GGX lobes under a pixel, whose normals differ (Tokuyoshi and Kaplanyan 2019, Improved Geometric Specular
 * Antialiasing). \a change_sq: square of the change of the normal from pixel to pixel, the sum of that to the right and that up.
 * \a cos_v: between normal and viewer. At the rim of a round body, normals differ along the line of sight alone, where a round
 * lobe of that variance would light the rim by lamps from all sides. \a share: of the variance of these normals: 1 for one sample,
 * and 0 for infinitely many.
 */
SHARED_FUNCTION float filtered_alpha(float alpha, float change_sq, float cos_v, float share)
{
  float variance = min(0.5f * PIXEL_VARIANCE * change_sq * (cos_v * cos_v), NORMAL_VARIANCE_MAX) * share;
  return min(sqrt(alpha * alpha + 2.0f * variance), 1.0f);
}

/** Least alpha of sheen. For a smaller one, nearly all of the lobe lies at grazing angles that pixels do not resolve. */
SHARED_CONSTANT float SHEEN_ALPHA_MIN = 5e-3f;

/** Distribution of the normals of fibres, 1/sr (Estevez and Kulla 2017, eq. 2). \a alpha: in [SHEEN_ALPHA_MIN, 1]. */
SHARED_FUNCTION float charlie_distribution(float cos_h, float alpha)
{
  float sine_sq = clamp((1.0f - cos_h) * (1.0f + cos_h), 0.0f, 1.0f);
  return 0.5f * INV_PI * (2.0f + 1.0f / alpha) * pow(sine_sq, 0.5f / alpha);
}

/**
 * Lobe of sheen without its colour, 1/sr, with the visibility of Neubelt and Pettineo (2013). \a cos_l: in [0, 1]. \a cos_v: in
 * (0, 1]. Its albedo exceeds 1 at grazing angles where alpha is small; \see sheen_bounded.
 */
SHARED_FUNCTION float sheen_lobe(float cos_l, float cos_v, float cos_h, float alpha)
{
  return charlie_distribution(cos_h, alpha) / (4.0f * (cos_l + cos_v - cos_l * cos_v));
}

/** Factor of a sheen lobe with the directional albedo \a albedo, so that it reflects no more light than it receives. */
SHARED_FUNCTION float sheen_bounded(float albedo)
{
  return 1.0f / max(albedo, 1.0f);
}

/** Schlick's approximation of Fresnel reflectance (1994). \a cosine: between the half vector and the view direction. */
SHARED_FUNCTION vec3 fresnel_schlick(vec3 f0, float f90, float cosine)
{
  float m = clamp(1.0f - cosine, 0.0f, 1.0f);
  float m2 = m * m;
  return f0 + (vec3(f90) - f0) * (m2 * m2 * m);
}

/**
 * Visibility of a light for the diffuse part of a surface with a normal texture. Light fades towards the horizon of the smooth
 * surface instead of ending there (Conty Estevez, Lecocq and Stein 2019, Ray Tracing Gems 12). 1 for a normal that is not
 * perturbed. \a normal and \a to_light form an acute angle.
 */
SHARED_FUNCTION float bump_visibility(vec3 smooth_normal, vec3 normal, vec3 to_light)
{
  float below = dot(normal, to_light) * dot(smooth_normal, normal);
  float g = below > 0.0f ? clamp(dot(smooth_normal, to_light) / below, 0.0f, 1.0f) : 0.0f;
  return g + g * g * (1.0f - g);
}

SHARED_END

#endif
