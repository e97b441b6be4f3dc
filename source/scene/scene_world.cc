// SPDX-License-Identifier: MIT
#include "scene_world.hh"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gnomon::scene {

static std::string fault_of(const WorldPicture &picture)
{
  if (picture.width < 1 || picture.height < 1 ||
      picture.texels.size() != std::size_t(picture.width) * std::size_t(picture.height)) {
    return "has no texels, or not as many as its size says";
  }
  const auto is_radiance = [](float value) { return value >= 0.0F && std::isfinite(value); };
  const auto found = std::ranges::find_if_not(picture.texels, [&](const glm::vec3 &texel) {
    return is_radiance(texel.r) && is_radiance(texel.g) && is_radiance(texel.b);
  });
  if (found == picture.texels.end()) {
    return {};
  }
  const auto index = std::size_t(found - picture.texels.begin());
  const auto width = std::size_t(picture.width);
  const float value = !is_radiance(found->r) ? found->r : !is_radiance(found->g) ? found->g : found->b;
  return fmt::format("texel {}, {} from the top left is {}; texels must be finite and at least 0", index % width,
                     index / width, value);
}

std::string fault_of(const World &world)
{
  const auto is_factor = [](float value) { return value >= 0.0F && value <= 1e30F; };
  if (!is_factor(world.color.r) || !is_factor(world.color.g) || !is_factor(world.color.b) ||
      !is_factor(world.strength) || !std::isfinite(world.rotation)) {
    return "its colour and strength must be numbers of at least 0, and its rotation a number";
  }
  if (!world.picture) {
    return {};
  }
  const std::string &path = world.picture->path;
  const std::string fault = fault_of(*world.picture);
  return fault.empty() ? fault : fmt::format("its picture{}: {}", path.empty() ? "" : " '" + path + "'", fault);
}

}  // namespace gnomon::scene
