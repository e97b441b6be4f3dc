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
  std::string number_fault;
  World::for_each_property([&](const auto &row) {
    for_each_number(world.*row.member, [&](double value) {
      if (!row.allows(value)) {
        number_fault = fmt::format("its {} is {:g}, and must be {}", row.name, value, range_text(row));
      }
    });
  });
  if (!number_fault.empty()) {
    return number_fault;
  }
  if (!world.picture) {
    return {};
  }
  const std::string &path = world.picture->path;
  const std::string fault = fault_of(*world.picture);
  return fault.empty() ? fault : fmt::format("its picture{}: {}", path.empty() ? "" : " '" + path + "'", fault);
}

}  // namespace gnomon::scene
