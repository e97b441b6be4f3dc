// SPDX-License-Identifier: MIT
#include "cli_work_plan.hh"

#include "cli.hh"
#include "cli_exr_part.hh"
#include "cli_fingerprint.hh"
#include "cli_frames.hh"
#include "cli_output.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace gnomon::cli {

using nlohmann::json;

/** All of the plan but its hash. */
static json to_json(const WorkPlan &plan)
{
  json scenes = json::array();
  for (const PlannedScene &scene : plan.scenes) {
    scenes.push_back({{"path", scene.path}, {"fingerprint", scene.fingerprint}, {"pictures", scene.pictures}});
  }
  json parts = json::array();
  for (const WorkPart &part : plan.parts) {
    json entry = {{"scene", part.scene}, {"output", part.output}};
    for (const auto &[key, value] :
         {std::pair("frames", &part.frames), {"tile", &part.tile}, {"samples", &part.samples}}) {
      if (!value->empty()) {
        entry[key] = *value;
      }
    }
    parts.push_back(std::move(entry));
  }
  return {{"program", plan.program},           {"folder", plan.folder},         {"scenes", std::move(scenes)},
          {"arguments", plan.arguments},       {"frame_step", plan.frame_step}, {"part_seconds", plan.part_seconds},
          {"memory_bytes", plan.memory_bytes}, {"parts", std::move(parts)}};
}

static WorkPlan from_json(const json &document)
{
  WorkPlan plan;
  document.at("program").get_to(plan.program);
  document.at("folder").get_to(plan.folder);
  document.at("arguments").get_to(plan.arguments);
  document.at("frame_step").get_to(plan.frame_step);
  document.at("part_seconds").get_to(plan.part_seconds);
  document.at("memory_bytes").get_to(plan.memory_bytes);
  for (const json &scene : document.at("scenes")) {
    plan.scenes.push_back({scene.at("path"), scene.at("fingerprint"), scene.at("pictures")});
  }
  for (const json &part : document.at("parts")) {
    plan.parts.push_back({part.at("scene"), part.value("frames", ""), part.value("tile", ""), part.value("samples", ""),
                          part.at("output")});
  }
  return plan;
}

std::string WorkPlan::id() const
{
  return text_fingerprint(to_json(*this).dump());
}

double add_parts(WorkPlan &plan, const WorkOfScene &work, double target_seconds)
{
  const double picture_seconds = work.cost.sample_seconds * work.sample_count;
  // The start of the process is a part of each part's time; parts shorter than it would only cost more.
  const double seconds = std::max(target_seconds - work.cost.start_seconds, work.cost.start_seconds);
  const int tile_count = work.can_divide_pictures ? work.tile_count : 1;
  const double ranges = work.can_divide_pictures ? std::ceil(picture_seconds / tile_count / seconds) : 1.0;
  const int range_count = int(std::clamp(ranges, 1.0, double(work.sample_count)));
  const bool is_divided = tile_count * range_count > 1;
  const int frame_count = (work.last_frame - work.first_frame) / plan.frame_step + 1;
  const double frames = is_divided ? 1.0 : std::floor(seconds / picture_seconds);
  const int group_size = int(std::clamp(frames, 1.0, double(frame_count)));
  for (int first = 0; first < frame_count; first += group_size) {
    const int last = std::min(first + group_size, frame_count) - 1;
    const auto number = [&](int index) { return work.first_frame + index * plan.frame_step; };
    WorkPart part{work.scene, {}, {}, {}, work.pictures};
    if (work.is_animated) {
      part.frames =
          first == last ? fmt::format("{}", number(first)) : fmt::format("{}-{}", number(first), number(last));
    }
    if (!is_divided) {
      plan.parts.push_back(part);
      continue;
    }
    for (int tile = 0; tile < tile_count; tile++) {
      for (int range = 0; range < range_count; range++) {
        const auto sample = [&](int index) { return int(std::int64_t(work.sample_count) * index / range_count); };
        const std::filesystem::path picture = frame_name(work.pictures, number(first));
        std::string name = picture.stem().string();
        if (tile_count > 1) {
          part.tile = fmt::format("{}/{}", tile + 1, tile_count);
          name += fmt::format(".tile{}of{}", tile + 1, tile_count);
        }
        if (range_count > 1) {
          part.samples = fmt::format("{}-{}", sample(range), sample(range + 1) - 1);
          name += ".samples" + part.samples;
        }
        part.output = (picture.parent_path() / (name + ".exr")).string();
        plan.parts.push_back(part);
      }
    }
  }
  const int range_size = (work.sample_count + range_count - 1) / range_count;
  return work.cost.start_seconds + work.cost.sample_seconds * range_size * group_size / tile_count;
}

static FrameSequence frames_of(const WorkPlan &plan, const WorkPart &part, const std::string &output)
{
  return FrameSequence({.range = part.frames, .step = plan.frame_step}, output);
}

Metadata planned_metadata(const std::string &id, const std::string &name)
{
  return {{plan_metadata, id}, {planned_file_metadata, name}};
}

std::string planned_fault(const std::string &name, const std::string &id)
{
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(name, ignored)) {
    return name + (std::filesystem::exists(name, ignored) ? ": is no regular file" : ": is missing");
  }
  try {
    const Metadata metadata = read_exr_part(name, ExrContent::Header).metadata;
    if (metadata_value(metadata, plan_metadata) != id) {
      return name + ": is not of this plan";
    }
    const std::string planned = metadata_value(metadata, planned_file_metadata);
    if (planned != name) {
      return fmt::format("{}: is a copy of '{}' under another name", name, planned);
    }
    return metadata_value(metadata, checksum_metadata).empty() ? name + ": is damaged: it has no checksum" : "";
  }
  catch (const std::runtime_error &error) {
    return error.what();
  }
}

/** \throws std::exception if \a document has not the form that write_plan writes */
static WorkPlan checked_plan(const json &document)
{
  WorkPlan plan = from_json(document);
  if (document.at("id") != plan.id()) {
    throw std::runtime_error("was edited after `gnomon plan` wrote it");
  }
  for (const WorkPart &part : plan.parts) {
    if (part.scene >= plan.scenes.size()) {
      throw std::runtime_error("names a scene that it does not have");
    }
    for (const std::string &output : {part.output, plan.scenes[part.scene].pictures}) {
      static_cast<void>(frames_of(plan, part, output));
    }
  }
  return plan;
}

WorkPlan read_plan(const std::filesystem::path &path, const std::string &program)
{
  WorkPlan plan;
  try {
    output::require_readable(path);
    std::ifstream file(path);
    if (!file) {
      throw std::runtime_error(fmt::format("cannot be read: {}", std::strerror(errno)));
    }
    const json document = json::parse(file);
    document.at("program").get_to(plan.program);
    // Plans of other versions may have other members.
    if (plan.program == program) {
      plan = checked_plan(document);
    }
  }
  catch (const std::exception &error) {
    throw std::runtime_error(fmt::format("{}: not a plan: {}", path.string(), error.what()));
  }
  if (plan.program != program) {
    throw std::runtime_error(fmt::format("{}: is a plan of {}, and this is {}", path.string(), plan.program, program));
  }
  return plan;
}

void write_plan(const std::filesystem::path &path, const WorkPlan &plan)
{
  json document = to_json(plan);
  try {
    document["id"] = plan.id();
  }
  catch (const json::type_error &) {
    throw std::runtime_error(path.string() + ": cannot be written: a name of a scene or of its pictures is not UTF-8");
  }
  write_json(path, document, 1);
}

std::vector<std::string> files_of(const WorkPlan &plan, const WorkPart &part)
{
  const FrameSequence frames = frames_of(plan, part, part.output);
  std::vector<std::string> files;
  for (int i = 0; i < frames.count(); i++) {
    files.push_back(frames.path(i).string());
  }
  return files;
}

std::string picture_of(const WorkPlan &plan, const WorkPart &part)
{
  return frames_of(plan, part, plan.scenes[part.scene].pictures).path(0).string();
}

PartName::PartName(const std::string &text)
{
  const std::size_t colon = text.rfind(':');
  const char *end = text.data() + text.size();
  const char *first = colon == text.npos ? end : text.data() + colon + 1;
  const auto [after, error] = std::from_chars(first, end, index);
  if (first == end || error != std::errc() || after != end) {
    throw UsageError(fmt::format("--part '{}' is not PLAN.json:K with the number K of a part, from 0", text));
  }
  plan = text.substr(0, colon);
}

std::string frame_name(const std::string &pattern, int frame)
{
  const std::filesystem::path path(pattern);
  std::string name = path.filename().string();
  const std::size_t last = name.rfind('#');
  if (last == name.npos) {
    return pattern;
  }
  std::size_t first = last;
  while (first > 0 && name[first - 1] == '#') {
    first--;
  }
  const std::size_t width = last - first + 1;
  name.replace(first, width, fmt::format("{:0{}}", frame, width));
  return (path.parent_path() / name).string();
}

std::string scene_name(std::string pattern, const std::filesystem::path &scene)
{
  constexpr std::string_view placeholder = "{scene}";
  std::string name = scene.stem().string();
  std::replace(name.begin(), name.end(), '#', '_');
  for (std::size_t at = 0; (at = pattern.find(placeholder, at)) != pattern.npos; at += name.size()) {
    pattern.replace(at, placeholder.size(), name);
  }
  return pattern;
}

}  // namespace gnomon::cli
