// SPDX-License-Identifier: MIT
#include "cli.hh"
#include "cli_world.hh"

#include "scene_units.hh"

#include <fmt/format.h>

namespace gnomon::cli {

static const char *to_string(scene::LampKind kind)
{
  switch (kind) {
    case scene::LampKind::Point: return "point";
    case scene::LampKind::Sun: return "sun";
    case scene::LampKind::Spot: return "spot";
    case scene::LampKind::Hemi: return "hemi";
    case scene::LampKind::Area: return "area";
  }
  return "?";
}

/** \a is_world_default: the studio was added. */
static void print_info(const scene::Scene &scene, bool is_world_default)
{
  const std::vector<scene::Object> objects = scene.objects();
  std::array<std::size_t, 3> counts{};
  for (const scene::Object &object : objects) {
    const scene::Mesh &mesh = scene.meshes()[object.mesh];
    counts[std::size_t(mesh.topology)] += mesh.indices.size() / index_count_of(mesh.topology);
  }
  const auto [triangles, lines, points] = counts;
  fmt::print("{}\n", output::printable(scene.path));
  fmt::print("  {} objects of {} meshes, {} triangles{}{} as placed, {} materials\n", objects.size(),
             scene.meshes().size(), triangles, lines > 0 ? fmt::format(", {} lines", lines) : "",
             points > 0 ? fmt::format(", {} points", points) : "", scene.materials().size());
  const scene::Bounds bounds = scene.bounds();
  if (!bounds.is_empty()) {
    fmt::print("  bounds ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}) m\n", bounds.min.x, bounds.min.y, bounds.min.z,
               bounds.max.x, bounds.max.y, bounds.max.z);
  }
  for (const auto &[handle, image] : scene.images()) {
    fmt::print("  image '{}', {}x{}\n", output::printable(image.name), image.width, image.height);
  }
  for (const scene::PlacedCamera &camera : scene.placed_cameras()) {
    fmt::print("  camera '{}', {}{}\n", output::printable(camera.name),
               camera.kind == scene::CameraKind::Perspective ? "perspective" : "orthographic",
               scene.is_camera_default ? " (added)" : "");
  }
  for (const scene::PlacedLamp &lamp : scene.placed_lamps()) {
    fmt::print("  lamp '{}', {}, {:g} {}{}\n", output::printable(lamp.name), to_string(lamp.kind), lamp.intensity,
               scene::intensity_unit(lamp.kind), scene.is_lamp_default ? " (added)" : "");
  }
  if (scene.world()) {
    fmt::print("  world, {}{}\n", output::printable(world_text(*scene.world())), is_world_default ? " (added)" : "");
  }
  for (const scene::Animation &animation : scene.animations) {
    fmt::print("  animation '{}', {:g} s, {} nodes, {} values\n", output::printable(animation.name),
               animation.duration(), animation.nodes.size(), animation.values.size());
  }
  for (const scene::DeformedMesh &deformed : scene.deformed_meshes) {
    fmt::print("  deformed mesh '{}', {} vertices, {} morph targets, {}\n",
               output::printable(scene.meshes()[deformed.mesh].name), deformed.positions.size(),
               deformed.targets.size(),
               deformed.skin < 0 ? "no skin"
                                 : fmt::format("{} joints", scene.skins[std::size_t(deformed.skin)].joints.size()));
  }
}

void add_info(CLI::App &app, Status &status)
{
  CLI::App *command = app.add_subcommand("info", "Contents of a scene");
  const auto path = std::make_shared<std::string>();
  const auto world = std::make_shared<WorldOptions>();
  command->add_option("scene", *path, "glTF 2.0 file")->required();
  const auto only_below = std::make_shared<std::filesystem::path>();
  add_world_options(*command, *world);
  add_only_below_option(*command, *only_below);
  command->callback([path, world, only_below, &status] {
    scene::Scene scene = import_scene(*path, *world, {.only_below = *only_below});
    const bool is_world_default = light_by_world(scene, scene.placed_cameras().front(), *world);
    for (const std::string &warning : scene.warnings) {
      print_message("gnomon: warning: {}\n", warning);
    }
    print_info(scene, is_world_default);
    status = Status::Done;
  });
}

}  // namespace gnomon::cli
