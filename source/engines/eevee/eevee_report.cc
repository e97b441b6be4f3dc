// SPDX-License-Identifier: MIT
// The report of a frame: the items that were made or left out. It reads the same state as the drawing code.
#include "internal/eevee_material_variants.hh"
#include "internal/eevee_report_source.hh"
#include "internal/eevee_surface_functions.hh"

#include "eevee_inspection.hh"
#include "render_blend_order.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <bit>

namespace gnomon::eevee {

const FrameNode *find(const FrameNode &node, std::string_view what)
{
  const auto found = std::ranges::find(node.children, what, &FrameNode::what);
  return found == node.children.end() ? nullptr : &*found;
}

namespace {

/** The name of a variant, for example "LIGHT|PUNCTUAL", and the purposes of its features. */
std::pair<std::string, std::string> variant_text(Feature features, std::string_view purpose)
{
  std::vector<std::string_view> names;
  std::vector<std::string_view> purposes;
  for (const FeatureDefine &define : feature_defines()) {
    if (has(features, define.feature)) {
      names.push_back(std::string_view(define.define).substr(std::string_view("USE_").size()));
      purposes.push_back(define.purpose);
    }
  }
  return {names.empty() ? "plain" : fmt::format("{}", fmt::join(names, "|")),
          purposes.empty() ? std::string(purpose) : fmt::format("{}", fmt::join(purposes, "; "))};
}

FrameNode program_nodes(const ReportSource &source)
{
  std::vector<FrameNode> programs;
  Feature made_features = Feature::None;
  for (const ShaderDeclaration &declaration : shader_declarations()) {
    const std::vector<Feature> made = source.shaders.made(declaration.id);
    const std::size_t possible = shader_variants(declaration).size();
    FrameNode &node = programs.emplace_back(FrameNode{
        .what = std::string(declaration.name), .is_made = !made.empty(), .why = std::string(declaration.purpose)});
    node.count = made.size();
    if (made.empty()) {
      node.why = why_no_program(source, declaration.id);
      continue;
    }
    if (possible > 1) {
      node.why += fmt::format("; {} of {} possible variants", made.size(), possible);
      for (const Feature features : made) {
        auto [what, why] = variant_text(features, declaration.purpose);
        node.children.push_back({.what = std::move(what), .is_made = true, .why = std::move(why)});
      }
    }
    for (const Feature features : made) {
      made_features = made_features | features;
    }
  }
  std::vector<FrameNode> features;
  for (const FeatureDefine &define : feature_defines()) {
    const bool is_made = has(made_features, define.feature);
    features.push_back({.what = define.define,
                        .is_made = is_made,
                        .why = is_made                   ? std::string(define.purpose)
                               : source.data.is_recorded ? why_no_feature(source, define.feature)
                                                         : nothing_seen});
  }
  programs.insert(programs.begin(), folder("features", "features of the variants", "no created program has a feature",
                                           std::move(features)));
  FrameNode node = folder("programs", "what passes draw with", nothing_seen, std::move(programs));
  node.count = source.shaders.size();
  return node;
}

FrameNode pass_node(const DrawnStep &drawn, std::size_t index, const FrameState &state)
{
  const FramePass &pass = drawn.step.passes[index];
  const DrawnStep::PassRecord &record = drawn.passes[index];
  return {.what = pass.pass->name(),
          .is_made = record.runs > 0,
          .why = std::string(reason_of(pass, record, state)),
          .count = record.runs};
}

FrameNode shadow_step_node(const ReportSource &source, const Need &need)
{
  std::uint64_t layers = 0;
  for (const ShadowState &state : source.data.shadows.states()) {
    layers += std::uint64_t(std::popcount(state.drawn_now));
  }
  return {.what = "shadows",
          .is_made = layers > 0,
          .why = layers == 0 && need.is_needed ? "all needed layers are up to date" : std::string(need.reason),
          .count = layers};
}

/**
 * A node that lists the resources that \a step reads, each with the last step in \a drawn_before that wrote it.
 * \a live: names of all resources.
 */
FrameNode read_node(const FrameStep &step, std::span<const FrameStep *const> drawn_before,
                    const std::set<std::string_view> &live)
{
  std::vector<std::string> reads;
  for (const FrameRead &read : step.reads) {
    const std::string_view name = read.name;
    const auto writer = std::ranges::find_if(drawn_before.rbegin(), drawn_before.rend(), [&](const FrameStep *before) {
      return std::ranges::find(before->writes, name) != before->writes.end();
    });
    if (writer != drawn_before.rend() && live.contains(name)) {
      reads.push_back(fmt::format("{} of {}", name, (*writer)->name));
    }
  }
  return {.what = "reads", .is_made = !reads.empty(), .why = fmt::format("{}", fmt::join(reads, ", "))};
}

FrameNode pass_nodes(const ReportSource &source)
{
  const Data &data = source.data;
  const FrameState state = data.state(source.settings);
  std::vector<FrameNode> nodes;
  std::vector<const FrameStep *> drawn_before;
  const std::vector<gpu::LiveResource> resources = source.device().live();
  std::set<std::string_view> live;
  for (const gpu::LiveResource &resource : resources) {
    live.insert(resource.name);
  }
  for (const DrawnStep &drawn : data.frame.steps()) {
    const FrameStep &step = drawn.step;
    const Need need = drawn.need_in(state);
    FrameNode node;
    if (step.name == "shadows") {
      node = shadow_step_node(source, need);
    }
    else if (step.passes.empty()) {
      node = {.what = std::string(step.name), .is_made = need.is_needed, .why = std::string(need.reason)};
    }
    else if (step.passes.size() == 1) {
      node = pass_node(drawn, 0, state);
      node.what = step.name;
      node.why = need.reason;
    }
    else {
      std::vector<FrameNode> passes;
      for (std::size_t i = 0; i < step.passes.size(); i++) {
        passes.push_back(pass_node(drawn, i, state));
      }
      const std::string reason(need.reason);
      node = folder(std::string(step.name), reason, need.is_needed ? nothing_seen : reason, std::move(passes));
    }
    node.seconds = drawn.taken_seconds;
    if (node.is_made) {
      if (FrameNode reads = read_node(step, drawn_before, live); reads.is_made) {
        node.children.push_back(std::move(reads));
      }
      drawn_before.push_back(&step);
    }
    nodes.push_back(std::move(node));
  }
  return folder("passes", "runs of the last picture", nothing_seen, std::move(nodes));
}

/** Add a child for the layers in \a mask to the node \a lamp, unless \a mask is 0. */
void add_layers(FrameNode &lamp, const char *what, bool is_made, std::uint32_t mask, const char *why)
{
  if (mask != 0) {
    lamp.children.push_back(
        {.what = what, .is_made = is_made, .why = why, .count = std::uint64_t(std::popcount(mask))});
  }
}

FrameNode lamp_node(const ReportSource &source, std::size_t index, const std::vector<ShadowState> &states)
{
  const scene::PlacedLamp &lamp = source.data.shared->lights.plan().placed[index];
  const Lamps &lamps = source.data.shared->lights.plan().lamps;
  FrameNode node{.what = lamp.name};
  const auto light = std::ranges::find(lamps.lamp_index, std::uint32_t(index));
  if (light == lamps.lamp_index.end()) {
    node.why = "it gives no light";
    return node;
  }
  const auto state = std::ranges::find(states, int(light - lamps.lamp_index.begin()), &ShadowState::light);
  if (state == states.end()) {
    node.why = source.settings.shadow.kind == scene::ShadowKind::None ? "shadows are off"
               : shadow_kind(lamp, source.settings.shadow) == scene::ShadowKind::None
                   ? "it requests no shadow"
                   : "a limit was hit: see the limits";
    return node;
  }
  node.is_made = state->drawn != 0;
  node.count = std::uint64_t(std::popcount(state->drawn));
  if (state->layer_count == 0) {
    node.why = source.data.is_recorded ? "no caster can shadow a visible surface" : nothing_seen;
    return node;
  }
  node.why = fmt::format("{} layers of {}x{} in {}", state->layer_count, state->size_px, state->size_px, state->array);
  const std::uint32_t all = (1U << state->layer_count) - 1U;
  add_layers(node, "drawn", true, state->drawn_now & all, "not up to date");
  add_layers(node, "kept", false, state->drawn & ~state->drawn_now & all, "up to date");
  add_layers(node, "empty", false, state->up_to_date & ~state->drawn & all, "no caster in it");
  add_layers(node, "not looked up", false, ~state->up_to_date & all, "no visible surface reads them");
  return node;
}

FrameNode shadow_nodes(const ReportSource &source)
{
  const std::vector<ShadowState> states = source.data.shadows.states();
  std::vector<FrameNode> lamps;
  for (std::size_t i = 0; i < source.data.shared->lights.plan().placed.size(); i++) {
    lamps.push_back(lamp_node(source, i, states));
  }
  return folder("shadows", "layers by lamp", why_no_shadow(source, "no lamp has a layer that is drawn"),
                std::move(lamps));
}

FrameNode draw_nodes(const ReportSource &source)
{
  std::vector<FrameNode> passes;
  for (const DrawnStep &drawn : source.data.frame.steps()) {
    for (std::size_t i = 0; i < drawn.passes.size(); i++) {
      const draw::RecordCounts counts = drawn.passes[i].counts;
      const draw::Pass &pass = *drawn.step.passes[i].pass;
      if (counts.drawn + counts.culled == 0 || !pass.has_objects()) {
        continue;
      }
      FrameNode &node = passes.emplace_back(FrameNode{.what = pass.name(),
                                                      .is_made = counts.drawn > 0,
                                                      .why = counts.drawn > 0 ? "in the view" : "outside of the view",
                                                      .count = counts.drawn});
      if (counts.culled > 0) {
        node.children.push_back({.what = "culled", .why = "outside of the view", .count = counts.culled});
      }
    }
  }
  FrameNode node = folder("draws", "instances, over the samples of the last picture", nothing_seen, std::move(passes));
  node.count = 0;
  for (const FrameNode &pass : node.children) {
    *node.count += *pass.count;
  }
  return node;
}

std::vector<std::string> warnings_of(const ReportSource &source)
{
  const render_scene::RenderScene &render_scene = source.render_scene;
  const scene::Scene &scene = source.scene();
  std::vector<std::string> warnings = source.data.shared->lights.plan().lamps.warnings;
  const auto add = [&](const std::vector<std::string> &lines) {
    warnings.insert(warnings.end(), lines.begin(), lines.end());
  };
  add(source.data.shared->shadows.warnings());
  if (source.settings.shadow.is_fitted_to_depth && has_surfaces_without_depth(scene)) {
    warnings.emplace_back(
        "cascades are not fitted to depths: blended and transmissive materials receive shadows, and are drawn later");
  }
  add(surface_function_warnings(scene, source.shaders));
  add(scene.stale_references());
  std::set<scene::Handle<scene::Mesh>> meshes;
  for (const draw::ObjectIndex object : source.data.surfaces.objects()) {
    const scene::Handle<scene::Mesh> handle = render_scene.object(object).mesh;
    if (!meshes.insert(handle).second) {
      continue;
    }
    // The objects are those of the last sync, and the mesh may have been removed since.
    const scene::Mesh *mesh = scene.meshes().find(handle);
    for (const scene::TextureInput &input : scene::texture_inputs) {
      const std::string why = mesh ? why_no_texture(*mesh, input, scene.material_of(*mesh).*input.slot) : std::string();
      if (!why.empty()) {
        warnings.push_back(fmt::format("mesh '{}': {}; its material's {} is not drawn", mesh->name, why, input.name));
      }
    }
  }
  meshes.clear();
  for (const scene::Object &object : scene.objects()) {
    const scene::Mesh *mesh = scene.meshes().find(object.mesh);
    if (mesh && !render_scene.meshes().has_shape(object.mesh, *mesh) && meshes.insert(object.mesh).second) {
      warnings.push_back(
          fmt::format("mesh '{}': the host has named no buffers of it, so that it is not drawn", mesh->name));
    }
  }
  return warnings;
}

std::vector<std::string> limits_of(const Data &data)
{
  std::vector<std::string> limits = data.shared->lights.plan().lamps.limits;
  const std::vector<std::string> &of_shadows = data.shared->shadows.limits();
  limits.insert(limits.end(), of_shadows.begin(), of_shadows.end());
  if (data.blend.ordered_count() > render_scene::blend_order_exact_max) {
    limits.push_back(fmt::format("{} blended objects are in the view: more than {} are ordered by distance alone",
                                 data.blend.ordered_count(), render_scene::blend_order_exact_max));
  }
  if (const std::size_t count = data.transmission.bodies().left_out(); count > 0) {
    limits.push_back(fmt::format(
        "{} triangles transmit light, more than the device holds: light goes through the nearest surface alone",
        count));
  }
  return limits;
}

int lost_shadow_count(const ReportSource &source)
{
  const Lamps &lamps = source.data.shared->lights.plan().lamps;
  int count = 0;
  for (int i = 0; i < lamps.light_count(); i++) {
    const scene::PlacedLamp &lamp = source.data.shared->lights.plan().placed[lamps.lamp_index[std::size_t(i)]];
    const bool is_asked_for = shadow_kind(lamp, source.settings.shadow) != scene::ShadowKind::None;
    count += is_asked_for && lamps.lights[std::size_t(i)].shadow_kind == SHADOW_NONE ? 1 : 0;
  }
  return count;
}

std::vector<FrameItem> frame_items(const ReportSource &source)
{
  const Data &data = source.data;
  const Settings &settings = source.settings;
  const SharedData &shared = *data.shared;
  const SceneShadows &shadows = shared.shadows;
  const int light_count = shared.lights.plan().lamps.light_count();
  std::vector<FrameItem> items;
  const auto item = [&](std::string what, bool is_made, std::string why, std::string why_not) {
    items.push_back({std::move(what), is_made, is_made ? std::move(why) : std::move(why_not)});
  };
  const Feature f = data.features;
  const bool is_recorded = data.is_recorded;
  const std::string no_shadow = settings.shadow.kind == scene::ShadowKind::None ? "shadows are off" : "no such lamp";
  const auto why_not = [&](std::string reason) { return is_recorded ? std::move(reason) : nothing_seen; };
  item("light_block", bool(shared.lights.block()), fmt::format("{} lights", light_count),
       !has(f, Feature::Light)          ? "no lamp gives light"
       : has(f, Feature::LightClusters) ? "the lights are in light_texture"
                                        : nothing_seen);
  item("light_texture", bool(shared.lights.texture()), fmt::format("{} lights", light_count),
       has(f, Feature::LightClusters) ? nothing_seen : "few lamps have a range");
  const std::shared_ptr<const scene::EmissiveSurfaces> &emission = shared.lights.plan().emission;
  const int further = shared.lights.plan().lamps.surface_point_count;
  item("light of emissive surfaces", emission != nullptr,
       emission
           ? fmt::format("{} points in each sample{}, chosen from {} patches", settings.emissive_points(),
                         further > 0 ? fmt::format(" and {} without shadows", further) : "", emission->patch_count())
           : "",
       settings.emissive_points() > 0  ? "no material emits light"
       : settings.emissive_point_count ? "not asked for"
                                       : "a picture of one sample has none, unless asked for");
  item("shadow_cubes", bool(shadows.cubes()), fmt::format("{} point lamps or wide spots", shadows.cube_count()),
       has(f, Feature::ShadowCube) ? why_not("no visible surface looks a cube up") : no_shadow);
  item("shadow_maps", bool(shadows.maps()), fmt::format("{} suns or spots", shadows.map_count()),
       has(f, Feature::ShadowMap) ? why_not("no caster can shadow a visible surface") : no_shadow);
  item("shadow_esm", shadows.esm_count() > 0, fmt::format("{} point lamps or spots", shadows.esm_count()),
       has(f, Feature::ShadowEsm) ? nothing_seen : no_shadow);
  item("shadow_pass", !shared.shadow_pass.pass().is_empty(), "casters for the lamps' shadows",
       has(f, any_shadow) ? nothing_seen : "no shadow");
  for (const FramePass &pass : data.depth.passes()) {
    item(pass.pass->name(), !pass.pass->is_empty(), std::string(pass.purpose),
         why_not(std::string(pass.why_empty(data.state(settings)))));
  }
  item("base colour textures", source.render_scene.images().count() > 0,
       fmt::format("{} images that materials look up", source.render_scene.images().count()),
       why_not("no lit or cut out material has one"));
  item("specular in eevee_lit", has(f, Feature::Specular), "a material reflects",
       has(f, Feature::Light) ? why_not("every material is Lambertian") : "no lamp gives light");
  item("cascade tint", data.surfaces.has_tint(), "asked for",
       !settings.has_cascade_tint    ? "not asked for"
       : shared.lights.plan().tinted ? nothing_seen
                                     : "no sun has a shadow");
  item("film", is_recorded,
       settings.sample_count == 0 ? "samples until the host ends the picture"
                                  : fmt::format("{} samples a pixel", settings.sample_count),
       nothing_seen);
  item("tonemap", data.output.is_recorded(), "a target was given", data.output.target() ? nothing_seen : no_target);
  item("programs", source.shaders.size() > 0, fmt::format("{} programs", source.shaders.size()), nothing_seen);
  return items;
}

}  // namespace

Report Inspection::report() const
{
  const Data &data = engine_data();
  Report report;
  if (!data.synced_picture) {
    report.tree = {.what = "frame", .why = "the viewport was never synced"};
    return report;
  }
  const ReportSource source{engine_.scene_, *engine_.shaders_, engine_.settings_, data, viewport_};
  report.warnings = warnings_of(source);
  report.limits = limits_of(data);
  report.lost_shadow_count = lost_shadow_count(source);
  report.shadow_counters = data.shadows.counters();
  report.emission_revision = engine_.emission_->revision();
  report.pass_recordings = data.surfaces.recording_count();
  auto [targets, blocks] = resource_nodes(source);
  report.tree = folder("frame", "the picture", "",
                       {program_nodes(source), pass_nodes(source), std::move(targets), std::move(blocks),
                        mesh_nodes(source), texture_nodes(source), shadow_nodes(source), draw_nodes(source)});
  report.items = frame_items(source);
  return report;
}

}  // namespace gnomon::eevee
