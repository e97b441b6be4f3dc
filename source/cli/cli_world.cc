// SPDX-License-Identifier: MIT
#include "cli_world.hh"

#include "cli.hh"
#include "cli_picture.hh"

#include "gltf_import.hh"
#include "scene_studio.hh"

#include <fmt/format.h>
#include <glm/trigonometric.hpp>

#include <charconv>
#include <cmath>

namespace gnomon::cli {

void add_world_options(CLI::App &command, WorldOptions &options)
{
  command.add_option("--world", options.world,
                     "World that lights the scene: an equirectangular HDR or EXR picture, a radiance R,G,B, studio, or "
                     "none (default: the scene's own; studio if the scene has neither lamps nor a world)");
  command.add_option("--world-layer", options.layer,
                     "Layer of the world's EXR file, where it has several and none without a name");
  command.add_option("--world-strength", options.strength, "Factor of the world's radiance")
      ->capture_default_str()
      ->check(number_range(0.0, 1e6));
  command
      .add_option("--world-rotation", options.rotation_degrees,
                  "Rotation of the world around the vertical axis, degrees")
      ->capture_default_str()
      ->check(number_range(-360.0, 360.0));
}

std::vector<std::string> arguments_of(const WorldOptions &options)
{
  std::vector<std::string> arguments = {"--world-strength", fmt::format("{}", options.strength), "--world-rotation",
                                        fmt::format("{}", options.rotation_degrees)};
  if (!options.world.empty()) {
    arguments.insert(arguments.end(), {"--world", options.world});
  }
  if (!options.layer.empty()) {
    arguments.insert(arguments.end(), {"--world-layer", options.layer});
  }
  return arguments;
}

void add_background_option(CLI::App &command, std::string &background)
{
  command.add_option(
      "--background", background,
      "Background of pixels without a surface: none (transparent: the file has alpha), world, or a radiance R,G,B "
      "(default: the scene's own world; with --world, or without a world, none; light grey in a PNG that the default "
      "studio lights)");
}

std::optional<glm::vec3> parse_color(const std::string &text)
{
  glm::vec3 color(0.0F);
  const char *at = text.data();
  const char *end = text.data() + text.size();
  for (int i = 0; i < 3; i++) {
    const auto [after, error] = std::from_chars(at, end, color[i]);
    const bool is_last = i == 2;
    if (error != std::errc() || !(color[i] >= 0.0F) || std::isinf(color[i]) ||
        (is_last ? after != end : after == end || *after != ',')) {
      return std::nullopt;
    }
    at = after + (is_last ? 0 : 1);
  }
  return color;
}

scene::WorldPicture read_world_picture(const std::filesystem::path &path, const std::string &layer,
                                       std::vector<std::string> &warnings)
{
  const Picture file = read_picture(path, layer);
  if (file.is_cube_map) {
    throw std::runtime_error(fmt::format(
        "{}: is a cube map, and a world must be an equirectangular picture (latitude and longitude)", path.string()));
  }
  for (const std::string &warning : file.warnings) {
    warnings.push_back(fmt::format("world '{}': {}", path.string(), warning));
  }
  scene::WorldPicture picture{file.size_px.x, file.size_px.y, {}, path.string()};
  picture.texels.reserve(file.pixels.size());
  for (int y = file.size_px.y - 1; y >= 0; y--) {
    for (int x = 0; x < file.size_px.x; x++) {
      picture.texels.emplace_back(file.pixels[std::size_t(y) * std::size_t(file.size_px.x) + std::size_t(x)]);
    }
  }
  return picture;
}

void add_only_below_option(CLI::App &command, std::filesystem::path &folder)
{
  // An empty name, of a variable that is not set, is an error, too.
  command
      .add_option("--only-below", folder,
                  "For scenes of strangers: read the files that the scene names only below this folder, after links "
                  "are resolved (default: anywhere)")
      ->check(CLI::ExistingDirectory);
}

/** Whether the world of \a options is the path of a picture. */
static bool names_picture(const WorldOptions &options)
{
  return !options.world.empty() && options.world != "none" && options.world != "studio" && !parse_color(options.world);
}

void add_inputs(output::Roles &roles, const scene::Scene &scene, const WorldOptions &options)
{
  for (const std::string &file : scene.files) {
    roles.add_input(file, file == scene.path ? "the scene" : "the scene's file");
  }
  if (names_picture(options)) {
    roles.add_input(options.world, "--world");
  }
}

scene::Scene import_scene(const std::string &path, const WorldOptions &world, const gltf::ImportOptions &options)
{
  const std::string layer = world.world.empty() ? world.layer : "";
  gltf::ImportOptions all = options;
  std::vector<std::string> warnings;
  all.read_picture = [&](const std::filesystem::path &picture) { return read_world_picture(picture, layer, warnings); };
  scene::Scene scene = gltf::import_gltf(path, all);
  scene.warnings.insert(scene.warnings.end(), warnings.begin(), warnings.end());
  return scene;
}

std::string world_text(const scene::World &world)
{
  if (!world.picture) {
    const glm::vec3 radiance = world.color * world.strength;
    return fmt::format("{:g}, {:g}, {:g} W/(sr m²)", radiance.r, radiance.g, radiance.b);
  }
  const scene::WorldPicture &picture = *world.picture;
  return fmt::format("picture{}, {}x{}, color {:g}, {:g}, {:g}, strength {:g}, rotation {:g}°",
                     picture.path.empty() ? "" : " '" + picture.path + "'", picture.width, picture.height,
                     world.color.r, world.color.g, world.color.b, world.strength, glm::degrees(world.rotation));
}

/** The world that the options name: a radiance or the path of a picture. */
static scene::World world_of(const WorldOptions &options, std::vector<std::string> &warnings)
{
  if (const std::optional<glm::vec3> color = parse_color(options.world)) {
    return {.color = *color};
  }
  const bool is_list = options.world.find(',') != options.world.npos;
  if (std::error_code ignored; is_list && !std::filesystem::exists(options.world, ignored)) {
    throw std::runtime_error(
        fmt::format("--world '{}': no file has this name, and it is no radiance: three finite numbers R,G,B, 0 or more",
                    options.world));
  }
  scene::WorldPicture picture = read_world_picture(options.world, options.layer, warnings);
  if (const std::string clamped = clamp_radiances(picture); !clamped.empty()) {
    warnings.push_back(fmt::format("world '{}': {}", options.world, clamped));
  }
  return {.picture = std::make_shared<const scene::WorldPicture>(std::move(picture))};
}

bool light_by_world(scene::Scene &scene, const scene::PlacedCamera &camera, const WorldOptions &options)
{
  const bool is_default = options.world.empty();
  const bool has_picture = is_default ? scene.world() && scene.world()->picture : names_picture(options);
  if (!options.layer.empty() && !has_picture) {
    scene.warnings.push_back(
        fmt::format("--world-layer {}: has no effect, because the world is no picture", options.layer));
  }
  if (options.world == "none") {
    scene.set_world(std::nullopt);
    return false;
  }
  const bool is_default_studio = is_default && !scene.world() && scene.is_lamp_default;
  std::optional<scene::World> world = options.world == "studio" || is_default_studio
                                          ? scene::studio_world(camera.world_from_camera)
                                      : is_default ? scene.world()
                                                   : world_of(options, scene.warnings);
  if (!world) {
    return false;
  }
  world->strength *= options.strength;
  world->rotation += glm::radians(options.rotation_degrees);
  if (const std::string limited = limit_radiances(*world); !limited.empty()) {
    scene.warnings.push_back("world: " + limited);
  }
  scene.set_world(std::move(world));
  if (scene.is_lamp_default) {
    scene.remove(scene.placed_lamps().front().node);
    scene.is_lamp_default = false;
    std::erase_if(scene.warnings,
                  [](const std::string &line) { return line.find("has no lamp") != std::string::npos; });
    if (is_default_studio) {
      scene.warnings.push_back(
          "scene: has no lamp and no world; the studio world lights it (--world none uses a sun instead)");
    }
  }
  return is_default_studio;
}

eevee::Background background_of(const std::string &option, const eevee::Background &fallback)
{
  using Kind = eevee::Background::Kind;
  if (option.empty()) {
    return fallback;
  }
  if (option == "none" || option == "world") {
    return {option == "none" ? Kind::None : Kind::World};
  }
  const std::optional<glm::vec3> color = parse_color(option);
  if (!color) {
    throw UsageError(fmt::format("--background '{}' is not none, world or a radiance R,G,B", option));
  }
  return {Kind::Color, *color};
}

}  // namespace gnomon::cli
