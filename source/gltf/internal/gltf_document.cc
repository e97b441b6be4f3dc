// SPDX-License-Identifier: MIT
#include "internal/gltf_document.hh"

#include "internal/gltf_document_buffers.hh"
#include "internal/gltf_document_extras.hh"
#include "internal/gltf_document_shading.hh"
#include "internal/gltf_foreign_extras.hh"
#include "internal/gltf_json.hh"
#include "internal/gltf_json_fault.hh"
#include "memory_pages.hh"

#include <algorithm>
#include <new>
#include <utility>

namespace gnomon::gltf {

namespace {

/** The length of an array. Long arrays are counted, because simdjson stores a length in 24 bits. */
std::size_t size_of(const JsonArray &array)
{
  constexpr std::size_t saturated = 0xFFFFFF;
  const std::size_t size = array.size();
  return size < saturated ? size : std::size_t(std::distance(array.begin(), array.end()));
}

/** Fills a model from a document. */
class DocumentReader {
 public:
  DocumentReader(const JsonValue &document, Warnings &warnings) : document_{.warnings = &warnings}
  {
    JsonObject root;
    if (document.get(root) != simdjson::SUCCESS) {
      throw Fault("JSON", "the document is not an object");
    }
    for (const auto [key, value] : root) {
      if (!root_.insert_or_assign(key, value).second) {
        at_root(key).warn("stands twice in the document; the last counts");
      }
    }
  }

  Model read()
  {
    check_asset();
    for (const std::string_view key :
         {"scenes", "nodes", "meshes", "skins", "accessors", "bufferViews", "buffers", "materials", "cameras",
          "textures", "samplers", "images", "extensionsRequired"}) {
      if (const JsonValue *value = root(key)) {
        indices_.set_size(key, size_of(array_at(at_root(key), *value)));
      }
    }
    if (const JsonValue *value = root("scene")) {
      model_.scene = indices_.index_into("scenes", at_root("scene"), *value);
    }
    read_extensions();
    if (const JsonValue *extras = root(extras_key)) {
      note_foreign_extras(document_, *extras);
    }
    read_array("scenes", model_.scenes,
               [this](const auto &at, const auto &value, auto &one) { read_scene(at, value, one); });
    read_array("buffers", model_.buffers, read_buffer);
    read_array("nodes", model_.nodes,
               [this](const auto &at, const auto &value, auto &one) { read_node(at, value, one); });
    read_array("meshes", model_.meshes,
               [this](const auto &at, const auto &value, auto &one) { read_mesh(at, value, one); });
    read_array("accessors", model_.accessors,
               [this](const auto &at, const auto &value, auto &one) { read_accessor(at, value, indices_, one); });
    read_array("materials", model_.materials, read_material);
    read_array("cameras", model_.cameras, read_camera);
    read_array("bufferViews", model_.buffer_views,
               [this](const auto &at, const auto &value, auto &one) { read_buffer_view(at, value, indices_, one); });
    read_array("textures", model_.textures, read_texture);
    read_array("samplers", model_.samplers, read_sampler);
    read_array("images", model_.images, read_image);
    read_array("extensionsRequired", model_.extensions_required, read_required_extension);
    read_array("skins", model_.skins,
               [this](const auto &at, const auto &value, auto &one) { read_skin(at, value, one); });
    read_array("animations", model_.animations,
               [this](const auto &at, const auto &value, auto &one) { read_animation(at, value, one); });
    return std::move(model_);
  }

 private:
  /** Stands for the array of EXT_lights_image_based among the arrays of the document. */
  static constexpr std::string_view image_lights = "image-based lights";

  const Place document_;
  std::map<std::string_view, JsonValue> root_;
  DocumentIndices indices_;
  Model model_;

  [[nodiscard]] Place at_root(std::string_view key) const
  {
    return {&document_, key};
  }

  [[nodiscard]] const JsonValue *root(std::string_view key) const
  {
    const auto found = root_.find(key);
    return found == root_.end() ? nullptr : &found->second;
  }

  template <typename Element, typename Read>
  static void read_elements(const Place &place, const JsonArray &array, std::vector<Element> &elements,
                            const Read &read_one)
  {
    elements.clear();
    elements.reserve(size_of(array));
    memory::prefer_large_pages(elements.data(), elements.capacity() * sizeof(Element));
    for (const JsonValue value : array) {
      const bool is_of_document = place.outer->outer == nullptr;
      const Place at{place.outer, place.key, elements.size(), is_of_document ? &value : nullptr};
      read_one(at, value, elements.emplace_back());
    }
  }

  template <typename Element, typename Read>
  void read_array(std::string_view key, std::vector<Element> &elements, const Read &read_one)
  {
    if (const JsonValue *value = root(key)) {
      const Place place = at_root(key);
      read_elements(place, array_at(place, *value), elements, read_one);
    }
  }

  static auto into_numbers(std::string_view key, std::vector<double> &target)
  {
    return Member{key, [&target](const Place &place, const JsonValue &value) {
                    target.clear();
                    for (const JsonValue element : array_at(place, value, "an array of numbers")) {
                      target.push_back(number_at({place.outer, place.key, target.size()}, element));
                    }
                  }};
  }

  void check_asset() const
  {
    const JsonValue *asset = root("asset");
    if (asset == nullptr) {
      throw Fault("asset", "is missing: this is not a glTF 2.0 file");
    }
    std::string version;
    read_members(at_root("asset"), *asset, into("version", version));
    if (!version.starts_with("2.")) {
      throw Fault("asset.version", "is '" + printable(version) + "', and only glTF 2.0 is read");
    }
  }

  static void read_required_extension(const Place &place, const JsonValue &value, std::string &name)
  {
    name = string_at(place, value);
  }

  void read_scene(const Place &place, const JsonValue &value, Model::Scene &scene) const
  {
    const auto read_image_based = [&](const Place &at, const JsonValue &extension) {
      read_members(at, extension, indices_.into_index("light", scene.image_light, image_lights));
    };
    read_members(place, value, indices_.into_indices("nodes", scene.roots, "nodes"),
                 Member{"extensions",
                        [&](const Place &at, const JsonValue &extensions) {
                          read_members(at, extensions, Member{"EXT_lights_image_based", read_image_based});
                        }},
                 Member{"extras",
                        [&](const Place &, const JsonValue &extras) { read_extras(place, "", extras, scene.extras); }});
  }

  // ---- Nodes ----

  void read_node(const Place &place, const JsonValue &value, Model::Node &node) const
  {
    std::optional<JsonValue> extras;
    read_members(
        place, value, into_name(node.name), indices_.into_indices("children", node.children, "nodes"),
        Member{"matrix",
               [&](const Place &at, const JsonValue &matrix) { read_numbers(at, matrix, node.matrix.emplace()); }},
        into("translation", node.translation), into("rotation", node.rotation), into("scale", node.scale),
        indices_.into_index("mesh", node.mesh, "meshes"), indices_.into_index("camera", node.camera, "cameras"),
        indices_.into_index("skin", node.skin, "skins"), into_numbers("weights", node.weights),
        Member{"extensions",
               [&](const Place &at, const JsonValue &extensions) { read_node_extensions(at, extensions, node); }},
        Member{"extras", [&](const Place &, const JsonValue &member) { extras = member; }});
    // After the name, which messages about extras include.
    if (extras) {
      read_extras(place, node.name, *extras, node.extras);
    }
  }

  void read_node_extensions(const Place &place, const JsonValue &value, Model::Node &node) const
  {
    read_members(place, value,
                 Member{"KHR_lights_punctual",
                        [&](const Place &at, const JsonValue &extension) {
                          read_members(at, extension, indices_.into_index("light", node.light, "lights"));
                        }},
                 Member{"KHR_node_visibility",
                        [&](const Place &at, const JsonValue &extension) {
                          read_members(at, extension, into("visible", node.is_visible));
                        }},
                 Member{"EXT_mesh_gpu_instancing", [&](const Place &at, const JsonValue &extension) {
                          Model::Instances &instances = node.instances.emplace(Model::Instances{});
                          read_members(
                              at, extension,
                              Member{"attributes", [&](const Place &in, const JsonValue &attributes) {
                                       read_members(
                                           in, attributes,
                                           indices_.into_index("TRANSLATION", instances.translation, "accessors"),
                                           indices_.into_index("ROTATION", instances.rotation, "accessors"),
                                           indices_.into_index("SCALE", instances.scale, "accessors"));
                                     }});
                        }});
  }

  // ---- Meshes ----

  void read_mesh(const Place &place, const JsonValue &value, Model::Mesh &mesh) const
  {
    bool has_primitives = false;
    read_members(place, value, into_name(mesh.name), into_numbers("weights", mesh.weights),
                 Member{"primitives", [&](const Place &at, const JsonValue &member) {
                          JsonArray primitives;
                          has_primitives = member.get(primitives) == simdjson::SUCCESS;
                          if (has_primitives) {
                            read_elements(at, primitives, mesh.primitives,
                                          [this](const auto &at_one, const auto &value_one, auto &one) {
                                            read_primitive(at_one, value_one, one);
                                          });
                          }
                        }});
    if (!has_primitives) {
      throw Fault(place.text() + ".primitives", "is missing or not an array");
    }
  }

  void read_primitive(const Place &place, const JsonValue &value, Model::Primitive &primitive) const
  {
    bool has_attributes = false;
    const auto read_variants = [&](const Place &at, const JsonValue &mappings) {
      read_elements(at, array_at(at, mappings), primitive.variant_materials,
                    [this](const Place &in, const JsonValue &one, Model::VariantMaterial &mapping) {
                      read_members(in, one, indices_.into_index("material", mapping.material, "materials"),
                                   indices_.into_indices("variants", mapping.variants, "variants"));
                    });
    };
    const auto read_extension = [&](std::string_view name, const Place &at, const JsonValue &extension) {
      if (name == "KHR_draco_mesh_compression") {
        read_draco(at, extension, primitive.draco.emplace(Model::Draco{}));
      }
      else if (name == "KHR_materials_variants") {
        read_members(at, extension, Member{"mappings", read_variants});
      }
      else {
        warn_unread_extension(*at.outer, name);
        primitive.compression = name.find("compression") != name.npos ? name : primitive.compression;
      }
    };
    read_members(
        place, value, indices_.into_index("indices", primitive.indices, "accessors"),
        indices_.into_index("material", primitive.material, "materials"), into("mode", primitive.mode),
        Member{"attributes",
               [&](const Place &at, const JsonValue &attributes) {
                 has_attributes = true;
                 read_attributes(at, attributes, primitive.attributes);
               }},
        Member{"targets",
               [&](const Place &at, const JsonValue &targets) {
                 read_elements(
                     at, array_at(at, targets), primitive.targets,
                     [this](const Place &in, const JsonValue &one, auto &target) { read_attributes(in, one, target); });
               }},
        Member{"extensions",
               [&](const Place &at, const JsonValue &extensions) { for_members(at, extensions, read_extension); }},
        Member{"extras", [&](const Place &at, const JsonValue &extras) {
                 if (extras.is_object()) {
                   read_members(at, extras, Member{"gnomon_name", [&](const Place &in, const JsonValue &name) {
                                                     primitive.name = name_at(in, name);
                                                   }});
                 }
               }});
    if (!has_attributes) {
      throw Fault(place.text(), "has no attributes");
    }
  }

  void read_draco(const Place &place, const JsonValue &value, Model::Draco &draco) const
  {
    read_members(place, value, indices_.into_index("bufferView", draco.buffer_view, "bufferViews"),
                 Member{"attributes", [&](const Place &at, const JsonValue &attributes) {
                          for_members(at, attributes, [&](std::string_view key, const Place &in, const JsonValue &id) {
                            draco.attributes.insert_or_assign(std::string(key), index_at(in, id));
                          });
                        }});
    if (draco.buffer_view < 0) {
      fail_incomplete(place, "bufferView");
    }
  }

  void read_attributes(const Place &place, const JsonValue &value, std::map<std::string, int, std::less<>> &read) const
  {
    read.clear();
    for_members(place, value, [&](std::string_view key, const Place &at, const JsonValue &accessor) {
      if (key == "POSITION" || key == "NORMAL" || key == "TANGENT" || key == "COLOR_0" ||
          key.starts_with("TEXCOORD_") || key.starts_with("JOINTS_") || key.starts_with("WEIGHTS_")) {
        read.insert_or_assign(std::string(key), indices_.index_into("accessors", at, accessor));
      }
    });
  }

  void read_skin(const Place &place, const JsonValue &value, Model::Skin &skin) const
  {
    read_members(place, value, into_name(skin.name), indices_.into_indices("joints", skin.joints, "nodes"),
                 indices_.into_index("inverseBindMatrices", skin.inverse_bind_matrices, "accessors"));
  }

  void read_animation(const Place &place, const JsonValue &value, Model::Animation &animation) const
  {
    const auto read_sampler = [this](const Place &at, const JsonValue &one, Model::AnimationSampler &sampler) {
      read_members(at, one, indices_.into_index("input", sampler.input, "accessors"),
                   indices_.into_index("output", sampler.output, "accessors"),
                   into("interpolation", sampler.interpolation));
      if (sampler.input < 0 || sampler.output < 0) {
        fail_incomplete(at, sampler.input < 0 ? "input" : "output");
      }
    };
    const auto read_target = [this](const Place &at, const JsonValue &one, Model::AnimationChannel &channel) {
      read_members(at, one, indices_.into_index("node", channel.node, "nodes"), into("path", channel.path),
                   Member{"extensions", [&](const Place &in, const JsonValue &extensions) {
                            read_members(in, extensions,
                                         Member{"KHR_animation_pointer", [&](const Place &of, const JsonValue &member) {
                                                  read_members(of, member, into("pointer", channel.pointer));
                                                }});
                          }});
    };
    read_members(place, value, into_name(animation.name),
                 Member{"samplers",
                        [&](const Place &at, const JsonValue &member) {
                          read_elements(at, array_at(at, member), animation.samplers, read_sampler);
                        }},
                 Member{"channels", [&](const Place &at, const JsonValue &member) {
                          read_elements(at, array_at(at, member), animation.channels,
                                        [&](const Place &in, const JsonValue &one, Model::AnimationChannel &channel) {
                                          read_members(in, one, into("sampler", channel.sampler),
                                                       Member{"target", [&](const Place &of, const JsonValue &target) {
                                                                read_target(of, target, channel);
                                                              }});
                                        });
                        }});
    for (const Model::AnimationChannel &channel : animation.channels) {
      if (std::size_t(channel.sampler) >= animation.samplers.size()) {
        throw Fault(place.text() + ".channels",
                    channel.sampler < 0 ? "one has no sampler" : "a sampler's index is out of range");
      }
    }
  }

  void read_extensions()
  {
    const JsonValue *extensions = root("extensions");
    if (extensions == nullptr) {
      return;
    }
    const auto read_array_of_lights = [&](const Place &at, const JsonValue &lights) {
      read_elements(at, array_at(at, lights), model_.lights, read_light);
    };
    const auto read_array_of_image_lights = [&](const Place &at, const JsonValue &lights) {
      read_elements(at, array_at(at, lights), model_.image_lights, read_image_light);
    };
    const auto read_array_of_variants = [&](const Place &at, const JsonValue &variants) {
      read_elements(
          at, array_at(at, variants), model_.variants,
          [](const Place &in, const JsonValue &one, std::string &name) { read_members(in, one, into_name(name)); });
    };
    read_members(at_root(extensions_key), *extensions,
                 Member{"KHR_lights_punctual",
                        [&](const Place &at, const JsonValue &punctual) {
                          read_members(at, punctual, Member{"lights", read_array_of_lights});
                        }},
                 Member{"EXT_lights_image_based",
                        [&](const Place &at, const JsonValue &image_based) {
                          read_members(at, image_based, Member{"lights", read_array_of_image_lights});
                        }},
                 Member{"KHR_materials_variants", [&](const Place &at, const JsonValue &variants) {
                          read_members(at, variants, Member{"variants", read_array_of_variants});
                        }});
    indices_.set_size("lights", model_.lights.size());
    indices_.set_size(image_lights, model_.image_lights.size());
    indices_.set_size("variants", model_.variants.size());
  }
};

/** Removes the code from "CODE: The JSON document has …", which has no meaning for a user. */
std::string reason_of(simdjson::error_code error)
{
  const std::string_view message = simdjson::error_message(error);
  const std::size_t prefix_end = message.find(": ");
  return printable(prefix_end == message.npos ? message : message.substr(prefix_end + 2));
}

}  // namespace

std::size_t document_padding()
{
  return simdjson::SIMDJSON_PADDING;
}

Model parse_document(std::span<const unsigned char> json, Warnings &warnings)
{
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  std::string_view whole(reinterpret_cast<const char *>(json.data()), json.size());
  // Padding by zero bytes, which may stand before and after padding by spaces.
  constexpr std::string_view padding("\0 \t\r\n", 5);
  const std::size_t size = whole.find_last_not_of(padding) + 1;
  const std::ptrdiff_t zero_count = std::ranges::count(whole.substr(size), '\0');
  if (size > 0 && zero_count > 0) {
    warnings.add("JSON", "zero bytes at its end are dropped: " + std::to_string(zero_count));
    whole = whole.substr(0, size);
  }
  std::string_view text = whole;
  if (text.starts_with(byte_order_mark)) {
    warnings.add("JSON", "begins with a byte-order mark, which glTF does not allow");
    text.remove_prefix(byte_order_mark.size());
  }
  simdjson::dom::parser parser;
  JsonValue document;
  std::string changed;
  const simdjson::error_code error = parse_json(parser, text, changed, document);
  if (error == simdjson::MEMALLOC) {
    throw std::bad_alloc();
  }
  if (error != simdjson::SUCCESS) {
    const std::string found = json_fault(whole);
    throw Fault("JSON", "parse error: " + (found.empty() ? reason_of(error) : found));
  }
  Model model = DocumentReader(document, warnings).read();
  if (warnings.has_kept_extras()) {
    read_foreign_extras(text, warnings, model);
  }
  return model;
}

}  // namespace gnomon::gltf
