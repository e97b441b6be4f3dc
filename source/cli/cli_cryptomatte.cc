// SPDX-License-Identifier: MIT
#include "cli_cryptomatte.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>

namespace gnomon::cli {

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

Cryptomatte make_cryptomatte(const std::string &name,
                             std::span<const std::vector<std::pair<std::uint32_t, float>>> pixels,
                             std::span<const std::string> names)
{
  std::vector<float> ids;
  nlohmann::json manifest = nlohmann::json::object();
  for (const std::string &thing : names) {
    ids.push_back(cryptomatte_id(thing));
    if (thing.empty()) {
      continue;
    }
    manifest[thing] = fmt::format("{:08x}", std::bit_cast<std::uint32_t>(ids.back()));
  }
  Cryptomatte matte;
  // Each layer holds two ranks: id, coverage, id, coverage.
  for (int i = 0; i < cryptomatte_rank_count / 2; i++) {
    matte.layers.push_back({fmt::format("{}{:02}", name, i), "RGBA", std::vector<float>(4 * pixels.size(), 0.0F)});
  }
  std::vector<std::pair<float, float>> ranks;
  for (std::size_t i = 0; i < pixels.size(); i++) {
    ranks.clear();
    for (const auto &[thing, coverage] : pixels[i]) {
      const float id = ids[thing];
      const auto found = std::ranges::find(ranks, id, &std::pair<float, float>::first);
      if (found != ranks.end()) {
        found->second += coverage;
      }
      else {
        ranks.emplace_back(id, coverage);
      }
    }
    std::ranges::sort(ranks, [](const auto &a, const auto &b) { return a.second > b.second; });
    for (std::size_t rank = 0; rank < std::min(ranks.size(), std::size_t(cryptomatte_rank_count)); rank++) {
      float *values = &matte.layers[rank / 2].values[4 * i + rank % 2 * 2];
      values[0] = ranks[rank].first;
      values[1] = ranks[rank].second;
    }
  }
  const std::string key = fmt::format("cryptomatte/{:.7}/", fmt::format("{:08x}", murmur_hash3(name)));
  matte.metadata = {{key + "name", name},
                    {key + "hash", "MurmurHash3_32"},
                    {key + "conversion", "uint32_to_float32"},
                    {key + "manifest", manifest.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)}};
  return matte;
}

}  // namespace gnomon::cli
