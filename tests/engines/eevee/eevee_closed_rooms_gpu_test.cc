// SPDX-License-Identifier: MIT
// Closed rooms with all light outside are black.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

namespace gnomon::eevee {
namespace {

/** How the walls of a room meet. */
enum class Joint {
  /** Six quads that share their edges. */
  Shared,
  /** The same, each longer by the spacing of floats at its edges. */
  Ulp,
  /** The same, each longer by a hundredth of the room's width. */
  Overlap,
  /** Each wall passes through the others, by a tenth of the width. */
  Tee,
  /** Boxes as thick as a twentieth of the width, with the inner faces of their neighbours as ends. */
  Boxes,
  Count,
};

enum class Outside { World, Sun, Point, Spot, Area, Count };

/** A room with light outside, drawn by the number. */
struct Room {
  explicit Room(unsigned number) : random(number), joint(Joint(number % unsigned(Joint::Count)))
  {
    outside = Outside(number / unsigned(Joint::Count) % unsigned(Outside::Count));
    const double scale = std::array{1.0, 1e-3, 1e3}[number / 3 % 3];
    const bool is_turned = number % 2 == 1;
    const bool is_far = number % 7 == 3;
    // In one sample, a world has no occlusion, and penumbrae are approximate.
    const bool is_sampled = outside == Outside::World || outside == Outside::Area || number % 4 == 0;
    const int sample_count = is_sampled ? 16 : 1;
    settings = offline_settings(sample_count);
    settings.shadow.caster_faces = joint == Joint::Boxes ? CasterFaces(number / 5 % 3) : CasterFaces::All;
    is_double_sided = number % 2 == 0 || joint != Joint::Boxes;

    half = scale * glm::dvec3(uniform(1.0, 3.0), uniform(1.0, 1.5), uniform(1.0, 3.0));
    glm::dmat4 turn(1.0);
    if (is_turned) {
      turn = glm::rotate(turn, uniform(0.0, 6.0), direction());
    }
    const glm::dvec3 center = is_far ? 3e4 * scale * direction() : glm::dvec3(0.0);
    world_from_room = glm::translate(glm::dmat4(1.0), center) * turn;
    add_walls();
    add_light();

    const glm::dvec3 eye = 0.6 * half * glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    // Towards a corner, where three joints meet.
    const glm::dvec3 corner = half * glm::sign(glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)));
    camera.name = "camera";
    camera.world_from_camera = world_from_room * glm::inverse(glm::lookAt(eye, corner, glm::dvec3(0.1, 1.0, 0.2)));
    camera.vertical_angle = 1.2F;
    camera.near = float(0.01 * scale);
  }

  double uniform(double low, double high)
  {
    return std::uniform_real_distribution<double>(low, high)(random);
  }
  glm::dvec3 direction()
  {
    const double z = uniform(-1.0, 1.0);
    const double angle = uniform(0.0, 2.0 * std::numbers::pi);
    const double across = std::sqrt(1.0 - z * z);
    return {across * std::cos(angle), across * std::sin(angle), z};
  }
  void add_quad(scene::Mesh &mesh, const std::array<glm::dvec3, 4> &corners, const glm::dvec3 &normal) const
  {
    const auto first = std::uint32_t(mesh.positions.size());
    for (const glm::dvec3 &corner : corners) {
      mesh.positions.emplace_back(corner);
      mesh.normals.emplace_back(normal);
    }
    for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) {
      mesh.indices.push_back(first + i);
    }
  }
  /** The side of the box from \a min to \a max at the \a side of \a axis, which faces \a facing along the axis. */
  void add_side(scene::Mesh &mesh, const glm::dvec3 &min, const glm::dvec3 &max, int axis, double side,
                double facing) const
  {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    std::array<glm::dvec3, 4> corners;
    for (std::size_t i = 0; i < 4; i++) {
      const bool is_right = i == 1 || i == 2;
      const bool is_up = i >= 2;
      corners[i][axis] = side > 0.0 ? max[axis] : min[axis];
      corners[i][u] = is_right ? max[u] : min[u];
      corners[i][v] = is_up ? max[v] : min[v];
    }
    if (facing < 0.0) {
      std::swap(corners[1], corners[3]);
    }
    glm::dvec3 normal(0.0);
    normal[axis] = facing;
    add_quad(mesh, corners, normal);
  }
  void add_walls()
  {
    scene::Material material;
    material.metallic = 0.0F;
    material.roughness = 1.0F;
    material.is_double_sided = is_double_sided;
    const auto handle = scene.add(std::move(material));
    const double width = 2.0 * std::max({half.x, half.y, half.z});
    for (int axis = 0; axis < 3; axis++) {
      for (const double side : {-1.0, 1.0}) {
        scene::Mesh mesh;
        mesh.name = "wall";
        mesh.material = handle;
        if (joint == Joint::Boxes) {
          glm::dvec3 min = -half - 0.05 * width;
          glm::dvec3 max = half + 0.05 * width;
          (side > 0.0 ? min : max)[axis] = side * half[axis];
          for (int before = 0; before < axis; before++) {
            min[before] = -half[before];
            max[before] = half[before];
          }
          for (int face = 0; face < 3; face++) {
            add_side(mesh, min, max, face, -1.0, -1.0);
            add_side(mesh, min, max, face, 1.0, 1.0);
          }
        }
        else {
          const double longer = joint == Joint::Overlap ? 0.01 * width : joint == Joint::Tee ? 0.1 * width : 0.0;
          glm::dvec3 out = half + longer;
          if (joint == Joint::Ulp) {
            out = glm::dvec3(std::nextafter(float(half.x), 1e30F), std::nextafter(float(half.y), 1e30F),
                             std::nextafter(float(half.z), 1e30F));
          }
          out[axis] = half[axis];
          add_side(mesh, -out, out, axis, side, -side);
        }
        test::add_object(scene, scene.add(std::move(mesh)), world_from_room);
      }
    }
  }
  void add_light()
  {
    if (outside == Outside::World) {
      scene.set_world(scene::World{});
      return;
    }
    scene::Lamp lamp;
    lamp.name = "lamp";
    const glm::dvec3 toward = direction();
    const double distance = glm::length(half) * uniform(1.5, 4.0);
    const double distance_sq = distance * distance;
    // A white surface at the middle of the room that faces the lamp would have a radiance of about 1.
    lamp.intensity = float(std::numbers::pi * distance_sq);
    switch (outside) {
      case Outside::Sun:
        lamp.kind = scene::LampKind::Sun;
        lamp.intensity = float(std::numbers::pi);
        lamp.angle = settings.sample_count > 1 ? 0.1F : 0.0F;
        break;
      case Outside::Point:
        lamp.kind = scene::LampKind::Point;
        lamp.radius = settings.sample_count > 1 ? float(0.1 * distance) : 0.0F;
        break;
      case Outside::Spot:
        lamp.kind = scene::LampKind::Spot;
        lamp.spot_outer_angle = 0.9F;
        break;
      default:
        lamp.kind = scene::LampKind::Area;
        lamp.intensity *= 4.0F;
        lamp.area_size_x = lamp.area_size_y = float(0.3 * distance);
        break;
    }
    const glm::dvec3 up = std::abs(toward.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    test::add_lamp(scene, lamp, world_from_room * glm::inverse(glm::lookAt(distance * toward, glm::dvec3(0.0), up)));
  }

  std::mt19937 random;
  Joint joint;
  Outside outside = Outside::World;
  bool is_double_sided = true;
  /** Half the room's inner size, metres. */
  glm::dvec3 half{1.0};
  glm::dmat4 world_from_room{1.0};
  Settings settings;
  scene::Scene scene;
  scene::PlacedCamera camera;
};

class ClosedRoomsGpuTest : public test::GpuDeviceTest {};

TEST_F(ClosedRoomsGpuTest, AreBlackExceptForSinglePixels)
{
  int shining = 0;
  for (unsigned number = 0; number < 100; number++) {
    Room room(number);
    test::Renderer renderer(*device, room.scene, {48, 32}, room.settings);
    const test::Picture picture = renderer.picture(room.camera);
    float brightest = 0.0F;
    int count = 0;
    for (const glm::vec4 &pixel : picture.pixels) {
      brightest = std::max({brightest, pixel.r, pixel.g, pixel.b});
      count += std::max({pixel.r, pixel.g, pixel.b}) > 1e-4F ? 1 : 0;
    }
    shining += count > 0 ? 1 : 0;
    // Where a floor is narrower than a texel in the map of one of the samples, no texel tells of it.
    EXPECT_LE(count, 12) << "room " << number << ", joint " << int(room.joint) << ", light " << int(room.outside);
    EXPECT_LE(brightest, 0.03F) << "room " << number << ", joint " << int(room.joint) << ", light "
                                << int(room.outside);
  }
  EXPECT_LE(shining, 8);
}

}  // namespace
}  // namespace gnomon::eevee
