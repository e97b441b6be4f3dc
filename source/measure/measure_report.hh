// SPDX-License-Identifier: MIT
#pragma once

#include "measure_image_error.hh"
#include "measure_technique.hh"
#include "measure_technique_run.hh"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gnomon::measure {

/** Time and error of a picture. */
struct PictureReport {
  int sample_count = 0;
  /** One for each round. \see TechniqueTimes::picture_seconds */
  std::vector<double> seconds;
  ImageError error;
  /** Whether no other picture of the scene is both faster and nearer to the reference. */
  bool is_on_front = false;
};

struct TechniqueReport {
  Technique technique;
  std::vector<PictureReport> pictures;
  /** One for each round. */
  std::vector<std::map<std::string, double>> step_seconds;
  std::vector<LampError> lamps;
  std::size_t memory_bytes = 0;
  std::vector<std::string> limits;
  int lost_shadow_count = 0;
};

/** All measurements of a scene. */
struct SceneReport {
  /** Name of the scene's file without the extension. */
  std::string name;
  std::filesystem::path path;
  /** Hash of the scene's file and of the files it refers to. Measurements are valid only for the same hash. */
  std::string fingerprint;
  /** A description of the light from all around the scene; empty: none. */
  std::string world;
  /** RMSE of the reference due to its own noise. \see ReferencePicture::noise */
  double reference_noise = 0.0;
  double reference_seconds = 0.0;
  /** Warnings of the import and of the engine, such as features that are not drawn. */
  std::vector<std::string> warnings;
  std::vector<TechniqueReport> techniques;
};

/** Conditions and results of a run. A later run can continue from it. */
struct RunReport {
  std::string program;
  std::string commit;
  /** Hash of the program. */
  std::string build;
  std::string device;
  std::string machine;
  /** Start of the run, UTC. */
  std::string date;
  glm::ivec2 size_px{0};
  int rounds = 0;
  int reference_samples = 0;
  /** The setting of pictures and references. \see eevee::Settings */
  bool has_multiscatter = false;
  /** Wall time spent so far. */
  double seconds = 0.0;
  std::vector<SceneReport> scenes;
};

[[nodiscard]] double median(std::vector<double> values);
/** Half of the interquartile range, divided by the median. 0 for less than two values. */
[[nodiscard]] double spread(std::vector<double> values);

/** Median over the rounds of the device time of one step, or of the sum of all steps if \a step is "". */
[[nodiscard]] double step_seconds(const TechniqueReport &report, const std::string &step);

/** The error over the receivers of all lamps. Edge offsets are those of the worst lamp. */
[[nodiscard]] reference::VisibilityError all_lamps(const std::vector<LampError> &lamps);

/** Sets PictureReport::is_on_front by median time and RMSE. */
void find_front(SceneReport &report);

/** The exponent p in y ∝ x^-p by least squares. Empty for less than two points, or if a y is not above 0. */
[[nodiscard]] std::optional<double> convergence_order(const std::vector<glm::dvec2> &points);

struct Convergence {
  std::string technique;
  /** Order of wrong_fraction in the layer size, and of the RMSE in the number of samples at the largest size. */
  std::optional<double> visibility_by_size;
  std::optional<double> rmse_by_samples;
};

/** One for each Technique::name. */
[[nodiscard]] std::vector<Convergence> convergence(const SceneReport &report);

/** The value of `--specular`. */
[[nodiscard]] std::string specular_text(const RunReport &run);

/** A table for a terminal. */
[[nodiscard]] std::string to_text(const SceneReport &scene);
/** Quotes \a text as a field of a CSV file. */
[[nodiscard]] std::string csv_quoted(std::string text);
/** One row for each picture, after a header row. */
[[nodiscard]] std::string to_csv(const RunReport &run);
/** All members. A technique is stored by its label, without its settings. */
[[nodiscard]] nlohmann::json to_json(const RunReport &run);
/**
 * The inverse of to_json. Techniques are found by their label among report_techniques().
 * \throws std::exception if \a json is malformed or inconsistent.
 */
[[nodiscard]] RunReport run_from_json(const nlohmann::json &json);

/** File name of a picture in the run's folder. */
[[nodiscard]] std::string picture_file(const SceneReport &scene, const Technique &technique, int sample_count);
[[nodiscard]] std::string reference_file(const SceneReport &scene);

/** Reads a picture of the run: scene-linear, rows from the bottom. */
using ReadPicture = std::function<std::vector<glm::vec4>(const std::string &file)>;
/** Encodes display_bytes() as a PNG file. */
using MakePng = std::function<std::vector<std::byte>(glm::ivec2 size_px, std::span<const std::uint8_t> rgba)>;

/** A page with tables, plots of error against time with the Pareto front, and its pictures. */
[[nodiscard]] std::string to_html(const RunReport &run, const ReadPicture &read, const MakePng &make_png);

}  // namespace gnomon::measure
