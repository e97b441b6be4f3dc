// SPDX-License-Identifier: MIT
#pragma once

#include "python_scene.hh"

#include "draw_target.hh"
#include "eevee_picture_layers.hh"

#include <atomic>
#include <mutex>
#include <thread>

#include <unistd.h>

namespace gnomon::python {

/**
 * A device with a context of its own, or with that of a host. Its thread is the one that constructs it, and all others
 * get an error. Python may drop the last reference to an object on any thread, and while another context is current;
 * what belongs to the device is then freed by the next call on its thread. A driver's threads do not exist in a forked
 * child, which would wait for them forever: there all functions throw, and nothing is freed.
 */
class Device {
 public:
  /**
   * \a backend: of gpu::drawing_backend_names. \a is_host: draw in the context of OpenGL that is current on the thread.
   * It must be current in each later call, too. Only free() then frees the device.
   * \throws std::invalid_argument if the backend is another; gpu::Error, also in a child of a process that made a
   * device before the fork
   */
  Device(const std::string &backend, bool is_host);
  ~Device();
  Device(const Device &) = delete;
  Device &operator=(const Device &) = delete;

  /** \throws gpu::Error on other threads, in forked children, during a draw, and after free() */
  gpu::Device &use();
  /** Destroys \a resources on the device's thread, at once or in the next use(). */
  void dispose(std::shared_ptr<void> resources);
  /** Frees the device. \throws gpu::Error as use(), and while there are renderers; the device is then as before */
  void free();
  /** On any thread. */
  std::atomic<int> renderer_count = 0;
  /** During a draw, in which the interpreter may run handlers of signals. */
  bool is_drawing = false;

 private:
  /** Whether this is the thread and the process that made the device. */
  [[nodiscard]] bool is_at_home() const;

  const std::thread::id thread_ = std::this_thread::get_id();
  const pid_t process_ = ::getpid();
  const bool is_host_;
  /** Empty after free(). */
  std::unique_ptr<gpu::Device> device_;
  std::mutex mutex_;
  /** Resources that the next use() frees. */
  std::vector<std::shared_ptr<void>> left_;
};

/** A picture's facts. */
struct Report {
  std::vector<std::string> warnings;
  std::vector<std::string> limits;
  int sample_count = 0;
  double frame_seconds = 0.0;
  std::size_t memory_bytes = 0;
};

/** Layers of a picture beside the picture itself. */
struct LayerRequest {
  eevee::SurfaceRequest surfaces;
  bool has_light = false;
  bool has_emission = false;
  bool has_world = false;
};

/** Rows from the bottom. Layers that were not requested are empty. */
struct Layers {
  std::vector<glm::vec4> picture;
  eevee::SurfaceLayers surfaces;
  /** By the names of the lamps, each once. */
  std::vector<std::pair<std::string, std::vector<glm::vec4>>> light;
  std::vector<glm::vec4> emission;
  std::vector<glm::vec4> world;
};

/** Draws one scene on one device. All functions are called on the device's thread. */
class Renderer {
 public:
  Renderer(std::shared_ptr<Device> device, ScenePtr scene, glm::ivec2 size_px, const eevee::Settings &settings);
  ~Renderer();
  Renderer(const Renderer &) = delete;
  Renderer &operator=(const Renderer &) = delete;

  /**
   * The picture: scene-linear RGBA, rows from the bottom. Called without the interpreter's lock, while a Reading of the
   * scene exists. \a limits ends a picture of no known number of samples.
   */
  std::vector<glm::vec4> render(const scene::PlacedCamera &camera, const eevee::DrawLimits &limits);
  /**
   * The picture and \a layers of it. Called as render().
   * \throws gpu::Error if the number of samples is not known, or not the same for all pixels
   */
  Layers render_layers(const scene::PlacedCamera &camera, const eevee::DrawLimits &limits, const LayerRequest &request);
  /**
   * The picture of \a camera within \a seconds: at once after a change, in a lower quality if the time asks for it, and
   * better with each call. Called as render(). \return the picture, empty if it is that of the last call, and whether
   * it is complete \throws gpu::Error
   */
  std::pair<std::vector<glm::vec4>, bool> refine(const scene::PlacedCamera &camera, double seconds);
  /** The array of the last refine(), which its next call returns again if the picture is the same. */
  py::object refined = py::none();
  /** The same as refine(), into \a target. \return whether the picture is complete */
  bool draw(const scene::PlacedCamera &camera, double seconds, const draw::Target &target);
  [[nodiscard]] Report report();
  /** \throws gpu::Error */
  eevee::SceneRenderer &use();
  [[nodiscard]] const ScenePtr &scene() const
  {
    return state_->scene;
  }
  [[nodiscard]] const eevee::Settings &settings() const
  {
    return state_->renderer.settings();
  }
  [[nodiscard]] glm::ivec2 size_px()
  {
    return state_->renderer.viewport().size_px();
  }

 private:
  struct State {
    /** Outlives the renderer. */
    ScenePtr scene;
    eevee::SceneRenderer renderer;
    /** The target of the previews of refine(), in the size of the viewport. */
    std::optional<draw::TargetTexture> shown{};
  };

  std::shared_ptr<Device> device_;
  std::shared_ptr<State> state_;
  int samples_drawn_ = 0;
  double frame_seconds_ = 0.0;
};

}  // namespace gnomon::python
