// SPDX-License-Identifier: MIT
#include "cli_render_report.hh"

#include "cli_explain.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace gnomon::cli {

/** Numbers and switches are as in Python; enumerations are words. */
template <typename Value>
static nlohmann::json value_json(const Value &value)
{
  if constexpr (std::is_enum_v<Value>) {
    return scene::words<Value>[std::size_t(value)];
  }
  else if constexpr (std::is_same_v<Value, eevee::PcfKernel>) {
    return eevee::text_of(value);
  }
  else if constexpr (std::is_same_v<Value, eevee::Background>) {
    switch (value.kind) {
      case eevee::Background::Kind::None: return nullptr;
      case eevee::Background::Kind::World: return "world";
      case eevee::Background::Kind::Color: break;
    }
    return {value.color.r, value.color.g, value.color.b};
  }
  else {
    return value;
  }
}

/** The values of \a settings by their names. */
template <typename Settings>
static void add_settings(nlohmann::json &values, const Settings &settings)
{
  Settings::for_each_property([&](const auto &row) {
    using Value = typename std::decay_t<decltype(row)>::Value;
    const Value &value = row.access(settings);
    nlohmann::json &entry = values[std::string(row.name)];
    if constexpr (requires { value.has_value(); }) {
      if (value) {
        entry = value_json(*value);
      }
    }
    else {
      entry = value_json(value);
    }
  });
}

static nlohmann::json frames_json(const RenderResult &result)
{
  nlohmann::json frames = nlohmann::json::array();
  for (std::size_t i = 0; i < result.frame_seconds.size(); i++) {
    nlohmann::json steps = nlohmann::json::object();
    for (const eevee::StepTime &step : result.frame_steps[i]) {
      steps[step.step] = step.seconds;
    }
    frames.push_back({{"seconds", result.frame_seconds[i]},
                      {"step_seconds", steps},
                      {"lamps_updated", result.frame_shadows[i].lamps_updated},
                      {"faces_drawn", result.frame_shadows[i].faces_drawn},
                      {"faces_skipped", result.frame_shadows[i].faces_skipped},
                      {"caster_draws", result.frame_shadows[i].caster_draws}});
  }
  return frames;
}

static nlohmann::json counters_json(const gpu::Counters &c)
{
  return {{"passes", c.passes},
          {"draws", c.draws},
          {"instances", c.instances},
          {"triangles", c.triangles},
          {"shader_binds", c.shader_binds},
          {"shaders_made", c.shaders_made},
          {"shaders_from_cache", c.shaders_from_cache},
          {"pipelines_made", c.pipelines_made},
          {"textures_made", c.textures_made},
          {"upload_bytes", c.upload_bytes}};
}

nlohmann::json to_json(const RenderOptions &options, const eevee::Settings &settings, const scene::Scene &scene,
                       const scene::Camera &camera, const RenderResult &result, const Chooser *chooser)
{
  nlohmann::json values = nlohmann::json::object();
  add_settings(values, settings);
  add_settings(values, settings.shadow);
  add_settings(values, options.display());
  add_settings(values, options.import_options());
  nlohmann::json made = nlohmann::json::array();
  nlohmann::json left_out = nlohmann::json::array();
  for (const eevee::FrameItem &item : result.report.items) {
    (item.is_made ? made : left_out).push_back({{"what", item.what}, {"why", item.why}});
  }
  std::vector<std::string> warnings = scene.warnings;
  warnings.insert(warnings.end(), result.report.warnings.begin(), result.report.warnings.end());
  return {{"program", "gnomon " GNOMON_VERSION},
          {"scene", options.scene},
          {"output", options.output},
          {"camera", camera.name},
          {"size", options.size},
          {"samples", result.samples_drawn},
          {"seed", settings.seed},
          {"settings", values},
          {"device", result.device},
          {"import_seconds", result.import_seconds},
          {"device_seconds", result.device_seconds},
          {"sync_seconds", result.sync_seconds},
          {"frame_seconds", result.frame_seconds},
          {"frames", frames_json(result)},
          {"skipped_frames", result.skipped_frame_count},
          {"layer_seconds", result.layer_seconds},
          {"output_seconds", result.output_seconds},
          {"total_seconds", result.total_seconds},
          {"non_finite", result.non_finite_count},
          {"counters", counters_json(result.counters)},
          {"memory_bytes", result.memory_bytes},
          {"made", made},
          {"left_out", left_out},
          {"frame_tree", tree_json(result.report.tree)},
          {"choice", chooser ? chooser->to_json() : nlohmann::json()},
          {"limits", result.report.limits},
          {"warnings", warnings}};
}

void print_summary(const RenderOptions &options, const RenderResult &result)
{
  fmt::print("{}\n", result.device);
  fmt::print("import {:.1f} ms, device {:.1f} ms, set-up {:.1f} ms", 1e3 * result.import_seconds,
             1e3 * result.device_seconds, 1e3 * result.sync_seconds);
  if (!result.frame_seconds.empty()) {
    fmt::print(", first frame {:.1f} ms", 1e3 * result.frame_seconds.front());
  }
  if (result.frame_seconds.size() > 1) {
    std::vector<double> warm(result.frame_seconds.begin() + 1, result.frame_seconds.end());
    std::ranges::sort(warm);
    fmt::print(", warm frame {:.1f} ms (median of {})", 1e3 * warm[warm.size() / 2], warm.size());
  }
  if (!options.aov.empty()) {
    fmt::print(", layers {:.1f} ms", 1e3 * result.layer_seconds);
  }
  fmt::print(", output {:.1f} ms, all {:.1f} ms\n", 1e3 * result.output_seconds, 1e3 * result.total_seconds);
  if (result.skipped_frame_count > 0) {
    fmt::print("{} frames were skipped, because their files are complete\n", result.skipped_frame_count);
  }
  std::vector<std::string> made;
  for (const eevee::FrameItem &item : result.report.items) {
    if (item.is_made) {
      made.push_back(item.what);
    }
  }
  fmt::print("made: {}\n", fmt::join(made, ", "));
  if (!options.output.empty() && options.has_picture()) {
    fmt::print("{}\n", std::filesystem::absolute(options.output).lexically_normal().string());
  }
}

}  // namespace gnomon::cli
