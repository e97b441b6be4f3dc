// SPDX-License-Identifier: MIT
#include "cli_aov.hh"

#include "cli.hh"
#include "cli_cryptomatte.hh"

#include "render_materials.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <set>

namespace gnomon::cli {

namespace {

constexpr std::array<std::string_view, 12> plain_names = {"combined", "depth",      "position",      "normal",
                                                          "albedo",   "roughness",  "emission",      "world",
                                                          "light",    "visibility", "crypto_object", "crypto_material"};
/** Followed by a dot and the name of a lamp. */
constexpr std::array<std::string_view, 2> lamp_names = {"light", "visibility"};
/** Names of layers that show surfaces. */
constexpr std::array<std::string_view, 8> surface_names = {
    "depth", "position", "normal", "albedo", "roughness", "visibility", "crypto_object", "crypto_material"};

/** The name of a lamp's layer up to the dot; otherwise the whole name. */
std::string_view layer_kind(std::string_view name)
{
  const std::string_view stem = name.substr(0, name.find('.'));
  return std::ranges::find(lamp_names, stem) != lamp_names.end() ? stem : name;
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

/** The first components of \a pixels, from \a first. */
Layer layer_of(std::string name, std::string channels, std::span<const glm::vec4> pixels, int first = 0)
{
  Layer layer{std::move(name), std::move(channels), {}};
  layer.values.reserve(pixels.size() * layer.channels.size());
  for (const glm::vec4 &pixel : pixels) {
    for (std::size_t i = 0; i < layer.channels.size(); i++) {
      layer.values.push_back(pixel[first + int(i)]);
    }
  }
  return layer;
}

/** The names of objects by draw::ObjectIndex: those of their nodes or of their materials. Empty: no object. */
std::vector<std::string> object_names(eevee::SceneRenderer &renderer, bool is_material)
{
  const scene::Scene &scene = renderer.render_scene().scene();
  const draw::ObjectBuffer &objects = renderer.render_scene().objects();
  std::vector<std::string> names(objects.index_end());
  for (draw::ObjectIndex i = draw::object_identity + 1; i < objects.index_end(); i++) {
    if (objects.is_live(i)) {
      const render_scene::RenderObject &object = renderer.render_scene().object(i);
      names[i] = is_material ? scene.material_of(scene.meshes()[object.mesh]).name : scene.nodes()[object.node].name;
      names[i] = names[i].empty() ? "unnamed" : names[i];
    }
  }
  return names;
}

}  // namespace

std::string aov_names()
{
  return fmt::format("{}, light.LAMP, visibility.LAMP", fmt::join(plain_names, ", "));
}

Aov::Aov(const std::string &list)
{
  for (std::size_t begin = 0; !list.empty() && begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    names_.push_back(list.substr(begin, end - begin));
    begin = end + 1;
    const std::string &name = names_.back();
    if (std::ranges::find(plain_names, layer_kind(name)) == plain_names.end()) {
      throw UsageError(fmt::format("--aov: no layer '{}'; there are: {}", name, aov_names()));
    }
  }
}

bool Aov::has(const std::string &name) const
{
  return std::ranges::find(names_, name) != names_.end();
}

std::vector<std::string> Aov::lamps_of(const std::string &layer, std::span<const scene::PlacedLamp> lamps) const
{
  std::vector<std::string> names;
  const auto add = [&](const std::string &name) {
    if (std::ranges::find(names, name) == names.end()) {
      names.push_back(name);
    }
  };
  for (const std::string &name : names_) {
    if (name == layer) {
      std::ranges::for_each(lamps, add, &scene::PlacedLamp::name);
    }
    else if (layer_kind(name) == layer) {
      add(name.substr(layer.size() + 1));
    }
  }
  return names;
}

void Aov::check(const scene::Scene &scene) const
{
  const std::vector<scene::PlacedLamp> lamps = scene.placed_lamps();
  for (const std::string_view layer : lamp_names) {
    for (const std::string &name : lamps_of(std::string(layer), lamps)) {
      // OpenEXR cuts longer names off. A dot, a dot and a letter are added.
      if (layer.size() + name.size() + 3 > 255) {
        throw std::runtime_error(fmt::format("{}: --aov {}: the name of lamp '{}' is too long for a channel of an EXR",
                                             scene.path, layer, name));
      }
      const std::size_t count = lamps_named(lamps, name).size();
      if (count == 0) {
        std::set<std::string> names;
        std::ranges::transform(lamps, std::inserter(names, names.end()), &scene::PlacedLamp::name);
        throw std::runtime_error(fmt::format("{}: --aov {}.{}: no lamp '{}'; visible lamps: {}", scene.path, layer,
                                             name, name,
                                             names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
      }
      if (count > 1 && layer == "visibility") {
        throw std::runtime_error(fmt::format("{}: --aov visibility: {} lamps have the name '{}'; each needs its own",
                                             scene.path, count, name));
      }
    }
  }
}

std::vector<std::string> Aov::warnings(const scene::Scene &scene) const
{
  std::vector<std::string> layers;
  std::ranges::copy_if(names_, std::back_inserter(layers), [](const std::string &name) {
    return std::ranges::find(surface_names, layer_kind(name)) != surface_names.end();
  });
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
  for (const char *name : {"light", "visibility"}) {
    if (has(name) && scene.placed_lamps().empty()) {
      warnings.push_back(fmt::format("--aov {}: the scene has no lamps, so there are no such layers", name));
    }
  }
  return warnings;
}

void Aov::add_light(eevee::SceneRenderer &renderer, const scene::PlacedCamera &camera, int sample_count,
                    AovLayers &layers) const
{
  using eevee::LightPart;
  const auto render_part = [&](const LightPart &part) {
    return eevee::render_light_layer(renderer, camera, sample_count, part);
  };
  for (const std::string &name : lamps_of("light", renderer.render_scene().lamps())) {
    layers.layers.push_back(
        layer_of("light." + name, "RGB", eevee::render_lamp_layer(renderer, camera, sample_count, name)));
  }
  // The world comes last, because the layers before leave it out.
  if (has("emission")) {
    layers.layers.push_back(layer_of("emission", "RGB", render_part({LightPart::Kind::Emission})));
  }
  if (has("world")) {
    layers.layers.push_back(layer_of("world", "RGB", render_part({LightPart::Kind::World})));
  }
}

void Aov::add_surfaces(eevee::SceneRenderer &renderer, const scene::PlacedCamera &camera, int sample_count,
                       AovLayers &layers) const
{
  const auto lamps = renderer.render_scene().lamps();
  const std::vector<std::string> visible = lamps_of("visibility", lamps);
  eevee::SurfaceRequest request{.has_centers = has("depth") || has("position") || has("normal"),
                                .has_means = has("albedo") || has("roughness"),
                                .has_objects = has("crypto_object") || has("crypto_material")};
  for (const std::string &name : visible) {
    request.visible_lamps.push_back(lamps_named(lamps, name).front());
  }
  if (!request.has_centers && !request.has_means && !request.has_objects && visible.empty()) {
    return;
  }
  eevee::SurfaceLayers surfaces = eevee::render_surface_layers(renderer, camera, sample_count, request);
  const auto add = [&](const char *name, const char *channels, std::span<const glm::vec4> pixels, int first = 0) {
    if (has(name)) {
      layers.layers.push_back(layer_of(name, channels, pixels, first));
    }
  };
  add("depth", "Z", surfaces.position_depth, 3);
  add("position", "XYZ", surfaces.position_depth);
  add("normal", "XYZ", surfaces.normal);
  add("albedo", "RGB", surfaces.albedo_roughness);
  add("roughness", "V", surfaces.albedo_roughness, 3);
  for (std::size_t i = 0; i < visible.size(); i++) {
    layers.layers.push_back({"visibility." + visible[i], "V", std::move(surfaces.visibilities[i])});
  }
  for (const auto &[option, name] :
       {std::pair("crypto_object", "CryptoObject"), std::pair("crypto_material", "CryptoMaterial")}) {
    if (has(option)) {
      Cryptomatte matte = make_cryptomatte(name, surfaces.objects,
                                           object_names(renderer, std::string_view(option) == "crypto_material"));
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
