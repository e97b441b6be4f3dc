// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_lamps.hh"

#include "draw_view.hh"
#include "eevee_light_cluster_shared.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::eevee {

/**
 * Lists of the lights that can reach the froxels of a view (\see shared::light_froxel). The list of a froxel contains
 * each light that reaches a point of it which the view shows, and may contain others. Lights that reach everywhere are
 * in no list. Needs no device.
 */
class LightClusters {
 public:
  /** Most values of all lists, unless there are more lights. */
  static constexpr std::size_t values_max = std::size_t(1) << 20U;

  /**
   * Make the lists of \a lamps for \a view. \a size_px: size of its picture. Views that are offset by up to a pixel
   * have the same lists. \a bounds_ws: of the surfaces. Lists are shortest within it, and complete everywhere. \a
   * device_values_max: most values that the device takes, at least 3 more than there are lights. The grid is coarsened
   * until its lists fit into both limits. The memory is reused, so that a build like the last one allocates nothing.
   */
  void build(const Lamps &lamps, const draw::View &view, glm::ivec2 size_px, const scene::Bounds &bounds_ws,
             std::size_t device_values_max = std::numeric_limits<std::size_t>::max());

  [[nodiscard]] const shared::LightClusterBlock &block() const
  {
    return block_;
  }
  /**
   * Content of `light_lists`: for each froxel the index of its first entry and the number of its entries before
   * Lamps::cube_light_count, then the index after the last entry, then the entries. Indices are whole numbers.
   */
  [[nodiscard]] std::span<const float> values() const
  {
    return values_;
  }
  [[nodiscard]] std::size_t froxel_count() const
  {
    return std::size_t(block_.column_count) * std::size_t(block_.row_count) * std::size_t(block_.slice_count);
  }
  [[nodiscard]] std::size_t entry_count() const
  {
    return run_entries_;
  }

 private:
  /** A plane through view space. A point is on the side of the higher index if dot(normal, point) + offset >= 0. */
  struct Plane {
    glm::vec3 normal{0.0F};
    float offset = 0.0F;

    [[nodiscard]] float distance(const glm::vec3 &point) const
    {
      return normal.x * point.x + normal.y * point.y + normal.z * point.z + offset;
    }
  };
  struct Sphere {
    /** View space. */
    glm::vec3 center{0.0F};
    float radius = 0.0F;
  };
  /** A light whose reach touches the view. */
  struct Local {
    Sphere sphere;
    std::uint32_t light = 0;
  };
  /** Depths, metres. */
  struct Slab {
    float near = 0.0F;
    float far = 0.0F;
  };
  /** The froxels from `first` on in a row, which a light can reach. */
  struct Run {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::uint32_t light = 0;
  };

  [[nodiscard]] static Slab visible_depths(const draw::View &view, const scene::Bounds &bounds_ws);
  void set_grid(const draw::View &view, glm::ivec2 size_px);
  void find_locals(const Lamps &lamps, const draw::View &view);
  void set_slices(const Slab &visible);
  /** \return false if there are more than \a most values */
  [[nodiscard]] bool find_runs(std::size_t most);
  /** Adds the runs of a light in a slice. \a part: contains the part of its reach that is in the slice. */
  void add_slice(const Sphere &part, int slice, std::uint32_t light);
  void add_row(const Sphere &part, int slice, int row, std::uint32_t light);
  void write_values();

  shared::LightClusterBlock block_{};
  /** The planes between the columns and between the rows, and those at both edges of the grid. */
  std::vector<Plane> columns_;
  std::vector<Plane> rows_;
  /** With a margin for rounding. */
  std::vector<Slab> slices_;
  /** Bound of the displacement by rounding in light_froxel: this fraction of the coordinates' magnitude, plus metres.
   */
  float rounding_ = 0.0F;
  float rounding_m_ = 0.0F;
  std::vector<Local> locals_;
  std::vector<Run> runs_;
  std::size_t run_entries_ = 0;
  /** For each froxel, the number of its entries; then the index after the last one that was written. */
  std::vector<std::uint32_t> ends_;
  std::vector<float> values_;
};

}  // namespace gnomon::eevee
