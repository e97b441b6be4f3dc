// SPDX-License-Identifier: MIT
// Edges of triangles instead of surfaces, and half-transparent surfaces (x-ray).
#include "overlay.hh"

#include "draw_target.hh"
#include "engines/eevee/eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "gpu_read.hh"
#include "render_camera.hh"
#include "unlit_engine.hh"

#include <glm/gtc/matrix_transform.hpp>

namespace gnomon::overlay {
namespace {

using Pixels = std::vector<glm::vec4>;

/** Two boxes behind each other. */
class WireframeTest : public test::SharedDeviceTest {
 protected:
  static constexpr glm::ivec2 size_px{80, 60};
  /** Each pixel whose middle is at most so far from an edge is drawn: half a pixel along an axis, for any slope. */
  static constexpr double near = 0.3;

  void SetUp() override
  {
    test::SharedDeviceTest::SetUp();
    if (!device) {
      return;
    }
    const auto material = test::add_material(scene, {0.8F, 0.5F, 0.2F});
    scene.edit(material, [](scene::Material &one) { one.is_double_sided = false; });
    const auto mesh = test::add_box_mesh(scene, material);
    const auto at = [](const glm::dvec3 &position, double size) {
      return glm::scale(glm::translate(glm::dmat4(1), position), glm::dvec3(size));
    };
    front = test::add_object(scene, mesh, at({0, 0, 0}, 0.5));
    back = test::add_object(scene, mesh, at({0.3, 0.2, -3}, 1.0));
    shared.emplace(*device, scene);
    shared->update();
  }
  draw::View view()
  {
    return render_scene::view_of(camera, size_px, shared->origin_ws());
  }
  Pixels unlit_picture(unlit::Engine &engine, draw::Viewport &viewport, const unlit::Display &display)
  {
    draw::Engine *one = &engine;
    engine.set_display(viewport, display);
    viewport.sync(std::span(&one, 1), shared->objects());
    const draw::TargetTexture texture(*device, "target", gpu::Format::RGBA32F, size_px);
    draw::Target target = texture.target();
    target.encoding = draw::Encoding::SceneLinear;
    viewport.draw(std::span(&one, 1), view(), target);
    return gpu::read_as<glm::vec4>(*device, texture.texture());
  }
  /** Distance of the middle of a pixel to the nearest edge of a triangle of \a node on the screen, pixels. */
  double distance_to_edge(scene::Handle<scene::Node> node, glm::ivec2 pixel_px)
  {
    const scene::Mesh &mesh = scene.meshes()[scene.nodes()[node].meshes.front()];
    const glm::dmat4 clip_from_object = glm::dmat4(view().clip_from_world()) * scene.world_from_node(node);
    const auto place = [&](std::size_t corner) {
      const glm::dvec4 clip = clip_from_object * glm::dvec4(mesh.positions[mesh.indices[corner]], 1.0);
      return (0.5 * glm::dvec2(clip) / clip.w + 0.5) * glm::dvec2(size_px);
    };
    const glm::dvec2 middle = glm::dvec2(pixel_px) + 0.5;
    double least = 1e9;
    for (std::size_t i = 0; i < mesh.indices.size(); i++) {
      const glm::dvec2 from = place(i);
      const glm::dvec2 way = place(i - i % 3 + (i + 1) % 3) - from;
      const double along = std::clamp(glm::dot(middle - from, way) / std::max(glm::dot(way, way), 1e-9), 0.0, 1.0);
      least = std::min(least, glm::distance(middle, from + along * way));
    }
    return least;
  }
  /** Calls \a visit with each pixel and its index. */
  template <typename Visit>
  static void for_each_pixel(Visit &&visit)
  {
    for (int y = 0; y < size_px.y; y++) {
      for (int x = 0; x < size_px.x; x++) {
        visit(glm::ivec2(x, y), std::size_t(y * size_px.x + x));
      }
    }
  }

  scene::Scene scene;
  scene::Handle<scene::Node> front, back;
  scene::PlacedCamera camera = test::camera_at({1.2, 1, 4}, {0, 0, 0});
  std::optional<render_scene::RenderScene> shared;
};

TEST_F(WireframeTest, UnlitShowsEdgesAndLooksThroughSurfaces)
{
  unlit::Engine engine(*shared);
  draw::Viewport viewport(*device, size_px);
  draw::Viewport other(*device, size_px);
  const Pixels solid = unlit_picture(engine, other, {});
  const Pixels edges = unlit_picture(engine, viewport, {.is_wireframe = true});
  const Pixels xray = unlit_picture(engine, viewport, {.is_xray = true});
  EXPECT_EQ(unlit_picture(engine, viewport, {}), solid);
  EXPECT_EQ(unlit_picture(engine, other, {}), solid) << "another viewport of the engine";
  Overlay overlay(*shared);
  const draw::View without_front = view().with_hidden(shared->hidden_objects(std::array{front}));
  int two = 0;
  int differing = 0;
  for_each_pixel([&](glm::ivec2 pixel, std::size_t i) {
    const double distance = std::min(distance_to_edge(front, pixel), distance_to_edge(back, pixel));
    EXPECT_TRUE(edges[i].a > 0.0F ? distance <= 1.0 : distance > near) << pixel.x << ' ' << pixel.y;
    const auto hit = overlay.pick(view(), size_px, pixel);
    const int layers =
        (hit ? 1 : 0) + (hit && hit->node == front && overlay.pick(without_front, size_px, pixel) ? 1 : 0);
    // A pick of a pixel rounds otherwise at the outline of a box.
    differing += std::abs(xray[i].a - (1.0F - std::pow(0.5F, float(layers)))) > 1e-3F ? 1 : 0;
    EXPECT_NEAR(xray[i].r, solid[i].r * xray[i].a, 1e-2F) << "both boxes have one colour";
    two += layers == 2 ? 1 : 0;
  });
  EXPECT_GT(two, 100);
  EXPECT_LE(differing, 2);
}

}  // namespace
}  // namespace gnomon::overlay
