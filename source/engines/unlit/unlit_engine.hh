// SPDX-License-Identifier: MIT
#pragma once

#include "unlit_programs.hh"

#include "draw_engine.hh"
#include "draw_viewport.hh"
#include "render_scene.hh"

#include <map>
#include <memory>
#include <optional>

namespace gnomon::unlit {

struct Settings {
  /**
   * What it does not see is black; its field of view ends at the edges of its picture. World space of the scene.
   * Nothing: depth_camera_of the first lamp that has one.
   */
  std::optional<scene::PlacedCamera> depth_camera{};
  /** false: no depth camera, no shadow. */
  bool has_shadow = true;
  /** Of the render texture that the depth camera renders into, pixels, at least 1x1. */
  glm::ivec2 depth_size_px{1024, 1024};
};

struct Data;

/**
 * Shows surfaces without light: base colour, its texture, vertex colours, and what they emit. A depth camera renders
 * the scene into a texture, once for all viewports and again when something that it sees changes; surfaces that it does
 * not see are black. One sample a pixel, and no film: a quick view for editors, and an example of a second engine.
 */
class Engine final : public draw::Engine {
 public:
  /** \a scene must outlive the engine. After an edit of the scene: as for eevee::Engine. */
  explicit Engine(render_scene::RenderScene &scene, const Settings &settings = {});
  ~Engine() override;

  /** Other settings, from the next draw::Viewport::sync on. */
  void set_settings(const Settings &settings)
  {
    settings_ = settings;
    settings_revision_++;
  }

  [[nodiscard]] std::string_view name() const override
  {
    return "unlit";
  }
  void init(draw::Viewport &viewport) override;
  void cache_init(draw::Viewport &viewport) override;
  void cache_populate(draw::Viewport &viewport, const draw::ObjectBuffer &objects, draw::ObjectIndex object) override;
  void cache_finish(draw::Viewport &viewport) override;
  void draw_scene(draw::Viewport &viewport, const draw::View &view) override;

  /** The scene-linear picture, RGBA16F. \pre a draw of the viewport has taken place */
  [[nodiscard]] const gpu::Texture &radiance(draw::Viewport &viewport) const;
  /** Its depths as the last draw saw them; nothing: there is no depth camera. */
  [[nodiscard]] const gpu::Texture *depth_camera_texture() const;

 private:
  struct DepthCamera;

  const gpu::Shader &shader(gpu::Device &device, ShaderId id, Feature features);
  void update_depth_camera(gpu::Device &device, std::span<const draw::ObjectIndex> objects);
  void record(Data &data, gpu::Device &device);
  void draw_sample(draw::Viewport &viewport, Data &data, const draw::View &view);

  render_scene::RenderScene &scene_;
  Settings settings_;
  std::uint64_t settings_revision_ = 1;
  std::map<std::pair<ShaderId, Feature>, gpu::Shader> shaders_;
  /** Of all viewports. */
  std::unique_ptr<DepthCamera> depth_camera_;
};

/** For a host's registry; engines that it creates read \a scene, which must outlive them. */
[[nodiscard]] draw::EngineType engine_type(render_scene::RenderScene &scene, const Settings &settings = {});

}  // namespace gnomon::unlit
