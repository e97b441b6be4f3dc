// SPDX-License-Identifier: MIT
#include "cli.hh"

#ifdef GNOMON_VIEW
#include "cli_device.hh"
#include "cli_picture.hh"
#include "cli_world.hh"

#include "view.hh"
#endif

namespace gnomon::cli {

#ifdef GNOMON_VIEW
void add_view(CLI::App &app)
{
  CLI::App *command = app.add_subcommand("view", "A window on a scene: look at it, edit it, save it");
  const auto o = std::make_shared<view::Options>();
  command->add_option("scene", o->scene, "glTF 2.0 file; others can be dropped on the window");
  command->add_option("--script", o->script, "Run the commands of a file, then end");
  command->add_option("--screenshot", o->screenshot,
                      "Write the window to a PNG when its pictures are complete, then end");
  command->add_option("--shaders", o->shaders,
                      "Folder with the engine's shaders, which are compiled again when a file changes");
  add_only_below_option(*command, o->only_below);
  const auto backend = std::make_shared<std::string>("auto");
  add_backend_option(*command, *backend);
  command->callback([o, backend] {
    o->backend = gpu::backend_of(*backend);
    o->writers.png = [](const auto &path, glm::ivec2 size_px, std::span<const std::uint8_t> rgba) {
      write_png(path, size_px, rgba, {});
    };
    o->writers.exr = [](const auto &path, glm::ivec2 size_px, std::span<const float> rgba) {
      write_exr(path, size_px, rgba, {{"gnomon:units", "scene-linear radiance, W/(sr m^2)"}}, Alpha::Written);
    };
    o->read_picture = [](const std::filesystem::path &path) {
      // The window shows no warnings of pictures.
      std::vector<std::string> warnings;
      scene::WorldPicture picture = read_world_picture(path, {}, warnings);
      static_cast<void>(clamp_radiances(picture));
      return picture;
    };
    view::run(*o);
  });
}
#else
void add_view(CLI::App &app)
{
  CLI::App *command = app.add_subcommand("view", "A window on a scene (left out of this build)");
  command->allow_extras();
  command->callback([] { throw UsageError("'view' is left out of this build: cmake -DGNOMON_VIEW=ON"); });
}
#endif

}  // namespace gnomon::cli
