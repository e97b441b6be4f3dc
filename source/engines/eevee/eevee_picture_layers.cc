// SPDX-License-Identifier: MIT
#include "eevee_picture_layers.hh"

#include "eevee_pixel_filter.hh"

#include <glm/common.hpp>

#include <algorithm>
#include <functional>

namespace gnomon::eevee {

namespace {

constexpr glm::vec4 no_surface(0.0F, 0.0F, 0.0F, no_depth);

/** Sets other settings until its end. */
class OtherSettings {
 public:
  OtherSettings(SceneRenderer &renderer, const Settings &settings) : renderer_(renderer), own_(renderer.settings())
  {
    renderer_.set_settings(settings);
  }
  OtherSettings(const OtherSettings &) = delete;
  OtherSettings &operator=(const OtherSettings &) = delete;
  ~OtherSettings()
  {
    renderer_.set_settings(own_);
  }

 private:
  SceneRenderer &renderer_;
  Settings own_;
};

/**
 * Calls \a add with the index of each pixel, the index of each of its nine neighbours (itself included) and its weight.
 * \see eevee_film_frag.glsl
 */
template <typename Add>
void for_each_weight(glm::ivec2 size_px, const FilmWeights &weights, const Add &add)
{
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      const auto pixel = std::size_t(y) * std::size_t(size_px.x) + std::size_t(x);
      for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
          const glm::ivec2 place = glm::clamp(glm::ivec2(x + column - 1, y + row - 1), glm::ivec2(0), size_px - 1);
          const auto neighbour = std::size_t(place.y) * std::size_t(size_px.x) + std::size_t(place.x);
          add(pixel, neighbour, weights.columns[column] * weights.rows[row]);
        }
      }
    }
  }
}

void add_coverage(std::vector<Coverage> &pixel, draw::ObjectIndex object, float weight)
{
  const auto found = std::ranges::find(pixel, object, &Coverage::first);
  if (found != pixel.end()) {
    found->second += weight;
  }
  else {
    pixel.emplace_back(object, weight);
  }
}

}  // namespace

std::vector<glm::vec4> render_light_layer(SceneRenderer &renderer, const scene::PlacedCamera &camera, int sample_count,
                                          const LightComponent &light)
{
  Settings settings = renderer.settings();
  GNOMON_ASSERT(settings.noise_threshold == 0.0F, "layers have all samples");
  settings.light = light;
  std::vector<glm::vec4> picture;
  {
    const OtherSettings other(renderer, settings);
    renderer.sync();
    renderer.draw(camera, {.progress = [&](int samples_drawn) { return samples_drawn < sample_count; }});
    picture = renderer.read_picture();
  }
  renderer.sync();
  return picture;
}

std::vector<glm::vec4> render_lamp_layer(SceneRenderer &renderer, const scene::PlacedCamera &camera, int sample_count,
                                         std::string_view lamp_name)
{
  std::vector<glm::vec4> sum;
  for (std::size_t lamp = 0; lamp < renderer.render_scene().lamps().size(); lamp++) {
    if (renderer.render_scene().lamps()[lamp].name == lamp_name) {
      const std::vector<glm::vec4> light =
          render_light_layer(renderer, camera, sample_count, {LightComponent::Kind::Lamp, lamp});
      sum.resize(light.size(), glm::vec4(0.0F));
      std::ranges::transform(sum, light, sum.begin(), std::plus<>());
    }
  }
  return sum;
}

const std::vector<glm::vec4> *SurfaceLayers::pixels(LayerSource source) const
{
  switch (source) {
    case LayerSource::Centers: return &position_depth;
    case LayerSource::Normals: return &normal;
    case LayerSource::Means: return &albedo_roughness;
    default: return nullptr;
  }
}

SurfaceRequest surface_request(std::span<const std::string> names)
{
  SurfaceRequest request;
  for (const PictureLayer &layer : picture_layers) {
    if (std::ranges::find(names, layer.name) == names.end()) {
      continue;
    }
    request.has_centers |= layer.source == LayerSource::Centers || layer.source == LayerSource::Normals ||
                           layer.source == LayerSource::Ids;
    request.has_means |= layer.source == LayerSource::Means;
    request.has_objects |= layer.source == LayerSource::Objects || layer.source == LayerSource::Materials;
  }
  return request;
}

/** Add one sample of the picture to \a layers. */
static void add_sample(SceneRenderer &renderer, const draw::View &view, int sample, double weight_sum,
                       const SurfaceRequest &request, SurfaceLayers &layers)
{
  const Settings &settings = renderer.settings();
  const glm::ivec2 size_px = renderer.viewport().size_px();
  const Inspection inspection = renderer.inspect();
  const FilmWeights weights = film_weights(sample, settings.sample_count, settings.seed, weight_sum);
  for (std::size_t i = 0; i < request.visible_lamps.size(); i++) {
    std::vector<float> &sum = layers.visibilities[i];
    if (const std::optional<Probe> probe = inspection.probe(view, request.visible_lamps[i], sample)) {
      for_each_weight(size_px, weights, [&](std::size_t pixel, std::size_t neighbour, float weight) {
        sum[pixel] += weight * probe->position_visibility[neighbour].w;
      });
    }
  }
  if (!request.has_means && !request.has_objects) {
    return;
  }
  const std::optional<Surfaces> surfaces = inspection.surfaces(view, sample);
  if (!surfaces) {
    return;
  }
  for_each_weight(size_px, weights, [&](std::size_t pixel, std::size_t neighbour, float weight) {
    if (request.has_means) {
      layers.albedo_roughness[pixel] += weight * surfaces->albedo_roughness[neighbour];
    }
    const auto object = draw::ObjectIndex(surfaces->normal_object[neighbour].w);
    if (request.has_objects && object != draw::object_identity && weight > 0.0F) {
      add_coverage(layers.objects[pixel], object, weight);
    }
  });
}

SurfaceLayers render_surface_layers(SceneRenderer &renderer, const scene::PlacedCamera &camera, int sample_count,
                                    const SurfaceRequest &request)
{
  Settings settings = renderer.settings();
  GNOMON_ASSERT(settings.noise_threshold == 0.0F, "layers have all samples");
  settings.has_probe = !request.visible_lamps.empty();
  settings.has_surfaces = request.has_centers || request.has_means || request.has_objects;
  SurfaceLayers layers;
  {
    const OtherSettings other(renderer, settings);
    renderer.sync();
    // The origin of the render scene follows the camera with the first sample.
    renderer.draw_sample(camera);
    const draw::View view = renderer.view_of(camera);
    const glm::ivec2 size_px = renderer.viewport().size_px();
    const auto pixel_count = std::size_t(size_px.x) * std::size_t(size_px.y);
    if (const auto centers = request.has_centers ? renderer.inspect().surfaces(view) : std::nullopt) {
      layers.position_depth = centers->position_depth;
      layers.normal = centers->normal_object;
      const glm::vec4 origin_ws(glm::vec3(renderer.render_scene().origin_ws()), 0.0F);
      for (std::size_t i = 0; i < pixel_count; i++) {
        const bool is_surface = layers.normal[i].w != float(draw::object_identity);
        layers.position_depth[i] = is_surface ? layers.position_depth[i] + origin_ws : no_surface;
      }
    }
    layers.position_depth.resize(request.has_centers ? pixel_count : 0, no_surface);
    layers.normal.resize(request.has_centers ? pixel_count : 0);
    layers.albedo_roughness.resize(request.has_means ? pixel_count : 0);
    layers.objects.resize(request.has_objects ? pixel_count : 0);
    layers.visibilities.resize(request.visible_lamps.size(), std::vector<float>(pixel_count, 0.0F));
    const bool has_samples = request.has_means || request.has_objects || !request.visible_lamps.empty();
    double weight_sum = 0.0;
    for (int i = 0; i < sample_count; i++) {
      weight_sum += film_share(i, settings.sample_count, settings.seed, 1.0);
    }
    for (int i = 0; has_samples && i < sample_count; i++) {
      add_sample(renderer, view, i, weight_sum, request, layers);
    }
  }
  renderer.sync();
  return layers;
}

}  // namespace gnomon::eevee
