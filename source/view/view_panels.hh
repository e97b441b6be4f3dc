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

/** What the window shows beside the viewports. Each function draws items of the current window. */
namespace gnomon::view {

/** The rows of tables with \a thing's properties, some under headers. \return whether the user changed \a thing */
template <typename T>
bool show_properties(T &thing);

/** The nodes as a tree: a click selects, a box hides. */
class SceneTree {
 public:
  void show(Document &document);

 private:
  void show_node(Document &document, scene::Handle<scene::Node> handle);
  char filter_[64] = "";
};

/** The selected node: its placement, flags, lamp, camera and materials. */
void show_selection(Document &document);
/** Light from everywhere. \return whether the user wants to choose a picture */
[[nodiscard]] bool show_world(Document &document);
/** Settings of all viewports. */
void show_settings(Document &document);

/** Of what a panel shows: it is made anew where this differs, as it takes time. */
struct PanelKey {
  scene::Revision scene = 0;
  std::uint64_t settings = 0;
  int samples_drawn = -1;
  scene::Handle<scene::Node> selected{};
  int layer = 0;

  bool operator==(const PanelKey &) const = default;
};

/** The frame of a viewport as a list, with bytes, times and reasons, and what is not drawn. */
class FramePanel {
 public:
  void show(Document &document, Viewport &viewport);

 private:
  eevee::Report report_;
  PanelKey shown_;
};

/** Error against time of the current settings, which is measured in the background. */
class ErrorPanel {
 public:
  /**
   * Begin to measure the picture of \a viewport as eevee draws it, of the scene and the settings as they are now.
   * \throws std::runtime_error if a measurement is under way
   */
  void begin(const Document &document, const Viewport &viewport);
  /** Let the measurement end, if there is one. take throws measure::Cancelled then. */
  void cancel()
  {
    if (measurement_) {
      measurement_->cancel();
    }
  }
  /** Forget what was measured, of a document that is closed. Cancels. */
  void clear();
  [[nodiscard]] bool is_measuring() const
  {
    return measurement_ != nullptr;
  }
  [[nodiscard]] bool has_ended() const
  {
    return measurement_ && measurement_->is_done();
  }
  /** Show what the measurement gave. \return a sentence about it \pre has_ended \throws what has ended it before */
  std::string take();
  /** \return whether the user has asked for a measurement */
  [[nodiscard]] bool show(const Document &document);

 private:
  /** Of what was measured. */
  struct Key {
    scene::Revision scene = 0;
    std::uint64_t settings = 0;

    bool operator==(const Key &) const = default;
  };
  [[nodiscard]] static Key key_of(const Document &document);

  /** nullptr: nothing is being measured. */
  std::unique_ptr<ErrorMeasurement> measurement_;
  std::vector<measure::TimedError> points_;
  std::vector<std::string> untraced_;
  Key key_;
  glm::ivec2 size_px_{0};
};

/** The layers of the selected lamp's shadow. */
class ShadowPanel {
 public:
  /** \a device: of the document. \throws gpu::Error */
  void show(Document &document, Viewport &viewport, gpu::Device &device);
  /**
   * Show the layer \a text of the selected lamp's shadow: "all", or as eevee::find_layer.
   * \throws std::runtime_error naming its layers if there is none
   */
  void select(Document &document, Viewport &viewport, const std::string &text);
  /** Forget the picture, before its OpenGL context is destroyed. */
  void close();

 private:
  /** \pre the lamp has layers */
  void read(eevee::Engine &engine, Viewport &viewport, std::size_t lamp, gpu::Device &device);

  Canvas canvas_;
  PanelKey shown_;
  /** 0: all layers, then one after the other. */
  int layer_ = 0;
};

}  // namespace gnomon::view
