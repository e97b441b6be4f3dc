// SPDX-License-Identifier: MIT
#include "internal/measure_bench_meshes.hh"
#include "internal/measure_temporary_folder.hh"

#include "gltf_export.hh"
#include "gltf_import.hh"
#include "measure_scene.hh"

#include <simdjson.h>

#include <glm/gtc/matrix_transform.hpp>

#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace gnomon::measure {

/** Reads a .gltf file and parses its JSON. \throws std::runtime_error if it is not JSON */
static void parse_file(const std::filesystem::path &path)
{
  const auto size = std::size_t(std::filesystem::file_size(path));
  simdjson::padded_string text(size);
  std::ifstream(path, std::ios::binary).read(text.data(), std::streamsize(size));
  simdjson::dom::parser parser;
  simdjson::dom::element document;
  if (parser.parse(text).get(document) != simdjson::SUCCESS) {
    throw std::runtime_error(fmt::format("{}: is not JSON", path.string()));
  }
}

std::vector<PartCost> measure_import(int node_count, int rounds)
{
  scene::Scene scene;
  const auto box = add_box_mesh(scene, add_material(scene, glm::vec3(0.6F)));
  for (int i = 0; i < node_count; i++) {
    add_object(scene, box, glm::translate(glm::dmat4(1.0), glm::dvec3(i % 100, i / 100, 0)));
  }
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path / "nodes.gltf";
  gltf::export_gltf(scene, path);
  std::vector<PartCost> costs = {{"file read, and its JSON parsed by simdjson"}, {"file imported"}};
  for (int round = 0; round <= rounds; round++) {
    std::vector<double> times = {now(Clock::Wall)};
    parse_file(path);
    times.push_back(now(Clock::Wall));
    static_cast<void>(gltf::import_gltf(path));
    times.push_back(now(Clock::Wall));
    // The first warms up.
    for (std::size_t i = 0; round > 0 && i < costs.size(); i++) {
      costs[i].seconds.push_back(times[i + 1] - times[i]);
    }
  }
  return costs;
}

}  // namespace gnomon::measure
