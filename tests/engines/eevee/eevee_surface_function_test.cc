// SPDX-License-Identifier: MIT
// Programs, blocks and passes of surface functions: what a scene does not need is not made, and what it needs once.
#include "eevee_test_scene.hh"

#include "eevee_programs.hh"
#include "gpu_device.hh"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace gnomon::eevee {
namespace {

using test::Renderer;

constexpr glm::ivec2 function_size_px(8, 8);

class SurfaceFunctionTest : public testing::Test {
 protected:
  SurfaceFunctionTest()
  {
    for (int i = 0; i < 3; i++) {
      materials.push_back(test::add_material(scene, glm::vec3(1.0F)));
      test::add_object(scene, test::add_square_mesh(scene, materials.back()),
                       glm::translate(glm::dmat4(1), glm::dvec3(0.1 * i)));
    }
    test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {0, 0, -1}, 3.0F);
  }
  scene::Handle<scene::SurfaceFunction> add_function()
  {
    return scene.add(
        scene::SurfaceFunction{.text = "void surface(SurfaceInputs inputs, inout StandardSurface result) {}"});
  }
  void give(std::size_t material, scene::Handle<scene::SurfaceFunction> function,
            scene::AlphaMode mode = scene::AlphaMode::Opaque)
  {
    scene.edit(materials[material], [&](scene::Material &value) {
      value.surface_function = function;
      value.alpha_mode = mode;
    });
  }
  /** By name of a program: how many of them have a surface function. */
  std::map<std::string, int> made()
  {
    std::map<std::string, int> counts;
    for (const gpu::LiveResource &live : device->live()) {
      if (live.kind == gpu::ResourceKind::Shader && live.detail.find("USE_SURFACE_FUNCTION") != std::string::npos) {
        counts[live.name]++;
      }
    }
    return counts;
  }
  bool has_block() const
  {
    return std::ranges::any_of(device->live(),
                               [](const gpu::LiveResource &live) { return live.name == "surface_function_block"; });
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  scene::Scene scene;
  std::vector<scene::Handle<scene::Material>> materials;
  scene::PlacedCamera camera = test::camera_at({0, 0, 5}, {0, 0, 0});
};

using ProgramCounts = std::map<std::string, int>;

TEST_F(SurfaceFunctionTest, ScenesWithoutOneMakeNothingForThem)
{
  // A handle whose function was removed counts as none.
  const auto removed = add_function();
  give(0, removed, scene::AlphaMode::Mask);
  scene.remove(removed);
  Renderer renderer(*device, scene, function_size_px);
  renderer.draw(camera);
  EXPECT_EQ(made(), ProgramCounts());
  EXPECT_FALSE(has_block());
  EXPECT_EQ(renderer.inspect().report().warnings,
            (std::vector<std::string>{"material 'material0': its surface function was removed"}));
}

TEST_F(SurfaceFunctionTest, OneIsCompiledIntoDepthAndShadowsIfItCanChangeAlpha)
{
  Renderer renderer(*device, scene, function_size_px);
  const auto first = add_function();
  give(0, first);
  give(1, first);
  renderer.sync();
  renderer.draw(camera);
  EXPECT_TRUE(has_block());
  EXPECT_EQ(made(), (ProgramCounts{{"eevee_lit", 1}}));
  give(1, first, scene::AlphaMode::Mask);
  renderer.sync();
  renderer.draw(camera);
  EXPECT_EQ(made(), (ProgramCounts{{"eevee_lit", 1}, {"eevee_depth_function", 1}, {"eevee_shadow_layered", 1}}));
  const std::size_t shader_count = device->counters().shaders_made;
  // Blended surfaces have no depth; their shadow is drawn by a variant of its own.
  const auto second = add_function();
  // Functions of one text share programs.
  scene.edit(second, [](scene::SurfaceFunction &function) { function.text += "// second\n"; });
  give(2, second, scene::AlphaMode::Blend);
  renderer.sync();
  renderer.draw(camera);
  EXPECT_EQ(made(), (ProgramCounts{{"eevee_lit", 2}, {"eevee_depth_function", 1}, {"eevee_shadow_layered", 2}}));
  EXPECT_EQ(device->counters().shaders_made, shader_count + 2);
  // Programs of an earlier text are destroyed, and later those of functions that no material has.
  scene.edit(second, [](scene::SurfaceFunction &function) { function.text += "\n"; });
  renderer.sync();
  renderer.draw(camera);
  EXPECT_EQ(made(), (ProgramCounts{{"eevee_lit", 2}, {"eevee_depth_function", 1}, {"eevee_shadow_layered", 2}}));
  EXPECT_EQ(device->counters().shaders_made, shader_count + 4);
  give(0, {});
  give(1, {});
  give(2, {});
  renderer.sync();
  renderer.draw(camera);
  EXPECT_EQ(made(), ProgramCounts());
  EXPECT_FALSE(has_block());
}

TEST_F(SurfaceFunctionTest, VariantsWithOneAreAmongThoseThatAreDeclared)
{
  for (const ShaderDeclaration &declaration : shader_declarations()) {
    const std::vector<Feature> declared = shader_variants(declaration);
    for (const Feature features : surface_function_variants(declaration)) {
      EXPECT_NE(std::ranges::find(declared, features), declared.end()) << declaration.name;
      EXPECT_TRUE(has(features, Feature::FullMaterial)) << declaration.name;
    }
  }
}

TEST_F(SurfaceFunctionTest, DirectivesThatBelongToAWholeFileAreFaults)
{
  EXPECT_FALSE(surface_function_fault("#define A 1\n#if A\n// #include\n#endif\n"));
  for (const std::string directive : {"include", "version", "extension", "line"}) {
    const auto fault = surface_function_fault("\n\n  #  " + directive + " x");
    ASSERT_TRUE(fault);
    EXPECT_EQ(fault->line, 3);
    EXPECT_NE(fault->reason.find("#" + directive), std::string::npos);
  }
  EXPECT_FALSE(surface_function_fault(""));
}

}  // namespace
}  // namespace gnomon::eevee
