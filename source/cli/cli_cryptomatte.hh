// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"
#include "eevee_cryptomatte.hh"

namespace gnomon::cli {

/** Layers and header entries of one kind of things in an EXR file. */
struct Cryptomatte {
  std::vector<Layer> layers;
  Metadata metadata;
};

/** \a name: of the layers, such as CryptoObject. For the others, \see eevee::cryptomatte_layers */
[[nodiscard]] Cryptomatte make_cryptomatte(const std::string &name,
                                           std::span<const std::vector<eevee::Coverage>> pixels,
                                           std::span<const std::string> names);

}  // namespace gnomon::cli
