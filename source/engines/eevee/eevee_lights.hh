// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"
#include "eevee_light_clusters.hh"

#include "draw_pass.hh"
#include "draw_viewport.hh"

#include <optional>
#include <vector>

/** The lights on the device: in `light_block`, or in `light_texture` with lists. Internal to the engine. */
namespace gnomon::eevee {

struct Data;
struct SampledLampPoints;
struct Settings;

/** Entries of `light_block` with Feature::LightClusters. \see SharedData::light_block */
inline constexpr int probed_entry = 0;
inline constexpr int tinted_entry = 1;

/** The lists of the lights that can reach the parts of a view, on the host and on the device. */
struct ViewClusters {
  struct Key {
    draw::View view;
    glm::ivec2 size_px{0};
    /** SharedData::reaches_revision. */
    std::uint64_t reaches = 0;

    bool operator==(const Key &) const = default;
  };
  LightClusters lists;
  /** The inputs that the lists on the device were made from. Empty if they are undefined. */
  std::optional<Key> made;
  gpu::Buffer block;
  gpu::Texture texture;
  /** The binding of `texture`. Programs read it by reference, because its size follows the view. */
  draw::TextureBinding binding;
};

/**
 * Create the buffers and textures of lights that the features \a read need, and free those that they do not; then write
 * the lights of the last sync.
 */
void make_lights(Data &data, gpu::Device &device, const Settings &settings, Feature read);
/** Bind the resources of lights that programs read. */
void bind_lights(draw::ShadingGroup &group, const Data &data);
/** The entry in `light_block` of \a light, which is an index in Lamps::lights. \a entry: that with LightClusters. */
[[nodiscard]] int light_entry(const Data &data, int light, int entry);
/** With LightClusters, append a write of \a light to its entry in `light_block`, with its point in \a sampled. */
void write_light_entry(const Data &data, const SampledLampPoints &sampled, int light, int entry,
                       gpu::CommandList &list);
/** Write the lights of \a sampled. Entries of `light_block` are written by \a list. */
void write_lamp_points(Data &data, const SampledLampPoints &sampled, gpu::Device &device, gpu::CommandList &list);
/** Make the lists for \a view, the view of the picture. Does nothing if they are up to date. */
void update_light_clusters(Data &data, draw::Viewport &viewport, const draw::View &view, gpu::CommandList &list);

}  // namespace gnomon::eevee
