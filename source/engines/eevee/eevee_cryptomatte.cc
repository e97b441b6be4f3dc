// SPDX-License-Identifier: MIT
#include "eevee_cryptomatte.hh"

#include <algorithm>
#include <bit>

namespace gnomon::eevee {

std::uint32_t murmur_hash3(std::string_view text)
{
  const auto byte = [&](std::size_t i) { return std::uint32_t(std::uint8_t(text[i])); };
  const auto mixed = [](std::uint32_t block) { return std::rotl(block * 0xCC9E2D51U, 15) * 0x1B873593U; };
  std::uint32_t hash = 0;
  const std::size_t whole = text.size() / 4 * 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    hash ^= mixed(byte(i) | byte(i + 1) << 8U | byte(i + 2) << 16U | byte(i + 3) << 24U);
    hash = std::rotl(hash, 13) * 5U + 0xE6546B64U;
  }
  std::uint32_t rest = 0;
  for (std::size_t i = text.size(); i-- > whole;) {
    rest = rest << 8U | byte(i);
  }
  hash ^= mixed(rest) ^ std::uint32_t(text.size());
  hash = (hash ^ hash >> 16U) * 0x85EBCA6BU;
  hash = (hash ^ hash >> 13U) * 0xC2B2AE35U;
  return hash ^ hash >> 16U;
}

float cryptomatte_id(std::string_view name)
{
  std::uint32_t bits = murmur_hash3(name);
  const std::uint32_t exponent = bits >> 23U & 0xFFU;
  if (exponent == 0 || exponent == 0xFFU) {
    bits ^= 1U << 23U;
  }
  return std::bit_cast<float>(bits);
}

std::vector<std::string> object_names(SceneRenderer &renderer, bool has_materials)
{
  const scene::Scene &scene = renderer.render_scene().scene();
  const draw::ObjectBuffer &objects = renderer.render_scene().objects();
  std::vector<std::string> names(objects.index_end());
  for (draw::ObjectIndex i = draw::object_identity + 1; i < objects.index_end(); i++) {
    if (objects.is_live(i)) {
      const render_scene::RenderObject &object = renderer.render_scene().object(i);
      names[i] = has_materials ? scene.material_of(scene.meshes()[object.mesh]).name : scene.nodes()[object.node].name;
      names[i] = names[i].empty() ? "unnamed" : names[i];
    }
  }
  return names;
}

CryptomatteLayers cryptomatte_layers(std::span<const std::vector<Coverage>> pixels, std::span<const std::string> names)
{
  std::vector<float> ids;
  std::ranges::transform(names, std::back_inserter(ids), cryptomatte_id);
  CryptomatteLayers layers;
  for (std::vector<glm::vec4> &layer : layers) {
    layer.assign(pixels.size(), glm::vec4(0.0F));
  }
  std::vector<std::pair<float, float>> ranks;
  for (std::size_t i = 0; i < pixels.size(); i++) {
    ranks.clear();
    for (const auto &[object, coverage] : pixels[i]) {
      const float id = ids[object];
      const auto found = std::ranges::find(ranks, id, &std::pair<float, float>::first);
      if (found != ranks.end()) {
        found->second += coverage;
      }
      else {
        ranks.emplace_back(id, coverage);
      }
    }
    std::ranges::stable_sort(ranks, [](const auto &a, const auto &b) { return a.second > b.second; });
    for (std::size_t rank = 0; rank < std::min(ranks.size(), 2 * cryptomatte_layer_count); rank++) {
      glm::vec4 &values = layers[rank / 2][i];
      const int first = int(rank % 2) * 2;
      values[first] = ranks[rank].first;
      values[first + 1] = ranks[rank].second;
    }
  }
  return layers;
}

}  // namespace gnomon::eevee
