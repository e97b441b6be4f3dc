// SPDX-License-Identifier: MIT
// A world's light against closed forms and the reference, on the driver.
#include "eevee_closed_forms.hh"
#include "eevee_test_scene.hh"
#include "eevee_world.hh"
#include "gpu_device_fixture.hh"
#include "reference_light.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gnomon::eevee {
namespace {

/** A square in the plane z = 0 that fills the view, and a world. */
class WorldGpuTest : public test::SharedDeviceTest {
 protected:
  WorldGpuTest()
  {
    material = test::add_material(scene, {0.25F, 0.5F, 1.0F});
    test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1.0), glm::dvec3(4.0)));
  }
  glm::vec3 middle(int sample_count)
  {
    test::Renderer renderer(*device, scene, {8, 8}, {.shadow = {.map_size_px = 256}, .sample_count = sample_count});
    const test::Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return glm::vec3(picture.middle());
  }
  glm::vec3 reference_middle(int sample_count = 4096)
  {
    const reference::Tracer tracer(scene);
    const std::vector<glm::ivec2> pixels = {{4, 4}};
    return glm::vec3(reference::direct_light(tracer, camera, {8, 8}, pixels, {.sample_count = sample_count}).front());
  }
  /** A picture of \a radiance in the half of all directions where \a axis is above 0, and \a other elsewhere. */
  void add_half_world(int axis, const glm::vec3 &radiance, const glm::vec3 &other)
  {
    scene::WorldPicture picture{128, 64, {}};
    for (int y = 0; y < picture.height; y++) {
      for (int x = 0; x < picture.width; x++) {
        const glm::dvec3 v = render_scene::direction_of((x + 0.5) / picture.width, 1.0 - (y + 0.5) / picture.height);
        picture.texels.push_back(v[axis] > 0.0 ? radiance : other);
      }
    }
    scene.set_world(scene::World{.picture = std::make_shared<const scene::WorldPicture>(std::move(picture))});
  }

  scene::Scene scene;
  scene::Handle<scene::Material> material;
  scene::PlacedCamera camera = test::camera_at({0.1, 0.1, 16}, {0.1, 0.1, 0}, 0.02F);
};

void expect_relative(const glm::vec3 &value, const glm::vec3 &expected, float relative)
{
  for (int i = 0; i < 3; i++) {
    EXPECT_NEAR(value[i], expected[i], relative * expected[i]) << "channel " << i;
  }
}

TEST_F(WorldGpuTest, OfOneRadianceGivesAPlaneItsAlbedoTimesThat)
{
  scene.set_world(scene::World{.color = {2.0F, 1.0F, 0.5F}, .strength = 1.5F});
  const glm::vec3 expected(0.75F, 0.75F, 0.75F);
  expect_relative(middle(1), expected, 1e-3F);
  // 64 directions, half of them below the plane.
  expect_relative(middle(16), expected, 0.03F);
  expect_relative(reference_middle(), expected, 2e-3F);
}

TEST_F(WorldGpuTest, WhiteFurnaceOfAMetal)
{
  scene.set_world(scene::World{});
  for (const float roughness : {0.1F, 0.4F, 1.0F}) {
    scene.edit(material, [&](scene::Material &value) {
      value.base_color = glm::vec3(1.0F);
      value.metallic = 1.0F;
      value.roughness = roughness;
    });
    // A single scattering keeps 0.99 of the light on smooth surfaces and 0.307 at a roughness of 1.
    const glm::vec3 expected = reference_middle(2048);
    EXPECT_GT(expected.r, roughness < 0.2F ? 0.99F : 0.3F);
    EXPECT_LT(expected.r, 1.005F);
    expect_relative(middle(1), expected, 0.01F);
    expect_relative(middle(32), expected, 0.05F);
  }
}

/** Under layers that reflect all light, a white surface sends out no more light than it receives. */
TEST_F(WorldGpuTest, WhiteFurnaceOfLayers)
{
  scene.set_world(scene::World{});
  for (const float angle : {0.0F, 1.0F, 1.4F}) {
    camera = test::camera_at(glm::dvec3(0.1, 0.1, 0) + 16.0 * glm::dvec3(std::sin(angle), 0.0, std::cos(angle)),
                             {0.1, 0.1, 0}, 0.01F);
    for (const float roughness : {0.1F, 0.6F}) {
      for (const bool has_sheen : {false, true}) {
        scene.edit(material, [&](scene::Material &value) {
          value.base_color = glm::vec3(1.0F);
          value.coat = has_sheen ? 0.0F : 1.0F;
          value.coat_roughness = roughness;
          value.sheen_color = glm::vec3(has_sheen ? 1.0F : 0.0F);
          value.sheen_roughness = roughness;
        });
        const float one_frame = middle(1).r;
        EXPECT_LT(one_frame, 1.002F) << angle << ' ' << roughness << ' ' << has_sheen;
        // Rough coats lose what would be scattered again among their microfacets.
        EXPECT_GT(one_frame, roughness < 0.5F ? 0.9F : 0.8F) << angle << ' ' << roughness << ' ' << has_sheen;
        // Few sampled directions are in a lobe that is seen at a grazing angle.
        if (angle == 1.0F) {
          EXPECT_NEAR(middle(64).r, one_frame, 0.06F) << roughness << ' ' << has_sheen;
        }
      }
    }
  }
}

TEST_F(WorldGpuTest, LightFromOneSideIsWhereThePictureHasIt)
{
  // The plane sees the half space of +Z, of which a half shines that has +X: all of it, and none when the plane is
  // turned.
  add_half_world(2, glm::vec3(1.0F), glm::vec3(0.0F));
  expect_relative(middle(1), {0.25F, 0.5F, 1.0F}, 0.03F);
  expect_relative(reference_middle(), {0.25F, 0.5F, 1.0F}, 0.01F);
  add_half_world(0, glm::vec3(1.0F), glm::vec3(0.0F));
  expect_relative(middle(1), {0.125F, 0.25F, 0.5F}, 0.02F);
  expect_relative(middle(16), {0.125F, 0.25F, 0.5F}, 0.05F);
  expect_relative(reference_middle(), {0.125F, 0.25F, 0.5F}, 0.01F);
  scene.set_world([&] {
    scene::World turned = *scene.world();
    // +X comes to -Z: below the plane.
    turned.rotation = float(0.5 * std::numbers::pi);
    return turned;
  }());
  EXPECT_LT(middle(1).b, 0.03F);
  EXPECT_LT(middle(16).b, 0.02F);
  EXPECT_LT(reference_middle().b, 0.01F);
}

TEST_F(WorldGpuTest, OcclusionConvergesToTheReference)
{
  // A wall across the plane hides half of the sky, less what is above it.
  test::add_object(
      scene, test::add_square_mesh(scene, material),
      glm::dmat4(glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 0, 1, 0), glm::dvec4(1, 0, 0, 0), glm::dvec4(0.6, 0, 1, 1)));
  add_half_world(1, {1.0F, 0.8F, 0.6F}, {0.3F, 0.3F, 0.6F});
  const glm::vec3 expected = reference_middle();
  EXPECT_LT(expected.b, 0.55F);
  expect_relative(middle(64), expected, 0.04F);
}

/** Each pixel of the floor of a room with a window in its ceiling has the form factor of the window. */
TEST_F(WorldGpuTest, LightThroughAWindowConvergesToItsFormFactor)
{
  scene.set_world(scene::World{});
  const auto box = test::add_box_mesh(scene, material);
  const auto add = [&](const glm::dvec3 &min, const glm::dvec3 &max) {
    test::add_object(scene, box, glm::scale(glm::translate(glm::dmat4(1.0), 0.5 * (min + max)), 0.5 * (max - min)));
  };
  // Walls around a floor of 4 m, and a thin ceiling with a hole of 1 m.
  add({-2.2, -2.2, -0.2}, {-2.0, 2.2, 3.0});
  add({2.0, -2.2, -0.2}, {2.2, 2.2, 3.0});
  add({-2.0, -2.2, -0.2}, {2.0, -2.0, 3.0});
  add({-2.0, 2.0, -0.2}, {2.0, 2.2, 3.0});
  add({-2.2, -2.2, 3.0}, {-0.5, 2.2, 3.01});
  add({0.5, -2.2, 3.0}, {2.2, 2.2, 3.01});
  add({-0.5, -2.2, 3.0}, {0.5, -0.5, 3.01});
  add({-0.5, 0.5, 3.0}, {0.5, 2.2, 3.01});
  constexpr int size = 32;
  constexpr double half = 1.5;
  constexpr double eye = 2.9;
  camera = test::camera_at({0, 0, eye}, {0, 0, 0}, float(2.0 * std::atan(half / eye)));
  const std::vector<glm::dvec3> window = test::rectangle_corners({0, 0, 3}, {0.5, 0, 0}, {0, 0.5, 0});
  struct Errors {
    double mean = 0.0;
    double rmse = 0.0;
  };
  const auto errors_of = [&](int sample_count) {
    test::Renderer renderer(*device, scene, {size, size},
                            {.shadow = {.map_size_px = 2048}, .sample_count = sample_count});
    const test::Picture picture = renderer.picture(camera);
    Errors errors;
    double sum = 0.0;
    for (int y = 0; y < size; y++) {
      for (int x = 0; x < size; x++) {
        // The room looks the same from all sides.
        const glm::dvec3 place(half * (2.0 * x + 1.0 - size) / size, half * (2.0 * y + 1.0 - size) / size, 0.0);
        const double expected = test::lambert_irradiance(window, place) / std::numbers::pi;
        const double error = double(picture.pixels[std::size_t(y * size + x)].b) - expected;
        sum += expected;
        errors.mean += error;
        errors.rmse += error * error;
      }
    }
    errors.mean /= sum;
    errors.rmse = std::sqrt(errors.rmse * size * size) / sum;
    return errors;
  };
  const Errors few = errors_of(16);
  const Errors many = errors_of(128);
  EXPECT_NEAR(few.mean, 0.0, 0.1);
  EXPECT_NEAR(many.mean, 0.0, 0.01);
  // Seen: 1.02 and 0.17.
  EXPECT_LT(few.rmse, 1.1);
  EXPECT_LT(many.rmse, 0.2);
}

TEST_F(WorldGpuTest, AMirrorKeepsAWorldOfOneRadianceFromEverySide)
{
  scene.set_world(scene::World{});
  scene.edit(material, [](scene::Material &value) {
    value.base_color = glm::vec3(1.0F);
    value.metallic = 1.0F;
    value.roughness = 0.1F;
  });
  for (const double angle : {0.0, 0.4, 0.8, 1.1, 1.3, 1.4}) {
    camera = test::camera_at(glm::dvec3(0.1, 0.1, 0) + 16.0 * glm::dvec3(std::sin(angle), 0.0, std::cos(angle)),
                             {0.1, 0.1, 0}, 0.001F);
    for (const int sample_count : {16, 64}) {
      EXPECT_NEAR(middle(sample_count).g, 1.0F, 0.07F) << angle << ' ' << sample_count;
    }
  }
}

/** The mirrored edges of a wall become sharper with the number of samples. */
TEST_F(WorldGpuTest, AWallInAMirrorConvergesToThatOfTheReference)
{
  scene.set_world(scene::World{});
  scene.edit(material, [](scene::Material &value) {
    value.base_color = glm::vec3(1.0F);
    value.metallic = 1.0F;
    value.roughness = 0.05F;
  });
  test::add_object(scene, test::add_box_mesh(scene, material),
                   glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(-3, 0, 1)), glm::dvec3(0.2, 1.2, 1.0)));
  constexpr int size = 24;
  camera = test::camera_at({4, 0, 4}, {-1, 0, 0}, 0.7F);
  std::vector<glm::ivec2> pixels;
  for (int y = 0; y < size; y++) {
    for (int x = 0; x < size; x++) {
      pixels.emplace_back(x, y);
    }
  }
  const reference::Tracer tracer(scene);
  const auto expected = reference::direct_light(tracer, camera, {size, size}, pixels, {.sample_count = 64});
  const auto error_of = [&](int sample_count) {
    test::Renderer renderer(*device, scene, {size, size},
                            {.shadow = {.map_size_px = 512}, .sample_count = sample_count});
    const test::Picture picture = renderer.picture(camera);
    double sum = 0.0;
    for (std::size_t i = 0; i < pixels.size(); i++) {
      const double error = double(picture.pixels[i].g) - double(glm::vec3(expected[i]).g);
      sum += error * error;
    }
    return std::sqrt(sum / double(pixels.size()));
  };
  EXPECT_LT(error_of(16), 0.3);
  EXPECT_LT(error_of(64), 0.2);
  EXPECT_LT(error_of(256), 0.15);
}

/** A mirrored sun that is wider than the lobe of the metal is a disk of about the sun's radiance, or is hidden. */
TEST_F(WorldGpuTest, ASunInASmoothMetalIsThatOfTheReference)
{
  scene.edit(material, [&](scene::Material &value) {
    value.base_color = glm::vec3(1.0F);
    value.metallic = 1.0F;
    value.roughness = 0.15F;
  });
  const glm::dvec3 to_sun = glm::normalize(glm::dvec3(-1, 0, 1));
  const double half_angle = 0.15;
  scene::WorldPicture picture{256, 128, {}};
  for (int y = 0; y < picture.height; y++) {
    for (int x = 0; x < picture.width; x++) {
      const glm::dvec3 v = render_scene::direction_of((x + 0.5) / picture.width, 1.0 - (y + 0.5) / picture.height);
      picture.texels.emplace_back(glm::dot(v, to_sun) > std::cos(half_angle) ? 50.0F : 0.01F);
    }
  }
  scene.set_world(scene::World{.picture = std::make_shared<const scene::WorldPicture>(std::move(picture))});
  float brightest = 0.0F;
  // The middle of the sun, a place between it and the rim, and one beside the sun. Widened lobes blur all of them.
  for (const double turn : {0.0, 0.5 * half_angle, half_angle + 0.05}) {
    const double angle = 0.25 * std::numbers::pi + turn;
    camera = test::camera_at(glm::dvec3(0.1, 0.1, 0) + 16.0 * glm::dvec3(std::sin(angle), 0.0, std::cos(angle)),
                             {0.1, 0.1, 0}, 0.001F);
    const glm::vec3 expected = reference_middle(1 << 14);
    brightest = std::max(brightest, expected.g);
    for (const int sample_count : {4, 16}) {
      // The widened lobe of 4 samples takes 0.13 of the brightest between the middle and the rim, that of 16 less than
      // 0.04.
      const float tolerance = sample_count == 4 ? 0.15F : 0.04F;
      EXPECT_NEAR(middle(sample_count).g, expected.g, tolerance * brightest) << turn << ' ' << sample_count;
    }
  }
  // Above the reflected ray, wide enough for all of the sun.
  camera = test::camera_at(glm::dvec3(0.1, 0.1, 0) + 16.0 * glm::dvec3(std::sqrt(0.5), 0.0, std::sqrt(0.5)),
                           {0.1, 0.1, 0}, 0.001F);
  test::add_object(scene, test::add_square_mesh(scene, material),
                   glm::translate(glm::dmat4(1.0), glm::dvec3(-2.9, 0.1, 3)));
  EXPECT_LT(middle(4).g, 0.05F);
}

TEST_F(WorldGpuTest, OneFrameOfAClosedRoomIsBlack)
{
  test::remove_objects(scene);
  scene.set_world(scene::World{});
  const auto box = test::add_box_mesh(scene, material);
  const auto add = [&](const glm::dvec3 &center, const glm::dvec3 &half) {
    return test::add_object(scene, box, glm::scale(glm::translate(glm::dmat4(1.0), center), half));
  };
  add({0, 0, -0.1}, {2.2, 2.2, 0.1});
  add({-2.1, 0, 2}, {0.1, 2.2, 2});
  add({2.1, 0, 2}, {0.1, 2.2, 2});
  add({0, -2.1, 2}, {2, 0.1, 2});
  add({0, 2.1, 2}, {2, 0.1, 2});
  const auto top = add({0, 0, 4.1}, {2.2, 2.2, 0.1});
  camera = test::camera_at({0.3, 0.2, 3.5}, {0.1, 0.1, 0}, 1.0F);
  test::Renderer renderer(*device, scene, {32, 32}, {.shadow = {.map_size_px = 256}, .sample_count = 1});
  const auto brightest = [&] {
    renderer.sync();
    float largest = 0.0F;
    for (const glm::vec4 &pixel : renderer.picture(camera).pixels) {
      largest = std::max(largest, pixel.b);
    }
    return largest;
  };
  // The shader has a weight of 1e-12 for all light, and squares.
  EXPECT_LT(brightest(), 1e-9F);
  const glm::dmat4 closed = scene.nodes()[top].parent_from_node;
  scene.set_transform(top, glm::translate(glm::dmat4(1.0), glm::dvec3(20, 0, 0)) * closed);
  EXPECT_GT(brightest(), 0.1F);
  scene.set_transform(top, closed);
  EXPECT_LT(brightest(), 1e-9F);
}

/** Probes around the view are at all sides of the sphere. */
TEST_F(WorldGpuTest, OneFrameOfASphereAboveAGroundHasNoEdges)
{
  scene.set_world(scene::World{});
  const auto ground = test::add_material(scene, {0.5F, 0.5F, 0.0F});
  material = test::add_material(scene, glm::vec3(1.0F));
  struct Case {
    glm::dvec4 sphere;
    glm::vec3 eye;
    double ground_size;
  };
  for (const Case &one : {Case{{1.62, 1.59, 2.88, 0.62}, {-8.5, 8.53, -2.67}, 60.0},
                          Case{{3.48, 0.86, 3.57, 0.71}, {10.43, 6.43, 0.06}, 20.0}}) {
    test::remove_objects(scene);
    const glm::dmat4 turned = glm::rotate(glm::dmat4(1.0), -0.5 * std::numbers::pi, glm::dvec3(1, 0, 0));
    test::add_object(scene, test::add_square_mesh(scene, ground), glm::scale(turned, glm::dvec3(one.ground_size)));
    const glm::dmat4 moved = glm::translate(glm::dmat4(1.0), glm::dvec3(one.sphere));
    test::add_object(scene, test::add_sphere_mesh(scene, material), glm::scale(moved, glm::dvec3(one.sphere.w)));
    constexpr glm::ivec2 size(160, 90);
    test::Renderer renderer(*device, scene, size, {.shadow = {.map_size_px = 256}, .sample_count = 1});
    const test::Picture picture = renderer.picture(test::camera_at(one.eye, {0, 0.5, 0}, 0.5F));
    const auto blue = [&](int x, int y) {
      const glm::vec4 pixel = picture.pixels[std::size_t(y * size.x + x)];
      return pixel.b > 0.9F * pixel.r ? pixel.b : -1.0F;
    };
    int count = 0;
    float largest = 0.0F;
    for (int y = 1; y < size.y - 1; y++) {
      for (int x = 1; x < size.x - 1; x++) {
        const std::array around = {blue(x, y), blue(x - 1, y), blue(x + 1, y), blue(x, y - 1), blue(x, y + 1)};
        const auto [low, high] = std::ranges::minmax(around);
        if (low >= 0.0F) {
          count++;
          largest = std::max({largest, high - around[0], around[0] - low});
        }
      }
    }
    EXPECT_GT(count, 50);
    // 0.18 was seen, and 0.4 with a box that did not grow to the side that a surface faces.
    EXPECT_LT(largest, 0.25F);
  }
}

/** A convex body alone keeps its light. Objects without shadows change no bit. */
TEST_F(WorldGpuTest, OneFrameWithoutOcclusionIsThatWithoutShadows)
{
  test::remove_objects(scene);
  scene.set_world(scene::World{.color = {1.0F, 0.8F, 0.6F}});
  scene.edit(material, [](scene::Material &value) { value.roughness = 0.4F; });
  const auto box = test::add_box_mesh(scene, material);
  test::add_object(scene, box, glm::rotate(glm::dmat4(1.0), 0.6, glm::normalize(glm::dvec3(1, 2, 3))));
  camera = test::camera_at({4, 3, 5}, {0, 0, 0}, 0.5F);
  const auto drawn = [&](scene::ShadowKind kind) {
    test::Renderer renderer(*device, scene, {32, 32}, {.shadow = {.kind = kind}, .sample_count = 1});
    return renderer.picture(camera).pixels;
  };
  const std::vector<glm::vec4> expected = drawn(scene::ShadowKind::None);
  const std::vector<glm::vec4> alone = drawn(scene::ShadowKind::Hard);
  for (std::size_t i = 0; i < alone.size(); i++) {
    // The body blocks light from probes at which no point looks, and they have the mean of others: 2e-4 was seen.
    test::expect_near(glm::vec3(alone[i]), glm::vec3(expected[i]), 3e-4F);
  }
  test::add_object(scene, box, glm::translate(glm::dmat4(1.0), {1, 2, 1}));
  const std::vector<glm::vec4> without = drawn(scene::ShadowKind::None);
  EXPECT_NE(drawn(scene::ShadowKind::Hard), without);
  const auto edit_all = [&](const auto &change) {
    for (const scene::Object &object : scene.objects()) {
      scene.edit(object.node, change);
    }
  };
  edit_all([](scene::Node &value) { value.receives_shadow = false; });
  EXPECT_EQ(drawn(scene::ShadowKind::Hard), without);
  edit_all([](scene::Node &value) { value.receives_shadow = true; });
  edit_all([](scene::Node &value) { value.casts_shadow = false; });
  EXPECT_EQ(drawn(scene::ShadowKind::Hard), without);
}

TEST_F(WorldGpuTest, BlackIsNoWorldAndCompilesNothingOfIt)
{
  test::add_lamp(scene, scene::LampKind::Sun, {}, {0, 0, -1}, 1.0F);
  scene.set_world(scene::World{.strength = 0.0F});
  test::Renderer renderer(*device, scene, {8, 8}, {.sample_count = 2});
  static_cast<void>(renderer.picture(camera));
  for (const std::string &name : device->live_resources()) {
    EXPECT_EQ(name.find("world"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace gnomon::eevee
