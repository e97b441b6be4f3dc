// SPDX-License-Identifier: MIT
#include "internal/measure_bench_meshes.hh"

#include "measure_scene.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::measure {

namespace {

/** Quads along an edge of the terrain, which is a square of as many metres. */
constexpr int terrain_edge = 200;
static_assert(2 * terrain_edge * terrain_edge == sync_triangle_count);

/** Hills of one mesh, with point lamps between them whose light reaches all triangles, and a box above. */
class Terrain {
 public:
  Terrain()
  {
    scene::Mesh mesh;
    mesh.name = "terrain";
    constexpr int row = terrain_edge + 1;
    for (int z = 0; z < row; z++) {
      for (int x = 0; x < row; x++) {
        mesh.positions.emplace_back(float(x), height_m(float(x), float(z)), float(z));
      }
    }
    mesh.normals.assign(mesh.positions.size(), {0, 1, 0});
    for (int z = 0; z < terrain_edge; z++) {
      for (int x = 0; x < terrain_edge; x++) {
        const auto i = std::uint32_t(z * row + x);
        mesh.indices.insert(mesh.indices.end(), {i, i + row, i + 1, i + 1, i + row, i + row + 1});
      }
    }
    mesh.material = add_material(scene, glm::vec3(0.6F));
    terrain = scene.add(std::move(mesh));
    add_object(scene, terrain, glm::dmat4(1.0));
    box = add_object(scene, add_box_mesh(scene, scene.meshes()[terrain].material), box_at(0.0));
    for (int i = 0; i < sync_lamp_count; i++) {
      const float x = 20.0F * float(i % 10) + 10.3F;
      const float z = 40.0F * float(i / 10) + 10.3F;
      add_lamp(scene, scene::LampKind::Point, {x, height_m(x, z) + 0.5F, z}, {0, -1, 0}, 30.0F);
    }
    lamp = scene.placed_lamps().front().node;
    const auto edge = float(terrain_edge);
    camera = camera_at({0.5F * edge, 30.0F, edge + 20.0F}, {0.5F * edge, 0.0F, 0.5F * edge});
  }

  static glm::dmat4 box_at(double shift_m)
  {
    return glm::translate(glm::dmat4(1.0), {0.5 * terrain_edge + shift_m, 20.0, 0.5 * terrain_edge});
  }

  scene::Scene scene;
  scene::Handle<scene::Mesh> terrain;
  scene::Handle<scene::Node> box;
  scene::Handle<scene::Node> lamp;
  scene::PlacedCamera camera;

 private:
  static float height_m(float x, float z)
  {
    return 4.0F * std::sin(0.1F * x) * std::sin(0.13F * z);
  }
};

/** The least distance of a point to a vertex of each triangle in turn. */
float least_distance(const scene::Mesh &mesh, const glm::vec3 &point)
{
  float least = std::numeric_limits<float>::infinity();
  for (const std::uint32_t index : mesh.indices) {
    const glm::vec3 offset = mesh.positions[index] - point;
    least = std::min(least, glm::dot(offset, offset));
  }
  return std::sqrt(least);
}

}  // namespace

std::vector<PartCost> measure_sync(gpu::Device &device, int rounds)
{
  Terrain terrain;
  const scene::Mesh &mesh = terrain.scene.meshes()[terrain.terrain];
  std::vector<PartCost> costs = {{"distances of the triangles to one lamp"},
                                 {"first sync and picture"},
                                 {"nothing was changed"},
                                 {"an object was moved"},
                                 {"one lamp was moved"}};
  for (int round = 0; round <= rounds; round++) {
    std::vector<double> seconds;
    const auto measure = [&](auto &&work) {
      const double start = now(Clock::Wall);
      work();
      seconds.push_back(now(Clock::Wall) - start);
    };
    const double shift_m = 0.01 * (round + 1);
    // Used, so that the loop is not left out.
    float least_m = 0.0F;
    measure([&] { least_m = least_distance(mesh, glm::vec3(float(shift_m))); });
    eevee::SceneRenderer renderer(device, terrain.scene, glm::ivec2(320, 180), {.shadow = {.cube_size_px = 16}});
    // Distances to triangles are found where the picture is recorded.
    const auto sync_and_draw = [&] {
      renderer.sync();
      renderer.draw(terrain.camera);
    };
    measure(sync_and_draw);
    measure(sync_and_draw);
    terrain.scene.set_transform(terrain.box, Terrain::box_at(shift_m + double(least_m)));
    measure(sync_and_draw);
    terrain.scene.edit(terrain.lamp, [](scene::Node &node) { node.parent_from_node[3].y += 0.001; });
    measure(sync_and_draw);
    // The first warms up.
    for (std::size_t i = 0; round > 0 && i < costs.size(); i++) {
      costs[i].seconds.push_back(seconds[i]);
    }
  }
  return costs;
}

}  // namespace gnomon::measure
