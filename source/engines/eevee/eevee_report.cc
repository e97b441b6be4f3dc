// SPDX-License-Identifier: MIT
// What a frame consists of, and what it was spared, from the state that the engine itself went by.
#include "eevee_engine.hh"
#include "eevee_engine_data.hh"
#include "eevee_materials.hh"

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

constexpr const char *nothing_seen = "nothing is seen";

/** Everything the nodes are made from. */
struct Source {
  const scene::Scene &scene;
  const Settings &settings;
  const Data &data;
  draw::Viewport &viewport;

  [[nodiscard]] const gpu::Device &device() const
  {
    return viewport.device();
  }
  [[nodiscard]] bool has(Feature feature) const
  {
    return eevee::has(data.stl.features, feature);
  }
};

/** Made of its children: made where any of them is, bytes and seconds theirs together. */
FrameNode folder(std::string what, std::string why, std::string why_not, std::vector<FrameNode> children)
{
  FrameNode node{.what = std::move(what)};
  for (const FrameNode &child : children) {
    node.is_made |= child.is_made;
    if (child.bytes) {
      node.bytes = node.bytes.value_or(0) + *child.bytes;
    }
    if (child.upload_bytes) {
      node.upload_bytes = node.upload_bytes.value_or(0) + *child.upload_bytes;
    }
    if (child.seconds) {
      node.seconds = node.seconds.value_or(0.0) + *child.seconds;
    }
  }
  node.why = node.is_made ? std::move(why) : std::move(why_not);
  node.children = std::move(children);
  return node;
}

/** Why no shadow of a kind is there, where no lamp has one. */
std::string why_no_shadow(const Source &source, std::string no_such_lamp)
{
  if (source.settings.shadow.kind == scene::ShadowKind::None) {
    return "shadows are off";
  }
  return source.has(Feature::Light) ? std::move(no_such_lamp) : "no lamp gives light";
}

/** Whether an object that may be seen has a material with a base colour texture; of \a image alone, where given. */
bool is_textured(const Source &source, std::optional<std::uint32_t> image = std::nullopt)
{
  return std::ranges::any_of(source.data.stl.objects, [&](const draw::ObjectRef &object) {
    const scene::Mesh &mesh = source.scene.meshes[source.scene.objects[object.index].mesh];
    const std::int32_t texture = source.scene.materials[mesh.material].base_color_texture;
    return texture >= 0 && (!image || source.scene.textures[std::size_t(texture)].image == *image);
  });
}

std::string why_no_feature(const Source &source, Feature feature)
{
  if (feature == Feature::BaseColorTexture && source.data.is_recorded && !is_textured(source)) {
    return "no material that is drawn has a texture";
  }
  if (feature == Feature::Light || !source.has(Feature::Light)) {
    const bool is_mask = feature == Feature::AlphaMask;
    if (!source.data.is_recorded && (is_mask || feature == Feature::BaseColorTexture)) {
      return nothing_seen;
    }
    return is_mask ? "no texture's alpha cuts a material out" : "no lamp gives light";
  }
  switch (feature) {
    case Feature::Punctual: return "no point lamp or spot gives light";
    case Feature::Specular: return source.data.is_recorded ? "every material is Lambertian" : nothing_seen;
    case Feature::ShadowCube: return why_no_shadow(source, "no point lamp or wide spot casts a shadow of depths");
    case Feature::ShadowMap: return why_no_shadow(source, "no sun or spot casts a shadow of depths");
    case Feature::ShadowPcf: return why_no_shadow(source, "no shadow is filtered by percentage-closer lookups");
    case Feature::ShadowEsm: return why_no_shadow(source, "no lamp casts an exponential shadow");
    case Feature::ShadowEvsm: return why_no_shadow(source, "no lamp casts an exponential variance shadow");
    case Feature::BaseColorTexture:
      return source.data.is_recorded ? "no material that is drawn has a texture" : nothing_seen;
    case Feature::AlphaMask: return source.data.is_recorded ? "no texture's alpha cuts a material out" : nothing_seen;
    default: return "";
  }
}

/** Why no variant of a program was made. \pre none was */
std::string why_no_program(const Source &source, ShaderId id)
{
  const std::string no_esm = why_no_feature(source, Feature::ShadowEsm);
  const std::string no_evsm = why_no_feature(source, Feature::ShadowEvsm);
  const std::string other_kernel = "exponential shadows are filtered otherwise";
  switch (id) {
    case ShaderId::Probe: return source.settings.has_probe ? "no lamp was probed" : "not asked for";
    case ShaderId::DebugShadow: return "not asked for";
    case ShaderId::DebugCascades:
      return source.data.stl.tinted_light
                 ? nothing_seen
                 : (source.settings.has_cascade_tint ? "no sun has a shadow" : "not asked for");
    case ShaderId::Tonemap: return source.settings.has_display ? nothing_seen : "only radiance was asked for";
    default: break;
  }
  if (!source.data.is_recorded) {
    return nothing_seen;
  }
  switch (id) {
    case ShaderId::Shadow:
    case ShaderId::ShadowLayered:
    case ShaderId::ShadowGeometry:
      return source.has(any_shadow) ? "another way of drawing a lamp's layers is used"
                                    : why_no_shadow(source, "no lamp casts a shadow");
    case ShaderId::EsmDistance:
    case ShaderId::EsmDisk4:
    case ShaderId::EsmDisk32:
    case ShaderId::EsmSeparable: return source.has(Feature::ShadowEsm) ? other_kernel : no_esm;
    case ShaderId::EvsmDisk4:
    case ShaderId::EvsmDisk32:
    case ShaderId::EvsmSeparable: return source.has(Feature::ShadowEvsm) ? other_kernel : no_evsm;
    default: return nothing_seen;
  }
}

/** "LIGHT|PUNCTUAL", and who asked for each. */
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

FrameNode program_nodes(const Source &source)
{
  std::vector<FrameNode> programs;
  Feature made_features = Feature::None;
  for (const ShaderDeclaration &declaration : shader_declarations()) {
    const std::vector<Feature> made = source.data.stl.shaders.made(declaration.id);
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
  programs.insert(programs.begin(),
                  folder("features", "what variants have", "no program that is made has any", std::move(features)));
  FrameNode node = folder("programs", "what passes draw with", nothing_seen, std::move(programs));
  node.count = source.data.stl.shaders.size();
  return node;
}

FrameNode pass_nodes(const Source &source)
{
  const Data &data = source.data;
  const auto node_of = [&](std::string what, std::string_view pass, std::string why, std::string why_not) {
    const auto found = data.passes.find(std::string(pass));
    const std::uint64_t runs = found == data.passes.end() ? 0 : found->second.runs;
    return FrameNode{.what = std::move(what),
                     .is_made = runs > 0,
                     .why = runs > 0 ? std::move(why) : std::move(why_not),
                     .count = runs};
  };
  const auto with_time = [&](FrameNode node, std::string_view step) {
    const auto found = std::ranges::find(data.timing.steps, step, &Timing::Step::name);
    if (found != data.timing.steps.end()) {
      node.seconds = found->taken_seconds;
    }
    return node;
  };
  /** Of objects: recorded and out of the view, or of no such object. */
  const auto why_no_object = [&](const draw::Pass &pass, std::string no_such) {
    return !data.is_seen ? nothing_seen : pass.is_empty() ? std::move(no_such) : "none of its objects is in the view";
  };
  const PassList &psl = *data.psl;
  std::vector<FrameNode> passes;

  std::uint64_t layers = 0;
  for (const ShadowState &state : data.stl.shadows.states()) {
    layers += std::uint64_t(std::popcount(state.drawn_now));
  }
  FrameNode shadows{
      .what = "shadows", .is_made = layers > 0, .why = "layers that were not up to date", .count = layers};
  if (layers == 0) {
    shadows.why = !source.has(any_shadow) ? why_no_shadow(source, "no lamp casts a shadow")
                  : !data.is_seen         ? nothing_seen
                                          : "every layer that is looked up is up to date";
  }
  passes.push_back(with_time(std::move(shadows), "shadows"));
  std::vector<FrameNode> depth;
  depth.push_back(node_of("depth_pass", psl.depth_pass.name(), "two-sided materials",
                          why_no_object(psl.depth_pass, "no object with a two-sided material")));
  depth.push_back(node_of("depth_pass_cull", psl.depth_pass_cull.name(), "one-sided materials",
                          why_no_object(psl.depth_pass_cull, "no object with a one-sided material")));
  passes.push_back(
      with_time(folder("depth_prepass", "each pixel is lit once", nothing_seen, std::move(depth)), "depth_prepass"));
  std::vector<FrameNode> lit;
  lit.push_back(node_of("pass", psl.pass.name(), "objects in the view", nothing_seen));
  lit.push_back(node_of("tint_pass", psl.tint_pass.name(), "asked for",
                        !source.settings.has_cascade_tint ? "not asked for"
                        : data.stl.tinted_light           ? nothing_seen
                                                          : "no sun has a shadow"));
  passes.push_back(with_time(folder("lit", "objects in the view", nothing_seen, std::move(lit)), "lit"));
  passes.push_back(
      with_time(node_of("film", psl.film_pass.name(), fmt::format("{} samples a pixel", source.settings.sample_count),
                        "nothing is seen: the picture is cleared"),
                "film"));
  passes.push_back(with_time(
      node_of("tonemap", psl.tonemap.name(), "a display picture was asked for",
              source.settings.has_display ? "nothing is seen: the picture is cleared" : "only radiance was asked for"),
      "tonemap"));
  return folder("passes", "runs of the last picture", nothing_seen, std::move(passes));
}

FrameNode resource_node(const Source &source, const gpu::Resource &resource, std::string what, std::string why,
                        std::string why_not)
{
  FrameNode node{.what = std::move(what), .is_made = bool(resource)};
  if (!resource) {
    node.why = std::move(why_not);
    return node;
  }
  const gpu::LiveResource live = source.device().live(resource);
  node.why = live.detail.empty() ? std::move(why) : fmt::format("{}: {}", live.detail, why);
  node.bytes = live.size_bytes;
  return node;
}

FrameNode target_nodes(const Source &source)
{
  const TextureList &txl = source.data.txl;
  const Shadows &shadows = source.data.stl.shadows;
  std::vector<FrameNode> targets;
  const auto add = [&](const gpu::Texture &texture, std::string what, std::string why, std::string why_not) {
    targets.push_back(resource_node(source, texture, std::move(what), std::move(why), std::move(why_not)));
  };
  const std::string not_asked = "not asked for";
  add(txl.film, "film", "the picture", "");
  add(txl.display, "display", "a display picture was asked for", "only radiance was asked for");
  if (source.viewport.has_depth_texture()) {
    add(source.viewport.depth_texture(), "depth", "each pixel is lit once", "");
  }
  else {
    add({}, "depth", "", nothing_seen);
  }
  add(txl.radiance, "radiance", "one sample, before the pixel filter", nothing_seen);
  add(txl.probe_position, "probe_position", "asked for", source.settings.has_probe ? nothing_seen : not_asked);
  add(txl.probe_normal, "probe_normal", "asked for", source.settings.has_probe ? nothing_seen : not_asked);
  add(source.data.shadow_picture.texture(), "shadow_picture", "asked for", not_asked);
  const auto why_no_layers = [&](Feature feature) {
    return !source.has(feature)       ? why_no_feature(source, feature)
           : !source.data.is_recorded ? nothing_seen
                                      : "nothing is seen that a caster could darken";
  };
  add(shadows.cubes(), "shadow_cubes", fmt::format("{} point lamps or wide spots", shadows.cube_count()),
      why_no_layers(Feature::ShadowCube));
  add(shadows.maps(), "shadow_maps", fmt::format("{} suns or spots", shadows.map_count()),
      why_no_layers(Feature::ShadowMap));
  add(shadows.distance_cube(), "shadow_distance_cube", "on the way to octahedral layers",
      why_no_layers(Feature::ShadowEsm));
  if (shadows.octahedral().textures().empty()) {
    add({}, "shadow_esm", "", why_no_layers(Feature::ShadowEsm));
  }
  for (const gpu::Texture *texture : shadows.octahedral().textures()) {
    add(*texture, texture->desc().name, "exponential shadows", "");
  }
  return folder("targets", "what passes draw into", "", std::move(targets));
}

FrameNode block_nodes(const Source &source)
{
  const StorageList &stl = source.data.stl;
  std::vector<FrameNode> blocks;
  const auto add = [&](const gpu::Buffer &buffer, std::string what, std::string why, std::string why_not) {
    FrameNode &node = blocks.emplace_back(
        resource_node(source, buffer, std::move(what), std::move(why),
                      source.data.is_recorded || !source.has(Feature::Light) ? std::move(why_not) : nothing_seen));
    if (buffer) {
      node.upload_bytes = source.device().live(buffer).upload_bytes;
    }
  };
  const std::string no_shadow = why_no_shadow(source, "no lamp casts a shadow");
  add(stl.view_block, "view_block", "whatever is drawn", nothing_seen);
  add(source.viewport.objects().buffer(), "object_block", fmt::format("{} matrices", source.viewport.objects().size()),
      nothing_seen);
  add(stl.material_block, "material_block", fmt::format("{} materials", source.scene.materials.size()), nothing_seen);
  add(stl.light_block, "light_block", fmt::format("{} lights", stl.lamps.light_block.light_count),
      "no lamp gives light");
  add(stl.shadows.block(), "shadow_block", "shadows of depths",
      source.has(any_shadow) ? "all shadows are exponential" : no_shadow);
  add(stl.shadows.render_blocks(), "shadow_render_block", "views that casters are drawn with", no_shadow);
  add(stl.shadows.octahedral().block(), "esm_block", "exponential shadows", why_no_feature(source, Feature::ShadowEsm));
  return folder("blocks", "what programs read", nothing_seen, std::move(blocks));
}

/** Meshes and images alike: how many were taken to the device, and why. */
FrameNode mesh_nodes(const Source &source)
{
  const StorageList &stl = source.data.stl;
  std::vector<FrameNode> meshes;
  for (std::size_t i = 0; i < source.scene.meshes.size(); i++) {
    const scene::Mesh &mesh = source.scene.meshes[i];
    const gpu::Batch none;
    const gpu::Batch &batch = i < stl.batches.size() ? stl.batches[i].batch : none;
    const bool is_used = std::ranges::any_of(
        source.scene.objects, [&](const scene::Object &object) { return object.mesh == std::uint32_t(i); });
    FrameNode &node = meshes.emplace_back(
        resource_node(source, batch, mesh.name, fmt::format("{} triangles", mesh.indices.size() / 3),
                      !is_used                                          ? "no object has it"
                      : !is_seen(source.scene.materials[mesh.material]) ? "its material is cut out everywhere"
                                                                        : nothing_seen));
    if (batch) {
      node.upload_bytes = source.device().live(batch).upload_bytes;
    }
  }
  return folder("meshes", "objects' triangles", source.scene.meshes.empty() ? "there is none" : nothing_seen,
                std::move(meshes));
}

FrameNode texture_nodes(const Source &source)
{
  std::vector<FrameNode> images;
  for (std::size_t i = 0; i < source.scene.images.size(); i++) {
    const gpu::Texture none;
    const gpu::Texture *made = source.data.stl.textures.image(i);
    FrameNode &node = images.emplace_back(
        resource_node(source, made ? *made : none, source.scene.images[i].name, "base colour that a material looks up",
                      !is_textured(source, std::uint32_t(i)) ? "no object has a material that looks it up"
                      : !source.data.is_recorded             ? nothing_seen
                                                             : "no lamp lights it, and it cuts nothing out"));
    if (made) {
      node.upload_bytes = source.device().live(*made).upload_bytes;
    }
  }
  return folder("textures", "materials' base colours", images.empty() ? "no material has one" : "none is looked up",
                std::move(images));
}

/** Layers of one kind of a lamp's; none: no node. */
void add_layers(FrameNode &lamp, const char *what, bool is_made, std::uint32_t mask, const char *why)
{
  if (mask != 0) {
    lamp.children.push_back(
        {.what = what, .is_made = is_made, .why = why, .count = std::uint64_t(std::popcount(mask))});
  }
}

FrameNode lamp_node(const Source &source, std::size_t index, const std::vector<ShadowState> &states)
{
  const scene::Lamp &lamp = source.scene.lamps[index];
  const Lamps &lamps = source.data.stl.lamps;
  FrameNode node{.what = lamp.name};
  const auto light = std::ranges::find(lamps.scene_index, std::uint32_t(index));
  if (light == lamps.scene_index.end()) {
    node.why = "it gives no light";
    return node;
  }
  const auto state = std::ranges::find(states, int(light - lamps.scene_index.begin()), &ShadowState::light);
  if (state == states.end()) {
    node.why = source.settings.shadow.kind == scene::ShadowKind::None ? "shadows are off"
               : shadow_kind(lamp, source.settings.shadow) == scene::ShadowKind::None
                   ? "it asks for none"
                   : "a limit was hit: see the limits";
    return node;
  }
  node.is_made = state->drawn != 0;
  node.count = std::uint64_t(std::popcount(state->drawn));
  if (state->layer_count == 0) {
    node.why = source.data.is_recorded ? "nothing is seen that a caster could darken" : nothing_seen;
    return node;
  }
  node.why = fmt::format("{} layers of {}x{} in {}", state->layer_count, state->size_px, state->size_px, state->array);
  const std::uint32_t all = (1U << state->layer_count) - 1U;
  add_layers(node, "drawn", true, state->drawn_now & all, "not up to date");
  add_layers(node, "kept", false, state->drawn & ~state->drawn_now & all, "up to date");
  add_layers(node, "empty", false, state->up_to_date & ~state->drawn & all, "no caster in it");
  add_layers(node, "not looked up", false, ~state->up_to_date & all, "nothing visible looks there");
  return node;
}

FrameNode shadow_nodes(const Source &source)
{
  const std::vector<ShadowState> states = source.data.stl.shadows.states();
  std::vector<FrameNode> lamps;
  for (std::size_t i = 0; i < source.scene.lamps.size(); i++) {
    lamps.push_back(lamp_node(source, i, states));
  }
  return folder("shadows", "layers by lamp", why_no_shadow(source, "no lamp has a layer that is drawn"),
                std::move(lamps));
}

FrameNode draw_nodes(const Source &source)
{
  const PassList &psl = *source.data.psl;
  std::vector<FrameNode> passes;
  for (const draw::Pass *pass : {&psl.depth_pass, &psl.depth_pass_cull, &psl.pass, &psl.tint_pass}) {
    const auto found = source.data.passes.find(pass->name());
    const draw::RecordCounts counts = found == source.data.passes.end() ? draw::RecordCounts() : found->second.counts;
    if (counts.drawn + counts.culled == 0) {
      continue;
    }
    FrameNode &node = passes.emplace_back(FrameNode{.what = pass->name(),
                                                    .is_made = counts.drawn > 0,
                                                    .why = counts.drawn > 0 ? "in the view" : "outside of the view",
                                                    .count = counts.drawn});
    if (counts.culled > 0) {
      node.children.push_back({.what = "culled", .why = "outside of the view", .count = counts.culled});
    }
  }
  FrameNode node = folder("draws", "instances, over the samples of the last picture", nothing_seen, std::move(passes));
  node.count = 0;
  for (const FrameNode &pass : node.children) {
    *node.count += *pass.count;
  }
  return node;
}

}  // namespace

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
  for (int i = 0; i < stl.lamps.light_block.light_count; i++) {
    const scene::Lamp &lamp = scene_.lamps[stl.lamps.scene_index[std::size_t(i)]];
    const bool is_asked_for = shadow_kind(lamp, settings_.shadow) != scene::ShadowKind::None;
    report.lost_shadow_count += is_asked_for && stl.lamps.light_block.lights[i].shadow_kind == SHADOW_NONE ? 1 : 0;
  }

  const Source source{scene_, settings_, data, viewport};
  report.tree = folder("frame", "the picture", "",
                       {program_nodes(source), pass_nodes(source), target_nodes(source), block_nodes(source),
                        mesh_nodes(source), texture_nodes(source), shadow_nodes(source), draw_nodes(source)});

  const auto part = [&](std::string what, bool is_made, std::string why, std::string why_not) {
    report.parts.push_back({std::move(what), is_made, is_made ? std::move(why) : std::move(why_not)});
  };
  const Feature f = stl.features;
  const bool is_recorded = data.is_recorded;
  const std::string no_shadow = settings_.shadow.kind == scene::ShadowKind::None ? "shadows are off" : "no such lamp";
  const auto why_not = [&](std::string reason) { return is_recorded ? std::move(reason) : nothing_seen; };
  part("light_block", bool(stl.light_block), fmt::format("{} lights", stl.lamps.light_block.light_count),
       has(f, Feature::Light) ? nothing_seen : "no lamp gives light");
  part("shadow_cubes", bool(stl.shadows.cubes()), fmt::format("{} point lamps or wide spots", stl.shadows.cube_count()),
       has(f, Feature::ShadowCube) ? nothing_seen : no_shadow);
  part("shadow_maps", bool(stl.shadows.maps()), fmt::format("{} suns or spots", stl.shadows.map_count()),
       has(f, Feature::ShadowMap) ? why_not("nothing is seen that a caster could darken") : no_shadow);
  part("shadow_esm", stl.shadows.octahedral().size() > 0,
       fmt::format("{} point lamps or spots", stl.shadows.octahedral().size()),
       has(f, Feature::ShadowEsm) ? nothing_seen : no_shadow);
  part("shadow_pass", !data.psl->shadow_pass.is_empty(), "casters for the lamps' shadows",
       has(f, any_shadow) ? nothing_seen : "no shadow");
  part("depth_pass", !data.psl->depth_pass.is_empty(), "two-sided materials",
       why_not("no object with a two-sided material"));
  part("depth_pass_cull", !data.psl->depth_pass_cull.is_empty(), "one-sided materials",
       why_not("no object with a one-sided material"));
  part("base colour textures", stl.textures.image_count() > 0,
       fmt::format("{} images that materials look up", stl.textures.image_count()),
       why_not("no lit or cut out material has one"));
  part("specular in eevee_lit", has(f, Feature::Specular), "a material reflects",
       has(f, Feature::Light) ? why_not("every material is Lambertian") : "no lamp gives light");
  part("cascade tint", !data.psl->tint_pass.is_empty(), "asked for",
       !settings_.has_cascade_tint ? "not asked for"
       : stl.tinted_light          ? nothing_seen
                                   : "no sun has a shadow");
  part("film", is_recorded, fmt::format("{} samples a pixel", settings_.sample_count), nothing_seen);
  part("tonemap", !data.psl->tonemap.is_empty(), "a display picture was asked for",
       settings_.has_display ? nothing_seen : "only radiance was asked for");
  part("programs", stl.shaders.size() > 0, fmt::format("{} programs", stl.shaders.size()), nothing_seen);
  return report;
}

}  // namespace gnomon::eevee
