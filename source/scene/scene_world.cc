// SPDX-License-Identifier: MIT
#include "scene_world.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

namespace gnomon::scene {

/** The greatest radiance, of a texel alone and of the whole world. */
constexpr auto radiance_max = float(light_max);

static std::string fault_of(const WorldPicture &picture)
{
  if (picture.width < 1 || picture.height < 1 ||
      picture.texels.size() != std::size_t(picture.width) * std::size_t(picture.height)) {
    return "has no texels, or not as many as its size says";
  }
  const auto is_radiance = [](float value) { return value >= 0.0F && value <= radiance_max; };
  const auto found = std::ranges::find_if_not(picture.texels, [&](const glm::vec3 &texel) {
    return is_radiance(texel.r) && is_radiance(texel.g) && is_radiance(texel.b);
  });
  if (found == picture.texels.end()) {
    return {};
  }
  const auto index = std::size_t(found - picture.texels.begin());
  const auto width = std::size_t(picture.width);
  const float value = !is_radiance(found->r) ? found->r : !is_radiance(found->g) ? found->g : found->b;
  return fmt::format("texel {}, {} from the top left is {}; texels must be from 0 to {:g}", index % width,
                     index / width, value, light_max);
}

/** The color and strength of \a world. */
static glm::dvec3 factor_of(const World &world)
{
  return double(world.strength) * glm::dvec3(world.color);
}

/** Whether a component of a radiance is more than `radiance_max`. */
static bool is_beyond(const glm::dvec3 &radiance)
{
  return std::max({radiance.r, radiance.g, radiance.b}) > double(radiance_max);
}

/** The largest value of up to \a value whose product with \a factor is not beyond. */
static float limited(float value, double factor)
{
  const double max = double(radiance_max);
  if (double(value) * factor <= max) {
    return value;
  }
  const auto rounded = float(max / factor);
  return double(rounded) * factor <= max ? rounded : std::nextafter(rounded, 0.0F);
}

static glm::vec3 limited(const glm::vec3 &value, const glm::dvec3 &factor)
{
  return {limited(value.r, factor.r), limited(value.g, factor.g), limited(value.b, factor.b)};
}

/** Places of texels, for a warning. */
struct TexelCount {
  std::size_t count = 0;
  std::size_t first = 0;

  void add(std::size_t index)
  {
    first = count == 0 ? index : first;
    count++;
  }
  /** \a kind: what the texels are */
  [[nodiscard]] std::string text(const WorldPicture &picture, std::string_view kind) const
  {
    const auto width = std::size_t(std::max(picture.width, 1));
    return fmt::format("{} of {} texels {} (the first at {}, {} from the top left)", count, picture.texels.size(), kind,
                       first % width, first / width);
  }
};

std::string clamp_radiances(WorldPicture &picture)
{
  struct Kind {
    std::string name;
    TexelCount texels{};
  };
  std::array<Kind, 4> kinds{{{"negative"}, {"not a number"}, {"infinite"}, {fmt::format("above {:g}", light_max)}}};
  glm::vec3 largest(0.0F);
  for (std::size_t i = 0; i < picture.texels.size(); i++) {
    std::array<bool, 4> is_kind{};
    for (int c = 0; c < 3; c++) {
      const float value = picture.texels[i][c];
      is_kind[0] = is_kind[0] || value < 0.0F;
      is_kind[1] = is_kind[1] || std::isnan(value);
      is_kind[2] = is_kind[2] || value == std::numeric_limits<float>::infinity();
      is_kind[3] = is_kind[3] || (std::isfinite(value) && value > radiance_max);
      largest[c] = std::isfinite(value) ? std::max(largest[c], value) : largest[c];
    }
    for (std::size_t k = 0; k < kinds.size(); k++) {
      if (is_kind[k]) {
        kinds[k].texels.add(i);
      }
    }
  }
  std::string text;
  for (const Kind &kind : kinds) {
    if (kind.texels.count > 0) {
      text += (text.empty() ? "" : ", ") + kind.texels.text(picture, kind.name);
    }
  }
  if (text.empty()) {
    return text;
  }
  for (glm::vec3 &texel : picture.texels) {
    for (int c = 0; c < 3; c++) {
      // False for NaN, too.
      texel[c] = texel[c] > 0.0F ? std::min({texel[c], largest[c], radiance_max}) : 0.0F;
    }
  }
  return text + fmt::format(": clamped to 0 and the largest finite value, at most {:g}", light_max);
}

/** Which radiances of \a world are beyond, its color and strength multiplied; empty: none. */
static std::string beyond_of(const World &world)
{
  const glm::dvec3 factor = factor_of(world);
  if (!world.picture) {
    return is_beyond(factor) ? fmt::format("its color times its strength is {:g}, {:g}, {:g}, which is above {:g}",
                                           factor.r, factor.g, factor.b, light_max)
                             : std::string();
  }
  TexelCount beyond;
  for (std::size_t i = 0; i < world.picture->texels.size(); i++) {
    if (is_beyond(factor * glm::dvec3(world.picture->texels[i]))) {
      beyond.add(i);
    }
  }
  const std::string kind = fmt::format("above {:g} by its color and strength", light_max);
  return beyond.count > 0 ? "its picture: " + beyond.text(*world.picture, kind) : std::string();
}

std::string limit_radiances(World &world)
{
  const std::string beyond = beyond_of(world);
  if (beyond.empty()) {
    return beyond;
  }
  if (world.picture) {
    WorldPicture picture = *world.picture;
    for (glm::vec3 &texel : picture.texels) {
      texel = limited(texel, factor_of(world));
    }
    world.picture = std::make_shared<const WorldPicture>(std::move(picture));
  }
  else {
    world.color = limited(world.color, glm::dvec3(world.strength));
  }
  return fmt::format("{}: clamped to {:g}", beyond, light_max);
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
  if (world.picture) {
    const std::string &path = world.picture->path;
    if (const std::string fault = fault_of(*world.picture); !fault.empty()) {
      return fmt::format("its picture{}: {}", path.empty() ? "" : " '" + path + "'", fault);
    }
  }
  return beyond_of(world);
}

}  // namespace gnomon::scene
