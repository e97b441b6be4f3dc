// SPDX-License-Identifier: MIT
#include "eevee_texel_density.hh"

#include "gpu_error.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::eevee {

namespace {

/** At equal steps of the logarithm. */
constexpr std::array<glm::vec3, 5> colors = {
    glm::vec3(1.0F, 0.12F, 0.1F), {1.0F, 0.85F, 0.1F}, {0.2F, 0.85F, 0.25F}, {0.1F, 0.85F, 0.95F}, {0.2F, 0.3F, 1.0F}};
/** Part of the colour that remains where the picture is black. */
constexpr float color_min = 0.35F;

}  // namespace

glm::vec3 texel_density_color(float density)
{
  const float place = 0.5F + 0.5F * std::log2(density) / std::log2(texel_density_max);
  const float step = std::clamp(place, 0.0F, 1.0F) * float(colors.size() - 1);
  const std::size_t first = std::min(std::size_t(step), colors.size() - 2);
  return glm::mix(colors[first], colors[first + 1], step - float(first));
}

void show_texel_density(std::span<std::uint8_t> rgba, std::span<const float> density)
{
  GNOMON_ASSERT(rgba.size() == 4 * density.size(), "{} bytes for {} pixels", rgba.size(), density.size());
  for (std::size_t i = 0; i < density.size(); i++) {
    std::uint8_t *const pixel = &rgba[4 * i];
    const float brightness =
        glm::dot(glm::vec3(pixel[0], pixel[1], pixel[2]), glm::vec3(0.2126F, 0.7152F, 0.0722F)) / 255.0F;
    const glm::vec3 shown = density[i] > 0.0F ? texel_density_color(density[i]) * glm::mix(color_min, 1.0F, brightness)
                                              : glm::vec3(brightness);
    for (int channel = 0; channel < 3; channel++) {
      pixel[channel] = std::uint8_t(std::lround(255.0F * shown[channel]));
    }
  }
}

}  // namespace gnomon::eevee
