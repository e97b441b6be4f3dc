// SPDX-License-Identifier: MIT
#include "internal/measure_bench.hh"

#include "gpu_read.hh"

#include <glm/geometric.hpp>

#include <chrono>
#include <cmath>

namespace gnomon::measure {

namespace {

using Clock = std::chrono::steady_clock;

/** Planes seen by a lamp at less than half a degree get less than 1 % of its light, and are not judged. */
constexpr double judged_cosine_min = 0.0087;

/** Whether \a lamp shines there: within a spot's cone and the range, and not along the surface. */
bool is_lit_at(const scene::PlacedLamp &lamp, const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws)
{
  const glm::dvec3 back_ws(lamp.world_from_lamp[2]);
  if (lamp.kind == scene::LampKind::Sun) {
    return glm::dot(back_ws, normal_ws) > judged_cosine_min;
  }
  const glm::dvec3 to_lamp = glm::dvec3(lamp.world_from_lamp[3]) - position_ws;
  const double distance = glm::length(to_lamp);
  const bool is_in_range = lamp.range == 0.0F || distance < double(lamp.range);
  const bool is_in_cone = lamp.kind != scene::LampKind::Spot ||
                          glm::dot(to_lamp, back_ws) > distance * std::cos(double(lamp.spot_outer_angle));
  return is_in_range && is_in_cone && glm::dot(to_lamp, normal_ws) > judged_cosine_min * distance;
}

}  // namespace

Bench::Bench(gpu::Device &device, const scene::Scene &scene, const scene::PlacedCamera &camera,
             const Technique &technique, glm::ivec2 size_px)
    : settings_{.shadow = technique.settings},
      render_scene_(device, scene),
      engine_(render_scene_, settings_),
      viewport_(device, size_px),
      view_(eevee::view_of(render_scene_.relative(camera), size_px))
{
  render_scene_.update();
}

void Bench::warm_up(bool has_probe)
{
  settings_.has_probe = has_probe;
  set(1, false);
  draw(1);
}

std::map<std::string, double> Bench::step_seconds()
{
  set(1, true);
  draw(1);
  std::map<std::string, double> seconds;
  for (const eevee::StepTime &step : engine_.take_step_times(viewport_)) {
    seconds[step.step] = step.seconds;
  }
  return seconds;
}

double Bench::picture_seconds(int sample_count)
{
  set(sample_count, false);
  const Clock::time_point start = Clock::now();
  draw(sample_count);
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<glm::vec4> Bench::picture()
{
  return gpu::read_as<glm::vec4>(viewport_.device(), engine_.radiance(viewport_));
}

void Bench::set(int sample_count, bool is_timed)
{
  settings_.sample_count = sample_count;
  settings_.is_timed = is_timed;
  engine_.set_settings(settings_);
  viewport_.sync(engines_, render_scene_.objects());
  engine_.invalidate_shadows(viewport_);
  viewport_.device().finish();
}

void Bench::draw(int sample_count)
{
  viewport_.restart();
  for (int i = 0; i < sample_count; i++) {
    viewport_.draw(engines_, view_);
  }
  viewport_.device().finish();
}

std::vector<LampError> Bench::judge(const reference::Tracer &tracer)
{
  std::vector<LampError> errors;
  const std::span<const scene::PlacedLamp> lamps = render_scene_.lamps();
  for (std::size_t lamp = 0; lamp < lamps.size(); lamp++) {
    const std::optional<eevee::Probe> probe = engine_.probe(viewport_, view_, lamp);
    if (!probe) {
      continue;
    }
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<float> visibility;
    for (std::size_t i = 0; i < probe->normal.size(); i++) {
      if (probe->normal[i].w > 0.0F &&
          is_lit_at(lamps[lamp], glm::dvec3(probe->position_visibility[i]), glm::dvec3(probe->normal[i]))) {
        positions.emplace_back(probe->position_visibility[i]);
        normals.emplace_back(probe->normal[i]);
        visibility.push_back(probe->position_visibility[i].w);
      }
    }
    reference::CompareSettings settings;
    settings.texel_size_m = [&](const glm::dvec3 &position_ws) {
      return engine_.shadow_texel_size(viewport_, lamp, position_ws);
    };
    errors.push_back({lamps[lamp].name,
                      reference::compare_visibility(tracer, lamps[lamp], {positions, normals, visibility}, settings)});
  }
  return errors;
}

void leave_shadows_to_technique(scene::Scene &scene)
{
  for (const auto &[handle, lamp] : scene.lamps()) {
    if (lamp.shadow.kind != scene::ShadowKind::None) {
      scene.edit(handle, [](scene::Lamp &changed) { changed.shadow = {}; });
    }
  }
}

VisitTimes visit(gpu::Device &device, const scene::Scene &scene, const Technique &technique, glm::ivec2 size_px,
                 const reference::Tracer *tracer, VisitResult &result)
{
  const scene::PlacedCamera camera = scene.placed_cameras().front();
  if (tracer) {
    // On its own, so that the probe is no part of the memory.
    Bench judged(device, scene, camera, technique, size_px);
    judged.warm_up(true);
    result = {};
    result.lamps = judged.judge(*tracer);
    const eevee::Report report = judged.report();
    result.warnings = report.warnings;
    result.limits = report.limits;
    result.lost_shadow_count = report.lost_shadow_count;
  }
  Bench bench(device, scene, camera, technique, size_px);
  bench.warm_up(false);
  VisitTimes times;
  times.step_seconds = bench.step_seconds();
  for (const int sample_count : technique.sample_counts) {
    times.picture_seconds.push_back(bench.picture_seconds(sample_count));
    if (tracer) {
      result.pictures.push_back(bench.picture());
    }
  }
  result.memory_bytes = tracer ? device.memory_bytes() : result.memory_bytes;
  return times;
}

}  // namespace gnomon::measure
