// SPDX-License-Identifier: MIT
#include "unlit_programs.hh"

#include <array>

namespace gnomon::unlit {

namespace {

constexpr std::array<ShaderDeclaration, 3> declarations = {{
    {ShaderId::Depth, "unlit_depth", "eevee/eevee_depth_vert.glsl", "eevee/eevee_shadow_frag.glsl",
     Feature::AlphaMask | Feature::FullMaterial, "depth of the objects in the view of the depth camera"},
    {ShaderId::Surface, "unlit_surface", "unlit/unlit_vert.glsl", "unlit/unlit_frag.glsl",
     Feature::BaseColorTexture | Feature::FullMaterial | Feature::DepthCamera | Feature::ClipPlanes | Feature::XRay,
     "surfaces without light, with the depth camera's shadow"},
    {ShaderId::Target, "unlit_target", "draw/draw_fullscreen_vert.glsl", "draw/draw_target_frag.glsl",
     Feature::TargetDepth, "the picture as its target stores it"},
}};

constexpr std::array<std::pair<Feature, const char *>, 7> defines = {{
    {Feature::BaseColorTexture, "USE_BASE_COLOR_TEXTURE"},
    {Feature::FullMaterial, "USE_FULL_MATERIAL"},
    {Feature::AlphaMask, "USE_ALPHA_MASK"},
    {Feature::DepthCamera, "USE_DEPTH_CAMERA"},
    {Feature::TargetDepth, "USE_TARGET_DEPTH"},
    {Feature::ClipPlanes, "USE_CLIP_PLANES"},
    {Feature::XRay, "USE_XRAY"},
}};

/** Variants for full materials always read the base colour texture. Depth programs read materials only for the mask. */
bool is_possible(Feature features, const ShaderDeclaration &declaration)
{
  return !has(features, Feature::FullMaterial) ||
         (!has(features, Feature::BaseColorTexture) &&
          (!has(declaration.features, Feature::AlphaMask) || has(features, Feature::AlphaMask)));
}

}  // namespace

std::span<const ShaderDeclaration> shader_declarations()
{
  return declarations;
}

std::vector<Feature> shader_variants(const ShaderDeclaration &declaration)
{
  std::vector<Feature> variants;
  for (std::uint32_t mask = 0; mask < 1U << defines.size(); mask++) {
    const auto features = Feature(mask);
    if ((features & declaration.features) == features && is_possible(features, declaration)) {
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
  for (const auto &[feature, define] : defines) {
    if (has(features & declaration.features, feature)) {
      desc.defines.emplace_back(define);
    }
  }
  return desc;
}

}  // namespace gnomon::unlit
