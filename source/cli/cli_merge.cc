// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_exr_part.hh"
#include "cli_origin.hh"
#include "cli_output.hh"
#include "cli_work_plan.hh"

#include "scene_parallel.hh"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string_view>
#include <thread>

namespace gnomon::cli {

namespace {

struct MergeOptions {
  std::vector<std::string> parts;
  std::string output;
  /** Empty: the parts and the output are given. */
  std::string plan;
  /** Whether the parts of the plan are checked, and nothing is written. */
  bool is_checked_only = false;
};

/** Metadata that may differ between the parts of one picture. */
bool is_of_part(const std::string &name)
{
  return name == share_metadata || name == range_metadata || name == "gnomon:device" || name == plan_metadata ||
         name == planned_file_metadata || name == checksum_metadata;
}

/** Leaves out the options that two lists of options begin with and end with. */
void drop_shared_options(std::string &a, std::string &b)
{
  constexpr std::string_view option = " --";
  const auto in_a = std::ranges::mismatch(a, b).in1;
  const auto shared_count = std::size_t(in_a - a.begin());
  const std::size_t begin = shared_count == 0 ? a.npos : a.rfind(option, shared_count - 1);
  if (begin != a.npos) {
    a.erase(0, begin + 1);
    b.erase(0, begin + 1);
  }
  const auto from_end = std::mismatch(a.rbegin(), a.rend(), b.rbegin(), b.rend());
  const auto count = std::size_t(from_end.first - a.rbegin());
  const std::size_t end = a.find(option, a.size() - count);
  if (end != a.npos) {
    b.erase(b.size() - (a.size() - end));
    a.erase(end);
  }
}

/** \throws std::runtime_error naming \a path if it is not a part of the same picture as \a first */
void check_same_picture(const std::string &path, const ExrPart &part, const std::string &first_path,
                        const ExrPart &first)
{
  const auto fail = [&](const std::string &what, std::string value, std::string first_value) {
    drop_shared_options(value, first_value);
    throw std::runtime_error(fmt::format("{}: not a part of the same picture as {}: {} is '{}', not '{}'", path,
                                         first_path, what, value, first_value));
  };
  const auto size_text = [](glm::ivec2 size_px) { return fmt::format("{}x{}", size_px.x, size_px.y); };
  if (part.whole_size_px != first.whole_size_px) {
    fail("the size of the picture", size_text(part.whole_size_px), size_text(first.whole_size_px));
  }
  const auto names_of = [](const ExrPart &one) {
    std::vector<std::string> names;
    std::ranges::transform(one.channels, std::back_inserter(names), [](const auto &channel) { return channel.first; });
    return fmt::format("{}", fmt::join(names, ", "));
  };
  if (names_of(part) != names_of(first)) {
    fail("the list of channels", names_of(part), names_of(first));
  }
  std::set<std::string> names;
  for (const ExrPart *one : {&part, &first}) {
    for (const auto &[name, value] : one->metadata) {
      if (name.starts_with("gnomon:") && !is_of_part(name)) {
        names.insert(name);
      }
    }
  }
  const auto check = [&](const std::string &name) {
    // The folder of the scene may differ between machines.
    const auto value_of = [&](const ExrPart &one) {
      const std::string value = metadata_value(one.metadata, name);
      return name == "gnomon:scene" ? std::filesystem::path(value).filename().string() : value;
    };
    if (value_of(part) != value_of(first)) {
      fail(name, value_of(part), value_of(first));
    }
  };
  // A setting says more than the fingerprint that it changes.
  const std::string content = "gnomon:content";
  names.erase(content);
  std::ranges::for_each(names, check);
  check(content);
}

/** Share of the picture's samples that \a part contains, in (0, 1]. */
double share_of(const std::string &path, const ExrPart &part)
{
  const std::string text = metadata_value(part.metadata, share_metadata);
  double share = 1.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), share);
  if (!text.empty() &&
      (error != std::errc() || end != text.data() + text.size() || !(share > 0.0 && share <= 1.0 + 1e-9))) {
    throw std::runtime_error(fmt::format("{}: {} '{}' is not a share from 0 to 1", path, share_metadata, text));
  }
  return share;
}

/** The samples of \a part, from the first to the last. A file without a range contains all samples. */
glm::ivec2 samples_of(const std::string &path, const ExrPart &part)
{
  const std::string text = metadata_value(part.metadata, range_metadata);
  glm::ivec2 range{0, std::numeric_limits<int>::max()};
  const char *end = text.data() + text.size();
  const auto [middle, first_error] = std::from_chars(text.data(), end, range.x);
  const bool has_last = first_error == std::errc() && middle != end && *middle == '-';
  const auto [after, last_error] = std::from_chars(has_last ? middle + 1 : end, end, range.y);
  if (!text.empty() && (!has_last || last_error != std::errc() || after != end)) {
    throw std::runtime_error(fmt::format("{}: {} '{}' is not A-B", path, range_metadata, text));
  }
  return range;
}

bool is_whole(const std::string &path, const ExrPart &part)
{
  return part.size_px == part.whole_size_px && metadata_value(part.metadata, range_metadata).empty() &&
         share_of(path, part) >= 1.0;
}

/** \throws std::runtime_error if both parts contain a sample of a pixel. */
void check_disjoint(const std::string &path, const ExrPart &part, const std::string &other_path, const ExrPart &other)
{
  const auto overlap = [](int first, int end, int other_first, int other_end) {
    return first < other_end && other_first < end;
  };
  const glm::ivec2 range = samples_of(path, part);
  const glm::ivec2 other_range = samples_of(other_path, other);
  const glm::ivec2 end_px = part.first_px + part.size_px;
  const glm::ivec2 other_end_px = other.first_px + other.size_px;
  if (overlap(part.first_px.x, end_px.x, other.first_px.x, other_end_px.x) &&
      overlap(part.first_px.y, end_px.y, other.first_px.y, other_end_px.y) && range.x <= other_range.y &&
      other_range.x <= range.y) {
    throw std::runtime_error(fmt::format("{} and {} contain the same samples", path, other_path));
  }
}

/** Pictures of several channels, whose pixels are sums over parts. */
class Merger {
 public:
  explicit Merger(const ExrPart &first) : whole_size_px_(first.whole_size_px)
  {
    for (const auto &[name, values] : first.channels) {
      sums_[name].resize(pixel_count());
    }
    shares_.resize(pixel_count());
  }

  void add(const std::string &path, const ExrPart &part)
  {
    const double share = share_of(path, part);
    if (share < 1.0 - share_tolerance) {
      for (const auto &[name, values] : part.channels) {
        if (name.size() != 1 || std::string_view("RGBA").find(name[0]) == std::string_view::npos) {
          throw std::runtime_error(fmt::format(
              "{}: channel {} of a range of samples cannot be merged: only R, G, B and A are means of samples", path,
              name));
        }
      }
    }
    for (int y = 0; y < part.size_px.y; y++) {
      const std::size_t row =
          std::size_t(part.first_px.y + y) * std::size_t(whole_size_px_.x) + std::size_t(part.first_px.x);
      for (int x = 0; x < part.size_px.x; x++) {
        shares_[row + std::size_t(x)] += share;
      }
      for (const auto &[name, values] : part.channels) {
        std::vector<double> &sum = sums_.at(name);
        const std::size_t part_row = std::size_t(y) * std::size_t(part.size_px.x);
        for (std::size_t x = 0; x < std::size_t(part.size_px.x); x++) {
          sum[row + x] += share * double(values[part_row + x]);
        }
      }
    }
  }

  /** \throws std::runtime_error if samples of a pixel are missing */
  [[nodiscard]] ExrPart merged() const
  {
    for (std::size_t i = 0; i < shares_.size(); i++) {
      if (std::abs(shares_[i] - 1.0) > share_tolerance) {
        throw std::runtime_error(
            fmt::format("pixel ({}, {}) from the upper left has {:.6g} of its samples: a part of the "
                        "picture is missing",
                        i % std::size_t(whole_size_px_.x), i / std::size_t(whole_size_px_.x), shares_[i]));
      }
    }
    ExrPart whole{whole_size_px_, whole_size_px_, {0, 0}, {}, {}};
    for (const auto &[name, sum] : sums_) {
      whole.channels[name].assign(sum.begin(), sum.end());
    }
    return whole;
  }

 private:
  /** The shares are printed and read as text, and added up in double. */
  static constexpr double share_tolerance = 1e-6;

  [[nodiscard]] std::size_t pixel_count() const
  {
    return std::size_t(whole_size_px_.x) * std::size_t(whole_size_px_.y);
  }

  glm::ivec2 whole_size_px_;
  std::map<std::string, std::vector<double>> sums_;
  std::vector<double> shares_;
};

/** Names the devices if the parts were drawn by several, which differ in the last bits. */
void warn_of_devices(const std::vector<std::string> &paths, const std::vector<ExrPart> &headers)
{
  const std::string first = metadata_value(headers.front().metadata, "gnomon:device");
  for (std::size_t i = 1; i < headers.size(); i++) {
    const std::string device = metadata_value(headers[i].metadata, "gnomon:device");
    if (device != first) {
      print_message(
          "gnomon: warning: the parts were drawn by several devices, whose pixels may differ: {} by '{}', {} by '{}'\n",
          paths.front(), first, paths[i], device);
      return;
    }
  }
}

/**
 * The picture of \a paths. \throws std::runtime_error if they are not all parts of one picture, each once
 */
ExrPart merge_parts(const std::vector<std::string> &paths)
{
  // The headers are compared first, so that memory is only allocated for a picture whose pixels are all there.
  std::vector<ExrPart> headers;
  std::int64_t pixel_count = 0;
  for (std::size_t i = 0; i < paths.size(); i++) {
    headers.push_back(read_exr_part(paths[i], ExrContent::Header));
    if (paths.size() > 1 && is_whole(paths[i], headers[i])) {
      throw std::runtime_error(fmt::format("{}: is a whole picture, not a part", paths[i]));
    }
    check_same_picture(paths[i], headers[i], paths.front(), headers.front());
    for (std::size_t other = 0; other < i; other++) {
      check_disjoint(paths[other], headers[other], paths[i], headers[i]);
    }
    pixel_count += std::int64_t(headers[i].size_px.x) * headers[i].size_px.y;
  }
  warn_of_devices(paths, headers);
  const ExrPart &first = headers.front();
  if (pixel_count < std::int64_t(first.whole_size_px.x) * first.whole_size_px.y) {
    throw std::runtime_error(fmt::format("the parts have {} pixels, and the picture has {}x{}: a part is missing",
                                         pixel_count, first.whole_size_px.x, first.whole_size_px.y));
  }
  Merger merger(first);
  for (const std::string &path : paths) {
    merger.add(path, read_exr_part(path));
  }
  ExrPart whole = merger.merged();
  std::ranges::copy_if(first.metadata, std::back_inserter(whole.metadata),
                       [](const auto &entry) { return !is_of_part(entry.first); });
  return whole;
}

/** \return Status::NonFinite, with a message, if the picture has values that are not finite; it is then not written */
Status write_merged(const std::string &path, const ExrPart &whole)
{
  std::size_t non_finite_count = 0;
  for (const auto &[name, values] : whole.channels) {
    non_finite_count += std::size_t(std::ranges::count_if(values, [](float value) { return !std::isfinite(value); }));
  }
  if (non_finite_count > 0) {
    print_message("gnomon: {} values of the merged picture are not finite; not written\n", non_finite_count);
    return Status::NonFinite;
  }
  write_exr_part(path, whole);
  return Status::Done;
}

Status merge(const MergeOptions &options)
{
  if (options.parts.empty() || options.output.empty()) {
    throw UsageError("merge: parts and -o OUT.exr, or --plan PLAN.json, are required");
  }
  if (std::filesystem::path(options.output).extension() != ".exr") {
    throw UsageError(fmt::format("-o '{}' does not end in .exr", options.output));
  }
  output::Roles roles;
  for (const std::string &part : options.parts) {
    roles.add_input(part, "the part");
  }
  roles.add_output(options.output, "-o");
  keep_text_from(roles);
  const Status status = write_merged(options.output, merge_parts(options.parts));
  if (status == Status::Done) {
    fmt::print("{}\n", std::filesystem::absolute(options.output).lexically_normal().string());
  }
  return status;
}

/** A file of a plan. */
struct PlannedFile {
  /** Index of WorkPlan::parts. */
  std::size_t part = 0;
  std::string name{};
  /** The result of planned_fault. */
  std::string fault{};
};

/** Sets PlannedFile::fault. */
void find_faults(std::vector<PlannedFile> &files, const std::string &id)
{
  // Each thread has a file in memory.
  constexpr unsigned thread_count_max = 8;
  const unsigned thread_count = std::clamp(std::thread::hardware_concurrency(), 1U, thread_count_max);
  scene::parallel_for(files.size(), thread_count,
                      [&](std::size_t i) { files[i].fault = planned_fault(files[i].name, id); });
}

/** The files that a plan's parts write. */
struct PlannedFiles {
  std::vector<PlannedFile> files;
  /** The files of each divided picture. */
  std::map<std::string, std::vector<std::string>> divided;
  /** Pictures of the plan, divided or not. */
  std::size_t picture_count = 0;
};

PlannedFiles planned_files(const WorkPlan &plan)
{
  PlannedFiles planned;
  for (std::size_t i = 0; i < plan.parts.size(); i++) {
    for (const std::string &name : files_of(plan, plan.parts[i])) {
      if (plan.parts[i].is_of_picture()) {
        planned.divided[picture_of(plan, plan.parts[i])].push_back(name);
      }
      else {
        planned.picture_count++;
      }
      planned.files.push_back({.part = i, .name = name});
    }
  }
  planned.picture_count += planned.divided.size();
  return planned;
}

/**
 * Leaves out the pictures that an earlier merge has joined, and their parts, which may have been deleted since.
 * \return the faults of joined pictures that are damaged
 */
std::vector<std::string> leave_out_joined(PlannedFiles &planned, const std::string &id)
{
  std::vector<PlannedFile> pictures;
  for (const auto &[picture, names] : planned.divided) {
    pictures.push_back({.name = picture});
  }
  find_faults(pictures, id);
  std::set<std::string> not_needed;
  std::vector<std::string> faults;
  for (const PlannedFile &picture : pictures) {
    if (picture.fault.empty()) {
      const std::vector<std::string> &names = planned.divided.at(picture.name);
      not_needed.insert(names.begin(), names.end());
      planned.divided.erase(picture.name);
    }
    else if (std::error_code ignored; std::filesystem::exists(picture.name, ignored)) {
      faults.push_back(picture.fault);
    }
  }
  std::erase_if(planned.files, [&](const PlannedFile &file) { return not_needed.contains(file.name); });
  return faults;
}

/** Checks all parts of a plan, and joins those of pictures that are divided. */
Status merge_plan(const std::string &path, bool is_checked_only)
{
  const WorkPlan plan = read_plan(path, program_name());
  std::filesystem::current_path(std::filesystem::absolute(path).parent_path() / plan.folder);
  const std::string id = plan.id();
  PlannedFiles planned = planned_files(plan);
  const std::vector<std::string> joined_faults = leave_out_joined(planned, id);
  find_faults(planned.files, id);
  std::size_t fault_count = 0;
  for (const PlannedFile &file : planned.files) {
    if (!file.fault.empty()) {
      print_message("gnomon: part {}: {}\n", file.part, file.fault);
      fault_count++;
    }
  }
  if (fault_count > 0) {
    for (const std::string &fault : joined_faults) {
      print_message("gnomon: {}\n", fault);
    }
    print_message("gnomon: {}: {} files are missing or damaged; render their parts again\n", path, fault_count);
    return Status::Failed;
  }
  if (!is_checked_only) {
    for (const auto &[picture, names] : planned.divided) {
      ExrPart whole = merge_parts(names);
      std::ranges::copy(planned_metadata(id, picture), std::back_inserter(whole.metadata));
      if (const Status status = write_merged(picture, whole); status != Status::Done) {
        return status;
      }
    }
  }
  fmt::print("{}: {} pictures are complete\n", path, planned.picture_count);
  return Status::Done;
}

}  // namespace

void add_merge(CLI::App &app, Status &status)
{
  CLI::App *command = app.add_subcommand(
      "merge",
      "Join the parts of one picture from `gnomon render --tile` and `--sample-range`, or check and join the "
      "files of a plan of `gnomon plan`");
  auto options = std::make_shared<MergeOptions>();
  CLI::Option *parts = command->add_option("parts", options->parts, "EXR files of all parts");
  CLI::Option *output = command->add_option("-o,--output", options->output, "OUT.exr: the whole picture");
  CLI::Option *plan =
      command
          ->add_option(
              "--plan", options->plan,
              "PLAN.json of `gnomon plan`: check that all its parts are there, and join those of divided pictures")
          ->excludes(parts)
          ->excludes(output);
  command->add_flag("--check", options->is_checked_only, "Only name the parts of the plan that are missing or damaged")
      ->needs(plan);
  command->callback([options, &status] {
    status = options->plan.empty() ? merge(*options) : merge_plan(options->plan, options->is_checked_only);
  });
}

}  // namespace gnomon::cli
