// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_budget_controller.hh"
#include "eevee_engine.hh"

#include <functional>
#include <memory>
#include <string>

namespace gnomon::eevee {

/** Result of a call within a time budget: the picture that is shown, and the reason. */
struct BudgetReport {
  enum class Kind {
    /** A sample in another size or with other shadows than the picture's. */
    Preview,
    /** The picture with some of its samples. */
    Refining,
    Complete,
  };
  Kind kind = Kind::Preview;
  /** The shown picture is another than that of the last call. */
  bool is_new = false;
  /** Size of the picture, and of the shown image. */
  glm::ivec2 size_px{0};
  glm::ivec2 drawn_size_px{0};
  /** The edges of the shadows that are shown are divided by it. */
  int shadow_divisor = 1;
  /** Whole samples of the picture. */
  int samples_drawn = 0;
  /** Settings::sample_count */
  int sample_count = 0;
  double budget_seconds = 0.0;
  /** Time of the call, with the device's. */
  double seconds = 0.0;
  /** Expected time of a whole sample after an edit. Empty: not known. */
  std::optional<double> whole_seconds;

  /** One line that names the lowered quality and the reason. */
  [[nodiscard]] std::string text() const;
};

/**
 * Draws the picture of a viewport within a time for each call, so that a host keeps its frame rate. BudgetController
 * has the rules. The first call after an edit shows a whole picture. If a sample of the picture takes too long, it is a
 * preview: by an engine and a viewport of their own, in a lower resolution, with smaller shadows and one sample in
 * which each lamp is shaded as a whole; it is scaled to the target. Lamps with a shadow size of their own
 * (scene::LampShadow) keep it. The first preview creates the engine, which compiles its programs.
 *
 * Later calls draw the samples of the picture, in parts. Until the first sample is whole, they show the preview again.
 * After stalled_calls_max calls that show the same preview, the next call draws a better preview: in the next larger
 * size, or with shadows of twice the edge. It lights the rest of the sample instead, if that is less work. Therefore
 * the picture of a scene without changes gets better at any speed of the machine. The complete picture is bit for bit
 * that of draw::Viewport::draw. A sample in which something transmits light is lit in one call, whatever its time. The
 * set-up of a sample is divided into its depth and parts of shadows: layers, or rows of large layers. The layers of one
 * exponential shadow are drawn in one call.
 *
 * Each call waits for the device, whose time it measures. Use one object for each viewport, on the device's thread and
 * not during a recording.
 */
class BudgetedPicture {
 public:
  /** Returns a time in seconds that never decreases. */
  using Clock = std::function<double()>;
  /** Calls that show the same preview before a better one is drawn. */
  static constexpr int stalled_calls_max = 4;

  /**
   * \a engine draws \a scene in \a viewport, and no other engine does. All three must outlive the object. \a clock:
   * empty: the system's.
   */
  BudgetedPicture(render_scene::RenderScene &scene, Engine &engine, draw::Viewport &viewport, Clock clock = {});

  /**
   * Begin a call, whose time is counted from now on. Call it before the sync of the viewport, which is a part of it.
   * \a budget_seconds: of the call, in [BudgetController::budget_min, BudgetController::budget_max]
   * \throws gpu::Error if it is not in this range
   */
  void begin(double budget_seconds);
  /**
   * Draw as much as the budget allows, and write the picture to \a target. The viewport must be synced, as for
   * draw::Viewport::draw. \pre begin
   * \return whether the picture is complete
   * \throws gpu::Error as draw::Viewport::draw
   */
  bool draw(const draw::View &view, const draw::Target &target);
  /** Write the picture of the last draw to \a target. \pre draw \throws gpu::Error as draw::Viewport::write */
  void write(const draw::Target &target);
  [[nodiscard]] const BudgetReport &report() const
  {
    return report_;
  }

 private:
  /** Time since begin(). */
  [[nodiscard]] double spent() const;
  /** The time of \a work until the device is done. */
  template <typename Work>
  double time_of(Work &&work);
  /** The viewport's samples are of \a view, by the engine. */
  [[nodiscard]] bool is_of(const draw::View &view) const;
  /** The same, and there is a whole one. */
  [[nodiscard]] bool has_samples(const draw::View &view) const;
  /** Draw the first picture after an edit. */
  void draw_first(const draw::View &view);
  /** \a is_planned: \a plan is the controller's, which learns the times. */
  void draw_preview(const draw::View &view, const BudgetController::FirstPlan &plan, bool is_planned);
  /** Draw a better preview, or the rest of the sample. \return false: there is no better preview */
  bool draw_better(const draw::View &view);
  /** Draw the next part of a sample: its set-up, or \a rows. \a spent_before: counted as a part of the set-up. */
  void draw_part(const draw::View &view, int rows, double spent_before = 0.0);
  /**
   * Draw the set-up of a sample, or the part that fits into the budget. \return false if no part fits beside the work
   * that the call has done
   */
  bool draw_setup(const draw::View &view, bool has_drawn);
  void refine(const draw::View &view);

  render_scene::RenderScene &scene_;
  Engine &engine_;
  draw::Viewport &viewport_;
  Clock clock_;
  BudgetController controller_;
  double begun_ = 0.0;
  double budget_ = 0.0;
  /** The time of the set-up that has begun. */
  double setup_seconds_ = 0.0;
  /** Created by the first preview; the viewport is destroyed first. */
  std::unique_ptr<Engine> preview_engine_;
  std::unique_ptr<draw::Viewport> preview_;
  /** Engine::settings_revision and the divisor that the preview's settings were made from. */
  std::optional<std::pair<std::uint64_t, int>> preview_settings_;
  /** draw::Viewport::restart_count and view of the picture that was shown last. Empty: none. */
  std::optional<std::uint64_t> shown_;
  draw::View shown_view_;
  bool is_preview_shown_ = false;
  /** preview_ shows this picture, as `preview_plan_` says. */
  bool has_preview_ = false;
  BudgetController::FirstPlan preview_plan_;
  /** The call has drawn a preview. */
  bool has_drawn_preview_ = false;
  /** Calls that have shown the same preview. */
  int stalled_calls_ = 0;
  /** Parts of shadows of the set-up that has begun. */
  int setup_parts_ = 0;
  BudgetReport report_;
};

}  // namespace gnomon::eevee
