// SPDX-License-Identifier: MIT
#include "internal/gltf_document_shading.hh"

#include "internal/gltf_pointer.hh"
#include "scene_animation.hh"
#include "scene_properties.hh"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <type_traits>

namespace gnomon::gltf {

namespace {

/** \a more: members that the slot may have beside those of each slot. */
template <typename... Read>
void read_slot(const Place &place, const JsonValue &value, Model::TextureSlot &slot, const Member<Read> &...more)
{
  // The texture transform's set replaces the slot's.
  int transformed_set = -1;
  const auto read_transform = [&](const Place &at, const JsonValue &transform) {
    read_members(at, transform, into("offset", slot.offset), into("rotation", slot.rotation), into("scale", slot.scale),
                 into("texCoord", transformed_set));
  };
  read_members(place, value, into("index", slot.index), into("texCoord", slot.set),
               Member{"extensions",
                      [&](const Place &at, const JsonValue &extensions) {
                        read_members(at, extensions, Member{"KHR_texture_transform", read_transform});
                      }},
               more...);
  slot.set = transformed_set < 0 ? slot.set : transformed_set;
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
  material.factors["base_color"] = source.diffuse;
  material.factors["metallic"] = {0.0};
  material.factors["roughness"] = {1.0 - source.glossiness};
  material.factors["specular"] = {1.0};
  for (std::size_t i = 0; i < 3; i++) {
    material.factors["specular_color"][i] = source.specular[i] / dielectric;
  }
  material.factors.erase("ior");
  material.textures["base_color_texture"] = source.diffuse_texture;
  material.textures.erase("specular_texture");
  material.textures["specular_color_texture"] = source.specular_glossiness_texture;
  material.textures["metallic_roughness_texture"] = source.specular_glossiness_texture;
  material.glossiness = source.glossiness;
}

/** Parses a material. Factors and textures are found by the paths of their rows. */
class MaterialParser {
 public:
  explicit MaterialParser(Model::Material &material) : material_(material) {}

  void read(const Place &place, const JsonValue &value)
  {
    read_object(place, value, "");
    if (specular_glossiness_) {
      convert(*specular_glossiness_, material_);
    }
  }

 private:
  Model::Material &material_;
  std::optional<SpecularGlossiness> specular_glossiness_;

  /** \a path: of the object, from the material; empty: the material. */
  void read_object(const Place &place, const JsonValue &value, const std::string &path)
  {
    std::set<std::string_view> read;
    for_members(place, value, [&](std::string_view key, const Place &at, const JsonValue &member) {
      if (key == extras_key) {
        note_foreign_extras(place, member);
      }
      if (!read_member(at, member, path.empty() ? std::string(key) : path + '/' + std::string(key))) {
        if (key == extensions_key || place.key == extensions_key) {
          skip_member(place, at, member);
        }
      }
      else if (!read.insert(key).second) {
        at.warn(twice_text);
      }
    });
  }

  /** \return false if the importer does not read members at \a path. */
  bool read_member(const Place &at, const JsonValue &value, const std::string &path)
  {
    if (read_factor(at, value, path) || read_texture(at, value, path)) {
      return true;
    }
    if (path == "name") {
      material_.name = name_at(at, value);
    }
    else if (path == "alphaMode") {
      material_.alpha_mode = string_at(at, value);
    }
    else if (path == strength_path) {
      material_.emissive_strength = number_at(at, value);
    }
    else if (path == "extensions/KHR_materials_pbrSpecularGlossiness") {
      read_specular_glossiness(at, value);
    }
    else if (path == "extras") {
      read_extras(at, value);
    }
    else if (has_parts(path)) {
      read_object(at, value, path);
    }
    else {
      return false;
    }
    return true;
  }

  bool read_factor(const Place &at, const JsonValue &value, std::string_view path)
  {
    bool is_read = false;
    scene::Material::for_each_property([&](const auto &row) {
      using Value = typename std::decay_t<decltype(row)>::Value;
      if (row.path != path) {
        return;
      }
      if constexpr (std::is_same_v<Value, float>) {
        material_.factors[row.name] = {number_at(at, value)};
        is_read = true;
      }
      else if constexpr (std::is_same_v<Value, glm::vec3>) {
        read_numbers(at, value, std::span(material_.factors[row.name]).first(scene::width_of(row.name)));
        is_read = true;
      }
      else if constexpr (std::is_same_v<Value, bool>) {
        // An extension without members says true.
        const bool is_extension = at.outer->key == extensions_key;
        if (is_extension) {
          read_members(at, value);
        }
        material_.factors[row.name] = {is_extension ? 1.0 : double(boolean_at(at, value))};
        is_read = true;
      }
    });
    return is_read;
  }

  bool read_texture(const Place &at, const JsonValue &value, std::string_view path)
  {
    const auto *const input = std::ranges::find(scene::texture_inputs, path, &scene::TextureInput::path);
    if (input == scene::texture_inputs.end()) {
      return false;
    }
    // A factor that stands in the slot, such as the scale of a normal texture.
    std::string_view factor_path;
    scene::Material::for_each_property(
        [&](const scene::Description &row) { factor_path = is_below(row.path, path) ? row.path : factor_path; });
    const std::string_view factor_key = factor_path.empty() ? "" : factor_path.substr(path.size() + 1);
    read_slot(at, value, material_.textures[input->name],
              Member{factor_key, [&](const Place &in, const JsonValue &factor) {
                       static_cast<void>(read_factor(in, factor, factor_path));
                     }});
    return true;
  }

  void read_specular_glossiness(const Place &at, const JsonValue &value)
  {
    SpecularGlossiness &read = specular_glossiness_.emplace();
    const auto into_slot = [](std::string_view key, Model::TextureSlot &slot) {
      return Member{key, [&slot](const Place &in, const JsonValue &member) { read_slot(in, member, slot); }};
    };
    read_members(at, value, into("diffuseFactor", read.diffuse), into("specularFactor", read.specular),
                 into("glossinessFactor", read.glossiness), into_slot("diffuseTexture", read.diffuse_texture),
                 into_slot("specularGlossinessTexture", read.specular_glossiness_texture));
  }

  void read_extras(const Place &at, const JsonValue &extras)
  {
    if (extras.is_object()) {
      read_members(at, extras, into("gnomon_surface", material_.surface_uri),
                   Member{"gnomon_thickness", [&](const Place &in, const JsonValue &thickness) {
                            material_.own_thickness = number_at(in, thickness);
                          }});
    }
  }

  static bool is_below(std::string_view path, std::string_view object)
  {
    return path.size() > object.size() && path.starts_with(object) && path[object.size()] == '/';
  }

  /** Whether the object at \a path may have factors or textures. */
  static bool has_parts(std::string_view path)
  {
    bool has_any = is_below(strength_path, path) ||
                   std::ranges::any_of(scene::texture_inputs,
                                       [&](const scene::TextureInput &input) { return is_below(input.path, path); });
    scene::Material::for_each_property([&](const scene::Description &row) { has_any |= is_below(row.path, path); });
    return has_any;
  }
};

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
    else if (key == extras_key) {
      note_foreign_extras(place, number);
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
  MaterialParser(material).read(place, value);
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
  // Which lens is read depends on it.
  for_members(place, value, [&](std::string_view key, const Place &at, const JsonValue &member) {
    type = key == "type" ? string_at(at, member) : type;
  });
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
  read_members(place, value, into_name(camera.name), into("type", type), Member{"perspective", read_if_used},
               Member{"orthographic", read_if_used});
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
