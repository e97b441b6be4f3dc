// SPDX-License-Identifier: MIT
#include "internal/eevee_lut.hh"
#include "internal/eevee_resource_report.hh"

#include "eevee_multiscatter_shared.h"
#include "eevee_shape_shared.h"
#include "eevee_tables.hh"

namespace gnomon::eevee {

/** Create \a table if \a is_needed, otherwise free it. */
static void update(gpu::Texture &table, gpu::Device &device, const char *name, bool is_needed, glm::ivec2 size,
                   std::span<const float> (*texels)())
{
  if (!is_needed) {
    table = {};
  }
  else if (!table) {
    table = device.create_texture({.name = name, .format = gpu::Format::RGBA32F, .width = size.x, .height = size.y});
    device.upload(table, 0, std::as_bytes(texels()));
  }
}

void LookupTables::make(gpu::Device &device, Feature features, Feature read)
{
  const bool has_light = has(read, Feature::Light);
  // With multiple scattering, the world's light reads its table of albedos.
  const bool has_multiscatter = has_light && has(read, Feature::Multiscatter);
  const Feature of_ltc = has_multiscatter ? Feature::LampShape : Feature::LampShape | Feature::World;
  const bool has_ltc =
      has_light && (has(read, Feature::Layers) || (has(features, of_ltc) && has(features, Feature::Specular)));
  update(ltc_, device, "ltc_table", has_ltc, {2 * LTC_TABLE_SIZE, LTC_TABLE_SIZE}, ltc_table);
  update(multiscatter_, device, "multiscatter_table", has_multiscatter, glm::ivec2(MULTISCATTER_TABLE_SIZE),
         multiscatter_table);
  if ((has_ltc || has_multiscatter) && !sampler_) {
    sampler_ = device.create_sampler({.name = "table_sampler", .filter = gpu::Filter::Linear});
  }
}

void LookupTables::bind(draw::ShadingGroup &group) const
{
  if (ltc_) {
    group.bind_texture("ltc_table", ltc_, sampler_);
  }
  if (multiscatter_) {
    group.bind_texture("multiscatter_table", multiscatter_, sampler_);
  }
}

void LookupTables::report(ResourceReport &report) const
{
  const bool has_light = report.has(Feature::LampShape | Feature::World);
  report.add_target(ltc_, "ltc_table", "specular light of lamps with an extent and of the world; sheen",
                    report.why_no_feature(has_light ? Feature::Specular : Feature::LampShape));
  report.add_target(multiscatter_, "multiscatter_table", "albedos, for light that microfacets reflect more than once",
                    report.why_no_feature(Feature::Multiscatter));
}

}  // namespace gnomon::eevee
