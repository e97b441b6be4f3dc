// SPDX-License-Identifier: MIT
// Radiance HDR as in Ward, "Real Pixels", Graphics Gems II (1991), with the run lengths that Radiance writes since
// then.
#include "internal/cli_picture_formats.hh"

#include <fmt/format.h>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gnomon::cli {

namespace {

using Rgbe = std::array<unsigned char, 4>;

class HdrReader {
 public:
  explicit HdrReader(std::span<const unsigned char> file) : rest_(file) {}

  Picture read()
  {
    while (!line().empty()) {
    }
    const std::string resolution(line());
    Picture picture;
    if (std::sscanf(resolution.c_str(), "-Y %5d +X %5d", &picture.size_px.y, &picture.size_px.x) != 2) {
      throw std::runtime_error(fmt::format("its size is '{:.40}' and not -Y HEIGHT +X WIDTH", resolution));
    }
    check_edges(picture.size_px.x, picture.size_px.y);
    const auto width = std::size_t(picture.size_px.x);
    const auto height = std::size_t(picture.size_px.y);
    // A run of 127 values takes two bytes in each of four channels.
    if (width * height / 16 > rest_.size()) {
      throw std::runtime_error("is cut off");
    }
    picture.pixels.resize(width * height);
    std::vector<Rgbe> row(width);
    for (std::size_t y = height; y-- > 0;) {
      read_row(row);
      for (std::size_t x = 0; x < width; x++) {
        const auto [red, green, blue, exponent] = row[x];
        const float scale = exponent == 0 ? 0.0F : std::ldexp(1.0F, int(exponent) - (128 + 8));
        picture.pixels[y * width + x] = glm::vec4(glm::vec3(red, green, blue) * scale, 1.0F);
      }
    }
    return picture;
  }

 private:
  std::span<const unsigned char> rest_;

  std::span<const unsigned char> take(std::size_t count)
  {
    if (rest_.size() < count) {
      throw std::runtime_error("is cut off");
    }
    const std::span<const unsigned char> taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  /** Without its end. */
  std::string_view line()
  {
    const std::string_view text(reinterpret_cast<const char *>(rest_.data()), rest_.size());
    const std::size_t size = text.find('\n');
    (void)take(size == text.npos ? text.size() + 1 : size + 1);
    return text.substr(0, size);
  }

  void read_row(std::vector<Rgbe> &row)
  {
    const bool has_runs = row.size() >= 8 && row.size() < 0x8000 && rest_.size() >= 4 && rest_[0] == 2 &&
                          rest_[1] == 2 && rest_[2] < 0x80;
    if (!has_runs) {
      for (Rgbe &pixel : row) {
        std::ranges::copy(take(4), pixel.begin());
        if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
          throw std::runtime_error("is compressed in the way of Radiance before 1991, which is not read");
        }
      }
      return;
    }
    const std::span<const unsigned char> start = take(4);
    if ((std::size_t(start[2]) << 8U | start[3]) != row.size()) {
      throw std::runtime_error("is damaged: a row has another width");
    }
    for (std::size_t channel = 0; channel < 4; channel++) {
      read_channel(row, channel);
    }
  }

  void read_channel(std::vector<Rgbe> &row, std::size_t channel)
  {
    for (std::size_t x = 0; x < row.size();) {
      const std::size_t code = take(1)[0];
      const bool is_run = code > 128;
      const std::size_t count = is_run ? code - 128 : code;
      if (count == 0 || count > row.size() - x) {
        throw std::runtime_error("is damaged: a run does not fit its row");
      }
      const std::span<const unsigned char> values = take(is_run ? 1 : count);
      for (std::size_t i = 0; i < count; i++) {
        row[x++][channel] = values[is_run ? 0 : i];
      }
    }
  }
};

}  // namespace

Picture read_hdr_picture(std::span<const unsigned char> file)
{
  return HdrReader(file).read();
}

}  // namespace gnomon::cli
