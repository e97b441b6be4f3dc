// SPDX-License-Identifier: MIT
#pragma once

#include "view_additions.hh"
#include "view_history.hh"
#include "view_properties.hh"
#include "view_settings.hh"
#include "view_transform_operation.hh"

#include "draw_engine.hh"
#include "eevee_inspection.hh"
#include "overlay.hh"
#include "render_scene.hh"

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <unordered_set>
#include <vector>

namespace gnomon::view {

/** An open scene on a device, with its engines, undo history and selection. */
class Document {
 public:
  /**
   * \a device must outlive the document, or leave_device must be called before. The document must outlive the viewports
   * that show it.
   */
  Document(gpu::Device &device, scene::Scene scene, const WindowSettings &settings);
  /** Destroy all resources on the device; call it before the device is destroyed. Scene, history and settings stay. */
  void leave_device();
  /** Show the scene on another device. \pre leave_device */
  void use_device(gpu::Device &device);

  /** An imported scene, completed: without lamps and world, it gets studio lighting. */
  [[nodiscard]] static scene::Scene completed(scene::Scene scene);
  /** Ends a transform. \return gltf::left_out_of_export() of the scene's file before \throws gltf::ExportError */
  std::string save(const std::filesystem::path &path);

  [[nodiscard]] const scene::Scene &scene() const
  {
    return scene_;
  }
  template <typename T, std::invocable<T &> Change>
  void edit(scene::Handle<T> thing, Change &&change)
  {
    history_.edit(scene_, thing, change);
    deform();
  }
  void set_world(std::optional<scene::World> world)
  {
    history_.set_world(scene_, std::move(world));
  }
  /**
   * Set the world's picture. Strength and rotation of an earlier picture stay. nullptr: light by the world's colour
   * alone. \throws scene::InvalidEdit and changes nothing
   */
  void set_world_picture(std::shared_ptr<const scene::WorldPicture> picture);
  /** The nodes that undo or redo restores become selected. Both end a transform first. */
  bool undo();
  bool redo();
  [[nodiscard]] History &history()
  {
    return history_;
  }

  /**
   * Set the targets of \a animation to its values at \a seconds. Not an undo step, and a saved scene stays saved. Ends
   * a transform. \throws scene::InvalidEdit
   */
  void pose(const scene::Animation &animation, double seconds);

  /** Hide the selected nodes if `selected` is shown, otherwise show them, as an edit of the scene. */
  void toggle_visibility();
  /** Add a node and select it. \see view::add */
  void add(const Addition &addition, const glm::dvec3 &position_ws, const glm::dmat4 &world_from_view);
  /**
   * Remove the selected nodes and their descendants, as one undo step. Ends a transform. \return false if no node is
   * selected
   */
  bool remove_selected();
  /**
   * Duplicate the selected nodes with their descendants, as one undo step, and select the copies. Ends a transform.
   * \return false if no node is selected
   */
  bool duplicate_selected();

  /**
   * Start to transform `selected` with the pointer in a picture, and the other selected nodes with it, around its
   * position. Nodes below a selected one follow that one, also `selected`. A node stays where it is if the matrix of
   * its parent has no inverse. Ends a running transform. \throws as TransformOperation
   */
  void begin_transform(const Transform &transform, const PictureMap &map, const glm::dvec2 &pointer);
  /** The running transform; nullptr: none. Call update_transform after changing it. */
  [[nodiscard]] TransformOperation *operation()
  {
    return operation_ ? &*operation_ : nullptr;
  }
  /** Set the nodes' matrices from the operation. */
  void update_transform();
  /**
   * End the transform. It becomes one undo step; if it is not kept, the nodes' matrices are restored. No effect without
   * an operation.
   */
  void end_transform(bool is_kept);
  /** Kind of the gizmo at the selected node. Empty: none. */
  std::optional<TransformKind> gizmo = TransformKind::Move;
  /** The orientation of the gizmo's axes, and of those that transforms begin with. */
  Orientation orientation = Orientation::World;

  [[nodiscard]] bool is_saved() const
  {
    return saved_revision_ == scene_.revision();
  }

  [[nodiscard]] render_scene::RenderScene &render_scene()
  {
    return *render_scene_;
  }
  [[nodiscard]] const std::vector<std::string> &engine_names() const
  {
    return engine_names_;
  }
  /**
   * The engine \a name, which the first call creates. \throws gpu::Error, which lists the engines, if there is none of
   * that name
   */
  [[nodiscard]] draw::Engine &engine(const std::string &name);
  /** The engine eevee. nullptr: no viewport has used it yet. */
  [[nodiscard]] eevee::Engine *eevee();

  /**
   * Compile the programs of the engine eevee from other files. \a viewport: one that eevee draws, if there is one.
   * \return a message for each program that does not compile; the earlier program stays in use
   */
  std::vector<std::string> reload_shaders(draw::Viewport &viewport, gpu::ShaderFiles files);
  /** Whether reload_shaders was called since the document uses this device. */
  [[nodiscard]] bool has_own_shaders() const
  {
    return has_own_shaders_;
  }

  /**
   * Read surface functions again if their files have changed since the last call, or since the first call that saw
   * them. Not an undo step. \return a message for each function read again
   */
  std::vector<std::string> reload_surface_functions();

  [[nodiscard]] const WindowSettings &settings() const
  {
    return settings_;
  }
  void set_settings(const WindowSettings &settings);
  /** The shadow of \a lamp, with the current settings. */
  [[nodiscard]] ShadowOfLamp shadow_of(const scene::Lamp &lamp) const
  {
    return {lamp.kind, settings_.eevee.shadow.kind, lamp.shadow};
  }
  [[nodiscard]] std::uint64_t settings_revision() const
  {
    return settings_revision_;
  }

  /** Panels and the gizmo use this node. Invalid handle: no node is selected. */
  scene::Handle<scene::Node> selected{};
  /**
   * Select \a nodes, of which the first becomes `selected`. \a adds: beside those that are selected; otherwise in place
   * of them.
   */
  void select(std::span<const scene::Handle<scene::Node>> nodes, bool adds = false);
  void select(scene::Handle<scene::Node> node, bool adds = false)
  {
    select(std::span(&node, node ? 1 : 0), adds);
  }
  /** `selected` and the nodes that are selected beside it; those that were removed are left out. */
  [[nodiscard]] std::vector<scene::Handle<scene::Node>> selection() const;
  [[nodiscard]] bool is_selected(scene::Handle<scene::Node> node) const;
  /** Select the surface that a click in a picture met; empty: nothing. \a adds: \see select */
  void click(const std::optional<overlay::Hit> &hit, bool adds = false);
  /** The surface that the last click met. nullptr: none of the selected node, or the scene has changed since. */
  [[nodiscard]] const overlay::Hit *clicked() const
  {
    const bool is_shown = clicked_ && clicked_->node == selected && clicked_revision_ == scene_.revision();
    return is_shown ? &*clicked_ : nullptr;
  }
  /** The nodes of selection() that are not below another one. */
  [[nodiscard]] std::vector<scene::Handle<scene::Node>> selected_roots() const;
  /** The selected nodes and their descendants, each once. */
  [[nodiscard]] std::vector<scene::Handle<scene::Node>> selected_nodes() const;
  /** Bounding box of the selected nodes; a lamp counts as a point. Without a selection: of the scene. */
  [[nodiscard]] scene::Bounds selected_bounds() const;
  /** The first node with that name. Invalid handle: none. */
  [[nodiscard]] scene::Handle<scene::Node> find(const std::string &name) const;

 private:
  /** A node that the operation moves. Its descendants follow it. */
  struct Moved {
    scene::Handle<scene::Node> node;
    /** At the start. */
    glm::dmat4 parent_from_node{1.0};
    glm::dmat4 world_from_node{1.0};
  };
  /** After undo or redo. */
  void follow_history();
  /** Deform meshes whose joints an edit has moved, removed or restored. */
  void deform();

  scene::Scene scene_;
  History history_;
  /** Empty: the document has left its device. */
  std::optional<render_scene::RenderScene> render_scene_;
  draw::EngineRegistry registry_;
  std::vector<std::string> engine_names_;
  std::map<std::string, std::unique_ptr<draw::Engine>> engines_;
  std::optional<TransformOperation> operation_;
  /** The selected_roots() at the start of the operation. */
  std::vector<Moved> moved_;
  WindowSettings settings_;
  std::uint64_t settings_revision_ = 0;
  bool has_own_shaders_ = false;
  /** The time of the last write of the file of each surface function. */
  std::map<scene::Handle<scene::SurfaceFunction>, std::filesystem::file_time_type> function_times_;
  scene::Revision saved_revision_ = 0;
  /** Nodes that are selected beside `selected`. */
  std::vector<scene::Handle<scene::Node>> others_;
  /** The same nodes, to look them up. */
  std::unordered_set<scene::Handle<scene::Node>> others_known_;
  std::optional<overlay::Hit> clicked_;
  /** scene::Scene::revision at the last click. */
  scene::Revision clicked_revision_ = 0;
};

}  // namespace gnomon::view
