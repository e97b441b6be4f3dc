// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_budgeted_picture.hh"
#include "eevee_inspection.hh"

#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace gnomon::eevee {

/**
 * Poses a moving scene for one sample, and returns the camera of that time. \a place: of the sample in the time for
 * which the shutter is open, from 0 to below 1.
 */
using Pose = std::function<scene::PlacedCamera(double place)>;

/** Limits that end a picture before it has all its samples. It gets at least one sample, whatever the limits are. */
struct DrawLimits {
  /** Called after each sample with the number of samples drawn. Returns false to end the picture. May be empty. */
  std::function<bool(int samples_drawn)> progress{};
  /**
   * Maximum wall time, seconds. No further sample is drawn if it would exceed this time, estimated from the time of
   * the last sample. If the value is finite, draw waits for the device after each sample.
   */
  double seconds_max = std::numeric_limits<double>::infinity();
};

/**
 * Renders a scene on a device. It owns the resources of the scene on the device, one engine and one viewport, and makes
 * their calls in the required order. Programs with several engines or viewports use these classes directly.
 *
 * The scene may be edited between any two calls; sync applies the edits. prepare and draw_within call sync themselves
 * if it is necessary. Before draw_sample and draw, the caller must call it. A program either draws on the device's
 * thread, or uses two threads: one edits the scene and calls prepare, and the device's thread submits the packets.
 */
class SceneRenderer {
 public:
  /**
   * \a device and \a scene must outlive the renderer. Call sync before the first draw.
   * \throws gpu::Error if the device does not support pictures of \a size_px.
   */
  SceneRenderer(gpu::Device &device, const scene::Scene &scene, glm::ivec2 size_px, const Settings &settings = {})
      : trim_{device},
        render_scene_(device, scene),
        engine_(render_scene_, settings),
        viewport_(device, size_px),
        settings_(settings)
  {
  }

  /** Apply edits of the scene and new settings. \throws gpu::Error that names the cause if they cannot be drawn. */
  void sync();
  /** Set other settings. They take effect with the next sync. */
  void set_settings(const Settings &settings)
  {
    settings_ = settings;
    is_synced_ = false;
    engine_.set_settings(settings);
  }
  /** Set another size, effective with the next sync. \throws gpu::Error as the constructor; nothing changes then. */
  void resize(glm::ivec2 size_px)
  {
    viewport_.resize(size_px);
    is_synced_ = false;
  }

  /**
   * Sync if necessary, and record the calls of draw_sample into \a packet, for gpu::Device::submit on the device's
   * thread. This function does not call the graphics API, and may be called on another thread. It takes the feedback of
   * the last submission of \a packet, so that cascades that are fitted to depths follow the camera some frames later.
   * The framebuffer of \a target must live until the submission.
   * \return as draw_sample \throws gpu::Error as sync and draw_sample, but not for a missing sync
   */
  bool prepare(gpu::Packet &packet, const scene::PlacedCamera &camera, const draw::Target &target = {});
  /**
   * Draw the next sample of the picture of \a camera, unless the picture is complete, and write the mean of its samples
   * to \a target. The picture restarts if the camera changes or if sync applies a change. A host calls this function
   * once per frame. \return whether the picture is complete, so that further calls would not change it
   * \throws gpu::Error if a sync is missing: after the scene, the settings or the size changed, or after a sync failed
   */
  bool draw_sample(const scene::PlacedCamera &camera, const draw::Target &target = {});
  /**
   * The same as draw_sample, within a time: the first call after an edit or a change of the camera draws a whole
   * picture, in a lower resolution and with smaller shadows if the budget requires it; later calls draw parts of
   * samples, or several samples. The complete picture is bit for bit that of draw_sample. Syncs if necessary, and waits
   * for the device. Use it on the device's thread, without a recording. \a budget_seconds: \see BudgetedPicture::draw
   * \return whether the picture is complete
   */
  bool draw_within(double budget_seconds, const scene::PlacedCamera &camera, const draw::Target &target = {});
  /** Write the picture of the last draw_within to \a target. \throws gpu::Error, also if there is none */
  void write_shown(const draw::Target &target);
  /** The report of the last draw_within. Before the first, all members have their defaults. */
  [[nodiscard]] const BudgetReport &budget_report() const
  {
    static const BudgetReport none;
    return budgeted_ ? budgeted_->report() : none;
  }
  /**
   * Draw a picture anew, until it is complete or \a limits end it, and write the mean of its samples to \a target.
   * \return the number of samples
   * \throws gpu::Error as draw_sample, and if neither the settings nor \a limits limit the number of samples
   */
  int draw(const scene::PlacedCamera &camera, const DrawLimits &limits = {}, const draw::Target &target = {});
  /**
   * Draw a picture with motion blur, otherwise as draw. Before each sample, this function calls \a pose, which may edit
   * the scene and returns the camera, and syncs. The samples are spread evenly over the time of the shutter.
   */
  int draw_moving(const Pose &pose, const DrawLimits &limits = {}, const draw::Target &target = {});
  /**
   * The mean of the samples drawn so far: scene-linear RGBA, W/(sr m²), premultiplied by alpha, rows from the bottom.
   * Waits for the device. Pixels outside of draw::Viewport::region are undefined.
   * \throws gpu::Error if no sample is drawn since the picture started; a preview of draw_within is no sample
   */
  [[nodiscard]] std::vector<glm::vec4> read_picture();

  /**
   * Leave objects out of the pictures and not out of the scene. \see RenderScene::hidden_objects,
   * draw::View::hidden. Takes effect with the next draw, and needs no sync. At first, nothing is left out.
   */
  void set_hidden(std::vector<scene::Handle<scene::Node>> hidden, std::vector<scene::Handle<scene::Node>> isolated = {})
  {
    hidden_ = std::move(hidden);
    isolated_ = std::move(isolated);
  }

  /**
   * Show only what is on the side of \a planes_ws with dot(plane, (p, 1)) >= 0: draw::View::clip_planes, in world space
   * of the scene. Takes effect with the next draw or view_of. \throws gpu::Error, and keeps the planes of before, if
   * they are more than draw::View::clip_plane_max or not finite
   */
  void set_clip_planes(std::vector<glm::dvec4> planes_ws);

  /** The view of \a camera in the coordinates of the render scene, without what is left out. */
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
  [[nodiscard]] Inspection inspect()
  {
    return {engine_, viewport_};
  }
  [[nodiscard]] draw::Viewport &viewport()
  {
    return viewport_;
  }

 private:
  /** \throws gpu::Error if a sync is missing */
  void check_synced() const;
  /** \a camera_of: the camera of a sample, whose number is counted from 0. */
  int draw_all(const std::function<scene::PlacedCamera(int index)> &camera_of, const DrawLimits &limits,
               const draw::Target &target);
  /** Move the origin of the render scene near to \a camera, if it is far away. */
  void follow(const scene::PlacedCamera &camera);

  /** Destroyed after the resources of the members below. */
  struct Trim {
    gpu::Device &device;
    ~Trim()
    {
      device.trim();
    }
  };
  Trim trim_;
  render_scene::RenderScene render_scene_;
  Engine engine_;
  draw::Viewport viewport_;
  Settings settings_;
  std::vector<scene::Handle<scene::Node>> hidden_;
  std::vector<scene::Handle<scene::Node>> isolated_;
  std::vector<glm::dvec4> clip_planes_ws_;
  /** The last sync succeeded, and settings and size have not changed since. */
  bool is_synced_ = false;
  /** Created by the first draw_within. */
  std::optional<BudgetedPicture> budgeted_;
};

}  // namespace gnomon::eevee
