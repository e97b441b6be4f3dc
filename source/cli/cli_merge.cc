// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_exr_part.hh"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <stdexcept>

namespace gnomon::cli {

namespace {

struct MergeOptions {
  std::vector<std::string> parts;
  std::string output;
};

/** Metadata that may differ between the parts of one picture. */
bool is_of_part(const std::string &name)
{
  return name == share_metadata || name == part_metadata || name == "gnomon:device";
}

/** \throws std::runtime_error naming \a path if it is not a part of the same picture as \a first */
void check_same_picture(const std::string &path, const ExrPart &part, const std::string &first_path,
                        const ExrPart &first)
{
  const auto fail = [&](const std::string &what, const std::string &value, const std::string &first_value) {
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
  for (const std::string &name : names) {
    if (metadata_value(part.metadata, name) != metadata_value(first.metadata, name)) {
      fail(name, metadata_value(part.metadata, name), metadata_value(first.metadata, name));
    }
  }
}

/** Share of the picture's samples that \a part contains, in (0, 1]. */
double share_of(const std::string &path, const ExrPart &part)
{
  const std::string text = metadata_value(part.metadata, share_metadata);
  if (text.empty()) {
    return 1.0;
  }
  char *end = nullptr;
  const double share = std::strtod(text.c_str(), &end);
  if (*end != '\0' || !(share > 0.0 && share <= 1.0 + 1e-9)) {
    throw std::runtime_error(fmt::format("{}: {} '{}' is not a share from 0 to 1", path, share_metadata, text));
  }
  return share;
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

  /** \throws std::runtime_error if samples of a pixel are missing, or several parts contain them */
  [[nodiscard]] ExrPart merged() const
  {
    for (std::size_t i = 0; i < shares_.size(); i++) {
      if (std::abs(shares_[i] - 1.0) > share_tolerance) {
        throw std::runtime_error(
            fmt::format("pixel ({}, {}) from the upper left has {:.4g} of its samples: {}",
                        i % std::size_t(whole_size_px_.x), i / std::size_t(whole_size_px_.x), shares_[i],
                        shares_[i] < 1.0 ? "a part of the picture is missing" : "two parts contain the same samples"));
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

Status merge(const MergeOptions &options)
{
  if (std::filesystem::path(options.output).extension() != ".exr") {
    throw UsageError(fmt::format("-o '{}' does not end in .exr", options.output));
  }
  const ExrPart first = read_exr_part(options.parts.front());
  Merger merger(first);
  for (const std::string &path : options.parts) {
    const ExrPart part = read_exr_part(path);
    check_same_picture(path, part, options.parts.front(), first);
    merger.add(path, part);
  }
  ExrPart whole = merger.merged();
  std::ranges::copy_if(first.metadata, std::back_inserter(whole.metadata),
                       [](const auto &entry) { return !is_of_part(entry.first); });
  std::size_t non_finite_count = 0;
  for (const auto &[name, values] : whole.channels) {
    non_finite_count += std::size_t(std::ranges::count_if(values, [](float value) { return !std::isfinite(value); }));
  }
  if (non_finite_count > 0) {
    fmt::print(stderr, "gnomon: {} values of the merged picture are not finite; not written\n", non_finite_count);
    return Status::NonFinite;
  }
  write_exr_part(options.output, whole);
  fmt::print("{}\n", std::filesystem::absolute(options.output).lexically_normal().string());
  return Status::Done;
}

}  // namespace

void add_merge(CLI::App &app, Status &status)
{
  CLI::App *command =
      app.add_subcommand("merge", "Join the parts of one picture from `gnomon render --tile` and `--sample-range`");
  auto options = std::make_shared<MergeOptions>();
  command->add_option("parts", options->parts, "EXR files of all parts")->required();
  command->add_option("-o,--output", options->output, "OUT.exr: the whole picture")->required();
  command->callback([options, &status] { status = merge(*options); });
}

}  // namespace gnomon::cli
