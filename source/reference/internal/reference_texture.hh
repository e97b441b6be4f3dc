// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/vec4.hpp>

#include <array>
#include <optional>

namespace gnomon::reference {

/**
 * Looks up level 0 of a texture at \a uv: linear RGB and alpha, all in [0, 1]. Texels are filtered by the sampler's
 * magnification filter. Colours are decoded before they are filtered. (0, 0) is the outer corner of the first texel.
 */
[[nodiscard]] glm::dvec4 texture_at(const scene::Image &image, const scene::Texture &texture, const glm::dvec2 &uv,
                                    bool is_color);

/** A point of a triangle of a mesh. */
struct MeshPoint {
  const scene::Scene &scene;
  const scene::Mesh &mesh;
  /** Indices in the mesh's positions. */
  std::array<std::uint32_t, 3> vertices;
  /** Barycentric. The sum is 1. */
  glm::dvec3 weights;

  /** A stream of the mesh at the point. \pre it has a value for each position */
  template <typename Value>
  [[nodiscard]] auto interpolated(const std::vector<Value> &stream) const
  {
    using Double = glm::vec<Value::length(), double>;
    Double sum(0.0);
    for (std::size_t i = 0; i < 3; i++) {
      sum += weights[int(i)] * Double(stream[vertices[i]]);
    }
    return sum;
  }

  /** The texture of a slot at the point; empty if the texture, its image or the mesh's uvs are missing. */
  [[nodiscard]] std::optional<glm::dvec4> texture(const scene::TextureSlot &slot, bool is_color) const;
  /** Base colour and alpha: the material's factors times the texture and the vertex colour. */
  [[nodiscard]] glm::dvec4 base_color() const;
  /** The interpolated normal, of any length; \a world_from_object: the linear part. */
  [[nodiscard]] glm::dvec3 smooth_normal_ws(const glm::dmat3 &world_from_object) const;
  /** The same with the normal texture. */
  [[nodiscard]] glm::dvec3 normal_ws(const glm::dmat3 &world_from_object) const;
};

}  // namespace gnomon::reference
