// SPDX-License-Identifier: MIT
#include "scene_world.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

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

std::string clamp_radiances(WorldPicture &picture)
{
  struct Kind {
    std::string_view name;
    std::size_t count = 0;
    std::size_t first = 0;
  };
  std::array<Kind, 3> kinds{{{"negative"}, {"not a number"}, {"infinite"}}};
  glm::vec3 largest(0.0F);
  for (std::size_t i = 0; i < picture.texels.size(); i++) {
    std::array<bool, 3> is_kind{};
    for (int c = 0; c < 3; c++) {
      const float value = picture.texels[i][c];
      is_kind[0] = is_kind[0] || value < 0.0F;
      is_kind[1] = is_kind[1] || std::isnan(value);
      is_kind[2] = is_kind[2] || value == std::numeric_limits<float>::infinity();
      largest[c] = std::isfinite(value) ? std::max(largest[c], value) : largest[c];
    }
    for (std::size_t k = 0; k < kinds.size(); k++) {
      if (is_kind[k]) {
        kinds[k].first = kinds[k].count == 0 ? i : kinds[k].first;
        kinds[k].count++;
      }
    }
  }
  std::string text;
  for (const Kind &kind : kinds) {
    if (kind.count > 0) {
      const auto width = std::size_t(std::max(picture.width, 1));
      text += fmt::format("{}{} of {} texels {} (the first at {}, {} from the top left)", text.empty() ? "" : ", ",
                          kind.count, picture.texels.size(), kind.name, kind.first % width, kind.first / width);
    }
  }
  if (text.empty()) {
    return text;
  }
  for (glm::vec3 &texel : picture.texels) {
    for (int c = 0; c < 3; c++) {
      // False for NaN, too.
      texel[c] = texel[c] > 0.0F ? std::min(texel[c], largest[c]) : 0.0F;
    }
  }
  return text + ": clamped to 0 and the largest finite value";
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
