// SPDX-License-Identifier: MIT
#include "scene_studio.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gnomon::scene {

namespace {

constexpr double pi = std::numbers::pi;

/** A round light with a soft rim. */
struct SoftBox {
  /** Around +Y from the camera, positive to its left, and above the horizon; radians. */
  double azimuth;
  double elevation;
  /** Radians. */
  double radius;
  double radiance;
};

constexpr std::array<SoftBox, 3> boxes = {{
    {0.9, 0.75, 0.32, 6.0},
    {-1.1, 0.35, 0.45, 0.9},
    {-2.6, 0.8, 0.25, 5.0},
}};

/** Unit vector; an azimuth of 0 is +X, which studio_world turns to the camera. */
glm::dvec3 direction(double azimuth, double elevation)
{
  return {std::cos(elevation) * std::cos(azimuth), std::sin(elevation), std::cos(elevation) * std::sin(azimuth)};
}

std::shared_ptr<const WorldPicture> studio_picture()
{
  WorldPicture picture{256, 128, {}};
  for (int y = 0; y < picture.height; y++) {
    const double elevation = (0.5 - (y + 0.5) / picture.height) * pi;
    for (int x = 0; x < picture.width; x++) {
      const double azimuth = ((x + 0.5) / picture.width - 0.5) * 2.0 * pi;
      const glm::dvec3 to_world = direction(azimuth, elevation);
      // From the floor to the ceiling.
      double radiance = glm::mix(0.16, 0.5, glm::smoothstep(-0.5, 1.0, std::sin(elevation)));
      for (const SoftBox &box : boxes) {
        const double angle =
            std::acos(std::clamp(glm::dot(to_world, direction(box.azimuth, box.elevation)), -1.0, 1.0));
        radiance += box.radiance * (1.0 - glm::smoothstep(0.9 * box.radius, 1.1 * box.radius, angle));
      }
      picture.texels.emplace_back(radiance);
    }
  }
  return std::make_shared<const WorldPicture>(std::move(picture));
}

}  // namespace

World studio_world(const glm::dmat4 &world_from_camera)
{
  // The camera is where its +Z points, seen from the scene.
  const glm::dvec3 back(world_from_camera[2]);
  return {.rotation = float(std::atan2(-back.z, back.x)), .picture = studio_picture()};
}

}  // namespace gnomon::scene
