// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_casters.hh"
#include "eevee_lamps.hh"
#include "eevee_octahedral.hh"
#include "eevee_sun_fit.hh"

#include "draw_pass.hh"
#include "eevee_depth_shared.h"
#include "eevee_shadow_shared.h"

#include <array>
#include <functional>
#include <optional>

namespace gnomon::eevee {

/** Rotations that turn a cube face's axis to -Z, in OpenGL's order: +X, -X, +Y, -Y, +Z, -Z. */
extern const std::array<glm::mat4, 6> cubefacemat;

/** From clip space to texture coordinates: xy from [-1, 1] to [0, 1]; the depth is in [0, 1] already. */
extern const glm::mat4 texcomat;

/** How the layers of a lamp are drawn; the texels are the same. */
enum class LayerPass {
  /** The best that the device has. */
  Best,
  /** A pass for each layer. */
  Single,
  /** One pass: the geometry shader chooses each triangle's layer. */
  Geometry,
  /** One pass: the vertex shader chooses it. */
  Layered,
};

/** Which sides of closed objects throw the shadow; two-sided materials always throw it with both. */
enum class CasterFaces { All, Front, Back };

/** A lamp's own wishes (scene::LampShadow) go before the settings of the same name, except that None is none at all. */
struct ShadowSettings {
  /** Hard: the bilinear blend of the four texels around a lookup. Pcf: the mean of several such. */
  scene::ShadowKind kind = scene::ShadowKind::Hard;
  /** Edge of a cube face and of a map, pixels, at least 1. */
  int cube_size_px = 1024;
  int map_size_px = 2048;
  PcfKernel pcf{};
  /** Of Esm and Evsm, but for its method; for point lamps and spots. */
  EsmSettings esm{};
  CascadeSettings cascades{};
  LayerPass layer_pass = LayerPass::Best;
  CasterFaces caster_faces = CasterFaces::All;
  /** Sizes are lowered evenly to stay within it; lamps that do not fit even so lose their shadow and are named. */
  std::size_t memory_bytes_max = std::size_t(1) << 30U;
};

/**
 * Spots wider than this (half the opening, radians) look into a cube: a plane would stretch too far, and at 60° a
 * point's distance along the axis is half of that from the lamp, which is where lamp_near puts the near plane.
 */
inline constexpr float spot_map_angle_max = 1.04F;

/** What a lamp asks for, or else \a settings have; a sun that asks for Esm or Evsm has Pcf. */
[[nodiscard]] scene::ShadowKind shadow_kind(const scene::Lamp &lamp, const ShadowSettings &settings);

/** The six views of a cube around \a position_ws, each with a border of CUBE_BORDER_TEXELS. */
[[nodiscard]] std::array<draw::View, 6> shadow_cube_views(const glm::vec3 &position_ws, float near, int size_px);

/** The view of a spot, with room for a filter's kernel around its cone. \pre its angle at most spot_map_angle_max */
[[nodiscard]] draw::View shadow_spot_view(const scene::PlacedLamp &lamp, float near, int size_px);

/** Counts since the shadows were made. */
struct ShadowCounters {
  /** Lamps of which any layer was drawn. */
  std::uint64_t lamps_updated = 0;
  /** Layers drawn: faces of cubes, maps, cascades. */
  std::uint64_t faces_drawn = 0;
  /** Layers of updated lamps that were not: no caster in them, or nothing visible looks there. */
  std::uint64_t faces_skipped = 0;
  /** Instances of casters drawn, one for each layer that a caster touches. */
  std::uint64_t caster_draws = 0;
};

/** Which of a light's layers are drawn, and which are not, for who reports it. Bit i of a mask: layer i. */
struct ShadowState {
  /** In light_block. */
  int light = 0;
  /** Where the layers are: "shadow_cubes", "shadow_maps" or "shadow_distance_cube". */
  std::string_view array;
  /** Edge of each, texels. */
  int size_px = 0;
  /** 0: a sun, of which nothing is seen that its casters could darken; or nothing was ever seen. */
  int layer_count = 0;
  /** Drawn, and still what they should be. */
  std::uint32_t drawn = 0;
  /** Those, and those that were not drawn for want of a caster. What is in neither, nothing visible looks up. */
  std::uint32_t settled = 0;
  /** Drawn since begin_picture. */
  std::uint32_t drawn_now = 0;
};

/** A light's layers as they stand, for who shows them. */
struct ShadowLayers {
  /** How many; 0 where nothing is seen that the light's casters could darken. */
  int count = 0;
  /** Array that holds them, from `first_layer` on. nullptr while count is 0. */
  const gpu::Texture *texture = nullptr;
  int first_layer = 0;
  /** Edge of each, texels, in the lower left corner of its layer after `border` texels. */
  int size_px = 0;
  int border = 0;
  /** Six faces, in OpenGL's order. */
  bool is_cube = false;
  /** Bit i: layer i was drawn. */
  std::uint32_t drawn = 0;
  /** PROJECTION_… that the depths were made by. */
  int projection = PROJECTION_PERSPECTIVE_INFINITE;
  /** ESM_…: the layer holds distances instead; -1: depths. */
  int esm_format = -1;
  /**
   * Distances that depths 1 and 0 stand for, metres: one for each cascade, from where the first caster may be; one for
   * all layers of other lamps, from the lamp.
   */
  std::vector<glm::vec2> near_far;
  /** Distances that hold all casters, metres, as far as the lamp reaches. */
  glm::vec2 shown{0.0F};
};

/**
 * Shadow maps of a scene's lamps in one viewport: which lamp has which layers, and which of them are up to date.
 *
 * Order: sync; once anything is seen, allocate, bind, casters, finish; then update for each view. What the last sync
 * drew stays where neither the lamp nor its settings nor a caster in its range changed.
 */
class Shadows {
 public:
  /**
   * Give each light of \a lamps that casts a shadow its place; \a placed is the list that \a lamps was made from.
   * Writes shadow_kind and shadow_index of its entry. Makes nothing on the device. \throws gpu::Error naming lamp and
   * setting where a setting is out of range.
   */
  void sync(const gpu::Limits &device_limits, std::span<const scene::PlacedLamp> placed,
            const scene::Bounds &scene_bounds, Lamps &lamps, const ShadowSettings &settings);
  /** Make what the last sync gave places to, and free what has none any more. \a shaders: for the next filter passes.
   */
  void allocate(gpu::Device &device, ShaderCache &shaders);
  void add_caster(const Caster &caster)
  {
    casters_.push_back(caster);
  }
  /** After the last caster. */
  void finish();
  /** Draw everything again: the shaders are others. */
  void invalidate();
  /** What is drawn from here on is ShadowState::drawn_now. */
  void begin_picture();
  /** Of each light that casts a shadow. */
  [[nodiscard]] std::vector<ShadowState> states() const;

  /**
   * Fit to what \a view sees and record into \a list what is not up to date. \a pass draws the casters' instances,
   * \a pixel_size: see fit_sun. \a read_depths gives the picture's, see narrow_to_depths; asked for only where settings
   * and lamps want it and the view is a new one.
   */
  void update(gpu::Device &device, const draw::View &view, float pixel_size, const draw::Pass &pass,
              gpu::CommandList &list, const std::function<std::vector<float>()> &read_depths = {});

  /** To be bound by reference in the pass that draws casters, as `shadow_render_block`. */
  [[nodiscard]] const gpu::BufferRange *render_block() const
  {
    return &render_block_range_;
  }
  /** Which of LayerPass's ways the pass that draws casters must have its shader for; never Best. */
  [[nodiscard]] LayerPass layer_pass() const
  {
    return layer_pass_;
  }

  /** The shadows' features as far as lamps have them; valid after sync. */
  [[nodiscard]] Feature features() const;
  /** Everything that lookups read, for a group whose shader has features(). */
  void bind(draw::ShadingGroup &group) const;
  [[nodiscard]] const gpu::Texture &cubes() const
  {
    return cubes_.texture;
  }
  /** Made by the first update: it takes a view to know how many there are. */
  [[nodiscard]] const gpu::Texture &maps() const
  {
    return maps_.texture;
  }
  [[nodiscard]] const gpu::Texture &distance_cube() const
  {
    return distance_cube_.texture;
  }
  /** `shadow_block`, empty without cubes and maps; and the views that casters are drawn with, one a lamp. */
  [[nodiscard]] const gpu::Buffer &block() const
  {
    return shadow_block_buffer_;
  }
  [[nodiscard]] const gpu::Buffer &render_blocks() const
  {
    return render_buffer_;
  }
  /** Edge of a texel of a light's shadow at a place, across the light, metres; 0: it has none there. */
  [[nodiscard]] double texel_size(const shared::LightData &light, const glm::dvec3 &position_ws) const;
  /** Of a light that casts a shadow, as the last update left them. */
  [[nodiscard]] std::optional<ShadowLayers> layers(const shared::LightData &light) const;
  /** What the shaders read of it. */
  [[nodiscard]] const shared::ShadowBlock &block_data() const
  {
    return shadow_block_;
  }
  /** Of lamps whose wishes cannot be met, and what they get instead. */
  [[nodiscard]] const std::vector<std::string> &warnings() const
  {
    return warnings_;
  }
  /** Lamps that lost their shadow, and sizes that were lowered, with the limit. */
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
  [[nodiscard]] const OctahedralStore &octahedral() const
  {
    return octahedral_;
  }

 private:
  /** What a lamp has in an array. */
  struct Slot {
    /** The lamp as it was when its layers were drawn. */
    scene::PlacedLamp lamp;
    /** In light_block. */
    int light = 0;
    scene::ShadowKind kind = scene::ShadowKind::Hard;
    int size_px = 0;
    /** In shadow_block: the first of `layer_count_max`. */
    int entry = 0;
    int layer_count_max = 0;
    int first_layer = 0;
    /** Lamps farther from a caster than this are not darkened by it, metres; infinite: none is. */
    float range = 0.0F;
    float near = 0.0F;
    /** One a layer. */
    std::vector<draw::View> views;
    /** Suns: what views were fitted to; empty while no caster matters. */
    std::vector<SunFit> fits;
    /** All layers of the slot, for passes whose shader chooses one. */
    gpu::Framebuffer framebuffer;
    /** Where its ShadowRenderBlock stands in the buffer. */
    std::uint32_t render_offset_bytes = 0;
    int framebuffer_layers = 0;
    /** Bit a layer: it was drawn, and still is what it should be. */
    std::uint32_t drawn = 0;
    /** The same, and those that have nothing in them to draw. */
    std::uint32_t settled = 0;
    std::uint32_t drawn_now = 0;
  };
  /** Layers of one size, and who has them. */
  struct Array {
    std::string_view name;
    gpu::Texture texture;
    draw::TextureBinding binding;
    /** One a layer; empty until a pass draws that layer alone. */
    std::vector<gpu::Framebuffer> framebuffers;
    std::vector<Slot> slots;
  };

  void place_slots(const gpu::Limits &device_limits, std::span<const scene::PlacedLamp> placed, Lamps &lamps);
  [[nodiscard]] std::array<Array *, 3> arrays()
  {
    return {&cubes_, &maps_, &distance_cube_};
  }
  void warn_of_idle_wishes(const scene::Lamp &lamp);
  void place_octahedral(const gpu::Limits &device_limits, const scene::Bounds &bounds_ws);
  [[nodiscard]] int octahedral_size_px(const Slot &slot) const;
  void keep_drawn(Array &array, std::vector<Slot> before);
  void create_layers(gpu::Device &device, Array &array, int layers);
  void place_render_blocks(gpu::Device &device);
  [[nodiscard]] std::size_t bytes_needed() const;
  void fit_memory(Lamps &lamps);
  void fit_suns(gpu::Device &device, const draw::View &view, float pixel_size);
  void write_cube_data(const Slot &slot);
  void write_map_data(const Slot &slot);
  /** Of a cube for depths, or of maps: layers that something visible may look up. */
  [[nodiscard]] std::uint32_t looked_up_layers(const Slot &slot) const;
  [[nodiscard]] bool is_spot_looked_up(const Slot &slot) const;
  [[nodiscard]] std::uint32_t looked_up_faces(const Slot &slot) const;
  void find_touched_layers(const Slot &slot);
  void update_slot(gpu::Device &device, Slot &slot, Array &array, std::uint32_t wanted, const draw::Pass &pass,
                   gpu::CommandList &list);

  ShadowSettings settings_;
  /** By which sizes were lowered to fit the memory. */
  float memory_scale_ = 1.0F;
  LayerPass layer_pass_ = LayerPass::Single;
  std::vector<Caster> casters_;
  /** casters_ is whole: no sync is under way, and the last did not fail. */
  bool is_finished_ = false;
  /** Of the last sync. */
  std::vector<Caster> casters_before_;
  scene::Bounds caster_bounds_ws_;
  /** Around each caster. */
  std::vector<draw::CullingVolume> caster_volumes_;
  /** Those of the casters, each once. */
  std::vector<draw::InstanceCall *> caster_calls_;
  /** Of the lamp being drawn: layers that each caster touches. */
  std::vector<std::uint8_t> caster_layers_;
  /** What visible_ is of. */
  std::optional<glm::mat4> seen_clip_from_world_;
  VisibleRange visible_;
  Array cubes_{"shadow_cubes", {}, {}, {}, {}};
  Array maps_{"shadow_maps", {}, {}, {}, {}};
  /** Lamps with exponential shadows; their layers are one cube that each is drawn into on its way to octahedral_. */
  Array distance_cube_{"shadow_distance_cube", {}, {}, {}, {}};
  /** What each of distance_cube_'s slots asks of octahedral_. */
  std::vector<EsmLamp> esm_lamps_;
  OctahedralStore octahedral_;
  gpu::Sampler sampler_;
  shared::ShadowBlock shadow_block_{};
  gpu::Buffer shadow_block_buffer_;
  gpu::Buffer render_buffer_;
  bool is_block_dirty_ = true;
  gpu::BufferRange render_block_range_;
  std::vector<std::string> warnings_;
  std::vector<std::string> limits_;
  ShadowCounters counters_;
};

}  // namespace gnomon::eevee
