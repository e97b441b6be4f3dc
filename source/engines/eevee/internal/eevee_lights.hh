// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_emission.hh"
#include "eevee_lamp_points.hh"
#include "internal/eevee_scene_world.hh"

#include "draw_pass.hh"

#include <optional>
#include <vector>

namespace gnomon::eevee {

class SceneShadows;

struct LightComponent;
struct ResourceReport;

/** Entries of `light_block` with Feature::LightClusters. \see SceneLights::block */
inline constexpr int probed_entry = 0;
inline constexpr int tinted_entry = 1;

/** The lights of a scene: of its lamps, emissive surfaces and world. Needs no device. */
struct PlannedLights {
  /** The lamps of the scene, followed by those of emission_lamps, world_lamps and further_emission_lamps. */
  std::vector<scene::PlacedLamp> placed;
  Lamps lamps;
  /** By index in Lamps::lights: whether the light is not in Settings::light. */
  std::vector<bool> is_left_out;
  /** Points of lamps with an extent. Empty if a picture has one sample: then these lamps are shaded as a whole. */
  LampPoints points;
  /** Index in Lamps::lights of the sun of Settings::has_cascade_tint. Empty without this setting or such a sun. */
  std::optional<int> tinted;
  /** The scene's bounds. */
  scene::Bounds bounds_ws;
  /** nullptr: they give no light to others, or there are none. */
  std::shared_ptr<const scene::EmissiveSurfaces> emission;

  /** Pixels visit the lights that can reach them, which are in `light_texture`. */
  [[nodiscard]] bool is_clustered() const
  {
    return has(lamps.features, Feature::LightClusters);
  }
};

/** The lights of a scene, for all viewports: in `light_block`, or in `light_texture` with lists. Internal. */
class SceneLights {
 public:
  /** \a world must outlive the object. */
  explicit SceneLights(const SceneWorld &world) : world_(world) {}
  /**
   * Plan the lights, and \a shadows of them, if an input changed. Creates no resources on the device.
   * \a settings_revision, shaders_revision: change whenever the settings or programs do. \a emission: is updated.
   * \return whether they were planned anew. \throws gpu::Error if a setting of shadows is out of range
   */
  bool sync(const render_scene::RenderScene &scene, const Settings &settings, std::uint64_t settings_revision,
            std::uint64_t shaders_revision, SceneEmission &emission, SceneShadows &shadows);
  /** Let the next sync plan again, because work was lost. */
  void forget()
  {
    synced_.reset();
  }
  /**
   * Create the buffers and textures that the features \a read need, free the others, and write the planned lights.
   */
  void make(gpu::Device &device, const Settings &settings, Feature read);
  void bind(draw::ShadingGroup &group) const;
  /** Write the lights of \a sampled. Entries of `light_block` are written by \a list. */
  void write_points(const SampledLampPoints &sampled, gpu::Device &device, gpu::CommandList &list);
  /** If lights are clustered, append a write of \a light, at its point in \a sampled, to \a entry of `light_block`. */
  void write_entry(const SampledLampPoints &sampled, int light, int entry, gpu::CommandList &list) const;

  void report(ResourceReport &report) const;
  [[nodiscard]] const PlannedLights &plan() const
  {
    return plan_;
  }
  /** Increased when lights are planned. */
  [[nodiscard]] std::uint64_t revision() const
  {
    return revision_;
  }
  /** Increased when the reach of a light, or the order of the lights, changes. */
  [[nodiscard]] std::uint64_t reaches_revision() const
  {
    return reaches_revision_;
  }
  /** The entry in `light_block` of \a light, an index in Lamps::lights. \a entry: that of clustered lights. */
  [[nodiscard]] int entry_of(int light, int entry) const
  {
    return plan_.is_clustered() ? entry : light;
  }
  /**
   * If lights are clustered, the block exists for Inspection::probe and the tint of cascades, and has only the lights
   * of these: probed_entry and tinted_entry.
   */
  [[nodiscard]] const gpu::Buffer &block() const
  {
    return block_;
  }
  /** Empty unless lights are clustered. */
  [[nodiscard]] const gpu::Texture &texture() const
  {
    return texture_;
  }
  /** The sampler of `light_texture` and `light_lists`. */
  [[nodiscard]] const gpu::Sampler &sampler() const
  {
    return sampler_;
  }

 private:
  /** Revisions of everything that the plan depends on. */
  struct Key {
    std::uint64_t lamps = 0;
    std::uint64_t objects = 0;
    std::uint64_t passes = 0;
    std::uint64_t settings = 0;
    std::uint64_t shaders = 0;
    std::uint64_t viewports = 0;
    std::uint64_t emission = 0;
    std::uint64_t content = 0;

    bool operator==(const Key &) const = default;
  };
  struct PlacedSections;
  void make_plan(const render_scene::RenderScene &scene, const Settings &settings, SceneShadows &shadows);
  /** Set PlannedLights::placed and lamps. */
  PlacedSections place_lights(const render_scene::RenderScene &scene, const Settings &settings, LampShading shading);
  /** Give each light of an emissive surface its point: those of one sample do not move, so that shadows are kept. */
  void fix_surface_points(const PlacedSections &first, const Settings &settings);
  /** Set PlannedLights::is_left_out, and leave these lights out. */
  void select_lights(const PlacedSections &first, const LightComponent &selected);
  void write_block(gpu::Device &device);
  void write_texture(gpu::Device &device);
  /** The light \a point.light at \a point, as a sample draws it. */
  [[nodiscard]] shared::LightData light_in_sample(const LampPoint &point) const;

  const SceneWorld &world_;
  PlannedLights plan_;
  std::optional<Key> synced_;
  std::uint64_t revision_ = 0;
  std::uint64_t reaches_revision_ = 0;
  gpu::Buffer block_;
  gpu::Buffer shape_block_;
  gpu::Texture texture_;
  gpu::Sampler sampler_;
  /** Content of `texture_`: LIGHT_TEXELS for each light. */
  std::vector<glm::vec4> texels_;
  /** The lights on the device are the planned ones. */
  bool is_written_ = false;
  /** Temporary memory of write_points. */
  std::vector<shared::LightData> sampled_;
};

/** Texels of a texture for \a count: the next power of two, so that edits and moving views seldom make a new one. */
[[nodiscard]] int light_texture_width(std::size_t count, const gpu::Device &device);

}  // namespace gnomon::eevee
