// SPDX-License-Identifier: MIT
#pragma once

#include "image_base64.hh"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

/** A builder of small glTF files. Internal to source/verify, and for tests. */
namespace gnomon::verify::gltf {

using nlohmann::json;

enum Component : int { Int8 = 5120, Uint8 = 5121, Int16 = 5122, Uint16 = 5123, Uint32 = 5125, Float32 = 5126 };

using image::base64;

/** A temporary folder that is removed by the destructor. */
class TemporaryFolder {
 public:
  TemporaryFolder()
  {
    std::string name = (std::filesystem::temp_directory_path() / "gnomon_XXXXXX").string();
    path_ = ::mkdtemp(name.data()) == nullptr ? std::filesystem::path() : std::filesystem::path(name);
  }
  ~TemporaryFolder()
  {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  TemporaryFolder(const TemporaryFolder &) = delete;
  TemporaryFolder &operator=(const TemporaryFolder &) = delete;

  [[nodiscard]] const std::filesystem::path &path() const
  {
    return path_;
  }
  [[nodiscard]] std::filesystem::path write(const std::string &name, const std::string &content) const
  {
    const std::filesystem::path file = path_ / name;
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }

 private:
  std::filesystem::path path_;
};

/** A glTF document with one buffer. */
class GltfBuilder {
 public:
  json document = {{"asset", {{"version", "2.0"}}}};
  std::vector<unsigned char> bytes;

  template <typename T>
  int view(const std::vector<T> &values, int stride = 0)
  {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride > 0) {
      view["byteStride"] = stride;
    }
    const auto *begin = reinterpret_cast<const unsigned char *>(values.data());
    bytes.insert(bytes.end(), begin, begin + values.size() * sizeof(T));
    return append("bufferViews", view);
  }

  template <typename T>
  int accessor(const std::vector<T> &values, Component component, const std::string &type, json more = json::object())
  {
    const std::size_t width = type == "MAT4" ? 16 : type == "VEC4" ? 4 : type == "VEC3" ? 3 : type == "VEC2" ? 2 : 1;
    json accessor = {{"bufferView", view(values)},
                     {"componentType", int(component)},
                     {"count", values.size() / width},
                     {"type", type}};
    accessor.update(more);
    return append("accessors", accessor);
  }

  int positions(const std::vector<float> &values)
  {
    return accessor(values, Float32, "VEC3");
  }

  /** Adds a mesh of one primitive. \return its index */
  int mesh(const json &primitive, const std::string &name = "mesh")
  {
    return append("meshes", {{"name", name}, {"primitives", json::array({primitive})}});
  }

  /** Adds a node that is a root of the scene. \return its index */
  int node(json node)
  {
    const int index = append("nodes", std::move(node));
    document["scene"] = 0;
    document["scenes"][0]["nodes"].push_back(index);
    return index;
  }

  int append(const std::string &array, json element)
  {
    document[array].push_back(std::move(element));
    return static_cast<int>(document[array].size()) - 1;
  }

  /** Adds a light on a node of its own. \return the node's index */
  int light(json light, json extras = nullptr, json more = json::object())
  {
    json &lights = document["extensions"]["KHR_lights_punctual"]["lights"];
    lights.push_back(std::move(light));
    json node_json = {{"name", "lamp"}, {"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}};
    if (!extras.is_null()) {
      node_json["extras"] = std::move(extras);
    }
    node_json.update(more);
    return node(node_json);
  }

  [[nodiscard]] std::string gltf() const
  {
    json full = document;
    if (!bytes.empty() && !full.contains("buffers")) {
      full["buffers"] = json::array(
          {{{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}});
    }
    return full.dump();
  }

  [[nodiscard]] std::string glb() const
  {
    json full = document;
    if (!bytes.empty() && !full.contains("buffers")) {
      full["buffers"] = json::array({{{"byteLength", bytes.size()}}});
    }
    std::string text = full.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string binary(bytes.begin(), bytes.end());
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    std::string result = "glTF" + u32(2) + u32(28 + text.size() + binary.size());
    result += u32(text.size()) + "JSON" + text;
    return result + u32(binary.size()) + std::string("BIN\0", 4) + binary;
  }

 private:
  static std::string u32(std::size_t value)
  {
    const auto narrow = static_cast<std::uint32_t>(value);
    std::string result(4, '\0');
    std::memcpy(result.data(), &narrow, 4);
    return result;
  }
};

/** A triangle in the plane z = 0, facing +Z. */
inline const std::vector<float> triangle_positions{0, 0, 0, 1, 0, 0, 0, 1, 0};

/** A scene of one node with this triangle. */
inline GltfBuilder triangle_scene()
{
  GltfBuilder builder;
  const int mesh = builder.mesh({{"attributes", {{"POSITION", builder.positions(triangle_positions)}}}});
  builder.node({{"name", "thing"}, {"mesh", mesh}});
  return builder;
}

}  // namespace gnomon::verify::gltf
