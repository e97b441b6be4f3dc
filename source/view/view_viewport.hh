// SPDX-License-Identifier: MIT
#pragma once

#include "view_canvas.hh"
#include "view_document.hh"
#include "view_navigation.hh"

#include "draw_viewport.hh"

#include <memory>
#include <optional>
#include <string>

namespace gnomon::view {

/** A picture of the document's scene in the window: its camera, its engine, and what the pointer does in it. */
class Viewport {
 public:
  explicit Viewport(gpu::Device &device) : device_(device) {}

  /** Forget the picture, before the document that it shows is destroyed. */
  void close();
  /** Look through the scene's first camera. */
  void look_at(const Document &document);

  /** Draw the next sample, if the picture needs more. \return whether it is complete \throws gpu::Error */
  bool draw(Document &document);
  /**
   * Show the picture as an item of the current window that fills \a size, and let the pointer act on it.
   * \return whether the pointer is over it
   */
  bool show(Document &document, glm::vec2 size, bool is_active);

  /** Select what is at a pixel of the picture, from its upper left corner. \pre draw */
  void pick(Document &document, glm::ivec2 pixel_px);
  /** The picture so far: scene-linear, rows from the bottom, four floats each. \pre draw */
  [[nodiscard]] std::vector<float> radiance(Document &document);
  /** What the window shows of it: rows from the bottom, four bytes each. */
  [[nodiscard]] std::vector<std::uint8_t> pixels() const
  {
    return canvas_.read();
  }

  /** Of the next draw; at least 1x1. */
  void set_size(glm::ivec2 size_px)
  {
    size_px_ = glm::max(size_px, 1);
  }
  [[nodiscard]] glm::ivec2 size_px() const
  {
    return size_px_;
  }
  /** Samples of the picture so far. */
  [[nodiscard]] int samples_drawn() const
  {
    return viewport_ ? viewport_->samples_drawn() : 0;
  }
  /** nullptr: nothing was drawn yet. */
  [[nodiscard]] draw::Viewport *viewport()
  {
    return viewport_.get();
  }

  Navigation navigation;
  std::string engine = "eevee";

 private:
  /** All that a picture depends on. */
  struct Key {
    scene::Revision scene = 0;
    std::uint64_t settings = 0;
    std::string engine;
    glm::ivec2 size_px{0};
    glm::dvec3 origin_ws{0.0};

    bool operator==(const Key &) const = default;
  };
  void show_overlays(Document &document, glm::vec2 corner, glm::vec2 size);
  void take_pointer(Document &document, glm::vec2 corner);
  /** Where the middle of \a lamp is, pixels from the upper left corner; nothing: not in the picture. */
  [[nodiscard]] std::optional<glm::vec2> place_of(const scene::PlacedLamp &lamp) const;

  gpu::Device &device_;
  Canvas canvas_;
  std::unique_ptr<draw::Viewport> viewport_;
  glm::ivec2 size_px_{320, 240};
  Key synced_;
  draw::View drawn_view_;
  scene::Handle<scene::Node> outlined_;
  bool is_complete_ = false;
  /** The last draw threw. */
  bool has_failed_ = false;
  /** Whether the pointer has moved since its button went down. */
  bool is_dragged_ = false;
};

}  // namespace gnomon::view
