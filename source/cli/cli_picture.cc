// SPDX-License-Identifier: MIT
#include "cli_picture.hh"

#include "internal/cli_picture_formats.hh"
#include "internal/cli_picture_module.hh"

#include "cli_output.hh"

#include "image_decoder.hh"
#include "image_png.hh"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>

namespace gnomon::cli {

namespace fs = std::filesystem;

using Bytes = std::vector<unsigned char>;

static Bytes rgb_png(glm::ivec2 size_px, std::span<const std::uint8_t> rgba, const Metadata &metadata)
{
  std::vector<std::uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  const auto width = std::size_t(size_px.x);
  for (auto y = std::size_t(size_px.y); y-- > 0;) {
    for (std::size_t x = 0; x < width; x++) {
      const std::uint8_t *pixel = &rgba[4 * (y * width + x)];
      rgb.insert(rgb.end(), pixel, pixel + 3);
    }
  }
  return image::png_file(std::uint32_t(size_px.x), std::uint32_t(size_px.y), 3, rgb, metadata);
}

void write_png(const fs::path &path, glm::ivec2 size_px, std::span<const std::uint8_t> rgba, const Metadata &metadata)
{
  Metadata all = {{"Software", "gnomon " GNOMON_VERSION}};
  all.insert(all.end(), metadata.begin(), metadata.end());
  write_atomically(path, [&](const fs::path &beside) {
    try {
      const Bytes bytes = rgb_png(size_px, rgba, all);
      std::ofstream file(beside, std::ios::binary);
      if (!file.write(reinterpret_cast<const char *>(bytes.data()), std::streamsize(bytes.size())).flush()) {
        throw image::Error("the disk may be full");
      }
    }
    catch (const image::Error &error) {
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), error.what()));
    }
  });
}

std::vector<std::byte> png_bytes(glm::ivec2 size_px, std::span<const std::uint8_t> rgba)
{
  const Bytes bytes = rgb_png(size_px, rgba, {});
  const auto view = std::as_bytes(std::span(bytes));
  return {view.begin(), view.end()};
}

/** Of red, green, blue and one more in rows from the top. */
template <typename Value, typename Convert>
static Picture picture_of(glm::ivec2 size_px, const Value *values, Convert linear_of)
{
  Picture picture{size_px, {}};
  picture.pixels.reserve(std::size_t(size_px.x) * std::size_t(size_px.y));
  for (auto y = std::size_t(size_px.y); y-- > 0;) {
    const Value *row = values + 4 * y * std::size_t(size_px.x);
    for (std::size_t x = 0; x < std::size_t(size_px.x); x++) {
      const Value *pixel = row + 4 * x;
      picture.pixels.emplace_back(linear_of(pixel[0]), linear_of(pixel[1]), linear_of(pixel[2]), 1.0F);
    }
  }
  return picture;
}

static Picture read_coded_picture(const Bytes &file)
{
  const std::unique_ptr<image::Decoder> decoder = image::open_decoder(file);
  check_edges(decoder->width(), decoder->height());
  return picture_of(glm::ivec2(decoder->width(), decoder->height()), decoder->read_rgba16().data(),
                    [](std::uint16_t value) { return linear_of_srgb(float(value) / 65535.0F); });
}

static Picture read_any_picture(const fs::path &path)
{
  if (std::optional<Picture> picture = read_exr_picture(path)) {
    return std::move(*picture);
  }
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg();
  Bytes file(std::size_t(std::max(size, std::streamoff(0))));
  if (!stream.seekg(0).read(reinterpret_cast<char *>(file.data()), size)) {
    throw std::runtime_error(fmt::format("cannot be read: {}", std::strerror(errno)));
  }
  if (image::format_of(file) == image::Format::None) {
    return read_by_module(path);
  }
  return read_coded_picture(file);
}

Picture read_picture(const fs::path &path)
{
  try {
    return read_any_picture(path);
  }
  catch (const std::exception &error) {
    throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
  }
}

std::vector<glm::vec4> read_exr(const fs::path &path, glm::ivec2 size_px)
{
  Picture picture = read_picture(path);
  if (picture.size_px != size_px) {
    throw std::runtime_error(fmt::format("{}: is not of {}x{} pixels", path.string(), size_px.x, size_px.y));
  }
  return std::move(picture.pixels);
}

}  // namespace gnomon::cli
