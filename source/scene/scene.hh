// SPDX-License-Identifier: MIT
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/**
 * A scene as plain data: what the engines read and nothing knows how it was loaded.
 *
 * World space is right-handed, in metres, with whatever axis up the file had. Colours are linear
 * with Rec. 709 primaries. Matrices read target-from-source. Everything an importer hands over is
 * finite, every index is in range and every non-singular promise below is kept, so that engines do
 * not check again.
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
};

/** The box around \a bounds after a transform; empty stays empty. */
[[nodiscard]] Bounds transformed(const Bounds &bounds, const glm::mat4 &target_from_source);

/** Texels of a base colour, each four bytes: red, green and blue encoded as sRGB, and linear alpha, not multiplied in.
 */
struct Image {
  std::string name;
  /** Both above 0. */
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  /** 4 · width · height; rows from the top, which is where v is 0. */
  std::vector<std::uint8_t> texels;
  /** To be incremented after an edit of the texels between two syncs, so that engines take the image anew. */
  std::uint64_t revision = 0;
};

enum class TextureWrap { Repeat, MirroredRepeat, ClampToEdge };

enum class TextureFilter { Nearest, Linear };

/** Between which levels of a minified texture; None: the full size only. */
enum class MipFilter { None, Nearest, Linear };

/** How an image is looked up. */
struct Texture {
  /** Index in Scene::images. */
  std::uint32_t image = 0;
  TextureWrap wrap_u = TextureWrap::Repeat;
  TextureWrap wrap_v = TextureWrap::Repeat;
  TextureFilter magnified = TextureFilter::Linear;
  TextureFilter minified = TextureFilter::Linear;
  MipFilter mip = MipFilter::Linear;
};

enum class AlphaMode { Opaque, Mask, Blend };

/** Metallic-roughness surface of glTF 2.0 with KHR_materials_specular. All factors in [0, 1]. */
struct Material {
  std::string name;
  glm::vec3 base_color{1.0F};
  float alpha = 1.0F;
  /** Index in Scene::textures of what base_color and alpha are multiplied with, at Mesh::uvs. -1: none. */
  std::int32_t base_color_texture = -1;
  float metallic = 1.0F;
  /** Perceptual; GGX alpha is its square. */
  float roughness = 1.0F;
  /** Scales dielectric reflection at normal incidence (0.04); 0 leaves a Lambertian surface. */
  float specular = 1.0F;
  /** Tints dielectric reflection. May exceed 1; the product with 0.04 is clamped to 1. */
  glm::vec3 specular_color{1.0F};
  /** Scene-linear radiance, W/(sr m²) per channel. May exceed 1. */
  glm::vec3 emissive{0.0F};
  AlphaMode alpha_mode = AlphaMode::Opaque;
  /** Mask only: below it the surface is cut out. */
  float alpha_cutoff = 0.5F;
  /** false: back faces are not drawn and cast no light. */
  bool is_double_sided = false;
};

/** Indexed triangles of one material (a glTF primitive). */
struct Mesh {
  std::string name;
  /** Object space. */
  std::vector<glm::vec3> positions;
  /** Unit vectors, object space, one a position. */
  std::vector<glm::vec3> normals;
  /**
   * Where its material's base colour texture is looked up, one a position; (0, 0) is the outer corner of the image's
   * first texel. The material's texture transform is in them. Empty where the material has no texture.
   */
  std::vector<glm::vec2> uvs;
  /** Three a triangle, each below positions.size(). */
  std::vector<std::uint32_t> indices;
  /** Index in Scene::materials, always valid. */
  std::uint32_t material = 0;
  /** Object space, never empty. */
  Bounds bounds;
  /** For who changes the rest after a sync: another number, so that engines take the mesh anew. */
  std::uint64_t revision = 0;
};

/** A mesh placed in the world. Several objects may share a mesh. */
struct Object {
  std::string name;
  /** Index in Scene::meshes. */
  std::uint32_t mesh = 0;
  /** Affine; may be singular, sheared or mirrored. */
  glm::mat4 world_from_object{1.0F};
};

enum class LampKind { Point, Sun, Spot, Hemi, Area };

enum class AreaShape { Rectangle, Ellipse };

enum class ShadowKind { None, Hard, Pcf, Esm, Evsm };

enum class EsmFormat { Half, Float };

/** What a lamp asks of its shadow; what is absent is left to whoever draws it. */
struct LampShadow {
  std::optional<ShadowKind> kind;
  /** Texels along an edge of the depth map or of a cube's face, 1 to 16384. */
  std::optional<int> size;
  /** Of exponential shadows, 1/m, 0.01 to 1e4. */
  std::optional<float> exponent;
  /** Scales the bias that is derived from the texel; 0 to 100, and 1 leaves it. */
  std::optional<float> bias;
  /** Casters nearer or farther than these are not drawn, metres, above 0; where both are there, end > start. */
  std::optional<float> clip_start;
  std::optional<float> clip_end;
  /** Half the opening angle of the kernel that exponential shadows are filtered with, radians, 0 to π/4. */
  std::optional<float> filter_radius;
  /** Texels along an edge of the octahedral layer of exponential shadows, 1 to 16384. */
  std::optional<int> esm_size;
  std::optional<EsmFormat> esm_format;

  bool operator==(const LampShadow &) const = default;
};

/**
 * A lamp in radiometric units: glTF's photometric ones divided by 683 lm/W.
 * It looks along its local -Z.
 */
struct Lamp {
  std::string name;
  LampKind kind = LampKind::Point;
  /** Columns 0 to 2 are orthonormal: node scale does not change a lamp. */
  glm::mat4 world_from_lamp{1.0F};
  glm::vec3 color{1.0F};
  /**
   * Sun: irradiance on a surface that faces it, W/m².
   * Hemi: the same, of a uniform sky over the half space behind the lamp; a surface tilted by t gets (1 + cos t) / 2.
   * Point and spot: radiant intensity, W/sr; irradiance is intensity · cos / (d² + radius²).
   * Area: power of the one emitting side, W.
   */
  float intensity = 1.0F;
  /** Point and spot: a disk turned to the receiver, metres. 0: a hard shadow. */
  float radius = 0.0F;
  /** Sun: angular diameter, radians. 0: a hard shadow. */
  float angle = 0.0F;
  /** Spot: half the opening angle, radians, in (0, π/2]. */
  float spot_outer_angle = 0.785398F;
  /**
   * Spot: width of the soft edge as a fraction of 1 - cos(outer), in [0, 1]. 0: a hard edge.
   * Transmission is smoothstep(0, 1, (cos - cos_outer) / ((1 - cos_outer) · blend)).
   */
  float spot_blend = 0.0F;
  /** Point and spot: no light beyond, metres. 0: no limit. */
  float range = 0.0F;
  AreaShape area_shape = AreaShape::Rectangle;
  /** Area: full edge lengths or diameters, metres, above 0. */
  float area_size_x = 1.0F;
  float area_size_y = 1.0F;
  /** Point, spot and sun. */
  LampShadow shadow;

  bool operator==(const Lamp &) const = default;
};

enum class CameraKind { Perspective, Orthographic };

/** Looks along its local -Z, +Y up. */
struct Camera {
  std::string name;
  CameraKind kind = CameraKind::Perspective;
  /** Columns 0 to 2 are orthonormal: node scale does not change a camera. */
  glm::mat4 world_from_camera{1.0F};
  /** Perspective: full vertical angle, radians, in (0, π). */
  float vertical_angle = 0.8F;
  /** Perspective: width / height of the frame. 0: that of the image. */
  float aspect = 0.0F;
  /** Orthographic: half width and half height of the frame, metres, above 0. */
  float half_width = 1.0F;
  float half_height = 1.0F;
  /** Distances along the view direction, metres; near > 0 when perspective, far > near. far 0: infinite. */
  float near = 0.1F;
  float far = 0.0F;
};

struct Scene {
  /** The file as the user named it; for messages. */
  std::string path;
  std::vector<Mesh> meshes;
  std::vector<Material> materials;
  /** Only what some material looks up. */
  std::vector<Texture> textures;
  std::vector<Image> images;
  std::vector<Object> objects;
  std::vector<Lamp> lamps;
  /** At least one after import; the first is the default. */
  std::vector<Camera> cameras;
  /** The file had none, and what stands in cameras or lamps was made up. */
  bool is_camera_default = false;
  bool is_lamp_default = false;
  /** What was left out or mended at the door, each naming the element and the reason. */
  std::vector<std::string> warnings;

  /** World space box around all objects; empty when there is none. */
  [[nodiscard]] Bounds bounds() const;
};

}  // namespace gnomon::scene
