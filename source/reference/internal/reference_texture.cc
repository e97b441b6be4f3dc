// SPDX-License-Identifier: MIT
#include "internal/reference_texture.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::reference {

namespace {

/** Table of the sRGB decoding (IEC 61966-2-1) for bytes. */
std::array<double, 256> make_decoded_srgb()
{
  std::array<double, 256> decoded{};
  for (std::size_t i = 0; i < decoded.size(); i++) {
    const double x = double(i) / 255.0;
    decoded[i] = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  }
  return decoded;
}

/** Index of the texel at \a place, an integer counted from the first of \a size texels. */
std::uint32_t wrapped(double place, std::uint32_t size, scene::TextureWrap wrap)
{
  const double count = size;
  switch (wrap) {
    case scene::TextureWrap::ClampToEdge: place = std::clamp(place, 0.0, count - 1.0); break;
    case scene::TextureWrap::Repeat: place -= count * std::floor(place / count); break;
    case scene::TextureWrap::MirroredRepeat:
      place -= 2.0 * count * std::floor(place / (2.0 * count));
      place = place < count ? place : 2.0 * count - 1.0 - place;
      break;
  }
  // For large values, `place` may not be an exact integer in this range.
  return std::uint32_t(std::clamp(place, 0.0, count - 1.0));
}

}  // namespace

glm::dvec4 texture_at(const scene::Image &image, const scene::Texture &texture, const glm::dvec2 &uv, bool is_color)
{
  static const std::array<double, 256> decoded_srgb = make_decoded_srgb();
  const auto texel = [&](double column, double row) {
    const std::size_t x = wrapped(column, image.width, texture.wrap_u);
    const std::size_t y = wrapped(row, image.height, texture.wrap_v);
    const std::uint8_t *rgba = &image.texels[4 * (y * image.width + x)];
    return is_color ? glm::dvec4(decoded_srgb[rgba[0]], decoded_srgb[rgba[1]], decoded_srgb[rgba[2]], rgba[3] / 255.0)
                    : glm::dvec4(rgba[0], rgba[1], rgba[2], rgba[3]) / 255.0;
  };
  const glm::dvec2 at = uv * glm::dvec2(image.width, image.height);
  if (texture.magnified == scene::TextureFilter::Nearest) {
    return texel(std::floor(at.x), std::floor(at.y));
  }
  const glm::dvec2 low = glm::floor(at - 0.5);
  const glm::dvec2 share = at - 0.5 - low;
  return glm::mix(glm::mix(texel(low.x, low.y), texel(low.x + 1.0, low.y), share.x),
                  glm::mix(texel(low.x, low.y + 1.0), texel(low.x + 1.0, low.y + 1.0), share.x), share.y);
}

std::optional<glm::dvec4> MeshPoint::texture(const scene::TextureSlot &slot, bool is_color) const
{
  const scene::Texture *texture = scene.textures().find(slot.texture);
  const scene::Image *image = texture ? scene.images().find(texture->image) : nullptr;
  const std::vector<glm::vec2> &uvs = mesh.uv_set(slot.uv_set);
  if (!image || uvs.empty()) {
    return std::nullopt;
  }
  return texture_at(*image, *texture, slot.uv_from_mesh() * glm::dvec3(interpolated(uvs), 1.0), is_color);
}

glm::dvec4 MeshPoint::base_color() const
{
  const scene::Material &material = scene.material_of(mesh);
  const glm::dvec4 color = mesh.colors.empty() ? glm::dvec4(1.0) : interpolated(mesh.colors);
  return glm::dvec4(material.base_color, material.alpha) * color *
         texture(material.base_color_texture, true).value_or(glm::dvec4(1.0));
}

/** Matrix of cofactors. It transforms normals, up to the sign of the determinant, and exists for singular matrices. */
static glm::dmat3 cofactors(const glm::dmat3 &m)
{
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

/** The direction of \a v with the length of \a original; zero where \a v has none. */
static glm::dvec3 with_length_of(const glm::dvec3 &v, const glm::dvec3 &original)
{
  const double length = glm::length(v);
  return length > 0.0 ? v * (glm::length(original) / length) : glm::dvec3(0.0);
}

static double mirror_sign(const glm::dmat3 &world_from_object)
{
  return glm::determinant(world_from_object) < 0.0 ? -1.0 : 1.0;
}

glm::dvec3 MeshPoint::smooth_normal_ws(const glm::dmat3 &world_from_object) const
{
  const glm::dvec3 normal = interpolated(mesh.normals);
  return with_length_of(mirror_sign(world_from_object) * (cofactors(world_from_object) * normal), normal);
}

glm::dvec3 MeshPoint::normal_ws(const glm::dmat3 &world_from_object) const
{
  const scene::Material &material = scene.material_of(mesh);
  const double mirrored = mirror_sign(world_from_object);
  const glm::dvec3 normal = smooth_normal_ws(world_from_object);
  const std::optional<glm::dvec4> texel =
      mesh.tangents.empty() ? std::nullopt : texture(material.normal_texture, false);
  if (!texel) {
    return normal;
  }
  // glTF 2.0, 3.9.3. MikkTSpace defines the frame by the interpolated vectors without normalisation.
  const glm::dvec4 tangent = interpolated(mesh.tangents);
  const glm::dvec3 along_u = with_length_of(world_from_object * glm::dvec3(tangent), glm::dvec3(tangent));
  const glm::dvec3 up = (tangent.w < 0.0 ? -mirrored : mirrored) * glm::cross(normal, along_u);
  const glm::dvec3 mapped = 2.0 * glm::dvec3(*texel) - 1.0;
  return double(material.normal_scale) * (mapped.x * along_u + mapped.y * up) + mapped.z * normal;
}

}  // namespace gnomon::reference
