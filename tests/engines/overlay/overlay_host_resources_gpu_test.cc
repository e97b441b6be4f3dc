// SPDX-License-Identifier: MIT
#include "overlay.hh"

#include "engines/eevee/eevee_test_scene.hh"
#include "engines/host_mesh.hh"
#include "gpu/gpu_host_framebuffer.hh"
#include "gpu/gpu_testing.hh"
#include "gpu_read.hh"
#include "render_camera.hh"

#include <glm/gtc/matrix_transform.hpp>

namespace gnomon::overlay {
namespace {

class OverlayHostResourcesTest : public test::HostFramebufferTest {};

INSTANTIATE_TEST_SUITE_P(, OverlayHostResourcesTest, testing::Values(test::HostKind::Egl), test::name_of_host);

TEST_P(OverlayHostResourcesTest, MeshesInTheHostsBuffersArePickedAndHideLines)
{
  constexpr glm::ivec2 size_px{32, 24};
  scene::Scene scene;
  const auto square = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F)));
  const auto node = test::add_object(scene, square, glm::dmat4(1));
  const scene::Mesh before = scene.meshes()[square];
  const test::HostMesh host_square(before);
  scene.replace(square, test::without_vertices(before));
  render_scene::RenderScene render_scene(*device, scene);
  Overlay overlay(render_scene);
  const draw::View view = render_scene::view_of(test::camera_at({0, 0, 6}, {0, 0, 0}), size_px);
  const auto picked = [&] {
    render_scene.update();
    const std::optional<Hit> hit = overlay.pick(view, size_px, size_px / 2);
    EXPECT_FALSE(hit && hit->triangle) << "the CPU does not know the triangles";
    return hit ? hit->node : scene::Handle<scene::Node>();
  };
  // A line behind the square.
  const auto seen_pixels = [&] {
    render_scene.update();
    const draw::TargetTexture texture(*device, "target", gpu::Format::RGBA32F, size_px);
    gpu::CommandList clear;
    clear.begin_pass("clear", *std::get<const gpu::Framebuffer *>(texture.target().framebuffer), {});
    clear.end_pass();
    device->submit(clear);
    const Line line{
        .from_ws = {-0.9, 0, -1}, .to_ws = {0.9, 0, -1}, .color = {1, 1, 1, 1}, .width_px = 3.0F, .is_on_top = false};
    overlay.draw_lines(view, size_px, {&line, 1}, texture.target());
    int count = 0;
    for (const glm::vec4 &pixel : gpu::read_as<glm::vec4>(*device, texture.texture())) {
      count += pixel.a > 0.5F ? 1 : 0;
    }
    return count;
  };
  EXPECT_FALSE(picked());
  EXPECT_GT(seen_pixels(), 5);
  render_scene.set_host_batch(square, host_square.batch);
  test::expect_contains(test::error_of([&] {
                          static_cast<void>(overlay.pick(view, size_px, {0, 0}));
                        }),
                        "the scene is not up to date");
  EXPECT_EQ(picked(), node);
  EXPECT_EQ(seen_pixels(), 0);
  // With other content, the square hides nothing.
  scene::Mesh far_away = before;
  for (glm::vec3 &position : far_away.positions) {
    position.x += 100.0F;
  }
  host_square.write(far_away);
  render_scene.set_host_batch(square, host_square.batch);
  EXPECT_GT(seen_pixels(), 5);
  EXPECT_FALSE(picked());
}

}  // namespace
}  // namespace gnomon::overlay
