// SPDX-License-Identifier: MIT
// Debug views compared with known distances.
#include "eevee_debug.hh"
#include "eevee_shaders.hh"
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "shadows/shadows.hh"

#include "eevee_esm_shared.h"
#include "eevee_octahedral_shared.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gnomon::eevee {
namespace {

using test::Picture;
using test::Renderer;

class DebugViewGpuTest : public test::SharedDeviceTest {
 protected:
  /** Facing +Z. */
  void add_square(const glm::vec3 &center, float half)
  {
    test::add_object(scene, square, glm::scale(glm::translate(glm::mat4(1.0F), center), glm::vec3(half, half, 1.0F)));
  }
  Picture read(const gpu::Texture &texture)
  {
    Picture picture{{texture.desc().width, texture.desc().height}, gpu::read_as<glm::vec4>(*device, texture)};
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return picture;
  }
  Picture shadow(Renderer &renderer, std::optional<std::size_t> layer)
  {
    return read(renderer.inspect().shadow_picture(0, layer));
  }
  static bool is_blue(const glm::vec4 &pixel)
  {
    return pixel.a == 0.0F && pixel.b > pixel.r && pixel.b > pixel.g;
  }
  static bool is_red(const glm::vec4 &pixel)
  {
    return pixel.a == 0.0F && pixel.r > pixel.b && pixel.r > pixel.g;
  }

  scene::Scene scene;
  scene::Handle<scene::Mesh> square = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(0.8F)));
};

TEST_F(DebugViewGpuTest, FacesOfACubeHoldDistancesAlongTheirAxes)
{
  add_square({0, 0, 0}, 20.0F);
  add_square({1.2F, 0.6F, 2}, 0.25F);
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 20.0F);
  Settings settings;
  settings.shadow.cube_size_px = 64;
  Renderer renderer(*device, scene, {16, 16}, settings);
  renderer.draw(test::camera_at({3, 3, 3}, {0, 0, 0}));
  const float scale = shared::cube_uv_scale(64.0F);
  /** Direction of a pixel of the face: x right, y down, at distance 1. */
  const auto seen = [&](int x, int y) { return (glm::vec2(float(x), 63.0F - float(y)) + 0.5F) / 32.0F - 1.0F; };

  // Below: the ground is 4 m away, the square 2 m, where x and y, which the face shows mirrored, are 1.2 and 0.6 m.
  const Picture below = shadow(renderer, 5);
  ASSERT_EQ(below.size_px, glm::ivec2(64, 64));
  int squares = 0;
  for (int y = 0; y < 64; y++) {
    for (int x = 0; x < 64; x++) {
      const glm::vec2 p = seen(x, y) / scale * 2.0F - glm::vec2(-1.2F, -0.6F);
      const float from_middle = std::max(std::abs(p.x), std::abs(p.y));
      if (std::abs(from_middle - 0.25F) > 1e-3F) {
        EXPECT_NEAR(below.at(x, y).a, from_middle < 0.25F ? 2.0F : 4.0F, 1e-4F) << x << ", " << y;
        squares += from_middle < 0.25F;
      }
    }
  }
  EXPECT_GT(squares, 30);
  EXPECT_EQ(below.at(32, 32).r, below.at(32, 32).b) << "distances are grey";

  // +X shows -z across: the ground is where the ray has fallen by 4 m.
  const Picture side = shadow(renderer, 0);
  int grounds = 0;
  int empty = 0;
  for (int y = 0; y < 64; y++) {
    for (int x = 0; x < 64; x++) {
      const glm::vec2 p = seen(x, y) / scale;
      const float distance = 4.0F / p.x;
      const bool is_square = std::abs(p.x * 1.2F - 2.0F) < 1.0F;
      if (p.x > 0.0F && distance < 19.0F && std::abs(p.y) * distance < 19.0F && !is_square) {
        EXPECT_NEAR(side.at(x, y).a, distance, 1e-4F * distance) << x << ", " << y;
        grounds++;
      }
      if (p.x < 0.0F) {
        EXPECT_TRUE(is_blue(side.at(x, y))) << x << ", " << y;
        empty++;
      }
    }
  }
  EXPECT_GT(grounds, 100);
  EXPECT_GT(empty, 1000);
}

TEST_F(DebugViewGpuTest, ACubeUnfoldsToACross)
{
  const glm::vec3 lamp(0, 0, 4);
  test::add_lamp(scene, scene::LampKind::Point, lamp, {0, 0, -1}, 20.0F);
  // Across each axis but -Y a square, one metre away, two, three, five and six.
  for (int face = 0; face < 6; face++) {
    glm::vec3 axis(0.0F);
    axis[face / 2] = face % 2 == 0 ? 1.0F : -1.0F;
    if (face != 3) {
      const glm::vec3 up = face / 2 == 1 ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
      const glm::mat4 world_from_square = glm::inverse(glm::lookAt(lamp + float(face + 1) * axis, lamp, up));
      test::add_object(scene, square, glm::scale(world_from_square, glm::vec3(0.3F)));
    }
  }
  Settings settings;
  settings.shadow.cube_size_px = 32;
  Renderer renderer(*device, scene, {16, 16}, settings);
  renderer.draw(test::camera_at({9, 9, 9}, {0, 0, 4}));
  const Picture cross = shadow(renderer, std::nullopt);
  ASSERT_EQ(cross.size_px, glm::ivec2(128, 96));
  const auto middle_of = [&](int column, int row) { return cross.at(32 * column + 16, 32 * row + 16); };
  EXPECT_NEAR(middle_of(1, 2).a, 3.0F, 1e-4F) << "+Y, above";
  EXPECT_NEAR(middle_of(0, 1).a, 2.0F, 1e-4F) << "-X";
  EXPECT_NEAR(middle_of(1, 1).a, 5.0F, 1e-4F) << "+Z";
  EXPECT_NEAR(middle_of(2, 1).a, 1.0F, 1e-4F) << "+X";
  EXPECT_NEAR(middle_of(3, 1).a, 6.0F, 1e-4F) << "-Z";
  EXPECT_TRUE(is_red(middle_of(1, 0))) << "-Y has no caster and was not drawn";
  const std::vector<std::string> names = renderer.inspect().shadow_layers(0);
  const auto nearest_of = [&](const std::string &name) {
    const Picture face = shadow(renderer, find_layer(names, name));
    return face.at(face.size_px.x / 2, face.size_px.y / 2).a;
  };
  EXPECT_NEAR(nearest_of("+X"), 1.0F, 1e-4F);
  EXPECT_NEAR(nearest_of("-X"), 2.0F, 1e-4F);
  EXPECT_NEAR(nearest_of("+Y"), 3.0F, 1e-4F);
  EXPECT_NEAR(nearest_of("+Z"), 5.0F, 1e-4F);
  EXPECT_NEAR(nearest_of("-Z"), 6.0F, 1e-4F);
  for (const auto &[column, row] : {std::pair{0, 0}, {0, 2}, {2, 0}, {3, 0}, {2, 2}, {3, 2}}) {
    EXPECT_EQ(middle_of(column, row), glm::vec4(0.0F)) << column << ", " << row;
  }
}

TEST_F(DebugViewGpuTest, CascadesHoldDistancesAlongTheLightFromOnePlane)
{
  add_square({0, 0, 0}, 100.0F);
  add_square({0, 0, 2}, 1.0F);
  add_square({0, 15, 2}, 1.0F);
  add_square({0, 60, 2}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 4}, {0, 0, -1}, 20.0F);
  Settings settings;
  settings.shadow.map_size_px = 128;
  settings.shadow.cascades.count = 3;
  Renderer renderer(*device, scene, {64, 64}, settings);
  renderer.draw(test::camera_at({0, -6, 3}, {0, 10, 0}));
  const std::vector<std::string> names = {"cascade 0 of 3", "cascade 1 of 3", "cascade 2 of 3"};
  ASSERT_EQ(renderer.inspect().shadow_layers(0), names);
  const std::size_t count = names.size();
  const Picture all = shadow(renderer, std::nullopt);
  ASSERT_EQ(all.size_px, glm::ivec2(3 * 128, 128));
  std::vector<float> nearest;
  for (std::size_t i = 0; i < count; i++) {
    const Picture one = shadow(renderer, i);
    float low = 1e30F;
    float high = 0.0F;
    for (int y = 0; y < 128; y++) {
      for (int x = 0; x < 128; x++) {
        EXPECT_EQ(one.at(x, y), all.at(128 * int(i) + x, y));
        low = one.at(x, y).a > 0.0F ? std::min(low, one.at(x, y).a) : low;
        high = std::max(high, one.at(x, y).a);
      }
    }
    EXPECT_NEAR(high - low, 2.0F, 1e-4F) << "from the squares to the ground, cascade " << i;
    nearest.push_back(low);
  }
  EXPECT_NEAR(nearest[0], nearest[2], 1e-4F);
}

/** The ground has other distances at each corner of a map. Depths of such maps are measured from a plane along it. */
TEST_F(DebugViewGpuTest, DistancesOfAFittedMapAreShownFromBlackToWhite)
{
  add_square({0, 0, 0}, 100.0F);
  add_square({0, 0, 2}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 4}, {0.6F, 0.8F, -1}, 20.0F);
  Settings settings;
  settings.shadow.map_size_px = 128;
  settings.shadow.is_fitted_to_depth = true;
  settings.shadow.cascades.count = 2;
  Renderer renderer(*device, scene, {64, 64}, settings);
  renderer.draw(test::camera_at({0, -6, 3}, {0, 10, 0}));
  const Picture last = shadow(renderer, renderer.inspect().shadow_layers(0).size() - 1);
  const auto count = [&](auto &&is_counted) { return std::ranges::count_if(last.pixels, is_counted); };
  const auto shown = count([](const glm::vec4 &pixel) { return pixel.a > 0.0F; });
  const auto white = count([](const glm::vec4 &pixel) { return pixel.a > 0.0F && pixel.r > 0.999F; });
  EXPECT_GT(shown, 1000);
  EXPECT_LT(double(white), 0.02 * double(shown));
}

TEST_F(DebugViewGpuTest, StoredDistancesAreShownTexelByTexel)
{
  // Two layers of 6 texels and a border of one, of which the second is looked at.
  constexpr int edge = 8;
  const gpu::Texture texture = device->create_texture({.name = "distances",
                                                       .kind = gpu::TextureKind::Array,
                                                       .format = gpu::Format::R32F,
                                                       .width = edge,
                                                       .height = edge,
                                                       .layers = 2});
  ShaderCache shaders;
  ShadowPicture shadow_picture;
  ShadowLayers layers;
  layers.count = 1;
  layers.texture = &texture;
  layers.first_layer = 1;
  layers.size_px = 6;
  layers.border = 1;
  layers.drawn = 1;
  layers.near_far = {{0.0F, 100.0F}};
  layers.shown = {0.0F, 100.0F};
  for (const int format : {ESM_FLOAT, ESM_HALF}) {
    layers.esm_format = format;
    std::vector<float> stored;
    for (int i = 0; i < edge * edge; i++) {
      stored.push_back(shared::esm_encoded(i == 27 ? 100.0F : float(i), 100.0F, format));
    }
    device->upload(texture, 1, std::as_bytes(std::span(stored)));
    const Picture picture = read(shadow_picture.draw(*device, shaders, layers, std::nullopt));
    ASSERT_EQ(picture.size_px, glm::ivec2(6, 6));
    const float tolerance = shared::esm_format_error(100.0F, format) + 1e-4F;
    for (int y = 0; y < 6; y++) {
      for (int x = 0; x < 6; x++) {
        const int i = edge * (y + 1) + x + 1;
        if (i == 27) {
          EXPECT_TRUE(is_blue(picture.at(x, y))) << "as far as what was cleared";
          continue;
        }
        EXPECT_NEAR(picture.at(x, y).a, float(i), tolerance);
        EXPECT_NEAR(picture.at(x, y).r, 0.1F + 0.9F * std::sqrt(float(i) / 100.0F), 1e-3F);
      }
    }
  }
}

TEST_F(DebugViewGpuTest, AnOctahedralLayerHoldsDistancesFromTheLamp)
{
  add_square({0, 0, 0}, 20.0F);
  test::add_lamp(scene, scene::LampKind::Point, {0, 0, 4}, {0, 0, -1}, 20.0F);
  Settings settings;
  settings.shadow.kind = scene::ShadowKind::Esm;
  settings.shadow.esm.size_px = 128;
  settings.shadow.esm.filter_angle = 0.0F;
  Renderer renderer(*device, scene, {16, 16}, settings);
  renderer.draw(test::camera_at({3, 3, 3}, {0, 0, 0}));
  EXPECT_EQ(renderer.inspect().shadow_layers(0), std::vector<std::string>{"octahedral"});
  const Picture picture = shadow(renderer, 0);
  ASSERT_EQ(picture.size_px, glm::ivec2(128, 128));
  int grounds = 0;
  for (int y = 0; y < 128; y++) {
    for (int x = 0; x < 128; x++) {
      const glm::vec3 direction = shared::octahedral_to_direction((glm::vec2(x, y) + 0.5F) / 128.0F);
      if (direction.z < -0.5F) {
        // Half a texel of a cube face of 64 texels, 1/64, times the slope: at most sqrt(3).
        EXPECT_NEAR(picture.at(x, y).a * -direction.z, 4.0F, 4.0F * 0.03F) << x << ", " << y;
        grounds++;
      }
      if (direction.z > 0.0F) {
        EXPECT_TRUE(is_blue(picture.at(x, y))) << x << ", " << y;
      }
    }
  }
  EXPECT_GT(grounds, 1000);
}

class CascadeTintGpuTest : public DebugViewGpuTest {
 protected:
  /** Factors by which the tint multiplies the picture, pixel by pixel. */
  Picture tints(const scene::PlacedCamera &camera, int cascades)
  {
    // Lights everything, so that the tint is visible in the shadow, too.
    test::add_lamp(scene, scene::LampKind::Hemi, {}, {0, 0, -1}, 1.0F);
    Settings settings;
    settings.shadow.map_size_px = 128;
    settings.shadow.cascades.count = cascades;
    const Picture plain = Renderer(*device, scene, {edge_px, edge_px}, settings).picture(camera);
    settings.has_cascade_tint = true;
    Picture tinted = Renderer(*device, scene, {edge_px, edge_px}, settings).picture(camera);
    EXPECT_EQ(tinted.non_finite_count(), 0U);
    for (std::size_t i = 0; i < tinted.pixels.size(); i++) {
      tinted.pixels[i] /= glm::max(plain.pixels[i], glm::vec4(1e-6F));
    }
    return tinted;
  }
  static void expect_near(const glm::vec3 &tint, const glm::vec3 &wanted)
  {
    EXPECT_LT(glm::length(tint - wanted), 1e-3F) << tint.r << " " << tint.g << " " << tint.b;
  }
  static constexpr int edge_px = 512;
  static constexpr glm::vec3 first{1.0F, 0.4F, 0.4F};
  static constexpr glm::vec3 second{0.4F, 1.0F, 0.4F};
};

TEST_F(CascadeTintGpuTest, PixelsOutsideAllCascadesAreUnchanged)
{
  add_square({0, 0, 0}, 20.0F);
  add_square({0, 0, 2}, 1.0F);
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 4}, {0, 0, -1}, 1.0F);
  // 7.6 m of ground; the map is about 2.3 m wide.
  const Picture picture = tints(test::camera_at({0, 0, 1.9F}, {0, 0, 0}, 2.2F), 1);
  expect_near(picture.middle(), first);
  expect_near(picture.at(16, edge_px / 2), glm::vec3(1.0F));
  expect_near(picture.at(edge_px / 2, edge_px - 16), glm::vec3(1.0F));
}

TEST_F(CascadeTintGpuTest, EachCascadeHasItsColourAndFadesIntoTheNext)
{
  add_square({0, 0, 0}, 200.0F);
  for (const float x : {-10.0F, 10.0F}) {
    add_square({x, -2, 1}, 1.0F);
    add_square({x, 100, 1}, 1.0F);
  }
  test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 4}, {0, 0, -1}, 1.0F);
  const Picture picture = tints(test::camera_at({0, -10, 8}, {0, 10, 0}), 2);
  // Up the middle, away from the camera.
  int first_row = 0;
  int second_row = 0;
  int fading = 0;
  for (int y = 0; y < edge_px; y++) {
    const glm::vec3 tint = picture.at(edge_px / 2, y);
    const bool is_first = glm::length(tint - first) < 1e-3F;
    const bool is_second = glm::length(tint - second) < 1e-3F;
    first_row = is_first ? y : first_row;
    second_row = is_second && second_row == 0 ? y : second_row;
    // Only the two tints, with weights that add up to 1.
    const bool is_between = first_row > 0 && second_row == 0 && !is_first;
    if (is_between) {
      EXPECT_NEAR(tint.r + tint.g, 1.4F, 1e-3F) << y;
      EXPECT_NEAR(tint.b, 0.4F, 1e-3F) << y;
      fading++;
    }
  }
  EXPECT_GT(first_row, 20);
  EXPECT_GT(second_row, first_row);
  // The pixel filter alone would give only two or three mixed pixels.
  EXPECT_GT(fading, 4) << first_row << " to " << second_row;
}

}  // namespace
}  // namespace gnomon::eevee
