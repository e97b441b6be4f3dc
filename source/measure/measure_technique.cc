// SPDX-License-Identifier: MIT
#include "measure_technique.hh"

#include <fmt/format.h>

#include <initializer_list>
#include <utility>

namespace gnomon::measure {

namespace {

using scene::ShadowKind;
using Sizes = std::initializer_list<int>;

/** More than any technique needs, so that no shadow map is made smaller. */
constexpr std::size_t memory_bytes_max = std::size_t(4) << 30U;

Technique maps(std::string name, int size_px, std::string options, const eevee::ShadowSettings &settings)
{
  Technique technique{std::move(name), size_px, settings, {1, 4, 16}, std::move(options)};
  technique.settings.cube_size_px = technique.settings.map_size_px = size_px;
  technique.settings.memory_bytes_max = memory_bytes_max;
  technique.options += fmt::format(" --shadow-size {} --shadow-memory {}", size_px, memory_bytes_max >> 20U);
  return technique;
}

Technique exponential(std::string name, int size_px, std::string options, ShadowKind kind,
                      const eevee::EsmSettings &esm)
{
  Technique technique{std::move(name), size_px, {}, {1, 4, 16}, std::move(options)};
  technique.settings.kind = kind;
  technique.settings.esm = esm;
  technique.settings.esm.size_px = size_px;
  technique.settings.memory_bytes_max = memory_bytes_max;
  if (!technique.options.empty()) {
    technique.options += fmt::format(" --shadow-size {} --shadow-memory {}", size_px, memory_bytes_max >> 20U);
  }
  return technique;
}

/** One map for each sun, so that only the size differs. */
constexpr eevee::CascadeSettings one_cascade = {.count = 1};

}  // namespace

std::string label(const Technique &technique)
{
  return technique.size_px > 0 ? fmt::format("{} {}", technique.name, technique.size_px) : technique.name;
}

std::vector<Technique> report_techniques()
{
  std::vector<Technique> all;
  all.push_back({"no shadow", 0, {.kind = ShadowKind::None}, {1, 4, 16}, "--shadow none"});
  for (const int size_px : Sizes{512, 1024, 2048, 4096}) {
    all.push_back(maps("hard", size_px, "--shadow hard --cascades 1", {.cascades = one_cascade}));
  }
  for (const int size_px : Sizes{1024, 2048}) {
    all.push_back(maps("hard, cascades", size_px, "--shadow hard", {}));
  }
  all.push_back(maps("hard, six passes", 1024, "--shadow hard --cascades 1 --cube-pass six",
                     {.cascades = one_cascade, .layer_pass = eevee::LayerPass::Single}));
  all.push_back(maps("hard, geometry shader", 1024, "--shadow hard --cascades 1 --cube-pass geometry",
                     {.cascades = one_cascade, .layer_pass = eevee::LayerPass::Geometry}));
  const auto add_pcf = [&all](const std::string &kernel, const eevee::PcfKernel &pcf, Sizes sizes) {
    for (const int size_px : sizes) {
      all.push_back(maps("pcf " + kernel, size_px, fmt::format("--shadow pcf --pcf {} --cascades 1", kernel),
                         {.kind = ShadowKind::Pcf, .pcf = pcf, .cascades = one_cascade}));
    }
  };
  add_pcf("3x3", {.width = 3, .taps = 0}, {512, 1024, 2048, 4096});
  add_pcf("5x5", {.width = 5, .taps = 0}, {1024, 2048});
  add_pcf("disk:16", {.width = 0, .taps = 16}, {1024, 2048});
  const auto add_esm = [&all](const std::string &name, const std::string &options, ShadowKind kind,
                              const eevee::EsmSettings &esm, Sizes sizes) {
    for (const int size_px : sizes) {
      all.push_back(exponential(name, size_px, options, kind, esm));
    }
  };
  using Kernel = eevee::EsmKernel;
  add_esm("esm 4", "--shadow esm --esm 4", ShadowKind::Esm, {.kernel = Kernel::Disk4}, {256, 512, 1024});
  add_esm("esm 32", "--shadow esm --esm 32", ShadowKind::Esm, {.kernel = Kernel::Disk32}, {1024});
  add_esm("esm separable", "--shadow esm --esm separable", ShadowKind::Esm, {.kernel = Kernel::Separable}, {1024});
  add_esm("esm 4, 16 bits", "", ShadowKind::Esm, {.format = eevee::EsmFormat::Half, .kernel = Kernel::Disk4}, {512});
  add_esm("evsm 4", "--shadow evsm --esm 4", ShadowKind::Evsm, {.kernel = Kernel::Disk4}, {256, 512, 1024});
  add_esm("evsm 32", "--shadow evsm --esm 32", ShadowKind::Evsm, {.kernel = Kernel::Disk32}, {512});
  // With many samples only the shadows' own error remains, so they are rendered where it is smallest.
  for (Technique &technique : all) {
    const std::string name = label(technique);
    if (name == "hard 4096" || name == "hard, cascades 2048" || name == "pcf 3x3 4096") {
      technique.sample_counts.push_back(64);
    }
  }
  return all;
}

std::vector<Technique> pilot_techniques()
{
  std::vector<Technique> all;
  for (const int size_px : Sizes{512, 1024, 2048, 4096}) {
    all.push_back(maps("hard, cascades", size_px, "--shadow hard", {}));
  }
  return all;
}

}  // namespace gnomon::measure
