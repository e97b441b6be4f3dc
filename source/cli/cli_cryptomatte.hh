// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

/**
 * Cryptomatte 1.2 (Friedman and Jones, "Fully automatic ID mattes with support for motion blur and transparency",
 * Siggraph 2015; specification at github.com/Psyop/Cryptomatte): for each pixel, the things that cover it and the part
 * of the pixel that each covers, so that compositing programs make antialiased mattes of them by name.
 */
namespace gnomon::cli {

/** Layers and header entries of one kind of things. */
struct Cryptomatte {
  std::vector<Layer> layers;
  Metadata metadata;
};

/** MurmurHash3_x86_32 of Austin Appleby with the seed 0. */
[[nodiscard]] std::uint32_t murmur_hash3(std::string_view text);
/** The id of a name: its hash as a float, with a bit of the exponent flipped where it would not be a normal number. */
[[nodiscard]] float cryptomatte_id(std::string_view name);

/** Things that a pixel can have. Those that cover less are left out where there are more. */
inline constexpr int cryptomatte_rank_count = 6;

/**
 * \a name: of the layers, such as CryptoObject. \a pixels: things by index, and the parts that they cover, rows from
 * the bottom. \a names: of the things, by index; empty for indices that no pixel has. Things with equal names are one.
 */
[[nodiscard]] Cryptomatte make_cryptomatte(const std::string &name,
                                           std::span<const std::vector<std::pair<std::uint32_t, float>>> pixels,
                                           std::span<const std::string> names);

}  // namespace gnomon::cli
