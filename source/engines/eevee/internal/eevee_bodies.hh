// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_blend.hh"
#include "internal/eevee_scene_world.hh"

#include "draw_pass.hh"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::eevee {

/**
 * The triangles of surfaces that transmit light, through which the lit program of transmission traces rays, and the
 * background that these see. Internal to the engine.
 */
class Bodies {
 public:
  /**
   * Take the triangles of those \a objects that are neither blended nor \a hidden. Left out are masked ones and those
   * in buffers of a host, and all of them where they exceed the limits of the device. \a stand_in: bound instead of the
   * background's picture where there is none
   */
  void update(const render_scene::RenderScene &scene, std::span<const TransmissiveObject> objects,
              const draw::ObjectSet &hidden, const Settings &settings, const SceneWorld &world,
              const draw::TextureBinding &stand_in);
  void free();
  void bind(draw::ShadingGroup &group) const;
  void report(ResourceReport &report) const;
  /** The triangles that the device cannot hold, so that none is traced; 0: all are. */
  [[nodiscard]] std::size_t left_out() const
  {
    return left_out_;
  }

  /** An object whose triangles are traced. */
  struct Body {
    scene::Handle<scene::Mesh> mesh;
    /** Revision of the mesh's shape. */
    scene::Revision shape = 0;
    /** In render_scene::MaterialTable. */
    std::uint32_t material = 0;
    glm::mat4 world_from_object{1.0F};

    bool operator==(const Body &) const = default;
  };

 private:
  /** Inputs from which `texels_` was made. */
  struct Key {
    std::vector<Body> bodies;
    /** gpu::Device::loss_count */
    std::uint64_t losses = 0;

    bool operator==(const Key &) const = default;
  };
  /** The first texels: \see eevee_bodies_shared.h */
  using Head = std::array<glm::vec4, 2>;
  /** \a head: without the number of nodes. Does nothing if the texture has it. */
  void write_head(gpu::Device &device, Head head);

  /** Empty after an incomplete update. */
  std::optional<Key> key_;
  /** Empty if it is not written. */
  std::optional<Head> head_;
  std::size_t node_count_ = 0;
  gpu::Texture texels_;
  gpu::Sampler sampler_;
  /** Read by recorded passes, which may outlive a texture. */
  draw::TextureBinding texels_binding_;
  draw::TextureBinding picture_binding_;
  std::size_t triangle_count_ = 0;
  std::size_t left_out_ = 0;
};

}  // namespace gnomon::eevee
