// SPDX-License-Identifier: MIT
// Included before the source of an example, whose calls of the library then have to leave the state of OpenGL as it
// was.
#pragma once

#include <gnomon/gnomon.hh>

#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace gnomon::test {

/**
 * Makes \a call. The program ends with status 1 if it throws, or if state of OpenGL differs after it; so it does if no
 * call is made.
 */
void expect_state_kept(const char *name, const std::function<void()> &call);
/** The same as make_host_calls, with expect_state_kept, into the framebuffer of \a target. */
void expect_state_kept_by_all_calls(const scene::Scene &scene, const draw::Target &target);
/**
 * Edits of tests/engines/scene_edits.hh, in random order. Each call of the function makes one, or takes it back, and
 * returns its name; empty: \a scene is as it was. There are 1000 calls, or 40 where slow tests are left out.
 */
std::function<std::string()> listed_edits(scene::Scene &scene);

}  // namespace gnomon::test

namespace gnomon::gpu {

inline std::unique_ptr<Device> create_checked_device(const GlDeviceDesc &desc)
{
  std::unique_ptr<Device> device;
  test::expect_state_kept("create_gl_device", [&] { device = create_gl_device(desc); });
  return device;
}

}  // namespace gnomon::gpu

namespace gnomon::eevee {

/**
 * The functions of SceneRenderer that hosts call. Before the first draw all other calls are made, and then each sync
 * follows an edit of the scene, until all edits are made and taken back.
 */
class CheckedRenderer {
 public:
  CheckedRenderer(gpu::Device &device, scene::Scene &scene, glm::ivec2 size_px, const Settings &settings)
      : scene_(scene), next_edit_(test::listed_edits(scene))
  {
    test::expect_state_kept("SceneRenderer",
                            [&] { renderer_ = std::make_unique<SceneRenderer>(device, scene, size_px, settings); });
  }
  ~CheckedRenderer()
  {
    test::expect_state_kept("~SceneRenderer", [&] { renderer_.reset(); });
  }
  CheckedRenderer(const CheckedRenderer &) = delete;
  CheckedRenderer &operator=(const CheckedRenderer &) = delete;

  void resize(glm::ivec2 size_px)
  {
    size_px_ = size_px;
  }
  void sync()
  {
    edit_ = next_edit_();
    // Few pixels for the draws with edits, which are many.
    const glm::ivec2 size_px = edit_.empty() ? size_px_ : glm::ivec2(32 + edit_.size() % 2, 18);
    test::expect_state_kept("resize", [&] { renderer_->resize(size_px); });
    test::expect_state_kept(("sync after " + edit_).c_str(), [&] { renderer_->sync(); });
  }
  bool draw_sample(const scene::PlacedCamera &camera, const draw::Target &target)
  {
    if (!std::exchange(has_drawn_, true)) {
      test::expect_state_kept_by_all_calls(scene_, target);
    }
    bool is_complete = false;
    test::expect_state_kept(("draw_sample after " + edit_).c_str(),
                            [&] { is_complete = renderer_->draw_sample(camera, target); });
    return is_complete && edit_.empty();
  }
  [[nodiscard]] render_scene::RenderScene &render_scene()
  {
    return renderer_->render_scene();
  }
  [[nodiscard]] draw::View view_of(const scene::PlacedCamera &camera) const
  {
    return renderer_->view_of(camera);
  }

 private:
  const scene::Scene &scene_;
  std::function<std::string()> next_edit_;
  std::string edit_;
  glm::ivec2 size_px_{1};
  std::unique_ptr<SceneRenderer> renderer_;
  bool has_drawn_ = false;
};

}  // namespace gnomon::eevee

#define create_gl_device create_checked_device
#define SceneRenderer CheckedRenderer
