// SPDX-License-Identifier: MIT
// The draws of a host that edits its scene, for hosts of several toolkits.
#pragma once

#include "hosts/checked_renderer.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <memory>
#include <vector>

namespace gnomon::test {

/**
 * Draws a scene into the framebuffer of a host, with an edit before each draw, and then the picture of the scene as it
 * was. Each call of the library must leave the state of OpenGL as it was. Created and destroyed in any context; the
 * other functions are called in the host's, and so is release().
 */
class EditedDraws {
 public:
  static constexpr int edit_count = 1000;
  static constexpr int sample_count = 8;

  explicit EditedDraws(const char *scene_path)
      : scene_(gltf::import_gltf(scene_path)),
        lamp_(scene_.placed_lamps().front().node),
        material_(scene_.meshes()[scene_.objects().front().mesh].material),
        lamp_place_(scene_.nodes()[lamp_].parent_from_node),
        roughness_(scene_.materials()[material_].roughness)
  {
  }

  /** One draw. \return whether it was the last one: the framebuffer has the complete picture */
  bool draw(const gpu::HostFramebuffer &framebuffer)
  {
    if (!renderer_) {
      device_ = gpu::create_gl_device({.context = gpu::ContextKind::Host});
      renderer_ = std::make_unique<eevee::SceneRenderer>(*device_, scene_, framebuffer.size_px,
                                                         eevee::Settings{.sample_count = sample_count});
    }
    const bool is_edited = draw_count_ < edit_count;
    if (draw_count_ <= edit_count) {
      edit(is_edited ? std::sin(0.1 * draw_count_) : 0.0);
    }
    // Few pixels for the draws with edits, which are many.
    renderer_->resize(is_edited ? glm::ivec2(32 + draw_count_ / 100, 18) : framebuffer.size_px);
    renderer_->sync();
    draw_count_++;
    return renderer_->draw_sample(scene_.placed_cameras().front(), {.framebuffer = framebuffer}) && !is_edited;
  }
  void release()
  {
    renderer_.reset();
    expect_state_kept("~Device", [&] { device_.reset(); });
  }

 private:
  /** \a amount 0: as in the file. */
  void edit(double amount)
  {
    if (draw_count_ % 2 == 0 || amount == 0.0) {
      scene_.set_transform(lamp_, glm::translate(glm::dmat4(1), {0.2 * amount, 0, 0}) * lamp_place_);
    }
    if (draw_count_ % 2 == 1 || amount == 0.0) {
      scene_.edit(material_, [&](scene::Material &material) {
        material.roughness = roughness_ * float(1.0 - 0.5 * std::abs(amount));
      });
    }
  }

  scene::Scene scene_;
  scene::Handle<scene::Node> lamp_;
  scene::Handle<scene::Material> material_;
  glm::dmat4 lamp_place_;
  float roughness_;
  int draw_count_ = 0;
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<eevee::SceneRenderer> renderer_;
};

}  // namespace gnomon::test
