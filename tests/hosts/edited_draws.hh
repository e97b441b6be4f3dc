// SPDX-License-Identifier: MIT
#pragma once

#include "hosts/checked_renderer.hh"

#include <memory>

namespace gnomon::test {

/**
 * The picture of a scene in the framebuffer of a host, by CheckedRenderer. Created and destroyed in any context; the
 * other functions are called in the host's, and so is release().
 */
class EditedDraws {
 public:
  explicit EditedDraws(const char *scene_path) : scene_(gltf::import_gltf(scene_path)) {}

  /** One draw. \return whether it was the last one: the framebuffer has the complete picture */
  bool draw(const gpu::HostFramebuffer &framebuffer)
  {
    if (!renderer_) {
      device_ = gpu::create_gl_device({.context = gpu::ContextKind::Host});
      renderer_ = std::make_unique<eevee::SceneRenderer>(*device_, scene_, framebuffer.size_px,
                                                         eevee::Settings{.sample_count = 8});
    }
    renderer_->resize(framebuffer.size_px);
    renderer_->sync();
    return renderer_->draw_sample(scene_.placed_cameras().front(), {.framebuffer = framebuffer});
  }
  void release()
  {
    renderer_.reset();
    expect_state_kept("~Device", [&] { device_.reset(); });
  }

 private:
  scene::Scene scene_;
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<eevee::SceneRenderer> renderer_;
};

}  // namespace gnomon::test
