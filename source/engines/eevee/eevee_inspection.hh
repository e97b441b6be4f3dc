// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine.hh"
#include "eevee_frame_tree.hh"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::eevee {

class Shadows;

/** Device time of a step of the frame in seconds, summed over the samples of a picture. */
struct StepTime {
  std::string step;
  double seconds = 0.0;
};

/** A step of the frame, as its module describes it. */
struct StepDescription {
  std::string name;
  /** Markdown. */
  std::string summary;
  /** The names of its passes. */
  std::vector<std::string> passes{};
  /**
   * Names of textures and buffers: those written by steps that the step reads, and those that it writes. "target"
   * stands for the attachments of a draw's target.
   */
  std::vector<std::string> reads{};
  std::vector<std::string> writes{};
  /** Drawn with each draw that has a target. Otherwise with each sample of the picture. */
  bool is_of_target = false;
};

/** The surface at the centre of each pixel, and the visibility of one lamp there. Rows from the bottom. */
struct Probe {
  /** xyz: position relative to RenderScene::origin_ws, metres. w: visibility of the lamp, in [0, 1]. */
  std::vector<glm::vec4> position_visibility;
  /** xyz: normal of the triangle on its visible side. w: 1. All components are 0 for pixels without a surface. */
  std::vector<glm::vec4> normal;
};

/** The opaque surface at the centre of each pixel. Rows from the bottom; all values are 0 without a surface. */
struct Surfaces {
  /** Metres. xyz: position relative to RenderScene::origin_ws. w: distance from the eye along the view axis. */
  std::vector<glm::vec4> position_depth;
  /** xyz: shading normal on the visible side, world space, unit length. w: the object's draw::ObjectIndex. */
  std::vector<glm::vec4> normal_object;
  /** rgb: linear base colour; 0 for unlit materials. a: roughness. */
  std::vector<glm::vec4> albedo_roughness;
};

/** Report of the last picture of a viewport: warnings, exceeded limits, and the items that were made or left out. */
struct Report {
  std::vector<std::string> warnings;
  std::vector<std::string> limits;
  /** Number of lamps that give light and request a shadow, but have none because of a limit. */
  int lost_shadow_count = 0;
  std::vector<FrameItem> items;
  /** The node "frame": programs, passes, targets, blocks, meshes, textures, shadows and draws of the last picture. */
  FrameNode tree;
  ShadowCounters shadow_counters;
  /** Increased when the table of emissive surfaces changes, which engines of one scene share. */
  std::uint64_t emission_revision = 0;
  /** Number of recordings of the passes since the first sync of the viewport. */
  std::uint64_t pass_recordings = 0;
};

/** Index of the layer \a text among \a names of Inspection::shadow_layers: a name, or the index as a number. */
[[nodiscard]] std::optional<std::size_t> find_layer(std::span<const std::string> names, std::string_view text);

/**
 * Observes an engine in one viewport, for reports, tests, measurements and the shadow inspector of an editor. No
 * picture needs it. It holds two references only: construct one where it is used. \see SceneRenderer::inspect
 *
 * Call it on the device's thread. probe, surfaces, texel_density and shadow_picture submit work, and must not be called
 * while the device records a packet.
 */
class Inspection {
 public:
  /** Both references must outlive this object. */
  Inspection(Engine &engine, draw::Viewport &viewport) : engine_(engine), viewport_(viewport) {}

  /** A report of the last picture; empty before the first sync. The cost is linear in the size of the scene. */
  [[nodiscard]] Report report() const;
  /**
   * Times of the samples that were submitted since the last call, for which it waits. Empty unless Settings::is_timed.
   */
  [[nodiscard]] std::vector<StepTime> take_step_times() const;
  /** All steps of a frame, needed or not, in the order in which they are drawn. No sync is necessary. */
  [[nodiscard]] std::vector<StepDescription> steps() const;
  /** The recorded passes as text. Empty before the first draw in which an object or a background is visible. */
  [[nodiscard]] std::string serialize_passes() const;
  /**
   * Positions, normals and the visibility of the \a lamp-th lamp of RenderScene::lamps at each pixel. Empty where the
   * lamp gives no light, or there are no objects. \a sample: at the positions and with the points of lamps of this
   * sample of the picture; without it, at the centres of pixels and with the centres of lamps. \pre Settings::has_probe
   */
  [[nodiscard]] std::optional<Probe> probe(const draw::View &picture_view, std::size_t lamp,
                                           std::optional<int> sample = std::nullopt) const;
  /**
   * The opaque surfaces that \a picture_view sees. Empty if there are no objects. \a sample: at the positions of this
   * sample of the picture; without it, at the centres of pixels. \pre Settings::has_surfaces
   */
  [[nodiscard]] std::optional<Surfaces> surfaces(const draw::View &picture_view,
                                                 std::optional<int> sample = std::nullopt) const;
  /** The shadow layers after the last draw. \pre the viewport was synced */
  [[nodiscard]] const Shadows &shadows() const;
  /** Counters of the shadow layers that this viewport drew. Viewports share layers. \pre the viewport was synced */
  [[nodiscard]] const ShadowCounters &shadow_counters() const;
  /**
   * Edge of a texel of the lamp's shadow at a position, perpendicular to the light, metres. 0 where the lamp has no
   * shadow there. \a position_ws: metres, relative to RenderScene::origin_ws
   */
  [[nodiscard]] double shadow_texel_size(std::size_t lamp, const glm::dvec3 &position_ws) const;
  /**
   * Texels of the lamp's shadow along the edge of a pixel, at the opaque surface at the centre of each pixel: below 1
   * where texels are larger than pixels. The edge of a texel is shadow_texel_size, that of a pixel is measured parallel
   * to the picture at the depth of the surface. 0 where the lamp has no shadow, where there is no surface, on surfaces
   * that are unlit, receive no shadows or face away from the lamp's centre, and outside of the lamp's cone and range.
   * Rows from the bottom. Empty if the lamp gives no light or has no shadow, or there
   * are no objects. \pre Settings::has_surfaces
   */
  [[nodiscard]] std::optional<std::vector<float>> texel_density(const draw::View &picture_view, std::size_t lamp) const;
  /**
   * Names of the layers of the lamp's shadow in the last picture: "+X", "-X", "+Y", "-Y", "+Z", "-Z" for the faces of a
   * cube by their axes in the world, "cascade 0 of 4" and so on for cascades of a sun from the finest, "map" for a
   * spot, "octahedral". Empty where the lamp has no shadow. \see find_layer
   */
  [[nodiscard]] std::vector<std::string> shadow_layers(std::size_t lamp) const;
  /**
   * A picture of one layer, by index, or of all layers. The texture is valid until the next call.
   * \see ShadowPicture::draw \pre shadow_layers is not empty
   */
  [[nodiscard]] const gpu::Texture &shadow_picture(std::size_t lamp,
                                                   std::optional<std::size_t> layer = std::nullopt) const;
  /** Index in RenderScene::lamps of the sun whose cascades Settings::has_cascade_tint shows. Valid after a sync. */
  [[nodiscard]] std::optional<std::size_t> tinted_sun() const;
  /** Mark all shadows as out of date, to measure the cost of drawing them. */
  void invalidate_shadows() const;

 private:
  [[nodiscard]] Data &engine_data() const;

  Engine &engine_;
  draw::Viewport &viewport_;
};

}  // namespace gnomon::eevee
