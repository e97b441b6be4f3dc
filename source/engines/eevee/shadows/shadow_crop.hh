// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_visible_clusters.hh"

#include "draw_view.hh"

#include <glm/gtc/type_precision.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <span>
#include <vector>

namespace gnomon::eevee {

/** A box that contains surfaces of the picture. World space, metres. */
struct VisibleBox {
  glm::dvec3 center_ws{0.0};
  glm::dvec3 half_ws{0.0};
};

/**
 * Boxes around the clusters. Clusters of 4 x 4 neighbouring squares that are in the same range of the distance share a
 * box. It is wider than its clusters by a quarter of the largest cluster on each side, so that it contains most
 * surfaces that another sample sees between the pixels.
 */
[[nodiscard]] std::vector<VisibleBox> visible_boxes(std::span<const VisibleCluster> clusters);

/**
 * The part of a perspective map that its layer holds: left, bottom, right and top edge in steps of 1 / 255 of the map's
 * width and height.
 */
using MapCrop = glm::u8vec4;
inline constexpr MapCrop whole_map(0, 0, 255, 255);

/**
 * The smallest part of the map of \a view that contains the lookups of all \a boxes and a border for the filter kernel.
 *
 * \a view: of the whole map, perspective and symmetric. \a inner: fraction of the map's width from the centre to the
 * outermost lookups; the rest is the map's own border. \a size_px: edge of the layer, texels.
 * \return nothing if no box is looked up
 */
[[nodiscard]] std::optional<MapCrop> map_crop(const draw::View &view, double inner, int size_px,
                                              std::span<const VisibleBox> boxes);

/**
 * \a view restricted to a part of its picture.
 * \a center_ndc: of the part, in normalized device coordinates. \a scale: width and height of the picture, divided by
 * those of the part.
 */
[[nodiscard]] draw::View cropped_view(const draw::View &view, const glm::vec2 &center_ndc, const glm::vec2 &scale);
/** \a view restricted to \a crop. */
[[nodiscard]] draw::View cropped_view(const draw::View &view, const MapCrop &crop);

/** The smallest part that contains both. */
[[nodiscard]] MapCrop united(const MapCrop &a, const MapCrop &b);

/** Width and height of \a crop, fractions of the map's. */
[[nodiscard]] inline glm::vec2 extent_of(const MapCrop &crop)
{
  return {float(crop.z - crop.x) / 255.0F, float(crop.w - crop.y) / 255.0F};
}

}  // namespace gnomon::eevee
