// SPDX-License-Identifier: MIT
// Pictures in a rectangle of a host's framebuffer, within its context.
#include "unlit_engine.hh"

#include "engines/eevee/eevee_test_scene.hh"
#include "gpu/gpu_host_framebuffer.hh"
#include "gpu_read.hh"
#include "render_camera.hh"

#include <glm/gtc/matrix_transform.hpp>

namespace gnomon::unlit {
namespace {

constexpr glm::ivec2 host_size_px(37, 29);
constexpr gpu::Rectangle picture_rectangle{{7, 5}, {24, 18}};

class UnlitTarget : public test::HostFramebufferTest {};

INSTANTIATE_TEST_SUITE_P(, UnlitTarget, testing::Values(test::HostKind::Egl, test::HostKind::Glx), test::name_of_host);

TEST_P(UnlitTarget, AFramebufferThatChangesEveryFrameGetsThePictureAndKeepsTheRest)
{
  scene::Scene scene;
  const auto plain = test::add_material(scene, {0.8F, 0.5F, 0.2F});
  test::add_object(scene, test::add_square_mesh(scene, plain), glm::scale(glm::dmat4(1), glm::dvec3(2)));
  test::add_object(scene, test::add_box_mesh(scene, plain),
                   glm::scale(glm::translate(glm::dmat4(1), {0.3, 0, 0.5}), glm::dvec3(0.5)));
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0.3F, 0.5F, -1}, 3.0F);
  render_scene::RenderScene render_scene(*device, scene);
  render_scene.update();
  const draw::View view =
      render_scene::view_of(test::camera_at({0, -5, 4}, {0, 0, 0}, 0.6F), picture_rectangle.size_px);
  Engine engine(render_scene);
  const std::array<draw::Engine *, 1> engines = {&engine};
  const draw::TargetTexture display(*device, "display", gpu::Format::RGBA8, picture_rectangle.size_px);
  const auto make_viewport = [&] {
    auto viewport = std::make_unique<draw::Viewport>(*device, picture_rectangle.size_px);
    viewport->sync(engines, render_scene.objects());
    return viewport;
  };
  make_viewport()->draw(engines, view, display.target());
  const test::Pixels truth{picture_rectangle.size_px,
                           gpu::read_as<std::array<std::uint8_t, 4>>(*device, display.texture())};

  const auto viewport = make_viewport();
  std::vector<std::unique_ptr<test::HostPicture>> hosts;
  for (int frame = 0; frame < 5; frame++) {
    const bool is_srgb = frame % 2 == 0;
    const test::HostPicture &host =
        *hosts.emplace_back(is_srgb ? std::make_unique<test::HostPicture>(host_size_px, GL_SRGB8_ALPHA8, 4)
                                    : std::make_unique<test::HostPicture>(host_size_px, GL_RGBA8, 0));
    const test::Pixels before = host.pixels();
    draw::Target target;
    target.framebuffer = host.framebuffer();
    target.origin_px = picture_rectangle.origin_px;
    target.encoding = is_srgb ? draw::Encoding::SrgbFormat : draw::Encoding::Display;
    target.depth = draw::HostDepth{.clip_from_view = glm::perspectiveRH_NO(0.6, 4.0 / 3.0, 0.5, 1000.0)};
    // The last two write a picture that is complete.
    if (frame < 3) {
      viewport->draw(engines, view, target);
    }
    else {
      viewport->write(engines, target);
    }
    const test::Pixels pixels = host.pixels();
    test::expect_equal_outside(picture_rectangle, pixels, before);
    test::expect_drawn_inside(picture_rectangle, pixels, before);
    if (!is_srgb) {
      test::expect_filled_depth_outside(picture_rectangle, host.depths(), host_size_px);
    }
    for (int y = 0; y < truth.size_px.y; y++) {
      for (int x = 0; x < truth.size_px.x; x++) {
        const std::array<int, 4> expected = truth.at(x, y);
        const std::array<int, 4> found =
            pixels.at(picture_rectangle.origin_px.x + x, picture_rectangle.origin_px.y + y);
        for (std::size_t c = 0; c < 4; c++) {
          // The driver's sRGB table and the shader's formula differ by one step of 255.
          ASSERT_NEAR(found[c], expected[c], is_srgb ? 1 : 0) << x << ", " << y << ", frame " << frame;
        }
      }
    }
  }
}

}  // namespace
}  // namespace gnomon::unlit
