// SPDX-License-Identifier: MIT
#include "gltf_export.hh"

#include "image_base64.hh"
#include "internal/gltf_camera.hh"
#include "internal/gltf_extra.hh"
#include "internal/gltf_file.hh"
#include "internal/gltf_foreign_extras.hh"
#include "internal/gltf_node.hh"
#include "internal/gltf_report.hh"
#include "internal/gltf_write_animation.hh"
#include "internal/gltf_write_buffer.hh"
#include "internal/gltf_write_json.hh"
#include "internal/gltf_write_lamp.hh"
#include "internal/gltf_write_mesh.hh"
#include "internal/gltf_write_skin_copy.hh"
#include "internal/gltf_write_world.hh"
#include "output_file.hh"

#include <array>
#include <limits>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::gltf {

using scene::Camera;
using scene::Handle;
using scene::Lamp;
using scene::Node;
using scene::Scene;

namespace {

/** Whether two cameras have the same lens and extras. */
bool is_same(const Camera &a, const Camera &b)
{
  return a.kind == b.kind && a.vertical_angle == b.vertical_angle && a.aspect == b.aspect &&
         a.half_width == b.half_width && a.half_height == b.half_height && a.near == b.near && a.far == b.far &&
         a.extras == b.extras;
}

class SceneWriter {
 public:
  /** \a folder: that of the file */
  SceneWriter(const Scene &scene, std::filesystem::path folder)
      : scene_(scene), folder_(std::move(folder)), meshes_(scene, buffer_, folder_), moved_(moved_nodes(scene))
  {
  }

  /** The document without the member "buffers", which depends on the file format. */
  JsonText document()
  {
    number_nodes();
    find_copies();
    JsonText nodes;
    JsonText roots;
    for (const Handle<Node> handle : order_) {
      nodes.add(node_json(handle));
      if (!scene_.parent(handle)) {
        roots.add(std::to_string(indices_.nodes.at(handle)));
      }
    }
    for (const SkinCopy &copy : copies_) {
      add_copied_joints(copy, nodes);
    }
    const JsonText skins = skins_json(scene_, indices_, copies_, nodes, buffer_);
    indices_.materials = meshes_.material_indices();
    bool has_pointers = false;
    const JsonText animations = animations_json(scene_, indices_, buffer_, has_pointers);
    if (has_pointers) {
      meshes_.extensions.insert("KHR_animation_pointer");
    }
    JsonText document;
    document.add("asset", R"({"generator":"Gnomon","version":"2.0"})");
    add_extensions(document);
    add_extras({}, {scene_.file_extras}, "document", document);
    document.add("scene", "0");
    document.add("scenes", '[' + scene_json(roots) + ']');
    const auto add = [&document](std::string_view key, const JsonText &array) {
      if (!array.empty()) {
        document.add(key, array.array());
      }
    };
    add("nodes", nodes);
    add("cameras", cameras_);
    add("meshes", meshes_.meshes);
    add("skins", skins);
    add("animations", animations);
    add("materials", meshes_.materials);
    add("textures", meshes_.textures);
    add("samplers", meshes_.samplers);
    add("images", meshes_.images);
    add("accessors", buffer_.accessors);
    add("bufferViews", buffer_.views);
    return document;
  }

  [[nodiscard]] const std::vector<unsigned char> &bytes() const
  {
    return buffer_.bytes;
  }

 private:
  const Scene &scene_;
  std::filesystem::path folder_;
  WrittenBuffer buffer_;
  MeshWriter meshes_;
  JsonText cameras_;
  JsonText lights_;
  WrittenIndices indices_;
  std::map<Handle<Node>, const scene::AnimatedNode *> moved_;
  /** Parents before their children. */
  std::vector<Handle<Node>> order_;
  std::vector<SkinCopy> copies_;
  /** Index in copies_; -1: the mesh of the node is written as it stands, because its joints cannot be copied. */
  std::map<Handle<Node>, int> copy_of_;

  /** Whether the node is the unchanged camera or lamp that the importer adds to a file without one. */
  [[nodiscard]] bool is_made_up(Handle<Node> handle, const Node &node) const
  {
    if (node.name != default_name || !node.extras.empty() || !node.meshes.empty() || scene_.parent(handle) ||
        scene_.first_child(handle)) {
      return false;
    }
    const Camera *camera = scene_.cameras().find(node.camera);
    const Lamp *lamp = scene_.lamps().find(node.lamp);
    if (scene_.is_camera_default && camera != nullptr && lamp == nullptr) {
      const scene::PlacedCamera added = default_camera(scene_.bounds());
      return node.parent_from_node == added.world_from_camera && is_same(*camera, added);
    }
    const std::vector<scene::PlacedCamera> cameras = scene_.placed_cameras();
    if (scene_.is_lamp_default && lamp != nullptr && camera == nullptr && !cameras.empty()) {
      const scene::PlacedLamp added = default_sun(cameras.front());
      return node.parent_from_node == added.world_from_lamp && *lamp == added;
    }
    return false;
  }

  void number_nodes()
  {
    for (const auto &[root, node] : scene_.nodes()) {
      if (scene_.parent(root) || is_made_up(root, node)) {
        continue;
      }
      // No recursion: the node tree may be deeper than the stack.
      Handle<Node> at = root;
      while (at) {
        indices_.nodes.emplace(at, static_cast<int>(order_.size()));
        order_.push_back(at);
        Handle<Node> next = scene_.first_child(at);
        while (!next && at != root) {
          next = scene_.next_sibling(at);
          at = next ? at : scene_.parent(at);
        }
        at = next;
      }
    }
  }

  /** Finds the nodes that show deformed meshes of other nodes, and numbers the nodes that they need. */
  void find_copies()
  {
    std::size_t index = order_.size();
    for (const Handle<Node> handle : order_) {
      const scene::DeformedMesh *const deformed = meshes_.deformed_of(scene_.nodes()[handle].meshes);
      if (deformed == nullptr || deformed->node == handle) {
        continue;
      }
      if (deformed->skin >= 0) {
        std::optional<SkinCopy> copy = skin_copy(scene_, *deformed);
        copy_of_.emplace(handle, copy ? int(copies_.size()) : -1);
        if (!copy) {
          continue;
        }
        copy->first_index = int(index);
        for (const Handle<Node> joint : copy->nodes) {
          indices_.moved_copies.emplace(joint, *copy->index_of(joint));
        }
        index += 1 + copy->nodes.size();
        copies_.push_back(std::move(*copy));
      }
      indices_.morphed_copies.emplace(deformed->node, indices_.nodes.at(handle));
    }
  }

  void add_copied_joints(const SkinCopy &copy, JsonText &nodes)
  {
    const auto children_json = [&](Handle<Node> parent) {
      JsonText children;
      for (const Handle<Node> joint : copy.nodes) {
        if (scene_.parent(joint) == parent) {
          children.add(std::to_string(*copy.index_of(joint)));
        }
      }
      return children;
    };
    const auto add = [&](Handle<Node> original, JsonText json) {
      if (const JsonText children = children_json(original); !children.empty()) {
        json.add("children", children.array());
      }
      nodes.add(json.object());
    };
    JsonText base;
    add_matrix(copy.node_from_base, "joints of a copy", base);
    add(copy.base, std::move(base));
    for (const Handle<Node> joint : copy.nodes) {
      const Node &node = scene_.nodes()[joint];
      const std::string what = "node '" + printable(node.name) + '\'';
      JsonText json;
      add_place(joint, what, json);
      add(joint, std::move(json));
    }
  }

  std::string scene_json(const JsonText &roots)
  {
    JsonText json;
    if (!roots.empty()) {
      json.add("nodes", roots.array());
    }
    const bool is_default = scene_.world() == scene_.default_world && scene_.placed_lamps().empty();
    JsonText extras;
    if (scene_.world() && !is_default) {
      add_world_extras(*scene_.world(), folder_, buffer_, extras);
    }
    add_extras(std::move(extras), {scene_.extras}, "scene", json);
    return json.object();
  }

  std::string node_json(Handle<Node> handle)
  {
    const Node &node = scene_.nodes()[handle];
    const std::string what = "node '" + printable(node.name) + '\'';
    JsonText json;
    JsonText extras;
    if (!node.name.empty()) {
      json.add("name", json_string(node.name, what));
    }
    JsonText children;
    for (Handle<Node> child = scene_.first_child(handle); child; child = scene_.next_sibling(child)) {
      children.add(std::to_string(indices_.nodes.at(child)));
    }
    const auto copy = copy_of_.find(handle);
    const bool is_frozen = copy != copy_of_.end() && copy->second < 0;
    if (copy != copy_of_.end() && !is_frozen) {
      children.add(std::to_string(copies_[std::size_t(copy->second)].first_index));
    }
    if (!children.empty()) {
      json.add("children", children.array());
    }
    add_place(handle, what, json);
    if (const int mesh = meshes_.index_of(node.meshes, !is_frozen); mesh >= 0) {
      json.add("mesh", std::to_string(mesh));
      if (!is_frozen) {
        add_deformation(node, copy == copy_of_.end() ? -1 : int(scene_.skins.size()) + copy->second, what, json);
      }
    }
    add_flags(node, extras);
    add_camera(node, json, extras);
    add_lamp(node, json, extras);
    // Files have no element for an area lamp but its node.
    const Lamp *const lamp = scene_.lamps().find(node.lamp);
    const bool is_area = lamp != nullptr && lamp->kind == scene::LampKind::Area;
    add_extras(std::move(extras), {node.extras, is_area ? lamp->extras : std::string_view()}, what, json);
    return json.object();
  }

  /** Adds the transform of the node. */
  void add_place(Handle<Node> handle, const std::string &what, JsonText &json) const
  {
    const glm::dmat4 &matrix = scene_.nodes()[handle].parent_from_node;
    if (const auto moved = moved_.find(handle); moved != moved_.end()) {
      add_transform(matrix, *moved->second, what, json);
    }
    else {
      add_matrix(matrix, what, json);
    }
  }

  static void add_matrix(const glm::dmat4 &matrix, const std::string &what, JsonText &json)
  {
    if (matrix == glm::dmat4(1.0)) {
      return;
    }
    JsonText numbers;
    for (int i = 0; i < 16; i++) {
      numbers.add(json_number(matrix[i / 4][i % 4], what));
    }
    json.add("matrix", numbers.array());
  }

  /** \a copied_skin: index of the skin of a copy; -1: the node has that of its mesh. */
  void add_deformation(const Node &node, int copied_skin, const std::string &what, JsonText &json) const
  {
    const scene::DeformedMesh *const deformed = meshes_.deformed_of(node.meshes);
    if (deformed == nullptr) {
      return;
    }
    if (deformed->skin >= 0) {
      json.add("skin", std::to_string(copied_skin >= 0 ? copied_skin : deformed->skin));
    }
    JsonText weights;
    for (const double weight : deformed->weights) {
      weights.add(json_number(weight, what));
    }
    if (!weights.empty()) {
      json.add("weights", weights.array());
    }
  }

  static void add_flags(const Node &node, JsonText &extras)
  {
    for_each_flag([&](const auto &row) {
      if (const bool flag = node.*row.member; flag != Node().*row.member) {
        extras.add(extra_key(row), flag ? "true" : "false");
      }
    });
  }

  void add_camera(const Node &node, JsonText &json, JsonText &extras)
  {
    const Camera *camera = scene_.cameras().find(node.camera);
    if (camera == nullptr) {
      return;
    }
    const auto [place, is_new] = indices_.cameras.try_emplace(node.camera, 0);
    if (is_new) {
      place->second = cameras_.add(camera_json(*camera));
    }
    json.add("camera", std::to_string(place->second));
    if (camera->name != node.name) {
      extras.add("gnomon_camera_name", json_string(camera->name, "camera"));
    }
    add_camera_extras(*camera, extras);
  }

  void add_lamp(const Node &node, JsonText &json, JsonText &extras)
  {
    const Lamp *lamp = scene_.lamps().find(node.lamp);
    if (lamp == nullptr) {
      return;
    }
    if (lamp->kind != scene::LampKind::Area) {
      const auto [place, is_new] = indices_.lights.try_emplace(node.lamp, 0);
      if (is_new) {
        place->second = lights_.add(light_json(*lamp));
      }
      json.add("extensions", "{\"KHR_lights_punctual\":{\"light\":" + std::to_string(place->second) + "}}");
    }
    if (lamp->name != node.name) {
      extras.add("gnomon_lamp_name", json_string(lamp->name, "lamp"));
    }
    add_lamp_extras(*lamp, extras);
  }

  void add_extensions(JsonText &document) const
  {
    JsonText used;
    if (!lights_.empty()) {
      used.add("\"KHR_lights_punctual\"");
    }
    for (const std::string &name : meshes_.extensions) {
      used.add('"' + name + '"');
    }
    if (!used.empty()) {
      document.add("extensionsUsed", used.array());
    }
    if (!lights_.empty()) {
      document.add("extensions", "{\"KHR_lights_punctual\":{\"lights\":" + lights_.array() + "}}");
    }
  }
};

void add_u32(std::string &text, std::size_t value)
{
  for (unsigned shift = 0; shift < 32; shift += 8) {
    text += static_cast<char>(value >> shift & 0xFFU);
  }
}

std::string glb_of(std::string json, const std::vector<unsigned char> &bytes)
{
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string binary(bytes.begin(), bytes.end());
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  const std::size_t size = 12 + 8 + json.size() + (binary.empty() ? 0 : 8 + binary.size());
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    throw Fault("scene", "is larger than 4 GiB, the limit of a .glb");
  }
  std::string result = "glTF";
  add_u32(result, 2);
  add_u32(result, size);
  add_u32(result, json.size());
  result += "JSON" + json;
  if (!binary.empty()) {
    add_u32(result, binary.size());
    result += std::string("BIN\0", 4) + binary;
  }
  return result;
}

/** \a folder: that of the file */
std::string file_of(const Scene &scene, const std::filesystem::path &folder, bool is_binary)
{
  SceneWriter writer(scene, folder);
  JsonText document = writer.document();
  if (!writer.bytes().empty()) {
    const std::string uri =
        is_binary ? "" : ",\"uri\":\"data:application/octet-stream;base64," + image::base64(writer.bytes()) + '"';
    document.add("buffers", "[{\"byteLength\":" + std::to_string(writer.bytes().size()) + uri + "}]");
  }
  return is_binary ? glb_of(document.object(), writer.bytes()) : document.object() + '\n';
}

}  // namespace

void export_gltf(const Scene &scene, const std::filesystem::path &path)
{
  const auto failed = [&path](std::string_view reason) {
    return ExportError(path.string() + ": " + std::string(reason));
  };
  const std::filesystem::path extension = path.extension();
  if (extension != ".gltf" && extension != ".glb") {
    throw failed("the name ends neither in .gltf nor in .glb");
  }
  try {
    output::write_file(path, file_of(scene, path.parent_path(), extension == ".glb"));
  }
  catch (const Fault &fault) {
    throw failed(fault.what());
  }
  catch (const output::Error &error) {
    throw ExportError(error.what());
  }
  catch (const std::bad_alloc &) {
    throw failed("there is not enough memory for it");
  }
}

std::string left_out_of_export(const std::filesystem::path &path)
{
  try {
    Warnings warnings;
    const std::size_t count = load_document(path, warnings).model.variants.size();
    const std::string variants =
        count == 0 ? "" : std::to_string(count) + (count == 1 ? " variant" : " variants") + " of materials";
    const std::string extras = warnings.foreign_extras();
    return variants + (variants.empty() || extras.empty() ? "" : " and ") + extras;
  }
  catch (const std::exception &) {
    return "";
  }
}

}  // namespace gnomon::gltf
