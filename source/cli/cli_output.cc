// SPDX-License-Identifier: MIT
#include "cli_output.hh"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <unistd.h>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace gnomon::cli {

namespace fs = std::filesystem;

void write_atomically(const fs::path &path, const std::function<void(const fs::path &beside)> &write)
{
  // The extension remains last, because it selects the format.
  const fs::path beside =
      path.parent_path() / fmt::format(".{}.{}{}", path.stem().string(), getpid(), path.extension().string());
  try {
    write(beside);
    fs::rename(beside, path);
  }
  catch (const fs::filesystem_error &error) {
    std::error_code ignored;
    fs::remove(beside, ignored);
    throw std::runtime_error(fmt::format("{}: {}", path.string(), error.code().message()));
  }
  catch (...) {
    std::error_code ignored;
    fs::remove(beside, ignored);
    throw;
  }
}

NonFinite find_non_finite(glm::ivec2 size_px, std::span<const float> rgba)
{
  NonFinite found;
  const auto width = std::size_t(size_px.x);
  // From the upper row down, the order in which a viewer reads the picture.
  for (int y = 0; y < size_px.y; y++) {
    const std::span<const float> row = rgba.subspan(std::size_t(size_px.y - 1 - y) * width * 4, width * 4);
    for (std::size_t i = 0; i < row.size(); i++) {
      if (!std::isfinite(row[i]) && found.count++ == 0) {
        found.first_px = {int(i / 4), y};
      }
    }
  }
  return found;
}

/** Memory has four channels for each pixel and rows from the bottom; strides convert both. */
static bool write_rows(OIIO::ImageOutput &output, glm::ivec2 size_px, OIIO::TypeDesc type, const void *pixels)
{
  const auto pixel_bytes = OIIO::stride_t(4 * type.size());
  const OIIO::stride_t row_bytes = pixel_bytes * size_px.x;
  const auto *top = static_cast<const char *>(pixels) + row_bytes * (size_px.y - 1);
  return output.write_image(type, top, pixel_bytes, -row_bytes) && output.close();
}

static void write_image(const fs::path &path, glm::ivec2 size_px, OIIO::TypeDesc type, const void *pixels,
                        const Metadata &metadata)
{
  OIIO::ImageSpec spec(size_px.x, size_px.y, 3, type);
  spec["Software"] = "gnomon " GNOMON_VERSION;
  for (const auto &[name, value] : metadata) {
    spec[name] = value;
  }
  write_atomically(path, [&](const fs::path &beside) {
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(beside.string());
    if (!output || !output->open(beside.string(), spec)) {
      throw std::runtime_error(
          fmt::format("{}: cannot be written: {}", path.string(), output ? output->geterror() : OIIO::geterror()));
    }
    if (!write_rows(*output, size_px, type, pixels)) {
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), output->geterror()));
    }
  });
}

void write_exr(const fs::path &path, glm::ivec2 size_px, std::span<const float> rgba, const Metadata &metadata)
{
  write_image(path, size_px, OIIO::TypeDesc::FLOAT, rgba.data(), metadata);
}

void write_png(const fs::path &path, glm::ivec2 size_px, std::span<const std::uint8_t> rgba, const Metadata &metadata)
{
  write_image(path, size_px, OIIO::TypeDesc::UINT8, rgba.data(), metadata);
}

void write_text(const fs::path &path, const std::string &text)
{
  write_atomically(path, [&](const fs::path &beside) {
    std::ofstream file(beside);
    if (!(file << text << std::flush)) {
      throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
    }
  });
}

static float linear_of_srgb(float encoded)
{
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

Picture read_picture(const fs::path &path)
{
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path.string());
  if (!input) {
    throw std::runtime_error(fmt::format("{}: {}", path.string(), OIIO::geterror()));
  }
  const OIIO::ImageSpec &spec = input->spec();
  const int red = spec.channelindex("R");
  if (red < 0 || spec.channelindex("G") != red + 1 || spec.channelindex("B") != red + 2) {
    throw std::runtime_error(fmt::format("{}: has no channels R, G and B", path.string()));
  }
  Picture picture{{spec.width, spec.height}, {}};
  picture.pixels.assign(std::size_t(spec.width) * std::size_t(spec.height), glm::vec4(1.0F));
  const auto row_bytes = OIIO::stride_t(sizeof(glm::vec4)) * spec.width;
  auto *top = reinterpret_cast<char *>(picture.pixels.data()) + row_bytes * (spec.height - 1);
  if (!input->read_image(0, 0, red, red + 3, OIIO::TypeDesc::FLOAT, top, sizeof(glm::vec4), -row_bytes)) {
    throw std::runtime_error(fmt::format("{}: {}", path.string(), input->geterror()));
  }
  if (!spec.format.is_floating_point()) {
    for (glm::vec4 &pixel : picture.pixels) {
      pixel = {linear_of_srgb(pixel.r), linear_of_srgb(pixel.g), linear_of_srgb(pixel.b), 1.0F};
    }
  }
  return picture;
}

std::vector<glm::vec4> read_exr(const fs::path &path, glm::ivec2 size_px)
{
  Picture picture = read_picture(path);
  if (picture.size_px != size_px) {
    throw std::runtime_error(fmt::format("{}: is not of {}x{} pixels", path.string(), size_px.x, size_px.y));
  }
  return std::move(picture.pixels);
}

std::vector<std::byte> png_bytes(glm::ivec2 size_px, std::span<const std::uint8_t> rgba)
{
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("memory.png", &memory);
  if (!output || !output->open("memory.png", OIIO::ImageSpec(size_px.x, size_px.y, 3, OIIO::TypeDesc::UINT8)) ||
      !write_rows(*output, size_px, OIIO::TypeDesc::UINT8, rgba.data())) {
    throw std::runtime_error(fmt::format("a PNG file: {}", output ? output->geterror() : OIIO::geterror()));
  }
  const auto view = std::as_bytes(std::span(bytes));
  return {view.begin(), view.end()};
}

}  // namespace gnomon::cli
