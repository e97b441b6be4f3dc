// SPDX-License-Identifier: MIT
#pragma once

#include "draw_engine.hh"
#include "draw_objects.hh"

#include "gpu_device.hh"

#include <map>
#include <span>

namespace gnomon::draw {

/** Base of what an engine keeps in a viewport: its framebuffer, texture, pass and storage lists (`fbl txl psl stl`). */
struct EngineViewportData {
  virtual ~EngineViewportData() = default;
};

/**
 * One picture of a scene on a device: its size, the objects' matrices, the depth that all engines share, and what each
 * engine keeps for it. Must go before its device.
 */
class Viewport {
 public:
  /** \throws gpu::Error where size_px is below 1x1, or above what a texture of the device may have. */
  Viewport(gpu::Device &device, glm::ivec2 size_px);

  /**
   * Let \a engines record \a objects; to be called again when any of them changed. What they add to objects() is
   * uploaded; who adds later, or draws with object_identity alone, calls ObjectBuffer::upload.
   * \throws gpu::Error naming an object whose matrix is not finite, or whose volume holds NaN; then nothing has
   * changed.
   */
  void sync(std::span<Engine *const> engines, std::span<const ObjectRef> objects);
  /** Let \a engines draw what they recorded, in order. \throws gpu::Error where \a view or its inverse is not finite.
   */
  void draw(std::span<Engine *const> engines, const View &view);

  [[nodiscard]] gpu::Device &device() const
  {
    return device_;
  }
  [[nodiscard]] glm::ivec2 size_px() const
  {
    return size_px_;
  }
  [[nodiscard]] ObjectBuffer &objects()
  {
    return objects_;
  }
  /**
   * The depth of the picture, for engines to attach to their framebuffers. Made at the first ask.
   * \throws gpu::Error where the device cannot hold it.
   */
  [[nodiscard]] const gpu::Texture &depth_texture();
  [[nodiscard]] bool has_depth_texture() const
  {
    return bool(depth_texture_);
  }

  /** Made by the first ask of \a engine; lives as long as the viewport. \pre always asked with the same Data. */
  template <typename Data>
  Data &engine_data(const Engine &engine)
  {
    std::unique_ptr<EngineViewportData> &data = engine_data_[engine.id()];
    if (!data) {
      data = std::make_unique<Data>();
    }
    return static_cast<Data &>(*data);
  }

 private:
  gpu::Device &device_;
  glm::ivec2 size_px_;
  ObjectBuffer objects_;
  gpu::Texture depth_texture_;
  std::map<std::uint64_t, std::unique_ptr<EngineViewportData>> engine_data_;
};

}  // namespace gnomon::draw
