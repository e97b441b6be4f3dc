// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"

#include <functional>

namespace gnomon::eevee {

/**
 * Renders a scene on a device: the scene's resources there, one engine, one viewport, and the order of calls that makes
 * a picture with them. For programs that need no other arrangement.
 *
 * The scene may be edited between any two calls; sync takes note of the edits. A program renders on the device's thread
 * by sync and draw, or on two threads: one edits the scene and calls prepare, the device's thread submits the packets.
 */
class SceneRenderer {
 public:
  /**
   * \a device and \a scene must outlive the renderer. Call sync before the first draw.
   * \throws gpu::Error where \a size_px is not one that the device can draw.
   */
  SceneRenderer(gpu::Device &device, const scene::Scene &scene, glm::ivec2 size_px, const Settings &settings = {})
      : render_scene_(device, scene), engine_(render_scene_, settings), viewport_(device, size_px), settings_(settings)
  {
  }

  /** Take note of edits of the scene and of other settings. \throws gpu::Error naming what cannot be drawn. */
  void sync();
  /** Other settings, from the next sync on. */
  void set_settings(const Settings &settings)
  {
    settings_ = settings;
    is_synced_ = false;
    engine_.set_settings(settings);
  }
  /** Another size, from the next sync on. \throws gpu::Error as the constructor; then nothing changes. */
  void resize(glm::ivec2 size_px)
  {
    viewport_.resize(size_px);
    is_synced_ = false;
  }

  /**
   * Take note of edits, if there are any, and record the next sample of the picture that \a camera sees, for
   * gpu::Device::submit on the device's thread; otherwise as draw_sample. Needs no device, and may be called on another
   * thread. Uses the feedback of \a packet's last submission, so that cascades that are fitted to depths follow the
   * camera some frames late. The framebuffer of \a target must live until the submission.
   */
  bool prepare(gpu::Packet &packet, const scene::PlacedCamera &camera, const draw::Target &target = {});
  /**
   * Draw the next sample of the picture that \a camera sees, if it needs more, and write the picture so far to
   * \a target. The picture begins anew when the camera or anything that sync takes note of changes: a host calls this
   * once a frame. \return whether the picture is complete, so that further calls would change nothing
   */
  bool draw_sample(const scene::PlacedCamera &camera, const draw::Target &target = {});
  /** Called after each sample with the samples drawn so far; false: draw no more. May be empty. */
  using Progress = std::function<bool(int samples_drawn)>;
  /**
   * Draw all samples of a picture anew and write it to \a target.
   * \return whether it is whole: \a progress stopped it otherwise, and the target is as it was
   */
  bool draw(const scene::PlacedCamera &camera, const Progress &progress = {}, const draw::Target &target = {});

  /** What \a camera sees, in the coordinates of the render scene. */
  [[nodiscard]] draw::View view_of(const scene::PlacedCamera &camera) const;
  [[nodiscard]] const Settings &settings() const
  {
    return settings_;
  }
  [[nodiscard]] render_scene::RenderScene &render_scene()
  {
    return render_scene_;
  }
  [[nodiscard]] Engine &engine()
  {
    return engine_;
  }
  [[nodiscard]] draw::Viewport &viewport()
  {
    return viewport_;
  }

 private:
  render_scene::RenderScene render_scene_;
  Engine engine_;
  draw::Viewport viewport_;
  Settings settings_;
  /** No settings and no size were given since the last sync, and it came to its end. */
  bool is_synced_ = false;
};

}  // namespace gnomon::eevee
