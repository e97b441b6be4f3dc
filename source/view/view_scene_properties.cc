// SPDX-License-Identifier: MIT
#include "view_property_makers.hh"

#include "scene_units.hh"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::view {

namespace {

Properties<scene::Lamp> make_lamp_properties()
{
  using scene::Lamp;
  using enum scene::LampKind;
  Properties<Lamp> made;
  made.choices.push_back(choice("kind", "Kind", {"point", "sun", "spot", "hemi", "area"}, &Lamp::kind));
  ChoiceProperty<Lamp> shape = choice("area_shape", "Shape", {"rectangle", "ellipse"}, &Lamp::area_shape);
  shape.applies = [](const Lamp &lamp) { return lamp.kind == Area; };
  made.choices.push_back(std::move(shape));
  ChoiceProperty<Lamp> shadow{"shadow", "Shadow", {"as the scene"},
                              {},       {},       [](const Lamp &lamp) { return lamp.kind != Hemi; }};
  shadow.options.insert(shadow.options.end(), shadow_kinds.begin(), shadow_kinds.end());
  shadow.get = [](const Lamp &lamp) { return lamp.shadow.kind ? int(*lamp.shadow.kind) + 1 : 0; };
  shadow.set = [](Lamp &lamp, int value) {
    lamp.shadow.kind = value == 0 ? std::nullopt : std::optional(scene::ShadowKind(value - 1));
  };
  made.choices.push_back(std::move(shadow));

  made.numbers.push_back(color<Lamp>("color", "Color", &Lamp::color));
  NumberProperty<Lamp> power = number("power", "Power", "", &Lamp::intensity, 0.0, endless);
  power.unit = [](const Lamp &lamp) { return scene::intensity_unit(lamp.kind); };
  made.numbers.push_back(std::move(power));
  made.numbers.push_back(only(number("radius", "Radius", "m", &Lamp::radius, 0.0, 1000.0), Point, Spot));
  made.numbers.push_back(only(number("angle", "Angle", "°", &Lamp::angle, 0.0, 180.0, degrees_per_radian), Sun));
  made.numbers.push_back(
      only(number("cone", "Cone", "°", &Lamp::spot_outer_angle, 0.2, 180.0, 2.0 * degrees_per_radian), Spot));
  made.numbers.push_back(only(number("blend", "Blend", "", &Lamp::spot_blend, 0.0, 1.0), Spot));
  made.numbers.push_back(only(number("range", "Range", "m", &Lamp::range, 0.0, endless), Point, Spot));
  made.numbers.push_back(only(number("size_x", "Size X", "m", &Lamp::area_size_x, 1e-3, 1e4), Area));
  made.numbers.push_back(only(number("size_y", "Size Y", "m", &Lamp::area_size_y, 1e-3, 1e4), Area));
  return made;
}

/** A camera is of one kind at a time, and has what files of that kind must have. */
void set_camera_kind(scene::Camera &camera, int kind)
{
  camera.kind = scene::CameraKind(kind);
  if (camera.kind == scene::CameraKind::Orthographic && camera.far == 0.0F) {
    camera.far = std::max(1000.0F, 10.0F * camera.near);
  }
  if (camera.kind == scene::CameraKind::Perspective && camera.near == 0.0F) {
    camera.near = std::min(0.1F, camera.far > 0.0F ? 0.1F * camera.far : 0.1F);
  }
}

Properties<scene::Camera> make_camera_properties()
{
  using scene::Camera;
  using enum scene::CameraKind;
  constexpr double near_min = 1e-5;
  Properties<Camera> made;
  ChoiceProperty<Camera> kind = choice("kind", "Kind", {"perspective", "orthographic"}, &Camera::kind);
  kind.set = set_camera_kind;
  made.choices.push_back(std::move(kind));
  made.numbers.push_back(
      only(number("vertical_angle", "Vertical angle", "°", &Camera::vertical_angle, 0.1, 179.0, degrees_per_radian),
           Perspective));
  made.numbers.push_back(
      only(zero_is("as the picture", 1.5, number("aspect", "Width / height", "", &Camera::aspect, 0.01, 100.0)),
           Perspective));
  made.numbers.push_back(
      only(number("half_width", "Half width", "m", &Camera::half_width, 1e-4, endless), Orthographic));
  made.numbers.push_back(
      only(number("half_height", "Half height", "m", &Camera::half_height, 1e-4, endless), Orthographic));
  NumberProperty<Camera> near = number("near", "Near", "m", &Camera::near, 0.0, endless);
  near.narrowed = [](const Camera &camera) {
    const double far = camera.far > 0.0F ? double(std::nextafter(camera.far, 0.0F)) : endless;
    return Limits{camera.kind == Perspective ? near_min : 0.0, far};
  };
  made.numbers.push_back(std::move(near));
  NumberProperty<Camera> far = number("far", "Far", "m", &Camera::far, near_min, endless);
  far.narrowed = [](const Camera &camera) {
    return Limits{double(std::nextafter(camera.near, std::numeric_limits<float>::infinity())), endless};
  };
  made.numbers.push_back(only(far, Orthographic));
  made.numbers.push_back(only(zero_is("infinite", 1000.0, far), Perspective));
  return made;
}

Properties<scene::Material> make_material_properties()
{
  using scene::Material;
  Properties<Material> made;
  made.choices.push_back(choice("double_sided", "Double-sided", off_on, &Material::is_double_sided));
  made.choices.push_back(choice("unlit", "Unlit", off_on, &Material::is_unlit));
  made.choices.push_back(choice("alpha_mode", "Alpha mode", {"opaque", "mask", "blend"}, &Material::alpha_mode));
  made.numbers.push_back(color<Material>("base_color", "Base color", &Material::base_color));
  made.numbers.push_back(number("alpha", "Alpha", "", &Material::alpha, 0.0, 1.0));
  NumberProperty<Material> cutoff = number("alpha_cutoff", "Cutoff", "", &Material::alpha_cutoff, 0.0, 1.0);
  cutoff.applies = [](const Material &material) { return material.alpha_mode == scene::AlphaMode::Mask; };
  made.numbers.push_back(std::move(cutoff));
  made.numbers.push_back(number("metallic", "Metallic", "", &Material::metallic, 0.0, 1.0));
  made.numbers.push_back(number("roughness", "Roughness", "", &Material::roughness, 0.0, 1.0));
  made.numbers.push_back(number("specular", "Specular", "", &Material::specular, 0.0, 1.0));
  made.numbers.push_back(number("emissive", "Emission", "W/(sr m²)", &Material::emissive, 0.0, 1e6));
  made.numbers.push_back(number("normal_scale", "Normal scale", "", &Material::normal_scale, -10.0, 10.0));
  return made;
}

}  // namespace

template <>
const Properties<scene::Lamp> &properties()
{
  static const Properties<scene::Lamp> made = make_lamp_properties();
  return made;
}

template <>
const Properties<scene::Camera> &properties()
{
  static const Properties<scene::Camera> made = make_camera_properties();
  return made;
}

template <>
const Properties<scene::Material> &properties()
{
  static const Properties<scene::Material> made = make_material_properties();
  return made;
}

template <>
const Properties<Placement> &properties()
{
  static const Properties<Placement> made = {
      {},
      {number("position", "Position", "m", &Placement::position, -endless, endless),
       number("rotation", "Rotation", "°", &Placement::rotation, -360.0, 360.0),
       number("scale", "Scale", "", &Placement::scale, -1e6, 1e6)}};
  return made;
}

template <>
const Properties<scene::Node> &properties()
{
  static const Properties<scene::Node> made = {
      {choice("visible", "Visible", off_on, &scene::Node::is_visible),
       choice("casts_shadow", "Casts shadow", off_on, &scene::Node::casts_shadow),
       choice("receives_shadow", "Receives shadow", off_on, &scene::Node::receives_shadow)},
      {}};
  return made;
}

template <>
const Properties<scene::World> &properties()
{
  static const Properties<scene::World> made = {
      {},
      {color<scene::World>("color", "Color", &scene::World::color),
       number("strength", "Strength", "", &scene::World::strength, 0.0, 1e6),
       number("rotation", "Rotation", "°", &scene::World::rotation, -360.0, 360.0, degrees_per_radian)}};
  return made;
}

}  // namespace gnomon::view
