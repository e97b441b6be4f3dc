// SPDX-License-Identifier: MIT
#pragma once

#include "view_additions.hh"
#include "view_history.hh"
#include "view_properties.hh"
#include "view_settings.hh"
#include "view_transform_operation.hh"

#include "draw_engine.hh"
#include "eevee_inspection.hh"
#include "render_scene.hh"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gnomon::view {

/** An open scene on a device, with the engines that show it, its undo history and what is selected. */
class Document {
 public:
  /**
   * \a device must outlive the document, unless it leaves the device. The document must outlive the viewports that show
   * it.
   */
  Document(gpu::Device &device, scene::Scene scene, const Settings &settings);
  /** Forget all that is on the device, before the device is destroyed. Scene, history and settings stay. */
  void leave_device();
  /** Show the scene on another device. \pre leave_device */
  void use_device(gpu::Device &device);

  /** A scene that was imported; one that has neither lamps nor a world is lit by a studio. */
  [[nodiscard]] static scene::Scene completed(scene::Scene scene);
  /** \throws gltf::ExportError */
  void save(const std::filesystem::path &path);

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
   * Light the scene by a picture, as the picture before it did if there is one. nullptr: by the world's colour alone.
   * \throws scene::InvalidEdit; nothing changes
   */
  void set_world_picture(std::shared_ptr<const scene::WorldPicture> picture);
  /** A node that comes back is selected. */
  bool undo();
  bool redo();
  [[nodiscard]] History &history()
  {
    return history_;
  }

  /** Selects what it adds. \see view::add */
  void add(const Addition &addition, const glm::dvec3 &position_ws, const glm::dmat4 &world_from_view);
  /** With its descendants. \return false: nothing is selected */
  bool remove_selected();
  /** Selects the copy. \return false: nothing is selected */
  bool duplicate_selected();

  /** Let the selected node follow the pointer in a picture. \throws as TransformOperation */
  void begin_transform(const Transform &transform, const PictureMap &map, const glm::dvec2 &pointer);
  /** nullptr: none has begun. Call update_transform after changing it. */
  [[nodiscard]] TransformOperation *operation()
  {
    return operation_ ? &*operation_ : nullptr;
  }
  /** Edit the node as the operation says. */
  void update_transform();
  /** Its edits are one step for undo; if it is not kept, the node is as it was. No effect where none has begun. */
  void end_transform(bool is_kept);
  /** The gizmo at the selected node; nothing: none. */
  std::optional<TransformKind> gizmo = TransformKind::Move;
  /** Of the axes of the gizmo, and those that transforms begin with. */
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
  /** The first call makes it. \throws gpu::Error naming the engines where there is none of that name */
  [[nodiscard]] draw::Engine &engine(const std::string &name);
  /** The engine with lamps and shadows; nullptr: no viewport has used it. */
  [[nodiscard]] eevee::Engine *eevee();

  /**
   * Compile the programs of the engine with lamps and shadows from other files. \a viewport: one that it draws in, if
   * any does. \return a message for each program that does not compile and stays as it was
   */
  std::vector<std::string> reload_shaders(draw::Viewport &viewport, gpu::ShaderFiles files);
  /** Whether reload_shaders was called on this device. */
  [[nodiscard]] bool has_own_shaders() const
  {
    return has_own_shaders_;
  }

  /**
   * Read the surface functions again whose files have changed since the last call, or since they were first seen. That
   * is no edit for undo. \return a message for each
   */
  std::vector<std::string> reload_surface_functions();

  [[nodiscard]] const Settings &settings() const
  {
    return settings_;
  }
  void set_settings(const Settings &settings);
  /** With the settings of these viewports. */
  [[nodiscard]] ShadowOfLamp shadow_of(const scene::Lamp &lamp) const
  {
    return {lamp.kind, settings_.eevee.shadow.kind, lamp.shadow};
  }
  [[nodiscard]] std::uint64_t settings_revision() const
  {
    return settings_revision_;
  }

  /** An invalid handle: nothing. */
  scene::Handle<scene::Node> selected{};
  /** The selected node and its descendants. */
  [[nodiscard]] std::vector<scene::Handle<scene::Node>> selected_nodes() const;
  /** The box around the selected nodes, a lamp being a point; around the scene where nothing is selected. */
  [[nodiscard]] scene::Bounds selected_bounds() const;
  /** The first node of that name; an invalid handle: there is none. */
  [[nodiscard]] scene::Handle<scene::Node> find(const std::string &name) const;

 private:
  /** Deforms meshes whose joints an edit has moved, removed or brought back. */
  void deform();

  scene::Scene scene_;
  History history_;
  /** Nothing: the document has left its device. */
  std::optional<render_scene::RenderScene> render_scene_;
  draw::EngineRegistry registry_;
  std::vector<std::string> engine_names_;
  std::map<std::string, std::unique_ptr<draw::Engine>> engines_;
  std::optional<TransformOperation> operation_;
  Settings settings_;
  std::uint64_t settings_revision_ = 0;
  bool has_own_shaders_ = false;
  /** Of the last write of the file of each surface function. */
  std::map<scene::Handle<scene::SurfaceFunction>, std::filesystem::file_time_type> function_times_;
  scene::Revision saved_revision_ = 0;
};

}  // namespace gnomon::view
