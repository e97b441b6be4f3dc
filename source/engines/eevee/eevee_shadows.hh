// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_lamps.hh"

#include "draw_pass.hh"
#include "draw_viewport.hh"
#include "eevee_shadow_shared.h"

#include <array>
#include <optional>

namespace gnomon::eevee {

/** Rotations that turn a cube face's axis to -Z, in OpenGL's order: +X, -X, +Y, -Y, +Z, -Z. */
extern const std::array<glm::mat4, 6> cubefacemat;

/** From clip space to texture coordinates: xy from [-1, 1] to [0, 1]; the depth is in [0, 1] already. */
extern const glm::mat4 texcomat;

enum class ShadowMethod { None, Hard };

struct ShadowSettings {
  ShadowMethod method = ShadowMethod::Hard;
  /** Edge of a cube face and of a map, pixels, at least 1. */
  int cube_size_px = 1024;
  int map_size_px = 2048;
  /** Lamps past it lose their shadow and are named. */
  std::size_t memory_bytes_max = std::size_t(1) << 30U;
};

/** Spots wider than this (half the opening, radians) look into a cube: a plane would stretch too far. */
inline constexpr float spot_map_angle_max = 1.2F;

/**
 * Distance of the near plane of a lamp, metres: what is nearer casts no shadow. As far as the nearest caster's box
 * allows, because depths lose precision with the square of distance / near; where the lamp is inside of boxes, a
 * small part of the smallest one's size.
 */
[[nodiscard]] float lamp_near(const glm::vec3 &position_ws, const std::vector<scene::Bounds> &casters_ws);

/** The six views of a cube around \a position_ws. */
[[nodiscard]] std::array<draw::View, 6> shadow_cube_views(const glm::vec3 &position_ws, float near);

/** The view of a spot, with a texel around its cone. \pre its angle at most spot_map_angle_max */
[[nodiscard]] draw::View shadow_spot_view(const scene::Lamp &lamp, float near, int size_px);

/** A sun's view, and what it was fitted to. */
struct SunFit {
  draw::View view;
  /** In the lamp's axes, metres: the rectangle across and the range along the light. */
  glm::dvec3 min;
  glm::dvec3 max;
};

/**
 * The smallest view of a sun that holds each caster that can darken what is visible: across the light, where
 * receivers and casters overlap; along it, from the first caster to the last receiver.
 *
 * \a receivers_ws: corners of what is visible. \return nothing where no caster can darken any of it.
 */
[[nodiscard]] std::optional<SunFit> fit_sun(const scene::Lamp &lamp, const std::vector<glm::dvec3> &receivers_ws,
                                            const std::vector<scene::Bounds> &casters_ws, int size_px);

/** Counts since the shadows were made. */
struct ShadowCounters {
  std::uint64_t lamps_updated = 0;
  /** Layers rendered: faces of cubes, and maps. */
  std::uint64_t faces_drawn = 0;
};

/**
 * Shadow maps of a scene's lamps in one viewport: which lamp has which layer, and whether it is up to date.
 *
 * Order: sync, then casters into pass(), then update for each view.
 */
class Shadows {
 public:
  /** Give each light of \a lamps that casts a shadow its layers. Writes shadow_kind and shadow_index of its entry. */
  void sync(gpu::Device &device, const scene::Scene &scene, Lamps &lamps, const ShadowSettings &settings);
  /** Box of a caster, world space. */
  void add_caster(const scene::Bounds &bounds)
  {
    casters_ws_.push_back(bounds);
  }
  /** Set-up of what does not depend on the view; after the last caster. */
  void finish(const scene::Scene &scene);

  /** Fit to what \a view sees, and record what is not up to date into \a list with \a pass. */
  void update(gpu::Device &device, const draw::View &view, const draw::Pass &pass, gpu::CommandList &list);

  /** To be bound by reference in the pass that draws casters: `shadow_render_block` and `shadow_face`. */
  [[nodiscard]] const gpu::BufferRange *render_block() const
  {
    return &render_block_range_;
  }
  [[nodiscard]] const int *render_face() const
  {
    return &render_face_;
  }

  /** Feature::ShadowCube and Feature::ShadowMap as far as lamps have them; valid after sync. */
  [[nodiscard]] Feature features() const;
  /** Valid where features() says so. */
  [[nodiscard]] const gpu::Texture &cubes() const
  {
    return cubes_.texture;
  }
  [[nodiscard]] const gpu::Texture &maps() const
  {
    return maps_.texture;
  }
  [[nodiscard]] const gpu::Sampler &sampler() const
  {
    return sampler_;
  }
  [[nodiscard]] const gpu::Buffer &block() const
  {
    return shadow_block_buffer_;
  }
  /** Lamps that lost their shadow, named, with the limit. */
  [[nodiscard]] const std::vector<std::string> &limits() const
  {
    return limits_;
  }
  [[nodiscard]] const ShadowCounters &counters() const
  {
    return counters_;
  }
  [[nodiscard]] std::size_t cube_count() const
  {
    return cubes_.slots.size();
  }
  [[nodiscard]] std::size_t map_count() const
  {
    return maps_.slots.size();
  }

 private:
  /** What a lamp has in an array. */
  struct Slot {
    std::uint32_t lamp = 0;
    std::vector<draw::View> views;
    /** Suns: what the view was fitted to; nothing while no caster matters. */
    std::optional<SunFit> sun;
    /** Where its ShadowRenderBlock stands in the buffer. */
    std::uint32_t render_offset_bytes = 0;
    bool is_up_to_date = false;
  };
  /** Layers of one size, and who has them. */
  struct Array {
    gpu::Texture texture;
    /** One a layer. */
    std::vector<gpu::Framebuffer> framebuffers;
    std::vector<Slot> slots;
  };

  void create_layers(gpu::Device &device, Array &array, std::string_view name, int size_px, int layers_a_slot);
  void place_render_blocks(gpu::Device &device);
  void fit_suns(const draw::View &view);
  void write_map_data(const Slot &slot, int index);
  void record_slot(Slot &slot, Array &array, int first_layer, const draw::Pass &pass, gpu::CommandList &list);

  const scene::Scene *scene_ = nullptr;
  ShadowSettings settings_;
  std::vector<scene::Bounds> casters_ws_;
  /** What the suns were last fitted to. */
  std::optional<glm::mat4> fitted_clip_from_world_;
  Array cubes_;
  Array maps_;
  gpu::Sampler sampler_;
  shared::ShadowBlock shadow_block_{};
  gpu::Buffer shadow_block_buffer_;
  gpu::Buffer render_buffer_;
  bool is_block_dirty_ = true;
  gpu::BufferRange render_block_range_;
  int render_face_ = 0;
  std::vector<std::string> limits_;
  ShadowCounters counters_;
};

}  // namespace gnomon::eevee
