// SPDX-License-Identifier: MIT
#include "cli_render_output.hh"

#include "cli.hh"
#include "cli_exr_part.hh"
#include "cli_output.hh"

#include "eevee_texel_density.hh"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace gnomon::cli {

/** Counts non-finite values of the picture or of a layer, and prints where the first is. */
static std::size_t count_non_finite(const RenderOptions &options, std::string_view what, glm::ivec2 size_px,
                                    std::span<const float> values, std::size_t channel_count)
{
  const NonFinite found = find_non_finite(size_px, values, channel_count);
  if (found.count > 0) {
    print_message("gnomon: {}: {} values of {} are not finite, the first at pixel ({}, {}); not written\n",
                  options.scene, found.count, what, found.first_px.x, found.first_px.y);
  }
  return found.count;
}

/** The unit of the output's values. */
static std::string units_of(const RenderOptions &options)
{
  if (options.is_png()) {
    return fmt::format("display-referred, {}",
                       options.is_shadow_shown()
                           ? "raw"
                           : scene::words<draw::ViewTransform>[std::size_t(options.display().view_transform)]);
  }
  return options.is_shadow_shown()    ? "metres, 0 where nothing was drawn"
         : options.is_density_shown() ? "shadow texels along the edge of a pixel, 0 where there is no shadow"
                                      : "scene-linear radiance, W/(sr m^2)";
}

/** \a sample_count: of the file, or of the whole picture whose part it is */
static Metadata metadata_of(const RenderOptions &options, const RenderedPicture &picture, int sample_count)
{
  Metadata metadata = {{"gnomon:scene", options.scene},
                       {"gnomon:samples", std::to_string(sample_count)},
                       {"gnomon:seed", std::to_string(options.engine_settings().seed)}};
  metadata.insert(metadata.end(), picture.metadata.begin(), picture.metadata.end());
  metadata.insert(metadata.end(), picture.aov.metadata.begin(), picture.aov.metadata.end());
  if (!options.debug.empty()) {
    metadata.emplace_back("gnomon:debug", options.debug);
  }
  metadata.emplace_back("gnomon:units", units_of(options));
  return metadata;
}

/** Writes the pixels of options.region(), which have the samples \a range of the picture. */
static void write_part(const RenderOptions &options, const RenderedPicture &picture, glm::ivec2 range,
                       const std::filesystem::path &path)
{
  const glm::ivec2 whole_px = options.size_px();
  const gpu::Rectangle region = options.region();
  Metadata metadata = metadata_of(options, picture, options.samples);
  metadata.emplace_back(share_metadata, fmt::format("{}", picture.sample_share));
  metadata.emplace_back(range_metadata, fmt::format("{}-{}", range.x, range.y));
  metadata.emplace_back("gnomon:settings", picture.settings);
  ExrPart part{whole_px,
               region.size_px,
               {region.origin_px.x, whole_px.y - region.origin_px.y - region.size_px.y},
               {},
               std::move(metadata)};
  const std::span<const glm::vec4> pixels = picture.pixels;
  const std::string_view names = picture.alpha == Alpha::Written ? "RGBA" : "RGB";
  for (std::size_t i = 0; i < names.size(); i++) {
    std::vector<float> &channel = part.channels[std::string(1, names[i])];
    channel.reserve(pixels.size());
    for (int y = region.size_px.y - 1; y >= 0; y--) {
      const auto row = pixels.subspan(std::size_t(y) * std::size_t(region.size_px.x), std::size_t(region.size_px.x));
      std::ranges::transform(row, std::back_inserter(channel),
                             [&](const glm::vec4 &pixel) { return pixel[glm::length_t(i)]; });
    }
  }
  write_exr_part(path, part);
}

std::size_t write_picture(const RenderOptions &options, const RenderedPicture &picture)
{
  const std::span<const float> values = floats(picture.pixels);
  std::size_t non_finite_count = count_non_finite(options, "the picture", picture.size_px, values, 4);
  for (const Layer &layer : picture.aov.layers) {
    non_finite_count += count_non_finite(options, fmt::format("the layer '{}'", layer.name), picture.size_px,
                                         layer.values, layer.channels.size());
  }
  if (non_finite_count > 0) {
    return non_finite_count;
  }
  const Metadata metadata = metadata_of(options, picture, picture.sample_count);
  if (options.is_png()) {
    std::vector<std::uint8_t> bytes = picture.display.empty() ? to_bytes(values) : picture.display;
    if (!picture.density.empty()) {
      eevee::show_texel_density(bytes, picture.density);
    }
    write_png(options.output, picture.size_px, bytes, metadata, picture.alpha);
  }
  else if (options.is_part()) {
    write_part(options, picture, options.sample_bounds(), options.output);
  }
  else {
    const std::vector<float> distances = options.is_shadow_shown() ? alpha_in_all(values) : std::vector<float>();
    write_exr(options.output, picture.size_px, distances.empty() ? values : distances, metadata, picture.alpha,
              picture.aov.layers);
  }
  return 0;
}

std::filesystem::path checkpoint_path(const RenderOptions &options)
{
  return std::filesystem::path(options.output).replace_extension(".checkpoint.exr");
}

std::filesystem::path write_checkpoint(const RenderOptions &options, const RenderedPicture &picture)
{
  const int first = options.sample_bounds().x;
  const std::filesystem::path path = checkpoint_path(options);
  write_part(options, picture, {first, first + picture.sample_count - 1}, path);
  return path;
}

}  // namespace gnomon::cli
