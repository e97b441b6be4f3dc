// SPDX-License-Identifier: MIT
#include "view_property_makers.hh"

#include "scene_units.hh"
#include "shadows/shadow_plan.hh"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::view {

namespace {

constexpr const char *as_the_scene = "as the scene";

/** The next float. */
double below(float value)
{
  return double(std::nextafter(value, 0.0F));
}
double above(float value)
{
  return double(std::nextafter(value, std::numeric_limits<float>::infinity()));
}

Properties<scene::Lamp> make_lamp_properties()
{
  using scene::Lamp;
  using enum scene::LampKind;
  Properties<Lamp> made;
  made.choices.push_back(choice("kind", "Kind", {"point", "sun", "spot", "hemi", "area"}, &Lamp::kind));
  ChoiceProperty<Lamp> shape = choice("area_shape", "Shape", {"rectangle", "ellipse"}, &Lamp::area_shape);
  shape.applies = [](const Lamp &lamp) { return lamp.kind == Area; };
  made.choices.push_back(std::move(shape));

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

/** "as the scene" for no value of its own, and then \a options, which count as the values do. */
template <typename Value>
ChoiceProperty<ShadowOfLamp> shadow_choice(const char *name, const char *label, std::vector<const char *> options,
                                           std::optional<Value> scene::LampShadow::*member)
{
  options.insert(options.begin(), as_the_scene);
  return {name,
          label,
          std::move(options),
          [=](const ShadowOfLamp &of) { return of.shadow.*member ? int(*(of.shadow.*member)) + 1 : 0; },
          [=](ShadowOfLamp &of, int value) {
            of.shadow.*member = value == 0 ? std::nullopt : std::optional(Value(value - 1));
          },
          {}};
}

/** \a first: where there was none. */
template <typename Value>
NumberProperty<ShadowOfLamp> shadow_number(const char *name, const char *label, const char *unit,
                                           std::optional<Value> scene::LampShadow::*member, double min, double max,
                                           double first, double factor = 1.0)
{
  NumberProperty<ShadowOfLamp> property{
      .name = name,
      .label = label,
      .unit = [unit](const ShadowOfLamp &) { return unit; },
      .width = 1,
      .min = min,
      .max = max,
      .get = [=](const ShadowOfLamp &of,
                 int) { return of.shadow.*member ? double(*(of.shadow.*member)) * factor : first; },
      .set = [=](ShadowOfLamp &of, int, double value) { of.shadow.*member = stored<Value>(value / factor); }};
  property.absent = as_the_scene;
  property.is_absent = [=](const ShadowOfLamp &of) { return !(of.shadow.*member); };
  property.remove = [=](ShadowOfLamp &of) { (of.shadow.*member).reset(); };
  property.group = "Shadow settings";
  return property;
}

scene::ShadowKind kind_of(const ShadowOfLamp &of)
{
  return eevee::shadow_kind(of.lamp, of.shadow.kind, {.kind = of.scene_kind});
}

bool is_exponential(const ShadowOfLamp &of)
{
  return kind_of(of) == scene::ShadowKind::Esm || kind_of(of) == scene::ShadowKind::Evsm;
}

Properties<ShadowOfLamp> make_shadow_properties()
{
  using scene::LampShadow;
  Properties<ShadowOfLamp> made;
  made.choices.push_back(shadow_choice("shadow", "Shadow", shadow_kinds, &LampShadow::kind));
  made.choices.back().applies = [](const ShadowOfLamp &of) { return of.lamp != scene::LampKind::Hemi; };
  ChoiceProperty<ShadowOfLamp> format =
      shadow_choice("esm_format", "Layer format", {"16f", "32f"}, &LampShadow::esm_format);
  format.applies = [](const ShadowOfLamp &of) { return kind_of(of) == scene::ShadowKind::Esm; };
  format.group = "Shadow settings";
  made.choices.push_back(std::move(format));

  const auto add = [&](NumberProperty<ShadowOfLamp> property, bool (*applies)(const ShadowOfLamp &)) {
    property.applies = applies;
    made.numbers.push_back(std::move(property));
  };
  const auto has_shadow = [](const ShadowOfLamp &of) { return kind_of(of) != scene::ShadowKind::None; };
  // A sun is at no distance.
  const auto has_distances = [](const ShadowOfLamp &of) {
    return kind_of(of) != scene::ShadowKind::None && of.lamp != scene::LampKind::Sun;
  };
  add(shadow_number("shadow_size", "Size", "px", &LampShadow::size, 1.0, 16384.0, 1024.0), has_shadow);
  add(shadow_number("bias", "Bias", "", &LampShadow::bias, 0.0, 100.0, 1.0), has_shadow);
  NumberProperty<ShadowOfLamp> start =
      shadow_number("clip_start", "Clip start", "m", &LampShadow::clip_start, 1e-5, endless, 0.1);
  start.narrowed = [](const ShadowOfLamp &of) {
    return Limits{1e-5, of.shadow.clip_end ? below(*of.shadow.clip_end) : endless};
  };
  add(std::move(start), has_distances);
  NumberProperty<ShadowOfLamp> end =
      shadow_number("clip_end", "Clip end", "m", &LampShadow::clip_end, 1e-5, endless, 100.0);
  end.narrowed = [](const ShadowOfLamp &of) {
    return Limits{of.shadow.clip_start ? above(*of.shadow.clip_start) : 1e-5, endless};
  };
  add(std::move(end), has_distances);
  add(shadow_number("exponent", "Exponent", "1/m", &LampShadow::exponent, 0.01, 1e4, 10.0), is_exponential);
  // Files may have wider filters, and layers of other sizes, than the engine takes.
  add(shadow_number("filter_radius", "Filter radius", "°", &LampShadow::filter_angle, 0.0, esm_filter_degrees_max, 1.0,
                    degrees_per_radian),
      is_exponential);
  add(shadow_number("esm_size", "Layer size", "px", &LampShadow::esm_size, esm_size_min, esm_size_max, 512.0),
      is_exponential);
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
    const double far = camera.far > 0.0F ? below(camera.far) : endless;
    return Limits{camera.kind == Perspective ? near_min : 0.0, far};
  };
  made.numbers.push_back(std::move(near));
  NumberProperty<Camera> far = number("far", "Far", "m", &Camera::far, near_min, endless);
  far.narrowed = [](const Camera &camera) { return Limits{above(camera.near), endless}; };
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
  // Dielectrics reflect 0.04 of the light at normal incidence: a factor of 25 makes it all.
  made.numbers.push_back(color<Material>("specular_color", "Specular color", &Material::specular_color, 25.0));
  made.numbers.push_back(number("emissive", "Emission", "W/(sr m²)", &Material::emissive, 0.0, 1e6));
  made.numbers.push_back(number("normal_scale", "Normal scale", "", &Material::normal_scale, -10.0, 10.0));
  NumberProperty<Material> occlusion =
      number("occlusion_strength", "Occlusion", "", &Material::occlusion_strength, 0.0, 1.0);
  occlusion.applies = [](const Material &material) { return bool(material.occlusion_texture); };
  made.numbers.push_back(std::move(occlusion));

  const auto add = [&](const char *group, NumberProperty<Material> property) {
    property.group = group;
    made.numbers.push_back(std::move(property));
  };
  add("Coat", number("coat", "Coat", "", &Material::coat, 0.0, 1.0));
  add("Coat", number("coat_roughness", "Roughness", "", &Material::coat_roughness, 0.0, 1.0));
  NumberProperty<Material> coat_normal =
      number("coat_normal_scale", "Normal scale", "", &Material::coat_normal_scale, -10.0, 10.0);
  coat_normal.applies = [](const Material &material) { return bool(material.coat_normal_texture); };
  add("Coat", std::move(coat_normal));
  add("Sheen", color<Material>("sheen_color", "Color", &Material::sheen_color));
  add("Sheen", number("sheen_roughness", "Roughness", "", &Material::sheen_roughness, 0.0, 1.0));
  add("Anisotropy", number("anisotropy", "Strength", "", &Material::anisotropy, 0.0, 1.0));
  add("Anisotropy", number("anisotropy_rotation", "Rotation", "°", &Material::anisotropy_rotation, -360.0, 360.0,
                           degrees_per_radian));
  add("Transmission", number("transmission", "Transmission", "", &Material::transmission, 0.0, 1.0));
  add("Transmission", number("thickness", "Thickness", "m", &Material::thickness, 0.0, 1e4));
  add("Transmission", number("ior", "Index of refraction", "", &Material::ior, 1.0, 10.0));
  add("Transmission",
      zero_is("no absorption", 1.0,
              number("attenuation_distance", "Attenuation", "m", &Material::attenuation_distance, 1e-6, endless)));
  add("Transmission", color<Material>("attenuation_color", "Attenuation color", &Material::attenuation_color));
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
const Properties<ShadowOfLamp> &properties()
{
  static const Properties<ShadowOfLamp> made = make_shadow_properties();
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
