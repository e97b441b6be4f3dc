// SPDX-License-Identifier: MIT
#include "internal/gltf_animation.hh"

#include "internal/gltf_accessor.hh"
#include "internal/gltf_node.hh"
#include "internal/gltf_pointer.hh"
#include "internal/gltf_units.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace gnomon::gltf {

using scene::AnimatedNode;
using scene::AnimatedValue;
using scene::Handle;
using scene::Interpolation;
using scene::SharedTrack;
using scene::Track;

namespace {

/**
 * Maximum number of values in all tracks of a file. The size of a file does not limit their number, because accessors
 * without data take no space.
 */
constexpr std::size_t value_count_max = std::size_t(1) << 26U;

/** The target of a channel is in the file and not in the scene, such as a material of another variant. */
struct UnusedTarget : Fault {
  using Fault::Fault;
};

class AnimationImporter {
 public:
  AnimationImporter(const File &file, const ImportedThings &things, Warnings &warnings, scene::Scene &scene)
      : file_(file), things_(things), warnings_(warnings), scene_(scene)
  {
  }

  void import()
  {
    for (std::size_t i = 0; i < file_.model.animations.size(); i++) {
      import_animation(i);
    }
  }

 private:
  using TrackKey = std::tuple<int, int, std::string, std::size_t>;

  const File &file_;
  const ImportedThings &things_;
  Warnings &warnings_;
  scene::Scene &scene_;
  std::map<TrackKey, SharedTrack> tracks_;
  std::size_t value_count_ = 0;

  void import_animation(std::size_t index)
  {
    const Model::Animation &source = file_.model.animations[index];
    const std::string what = label("animation", source.name, index);
    scene::Animation animation;
    animation.name = source.name.empty() ? "animation " + std::to_string(index) : source.name;
    std::map<int, std::size_t> node_places;
    std::set<std::string> targets;
    bool has_fault = false;
    // Such an animation can be played. It moves nothing.
    bool has_unused_target = false;
    for (const Model::AnimationChannel &channel : source.channels) {
      try {
        const std::string target = target_of(channel);
        if (targets.contains(target)) {
          throw Fault("target", "a channel before it has the same");
        }
        import_channel(source, channel, what, node_places, animation);
        if (!target.empty()) {
          targets.insert(target);
        }
      }
      catch (const Fault &fault) {
        warnings_.add_counted(what, 1, std::string("channel left out: ") + fault.what());
        has_fault = true;
        has_unused_target |= dynamic_cast<const UnusedTarget *>(&fault) != nullptr;
      }
    }
    if (!animation.nodes.empty() || !animation.values.empty() || has_unused_target) {
      scene_.animations.push_back(std::move(animation));
    }
    else if (!has_fault) {
      warnings_.add(what, source.channels.empty() ? "has no channels" : "its channels have no target");
    }
  }

  /** One text for all spellings of the target; empty: none, which is valid. */
  static std::string target_of(const Model::AnimationChannel &channel)
  {
    if (!channel.pointer.empty()) {
      const std::optional<PointerParts> parts = parts_of(channel.pointer);
      return parts ? fmt::format("/{}/{}/{}", parts->collection, parts->index, parts->path) : channel.pointer;
    }
    if (channel.path == "pointer") {
      throw Fault("target", "has no pointer");
    }
    return channel.node < 0 ? "" : fmt::format("/nodes/{}/{}", channel.node, channel.path);
  }

  void import_channel(const Model::Animation &source, const Model::AnimationChannel &channel, const std::string &what,
                      std::map<int, std::size_t> &node_places, scene::Animation &animation)
  {
    const Model::AnimationSampler &sampler = source.samplers[std::size_t(channel.sampler)];
    if (channel.pointer.empty()) {
      if (channel.node >= 0) {
        import_node_channel(sampler, channel.node, channel.path, node_places, animation);
      }
      // A channel without a node is valid and ignored, because its target may be defined by an extension.
      return;
    }
    const std::optional<PointerParts> parts = parts_of(channel.pointer);
    if (parts && parts->collection == "nodes" && parts->path == visibility_path) {
      import_visibility_channel(sampler, parts->index, what, animation);
      return;
    }
    if (parts && parts->collection == "meshes" && parts->path == "weights") {
      import_mesh_weights_channel(sampler, parts->index, node_places, animation);
      return;
    }
    if (parts && parts->collection == "materials" && import_transform_channel(sampler, *parts, what, animation)) {
      return;
    }
    if (parts && parts->collection == "nodes") {
      import_node_channel(sampler, parts->index, std::string(parts->path), node_places, animation);
      return;
    }
    const std::optional<scene::Description> property = parts ? animated_property(*parts) : std::nullopt;
    if (property && property->name == scene::cone_property) {
      import_cone_channel(sampler, *parts, *property, what, animation);
      return;
    }
    if (!property) {
      // Only the end says what is not played.
      constexpr std::size_t pointer_size_max = 400;
      throw Fault("pointer", "'" + printable(channel.pointer, pointer_size_max) + "' is not played");
    }
    import_value_channel(sampler, *parts, *property, what, animation);
  }

  /** \a kind, \a index, \a count: what the target is, its place in its array of the file, and the array's size. */
  [[noreturn]] static void fail_without_target(std::string_view kind, int index, std::size_t count)
  {
    // A negative index becomes larger than all sizes.
    if (std::size_t(index) < count) {
      throw UnusedTarget("pointer", "its target is not in the scene");
    }
    throw Fault("pointer", fmt::format("the file has no {} {}", kind, index));
  }

  /** The nodes that show the mesh with the mesh's own weights. */
  void import_mesh_weights_channel(const Model::AnimationSampler &sampler, int mesh,
                                   std::map<int, std::size_t> &node_places, scene::Animation &animation)
  {
    bool has_target = false;
    for (std::size_t i = 0; i < things_.nodes.size(); i++) {
      const Model::Node &node = file_.model.nodes[i];
      if (things_.nodes[i] && node.mesh == mesh && mesh >= 0 && node.weights.empty()) {
        import_node_channel(sampler, int(i), "weights", node_places, animation);
        has_target = true;
      }
    }
    if (!has_target) {
      fail_without_target("mesh", mesh, file_.model.meshes.size());
    }
  }

  void import_visibility_channel(const Model::AnimationSampler &sampler, int node, const std::string &what,
                                 scene::Animation &animation)
  {
    if (std::size_t(node) >= things_.nodes.size() || !things_.nodes[std::size_t(node)]) {
      fail_without_target("node", node, file_.model.nodes.size());
    }
    AnimatedValue value;
    value.target = things_.nodes[std::size_t(node)];
    value.property = "is_visible";
    Model::AnimationSampler steps = sampler;
    if (sampler.interpolation == "LINEAR") {
      warnings_.add(what, "'visible' has no values between two keys: STEP is taken for LINEAR");
      steps.interpolation = "STEP";
    }
    value.track = track(steps, 1, Model::ElementType::Scalar);
    animation.values.push_back(value);
  }

  /** \return false if the pointer is not that of a transform of a texture. */
  bool import_transform_channel(const Model::AnimationSampler &sampler, const PointerParts &parts,
                                const std::string &what, scene::Animation &animation)
  {
    const std::size_t split = parts.path.find(transform_path);
    if (split == parts.path.npos) {
      return false;
    }
    const std::string_view property = parts.path.substr(split + transform_path.size());
    const std::string_view slot_path = parts.path.substr(0, split);
    const auto *const input = std::ranges::find(scene::texture_inputs, slot_path, &scene::TextureInput::path);
    if (input == scene::texture_inputs.end() ||
        (property != "offset" && property != "rotation" && property != "scale")) {
      return false;
    }
    const auto found = things_.materials.find(parts.index);
    if (found == things_.materials.end()) {
      fail_without_target("material", parts.index, file_.model.materials.size());
    }
    const bool has_normals =
        input->slot == &scene::Material::normal_texture || input->slot == &scene::Material::coat_normal_texture;
    if (has_normals && property == "rotation") {
      // Tangents are made from the transform at rest.
      warnings_.add(what,
                    "the image of '" + printable(slot_path) + "' turns, and the directions of its normals do not");
    }
    AnimatedValue value;
    value.target = found->second;
    value.property = property == "offset" ? "offset" : property == "scale" ? "scale" : "rotation";
    value.slot = input->name;
    value.track = property == "rotation" ? track(sampler, 1, Model::ElementType::Scalar)
                                         : track(sampler, 2, Model::ElementType::Vec2);
    animation.values.push_back(value);
    return true;
  }

  /** The property that the pointer animates. */
  static std::optional<scene::Description> animated_property(const PointerParts &parts)
  {
    std::optional<scene::Description> property;
    for_each_animated([&](std::string_view collection, const scene::Description &row) {
      const bool is_it = row.path == parts.path || (row.name == "emissive" && parts.path == strength_path) ||
                         (row.name == scene::cone_property && parts.path == inner_cone_path);
      if (collection == parts.collection && is_it) {
        property = row;
      }
    });
    return property;
  }

  void import_node_channel(const Model::AnimationSampler &sampler, int node, const std::string &path,
                           std::map<int, std::size_t> &node_places, scene::Animation &animation)
  {
    // The index of a pointer may be any number. A negative one becomes larger than all sizes.
    if (std::size_t(node) >= file_.model.nodes.size()) {
      fail_without_target("node", node, file_.model.nodes.size());
    }
    if (!things_.nodes[std::size_t(node)]) {
      throw UnusedTarget("target", "its node is not in the scene");
    }
    const Model::Node &source = file_.model.nodes[std::size_t(node)];
    const auto weight_count = [&] {
      const std::size_t count = source.mesh < 0 || file_.model.meshes[std::size_t(source.mesh)].primitives.empty()
                                    ? 0
                                    : file_.model.meshes[std::size_t(source.mesh)].primitives.front().targets.size();
      if (count == 0) {
        throw Fault("weights", "its node has no morph targets");
      }
      return count;
    };
    AnimatedNode animated;
    if (path == "translation") {
      animated.translation_track = track(sampler, 3, Model::ElementType::Vec3);
    }
    else if (path == "rotation") {
      animated.rotation_track = track(sampler, 4, Model::ElementType::Vec4);
    }
    else if (path == "scale") {
      animated.scale_track = track(sampler, 3, Model::ElementType::Vec3);
    }
    else if (path == "weights") {
      animated.weights_track = track(sampler, weight_count(), Model::ElementType::Scalar);
      if (const auto instances = things_.instances.find(node); instances != things_.instances.end()) {
        for (const Handle<scene::Node> instance : instances->second) {
          AnimatedNode &moved = animation.nodes.emplace_back();
          moved.node = instance;
          moved.weights_track = animated.weights_track;
        }
        return;
      }
    }
    else {
      throw Fault("target", "its path '" + printable(path) + "' is not played");
    }
    const auto [place, is_new] = node_places.try_emplace(node, animation.nodes.size());
    if (is_new) {
      AnimatedNode &rest = animation.nodes.emplace_back();
      rest.node = things_.nodes[std::size_t(node)];
      rest.translation = {source.translation[0], source.translation[1], source.translation[2]};
      rest.scale = {source.scale[0], source.scale[1], source.scale[2]};
      const glm::dvec4 r(source.rotation[0], source.rotation[1], source.rotation[2], source.rotation[3]);
      if (is_rotation(r)) {
        rest.rotation = glm::normalize(glm::dquat(r.w, r.x, r.y, r.z));
      }
    }
    AnimatedNode &target = animation.nodes[place->second];
    for (SharedTrack AnimatedNode::*member : {&AnimatedNode::translation_track, &AnimatedNode::rotation_track,
                                              &AnimatedNode::scale_track, &AnimatedNode::weights_track}) {
      if (animated.*member) {
        target.*member = animated.*member;
      }
    }
  }

  /** One value has both angles of a cone. The one that no channel moves is constant. */
  void import_cone_channel(const Model::AnimationSampler &sampler, const PointerParts &parts,
                           const scene::Description &property, const std::string &what, scene::Animation &animation)
  {
    const SharedTrack moved = track(sampler, 1, Model::ElementType::Scalar);
    const auto found = things_.lamps.find(parts.index);
    if (found == things_.lamps.end()) {
      fail_without_target("light", parts.index, file_.model.lights.size());
    }
    const Model::Light &light = file_.model.lights[std::size_t(parts.index)];
    const auto constant = [](double angle) {
      return std::make_shared<Track>(Track{Interpolation::Step, 1, {0.0F}, {float(angle)}});
    };
    for (const Handle<scene::Lamp> lamp : found->second) {
      if (!property.has_kind(unsigned(scene_.lamps()[lamp].kind))) {
        throw Fault("pointer", "its target has no '" + std::string(parts.path) + "'");
      }
      auto value = std::ranges::find_if(animation.values, [&](const AnimatedValue &one) {
        return one.target == decltype(one.target)(lamp) && one.property == property.name;
      });
      if (value == animation.values.end()) {
        animation.values.push_back({.target = lamp,
                                    .property = property.name,
                                    .track = constant(light.outer_cone_angle),
                                    .second_track = constant(light.inner_cone_angle)});
        value = std::prev(animation.values.end());
      }
      (parts.path == inner_cone_path ? value->second_track : value->track) = moved;
      if (lamp == found->second.front() && parts.path == property.path) {
        warn_of_range(*value, parts, property, what, scene_.lamps()[lamp].name);
      }
    }
  }

  void import_value_channel(const Model::AnimationSampler &sampler, const PointerParts &parts,
                            const scene::Description &property, const std::string &what, scene::Animation &animation)
  {
    constexpr std::array<Model::ElementType, 5> types = {Model::ElementType::Scalar, Model::ElementType::Scalar,
                                                         Model::ElementType::Vec2, Model::ElementType::Vec3,
                                                         Model::ElementType::Vec4};
    AnimatedValue value;
    value.property = property.name;
    // emissiveStrength is one number, which is multiplied by the three numbers of emissiveFactor.
    const bool is_strength = parts.path == strength_path;
    const std::size_t width = is_strength ? 1 : scene::width_of(property.name);
    value.track = track(sampler, width, types[width]);
    const bool is_emissive_factor = property.name == "emissive" && !is_strength;
    const double number_max = is_emissive_factor ? 1.0 : std::numeric_limits<double>::infinity();
    bool has_target = false;
    const auto add = [&]<typename T>(Handle<T> handle, const glm::dvec3 &factor) {
      if constexpr (!std::is_same_v<T, scene::Material>) {
        if (!property.has_kind(unsigned(scene_.pool<T>()[handle].kind))) {
          throw Fault("pointer", "its target has no '" + std::string(parts.path) + "'");
        }
      }
      value.target = handle;
      value.factor = factor;
      if (!has_target) {
        warn_of_range(value, parts, property, what, scene_.pool<T>()[handle].name, number_max);
        value.track = is_emissive_factor ? at_most_one(value.track) : value.track;
      }
      has_target = true;
      scene::add_value(animation, value);
    };
    if (parts.collection == "materials") {
      if (const auto found = things_.materials.find(parts.index); found != things_.materials.end()) {
        const Model::Material &source = file_.model.materials[std::size_t(parts.index)];
        const std::array<double, 4> emissive =
            source.factor("emissive") ? *source.factor("emissive") : std::array<double, 4>{};
        const std::array<double, 4> *const ior = source.factor("ior");
        add(found->second, is_strength                   ? glm::dvec3(emissive[0], emissive[1], emissive[2])
                           : property.name == "emissive" ? glm::dvec3(source.emissive_strength)
                           : property.name == "specular_color" && ior != nullptr
                               ? glm::dvec3(reflectance_ratio(float(valid_ior((*ior)[0]))))
                               : glm::dvec3(1.0));
      }
    }
    else if (parts.collection == "lights") {
      const bool is_intensity = property.name == "intensity";
      if (const auto found = things_.lamps.find(parts.index); found != things_.lamps.end()) {
        for (const Handle<scene::Lamp> lamp : found->second) {
          add(lamp, glm::dvec3(is_intensity ? 1.0 / lumen_per_watt : 1.0));
        }
      }
    }
    else if (const auto found = things_.cameras.find(parts.index); found != things_.cameras.end()) {
      for (const Handle<scene::Camera> camera : found->second) {
        add(camera, glm::dvec3(1.0));
      }
    }
    if (!has_target) {
      // The name of a collection without its plural.
      fail_without_target(parts.collection.substr(0, parts.collection.size() - 1), parts.index,
                          parts.collection == "materials" ? file_.model.materials.size()
                          : parts.collection == "lights"  ? file_.model.lights.size()
                                                          : file_.model.cameras.size());
    }
  }

  /** \a track with keys of at most 1, as a factor that does not move is. Tangents of the others are 0. */
  static SharedTrack at_most_one(const SharedTrack &track)
  {
    auto limited = std::make_shared<Track>(*track);
    const bool is_spline = track->interpolation == Interpolation::CubicSpline;
    for (std::size_t i = 0; i < limited->values.size(); i++) {
      const bool is_tangent = is_spline && i / track->width % 3 != 1;
      if (!is_tangent && limited->values[i] > 1.0F) {
        limited->values[i] = 1.0F;
        if (is_spline) {
          limited->values[i - track->width] = limited->values[i + track->width] = 0.0F;
        }
      }
    }
    return limited->values == track->values ? track : limited;
  }

  /**
   * Names the first value that \a property does not allow, or that is above \a number_max. scene::pose() takes the
   * nearest one that the property allows.
   */
  void warn_of_range(const AnimatedValue &value, const PointerParts &parts, const scene::Description &property,
                     const std::string &what, const std::string &target,
                     double number_max = std::numeric_limits<double>::infinity())
  {
    const Track &track = *value.track;
    const bool is_spline = track.interpolation == Interpolation::CubicSpline;
    for (std::size_t key = 0; key < track.times.size(); key++) {
      for (std::size_t i = 0; i < track.width; i++) {
        // A key of a spline has a tangent before its value, and one after it.
        const double number = track.values[track.width * (is_spline ? 3 * key + 1 : key) + i];
        const double factor = i < 3 ? value.factor[int(i)] : 1.0;
        if (!property.allows(number * factor) || number > number_max) {
          warnings_.add(what, fmt::format("the '{}' of '{}' is {} at {} s, clamped to {}", parts.path,
                                          printable(target), text(number), text(track.times[key]),
                                          text(std::min(property.nearest(number * factor) / factor, number_max))));
          return;
        }
      }
    }
  }

  SharedTrack track(const Model::AnimationSampler &sampler, std::size_t width, Model::ElementType type)
  {
    const auto [place, is_new] =
        tracks_.try_emplace({sampler.input, sampler.output, sampler.interpolation, width}, nullptr);
    if (is_new) {
      place->second = read_track(sampler, width, type);
    }
    if (!place->second) {
      throw Fault("sampler", "cannot be read");
    }
    return place->second;
  }

  SharedTrack read_track(const Model::AnimationSampler &sampler, std::size_t width, Model::ElementType type)
  {
    auto read = std::make_shared<Track>();
    read->width = width;
    read->interpolation = sampler.interpolation == "STEP"          ? Interpolation::Step
                          : sampler.interpolation == "CUBICSPLINE" ? Interpolation::CubicSpline
                                                                   : Interpolation::Linear;
    if (read->interpolation == Interpolation::Linear && sampler.interpolation != "LINEAR") {
      throw Fault("interpolation", "'" + printable(sampler.interpolation) + "' is not one of glTF 2.0");
    }
    const AccessorReader input(file_, sampler.input, Model::ElementType::Scalar);
    const AccessorReader output(file_, sampler.output, type);
    // The morph weights of a key are consecutive scalars.
    const std::size_t elements_of_value = type == Model::ElementType::Scalar ? width : 1;
    const std::size_t parts = read->interpolation == Interpolation::CubicSpline ? 3 : 1;
    if (input.count() == 0 || output.count() / (parts * elements_of_value) != input.count() ||
        output.count() % (parts * elements_of_value) != 0) {
      throw Fault("sampler", "the numbers of times and values do not match");
    }
    value_count_ += input.count() * (1 + parts * width);
    if (value_count_ > value_count_max) {
      throw Fault("animations", "have more than " + std::to_string(value_count_max) + " values");
    }
    for (std::size_t i = 0; i < input.count(); i++) {
      const float seconds = input.scalar(i);
      // The negated comparisons also reject NaN.
      if (!(seconds >= 0.0F) || !std::isfinite(seconds) || (i > 0 && !(seconds > read->times.back()))) {
        throw Fault("sampler", "its times do not ascend from 0, or one is not finite");
      }
      read->times.push_back(seconds);
    }
    for (std::size_t i = 0; i < output.count(); i++) {
      const glm::vec4 value = type == Model::ElementType::Scalar ? glm::vec4(output.scalar(i))
                              : type == Model::ElementType::Vec2 ? glm::vec4(output.vec2(i), 0.0F, 0.0F)
                              : type == Model::ElementType::Vec3 ? glm::vec4(output.vec3(i), 0.0F)
                                                                 : output.vec4(i);
      for (std::size_t k = 0; k < width / elements_of_value; k++) {
        if (!std::isfinite(value[int(k)])) {
          throw Fault("sampler", "a value is not finite");
        }
        read->values.push_back(value[int(k)]);
      }
    }
    return read;
  }
};

}  // namespace

void import_animations(const File &file, const ImportedThings &things, Warnings &warnings, scene::Scene &scene)
{
  AnimationImporter(file, things, warnings, scene).import();
}

}  // namespace gnomon::gltf
