// SPDX-License-Identifier: MIT
#pragma once

#include "measure_image_error.hh"
#include "measure_technique.hh"
#include "measure_visit.hh"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gnomon::measure {

/** A picture of a technique: what it takes, and how wrong it is. */
struct PictureReport {
  int sample_count = 0;
  /** One a round. \see VisitTimes::picture_seconds */
  std::vector<double> seconds;
  ImageError error;
  /** No other picture of the scene is both faster and nearer to the reference. */
  bool is_on_front = false;
};

struct TechniqueReport {
  Technique technique;
  std::vector<PictureReport> pictures;
  /** One a round. */
  std::vector<std::map<std::string, double>> step_seconds;
  std::vector<LampError> lamps;
  std::size_t memory_bytes = 0;
  std::vector<std::string> limits;
  int lost_shadow_count = 0;
};

/** All that was measured of a scene. */
struct SceneReport {
  /** Name of its file, without the extension. */
  std::string name;
  std::filesystem::path path;
  /** Hash of the file and those it names: what was measured is of no use for another. */
  std::string fingerprint;
  /** RMSE of the reference itself, by its two halves. */
  double reference_noise = 0.0;
  double reference_seconds = 0.0;
  /** Of the import and of the engine: what the pictures lack, for one. */
  std::vector<std::string> warnings;
  std::vector<TechniqueReport> techniques;
};

/** What a run measures, and what it needs to go on with another's results. */
struct RunReport {
  std::string program;
  std::string commit;
  /** Hash of the program. */
  std::string build;
  std::string device;
  std::string machine;
  /** Of the start, UTC. */
  std::string date;
  glm::ivec2 size_px{0};
  int rounds = 0;
  int reference_samples = 0;
  /** Wall time of all, spent so far. */
  double seconds = 0.0;
  std::vector<SceneReport> scenes;
};

[[nodiscard]] double median(std::vector<double> values);
/** Half of what lies between the quartiles, over the median. 0 for less than two values. */
[[nodiscard]] double spread(std::vector<double> values);

/** Device time of one step, median over the rounds; "" for all of them together. */
[[nodiscard]] double step_seconds(const TechniqueReport &report, const std::string &step);

/** Of all lamps as of one. Edge offsets: the worst lamp's. */
[[nodiscard]] reference::VisibilityError all_lamps(const std::vector<LampError> &lamps);

/** Set PictureReport::is_on_front, by median time and RMSE. */
void find_front(SceneReport &report);

/** p in y ∝ x^-p, by least squares; nothing for less than two points, or where a y is not above 0. */
[[nodiscard]] std::optional<double> convergence_order(const std::vector<glm::dvec2> &points);

struct Convergence {
  std::string technique;
  /** Wrong pixels of a lamp's shadow against the layers' size, and RMSE against the samples (of the largest size). */
  std::optional<double> visibility_by_size;
  std::optional<double> rmse_by_samples;
};

/** Of each name that techniques have. */
[[nodiscard]] std::vector<Convergence> convergence(const SceneReport &report);

/** A table for a terminal. */
[[nodiscard]] std::string to_text(const SceneReport &scene);
/** A text as a field of a CSV file. */
[[nodiscard]] std::string csv_quoted(std::string text);
/** One row a picture, with its head. */
[[nodiscard]] std::string to_csv(const RunReport &run);
/** All of it; settings are not in it but by the technique's name. */
[[nodiscard]] nlohmann::json to_json(const RunReport &run);
/**
 * What to_json made. Techniques are found by their label among report_techniques().
 * \throws std::exception where it is not that, or does not fit together.
 */
[[nodiscard]] RunReport run_from_json(const nlohmann::json &json);

/** Name of a picture's file in the run's folder. */
[[nodiscard]] std::string picture_file(const SceneReport &scene, const Technique &technique, int sample_count);
[[nodiscard]] std::string reference_file(const SceneReport &scene);

/** Reads a picture that the run has written: scene-linear, rows from the bottom. */
using ReadPicture = std::function<std::vector<glm::vec4>(const std::string &file)>;
/** \a png: makes a PNG file of display_bytes. */
using MakePng = std::function<std::vector<std::byte>(glm::ivec2 size_px, std::span<const std::uint8_t> rgba)>;

/** A page with tables, error against time with the front marked, and its pictures. */
[[nodiscard]] std::string to_html(const RunReport &run, const ReadPicture &read, const MakePng &make_png);

}  // namespace gnomon::measure
