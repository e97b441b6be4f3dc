// SPDX-License-Identifier: MIT
#include "measure_technique.hh"

#include <fmt/format.h>

#include <initializer_list>
#include <string_view>
#include <type_traits>
#include <utility>

namespace gnomon::measure {

namespace {

using scene::ShadowKind;
using Sizes = std::initializer_list<int>;

/** More than any technique needs, so that no shadow map is made smaller. */
constexpr std::size_t memory_bytes_max = std::size_t(4) << 30U;

using Options = std::vector<std::string_view>;

/** \a settings with layers and maps of \a size_px, and the \a options that give them. */
Technique made(std::string name, int size_px, const eevee::ShadowSettings &settings, const Options &options)
{
  Technique technique{std::move(name), size_px, settings, {1, 4, 16}, {}};
  eevee::ShadowSettings &all = technique.settings;
  all.cube_size_px = all.map_size_px = all.esm.size_px = size_px;
  all.memory_bytes_max = memory_bytes_max;
  for (const std::string_view option : options) {
    std::string value;
    eevee::ShadowSettings::for_each_property([&](const auto &row) {
      using Value = typename std::decay_t<decltype(row)>::Value;
      if constexpr (!requires(Value one) { one.has_value(); }) {
        value = row.option == option ? scene::value_text(row, row.access(all)) : value;
      }
    });
    technique.options += fmt::format("{}--{} {}", technique.options.empty() ? "" : " ", option, value);
  }
  return technique;
}

/** One map for each sun, so that only the size differs. */
constexpr eevee::CascadeSettings one_cascade = {.count = 1};

const Options map_options{"shadow", "cascades", "shadow-size", "shadow-memory"};
const Options cascade_options{"shadow", "shadow-size", "shadow-memory"};

}  // namespace

std::string label(const Technique &technique)
{
  return technique.size_px > 0 ? fmt::format("{} {}", technique.name, technique.size_px) : technique.name;
}

std::vector<Technique> report_techniques()
{
  std::vector<Technique> all;
  all.push_back({"no shadow", 0, {.kind = ShadowKind::None}, {1, 4, 16}, "--shadow none"});
  const auto add = [&all](const std::string &name, Sizes sizes, const eevee::ShadowSettings &settings,
                          const Options &options) {
    for (const int size_px : sizes) {
      all.push_back(made(name, size_px, settings, options));
    }
  };
  add("hard", {512, 1024, 2048, 4096}, {.cascades = one_cascade}, map_options);
  add("hard, cascades", {1024, 2048}, {}, cascade_options);
  const Options pass_options{"shadow", "cascades", "cube-pass", "shadow-size", "shadow-memory"};
  add("hard, six passes", {1024}, {.cascades = one_cascade, .layer_pass = eevee::LayerPass::Single}, pass_options);
  add("hard, geometry shader", {1024}, {.cascades = one_cascade, .layer_pass = eevee::LayerPass::Geometry},
      pass_options);
  const auto add_pcf = [&add](const eevee::PcfKernel &pcf, Sizes sizes) {
    add("pcf " + text_of(pcf), sizes, {.kind = ShadowKind::Pcf, .pcf = pcf, .cascades = one_cascade},
        {"shadow", "pcf", "cascades", "shadow-size", "shadow-memory"});
  };
  add_pcf({.width = 3, .taps = 0}, {512, 1024, 2048, 4096});
  add_pcf({.width = 5, .taps = 0}, {1024, 2048});
  add_pcf({.width = 0, .taps = 16}, {1024, 2048});
  const auto add_esm = [&add](const std::string &name, ShadowKind kind, eevee::EsmKernel kernel, Sizes sizes) {
    add(name, sizes, {.kind = kind, .esm = {.kernel = kernel}}, {"shadow", "esm", "shadow-size", "shadow-memory"});
  };
  using Kernel = eevee::EsmKernel;
  add_esm("esm 4", ShadowKind::Esm, Kernel::Disk4, {256, 512, 1024});
  add_esm("esm 32", ShadowKind::Esm, Kernel::Disk32, {1024});
  add_esm("esm separable", ShadowKind::Esm, Kernel::Separable, {1024});
  // The format has no option.
  add("esm 4, 16 bits", {512}, {.kind = ShadowKind::Esm, .esm = {.format = eevee::EsmFormat::Half}}, {});
  add_esm("evsm 4", ShadowKind::Evsm, Kernel::Disk4, {256, 512, 1024});
  add_esm("evsm 32", ShadowKind::Evsm, Kernel::Disk32, {512});
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
    all.push_back(made("hard, cascades", size_px, {}, cascade_options));
  }
  return all;
}

}  // namespace gnomon::measure
