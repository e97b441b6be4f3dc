// SPDX-License-Identifier: MIT
#include "eevee_engine.hh"
#include "eevee_engine_data.hh"

namespace gnomon::eevee {

Report Engine::report(draw::Viewport &viewport) const
{
  const Data &data = viewport.engine_data<Data>(*this);
  const StorageList &stl = data.stl;
  Report report;
  report.warnings = stl.lamps.warnings;
  report.warnings.insert(report.warnings.end(), stl.shadows.warnings().begin(), stl.shadows.warnings().end());
  report.limits = stl.lamps.limits;
  report.limits.insert(report.limits.end(), stl.shadows.limits().begin(), stl.shadows.limits().end());
  report.shadow_counters = stl.shadows.counters();

  const auto part = [&](std::string what, bool is_made, std::string why, std::string why_not) {
    report.parts.push_back({std::move(what), is_made, is_made ? std::move(why) : std::move(why_not)});
  };
  const Feature f = stl.features;
  const std::string no_shadow = settings_.shadow.kind == scene::ShadowKind::None ? "shadows are off" : "no such lamp";
  part("light_block", has(f, Feature::Light), fmt::format("{} lights", stl.lamps.light_block.light_count),
       "no lamp gives light");
  part("shadow_cubes", has(f, Feature::ShadowCube),
       fmt::format("{} point lamps or wide spots", stl.shadows.cube_count()), no_shadow);
  part("shadow_maps", has(f, Feature::ShadowMap), fmt::format("{} suns or spots", stl.shadows.map_count()), no_shadow);
  part("shadow_esm", has(f, Feature::ShadowEsm),
       fmt::format("{} point lamps or spots", stl.shadows.octahedral().size()), no_shadow);
  part("shadow_pass", !data.psl->shadow_pass.is_empty(), "casters for the lamps' shadows",
       has(f, any_shadow) ? "no caster" : "no shadow");
  part("depth_pass", !data.psl->depth_pass.is_empty(), "two-sided materials", "no object with a two-sided material");
  part("depth_pass_cull", !data.psl->depth_pass_cull.is_empty(), "one-sided materials",
       "no object with a one-sided material");
  part("base colour textures", stl.textures.image_count() > 0,
       fmt::format("{} images that materials look up", stl.textures.image_count()),
       "no lit or cut out material has one");
  part("specular in eevee_lit", has(f, Feature::Specular), "a material reflects",
       has(f, Feature::Light) ? "every material is Lambertian" : "no lamp gives light");
  part("cascade tint", stl.tinted_light.has_value(), "asked for",
       settings_.has_cascade_tint ? "no sun has a shadow" : "not asked for");
  part("film", true, fmt::format("{} samples a pixel", settings_.sample_count), "");
  part("tonemap", bool(data.txl.display), "a display picture was asked for", "only radiance was asked for");
  part("programs", stl.shaders.size() > 0, fmt::format("{} programs", stl.shaders.size()), "nothing to draw");
  return report;
}

}  // namespace gnomon::eevee
