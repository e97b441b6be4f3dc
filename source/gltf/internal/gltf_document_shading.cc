// SPDX-License-Identifier: MIT
#include "internal/gltf_document_shading.hh"

#include <algorithm>
#include <map>
#include <optional>

namespace gnomon::gltf {

namespace {

/** \a factor: a member of the slot named \a factor_key; nullptr, and an empty name, if it has none. */
void read_slot(const Place &place, const JsonValue &value, Model::TextureSlot &slot, std::string_view factor_key = "",
               double *factor = nullptr)
{
  // The texture transform's set replaces the slot's.
  int transformed_set = -1;
  const auto read_transform = [&](const Place &at, const JsonValue &transform) {
    read_members(at, transform, into("offset", slot.offset), into("rotation", slot.rotation), into("scale", slot.scale),
                 into("texCoord", transformed_set));
  };
  double unused = 0.0;
  read_members(place, value, into("index", slot.index), into("texCoord", slot.set),
               into(factor_key, factor != nullptr ? *factor : unused),
               Member{"extensions", [&](const Place &at, const JsonValue &extensions) {
                        read_members(at, extensions, Member{"KHR_texture_transform", read_transform});
                      }});
  slot.set = transformed_set < 0 ? slot.set : transformed_set;
}

auto into_slot(std::string_view key, Model::TextureSlot &slot, std::string_view factor_key = "",
               double *factor = nullptr)
{
  return Member{key, [=, &slot](const Place &place, const JsonValue &value) {
                  read_slot(place, value, slot, factor_key, factor);
                }};
}

void read_specular(const Place &place, const JsonValue &value, Model::Material &material)
{
  read_members(place, value, into("specularFactor", material.specular),
               into("specularColorFactor", material.specular_color),
               into_slot("specularTexture", material.specular_texture),
               into_slot("specularColorTexture", material.specular_color_texture));
}

void read_coat(const Place &place, const JsonValue &value, Model::Material &material)
{
  read_members(place, value, into("clearcoatFactor", material.coat),
               into("clearcoatRoughnessFactor", material.coat_roughness),
               into_slot("clearcoatTexture", material.coat_texture),
               into_slot("clearcoatRoughnessTexture", material.coat_roughness_texture),
               into_slot("clearcoatNormalTexture", material.coat_normal_texture, "scale", &material.coat_normal_scale));
}

void read_sheen(const Place &place, const JsonValue &value, Model::Material &material)
{
  read_members(place, value, into("sheenColorFactor", material.sheen_color),
               into("sheenRoughnessFactor", material.sheen_roughness),
               into_slot("sheenColorTexture", material.sheen_color_texture),
               into_slot("sheenRoughnessTexture", material.sheen_roughness_texture));
}

void read_anisotropy(const Place &place, const JsonValue &value, Model::Material &material)
{
  read_members(place, value, into("anisotropyStrength", material.anisotropy),
               into("anisotropyRotation", material.anisotropy_rotation),
               into_slot("anisotropyTexture", material.anisotropy_texture));
}

void read_transmission(const Place &place, const JsonValue &value, Model::Material &material)
{
  read_members(place, value, into("transmissionFactor", material.transmission),
               into_slot("transmissionTexture", material.transmission_texture));
}

void read_volume(const Place &place, const JsonValue &value, Model::Material &material)
{
  read_members(place, value, into("thicknessFactor", material.thickness),
               into_slot("thicknessTexture", material.thickness_texture),
               Member{"attenuationDistance",
                      [&](const Place &at, const JsonValue &distance) {
                        material.attenuation_distance = number_at(at, distance);
                      }},
               into("attenuationColor", material.attenuation_color));
}

/** KHR_materials_pbrSpecularGlossiness. */
struct SpecularGlossiness {
  std::array<double, 4> diffuse{1.0, 1.0, 1.0, 1.0};
  std::array<double, 3> specular{1.0, 1.0, 1.0};
  double glossiness = 1.0;
  Model::TextureSlot diffuse_texture;
  Model::TextureSlot specular_glossiness_texture;
};

/**
 * A dielectric whose specular colour gives the same reflectance at normal incidence. It replaces pbrMetallicRoughness
 * and KHR_materials_specular, as the extension says.
 */
void convert(const SpecularGlossiness &source, Model::Material &material)
{
  // Reflectance of a dielectric without a specular colour.
  constexpr double dielectric = 0.04;
  material.base_color = source.diffuse;
  material.base_color_texture = source.diffuse_texture;
  material.metallic = 0.0;
  material.roughness = 1.0 - source.glossiness;
  material.specular = 1.0;
  material.specular_texture = {};
  for (std::size_t i = 0; i < 3; i++) {
    material.specular_color[i] = source.specular[i] / dielectric;
  }
  material.specular_color_texture = source.specular_glossiness_texture;
  material.metallic_roughness_texture = source.specular_glossiness_texture;
  material.glossiness = source.glossiness;
  material.ior.reset();
}

void read_material_extensions(const Place &place, const JsonValue &value, Model::Material &material,
                              std::optional<SpecularGlossiness> &specular_glossiness)
{
  for_members(place, value, [&](std::string_view name, const Place &at, const JsonValue &extension) {
    if (name == "KHR_materials_specular") {
      read_specular(at, extension, material);
    }
    else if (name == "KHR_materials_pbrSpecularGlossiness") {
      SpecularGlossiness &read = specular_glossiness.emplace();
      read_members(at, extension, into("diffuseFactor", read.diffuse), into("specularFactor", read.specular),
                   into("glossinessFactor", read.glossiness), into_slot("diffuseTexture", read.diffuse_texture),
                   into_slot("specularGlossinessTexture", read.specular_glossiness_texture));
    }
    else if (name == "KHR_materials_clearcoat") {
      read_coat(at, extension, material);
    }
    else if (name == "KHR_materials_sheen") {
      read_sheen(at, extension, material);
    }
    else if (name == "KHR_materials_anisotropy") {
      read_anisotropy(at, extension, material);
    }
    else if (name == "KHR_materials_transmission") {
      read_transmission(at, extension, material);
    }
    else if (name == "KHR_materials_volume") {
      read_volume(at, extension, material);
    }
    else if (name == "KHR_materials_emissive_strength") {
      read_members(at, extension, into("emissiveStrength", material.emissive_strength));
    }
    else if (name == "KHR_materials_ior") {
      read_members(at, extension, into("ior", material.ior.emplace(1.5)));
    }
    else if (name == "KHR_materials_unlit") {
      static_cast<void>(object_at(at, extension));
      material.is_unlit = true;
    }
    else {
      warn_unread_extension(place, name);
    }
  });
}

/** Reads the numbers of a camera. All of \a required must be present. */
void read_lens(const Place &place, const JsonValue &value, const std::map<std::string_view, double *> &required,
               double *aspect_ratio, double *zfar)
{
  std::map<std::string_view, double *> numbers = required;
  if (aspect_ratio != nullptr) {
    numbers.insert({{"aspectRatio", aspect_ratio}, {"zfar", zfar}});
  }
  std::size_t required_count = 0;
  for_members(place, value, [&](std::string_view key, const Place &at, const JsonValue &number) {
    if (const auto found = numbers.find(key); found != numbers.end()) {
      required_count += required.count(key);
      *found->second = number_at(at, number);
    }
    else if (key == extensions_key) {
      skip_member(place, at, number);
    }
  });
  if (required_count < required.size()) {
    std::string names;
    for (const auto &[key, number] : required) {
      names += (names.empty() ? "" : ", ") + std::string(key);
    }
    throw Fault("glTF", place.text() + ": needs " + names);
  }
}

}  // namespace

void read_material(const Place &place, const JsonValue &value, Model::Material &material)
{
  std::optional<SpecularGlossiness> specular_glossiness;
  const auto read_roughness = [&](const Place &at, const JsonValue &roughness) {
    read_members(at, roughness, into("baseColorFactor", material.base_color), into("metallicFactor", material.metallic),
                 into("roughnessFactor", material.roughness),
                 into_slot("baseColorTexture", material.base_color_texture),
                 into_slot("metallicRoughnessTexture", material.metallic_roughness_texture));
  };
  read_members(place, value, into_name(material.name), Member{"pbrMetallicRoughness", read_roughness},
               into("emissiveFactor", material.emissive), into("alphaMode", material.alpha_mode),
               into("alphaCutoff", material.alpha_cutoff), into("doubleSided", material.is_double_sided),
               into_slot("normalTexture", material.normal_texture, "scale", &material.normal_scale),
               into_slot("occlusionTexture", material.occlusion_texture, "strength", &material.occlusion_strength),
               into_slot("emissiveTexture", material.emissive_texture),
               Member{"extensions",
                      [&](const Place &at, const JsonValue &extensions) {
                        read_material_extensions(at, extensions, material, specular_glossiness);
                      }},
               Member{"extras", [&](const Place &at, const JsonValue &extras) {
                        if (extras.is_object()) {
                          read_members(at, extras, into("gnomon_surface", material.surface_uri),
                                       Member{"gnomon_thickness", [&](const Place &in, const JsonValue &thickness) {
                                                material.own_thickness = number_at(in, thickness);
                                              }});
                        }
                      }});
  if (specular_glossiness) {
    convert(*specular_glossiness, material);
  }
}

void read_texture(const Place &place, const JsonValue &value, Model::Texture &texture)
{
  read_members(place, value, into_name(texture.name), into("sampler", texture.sampler), into("source", texture.source),
               Member{"extensions", [&](const Place &at, const JsonValue &extensions) {
                        read_members(at, extensions,
                                     Member{"EXT_texture_webp", [&](const Place &in, const JsonValue &webp) {
                                              read_members(in, webp, into("source", texture.webp_source));
                                            }});
                      }});
}

void read_sampler(const Place &place, const JsonValue &value, Model::Sampler &sampler)
{
  read_members(place, value, into("magFilter", sampler.mag_filter), into("minFilter", sampler.min_filter),
               into("wrapS", sampler.wrap_s), into("wrapT", sampler.wrap_t));
}

void read_image(const Place &place, const JsonValue &value, Model::Image &image)
{
  read_members(place, value, into_name(image.name), into("uri", image.uri), into("bufferView", image.buffer_view));
}

void read_camera(const Place &place, const JsonValue &value, Model::Camera &camera)
{
  std::string type;
  const auto later = [](const Place &, const JsonValue &) {};
  read_members(place, value, into_name(camera.name), into("type", type), Member{"extensions", later});
  if (type != "perspective" && type != "orthographic") {
    throw Fault("glTF", "Invalid camera type of " + place.text() + ": '" + printable(type) + "'");
  }
  camera.is_perspective = type == "perspective";
  bool has_lens = false;
  const auto read_if_used = [&](const Place &at, const JsonValue &lens) {
    has_lens = has_lens || at.key == type;
    if (at.key != type) {
      static_cast<void>(object_at(at, lens));
    }
    else if (camera.is_perspective) {
      read_lens(at, lens, {{"yfov", &camera.yfov}, {"znear", &camera.znear}}, &camera.aspect_ratio, &camera.zfar);
    }
    else {
      read_lens(at, lens,
                {{"xmag", &camera.xmag}, {"ymag", &camera.ymag}, {"znear", &camera.znear}, {"zfar", &camera.zfar}},
                nullptr, nullptr);
    }
  };
  read_members(place, value, Member{"perspective", read_if_used}, Member{"orthographic", read_if_used});
  if (!has_lens) {
    throw Fault("glTF", place.text() + ": has no " + type);
  }
}

void read_light(const Place &place, const JsonValue &value, Model::Light &light)
{
  bool has_spot = false;
  read_members(place, value, into_name(light.name), into("type", light.type), into("color", light.color),
               into("intensity", light.intensity), into("range", light.range),
               Member{"spot", [&](const Place &at, const JsonValue &spot) {
                        has_spot = true;
                        read_members(at, spot, into("innerConeAngle", light.inner_cone_angle),
                                     into("outerConeAngle", light.outer_cone_angle));
                      }});
  if (light.type.empty() || (light.type == "spot" && !has_spot)) {
    throw Fault("glTF", place.text() + ": has no " + (light.type.empty() ? "type" : "spot"));
  }
}

void read_image_light(const Place &place, const JsonValue &value, Model::ImageLight &light)
{
  const auto read_images = [&light](const Place &at, const JsonValue &levels) {
    light.faces.clear();
    const JsonArray array = array_at(at, levels);
    if (array.begin() == array.end()) {
      return;
    }
    const Place full_size{at.outer, at.key, 0};
    for (const JsonValue face : array_at(full_size, *array.begin(), "an array of indices")) {
      light.faces.push_back(index_at(full_size, face));
    }
  };
  read_members(place, value, into_name(light.name), into("intensity", light.intensity),
               into("rotation", light.rotation), Member{"specularImages", read_images});
}

}  // namespace gnomon::gltf
