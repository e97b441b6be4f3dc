// SPDX-License-Identifier: MIT
#include "internal/gltf_schema.hh"

#include "internal/gltf_report.hh"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::gltf {

namespace {

using nlohmann::json;
using Names = std::initializer_list<std::string_view>;

constexpr std::size_t name_size_max = 1024;

enum class Kind { Index, Indices, Size, Number, Numbers, Boolean, String };

/** A property that the import reads. */
struct Property {
  std::string_view key;
  Kind kind;
  /** Index and Indices: the top-level array that they point into; none: any index will do. */
  std::string_view array = {};
  /** Numbers: how many. */
  std::size_t count = 0;
};

constexpr std::array scene_properties{Property{"name", Kind::String}, Property{"nodes", Kind::Indices, "nodes"}};
constexpr std::array node_properties{
    Property{"name", Kind::String},
    Property{"camera", Kind::Index, "cameras"},
    Property{"mesh", Kind::Index, "meshes"},
    Property{"skin", Kind::Index, "skins"},
    Property{"matrix", Kind::Numbers, {}, 16},
    Property{"rotation", Kind::Numbers, {}, 4},
    Property{"scale", Kind::Numbers, {}, 3},
    Property{"translation", Kind::Numbers, {}, 3},
    Property{"children", Kind::Indices, "nodes"},
};
constexpr std::array node_light_properties{Property{"light", Kind::Index, "lights"}};
constexpr std::array mesh_properties{Property{"name", Kind::String}};
constexpr std::array primitive_properties{
    Property{"indices", Kind::Index, "accessors"},
    Property{"material", Kind::Index, "materials"},
    Property{"mode", Kind::Index},
};
constexpr std::array attribute_properties{
    Property{"POSITION", Kind::Index, "accessors"},
    Property{"NORMAL", Kind::Index, "accessors"},
};
/** Followed by the number of the set. */
constexpr std::string_view texture_coordinate_prefix = "TEXCOORD_";
constexpr std::array accessor_properties{
    Property{"name", Kind::String},        Property{"bufferView", Kind::Index, "bufferViews"},
    Property{"byteOffset", Kind::Size},    Property{"componentType", Kind::Size},
    Property{"count", Kind::Size},         Property{"type", Kind::String},
    Property{"normalized", Kind::Boolean},
};
constexpr std::array sparse_properties{Property{"count", Kind::Index}};
constexpr std::array sparse_part_properties{
    Property{"bufferView", Kind::Index, "bufferViews"},
    Property{"byteOffset", Kind::Index},
    Property{"componentType", Kind::Index},
};
constexpr std::array buffer_view_properties{
    Property{"name", Kind::String},     Property{"buffer", Kind::Index, "buffers"}, Property{"byteOffset", Kind::Size},
    Property{"byteLength", Kind::Size}, Property{"byteStride", Kind::Size},
};
constexpr std::array buffer_properties{Property{"name", Kind::String}, Property{"uri", Kind::String},
                                       Property{"byteLength", Kind::Size}};
constexpr std::array material_properties{
    Property{"name", Kind::String},
    Property{"alphaMode", Kind::String},
    Property{"alphaCutoff", Kind::Number},
    Property{"doubleSided", Kind::Boolean},
    Property{"emissiveFactor", Kind::Numbers, {}, 3},
};
constexpr std::array roughness_properties{
    Property{"baseColorFactor", Kind::Numbers, {}, 4},
    Property{"metallicFactor", Kind::Number},
    Property{"roughnessFactor", Kind::Number},
};
constexpr std::array slot_properties{Property{"index", Kind::Index}};
constexpr std::array base_color_slot_properties{Property{"index", Kind::Index}, Property{"texCoord", Kind::Index}};
constexpr std::array texture_transform_properties{
    Property{"offset", Kind::Numbers, {}, 2},
    Property{"rotation", Kind::Number},
    Property{"scale", Kind::Numbers, {}, 2},
    Property{"texCoord", Kind::Index},
};
/** Of textures and images most are not read, so that their indices are the reader's to check. */
constexpr std::array texture_properties{Property{"name", Kind::String}, Property{"sampler", Kind::Index},
                                        Property{"source", Kind::Index}};
constexpr std::array sampler_properties{
    Property{"magFilter", Kind::Index},
    Property{"minFilter", Kind::Index},
    Property{"wrapS", Kind::Index},
    Property{"wrapT", Kind::Index},
};
constexpr std::array image_properties{Property{"name", Kind::String}, Property{"uri", Kind::String},
                                      Property{"bufferView", Kind::Index}};
constexpr std::array specular_properties{
    Property{"specularFactor", Kind::Number},
    Property{"specularColorFactor", Kind::Numbers, {}, 3},
};
constexpr std::array emissive_strength_properties{Property{"emissiveStrength", Kind::Number}};
constexpr std::array ior_properties{Property{"ior", Kind::Number}};
constexpr std::array camera_properties{Property{"name", Kind::String}, Property{"type", Kind::String}};
constexpr std::array perspective_properties{
    Property{"aspectRatio", Kind::Number},
    Property{"yfov", Kind::Number},
    Property{"zfar", Kind::Number},
    Property{"znear", Kind::Number},
};
constexpr std::array orthographic_properties{
    Property{"xmag", Kind::Number},
    Property{"ymag", Kind::Number},
    Property{"zfar", Kind::Number},
    Property{"znear", Kind::Number},
};
constexpr std::array light_properties{
    Property{"name", Kind::String},  Property{"type", Kind::String},          Property{"intensity", Kind::Number},
    Property{"range", Kind::Number}, Property{"color", Kind::Numbers, {}, 3},
};
constexpr std::array spot_properties{
    Property{"innerConeAngle", Kind::Number},
    Property{"outerConeAngle", Kind::Number},
};

/** Where in the document: linked back to its root, and written out only when there is something to say. */
struct Place {
  const Place *outer;
  std::string_view key;
  std::size_t index = no_index;
  static constexpr std::size_t no_index = std::numeric_limits<std::size_t>::max();

  [[nodiscard]] std::string text() const
  {
    std::string result = outer == nullptr || outer->key.empty() ? "" : outer->text() + '.';
    result += key;
    return index == no_index ? result : result + '[' + std::to_string(index) + ']';
  }
};

/** A value as it stands in the file, cut short. */
std::string quoted(const json &value)
{
  // A deep value must not be written out: that recurses.
  return value.is_structured() ? (value.is_array() ? "an array" : "an object") : printable(value.dump());
}

[[noreturn]] void fail(const Place &place, const json &value, std::string_view wanted)
{
  throw Fault(place.text(), "is " + quoted(value) + ", and must be " + std::string(wanted));
}

json *member(json &object, std::string_view key)
{
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

class Checker {
 public:
  explicit Checker(json &document) : document_(document) {}

  void check_all();

 private:
  json &document_;
  /** How many elements each top-level array has. */
  std::map<std::string_view, std::size_t> size_of_;

  void check_index(const Place &place, const json &value, std::string_view array) const;
  /** Numbers become doubles: tinygltf would cut the large whole ones of an extension to 32 bits. */
  void check_value(const Place &place, json &value, const Property &property) const;
  /** Check the \a properties of \a object, and erase all but them and \a children, which the caller checks. */
  void check_object(const Place &place, json &object, std::span<const Property> properties, Names children = {}) const;
  /** The same for a member of \a object, if it has it. \return that, or nullptr. */
  json *check_member(const Place &outer, json &object, std::string_view key, std::span<const Property> properties,
                     Names children = {}) const;
  static void check_is_object(const Place &place, const json &value);
  void check_asset() const;
  void check_node(const Place &place, json &node) const;
  void check_mesh(const Place &place, json &mesh) const;
  void check_accessor(const Place &place, json &accessor) const;
  void check_attributes(const Place &place, json &attributes) const;
  void check_base_color_slot(const Place &outer, json &roughness) const;
  void check_material(const Place &place, json &material) const;
  void check_camera(const Place &place, json &camera) const;
  void check_light(const Place &place, json &light) const;
  void check_lights();

  template <typename CheckElement>
  void check_array(std::string_view key, const CheckElement &check_element)
  {
    if (json *array = member(document_, key)) {
      for (std::size_t i = 0; i < array->size(); i++) {
        check_element(Place{nullptr, key, i}, (*array)[i]);
      }
    }
  }
};

void Checker::check_is_object(const Place &place, const json &value)
{
  if (!value.is_object()) {
    fail(place, value, "an object");
  }
}

void Checker::check_index(const Place &place, const json &value, std::string_view array) const
{
  // tinygltf keeps indices in an int.
  constexpr std::uint64_t index_max = std::numeric_limits<int>::max();
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > index_max) {
    fail(place, value, "an index");
  }
  if (array.empty()) {
    return;
  }
  const auto size = size_of_.find(array);
  const std::size_t count = size == size_of_.end() ? 0 : size->second;
  if (value.get<std::uint64_t>() >= count) {
    throw Fault(place.text(), "index " + value.dump() + " is out of range: the file has " + std::to_string(count) +
                                  ' ' + std::string(array));
  }
}

void Checker::check_value(const Place &place, json &value, const Property &property) const
{
  const auto are_numbers = [&] {
    return value.is_array() && value.size() == property.count &&
           std::all_of(value.begin(), value.end(), [](const json &element) { return element.is_number(); });
  };
  switch (property.kind) {
    case Kind::Index: check_index(place, value, property.array); break;
    case Kind::Indices:
      if (!value.is_array()) {
        fail(place, value, "an array of indices");
      }
      for (std::size_t i = 0; i < value.size(); i++) {
        check_index({place.outer, place.key, i}, value[i], property.array);
      }
      break;
    case Kind::Size:
      if (!value.is_number_unsigned()) {
        fail(place, value, "a whole number, not negative");
      }
      break;
    case Kind::Number:
      if (!value.is_number()) {
        fail(place, value, "a number");
      }
      value = value.get<double>();
      break;
    case Kind::Numbers:
      if (!are_numbers()) {
        fail(place, value, "an array of " + std::to_string(property.count) + " numbers");
      }
      for (json &element : value) {
        element = element.get<double>();
      }
      break;
    case Kind::Boolean:
      if (!value.is_boolean()) {
        fail(place, value, "true or false");
      }
      break;
    case Kind::String:
      if (!value.is_string()) {
        fail(place, value, "a string");
      }
      // Names are copied to every object.
      if (property.key == "name" && value.get_ref<const std::string &>().size() > name_size_max) {
        throw Fault(place.text(), "is longer than " + std::to_string(name_size_max) + " bytes");
      }
      break;
  }
}

void Checker::check_object(const Place &place, json &object, std::span<const Property> properties, Names children) const
{
  check_is_object(place, object);
  for (auto it = object.begin(); it != object.end();) {
    const std::string_view key = it.key();
    const auto property =
        std::find_if(properties.begin(), properties.end(), [key](const Property &p) { return p.key == key; });
    if (property != properties.end()) {
      check_value({&place, property->key}, it.value(), *property);
    }
    const bool is_read =
        property != properties.end() || std::find(children.begin(), children.end(), key) != children.end();
    it = is_read ? std::next(it) : object.erase(it);
  }
}

json *Checker::check_member(const Place &outer, json &object, std::string_view key,
                            std::span<const Property> properties, Names children) const
{
  json *value = member(object, key);
  if (value != nullptr) {
    check_object({&outer, key}, *value, properties, children);
  }
  return value;
}

/** The names of an element's extensions still tell what is not drawn; what is in the unknown ones is not needed. */
void empty_unknown_extensions(const Place &outer, json &element, Names known)
{
  json *extensions = member(element, "extensions");
  if (extensions == nullptr) {
    return;
  }
  const Place place{&outer, "extensions"};
  if (!extensions->is_object()) {
    fail(place, *extensions, "an object");
  }
  for (auto &[name, content] : extensions->items()) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      content = json::object();
    }
  }
}

/** Keep Gnomon's own extras, in the few forms that they have. */
void check_extras(const Place &outer, json &node)
{
  json *extras = member(node, "extras");
  if (extras == nullptr) {
    return;
  }
  if (!extras->is_object()) {
    node.erase("extras");
    return;
  }
  constexpr std::size_t array_size_max = 4;
  const std::string name = node.contains("name") ? " '" + printable(node["name"].get<std::string>()) + "'" : "";
  for (auto it = extras->begin(); it != extras->end();) {
    json &value = it.value();
    if (it.key().rfind("gnomon_", 0) != 0) {
      it = extras->erase(it);
      continue;
    }
    const bool is_vector = value.is_array() && !value.empty() && value.size() <= array_size_max &&
                           std::all_of(value.begin(), value.end(), [](const json &v) { return v.is_number(); });
    if (value.is_null() || (value.is_structured() && !is_vector)) {
      throw Fault(outer.text() + name, "extra " + printable(it.key()) + " is " + quoted(value) +
                                           ", and must be a number, a string or a few numbers");
    }
    // tinygltf would cut a large integer to 32 bits.
    if (value.is_number()) {
      value = value.get<double>();
    }
    ++it;
  }
}

void Checker::check_asset() const
{
  const Place place{nullptr, "asset"};
  json *asset = member(document_, "asset");
  if (asset == nullptr) {
    throw Fault("asset", "is missing: this is not a glTF 2.0 file");
  }
  constexpr std::array properties{Property{"version", Kind::String}};
  check_object(place, *asset, properties);
  const std::string version = asset->value("version", "");
  if (version.rfind("2.", 0) != 0) {
    throw Fault("asset.version", "is '" + printable(version) + "', and only glTF 2.0 is read");
  }
}

void Checker::check_node(const Place &place, json &node) const
{
  check_object(place, node, node_properties, {"extensions", "extras"});
  empty_unknown_extensions(place, node, {"KHR_lights_punctual"});
  if (json *extensions = member(node, "extensions")) {
    const Place extensions_place{&place, "extensions"};
    check_member(extensions_place, *extensions, "KHR_lights_punctual", node_light_properties);
  }
  check_extras(place, node);
}

void Checker::check_mesh(const Place &place, json &mesh) const
{
  check_object(place, mesh, mesh_properties, {"primitives"});
  json *primitives = member(mesh, "primitives");
  if (primitives == nullptr || !primitives->is_array()) {
    throw Fault(place.text() + ".primitives", "is missing or not an array");
  }
  for (std::size_t i = 0; i < primitives->size(); i++) {
    const Place primitive_place{&place, "primitives", i};
    json &primitive = (*primitives)[i];
    check_object(primitive_place, primitive, primitive_properties, {"attributes", "extensions", "targets"});
    json *attributes = member(primitive, "attributes");
    if (attributes == nullptr) {
      throw Fault(primitive_place.text(), "has no attributes");
    }
    check_attributes({&primitive_place, "attributes"}, *attributes);
    empty_unknown_extensions(primitive_place, primitive, {});
    if (json *targets = member(primitive, "targets")) {
      // That there are some is all that is said of them.
      *targets = json::array({json::object()});
    }
  }
}

void Checker::check_attributes(const Place &place, json &attributes) const
{
  check_is_object(place, attributes);
  std::vector<Property> properties(attribute_properties.begin(), attribute_properties.end());
  for (const auto &[key, value] : attributes.items()) {
    if (key.rfind(texture_coordinate_prefix, 0) == 0) {
      properties.push_back({key, Kind::Index, "accessors"});
    }
  }
  check_object(place, attributes, properties);
}

void Checker::check_accessor(const Place &place, json &accessor) const
{
  check_object(place, accessor, accessor_properties, {"sparse"});
  json *sparse = check_member(place, accessor, "sparse", sparse_properties, {"indices", "values"});
  if (sparse == nullptr) {
    return;
  }
  const Place sparse_place{&place, "sparse"};
  for (const std::string_view part : {"indices", "values"}) {
    if (check_member(sparse_place, *sparse, part, sparse_part_properties) == nullptr) {
      throw Fault(sparse_place.text(), "has no " + std::string(part));
    }
  }
}

void Checker::check_base_color_slot(const Place &outer, json &roughness) const
{
  constexpr std::string_view key = "baseColorTexture";
  json *slot = check_member(outer, roughness, key, base_color_slot_properties, {"extensions"});
  if (slot == nullptr) {
    return;
  }
  const Place place{&outer, key};
  empty_unknown_extensions(place, *slot, {"KHR_texture_transform"});
  if (json *extensions = member(*slot, "extensions")) {
    check_member({&place, "extensions"}, *extensions, "KHR_texture_transform", texture_transform_properties);
  }
}

void Checker::check_material(const Place &place, json &material) const
{
  check_object(place, material, material_properties,
               {"pbrMetallicRoughness", "normalTexture", "occlusionTexture", "emissiveTexture", "extensions"});
  for (const std::string_view slot : {"normalTexture", "occlusionTexture", "emissiveTexture"}) {
    check_member(place, material, slot, slot_properties);
  }
  if (json *roughness = check_member(place, material, "pbrMetallicRoughness", roughness_properties,
                                     {"baseColorTexture", "metallicRoughnessTexture"})) {
    const Place roughness_place{&place, "pbrMetallicRoughness"};
    check_base_color_slot(roughness_place, *roughness);
    check_member(roughness_place, *roughness, "metallicRoughnessTexture", slot_properties);
  }
  empty_unknown_extensions(place, material,
                           {"KHR_materials_specular", "KHR_materials_emissive_strength", "KHR_materials_ior"});
  if (json *extensions = member(material, "extensions")) {
    const Place extensions_place{&place, "extensions"};
    if (json *specular = check_member(extensions_place, *extensions, "KHR_materials_specular", specular_properties,
                                      {"specularTexture", "specularColorTexture"})) {
      const Place specular_place{&extensions_place, "KHR_materials_specular"};
      check_member(specular_place, *specular, "specularTexture", slot_properties);
      check_member(specular_place, *specular, "specularColorTexture", slot_properties);
    }
    check_member(extensions_place, *extensions, "KHR_materials_emissive_strength", emissive_strength_properties);
    check_member(extensions_place, *extensions, "KHR_materials_ior", ior_properties);
  }
}

void Checker::check_camera(const Place &place, json &camera) const
{
  check_object(place, camera, camera_properties, {"perspective", "orthographic"});
  check_member(place, camera, "perspective", perspective_properties);
  check_member(place, camera, "orthographic", orthographic_properties);
}

void Checker::check_light(const Place &place, json &light) const
{
  check_object(place, light, light_properties, {"spot"});
  check_member(place, light, "spot", spot_properties);
}

void Checker::check_lights()
{
  json *extensions = member(document_, "extensions");
  if (extensions == nullptr) {
    return;
  }
  const Place place{nullptr, "extensions"};
  check_object(place, *extensions, {}, {"KHR_lights_punctual"});
  json *punctual = check_member(place, *extensions, "KHR_lights_punctual", {}, {"lights"});
  if (punctual == nullptr || !punctual->contains("lights")) {
    return;
  }
  const Place punctual_place{&place, "KHR_lights_punctual"};
  json &lights = (*punctual)["lights"];
  if (!lights.is_array()) {
    fail({&punctual_place, "lights"}, lights, "an array");
  }
  size_of_["lights"] = lights.size();
  for (std::size_t i = 0; i < lights.size(); i++) {
    check_light({&punctual_place, "lights", i}, lights[i]);
  }
}

void Checker::check_all()
{
  if (!document_.is_object()) {
    throw Fault("JSON", "the document is not an object");
  }
  check_asset();
  for (const std::string_view key : {"scenes", "nodes", "meshes", "skins", "accessors", "bufferViews", "buffers",
                                     "materials", "cameras", "textures", "samplers", "images", "extensionsRequired"}) {
    if (const json *array = member(document_, key)) {
      if (!array->is_array()) {
        fail({nullptr, key}, *array, "an array");
      }
      size_of_[key] = array->size();
    }
  }

  constexpr std::array properties{Property{"scene", Kind::Index, "scenes"}};
  const Place root{nullptr, ""};
  check_object(root, document_, properties,
               {"asset", "scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers", "materials", "cameras",
                "textures", "samplers", "images", "extensions", "extensionsRequired"});
  check_lights();

  const auto check_plain = [this](std::span<const Property> element_properties) {
    return
        [this, element_properties](const Place &place, json &value) { check_object(place, value, element_properties); };
  };
  check_array("scenes", check_plain(scene_properties));
  check_array("buffers", check_plain(buffer_properties));
  check_array("nodes", [this](const Place &place, json &value) { check_node(place, value); });
  check_array("meshes", [this](const Place &place, json &value) { check_mesh(place, value); });
  check_array("accessors", [this](const Place &place, json &value) { check_accessor(place, value); });
  check_array("materials", [this](const Place &place, json &value) { check_material(place, value); });
  check_array("cameras", [this](const Place &place, json &value) { check_camera(place, value); });
  check_array("bufferViews", check_plain(buffer_view_properties));
  check_array("textures", check_plain(texture_properties));
  check_array("samplers", check_plain(sampler_properties));
  check_array("images", check_plain(image_properties));
  check_array("extensionsRequired", [](const Place &place, const json &value) {
    if (!value.is_string()) {
      fail(place, value, "a string");
    }
  });
}

}  // namespace

void check_document(json &document)
{
  Checker(document).check_all();
}

}  // namespace gnomon::gltf
