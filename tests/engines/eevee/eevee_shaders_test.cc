// SPDX-License-Identifier: MIT
#include "eevee_shaders.hh"

#include "draw_object_shared.h"
#include "draw_view_shared.h"
#include "eevee_light_shared.h"
#include "eevee_material_shared.h"
#include "eevee_shadow_shared.h"
#include "shader_files.hh"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace gnomon::eevee {
namespace {

gpu::ShaderInterface interface_of(const ShaderDeclaration &declaration, Feature features)
{
  const gpu::ShaderDesc desc = shader_desc(declaration, features);
  return gpu::reflect(desc.name, gpu::preprocess(desc, shaders::file));
}

TEST(ShaderDeclarations, StandInTheOrderOfTheirIds)
{
  for (std::size_t i = 0; i < shader_declarations().size(); i++) {
    EXPECT_EQ(std::size_t(shader_declarations()[i].id), i);
    EXPECT_FALSE(shader_declarations()[i].purpose.empty());
  }
}

TEST(ShaderVariants, AreCompiledByGlslang)
{
  for (const ShaderDeclaration &declaration : shader_declarations()) {
    for (const Feature features : shader_variants(declaration)) {
      EXPECT_NO_THROW(interface_of(declaration, features)) << declaration.name << " " << std::uint32_t(features);
    }
  }
}

TEST(ShaderVariants, AreAllDifferentPrograms)
{
  for (const ShaderDeclaration &declaration : shader_declarations()) {
    std::set<std::string> texts;
    for (const Feature features : shader_variants(declaration)) {
      std::string defines;
      for (const std::string &define : shader_desc(declaration, features).defines) {
        defines += define + " ";
      }
      EXPECT_TRUE(texts.insert(defines).second) << declaration.name << ": " << defines;
    }
  }
}

/** The block's members by name, of the largest variant that has it. */
std::map<std::string, std::uint32_t> offsets(const std::string &block, std::uint32_t *size_bytes)
{
  std::map<std::string, std::uint32_t> offsets;
  for (const ShaderDeclaration &declaration : shader_declarations()) {
    for (const Feature features : shader_variants(declaration)) {
      for (const auto &binding : interface_of(declaration, features).bindings) {
        if (binding.name == block) {
          *size_bytes = binding.size_bytes;
          for (const auto &member : binding.members) {
            offsets[member.name] = member.offset_bytes;
          }
        }
      }
      if (!offsets.empty()) {
        return offsets;
      }
    }
  }
  return offsets;
}

struct Field {
  std::string name;
  std::size_t offset_bytes;
};

void expect_layout(const std::string &block, std::size_t size_bytes, const std::vector<Field> &fields)
{
  std::uint32_t size = 0;
  const std::map<std::string, std::uint32_t> reflected = offsets(block, &size);
  EXPECT_EQ(size, size_bytes) << block;
  for (const Field &field : fields) {
    const auto found = reflected.find(field.name);
    ASSERT_NE(found, reflected.end()) << block << " has no " << field.name;
    EXPECT_EQ(found->second, field.offset_bytes) << block << "." << field.name;
  }
  EXPECT_EQ(reflected.size(), fields.size()) << block << ": a field is not compared";
}

// hazards.md: a float array in a std140 block took 16 bytes an element in GLSL and 4 in C.
TEST(SharedBlocks, AreLaidOutAlikeInCppAndGlsl)
{
  using namespace shared;
  expect_layout("view_block", sizeof(ViewData),
                {{"view.clip_from_world", offsetof(ViewData, clip_from_world)},
                 {"view.position_ws", offsetof(ViewData, position_ws)},
                 {"view.is_perspective", offsetof(ViewData, is_perspective)},
                 {"view.back_ws", offsetof(ViewData, back_ws)},
                 {"view._pad0", offsetof(ViewData, _pad0)}});
  expect_layout("object_block", sizeof(ObjectData),
                {{"objects[0].world_from_object", offsetof(ObjectData, world_from_object)},
                 {"objects[0].normal_x", offsetof(ObjectData, normal_x)},
                 {"objects[0].normal_y", offsetof(ObjectData, normal_y)},
                 {"objects[0].normal_z", offsetof(ObjectData, normal_z)},
                 {"objects[0].value", offsetof(ObjectData, value)}});
  expect_layout("material_block", sizeof(MaterialData),
                {{"materials[0].diffuse", offsetof(MaterialData, diffuse)},
                 {"materials[0].alpha", offsetof(MaterialData, alpha)},
                 {"materials[0].specular_f0", offsetof(MaterialData, specular_f0)},
                 {"materials[0].specular_f90", offsetof(MaterialData, specular_f90)},
                 {"materials[0].emissive", offsetof(MaterialData, emissive)},
                 {"materials[0]._pad0", offsetof(MaterialData, _pad0)}});
  const std::size_t light = offsetof(LightBlock, lights);
  expect_layout("light_block", sizeof(LightBlock),
                {{"light_data.light_count", offsetof(LightBlock, light_count)},
                 {"light_data._pad0", offsetof(LightBlock, _pad0)},
                 {"light_data._pad1", offsetof(LightBlock, _pad1)},
                 {"light_data._pad2", offsetof(LightBlock, _pad2)},
                 {"light_data.lights[0].position_ws", light + offsetof(LightData, position_ws)},
                 {"light_data.lights[0].kind", light + offsetof(LightData, kind)},
                 {"light_data.lights[0].color", light + offsetof(LightData, color)},
                 {"light_data.lights[0].radius_sq", light + offsetof(LightData, radius_sq)},
                 {"light_data.lights[0].forward_ws", light + offsetof(LightData, forward_ws)},
                 {"light_data.lights[0].range_inv_sq", light + offsetof(LightData, range_inv_sq)},
                 {"light_data.lights[0].spot_cos_outer", light + offsetof(LightData, spot_cos_outer)},
                 {"light_data.lights[0].spot_inv_width", light + offsetof(LightData, spot_inv_width)},
                 {"light_data.lights[0].shadow_kind", light + offsetof(LightData, shadow_kind)},
                 {"light_data.lights[0].shadow_index", light + offsetof(LightData, shadow_index)}});
  const std::size_t map = offsetof(ShadowBlock, maps);
  expect_layout("shadow_block", sizeof(ShadowBlock),
                {{"shadow.cubes[0].near", offsetof(ShadowCubeData, near)},
                 {"shadow.cubes[0].texel_size", offsetof(ShadowCubeData, texel_size)},
                 {"shadow.cubes[0].layer", offsetof(ShadowCubeData, layer)},
                 {"shadow.cubes[0]._pad0", offsetof(ShadowCubeData, _pad0)},
                 {"shadow.maps[0].texco_from_world", map + offsetof(ShadowMapData, texco_from_world)},
                 {"shadow.maps[0].texel_size", map + offsetof(ShadowMapData, texel_size)},
                 {"shadow.maps[0].layer", map + offsetof(ShadowMapData, layer)},
                 {"shadow.maps[0].rounding", map + offsetof(ShadowMapData, rounding)},
                 {"shadow.maps[0]._pad0", map + offsetof(ShadowMapData, _pad0)}});
  expect_layout("shadow_render_block", sizeof(ShadowRenderBlock), {{"shadow_render.clip_from_world", 0}});
}

TEST(SharedBlocks, FitTheSmallestPromisedUniformBlock)
{
  for (const ShaderDeclaration &declaration : shader_declarations()) {
    for (const auto &binding : interface_of(declaration, shader_variants(declaration).back()).bindings) {
      if (binding.kind == gpu::BindingKind::UniformBlock) {
        EXPECT_LE(binding.size_bytes, std::uint32_t(UNIFORM_BLOCK_BYTES_MAX)) << binding.name;
      }
    }
  }
}

TEST(ShaderCache, MakesAVariantOnceAndIgnoresOtherFeatures)
{
  const auto device = gpu::create_null_device();
  ShaderCache cache;
  const gpu::Shader &depth = cache.get(*device, ShaderId::Depth);
  EXPECT_EQ(&cache.get(*device, ShaderId::Depth, Feature::Light | Feature::Specular), &depth);
  cache.get(*device, ShaderId::Lit, Feature::Light);
  cache.get(*device, ShaderId::Lit, Feature::Light);
  EXPECT_EQ(cache.size(), 2U);
  EXPECT_EQ(device->counters().shaders_made, 2U);
}

}  // namespace
}  // namespace gnomon::eevee
