// SPDX-License-Identifier: MIT
#include "cli_frames.hh"

#include "cli.hh"
#include "cli_exr_part.hh"
#include "cli_work_plan.hh"
#include "output_file.hh"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <vector>

namespace gnomon::cli {

FrameSequence::FrameSequence(FrameOptions options, std::filesystem::path output)
    : options_(std::move(options)), output_(std::move(output))
{
  const std::string name = output_.filename().string();
  const bool has_place = name.find('#') != name.npos;
  if (!is_animated()) {
    if (has_place) {
      throw UsageError(fmt::format("'{}' has a # for a frame number, which needs --frames", output_.string()));
    }
    return;
  }
  const std::string &text = options_.range;
  const char *end = text.data() + text.size();
  const auto [after_first, first_error] = std::from_chars(text.data(), end, first_);
  const bool has_last = first_error == std::errc() && after_first != end && *after_first == '-';
  const auto [after_last, last_error] = std::from_chars(has_last ? after_first + 1 : text.data(), end, last_);
  if (first_error != std::errc() || last_error != std::errc() || after_last != end || first_ < 0 || last_ < first_) {
    throw UsageError(fmt::format("--frames '{}' is neither A-B nor A with whole numbers 0 <= A <= B", text));
  }
  if (options_.step < 1) {
    throw UsageError(fmt::format("--step {} is not 1 or more", options_.step));
  }
  constexpr std::int64_t count_max = std::int64_t(1) << 24U;
  if ((std::int64_t(last_) - first_) / options_.step + 1 > count_max) {
    throw UsageError(fmt::format("--frames '{}' are more than {} frames", text, count_max));
  }
  if (!name.empty() && count() > 1 && !has_place) {
    throw UsageError(
        fmt::format("'{}' has no # for the frame number; use a name such as frame_####.exr", output_.string()));
  }
}

std::filesystem::path FrameSequence::path(int index) const
{
  return is_animated() ? std::filesystem::path(frame_name(output_.string(), number(index))) : output_;
}

Metadata FrameSequence::metadata(int index) const
{
  return is_animated() ? Metadata{{"gnomon:frame", std::to_string(number(index))},
                                  {"gnomon:seconds", fmt::format("{:g}", seconds(index))}}
                       : Metadata();
}

bool FrameSequence::is_done(int index, glm::ivec2 size_px, const std::string &plan_id) const
{
  const std::filesystem::path file = path(index);
  if (!plan_id.empty()) {
    return planned_fault(file.string(), plan_id).empty();
  }
  if (!options_.is_resumed || !std::filesystem::is_regular_file(file)) {
    return false;
  }
  try {
    return read_picture(file).size_px == size_px;
  }
  catch (const std::runtime_error &) {
    // The file is incomplete, for example because the program was interrupted. Render it again.
    return false;
  }
}

void FrameSequence::remove_unfinished_files() const
{
  if (!options_.is_resumed) {
    return;
  }
  std::set<std::string> names;
  for (int i = 0; i < count(); i++) {
    names.insert(path(i).filename().string());
  }
  output::remove_unfinished(output_.parent_path(), names);
}

void FrameSequence::choose_animations(scene::Scene &scene)
{
  if (!is_animated()) {
    return;
  }
  std::set<std::string> names;
  for (const scene::Animation &one : scene.animations) {
    names.insert(one.name);
  }
  // Messages of the import about animations that it has left out, or parts of them.
  std::string faults;
  for (const std::string &warning : scene.warnings) {
    faults += warning.starts_with("animation") ? "; " + warning : "";
  }
  if (names.empty()) {
    throw std::runtime_error(fmt::format("{}: --frames needs an animation, and the scene has none{}{}", scene.path,
                                         faults.empty() ? "" : " that can be played", faults));
  }
  std::set<std::string> chosen;
  for (const std::string &name : options_.animations) {
    if (names.contains(name)) {
      chosen.insert(name);
    }
    else if (name == "all") {
      chosen = names;
    }
    else {
      throw std::runtime_error(
          fmt::format("{}: no animation '{}'; it has: {}{}", scene.path, name, fmt::join(names, ", "), faults));
    }
  }
  std::set<std::string> played;
  std::set<std::string> left_out;
  for (const scene::Animation &one : scene.animations) {
    if (!chosen.empty() && !chosen.contains(one.name)) {
      continue;
    }
    // Names cannot choose between animations of one name.
    const bool is_same_name = !chosen.empty() && played.contains(one.name);
    if (scene::join(animation_, one)) {
      played.insert(one.name);
    }
    else if (!is_same_name) {
      left_out.insert(one.name);
    }
  }
  if (left_out.empty()) {
    return;
  }
  const std::string message =
      fmt::format("animations that move the same as others before them: {}", fmt::join(left_out, ", "));
  if (!chosen.empty()) {
    throw std::runtime_error(fmt::format("{}: --animation names {}", scene.path, message));
  }
  scene.warnings.push_back(fmt::format("not played, as --animation names none: {}", message));
}

void FrameSequence::pose(scene::Scene &scene, int index, double place) const
{
  if (is_animated()) {
    const double shutter_seconds = options_.shutter / options_.frames_per_second;
    scene::pose(scene, animation_, seconds(index) + (place - 0.5) * shutter_seconds);
  }
}

}  // namespace gnomon::cli
