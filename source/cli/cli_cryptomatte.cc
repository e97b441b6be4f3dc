// SPDX-License-Identifier: MIT
#include "cli_cryptomatte.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <bit>
#include <utility>

namespace gnomon::cli {

Cryptomatte make_cryptomatte(const std::string &name, std::span<const std::vector<eevee::Coverage>> pixels,
                             std::span<const std::string> names)
{
  nlohmann::json manifest = nlohmann::json::object();
  for (const std::string &thing : names) {
    if (!thing.empty()) {
      manifest[thing] = fmt::format("{:08x}", std::bit_cast<std::uint32_t>(eevee::cryptomatte_id(thing)));
    }
  }
  Cryptomatte matte;
  for (const std::vector<glm::vec4> &pairs : eevee::cryptomatte_layers(pixels, names)) {
    Layer layer{fmt::format("{}{:02}", name, matte.layers.size()), "RGBA", {}};
    layer.values.reserve(4 * pairs.size());
    for (const glm::vec4 &pair : pairs) {
      layer.values.insert(layer.values.end(), {pair.x, pair.y, pair.z, pair.w});
    }
    matte.layers.push_back(std::move(layer));
  }
  const std::string key = fmt::format("cryptomatte/{:.7}/", fmt::format("{:08x}", eevee::murmur_hash3(name)));
  matte.metadata = {{key + "name", name},
                    {key + "hash", "MurmurHash3_32"},
                    {key + "conversion", "uint32_to_float32"},
                    {key + "manifest", manifest.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)}};
  return matte;
}

}  // namespace gnomon::cli
