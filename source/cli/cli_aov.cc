// SPDX-License-Identifier: MIT
#include "cli_aov.hh"

#include "cli.hh"
#include "cli_cryptomatte.hh"

#include "render_materials.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <set>

namespace gnomon::cli {

namespace {

using eevee::LayerSource;

/** Whether the layer can be in a file. */
bool is_in_files(const eevee::PictureLayer &layer)
{
  return layer.source != LayerSource::Ids;
}

/** The layer that a name of the list asks for; nullptr if there is none. */
const eevee::PictureLayer *find_layer(std::string_view name)
{
  const std::string_view stem = name.substr(0, name.find('.'));
  for (const eevee::PictureLayer &layer : eevee::picture_layers) {
    if (is_in_files(layer) && layer.name == (layer.has_lamps() ? stem : name)) {
      return &layer;
    }
  }
  return nullptr;
}

std::vector<std::size_t> lamps_named(std::span<const scene::PlacedLamp> lamps, const std::string &name)
{
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < lamps.size(); i++) {
    if (lamps[i].name == name) {
      indices.push_back(i);
    }
  }
  return indices;
}

/** \a name: of the layer in the file */
Layer layer_of(const eevee::PictureLayer &picture_layer, std::string name, std::span<const glm::vec4> pixels)
{
  Layer layer{std::move(name), std::string(picture_layer.channels), {}};
  layer.values.reserve(pixels.size() * layer.channels.size());
  for (const glm::vec4 &pixel : pixels) {
    for (std::size_t i = 0; i < layer.channels.size(); i++) {
      layer.values.push_back(pixel[picture_layer.first + int(i)]);
    }
  }
  return layer;
}

}  // namespace

std::string aov_names()
{
  std::vector<std::string> names;
  std::vector<std::string> lamp_names;
  for (const eevee::PictureLayer &layer : eevee::picture_layers) {
    if (is_in_files(layer)) {
      names.emplace_back(layer.name);
    }
    if (layer.has_lamps()) {
      lamp_names.push_back(fmt::format("{}.LAMP", layer.name));
    }
  }
  return fmt::format("{}, {}", fmt::join(names, ", "), fmt::join(lamp_names, ", "));
}

Aov::Aov(const std::string &list)
{
  for (std::size_t begin = 0; !list.empty() && begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    names_.push_back(list.substr(begin, end - begin));
    begin = end + 1;
    const std::string &name = names_.back();
    if (find_layer(name) == nullptr) {
      throw UsageError(fmt::format("--aov: no layer '{}'; there are: {}", name, aov_names()));
    }
  }
}

bool Aov::has(std::string_view name) const
{
  return std::ranges::find(names_, name) != names_.end();
}

std::vector<std::string> Aov::lamps_of(const eevee::PictureLayer &layer, std::span<const scene::PlacedLamp> lamps) const
{
  std::vector<std::string> names;
  const auto add = [&](const std::string &name) {
    if (std::ranges::find(names, name) == names.end()) {
      names.push_back(name);
    }
  };
  for (const std::string &name : names_) {
    if (name == layer.name) {
      std::ranges::for_each(lamps, add, &scene::PlacedLamp::name);
    }
    else if (find_layer(name) == &layer) {
      add(name.substr(layer.name.size() + 1));
    }
  }
  return names;
}

void Aov::check(const scene::Scene &scene) const
{
  const std::vector<scene::PlacedLamp> lamps = scene.placed_lamps();
  for (const eevee::PictureLayer &layer : eevee::picture_layers) {
    if (!layer.has_lamps()) {
      continue;
    }
    for (const std::string &name : lamps_of(layer, lamps)) {
      // OpenEXR cuts longer names off. A dot, a dot and a letter are added.
      if (layer.name.size() + name.size() + 3 > 255) {
        throw std::runtime_error(fmt::format("{}: --aov {}: the name of lamp '{}' is too long for a channel of an EXR",
                                             scene.path, layer.name, name));
      }
      const std::size_t count = lamps_named(lamps, name).size();
      if (count == 0) {
        std::set<std::string> names;
        std::ranges::transform(lamps, std::inserter(names, names.end()), &scene::PlacedLamp::name);
        throw std::runtime_error(fmt::format("{}: --aov {}.{}: no lamp '{}'; visible lamps: {}", scene.path, layer.name,
                                             name, name,
                                             names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
      }
      if (count > 1 && layer.source == LayerSource::Visibility) {
        throw std::runtime_error(fmt::format("{}: --aov {}: {} lamps have the name '{}'; each needs its own",
                                             scene.path, layer.name, count, name));
      }
    }
  }
}

std::vector<std::string> Aov::warnings(const scene::Scene &scene) const
{
  std::vector<std::string> layers;
  std::ranges::copy_if(names_, std::back_inserter(layers),
                       [](const std::string &name) { return find_layer(name)->is_of_surfaces(); });
  const bool has_blended = std::ranges::any_of(scene.objects(), [&](const scene::Object &object) {
    const scene::Mesh &mesh = scene.meshes()[object.mesh];
    return render_scene::is_blended(scene, mesh) && render_scene::is_drawable(scene, scene.material_of(mesh));
  });
  std::vector<std::string> warnings;
  if (!layers.empty() && has_blended) {
    warnings.push_back(
        fmt::format("--aov {}: blended surfaces are not in these layers; the opaque surface behind them is",
                    fmt::join(layers, ",")));
  }
  for (const eevee::PictureLayer &layer : eevee::picture_layers) {
    if (layer.has_lamps() && has(layer.name) && scene.placed_lamps().empty()) {
      warnings.push_back(fmt::format("--aov {}: the scene has no lamps, so there are no such layers", layer.name));
    }
  }
  return warnings;
}

void Aov::add_light(eevee::SceneRenderer &renderer, const scene::PlacedCamera &camera, int sample_count,
                    AovLayers &layers) const
{
  using Kind = eevee::LightComponent::Kind;
  for (const eevee::PictureLayer &layer : eevee::picture_layers) {
    if (layer.source == LayerSource::Lamp) {
      for (const std::string &name : lamps_of(layer, renderer.render_scene().lamps())) {
        layers.layers.push_back(layer_of(layer, fmt::format("{}.{}", layer.name, name),
                                         eevee::render_lamp_layer(renderer, camera, sample_count, name)));
      }
    }
    else if (has(layer.name) && (layer.source == LayerSource::Emission || layer.source == LayerSource::World)) {
      const Kind kind = layer.source == LayerSource::World ? Kind::World : Kind::Emission;
      layers.layers.push_back(
          layer_of(layer, std::string(layer.name), eevee::render_light_layer(renderer, camera, sample_count, {kind})));
    }
  }
}

void Aov::add_surfaces(eevee::SceneRenderer &renderer, const scene::PlacedCamera &camera, int sample_count,
                       AovLayers &layers) const
{
  const auto lamps = renderer.render_scene().lamps();
  eevee::SurfaceRequest request = eevee::surface_request(names_);
  std::vector<std::string> visible;
  for (const eevee::PictureLayer &layer : eevee::picture_layers) {
    if (layer.source == LayerSource::Visibility) {
      visible = lamps_of(layer, lamps);
    }
  }
  for (const std::string &name : visible) {
    request.visible_lamps.push_back(lamps_named(lamps, name).front());
  }
  if (!request.has_centers && !request.has_means && !request.has_objects && visible.empty()) {
    return;
  }
  eevee::SurfaceLayers surfaces = eevee::render_surface_layers(renderer, camera, sample_count, request);
  for (const eevee::PictureLayer &layer : eevee::picture_layers) {
    const std::vector<glm::vec4> *pixels = surfaces.pixels(layer.source);
    if (pixels != nullptr && has(layer.name)) {
      layers.layers.push_back(layer_of(layer, std::string(layer.name), *pixels));
    }
    if (layer.source == LayerSource::Visibility) {
      for (std::size_t i = 0; i < visible.size(); i++) {
        layers.layers.push_back({fmt::format("{}.{}", layer.name, visible[i]), std::string(layer.channels),
                                 std::move(surfaces.visibilities[i])});
      }
    }
    const bool has_materials = layer.source == LayerSource::Materials;
    if (has(layer.name) && (has_materials || layer.source == LayerSource::Objects)) {
      Cryptomatte matte = make_cryptomatte(has_materials ? "CryptoMaterial" : "CryptoObject", surfaces.objects,
                                           eevee::object_names(renderer, has_materials));
      std::ranges::move(matte.layers, std::back_inserter(layers.layers));
      std::ranges::move(matte.metadata, std::back_inserter(layers.metadata));
    }
  }
}

AovLayers Aov::render(eevee::SceneRenderer &renderer, const scene::PlacedCamera &camera, int sample_count) const
{
  AovLayers layers;
  add_light(renderer, camera, sample_count, layers);
  add_surfaces(renderer, camera, sample_count, layers);
  return layers;
}

}  // namespace gnomon::cli
