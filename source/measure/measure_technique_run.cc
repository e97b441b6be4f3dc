// SPDX-License-Identifier: MIT
#include "internal/measure_technique_renderer.hh"

#include "gpu_read.hh"

#include <glm/geometric.hpp>

#include <chrono>
#include <cmath>

namespace gnomon::measure {

namespace {

/** Surfaces at less than half a degree to the light receive less than 1 % of it and are not compared. */
constexpr double compared_cosine_min = 0.0087;

/** Whether \a lamp lights the position: within the spot's cone and the range, and not at a grazing angle. */
bool is_lit_at(const scene::PlacedLamp &lamp, const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws)
{
  const glm::dvec3 back_ws(lamp.world_from_lamp[2]);
  if (lamp.kind == scene::LampKind::Sun) {
    return glm::dot(back_ws, normal_ws) > compared_cosine_min;
  }
  const glm::dvec3 to_lamp = glm::dvec3(lamp.world_from_lamp[3]) - position_ws;
  const double distance = glm::length(to_lamp);
  const bool is_in_range = lamp.range == 0.0F || distance < double(lamp.range);
  const bool is_in_cone = lamp.kind != scene::LampKind::Spot ||
                          glm::dot(to_lamp, back_ws) > distance * std::cos(double(lamp.spot_outer_angle));
  return is_in_range && is_in_cone && glm::dot(to_lamp, normal_ws) > compared_cosine_min * distance;
}

}  // namespace

TechniqueRenderer::TechniqueRenderer(gpu::Device &device, const scene::Scene &scene, const scene::PlacedCamera &camera,
                                     const eevee::Settings &settings, glm::ivec2 size_px)
    : camera_(camera), settings_(settings), renderer_(device, scene, size_px, settings_)
{
}

void TechniqueRenderer::warm_up(bool has_probe)
{
  settings_.has_probe = has_probe;
  set(1, false);
  draw();
}

std::map<std::string, double> TechniqueRenderer::step_seconds()
{
  set(1, true);
  draw();
  std::map<std::string, double> seconds;
  for (const eevee::StepTime &step : renderer_.inspect().take_step_times()) {
    seconds[step.step] = step.seconds;
  }
  return seconds;
}

double TechniqueRenderer::picture_seconds(int sample_count, const std::function<bool(int samples_drawn)> &progress)
{
  set(sample_count, false);
  const std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  draw({.progress = progress});
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<glm::vec4> TechniqueRenderer::picture()
{
  return renderer_.read_picture();
}

void TechniqueRenderer::set(int sample_count, bool is_timed)
{
  settings_.sample_count = sample_count;
  settings_.is_timed = is_timed;
  renderer_.set_settings(settings_);
  renderer_.sync();
  renderer_.inspect().invalidate_shadows();
  renderer_.viewport().device().finish();
}

void TechniqueRenderer::draw(const eevee::DrawLimits &limits)
{
  renderer_.draw(camera_, limits);
  renderer_.viewport().device().finish();
}

std::vector<LampError> TechniqueRenderer::lamp_errors(const reference::Tracer &tracer)
{
  std::vector<LampError> errors;
  eevee::Engine &engine = renderer_.engine();
  draw::Viewport &viewport = renderer_.viewport();
  const glm::dvec3 origin_ws = renderer_.render_scene().origin_ws();
  const std::span<const scene::PlacedLamp> lamps = renderer_.render_scene().lamps();
  for (std::size_t i_lamp = 0; i_lamp < lamps.size(); i_lamp++) {
    const std::optional<eevee::Probe> probe =
        eevee::Inspection(engine, viewport).probe(renderer_.view_of(camera_), i_lamp);
    if (!probe) {
      continue;
    }
    // The reference uses the scene's world space, the engine a space relative to its origin.
    scene::PlacedLamp lamp = lamps[i_lamp];
    lamp.world_from_lamp[3] += glm::dvec4(origin_ws, 0.0);
    std::vector<glm::dvec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<float> visibility;
    for (std::size_t i = 0; i < probe->normal.size(); i++) {
      const glm::dvec3 position_ws = origin_ws + glm::dvec3(probe->position_visibility[i]);
      if (probe->normal[i].w > 0.0F && is_lit_at(lamp, position_ws, glm::dvec3(probe->normal[i]))) {
        positions.push_back(position_ws);
        normals.emplace_back(probe->normal[i]);
        visibility.push_back(probe->position_visibility[i].w);
      }
    }
    reference::CompareSettings settings;
    settings.texel_size_m = [&](const glm::dvec3 &position_ws) {
      return eevee::Inspection(engine, viewport).shadow_texel_size(i_lamp, position_ws - origin_ws);
    };
    errors.push_back(
        {lamp.name, reference::compare_visibility(tracer, lamp, {positions, normals, visibility}, settings)});
  }
  return errors;
}

void remove_shadow_settings(scene::Scene &scene)
{
  for (const auto &[handle, lamp] : scene.lamps()) {
    if (lamp.shadow.kind != scene::ShadowKind::None) {
      scene.edit(handle, [](scene::Lamp &changed) { changed.shadow = {}; });
    }
  }
}

TechniqueTimes measure_technique(gpu::Device &device, const scene::Scene &scene, const Technique &technique,
                                 glm::ivec2 size_px, const reference::Tracer *tracer, TechniqueResult &result,
                                 bool has_multiscatter)
{
  const scene::PlacedCamera camera = scene.placed_cameras().front();
  const eevee::Settings settings{.shadow = technique.settings, .has_multiscatter = has_multiscatter};
  if (tracer) {
    // In a renderer of its own, so that the probe's memory is not counted.
    TechniqueRenderer probed(device, scene, camera, settings, size_px);
    probed.warm_up(true);
    result = {};
    result.lamps = probed.lamp_errors(*tracer);
    const eevee::Report report = probed.report();
    result.warnings = report.warnings;
    result.limits = report.limits;
    result.lost_shadow_count = report.lost_shadow_count;
  }
  TechniqueRenderer renderer(device, scene, camera, settings, size_px);
  renderer.warm_up(false);
  TechniqueTimes times;
  times.step_seconds = renderer.step_seconds();
  for (const int sample_count : technique.sample_counts) {
    times.picture_seconds.push_back(renderer.picture_seconds(sample_count));
    if (tracer) {
      result.pictures.push_back(renderer.picture());
    }
  }
  result.memory_bytes = tracer ? device.memory_bytes() : result.memory_bytes;
  return times;
}

}  // namespace gnomon::measure
