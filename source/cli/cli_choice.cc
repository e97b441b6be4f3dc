// SPDX-License-Identifier: MIT
#include "cli_choice.hh"

#include "cli.hh"
#include "cli_fingerprint.hh"
#include "cli_origin.hh"

#include "output_file.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace gnomon::cli {

namespace fs = std::filesystem;

Chooser::Chooser(const ChoiceOptions &options, gpu::Device &device, const scene::Scene &scene,
                 const scene::PlacedCamera &camera, glm::ivec2 size_px, bool has_multiscatter)
    : options_(options),
      scene_(scene),
      camera_(camera),
      size_px_(size_px),
      has_multiscatter_(has_multiscatter),
      tracer_(scene)
{
  if (options.error_max > 0.0) {
    requirement_.error_max = options.error_max;
  }
  else {
    requirement_.seconds_max = 1e-3 * options.milliseconds_max;
  }
  for (const std::string &line : reference::untraced_parts(scene)) {
    print_message("gnomon: warning: {}\n", line);
  }
  std::vector<measure::Model> models;
  if (!options.report_folder.empty()) {
    models = models_of_report(device);
    source_ = fmt::format("report {}", options.report_folder);
  }
  if (models.empty()) {
    measure::Pilot pilot = measure::run_pilot(device, scene, camera, size_px, tracer_, requirement_, has_multiscatter_);
    models = std::move(pilot.models);
    source_ = fmt::format("a pilot of {} pictures in {:.1f} s", pilot.picture_count, pilot.seconds);
  }
  choice_ = measure::choose(models, requirement_);
}

std::vector<measure::Model> Chooser::models_of_report(const gpu::Device &device) const
{
  const fs::path path = fs::path(options_.report_folder) / "report.json";
  output::require_readable(path, path.string() + ": ");
  std::ifstream file(path);
  if (!file) {
    throw std::runtime_error(fmt::format("{}: cannot be read", path.string()));
  }
  measure::RunReport run;
  try {
    run = measure::run_from_json(nlohmann::json::parse(file));
  }
  catch (const std::exception &error) {
    throw std::runtime_error(fmt::format("{}: is not a report: {}", path.string(), error.what()));
  }
  const auto found = std::ranges::find(run.scenes, scene_fingerprint(scene_), &measure::SceneReport::fingerprint);
  const auto unknown = [&](const std::string &why) {
    print_message("gnomon: warning: {}: {}; running a pilot instead\n", path.string(), why);
    return std::vector<measure::Model>();
  };
  if (found == run.scenes.end()) {
    return unknown(fmt::format("{} is not in it, or has changed", scene_.path));
  }
  if (run.size_px != size_px_ || camera_.node != scene_.placed_cameras().front().node) {
    return unknown(fmt::format("it has pictures of {}x{} by the first camera only", run.size_px.x, run.size_px.y));
  }
  const Origin here = origin();
  if (run.build != program_fingerprint() || run.device != device.description() || run.machine != here.machine) {
    return unknown("its times are those of another build, machine or driver");
  }
  if (run.has_multiscatter != has_multiscatter_) {
    return unknown(fmt::format("its pictures have --specular {}", measure::specular_text(run)));
  }
  const bool has_lamp_settings = std::ranges::any_of(tracer_.lamps(), [](const scene::Lamp &lamp) {
    return lamp.shadow.kind != scene::ShadowKind::None && lamp.shadow != scene::LampShadow();
  });
  if (has_lamp_settings) {
    return unknown("the scene has per-lamp shadow settings, which reports ignore");
  }
  return measure::models_from(*found);
}

void Chooser::measure(std::span<const glm::vec4> picture, double seconds)
{
  measured_seconds_ = seconds;
  constexpr int pixel_count = 4096;
  constexpr int sample_count = 64;
  const measure::PixelSample sample(tracer_, camera_, size_px_, picture, pixel_count, sample_count, 1,
                                    has_multiscatter_);
  measured_ = sample.error(picture);
}

std::string Chooser::requirement_text() const
{
  return requirement_.error_max ? fmt::format("RMSE {}", *requirement_.error_max)
                                : fmt::format("{} ms", 1e3 * *requirement_.seconds_max);
}

std::vector<std::string> Chooser::limits() const
{
  std::vector<std::string> limits;
  if (!choice_.is_met) {
    limits.push_back(fmt::format("{} required; the nearest is RMSE {:.5f} in {:.1f} ms", requirement_text(),
                                 choice_.predicted_error.rmse, 1e3 * choice_.predicted_seconds));
  }
  else if (requirement_.error_max && measured_.rmse - 2.0 * measured_.standard_error > *requirement_.error_max) {
    limits.push_back(fmt::format("{} required; RMSE {:.5f} was measured", requirement_text(), measured_.rmse));
  }
  else if (requirement_.seconds_max && measured_seconds_ > *requirement_.seconds_max) {
    limits.push_back(
        fmt::format("{} required; the first picture took {:.1f} ms", requirement_text(), 1e3 * measured_seconds_));
  }
  return limits;
}

void Chooser::print_choice() const
{
  fmt::print("for {}: {}, {} samples; expected RMSE {:.5f} ± {:.5f} in {:.1f} ms, by {}\n", requirement_text(),
             label(choice_.technique), choice_.sample_count, choice_.predicted_error.rmse,
             choice_.predicted_error.standard_error, 1e3 * choice_.predicted_seconds, source_);
  if (!choice_.technique.options.empty()) {
    fmt::print("to repeat: gnomon render {} --samples {}\n", choice_.technique.options, choice_.sample_count);
  }
}

void Chooser::print_measured() const
{
  fmt::print("measured: RMSE {:.5f} ± {:.5f} against ray tracing at a sample of pixels, first picture in {:.1f} ms\n",
             measured_.rmse, measured_.standard_error, 1e3 * measured_seconds_);
}

nlohmann::json Chooser::to_json() const
{
  return {{"technique", choice_.technique.name},
          {"size_px", choice_.technique.size_px},
          {"options", choice_.technique.options},
          {"samples", choice_.sample_count},
          {"source", source_},
          {"met", choice_.is_met},
          {"predicted_seconds", choice_.predicted_seconds},
          {"predicted_rmse", choice_.predicted_error.rmse},
          {"predicted_rmse_standard_error", choice_.predicted_error.standard_error},
          {"measured_seconds", measured_seconds_},
          {"measured_rmse", measured_.rmse},
          {"measured_rmse_standard_error", measured_.standard_error}};
}

}  // namespace gnomon::cli
