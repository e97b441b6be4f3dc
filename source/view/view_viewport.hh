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
#include <span>
#include <string>
#include <vector>

namespace gnomon::view {

/** A view of the document's scene in the window, with its camera, its engine and its pointer actions. */
class WindowViewport {
 public:
  /** Delete the picture; call it before the document is destroyed or leaves its device. */
  void close();
  /** Look through the scene's first camera. */
  void look_at(const Document &document);
  /** Look through \a camera and follow edits of it and its node, until the user moves the view. */
  void look_through(const Document &document, const scene::PlacedCamera &camera);
  /** Update the view from the scene's camera that it follows, if there is one. */
  void follow(const Document &document);
  /** The camera of the picture: the scene's camera that it follows, or that of `navigation`. */
  [[nodiscard]] scene::PlacedCamera camera(const Document &document) const;

  /**
   * Draw the next sample, if the picture needs more. \a budget_seconds: \see eevee::BudgetedPicture; 0: no budget.
   * \return whether no more draws are needed: the picture is complete, and dark_inside is known \throws gpu::Error
   */
  bool draw(Document &document, double budget_seconds);
  /**
   * Show the picture as an item of the current ImGui window with \a size, and process the pointer's actions. \return
   * whether the pointer is over the picture
   */
  bool show(Document &document, glm::vec2 size, bool is_active);

  /**
   * Select the node at a pixel, counted from the picture's upper left corner. \a adds: \see Document::select
   * \pre draw was called
   */
  void pick(Document &document, glm::ivec2 pixel_px, bool adds = false);
  /**
   * Select the nodes in an area: those that overlay::Overlay::select finds by `reach` and `extent`, and lamps and
   * cameras. \a outline_px: pixels as for pick. \pre draw was called
   */
  void select_area(Document &document, std::span<const glm::dvec2> outline_px, bool adds);
  /** Leave the selected nodes and their descendants out of this viewport's pictures. */
  void hide(const Document &document);
  /** Leave all but the selected nodes and their descendants out; the second call shows the others again. */
  void isolate(const Document &document);
  /** Whether the viewport isolates a node that the scene still has. */
  [[nodiscard]] bool is_isolated(const scene::Scene &scene) const;
  /** Whether the viewport isolates or hides a node that the scene still has. */
  [[nodiscard]] bool is_hiding(const scene::Scene &scene) const;
  /** Undo hide and isolate. */
  void show_all();
  /**
   * Show only what is seen now in the rectangle between two pixels, counted as for pick: the four planes through its
   * sides cut the rest off. \pre draw was called
   */
  void clip(const glm::dvec2 &from_px, const glm::dvec2 &to_px);
  /** Undo clip; the next drag of the left button does not mark a rectangle for it either. */
  void unclip();
  /** Undo clip; if nothing is cut off, the next drag of the left button marks the rectangle for it. */
  void toggle_clip();
  [[nodiscard]] bool is_clipped() const
  {
    return !clip_planes_ws_.empty();
  }
  /** Whether the node is left out of this viewport. */
  [[nodiscard]] bool is_hidden(const scene::Scene &scene, scene::Handle<scene::Node> node) const;
  /** Start to transform the selected node with the pointer. \pre draw was called \throws as TransformOperation */
  void begin_transform(Document &document, TransformKind kind);
  /**
   * Drag the handle of the gizmo that is at \a from_px to \a to_px, both pixels as for pick.
   * \return false if there is no handle \pre draw was called
   */
  bool drag_handle(Document &document, const glm::dvec2 &from_px, const glm::dvec2 &to_px);
  /** The current picture: scene-linear, rows from the bottom, four floats for each pixel. \pre draw was called */
  [[nodiscard]] std::vector<float> radiance(Document &document);
  /** The viewport's pixels in the window: rows from the bottom, four bytes each. */
  [[nodiscard]] std::vector<std::uint8_t> pixels() const
  {
    return canvas_.read();
  }

  /** Set the size of the next draw; at least 1x1. */
  void set_size(glm::ivec2 size_px)
  {
    size_px_ = glm::max(size_px, 1);
  }
  [[nodiscard]] glm::ivec2 size_px() const
  {
    return size_px_;
  }
  /** Number of samples drawn of the current picture. */
  [[nodiscard]] int samples_drawn() const
  {
    return viewport_ ? viewport_->samples_drawn() : 0;
  }
  /** Whether the picture of the last draw needs no more samples. */
  [[nodiscard]] bool is_complete() const
  {
    return is_complete_ && !has_failed_;
  }
  /**
   * Estimated RMSE of the current picture. Empty: not known yet, or no maximum error is set. \see
   * WindowSettings::error_max
   */
  [[nodiscard]] std::optional<double> error() const
  {
    return error_.value();
  }
  /**
   * The node whose back is all that is seen in a black picture: the eye is likely inside of it. Empty: there is none.
   */
  [[nodiscard]] std::optional<scene::Handle<scene::Node>> dark_inside() const
  {
    return is_complete() && viewport_ && dark_picture_ == viewport_->restart_count() ? dark_inside_ : std::nullopt;
  }
  /** The report of the last draw; nullptr: the draw had no budget. */
  [[nodiscard]] const eevee::BudgetReport *budget_report() const
  {
    return has_budget_ ? &budgeted_->report() : nullptr;
  }
  /** nullptr: no picture was drawn yet. */
  [[nodiscard]] draw::Viewport *viewport()
  {
    return viewport_.get();
  }

  Navigation navigation;
  /** Empty: the camera does not fly. */
  std::optional<Fly> fly;
  std::string engine = "eevee";
  /** Show lamps, cameras, the outline of the selected nodes, and the gizmo. */
  bool has_overlays = true;
  /** Show the edges of triangles instead of the surfaces of unlit. */
  bool has_wireframe = false;
  /** Which nodes the pointer selects in an area. With Through, the surfaces of unlit are seen through. */
  overlay::Reach reach = overlay::Reach::Visible;
  /** How much of a node must be in the area. */
  overlay::Extent extent = overlay::Extent::Part;

 private:
  /** Background colour behind the picture. */
  static constexpr glm::vec4 backdrop{0.22F, 0.22F, 0.23F, 1.0F};

  /** Key of the picture: all values that it depends on, except the view. */
  struct Key {
    scene::Revision scene = 0;
    std::uint64_t settings = 0;
    std::string engine;
    glm::ivec2 size_px{0};
    glm::dvec3 origin_ws{0.0};
    bool has_wireframe = false;
    overlay::Reach reach = overlay::Reach::Visible;

    bool operator==(const Key &) const = default;
  };
  /** Key of the overlays: all values that they depend on, except scene and view. */
  struct OverlayKey {
    bool is_shown = false;
    scene::Handle<scene::Node> selected{};
    std::vector<scene::Handle<scene::Node>> selection{};
    /** Nodes that are left out; those without objects have no part in the view. */
    std::vector<scene::Handle<scene::Node>> hidden{};
    std::vector<scene::Handle<scene::Node>> isolated{};
    std::optional<TransformKind> gizmo{};
    Orientation orientation = Orientation::World;
    std::optional<TransformAxis> pointed{};
    std::optional<Transform> operation{};

    bool operator==(const OverlayKey &) const = default;
  };
  /** Key of the texel density shown over the picture. */
  struct DensityKey {
    /** draw::Viewport::restart_count. */
    std::uint64_t picture = 0;
    glm::ivec2 size_px{0};
    /** The density is that of the last sample. Samples of a lamp with an extent use different points of it. */
    bool is_last = false;
    scene::Handle<scene::Node> lamp{};

    bool operator==(const DensityKey &) const = default;
  };
  [[nodiscard]] OverlayKey overlay_key(Document &document) const;
  /** Empty: follows no camera. */
  [[nodiscard]] std::optional<scene::PlacedCamera> looked_through(const Document &document) const;
  /** The view that is drawn: without the nodes that are hidden here, and with the clip planes. */
  [[nodiscard]] draw::View drawn_view(Document &document) const;
  /** Make the viewport, or give it the size, and clear the canvas. */
  void prepare(render_scene::RenderScene &render_scene);
  /** Draw for draw(), whatever has changed. \a is_synced: the viewport has the objects of synced_. \return as draw() */
  bool redraw(Document &document, double budget_seconds, bool is_synced);
  /** Draw with \a used, within the budget if there is one and the engine supports budgets. */
  void draw_picture(Document &document, draw::Engine &used, double budget_seconds, const draw::Target &target);
  /** End a picture that has reached the maximum time. */
  void limit_time(const Document &document, eevee::Engine &eevee);
  /** With a maximum error: end a picture that has reached it, or that has all its samples. */
  void limit_error(const Document &document, eevee::Engine &eevee);
  /** Update dark_inside for the complete picture by \a engine, once for each picture. */
  void look_around(draw::Engine &engine);
  /** Read back the picture that \a write writes to a target. */
  [[nodiscard]] std::vector<float> read_written(gpu::Device &device,
                                                const std::function<void(const draw::Target &)> &write) const;
  // view_viewport_density.cc
  /**
   * Colour the picture by the texel density of the selected lamp's shadow, if it has one. \pre the picture is not a
   * preview
   */
  void draw_density(Document &document, eevee::Engine &eevee, const draw::Target &target);
  /** Show the colour scale and the lamp's name, or the reason why there is no density. */
  void show_density_scale(Document &document, glm::vec2 corner, glm::vec2 size) const;

  void draw_overlays(Document &document, const draw::Target &target);
  void show_lamps(Document &document, glm::vec2 corner, glm::vec2 size);
  void take_pointer(Document &document, glm::vec2 corner);
  void take_navigation(bool is_hovered);
  /** Follow a drag that selects an area. \return whether there is one; it then consumes the pointer's input */
  bool take_area(Document &document, glm::vec2 corner);
  void show_area(glm::vec2 corner) const;
  /** Write over the picture how many nodes are left out or isolated, and why it is black. */
  void show_notes(const Document &document, glm::vec2 corner, glm::vec2 size) const;
  /** \return whether an operation is running; it then consumes the pointer's input */
  bool take_operation(Document &document);
  /** The gizmo at the selected node. Empty: there is none, or the node is hidden in this viewport. */
  [[nodiscard]] std::optional<Gizmo> gizmo_of(Document &document) const;
  /** Pixel of a point, counted as for pick. Empty: outside of the picture. */
  [[nodiscard]] std::optional<glm::vec2> place_of(const glm::dvec3 &position_ws) const;

  /**
   * The node of the camera that the view follows. Following ends when the viewport's navigation differs from this one.
   */
  struct LookedThrough {
    scene::Handle<scene::Node> node;
    Navigation navigation;
  };

  /** The area that the pointer drags, in pixels as for pick. */
  struct Area {
    /** The path of a lasso, or two opposite corners of a rectangle. */
    std::vector<glm::dvec2> points_px;
    bool is_lasso = false;

    [[nodiscard]] std::vector<glm::dvec2> outline_px() const;
  };

  Canvas canvas_;
  std::optional<LookedThrough> looked_through_;
  std::unique_ptr<draw::Viewport> viewport_;
  /** Draws viewport_. Created by the first draw with a budget. */
  std::optional<eevee::BudgetedPicture> budgeted_;
  bool has_budget_ = false;
  /** Draws over the document's scene; not shared between viewports, as it keeps the state of a view. */
  std::optional<overlay::Overlay> overlay_;
  glm::ivec2 size_px_{320, 240};
  Key synced_;
  draw::View drawn_view_;
  /** The map of drawn_view_. */
  PictureMap map_;
  /** draw::Viewport::restart_count of the current picture, and its start time. */
  std::uint64_t picture_ = 0;
  std::chrono::steady_clock::time_point started_;
  /** The error of the same picture. */
  ErrorEstimate error_;
  OverlayKey overlaid_;
  /** The key of density_. */
  DensityKey density_key_;
  /** \see eevee::Inspection::texel_density */
  std::optional<std::vector<float>> density_;
  std::optional<scene::Handle<scene::Node>> dark_inside_;
  /** draw::Viewport::restart_count of the picture of dark_inside_. */
  std::optional<std::uint64_t> dark_picture_;
  bool is_complete_ = false;
  /** The last draw threw. */
  bool has_failed_ = false;
  /** The press of the button is used, by a drag or an operation: it selects nothing and starts no area. */
  bool is_dragged_ = false;
  /** An operation was running in the last frame, in any viewport. */
  bool had_operation_ = false;
  /** Position of the pointer in pixels, counted as for pick. */
  glm::dvec2 pointer_px_{0.0};
  /** The handle of the gizmo under the pointer. */
  std::optional<TransformAxis> pointed_;
  /** The document's operation began in this viewport. */
  bool is_transforming_ = false;
  /** The drag moves a handle, until the button is released. */
  bool is_handle_dragged_ = false;
  std::optional<Area> area_;
  /** \see hide, isolate. Removed nodes stay in the lists, as undo may restore them. */
  std::vector<scene::Handle<scene::Node>> hidden_;
  std::vector<scene::Handle<scene::Node>> isolated_;
  /** \see clip */
  std::vector<glm::dvec4> clip_planes_ws_;
  bool is_clip_asked_ = false;
};

}  // namespace gnomon::view
