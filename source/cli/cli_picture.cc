// SPDX-License-Identifier: MIT
#include "cli_picture.hh"

#include "internal/cli_picture_formats.hh"
#include "internal/cli_picture_module.hh"

#include "image_decoder.hh"
#include "image_png.hh"
#include "image_radiance.hh"
#include "output_file.hh"

#include <fmt/format.h>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>
#include <stdexcept>

namespace gnomon::cli {

namespace fs = std::filesystem;

using Bytes = std::vector<unsigned char>;

static Bytes png_of(glm::ivec2 size_px, std::span<const std::uint8_t> rgba, const Metadata &metadata, Alpha alpha)
{
  const int channel_count = alpha == Alpha::Written ? 4 : 3;
  std::vector<std::uint8_t> texels;
  texels.reserve(rgba.size() / 4 * std::size_t(channel_count));
  const auto width = std::size_t(size_px.x);
  for (auto y = std::size_t(size_px.y); y-- > 0;) {
    for (std::size_t x = 0; x < width; x++) {
      const std::uint8_t *pixel = &rgba[4 * (y * width + x)];
      texels.insert(texels.end(), pixel, pixel + channel_count);
    }
  }
  return image::png_file(std::uint32_t(size_px.x), std::uint32_t(size_px.y), channel_count, texels, metadata);
}

void write_png(const fs::path &path, glm::ivec2 size_px, std::span<const std::uint8_t> rgba, const Metadata &metadata,
               Alpha alpha)
{
  Metadata all = {{"Software", "gnomon " GNOMON_VERSION}};
  all.insert(all.end(), metadata.begin(), metadata.end());
  try {
    const Bytes bytes = png_of(size_px, rgba, all, alpha);
    output::write_file(path, {reinterpret_cast<const char *>(bytes.data()), bytes.size()});
  }
  catch (const image::Error &error) {
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), error.what()));
  }
}

std::vector<std::byte> png_bytes(glm::ivec2 size_px, std::span<const std::uint8_t> rgba)
{
  const Bytes bytes = png_of(size_px, rgba, {}, Alpha::Dropped);
  const auto view = std::as_bytes(std::span(bytes));
  return {view.begin(), view.end()};
}

static Picture read_coded_picture(const Bytes &file)
{
  const std::unique_ptr<image::Decoder> decoder = image::open_decoder(file);
  check_edges(decoder->width(), decoder->height());
  Picture picture{glm::ivec2(decoder->width(), decoder->height()), {}};
  const auto width = std::size_t(picture.size_px.x);
  picture.pixels.reserve(width * std::size_t(picture.size_px.y));
  const std::vector<std::uint16_t> texels = decoder->read_rgba16();
  const auto linear_of = [](std::uint16_t value) { return linear_of_srgb(float(value) / 65535.0F); };
  for (auto y = std::size_t(picture.size_px.y); y-- > 0;) {
    for (std::size_t x = 0; x < width; x++) {
      const std::uint16_t *texel = &texels[4 * (y * width + x)];
      const glm::vec3 color(linear_of(texel[0]), linear_of(texel[1]), linear_of(texel[2]));
      picture.pixels.emplace_back(color * (float(texel[3]) / 65535.0F), 1.0F);
    }
  }
  return picture;
}

static Picture read_radiance_picture(const Bytes &file)
{
  image::RadianceDecoder decoder(file);
  check_edges(decoder.width(), decoder.height());
  Picture picture{glm::ivec2(decoder.width(), decoder.height()), {}};
  if (decoder.has_other_primaries()) {
    picture.warnings.emplace_back(primaries_warning);
  }
  const auto width = std::size_t(picture.size_px.x);
  picture.pixels.reserve(width * std::size_t(picture.size_px.y));
  const std::vector<float> values = decoder.read_rgb();
  for (auto y = std::size_t(picture.size_px.y); y-- > 0;) {
    for (std::size_t x = 0; x < width; x++) {
      const float *value = &values[3 * (y * width + x)];
      picture.pixels.emplace_back(value[0], value[1], value[2], 1.0F);
    }
  }
  return picture;
}

static Picture read_any_picture(const fs::path &path, const std::string &layer)
{
  output::require_readable(path);
  if (std::optional<Picture> picture = read_exr_picture(path, layer)) {
    return std::move(*picture);
  }
  if (!layer.empty()) {
    throw std::runtime_error(fmt::format("has no layer '{}': only EXR files have layers", layer));
  }
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg();
  Bytes file(std::size_t(std::max(size, std::streamoff(0))));
  if (!stream.seekg(0).read(reinterpret_cast<char *>(file.data()), size)) {
    throw std::runtime_error(fmt::format("cannot be read: {}", std::strerror(errno)));
  }
  if (image::is_radiance(file)) {
    return read_radiance_picture(file);
  }
  if (image::format_of(file) == image::Format::None) {
    return read_by_module(path);
  }
  return read_coded_picture(file);
}

Picture read_picture(const fs::path &path, const std::string &layer)
{
  try {
    return read_any_picture(path, layer);
  }
  catch (const std::bad_alloc &) {
    throw output::TransientError(fmt::format("{}: there is not enough memory to read it", path.string()));
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
