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
 * its view or its size changes, after a sync in which an engine finds a change, and by restart().
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
   * Let \a engines draw the next sample, in order, and write the picture so far to \a target.
   * \throws gpu::Error where \a view or its inverse is not finite, and where \a target cannot take the picture.
   */
  void draw(std::span<Engine *const> engines, const View &view, const Target &target = {});
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
  gpu::Device &device_;
  glm::ivec2 size_px_;
  gpu::Texture depth_texture_;
  /** Of the samples drawn. */
  View view_;
  Target target_;
  int samples_drawn_ = 0;
  struct EngineState {
    std::unique_ptr<EngineViewportData> data;
    /** ObjectBuffer::revision at the last sync that came to its end; nothing: none did. */
    std::optional<std::uint64_t> synced_revision;
  };
  /** By Engine::id. */
  std::map<std::uint64_t, EngineState> engines_;
};

}  // namespace gnomon::draw
