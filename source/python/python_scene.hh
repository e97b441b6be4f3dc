// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <pybind11/pybind11.h>

#include <atomic>
#include <memory>
#include <optional>

/** The Python module `gnomon`: scenes, renderers and pictures for scripts. doc/python.md explains it. */
namespace gnomon::python {

namespace py = pybind11;

/** A scene, and the number of functions that read it without the interpreter's lock. */
struct SharedScene {
  scene::Scene scene;
  std::atomic<int> reader_count = 0;

  /** The scene for an edit. \throws scene::InvalidEdit while another thread draws it. */
  scene::Scene &edited()
  {
    if (reader_count > 0) {
      throw scene::InvalidEdit("the scene cannot be edited while it is drawn or read");
    }
    return scene;
  }
};

using ScenePtr = std::shared_ptr<SharedScene>;
using SceneClass = py::class_<SharedScene, ScenePtr>;

/**
 * While it exists, edits of a scene throw. Construct it with the interpreter's lock, which edits need, too; afterwards
 * the scene may be read without the lock.
 */
class Reading {
 public:
  explicit Reading(ScenePtr scene) : scene_(std::move(scene))
  {
    scene_->reader_count++;
  }
  ~Reading()
  {
    scene_->reader_count--;
  }
  Reading(const Reading &) = delete;
  Reading &operator=(const Reading &) = delete;

 private:
  ScenePtr scene_;
};

/** A handle with its scene: a Python object whose properties are those of the thing. */
template <typename T>
struct Thing {
  ScenePtr scene;
  scene::Handle<T> handle;

  /** \throws scene::StaleHandle */
  [[nodiscard]] const T &value() const
  {
    return scene->scene.pool<T>()[handle];
  }
  bool operator==(const Thing &) const = default;
};

/** The camera at \a node, or the first of the scene. \throws scene::InvalidEdit if there is none. */
[[nodiscard]] scene::PlacedCamera camera_at(const ScenePtr &scene, const std::optional<Thing<scene::Node>> &node);

/** Adds the classes of scenes and their things, and the functions that read and write files. */
void define_scene(py::module_ &module);
/** Adds Device, Renderer and Report. */
void define_renderer(py::module_ &module);
/** Adds the pictures by ray tracing, and their comparison. */
void define_reference(py::module_ &module);

}  // namespace gnomon::python
