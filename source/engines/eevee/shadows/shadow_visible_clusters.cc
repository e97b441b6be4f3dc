// SPDX-License-Identifier: MIT
#include "shadow_visible_clusters.hh"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gnomon::eevee {

namespace {

/** Edge of the squares of pixels. */
constexpr int square_px = 16;

/** Conversions between depths, distances and positions of a view. */
class DepthScale {
 public:
  explicit DepthScale(const draw::View &view)
      : projection_(view.clip_from_view()),
        world_from_view_(glm::inverse(glm::dmat4(view.view_from_world()))),
        is_perspective_(view.is_perspective())
  {
  }

  /** Distance along the view direction, metres. */
  [[nodiscard]] double distance(double depth) const
  {
    return is_perspective_ ? projection_[3][2] / (depth + projection_[2][2])
                           : (projection_[3][2] - depth) / projection_[2][2];
  }
  /** The number whose even division gives the ranges. */
  [[nodiscard]] float scale(double distance) const
  {
    return is_perspective_ ? std::log2(float(std::max(distance, 1e-30))) : float(distance);
  }
  [[nodiscard]] glm::dvec3 position_ws(const glm::dvec2 &ndc, double distance) const
  {
    const double w = is_perspective_ ? distance : 1.0;
    const glm::dvec2 offset(-distance * projection_[2][0] + projection_[3][0],
                            -distance * projection_[2][1] + projection_[3][1]);
    return glm::dvec3(world_from_view_ * glm::dvec4((ndc.x * w - offset.x) / projection_[0][0],
                                                    (ndc.y * w - offset.y) / projection_[1][1], -distance, 1.0));
  }

 private:
  glm::dmat4 projection_;
  glm::dmat4 world_from_view_;
  bool is_perspective_;
};

/** The pixels of a square in one range. */
struct SquarePart {
  float nearest = 0.0F;
  float farthest = std::numeric_limits<float>::max();
  int pixel_count = 0;
};

}  // namespace

std::vector<VisibleCluster> visible_clusters(const PictureDepths &picture, std::vector<VisibleCluster> memory)
{
  std::vector<VisibleCluster> clusters = std::move(memory);
  clusters.clear();
  float nearest = 0.0F;
  float farthest = std::numeric_limits<float>::max();
  for (const float depth : picture.depths) {
    if (depth > 0.0F) {
      nearest = std::max(nearest, depth);
      farthest = std::min(farthest, depth);
    }
  }
  if (nearest == 0.0F) {
    return clusters;
  }
  const DepthScale scale(picture.view);
  const float scale_first = scale.scale(scale.distance(nearest));
  const float scale_length = scale.scale(scale.distance(farthest)) - scale_first;
  const float ranges_per_scale = scale_length > 0.0F ? float(distance_range_count) / scale_length : 0.0F;
  const glm::ivec2 size_px = picture.size_px;
  for (int y = 0; y < size_px.y; y += square_px) {
    for (int x = 0; x < size_px.x; x += square_px) {
      const glm::ivec2 first(x, y);
      const glm::ivec2 end = glm::min(first + square_px, size_px);
      std::array<SquarePart, distance_range_count> parts;
      for (int row = first.y; row < end.y; row++) {
        for (int column = first.x; column < end.x; column++) {
          const float depth = picture.depths[std::size_t(row) * std::size_t(size_px.x) + std::size_t(column)];
          if (depth > 0.0F) {
            const float along = (scale.scale(scale.distance(depth)) - scale_first) * ranges_per_scale;
            SquarePart &part = parts[std::size_t(std::clamp(int(along), 0, distance_range_count - 1))];
            part.nearest = std::max(part.nearest, depth);
            part.farthest = std::min(part.farthest, depth);
            part.pixel_count++;
          }
        }
      }
      const glm::dvec2 low = 2.0 * glm::dvec2(first) / glm::dvec2(size_px) - 1.0;
      const glm::dvec2 high = 2.0 * glm::dvec2(end) / glm::dvec2(size_px) - 1.0;
      for (int range = 0; range < distance_range_count; range++) {
        const SquarePart &part = parts[std::size_t(range)];
        if (part.pixel_count == 0) {
          continue;
        }
        const double near = scale.distance(part.nearest);
        const double far = scale.distance(part.farthest);
        const double margin = 0.01 * std::max(std::abs(near), std::abs(far));
        VisibleCluster &cluster = clusters.emplace_back();
        cluster.range = range;
        cluster.square = first / square_px;
        cluster.distance = 0.5 * (near + far);
        cluster.pixel_count = part.pixel_count;
        for (std::size_t i = 0; i < 8; i++) {
          const glm::dvec2 ndc((i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y);
          cluster.corners_ws[i] = scale.position_ws(ndc, (i & 4U) != 0 ? far + margin : near - margin);
        }
      }
    }
  }
  return clusters;
}

}  // namespace gnomon::eevee
