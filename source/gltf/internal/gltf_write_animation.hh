// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_write_buffer.hh"
#include "internal/gltf_write_json.hh"
#include "internal/gltf_write_skin_copy.hh"
#include "scene.hh"

#include <functional>
#include <map>
#include <string>
#include <vector>

/** Animations and skins. Internal to source/gltf. */
namespace gnomon::gltf {

/** Indices of the scene's things in the file. Things that are not written have none. */
struct WrittenIndices {
  std::map<scene::Handle<scene::Node>, int> nodes;
  /** Further nodes of the file that are moved as a node is: copies of joints. */
  std::multimap<scene::Handle<scene::Node>, int> moved_copies;
  /** Further nodes of the file that show the meshes of a node with its morph weights. */
  std::multimap<scene::Handle<scene::Node>, int> morphed_copies;
  std::map<scene::Handle<scene::Camera>, int> cameras;
  std::map<scene::Handle<scene::Lamp>, int> lights;
  std::map<scene::Handle<scene::Material>, int> materials;
};

/** The nodes whose transforms animations of \a scene move. */
[[nodiscard]] std::map<scene::Handle<scene::Node>, const scene::AnimatedNode *> moved_nodes(const scene::Scene &scene);

/**
 * Adds the members translation, rotation and scale, because glTF allows no matrix for nodes that an animation moves.
 * \a matrix: without shear, as scene::pose sets it; shear is lost. \a moved: its rotation is written if a scale is 0,
 * and its signs of the scale if they fit. \throws Fault that names \a what
 */
void add_transform(const glm::dmat4 &matrix, const scene::AnimatedNode &moved, const std::string &what, JsonText &json);

/**
 * The skins, in the order of Scene::skins, and those of \a copies behind them. A removed joint is a node that is in no
 * scene; \a nodes gets it. \throws Fault that names the skin
 */
[[nodiscard]] JsonText skins_json(const scene::Scene &scene, const WrittenIndices &indices,
                                  const std::vector<SkinCopy> &copies, JsonText &nodes, WrittenBuffer &buffer);

/**
 * The animations, without channels whose target is not written. \a has_pointers: set to true if one needs
 * KHR_animation_pointer. \throws Fault that names the animation
 */
[[nodiscard]] JsonText animations_json(const scene::Scene &scene, const WrittenIndices &indices, WrittenBuffer &buffer,
                                       bool &has_pointers);

}  // namespace gnomon::gltf
