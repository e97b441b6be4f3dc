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

/** An axis of the stored order, as "-Y 32" states it. */
struct Axis {
  bool is_reversed = false;
  char name = '\0';
  std::uint32_t length = 0;
};

/** Removes an axis from the start of \a line. Its length is 0 if there is none. */
Axis take_axis(std::string_view &line)
{
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  Axis axis;
  const bool is_axis = line.size() > 3 && (line[0] == '+' || line[0] == '-') && (line[1] == 'X' || line[1] == 'Y');
  if (!is_axis) {
    return axis;
  }
  axis.is_reversed = line[0] == '-';
  axis.name = line[1];
  line.remove_prefix(2);
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  const auto [after, error] = std::from_chars(line.data(), line.data() + line.size(), axis.length);
  line.remove_prefix(std::size_t(after - line.data()));
  axis.length = error == std::errc() ? axis.length : 0;
  return axis;
}

/** \a text without blanks at its ends, over which Radiance's own programs pass, too. */
std::string_view without_blanks(std::string_view text)
{
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  return text.substr(0, text.find_last_not_of(" \t") + 1);
}

/** Reads the numbers of a line of the header into \a values. \return the count of those that are in the line */
std::size_t read_numbers(std::string_view numbers, std::span<double> values)
{
  std::size_t count = 0;
  while (count < values.size()) {
    numbers.remove_prefix(std::min(numbers.find_first_not_of(" \t"), numbers.size()));
    const auto [after, error] = std::from_chars(numbers.data(), numbers.data() + numbers.size(), values[count]);
    if (error != std::errc()) {
      break;
    }
    numbers.remove_prefix(std::size_t(after - numbers.data()));
    count++;
  }
  return count;
}

/** Multiplies \a exposure by the numbers of a line of the header, of which one stands for all three. */
void multiply(std::array<double, 3> &exposure, std::string_view numbers)
{
  std::array<double, 3> factors{};
  const std::size_t read_count = read_numbers(numbers, factors);
  const auto is_factor = [](double factor) { return factor > 0.0 && std::isfinite(factor); };
  const auto first_bad = std::find_if_not(factors.begin(), factors.begin() + std::ptrdiff_t(read_count), is_factor);
  const auto count = std::size_t(first_bad - factors.begin());
  if (count != 1 && count != factors.size()) {
    throw Error("has an EXPOSURE or a COLORCORR that is no number above 0");
  }
  for (std::size_t i = 0; i < factors.size(); i++) {
    exposure[i] *= factors[count == 1 ? 0 : i];
  }
}

/** Least number of bytes that store a line of \a length pixels. */
std::uint64_t line_bytes_min(std::uint64_t length)
{
  // The shortest encoding: one pixel, a run of 255 of it, and runs that are 256 times as long. Four bytes each.
  return length == 1 ? 4 : length <= 256 ? 8 : 12;
}

/** Rec. 709 from CIE XYZ (IEC 61966-2-1). */
std::array<double, 3> rgb_of_xyz(const std::array<double, 3> &xyz)
{
  return {3.2404542 * xyz[0] - 1.5371385 * xyz[1] - 0.4985314 * xyz[2],
          -0.9692660 * xyz[0] + 1.8760108 * xyz[1] + 0.0415560 * xyz[2],
          0.0556434 * xyz[0] - 0.2040259 * xyz[1] + 1.0572252 * xyz[2]};
}

}  // namespace

bool is_rec709(const std::array<double, 8> &primaries)
{
  constexpr std::array<double, 8> rec709 = {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290};
  // Files have three decimals or more.
  constexpr double rounding = 0.5e-3;
  return std::ranges::equal(primaries, rec709, [](double a, double b) { return std::abs(a - b) <= rounding; });
}

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
    const std::size_t equals = line.find('=');
    const std::string_view key = line.substr(0, equals);
    const std::string_view value = equals == line.npos ? std::string_view() : without_blanks(line.substr(equals + 1));
    if (key == "FORMAT") {
      is_xyz_ = value == "32-bit_rle_xyze";
      if (!is_xyz_ && value != "32-bit_rle_rgbe") {
        throw Error("has another format than 32-bit_rle_rgbe and 32-bit_rle_xyze");
      }
    }
    else if (key == "EXPOSURE" || key == "COLORCORR") {
      multiply(exposure_, value);
    }
    else if (key == "PRIMARIES") {
      std::array<double, 8> primaries{};
      has_other_primaries_ = read_numbers(value, primaries) < primaries.size() || !is_rec709(primaries);
    }
  }
  std::string_view line = take_line(text);
  const Axis outer = take_axis(line);
  const Axis inner = take_axis(line);
  if (outer.length == 0 || inner.length == 0 || outer.name == inner.name ||
      line.find_first_not_of(" \t") != line.npos) {
    throw Error("does not state its size, for example as -Y HEIGHT +X WIDTH");
  }
  has_columns_ = outer.name == 'X';
  const Axis &across = has_columns_ ? outer : inner;
  const Axis &up = has_columns_ ? inner : outer;
  width_ = across.length;
  height_ = up.length;
  is_from_right_ = across.is_reversed;
  is_from_bottom_ = !up.is_reversed;
  rest_ = file.last(text.size());
  // So that nothing is allocated for a part of a file.
  if (line_bytes_min(inner.length) > rest_.size() / outer.length) {
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

void RadianceDecoder::read_line(std::span<unsigned char> line)
{
  const std::size_t length = line.size() / 4;
  const std::span<const unsigned char> start = take(4);
  const bool has_channel_runs = length >= run_width_min && length <= run_width_max && start[0] == 2 && start[1] == 2 &&
                                start[2] <= run_length_max;
  if (!has_channel_runs) {
    read_pixel_runs(start, line);
    return;
  }
  if (256U * start[2] + start[3] != length) {
    throw Error("is damaged: a row has another width than the picture");
  }
  read_channel_runs(line);
}

void RadianceDecoder::read_channel_runs(std::span<unsigned char> line)
{
  const std::size_t length = line.size() / 4;
  for (std::size_t channel = 0; channel < 4; channel++) {
    std::span<unsigned char> left = line.subspan(channel * length, length);
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

void RadianceDecoder::read_pixel_runs(std::span<const unsigned char> first_pixel, std::span<unsigned char> line)
{
  const std::size_t length = line.size() / 4;
  std::span<const unsigned char> pixel = first_pixel;
  std::span<const unsigned char> last = first_pixel;
  unsigned shift = 0;
  for (std::size_t x = 0; x < length;) {
    if (x > 0 || shift > 0) {
      pixel = take(4);
    }
    // Pixels of (1, 1, 1) are never stored: their exponent would be larger.
    const bool is_run = x > 0 && pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1;
    const std::size_t count = is_run ? std::size_t(pixel[3]) << shift : 1;
    shift = is_run ? shift + 8 : 0;
    if (count > length - x || shift > 24) {
      throw Error("is damaged: a run does not end with its row");
    }
    last = is_run ? last : pixel;
    for (const std::size_t end = x + count; x < end; x++) {
      for (std::size_t channel = 0; channel < 4; channel++) {
        line[channel * length + x] = last[channel];
      }
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
  const bool is_plain = !is_xyz_ && exposure_ == std::array<double, 3>{1.0, 1.0, 1.0};
  const std::size_t line_count = has_columns_ ? width_ : height_;
  const std::size_t length = has_columns_ ? height_ : width_;
  std::vector<float> values(std::size_t(3) * width_ * height_);
  std::vector<unsigned char> line(4 * length);
  for (std::size_t i = 0; i < line_count; i++) {
    read_line(line);
    for (std::size_t k = 0; k < length; k++) {
      const std::size_t x = has_columns_ ? i : k;
      const std::size_t y = has_columns_ ? k : i;
      const std::size_t column = is_from_right_ ? width_ - 1 - x : x;
      const std::size_t row = is_from_bottom_ ? height_ - 1 - y : y;
      float *value = &values[3 * (row * width_ + column)];
      const float scale = scales[line[3 * length + k]];
      std::array<double, 3> exact{};
      for (std::size_t channel = 0; channel < 3; channel++) {
        value[channel] = scale * float(line[channel * length + k]);
        exact[channel] = double(value[channel]) / exposure_[channel];
      }
      if (!is_plain) {
        exact = is_xyz_ ? rgb_of_xyz(exact) : exact;
        // Colours outside of the primaries have negative values.
        std::ranges::transform(exact, value, [](double one) { return float(std::max(one, 0.0)); });
      }
    }
  }
  return values;
}

}  // namespace gnomon::image
