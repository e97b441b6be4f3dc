// SPDX-License-Identifier: MIT
// Reflects each variant of each program, which takes half a minute. No test here needs a driver; they stand with those
// that do, because these run without sanitizers, under which it would take minutes.
#include "eevee_interfaces.hh"
#include "eevee_shaders.hh"
#include "shader_check_reflection.hh"
#include "shader_files.hh"

#include <gtest/gtest.h>

namespace gnomon::eevee {
namespace {

constexpr std::size_t slice_count = 16;

/** Every 16th variant from this one on, so that the processes of the tests share the work. */
class InterfaceTablesSlice : public testing::TestWithParam<std::size_t> {};

// The build tool reflects other kernels than these.
TEST_P(InterfaceTablesSlice, EqualsAFreshReflectionOfEachVariantWithAnyKernel)
{
  std::size_t index = 0;
  for (const ShaderDeclaration &declaration : shader_declarations()) {
    for (const Feature features : shader_variants(declaration)) {
      if (index++ % slice_count != GetParam()) {
        continue;
      }
      const gpu::ShaderInterface generated =
          interface_tables()[std::size_t(declaration.id)].interface_of(std::uint32_t(features));
      std::vector<PcfKernel> kernels = {{.width = 1}};
      if (has(features, Feature::ShadowPcf)) {
        kernels.push_back({.width = 0, .taps = 1});
      }
      for (const PcfKernel &kernel : kernels) {
        const gpu::ShaderDesc desc = shader_desc(declaration, features, {.pcf = kernel});
        EXPECT_EQ(generated, shader_check::reflect(desc.name, gpu::preprocess(desc, shaders::file)))
            << declaration.name << " " << std::uint32_t(features) << ", kernel " << kernel.width;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Slices, InterfaceTablesSlice, testing::Range(std::size_t(0), slice_count));

}  // namespace
}  // namespace gnomon::eevee
