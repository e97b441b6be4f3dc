// SPDX-License-Identifier: MIT
#pragma once

#include "render_images.hh"
#include "render_meshes.hh"

#include "draw_objects.hh"

#include <memory>
#include <optional>
#include <span>

/**
 * The resources of a scene on one device. All viewports and engines on the device share them.
 *
 * Scene edits reach the device in two steps: RenderScene::update finds the changes by comparing revisions and frees the
 * resources of removed meshes and images. Resources are created and written when a pass needs them.
 */
namespace gnomon::render_scene {

class MaterialTable;
struct WorldLight;

/** The kinds of surface inputs, with the fewest inputs first. Each class has its own shader variants. */
enum class MaterialClass : std::uint8_t {
  /** Only the factors of the material. */
  Plain,
  /** Also a base colour texture, with the first set of uvs and without a uv transform. */
  BaseColor,
  /** The textures of FullMaterialData, both sets of uvs, uv transforms, vertex colours, blending, surface functions. */
  Full,
  /** Also a coat, sheen or anisotropy, with their textures. */
  Layered,
  /** Also transmission, with its textures. */
  Transmissive
};

/** A mesh at a node. \see RenderScene::object */
struct RenderObject {
  scene::Handle<scene::Node> node;
  scene::Handle<scene::Mesh> mesh;
  /** Relative to origin_ws(). */
  scene::Bounds bounds;
  bool casts_shadow = true;
  bool receives_shadow = true;
};

/**
 * The resources of a scene on one device, and the scene's objects, lamps and world for engines.
 *
 * The device uses single-precision coordinates relative to origin_ws(). The matrices, bounds, lamps and cameras that
 * this class returns are relative to this origin. Engines call this space world space.
 *
 * Threads: one thread at a time uses this object. No thread may edit the scene meanwhile.
 */
class RenderScene {
 public:
  /**
   * \a scene must outlive this object, and this object must be destroyed before \a device. A scene or a device may be
   * used by several RenderScenes.
   */
  RenderScene(gpu::Device &device, const scene::Scene &scene);
  ~RenderScene();
  RenderScene(const RenderScene &) = delete;
  RenderScene &operator=(const RenderScene &) = delete;

  /** Update objects, lamps, materials and revisions for all edits of the scene since the last call. */
  void update();
  /** Whether the scene, the origin and the host's resources are unchanged since the last update(). */
  [[nodiscard]] bool is_up_to_date() const
  {
    return seen_ == scene_.revision() && !is_origin_changed_ && !has_host_calls_;
  }
  /**
   * Set the origin, in metres and the scene's world space, and call update() afterwards. A new origin changes all
   * matrices, so choose an origin near the view and keep it while possible. \see origin_near
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

  /**
   * Draw the mesh \a handle from buffers that the host has on the device, without a copy. Before the first call, and
   * after a call with std::nullopt, the mesh is not drawn. Call it again after the content of the buffers has changed:
   * shadows are then drawn again, and pictures restart. If \a batch is the same, nothing else is done.
   *
   * Takes effect with the next update(). Functions that update(), sync or draw may use the old names until all
   * viewports are synced after it, so the buffers must live until then, and until the submission of packets that were
   * recorded before. Removal of the mesh from the scene takes the buffers back, too. Call it on the thread of update().
   *
   * \throws scene::StaleHandle
   * \throws gpu::Error if \a batch is present and the mesh has no Mesh::host_shape. Nothing changes then. Errors in the
   * buffers, such as a wrong size, are thrown by the sync or draw that first uses them; during a recording, by the
   * submission of its packet.
   */
  void set_host_batch(scene::Handle<scene::Mesh> handle, const std::optional<gpu::HostBatch> &batch);
  /**
   * Look up the image \a handle in a texture that the host has on the device, without a copy. After a call with
   * std::nullopt, the image's own texels are looked up. Otherwise as set_host_batch.
   *
   * v = 0 is the first row of the texture, which is the lowest one of a picture that OpenGL has drawn;
   * scene::TextureSlot can turn it. For colours, the texture must have an sRGB format, or linear values; for data
   * (scene::TextureInput), no sRGB format. Image::texels stand for the texture where the CPU reads them: in the
   * reference, light of emissive surfaces and files, and for Image::is_opaque.
   *
   * \throws scene::StaleHandle
   */
  void set_host_texture(scene::Handle<scene::Image> handle, const std::optional<gpu::HostTexture> &texture);

  [[nodiscard]] const scene::Scene &scene() const
  {
    return scene_;
  }
  [[nodiscard]] gpu::Device &device() const
  {
    return device_;
  }
  /** The visible meshes at their nodes. The value of an object is the index of its material in materials(). */
  [[nodiscard]] draw::ObjectBuffer &objects()
  {
    return objects_;
  }
  [[nodiscard]] const draw::ObjectBuffer &objects() const
  {
    return objects_;
  }
  /** The mesh and node of an object. \pre objects().is_live(index), and not object_identity */
  [[nodiscard]] const RenderObject &object(draw::ObjectIndex index) const
  {
    return render_objects_[index];
  }
  /** Whether lamps light the object with their shadows. \pre as object() */
  [[nodiscard]] bool is_shadow_receiver(draw::ObjectIndex index) const;
  /**
   * The objects that a viewport leaves out, for draw::View::with_hidden: those of the nodes \a hidden and their
   * descendants; and, unless \a isolated is empty, all that are not of \a isolated or their descendants. Nodes that
   * were removed are skipped, so that removed \a isolated nodes leave nothing to show. Objects are those of the last
   * update(): call it for each view after an update.
   */
  [[nodiscard]] draw::ObjectSet hidden_objects(std::span<const scene::Handle<scene::Node>> hidden,
                                               std::span<const scene::Handle<scene::Node>> isolated = {}) const;
  /** Bounding box of all objects, relative to origin_ws(). */
  [[nodiscard]] const scene::Bounds &bounds() const
  {
    return bounds_;
  }
  /** The visible lamps in the order of Scene::placed_lamps, relative to origin_ws(). */
  [[nodiscard]] std::span<const scene::PlacedLamp> lamps() const
  {
    return lamps_;
  }
  /** Increases when update() finds a change that a picture may show: one of those of the following revisions. */
  [[nodiscard]] std::uint64_t revision() const
  {
    return objects_.revision() + lamps_revision_ + passes_revision_ + materials_revision_ + content_revision_;
  }
  /** Increases when update() finds that a lamp or the world has changed. */
  [[nodiscard]] std::uint64_t lamps_revision() const
  {
    return lamps_revision_;
  }
  /**
   * Increases when update() finds a change after which passes must be built again: the layout or material of a mesh,
   * the coverage or textures of a material, an image, a surface function, the settings of a texture, whether an object
   * casts or receives shadows, vertex streams on the device, or names, layouts and sizes of the host's resources.
   * Other changes of objects: \see draw::ObjectBuffer::revision
   */
  [[nodiscard]] std::uint64_t passes_revision() const
  {
    return passes_revision_;
  }
  /**
   * Increases when update() finds that vertices of a mesh have other values, or that resources of the host may have
   * other content.
   */
  [[nodiscard]] std::uint64_t content_revision() const
  {
    return content_revision_;
  }
  /** Increases when update() finds that a factor of a material has changed. */
  [[nodiscard]] std::uint64_t materials_revision() const
  {
    return materials_revision_;
  }
  /** The light of the scene's world; nullptr if the scene has no world or the world is black. */
  [[nodiscard]] const std::shared_ptr<const WorldLight> &world() const
  {
    return world_;
  }
  /** Increases when update() finds that the world has changed. */
  [[nodiscard]] std::uint64_t world_revision() const
  {
    return world_revision_;
  }
  /** Returns \a camera with its position relative to origin_ws(). */
  [[nodiscard]] scene::PlacedCamera relative(scene::PlacedCamera camera) const;
  /** Planes of the scene's world space, for draw::View::with_clip_planes. */
  [[nodiscard]] std::vector<glm::vec4> relative(std::span<const glm::dvec4> planes_ws) const;

  /** \see Meshes::get */
  [[nodiscard]] const gpu::Batch &batch(scene::Handle<scene::Mesh> mesh, MeshStreams streams)
  {
    return meshes_.get(device_, scene_, mesh, streams);
  }
  /** \see Images::get */
  [[nodiscard]] Images::Lookup texture(scene::Handle<scene::Texture> texture, scene::ImageUse use,
                                       float mask_cutoff = 0.0F)
  {
    return images_.get(device_, scene_, texture, use, mask_cutoff);
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
    return *materials_;
  }
  /**
   * Write the changed parts of `object_block`, of meshes and of the blocks of materials. \see MaterialTable::upload
   * \throws gpu::Error if a block exceeds the limit of the device
   */
  void upload(MaterialClass widest);

 private:
  /** The objects of one node, as a list. */
  struct NodeObjects {
    scene::Handle<scene::Node> node;
    /** object_identity: the node has no objects. */
    draw::ObjectIndex first = draw::object_identity;
  };
  /** Whether the node's objects show the meshes `shown_`. */
  [[nodiscard]] bool has_shown(const NodeObjects &entry, scene::Handle<scene::Node> node) const;
  void remove_objects(NodeObjects &entry);
  /** By object index: 1 for the objects of \a nodes and their descendants. */
  [[nodiscard]] std::vector<std::uint8_t> flags_of(std::span<const scene::Handle<scene::Node>> nodes) const;
  void update_objects();
  void update_node(scene::Handle<scene::Node> handle, const scene::Node &node, bool is_anew);
  /** \a index: the object to change; object_identity adds an object. \return the index of the object */
  draw::ObjectIndex write_object(draw::ObjectIndex index, scene::Handle<scene::Node> handle, const scene::Node &node,
                                 scene::Handle<scene::Mesh> mesh);
  void update_lamps();
  void update_revisions();

  gpu::Device &device_;
  const scene::Scene &scene_;
  glm::dvec3 origin_ws_{0.0};
  bool is_origin_changed_ = true;
  /** set_host_batch or set_host_texture was called since the last update. */
  bool has_host_calls_ = false;
  /** The changes that the current update() has found. */
  HostChanges host_batch_changes_;
  HostChanges host_texture_changes_;
  /** An object casts or receives shadows, and did not before, or the reverse. */
  bool are_flags_changed_ = false;
  std::uint64_t content_revision_ = 0;
  /** Scene::revision of the last update. */
  scene::Revision seen_ = 0;
  draw::ObjectBuffer objects_;
  /** Indexed by draw::ObjectIndex. */
  std::vector<RenderObject> render_objects_{1};
  /** Indexed by draw::ObjectIndex: the next object of the same node; object_identity: it is the last. */
  std::vector<draw::ObjectIndex> next_of_node_{draw::object_identity};
  /** Indexed by Handle::index of the node. */
  std::vector<NodeObjects> node_objects_;
  /** Temporary memory of update_node. */
  std::vector<scene::Handle<scene::Mesh>> shown_;
  scene::Bounds bounds_;
  std::vector<scene::PlacedLamp> lamps_;
  std::shared_ptr<const WorldLight> world_;
  std::uint64_t world_revision_ = 0;
  std::uint64_t lamps_revision_ = 0;
  std::uint64_t passes_revision_ = 0;
  std::uint64_t materials_revision_ = 0;
  Meshes meshes_;
  Images images_;
  std::unique_ptr<MaterialTable> materials_;
};

/**
 * An origin for a view at \a position_ws. Returns \a current while each coordinate of the position is within a step of
 * it, so that a moving camera rarely changes the origin. Otherwise each coordinate is the nearest multiple of the step.
 * The step is 1024 m, or, if that is less, the largest power of two up to 256 times the radius of \a bounds_ws, the
 * bounds of a scene with any origin.
 */
[[nodiscard]] glm::dvec3 origin_near(const glm::dvec3 &position_ws, const glm::dvec3 &current,
                                     const scene::Bounds &bounds_ws);

}  // namespace gnomon::render_scene
