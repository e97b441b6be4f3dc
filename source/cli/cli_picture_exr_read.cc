// SPDX-License-Identifier: MIT
// Reads pictures from EXR files of any windows, layers, parts and numbers.
#include "internal/cli_exr_file.hh"
#include "internal/cli_picture_formats.hh"

#include "image_radiance.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/vec3.hpp>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTestFile.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

/** Channels of a part whose names differ after the last point only. */
struct ExrLayer {
  int part = 0;
  /** For people: the names of the part and of the layer. Empty: the layer without a name of the only part. */
  std::string label;
  /** Name of the layer in its part. */
  std::string name;
  /** Full names of red, green and blue, or three times that of luminance. */
  std::array<std::string, 3> channels;
  /** Full names of RY and BY beside luminance; empty: there are none. */
  std::vector<std::string> chroma;
};

/** The layers of a part that are pictures, by name. */
std::vector<ExrLayer> layers_of(const Imf::Header &header, int part, bool is_only_part)
{
  std::map<std::string, std::map<std::string, std::string>> channels_of;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    const std::string full = channel.name();
    const std::size_t point = full.rfind('.');
    std::string last = full.substr(point == full.npos ? 0 : point + 1);
    std::ranges::transform(last, last.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; });
    // Nuke writes whole words in layers.
    for (const std::string_view word : {"RED", "GREEN", "BLUE"}) {
      last = last == word ? std::string(1, word[0]) : last;
    }
    channels_of[point == full.npos ? "" : full.substr(0, point)].emplace(last, full);
  }
  std::vector<ExrLayer> layers;
  for (const auto &[name, channels] : channels_of) {
    const auto has = [&, &of = channels](const char *channel) { return of.contains(channel); };
    ExrLayer layer;
    layer.part = part;
    layer.label = layer.name = name;
    if (has("R") && has("G") && has("B")) {
      layer.channels = {channels.at("R"), channels.at("G"), channels.at("B")};
    }
    // Not the Y of a vector X, Y and Z.
    else if (has("Y") && !has("X")) {
      layer.channels.fill(channels.at("Y"));
      if (has("RY") && has("BY")) {
        layer.chroma = {channels.at("RY"), channels.at("BY")};
      }
    }
    else {
      continue;
    }
    if (!is_only_part && header.hasName()) {
      layer.label = name.empty() ? header.name() : header.name() + '.' + name;
    }
    layers.push_back(std::move(layer));
  }
  return layers;
}

std::string names_of(const std::vector<ExrLayer> &layers)
{
  std::vector<std::string> names;
  for (const ExrLayer &layer : layers) {
    names.push_back(layer.label.empty() ? "the one without a name" : '\'' + layer.label + '\'');
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/** The layer of that label. Without one, the layer without a name, or the only one. */
ExrLayer chosen(const std::vector<ExrLayer> &layers, const std::string &label)
{
  if (!label.empty()) {
    const auto found = std::ranges::find_if(
        layers, [&](const ExrLayer &layer) { return layer.label == label || layer.name == label; });
    if (found == layers.end()) {
      throw std::runtime_error(fmt::format("has no layer '{}'; it has: {}", label, names_of(layers)));
    }
    return *found;
  }
  const auto is_unnamed = [](const ExrLayer &layer) { return layer.name.empty(); };
  const auto found = std::ranges::find_if(layers, is_unnamed);
  if (std::ranges::count_if(layers, is_unnamed) == 1) {
    return *found;
  }
  if (layers.size() > 1) {
    throw std::runtime_error(fmt::format(
        "has several layers, and none without a name (a world's is chosen by --world-layer): {}", names_of(layers)));
  }
  return layers.front();
}

/** \a read reads the pixels of \a data, rows from the bottom. Pixels outside of it are black. */
template <typename Read>
Picture picture_of_windows(const Imath::Box2i &display, const Imath::Box2i &data, const Read &read)
{
  const glm::ivec2 data_size_px = size_of_window(data);
  const glm::ivec2 size_px = size_of_window(display);
  Picture stored{data_size_px, {}};
  stored.pixels.assign(std::size_t(data_size_px.x) * std::size_t(data_size_px.y), glm::vec4(1.0F));
  read(stored);
  if (display == data) {
    return stored;
  }
  // So that a small file does not ask for all memory.
  constexpr std::int64_t empty_pixels_max = 1 << 24U;
  constexpr std::int64_t empty_pixels_per_pixel = 64;
  const auto pixel_count = [](glm::ivec2 of) { return std::int64_t(of.x) * of.y; };
  if (pixel_count(size_px) > std::max(empty_pixels_max, empty_pixels_per_pixel * pixel_count(data_size_px))) {
    throw std::runtime_error(fmt::format("has {}x{} pixels in its display window, and {}x{} in its data window",
                                         size_px.x, size_px.y, data_size_px.x, data_size_px.y));
  }
  Picture picture{size_px, {}};
  picture.pixels.assign(std::size_t(size_px.x) * std::size_t(size_px.y), glm::vec4(0.0F, 0.0F, 0.0F, 1.0F));
  const int first = std::max(display.min.x, data.min.x);
  const int end = std::min(display.max.x, data.max.x) + 1;
  // OpenEXR counts rows from the top.
  for (int y = std::max(display.min.y, data.min.y); first < end && y <= std::min(display.max.y, data.max.y); y++) {
    const auto row_from = std::size_t(data.max.y - y) * std::size_t(data_size_px.x);
    const auto row_to = std::size_t(display.max.y - y) * std::size_t(size_px.x);
    std::copy_n(&stored.pixels[row_from + std::size_t(first - data.min.x)], end - first,
                &picture.pixels[row_to + std::size_t(first - display.min.x)]);
  }
  return picture;
}

/** The address of pixel (0, 0) of a buffer of \a pixel_bytes a pixel whose last row is \a top, which may be outside. */
char *origin_of(void *top, const Imath::Box2i &data, std::ptrdiff_t pixel_bytes, std::ptrdiff_t row_bytes)
{
  return reinterpret_cast<char *>(reinterpret_cast<std::uintptr_t>(top) - std::uintptr_t(pixel_bytes * data.min.x) +
                                  std::uintptr_t(row_bytes * data.min.y));
}

Picture read_channels(Imf::MultiPartInputFile &file, const ExrLayer &layer)
{
  Imf::InputPart part(file, layer.part);
  const Imf::Header &header = part.header();
  for (const std::string &name : layer.channels) {
    const Imf::Channel *channel = header.channels().findChannel(name);
    if (channel->xSampling != 1 || channel->ySampling != 1) {
      throw std::runtime_error(fmt::format("channel {} has fewer pixels than the picture", name));
    }
  }
  const Imath::Box2i data = header.dataWindow();
  return picture_of_windows(header.displayWindow(), data, [&](Picture &picture) {
    if (!part.isComplete()) {
      throw std::runtime_error("is cut off");
    }
    const auto pixel_bytes = std::ptrdiff_t(sizeof(glm::vec4));
    const std::ptrdiff_t row_bytes = pixel_bytes * picture.size_px.x;
    char *origin = origin_of(&picture.pixels[std::size_t(picture.size_px.x) * std::size_t(picture.size_px.y - 1)], data,
                             pixel_bytes, row_bytes);
    const bool is_grey = layer.channels[0] == layer.channels[1];
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < (is_grey ? 1 : layer.channels.size()); i++) {
      buffer.insert(layer.channels[i], Imf::Slice(Imf::FLOAT, origin + i * sizeof(float), std::size_t(pixel_bytes),
                                                  std::size_t(-row_bytes)));
    }
    part.setFrameBuffer(buffer);
    part.readPixels(data.min.y, data.max.y);
    if (is_grey) {
      for (glm::vec4 &pixel : picture.pixels) {
        pixel = glm::vec4(glm::vec3(pixel.r), 1.0F);
      }
    }
  });
}

/** \throws std::runtime_error if OpenEXR does not compute colours of \a layer */
void check_chroma(const Imf::ChannelList &channels, const ExrLayer &layer)
{
  for (const std::string &name : layer.chroma) {
    const Imf::Channel &chroma = *channels.findChannel(name);
    if (chroma.xSampling != 2 || chroma.ySampling != 2) {
      throw std::runtime_error(
          fmt::format("has luminance and chroma (Y, RY and BY) whose channel {} has one pixel for "
                      "{}x{} of the picture; only chroma with one for 2x2 is read",
                      name, chroma.xSampling, chroma.ySampling));
    }
  }
}

/** Notes a cube map, and warns of other primaries. */
void add_facts(const Imf::Header &header, const ExrLayer &layer, Picture &picture)
{
  picture.is_cube_map = Imf::hasEnvmap(header) && Imf::envmap(header) == Imf::ENVMAP_CUBE;
  const bool is_grey = layer.chroma.empty() && layer.channels[0] == layer.channels[1];
  if (!is_grey && Imf::hasChromaticities(header)) {
    const Imf::Chromaticities &of = Imf::chromaticities(header);
    if (!image::is_rec709({double(of.red.x), double(of.red.y), double(of.green.x), double(of.green.y),
                           double(of.blue.x), double(of.blue.y), double(of.white.x), double(of.white.y)})) {
      picture.warnings.emplace_back(primaries_warning);
    }
  }
}

/** Colours of luminance and chroma, which OpenEXR computes as halves. */
Picture read_chroma(const fs::path &path, const ExrLayer &layer)
{
  Imf::RgbaInputFile file(path.c_str(), layer.name);
  const Imath::Box2i data = file.dataWindow();
  return picture_of_windows(file.displayWindow(), data, [&](Picture &picture) {
    if (!file.isComplete()) {
      throw std::runtime_error("is cut off");
    }
    const auto width = std::size_t(picture.size_px.x);
    std::vector<Imf::Rgba> rows(picture.pixels.size());
    const auto pixel_bytes = std::ptrdiff_t(sizeof(Imf::Rgba));
    const std::ptrdiff_t row_bytes = pixel_bytes * picture.size_px.x;
    char *origin = origin_of(&rows[rows.size() - width], data, pixel_bytes, row_bytes);
    file.setFrameBuffer(reinterpret_cast<Imf::Rgba *>(origin), 1, std::size_t(-std::ptrdiff_t(width)));
    file.readPixels(data.min.y, data.max.y);
    std::ranges::transform(rows, picture.pixels.begin(),
                           [](const Imf::Rgba &pixel) { return glm::vec4(pixel.r, pixel.g, pixel.b, 1.0F); });
  });
}

}  // namespace

std::optional<Picture> read_exr_picture(const fs::path &path, const std::string &layer_label)
{
  if (!Imf::isOpenExrFile(path.c_str())) {
    return std::nullopt;
  }
  ExrInput input(path);
  Imf::MultiPartInputFile &file = input.file();
  std::vector<ExrLayer> layers;
  bool is_deep = false;
  std::vector<std::string> channels;
  for (int part = 0; part < file.parts(); part++) {
    const Imf::Header &header = file.header(part);
    if (header.hasType() && Imf::isDeepData(header.type())) {
      is_deep = true;
      continue;
    }
    const std::vector<ExrLayer> of_part = layers_of(header, part, file.parts() == 1);
    layers.insert(layers.end(), of_part.begin(), of_part.end());
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
      channels.emplace_back(channel.name());
    }
  }
  if (layers.empty()) {
    constexpr std::size_t listed_max = 32;
    channels.resize(std::min(channels.size(), listed_max));
    throw std::runtime_error(
        is_deep ? "has deep pixels, which are not read"
                : fmt::format("has no channels R, G and B, and no channel Y; it has: {}", fmt::join(channels, ", ")));
  }
  const ExrLayer layer = chosen(layers, layer_label);
  input.check_memory(layer.part);
  if (!layer.chroma.empty()) {
    // OpenEXR computes colours of files of one part only.
    if (file.parts() > 1) {
      throw std::runtime_error(fmt::format(
          "has luminance and chroma (Y, RY and BY) in '{}', one of several parts; they are read from files of one part",
          layer.label));
    }
    check_chroma(file.header(layer.part).channels(), layer);
  }
  Picture picture = layer.chroma.empty() ? read_channels(file, layer) : read_chroma(path, layer);
  add_facts(file.header(layer.part), layer, picture);
  return picture;
}

}  // namespace gnomon::cli
