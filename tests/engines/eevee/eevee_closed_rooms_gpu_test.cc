// SPDX-License-Identifier: MIT
// Closed rooms with all light outside are black.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "scene_joints.hh"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
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

enum class Outside {
  World,
  /** Cascades. */
  Sun,
  /** The faces of a cube. */
  Point,
  /** One map. */
  Spot,
  Area,
  Count,
};

constexpr unsigned room_pairs = unsigned(Joint::Count) * unsigned(Outside::Count);

/** A random room with light outside. Each joint meets each light in any `room_pairs` successive numbers. */
struct Room {
  explicit Room(unsigned number) : random(number), joint(Joint(number % unsigned(Joint::Count)))
  {
    const unsigned row = number / unsigned(Joint::Count);
    outside = Outside(row % unsigned(Outside::Count));
    const double scale = std::array{1.0, 1e-3, 1e3}[(number + row) % 3];
    const bool is_turned = (number + row) % 2 == 1;
    const bool is_far = (number + 2 * row) % 4 == 3;
    // Sides of closed boxes.
    caster_faces = joint == Joint::Boxes ? CasterFaces(row % 3) : CasterFaces::All;
    is_double_sided = row % 2 == 0;

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
        size = {.angle = 0.1F};
        break;
      case Outside::Point:
        lamp.kind = scene::LampKind::Point;
        size = {.radius = float(0.1 * distance)};
        break;
      case Outside::Spot:
        lamp.kind = scene::LampKind::Spot;
        lamp.spot_outer_angle = 0.9F;
        size = {.radius = float(0.05 * distance)};
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

  /** A ground that is much larger than the room, below it. */
  void add_ground()
  {
    scene::Mesh mesh;
    mesh.name = "ground";
    const glm::dvec3 far = 100.0 * half;
    add_side(mesh, {-far.x, -1.3 * half.y, -far.z}, {far.x, -1.3 * half.y, far.z}, 1, 1.0, 1.0);
    test::add_object(scene, scene.add(std::move(mesh)), world_from_room);
  }

  /** Whether one sample has exact shadows. A world has none then, and penumbrae are approximate. */
  [[nodiscard]] bool has_hard_shadows() const
  {
    return outside != Outside::World && outside != Outside::Area;
  }
  /** Gives the lamp, which has none at first, its size. */
  void set_size()
  {
    if (has_hard_shadows()) {
      scene.edit(test::handle_at(scene.lamps(), 0), [&](scene::Lamp &lamp) {
        lamp.angle = size.angle;
        lamp.radius = size.radius;
      });
    }
  }

  struct Size {
    float angle = 0.0F;
    float radius = 0.0F;
  };

  std::mt19937 random;
  Joint joint;
  Outside outside = Outside::World;
  CasterFaces caster_faces = CasterFaces::All;
  bool is_double_sided = true;
  /** Half the room's inner size, metres. */
  glm::dvec3 half{1.0};
  glm::dmat4 world_from_room{1.0};
  Size size;
  scene::Scene scene;
  scene::PlacedCamera camera;
};

/** Light in closed rooms, in parts of 1. */
struct Leaks {
  int pictures = 0;
  /** Pictures with pixels above 1e-4 of the light outside, and these pixels. */
  int shining = 0;
  int pixels = 0;
  /** Sum of these pixels. */
  double light = 0.0;
  std::string rooms;
};

constexpr glm::ivec2 picture_size_px(48, 32);

class ClosedRoomsGpuTest : public test::SharedDeviceTest {
 protected:
  /** Draws the rooms from \a first to \a end - 1. \a layer_px: size of maps and faces; 0: as `gnomon render`. */
  Leaks leaks_of(unsigned first, unsigned end, int layer_px) const
  {
    Leaks leaks;
    for (unsigned number = first; number < end; number++) {
      Room room(number);
      if (room.has_hard_shadows()) {
        add(leaks, room, 1, layer_px);
      }
      room.set_size();
      // From 16 samples on, layers are fitted to the depths in the picture.
      add(leaks, room, number % 2 == 0 ? 16 : 4, layer_px);
    }
    return leaks;
  }
  /** Draws the first \a count rooms with one sample, in the light of lamps with a size. */
  Leaks leaks_of_sizes(unsigned count) const
  {
    Leaks leaks;
    for (unsigned number = 0; number < count; number++) {
      Room room(number);
      if (room.outside != Outside::World) {
        room.set_size();
        add(leaks, room, 1, 0);
      }
    }
    return leaks;
  }
  /** Draws the first \a count rooms in a world with one sample, every second one above a large ground. */
  Leaks leaks_of_one_sample(unsigned count) const
  {
    Leaks leaks;
    for (unsigned i = 0; i < count; i++) {
      const unsigned joint = i % unsigned(Joint::Count);
      Room room(i / unsigned(Joint::Count) * room_pairs + joint);
      if (i % 2 == 1) {
        room.add_ground();
      }
      add(leaks, room, 1, 0);
    }
    return leaks;
  }

 private:
  void add(Leaks &leaks, Room &room, int sample_count, int layer_px) const
  {
    Settings settings = offline_settings(sample_count);
    settings.shadow.caster_faces = room.caster_faces;
    if (layer_px > 0) {
      settings.shadow.cube_size_px = settings.shadow.map_size_px = layer_px;
      settings.shadow.cascades.can_resize = false;
    }
    test::Renderer renderer(*device, room.scene, picture_size_px, settings);
    int count = 0;
    float largest = 0.0F;
    for (const glm::vec4 &pixel : renderer.picture(room.camera).pixels) {
      const float value = std::max({pixel.r, pixel.g, pixel.b});
      ASSERT_TRUE(std::isfinite(value));
      largest = std::max(largest, value);
      if (value > 1e-4F) {
        count++;
        leaks.light += double(value);
      }
    }
    leaks.pictures++;
    leaks.pixels += count;
    if (count > 0) {
      leaks.shining++;
      leaks.rooms += fmt::format("joint {}, light {}, {} samples: {} pixels up to {}\n", int(room.joint),
                                 int(room.outside), sample_count, count, largest);
    }
  }
};

/**
 * Joints between texels that hold no part of the joint, such as those at corners of three walls, still let light
 * through. Without the continuation of casters (decision 0035), 29 of the 40 pictures shine, and 7 % of the pixels.
 */
void expect_dark(const Leaks &leaks, double shining_part_max, double pixels_part_max, double light_mean_max = 2e-4)
{
  EXPECT_LE(leaks.shining, shining_part_max * leaks.pictures) << leaks.rooms;
  const double pixels = double(leaks.pictures) * picture_size_px.x * picture_size_px.y;
  EXPECT_LE(leaks.pixels, pixels_part_max * pixels) << leaks.rooms;
  EXPECT_LE(leaks.light, light_mean_max * pixels) << leaks.rooms;
}

TEST_F(ClosedRoomsGpuTest, AreBlackExceptForFewPixels)
{
  // The error of shadows grows with the size of texels.
  // Measured: 0.2, 1.8e-3. Where edges are moved to a grid of 1/16 texels (SwiftShader): 0.35, 3.1e-3.
  const bool is_coarse = device->limits().subpixel_bits < 8;
  expect_dark(leaks_of(0, room_pairs, 512), is_coarse ? 0.4 : 0.25, is_coarse ? 3.5e-3 : 2.5e-3);
}

class SlowClosedRoomsGpuTest : public ClosedRoomsGpuTest {};

TEST_F(SlowClosedRoomsGpuTest, AreBlackExceptForFewPixels)
{
  // Measured: 0.1, 2.2e-3.
  expect_dark(leaks_of(1000, 1000 + 4 * room_pairs, 0), 0.15, 3e-3);
}

/** The probes of the occlusion are those that surfaces in the picture see, wherever the room is and however it is
 * turned. */
TEST_F(ClosedRoomsGpuTest, OneSampleInAWorldIsBlack)
{
  const Leaks leaks = leaks_of_one_sample(10);
  EXPECT_EQ(leaks.pictures, 10);
  EXPECT_EQ(leaks.shining, 0) << leaks.rooms;
}

/** A lit texel beside the shadow of one wall shows the place where that wall meets the receiver. */
TEST_F(ClosedRoomsGpuTest, ACornerOfThreeWallsUnderASunIsBlack)
{
  Room room(0);
  room.scene = {};
  room.half = {2.2, 1.35, 2.2};
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(1, 2, 3));
  room.world_from_room = glm::translate(turn, glm::dvec3(0, 1.35, 0));
  room.add_walls();
  scene::Lamp sun;
  sun.kind = scene::LampKind::Sun;
  sun.intensity = float(std::numbers::pi);
  test::add_lamp(room.scene, sun, glm::dmat4(glm::mat3_cast(glm::dquat(0.812, 0.5, 0.3, 0))));
  room.camera.world_from_camera = glm::translate(turn, glm::dvec3(-1.32, 1.485, 1.32)) *
                                  glm::mat4_cast(glm::dquat(0.913215, -0.139968, -0.378266, -0.0579765));
  room.camera.near = 0.01F;
  test::Renderer renderer(*device, room.scene, {640, 360}, offline_settings(1));
  float largest = 0.0F;
  for (const glm::vec4 &pixel : renderer.picture(room.camera).pixels) {
    largest = std::max(largest, pixel.r);
  }
  EXPECT_LE(largest, 1e-4F);
}

/** The floor's edges lie within the lower edges of walls, and the ceiling's within the upper ones. */
TEST_F(ClosedRoomsGpuTest, NoSampleSeesThroughTJoints)
{
  Room room(3);
  room.scene.set_world(std::nullopt);
  test::remove_objects(room.scene);
  for (int axis = 0; axis < 3; axis++) {
    for (const double side : {-1.0, 1.0}) {
      scene::Mesh mesh;
      mesh.name = "wall";
      glm::dvec3 out = room.half;
      out[(axis + 1) % 3] *= axis == 1 ? 1.0 : 1.1;
      out[(axis + 2) % 3] *= axis == 1 ? 1.0 : 1.1;
      out.y = room.half.y;
      room.add_side(mesh, -out, out, axis, side, -side);
      test::add_object(room.scene, room.scene.add(std::move(mesh)), room.world_from_room);
    }
  }
  const auto seen_through = [&] {
    test::Renderer renderer(*device, room.scene, {320, 180}, offline_settings(64));
    const auto picture = renderer.picture(room.camera);
    return std::ranges::count_if(picture.pixels, [](const glm::vec4 &pixel) { return pixel.a < 0.999F; });
  };
  EXPECT_GT(seen_through(), 0) << "the room has no cracks, so that nothing is tested";
  scene::close_joints(room.scene);
  EXPECT_EQ(seen_through(), 0);
}

/** Where layers do not show a receiver, it is not taken for the inside of a closed room. */
TEST_F(ClosedRoomsGpuTest, SurfaceThatLayersDoNotShowHasTheSameEdges)
{
  const auto picture = [&](const std::function<void(scene::Node &)> &edit_node,
                           const std::function<void(scene::Material &)> &edit_material,
                           CasterFaces faces = CasterFaces::All) {
    scene::Scene scene;
    const auto material = test::add_material(scene, glm::vec3(0.5F));
    const auto ground_material = test::add_material(scene, glm::vec3(0.5F));
    scene.edit(ground_material, edit_material);
    const auto ground = test::add_object(scene, test::add_square_mesh(scene, ground_material),
                                         glm::scale(glm::dmat4(1.0), glm::dvec3(10)));
    scene.edit(ground, edit_node);
    test::add_object(scene, test::add_box_mesh(scene, material), glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 3)));
    test::add_lamp(scene, scene::LampKind::Point, {1, 2, 7}, {0, 0, -1}, 40.0F);
    Settings settings = offline_settings(1);
    settings.shadow.cube_size_px = 64;
    settings.shadow.caster_faces = faces;
    test::Renderer renderer(*device, scene, {64, 48}, settings);
    return renderer.picture(test::camera_at({0, -12, 9}, {0, 0, 0}, 0.9F)).pixels;
  };
  const auto mean = [](const std::vector<glm::vec4> &pixels) {
    double sum = 0.0;
    for (const glm::vec4 &pixel : pixels) {
      sum += double(pixel.g);
    }
    return sum / double(pixels.size());
  };
  const auto keep = [](auto &) {};
  const std::vector<glm::vec4> cast = picture(keep, keep);
  // One ground is lit deferred, the other one forward.
  const std::vector<glm::vec4> uncast = picture([](scene::Node &node) { node.casts_shadow = false; }, keep);
  for (std::size_t i = 0; i < cast.size(); i++) {
    for (int channel = 0; channel < 4; channel++) {
      ASSERT_NEAR(uncast[i][channel], cast[i][channel], 1e-5F) << "pixel " << i;
    }
  }
  // The ground has a single side, which faces the lamp. The box has both.
  EXPECT_NEAR(mean(picture(
                  keep, [](scene::Material &one) { one.is_double_sided = false; }, CasterFaces::Back)),
              mean(cast), 1e-4 * mean(cast));
  const auto blended = [](scene::Material &one) {
    one.alpha_mode = scene::AlphaMode::Blend;
    one.alpha = 0.2F;
  };
  const double light = mean(picture(keep, blended));
  EXPECT_NEAR(light, mean(picture([](scene::Node &node) { node.casts_shadow = false; }, blended)), 1e-3 * light);
}

/** Where a wall hides a part of the lamp from its own front, lookups for that part are outside of the room. */
TEST_F(ClosedRoomsGpuTest, LampsWithASizeGiveLittleLightInOneSample)
{
  const Leaks leaks = leaks_of_sizes(room_pairs);
  EXPECT_EQ(leaks.pictures, 20);
  // Measured: 0.25, 2.5e-2, 2.5e-4. With lookups for all of the lamp, also below the horizon: 0.6, 6.2e-2.
  expect_dark(leaks, 0.4, 3e-2, 3e-4);
}

/** Penumbrae of one sample look up texels at offsets, some of which are beyond the walls. */
TEST_F(ClosedRoomsGpuTest, APointLampWithASizeOutsideGivesNoLightInOneSample)
{
  scene::Scene scene;
  const auto material = test::add_material(scene, glm::vec3(0.5F));
  scene.edit(material, [](scene::Material &wall) { wall.is_double_sided = true; });
  test::add_object(scene, test::add_box_mesh(scene, material),
                   glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 1.25)), glm::dvec3(3, 3, 1.25)));
  const auto lamp = test::add_lamp(scene, scene::LampKind::Point, {4, 4, 3.5}, {0, 0, -1}, 3000.0F);
  scene.edit(lamp, [](scene::Lamp &one) { one.radius = 0.1F; });
  const auto lit_count = [&](scene::ShadowKind kind) {
    Settings settings = offline_settings(1);
    settings.shadow.kind = kind;
    test::Renderer renderer(*device, scene, {320, 180}, settings);
    const auto picture = renderer.picture(test::camera_at({2.8, -2.8, 1.6}, {0, 0, 1.3}, 1.2F));
    return std::ranges::count_if(picture.pixels, [](const glm::vec4 &pixel) { return pixel.g > 1e-3F; });
  };
  EXPECT_EQ(lit_count(scene::ShadowKind::Hard), 0);
  EXPECT_GT(lit_count(scene::ShadowKind::None), 10000) << "without a shadow, the walls are lit";
}

/** A pane is in some samples of the layers, or in none. Objects without shadows are in none. Only their own lookups
 * differ from those of walls. Unlit surfaces have no lookups. */
TEST_F(ClosedRoomsGpuTest, APaneChangesNoOtherSurface)
{
  const auto picture = [&](const std::function<void(scene::Material &)> &edit_pane) {
    scene::Scene scene;
    const auto material = test::add_material(scene, glm::vec3(0.5F));
    scene.edit(material, [](scene::Material &wall) { wall.is_double_sided = true; });
    test::add_object(scene, test::add_box_mesh(scene, material), glm::scale(glm::dmat4(1.0), glm::dvec3(4)));
    const auto glass = test::add_material(scene, glm::vec3(0.5F));
    if (edit_pane) {
      scene.edit(glass, edit_pane);
      // Behind the camera. It casts no shadow, so that the layers are the same.
      const auto pane = test::add_object(scene, test::add_square_mesh(scene, glass),
                                         glm::translate(glm::dmat4(1.0), glm::dvec3(0, -3.5, 0)));
      scene.edit(pane, [](scene::Node &node) { node.casts_shadow = false; });
    }
    test::add_lamp(scene, scene::LampKind::Point, {1, 2, 7}, {0, 0, -1}, 4000.0F);
    Settings settings = offline_settings(1);
    settings.shadow.cube_size_px = 64;
    test::Renderer renderer(*device, scene, {64, 48}, settings);
    return renderer.picture(test::camera_at({0, -3, 0}, {0, 0, 1}, 1.4F)).pixels;
  };
  const std::vector<glm::vec4> without = picture(nullptr);
  EXPECT_EQ(picture([](scene::Material &pane) {
              pane.alpha_mode = scene::AlphaMode::Blend;
              pane.alpha = 0.5F;
            }),
            without)
      << "blended; bit for bit";
  EXPECT_EQ(picture([](scene::Material &pane) { pane.is_unlit = true; }), without) << "unlit; bit for bit";
  EXPECT_EQ(picture([](scene::Material & /*pane*/) {}), without) << "opaque; bit for bit";
}

}  // namespace
}  // namespace gnomon::eevee
