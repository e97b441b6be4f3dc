// SPDX-License-Identifier: MIT
#pragma once

#include "view_canvas.hh"
#include "view_document.hh"
#include "view_error_estimate.hh"
#include "view_fly.hh"
#include "view_gizmo.hh"

#include "draw_viewport.hh"
#include "eevee_budgeted_picture.hh"

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gnomon::view {

/** A picture of the document's scene in the window: its camera, its engine, and what the pointer does in it. */
class Viewport {
 public:
  /** Forget the picture, before the document that it shows is destroyed or leaves its device. */
  void close();
  /** Look through the scene's first camera. */
  void look_at(const Document &document);
  /** Show what \a camera sees, also after edits of it and its node, until the view is moved. */
  void look_through(const Document &document, const scene::PlacedCamera &camera);
  /** Move to the scene's camera that is looked through, if one is. */
  void follow(const Document &document);
  /** The camera of the picture: that of the scene that is looked through, or that of `navigation`. */
  [[nodiscard]] scene::PlacedCamera camera(const Document &document) const;

  /**
   * Draw the next sample, if the picture needs more. \a budget_seconds: \see eevee::BudgetedPicture; 0: no budget
   * \return whether it is complete \throws gpu::Error
   */
  bool draw(Document &document, double budget_seconds);
  /**
   * Show the picture as an item of the current window that fills \a size, and let the pointer act on it.
   * \return whether the pointer is over it
   */
  bool show(Document &document, glm::vec2 size, bool is_active);

  /** Select what is at a pixel of the picture, from its upper left corner. \pre draw */
  void pick(Document &document, glm::ivec2 pixel_px);
  /** Let the selected node follow the pointer. \pre draw \throws as TransformOperation */
  void begin_transform(Document &document, TransformKind kind);
  /**
   * Drag the handle of the gizmo that is at \a from_px to \a to_px, both pixels as for pick.
   * \return false: there is no handle \pre draw
   */
  bool drag_handle(Document &document, const glm::dvec2 &from_px, const glm::dvec2 &to_px);
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
  /** Whether the picture of the last draw needs no more samples. */
  [[nodiscard]] bool is_complete() const
  {
    return is_complete_ && !has_failed_;
  }
  /** RMSE of the picture so far. Empty: not known, or there is no maximum. \see Settings::error_max */
  [[nodiscard]] std::optional<double> error() const
  {
    return error_.value();
  }
  /** What the last draw with a budget drew; nullptr: the last draw had none. */
  [[nodiscard]] const eevee::BudgetReport *budget_report() const
  {
    return has_budget_ ? &budgeted_->report() : nullptr;
  }
  /** nullptr: nothing was drawn yet. */
  [[nodiscard]] draw::Viewport *viewport()
  {
    return viewport_.get();
  }

  Navigation navigation;
  /** Nothing: the camera stands. */
  std::optional<Fly> fly;
  std::string engine = "eevee";
  /** Show lamps, cameras, the outline of what is selected, and the gizmo. */
  bool has_overlays = true;

 private:
  /** Behind the picture. */
  static constexpr glm::vec4 backdrop{0.22F, 0.22F, 0.23F, 1.0F};

  /** All that a picture depends on. */
  struct Key {
    scene::Revision scene = 0;
    std::uint64_t settings = 0;
    std::string engine;
    glm::ivec2 size_px{0};
    glm::dvec3 origin_ws{0.0};

    bool operator==(const Key &) const = default;
  };
  /** All that is drawn over it depends on, beside the scene and the view. */
  struct OverlayKey {
    bool is_shown = false;
    scene::Handle<scene::Node> selected{};
    std::optional<TransformKind> gizmo{};
    Orientation orientation = Orientation::World;
    std::optional<TransformAxis> pointed{};
    std::optional<Transform> operation{};

    bool operator==(const OverlayKey &) const = default;
  };
  /** All that the texel density over the picture depends on. */
  struct DensityKey {
    /** draw::Viewport::restart_count. */
    std::uint64_t picture = 0;
    glm::ivec2 size_px{0};
    /** The density is that of the last sample, which shows another point of a lamp with an extent than the first. */
    bool is_last = false;
    scene::Handle<scene::Node> lamp{};

    bool operator==(const DensityKey &) const = default;
  };
  [[nodiscard]] OverlayKey overlay_key(Document &document) const;
  /** Nothing: none is looked through. */
  [[nodiscard]] std::optional<scene::PlacedCamera> looked_through(const Document &document) const;
  /** Draw with \a used, within the budget if there is one and it can. */
  void draw_picture(Document &document, draw::Engine &used, double budget_seconds, const draw::Target &target);
  /** End a picture whose time is over. */
  void limit_time(const Document &document, eevee::Engine &eevee);
  /** With a maximum error: end a picture whose error is small enough, or that has its samples. */
  void limit_error(const Document &document, eevee::Engine &eevee);
  /** \a write: writes a picture to a target */
  [[nodiscard]] std::vector<float> read_written(gpu::Device &device,
                                                const std::function<void(const draw::Target &)> &write) const;
  // view_viewport_density.cc
  /** Colour the picture by the texel density of the selected lamp's shadow, if there is one. \pre no preview is shown
   */
  void draw_density(Document &document, eevee::Engine &eevee, const draw::Target &target);
  /** The scale of its colours, and whose shadow it is; or why there is none. */
  void show_density_scale(Document &document, glm::vec2 corner, glm::vec2 size) const;

  void draw_overlays(Document &document, const draw::Target &target);
  void show_lamps(Document &document, glm::vec2 corner, glm::vec2 size);
  void take_pointer(Document &document, glm::vec2 corner);
  void take_navigation(bool is_hovered);
  /** \return whether there is an operation, which the pointer then acts on alone */
  bool take_operation(Document &document);
  /** At the selected node; nothing: it is not shown. */
  [[nodiscard]] std::optional<Gizmo> gizmo_of(Document &document) const;
  /** Where a point is in the picture, as pick counts; nothing: not in it. */
  [[nodiscard]] std::optional<glm::vec2> place_of(const glm::dvec3 &position_ws) const;

  /** A node with a camera that is looked through while `navigation` is as that camera has set it. */
  struct LookedThrough {
    scene::Handle<scene::Node> node;
    Navigation navigation;
  };

  Canvas canvas_;
  std::optional<LookedThrough> looked_through_;
  std::unique_ptr<draw::Viewport> viewport_;
  /** Of viewport_. Created by the first draw with a budget. */
  std::optional<eevee::BudgetedPicture> budgeted_;
  bool has_budget_ = false;
  /** Of the document's scene; of this viewport alone, as it keeps what its view shows. */
  std::optional<overlay::Overlay> overlay_;
  glm::ivec2 size_px_{320, 240};
  Key synced_;
  draw::View drawn_view_;
  /** Of drawn_view_. */
  PictureMap map_;
  /** draw::Viewport::restart_count of the picture, and when it was begun. */
  std::uint64_t picture_ = 0;
  std::chrono::steady_clock::time_point started_;
  /** Of the same picture. */
  ErrorEstimate error_;
  OverlayKey overlaid_;
  /** Of density_. */
  DensityKey density_key_;
  /** \see eevee::Inspection::texel_density */
  std::optional<std::vector<float>> density_;
  bool is_complete_ = false;
  /** The last draw threw. */
  bool has_failed_ = false;
  /** Whether the pointer has moved since its button went down. */
  bool is_dragged_ = false;
  /** In the last frame, in any viewport. */
  bool had_operation_ = false;
  /** In pixels, as pick counts. */
  glm::dvec2 pointer_px_{0.0};
  /** The handle of the gizmo under the pointer. */
  std::optional<TransformAxis> pointed_;
  /** The document's operation began here. */
  bool is_transforming_ = false;
  /** It is a handle that is dragged, until the button is released. */
  bool is_handle_dragged_ = false;
};

}  // namespace gnomon::view
