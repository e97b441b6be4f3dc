// SPDX-License-Identifier: MIT
#include "unlit_engine.hh"

#include "eevee_engine.hh"
#include "engines/eevee/eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "gpu_read.hh"
#include "render_camera.hh"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/packing.hpp>

namespace gnomon::unlit {
namespace {

constexpr glm::vec3 ground_color(0.75F, 0.5F, 0.25F);

class UnlitGpuTest : public test::SharedDeviceTest {
 protected:
  void SetUp() override
  {
    SharedDeviceTest::SetUp();
    if (device) {
      render_scene.emplace(*device, scene);
      viewport.emplace(*device, size_px);
    }
  }
  /** An engine's picture of the scene, by draws as often as it needs. */
  void draw(draw::Engine &engine, int draw_count = 1)
  {
    render_scene->update();
    const std::array<draw::Engine *, 1> engines = {&engine};
    viewport->sync(engines, render_scene->objects());
    for (int i = 0; i < draw_count; i++) {
      viewport->draw(engines, render_scene::view_of(camera, size_px));
    }
  }
  test::Picture picture(Engine &engine)
  {
    draw(engine);
    test::Picture picture{size_px, {}};
    const std::vector<std::uint64_t> drawn = gpu::read_as<std::uint64_t>(*device, engine.radiance(*viewport));
    for (int y = 0; y < size_px.y; y++) {
      for (int x = 0; x < size_px.x; x++) {
        const glm::ivec2 texel_px = viewport->guard_px() + glm::ivec2(x, y);
        picture.pixels.push_back(
            glm::unpackHalf4x16(drawn[std::size_t(texel_px.y * viewport->drawn_size_px().x + texel_px.x)]));
      }
    }
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture;
  }
  void add_ground()
  {
    test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, ground_color)),
                     glm::scale(glm::dmat4(1), glm::dvec3(2)));
  }
  /** Where the ray through the middle of a pixel meets the plane of this z. */
  [[nodiscard]] glm::dvec2 hit(int x, int y, double z) const
  {
    const glm::dmat4 view_from_clip = glm::inverse(glm::dmat4(render_scene::view_of(camera, size_px).clip_from_view()));
    const glm::dvec2 ndc = 2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(size_px) - 1.0;
    const glm::dvec4 near = view_from_clip * glm::dvec4(ndc, 1, 1);
    const glm::dvec3 eye(camera.world_from_camera[3]);
    const glm::dvec3 way(camera.world_from_camera * glm::dvec4(glm::dvec3(near) / near.w, 0));
    return glm::dvec2(eye + way * ((z - eye.z) / way.z));
  }

  static constexpr glm::ivec2 size_px{64, 48};
  scene::Scene scene;
  scene::PlacedCamera camera = test::camera_at({0, -5, 6}, {0, 0, 0});
  std::optional<render_scene::RenderScene> render_scene;
  std::optional<draw::Viewport> viewport;
};

TEST_F(UnlitGpuTest, ATiltedSurfaceCastsNoShadowOnItself)
{
  const auto node =
      test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, ground_color)), glm::dmat4(1));
  const glm::dvec3 from_sun(0.9, 0.4, -1);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, from_sun, 1.0F);
  Engine engine(*render_scene);
  int covered = 0;
  for (int step = 0; step < 60; step++) {
    const double angle = 0.02 * step;
    const glm::dmat4 tilted = glm::rotate(glm::dmat4(1), angle, {std::sin(step), std::cos(step), 0.2});
    scene.set_transform(node, glm::scale(tilted, glm::dvec3(2)));
    // Seen edge-on, it has no depth at the centres of texels.
    const auto facing = [&](const glm::dvec3 &way) {
      return std::abs(glm::dot(glm::normalize(way), glm::dvec3(tilted[2])));
    };
    if (facing(from_sun) < 0.1 || facing({0, -5, 6}) < 0.1) {
      continue;
    }
    for (const glm::vec4 &pixel : picture(engine).pixels) {
      covered += pixel.a > 0.0F ? 1 : 0;
      ASSERT_TRUE(pixel.a == 0.0F || pixel == glm::vec4(ground_color, 1)) << angle;
    }
  }
  EXPECT_GT(covered, 30000);
}

/** Both scenes are made by the same edits, so that their handles are equal. */
TEST_F(UnlitGpuTest, AnotherSceneUnderTheReferenceIsDrawnAndARestoredNodeIsBack)
{
  const auto fill = [&](const glm::vec3 &color, double height) {
    scene = {};
    test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, color)),
                     glm::scale(glm::dmat4(1), glm::dvec3(2)));
    const auto caster = test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, {0, 0, 1})),
                                         glm::scale(glm::translate(glm::dmat4(1), {0, 0, height}), glm::dvec3(0.5)));
    test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0.9, 0.4, -1}, 1.0F);
    return caster;
  };
  Engine engine(*render_scene);
  const auto pixels = [&] { return picture(engine).pixels; };
  fill({1, 0, 0}, 0.5);
  const auto first = pixels();
  const scene::Scene red = scene;
  const auto caster = fill({0, 1, 0}, 1.0);
  const auto second = pixels();
  EXPECT_NE(first, second);
  scene::Scene green = scene;
  scene = red;
  EXPECT_EQ(pixels(), first);
  std::swap(scene, green);
  EXPECT_EQ(pixels(), second);
  // An edit that is undone by a copy, and then made otherwise.
  const scene::Scene snapshot = scene;
  scene.set_transform(caster, glm::dmat4(1));
  pixels();
  scene = snapshot;
  EXPECT_EQ(pixels(), second);
  const scene::Node value = scene.nodes()[caster];
  scene.remove(caster);
  EXPECT_NE(pixels(), second);
  scene.restore(caster, value);
  EXPECT_EQ(pixels(), second);
  scene.remove(caster);
  scene.restore(caster, value);
  EXPECT_EQ(pixels(), second) << "removed and restored between two pictures";
  scene = {};
  for (const glm::vec4 &pixel : pixels()) {
    ASSERT_EQ(pixel, glm::vec4(0.0F));
  }
}

TEST_F(UnlitGpuTest, TheGroundIsItsColorAndBlackWhereTheCasterHidesItFromTheDepthCamera)
{
  add_ground();
  test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, {0, 0, 1})),
                   glm::scale(glm::translate(glm::dmat4(1), {0, 0, 1}), glm::dvec3(0.5)));
  const glm::dvec2 slant(0.9, 0.4);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {slant, -1}, 1.0F);
  Engine engine(*render_scene);
  const test::Picture unlit = picture(engine);
  // A texel of the depth camera, whose picture is as wide as the scene's sphere, at the slant of the light.
  constexpr double margin = 2 * 3.1 / 1024 * 1.5;
  int shadowed = 0;
  int lit = 0;
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      const glm::dvec2 ground = glm::abs(hit(x, y, 0));
      const glm::dvec2 caster = glm::abs(hit(x, y, 1));
      // Distance of a place from the edge of a square around the middle, negative inside.
      const auto outside = [](glm::dvec2 place, double half) {
        return std::max(std::abs(place.x), std::abs(place.y)) - half;
      };
      if (outside(ground, 2) > -1e-3 || outside(caster, 0.5) < 1e-3) {
        continue;
      }
      const double from_shadow = outside(hit(x, y, 0) - slant, 0.5);
      if (std::abs(from_shadow) < margin) {
        continue;
      }
      (from_shadow < 0 ? shadowed : lit)++;
      const glm::vec3 expected = from_shadow < 0 ? glm::vec3(0) : ground_color;
      EXPECT_EQ(unlit.at(x, y), glm::vec4(expected, 1)) << x << ", " << y;
    }
  }
  EXPECT_GT(shadowed, 30);
  EXPECT_GT(lit, 500);
}

/** Without the receiver's plane, half of each coarse texel would hide itself. */
TEST_F(UnlitGpuTest, APlaneThatACoarseDepthCameraSeesAtASlantHidesNothingOfItself)
{
  add_ground();
  for (const scene::LampKind kind : {scene::LampKind::Spot, scene::LampKind::Sun, scene::LampKind::Point}) {
    test::remove_lamps(scene);
    test::add_lamp(scene, kind, {-6, 1, 1.5}, {6, -1, -1.5}, 1.0F);
    Engine engine(*render_scene, {.depth_size_px = {48, 32}});
    const test::Picture unlit = picture(engine);
    for (const glm::vec4 &pixel : unlit.pixels) {
      if (pixel.a > 0) {
        EXPECT_EQ(pixel, glm::vec4(ground_color, 1)) << int(kind);
      }
    }
    viewport->remove_engine(engine);
  }
}

TEST_F(UnlitGpuTest, TexturesTintTheBaseColorAndUnlitMaterialsAreShownToo)
{
  const auto material = test::add_material(scene, {0.5F, 1, 1});
  const std::vector<std::uint8_t> red_and_green = {255, 0, 0, 255, 0, 255, 0, 255};
  scene.edit(material, [&](scene::Material &one) {
    one.base_color_texture = {test::add_texture(scene, 2, red_and_green)};
    one.emissive = {0, 0, 0.25F};
  });
  test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1), glm::dvec3(3)));
  Engine engine(*render_scene);
  const test::Picture textured = picture(engine);
  EXPECT_EQ(textured.at(size_px.x / 4, size_px.y / 2), glm::vec4(0.5F, 0, 0.25F, 1));
  EXPECT_EQ(textured.at(3 * size_px.x / 4, size_px.y / 2), glm::vec4(0, 1, 0.25F, 1));
  scene.edit(material, [](scene::Material &one) { one.is_unlit = true; });
  EXPECT_EQ(picture(engine).at(size_px.x / 4, size_px.y / 2), glm::vec4(0.5F, 0, 0, 1));
}

/** In whatever order they were added, and without a shadow. */
TEST_F(UnlitGpuTest, BlendedAndTransmissiveSurfacesCoverTheirPartOfWhatIsBehind)
{
  struct Pane {
    glm::vec3 color;
    float opacity;
    double z;
  };
  const std::array<Pane, 2> panes = {{{{1, 0, 0.5F}, 0.25F, 0.5}, {{0, 1, 0.5F}, 0.5F, 1.0}}};
  const auto add_pane = [&](const Pane &pane, bool is_transmissive) {
    const auto material = test::add_material(scene, pane.color);
    scene.edit(material, [&](scene::Material &one) {
      one.alpha_mode = is_transmissive ? scene::AlphaMode::Opaque : scene::AlphaMode::Blend;
      one.alpha = is_transmissive ? 1.0F : pane.opacity;
      one.transmission = is_transmissive ? 1.0F - pane.opacity : 0.0F;
      one.is_unlit = !is_transmissive;
    });
    test::add_object(scene, test::add_square_mesh(scene, material),
                     glm::scale(glm::translate(glm::dmat4(1), {0, 0, pane.z}), glm::dvec3(1.5)));
  };
  for (const bool is_transmissive : {false, true}) {
    for (const bool is_far_first : {false, true}) {
      scene = {};
      add_ground();
      test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0, 0, -1}, 1.0F);
      add_pane(panes[is_far_first ? 0 : 1], is_transmissive);
      add_pane(panes[is_far_first ? 1 : 0], is_transmissive);
      Engine engine(*render_scene);
      const test::Picture unlit = picture(engine);
      glm::vec3 expected = ground_color;
      for (const Pane &pane : panes) {
        expected = glm::mix(expected, pane.color, pane.opacity);
      }
      for (int c = 0; c < 3; c++) {
        // Tolerance for rounding to half floats after each of two blends.
        EXPECT_NEAR(unlit.at(size_px.x / 2, size_px.y / 2)[c], expected[c], 2e-3) << is_transmissive << is_far_first;
      }
      EXPECT_EQ(unlit.at(size_px.x / 2, size_px.y / 2).a, 1.0F);
      viewport->remove_engine(engine);
    }
  }
}

TEST_F(UnlitGpuTest, ABlendedSurfaceAloneHasItsAlpha)
{
  const auto material = test::add_material(scene, {1, 0.5F, 0});
  scene.edit(material, [](scene::Material &one) {
    one.alpha_mode = scene::AlphaMode::Blend;
    one.alpha = 0.25F;
  });
  test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1), glm::dvec3(3)));
  Engine engine(*render_scene);
  EXPECT_EQ(picture(engine).at(size_px.x / 2, size_px.y / 2), glm::vec4(0.25F, 0.125F, 0, 0.25F));
}

/** Seen in parallel along -Z, a line through the middles of pixels is one row of them. */
TEST_F(UnlitGpuTest, ALineIsOneRowOfPixels)
{
  const auto material = test::add_material(scene, {0.25F, 0.5F, 1});
  scene::Mesh mesh;
  const float y = 1.0F / float(size_px.y);
  mesh.positions = {{-2, y, 0}, {2, y, 0}};
  mesh.normals.assign(2, {0, 0, 1});
  mesh.indices = {0, 1};
  mesh.topology = scene::Topology::Lines;
  mesh.material = material;
  test::add_object(scene, scene.add(std::move(mesh)), glm::dmat4(1));
  camera = test::camera_at({0, 0, 5}, {0, 0, 0});
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = camera.half_height = 1.0F;
  Engine engine(*render_scene);
  const test::Picture line = picture(engine);
  for (int row = 0; row < size_px.y; row++) {
    for (int column = 0; column < size_px.x; column++) {
      EXPECT_EQ(line.at(column, row), row == size_px.y / 2 ? glm::vec4(0.25F, 0.5F, 1, 1) : glm::vec4(0))
          << column << ", " << row;
    }
  }
}

TEST_F(UnlitGpuTest, AViewportThatWasUnlitIsLitAsBefore)
{
  add_ground();
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0.3F, 0, -1}, 1.0F);
  constexpr int sample_count = 2;
  eevee::Engine lit(*render_scene, {.shadow = {.map_size_px = 64}, .sample_count = sample_count});
  Engine unlit(*render_scene);
  draw(lit, sample_count);
  const auto before = gpu::read_as<glm::vec4>(*device, lit.radiance(*viewport));
  const glm::vec4 ground = picture(unlit).middle();
  EXPECT_EQ(ground, glm::vec4(ground_color, 1));
  // A camera that moved meanwhile.
  camera = test::camera_at({1, -5, 6}, {0, 0, 0});
  draw(lit, sample_count);
  camera = test::camera_at({0, -5, 6}, {0, 0, 0});
  EXPECT_EQ(picture(unlit).middle(), ground);
  draw(lit, sample_count);
  EXPECT_EQ(gpu::read_as<glm::vec4>(*device, lit.radiance(*viewport)), before);
}

/** Without light, eevee reads no uvs of opaque surfaces, which unlit does: the meshes are made again, with uvs. */
TEST_F(UnlitGpuTest, AnEngineThatReadsMoreOfTheMeshesLeavesThePictureOfAnother)
{
  const auto material = test::add_material(scene, glm::vec3(1));
  const auto texture = test::add_texture(scene, 1, {255, 0, 0, 255});
  scene.edit(material, [&](scene::Material &one) { one.base_color_texture = texture; });
  for (int i = 0; i < 6; i++) {
    scene::Mesh mesh = scene.meshes()[test::add_square_mesh(scene, material)];
    for (glm::vec3 &position : mesh.positions) {
      position = 0.1F * float(i + 1) * position + glm::vec3(0.5F * float(i) - 1.5F, 0, 0);
    }
    test::add_object(scene, scene.add(std::move(mesh)), glm::dmat4(1));
  }
  eevee::Engine lit(*render_scene, {});
  Engine unlit(*render_scene);
  draw::Viewport other(*device, size_px);
  draw::Viewport &first = *viewport;
  const auto draw_in = [&](draw::Viewport &drawn, draw::Engine &engine) {
    const std::array<draw::Engine *, 1> engines = {&engine};
    drawn.sync(engines, render_scene->objects());
    drawn.restart();
    drawn.draw(engines, render_scene::view_of(camera, size_px));
  };
  render_scene->update();
  draw_in(first, lit);
  const auto before = gpu::read_as<glm::vec4>(*device, lit.radiance(first));
  draw_in(other, unlit);
  draw_in(first, lit);
  EXPECT_EQ(gpu::read_as<glm::vec4>(*device, lit.radiance(first)), before);
  // An object that is no longer drawn leaves the picture.
  scene.edit(test::handle_at(scene.nodes(), 0), [](scene::Node &node) { node.name = "other"; });
  render_scene->update();
  draw_in(first, lit);
  draw_in(other, unlit);
  EXPECT_EQ(gpu::read_as<glm::vec4>(*device, lit.radiance(first)), before);
  EXPECT_EQ(std::ranges::count_if(device->live(),
                                  [](const gpu::LiveResource &live) { return live.kind == gpu::ResourceKind::Batch; }),
            6);
}

}  // namespace
}  // namespace gnomon::unlit
