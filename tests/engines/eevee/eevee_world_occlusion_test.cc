// SPDX-License-Identifier: MIT
// The parts of a world's light that arrive at probes, against closed forms.
#include "internal/eevee_world_occlusion.hh"
#include "eevee_sobol.hh"
#include "eevee_test_scene.hh"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace gnomon::eevee {
namespace {

/** Boxes in a world of radiance 1. */
class WorldOcclusionTest : public testing::Test {
 protected:
  WorldOcclusionTest()
  {
    scene.set_world(scene::World{});
  }
  scene::Handle<scene::Node> add_box(const glm::dvec3 &min, const glm::dvec3 &max)
  {
    return test::add_object(scene, box, placed(min, max));
  }
  /** Transform of the box of add_box_mesh, which is from -1 to 1. */
  static glm::dmat4 placed(const glm::dvec3 &min, const glm::dvec3 &max)
  {
    return glm::scale(glm::translate(glm::dmat4(1.0), 0.5 * (min + max)), 0.5 * (max - min));
  }
  /** A room of 4 m with walls of 0.2 m and an open top. */
  void add_room()
  {
    add_box({-2.2, -2.2, -0.2}, {2.2, 2.2, 0.0});
    add_box({-2.2, -2.2, 0.0}, {-2.0, 2.2, 4.0});
    add_box({2.0, -2.2, 0.0}, {2.2, 2.2, 4.0});
    add_box({-2.0, -2.2, 0.0}, {2.0, -2.0, 4.0});
    add_box({-2.0, 2.0, 0.0}, {2.0, 2.2, 4.0});
  }
  /** The probes around all casters: the view sees none. */
  shared::WorldBlock traced(WorldOcclusion &occlusion)
  {
    return traced(occlusion, draw::View(glm::translate(glm::mat4(1.0F), glm::vec3(0, 0, 1000)), perspective));
  }
  shared::WorldBlock traced(WorldOcclusion &occlusion, const draw::View &view)
  {
    rendered.update();
    occlusion.update(rendered, false);
    shared::WorldBlock block{};
    occlusion.write(view, block);
    return block;
  }
  static void expect_same(const shared::WorldBlock &block, const shared::WorldBlock &expected)
  {
    EXPECT_EQ(block.probe_count, expected.probe_count);
    EXPECT_EQ(block.probe_scale, expected.probe_scale);
    EXPECT_EQ(block.probe_offset, expected.probe_offset);
    for (int i = 0; i < 2 * WORLD_PROBE_MAX; i++) {
      EXPECT_EQ(block.probes[i], expected.probes[i]) << i;
    }
  }
  /** Calls \a visit with the position of each probe, and the parts that arrive there along the axes and against them.
   */
  template <typename Visit>
  static void for_each_probe(const shared::WorldBlock &block, Visit &&visit)
  {
    const glm::ivec3 count(block.probe_count);
    for (int i = 0; i < count.x * count.y * count.z; i++) {
      const glm::vec3 place(i % count.x, i / count.x % count.y, i / (count.x * count.y));
      const glm::vec3 position = (place - glm::vec3(block.probe_offset)) / glm::vec3(block.probe_scale);
      const glm::vec3 positive(block.probes[2 * i]);
      const glm::vec3 negative(block.probes[2 * i + 1]);
      visit(position, positive * positive, negative * negative);
    }
  }

  glm::mat4 perspective = draw::perspective(1, 1, 0.1F, 10);
  scene::Scene scene;
  scene::Handle<scene::Mesh> box = test::add_box_mesh(scene, test::add_material(scene, glm::vec3(1.0F)));
  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  render_scene::RenderScene rendered{*device, scene};
};

/** Form factor of the rectangle from 0 to \a a and 0 to \a b at the height \a c, for a horizontal element below its
 * corner. */
double corner_form_factor(double a, double b, double c)
{
  const double x = a / c;
  const double y = b / c;
  const double p = std::sqrt(1.0 + x * x);
  const double q = std::sqrt(1.0 + y * y);
  return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2.0 * std::numbers::pi);
}

TEST_F(WorldOcclusionTest, InAnOpenRoomIsTheFormFactorOfTheOpening)
{
  add_room();
  WorldOcclusion occlusion;
  int count = 0;
  double difference = 0.0;
  for_each_probe(traced(occlusion), [&](const glm::vec3 &p, const glm::vec3 &positive, const glm::vec3 &negative) {
    if (std::max(std::abs(p.x), std::abs(p.y)) < 1.9F && p.z > 0.0F) {
      double expected = 0.0;
      for (const double x : {2.0 - double(p.x), 2.0 + double(p.x)}) {
        for (const double y : {2.0 - double(p.y), 2.0 + double(p.y)}) {
          expected += corner_form_factor(x, y, 4.0 - double(p.z));
        }
      }
      // A probe has 128 rays upwards. The largest error seen is 0.071.
      EXPECT_NEAR(double(positive.z), expected, 0.08) << p.x << ' ' << p.y << ' ' << p.z;
      EXPECT_EQ(negative.z, 0.0F);
      difference += double(positive.z) - expected;
      count++;
    }
  });
  EXPECT_GT(count, 100);
  EXPECT_NEAR(difference / count, 0.0, 0.01);
}

/** Light from directions at 1024 places of a Sobol sequence, as a picture of 256 samples draws them. */
struct Arriving {
  /** Irradiance / (4 π) from all of them. */
  double whole = 0.0;
  /** Irradiance / π on the middle of the floor of add_room(), and the part of the directions that arrive there. */
  double floor = 0.0;
  double part = 0.0;
};
Arriving arriving(const render_scene::WorldDistribution &directions)
{
  constexpr int count = 1024;
  Arriving sum;
  for (int i = 0; i < count; i++) {
    const render_scene::WorldDirection chosen = directions.at(glm::dvec2(sobol_point(std::uint32_t(i), 1)));
    const glm::dvec3 &v = chosen.to_world;
    sum.whole += chosen.irradiance.g / (4.0 * std::numbers::pi) / count;
    if (v.z > 0.0 && 4.0 * std::max(std::abs(v.x), std::abs(v.y)) < 2.0 * v.z) {
      sum.floor += v.z * chosen.irradiance.g / std::numbers::pi / count;
      sum.part += 1.0 / count;
    }
  }
  return sum;
}

TEST_F(WorldOcclusionTest, MoreDirectionsPassThroughAnOpeningAndBringTheSameLight)
{
  add_room();
  rendered.update();
  WorldOcclusion occlusion;
  occlusion.update(rendered, true);
  const Arriving even = arriving(rendered.world()->rest_directions);
  const Arriving chosen = arriving(*occlusion.directions().distribution);
  const double expected = 4.0 * corner_form_factor(2.0, 2.0, 4.0);
  // About 80 of them arrive: the error seen is 0.034.
  EXPECT_NEAR(even.floor, expected, 0.05 * expected);
  EXPECT_NEAR(chosen.floor, expected, 0.01 * expected);
  EXPECT_NEAR(chosen.whole, 1.0, 0.01);
  EXPECT_GT(chosen.part, 2.0 * even.part);
}

TEST_F(WorldOcclusionTest, AClosedRoomHasNone)
{
  add_room();
  add_box({-2.2, -2.2, 4.0}, {2.2, 2.2, 4.2});
  WorldOcclusion occlusion;
  int count = 0;
  for_each_probe(traced(occlusion), [&](const glm::vec3 &p, const glm::vec3 &positive, const glm::vec3 &negative) {
    if (std::max(std::abs(p.x), std::abs(p.y)) < 2.0F && p.z > 0.0F && p.z < 4.0F) {
      EXPECT_EQ(positive, glm::vec3(0.0F));
      EXPECT_EQ(negative, glm::vec3(0.0F));
      count++;
    }
  });
  EXPECT_GT(count, 100);
}

TEST_F(WorldOcclusionTest, InMirroredWallsIsThatInTheSameWalls)
{
  add_room();
  WorldOcclusion plain;
  const shared::WorldBlock expected = traced(plain);
  for (const scene::Object &object : scene.objects()) {
    scene.edit(object.node, [](scene::Node &node) {
      node.parent_from_node = node.parent_from_node * glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1));
    });
  }
  WorldOcclusion mirrored;
  const shared::WorldBlock block = traced(mirrored);
  ASSERT_EQ(mirrored.probe_count(), plain.probe_count());
  for (int i = 0; i < 2 * plain.probe_count(); i++) {
    EXPECT_EQ(block.probes[i], expected.probes[i]) << i;
  }
}

TEST_F(WorldOcclusionTest, OfEditsIsThatOfANewScene)
{
  add_room();
  const auto small = add_box({0.0, 0.0, 1.0}, {0.5, 0.5, 1.5});
  WorldOcclusion edited;
  static_cast<void>(traced(edited));
  const std::uint64_t all = edited.rays_traced();
  const auto expect_as_new = [&](double most_rays) {
    const std::uint64_t before = edited.rays_traced();
    const shared::WorldBlock block = traced(edited);
    EXPECT_LE(double(edited.rays_traced() - before), most_rays * double(all));
    WorldOcclusion made;
    const shared::WorldBlock expected = traced(made);
    for (int i = 0; i < 2 * made.probe_count(); i++) {
      EXPECT_EQ(block.probes[i], expected.probes[i]) << i;
    }
    EXPECT_EQ(block.whole_positive, expected.whole_positive);
    EXPECT_EQ(block.whole_negative, expected.whole_negative);
  };
  scene.set_transform(small, placed({-1.0, -0.5, 2.0}, {-0.5, 0.0, 2.5}));
  expect_as_new(0.1);
  scene.set_world(scene::World{.color = {0.5F, 1.0F, 2.0F}});
  expect_as_new(0.0);
  scene.edit(small, [](scene::Node &node) { node.casts_shadow = false; });
  expect_as_new(0.1);
  scene.edit(small, [](scene::Node &node) { node.casts_shadow = true; });
  expect_as_new(0.1);
  // More changes than bounds are looked at one by one, and with them those of the scene.
  for (int i = 0; i < 20; i++) {
    add_box({0.1 * i, 1.0, 1.0 + 0.1 * i}, {0.1 * i + 0.05, 1.1, 1.05 + 0.1 * i});
  }
  expect_as_new(1.0);
  scene.remove(small);
  expect_as_new(0.1);
  // The larger scene has 1.5 times as many probes, at other places.
  add_box({0.0, 0.0, 4.0}, {1.0, 1.0, 6.0});
  expect_as_new(2.0);
}

TEST_F(WorldOcclusionTest, OfViewsInTurnIsThatOfANewOne)
{
  add_room();
  const auto small = add_box({-0.5, 0.5, 1.0}, {0.5, 1.0, 1.5});
  const auto room_material = scene.meshes()[box].material;
  const glm::vec3 eye(0.5F, -1.5F, 1.5F);
  const draw::View first(glm::lookAt(eye, glm::vec3(0, 1, 1), glm::vec3(0, 0, 1)), perspective);
  const draw::View second(glm::lookAt(eye, glm::vec3(2, 0, 0), glm::vec3(0, 0, 1)), perspective);
  WorldOcclusion kept;
  const auto expect_as_new = [&](const char *after) {
    SCOPED_TRACE(after);
    for (const draw::View &view : {first, second, first}) {
      WorldOcclusion made;
      expect_same(traced(kept, view), traced(made, view));
    }
  };
  expect_as_new("nothing");
  EXPECT_NE(traced(kept, first).probe_offset, traced(kept, second).probe_offset);
  scene.set_transform(small, placed({-1.0, 0.0, 2.0}, {0.0, 0.5, 2.5}));
  expect_as_new("a move");
  scene.edit(small, [](scene::Node &node) { node.is_visible = false; });
  expect_as_new("hiding a box");
  scene.edit(small, [](scene::Node &node) { node.is_visible = true; });
  // The camera is within the box, of which it then sees no side.
  scene.set_transform(small, placed({-0.5, -1.7, 1.0}, {0.7, 1.5, 1.9}));
  expect_as_new("a move around the camera");
  for (const bool is_double_sided : {false, true}) {
    scene.edit(room_material, [&](scene::Material &value) { value.is_double_sided = is_double_sided; });
    rendered.update();
    // A view that did not change is written again for this reason alone.
    EXPECT_TRUE(kept.update(rendered, false));
    expect_as_new("sides of a material");
  }
}

TEST_F(WorldOcclusionTest, BelowAMaskIsWhatTheMaskLeaves)
{
  const auto texture = test::add_texture(scene, 2, {255, 255, 255, 255, 0, 0, 0, 100, 0, 0, 0, 0, 0, 0, 0, 0});
  const auto material = test::add_material(scene, glm::vec3(1.0F));
  const auto set_cutoff = [&](float cutoff) {
    scene.edit(material, [&](scene::Material &value) {
      value.base_color_texture.texture = texture;
      value.alpha_mode = scene::AlphaMode::Mask;
      value.alpha_cutoff = cutoff;
    });
  };
  set_cutoff(0.5F);
  test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1.0), glm::dvec3(50.0)));
  WorldOcclusion occlusion;
  const auto mean_below = [&] {
    double sum = 0.0;
    int count = 0;
    for_each_probe(traced(occlusion), [&](const glm::vec3 &p, const glm::vec3 &positive, const glm::vec3 &negative) {
      if (std::max(std::abs(p.x), std::abs(p.y)) < 30.0F && p.z < 0.0F) {
        EXPECT_EQ(negative.z, 1.0F);
        sum += double(positive.z);
        count++;
      }
    });
    EXPECT_GT(count, 40);
    return sum / count;
  };
  // 49 probes or more with 128 rays each, weighted by cosines, have a deviation of 0.007. The largest error seen is
  // 0.0204.
  EXPECT_NEAR(mean_below(), 0.75, 0.025);
  set_cutoff(0.3F);
  EXPECT_NEAR(mean_below(), 0.5, 0.025);
  // No texel is drawn.
  scene.edit(material, [](scene::Material &value) { value.alpha = 0.2F; });
  EXPECT_EQ(traced(occlusion).probe_count.x, 0.0F);
}

TEST_F(WorldOcclusionTest, BelowAMaskIsWhatTheAlphaOfVerticesLeaves)
{
  const auto texture = test::add_texture(scene, 2, {255, 255, 255, 255, 0, 0, 0, 100, 0, 0, 0, 0, 0, 0, 0, 0});
  const auto material = test::add_material(scene, glm::vec3(1.0F));
  scene.edit(material, [&](scene::Material &value) {
    value.base_color_texture.texture = texture;
    value.alpha_mode = scene::AlphaMode::Mask;
    value.alpha_cutoff = 0.3F;
  });
  const auto square = test::add_square_mesh(scene, material);
  test::add_object(scene, square, glm::scale(glm::dmat4(1.0), glm::dvec3(50.0)));
  const auto set_alphas = [&](float left, float right) {
    scene.edit(square, [&](scene::Mesh &mesh) {
      mesh.colors.clear();
      for (const glm::vec3 &position : mesh.positions) {
        mesh.colors.emplace_back(1.0F, 1.0F, 1.0F, position.x < 0.0F ? left : right);
      }
    });
  };
  WorldOcclusion occlusion;
  const auto mean_below = [&](float x_min, float x_max) {
    double sum = 0.0;
    int count = 0;
    for_each_probe(traced(occlusion), [&](const glm::vec3 &p, const glm::vec3 &positive, const glm::vec3 &) {
      if (p.x > x_min && p.x < x_max && std::abs(p.y) < 30.0F && p.z < 0.0F) {
        sum += double(positive.z);
        count++;
      }
    });
    EXPECT_GT(count, 0);
    return sum / count;
  };
  // Half of the texels, a quarter and none are covered. Bounds as above.
  set_alphas(1.0F, 1.0F);
  EXPECT_NEAR(mean_below(-30, 30), 0.5, 0.025);
  set_alphas(0.6F, 0.6F);
  EXPECT_NEAR(mean_below(-30, 30), 0.75, 0.025);
  set_alphas(0.2F, 0.2F);
  EXPECT_EQ(mean_below(-30, 30), 1.0);
  // From 0.2 to 1 along x: no texel, a quarter from 0.3 on, at x = -37.5, and half from 0.765 on, at 20.6.
  set_alphas(0.2F, 1.0F);
  EXPECT_NEAR(mean_below(-30, 0), 0.75, 0.025);
  EXPECT_NEAR(mean_below(20, 30), 0.5, 0.025);
  // Without a texture, the right half is covered. Probes are 4.7 m below: one that is 10 m from the edge between the
  // halves sees (1 - 10 / √(10² + 4.7²)) / 2 of the other, which is 0.047.
  scene.edit(material, [](scene::Material &value) {
    value.base_color_texture = {};
    value.alpha_cutoff = 0.5F;
  });
  set_alphas(0.0F, 1.0F);
  EXPECT_GT(mean_below(-40, -10), 0.95);
  EXPECT_LT(mean_below(10, 40), 0.05);
  set_alphas(1.0F, 0.0F);
  EXPECT_LT(mean_below(-40, -10), 0.05);
  EXPECT_GT(mean_below(10, 40), 0.95);
}

TEST_F(WorldOcclusionTest, NeedsCasters)
{
  const auto node = add_box({-1, -1, -1}, {1, 1, 1});
  WorldOcclusion occlusion;
  EXPECT_GT(traced(occlusion).probe_count.x, 0.0F);
  scene.edit(node, [](scene::Node &value) { value.casts_shadow = false; });
  EXPECT_EQ(traced(occlusion).probe_count.x, 0.0F);
}

}  // namespace
}  // namespace gnomon::eevee
