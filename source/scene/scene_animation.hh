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
#include <string_view>
#include <variant>
#include <vector>

/**
 * Animations, skins and morph targets as defined by glTF 2.0. \see Scene::animations, Scene::skins,
 * Scene::deformed_meshes
 */
namespace gnomon::scene {

/** Interpolation between two keys (glTF 2.0, appendix C). */
enum class Interpolation { Step, Linear, CubicSpline };

/** The keys of one animated value, which consists of `width` numbers. Immutable after import; channels share tracks. */
struct Track {
  Interpolation interpolation = Interpolation::Linear;
  std::size_t width = 1;
  /** Times of the keys in seconds: at least 0, strictly ascending, not empty. */
  std::vector<float> times;
  /**
   * Finite numbers. Step and Linear: `width` for each key. CubicSpline: 3 · `width` for each key, which are the
   * in-tangent, the value and the out-tangent.
   */
  std::vector<float> values;

  /**
   * Compute the value at \a seconds. Before the first key and after the last key, the value is constant.
   * \pre out.size() == width
   */
  void evaluate(double seconds, std::span<double> out) const;
  /**
   * Compute a rotation at \a seconds as a unit quaternion. Linear interpolation is spherical and takes the shorter arc.
   * \pre width == 4: x, y, z, w
   */
  [[nodiscard]] glm::dquat evaluate_rotation(double seconds) const;
};

using SharedTrack = std::shared_ptr<const Track>;

/**
 * A node with an animated transform or animated morph weights. If the track of a transform component is null, the
 * component has the constant value stored here. If `weights_track` is null, the morph weights do not change.
 */
struct AnimatedNode {
  Handle<Node> node{};
  glm::dvec3 translation{0.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 scale{1.0};
  SharedTrack translation_track;
  SharedTrack rotation_track;
  SharedTrack scale_track;
  /** Has one number for each morph target of the node's meshes. */
  SharedTrack weights_track;
};

/** Number of components of a property that can be animated: 4 for base_color, which has alpha as the last one. */
[[nodiscard]] std::size_t width_of(std::string_view property);

/** A property of a material, lamp, camera or node, and the track that animates it. */
struct AnimatedValue {
  std::variant<Handle<Material>, Handle<Lamp>, Handle<Camera>, Handle<Node>> target;
  /** Name of a row of the target with Description::is_animated; "offset", "rotation" or "scale" of a slot. */
  std::string_view property;
  /** TextureInput::name of the slot of a material whose transform is animated; empty: the target itself. */
  std::string_view slot{};
  /** Factors of the first three numbers of the track, for the conversion of units. */
  glm::dvec3 factor{1.0};
  SharedTrack track;
  /**
   * Emission: one number, by which the three of `track` are multiplied; nullptr: 1. A spot's cone: the angle at which
   * the light begins to fade, radians, at most that of `track`; not nullptr.
   */
  SharedTrack second_track{};
};

struct Animation {
  std::string name;
  std::vector<AnimatedNode> nodes;
  std::vector<AnimatedValue> values;

  /** Time of the last key in seconds; 0 if there are no tracks. */
  [[nodiscard]] double duration() const;
};

/** The joints of skinned meshes. */
struct Skin {
  std::string name;
  /** A joint that is not in the scene has a stale or empty handle. */
  std::vector<Handle<Node>> joints;
  /** Inverse bind matrices, one for each joint. */
  std::vector<glm::dmat4> joint_from_mesh;
};

/** Differences from the rest shape at weight 1, one for each vertex. An empty array means no differences. */
struct MorphTarget {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec3> tangents;
};

/** Up to four joints of one vertex and their weights. The weights of all sets of a vertex add up to 1. */
struct JointWeights {
  /** Indices in Skin::joints. */
  std::array<std::uint16_t, 4> joints{};
  glm::vec4 weights{0.0F};
};

/**
 * The rest shape of a mesh that is deformed by morph targets or joints. The joints and weights are those of one node;
 * other nodes may show the deformed mesh, too. Edits of the mesh change the rest shape (Scene::replace). The CPU
 * deforms the vertices once for each pose with linear blend skinning (glTF 2.0, section 3.7.3). Shadows, culling,
 * picking and the reference renderer read the deformed mesh.
 */
struct DeformedMesh {
  Handle<Mesh> mesh{};
  Handle<Node> node{};
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec4> tangents;
  /** true: each vertex has the normal of its deformed triangle. No two triangles may then share a vertex. */
  bool has_flat_normals = false;
  std::vector<MorphTarget> targets;
  /** Current weights, one for each target. */
  std::vector<double> weights;
  /** Index in Scene::skins; -1: the mesh has no skin and moves with its node. */
  int skin = -1;
  /** `joint_sets` consecutive entries for each vertex. */
  std::vector<JointWeights> joint_weights;
  std::size_t joint_sets = 0;
  /**
   * Triangles of the mesh whose second and third index the last deformation has swapped, because the joints mirror
   * them: in the mesh, the front of each triangle agrees with its normals. Empty: none.
   */
  std::vector<bool> reversed_triangles;
  /**
   * Joint matrices and weights of the last deformation; empty: the mesh has its rest shape. deform_meshes() skips the
   * mesh if they are unchanged.
   */
  std::vector<glm::dmat4> deformed_by_joints;
  std::vector<double> deformed_by_weights;
};

/** Name of the row of a spot's cone, whose pose also sets Lamp::spot_blend. */
inline constexpr std::string_view cone_property = "spot_outer_angle";

/** Adds \a value. A factor of emission and its strength become one value. */
void add_value(Animation &animation, AnimatedValue value);

/** Adds what \a other animates. \return false, without a change, if both animate the same thing */
[[nodiscard]] bool join(Animation &animation, const Animation &other);

class Scene;

/**
 * Set all values that \a animation animates to their values at \a seconds, and deform the meshes. Skips nodes,
 * materials, lamps and cameras that were removed. A value that does not change is not an edit of the scene.
 * \throws InvalidEdit as deform_meshes(), before anything changes
 */
void pose(Scene &scene, const Animation &animation, double seconds);

/** Set the morph weights of all meshes of \a node. Missing weights are 0. Call deform_meshes() afterwards. */
void set_morph_weights(Scene &scene, Handle<Node> node, std::span<const double> weights);

/** The indices of \a mesh in the order of the rest shape. \see DeformedMesh::reversed_triangles */
[[nodiscard]] std::vector<std::uint32_t> rest_indices(const Mesh &mesh, const DeformedMesh &deformed);

/**
 * Why \a deformed does not fit its mesh and its skin, so that deform_meshes() throws. Empty if it fits, and if it takes
 * no part in deformations, because its mesh or its node was removed or its mesh is in buffers of a host.
 */
[[nodiscard]] std::string fault_of(const Scene &scene, const DeformedMesh &deformed);

/**
 * Deform all meshes in Scene::deformed_meshes. Call this after joints have moved or weights have changed. Skips meshes
 * that were removed, or that are in buffers of a host. \throws InvalidEdit that names a mesh with the reason of
 * fault_of(), before anything changes; or if a vertex names a joint that its skin does not have, or is deformed beyond
 * the range of float
 */
void deform_meshes(Scene &scene);

}  // namespace gnomon::scene
