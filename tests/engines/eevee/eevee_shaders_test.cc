// SPDX-License-Identifier: MIT
#include "eevee_shaders.hh"

#include "eevee_blocks.hh"
#include "eevee_interfaces.hh"
#include "shader_check_blocks.hh"
#include "shader_check_reflection.hh"
#include "shader_files.hh"
#include "shared_types.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

namespace gnomon::eevee {
namespace {

/** The interface from the generated table. SlowInterfaceTables tests that it equals a fresh reflection. */
gpu::ShaderInterface interface_of(const ShaderDeclaration &declaration, Feature features)
{
  return interface_tables()[std::size_t(declaration.id)].interface_of(std::uint32_t(features));
}

TEST(ShaderDeclarations, StandInTheOrderOfTheirIds)
{
  for (std::size_t i = 0; i < shader_declarations().size(); i++) {
    EXPECT_EQ(std::size_t(shader_declarations()[i].id), i);
    EXPECT_FALSE(shader_declarations()[i].purpose.empty());
  }
}

TEST(InterfaceTables, StandInTheOrderOfTheIds)
{
  ASSERT_EQ(interface_tables().size(), shader_declarations().size());
  for (std::size_t i = 0; i < shader_declarations().size(); i++) {
    EXPECT_EQ(interface_tables()[i].name, shader_declarations()[i].name);
    EXPECT_EQ(interface_tables()[i].variants.size(), shader_variants(shader_declarations()[i]).size());
  }
}

// hazards.md: glslang rejects gl_Layer in a vertex shader at #version 330, and accepts it at 450.
TEST(ShaderVariants, ChooseTheLayerInTheVertexShaderAtVersion450)
{
  const ShaderDeclaration &layered = shader_declarations()[std::size_t(ShaderId::ShadowLayered)];
  const gpu::ShaderDesc desc = shader_desc(layered, Feature::None);
  const std::string path(layered.vertex_path);
  std::string text(*shaders::file(path));
  ASSERT_NE(text.find("gl_Layer = "), std::string::npos);
  ASSERT_EQ(text.find("#version 450 core\n"), 0U);
  EXPECT_NO_THROW(static_cast<void>(shader_check::reflect(desc.name, gpu::preprocess(desc, shaders::file))));
  text.replace(0, 12, "#version 330");
  const gpu::ShaderFiles older = [&](std::string_view file) {
    return file == path ? std::optional<std::string_view>(text) : shaders::file(file);
  };
  EXPECT_THROW(static_cast<void>(shader_check::reflect(desc.name, gpu::preprocess(desc, older))), gpu::Error);
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

TEST(ShaderVariants, EveryFrameHasADeclaredProgramForEachMaterial)
{
  const ShaderDeclaration &lit = shader_declarations()[std::size_t(ShaderId::Lit)];
  std::set<Feature> declared;
  for (const Feature features : shader_variants(lit)) {
    declared.insert(features);
  }
  constexpr Feature of_frame = Feature::Punctual | Feature::Specular | Feature::ShadowCube | Feature::ShadowMap |
                               Feature::ShadowPcf | Feature::ShadowEsm | Feature::ShadowEvsm | Feature::LampShape |
                               Feature::World | Feature::Multiscatter;
  for (std::uint32_t mask = std::uint32_t(of_frame); mask != 0; mask = (mask - 1) & std::uint32_t(of_frame)) {
    const Feature frame = Feature(mask) | Feature::Light;
    if ((!has(frame, Feature::Punctual) && has(frame, Feature::ShadowCube | Feature::ShadowEsm)) ||
        (!has(frame, Feature::ShadowCube | Feature::ShadowMap) && has(frame, Feature::ShadowPcf)) ||
        (!has(frame, Feature::ShadowEsm) && has(frame, Feature::ShadowEvsm))) {
      // No lamps give these.
      continue;
    }
    constexpr Feature layered = Feature::FullMaterial | Feature::Layers;
    for (const Feature material :
         {Feature::None, Feature::BaseColorTexture, Feature::FullMaterial, layered, layered | Feature::Transmission}) {
      // Layers reflect.
      const Feature reflects = has(material, Feature::Layers) ? Feature::Specular : Feature::None;
      const Feature variant = with_variant(frame | material | reflects);
      EXPECT_TRUE(declared.contains(variant)) << mask << ' ' << std::uint32_t(material);
      const bool is_asked = has(frame, Feature::Multiscatter) && has(frame | reflects, Feature::Specular);
      EXPECT_EQ(has(variant, Feature::Multiscatter), is_asked) << mask << ' ' << std::uint32_t(material);
    }
  }
}

// hazards.md: a float array in a std140 block took 16 bytes an element in GLSL and 4 in C. The build refuses variants
// of a program that disagree about the layout of a block, so that one variant is compiled for each block.
TEST(SharedBlocks, AreLaidOutAlikeInCppAndGlsl)
{
  const auto is_block = [](const auto &binding) { return binding.kind != gpu::BindingKind::Texture; };
  std::set<std::string> compared_anywhere;
  for (const ShaderDeclaration &declaration : shader_declarations()) {
    std::set<std::string> compared;
    // Variants with many features come last, and read the most blocks.
    std::vector<Feature> variants = shader_variants(declaration);
    std::ranges::reverse(variants);
    for (const Feature features : variants) {
      const std::vector<gpu::ShaderInterface::Binding> bindings = interface_of(declaration, features).bindings;
      if (std::ranges::all_of(
              bindings, [&](const auto &binding) { return !is_block(binding) || compared.contains(binding.name); })) {
        continue;
      }
      const gpu::ShaderDesc desc = shader_desc(declaration, features);
      for (const auto &comparison : shader_check::compare_blocks(desc, shaders::file, block_layouts())) {
        compared.insert(comparison.block);
        EXPECT_EQ(comparison.cpp_size_bytes, comparison.glsl_size_bytes) << comparison.block;
        for (const auto &field : comparison.fields) {
          EXPECT_TRUE(field.cpp_offset_bytes && field.glsl_offset_bytes) << comparison.block << ", " << field.name;
          EXPECT_EQ(field.cpp_offset_bytes, field.glsl_offset_bytes) << comparison.block << ", " << field.name;
        }
      }
      for (const auto &binding : bindings) {
        EXPECT_TRUE(!is_block(binding) || compared.contains(binding.name)) << binding.name;
      }
    }
    compared_anywhere.insert(compared.begin(), compared.end());
  }
  EXPECT_EQ(compared_anywhere.size(), block_layouts().size()) << "a block that no shader reads";
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

TEST(ShaderCache, KeepsMasksWithoutLight)
{
  const auto device = gpu::create_null_device();
  ShaderCache cache;
  EXPECT_NE(&cache.get(*device, ShaderId::Depth), &cache.get(*device, ShaderId::Depth, Feature::AlphaMask));
  EXPECT_NE(&cache.get(*device, ShaderId::Lit), &cache.get(*device, ShaderId::Lit, Feature::BaseColorTexture));
  EXPECT_EQ(&cache.get(*device, ShaderId::Lit), &cache.get(*device, ShaderId::Lit, Feature::Specular));
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

TEST(ShaderCache, ReloadWithoutAReflectionFunctionSaysSoAndChangesNothing)
{
  const auto device = gpu::create_null_device();
  ShaderCache cache;
  cache.get(*device, ShaderId::Depth);
  const gpu::ShaderFiles none = [](std::string_view) { return std::optional<std::string_view>(); };
  const std::vector<std::string> failures = cache.reload(*device, none, {});
  ASSERT_EQ(failures.size(), 1U);
  EXPECT_NE(failures[0].find("shader_check::reflect"), std::string::npos) << failures[0];
  EXPECT_EQ(device->counters().shaders_made, 1U);
  // Still from the library's files.
  EXPECT_NO_THROW(cache.get(*device, ShaderId::Lit));
}

TEST(ShaderCache, ReloadedShadersHaveTheInterfaceOfTheNewFiles)
{
  const auto device = gpu::create_null_device();
  ShaderCache cache;
  ASSERT_EQ(cache.get(*device, ShaderId::Film).interface().push_constant_size_bytes, 48U);
  const std::string path = "eevee/eevee_film_frag.glsl";
  std::string edited(*shaders::file(path));
  const std::string line = "  vec4 row_weights;\n";
  ASSERT_NE(edited.find(line), std::string::npos);
  edited.insert(edited.find(line) + line.size(), "  vec4 more;\n");
  const gpu::ShaderFiles files = [&](std::string_view file) {
    return file == path ? std::optional<std::string_view>(edited) : shaders::file(file);
  };
  EXPECT_EQ(cache.reload(*device, files, shader_check::reflect), std::vector<std::string>());
  EXPECT_EQ(cache.get(*device, ShaderId::Film).interface().push_constant_size_bytes, 64U);
}

}  // namespace
}  // namespace gnomon::eevee
