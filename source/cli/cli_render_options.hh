// SPDX-License-Identifier: MIT
#pragma once

#include "cli_choice.hh"
#include "cli_debug.hh"
#include "cli_frames.hh"
#include "cli_setting_options.hh"
#include "cli_world.hh"

#include "render_display.hh"

#include <CLI/App.hpp>

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace gnomon::cli {

/** Options of `gnomon render`. Texts are checked by CLI11 or by check(). */
struct RenderOptions {
  /** The scenes of the command line. The other members describe one of them. */
  std::vector<std::string> scenes;
  std::string scene;
  std::string output;
  std::string size = "960x540";
  std::string camera;
  Changes<gltf::ImportOptions> import_changes;
  Changes<scene::Camera> camera_changes;
  /** Empty: the scene's files may be anywhere. */
  std::filesystem::path only_below;
  int samples = 16;
  /** Seconds for each picture; infinity without --time-limit, otherwise `samples` may be 0: no limit. */
  double seconds_max = std::numeric_limits<double>::infinity();
  /** "A-B": the samples to draw, of `samples`, counted from 0; empty: all. */
  std::string sample_range;
  /** "I/N": the I-th of N strips of rows from the top, counted from 1; empty: the whole picture. */
  std::string tile;
  FrameOptions frames;
  int repeat = 1;
  /** The changes by options to the settings that offline_settings chooses for `samples`. */
  Changes<eevee::Settings> changes;
  bool redraws_shadows = false;
  std::string debug;
  DebugView debug_view;
  std::string aov;
  Changes<render_scene::Display> display_changes;
  /** One of gpu::backend_names. */
  std::string backend = "auto";
  bool is_explained = false;
  std::string json;
  std::string trace;
  ChoiceOptions choice;
  bool is_strict = false;
  /** "PLAN.json:K": the options are those of a part of a plan; empty: none. */
  std::string part;
  /** The file of that plan. */
  std::filesystem::path plan;
  /** Time after which the work ends, s; infinity: none. */
  double stop_seconds = std::numeric_limits<double>::infinity();
  /** Whether an unfinished picture is written for `gnomon merge`. */
  bool has_checkpoint = false;
  bool has_progress_lines = false;
  WorldOptions world;
  /** "none", "world" or a radiance R,G,B. Empty: none, or light grey in a PNG that the default studio lights. */
  std::string background;
  /** The options without a row of settings that parts of one picture must have in common, as text. \see settings_text
   */
  std::string given_text;
  /** WorkPlan::id of --part; empty: none. */
  std::string plan_id;
  /** PlannedScene::fingerprint of --part. */
  std::string planned_scene;

  /** \throws UsageError where an option's value is invalid, or does not go with another option */
  void check() const;
  /** Whether the output is display-referred. */
  [[nodiscard]] bool is_png() const;
  /** Whether a rendered picture is written. The null backend has none. */
  [[nodiscard]] bool has_picture() const
  {
    return backend != "null";
  }
  [[nodiscard]] bool is_shadow_shown() const
  {
    return debug_view.kind == DebugView::Kind::Shadow;
  }
  [[nodiscard]] bool is_density_shown() const
  {
    return debug_view.kind == DebugView::Kind::Density;
  }
  /** Pixels. \throws UsageError where `size` is not a size */
  [[nodiscard]] glm::ivec2 size_px() const;
  /** The same as size_px(). \throws UsageError, also if \a device draws no picture of that size */
  [[nodiscard]] glm::ivec2 size_px(const gpu::Device &device) const;
  /** Whether only a part of the picture is rendered, to be joined with the others by `gnomon merge`. */
  [[nodiscard]] bool is_part() const
  {
    return !sample_range.empty() || !tile.empty();
  }
  /** The pixels of --tile; the whole picture without it. \throws UsageError where it is invalid */
  [[nodiscard]] gpu::Rectangle region() const;
  /** The first and the last sample to draw. \throws UsageError where --sample-range is invalid */
  [[nodiscard]] glm::ivec2 sample_bounds() const;
  [[nodiscard]] render_scene::Display display() const;
  [[nodiscard]] gltf::ImportOptions import_options() const;
  /** Without the background, which depends on the scene. */
  [[nodiscard]] eevee::Settings engine_settings() const;
  /**
   * The options that parts of one picture must have in common, with the values that the picture is made with: they may
   * come from an option, the number of samples or the scene. \a lens: the camera after the options were applied
   */
  [[nodiscard]] std::string settings_text(eevee::Settings settings, const scene::Camera &lens) const;
};

/** Settings of the engine that `gnomon render` has without options. */
[[nodiscard]] std::vector<Defaults<eevee::Settings>> setting_defaults();

/** Options of `gnomon render` that are no options of a plan: they are of one process, or say which part it renders. */
inline constexpr std::array process_options = {
    "--output", "--tile",    "--sample-range", "--resume",     "--repeat",     "--redraw-shadows", "--json",
    "--trace",  "--explain", "--part",         "--stop-after", "--checkpoint", "--progress",       "--backend"};

/** The sentences about options that do not go together, for the help of a command that has all that they name. */
[[nodiscard]] std::string exclusions_text(const CLI::App &command);

/** Adds the options to \a command, which fills \a options. Both must outlive the parsing. */
void add_render_options(CLI::App &command, RenderOptions &options);

}  // namespace gnomon::cli
