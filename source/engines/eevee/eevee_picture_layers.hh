// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_scene_renderer.hh"

#include <string_view>
#include <utility>

/**
 * Layers of a picture for compositing: parts of its light, and what its surfaces are. They are rendered after the
 * picture, from the same samples with the same pixel filter, so that they fit it at edges. Blended surfaces have light,
 * but are no surfaces here: the opaque surface behind them is.
 */
namespace gnomon::eevee {

/** Layers that render_surface_layers makes. */
struct SurfaceRequest {
  /** SurfaceLayers::position_depth and normal. */
  bool has_centers = false;
  /** SurfaceLayers::albedo_roughness. */
  bool has_means = false;
  /** SurfaceLayers::objects. */
  bool has_objects = false;
  /** Indices in RenderScene::lamps. */
  std::vector<std::size_t> visible_lamps{};
};

/** An object, and the part of a pixel that it covers. */
using Coverage = std::pair<draw::ObjectIndex, float>;

/** Depth of pixels without a surface, metres. Blender's value. */
inline constexpr float no_depth = 1e10F;

/** One entry for each pixel, rows from the bottom. Layers that were not asked for are empty. */
struct SurfaceLayers {
  /**
   * Position in the scene's world space and depth, metres, at the centre of the pixel: no mean of two surfaces is on
   * either. (0, 0, 0, no_depth) without a surface.
   */
  std::vector<glm::vec4> position_depth;
  /** Surfaces::normal_object at the centre of the pixel. */
  std::vector<glm::vec4> normal;
  /** Surfaces::albedo_roughness, filtered as the picture is: multiplied by the coverage of the pixel. */
  std::vector<glm::vec4> albedo_roughness;
  /** The objects that cover the pixel, in no order. */
  std::vector<std::vector<Coverage>> objects;
  /** Visibility of each of SurfaceRequest::visible_lamps, filtered and multiplied by the coverage likewise. */
  std::vector<std::vector<float>> visibilities;
};

/**
 * The picture of \a camera with a part of its light. \a sample_count: samples of the picture.
 * Afterwards, the renderer is synced with its settings, and its picture begins anew. So are the next functions'.
 * \pre Settings::noise_threshold is 0, here and in the next functions: layers have all samples
 */
[[nodiscard]] std::vector<glm::vec4> render_light_layer(SceneRenderer &renderer, const scene::PlacedCamera &camera,
                                                        int sample_count, const LightPart &light);

/** The light of all lamps of a name. \see render_light_layer */
[[nodiscard]] std::vector<glm::vec4> render_lamp_layer(SceneRenderer &renderer, const scene::PlacedCamera &camera,
                                                       int sample_count, std::string_view lamp_name);

[[nodiscard]] SurfaceLayers render_surface_layers(SceneRenderer &renderer, const scene::PlacedCamera &camera,
                                                  int sample_count, const SurfaceRequest &request);

}  // namespace gnomon::eevee
