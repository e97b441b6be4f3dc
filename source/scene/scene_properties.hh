// SPDX-License-Identifier: MIT
#pragma once

#include "scene_handle.hh"
#include "scene_property.hh"

#include <glm/mat3x2.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/**
 * Lamps, cameras, materials and nodes, each with the rows that describe its properties.
 *
 * Each type has its members first, and then for_each_property(visit), which calls \a visit with a row (Property) for
 * each of them. Checks of edits and their comparison, the fingerprint, files, Python and its stub, the window and the
 * documentation read the rows: add a property here, and use it. \see scene_world.hh for worlds
 */
namespace gnomon::scene {

struct Mesh;
struct SurfaceFunction;
struct Texture;

/** The sentence of the rows of `extras`. */
inline constexpr std::string_view extras_sentence =
    "What other programs have added to the thing in its file: a JSON object without members that begin with gnomon_, "
    "which export_gltf writes again. Empty: nothing.";

/** Smallest length above 0, metres. The square of a smaller one would underflow in float. */
inline constexpr double smallest_length = 1e-12;

enum class LampKind { Point, Sun, Spot, Hemi, Area };
template <>
inline constexpr std::array<std::string_view, 5> words<LampKind>{"point", "sun", "spot", "hemi", "area"};

enum class AreaShape { Rectangle, Ellipse };
template <>
inline constexpr std::array<std::string_view, 2> words<AreaShape>{"rectangle", "ellipse"};

enum class ShadowKind { None, Hard, Pcf, Esm, Evsm };
template <>
inline constexpr std::array<std::string_view, 5> words<ShadowKind>{"none", "hard", "pcf", "esm", "evsm"};

enum class EsmFormat { Half, Float };
template <>
inline constexpr std::array<std::string_view, 2> words<EsmFormat>{"16f", "32f"};

/**
 * Shadow settings of one lamp. A present value replaces the setting of the engine, if there is one. If the engine's
 * kind is None, no lamp has a shadow. Units and limits are in the rows below.
 */
struct LampShadow {
  std::optional<ShadowKind> kind{};
  std::optional<int> size{};
  std::optional<float> exponent{};
  std::optional<float> bias{};
  std::optional<float> clip_start{};
  /** If both are present, above clip_start. */
  std::optional<float> clip_end{};
  std::optional<float> filter_angle{};
  std::optional<int> esm_size{};
  std::optional<EsmFormat> esm_format{};

  bool operator==(const LampShadow &) const = default;

  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

/**
 * A lamp in radiometric units: glTF's photometric units divided by 683 lm/W. It shines along the local -Z axis of its
 * node. The node's scale changes the size of an area lamp and the width of a spot's cone (PlacedLamp::scale), but no
 * other lamp. Shear and mirroring have no effect on lamps. Units and limits are in the rows below.
 */
struct Lamp {
  static constexpr std::string_view kind_name = "lamp";
  /** Light: colour and intensity. Shape: kind, size, cone and range. Shadow: LampShadow. */
  enum class Aspect { Name, Light, Shape, Shadow, Count };

  std::string name{};
  LampKind kind = LampKind::Point;
  glm::vec3 color{1.0F};
  /**
   * Point and spot: irradiance is intensity · cos / (d² + radius²).
   * Hemi: a surface tilted by t gets (1 + cos t) / 2 of it.
   * Area: the radiance of the one emitting side is intensity / (4 · area), as Blender has it. That is π/4 of the
   * radiance of a Lambertian emitter of as many watts.
   */
  float intensity = 1.0F;
  float radius = 0.0F;
  float angle = 0.0F;
  float spot_outer_angle = 0.785398F;
  /** Transmission is smoothstep(0, 1, (cos - cos_outer) / ((1 - cos_outer) · blend)). */
  float spot_blend = 0.0F;
  float range = 0.0F;
  AreaShape area_shape = AreaShape::Rectangle;
  float area_size_x = 1.0F;
  float area_size_y = 1.0F;
  /** Has no effect on a hemi lamp. */
  LampShadow shadow{};
  std::string extras{};

  bool operator==(const Lamp &) const = default;

  /** Visits the rows of all members but `shadow`, which LampShadow has. */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

template <typename Visit>
constexpr void Lamp::for_each_property(Visit &&visit)
{
  using enum LampKind;
  visit(
      property(&Lamp::name, {.name = "name", .aspect = unsigned(Aspect::Name), .sentence = "For messages and files."}));
  visit(property(&Lamp::extras, {.name = "extras", .aspect = unsigned(Aspect::Name), .sentence = extras_sentence}));
  visit(
      property(&Lamp::kind,
               {.name = "kind", .label = "Kind", .aspect = unsigned(Aspect::Shape), .sentence = "The kind of lamp."}));
  visit(property(&Lamp::color, {.name = "color",
                                .label = "Color",
                                .extra_kinds = bits(Area),
                                .path = "color",
                                .is_animated = true,
                                .aspect = unsigned(Aspect::Light),
                                .sentence = "Linear red, green and blue."}));
  visit(property(&Lamp::intensity,
                 {.name = "intensity",
                  .key = "power",
                  .label = "Power",
                  .max = light_max,
                  .extra_kinds = bits(Area),
                  .path = "intensity",
                  .is_animated = true,
                  .aspect = unsigned(Aspect::Light),
                  .sentence = "Point and spot: radiant intensity, W/sr. Sun: irradiance on a surface that faces the "
                              "lamp, W/m². Hemi: irradiance on such a surface from a uniform sky in the half space "
                              "behind the lamp, W/m². Area: power, W."}));
  visit(property(&Lamp::radius, {.name = "radius",
                                 .label = "Radius",
                                 .unit = "m",
                                 .kinds = bits(Point, Spot),
                                 .extra_kinds = bits(Point, Spot),
                                 .aspect = unsigned(Aspect::Shape),
                                 .sentence = "Radius of a disk turned to the receiver. 0: a hard shadow."}));
  visit(property(&Lamp::angle, {.name = "angle",
                                .label = "Angle",
                                .unit = "rad",
                                .max = std::numbers::pi,
                                .kinds = bits(Sun),
                                .extra_kinds = bits(Sun),
                                .aspect = unsigned(Aspect::Shape),
                                .sentence = "Angular diameter. 0: a hard shadow."}));
  // For smaller angles, 1 - cos would underflow in float.
  visit(property(&Lamp::spot_outer_angle, {.name = "spot_outer_angle",
                                           .key = "cone",
                                           .label = "Cone",
                                           .unit = "rad",
                                           .min = 1e-9,
                                           .max = std::numbers::pi / 2,
                                           .kinds = bits(Spot),
                                           .path = "spot/outerConeAngle",
                                           .is_animated = true,
                                           .aspect = unsigned(Aspect::Shape),
                                           .sentence = "Half the opening angle of the cone."}));
  visit(property(&Lamp::spot_blend,
                 {.name = "spot_blend",
                  .label = "Blend",
                  .max = 1.0,
                  .kinds = bits(Spot),
                  .extra_kinds = bits(Spot),
                  .aspect = unsigned(Aspect::Shape),
                  .sentence = "Width of the soft edge as a fraction of 1 - cos of the cone. 0: a hard edge."}));
  visit(property(&Lamp::range, {.name = "range",
                                .label = "Range",
                                .unit = "m",
                                .min = smallest_length,
                                .zero = "no limit",
                                .first = 10,
                                .kinds = bits(Point, Spot),
                                .path = "range",
                                .is_animated = true,
                                .aspect = unsigned(Aspect::Shape),
                                .sentence = "No light beyond this distance. 0: no limit."}));
  visit(property(&Lamp::area_shape, {.name = "area_shape",
                                     .key = "shape",
                                     .label = "Shape",
                                     .kinds = bits(Area),
                                     .extra_kinds = bits(Area),
                                     .aspect = unsigned(Aspect::Shape),
                                     .sentence = "The shape of the emitting side."}));
  visit(property(&Lamp::area_size_x, {.name = "area_size_x",
                                      .key = "size_x",
                                      .label = "Size X",
                                      .unit = "m",
                                      .min = smallest_length,
                                      .kinds = bits(Area),
                                      .extra_kinds = bits(Area),
                                      .aspect = unsigned(Aspect::Shape),
                                      .sentence = "Full edge length or diameter along x."}));
  visit(property(&Lamp::area_size_y, {.name = "area_size_y",
                                      .key = "size_y",
                                      .label = "Size Y",
                                      .unit = "m",
                                      .min = smallest_length,
                                      .kinds = bits(Area),
                                      .extra_kinds = bits(Area),
                                      .aspect = unsigned(Aspect::Shape),
                                      .sentence = "Full edge length or diameter along y."}));
}

template <typename Visit>
constexpr void LampShadow::for_each_property(Visit &&visit)
{
  constexpr unsigned casting = bits(LampKind::Point, LampKind::Sun, LampKind::Spot, LampKind::Area);
  constexpr unsigned shadow = unsigned(Lamp::Aspect::Shadow);
  constexpr std::string_view settings = "Shadow settings";
  visit(property(&LampShadow::kind, {.name = "shadow_kind",
                                     .key = "shadow",
                                     .label = "Shadow",
                                     .kinds = casting,
                                     .extra_kinds = casting,
                                     .aspect = shadow,
                                     .sentence = "The method of the shadow. Absent: that of the engine."}));
  visit(property(&LampShadow::size,
                 {.name = "shadow_size_px",
                  .key = "shadow_size",
                  .label = "Size",
                  .group = settings,
                  .unit = "px",
                  .min = 1,
                  .max = 16384,
                  .first = 1024,
                  .kinds = casting,
                  .extra_kinds = casting,
                  .aspect = shadow,
                  .sentence = "Edge of the depth map or of a cube's face. Absent: half of the layer size for "
                              "exponential shadows, otherwise that of the engine."}));
  visit(property(&LampShadow::bias,
                 {.name = "shadow_bias",
                  .key = "bias",
                  .label = "Bias",
                  .group = settings,
                  .max = 100,
                  .first = 1,
                  .kinds = casting,
                  .extra_kinds = casting,
                  .aspect = shadow,
                  .sentence = "Factor of the bias that is derived from the texel size. Absent: that of the "
                              "engine for exponential shadows, otherwise 1."}));
  visit(property(&LampShadow::clip_start, {.name = "shadow_clip_start",
                                           .key = "clip_start",
                                           .label = "Clip start",
                                           .group = settings,
                                           .unit = "m",
                                           .min = smallest_length,
                                           .first = 0.1,
                                           .kinds = casting,
                                           .extra_kinds = casting,
                                           .aspect = shadow,
                                           .sentence = "Casters nearer than this cast no shadow. Absent: no "
                                                       "limit."}));
  visit(
      property(&LampShadow::clip_end, {.name = "shadow_clip_end",
                                       .key = "clip_end",
                                       .label = "Clip end",
                                       .group = settings,
                                       .unit = "m",
                                       .min = smallest_length,
                                       .first = 100,
                                       .kinds = casting,
                                       .extra_kinds = casting,
                                       .aspect = shadow,
                                       .sentence = "Casters farther than this, which is above the clip start, cast no "
                                                   "shadow. Absent: no limit."}));
  visit(property(
      &LampShadow::exponent,
      {.name = "shadow_exponent",
       .key = "exponent",
       .label = "Exponent",
       .group = settings,
       .unit = "1/m",
       .min = 0.01,
       .max = 1e4,
       .first = 10,
       .kinds = casting,
       .extra_kinds = casting,
       .aspect = shadow,
       .sentence = "Exponential shadows: exponent. Absent: that of the engine. If that is absent too, it is derived "
                   "from the size, the filter and the range of the shadow."}));
  visit(property(
      &LampShadow::filter_angle,
      {.name = "shadow_filter_angle",
       .key = "filter_radius",
       .label = "Filter radius",
       .group = settings,
       .unit = "rad",
       .max = std::numbers::pi / 4,
       .first = std::numbers::pi / 180,
       .kinds = casting,
       .extra_kinds = casting,
       .is_extra_in_degrees = true,
       .aspect = shadow,
       .sentence = "Exponential shadows: half the opening angle of the filter. Absent: that of the engine. If that is "
                   "absent too, half the mean angle of a texel."}));
  visit(property(&LampShadow::esm_size, {.name = "shadow_esm_size_px",
                                         .key = "esm_size",
                                         .label = "Layer size",
                                         .group = settings,
                                         .unit = "px",
                                         .min = 4,
                                         .max = 8192,
                                         .first = 512,
                                         .kinds = casting,
                                         .extra_kinds = casting,
                                         .aspect = shadow,
                                         .sentence = "Exponential shadows: edge of the octahedral layer. Absent: that "
                                                     "of the engine."}));
  visit(property(
      &LampShadow::esm_format,
      {.name = "shadow_esm_format",
       .key = "esm_format",
       .label = "Layer format",
       .group = settings,
       .kinds = casting,
       .extra_kinds = casting,
       .aspect = shadow,
       .sentence =
           "ESM: format of the octahedral layer. Absent: that of the engine. If that is absent too, the smaller "
           "one that is accurate."}));
}

enum class CameraKind { Perspective, Orthographic };
template <>
inline constexpr std::array<std::string_view, 2> words<CameraKind>{"perspective", "orthographic"};

/** Looks along the local -Z axis of its node, +Y up. Scale, shear and mirroring of the node do not change it. */
struct Camera {
  static constexpr std::string_view kind_name = "camera";
  enum class Aspect { Name, Lens, Count };

  std::string name{};
  CameraKind kind = CameraKind::Perspective;
  float vertical_angle = 0.8F;
  float aspect = 0.0F;
  float half_width = 1.0F;
  float half_height = 1.0F;
  /** Distances along the view direction, metres. far > near, or 0. Perspective: near > 0. \see the rows */
  float near = 0.1F;
  float far = 0.0F;
  float shift_x = 0.0F;
  float shift_y = 0.0F;
  float aperture_radius = 0.0F;
  float focus_distance = 0.0F;
  int aperture_blades = 0;
  float aperture_rotation = 0.0F;
  float aperture_ratio = 1.0F;
  std::string extras{};

  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

template <typename Visit>
constexpr void Camera::for_each_property(Visit &&visit)
{
  using enum CameraKind;
  constexpr unsigned lens = unsigned(Aspect::Lens);
  constexpr unsigned any = bits(Perspective, Orthographic);
  visit(property(&Camera::name,
                 {.name = "name", .aspect = unsigned(Aspect::Name), .sentence = "For messages and files."}));
  visit(property(&Camera::extras, {.name = "extras", .aspect = unsigned(Aspect::Name), .sentence = extras_sentence}));
  visit(property(&Camera::kind,
                 {.name = "kind", .label = "Kind", .aspect = lens, .sentence = "The kind of projection."}));
  visit(property(&Camera::vertical_angle, {.name = "vertical_angle",
                                           .label = "Vertical angle",
                                           .unit = "rad",
                                           .min = 1e-6,
                                           .max = 3.1415925,
                                           .kinds = bits(Perspective),
                                           .path = "perspective/yfov",
                                           .is_animated = true,
                                           .aspect = lens,
                                           .sentence = "Full vertical angle."}));
  visit(property(&Camera::aspect, {.name = "aspect",
                                   .label = "Width / height",
                                   .min = 1e-6,
                                   .max = 1e6,
                                   .zero = "as the picture",
                                   .first = 1.5,
                                   .kinds = bits(Perspective),
                                   .path = "perspective/aspectRatio",
                                   .is_animated = true,
                                   .aspect = lens,
                                   .sentence = "Width / height of the frame. 0: that of the picture."}));
  visit(property(&Camera::half_width,
                 {.name = "half_width",
                  .label = "Half width",
                  .unit = "m",
                  .min = -number_max,
                  .least = smallest_length,
                  .kinds = bits(Orthographic),
                  .path = "orthographic/xmag",
                  .is_animated = true,
                  .aspect = lens,
                  .sentence = "Half the width of the frame. Below 0: left and right are exchanged."}));
  visit(property(&Camera::half_height,
                 {.name = "half_height",
                  .label = "Half height",
                  .unit = "m",
                  .min = -number_max,
                  .least = smallest_length,
                  .kinds = bits(Orthographic),
                  .path = "orthographic/ymag",
                  .is_animated = true,
                  .aspect = lens,
                  .sentence = "Half the height of the frame. Below 0: up and down are exchanged."}));
  visit(
      property(&Camera::near,
               {.name = "near",
                .label = "Near",
                .unit = "m",
                .min = -number_max,
                .path = "znear",
                .aspect = lens,
                .sentence = "Distance of the near plane. Perspective: above 0. A file can have no distance below 0."}));
  visit(property(&Camera::far, {.name = "far",
                                .label = "Far",
                                .unit = "m",
                                .min = smallest_length,
                                .zero = "infinite",
                                .first = 1000,
                                .path = "zfar",
                                .aspect = lens,
                                .sentence = "Distance of the far plane. Perspective: 0 is infinite."}));
  visit(property(&Camera::shift_x, {.name = "shift_x",
                                    .label = "Shift x",
                                    .min = -100,
                                    .max = 100,
                                    .extra_kinds = any,
                                    .aspect = lens,
                                    .sentence = "Shift of the frame to the right, in widths of the frame."}));
  visit(property(&Camera::shift_y, {.name = "shift_y",
                                    .label = "Shift y",
                                    .min = -100,
                                    .max = 100,
                                    .extra_kinds = any,
                                    .aspect = lens,
                                    .sentence = "Shift of the frame upwards, in heights of the frame."}));
  visit(property(&Camera::aperture_radius,
                 {.name = "aperture_radius",
                  .option = "aperture",
                  .label = "Aperture radius",
                  .unit = "m",
                  .kinds = bits(Perspective),
                  .extra_kinds = bits(Perspective),
                  .aspect = lens,
                  .sentence = "Half the height of the aperture: focal length / (2 f-number). 0: all is in focus."}));
  visit(property(&Camera::focus_distance,
                 {.name = "focus_distance",
                  .option = "focus",
                  .label = "Focus distance",
                  .unit = "m",
                  .min = smallest_length,
                  .zero = "infinite",
                  .first = 1,
                  .kinds = bits(Perspective),
                  .extra_kinds = bits(Perspective),
                  .aspect = lens,
                  .sentence = "Distance of the plane in focus, along the view direction. 0: infinite."}));
  visit(property(&Camera::aperture_blades, {.name = "aperture_blades",
                                            .label = "Aperture blades",
                                            .min = 3,
                                            .max = 64,
                                            .zero = "round",
                                            .first = 6,
                                            .kinds = bits(Perspective),
                                            .extra_kinds = bits(Perspective),
                                            .aspect = lens,
                                            .sentence = "Corners of a polygonal aperture. 0: round."}));
  visit(property(&Camera::aperture_rotation,
                 {.name = "aperture_rotation",
                  .label = "Aperture rotation",
                  .unit = "rad",
                  .min = -number_max,
                  .kinds = bits(Perspective),
                  .extra_kinds = bits(Perspective),
                  .aspect = lens,
                  .sentence = "Angle from the camera's +X axis to the middle of an edge, counter-clockwise."}));
  visit(property(&Camera::aperture_ratio, {.name = "aperture_ratio",
                                           .label = "Aperture ratio",
                                           .min = 1e-3,
                                           .max = 1e3,
                                           .kinds = bits(Perspective),
                                           .extra_kinds = bits(Perspective),
                                           .aspect = lens,
                                           .sentence = "Height of the aperture over its width."}));
}

enum class AlphaMode { Opaque, Mask, Blend };
template <>
inline constexpr std::array<std::string_view, 3> words<AlphaMode>{"opaque", "mask", "blend"};

/** A texture of a material, looked up at offset + rotation · (scale · uv), as KHR_texture_transform defines. */
struct TextureSlot {
  TextureSlot() = default;
  TextureSlot(Handle<Texture> texture_) : texture(texture_) {}

  /** An invalid handle stands for no texture. */
  Handle<Texture> texture{};
  int uv_set = 0;
  glm::vec2 offset{0.0F};
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

  /** Visits the rows of all members but `texture`. */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

template <typename Visit>
constexpr void TextureSlot::for_each_property(Visit &&visit)
{
  // In this range floats still distinguish texels.
  constexpr double limit = 1e6;
  visit(property(&TextureSlot::uv_set,
                 {.name = "uv_set", .max = 1, .path = "texCoord", .sentence = "0: Mesh::uvs. 1: Mesh::second_uvs."}));
  visit(property(&TextureSlot::offset, {.name = "offset",
                                        .min = -limit,
                                        .max = limit,
                                        .path = "offset",
                                        .sentence = "Added to the texture coordinates."}));
  visit(property(&TextureSlot::rotation, {.name = "rotation",
                                          .unit = "rad",
                                          .min = -limit,
                                          .max = limit,
                                          .path = "rotation",
                                          .sentence = "Counter-clockwise on the upright image."}));
  visit(property(&TextureSlot::scale, {.name = "scale",
                                       .min = -limit,
                                       .max = limit,
                                       .path = "scale",
                                       .sentence = "Factor of the texture coordinates, before the rotation."}));
}

/**
 * Metallic-roughness surface of glTF 2.0 with KHR_materials_specular, KHR_materials_clearcoat, KHR_materials_sheen,
 * KHR_materials_anisotropy, KHR_materials_transmission, KHR_materials_volume and KHR_materials_unlit. A mesh
 * without the uvs of a slot is drawn without its texture.
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
  float roughness = 1.0F;
  /** Green is multiplied with roughness, and blue with metallic. */
  TextureSlot metallic_roughness_texture{};
  /** Tangent space; needs Mesh::tangents. Red and green, mapped to [-1, 1], are multiplied with normal_scale. */
  TextureSlot normal_texture{};
  float normal_scale = 1.0F;
  /** Red: the fraction of ambient light that arrives. Of the lamps it affects only Hemi. */
  TextureSlot occlusion_texture{};
  float occlusion_strength = 1.0F;
  float specular = 1.0F;
  glm::vec3 specular_color{1.0F};
  /** Alpha is multiplied with specular. */
  TextureSlot specular_texture{};
  /** Multiplied with specular_color. */
  TextureSlot specular_color_texture{};
  float coat = 0.0F;
  float coat_roughness = 0.0F;
  /** Red is multiplied with coat. */
  TextureSlot coat_texture{};
  /** Green is multiplied with coat_roughness. */
  TextureSlot coat_roughness_texture{};
  /** The normal_texture of the coat; without it the coat is as smooth as the mesh, whatever normal_texture is. */
  TextureSlot coat_normal_texture{};
  float coat_normal_scale = 1.0F;
  glm::vec3 sheen_color{0.0F};
  float sheen_roughness = 0.0F;
  /** Multiplied with sheen_color. */
  TextureSlot sheen_color_texture{};
  /** Alpha is multiplied with sheen_roughness. */
  TextureSlot sheen_roughness_texture{};
  float anisotropy = 0.0F;
  float anisotropy_rotation = 0.0F;
  /** Red and green, mapped to [-1, 1]: the direction before the rotation. Blue is multiplied with anisotropy. */
  TextureSlot anisotropy_texture{};
  float transmission = 0.0F;
  /** Red is multiplied with transmission. */
  TextureSlot transmission_texture{};
  float thickness = 0.0F;
  /** Green is multiplied with thickness. */
  TextureSlot thickness_texture{};
  float ior = 1.5F;
  float attenuation_distance = 0.0F;
  glm::vec3 attenuation_color{1.0F};
  glm::vec3 emissive{0.0F};
  /** Multiplied with emissive. */
  TextureSlot emissive_texture{};
  bool is_unlit = false;
  AlphaMode alpha_mode = AlphaMode::Opaque;
  float alpha_cutoff = 0.5F;
  bool is_double_sided = false;
  /** Edits the surface; an invalid handle stands for none. */
  Handle<SurfaceFunction> surface_function{};
  std::string extras{};

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

  /** Visits the rows of all members but `surface_function` and the texture slots, which texture_inputs lists. */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

template <typename Visit>
constexpr void Material::for_each_property(Visit &&visit)
{
  using enum Aspect;
  constexpr std::string_view coat_group = "Coat";
  constexpr std::string_view sheen_group = "Sheen";
  constexpr std::string_view anisotropy_group = "Anisotropy";
  constexpr std::string_view transmission_group = "Transmission";
  // In this range floats still distinguish texels.
  constexpr double texel_limit = 1e6;
  visit(property(&Material::name, {.name = "name", .aspect = unsigned(Name), .sentence = "For messages and files."}));
  visit(property(&Material::extras, {.name = "extras", .aspect = unsigned(Name), .sentence = extras_sentence}));
  visit(property(&Material::base_color, {.name = "base_color",
                                         .label = "Base color",
                                         .max = 1,
                                         .path = "pbrMetallicRoughness/baseColorFactor",
                                         .is_animated = true,
                                         .aspect = unsigned(Surface),
                                         .sentence = "Linear red, green and blue."}));
  visit(property(&Material::alpha, {.name = "alpha",
                                    .label = "Alpha",
                                    .max = 1,
                                    .aspect = unsigned(Coverage),
                                    .sentence = "Opacity, if alpha_mode uses it."}));
  visit(property(&Material::alpha_mode, {.name = "alpha_mode",
                                         .label = "Alpha mode",
                                         .path = "alphaMode",
                                         .aspect = unsigned(Coverage),
                                         .sentence = "How alpha is used."}));
  visit(property(&Material::alpha_cutoff,
                 {.name = "alpha_cutoff",
                  .label = "Cutoff",
                  .max = 2,
                  .path = "alphaCutoff",
                  .is_animated = true,
                  .aspect = unsigned(Coverage),
                  .sentence = "alpha_mode mask: the surface is cut out where alpha is less. Above 1: everywhere."}));
  visit(property(&Material::metallic, {.name = "metallic",
                                       .label = "Metallic",
                                       .max = 1,
                                       .path = "pbrMetallicRoughness/metallicFactor",
                                       .is_animated = true,
                                       .aspect = unsigned(Surface),
                                       .sentence = "0: a dielectric. 1: a metal."}));
  visit(property(&Material::roughness, {.name = "roughness",
                                        .label = "Roughness",
                                        .max = 1,
                                        .path = "pbrMetallicRoughness/roughnessFactor",
                                        .is_animated = true,
                                        .aspect = unsigned(Surface),
                                        .sentence = "Perceptual; GGX alpha is its square."}));
  visit(property(&Material::normal_scale, {.name = "normal_scale",
                                           .label = "Normal scale",
                                           .min = -texel_limit,
                                           .max = texel_limit,
                                           .path = "normalTexture/scale",
                                           .is_animated = true,
                                           .aspect = unsigned(Surface),
                                           .sentence = "Factor of the normal texture's red and green."}));
  visit(
      property(&Material::occlusion_strength, {.name = "occlusion_strength",
                                               .label = "Occlusion",
                                               .max = 1,
                                               .path = "occlusionTexture/strength",
                                               .is_animated = true,
                                               .aspect = unsigned(Surface),
                                               .sentence = "Strength of the occlusion texture. 0: it has no effect."}));
  visit(property(&Material::specular,
                 {.name = "specular",
                  .label = "Specular",
                  .max = 1,
                  .path = "extensions/KHR_materials_specular/specularFactor",
                  .is_animated = true,
                  .aspect = unsigned(Surface),
                  .sentence = "Factor of dielectric reflection at normal incidence, 0.04. 0: a Lambertian surface."}));
  visit(property(&Material::specular_color,
                 {.name = "specular_color",
                  .label = "Specular color",
                  .path = "extensions/KHR_materials_specular/specularColorFactor",
                  .is_animated = true,
                  .aspect = unsigned(Surface),
                  .sentence = "Tint of dielectric reflection; the product with 0.04 is clamped to 1."}));
  visit(property(&Material::coat, {.name = "coat",
                                   .label = "Coat",
                                   .group = coat_group,
                                   .max = 1,
                                   .path = "extensions/KHR_materials_clearcoat/clearcoatFactor",
                                   .is_animated = true,
                                   .aspect = unsigned(Surface),
                                   .sentence = "Part of the surface under a clear coat of index 1.5. 0: no coat."}));
  visit(property(&Material::coat_roughness, {.name = "coat_roughness",
                                             .label = "Roughness",
                                             .group = coat_group,
                                             .max = 1,
                                             .path = "extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor",
                                             .is_animated = true,
                                             .aspect = unsigned(Surface),
                                             .sentence = "Perceptual; GGX alpha is its square."}));
  visit(
      property(&Material::coat_normal_scale, {.name = "coat_normal_scale",
                                              .label = "Normal scale",
                                              .group = coat_group,
                                              .min = -texel_limit,
                                              .max = texel_limit,
                                              .path = "extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale",
                                              .is_animated = true,
                                              .aspect = unsigned(Surface),
                                              .sentence = "Factor of the coat's normal texture."}));
  visit(property(&Material::sheen_color,
                 {.name = "sheen_color",
                  .label = "Color",
                  .group = sheen_group,
                  .max = 1,
                  .path = "extensions/KHR_materials_sheen/sheenColorFactor",
                  .is_animated = true,
                  .aspect = unsigned(Surface),
                  .sentence = "Reflectance of fibres on the base, under the coat. Black: no sheen."}));
  visit(property(&Material::sheen_roughness, {.name = "sheen_roughness",
                                              .label = "Roughness",
                                              .group = sheen_group,
                                              .max = 1,
                                              .path = "extensions/KHR_materials_sheen/sheenRoughnessFactor",
                                              .is_animated = true,
                                              .aspect = unsigned(Surface),
                                              .sentence = "Perceptual; the sheen's alpha is its square."}));
  visit(property(&Material::anisotropy, {.name = "anisotropy",
                                         .label = "Strength",
                                         .group = anisotropy_group,
                                         .max = 1,
                                         .path = "extensions/KHR_materials_anisotropy/anisotropyStrength",
                                         .is_animated = true,
                                         .aspect = unsigned(Surface),
                                         .sentence = "How much rougher the base is along one direction: alpha there is "
                                                     "mix(alpha, 1, anisotropy²). Meshes need tangents."}));
  visit(property(&Material::anisotropy_rotation,
                 {.name = "anisotropy_rotation",
                  .label = "Rotation",
                  .group = anisotropy_group,
                  .unit = "rad",
                  .min = -texel_limit,
                  .max = texel_limit,
                  .path = "extensions/KHR_materials_anisotropy/anisotropyRotation",
                  .is_animated = true,
                  .aspect = unsigned(Surface),
                  .sentence = "Angle of that direction from the tangent, counter-clockwise on the upright image."}));
  visit(property(
      &Material::transmission,
      {.name = "transmission",
       .label = "Transmission",
       .group = transmission_group,
       .max = 1,
       .path = "extensions/KHR_materials_transmission/transmissionFactor",
       .is_animated = true,
       .aspect = unsigned(Surface),
       .sentence =
           "Fraction of the light that enters the base and passes through it. 0: opaque; the other properties of the "
           "group then have no effect."}));
  visit(property(
      &Material::thickness,
      {.name = "thickness",
       .label = "Thickness",
       .group = transmission_group,
       .unit = "m",
       .path = "extensions/KHR_materials_volume/thicknessFactor",
       .is_animated = true,
       .aspect = unsigned(Surface),
       .sentence = "Length of the light's path inside the object, in object space. 0: a thin wall, no refraction."}));
  visit(
      property(&Material::ior, {.name = "ior",
                                .label = "Index of refraction",
                                .group = transmission_group,
                                .min = 1,
                                .path = "extensions/KHR_materials_ior/ior",
                                .aspect = unsigned(Surface),
                                .sentence = "Index of refraction of the volume. It does not change the reflection."}));
  visit(property(&Material::attenuation_distance,
                 {.name = "attenuation_distance",
                  .label = "Attenuation",
                  .group = transmission_group,
                  .unit = "m",
                  .min = smallest_length,
                  .zero = "no absorption",
                  .first = 1,
                  .path = "extensions/KHR_materials_volume/attenuationDistance",
                  .is_animated = true,
                  .aspect = unsigned(Surface),
                  .sentence = "Distance after which white light has attenuation_color. 0: nothing is absorbed."}));
  visit(property(&Material::attenuation_color, {.name = "attenuation_color",
                                                .label = "Attenuation color",
                                                .group = transmission_group,
                                                .max = 1,
                                                .path = "extensions/KHR_materials_volume/attenuationColor",
                                                .is_animated = true,
                                                .aspect = unsigned(Surface),
                                                .sentence = "Linear red, green and blue."}));
  visit(property(&Material::emissive, {.name = "emissive",
                                       .label = "Emission",
                                       .unit = "W/(sr m²)",
                                       .max = light_max,
                                       .path = "emissiveFactor",
                                       .is_animated = true,
                                       .aspect = unsigned(Surface),
                                       .sentence = "Emitted radiance, red, green and blue."}));
  visit(property(&Material::is_unlit, {.name = "is_unlit",
                                       .key = "unlit",
                                       .label = "Unlit",
                                       .path = "extensions/KHR_materials_unlit",
                                       .aspect = unsigned(Textures),
                                       .sentence = "Lamps have no effect: the radiance is the base colour."}));
  visit(property(&Material::is_double_sided, {.name = "is_double_sided",
                                              .key = "double_sided",
                                              .label = "Double-sided",
                                              .path = "doubleSided",
                                              .aspect = unsigned(Coverage),
                                              .sentence = "false: back faces are not drawn and emit no light."}));
}

/** One of a material's texture slots. */
struct TextureInput {
  TextureSlot Material::*slot;
  /** Name of the slot, and of its sampler in shaders. */
  std::string_view name;
  /** Place of the slot in a material of glTF, with '/' between keys. */
  std::string_view path;
  /** Red, green and blue are encoded as sRGB. */
  bool is_color;
  /** Files may use more uv sets than a mesh has. The sets of slots with the lowest ranks are kept. */
  int rank;
  /** The texel of the image that replaces a missing or damaged one, and a description of its appearance. */
  std::array<std::uint8_t, 4> stand_in{255, 255, 255, 255};
  std::string_view stand_in_name = "the factor alone";

  /** Name of the slot in glTF: the last key of the path. */
  [[nodiscard]] constexpr std::string_view key() const
  {
    return path.substr(path.rfind('/') + 1);
  }
};

/** All texture slots. */
inline constexpr std::array<TextureInput, 15> texture_inputs = {{
    {&Material::base_color_texture,
     "base_color_texture",
     "pbrMetallicRoughness/baseColorTexture",
     true,
     1,
     {255, 0, 255, 255},
     "a checkerboard"},
    {&Material::metallic_roughness_texture,
     "metallic_roughness_texture",
     "pbrMetallicRoughness/metallicRoughnessTexture",
     false,
     5,
     {255, 255, 0, 255},
     "no metal, of the factor's roughness"},
    {&Material::normal_texture, "normal_texture", "normalTexture", false, 3, {128, 128, 255, 255}, "a flat surface"},
    {&Material::occlusion_texture,
     "occlusion_texture",
     "occlusionTexture",
     false,
     11,
     {255, 255, 255, 255},
     "no occlusion"},
    {&Material::emissive_texture, "emissive_texture", "emissiveTexture", true, 2, {0, 0, 0, 255}, "no emission"},
    {&Material::specular_texture, "specular_texture", "extensions/KHR_materials_specular/specularTexture", false, 10},
    {&Material::specular_color_texture, "specular_color_texture",
     "extensions/KHR_materials_specular/specularColorTexture", true, 9},
    {&Material::coat_texture, "coat_texture", "extensions/KHR_materials_clearcoat/clearcoatTexture", false, 6},
    {&Material::coat_roughness_texture, "coat_roughness_texture",
     "extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture", false, 13},
    {&Material::sheen_color_texture, "sheen_color_texture", "extensions/KHR_materials_sheen/sheenColorTexture", true,
     7},
    {&Material::sheen_roughness_texture, "sheen_roughness_texture",
     "extensions/KHR_materials_sheen/sheenRoughnessTexture", false, 14},
    {&Material::anisotropy_texture,
     "anisotropy_texture",
     "extensions/KHR_materials_anisotropy/anisotropyTexture",
     false,
     8,
     {255, 128, 255, 255}},
    {&Material::coat_normal_texture,
     "coat_normal_texture",
     "extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
     false,
     12,
     {128, 128, 255, 255},
     "a coat as smooth as the mesh"},
    {&Material::transmission_texture, "transmission_texture",
     "extensions/KHR_materials_transmission/transmissionTexture", false, 4},
    {&Material::thickness_texture, "thickness_texture", "extensions/KHR_materials_volume/thicknessTexture", false, 15},
}};

/** A position in the scene with its contents. Nodes form trees: Scene::add(Node, parent). */
struct Node {
  static constexpr std::string_view kind_name = "node";
  /**
   * Transform: the world matrix, which depends on the node and its ancestors. Content: meshes, lamp and camera.
   * Visibility: is_visible of the node and its ancestors. Shadow: casts_shadow and receives_shadow.
   */
  enum class Aspect { Name, Transform, Content, Visibility, Shadow, Count };

  std::string name{};
  /** Affine, without absolute values above 1e12 (number_max); may be singular, sheared or mirrored. */
  glm::dmat4 parent_from_node{1.0};
  /** Meshes that are drawn at the node. */
  std::vector<Handle<Mesh>> meshes{};
  Handle<Lamp> lamp{};
  Handle<Camera> camera{};
  bool is_visible = true;
  bool casts_shadow = true;
  bool receives_shadow = true;
  std::string extras{};

  /** Visits the rows of all members but the transform, the meshes, the lamp and the camera. */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

template <typename Visit>
constexpr void Node::for_each_property(Visit &&visit)
{
  using enum Aspect;
  visit(property(&Node::name, {.name = "name", .aspect = unsigned(Name), .sentence = "For messages and files."}));
  visit(property(&Node::extras, {.name = "extras", .aspect = unsigned(Name), .sentence = extras_sentence}));
  visit(property(&Node::is_visible,
                 {.name = "is_visible",
                  .key = "visible",
                  .label = "Visible",
                  .extra_kinds = 1,
                  .aspect = unsigned(Visibility),
                  .sentence = "false: neither the node nor its descendants are drawn, cast shadows or give light."}));
  visit(property(&Node::casts_shadow, {.name = "casts_shadow",
                                       .label = "Casts shadow",
                                       .extra_kinds = 1,
                                       .aspect = unsigned(Shadow),
                                       .sentence = "Whether the node's own meshes cast shadows."}));
  visit(property(&Node::receives_shadow, {.name = "receives_shadow",
                                          .label = "Receives shadow",
                                          .extra_kinds = 1,
                                          .aspect = unsigned(Shadow),
                                          .sentence = "Whether the node's own meshes receive shadows."}));
}

/** The kind of a lamp or a camera, as the number of a bit in Description::kinds. Other things: 0. */
template <typename Thing>
[[nodiscard]] constexpr unsigned kind_of(const Thing &thing)
{
  if constexpr (requires { thing.kind; }) {
    return unsigned(thing.kind);
  }
  else {
    return 0;
  }
}

}  // namespace gnomon::scene
