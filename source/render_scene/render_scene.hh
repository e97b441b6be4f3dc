// SPDX-License-Identifier: MIT
#pragma once

#include "render_images.hh"
#include "render_materials.hh"
#include "render_meshes.hh"
#include "render_world.hh"

#include "draw_objects.hh"

#include <span>

/**
 * A scene's resources on one device, shared by all viewports and engines there.
 *
 * Scene edits reach the device in two steps: RenderScene::update compares revisions and needs no device; resources are
 * created and written when a pass that reads them is drawn.
 */
namespace gnomon::render_scene {

/** A mesh at a node, by its index in objects(). */
struct RenderObject {
  scene::Handle<scene::Node> node;
  scene::Handle<scene::Mesh> mesh;
  /** Relative to origin_ws(). */
  scene::Bounds bounds;
  bool casts_shadow = true;
  bool receives_shadow = true;
};

/**
 * Coordinates that reach the device are single precision, and relative to origin_ws(): matrices, lamps and cameras
 * given by this class have it subtracted. Engines call that space world space.
 */
class RenderScene {
 public:
  /** \a scene must outlive this; this must be destroyed before \a device. Both may serve several RenderScenes. */
  RenderScene(gpu::Device &device, const scene::Scene &scene) : device_(device), scene_(scene) {}
  RenderScene(const RenderScene &) = delete;
  RenderScene &operator=(const RenderScene &) = delete;

  /** Take note of all edits of the scene since the last call. Needs no device. Nothing else reads the scene's edits. */
  void update();
  /** Whether update would find nothing. */
  [[nodiscard]] bool is_up_to_date() const
  {
    return seen_ == scene_.revision() && !is_origin_changed_;
  }
  /**
   * Change the origin, metres, world space of the scene; then call update. Every matrix changes with it, so choose one
   * near the view and keep it. origin_near() suggests one.
   */
  void set_origin(const glm::dvec3 &origin_ws)
  {
    is_origin_changed_ |= origin_ws != origin_ws_;
    origin_ws_ = origin_ws;
  }
  [[nodiscard]] const glm::dvec3 &origin_ws() const
  {
    return origin_ws_;
  }

  [[nodiscard]] const scene::Scene &scene() const
  {
    return scene_;
  }
  [[nodiscard]] gpu::Device &device() const
  {
    return device_;
  }
  /** All visible meshes at their nodes. An object's value is its material's place in materials(). */
  [[nodiscard]] draw::ObjectBuffer &objects()
  {
    return objects_;
  }
  /** \pre \a index is of objects(), and live */
  [[nodiscard]] const RenderObject &object(draw::ObjectIndex index) const
  {
    return render_objects_[index];
  }
  /** The box around all objects, relative to origin_ws(). */
  [[nodiscard]] const scene::Bounds &bounds() const
  {
    return bounds_;
  }
  /** All visible lamps, in the order of Scene::placed_lamps. */
  [[nodiscard]] std::span<const scene::PlacedLamp> lamps() const
  {
    return lamps_;
  }
  /** Different after each update that found a lamp changed, added, moved or removed. */
  [[nodiscard]] std::uint64_t lamps_revision() const
  {
    return lamps_revision_;
  }
  /**
   * Different after each update that found a change by which passes must be recorded again: a mesh's shape or material,
   * a material's coverage or textures, an image, a sampler. Objects have a revision of their own.
   */
  [[nodiscard]] std::uint64_t passes_revision() const
  {
    return passes_revision_;
  }
  /** Different after each update that found a factor of a material changed. */
  [[nodiscard]] std::uint64_t materials_revision() const
  {
    return materials_revision_;
  }
  /** The scene's world; nullptr: there is none, or it is black. */
  [[nodiscard]] const std::shared_ptr<const WorldLight> &world() const
  {
    return world_;
  }
  /** Different after each update that found the world changed. */
  [[nodiscard]] std::uint64_t world_revision() const
  {
    return world_revision_;
  }
  /** The camera, relative to origin_ws(). */
  [[nodiscard]] scene::PlacedCamera relative(scene::PlacedCamera camera) const;

  [[nodiscard]] const gpu::Batch &batch(scene::Handle<scene::Mesh> mesh, MeshStreams streams)
  {
    return meshes_.get(device_, scene_.meshes(), mesh, streams);
  }
  /** \a is_color: \see scene::TextureInput. A texture that cannot be drawn is white. */
  [[nodiscard]] Images::Lookup texture(scene::Handle<scene::Texture> texture, bool is_color)
  {
    return images_.get(device_, scene_, texture, is_color);
  }
  [[nodiscard]] const Meshes &meshes() const
  {
    return meshes_;
  }
  [[nodiscard]] const Images &images() const
  {
    return images_;
  }
  [[nodiscard]] const MaterialTable &materials() const
  {
    return materials_;
  }
  /**
   * Write object_block, material_block and, where \a needs_full_materials, full_material_block, as far as they changed.
   * \throws gpu::Error past the device's limits.
   */
  void upload(bool needs_full_materials);

 private:
  /** One node's objects. */
  struct NodeObjects {
    scene::Handle<scene::Node> node;
    std::vector<draw::ObjectIndex> objects;
  };
  void remove_objects(NodeObjects &entry);
  void update_objects();
  void update_node(scene::Handle<scene::Node> handle, const scene::Node &node, bool is_anew);
  void write_object(draw::ObjectIndex &index, scene::Handle<scene::Node> node, scene::Handle<scene::Mesh> mesh);
  void update_lamps();
  void update_revisions();

  gpu::Device &device_;
  const scene::Scene &scene_;
  glm::dvec3 origin_ws_{0.0};
  bool is_origin_changed_ = true;
  /** Scene::revision of the last update. */
  scene::Revision seen_ = 0;
  draw::ObjectBuffer objects_;
  /** By draw::ObjectIndex. */
  std::vector<RenderObject> render_objects_{1};
  /** By Handle::index of the node. */
  std::vector<NodeObjects> node_objects_;
  scene::Bounds bounds_;
  std::vector<scene::PlacedLamp> lamps_;
  std::shared_ptr<const WorldLight> world_;
  std::uint64_t world_revision_ = 0;
  std::uint64_t lamps_revision_ = 0;
  std::uint64_t passes_revision_ = 0;
  std::uint64_t materials_revision_ = 0;
  Meshes meshes_;
  Images images_;
  MaterialTable materials_;
};

/**
 * An origin for a view at \a position_ws: the nearest multiple of a step of 1024 m in each coordinate, and \a current
 * as long as it is within that step of the position, so that a moving camera changes the origin seldom.
 */
[[nodiscard]] glm::dvec3 origin_near(const glm::dvec3 &position_ws, const glm::dvec3 &current);

}  // namespace gnomon::render_scene
