// SPDX-License-Identifier: MIT
#pragma once

#include "view_canvas.hh"
#include "view_document.hh"
#include "view_error_measurement.hh"
#include "view_properties.hh"
#include "view_viewport.hh"

#include <memory>
#include <string>
#include <vector>

/** The panels beside the viewports. Each function draws items of the current window. */
namespace gnomon::view {

/** Draw table rows for \a thing's properties, grouped under headers. \return whether the user changed \a thing */
template <typename T>
bool show_properties(T &thing);

/** The nodes as a tree. A click selects a node; a check box hides it. */
class SceneTree {
 public:
  void show(Document &document);

 private:
  void show_node(Document &document, scene::Handle<scene::Node> handle);
  char filter_[64] = "";
};

/** Show the selected node: placement, flags, lamp, camera and materials. */
void show_selection(Document &document);
/** Show the world. \return whether the user wants to choose a picture */
[[nodiscard]] bool show_world(Document &document);
/** Show the settings, which all viewports share. */
void show_settings(Document &document);

/** Key of a panel's cached content, which takes time to make. */
struct PanelKey {
  scene::Revision scene = 0;
  std::uint64_t settings = 0;
  int samples_drawn = -1;
  scene::Handle<scene::Node> selected{};
  int layer = 0;

  bool operator==(const PanelKey &) const = default;
};

/**
 * The parts of a viewport's frame as a list with bytes, times and reasons, and the parts of the scene that are not
 * drawn.
 */
class FramePanel {
 public:
  void show(Document &document, WindowViewport &viewport);

 private:
  eevee::Report report_;
  PanelKey shown_;
};

/** Error against time for the current settings, measured in the background. */
class ErrorPanel {
 public:
  /**
   * Start to measure the picture of \a viewport as eevee draws it, with the current scene and settings, on a device
   * of \a backend. \throws std::runtime_error if a measurement is running
   */
  void begin(const Document &document, const WindowViewport &viewport, gpu::Backend backend);
  /** Cancel the measurement, if one is running. take then throws measure::Cancelled. */
  void cancel()
  {
    if (measurement_) {
      measurement_->cancel();
    }
  }
  /** Delete the results when the document closes. Cancels a running measurement. */
  void clear();
  [[nodiscard]] bool is_measuring() const
  {
    return measurement_ != nullptr;
  }
  [[nodiscard]] bool has_ended() const
  {
    return measurement_ && measurement_->is_done();
  }
  /**
   * Take the measurement's results and show them. \return a sentence about them \pre has_ended \throws the exception
   * that ended the measurement early
   */
  std::string take();
  /** \return whether the user has requested a measurement */
  [[nodiscard]] bool show(const Document &document);

 private:
  /** Key of the measurement. */
  struct Key {
    scene::Revision scene = 0;
    std::uint64_t settings = 0;

    bool operator==(const Key &) const = default;
  };
  [[nodiscard]] static Key key_of(const Document &document);

  /** nullptr: no measurement is running. */
  std::unique_ptr<ErrorMeasurement> measurement_;
  std::vector<measure::TimedError> points_;
  std::vector<std::string> untraced_;
  Key key_;
  glm::ivec2 size_px_{0};
};

/** The layers of the selected lamp's shadow. */
class ShadowPanel {
 public:
  /** \a device: the document's device. \throws gpu::Error */
  void show(Document &document, WindowViewport &viewport, gpu::Device &device);
  /**
   * Show the layer \a text of the selected lamp's shadow: "all", or a name for eevee::find_layer. \throws
   * std::runtime_error, which lists the layers, if there is none of that name
   */
  void select(Document &document, WindowViewport &viewport, const std::string &text);
  /** Delete the texture; call it before its OpenGL context is destroyed. */
  void close();

 private:
  /** \pre the lamp has layers */
  void read(eevee::Engine &engine, WindowViewport &viewport, std::size_t lamp, gpu::Device &device);

  Canvas canvas_;
  PanelKey shown_;
  /** 0: all layers; n > 0: the layer of index n - 1. */
  int layer_ = 0;
};

}  // namespace gnomon::view
