// SPDX-License-Identifier: MIT
#include "overlay.hh"

#include "engines/eevee/eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "gpu_read.hh"
#include "reference_tracer.hh"
#include "render_camera.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <random>

namespace gnomon::overlay {
namespace {

constexpr glm::ivec2 size_px{60, 40};
constexpr glm::vec4 line_color(1.0F, 0.5F, 0.0F, 1.0F);

class OverlayGpuTest : public test::GpuDeviceTest {
 protected:
  void SetUp() override
  {
    GpuDeviceTest::SetUp();
    if (device) {
      render_scene.emplace(*device, scene);
      overlay.emplace(*render_scene);
    }
  }
  [[nodiscard]] draw::View view() const
  {
    return render_scene::view_of(camera, size_px, render_scene->origin_ws());
  }
  std::optional<Hit> pick(int x, int y)
  {
    render_scene->update();
    return overlay->pick(view(), size_px, {x, y});
  }
  /** The node under the middle of the picture; an invalid handle: none. */
  scene::Handle<scene::Node> picked()
  {
    const std::optional<Hit> hit = pick(size_px.x / 2, size_px.y / 2);
    return hit ? hit->node : scene::Handle<scene::Node>();
  }
  /** A square that faces the camera. */
  scene::Handle<scene::Node> add_square(double z, scene::Handle<scene::Material> material, double half_size = 1.0)
  {
    const glm::dmat4 place = glm::translate(glm::dmat4(1), {0, 0, z});
    return test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(place, glm::dvec3(half_size)));
  }
  /** Colours of a target of 80x60 pixels, with the picture at 10, 15, after \a draw over transparent black. */
  template <typename Draw>
  test::Picture drawn(Draw &&draw)
  {
    render_scene->update();
    const draw::TargetTexture texture(*device, "target", gpu::Format::RGBA32F, {80, 60});
    gpu::CommandList clear;
    clear.begin_pass("clear", *std::get<const gpu::Framebuffer *>(texture.target().framebuffer), {});
    clear.end_pass();
    device->submit(clear);
    draw::Target target = texture.target();
    target.origin_px = {10, 15};
    draw(target);
    return {{80, 60}, gpu::read_as<glm::vec4>(*device, texture.texture())};
  }
  test::Picture outline(std::span<const scene::Handle<scene::Node>> nodes)
  {
    return drawn(
        [&](const draw::Target &target) { overlay->draw_outline(view(), size_px, nodes, line_color, target); });
  }
  test::Picture lines(const std::vector<Line> &lines)
  {
    return drawn([&](const draw::Target &target) { overlay->draw_lines(view(), size_px, lines, target); });
  }
  /** Where the camera sees a point, in pixels of the target. */
  [[nodiscard]] glm::dvec2 seen(const glm::dvec3 &position_ws) const
  {
    const glm::dvec4 clip = glm::dmat4(view().clip_from_world()) * glm::dvec4(position_ws, 1.0);
    return glm::dvec2(10, 15) + (0.5 * glm::dvec2(clip) / clip.w + 0.5) * glm::dvec2(size_px);
  }

  scene::Scene scene;
  scene::PlacedCamera camera = test::camera_at({0, 0, 5}, {0, 0, 0});
  std::optional<render_scene::RenderScene> render_scene;
  std::optional<Overlay> overlay;
};

TEST_F(OverlayGpuTest, EachPixelPicksTheObjectAndPositionThatItsRayMeetsFirst)
{
  // Far from the world's origin, so that positions need it.
  const glm::dvec3 middle(40000, 0, -2000);
  camera = test::camera_at({}, {});
  camera.world_from_camera = glm::inverse(glm::lookAt(middle + glm::dvec3(3, 4, 6), middle, glm::dvec3(0, 1, 0)));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> range(-1.0, 1.0);
  const auto two_sided = test::add_material(scene, glm::vec3(0.5F));
  const auto one_sided = test::add_material(scene, glm::vec3(0.5F));
  test::edit_material(scene, 1, [](scene::Material &material) { material.is_double_sided = false; });
  for (int i = 0; i < 40; i++) {
    const auto material = i % 2 == 0 ? two_sided : one_sided;
    const auto mesh = i % 4 < 2 ? test::add_box_mesh(scene, material) : test::add_square_mesh(scene, material);
    glm::dmat4 place =
        glm::translate(glm::dmat4(1), middle + 2.5 * glm::dvec3(range(random), range(random), range(random)));
    place = glm::rotate(place, 3.0 * range(random), glm::normalize(glm::dvec3(range(random), range(random), 0.1)));
    // Every third is mirrored.
    place = glm::scale(place, glm::dvec3(i % 3 == 0 ? -0.6 : 0.6, 0.3, 0.5));
    const auto node = test::add_object(scene, mesh, place);
    if (i % 8 == 7) {
      scene.edit(node, [](scene::Node &hidden) { hidden.is_visible = false; });
    }
  }
  render_scene->set_origin(render_scene::origin_near(middle, glm::dvec3(0)));
  const reference::Tracer tracer(scene);
  const std::vector<scene::Object> objects = scene.objects();
  const glm::dmat4 world_from_clip =
      glm::dmat4(camera.world_from_camera) * glm::inverse(glm::dmat4(view().clip_from_view()));
  const glm::dvec3 eye(camera.world_from_camera[3]);
  int hit_count = 0;
  int miss_count = 0;
  for (int y = 0; y < size_px.y; y += 3) {
    for (int x = 0; x < size_px.x; x += 3) {
      const glm::dvec2 ndc = 2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(size_px) - 1.0;
      const glm::dvec4 near = world_from_clip * glm::dvec4(ndc, 1.0, 1.0);
      const auto expected = tracer.closest(
          {.origin_ws = eye, .direction_ws = glm::dvec3(near) / near.w - eye, .t_min = 1.0}, reference::Faces::Drawn);
      const std::optional<Hit> hit = pick(x, y);
      ASSERT_EQ(hit.has_value(), expected.has_value()) << x << ", " << y;
      (hit ? hit_count : miss_count)++;
      if (hit) {
        const reference::Surface surface = tracer.surface_at(*expected);
        EXPECT_EQ(hit->node, objects[surface.object].node) << x << ", " << y;
        EXPECT_EQ(hit->mesh, objects[surface.object].mesh) << x << ", " << y;
        // Matrices relative to the origin are floats, at up to 1024 m: 6e-5 m.
        EXPECT_LT(glm::distance(hit->position_ws, surface.position_ws), 1e-3) << x << ", " << y;
      }
    }
  }
  EXPECT_GT(hit_count, 50);
  EXPECT_GT(miss_count, 50);
}

TEST_F(OverlayGpuTest, WhatAMaskCutsOutAndHiddenNodesLetThePixelThrough)
{
  const auto plain = test::add_material(scene, glm::vec3(0.5F));
  const auto back = add_square(-1, plain);
  const auto masked = test::add_material(scene, glm::vec3(0.5F));
  const std::vector<std::uint8_t> hole_on_the_left = {255, 255, 255, 0, 255, 255, 255, 255};
  scene.edit(masked, [&](scene::Material &material) {
    material.base_color_texture = {test::add_texture(scene, 2, hole_on_the_left)};
    material.alpha_mode = scene::AlphaMode::Mask;
  });
  const auto front = add_square(0, masked);
  EXPECT_EQ(pick(size_px.x / 2 - 3, size_px.y / 2)->node, back);
  EXPECT_EQ(pick(size_px.x / 2 + 3, size_px.y / 2)->node, front);
  // A transform of the uvs makes the material a full one, which reads other inputs.
  scene.edit(masked, [](scene::Material &material) { material.base_color_texture.offset.x = 0.5F; });
  EXPECT_EQ(pick(size_px.x / 2 - 3, size_px.y / 2)->node, front);
  EXPECT_EQ(pick(size_px.x / 2 + 3, size_px.y / 2)->node, back);

  scene.edit(front, [](scene::Node &node) { node.is_visible = false; });
  EXPECT_EQ(picked(), back);
  scene.edit(back, [](scene::Node &node) { node.is_visible = false; });
  EXPECT_EQ(picked(), scene::Handle<scene::Node>());
}

TEST_F(OverlayGpuTest, PixelsOutsideOfThePictureHaveNothingAndEditsWithoutAnUpdateAreAnError)
{
  const auto square = add_square(0, test::add_material(scene, glm::vec3(0.5F)), 100.0);
  for (const glm::ivec2 pixel : {glm::ivec2(0, 0), size_px - 1}) {
    EXPECT_EQ(pick(pixel.x, pixel.y)->node, square);
  }
  for (const glm::ivec2 pixel :
       {glm::ivec2(-1, 5), glm::ivec2(5, -1), glm::ivec2(size_px.x, 5), glm::ivec2(5, size_px.y)}) {
    EXPECT_FALSE(pick(pixel.x, pixel.y)) << pixel.x << ", " << pixel.y;
  }
  scene.remove(square);
  EXPECT_THROW(static_cast<void>(overlay->pick(view(), size_px, {5, 5})), gpu::Error);
  EXPECT_FALSE(pick(5, 5));
}

TEST_F(OverlayGpuTest, NothingIsMadeBeforeAPixelCanSeeAnObject)
{
  const auto node = add_square(0, test::add_material(scene, glm::vec3(0.5F)), 0.1);
  EXPECT_FALSE(pick(0, 0));
  outline({});
  EXPECT_EQ(device->counters().shaders_made, 0U);
  EXPECT_EQ(device->memory_bytes(), 0U);
  EXPECT_EQ(picked(), node);
  EXPECT_EQ(device->counters().shaders_made, 1U);
}

TEST_F(OverlayGpuTest, AnOutlineFollowsTheEdgeOfTheSelectedObjectAloneAlsoWhereAnotherHidesIt)
{
  const auto material = test::add_material(scene, glm::vec3(0.5F));
  const auto square = add_square(0, material);
  add_square(1, material, 0.9);
  const test::Picture picture = outline(std::span(&square, 1));
  // Half the square's edge in pixels: 1 m at 5 m, with 20 pixels for the tangent of half the angle.
  const double half_px = 20.0 / (5.0 * std::tan(0.5 * double(camera.vertical_angle)));
  const glm::dvec2 middle = glm::dvec2(10, 15) + 0.5 * glm::dvec2(size_px);
  int line_count = 0;
  for (int y = 0; y < 60; y++) {
    for (int x = 0; x < 80; x++) {
      const glm::dvec2 from_middle = glm::abs(glm::dvec2(x, y) + 0.5 - middle);
      const double from_edge = std::max(from_middle.x, from_middle.y) - half_px;
      const glm::vec4 pixel = picture.at(x, y);
      // A line of two whole pixels at each side of the edge, the outer ones of half the strength.
      if (std::abs(from_edge) > 2.5) {
        EXPECT_EQ(pixel, glm::vec4(0)) << x << ", " << y;
      }
      else if (std::abs(from_edge) < 0.4 && std::min(from_middle.x, from_middle.y) < half_px - 3.0) {
        EXPECT_EQ(pixel, line_color) << x << ", " << y;
        line_count++;
      }
    }
  }
  EXPECT_GT(line_count, 20);
}

TEST_F(OverlayGpuTest, AnOutlineEndsAtTheEdgeOfThePicture)
{
  const auto square = add_square(0, test::add_material(scene, glm::vec3(0.5F)), 100.0);
  for (const glm::vec4 &pixel : outline(std::span(&square, 1)).pixels) {
    EXPECT_EQ(pixel, glm::vec4(0)) << "all of the picture is inside of the object";
  }
}

TEST_F(OverlayGpuTest, ALineHasItsColorAndItsWidthOnTheScreenAtEveryDistanceBetweenItsEnds)
{
  for (const double z : {0.0, 2.5}) {
    for (const float width : {1.0F, 3.0F}) {
      const Line line{{-0.7, 0.3, z}, {0.6, 0.3, z}, line_color, width};
      const test::Picture picture = lines({line});
      const glm::dvec2 from = seen(line.from_ws);
      const glm::dvec2 to = seen(line.to_ws);
      ASSERT_GT(to.x - from.x, 8.0);
      for (int x = 0; x < 80; x++) {
        double covered_px = 0.0;
        for (int y = 0; y < 60; y++) {
          const glm::vec4 pixel = picture.at(x, y);
          covered_px += double(pixel.a);
          EXPECT_EQ(glm::vec3(pixel), pixel.a * glm::vec3(line_color));
          EXPECT_TRUE(pixel.a == 0.0F || std::abs(y + 0.5 - from.y) <= 0.5 * double(width) + 1.0) << x << ", " << y;
        }
        if (x + 0.5 > from.x && x + 0.5 < to.x) {
          EXPECT_NEAR(covered_px, double(width), 1e-3) << x;
        }
        else {
          EXPECT_EQ(covered_px, 0.0) << x;
        }
      }
    }
  }
}

TEST_F(OverlayGpuTest, ObjectsHideLinesBehindThemThatAreNotOnTop)
{
  const auto square = add_square(0, test::add_material(scene, glm::vec3(0.5F)), 0.5);
  const auto line = [](double z, bool is_on_top) {
    return Line{{-0.9, 0, z}, {0.9, 0, z}, line_color, 1.0F, is_on_top};
  };
  const auto middle = [&](const test::Picture &picture) { return picture.at(10 + 30, 15 + 20).a; };
  const auto beside = [&](const test::Picture &picture) { return picture.at(int(seen({-0.8, 0, 0}).x), 15 + 20).a; };
  const test::Picture behind = lines({line(-0.1, false)});
  EXPECT_EQ(middle(behind), 0.0F);
  EXPECT_GT(beside(behind), 0.4F);
  EXPECT_GT(middle(lines({line(0.1, false)})), 0.4F) << "before the object";
  EXPECT_GT(middle(lines({line(0.0, false)})), 0.4F) << "on the object";
  EXPECT_GT(middle(lines({line(-0.1, true)})), 0.4F) << "on top";
  // Draw both kinds of lines in one call.
  EXPECT_GT(middle(lines({line(-0.1, true), line(-0.2, false)})), 0.4F);
  // The overlay uses the current state of the objects.
  scene.set_transform(square, glm::translate(glm::dmat4(1), {0, 5, 0}));
  EXPECT_GT(middle(lines({line(-0.1, false)})), 0.4F) << "the object has moved";
}

TEST_F(OverlayGpuTest, ALineThatBeginsBehindTheEyeIsDrawnFromTheNearPlaneOn)
{
  // Below the eye, from behind it to far away: it comes from the lower edge and ends near the middle.
  const test::Picture picture = lines({{{0, -0.5, 20}, {0, -0.5, -400}, line_color, 2.0F}});
  const int end_y = int(seen({0, -0.5, -400}).y);
  for (int y = 0; y < 60; y++) {
    const float alpha = picture.at(10 + 30, y).a;
    if (y >= 15 && y < end_y - 1) {
      EXPECT_GT(alpha, 0.9F) << y;
    }
    else if (y < 15 || y > end_y + 1) {
      EXPECT_EQ(alpha, 0.0F) << y;
    }
  }
  for (const glm::vec4 &pixel : lines({{{1, 0, 20}, {-1, 0, 7}, line_color, 2.0F}}).pixels) {
    EXPECT_EQ(pixel, glm::vec4(0)) << "all of it is behind the eye";
  }
}

TEST_F(OverlayGpuTest, NothingIsMadeWithoutLinesAndLinesOnTopDrawNoObject)
{
  add_square(0, test::add_material(scene, glm::vec3(0.5F)));
  // Drawing without lines creates nothing.
  lines({});
  EXPECT_EQ(device->counters().shaders_made, 0U);
  EXPECT_EQ(device->memory_bytes(), 0U);
  lines({{{-1, 0, 0}, {1, 0, 0}, line_color, 1.0F, true}});
  EXPECT_EQ(device->counters().shaders_made, 1U);
  EXPECT_FALSE(device->pass_counts().contains("overlay objects"));
  // Objects are drawn for the first picture alone.
  for (int i = 0; i < 3; i++) {
    lines({{{-1, 0, 0}, {1, 0, 0}}});
  }
  EXPECT_EQ(device->pass_counts().at("overlay objects"), 1U);
}

TEST_F(OverlayGpuTest, LinesThatAreNotFiniteOrHaveNoWidthAreNamed)
{
  for (const Line &wrong : {Line{{NAN, 0, 0}, {1, 0, 0}}, Line{{0, 0, 0}, {1, INFINITY, 0}},
                            Line{{0, 0, 0}, {1, 0, 0}, line_color, 0.0F}}) {
    try {
      lines({{{0, 0, 0}, {1, 0, 0}}, wrong});
      ADD_FAILURE();
    }
    catch (const gpu::Error &error) {
      EXPECT_NE(std::string_view(error.what()).find("line 1 "), std::string_view::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace gnomon::overlay
