// SPDX-License-Identifier: MIT
#include "eevee_inspection.hh"

#include "internal/eevee_engine_data.hh"
#include "internal/eevee_frame.hh"

#include "shadows/shadow_cube.hh"

#include "gpu_read.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace gnomon::eevee {

Data &Inspection::engine_data() const
{
  return engine_.data_of(viewport_);
}

/** Index in Lamps::lights. Empty where the lamp gives no light, or the viewport was never synced. */
static std::optional<std::size_t> light_of(const Data &data, std::size_t lamp)
{
  const Lamps &lamps = data.shared->lights.plan().lamps;
  const auto found = std::ranges::find(lamps.lamp_index, std::uint32_t(lamp));
  return found == lamps.lamp_index.end() ? std::nullopt : std::optional(std::size_t(found - lamps.lamp_index.begin()));
}

/** The pixels of the picture from a texture with a guard band. */
static std::vector<glm::vec4> read_picture(const draw::Viewport &viewport, const gpu::Texture &texture)
{
  return gpu::cropped(gpu::read_as<glm::vec4>(viewport.device(), texture), viewport.drawn_size_px().x,
                      {viewport.guard_px(), viewport.size_px()});
}

/** The view of a sample of the picture, whose index \a data gets. Without \a sample, \a drawn_view. */
static draw::View inspected_view(Data &data, const draw::View &drawn_view, const draw::Viewport &viewport,
                                 const Settings &settings, std::optional<int> sample)
{
  if (!sample) {
    return drawn_view;
  }
  data.sample_index = *sample;
  return view_of_sample(drawn_view, viewport, settings, *sample);
}

std::optional<Probe> Inspection::probe(const draw::View &picture_view, std::size_t lamp,
                                       std::optional<int> sample) const
{
  GNOMON_ASSERT(engine_.settings_.has_probe, "the settings ask for no probe");
  Data &data = engine_data();
  engine_.begin_draw(viewport_);
  const std::optional<std::size_t> light = light_of(data, lamp);
  if (!light || data.surfaces.objects().empty()) {
    return std::nullopt;
  }
  data.follow_clip(picture_view);
  engine_.record(viewport_);
  gpu::Device &device = viewport_.device();
  const draw::View view = viewport_.drawn_view(picture_view);
  const draw::View sample_view = inspected_view(data, view, viewport_, engine_.settings_, sample);
  engine_.update_view(viewport_, data, sample_view);
  gpu::CommandList list;
  SharedData &shared = *data.shared;
  if (sample) {
    shared.shadow_pass.set_sample(*sample, engine_.settings_.seed);
    data.shadows.invalidate_blended();
  }
  const SampledLampPoints sampled =
      sample ? shared.lights.plan().points.sample(std::uint32_t(*sample), engine_.settings_.seed)
             : shared.lights.plan().points.centers();
  shared.lights.write_points(sampled, device, list);
  shared.lights.write_entry(sampled, int(*light), probed_entry, list);
  const PictureDepths depths = sample ? data.depth.feedback().picture(viewport_.drawn_size_px()) : PictureDepths();
  data.shadows.update(device, view, pixel_size(view, viewport_), shared.shadow_pass.pass(), list, sampled.points,
                      depths);
  data.probe.draw_visibility(sample_view, shared.lights.entry_of(int(*light), probed_entry), list);
  device.submit(list);
  data.shadows.submitted();
  return Probe{read_picture(viewport_, data.probe.visibility()[0]),
               read_picture(viewport_, data.probe.visibility()[1])};
}

std::optional<Surfaces> Inspection::surfaces(const draw::View &picture_view, std::optional<int> sample) const
{
  GNOMON_ASSERT(engine_.settings_.has_surfaces, "the settings ask for no surfaces");
  Data &data = engine_data();
  engine_.begin_draw(viewport_);
  if (data.surfaces.objects().empty()) {
    return std::nullopt;
  }
  data.follow_clip(picture_view);
  engine_.record(viewport_);
  const draw::View view =
      inspected_view(data, viewport_.drawn_view(picture_view), viewport_, engine_.settings_, sample);
  engine_.update_view(viewport_, data, view);
  gpu::Device &device = viewport_.device();
  gpu::CommandList list;
  data.probe.draw_surfaces(view, list);
  device.submit(list);
  const std::array<gpu::Texture, 3> &seen = data.probe.surfaces();
  return Surfaces{read_picture(viewport_, seen[0]), read_picture(viewport_, seen[1]), read_picture(viewport_, seen[2])};
}

double Inspection::shadow_texel_size(std::size_t lamp, const glm::dvec3 &position_ws) const
{
  const Data &data = engine_data();
  const std::optional<std::size_t> light = light_of(data, lamp);
  if (!light) {
    return 0.0;
  }
  const auto sizes =
      data.shadows.texel_sizes(data.shared->lights.plan().lamps.lights[*light], std::span(&position_ws, 1));
  return sizes ? sizes->front() : 0.0;
}

/** Whether a surface gets light from the centre of \a light, if nothing is in between. \pre \a light has a shadow */
static bool is_lit(const shared::LightData &light, const shared::LightShape &shape, const glm::vec3 &position_ws,
                   const glm::vec3 &normal_ws)
{
  if (light.kind == LIGHT_SUN) {
    return glm::dot(normal_ws, light.forward_ws) < 0.0F;
  }
  const glm::vec3 from_light = position_ws - light.position_ws;
  const float distance_sq = glm::dot(from_light, from_light);
  if (!(glm::dot(normal_ws, from_light) < 0.0F) || distance_sq * light.range_inv_sq >= 1.0F) {
    return false;
  }
  const glm::vec3 direction = from_light / std::sqrt(distance_sq);
  switch (light.kind) {
    case LIGHT_SPOT:
      return shared::elliptic_drop(direction, light.forward_ws, shape.axis_x_ws, shape.axis_y_ws) <
             light.spot_drop_outer;
    case LIGHT_RECTANGLE:
    case LIGHT_ELLIPSE: return glm::dot(direction, light.forward_ws) > 0.0F;
    default: return true;
  }
}

std::optional<std::vector<float>> Inspection::texel_density(const draw::View &picture_view, std::size_t lamp) const
{
  const Data &data = engine_data();
  const std::optional<std::size_t> index = light_of(data, lamp);
  if (!index) {
    return std::nullopt;
  }
  if (!data.shadows.texel_sizes(data.shared->lights.plan().lamps.lights[*index], {})) {
    return std::nullopt;
  }
  const std::optional<Surfaces> seen = surfaces(picture_view);
  if (!seen) {
    return std::nullopt;
  }
  const shared::LightData &light = data.shared->lights.plan().lamps.lights[*index];
  const shared::LightShape &shape = data.shared->lights.plan().lamps.shapes[*index];
  const double pixel = double(pixel_size(viewport_.drawn_view(picture_view), viewport_));
  std::vector<float> density(seen->position_depth.size(), 0.0F);
  // The lit pixels, the places that they show, and the sizes of the pixels there, metres.
  std::vector<std::size_t> receivers;
  std::vector<glm::dvec3> positions_ws;
  std::vector<double> pixel_sizes;
  draw::ObjectIndex object = draw::object_identity;
  bool is_receiver = false;
  for (std::size_t i = 0; i < density.size(); i++) {
    // Neighbours are mostly of one object.
    const auto seen_object = draw::ObjectIndex(seen->normal_object[i].w);
    if (std::exchange(object, seen_object) != seen_object) {
      is_receiver = false;
      if (object != draw::object_identity) {
        is_receiver = engine_.scene_.is_shadow_receiver(object);
      }
    }
    const glm::vec3 position_ws(seen->position_depth[i]);
    if (!is_receiver || !is_lit(light, shape, position_ws, glm::vec3(seen->normal_object[i]))) {
      continue;
    }
    const double depth = picture_view.is_perspective() ? double(seen->position_depth[i].w) : 1.0;
    receivers.push_back(i);
    positions_ws.emplace_back(position_ws);
    pixel_sizes.push_back(pixel * depth);
  }
  const std::vector<double> texels = data.shadows.texel_sizes(light, positions_ws).value();
  for (std::size_t k = 0; k < receivers.size(); k++) {
    density[receivers[k]] = texels[k] > 0.0 ? float(pixel_sizes[k] / texels[k]) : 0.0F;
  }
  return density;
}

const Shadows &Inspection::shadows() const
{
  const Data &data = engine_data();
  GNOMON_ASSERT(data.synced_picture, "the viewport was never synced");
  return data.shadows;
}

const ShadowCounters &Inspection::shadow_counters() const
{
  return shadows().counters();
}

void Inspection::invalidate_shadows() const
{
  engine_data().shared->shadows.invalidate();
}

std::vector<StepDescription> Inspection::steps() const
{
  std::vector<StepDescription> steps;
  for (const DrawnStep &drawn : engine_data().frame.steps()) {
    const FrameStep &step = drawn.step;
    StepDescription &description =
        steps.emplace_back(StepDescription{std::string(step.name), std::string(step.summary)});
    for (const FramePass &pass : step.passes) {
      description.passes.push_back(pass.pass->name());
    }
    for (const FrameRead &read : step.reads) {
      description.reads.emplace_back(read.name);
    }
    description.writes.assign(step.writes.begin(), step.writes.end());
    description.is_of_target = step.when == FrameStep::When::EachTarget;
  }
  return steps;
}

std::string Inspection::serialize_passes() const
{
  const Data &data = engine_data();
  std::string text;
  if (!data.synced_picture) {
    return text;
  }
  text += data.shared->shadow_pass.pass().serialize(viewport_.device());
  // Some steps draw passes of earlier steps again.
  std::set<const draw::Pass *> printed;
  for (const DrawnStep &drawn : data.frame.steps()) {
    for (const FramePass &pass : drawn.step.passes) {
      text += printed.insert(pass.pass).second ? pass.pass->serialize(viewport_.device()) : std::string();
    }
  }
  for (const draw::Pass *pass : data.probe.passes()) {
    text += pass->serialize(viewport_.device());
  }
  return text;
}

static std::optional<ShadowLayers> layers_of(const Data &data, std::size_t lamp)
{
  const std::optional<std::size_t> light = light_of(data, lamp);
  return light ? data.shadows.layers(data.shared->lights.plan().lamps.lights[*light]) : std::nullopt;
}

std::vector<std::string> Inspection::shadow_layers(std::size_t lamp) const
{
  const std::optional<ShadowLayers> layers = layers_of(engine_data(), lamp);
  if (!layers || layers->count == 0) {
    return {};
  }
  if (layers->is_cube) {
    return {cube_face_names.begin(), cube_face_names.end()};
  }
  if (layers->projection != PROJECTION_ORTHOGRAPHIC) {
    return {layers->esm_format >= 0 ? "octahedral" : "map"};
  }
  std::vector<std::string> names;
  for (int i = 0; i < layers->count; i++) {
    names.push_back(fmt::format("cascade {} of {}", i, layers->count));
  }
  return names;
}

std::optional<std::size_t> find_layer(std::span<const std::string> names, std::string_view text)
{
  for (std::size_t i = 0; i < names.size(); i++) {
    if (text == names[i] || text == std::to_string(i)) {
      return i;
    }
  }
  return std::nullopt;
}

const gpu::Texture &Inspection::shadow_picture(std::size_t lamp, std::optional<std::size_t> layer) const
{
  Data &data = engine_data();
  const std::optional<ShadowLayers> layers = layers_of(data, lamp);
  GNOMON_ASSERT(layers, "lamp {} has no shadow", lamp);
  return data.shadow_picture.draw(viewport_.device(), *engine_.shaders_, *layers,
                                  layer ? std::optional(int(*layer)) : std::nullopt);
}

std::optional<std::size_t> Inspection::tinted_sun() const
{
  const Data &data = engine_data();
  if (!data.shared->lights.plan().tinted) {
    return std::nullopt;
  }
  return data.shared->lights.plan().lamps.lamp_index[std::size_t(*data.shared->lights.plan().tinted)];
}

std::vector<StepTime> Inspection::take_step_times() const
{
  std::vector<StepTime> times;
  for (DrawnStep &drawn : engine_data().frame.timed_steps()) {
    if (std::exchange(drawn.is_pending, false)) {
      drawn.taken_seconds = drawn.query ? viewport_.device().take_seconds(drawn.query) : std::nullopt;
      times.push_back({std::string(drawn.step.name), drawn.taken_seconds.value_or(0.0)});
    }
  }
  return times;
}

}  // namespace gnomon::eevee
