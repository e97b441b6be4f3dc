// SPDX-License-Identifier: MIT
#pragma once

#include "scene_handle.hh"

#include <glm/mat3x2.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/**
 * The contents of a scene as plain data.
 *
 * Units: metres, radians, watts. Colours are linear with Rec. 709 primaries. Each type lists its aspects, on which a
 * consumer may depend separately. An edit gives the changed aspects a new revision (scene.hh).
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

/** An image and its sampler. */
struct Texture {
  static constexpr std::string_view kind_name = "texture";
  enum class Aspect { Image, Sampler, Count };

  Handle<Image> image{};
  TextureWrap wrap_u = TextureWrap::Repeat;
  TextureWrap wrap_v = TextureWrap::Repeat;
  TextureFilter magnified = TextureFilter::Linear;
  TextureFilter minified = TextureFilter::Linear;
  MipFilter mip = MipFilter::Linear;
};

/** A texture of a material, looked up at offset + rotation · (scale · uv), as KHR_texture_transform defines. */
struct TextureSlot {
  TextureSlot() = default;
  TextureSlot(Handle<Texture> texture_) : texture(texture_) {}

  /** An invalid handle stands for no texture. */
  Handle<Texture> texture{};
  /** 0: Mesh::uvs. 1: Mesh::second_uvs. */
  int uv_set = 0;
  glm::vec2 offset{0.0F};
  /** Radians, counter-clockwise on the upright image. */
  float rotation = 0.0F;
  glm::vec2 scale{1.0F};

  /** Whether there is a handle; the texture may have been removed. */
  explicit operator bool() const
  {
    return bool(texture);
  }
  bool operator==(const TextureSlot &) const = default;
  [[nodiscard]] bool is_transformed() const
  {
    return offset != glm::vec2(0.0F) || rotation != 0.0F || scale != glm::vec2(1.0F);
  }
  /** The transform: the image is looked up at `uv_from_mesh * vec3(uv, 1)`. */
  [[nodiscard]] glm::dmat3x2 uv_from_mesh() const;
};

enum class AlphaMode { Opaque, Mask, Blend };

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
 * Metallic-roughness surface of glTF 2.0 with KHR_materials_specular, KHR_materials_clearcoat, KHR_materials_sheen,
 * KHR_materials_anisotropy, KHR_materials_transmission, KHR_materials_volume and KHR_materials_unlit. Factors without
 * another range are in [0, 1]. A mesh without the uvs of a slot is drawn without its texture.
 */
struct Material {
  static constexpr std::string_view kind_name = "material";
  /**
   * Surface: factors of the shading. Coverage: properties that decide which parts of a surface, and of its shadow,
   * exist: alpha mode, alpha, cutoff, sides, surface function, and where light is transmitted, the factors that it is
   * multiplied by; all factors, if a surface function may compute alpha from them. Textures: textures, their
   * transforms, and is_unlit, has_coat, has_sheen, has_anisotropy, has_transmission and surface_function, on which the
   * textures that are read depend.
   */
  enum class Aspect { Name, Surface, Coverage, Textures, Count };

  std::string name{};
  glm::vec3 base_color{1.0F};
  float alpha = 1.0F;
  /** Multiplied with base_color and alpha. */
  TextureSlot base_color_texture{};
  float metallic = 1.0F;
  /** Perceptual; GGX alpha is its square. */
  float roughness = 1.0F;
  /** Green is multiplied with roughness, and blue with metallic. */
  TextureSlot metallic_roughness_texture{};
  /** Tangent space; needs Mesh::tangents. Red and green, mapped to [-1, 1], are multiplied with normal_scale. */
  TextureSlot normal_texture{};
  /** Any finite value. */
  float normal_scale = 1.0F;
  /** Red: the fraction of ambient light that arrives. Of the lamps it affects only Hemi. */
  TextureSlot occlusion_texture{};
  /** 0: occlusion_texture has no effect. */
  float occlusion_strength = 1.0F;
  /** Scales dielectric reflection at normal incidence (0.04); 0 leaves a Lambertian surface. */
  float specular = 1.0F;
  /** Tints dielectric reflection. May exceed 1; the product with 0.04 is clamped to 1. */
  glm::vec3 specular_color{1.0F};
  /** Alpha is multiplied with specular. */
  TextureSlot specular_texture{};
  /** Multiplied with specular_color. */
  TextureSlot specular_color_texture{};
  /** Part of the surface under a clear coat of index 1.5. 0: no coat. */
  float coat = 0.0F;
  /** Perceptual. */
  float coat_roughness = 0.0F;
  /** Red is multiplied with coat. */
  TextureSlot coat_texture{};
  /** Green is multiplied with coat_roughness. */
  TextureSlot coat_roughness_texture{};
  /** As normal_texture, of the coat; without it the coat is as smooth as the mesh, whatever normal_texture is. */
  TextureSlot coat_normal_texture{};
  /** Any finite value. */
  float coat_normal_scale = 1.0F;
  /** Reflectance of fibres on the base, under the coat. Black: no sheen. */
  glm::vec3 sheen_color{0.0F};
  /** Perceptual. */
  float sheen_roughness = 0.0F;
  /** Multiplied with sheen_color. */
  TextureSlot sheen_color_texture{};
  /** Alpha is multiplied with sheen_roughness. */
  TextureSlot sheen_roughness_texture{};
  /**
   * How much rougher the base is along one direction of the surface: alpha there is mix(alpha, 1, anisotropy²). 0: the
   * same in all directions. Needs Mesh::tangents. The coat is not affected.
   */
  float anisotropy = 0.0F;
  /** Angle of that direction from the tangent, radians, counter-clockwise on the upright image. Any finite value. */
  float anisotropy_rotation = 0.0F;
  /** Red and green, mapped to [-1, 1]: the direction before the rotation. Blue is multiplied with anisotropy. */
  TextureSlot anisotropy_texture{};
  /** Part of the light that enters the base and passes it instead of being scattered. 0: opaque. */
  float transmission = 0.0F;
  /** Red is multiplied with transmission. */
  TextureSlot transmission_texture{};
  /**
   * Length of the light's way inside of the object, object space, at least 0. 0: a thin wall, which does not refract.
   * Used with transmission only, as the following members.
   */
  float thickness = 0.0F;
  /** Green is multiplied with thickness. */
  TextureSlot thickness_texture{};
  /** Index of refraction of the volume, at least 1. It does not change the reflection: that is `specular_color`. */
  float ior = 1.5F;
  /** Metres after which `attenuation_color` is left of white light; 0: nothing is absorbed. */
  float attenuation_distance = 0.0F;
  glm::vec3 attenuation_color{1.0F};
  /** Scene-linear radiance, W/(sr m²) per channel. May exceed 1. */
  glm::vec3 emissive{0.0F};
  /** Multiplied with emissive. */
  TextureSlot emissive_texture{};
  /** Lamps have no effect: the radiance is the base colour. */
  bool is_unlit = false;
  AlphaMode alpha_mode = AlphaMode::Opaque;
  /** Mask only: the surface is cut out where alpha is below. */
  float alpha_cutoff = 0.5F;
  /** false: back faces are not drawn and cast no light. */
  bool is_double_sided = false;
  /** Edits the surface; an invalid handle stands for none. */
  Handle<SurfaceFunction> surface_function{};

  [[nodiscard]] bool has_coat() const
  {
    return coat > 0.0F && !is_unlit;
  }
  [[nodiscard]] bool has_sheen() const
  {
    return sheen_color != glm::vec3(0.0F) && !is_unlit;
  }
  [[nodiscard]] bool has_anisotropy() const
  {
    return anisotropy > 0.0F && !is_unlit;
  }
  /** Whether the material needs Mesh::tangents. */
  [[nodiscard]] bool has_frame() const
  {
    return normal_texture || coat_normal_texture || has_anisotropy();
  }
  [[nodiscard]] bool has_transmission() const
  {
    return transmission > 0.0F && !is_unlit;
  }
};

/** One of a material's texture slots. */
struct TextureInput {
  TextureSlot Material::*slot;
  /** Name of the slot, and of its sampler in shaders. */
  std::string_view name;
  /** Red, green and blue are encoded as sRGB. */
  bool is_color;
};

/** All texture slots. */
inline constexpr std::array<TextureInput, 15> texture_inputs = {{
    {&Material::base_color_texture, "base_color_texture", true},
    {&Material::metallic_roughness_texture, "metallic_roughness_texture", false},
    {&Material::normal_texture, "normal_texture", false},
    {&Material::occlusion_texture, "occlusion_texture", false},
    {&Material::emissive_texture, "emissive_texture", true},
    {&Material::specular_texture, "specular_texture", false},
    {&Material::specular_color_texture, "specular_color_texture", true},
    {&Material::coat_texture, "coat_texture", false},
    {&Material::coat_roughness_texture, "coat_roughness_texture", false},
    {&Material::sheen_color_texture, "sheen_color_texture", true},
    {&Material::sheen_roughness_texture, "sheen_roughness_texture", false},
    {&Material::anisotropy_texture, "anisotropy_texture", false},
    {&Material::coat_normal_texture, "coat_normal_texture", false},
    {&Material::transmission_texture, "transmission_texture", false},
    {&Material::thickness_texture, "thickness_texture", false},
}};

/**
 * What the indices of a mesh connect. Points and lines are a pixel wide in every picture, cast no shadow and are not
 * seen by the reference; a material's sides have no effect on them.
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
  enum class Aspect { Name, Shape, Material, Count };

  std::string name{};
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

/** Calls \a function with each vector of \a mesh that has a value for each position. Empty vectors are skipped. */
template <typename AnyMesh, typename Function>
void for_each_stream(AnyMesh &mesh, Function &&function)
{
  const auto visit = [&](auto &stream) {
    if (!stream.empty()) {
      function(stream);
    }
  };
  visit(mesh.positions);
  visit(mesh.normals);
  visit(mesh.uvs);
  visit(mesh.second_uvs);
  visit(mesh.tangents);
  visit(mesh.colors);
}

enum class LampKind { Point, Sun, Spot, Hemi, Area };

enum class AreaShape { Rectangle, Ellipse };

enum class ShadowKind { None, Hard, Pcf, Esm, Evsm };

enum class EsmFormat { Half, Float };

/** Shadow settings of one lamp. Each present value overrides the engine's setting. */
struct LampShadow {
  std::optional<ShadowKind> kind{};
  /** Texels along an edge of the depth map or of a cube's face, 1 to 16384. */
  std::optional<int> size{};
  /** Exponent of exponential shadows, 1/m, 0.01 to 1e4. */
  std::optional<float> exponent{};
  /** Factor of the bias that is derived from the texel size, 0 to 100. 1 leaves it unchanged. */
  std::optional<float> bias{};
  /** Casters outside of this distance range are not drawn. Metres, above 0; if both are present, end > start. */
  std::optional<float> clip_start{};
  std::optional<float> clip_end{};
  /** Half the opening angle of the kernel that filters exponential shadows, radians, 0 to π/4. */
  std::optional<float> filter_radius{};
  /** Texels along an edge of the octahedral layer of exponential shadows, 1 to 16384. */
  std::optional<int> esm_size{};
  std::optional<EsmFormat> esm_format{};

  bool operator==(const LampShadow &) const = default;
};

/**
 * A lamp in radiometric units: glTF's photometric units divided by 683 lm/W. It shines along the local -Z axis of its
 * node. The node's scale changes the size of an area lamp and the width of a spot's cone (PlacedLamp::scale), but no
 * other lamp. Shear and mirroring have no effect on lamps.
 */
struct Lamp {
  static constexpr std::string_view kind_name = "lamp";
  /** Light: colour and intensity. Shape: kind, size, cone and range. Shadow: LampShadow. */
  enum class Aspect { Name, Light, Shape, Shadow, Count };

  std::string name{};
  LampKind kind = LampKind::Point;
  glm::vec3 color{1.0F};
  /**
   * Sun: irradiance on a surface that faces it, W/m².
   * Hemi: the same, of a uniform sky over the half space behind the lamp; a surface tilted by t gets (1 + cos t) / 2.
   * Point and spot: radiant intensity, W/sr; irradiance is intensity · cos / (d² + radius²).
   * Area: Blender's power, W: the radiance of the one emitting side is intensity / (4 · area). That is π/4 of the
   * radiance of a Lambertian emitter of as many watts.
   */
  float intensity = 1.0F;
  /** Point and spot: radius of a disk turned to the receiver, metres. 0: a hard shadow. */
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
  /** Has no effect on a hemi lamp. */
  LampShadow shadow{};

  bool operator==(const Lamp &) const = default;
};

enum class CameraKind { Perspective, Orthographic };

/** Looks along the local -Z axis of its node, +Y up. Scale, shear and mirroring of the node do not change it. */
struct Camera {
  static constexpr std::string_view kind_name = "camera";
  enum class Aspect { Name, Lens, Count };

  std::string name{};
  CameraKind kind = CameraKind::Perspective;
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

/** A position in the scene with its contents. Nodes form trees: Scene::add(Node, parent). */
struct Node {
  static constexpr std::string_view kind_name = "node";
  /**
   * Transform: the world matrix, which depends on the node and its ancestors. Content: meshes, lamp and camera.
   * Visibility: is_visible of the node and its ancestors. Shadow: casts_shadow and receives_shadow.
   */
  enum class Aspect { Name, Transform, Content, Visibility, Shadow, Count };

  std::string name{};
  /** Affine and finite; may be singular, sheared or mirrored. */
  glm::dmat4 parent_from_node{1.0};
  /** Meshes that are drawn at the node. */
  std::vector<Handle<Mesh>> meshes{};
  Handle<Lamp> lamp{};
  Handle<Camera> camera{};
  /** false: neither the node nor its descendants are drawn, cast shadows or give light. */
  bool is_visible = true;
  /** Apply only to the node's own meshes. */
  bool casts_shadow = true;
  bool receives_shadow = true;
};

}  // namespace gnomon::scene
