// SPDX-License-Identifier: MIT
#include "reference_light.hh"

#include "reference_visibility.hh"

#include "internal/reference_bsdf.hh"
#include "internal/reference_random.hh"
#include "internal/reference_world.hh"
#include "scene_emission.hh"
#include "scene_parallel.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <stdexcept>

namespace gnomon::reference {

namespace {

/** Radius of the pixel filter, pixels. */
constexpr double filter_radius_px = 1.5;

/** Four-term Blackman-Harris window (Harris 1978, table 1: minimum, -92 dB), with weight 1 at the centre. */
constexpr std::array<double, 4> filter_terms = {0.35875, 0.48829, 0.14128, 0.01168};

double filter_weight(double distance_px)
{
  if (std::abs(distance_px) >= filter_radius_px) {
    return 0.0;
  }
  double sum = 0.0;
  for (int i = 0; i < 4; i++) {
    sum += filter_terms[std::size_t(i)] * std::cos(std::numbers::pi * double(i) * distance_px / filter_radius_px);
  }
  return sum;
}

/** Inverse of the filter's cumulative weight: the distance, pixels, below which a fraction \a share in [0, 1) lies. */
double filter_quantile(double share)
{
  const auto weight_below = [](double distance_px) {
    double sum = 0.5 * (distance_px / filter_radius_px + 1.0);
    for (int i = 1; i < 4; i++) {
      const double frequency = std::numbers::pi * double(i);
      sum += filter_terms[std::size_t(i)] / filter_terms[0] * std::sin(frequency * distance_px / filter_radius_px) /
             (2.0 * frequency);
    }
    return sum;
  };
  double low = -filter_radius_px;
  double high = filter_radius_px;
  // 22 bisections give a precision of a millionth of a pixel.
  for (int i = 0; i < 22; i++) {
    const double middle = 0.5 * (low + high);
    (weight_below(middle) < share ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/** Point \a index of a golden-ratio lattice of \a count points in the unit square, shifted by \a key. */
glm::dvec2 lattice_point(int index, int count, std::uint64_t key)
{
  constexpr double golden = std::numbers::phi - 1.0;
  return {fraction((index + fraction(key)) / count), fraction(index * golden + fraction(mixed(key)))};
}

std::uint64_t pixel_key(std::uint64_t seed, const glm::ivec2 &pixel)
{
  return mixed(mixed(mixed(seed) ^ std::uint32_t(pixel.x)) ^ std::uint32_t(pixel.y));
}

void check(glm::ivec2 size_px, const DirectLightSettings &settings)
{
  if (size_px.x < 1 || size_px.y < 1 || settings.sample_count < 1) {
    throw std::invalid_argument(
        fmt::format("direct light: a picture of {}x{} pixels with {} samples: each must be at least 1", size_px.x,
                    size_px.y, settings.sample_count));
  }
}

/** Camera rays for the pixels of an image. */
class CameraRays {
 public:
  CameraRays(const scene::PlacedCamera &camera, glm::ivec2 size_px)
      : world_from_camera_(camera.world_from_camera),
        size_px_(size_px),
        is_perspective_(camera.kind == scene::CameraKind::Perspective),
        near_(camera.near),
        far_(camera.far > camera.near ? double(camera.far) : std::numeric_limits<double>::infinity()),
        aperture_radius_(is_perspective_ ? double(camera.aperture_radius) : 0.0),
        focus_distance_(camera.focus_distance > 0.0F ? double(camera.focus_distance)
                                                     : std::numeric_limits<double>::infinity()),
        aperture_blades_(camera.aperture_blades),
        aperture_rotation_(camera.aperture_rotation),
        aperture_ratio_(camera.aperture_ratio)
  {
    const double image_aspect = double(size_px.x) / double(size_px.y);
    half_size_.y =
        is_perspective_ ? std::tan(0.5 * double(camera.vertical_angle)) : std::abs(double(camera.half_height));
    const double frame_aspect = !is_perspective_ ? std::abs(double(camera.half_width) / double(camera.half_height))
                                : camera.aspect > 0.0F ? double(camera.aspect)
                                                       : image_aspect;
    const glm::dvec2 frame_half_size(half_size_.y * frame_aspect, half_size_.y);
    middle_ = 2.0 * frame_half_size * glm::dvec2(camera.shift_x, camera.shift_y);
    // The camera's frame is centred in the image and completely visible.
    half_size_.y *= std::max(frame_aspect / image_aspect, 1.0);
    half_size_.x = half_size_.y * image_aspect;
    if (!is_perspective_) {
      half_size_ = {std::copysign(half_size_.x, camera.half_width), std::copysign(half_size_.y, camera.half_height)};
    }
  }

  /**
   * \a at_px: relative to the lower left corner of the image. \a key: of the pixel. The ray's t is the depth along the
   * view axis, metres.
   */
  [[nodiscard]] Ray at(const glm::dvec2 &at_px, int sample, std::uint64_t key) const
  {
    const glm::dvec2 across = middle_ + half_size_ * (2.0 * at_px / glm::dvec2(size_px_) - 1.0);
    const glm::dvec2 point = aperture_radius_ > 0.0 ? aperture_point(sample, key) : glm::dvec2(0.0);
    const glm::dvec4 eye = is_perspective_ ? glm::dvec4(point, 0.0, 1.0) : glm::dvec4(across, 0.0, 1.0);
    const glm::dvec4 forward =
        is_perspective_ ? glm::dvec4(across - point / focus_distance_, -1.0, 0.0) : glm::dvec4(0.0, 0.0, -1.0, 0.0);
    return {glm::dvec3(world_from_camera_ * eye), glm::dvec3(world_from_camera_ * forward), near_, far_};
  }

 private:
  /** Metres. Independent of the points of lamps and pixels, which are multiples of other irrational numbers. */
  [[nodiscard]] glm::dvec2 aperture_point(int sample, std::uint64_t key) const
  {
    const double first = fraction(sample * (std::numbers::sqrt2 - 1.0) + fraction(mixed(key ^ 1)));
    const double second = fraction(sample * (std::numbers::sqrt3 - 1.0) + fraction(mixed(key ^ 2)));
    const double corner_count = aperture_blades_;
    const double place = first * corner_count;
    const double corner = std::floor(place);
    const double radius = std::sqrt(aperture_blades_ == 0 ? first : place - corner);
    const double half_angle = std::numbers::pi / corner_count;
    const double angle =
        aperture_blades_ == 0 ? 2.0 * std::numbers::pi * second : aperture_rotation_ + 2.0 * half_angle * corner;
    const double across = aperture_blades_ == 0 ? 0.0 : (2.0 * second - 1.0) * std::sin(half_angle);
    const double along = aperture_blades_ == 0 ? 1.0 : std::cos(half_angle);
    const glm::dvec2 point(along * std::cos(angle) - across * std::sin(angle),
                           along * std::sin(angle) + across * std::cos(angle));
    return aperture_radius_ * radius * glm::dvec2(point.x / aperture_ratio_, point.y);
  }

  glm::dmat4 world_from_camera_;
  glm::dvec2 size_px_;
  bool is_perspective_;
  double near_;
  double far_;
  double aperture_radius_;
  double focus_distance_;
  int aperture_blades_;
  double aperture_rotation_;
  double aperture_ratio_;
  glm::dvec2 half_size_{1.0};
  /** The middle of the image: on the plane at a distance of 1 where perspective. */
  glm::dvec2 middle_{0.0};
};

/** The inputs that all samples of a picture share. */
struct Integrator {
  const Tracer &tracer;
  CameraRays rays;
  const DirectLightSettings &settings;
  /** Empty: the scene has no world, or a black one. */
  std::optional<WorldSampler> world;
  scene::EmissiveSurfaces emission;

  Integrator(const Tracer &tracer_, const CameraRays &rays_, const DirectLightSettings &settings_);
  [[nodiscard]] glm::dvec3 lit_by_world(const Receiver &receiver, const glm::dvec3 &normal, const glm::dvec3 &view,
                                        const Bsdf &bsdf, int sample, std::uint64_t key) const;
  [[nodiscard]] glm::dvec3 lit_by_surfaces(const Receiver &receiver, const glm::dvec3 &normal, const glm::dvec3 &view,
                                           const Bsdf &bsdf, int sample, std::uint64_t key) const;
  [[nodiscard]] glm::dvec3 radiance(Ray ray, int sample, std::uint64_t key) const;
  /** From the surface alone, as if it were opaque. \a view: towards the viewer, unit vector. */
  [[nodiscard]] glm::dvec3 radiance_of(const Surface &surface, const glm::dvec3 &view, int sample,
                                       std::uint64_t key) const;
  [[nodiscard]] glm::dvec3 lit_by(const scene::PlacedLamp &lamp, const Receiver &receiver, const glm::dvec3 &normal,
                                  const glm::dvec3 &view, const Bsdf &bsdf, const glm::dvec2 &u) const;
  void render_tile(const glm::ivec2 &low_px, const glm::ivec2 &high_px, Picture &picture) const;
};

glm::dvec3 Integrator::lit_by(const scene::PlacedLamp &lamp, const Receiver &receiver, const glm::dvec3 &normal,
                              const glm::dvec3 &view, const Bsdf &bsdf, const glm::dvec2 &u) const
{
  const glm::dvec3 color(lamp.color);
  if (lamp.kind == scene::LampKind::Hemi) {
    const double cosine = glm::dot(normal, lamp_center(lamp).vector_ws);
    const double sky = double(lamp.intensity) * std::clamp(0.5 + 0.5 * cosine, 0.0, 1.0);
    return bsdf.diffuse * color * (sky / std::numbers::pi);
  }
  const LampSample sample = sample_lamp(lamp, receiver.position_ws, u);
  if (sample.irradiance <= 0.0) {
    return glm::dvec3(0.0);
  }
  const glm::dvec3 scattered = reflected(bsdf, normal, view, sample.to_light_ws);
  if (scattered == glm::dvec3(0.0)) {
    return glm::dvec3(0.0);
  }
  const double visible = casts_shadow(lamp) ? visible_part(tracer, receiver, sample.point) : 1.0;
  return scattered * color * (sample.irradiance * visible);
}

Integrator::Integrator(const Tracer &tracer_, const CameraRays &rays_, const DirectLightSettings &settings_)
    : tracer(tracer_), rays(rays_), settings(settings_)
{
  if (const std::optional<scene::World> &given = tracer.scene().world()) {
    world.emplace(*given);
    if (world->is_black()) {
      world.reset();
    }
  }
  if (scene::has_emission(tracer.scene())) {
    emission = scene::EmissiveSurfaces(tracer.scene(), tracer.scene().objects());
  }
}

/**
 * One direction by the world's light, and where the surface is specular one by its lobe, together by the balance
 * heuristic (Veach and Guibas 1995).
 */
glm::dvec3 Integrator::lit_by_world(const Receiver &receiver, const glm::dvec3 &normal, const glm::dvec3 &view,
                                    const Bsdf &bsdf, int sample, std::uint64_t key) const
{
  const bool is_specular = bsdf.f90 > 0.0;
  const auto light_from = [&](const glm::dvec3 &to_world) {
    const double density = world->density(to_world) + (is_specular ? lobe_density(bsdf, normal, view, to_world) : 0.0);
    const glm::dvec3 scattered = reflected(bsdf, normal, view, to_world);
    if (!(density > 0.0) || scattered == glm::dvec3(0.0)) {
      return glm::dvec3(0.0);
    }
    return visible_part(tracer, receiver, LightPoint{to_world, true}) * scattered * world->radiance(to_world) / density;
  };
  glm::dvec3 sum = light_from(world->sample(even_point(sample, mixed(key))).to_world_ws);
  if (is_specular) {
    sum += light_from(lobe_direction(bsdf, normal, view, even_point(sample, mixed(key + 1))));
  }
  return sum;
}

/** One point of the surfaces that emit light. */
glm::dvec3 Integrator::lit_by_surfaces(const Receiver &receiver, const glm::dvec3 &normal, const glm::dvec3 &view,
                                       const Bsdf &bsdf, int sample, std::uint64_t key) const
{
  const scene::EmissivePoint point = emission.at(even_point_in_cube(sample, key));
  const glm::dvec3 to_point = point.position - receiver.position_ws;
  const double distance_sq = glm::dot(to_point, to_point);
  if (!(distance_sq > 0.0)) {
    return glm::dvec3(0.0);
  }
  const glm::dvec3 to_light = to_point / std::sqrt(distance_sq);
  const glm::dvec3 scattered = reflected(bsdf, normal, view, to_light);
  if (scattered == glm::dvec3(0.0)) {
    return glm::dvec3(0.0);
  }
  // A disk of this area in the place of the point bounds the light near it, and so the noise.
  constexpr double disk_share = 1.0 / 1024.0;
  const double form = point.area * std::abs(glm::dot(to_light, point.normal)) /
                      (distance_sq + disk_share * point.area / std::numbers::pi);
  return visible_part(tracer, receiver, LightPoint{point.position, false}) * form * scattered * point.radiance;
}

glm::dvec3 Integrator::radiance(Ray ray, int sample, std::uint64_t key) const
{
  constexpr double least_open = 1e-6;
  glm::dvec3 sum(0.0);
  // The part of the light behind the surfaces so far that passes through them.
  double open = 1.0;
  while (open > least_open) {
    const std::optional<Hit> hit = tracer.closest(ray, Faces::Drawn);
    if (!hit) {
      break;
    }
    const Surface surface = tracer.surface_at(*hit);
    sum += open * surface.opacity * radiance_of(surface, -glm::normalize(ray.direction_ws), sample, key);
    open *= 1.0 - surface.opacity;
    ray.t_min = std::nextafter(hit->t, std::numeric_limits<double>::infinity());
  }
  return sum;
}

glm::dvec3 Integrator::radiance_of(const Surface &surface, const glm::dvec3 &view, int sample, std::uint64_t key) const
{
  const double side = glm::dot(surface.geometric_normal_ws, view) < 0.0 ? -1.0 : 1.0;
  const Receiver receiver{surface.position_ws, side * surface.geometric_normal_ws, surface.error_m};
  if (surface.material->is_unlit) {
    return surface.base_color;
  }
  Bsdf bsdf = make_bsdf(surface);
  bsdf.multiscatter = settings.has_multiscatter ? &multiscatter_table() : nullptr;
  if (surface.shading_normal_ws != surface.smooth_normal_ws) {
    bsdf.smooth_normal = side * surface.smooth_normal_ws;
  }
  glm::dvec3 sum = surface.emissive;
  const std::vector<scene::PlacedLamp> &lamps = tracer.lamps();
  for (std::size_t i = 0; i < lamps.size(); i++) {
    const glm::dvec2 u = even_point(sample, mixed(key + i));
    // Occlusion applies to ambient light only.
    const double occlusion = lamps[i].kind == scene::LampKind::Hemi ? surface.occlusion : 1.0;
    sum += occlusion * lit_by(lamps[i], receiver, side * surface.shading_normal_ws, view, bsdf, u);
  }
  if (world) {
    sum += lit_by_world(receiver, side * surface.shading_normal_ws, view, bsdf, sample, mixed(key + lamps.size()));
  }
  if (!emission.empty()) {
    sum += lit_by_surfaces(receiver, side * surface.shading_normal_ws, view, bsdf, sample, mixed(~key));
  }
  return sum;
}

void Integrator::render_tile(const glm::ivec2 &low_px, const glm::ivec2 &high_px, Picture &picture) const
{
  const glm::ivec2 size_px = high_px - low_px;
  // rgb: weighted sum of the samples. w: sum of the weights.
  std::vector<glm::dvec4> sums(std::size_t(size_px.x) * std::size_t(size_px.y), glm::dvec4(0.0));
  // Samples of neighbouring pixels contribute, also beyond the edges of the picture.
  for (int y = low_px.y - 1; y <= high_px.y; y++) {
    for (int x = low_px.x - 1; x <= high_px.x; x++) {
      const std::uint64_t key = pixel_key(settings.seed, {x, y});
      for (int i = 0; i < settings.sample_count; i++) {
        const glm::dvec2 at_px = glm::dvec2(x, y) + lattice_point(i, settings.sample_count, key);
        const glm::dvec3 light = radiance(rays.at(at_px, i, key), i, key);
        for (int to_y = std::max(y - 1, low_px.y); to_y <= std::min(y + 1, high_px.y - 1); to_y++) {
          for (int to_x = std::max(x - 1, low_px.x); to_x <= std::min(x + 1, high_px.x - 1); to_x++) {
            const double weight = filter_weight(at_px.x - (to_x + 0.5)) * filter_weight(at_px.y - (to_y + 0.5));
            sums[std::size_t(to_y - low_px.y) * std::size_t(size_px.x) + std::size_t(to_x - low_px.x)] +=
                weight * glm::dvec4(light, 1.0);
          }
        }
      }
    }
  }
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      const glm::dvec4 &sum = sums[std::size_t(y) * std::size_t(size_px.x) + std::size_t(x)];
      const std::size_t to = std::size_t(low_px.y + y) * std::size_t(picture.size_px.x) + std::size_t(low_px.x + x);
      picture.pixels[to] = glm::vec4(sum / sum.w);
    }
  }
}

}  // namespace

Picture direct_light(const Tracer &tracer, const scene::PlacedCamera &camera, glm::ivec2 size_px,
                     const DirectLightSettings &settings)
{
  check(size_px, settings);
  const Integrator integrator(tracer, CameraRays(camera, size_px), settings);
  Picture picture{size_px, std::vector<glm::vec4>(std::size_t(size_px.x) * std::size_t(size_px.y))};
  // Each tile also renders the ring of pixels around it, which adds one sixteenth.
  constexpr int tile_px = 64;
  const glm::ivec2 tiles = (size_px + tile_px - 1) / tile_px;
  const std::size_t tile_count = std::size_t(tiles.x) * std::size_t(tiles.y);
  std::mutex mutex;
  std::size_t tiles_done = 0;
  scene::parallel_for(tile_count, settings.thread_count, [&](std::size_t i) {
    const glm::ivec2 low = tile_px * glm::ivec2(i % std::size_t(tiles.x), i / std::size_t(tiles.x));
    integrator.render_tile(low, glm::min(low + tile_px, size_px), picture);
    const std::scoped_lock lock(mutex);
    tiles_done++;
    if (settings.progress) {
      settings.progress(double(tiles_done) / double(tile_count));
    }
  });
  return picture;
}

std::vector<glm::vec4> direct_light(const Tracer &tracer, const scene::PlacedCamera &camera, glm::ivec2 size_px,
                                    std::span<const glm::ivec2> pixels, const DirectLightSettings &settings)
{
  check(size_px, settings);
  const Integrator integrator(tracer, CameraRays(camera, size_px), settings);
  std::vector<glm::vec4> light(pixels.size());
  std::mutex mutex;
  std::size_t pixels_done = 0;
  scene::parallel_for(pixels.size(), settings.thread_count, [&](std::size_t i) {
    const std::uint64_t key = pixel_key(settings.seed, pixels[i]);
    glm::dvec3 sum(0.0);
    for (int sample = 0; sample < settings.sample_count; sample++) {
      const glm::dvec2 share = lattice_point(sample, settings.sample_count, key);
      const glm::dvec2 from_center_px = {filter_quantile(share.x), filter_quantile(share.y)};
      const Ray ray = integrator.rays.at(glm::dvec2(pixels[i]) + 0.5 + from_center_px, sample, key);
      sum += integrator.radiance(ray, sample, key);
    }
    light[i] = glm::vec4(sum / double(settings.sample_count), 1.0F);
    if (settings.progress) {
      const std::scoped_lock lock(mutex);
      pixels_done++;
      settings.progress(double(pixels_done) / double(pixels.size()));
    }
  });
  return light;
}

}  // namespace gnomon::reference
