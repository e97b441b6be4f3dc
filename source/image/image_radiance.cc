// SPDX-License-Identifier: MIT
#include "image_radiance.hh"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace gnomon::image {

namespace {

/** Rows of other widths are never stored as runs. */
constexpr std::uint32_t run_width_min = 8;
constexpr std::uint32_t run_width_max = 32767;
constexpr std::size_t run_length_max = 127;

/** Removes a line and its end from the start of \a text. \throws Error if there is no end of a line */
std::string_view take_line(std::string_view &text)
{
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) {
    throw Error("is cut off");
  }
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  if (line.ends_with('\r')) {
    line.remove_suffix(1);
  }
  return line;
}

/** Removes \a name and a whole number greater than 0 from the start of \a line. 0: \a line starts otherwise. */
std::uint32_t take_edge(std::string_view &line, std::string_view name)
{
  std::uint32_t edge = 0;
  if (line.starts_with(name)) {
    line.remove_prefix(name.size());
    const char *end = line.data() + line.size();
    const auto [after, error] = std::from_chars(line.data(), end, edge);
    line.remove_prefix(std::size_t(after - line.data()));
    edge = error == std::errc() ? edge : 0;
  }
  return edge;
}

/** Least number of bytes that store a row. */
std::uint64_t row_bytes_min(std::uint64_t width)
{
  constexpr std::uint64_t channel_count = 4;
  const bool has_runs = width >= run_width_min && width <= run_width_max;
  // A run takes two bytes. Four bytes come before the runs of a row.
  const std::uint64_t run_count = (width + run_length_max - 1) / run_length_max;
  return channel_count * (has_runs ? 1 + 2 * run_count : width);
}

}  // namespace

bool is_radiance(std::span<const unsigned char> file)
{
  return file.size() >= 2 && file[0] == '#' && file[1] == '?';
}

RadianceDecoder::RadianceDecoder(std::span<const unsigned char> file)
{
  std::string_view text(reinterpret_cast<const char *>(file.data()), file.size());
  if (!is_radiance(file)) {
    throw Error("is not a Radiance picture");
  }
  for (std::string_view line = take_line(text); !line.empty(); line = take_line(text)) {
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe") {
      throw Error("has another format than 32-bit_rle_rgbe");
    }
  }
  std::string_view line = take_line(text);
  height_ = take_edge(line, "-Y ");
  width_ = take_edge(line, " +X ");
  if (height_ == 0 || width_ == 0 || !line.empty()) {
    throw Error("does not state its size as -Y HEIGHT +X WIDTH: rows from the top, pixels from the left");
  }
  rest_ = file.last(text.size());
  // So that nothing is allocated for a part of a file.
  if (row_bytes_min(width_) > rest_.size() / height_) {
    throw Error("is cut off");
  }
}

std::span<const unsigned char> RadianceDecoder::take(std::size_t count)
{
  if (count > rest_.size()) {
    throw Error("is cut off");
  }
  const auto taken = rest_.first(count);
  rest_ = rest_.subspan(count);
  return taken;
}

void RadianceDecoder::read_row(std::span<unsigned char> row)
{
  const std::span<const unsigned char> start = take(4);
  const bool has_runs = width_ >= run_width_min && width_ <= run_width_max && start[0] == 2 && start[1] == 2 &&
                        start[2] <= run_length_max;
  if (!has_runs) {
    const std::span<const unsigned char> others = take(4 * (std::size_t(width_) - 1));
    for (std::size_t channel = 0; channel < 4; channel++) {
      row[channel * width_] = start[channel];
      for (std::size_t x = 1; x < width_; x++) {
        row[channel * width_ + x] = others[4 * (x - 1) + channel];
      }
    }
    return;
  }
  if (256U * start[2] + start[3] != width_) {
    throw Error("is damaged: a row has another width than the picture");
  }
  for (std::size_t channel = 0; channel < 4; channel++) {
    std::span<unsigned char> left = row.subspan(channel * width_, width_);
    while (!left.empty()) {
      const std::size_t code = take(1)[0];
      const bool is_run = code > run_length_max + 1;
      const std::size_t count = is_run ? code - (run_length_max + 1) : code;
      if (count == 0 || count > left.size()) {
        throw Error("is damaged: a run does not end with its row");
      }
      const std::span<const unsigned char> values = take(is_run ? 1 : count);
      for (std::size_t x = 0; x < count; x++) {
        left[x] = values[is_run ? 0 : x];
      }
      left = left.subspan(count);
    }
  }
}

std::vector<float> RadianceDecoder::read_rgb()
{
  // The exponent e of a value m is that of m 2^(e - 136). With 0, the value is 0.
  std::array<float, 256> scales{};
  for (int e = 1; e < 256; e++) {
    scales[std::size_t(e)] = std::ldexp(1.0F, e - 136);
  }
  std::vector<float> values;
  values.reserve(std::size_t(3) * width_ * height_);
  std::vector<unsigned char> row(std::size_t(4) * width_);
  for (std::uint32_t y = 0; y < height_; y++) {
    read_row(row);
    for (std::size_t x = 0; x < width_; x++) {
      const float scale = scales[row[3 * std::size_t(width_) + x]];
      for (std::size_t channel = 0; channel < 3; channel++) {
        values.push_back(scale * float(row[channel * width_ + x]));
      }
    }
  }
  return values;
}

}  // namespace gnomon::image
