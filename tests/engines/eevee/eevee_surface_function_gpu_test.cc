// SPDX-License-Identifier: MIT
// Surface functions of materials, on the driver: what they compute is drawn, in every pass, and a broken one is seen.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <tuple>

namespace gnomon::eevee {
namespace {

using test::Picture;
using test::Renderer;

constexpr glm::ivec2 function_size_px(24, 24);
constexpr glm::vec3 magenta(1.0F, 0.0F, 1.0F);

std::string function(const std::string &body)
{
  return "void surface(SurfaceInputs inputs, inout StandardSurface result)\n{\n" + body + "\n}\n";
}

double difference_of(const Picture &a, const Picture &b)
{
  double largest = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); i++) {
    largest = std::max(largest, double(glm::distance(a.pixels[i], b.pixels[i])));
  }
  return largest;
}

class SurfaceFunctionGpuTest : public test::SharedDeviceTest {
 protected:
  scene::Handle<scene::Material> add_material(const std::string &text, const glm::vec3 &albedo = glm::vec3(1.0F))
  {
    const auto material = test::add_material(scene, albedo);
    const auto added = scene.add(scene::SurfaceFunction{.name = "test", .text = text, .path = "test.glsl"});
    scene.edit(material, [&](scene::Material &value) { value.surface_function = added; });
    return material;
  }
  /** A square of half size 1 that faces +Z. */
  scene::Handle<scene::Node> add_square(scene::Handle<scene::Material> material, const glm::dvec3 &position = {})
  {
    const auto mesh = test::add_square_mesh(scene, material);
    scene.edit(mesh, [](scene::Mesh &value) { value.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}}; });
    return test::add_object(scene, mesh, glm::translate(glm::dmat4(1), position));
  }
  Picture render(const Settings &settings = {})
  {
    return render(camera, settings);
  }
  Picture render(const scene::PlacedCamera &from, const Settings &settings = {})
  {
    Renderer renderer(*device, scene, function_size_px, settings);
    Picture picture = renderer.picture(from);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    warnings = renderer.inspect().report().warnings;
    return picture;
  }
  void edit(scene::Handle<scene::Material> material, const std::string &text)
  {
    scene.edit(scene.materials()[material].surface_function, [&](scene::SurfaceFunction &value) { value.text = text; });
  }

  scene::Scene scene;
  scene::PlacedCamera camera = test::camera_at({0, 0, 4}, {0, 0, 0}, 0.6F);
  std::vector<std::string> warnings;
};

TEST_F(SurfaceFunctionGpuTest, CheckerFromUvsEqualsTheTextureOfItsTexels)
{
  // Odd counts, so that no texel's edge is at a pixel's centre.
  const auto material = add_material(function(R"(
  ivec2 cell = ivec2(floor(inputs.uv * vec2(7.0, 5.0)));
  result.base_color = (cell.x + cell.y) % 2 == 0 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 1.0);)"));
  scene.edit(material, [](scene::Material &value) { value.is_unlit = true; });
  add_square(material);
  const Picture computed = render();
  EXPECT_TRUE(warnings.empty());
  std::vector<std::uint8_t> texels;
  for (int y = 0; y < 5; y++) {
    for (int x = 0; x < 7; x++) {
      const bool is_even = (x + y) % 2 == 0;
      for (const int channel : {is_even ? 255 : 0, is_even ? 0 : 255, is_even ? 0 : 255, 255}) {
        texels.push_back(std::uint8_t(channel));
      }
    }
  }
  const auto texture = test::add_texture(scene, 7, texels);
  scene.edit(material, [&](scene::Material &value) {
    value.surface_function = {};
    value.base_color_texture = texture;
  });
  EXPECT_EQ(difference_of(computed, render()), 0.0);
}

TEST_F(SurfaceFunctionGpuTest, ReadsWhatTheMaterialsFactorsTexturesAndVertexColoursGive)
{
  const auto material = add_material(function(R"(
  result.emission = vec3(result.metallic, result.roughness, result.base_color.r) + texture(emissive_texture, vec2(0.5)).rgb;
  result.base_color = vec3(0.0);)"));
  const auto texture = test::add_texture(scene, 1, {0, 255, 0, 255});
  scene.edit(material, [&](scene::Material &value) {
    value.base_color = glm::vec3(0.5F);
    value.metallic = 0.25F;
    value.roughness = 0.75F;
    value.emissive_texture = texture;
  });
  const auto square = add_square(material);
  scene.edit(scene.nodes()[square].meshes.front(),
             [](scene::Mesh &mesh) { mesh.colors.assign(4, glm::vec4(0.5F, 1, 1, 1)); });
  // The surface has no light but that.
  // The vertex colour is interpolated: 4e-6 off.
  test::expect_near(glm::vec3(render().middle()), {0.25F, 1.75F, 0.25F}, 1e-5F);
  EXPECT_TRUE(warnings.empty());
}

TEST_F(SurfaceFunctionGpuTest, LightFallsOnTheSurfaceAndNormalThatTheFunctionReturns)
{
  // The normal leans by 60 degrees, so that half of the sun's light arrives.
  const auto material = add_material(function(R"(
  result.base_color = vec3(0.5, 0.25, 1.0);
  result.normal_ws = vec3(3.0 * sqrt(3.0), 0.0, 3.0);)"));
  add_square(material);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {0, 0, -1}, 3.14159265F);
  for (const auto &change : std::vector<std::function<void(scene::Material &)>>{
           [](scene::Material & /*value*/) {}, [](scene::Material &value) { value.coat = 1e-6F; }}) {
    scene.edit(material, change);
    test::expect_near(glm::vec3(render().middle()), {0.25F, 0.125F, 0.5F}, 1e-5F);
    EXPECT_TRUE(warnings.empty());
  }
}

TEST_F(SurfaceFunctionGpuTest, PositionIsThatOfTheScenesWorldAlsoFarFromTheOrigin)
{
  const auto material = add_material(function(R"(
  result.emission = mod(inputs.position_ws, vec3(300.0)) / 300.0;
  result.base_color = vec3(0.0);)"));
  // The origins that a render scene chooses are no multiples of the period.
  for (const glm::dvec3 &place : {glm::dvec3(10, 20, 30), glm::dvec3(99999, -50001, 30003)}) {
    const auto square = add_square(material, place);
    const glm::vec3 at(place);
    test::expect_near(
        glm::vec3(render(test::camera_at(at + glm::vec3(0, 0, 4), at, 0.6F)).middle()),
        glm::mod(at, glm::vec3(300.0F)) / 300.0F,
        // The middle pixel's centre is 0.05 m off the middle of the picture, and a float at 1e5 has steps of 8 mm.
        0.06F / 300.0F);
    scene.remove(square);
  }
}

TEST_F(SurfaceFunctionGpuTest, ResultsOutOfRangeAndWithoutValueReachNoPixel)
{
  const auto material = add_material(function(R"(
  float nothing = inputs.uv.x < 2.0 ? 0.0 : 1.0;
  result.base_color = vec3(nothing / nothing, -1.0, 5.0);
  result.roughness = nothing / nothing;
  result.metallic = -1.0 / nothing;
  result.normal_ws = vec3(nothing);
  result.emission = vec3(nothing / nothing, 1.0 / nothing, -1.0);)"));
  add_square(material);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {0, 0, -1}, 3.14159265F);
  const glm::vec4 pixel = render().middle();
  EXPECT_EQ(pixel.r, 0.0F);
  // The bound of emission.
  EXPECT_NEAR(pixel.g, 1e9F, 1e3F);
  EXPECT_NEAR(pixel.b, 1.0F, 1e-5F);
}

using AlphaCase = std::tuple<scene::AlphaMode, scene::LampKind, LayerPass>;

/** A lamp above a plate with a round hole, which the function makes; the plate's shadow is beside it on the ground. */
class SurfaceFunctionAlphaGpuTest : public SurfaceFunctionGpuTest, public testing::WithParamInterface<AlphaCase> {};

TEST_P(SurfaceFunctionAlphaGpuTest, CutsThePictureAndTheShadowAlike)
{
  const auto &[alpha_mode, lamp_kind, layer_pass] = GetParam();
  if (!test::has_layer_pass(device->limits(), layer_pass)) {
    GTEST_SKIP() << "the device does not draw shadow layers in this way";
  }
  const auto plate = add_material(function(R"(
  result.base_color = vec3(0.0);
  result.alpha = distance(inputs.position_os.xy, vec2(0.0)) < 0.5 ? 0.0 : 1.0;)"));
  scene.edit(plate, [&, mode = alpha_mode](scene::Material &value) { value.alpha_mode = mode; });
  add_square(plate, {-3, 0, 3});
  const auto ground = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(1.0F)));
  test::add_object(scene, ground, glm::scale(glm::dmat4(1), glm::dvec3(8)));
  // The lamp's ray through the plate's middle meets the origin.
  test::add_lamp(scene, lamp_kind, {-6, 0, 6}, {1, 0, -1}, 100.0F);
  Settings settings;
  settings.shadow.layer_pass = layer_pass;
  const auto radiance = [&](const glm::vec3 &position) {
    return render(test::camera_at(position + glm::vec3(0, 0, 9), position, 0.02F), settings).middle().g;
  };
  const float lit = radiance({0, 5, 0});
  ASSERT_GT(lit, 0.1F);
  EXPECT_GT(radiance({0, 0, 0}), 0.5F * lit);
  // The shadow of a point lamp is twice as large as the plate.
  EXPECT_EQ(radiance({0, lamp_kind == scene::LampKind::Sun ? 0.7F : 1.4F, 0}), 0.0F);
  // Through the hole, the camera sees the ground; beside it the black plate.
  EXPECT_GT(radiance({-3, 0, 0}), 0.1F * lit);
  EXPECT_EQ(radiance({-3, 0.6F, 0}), 0.0F);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
}

INSTANTIATE_TEST_SUITE_P(
    All, SurfaceFunctionAlphaGpuTest,
    testing::Values(AlphaCase(scene::AlphaMode::Mask, scene::LampKind::Sun, LayerPass::Best),
                    AlphaCase(scene::AlphaMode::Blend, scene::LampKind::Sun, LayerPass::Single),
                    AlphaCase(scene::AlphaMode::Mask, scene::LampKind::Point, LayerPass::Single),
                    AlphaCase(scene::AlphaMode::Mask, scene::LampKind::Point, LayerPass::Geometry),
                    AlphaCase(scene::AlphaMode::Blend, scene::LampKind::Point, LayerPass::Geometry),
                    AlphaCase(scene::AlphaMode::Blend, scene::LampKind::Point, LayerPass::Layered)));

TEST_F(SurfaceFunctionGpuTest, AlphaOfAnOpaqueMaterialHasNoEffect)
{
  const auto material = add_material(function("  result.alpha = 0.0; result.emission = vec3(1.0, 2.0, 3.0);"), {});
  add_square(material);
  test::expect_near(glm::vec3(render().middle()), {1, 2, 3}, 1e-6F);
}

TEST_F(SurfaceFunctionGpuTest, AlphaStartsWithTheFactorAndMayExceedIt)
{
  const auto material = add_material(function("  result.emission = vec3(result.alpha); result.alpha = 1.0;"), {});
  scene.edit(material, [](scene::Material &value) {
    value.alpha_mode = scene::AlphaMode::Mask;
    value.alpha = 0.25F;
  });
  add_square(material);
  test::expect_near(glm::vec3(render().middle()), glm::vec3(0.25F), 1e-6F);
}

TEST_F(SurfaceFunctionGpuTest, ABrokenOneIsMagentaWithAWarningAndOtherMaterialsAreRight)
{
  const auto broken = add_material(
      "// a comment\nvoid surface(SurfaceInputs inputs, inout StandardSurface result)\n{\n"
      "  result.base_color = missing;\n}\n");
  scene.edit(broken, [](scene::Material &value) { value.name = "broken"; });
  add_square(broken, {-1, 0, 0});
  add_square(add_material(function("  result.emission = vec3(1.0, 2.0, 3.0);"), {}), {1, 0, 0});
  Renderer renderer(*device, scene, function_size_px, {});
  Picture picture = renderer.picture(camera);
  test::expect_near(glm::vec3(picture.at(6, 12)), magenta, 1e-6F);
  test::expect_near(glm::vec3(picture.at(17, 12)), {1, 2, 3}, 1e-6F);
  const std::vector<std::string> found = renderer.inspect().report().warnings;
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found.front().find("material 'broken'"), std::string::npos) << found.front();
  EXPECT_NE(found.front().find("test.glsl:4"), std::string::npos) << found.front();
  // The text is edited.
  edit(broken, function("  result.emission = vec3(0.0, 1.0, 0.0); result.base_color = vec3(0.0);"));
  renderer.sync();
  test::expect_near(glm::vec3(renderer.picture(camera).at(6, 12)), {0, 1, 0}, 1e-6F);
  EXPECT_TRUE(renderer.inspect().report().warnings.empty());
  // The function is removed.
  scene.remove(scene.materials()[broken].surface_function);
  renderer.sync();
  EXPECT_EQ(glm::vec3(renderer.picture(camera).at(6, 12)), glm::vec3(0));
}

TEST_F(SurfaceFunctionGpuTest, NoTextMakesAPictureFailAndEachFaultIsNamed)
{
  const auto material = add_material("");
  add_square(material);
  for (const auto &[text, part] : std::vector<std::pair<std::string, std::string>>{
           {"", "it has no text"},
           {"float other() { return 1.0; }", "test.glsl"},
           {"void surface() {}", "test.glsl"},
           {"#endif\n" + function(""), "test.glsl"},
           {"}\n", "test.glsl:1"},
           {"\n# include \"eevee/eevee_light_lib.glsl\"\n" + function(""),
            "test.glsl:2: a surface function has no #include"},
           {"#version 450\n" + function(""), "test.glsl:1: a surface function has no #version"},
           {"layout(binding = 0) uniform sampler2D base_color_texture;\n" + function(""), "test.glsl:1"},
           {"/*" + function(""), "test.glsl"},
       }) {
    SCOPED_TRACE(text);
    edit(material, text);
    test::expect_near(glm::vec3(render().middle()), magenta, 1e-6F);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings.front().find(part), std::string::npos) << warnings.front();
  }
}

TEST_F(SurfaceFunctionGpuTest, EmissionIsAPartOfTheLight)
{
  const auto material = add_material(function("  result.emission = vec3(1.0, 2.0, 3.0);"));
  add_square(material);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {0, 0, -1}, 3.14159265F);
  const glm::vec3 emission = render({.light = {LightComponent::Kind::Emission}}).middle();
  const glm::vec3 lamp = render({.light = {LightComponent::Kind::Lamp, 0}}).middle();
  test::expect_near(emission, {1, 2, 3}, 1e-6F);
  test::expect_near(lamp, glm::vec3(1), 1e-5F);
  test::expect_near(render().middle(), emission + lamp, 1e-6F);
}

TEST_F(SurfaceFunctionGpuTest, LayersForCompositingShowTheFunctionsSurface)
{
  const auto material = add_material(function(R"(
  result.base_color = vec3(0.25, 0.5, 0.75);
  result.roughness = 0.5;
  result.normal_ws = vec3(0.6, 0.0, 0.8);)"));
  add_square(material);
  Renderer renderer(*device, scene, function_size_px, {.has_surfaces = true});
  renderer.draw(camera);
  const auto surfaces = renderer.inspect().surfaces(render_scene::view_of(camera, function_size_px));
  ASSERT_TRUE(surfaces);
  const std::size_t middle = std::size_t(function_size_px.x) * 12 + 12;
  test::expect_near(glm::vec3(surfaces->albedo_roughness[middle]), {0.25F, 0.5F, 0.75F}, 1e-6F);
  EXPECT_NEAR(surfaces->albedo_roughness[middle].a, 0.5F, 1e-6F);
  test::expect_near(glm::vec3(surfaces->normal_object[middle]), {0.6F, 0, 0.8F}, 1e-6F);
}

/** In all kinds of programs that have a function. */
TEST_F(SurfaceFunctionGpuTest, OneThatChangesNothingGivesThePictureWithoutIt)
{
  const auto material = add_material(function(""), {0.75F, 0.5F, 0.25F});
  const scene::Handle<scene::SurfaceFunction> unchanged = scene.materials()[material].surface_function;
  const auto base_color =
      test::add_texture(scene, 2, {255, 99, 0, 255, 9, 99, 255, 99, 40, 255, 0, 130, 7, 7, 70, 255});
  const auto data = test::add_texture(scene, 1, {0, 128, 190, 200});
  const auto square = test::add_square_mesh(scene, material);
  scene.edit(square, [](scene::Mesh &mesh) {
    mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.tangents.assign(4, {1, 0, 0, 1});
    mesh.colors = {{1, 1, 1, 1}, {0.5F, 1, 1, 1}, {1, 0.5F, 1, 0.5F}, {1, 1, 0.5F, 1}};
  });
  test::add_object(scene, square, glm::translate(glm::dmat4(1), glm::dvec3(0, 0, 1)));
  const auto ground = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F)));
  test::add_object(scene, ground, glm::scale(glm::dmat4(1), glm::dvec3(4)));
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 5}, {0.3F, 0.1F, -1}, 2.0F);
  scene.edit(material, [&](scene::Material &value) {
    value.specular_color = glm::vec3(1.0F);
    value.roughness = 0.4F;
    value.base_color_texture = base_color;
    value.metallic_roughness_texture = value.normal_texture = value.specular_texture = data;
    value.occlusion_texture = value.emissive_texture = data;
    value.emissive = glm::vec3(0.1F);
  });
  const auto expect_same = [&](const char *what, const Settings &settings = {}) {
    scene.edit(material, [&](scene::Material &value) { value.surface_function = unchanged; });
    const Picture with = render(settings);
    EXPECT_TRUE(warnings.empty()) << what << ": " << warnings.front();
    scene.edit(material, [&](scene::Material &value) { value.surface_function = {}; });
    EXPECT_LE(difference_of(with, render(settings)), 1e-5) << what;
  };
  const auto expect_same_after = [&](const char *what, const auto &change, const Settings &settings = {}) {
    scene.edit(material, change);
    expect_same(what, settings);
  };
  expect_same("textures");
  expect_same("multiple scattering", {.has_multiscatter = true});
  using scene::AlphaMode;
  expect_same_after("mask", [](scene::Material &value) {
    value.alpha_mode = AlphaMode::Mask;
    value.alpha = 0.9F;
  });
  expect_same_after("blend", [](scene::Material &value) { value.alpha_mode = AlphaMode::Blend; });
  scene.set_world(scene::World{.color = {0.25F, 0.5F, 0.75F}});
  expect_same_after("coat and world", [](scene::Material &value) {
    value.alpha_mode = AlphaMode::Opaque;
    value.coat = 0.5F;
    value.anisotropy = 0.5F;
  });
  expect_same_after("transmission", [](scene::Material &value) { value.transmission = 0.5F; });
  expect_same_after("unlit", [](scene::Material &value) { value.is_unlit = true; });
  scene.edit(material, [](scene::Material &value) {
    value.is_unlit = false;
    value.coat = value.anisotropy = value.transmission = 0.0F;
  });
  for (int i = 0; i < 12; i++) {
    const auto lamp = test::add_lamp(scene, scene::LampKind::Point, {0.25F * float(i) - 1.5F, 0, 3}, {0, 0, -1}, 0.1F);
    scene.edit(lamp, [](scene::Lamp &value) {
      value.range = 2.5F;
      value.shadow.kind = scene::ShadowKind::None;
    });
  }
  expect_same("many lamps");
}

TEST_F(SurfaceFunctionGpuTest, EditsOfItAndOfItsFactorsMoveTheShadow)
{
  const auto plate = add_material(function("  result.alpha = inputs.position_os.y > 0.0 ? 1.0 : 0.0;"));
  scene.edit(plate, [](scene::Material &value) { value.alpha_mode = scene::AlphaMode::Mask; });
  add_square(plate, {-3, 0, 3});
  const auto ground = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(1.0F)));
  test::add_object(scene, ground, glm::scale(glm::dmat4(1), glm::dvec3(8)));
  test::add_lamp(scene, scene::LampKind::Sun, {-6, 0, 6}, {1, 0, -1}, 3.0F);
  camera = test::camera_at({0, 0, 9}, {0, 0, 0}, 0.2F);
  Renderer renderer(*device, scene, function_size_px, {});
  // Rows count from the bottom.
  const auto is_lit = [&](int row) { return renderer.picture(camera).at(12, row).g > 0.3F; };
  EXPECT_TRUE(is_lit(6) && !is_lit(18));
  edit(plate, function("  result.alpha = inputs.position_os.y > 0.0 == result.roughness > 0.5 ? 0.0 : 1.0;"));
  renderer.sync();
  EXPECT_TRUE(!is_lit(6) && is_lit(18));
  scene.edit(plate, [](scene::Material &value) { value.roughness = 0.25F; });
  renderer.sync();
  EXPECT_TRUE(is_lit(6) && !is_lit(18));
}

}  // namespace
}  // namespace gnomon::eevee
