// SPDX-License-Identifier: MIT
#pragma once

#include "scene_animation.hh"
#include "scene_pool.hh"
#include "scene_types.hh"
#include "scene_world.hh"

#include <concepts>
#include <unordered_map>

namespace gnomon::scene {

/** Thrown for an invalid value or edit. The message names the thing and the reason. */
struct InvalidEdit : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

struct PosedVertices;

/** A mesh at a node, as engines draw it. */
struct Object {
  Handle<Node> node{};
  Handle<Mesh> mesh{};
  glm::dmat4 world_from_object{1.0};
};

/** A lamp at a node. The base class has the values of the lamp. */
struct PlacedLamp : Lamp {
  Handle<Node> node{};
  /** frame_of the node's world matrix: right-handed and orthonormal. */
  glm::dmat4 world_from_lamp{1.0};
  /** Spot, area lamp: lengths of the node's axes in world space. Other lamps: 1. */
  glm::dvec3 scale{1.0};

  bool operator==(const PlacedLamp &) const = default;
};

/**
 * Half the extent of an area lamp along the x and y axes of PlacedLamp::world_from_lamp, metres. (0, 0) if the lamp has
 * no area: an axis of its node has no length, or a half extent is below 1e-9 m or above 1e9 m. \pre an area lamp
 */
[[nodiscard]] glm::dvec2 area_half_size(const PlacedLamp &lamp);
/** Area of the rectangle or ellipse of an area lamp, m². \see area_half_size */
[[nodiscard]] double area_of(const PlacedLamp &lamp);

/**
 * Stretch of a spot's cone along the x and y axes of PlacedLamp::world_from_lamp: the half width of the cone at
 * distance 1 is this factor times the tangent of Lamp::spot_outer_angle. Each factor is the ratio of the node's scale
 * along that axis to its scale along z, in [0.001, 1000]. Both are 1 if an axis of the node has no length. \pre a spot
 */
[[nodiscard]] glm::dvec2 spot_scale(const PlacedLamp &lamp);

/** Lamp::spot_blend of a cone that begins to fade at the half angle \a inner, which is at most \a outer; radians. */
[[nodiscard]] double spot_blend(double inner, double outer);

/** A camera at a node. The base class has the values of the camera. */
struct PlacedCamera : Camera {
  Handle<Node> node{};
  /** Right-handed and orthonormal, as PlacedLamp::world_from_lamp. */
  glm::dmat4 world_from_camera{1.0};
};

/**
 * The rotation and position of \a world without its scale, shear and mirroring: a right-handed orthonormal frame that
 * keeps the direction of -Z exactly, and the direction of +Y as closely as possible. Axes of length 0 are replaced.
 */
[[nodiscard]] glm::dmat4 frame_of(const glm::dmat4 &world);
/** Lengths of the axes of \a world. Finite for every finite matrix. */
[[nodiscard]] glm::dvec3 scale_of(const glm::dmat4 &world);

/**
 * An editable scene: nodes, meshes, images, textures, surface functions, materials, lamps and cameras, each identified
 * by a Handle.
 *
 * World space is right-handed, in metres. The file or the host chooses which axis points up. Matrices are named
 * target_from_source.
 *
 * Every edit gives the changed aspects a new revision. A consumer compares them with the revisions that it has already
 * processed, and repeats only the dependent work. Setting an equal value changes nothing. Constructing, copying, moving
 * and assigning a scene are edits of all that it holds, so that a consumer that keeps a reference to it, such as a
 * renderer, shows the new content. A scene that was moved from can be assigned and destroyed.
 *
 * Removing a thing does not edit the things that refer to it: their handles become stale and are treated as absent, or
 * as the default material. stale_references() lists them. restore() undoes a removal: the handles are valid again.
 *
 * Threads: reading is safe from several threads; an edit needs exclusive access.
 */
class Scene {
 public:
  /** Path of the file as given by the user, for messages. */
  std::string path;
  /** The files that the importer has read, or that its file names: its own, buffers, images, pictures, functions. */
  std::vector<std::string> files{};
  /** Extras of other programs, of the file and of its scene, as extras_sentence says. */
  std::string file_extras{};
  std::string extras{};
  /** Whether the importer added a camera or a lamp because the file has none. */
  bool is_camera_default = false;
  bool is_lamp_default = false;
  /**
   * The studio that a program has set as the world of a file without lamps and world (scene_studio.hh). The exporter
   * leaves it out, unless the scene has another world or a lamp by now.
   */
  std::optional<World> default_world{};
  /** Import warnings. Each names the element and the reason. */
  std::vector<std::string> warnings{};
  /** The warnings that name a limit of the import: because of it, the picture lacks something that the file has. */
  std::vector<std::string> limits{};
  /** Played by pose(). */
  std::vector<Animation> animations{};
  std::vector<Skin> skins{};
  std::vector<DeformedMesh> deformed_meshes{};

  [[nodiscard]] const Pool<Node> &nodes() const
  {
    return nodes_;
  }
  [[nodiscard]] const Pool<Mesh> &meshes() const
  {
    return meshes_;
  }
  [[nodiscard]] const Pool<Image> &images() const
  {
    return images_;
  }
  [[nodiscard]] const Pool<Texture> &textures() const
  {
    return textures_;
  }
  [[nodiscard]] const Pool<SurfaceFunction> &surface_functions() const
  {
    return surface_functions_;
  }
  [[nodiscard]] const Pool<Material> &materials() const
  {
    return materials_;
  }
  [[nodiscard]] const Pool<Lamp> &lamps() const
  {
    return lamps_;
  }
  [[nodiscard]] const Pool<Camera> &cameras() const
  {
    return cameras_;
  }

  /**
   * The meshes, lamps and cameras of all visible nodes, in the order of the nodes. Stale handles are left out. Each
   * call makes a copy in linear time: keep the result instead of calling it for single elements.
   */
  [[nodiscard]] std::vector<Object> objects() const;
  [[nodiscard]] std::vector<PlacedLamp> placed_lamps() const;
  /** Includes the cameras of invisible nodes. */
  [[nodiscard]] std::vector<PlacedCamera> placed_cameras() const;
  /** The material of a mesh; the default material if the mesh's handle is stale or invalid. */
  [[nodiscard]] const Material &material_of(const Mesh &mesh) const;
  /** The box around all objects in world space; empty if there are no objects. */
  [[nodiscard]] Bounds bounds() const;
  /** One line for each reference to a thing that was removed: "node 'a': its lamp was removed". */
  [[nodiscard]] std::vector<std::string> stale_references() const;

  /** Product of all matrices from the root to \a node. \throws StaleHandle, as do the functions below. */
  [[nodiscard]] const glm::dmat4 &world_from_node(Handle<Node> node) const;
  /** Node::is_visible of the node and of all its ancestors. */
  [[nodiscard]] bool is_visible(Handle<Node> node) const;
  /** These return an invalid handle for a root, for a node without children, and for the last child. */
  [[nodiscard]] Handle<Node> parent(Handle<Node> node) const;
  [[nodiscard]] Handle<Node> first_child(Handle<Node> node) const;
  [[nodiscard]] Handle<Node> next_sibling(Handle<Node> node) const;

  /** Revision of the last edit, or of the construction or assignment of the scene if that is later. Above 0. */
  [[nodiscard]] Revision revision() const
  {
    return first_revision_.or_later(revision_);
  }

  /** The light of distant surroundings; std::nullopt: there is none. */
  [[nodiscard]] const std::optional<World> &world() const
  {
    return world_;
  }
  /** Revision of the last change of the world. */
  [[nodiscard]] Revision world_revision() const
  {
    return first_revision_.or_later(world_revision_);
  }
  /** \throws InvalidEdit with the reason of fault_of; nothing changes. */
  void set_world(std::optional<World> world);

  /** Adds a thing. \throws InvalidEdit if the value is invalid; the scene is then unchanged. */
  Handle<Mesh> add(Mesh mesh);
  Handle<Image> add(Image image);
  Handle<Texture> add(const Texture &texture);
  Handle<SurfaceFunction> add(SurfaceFunction function);
  Handle<Material> add(Material material);
  Handle<Lamp> add(Lamp lamp);
  Handle<Camera> add(Camera camera);
  /** Adds the node as the last child of \a parent, or as a root if \a parent is an invalid handle. */
  Handle<Node> add(Node node, Handle<Node> parent = {});
  /** Avoids copies while \a count nodes are added. */
  void reserve_nodes(std::size_t count);

  /**
   * Sets a thing's value. \throws StaleHandle or InvalidEdit; the scene is then unchanged.
   *
   * For a mesh in deformed_meshes, \a mesh is the deformed shape: the rest shape changes so that the current joints and
   * weights deform it to \a mesh. With another number of positions, it no longer fits its rest shape; pose() then
   * throws until the host replaces the entry of deformed_meshes, or removes it.
   */
  void replace(Handle<Mesh> handle, Mesh mesh);
  void replace(Handle<Image> handle, Image image);
  void replace(Handle<Texture> handle, const Texture &texture);
  void replace(Handle<SurfaceFunction> handle, SurfaceFunction function);
  void replace(Handle<Material> handle, Material material);
  void replace(Handle<Lamp> handle, Lamp lamp);
  void replace(Handle<Camera> handle, Camera camera);
  void replace(Handle<Node> handle, Node node);

  /**
   * Changes a thing: `scene.edit(lamp, [](scene::Lamp &lamp) { lamp.intensity = 2.0F; })`. Copies the value, changes
   * the copy and replaces the thing; prefer replace() for large meshes and images.
   */
  template <typename T, std::invocable<T &> Change>
  void edit(Handle<T> handle, Change &&change)
  {
    T value = pool<T>()[handle];
    change(value);
    replace(handle, std::move(value));
  }
  /**
   * Sets the values of some vertices, as a brush of an editor does. The time depends on their number, as does what
   * renderers upload: all of the runs of 64 vertices that contain changed ones. The first call for a mesh, and each
   * call for one of deformed_meshes, takes time for all of its vertices.
   *
   * Normals and tangents follow positions only where \a values has them, too.
   * \throws StaleHandle; InvalidEdit for a vertex that the mesh does not have, a vector of another length or one that
   * is empty in the mesh, a value that is not finite, and a colour out of range. The scene is then unchanged.
   */
  void set_vertices(Handle<Mesh> mesh, const VertexValues &values);
  /**
   * The vertices of a mesh whose values may have changed after the revision \a since of Mesh::Aspect::Shape, in
   * ascending order. \pre the Layout has not changed since. \throws StaleHandle
   */
  [[nodiscard]] std::vector<VertexRange> changed_vertices(Handle<Mesh> mesh, Revision since) const;
  /**
   * Sets Node::parent_from_node without copying the node. \throws StaleHandle; InvalidEdit if the matrix is not affine
   * or has a value beyond ±1e12. The scene is then unchanged.
   */
  void set_transform(Handle<Node> node, const glm::dmat4 &parent_from_node);
  /**
   * Makes \a node, with its descendants, the last child of \a parent, or a root if \a parent is an invalid handle. Its
   * local transform is kept. \throws InvalidEdit if \a parent is \a node or one of its descendants.
   */
  void set_parent(Handle<Node> node, Handle<Node> parent);

  /**
   * Adds a removed thing again, with any value, under its old handle. References to it are valid again. \throws
   * InvalidEdit if the value is invalid, if the scene never had the thing or has it, or if another thing has its index:
   * undo additions that followed the removal first. The scene is then unchanged.
   */
  template <typename T>
  requires(!std::same_as<T, Node>) void restore(Handle<T> handle, T value);
  /**
   * Adds a removed node again, as a child of \a parent before the child \a next. If \a next is an invalid handle, it is
   * the last child; if \a parent is one, it is a root. \throws StaleHandle; InvalidEdit if \a next is not a child of \a
   * parent.
   */
  void restore(Handle<Node> handle, Node node, Handle<Node> parent = {}, Handle<Node> next = {});

  /** Removes a thing. All copies of its handle become stale. \throws StaleHandle */
  template <typename T>
  void remove(Handle<T> handle)
  {
    pool<T>()[handle];
    if constexpr (std::same_as<T, Node>) {
      remove_subtree(handle);
    }
    else {
      writable_pool<T>().remove(handle, edited());
    }
    if constexpr (std::same_as<T, Mesh>) {
      vertex_blocks_.erase(handle);
    }
  }

  /** The pool of a type of thing, for generic code. */
  template <typename T>
  [[nodiscard]] const Pool<T> &pool() const
  {
    return const_cast<Scene *>(this)->writable_pool<T>();
  }

 private:
  /** Links and derived values of a node, by Handle::index. */
  struct NodeLinks {
    Handle<Node> parent;
    Handle<Node> first_child;
    Handle<Node> last_child;
    Handle<Node> previous_sibling;
    Handle<Node> next_sibling;
    glm::dmat4 world_from_node{1.0};
    bool is_visible = true;
  };

  /** Vertices of a mesh that follow each other, at most vertex_block_size. */
  struct VertexBlock {
    Bounds bounds;
    /** Revision of the last set_vertices() that changed one of them; 0: none did. */
    Revision revision = 0;
  };
  static constexpr std::size_t vertex_block_size = 64;
  /** All vertices of a mesh. */
  struct VertexBlocks {
    /** Revision of the last change of the shape by another call than set_vertices(). */
    Revision shape = 0;
    std::vector<VertexBlock> blocks;
  };

  template <typename T>
  Pool<T> &writable_pool()
  {
    if constexpr (std::same_as<T, Node>) {
      return nodes_;
    }
    else if constexpr (std::same_as<T, Mesh>) {
      return meshes_;
    }
    else if constexpr (std::same_as<T, Image>) {
      return images_;
    }
    else if constexpr (std::same_as<T, Texture>) {
      return textures_;
    }
    else if constexpr (std::same_as<T, SurfaceFunction>) {
      return surface_functions_;
    }
    else if constexpr (std::same_as<T, Material>) {
      return materials_;
    }
    else if constexpr (std::same_as<T, Lamp>) {
      return lamps_;
    }
    else {
      static_assert(std::same_as<T, Camera>);
      return cameras_;
    }
  }
  /** Calls \a visit with the node, the mesh and the world matrix of each of objects(). */
  template <typename Visit>
  void for_each_object(const Visit &visit) const;
  friend void deform_meshes(Scene &scene);
  /** Begins an edit. \return its revision */
  Revision edited()
  {
    return revision_ = next_revision();
  }
  template <typename T>
  Handle<T> add_value(T value);
  template <typename T>
  void replace_value(Handle<T> handle, T value);
  template <typename T>
  void restore_value(Handle<T> handle, T value);
  /** Sets what a pose changes of a mesh in deformed_meshes, whose rest shape does not change. \throws InvalidEdit */
  void set_posed(Handle<Mesh> handle, PosedVertices posed);
  void remove_subtree(Handle<Node> node);
  /** \a next: the child of \a parent that follows; an invalid handle: none. */
  void link(Handle<Node> node, Handle<Node> parent, Handle<Node> next = {});
  void unlink(Handle<Node> node);
  /** Updates world matrices and visibility of \a node and its descendants. Changed ones get \a revision. */
  void update_subtree(Handle<Node> node, Revision revision);
  NodeLinks &links(Handle<Node> node)
  {
    return links_[node.index];
  }
  const NodeLinks &links(Handle<Node> node) const
  {
    nodes_[node];
    return links_[node.index];
  }

  Revision revision_ = 0;
  std::optional<World> world_;
  Revision world_revision_ = 0;
  Pool<Node> nodes_;
  std::vector<NodeLinks> links_;
  Pool<Mesh> meshes_;
  /** The blocks of meshes that set_vertices() has changed since another change of their shape. */
  std::unordered_map<Handle<Mesh>, VertexBlocks> vertex_blocks_;
  Pool<Image> images_;
  Pool<Texture> textures_;
  Pool<SurfaceFunction> surface_functions_;
  Pool<Material> materials_;
  Pool<Lamp> lamps_;
  Pool<Camera> cameras_;
  /** The last member: not below those of the pools. */
  FirstRevision first_revision_;
};

}  // namespace gnomon::scene
