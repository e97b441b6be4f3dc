// SPDX-License-Identifier: MIT
// Exponential shadows of real scenes compared with ray tracing, for the figures of doc/decisions/0005.
#include "eevee_camera.hh"
#include "eevee_inspection.hh"
#include "gltf_import.hh"
#include "gpu_device_fixture.hh"
#include "reference_visibility.hh"
#include "shadows/shadow_octahedral_store.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon {
namespace {

constexpr glm::ivec2 size_px(640, 360);
/** Every n-th pixel in both directions is compared. */
constexpr int stride = 9;

/** A scene's point lamps and spots, and its visible receivers. */
struct Judge {
  struct Point {
    std::size_t pixel = 0;
    reference::Receiver receiver;
  };

  Judge(gpu::Device &gpu_device, const std::string &name)
      : device(gpu_device),
        scene(gltf::import_gltf(GNOMON_SOURCE "/examples/scenes/" + name + ".glb")),
        tracer(scene),
        points(tracer.lamps().size())
  {
    const auto probes = probes_of({.kind = scene::ShadowKind::Esm});
    for (std::size_t lamp = 0; lamp < tracer.lamps().size(); lamp++) {
      const eevee::Probe &probe = probes[lamp];
      for (std::size_t i = 0; i < probe.normal.size(); i++) {
        const bool is_judged = int(i) % size_px.x % stride == 0 && int(i) / size_px.x % stride == 0;
        if (!is_judged || probe.normal[i].w == 0.0F) {
          continue;
        }
        const auto receiver =
            reference::find_receiver(tracer, glm::dvec3(probe.position_visibility[i]), glm::dvec3(probe.normal[i]));
        if (receiver && is_lit(*receiver, tracer.lamps()[lamp])) {
          points[lamp].push_back({i, *receiver});
        }
      }
    }
  }

  static bool is_lit(const reference::Receiver &receiver, const scene::PlacedLamp &lamp)
  {
    const glm::dvec3 from_lamp = glm::normalize(receiver.position_ws - glm::dvec3(lamp.world_from_lamp[3]));
    return reference::is_facing(receiver, lamp) &&
           (lamp.kind != scene::LampKind::Spot ||
            glm::dot(from_lamp, -glm::dvec3(lamp.world_from_lamp[2])) > std::cos(double(lamp.spot_outer_angle)));
  }

  /** One for each lamp; empty for suns. */
  [[nodiscard]] std::vector<eevee::Probe> probes_of(const eevee::ShadowSettings &shadow) const
  {
    render_scene::RenderScene render_scene(device, scene);
    eevee::Engine engine(render_scene, {.shadow = shadow, .has_probe = true});
    draw::Viewport viewport(device, size_px);
    const std::array<draw::Engine *, 1> engines = {&engine};
    render_scene.update();
    viewport.sync(engines, render_scene.objects());
    const draw::View view = eevee::view_of(render_scene.relative(scene.placed_cameras().front()), size_px);
    std::vector<eevee::Probe> probes(tracer.lamps().size());
    for (std::size_t lamp = 0; lamp < tracer.lamps().size(); lamp++) {
      if (tracer.lamps()[lamp].kind != scene::LampKind::Sun) {
        probes[lamp] = eevee::Inspection(engine, viewport).probe(view, lamp).value_or(eevee::Probe{});
      }
    }
    return probes;
  }

  /**
   * Fraction of the cone around the ray from the lamp, with half opening \a angle, radians, that reaches the receiver's
   * plane.
   */
  [[nodiscard]] double truth(const Point &point, const scene::PlacedLamp &lamp, double angle) const
  {
    const glm::dvec3 lamp_ws(lamp.world_from_lamp[3]);
    const reference::Receiver &r = point.receiver;
    const auto sees = [&](const glm::dvec3 &p) { return !tracer.is_blocked(p, r.error_m + 1e-9, {lamp_ws, false}); };
    const glm::dvec3 axis = glm::normalize(r.position_ws - lamp_ws);
    const glm::dvec3 other = std::abs(axis.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 across = glm::normalize(glm::cross(axis, other));
    const glm::dvec3 up = glm::cross(axis, across);
    double lit = 0.0;
    int count = 0;
    const int ray_count = angle > 0.0 ? 32 : 1;
    for (int i = 0; i < ray_count; i++) {
      const double radius = angle * std::sqrt((i + 0.5) / ray_count);
      const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
      const glm::dvec3 ray = axis + radius * (std::cos(turn) * across + std::sin(turn) * up);
      const double down = glm::dot(ray, r.normal_ws);
      // Rays that miss the plane do not count.
      if (down < -1e-3) {
        lit += sees(lamp_ws + ray * (glm::dot(r.position_ws - lamp_ws, r.normal_ws) / down)) ? 1.0 : 0.0;
        count++;
      }
    }
    return count > 0 ? lit / count : sees(r.position_ws) ? 1.0 : 0.0;
  }

  /** RMSE of visibilities over all lamps. */
  [[nodiscard]] double error(const eevee::ShadowSettings &shadow, double truth_angle) const
  {
    const std::vector<eevee::Probe> probes = probes_of(shadow);
    double squares = 0.0;
    double count = 0.0;
    for (std::size_t lamp = 0; lamp < points.size(); lamp++) {
      for (const Point &point : points[lamp]) {
        const float visibility = probes[lamp].position_visibility[point.pixel].w;
        squares += std::pow(double(visibility) - truth(point, tracer.lamps()[lamp], truth_angle), 2.0);
        count += 1.0;
      }
    }
    return std::sqrt(squares / count);
  }

  gpu::Device &device;
  scene::Scene scene;
  reference::Tracer tracer;
  std::vector<std::vector<Point>> points;
};

class ExponentialShadows : public test::SharedDeviceTest {};

TEST_F(ExponentialShadows, VariancesAreNearerToTheTruthWhereTheFilterIsWide)
{
  for (const char *name : {"plaza", "spots", "room"}) {
    const Judge judge(*device, name);
    for (const float angle : {0.0F, 0.0277F, 0.0554F}) {
      eevee::ShadowSettings shadow{.kind = scene::ShadowKind::Esm};
      if (angle > 0.0F) {
        shadow.esm.filter_angle = angle;
        shadow.esm.kernel = eevee::EsmKernel::Disk32;
      }
      const double esm = judge.error(shadow, double(angle));
      shadow.kind = scene::ShadowKind::Evsm;
      const double evsm = judge.error(shadow, double(angle));
      fmt::print("{}, filter {} rad, 512 texels: visibility RMSE {:.4f} with esm, {:.4f} with evsm\n", name, angle, esm,
                 evsm);
      // A larger map has the same effect for a narrow filter, but not for a wide one.
      EXPECT_LT(evsm, (angle > 0.0F ? 0.85 : 1.0) * esm) << name << ", " << angle;
    }
  }
}

TEST_F(ExponentialShadows, DerivedExponentAndFilterAreNearTheBestOfRealScenes)
{
  for (const scene::ShadowKind kind : {scene::ShadowKind::Esm, scene::ShadowKind::Evsm}) {
    const Judge judge(*device, "plaza");
    eevee::ShadowSettings shadow{.kind = kind};
    const double derived = judge.error(shadow, 0.0);
    const float angle = eevee::esm_filter_angle(shadow.esm.size_px);
    double best = derived;
    for (const float factor : {1.0F, 4.0F}) {
      for (const float exponent : {1.0F, 4.0F, 16.0F}) {
        shadow.esm.filter_angle = factor * angle;
        shadow.esm.exponent = exponent;
        const double error = judge.error(shadow, 0.0);
        fmt::print("{} at {} /m, filter {:.5f} rad: {:.4f}, derived {:.4f}\n",
                   kind == scene::ShadowKind::Esm ? "esm" : "evsm", exponent, *shadow.esm.filter_angle, error, derived);
        best = std::min(best, error);
      }
    }
    EXPECT_LT(derived, 1.1 * best);
  }
}

}  // namespace
}  // namespace gnomon
