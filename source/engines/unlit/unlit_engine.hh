// SPDX-License-Identifier: MIT
#pragma once

#include "draw_engine.hh"
#include "draw_viewport.hh"
#include "render_scene.hh"

#include <map>
#include <memory>
#include <optional>

namespace gnomon::unlit {

enum class ShaderId;
enum class Feature : std::uint32_t;

struct Settings {
  /**
   * The camera that casts the shadow, in world space of the scene. Surfaces that are occluded from this camera are
   * black; surfaces outside the sides of its frustum are not darkened. If empty, the engine uses depth_camera_of the
   * first lamp that has one.
   */
  std::optional<scene::PlacedCamera> depth_camera{};
  /** Enables the depth camera and its shadow. */
  bool has_shadow = true;
  /** Size of the depth camera's render texture, pixels, at least 1x1. */
  glm::ivec2 depth_size_px{1024, 1024};
};

/** How a viewport shows surfaces. */
struct Display {
  /** The edges of all triangles, from both sides, instead of surfaces. Only nearer edges hide them. */
  bool is_wireframe = false;
  /** Surfaces, or edges, hide half of the picture behind them. As blended surfaces, they have no depth. */
  bool is_xray = false;

  bool operator==(const Display &) const = default;
};

struct Data;

/**
 * Draws surfaces without lighting: base colour, its texture, vertex colours and emission. Blended surfaces are blended
 * from back to front, as are surfaces that transmit light, with the fraction that they do not transmit as the opacity;
 * neither casts a shadow. A transmission texture is not read: its material is drawn opaque. A depth camera renders the
 * scene into a texture, which all viewports share and which is rendered again when the objects or the camera change.
 * Surfaces that receive shadows and are occluded from the depth camera are black. A picture has one sample for each
 * pixel. The engine is a fast preview for editors, and an example of a second engine.
 */
class Engine final : public draw::Engine {
 public:
  /**
   * \a scene must outlive the engine. After an edit of the scene call render_scene::RenderScene::update, then
   * draw::Viewport::sync with the objects of \a scene.
   */
  explicit Engine(render_scene::RenderScene &scene, const Settings &settings = {});
  ~Engine() override;

  /** Set other settings. They take effect with the next draw::Viewport::sync. */
  void set_settings(const Settings &settings)
  {
    settings_ = settings;
    settings_revision_++;
  }

  /**
   * Set how \a viewport shows surfaces. Takes effect with its next sync. \throws gpu::Error for a wireframe if the
   * device has none (gpu::Limits::has_wireframe)
   */
  void set_display(draw::Viewport &viewport, const Display &display);

  [[nodiscard]] std::string_view name() const override
  {
    return "unlit";
  }
  void init(draw::Viewport &viewport) override;
  void cache_init(draw::Viewport &viewport) override;
  void cache_populate(draw::Viewport &viewport, const draw::ObjectBuffer &objects, draw::ObjectIndex object) override;
  void cache_finish(draw::Viewport &viewport) override;
  void draw_scene(draw::Viewport &viewport, const draw::View &view) override;

  /**
   * The scene-linear picture and its guard band (draw::Viewport::drawn_size_px), RGBA16F, premultiplied by alpha; rows
   * from the bottom.
   * \throws gpu::Error if the viewport was not drawn since it was made or resized
   */
  [[nodiscard]] const gpu::Texture &radiance(draw::Viewport &viewport) const;
  /** The depth camera's render texture, Depth32F; nullptr if there is no depth camera. */
  [[nodiscard]] const gpu::Texture *depth_camera_texture() const;

 private:
  struct DepthCamera;

  const gpu::Shader &shader(gpu::Device &device, ShaderId id, Feature features);
  void update_depth_camera(gpu::Device &device, std::span<const draw::ObjectIndex> objects);
  void record_casters(gpu::Device &device, std::span<const draw::ObjectIndex> objects);
  void record(Data &data, gpu::Device &device);
  void record_surfaces(Data &data, gpu::Device &device);
  /** Orders the pass of blended surfaces for \a view, from back to front. */
  void order_blended(Data &data, const draw::View &view) const;
  void draw_sample(draw::Viewport &viewport, Data &data, const draw::View &view);

  render_scene::RenderScene &scene_;
  Settings settings_;
  std::uint64_t settings_revision_ = 1;
  std::map<std::pair<ShaderId, Feature>, std::shared_ptr<gpu::SharedShader>> shaders_;
  /** Shared by all viewports; nullptr if there is none. */
  std::unique_ptr<DepthCamera> depth_camera_;
};

/** The entry of this engine in a host's registry. \a scene must outlive all engines that the entry creates. */
[[nodiscard]] draw::EngineType engine_type(render_scene::RenderScene &scene, const Settings &settings = {});

}  // namespace gnomon::unlit
