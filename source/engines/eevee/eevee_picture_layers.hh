// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_scene_renderer.hh"

#include <array>
#include <string_view>
#include <utility>

/**
 * AOV layers of a picture, for compositing: parts of its light, and what its surfaces are. They are rendered after the
 * picture, from the same samples with the same pixel filter, so that they fit it at edges. Blended surfaces have light,
 * but are no surfaces here: the opaque surface behind them is.
 */
namespace gnomon::eevee {

/** The data from which a layer is made. */
enum class LayerSource {
  /** The picture itself. */
  Picture,
  /** SurfaceLayers::position_depth. */
  Centers,
  /** The normals of SurfaceLayers::normal. */
  Normals,
  /** SurfaceLayers::albedo_roughness. */
  Means,
  /** SurfaceLayers::visibilities. */
  Visibility,
  /** SurfaceLayers::objects, by the names of their nodes. */
  Objects,
  /** SurfaceLayers::objects, by the names of their materials. */
  Materials,
  /** The light of the lamps of one name: render_lamp_layer. */
  Lamp,
  /** LightComponent::Kind::Emission. */
  Emission,
  /** LightComponent::Kind::World. */
  World,
  /** The object indices of SurfaceLayers::normal. */
  Ids,
};

/** A layer by the name that users write: `gnomon render --aov`, Renderer.layers of Python. */
struct PictureLayer {
  std::string_view name;
  LayerSource source;
  /** Channels in an EXR, a letter each. Empty: no channels of floats, or others than a single layer's. */
  std::string_view channels = "";
  /** Component of the source's pixels that the first channel shows. */
  int first = 0;

  /** Whether there is a layer for each lamp, which has the lamp's name after a dot. */
  [[nodiscard]] constexpr bool has_lamps() const
  {
    return source == LayerSource::Lamp || source == LayerSource::Visibility;
  }
  /** Whether the layer shows opaque surfaces alone. */
  [[nodiscard]] constexpr bool is_of_surfaces() const
  {
    return source >= LayerSource::Centers && source <= LayerSource::Materials;
  }
};

/**
 * All layers. A host has those whose source it draws. Those of light are drawn in this order: the world's comes last,
 * because the others leave it out. doc/layers.md describes the layers.
 */
inline constexpr std::array picture_layers = {
    PictureLayer{"combined", LayerSource::Picture, "RGBA"},
    PictureLayer{"depth", LayerSource::Centers, "Z", 3},
    PictureLayer{"position", LayerSource::Centers, "XYZ"},
    PictureLayer{"normal", LayerSource::Normals, "XYZ"},
    PictureLayer{"albedo", LayerSource::Means, "RGB"},
    PictureLayer{"roughness", LayerSource::Means, "V", 3},
    PictureLayer{"light", LayerSource::Lamp, "RGB"},
    PictureLayer{"emission", LayerSource::Emission, "RGB"},
    PictureLayer{"world", LayerSource::World, "RGB"},
    PictureLayer{"visibility", LayerSource::Visibility, "V"},
    PictureLayer{"crypto_object", LayerSource::Objects},
    PictureLayer{"crypto_material", LayerSource::Materials},
    PictureLayer{"ids", LayerSource::Ids},
};

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
   * Position in the scene's world space and depth, metres, at the centre of the pixel, because the mean of two
   * positions lies on neither surface. (0, 0, 0, no_depth) without a surface.
   */
  std::vector<glm::vec4> position_depth;
  /** Surfaces::normal_object at the centre of the pixel: the normal, and the index of the object. */
  std::vector<glm::vec4> normal;
  /** Surfaces::albedo_roughness, filtered as the picture is: multiplied by the coverage of the pixel. */
  std::vector<glm::vec4> albedo_roughness;
  /** The objects that cover the pixel, in no order. */
  std::vector<std::vector<Coverage>> objects;
  /** Visibility of each of SurfaceRequest::visible_lamps, filtered and multiplied by the coverage likewise. */
  std::vector<std::vector<float>> visibilities;

  /** The pixels of a source; nullptr for sources without a vector for each pixel. */
  [[nodiscard]] const std::vector<glm::vec4> *pixels(LayerSource source) const;
};

/** The request for the layers of \a names, without visible_lamps. Names that picture_layers does not have add nothing.
 */
[[nodiscard]] SurfaceRequest surface_request(std::span<const std::string> names);

/**
 * The picture of \a camera with a part of its light. \a sample_count: samples of the picture.
 *
 * This function and the two below change the settings of \a renderer, draw, restore the settings and sync. The next
 * draw of \a renderer starts its picture again.
 * \pre Settings::noise_threshold is 0, here and in the next functions: layers have all samples
 */
[[nodiscard]] std::vector<glm::vec4> render_light_layer(SceneRenderer &renderer, const scene::PlacedCamera &camera,
                                                        int sample_count, const LightComponent &light);

/** The light of all lamps of a name. \see render_light_layer */
[[nodiscard]] std::vector<glm::vec4> render_lamp_layer(SceneRenderer &renderer, const scene::PlacedCamera &camera,
                                                       int sample_count, std::string_view lamp_name);

[[nodiscard]] SurfaceLayers render_surface_layers(SceneRenderer &renderer, const scene::PlacedCamera &camera,
                                                  int sample_count, const SurfaceRequest &request);

}  // namespace gnomon::eevee
