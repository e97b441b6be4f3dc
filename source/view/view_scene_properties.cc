// SPDX-License-Identifier: MIT
#include "view_property_makers.hh"

#include "eevee_shadow_settings.hh"
#include "scene_units.hh"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::view {

namespace {

constexpr auto itself = [](auto &thing) -> auto &
{
  return thing;
};

/** The next smaller float. */
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
  Properties<Lamp> made;
  add_rows<Lamp>(made, itself);
  named(made.numbers, "power").unit = [](const Lamp &lamp) { return scene::intensity_unit(lamp.kind); };
  // The whole angle is shown, as in other programs.
  NumberProperty<Lamp> &cone = named(made.numbers, "cone");
  cone.min *= 2.0;
  cone.max *= 2.0;
  cone.get = [get = cone.get](const Lamp &lamp, int i) { return 2.0 * get(lamp, i); };
  cone.set = [set = cone.set](Lamp &lamp, int i, double value) { set(lamp, i, 0.5 * value); };
  return made;
}

scene::ShadowKind kind_of(const ShadowOfLamp &of)
{
  return eevee::shadow_kind(of.lamp, of.shadow.kind, {.kind = of.scene_kind});
}

Properties<ShadowOfLamp> make_shadow_properties()
{
  using enum scene::ShadowKind;
  Properties<ShadowOfLamp> made;
  add_rows<scene::LampShadow>(
      made, [](auto &of) -> auto & { return of.shadow; }, "as the scene");
  const auto has_shadow = [](const ShadowOfLamp &of) { return kind_of(of) != None; };
  const auto is_exponential = [](const ShadowOfLamp &of) { return kind_of(of) == Esm || kind_of(of) == Evsm; };
  // A sun has no distance.
  const auto has_distances = [](const ShadowOfLamp &of) {
    return kind_of(of) != None && of.lamp != scene::LampKind::Sun;
  };
  named(made.choices, "shadow").applies = [](const ShadowOfLamp &of) { return of.lamp != scene::LampKind::Hemi; };
  named(made.choices, "esm_format").applies = [](const ShadowOfLamp &of) { return kind_of(of) == Esm; };
  for (const char *name : {"shadow_size", "bias"}) {
    named(made.numbers, name).applies = has_shadow;
  }
  for (const char *name : {"exponent", "filter_radius", "esm_size"}) {
    named(made.numbers, name).applies = is_exponential;
  }
  NumberProperty<ShadowOfLamp> &start = named(made.numbers, "clip_start");
  start.applies = has_distances;
  start.narrowed = [min = start.min, max = start.max](const ShadowOfLamp &of) {
    return Limits{min, of.shadow.clip_end ? below(*of.shadow.clip_end) : max};
  };
  NumberProperty<ShadowOfLamp> &end = named(made.numbers, "clip_end");
  end.applies = has_distances;
  end.narrowed = [min = end.min, max = end.max](const ShadowOfLamp &of) {
    return Limits{of.shadow.clip_start ? above(*of.shadow.clip_start) : min, max};
  };
  return made;
}

/** Set the camera's kind and the values that files require for it. */
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
  Properties<Camera> made;
  add_rows<Camera>(made, itself);
  named(made.choices, "kind").set = set_camera_kind;
  NumberProperty<Camera> &near = named(made.numbers, "near");
  near.narrowed = [max = near.max](const Camera &camera) {
    return Limits{camera.kind == Perspective ? scene::smallest_length : 0.0,
                  camera.far > 0.0F ? below(camera.far) : max};
  };
  NumberProperty<Camera> &far = named(made.numbers, "far");
  far.narrowed = [max = far.max](const Camera &camera) { return Limits{above(camera.near), max}; };
  far.applies = [](const Camera &camera) { return camera.kind == Perspective; };
  // The far plane of an orthographic camera is finite.
  NumberProperty<Camera> orthographic = far;
  orthographic.absent = nullptr;
  orthographic.applies = [](const Camera &camera) { return camera.kind == Orthographic; };
  made.numbers.push_back(std::move(orthographic));
  return made;
}

Properties<scene::Material> make_material_properties()
{
  using scene::Material;
  Properties<Material> made;
  add_rows<Material>(made, itself);
  named(made.numbers, "alpha_cutoff").applies = [](const Material &material) {
    return material.alpha_mode == scene::AlphaMode::Mask;
  };
  const auto need_texture = [&](const char *name, scene::TextureSlot Material::*slot) {
    named(made.numbers, name).applies = [slot](const Material &material) { return bool(material.*slot); };
  };
  need_texture("normal_scale", &Material::normal_texture);
  need_texture("occlusion_strength", &Material::occlusion_texture);
  need_texture("coat_normal_scale", &Material::coat_normal_texture);
  return made;
}

Properties<Placement> make_placement_properties()
{
  Properties<Placement> made;
  const auto add = [&](const char *name, const char *label, const char *unit, double limit,
                       glm::dvec3 Placement::*member) {
    made.numbers.push_back(number_property<Placement>(
        {.name = name, .label = label, .unit = unit, .min = -limit, .max = limit}, [member](auto &placement) -> auto & {
          return placement.*member;
        }));
    made.numbers.back().is_color = false;
  };
  add("position", "Position", "m", scene::number_max, &Placement::position);
  add("rotation", "Rotation", "°", 360.0, &Placement::rotation);
  add("scale", "Scale", "", scene::number_max, &Placement::scale);
  return made;
}

template <typename T>
Properties<T> make_properties()
{
  Properties<T> made;
  add_rows<T>(made, itself);
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
  static const Properties<Placement> made = make_placement_properties();
  return made;
}

template <>
const Properties<scene::Node> &properties()
{
  static const Properties<scene::Node> made = make_properties<scene::Node>();
  return made;
}

template <>
const Properties<scene::World> &properties()
{
  static const Properties<scene::World> made = make_properties<scene::World>();
  return made;
}

}  // namespace gnomon::view
