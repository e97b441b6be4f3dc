// SPDX-License-Identifier: MIT
#include "unlit_engine.hh"

#include "engines/eevee/eevee_test_scene.hh"
#include "engines/host_mesh.hh"
#include "gpu/gpu_host_framebuffer.hh"
#include "gpu_read.hh"
#include "render_camera.hh"

#include <glm/gtc/matrix_transform.hpp>

namespace gnomon::unlit {
namespace {

class UnlitHostResourcesTest : public test::HostFramebufferTest {};

INSTANTIATE_TEST_SUITE_P(, UnlitHostResourcesTest, testing::Values(test::HostKind::Egl), test::name_of_host);

TEST_P(UnlitHostResourcesTest, AMeshInTheHostsBuffersAndItsShadowAreThoseOfAnUploadedOne)
{
  constexpr glm::ivec2 size_px{32, 24};
  scene::Scene scene;
  const auto material = test::add_material(scene, {0.75F, 0.5F, 0.25F});
  const auto square = test::add_square_mesh(scene, material);
  const auto box = test::add_box_mesh(scene, material);
  test::add_object(scene, square, glm::scale(glm::dmat4(1), glm::dvec3(3)));
  test::add_object(scene, box, glm::scale(glm::translate(glm::dmat4(1), {0, 0, 1}), glm::dvec3(0.4)));
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0.3F, 0.5F, -1}, 2.0F);
  const scene::PlacedCamera camera = test::camera_at({0, -5, 6}, {0, 0, 0});

  render_scene::RenderScene render_scene(*device, scene);
  draw::Viewport viewport(*device, size_px);
  Engine engine(render_scene);
  const auto drawn = [&] {
    render_scene.update();
    const std::array<draw::Engine *, 1> engines = {&engine};
    viewport.sync(engines, render_scene.objects());
    viewport.draw(engines, render_scene::view_of(camera, size_px));
    return gpu::read_as<std::uint64_t>(*device, engine.radiance(viewport));
  };
  const std::vector<std::uint64_t> truth = drawn();
  const scene::Mesh before = scene.meshes()[box];
  const test::HostMesh host_box(before);
  scene.replace(box, test::without_vertices(before));
  const std::vector<std::uint64_t> without = drawn();
  EXPECT_NE(without, truth);
  render_scene.set_host_batch(box, host_box.batch);
  EXPECT_EQ(drawn(), truth);
  // The depth camera sees the new content, too.
  scene::Mesh smaller = before;
  for (glm::vec3 &position : smaller.positions) {
    position *= 0.5F;
  }
  host_box.write(smaller);
  render_scene.set_host_batch(box, host_box.batch);
  const std::vector<std::uint64_t> other = drawn();
  host_box.write(before);
  render_scene.set_host_batch(box, host_box.batch);
  EXPECT_EQ(drawn(), truth);
  EXPECT_NE(other, truth);
  EXPECT_NE(other, without);
}

}  // namespace
}  // namespace gnomon::unlit
