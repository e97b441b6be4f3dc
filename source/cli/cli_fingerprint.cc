// SPDX-License-Identifier: MIT
#include "cli_fingerprint.hh"

#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <fstream>
#include <memory>
#include <type_traits>

namespace gnomon::cli {

namespace {

/** Hashes values in sequence, without padding, whose bytes are undefined. */
class Hasher {
 public:
  Hasher()
  {
    XXH3_64bits_reset(state_.get());
  }
  template <typename T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void add(const T &value)
  {
    add_bytes(&value, sizeof(value));
  }
  template <typename T>
  void add(const std::optional<T> &value)
  {
    add(value.has_value());
    add(value.value_or(T()));
  }
  void add(std::string_view text)
  {
    add(text.size());
    add_bytes(text.data(), text.size());
  }
  template <glm::length_t Length, typename T>
  void add(const glm::vec<Length, T> &value)
  {
    for (glm::length_t i = 0; i < Length; i++) {
      add(value[i]);
    }
  }
  template <typename T>
  void add(const scene::Handle<T> &handle)
  {
    add(bool(handle));
    add(handle.index);
  }
  void add(const glm::dmat4 &value)
  {
    for (int column = 0; column < 4; column++) {
      add(value[column]);
    }
  }
  /** For elements without padding: numbers and vectors of numbers. */
  template <typename T>
  void add(const std::vector<T> &values)
  {
    add(values.size());
    add_bytes(values.data(), values.size() * sizeof(T));
  }
  void add_bytes(const void *bytes, std::size_t size)
  {
    XXH3_64bits_update(state_.get(), bytes, size);
  }
  [[nodiscard]] std::string text() const
  {
    return fmt::format("{:016x}", XXH3_64bits_digest(state_.get()));
  }

 private:
  struct Free {
    void operator()(XXH3_state_t *state) const
    {
      XXH3_freeState(state);
    }
  };
  std::unique_ptr<XXH3_state_t, Free> state_{XXH3_createState()};
};

/** All but extras of other programs, on which no picture depends. */
template <typename Thing>
void add_properties(Hasher &hash, const Thing &thing)
{
  Thing::for_each_property([&](const auto &row) {
    if (row.name != "extras") {
      hash.add(thing.*row.member);
    }
  });
}

void add(Hasher &hash, const scene::Scene &scene, const scene::TextureSlot &slot)
{
  const scene::Texture *texture = scene.textures().find(slot.texture);
  hash.add(texture != nullptr);
  if (!texture) {
    return;
  }
  add_properties(hash, slot);
  hash.add(texture->wrap_u);
  hash.add(texture->wrap_v);
  hash.add(texture->magnified);
  hash.add(texture->minified);
  hash.add(texture->mip);
  hash.add(texture->image.index);
}

void add(Hasher &hash, const scene::Scene &scene, const scene::Material &material)
{
  add_properties(hash, material);
  const scene::SurfaceFunction *function = scene.surface_functions().find(material.surface_function);
  hash.add(function != nullptr);
  if (function) {
    hash.add(function->text);
  }
  for (const scene::TextureInput &input : scene::texture_inputs) {
    add(hash, scene, material.*input.slot);
  }
}

void add(Hasher &hash, const scene::Mesh &mesh)
{
  hash.add(mesh.positions);
  hash.add(mesh.normals);
  hash.add(mesh.uvs);
  hash.add(mesh.second_uvs);
  hash.add(mesh.tangents);
  hash.add(mesh.colors);
  hash.add(mesh.indices);
  hash.add(mesh.topology);
  hash.add(mesh.material);
}

/** The node with its place in the tree, by which animations of other nodes move it, also if it cannot be seen yet. */
void add(Hasher &hash, const scene::Scene &scene, scene::Handle<scene::Node> handle, const scene::Node &node)
{
  hash.add(handle);
  hash.add(scene.parent(handle));
  hash.add(node.parent_from_node);
  hash.add(node.meshes.size());
  for (const scene::Handle<scene::Mesh> mesh : node.meshes) {
    hash.add(mesh);
  }
  hash.add(node.lamp);
  hash.add(node.camera);
  add_properties(hash, node);
}

void add(Hasher &hash, const scene::SharedTrack &track)
{
  hash.add(track != nullptr);
  if (track) {
    hash.add(track->interpolation);
    hash.add(track->width);
    hash.add(track->times);
    hash.add(track->values);
  }
}

void add(Hasher &hash, const scene::Animation &animation)
{
  hash.add(animation.name);
  hash.add(animation.nodes.size());
  for (const scene::AnimatedNode &node : animation.nodes) {
    hash.add(node.node);
    hash.add(node.translation);
    hash.add(glm::dvec4(node.rotation.x, node.rotation.y, node.rotation.z, node.rotation.w));
    hash.add(node.scale);
    for (const scene::SharedTrack *track :
         {&node.translation_track, &node.rotation_track, &node.scale_track, &node.weights_track}) {
      add(hash, *track);
    }
  }
  hash.add(animation.values.size());
  for (const scene::AnimatedValue &value : animation.values) {
    hash.add(value.target.index());
    std::visit([&](const auto &target) { hash.add(target); }, value.target);
    hash.add(value.property);
    hash.add(value.slot);
    hash.add(value.factor);
    add(hash, value.track);
    add(hash, value.second_track);
  }
}

/** The rest shape and its deformations. */
void add(Hasher &hash, const scene::DeformedMesh &deformed)
{
  hash.add(deformed.mesh);
  hash.add(deformed.node);
  hash.add(deformed.positions);
  hash.add(deformed.normals);
  hash.add(deformed.tangents);
  hash.add(deformed.has_flat_normals);
  hash.add(deformed.weights);
  hash.add(deformed.targets.size());
  for (const scene::MorphTarget &target : deformed.targets) {
    hash.add(target.positions);
    hash.add(target.normals);
    hash.add(target.tangents);
  }
  hash.add(deformed.skin);
  hash.add(deformed.joint_sets);
  hash.add(deformed.joint_weights.size());
  for (const scene::JointWeights &weights : deformed.joint_weights) {
    for (const std::uint16_t joint : weights.joints) {
      hash.add(joint);
    }
    hash.add(weights.weights);
  }
}

}  // namespace

std::string scene_fingerprint(const scene::Scene &scene)
{
  Hasher hash;
  for (const std::size_t count : {scene.images().size(), scene.materials().size(), scene.meshes().size(),
                                  scene.lamps().size(), scene.cameras().size(), scene.nodes().size(),
                                  scene.animations.size(), scene.skins.size(), scene.deformed_meshes.size()}) {
    hash.add(count);
  }
  for (const auto &[handle, image] : scene.images()) {
    hash.add(image.width);
    hash.add(image.height);
    hash.add(image.texels);
  }
  for (const auto &[handle, material] : scene.materials()) {
    hash.add(handle);
    add(hash, scene, material);
  }
  for (const auto &[handle, mesh] : scene.meshes()) {
    hash.add(handle);
    add(hash, mesh);
  }
  for (const auto &[handle, lamp] : scene.lamps()) {
    hash.add(handle);
    add_properties(hash, lamp);
    add_properties(hash, lamp.shadow);
  }
  for (const auto &[handle, camera] : scene.cameras()) {
    hash.add(handle);
    add_properties(hash, camera);
  }
  for (const auto &[handle, node] : scene.nodes()) {
    add(hash, scene, handle, node);
  }
  if (const std::optional<scene::World> &world = scene.world()) {
    add_properties(hash, *world);
    if (world->picture) {
      hash.add(world->picture->width);
      hash.add(world->picture->texels);
    }
  }
  for (const scene::Animation &animation : scene.animations) {
    add(hash, animation);
  }
  for (const scene::Skin &skin : scene.skins) {
    hash.add(skin.joints.size());
    for (const scene::Handle<scene::Node> joint : skin.joints) {
      hash.add(joint);
    }
    for (const glm::dmat4 &matrix : skin.joint_from_mesh) {
      hash.add(matrix);
    }
  }
  for (const scene::DeformedMesh &deformed : scene.deformed_meshes) {
    add(hash, deformed);
  }
  return hash.text();
}

std::string text_fingerprint(std::string_view text)
{
  Hasher hash;
  hash.add(text);
  return hash.text();
}

std::string program_fingerprint()
{
  return file_fingerprint("/proc/self/exe");
}

std::string file_fingerprint(const std::filesystem::path &path)
{
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return "";
  }
  Hasher hash;
  std::array<char, 1 << 16> bytes;
  while (file.read(bytes.data(), bytes.size()) || file.gcount() > 0) {
    hash.add_bytes(bytes.data(), std::size_t(file.gcount()));
  }
  return hash.text();
}

}  // namespace gnomon::cli
