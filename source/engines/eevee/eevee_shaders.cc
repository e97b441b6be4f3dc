// SPDX-License-Identifier: MIT
#include "eevee_shaders.hh"

#include "shader_files.hh"

#include <array>

namespace gnomon::eevee {

namespace {

struct FeatureDefine {
  Feature feature;
  const char *name;
};

constexpr std::array<FeatureDefine, 6> FEATURE_DEFINES = {{{Feature::Light, "USE_LIGHT"},
                                                          {Feature::Punctual, "USE_PUNCTUAL"},
                                                          {Feature::Hemi, "USE_HEMI"},
                                                          {Feature::Specular, "USE_SPECULAR"},
                                                          {Feature::ShadowCube, "USE_SHADOW_CUBE"},
                                                          {Feature::ShadowMap, "USE_SHADOW_MAP"}}};

constexpr Feature LIT_FEATURES = Feature::Light | Feature::Punctual | Feature::Hemi | Feature::Specular |
                                 Feature::ShadowCube | Feature::ShadowMap;

constexpr std::array<ShaderDeclaration, 5> DECLARATIONS = {{
    {ShaderId::Depth, "eevee_depth", "eevee/eevee_depth_vert.glsl", "eevee/eevee_depth_frag.glsl", Feature::None,
     "depth of what is seen, so that each pixel is lit once"},
    {ShaderId::Shadow, "eevee_shadow", "eevee/eevee_shadow_vert.glsl", "eevee/eevee_depth_frag.glsl", Feature::None,
     "depth of what a lamp sees"},
    {ShaderId::Lit, "eevee_lit", "eevee/eevee_lit_vert.glsl", "eevee/eevee_lit_frag.glsl", LIT_FEATURES,
     "light that surfaces send to the viewer"},
    {ShaderId::Film, "eevee_film", "draw/draw_fullscreen_vert.glsl", "eevee/eevee_film_frag.glsl", Feature::None,
     "sum of several samples a pixel"},
    {ShaderId::Tonemap, "eevee_tonemap", "draw/draw_fullscreen_vert.glsl", "eevee/eevee_tonemap_frag.glsl",
     Feature::None, "radiance as a display shows it"},
}};

/** Whether a scene can ask for this mask, and no smaller mask gives the same program. */
bool is_possible(Feature features)
{
  const bool has_light = has(features, Feature::Light);
  if (!has_light) {
    return features == Feature::None;
  }
  // Cubes are for point lamps and wide spots.
  return has(features, Feature::Punctual) || !has(features, Feature::ShadowCube);
}

}  // namespace

std::span<const ShaderDeclaration> shader_declarations()
{
  return DECLARATIONS;
}

std::vector<Feature> shader_variants(const ShaderDeclaration &declaration)
{
  std::vector<Feature> variants;
  for (std::uint32_t mask = 0; mask < 1U << FEATURE_DEFINES.size(); mask++) {
    const auto features = Feature(mask);
    if ((features & declaration.features) == features && is_possible(features)) {
      variants.push_back(features);
    }
  }
  return variants;
}

gpu::ShaderDesc shader_desc(const ShaderDeclaration &declaration, Feature features)
{
  gpu::ShaderDesc desc;
  desc.name = declaration.name;
  desc.vertex_path = declaration.vertex_path;
  desc.fragment_path = declaration.fragment_path;
  for (const FeatureDefine &define : FEATURE_DEFINES) {
    if (has(features & declaration.features, define.feature)) {
      desc.defines.emplace_back(define.name);
    }
  }
  return desc;
}

const gpu::Shader &ShaderCache::get(gpu::Device &device, ShaderId id, Feature features)
{
  const ShaderDeclaration &declaration = DECLARATIONS.at(std::size_t(id));
  const std::pair key(id, has(features, Feature::Light) ? features & declaration.features : Feature::None);
  const auto found = shaders_.find(key);
  if (found != shaders_.end()) {
    return found->second;
  }
  return shaders_[key] = device.create_shader(shader_desc(declaration, key.second), shaders::file);
}

}  // namespace gnomon::eevee
