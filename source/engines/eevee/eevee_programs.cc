// SPDX-License-Identifier: MIT
#include "eevee_programs.hh"

#include "gpu_shader_text.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace gnomon::eevee {

namespace {

constexpr std::array<FeatureDefine, 19> feature_table = {
    {{Feature::Light, "USE_LIGHT", "something shines"},
     {Feature::Punctual, "USE_PUNCTUAL", "a point, spot or area lamp shines"},
     {Feature::Specular, "USE_SPECULAR", "a material reflects specularly"},
     {Feature::ShadowCube, "USE_SHADOW_CUBE", "a point lamp, a wide spot or an area lamp casts shadows"},
     {Feature::ShadowMap, "USE_SHADOW_MAP", "a sun or a spot casts shadows"},
     {Feature::ShadowPcf, "USE_SHADOW_PCF", "a shadow is filtered by percentage-closer lookups"},
     {Feature::ShadowEsm, "USE_SHADOW_ESM", "a point lamp or a spot casts exponential shadows"},
     {Feature::BaseColorTexture, "USE_BASE_COLOR_TEXTURE", "a material's base colour has a texture"},
     {Feature::AlphaMask, "USE_ALPHA_MASK", "alpha cuts a material out, or lets light through it"},
     {Feature::ShadowEvsm, "USE_SHADOW_EVSM", "a point lamp or a spot casts exponential variance shadows"},
     {Feature::LampShape, "USE_LAMP_SHAPE", "a lamp has an extent, or a spot's cone is an ellipse"},
     {Feature::FullMaterial, "USE_FULL_MATERIAL",
      "a material has other textures than base colour, a transform or a second set of uvs, or a mesh has colours"},
     {Feature::TargetDepth, "USE_TARGET_DEPTH", "the target takes depth"},
     {Feature::World, "USE_WORLD", "a world shines"},
     {Feature::OpacityThreshold, "USE_OPACITY_THRESHOLD", "a blended material casts shadows"},
     {Feature::Layers, "USE_LAYERS", "a material has a clear coat, sheen or anisotropy, or transmits light"},
     {Feature::Transmission, "USE_TRANSMISSION", "a material transmits light"},
     {Feature::Multiscatter, "USE_MULTISCATTER",
      "microfacets reflect light more than once, and a material reflects specularly"},
     {Feature::LightClusters, "USE_LIGHT_CLUSTERS",
      "many lamps have a range, or there are more than light_block holds"}}};

/** Features of lighting. */
constexpr Feature light_features = Feature::Light | Feature::Punctual | Feature::Specular | Feature::ShadowCube |
                                   Feature::ShadowMap | Feature::ShadowPcf | Feature::ShadowEsm | Feature::ShadowEvsm |
                                   Feature::LampShape | Feature::World | Feature::Multiscatter | Feature::LightClusters;
/** Features that the visibility of a lamp depends on. */
constexpr Feature shadow_features = Feature::Light | Feature::Punctual | Feature::ShadowCube | Feature::ShadowMap |
                                    Feature::ShadowPcf | Feature::ShadowEsm | Feature::ShadowEvsm;

/** Features that alpha depends on. */
constexpr Feature alpha_features = Feature::AlphaMask | Feature::FullMaterial;
constexpr Feature caster_features = alpha_features | Feature::OpacityThreshold;

constexpr std::array<ShaderDeclaration, 27> declarations = {{
    {ShaderId::Depth, "eevee_depth", "eevee/eevee_depth_vert.glsl", "", "eevee/eevee_depth_frag.glsl", alpha_features,
     Feature::None, "depth of what is seen, so that each pixel is lit once"},
    {ShaderId::Shadow, "eevee_shadow", "eevee/eevee_shadow_vert.glsl", "", "eevee/eevee_shadow_frag.glsl",
     caster_features, Feature::None, "depth of what a lamp sees, a layer a pass"},
    {ShaderId::ShadowLayered, "eevee_shadow_layered", "eevee/eevee_shadow_layered_vert.glsl", "",
     "eevee/eevee_shadow_frag.glsl", caster_features, Feature::None,
     "depth of what a lamp sees, all layers in one pass"},
    {ShaderId::ShadowGeometry, "eevee_shadow_geometry", "eevee/eevee_shadow_geometry_vert.glsl",
     "eevee/eevee_shadow_geometry_geom.glsl", "eevee/eevee_shadow_frag.glsl", caster_features, Feature::None,
     "the same where vertex shaders cannot choose a layer"},
    {ShaderId::Lit, "eevee_lit", "eevee/eevee_lit_vert.glsl", "", "eevee/eevee_lit_frag.glsl",
     light_features | Feature::BaseColorTexture | Feature::FullMaterial | Feature::Layers | Feature::Transmission,
     Feature::None, "light that surfaces send to the viewer"},
    {ShaderId::Probe, "eevee_probe", "eevee/eevee_surface_vert.glsl", "", "eevee/eevee_probe_frag.glsl",
     shadow_features, Feature::Light, "position, normal and visibility of one lamp, for comparison with the reference"},
    {ShaderId::Film, "eevee_film", "draw/draw_fullscreen_vert.glsl", "", "eevee/eevee_film_frag.glsl", Feature::None,
     Feature::None, "sum of several samples a pixel"},
    {ShaderId::BackgroundColor, "eevee_background_color", "draw/draw_fullscreen_vert.glsl", "",
     "eevee/eevee_background_frag.glsl", Feature::None, Feature::None, "one colour where there is no surface"},
    {ShaderId::BackgroundWorld, "eevee_background_world", "draw/draw_fullscreen_vert.glsl", "",
     "eevee/eevee_background_frag.glsl", Feature::None, Feature::None, "the world where there is no surface",
     "BACKGROUND_WORLD"},
    {ShaderId::Tonemap, "eevee_tonemap", "draw/draw_fullscreen_vert.glsl", "", "draw/draw_target_frag.glsl",
     Feature::TargetDepth, Feature::None, "the picture as its target stores it"},
    {ShaderId::EsmDistance, "eevee_esm_distance", "draw/draw_fullscreen_vert.glsl", "",
     "eevee/eevee_esm_distance_frag.glsl", Feature::None, Feature::None, "distances from a lamp on an octahedral map"},
    {ShaderId::EsmDisk4, "eevee_esm_disk4", "draw/draw_fullscreen_vert.glsl", "", "eevee/eevee_esm_disk_frag.glsl",
     Feature::None, Feature::None, "exponential shadow map of four taps", "ESM_TAPS 4"},
    {ShaderId::EsmDisk32, "eevee_esm_disk32", "draw/draw_fullscreen_vert.glsl", "", "eevee/eevee_esm_disk_frag.glsl",
     Feature::None, Feature::None, "exponential shadow map of 32 taps", "ESM_TAPS 32"},
    {ShaderId::EsmSeparable, "eevee_esm_separable", "draw/draw_fullscreen_vert.glsl", "",
     "eevee/eevee_esm_separable_frag.glsl", Feature::None, Feature::None,
     "exponential shadow map of a Gaussian in two passes"},
    {ShaderId::EvsmDisk4, "eevee_evsm_disk4", "draw/draw_fullscreen_vert.glsl", "", "eevee/eevee_esm_disk_frag.glsl",
     Feature::None, Feature::None, "exponential variance shadow map of four taps", "EVSM_TAPS 4"},
    {ShaderId::EvsmDisk32, "eevee_evsm_disk32", "draw/draw_fullscreen_vert.glsl", "", "eevee/eevee_esm_disk_frag.glsl",
     Feature::None, Feature::None, "exponential variance shadow map of 32 taps", "EVSM_TAPS 32"},
    {ShaderId::EvsmSeparable, "eevee_evsm_separable", "draw/draw_fullscreen_vert.glsl", "",
     "eevee/eevee_esm_separable_frag.glsl", Feature::None, Feature::None,
     "exponential variance shadow map of a Gaussian in two passes", "EVSM"},
    {ShaderId::DebugShadow, "eevee_debug_shadow", "draw/draw_fullscreen_vert.glsl", "",
     "eevee/eevee_debug_shadow_frag.glsl", Feature::None, Feature::None, "layers of a shadow for people to look at"},
    {ShaderId::DebugCascades, "eevee_debug_cascades", "eevee/eevee_surface_vert.glsl", "",
     "eevee/eevee_debug_cascades_frag.glsl", Feature::Light, Feature::Light,
     "which cascades of a sun each pixel reads"},
    {ShaderId::Surfaces, "eevee_surfaces", "eevee/eevee_lit_vert.glsl", "", "eevee/eevee_surfaces_frag.glsl",
     Feature::Light | Feature::BaseColorTexture | Feature::FullMaterial, Feature::Light,
     "position, normal, object, albedo and roughness of surfaces, for compositing", "WRITES_OBJECT"},
    {ShaderId::DepthFunction, "eevee_depth_function", "eevee/eevee_depth_vert.glsl", "", "eevee/eevee_depth_frag.glsl",
     alpha_features, alpha_features, "depth of what a surface function cuts out", "USE_SURFACE_FUNCTION"},
    {ShaderId::GBuffer, "eevee_gbuffer", "eevee/eevee_lit_vert.glsl", "", "eevee/eevee_gbuffer_frag.glsl",
     Feature::Light | Feature::Specular, Feature::Light,
     "normals and materials of what is seen, for deferred lighting"},
    {ShaderId::DeferredLit, "eevee_deferred_lit", "draw/draw_fullscreen_vert.glsl", "",
     "eevee/eevee_deferred_lit_frag.glsl", without(light_features, Feature::ShadowEsm | Feature::ShadowEvsm),
     Feature::Light, "light that the surfaces in the G-buffer send to the viewer"},
    {ShaderId::AdaptiveTest, "eevee_adaptive_test", "draw/draw_fullscreen_vert.glsl", "",
     "eevee/eevee_adaptive_test_frag.glsl", Feature::None, Feature::None, "pixels that need no more samples"},
    {ShaderId::AdaptiveSpread, "eevee_adaptive_spread", "draw/draw_fullscreen_vert.glsl", "",
     "eevee/eevee_adaptive_spread_frag.glsl", Feature::None, Feature::None, "pixels that the pixel filter skips"},
    {ShaderId::AdaptiveDepth, "eevee_adaptive_depth", "draw/draw_fullscreen_vert.glsl", "",
     "eevee/eevee_adaptive_depth_frag.glsl", Feature::None, Feature::None, "depths that let passes skip pixels"},
    {ShaderId::AdaptiveScale, "eevee_adaptive_scale", "draw/draw_fullscreen_vert.glsl", "",
     "eevee/eevee_adaptive_scale_frag.glsl", Feature::None, Feature::None, "means of pixels without further samples"},
}};

/** The consequence of a rule's features. */
enum class RuleKind {
  /** A scene has all of `then`. */
  All,
  /** A scene has at least one of `then`. */
  Any,
  /** `then` changes nothing. Variants are without it. */
  No,
  /** A scene may lack `then`. Variants have all of it: it costs little, and there are fewer variants. */
  Add,
  /** `when` changes nothing unless there is one of `then`. Variants without `then` are without `when`. */
  Need,
};

/** A rule for features with at least one of `when`, and of `with` and of `with_too`, unless these are None. */
struct FeatureRule {
  Feature when;
  RuleKind kind;
  Feature then;
  Feature with = Feature::None;
  Feature with_too = Feature::None;
};

/** Features that change nothing if nothing shines. */
constexpr Feature lit_features = without(light_features, Feature::Light) | Feature::Layers | Feature::Transmission;
constexpr Feature depth_maps = Feature::ShadowCube | Feature::ShadowMap;
constexpr Feature often_together = Feature::World | Feature::Layers | Feature::Multiscatter;

/** with_variant applies the rules in this order. shader_variants returns the masks that fulfil all of them. */
constexpr std::array<FeatureRule, 17> feature_rules = {{
    // Variants for full materials always read the base colour texture. In programs that only test alpha, a full
    // material makes a difference only with an alpha mask.
    {Feature::FullMaterial, RuleKind::No, Feature::BaseColorTexture},
    {Feature::FullMaterial, RuleKind::All, Feature::AlphaMask},
    // Blended casters read the same inputs as masks.
    {Feature::OpacityThreshold, RuleKind::All, alpha_features},
    // Layers lie over full materials, and reflect. Transmission is one class of materials with layers.
    {Feature::Layers, RuleKind::All, Feature::FullMaterial | Feature::Specular},
    {Feature::Transmission, RuleKind::All, Feature::Layers},
    // Cubes and exponential maps exist for point, spot and area lamps only. Percentage-closer filtering reads a cube
    // or a planar map.
    {Feature::ShadowCube | Feature::ShadowEsm, RuleKind::All, Feature::Punctual},
    {Feature::ShadowPcf, RuleKind::Any, depth_maps},
    {Feature::ShadowEvsm, RuleKind::All, Feature::ShadowEsm},
    // Most scenes with many lamps have point lamps or spots, and reflect.
    {Feature::LightClusters, RuleKind::Add, Feature::Punctual | Feature::Specular},
    {Feature::LightClusters, RuleKind::Add, Feature::ShadowEvsm, Feature::ShadowEsm},
    {Feature::LightClusters, RuleKind::Add, Feature::ShadowPcf, Feature::ShadowEsm, depth_maps},
    // Also without lamps, the way of the light behind depends on normals and on the reflectance.
    {Feature::Transmission, RuleKind::Add, Feature::Light | Feature::Specular},
    // Microfacets that reflect light once or several times are those of specular reflection.
    {Feature::Multiscatter, RuleKind::Need, Feature::Specular},
    {Feature::Transmission | Feature::Multiscatter, RuleKind::Add, Feature::ShadowPcf, depth_maps},
    // Most scenes that have the first need the last together.
    {often_together, RuleKind::Add, Feature::Punctual | Feature::LampShape, Feature::Punctual | Feature::LampShape},
    {often_together, RuleKind::Add, Feature::ShadowEvsm, Feature::ShadowEsm},
    {lit_features, RuleKind::All, Feature::Light},
}};

/** Whether \a rule says something about \a features. */
constexpr bool applies(const FeatureRule &rule, Feature features)
{
  return has(features, rule.when) && (rule.with == Feature::None || has(features, rule.with)) &&
         (rule.with_too == Feature::None || has(features, rule.with_too));
}

/** Whether a scene can need \a features, and no smaller mask gives the same program. */
bool is_possible(Feature features, const ShaderDeclaration &declaration)
{
  return std::ranges::all_of(feature_rules, [&](const FeatureRule &rule) {
    const Feature then = rule.then & declaration.features;
    const Feature held = rule.then & features;
    return !applies(rule, features) || (rule.kind == RuleKind::No    ? held == Feature::None
                                        : rule.kind == RuleKind::Any ? held != Feature::None
                                                                     : held == then);
  });
}

}  // namespace

std::span<const FeatureDefine> feature_defines()
{
  return feature_table;
}

std::span<const ShaderDeclaration> shader_declarations()
{
  return declarations;
}

Feature with_variant(Feature features)
{
  for (const FeatureRule &rule : feature_rules) {
    if (rule.kind == RuleKind::Add && applies(rule, features)) {
      features = features | rule.then;
    }
    if (rule.kind == RuleKind::Need && applies(rule, features) && !has(features, rule.then)) {
      features = without(features, rule.when);
    }
  }
  return features;
}

Feature variant_of(const ShaderDeclaration &declaration, Feature features)
{
  return (has(features, Feature::Light) ? features : without(features, lit_features)) & declaration.features;
}

Feature constants_of(const ShaderDeclaration &declaration, Feature variant)
{
  const Feature lighting =
      (has(variant, Feature::LampShape) ? Feature::LampHighlights : Feature::None) |
      (has(variant, Feature::World) ? Feature::WorldOcclusion : Feature::None) |
      (has(variant, Feature::Punctual) ? Feature::SurfacePoints : Feature::None) |
      (has(variant, Feature::ShadowCube | Feature::ShadowMap) ? Feature::SurfaceInLayers : Feature::None);
  switch (declaration.id) {
    case ShaderId::GBuffer:
    case ShaderId::Depth:
    case ShaderId::DepthFunction:
    case ShaderId::Lit: return lighting | Feature::ClipPlanes | Feature::CoarseGrid;
    case ShaderId::Shadow:
    case ShaderId::ShadowLayered:
    case ShaderId::Probe:
    case ShaderId::DebugCascades:
    case ShaderId::Surfaces: return lighting | Feature::CoarseGrid;
    default: return lighting;
  }
}

std::vector<Feature> shader_variants(const ShaderDeclaration &declaration)
{
  std::vector<Feature> variants;
  // All subsets of the program's features in ascending order.
  const auto all = std::uint32_t(declaration.features);
  std::uint32_t mask = 0;
  do {
    const auto features = Feature(mask);
    if ((features & declaration.required) == declaration.required && is_possible(features, declaration)) {
      variants.push_back(features);
    }
    mask = (mask - all) & all;
  } while (mask != 0);
  return variants;
}

/** Features of all programs of \a id with a surface function; nothing: it has none. */
static std::optional<Feature> function_features(ShaderId id)
{
  switch (id) {
    case ShaderId::Lit: return Feature::Light | Feature::Specular | Feature::FullMaterial;
    case ShaderId::Surfaces: return Feature::Light | Feature::FullMaterial;
    case ShaderId::Shadow:
    case ShaderId::ShadowLayered:
    case ShaderId::ShadowGeometry:
    case ShaderId::DepthFunction: return alpha_features;
    default: return std::nullopt;
  }
}

std::vector<Feature> surface_function_variants(const ShaderDeclaration &declaration)
{
  const std::optional<Feature> required = function_features(declaration.id);
  std::vector<Feature> variants = required ? shader_variants(declaration) : std::vector<Feature>();
  std::erase_if(variants, [&](Feature features) { return (features & *required) != *required; });
  return variants;
}

gpu::ShaderDesc with_surface_function(gpu::ShaderDesc desc, const ShaderDeclaration &declaration)
{
  if (declaration.id != ShaderId::DepthFunction) {
    desc.defines.emplace_back("USE_SURFACE_FUNCTION");
  }
  if (declaration.id == ShaderId::Shadow || declaration.id == ShaderId::ShadowLayered ||
      declaration.id == ShaderId::ShadowGeometry) {
    desc.defines.emplace_back("WITHOUT_VIEW");
  }
  return desc;
}

std::optional<SurfaceFunctionFault> surface_function_fault(std::string_view text)
{
  int number = 1;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view directive = gpu::directive_of(text.substr(0, end));
    if (directive == "include" || directive == "version" || directive == "extension" || directive == "line") {
      return SurfaceFunctionFault{number, fmt::format("a surface function has no #{}", directive)};
    }
    text.remove_prefix(std::min(end + 1, text.size()));
    number++;
  }
  return std::nullopt;
}

gpu::ShaderDesc shader_desc(const ShaderDeclaration &declaration, Feature features, const PcfKernel &pcf)
{
  gpu::ShaderDesc desc;
  desc.name = declaration.name;
  desc.vertex_path = declaration.vertex_path;
  desc.geometry_path = declaration.geometry_path;
  desc.fragment_path = declaration.fragment_path;
  if (!declaration.define.empty()) {
    desc.defines.emplace_back(declaration.define);
  }
  for (const FeatureDefine &define : feature_table) {
    if (has(features & declaration.features, define.feature)) {
      desc.defines.emplace_back(define.define);
    }
  }
  if (has(features & declaration.features, Feature::ShadowPcf)) {
    desc.defines.push_back(fmt::format("SHADOW_PCF_WIDTH {}", pcf.width));
    desc.defines.push_back(fmt::format("SHADOW_PCF_TAPS {}", pcf.taps));
  }
  if (has(features & declaration.features, Feature::LampShape)) {
    desc.defines.push_back(fmt::format("HAS_LAMP_HIGHLIGHTS {}", int(has(features, Feature::LampHighlights))));
  }
  if (has(features & declaration.features, Feature::World)) {
    desc.defines.push_back(fmt::format("HAS_WORLD_OCCLUSION {}", int(has(features, Feature::WorldOcclusion))));
  }
  if (has(features, Feature::SurfaceInLayers)) {
    desc.defines.emplace_back("HAS_SURFACE_IN_LAYERS");
  }
  if (has(features, Feature::SurfacePoints)) {
    desc.defines.emplace_back("HAS_SURFACE_POINTS");
  }
  if (has(features, Feature::CoarseGrid)) {
    desc.defines.emplace_back("HAS_COARSE_GRID");
  }
  if (has(features, Feature::ClipPlanes)) {
    desc.defines.emplace_back("USE_CLIP_PLANES");
  }
  return desc;
}

}  // namespace gnomon::eevee
