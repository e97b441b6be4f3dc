// SPDX-License-Identifier: MIT
#pragma once

#include "scene_handle.hh"
#include "scene_properties.hh"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/**
 * The contents of a scene as plain data.
 *
 * Units: metres, radians, watts. Colours are linear with Rec. 709 primaries. Each type lists its aspects, on which a
 * consumer may depend separately. An edit gives the changed aspects a new revision (scene.hh). \see scene_properties.hh
 * for lamps, cameras, materials and nodes
 */
namespace gnomon::scene {

/** Axis-aligned box. Default-constructed it is empty: `min` above `max`. */
struct Bounds {
  glm::vec3 min{1e30F};
  glm::vec3 max{-1e30F};

  [[nodiscard]] bool is_empty() const
  {
    return min.x > max.x;
  }
  [[nodiscard]] glm::vec3 center() const
  {
    return 0.5F * min + 0.5F * max;
  }
  /** Half the diagonal: the radius of the sphere around the box. */
  [[nodiscard]] float radius() const;
  void extend(const glm::vec3 &point);
  void extend(const Bounds &other);
  bool operator==(const Bounds &) const = default;
};

/** The box around \a bounds after a transform; an empty box stays empty. */
[[nodiscard]] Bounds transformed(const Bounds &bounds, const glm::mat4 &target_from_source);

/**
 * Texels of four bytes each, not premultiplied by alpha. Textures of colours decode red, green and blue as sRGB;
 * textures of data use them as linear values (TextureInput::is_color). Alpha is always linear.
 */
struct Image {
  static constexpr std::string_view kind_name = "image";
  enum class Aspect { Name, Content, Count };

  std::string name{};
  /** Both above 0. */
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  /** 4 · width · height bytes; rows from the top, where v is 0. */
  std::vector<std::uint8_t> texels{};
  /** The alpha of every texel is 255. Scene::add and Scene::replace compute it. */
  bool is_opaque = false;
};

enum class TextureWrap { Repeat, MirroredRepeat, ClampToEdge };

enum class TextureFilter { Nearest, Linear };

/** The filter between mip levels of a minified texture. None: only the full size is read. */
enum class MipFilter { None, Nearest, Linear };

/** How materials use the texels of an image. */
enum class ImageUse {
  /** Four linear values. */
  Data,
  /** Colours that are encoded as sRGB; alpha has no effect. */
  Color,
  /** Colours of blended surfaces, as Color. A texel covers the fraction alpha, which is its weight in a mean. */
  Coverage,
  /** Colours of masked surfaces, as Color. A texel covers all or nothing. \see MaskCover */
  Mask,
};

/** The cover of a mask. */
struct MaskCover {
  /** Least alpha of a covered texel. 0: no mask. */
  float cutoff = 0.0F;
  /** Whether alphas are interpolated between the centres of texels; otherwise a texel is covered or not. */
  bool is_linear = false;
  auto operator<=>(const MaskCover &) const = default;
};

/** An image and its sampler. */
struct Texture {
  static constexpr std::string_view kind_name = "texture";
  enum class Aspect { Image, Sampler, Count };

  /** An invalid or stale handle: the texture is not drawn. */
  Handle<Image> image{};
  TextureWrap wrap_u = TextureWrap::Repeat;
  TextureWrap wrap_v = TextureWrap::Repeat;
  /** Filters where texels are larger and smaller than pixels. */
  TextureFilter magnified = TextureFilter::Linear;
  TextureFilter minified = TextureFilter::Linear;
  MipFilter mip = MipFilter::Linear;
};

/**
 * A function in GLSL that edits the surface of the materials that name it, at each point that is drawn. doc/surfaces.md
 * describes what it reads and writes.
 */
struct SurfaceFunction {
  static constexpr std::string_view kind_name = "surface function";
  enum class Aspect { Name, Text, Count };
  /** Largest size of `text`. */
  static constexpr std::size_t text_bytes_max = 65536;

  std::string name{};
  /** GLSL 4.5 that defines `void surface(SurfaceInputs inputs, inout StandardSurface result)`. */
  std::string text{};
  /** The file that the text was read from, for messages and files; empty: none. */
  std::string path{};
};

/**
 * The primitives that the indices of a mesh form. Points and lines are a pixel wide in every picture, cast no shadow
 * and are not seen by the reference; a material's sides have no effect on them.
 */
enum class Topology { Triangles, Lines, Points };

/** Number of indices of a triangle, a line or a point. */
[[nodiscard]] constexpr std::size_t index_count_of(Topology topology)
{
  return topology == Topology::Triangles ? 3 : topology == Topology::Lines ? 2 : 1;
}

/**
 * A shape in vertex buffers that a host has on a device. RenderScene::set_host_batch names the buffers. The CPU does
 * not know the triangles: they are drawn and cast shadows, but the reference, light of emissive surfaces, poses and
 * files leave them out.
 */
struct HostShape {
  /** A box around all positions: finite and not empty. Object space, metres. Parts outside of it may be missing. */
  Bounds bounds{};
  /** The streams that the buffers have beside positions and normals, as those of Mesh. */
  bool has_uvs = false;
  bool has_second_uvs = false;
  bool has_tangents = false;
  bool has_colors = false;

  bool operator==(const HostShape &) const = default;
};

/** Indexed triangles, lines or points of one material (a glTF primitive). Object space, metres. */
struct Mesh {
  static constexpr std::string_view kind_name = "mesh";
  /**
   * Shape: the vectors, the topology and the host's shape. Layout: the same without the values of vertices, that is,
   * the indices, the number of vertices and the vectors that are not empty.
   */
  enum class Aspect { Name, Shape, Layout, Material, Count };

  std::string name{};
  /** Metres. The values of this vector and of all others with a value for each position must be finite. */
  std::vector<glm::vec3> positions{};
  /** Unit vectors, one for each position. */
  std::vector<glm::vec3> normals{};
  /**
   * Texture coordinates, one for each position. (0, 0) is the outer corner of the image's first texel. Empty if no
   * texture uses them.
   */
  std::vector<glm::vec2> uvs{};
  /** A second set of texture coordinates. */
  std::vector<glm::vec2> second_uvs{};
  /**
   * Unit vectors along u of the normal texture, one for each position. w is 1 or -1: w · cross(normal, tangent) points
   * up in the image, against v. Empty if the material has neither normal textures nor anisotropy. \see make_tangents
   */
  std::vector<glm::vec4> tangents{};
  /** Multiplied with the material's base colour and alpha: linear, in [0, 1], one for each position. Empty: white. */
  std::vector<glm::vec4> colors{};
  /** Three for each triangle, two for each line, one for each point, each below positions.size(). */
  std::vector<std::uint32_t> indices{};
  Topology topology = Topology::Triangles;
  /** An invalid or stale handle stands for the default material. */
  Handle<Material> material{};
  /** Present: the shape is in buffers of a host, and the vectors above are empty. */
  std::optional<HostShape> host_shape{};
  /** The box around all positions. Scene::add and Scene::replace compute it. */
  Bounds bounds{};
  /** Extras of other programs, of the glTF mesh that contains this primitive, as extras_sentence says. */
  std::string extras{};

  [[nodiscard]] bool has_uvs(int set) const
  {
    return host_shape ? (set == 0 ? host_shape->has_uvs : host_shape->has_second_uvs) : !uv_set(set).empty();
  }
  [[nodiscard]] bool has_tangents() const
  {
    return host_shape ? host_shape->has_tangents : !tangents.empty();
  }
  [[nodiscard]] bool has_colors() const
  {
    return host_shape ? host_shape->has_colors : !colors.empty();
  }
  /** By TextureSlot::uv_set. */
  [[nodiscard]] const std::vector<glm::vec2> &uv_set(int set) const
  {
    return set == 0 ? uvs : second_uvs;
  }
};

/** New values of some vertices of a mesh. \see Scene::set_vertices */
struct VertexValues {
  /** Indices in the vectors of the mesh. */
  std::span<const std::uint32_t> vertices{};
  /** A value for each of `vertices`, as in the vector of Mesh. Empty: the mesh keeps its values. */
  std::span<const glm::vec3> positions{};
  std::span<const glm::vec3> normals{};
  std::span<const glm::vec2> uvs{};
  std::span<const glm::vec2> second_uvs{};
  std::span<const glm::vec4> tangents{};
  std::span<const glm::vec4> colors{};
};

/** Vertices of a mesh that follow each other. */
struct VertexRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;

  bool operator==(const VertexRange &) const = default;
};

/**
 * Calls \a visit for each vector of Mesh that has a value for each position, with three arguments: the member of Mesh,
 * the member of VertexValues and the name of one value. The plural of each name has an s.
 */
template <typename Visit>
constexpr void for_each_stream_member(Visit &&visit)
{
  using namespace std::string_view_literals;
  visit(&Mesh::positions, &VertexValues::positions, "position"sv);
  visit(&Mesh::normals, &VertexValues::normals, "normal"sv);
  visit(&Mesh::uvs, &VertexValues::uvs, "uv"sv);
  visit(&Mesh::second_uvs, &VertexValues::second_uvs, "second uv"sv);
  visit(&Mesh::tangents, &VertexValues::tangents, "tangent"sv);
  visit(&Mesh::colors, &VertexValues::colors, "colour"sv);
}

/** Calls \a function with each vector of \a mesh that has a value for each position. Empty vectors are skipped. */
template <typename AnyMesh, typename Function>
void for_each_stream(AnyMesh &mesh, Function &&function)
{
  for_each_stream_member([&](auto stream, auto /*values*/, std::string_view /*name*/) {
    if (!(mesh.*stream).empty()) {
      function(mesh.*stream);
    }
  });
}

}  // namespace gnomon::scene
