// SPDX-License-Identifier: MIT
#pragma once

#include "draw_objects.hh"

#include "gpu_packet.hh"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace gnomon::draw {

class Viewport;

/**
 * A way to draw a scene. What belongs to one viewport is kept in Viewport::engine_data.
 *
 * Call order, by Viewport::sync: init; cache_init, if objects were added or removed since the engine's last sync of
 * this viewport, or a sync failed; cache_populate for each object that changed, after cache_init for every object;
 * cache_finish, which calls Viewport::restart where the picture is another one than before. Then, by Viewport::draw,
 * draw_scene as often as wanted, until the scene changes.
 *
 * All of these record: they need no device, and may run on another thread than the device's (\see gpu::Recording).
 * What an engine notes as drawn or written is so once the packet is submitted. It compares gpu::Device::loss_count, and
 * draws and writes again what a lost packet held.
 */
class Engine {
 public:
  Engine();
  Engine(const Engine &) = delete;
  Engine &operator=(const Engine &) = delete;
  virtual ~Engine() = default;

  /** Of this engine alone, in this process: its address may be another's later. */
  [[nodiscard]] std::uint64_t id() const
  {
    return id_;
  }

  [[nodiscard]] virtual std::string_view name() const = 0;
  /** Make or check what does not depend on the objects. */
  virtual void init(Viewport &viewport) = 0;
  /** Forget all objects. */
  virtual void cache_init(Viewport &viewport) = 0;
  /** \a object was added or has changed; \a objects has its matrix and volume. */
  virtual void cache_populate(Viewport &viewport, const ObjectBuffer &objects, ObjectIndex object) = 0;
  /** All objects are known. */
  virtual void cache_finish(Viewport &viewport) = 0;
  /**
   * Draw the sample Viewport::samples_drawn of the picture, 0 being the first, unless the picture has all that the
   * engine draws; then write the picture so far to Viewport::target, where there is one.
   */
  virtual void draw_scene(Viewport &viewport, const View &view) = 0;
  /**
   * What the device reports about an earlier draw_scene of \a viewport: what it asked for by read_back, and times.
   * \return whether the picture of that draw_scene is final; otherwise another draw_scene with the same view may differ
   */
  virtual bool take_feedback(Viewport & /*viewport*/, const gpu::Feedback & /*feedback*/)
  {
    return true;
  }

 private:
  std::uint64_t id_;
};

/** How to make an engine; a host registers those it wants, with the scene they are to read. */
struct EngineType {
  std::string name;
  std::function<std::unique_ptr<Engine>()> create;
};

class EngineRegistry {
 public:
  /** \throws gpu::Error where the name is taken; nothing changes then. */
  void add(EngineType type);
  /** \throws gpu::Error naming the registered engines where \a name is none of them. */
  [[nodiscard]] std::unique_ptr<Engine> create(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  std::vector<EngineType> types_;
};

}  // namespace gnomon::draw
