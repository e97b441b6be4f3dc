// SPDX-License-Identifier: MIT
#include "cli_bench.hh"
#include "cli_device.hh"
#include "cli_render_options.hh"

#include "eevee_scene_renderer.hh"
#include "output_roles.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <string_view>

namespace gnomon::cli {

namespace {

/** Bytes of content on the device after the first sample of a picture. */
struct DeviceBytes {
  std::size_t all = 0;
  /** Bytes of the layers of shadows. */
  std::size_t shadows = 0;
};

DeviceBytes device_bytes(gpu::Device &device, const scene::Scene &scene, const RenderOptions &options)
{
  eevee::SceneRenderer renderer(device, scene, options.size_px(device), options.engine_settings());
  renderer.sync();
  renderer.draw_sample(scene.placed_cameras().front());
  DeviceBytes bytes{.all = device.memory_bytes()};
  for (const gpu::LiveResource &resource : device.live()) {
    const bool is_layer = resource.kind == gpu::ResourceKind::Texture && resource.name.starts_with("shadow_");
    bytes.shadows += is_layer ? resource.size_bytes : 0;
  }
  return bytes;
}

nlohmann::json print_memory(gpu::Device &device, const BenchOptions &options, const std::string &path)
{
  scene::Scene scene = import_scene(path, options.world);
  output::Roles roles;
  add_inputs(roles, scene, options.world);
  roles.add_output(options.json, "--json");
  light_by_world(scene, scene.placed_cameras().front(), options.world);
  fmt::print("\n{:<44} {:>9} {:>9} {:>18}\n", path, "all, MiB", "shadows", "all/without shadows");
  nlohmann::json rows = nlohmann::json::array();
  for (const int samples : {1, 64}) {
    RenderOptions picture;
    picture.size = options.size;
    picture.samples = samples;
    const DeviceBytes bytes = device_bytes(device, scene, picture);
    picture.changes.emplace_back([](eevee::Settings &settings) { settings.shadow.kind = scene::ShadowKind::None; });
    const DeviceBytes without = device_bytes(device, scene, picture);
    const double ratio = double(bytes.all) / double(without.all);
    fmt::print("  {:<42} {:>9.1f} {:>9.1f} {:>18.2f}\n", fmt::format("{} samples", samples), double(bytes.all) / 0x1p20,
               double(bytes.shadows) / 0x1p20, ratio);
    rows.push_back({{"scene", path},
                    {"samples", samples},
                    {"bytes", bytes.all},
                    {"shadow_bytes", bytes.shadows},
                    {"bytes_without_shadows", without.all}});
  }
  return rows;
}

}  // namespace

void bench_memory(const BenchOptions &options)
{
  const std::unique_ptr<gpu::Device> device = create_device(options.backend);
  fmt::print(
      "Content on the device after the first sample of a picture of {} pixels, with the settings of `gnomon render`,\n"
      "and its ratio to the same picture without shadows. {}\n",
      options.size, device->description());
  nlohmann::json rows = nlohmann::json::array();
  for (const std::string &path : options.scenes) {
    for (const nlohmann::json &row : print_memory(*device, options, path)) {
      rows.push_back(row);
    }
  }
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "memory"},
                            {"size", options.size},
                            {"device", device->description()},
                            {"rows", rows}});
}

}  // namespace gnomon::cli
