// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_programs.hh"

#include <algorithm>
#include <array>
#include <set>
#include <vector>

namespace gnomon::test {

/** Each two features that are on or off, and the numbers of both. */
using FeaturePair = std::array<std::uint32_t, 2>;

inline std::set<FeaturePair> feature_pairs(const eevee::ShaderDeclaration &declaration, eevee::Feature features)
{
  std::set<FeaturePair> pairs;
  const auto all = std::uint32_t(declaration.features);
  const auto value_of = [&](int bit) { return 2U * std::uint32_t(bit) + (std::uint32_t(features) >> bit & 1U); };
  for (int i = 0; i < 32; i++) {
    for (int j = i; j < 32; j++) {
      if ((all >> i & all >> j & 1U) != 0) {
        pairs.insert({value_of(i), value_of(j)});
      }
    }
  }
  return pairs;
}

/** A few variants in which each two features have every combination that they have in all variants. */
inline std::vector<eevee::Feature> pairwise_variants(const eevee::ShaderDeclaration &declaration)
{
  const std::vector<eevee::Feature> all = eevee::shader_variants(declaration);
  std::set<FeaturePair> missing;
  for (const eevee::Feature features : all) {
    missing.merge(feature_pairs(declaration, features));
  }
  std::vector<eevee::Feature> chosen;
  do {
    std::size_t most = 0;
    eevee::Feature best = all.front();
    for (const eevee::Feature features : all) {
      const std::set<FeaturePair> pairs = feature_pairs(declaration, features);
      const auto added =
          std::size_t(std::ranges::count_if(pairs, [&](const FeaturePair &pair) { return missing.contains(pair); }));
      if (added > most) {
        most = added;
        best = features;
      }
    }
    chosen.push_back(best);
    for (const FeaturePair &pair : feature_pairs(declaration, best)) {
      missing.erase(pair);
    }
  } while (!missing.empty());
  return chosen;
}

}  // namespace gnomon::test
