// SPDX-License-Identifier: MIT
// Memory of long sessions: of the device, and of the process.
#include "allocated.hh"
#include "eevee_budget_controller.hh"
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"
#include "gltf_import.hh"
#include "gpu_device_fixture.hh"
#include "shadows/shadows.hh"

#include <unistd.h>
#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <fstream>

namespace gnomon::eevee {
namespace {

class SlowMemoryGpuTest : public test::SharedDeviceTest {};

const std::string spots_file = GNOMON_SOURCE "/examples/scenes/spots.glb";

/** Resident memory of the process, MiB. */
double resident_mib()
{
  std::ifstream file("/proc/self/statm");
  double size_pages = 0.0;
  double resident_pages = 0.0;
  file >> size_pages >> resident_pages;
  return resident_pages * double(sysconf(_SC_PAGESIZE)) / 0x1p20;
}

TEST_F(SlowMemoryGpuTest, StaysFlatOver5000FramesWithEdits)
{
  scene::Scene scene = gltf::import_gltf(spots_file);
  const scene::PlacedCamera start = scene.placed_cameras().front();
  const scene::Handle<scene::Node> lamp = scene.placed_lamps().front().node;
  const scene::Handle<scene::Mesh> mesh = test::handle_at(scene.meshes(), 1);
  const scene::Handle<scene::Material> material = scene.meshes()[mesh].material;
  const glm::dmat4 lamp_place = scene.nodes()[lamp].parent_from_node;
  SceneRenderer renderer(*device, scene, {96, 54}, {.sample_count = 2});
  const draw::TargetTexture target(*device, "target", gpu::Format::RGBA8, {96, 54});
  scene::Handle<scene::Node> added;
  // All edits return to their first state after 20 frames.
  const auto edit = [&](int frame) {
    const double wave = std::sin(2.0 * 3.14159265358979 * double(frame % 20) / 20.0);
    switch (frame % 5) {
      case 0: scene.set_transform(lamp, glm::translate(lamp_place, {0.1 * wave, 0, 0})); break;
      case 1: scene.edit(material, [&](scene::Material &one) { one.roughness = float(0.5 + 0.4 * wave); }); break;
      case 2: added = test::add_object(scene, mesh, glm::translate(glm::dmat4(1), {wave, 1.0, 0.0})); break;
      case 3: scene.remove(added); break;
      default: break;
    }
    scene::PlacedCamera camera = start;
    camera.world_from_camera = glm::translate(start.world_from_camera, {0.05 * wave, 0, 0});
    return camera;
  };
  const auto draw = [&](int frame) {
    const scene::PlacedCamera camera = edit(frame);
    if (frame % 100 < 50) {
      // The smallest previews, previews of the machine's speed, and whole samples, which need the most memory.
      constexpr std::array<double, 3> budgets = {BudgetController::budget_min, 0.02, 10.0};
      renderer.draw_within(budgets[std::size_t(frame / 100) % 3], camera, target.target());
      return;
    }
    renderer.sync();
    renderer.draw_sample(camera, target.target());
  };
  std::size_t device_bytes = 0;
  std::size_t live_count = 0;
  double resident = 0.0;
  for (int frame = 0; frame < 5000; frame++) {
    draw(frame);
    if (frame == 1499) {
      device_bytes = device->memory_bytes();
      live_count = device->live_resources().size();
      resident = resident_mib();
    }
  }
  // Previews have the size of the machine's speed.
  EXPECT_LE(double(device->memory_bytes()), 1.05 * double(device_bytes));
  EXPECT_EQ(device->live_resources().size(), live_count);
  EXPECT_LE(resident_mib(), resident + 8.0);
  RecordProperty("growth_mib", std::to_string(resident_mib() - resident));
  printf("5000 frames: %.2f MiB, %.2f MiB more than after 1500\n", resident_mib(), resident_mib() - resident);
}

using MemoryGpuTest = test::SharedDeviceTest;

TEST_F(MemoryGpuTest, EachTurnOfScenesLeavesAsMuchAllocated)
{
  if (test::allocated_mib() == 0.0) {
    GTEST_SKIP() << "the allocator does not tell";
  }
  const auto draw_all = [&] {
    for (const char *name : {"full.gltf", "plaza.glb", "room.glb", "spots.glb"}) {
      const scene::Scene scene = gltf::import_gltf(std::string(GNOMON_SOURCE "/examples/scenes/") + name);
      SceneRenderer renderer(*device, scene, {96, 54}, {.sample_count = 1});
      renderer.sync();
      renderer.draw(scene.placed_cameras().front());
    }
    EXPECT_EQ(device->live_resources(), std::vector<std::string>());
    return test::allocated_mib();
  };
  draw_all();
  const double first_mib = draw_all();
  // On a busy machine, Device::trim may miss some textures, which the next call gives back.
  EXPECT_LE(std::min({draw_all(), draw_all(), draw_all()}), first_mib + 1.0);
}

/** Four maps of this size with 32 bits, and their size without short depths, take 256 MiB. */
TEST_F(MemoryGpuTest, MapsOfPicturesOf64SamplesHaveFewTexelsOf16Bits)
{
  const scene::Scene scene = gltf::import_gltf(GNOMON_SOURCE "/examples/scenes/plaza.glb");
  SceneRenderer renderer(*device, scene, {640, 360}, offline_settings(64));
  renderer.sync();
  renderer.draw_sample(scene.placed_cameras().front());
  const gpu::Texture &maps = renderer.inspect().shadows().scene().maps();
  EXPECT_EQ(maps.desc().format, gpu::Format::Depth16);
  EXPECT_LE(double(maps.desc().size_bytes()) / 0x1p20, 72.0);
}

/** The lamp is above all objects, so that no surface looks up the face at +Y. */
TEST_F(MemoryGpuTest, CubesOfPicturesOf64SamplesHaveNoLayerForAFaceThatNothingLooksUp)
{
  const scene::Scene scene = gltf::import_gltf(GNOMON_SOURCE "/examples/scenes/plaza.glb");
  SceneRenderer renderer(*device, scene, {640, 360}, offline_settings(64));
  renderer.sync();
  renderer.draw_sample(scene.placed_cameras().front());
  EXPECT_LE(renderer.inspect().shadows().scene().cubes().desc().layers, 5);
}

TEST_F(SlowMemoryGpuTest, StaysFlatOver200ScenesThatAreLoaded)
{
  double resident = 0.0;
  for (int load = 0; load < 200; load++) {
    const scene::Scene scene = gltf::import_gltf(spots_file);
    SceneRenderer renderer(*device, scene, {96, 54}, {.sample_count = 1});
    renderer.sync();
    renderer.draw(scene.placed_cameras().front());
    resident = load == 49 ? resident_mib() : resident;
  }
  EXPECT_TRUE(device->live_resources().empty());
  EXPECT_LE(resident_mib(), resident + 8.0);
  printf("200 scenes: %.2f MiB, %.2f MiB more than after 50\n", resident_mib(), resident_mib() - resident);
}

}  // namespace
}  // namespace gnomon::eevee
