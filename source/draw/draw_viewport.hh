// SPDX-License-Identifier: MIT
#pragma once

#include "draw_engine.hh"
#include "draw_objects.hh"
#include "draw_target.hh"
#include "draw_view.hh"

#include "gpu_device.hh"

#include <map>
#include <optional>
#include <span>

namespace gnomon::draw {

/** Base of what an engine keeps in a viewport: its framebuffer, texture, pass and storage lists (`fbl txl psl stl`). */
struct EngineViewportData {
  virtual ~EngineViewportData() = default;
  /** Destroy everything that depends on the size of the picture. The next sync makes it anew. */
  virtual void resized() = 0;
};

/**
 * One picture of a scene on a device: its size, the samples drawn so far, the depth that all engines share, and what
 * each engine keeps for it. Must be destroyed before its device.
 *
 * Each draw adds a sample to the picture until the engines have all that they are to draw. A picture begins anew when
 * its view, its size or its engines change, after a sync in which an engine finds a change, where a packet with samples
 * of it is lost, and by restart().
 */
class Viewport {
 public:
  /** \throws gpu::Error where size_px is below 1x1, or above what a texture of the device may have. */
  Viewport(gpu::Device &device, glm::ivec2 size_px);

  /**
   * Let each engine take note of the objects that changed since its last sync of this viewport. Call it after every
   * edit of the scene. \a objects must be the same buffer each time.
   */
  void sync(std::span<Engine *const> engines, const ObjectBuffer &objects);
  /**
   * Let \a engines draw the next sample, in order, and write the picture so far to \a target. While the device is
   * recording, this is a part of the recording. Otherwise it is recorded and submitted now, and repeated where the
   * device's feedback changes the picture.
   *
   * \throws gpu::Error where \a view or its inverse is not finite, where \a target cannot take the picture, and where
   * the submission fails; the picture then begins anew with the next draw.
   */
  void draw(std::span<Engine *const> engines, const View &view, const Target &target = {});
  /**
   * Give \a engines the feedback of an earlier packet in which they drew, for the next draw. Hosts that record packets
   * call it between submission and the next recording of that packet; draw without a recording does so itself. The
   * picture begins anew where the feedback changes it.
   * \return whether the picture of that packet is final
   */
  bool take_feedback(std::span<Engine *const> engines, const gpu::Feedback &feedback);
  /** Begin the picture anew with the next draw. */
  void restart()
  {
    samples_drawn_ = 0;
  }
  /** Draws since the picture began. */
  [[nodiscard]] int samples_drawn() const
  {
    return samples_drawn_;
  }
  /** Of the current draw, or of the last one. */
  [[nodiscard]] const View &view() const
  {
    return view_;
  }
  /** Of the current draw, or of the last one, whose framebuffer may be gone. */
  [[nodiscard]] const Target &target() const
  {
    return target_;
  }

  [[nodiscard]] gpu::Device &device() const
  {
    return device_;
  }
  [[nodiscard]] glm::ivec2 size_px() const
  {
    return size_px_;
  }
  /**
   * The depth of the picture, for engines to attach to their framebuffers. The first call creates it.
   * \throws gpu::Error where the device cannot hold it.
   */
  [[nodiscard]] const gpu::Texture &depth_texture();
  [[nodiscard]] bool has_depth_texture() const
  {
    return bool(depth_texture_);
  }

  /**
   * During draw_scene: whether draw repeats it until the picture is final. The first draw_scene then needs to draw only
   * what the device's feedback is made from.
   */
  [[nodiscard]] bool draws_until_final() const
  {
    return draws_until_final_;
  }

  /** The first call of \a engine creates it; remove_engine destroys it. \pre always called with the same Data. */
  template <typename Data>
  Data &engine_data(const Engine &engine)
  {
    std::unique_ptr<EngineViewportData> &data = engines_[engine.id()].data;
    if (!data) {
      data = std::make_unique<Data>();
    }
    return static_cast<Data &>(*data);
  }
  /** Destroy everything that \a engine keeps in this viewport. An engine that the viewport does not know is ignored. */
  void remove_engine(const Engine &engine)
  {
    engines_.erase(engine.id());
  }
  /**
   * Change the size of the picture. Engines then need another sync. Everything that depended on the size is destroyed.
   * \throws gpu::Error as the constructor; then nothing changes.
   */
  void resize(glm::ivec2 size_px);

 private:
  /** \a is_until_final: \see draws_until_final */
  void draw_sample(std::span<Engine *const> engines, bool is_until_final);
  void draw_until_final(std::span<Engine *const> engines);

  gpu::Device &device_;
  glm::ivec2 size_px_;
  gpu::Texture depth_texture_;
  /** Of the samples drawn. */
  View view_;
  /** Engine::id of the engines that drew them. */
  std::vector<std::uint64_t> drawn_by_;
  Target target_;
  int samples_drawn_ = 0;
  /** gpu::Device::loss_count when the last sample was drawn. */
  std::uint64_t loss_count_ = 0;
  /** For draw without a recording. */
  gpu::Packet packet_;
  bool draws_until_final_ = false;
  struct EngineState {
    std::unique_ptr<EngineViewportData> data;
    /** ObjectBuffer::revision at the last sync that came to its end; nothing: none did. */
    std::optional<std::uint64_t> synced_revision;
  };
  /** By Engine::id. */
  std::map<std::uint64_t, EngineState> engines_;
};

}  // namespace gnomon::draw
