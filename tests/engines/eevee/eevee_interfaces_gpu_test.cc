// SPDX-License-Identifier: MIT
// No test here needs a driver; they stand with those that do, because these run without sanitizers, under which glslang
// is several times as slow.
#include "engines/eevee/eevee_pairwise_variants.hh"

#include "eevee_interfaces.hh"
#include "eevee_shaders.hh"
#include "shader_check_reflection.hh"
#include "shader_files.hh"

#include <gtest/gtest.h>

namespace gnomon::eevee {
namespace {

/** Compares the tables with fresh reflections of \a variants of each program. The build tool reflects other kernels. */
void expect_fresh(std::vector<Feature> (*variants)(const ShaderDeclaration &declaration))
{
  for (const ShaderDeclaration &declaration : shader_declarations()) {
    for (const Feature features : variants(declaration)) {
      const gpu::ShaderInterface generated =
          interface_tables()[std::size_t(declaration.id)].interface_of(std::uint32_t(features));
      std::vector<PcfKernel> kernels = {{.width = 1}};
      if (has(features, Feature::ShadowPcf)) {
        kernels.push_back({.width = 0, .taps = 1});
      }
      for (const PcfKernel &kernel : kernels) {
        const gpu::ShaderDesc desc = shader_desc(declaration, features, kernel);
        EXPECT_EQ(generated, shader_check::reflect(desc.name, gpu::preprocess(desc, shaders::file)))
            << declaration.name << " " << std::uint32_t(features) << ", kernel " << kernel.width;
      }
    }
  }
}

TEST(InterfaceTables, EqualFreshReflectionsOfEachPairOfFeaturesWithAnyKernel)
{
  expect_fresh(test::pairwise_variants);
}

TEST(SlowInterfaceTables, EqualFreshReflectionsOfEachVariantWithAnyKernel)
{
  expect_fresh(shader_variants);
}

}  // namespace
}  // namespace gnomon::eevee
