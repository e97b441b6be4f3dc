// SPDX-License-Identifier: MIT
// A scene far from the origin looks the same: matrices are composed in double, and the device's are relative.
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"

#include "gltf_import.hh"
#include "gpu_device_fixture.hh"
#include "reference_light.hh"

#include <gtest/gtest.h>

namespace gnomon::eevee {
namespace {

/** The scene with all roots moved by \a shift. */
void move_all(scene::Scene &scene, const glm::dvec3 &shift)
{
  std::vector<scene::Handle<scene::Node>> roots;
  for (const auto &[handle, node] : scene.nodes()) {
    if (!scene.parent(handle)) {
      roots.push_back(handle);
    }
  }
  const scene::Handle<scene::Node> root =
      scene.add(scene::Node{.name = "root", .parent_from_node = glm::translate(glm::dmat4(1.0), shift)});
  for (const scene::Handle<scene::Node> node : roots) {
    scene.set_parent(node, root);
  }
}

scene::Scene load(const std::string &name)
{
  const std::string folder =
      name == "forest" ? std::string(GNOMON_TEST_DATA) + "/scenes/" : std::string(GNOMON_SOURCE) + "/examples/scenes/";
  return gltf::import_gltf(folder + name + ".glb");
}

class FarAway : public test::SharedDeviceTest {
 protected:
  static constexpr glm::ivec2 size_px{160, 90};

  /** The renderer draws \a earlier first. */
  std::vector<glm::vec4> picture_of(const scene::Scene &scene, const scene::PlacedCamera &camera,
                                    const std::vector<scene::PlacedCamera> &earlier = {})
  {
    Settings settings;
    settings.shadow.cube_size_px = 256;
    settings.shadow.map_size_px = 512;
    SceneRenderer renderer(*device, scene, size_px, settings);
    renderer.sync();
    for (const scene::PlacedCamera &before : earlier) {
      renderer.draw(before);
    }
    renderer.draw(camera);
    origin_ws = renderer.render_scene().origin_ws();
    return renderer.read_picture();
  }
  static double rms_difference(const std::vector<glm::vec4> &a, const std::vector<glm::vec4> &b)
  {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); i++) {
      const glm::dvec3 difference = glm::dvec3(a[i]) - glm::dvec3(b[i]);
      sum += glm::dot(difference, difference);
    }
    return std::sqrt(sum / (3.0 * double(a.size())));
  }

  /** The origin of the last picture_of. */
  glm::dvec3 origin_ws{0.0};
};

TEST_F(FarAway, APictureIsTheSameWhereTheShiftIsAMultipleOfTheOriginsStep)
{
  for (const char *name : {"plaza", "spots", "forest"}) {
    scene::Scene scene = load(name);
    const std::vector<glm::vec4> near = picture_of(scene, scene.placed_cameras().front());
    move_all(scene, {1048576.0, 0.0, -524288.0});
    const std::vector<glm::vec4> far = picture_of(scene, scene.placed_cameras().front());
    EXPECT_LE(rms_difference(near, far), 1e-3) << name;
  }
}

TEST_F(FarAway, TheErrorAgainstTheReferenceIsTheSameAnywhereAndAfterAChangeOfTheOrigin)
{
  for (const char *name : {"plaza", "spots", "forest"}) {
    const scene::Scene near = load(name);
    const scene::PlacedCamera near_camera = near.placed_cameras().front();
    const std::vector<glm::vec4> truth =
        reference::direct_light(reference::Tracer(near), near_camera, size_px, {.sample_count = 4}).pixels;
    const double error = rms_difference(picture_of(near, near_camera), truth);
    // Relative to multiples of the origin's step of 1024 m: little, less than half, more than half.
    for (const double shift : {1048576.3, 1048576.0 + 400.7, 1048576.0 + 700.1}) {
      SCOPED_TRACE(testing::Message() << name << " at " << shift);
      scene::Scene far = near;
      move_all(far, {shift, 12.9, -524288.0 - 0.5 * shift});
      const scene::PlacedCamera camera = far.placed_cameras().front();
      EXPECT_LE(rms_difference(picture_of(far, camera), truth), 1.02 * error);
      const glm::dvec3 own_origin_ws = origin_ws;
      scene::PlacedCamera away = camera;
      away.world_from_camera[3].x += 1000.0;
      EXPECT_LE(rms_difference(picture_of(far, camera, {camera, away}), truth), 1.02 * error);
      away.world_from_camera[3].x += 2000.0;
      EXPECT_LE(rms_difference(picture_of(far, camera, {away}), truth), 1.02 * error);
      EXPECT_EQ(origin_ws, own_origin_ws) << "it came back";
    }
  }
}

TEST_F(FarAway, AMovingCameraChangesTheOriginAndNotThePicture)
{
  scene::Scene scene;
  const auto mesh = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.5F)));
  for (const double x : {0.0, 1600.0}) {
    test::add_object(scene, mesh, glm::scale(glm::translate(glm::dmat4(1.0), {x, 0, 0}), glm::dvec3(3.0)));
    test::add_object(scene, mesh, glm::scale(glm::translate(glm::dmat4(1.0), {x, 0, 1}), glm::dvec3(0.5)));
    test::add_lamp(scene, scene::LampKind::Point, glm::vec3(x + 1.0, 1, 3), {0, 0, -1}, 30.0F);
  }
  Settings settings;
  settings.shadow.cube_size_px = 256;
  SceneRenderer renderer(*device, scene, {64, 64}, settings);
  renderer.sync();
  const auto picture_at = [&](double x) {
    scene::PlacedCamera camera = test::camera_at({0, 0, 8}, {0, 0, 0});
    camera.world_from_camera[3].x += x;
    renderer.draw(camera);
    return renderer.read_picture();
  };
  const std::vector<glm::vec4> first = picture_at(0.0);
  EXPECT_EQ(renderer.render_scene().origin_ws(), glm::dvec3(0.0));
  const std::vector<glm::vec4> second = picture_at(1600.0);
  EXPECT_EQ(renderer.render_scene().origin_ws(), glm::dvec3(2048.0, 0.0, 0.0));
  // The same objects are at two positions, 1600 m apart. At the second one, floats have a spacing of 0.03 mm, which
  // moves single texels of shadow edges. Measured: 1.3e-4.
  EXPECT_LE(rms_difference(first, second), 1e-3);
  EXPECT_LE(rms_difference(first, picture_at(0.0)), 1e-6) << "and back";
}

}  // namespace
}  // namespace gnomon::eevee
