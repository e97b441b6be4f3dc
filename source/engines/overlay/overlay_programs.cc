// SPDX-License-Identifier: MIT
#include "overlay_programs.hh"

#include <array>

namespace gnomon::overlay {

namespace {

constexpr std::array<Feature, 6> mask_variants = {Feature::None,
                                                  Feature::AlphaMask,
                                                  Feature::AlphaMask | Feature::FullMaterial,
                                                  Feature::ClipPlanes,
                                                  Feature::AlphaMask | Feature::ClipPlanes,
                                                  Feature::AlphaMask | Feature::FullMaterial | Feature::ClipPlanes};
constexpr std::array<Feature, 1> one_variant = {Feature::None};
constexpr std::array<Feature, 2> line_variants = {Feature::None, Feature::HiddenLines};

constexpr std::array<ShaderDeclaration, 3> declarations = {{
    {ShaderId::Objects, "overlay_objects", "overlay/overlay_objects_vert.glsl", "overlay/overlay_objects_frag.glsl",
     mask_variants, "the object at each pixel"},
    {ShaderId::Outline, "overlay_outline", "draw/draw_fullscreen_vert.glsl", "overlay/overlay_outline_frag.glsl",
     one_variant, "a line around each object"},
    {ShaderId::Lines, "overlay_lines", "overlay/overlay_lines_vert.glsl", "overlay/overlay_lines_frag.glsl",
     line_variants, "lines in world space"},
}};

}  // namespace

std::span<const ShaderDeclaration> shader_declarations()
{
  return declarations;
}

gpu::ShaderDesc shader_desc(const ShaderDeclaration &declaration, Feature features)
{
  gpu::ShaderDesc desc;
  desc.name = declaration.name;
  desc.vertex_path = declaration.vertex_path;
  desc.fragment_path = declaration.fragment_path;
  if ((features & Feature::AlphaMask) != Feature::None) {
    desc.defines.emplace_back("USE_ALPHA_MASK");
  }
  if ((features & Feature::FullMaterial) != Feature::None) {
    desc.defines.emplace_back("USE_FULL_MATERIAL");
  }
  if ((features & Feature::HiddenLines) != Feature::None) {
    desc.defines.emplace_back("USE_HIDDEN_LINES");
  }
  if ((features & Feature::ClipPlanes) != Feature::None) {
    desc.defines.emplace_back("USE_CLIP_PLANES");
  }
  return desc;
}

}  // namespace gnomon::overlay
