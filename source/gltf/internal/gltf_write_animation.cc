// SPDX-License-Identifier: MIT
#include "internal/gltf_write_animation.hh"

#include "internal/gltf_model.hh"
#include "internal/gltf_pointer.hh"
#include "internal/gltf_report.hh"
#include "internal/gltf_units.hh"
#include "internal/gltf_write_mesh.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace gnomon::gltf {

using scene::AnimatedNode;
using scene::AnimatedValue;
using scene::Handle;
using scene::Interpolation;
using scene::SharedTrack;

namespace {

std::string_view interpolation_name(Interpolation interpolation)
{
  switch (interpolation) {
    case Interpolation::Step: return "STEP";
    case Interpolation::CubicSpline: return "CUBICSPLINE";
    case Interpolation::Linear: break;
  }
  return "LINEAR";
}

/** \a values in groups of the components of \a T. */
template <typename T>
std::vector<T> grouped(const std::vector<float> &values)
{
  constexpr std::size_t width = sizeof(T) / sizeof(float);
  std::vector<T> result(values.size() / width);
  for (std::size_t i = 0; i < result.size() * width; i++) {
    result[i / width][int(i % width)] = values[i];
  }
  return result;
}

class AnimationWriter {
 public:
  AnimationWriter(const scene::Scene &scene, const WrittenIndices &indices, WrittenBuffer &buffer)
      : scene_(scene), indices_(indices), buffer_(buffer)
  {
  }

  std::string animation_json(const scene::Animation &animation)
  {
    what_ = what_of("animation", animation.name);
    channels_ = {};
    samplers_ = {};
    for (const AnimatedNode &node : animation.nodes) {
      add_node(node);
    }
    for (std::size_t i = 0; i < animation.values.size(); i++) {
      const AnimatedValue &value = animation.values[i];
      // scene::pose sets a property to the last of its values; glTF allows one.
      const bool is_last = std::none_of(
          animation.values.begin() + std::ptrdiff_t(i) + 1, animation.values.end(), [&](const AnimatedValue &later) {
            return later.target == value.target && later.property == value.property && later.slot == value.slot;
          });
      if (is_last) {
        add_value(value);
      }
    }
    if (channels_.empty()) {
      return {};
    }
    JsonText json;
    json.add("name", json_string(animation.name, what_));
    json.add("channels", channels_.array());
    json.add("samplers", samplers_.array());
    return json.object();
  }

  bool has_pointers = false;

 private:
  const scene::Scene &scene_;
  const WrittenIndices &indices_;
  WrittenBuffer &buffer_;
  std::string what_;
  JsonText channels_;
  JsonText samplers_;
  std::map<const scene::Track *, int> input_of_;
  /** By track and whether its values are scalars. */
  std::map<std::pair<const scene::Track *, bool>, int> output_of_;

  void add_node(const AnimatedNode &node)
  {
    const auto found = indices_.nodes.find(node.node);
    if (found == indices_.nodes.end()) {
      return;
    }
    add_transform_channels(node, found->second);
    const auto moved = indices_.moved_copies.equal_range(node.node);
    std::for_each(moved.first, moved.second, [&](const auto &copy) { add_transform_channels(node, copy.second); });
    const bool has_targets = std::ranges::any_of(scene_.deformed_meshes, [&](const scene::DeformedMesh &deformed) {
      return deformed.node == node.node &&
             deformed.targets.size() == (node.weights_track ? node.weights_track->width : 0);
    });
    if (has_targets) {
      add_channel_of(node.weights_track, found->second, "weights", true);
      const auto morphed = indices_.morphed_copies.equal_range(node.node);
      std::for_each(morphed.first, morphed.second,
                    [&](const auto &copy) { add_channel_of(node.weights_track, copy.second, "weights", true); });
    }
  }

  void add_transform_channels(const AnimatedNode &node, int index)
  {
    add_channel_of(node.translation_track, index, "translation", false);
    add_channel_of(node.rotation_track, index, "rotation", false);
    add_channel_of(node.scale_track, index, "scale", false);
  }

  /** \a track: null if there is none */
  void add_channel_of(const SharedTrack &track, int node, std::string_view path, bool is_scalar)
  {
    if (!track) {
      return;
    }
    const auto [place, is_new] = output_of_.try_emplace({track.get(), is_scalar}, 0);
    if (is_new) {
      place->second = output(track->values, is_scalar ? 1 : track->width);
    }
    add_channel(*track, place->second,
                "{\"node\":" + std::to_string(node) + ",\"path\":\"" + std::string(path) + "\"}");
  }

  void add_value(const AnimatedValue &value)
  {
    const std::optional<int> index = index_of(value);
    if (!index) {
      return;
    }
    if (std::holds_alternative<Handle<scene::Node>>(value.target)) {
      std::vector<std::uint8_t> flags;
      for (const float number : value.track->values) {
        flags.push_back(number >= 0.5F ? 1 : 0);
      }
      add_pointer(*value.track, buffer_.add_accessor(flags, Model::UnsignedByte, "SCALAR"),
                  "/nodes/" + std::to_string(*index) + '/' + std::string(visibility_path));
      return;
    }
    if (!value.slot.empty()) {
      const auto *const input = std::ranges::find(scene::texture_inputs, value.slot, &scene::TextureInput::name);
      add_pointer(*value.track, output(value.track->values, value.track->width),
                  "/materials/" + std::to_string(*index) + '/' + std::string(input->path) +
                      std::string(transform_path) + std::string(value.property));
      return;
    }
    if (value.second_track) {
      const bool is_cone = value.property == scene::cone_property;
      add_pointer(*value.track, output(value.track->values, value.track->width), pointer_to(value.property, *index));
      add_pointer(*value.second_track, output(value.second_track->values, 1),
                  pointer_to(value.property, *index, is_cone ? inner_cone_path : strength_path));
      return;
    }
    // The importer multiplies the numbers in the file by the unit. A strength has one number, and its property three.
    const std::size_t width = scene::width_of(value.property);
    const std::vector<float> &source = value.track->values;
    const double unit = unit_of(value);
    std::vector<float> values;
    for (std::size_t i = 0; i < source.size() / value.track->width * width; i++) {
      const std::size_t component = i % width;
      const std::size_t place = value.track->width == width ? i : i / width;
      values.push_back(float(source[place] * (component < 3 ? value.factor[int(component)] / unit : 1.0)));
    }
    add_pointer(*value.track, output(values, width), pointer_to(value.property, *index));
  }

  /** \a path: of the thing that has \a property; empty: that of the property. */
  static std::string pointer_to(std::string_view property, int index, std::string_view path = {})
  {
    std::string pointer;
    for_each_animated([&](std::string_view collection, const scene::Description &row) {
      if (row.name == property) {
        pointer = fmt::format("{}/{}/{}/{}", collection == "lights" ? light_pointer_prefix : "", collection, index,
                              path.empty() ? row.path : path);
      }
    });
    return pointer;
  }

  void add_pointer(const scene::Track &track, int output, const std::string &path)
  {
    add_channel(track, output,
                R"({"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":")" + path + "\"}}}");
    has_pointers = true;
  }

  [[nodiscard]] std::optional<int> index_of(const AnimatedValue &value) const
  {
    return std::visit(
        [&](auto handle) {
          const auto find_in = [&](const auto &map) {
            const auto found = map.find(handle);
            return found == map.end() ? std::nullopt : std::optional(found->second);
          };
          if constexpr (std::is_same_v<decltype(handle), Handle<scene::Material>>) {
            return find_in(indices_.materials);
          }
          else if constexpr (std::is_same_v<decltype(handle), Handle<scene::Lamp>>) {
            return find_in(indices_.lights);
          }
          else if constexpr (std::is_same_v<decltype(handle), Handle<scene::Node>>) {
            return find_in(indices_.nodes);
          }
          else {
            return find_in(indices_.cameras);
          }
        },
        value.target);
  }

  /** The importer's factor for the values of the written file. */
  [[nodiscard]] double unit_of(const AnimatedValue &value) const
  {
    if (value.property == "intensity") {
      return 1.0 / lumen_per_watt;
    }
    const auto *const material = std::get_if<Handle<scene::Material>>(&value.target);
    if (value.property == "emissive") {
      return double(emissive_strength(scene_.materials()[*material].emissive));
    }
    if (value.property == "specular_color") {
      const float ratio = reflectance_ratio(scene_.materials()[*material].ior);
      return ratio == 0.0F ? 1.0 : double(ratio);
    }
    return 1.0;
  }

  int output(const std::vector<float> &values, std::size_t width)
  {
    switch (width) {
      case 2: return buffer_.add_accessor(grouped<glm::vec2>(values), Model::Float, "VEC2");
      case 3: return buffer_.add_accessor(grouped<glm::vec3>(values), Model::Float, "VEC3");
      case 4: return buffer_.add_accessor(grouped<glm::vec4>(values), Model::Float, "VEC4");
      default: return buffer_.add_accessor(values, Model::Float, "SCALAR");
    }
  }

  void add_channel(const scene::Track &track, int output, const std::string &target)
  {
    const auto [input, is_new] = input_of_.try_emplace(&track, 0);
    if (is_new) {
      const std::string bounds = ",\"min\":[" + json_number(track.times.front(), what_) + "],\"max\":[" +
                                 json_number(track.times.back(), what_) + ']';
      input->second = buffer_.add_accessor(track.times, Model::Float, "SCALAR", bounds);
    }
    const int sampler =
        samplers_.add("{\"input\":" + std::to_string(input->second) + ",\"output\":" + std::to_string(output) +
                      ",\"interpolation\":\"" + std::string(interpolation_name(track.interpolation)) + "\"}");
    channels_.add("{\"sampler\":" + std::to_string(sampler) + ",\"target\":" + target + '}');
  }
};

}  // namespace

std::map<Handle<scene::Node>, const AnimatedNode *> moved_nodes(const scene::Scene &scene)
{
  std::map<Handle<scene::Node>, const AnimatedNode *> moved;
  for (const scene::Animation &animation : scene.animations) {
    for (const AnimatedNode &node : animation.nodes) {
      if (node.translation_track || node.rotation_track || node.scale_track) {
        moved.emplace(node.node, &node);
      }
    }
  }
  return moved;
}

void add_transform(const glm::dmat4 &matrix, const AnimatedNode &moved, const std::string &what, JsonText &json)
{
  const glm::dmat3 axes(matrix);
  glm::dvec3 scale(glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2]));
  const glm::dvec3 signs(std::copysign(1.0, moved.scale.x), std::copysign(1.0, moved.scale.y),
                         std::copysign(1.0, moved.scale.z));
  const double side = glm::determinant(axes) < 0.0 ? -1.0 : 1.0;
  scale *= signs.x * signs.y * signs.z == side ? signs : glm::dvec3(side, 1.0, 1.0);
  glm::dquat rotation = moved.rotation;
  if (scale.x != 0.0 && scale.y != 0.0 && scale.z != 0.0) {
    rotation = glm::normalize(glm::quat_cast(glm::dmat3(axes[0] / scale.x, axes[1] / scale.y, axes[2] / scale.z)));
  }
  const auto add = [&](std::string_view key, std::initializer_list<double> values) {
    JsonText array;
    for (const double value : values) {
      array.add(json_number(value, what));
    }
    json.add(key, array.array());
  };
  add("translation", {matrix[3].x, matrix[3].y, matrix[3].z});
  add("rotation", {rotation.x, rotation.y, rotation.z, rotation.w});
  add("scale", {scale.x, scale.y, scale.z});
}

JsonText skins_json(const scene::Scene &scene, const WrittenIndices &indices, const std::vector<SkinCopy> &copies,
                    JsonText &nodes, WrittenBuffer &buffer)
{
  JsonText skins;
  const auto add = [&](const scene::Skin &skin, const auto &index_of) {
    const std::string what = what_of("skin", skin.name);
    JsonText joints;
    for (const Handle<scene::Node> joint : skin.joints) {
      const std::optional<int> index = index_of(joint);
      joints.add(std::to_string(index ? *index : nodes.add(R"({"name":"removed joint"})")));
    }
    const std::vector<glm::mat4> matrices(skin.joint_from_mesh.begin(), skin.joint_from_mesh.end());
    JsonText json;
    if (!skin.name.empty()) {
      json.add("name", json_string(skin.name, what));
    }
    json.add("joints", joints.array());
    json.add("inverseBindMatrices", std::to_string(buffer.add_accessor(matrices, Model::Float, "MAT4")));
    skins.add(json.object());
  };
  for (const scene::Skin &skin : scene.skins) {
    add(skin, [&](Handle<scene::Node> joint) {
      const auto found = indices.nodes.find(joint);
      return found == indices.nodes.end() ? std::nullopt : std::optional(found->second);
    });
  }
  for (const SkinCopy &copy : copies) {
    add(scene.skins[std::size_t(copy.skin)], [&](Handle<scene::Node> joint) { return copy.index_of(joint); });
  }
  return skins;
}

JsonText animations_json(const scene::Scene &scene, const WrittenIndices &indices, WrittenBuffer &buffer,
                         bool &has_pointers)
{
  AnimationWriter writer(scene, indices, buffer);
  JsonText animations;
  for (const scene::Animation &animation : scene.animations) {
    if (const std::string json = writer.animation_json(animation); !json.empty()) {
      animations.add(json);
    }
  }
  has_pointers = writer.has_pointers;
  return animations;
}

}  // namespace gnomon::gltf
