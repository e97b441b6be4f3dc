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
 * Draws a scene. One engine may serve many viewports; it stores the data of a viewport in Viewport::engine_data.
 *
 * After each edit of the scene, Viewport::sync calls these functions in this order:
 * 1. init;
 * 2. cache_init, if this is the first sync of the viewport, if objects were added or removed since the last one, or if
 *    the last one failed;
 * 3. cache_populate for each changed object, or for every object after cache_init;
 * 4. cache_finish.
 *
 * Viewport::draw then calls draw_scene any number of times.
 *
 * All these functions may run during a gpu::Recording, on a thread other than the device's. Work that an engine has
 * recorded is not executed before the packet is submitted, and may be lost. An engine must compare
 * gpu::Device::loss_count and repeat lost work.
 */
class Engine {
 public:
  Engine();
  Engine(const Engine &) = delete;
  Engine &operator=(const Engine &) = delete;
  virtual ~Engine() = default;

  /** Unique within the process. Unlike the address, it is never reused. */
  [[nodiscard]] std::uint64_t id() const
  {
    return id_;
  }

  [[nodiscard]] virtual std::string_view name() const = 0;
  /** Create or update everything that does not depend on the objects. */
  virtual void init(Viewport &viewport) = 0;
  /** Remove all objects from the engine's caches. */
  virtual void cache_init(Viewport &viewport) = 0;
  /** Add or update \a object. \a objects holds its matrix, volume and value. */
  virtual void cache_populate(Viewport &viewport, const ObjectBuffer &objects, ObjectIndex object) = 0;
  /** Finish the sync, after all objects are known. Calls Viewport::scene_changed if the picture changes. */
  virtual void cache_finish(Viewport &viewport) = 0;
  /**
   * If samples are missing and Viewport::is_writing() is false, draw the part Viewport::part() of sample number
   * Viewport::samples_drawn(). The first sample is number 0. An engine whose pictures take little time may draw the
   * whole sample in each part. Then write the mean of the whole samples to Viewport::target(), if there is a target and
   * a sample. \a view: of the picture and its guard band.
   */
  virtual void draw_scene(Viewport &viewport, const View &view) = 0;
  /**
   * Receive the results of an earlier draw_scene of \a viewport: texels requested by read_back, and measured times.
   * \return true if the picture of that draw_scene is final; false if another draw_scene with the same view may differ
   */
  virtual bool take_feedback(Viewport & /*viewport*/, const gpu::Feedback & /*feedback*/)
  {
    return true;
  }

 private:
  std::uint64_t id_;
};

/** Name and factory of an engine. The factory passes the scene to the engine. */
struct EngineType {
  std::string name;
  std::function<std::unique_ptr<Engine>()> create;
};

/** The engines that a host makes available, by name. */
class EngineRegistry {
 public:
  /** \throws gpu::Error if the name is already registered; nothing changes then */
  void add(EngineType type);
  /** \throws gpu::Error naming the registered engines if \a name is not registered */
  [[nodiscard]] std::unique_ptr<Engine> create(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  std::vector<EngineType> types_;
};

}  // namespace gnomon::draw
