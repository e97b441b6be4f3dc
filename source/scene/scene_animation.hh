// SPDX-License-Identifier: MIT
#pragma once

#include "scene_handle.hh"
#include "scene_types.hh"

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

/** Animations, skins and morph targets, as glTF 2.0 defines them. Scene::animations and Scene::deformed_meshes. */
namespace gnomon::scene {

/** How a value between two keys is computed (glTF 2.0, appendix C). */
enum class Interpolation { Step, Linear, CubicSpline };

/** Keys of one animated value of \ref width numbers. Immutable after import, and shared between channels. */
struct Track {
  Interpolation interpolation = Interpolation::Linear;
  std::size_t width = 1;
  /** Seconds, at least 0, strictly ascending; not empty. */
  std::vector<float> times;
  /** Finite. width numbers for each key; with CubicSpline 3 · width: the in-tangent, the value and the out-tangent. */
  std::vector<float> values;

  /** The value at \a seconds; before the first and after the last key that key's value. \pre out.size() == width */
  void evaluate(double seconds, std::span<double> out) const;
  /** The same of rotations, as a unit quaternion by the shorter way. \pre width == 4: x, y, z, w */
  [[nodiscard]] glm::dquat evaluate_rotation(double seconds) const;
};

using SharedTrack = std::shared_ptr<const Track>;

/** A node with an animated transform or animated morph weights. Null tracks leave the value below. */
struct AnimatedNode {
  Handle<Node> node{};
  glm::dvec3 translation{0.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 scale{1.0};
  SharedTrack translation_track;
  SharedTrack rotation_track;
  SharedTrack scale_track;
  /** One number for each morph target of the node's meshes. */
  SharedTrack weights_track;
};

/** A property of a material, lamp or camera that can be animated (KHR_animation_pointer). */
enum class AnimatedProperty {
  /** Material::base_color and alpha: 4 numbers. */
  BaseColor,
  Metallic,
  Roughness,
  Emissive,
  AlphaCutoff,
  NormalScale,
  OcclusionStrength,
  LampColor,
  LampIntensity,
  LampRange,
  /** Camera::vertical_angle. */
  VerticalAngle,
  HalfWidth,
  HalfHeight,
};

/** Numbers that a property has in a track. */
[[nodiscard]] std::size_t width_of(AnimatedProperty property);

struct AnimatedValue {
  std::variant<Handle<Material>, Handle<Lamp>, Handle<Camera>> target;
  AnimatedProperty property = AnimatedProperty::BaseColor;
  /** Multiplied with the track's values: the conversion of units. */
  glm::dvec3 factor{1.0};
  SharedTrack track;
};

struct Animation {
  std::string name;
  std::vector<AnimatedNode> nodes;
  std::vector<AnimatedValue> values;

  /** The time of the last key, seconds; 0 without keys. */
  [[nodiscard]] double duration() const;
};

/** The joints of a skinned mesh. */
struct Skin {
  std::string name;
  std::vector<Handle<Node>> joints;
  /** Inverse bind matrices, one for each joint. */
  std::vector<glm::dmat4> joint_from_mesh;
};

/** Differences to the rest shape at weight 1, one for each vertex. Empty: none. */
struct MorphTarget {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec3> tangents;
};

/** The joints of one vertex, by their place in Skin::joints, and their weights. The sum of all weights of a vertex
 * is 1. */
struct JointWeights {
  std::array<std::uint16_t, 4> joints{};
  glm::vec4 weights{0.0F};
};

/**
 * The rest shape of a mesh that morph targets and joints deform. The mesh belongs to one node. Vertices are deformed by
 * linear blend skinning (glTF 2.0, section 3.7.3) on the CPU, once for each pose: shadows, culling, picking and the
 * reference all read the deformed mesh.
 */
struct DeformedMesh {
  Handle<Mesh> mesh{};
  Handle<Node> node{};
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec4> tangents;
  /** The file has no normals: they are those of the deformed triangles, of which no two share a vertex. */
  bool has_flat_normals = false;
  std::vector<MorphTarget> targets;
  /** One for each target. */
  std::vector<double> weights;
  /** Place in Scene::skins; -1: none, and the mesh follows its node. */
  int skin = -1;
  /** joint_sets entries for each vertex, one after the other. */
  std::vector<JointWeights> joint_weights;
  std::size_t joint_sets = 0;
  /** The joints' matrices and the weights of the last deform_meshes(), which skips a mesh where they are the same. */
  std::vector<glm::dmat4> deformed_by_joints;
  std::vector<double> deformed_by_weights;
};

class Scene;

/**
 * Sets all values that \a animation animates to those at \a seconds, and deforms the meshes. Things that were removed
 * are skipped. Values that do not change are no edit.
 */
void pose(Scene &scene, const Animation &animation, double seconds);

/** Sets the morph weights of all meshes of \a node. Missing weights are 0. Call deform_meshes() afterwards. */
void set_morph_weights(Scene &scene, Handle<Node> node, std::span<const double> weights);

/** Deforms the meshes by the joints' matrices and the morph weights. Call it after edits of joints or weights. */
void deform_meshes(Scene &scene);

}  // namespace gnomon::scene
