// SPDX-License-Identifier: MIT
// Light and penumbrae of lamps compared with closed forms, on the driver.
#include "eevee_closed_forms.hh"
#include "eevee_picture_layers.hh"
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include "measure_light.hh"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

namespace gnomon::eevee {
namespace {

using std::numbers::pi;

/** A camera that looks down from \a height_m at the origin, at a square of \a half_m by that times \a aspect. */
scene::PlacedCamera camera_above(double height_m, double half_m, double aspect = 1.0)
{
  scene::PlacedCamera camera = test::camera_at({0.0F, 0.0F, float(height_m)}, {0.0F, 0.0F, 0.0F});
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = float(half_m);
  camera.half_height = float(half_m * aspect);
  camera.near = float(0.1 * height_m);
  camera.far = float(2.0 * height_m);
  return camera;
}

/** The quotient of each pixel with and without shadows, in a picture of one sample. */
std::vector<float> visibilities_of_one_frame(gpu::Device &device, const scene::Scene &scene,
                                             const scene::PlacedCamera &camera, glm::ivec2 size_px)
{
  const test::Picture shadowed = test::Renderer(device, scene, size_px).picture(camera);
  const test::Picture lit =
      test::Renderer(device, scene, size_px, {.shadow = {.kind = scene::ShadowKind::None}}).picture(camera);
  EXPECT_EQ(shadowed.non_finite_count() + lit.non_finite_count(), 0U);
  std::vector<float> visibilities;
  for (std::size_t i = 0; i < lit.pixels.size(); i++) {
    EXPECT_GT(lit.pixels[i].r, 0.0F) << i;
    visibilities.push_back(shadowed.pixels[i].r / lit.pixels[i].r);
  }
  return visibilities;
}

struct PlacedLight {
  std::string name;
  scene::Lamp lamp{};
  glm::dmat4 world_from_lamp{1.0};
  /** On a surface at the origin that faces +z. */
  double irradiance = 0.0;
};

/** \a position, with -z towards \a target and an arbitrary turn around it. */
glm::dmat4 turned_to(const glm::dvec3 &position, const glm::dvec3 &target)
{
  return glm::inverse(glm::lookAt(position, target, glm::dvec3(0.3, 1.0, 0.2)));
}

/**
 * One lamp of each kind, with a size of \a size metres where it has one. Each is completely above the horizon of the
 * origin, and the origin is completely in the cones of sized spots.
 */
std::vector<PlacedLight> lamps_of_each_kind(double size)
{
  const glm::dvec3 at(0.6, -0.3, 1.5);
  const double distance_sq = glm::dot(at, at);
  const double cosine = at.z / std::sqrt(distance_sq);
  const double radius = double(float(size));
  const auto lamp_of = [&](scene::LampKind kind) {
    scene::Lamp lamp;
    lamp.kind = kind;
    lamp.intensity = 2.0F;
    return lamp;
  };
  std::vector<PlacedLight> lights;
  scene::Lamp point = lamp_of(scene::LampKind::Point);
  lights.push_back({"point", point, turned_to(at, {}), 2.0 * cosine / distance_sq});
  point.radius = float(size);
  lights.push_back({"sphere", point, turned_to(at, {}), 2.0 * cosine / (distance_sq + radius * radius)});

  scene::Lamp spot = lamp_of(scene::LampKind::Spot);
  spot.spot_outer_angle = 0.5F;
  spot.spot_blend = 0.6F;
  // The origin is in the soft edge of the cone.
  const glm::dvec3 aside = at + glm::normalize(glm::cross(at, glm::dvec3(0, 1, 0))) * (0.4 * std::sqrt(distance_sq));
  const glm::dmat4 world_from_spot = turned_to(at, aside - at);
  const double cos_axis = glm::dot(glm::dvec3(world_from_spot[2]), at) / std::sqrt(distance_sq);
  const double cos_outer = std::cos(double(0.5F));
  const double t = std::clamp((cos_axis - cos_outer) / ((1.0 - cos_outer) * double(0.6F)), 0.0, 1.0);
  lights.push_back({"spot", spot, world_from_spot, 2.0 * cosine / distance_sq * t * t * (3.0 - 2.0 * t)});
  spot.radius = float(size);
  spot.spot_outer_angle = 1.0F;
  spot.spot_blend = 0.1F;
  lights.push_back({"sized spot", spot, turned_to(at, {}), 2.0 * cosine / (distance_sq + radius * radius)});

  scene::Lamp sun = lamp_of(scene::LampKind::Sun);
  lights.push_back({"sun", sun, turned_to(at, {}), 2.0 * cosine});
  sun.angle = float(size);
  lights.push_back({"sun with an angle", sun, turned_to(at, {}), 2.0 * cosine});
  lights.push_back({"hemi", lamp_of(scene::LampKind::Hemi), turned_to(at, {}), 1.0 + cosine});

  for (const bool is_ellipse : {false, true}) {
    // Square and disk, rectangle and ellipse.
    for (const double aspect : {1.0, 0.5}) {
      for (const glm::dvec3 &target : {glm::dvec3(0.0), glm::dvec3(at.x, at.y, 0.0)}) {
        scene::Lamp area = lamp_of(scene::LampKind::Area);
        area.area_shape = is_ellipse ? scene::AreaShape::Ellipse : scene::AreaShape::Rectangle;
        area.area_size_x = float(2.0 * size);
        area.area_size_y = float(2.0 * aspect * size);
        const glm::dmat4 world_from_lamp = turned_to(at, target);
        const glm::dvec3 axis_x = size * glm::dvec3(world_from_lamp[0]);
        const glm::dvec3 axis_y = aspect * size * glm::dvec3(world_from_lamp[1]);
        const auto corners =
            is_ellipse ? test::ellipse_corners(at, axis_x, axis_y) : test::rectangle_corners(at, axis_x, axis_y);
        // Radiance P / (4 A).
        const double radiance = 2.0 / (4.0 * (is_ellipse ? pi : 4.0) * aspect * size * size);
        lights.push_back({std::string(is_ellipse ? "ellipse" : "rectangle") + (aspect == 1.0 ? " of equal axes" : "") +
                              (target == glm::dvec3(0.0) ? ", facing" : ", level"),
                          area, world_from_lamp, radiance * test::lambert_irradiance(corners, glm::dvec3(0.0))});
      }
    }
  }
  return lights;
}

class LampLightTest : public test::SharedDeviceTest {
 protected:
  LampLightTest()
  {
    test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1.0), glm::dvec3(20.0)));
  }
  /** Compares the light of lamps on the ground with their irradiances. */
  void expect_irradiances(const std::vector<PlacedLight> &lights, int sample_count, double tolerance)
  {
    // Three lamps at a time, one in each channel.
    for (std::size_t first = 0; first < lights.size(); first += 3) {
      test::remove_lamps(scene);
      const std::size_t end = std::min(first + 3, lights.size());
      for (std::size_t i = first; i < end; i++) {
        scene::Lamp lamp = lights[i].lamp;
        lamp.name = lights[i].name;
        lamp.color = glm::vec3(0.0F);
        lamp.color[int(i - first)] = 1.0F;
        test::add_lamp(scene, lamp, lights[i].world_from_lamp);
      }
      test::Renderer renderer(*device, scene, {5, 5},
                              {.shadow = {.kind = scene::ShadowKind::None}, .sample_count = sample_count});
      const test::Picture picture = renderer.picture(camera_above(1.0, 1e-4));
      ASSERT_EQ(picture.non_finite_count(), 0U);
      for (std::size_t i = first; i < end; i++) {
        EXPECT_NEAR(double(picture.middle()[int(i - first)]) * pi / lights[i].irradiance, 1.0, tolerance)
            << lights[i].name;
      }
    }
  }

  scene::Scene scene;
  scene::Handle<scene::Material> material = test::add_material(scene, glm::vec3(1.0F));
};

TEST_F(LampLightTest, OfOneFrameIsTheClosedForm)
{
  for (const double size : {0.05, 0.8}) {
    SCOPED_TRACE(size);
    expect_irradiances(lamps_of_each_kind(size), 1, 1e-3);
  }
}

TEST_F(LampLightTest, OfSamplesConvergesToTheClosedForm)
{
  // A tenth of the distance, at which the bias of points in a ball is 2e-5 (decision 0012).
  expect_irradiances(lamps_of_each_kind(0.1), 1024, 1e-4);
}

TEST_F(LampLightTest, SpecularOfOneFrameIsTheMeasuredApproximation)
{
  const double view_angle = 0.8;
  const glm::dvec3 view(std::sin(view_angle), 0.0, std::cos(view_angle));
  scene::PlacedCamera camera = camera_above(1.0, 1e-4);
  camera.world_from_camera = glm::inverse(glm::lookAt(view, glm::dvec3(0.0), glm::dvec3(0, 1, 0)));
  const glm::dvec3 center(-1.0, 0.4, 1.2);
  const glm::dmat4 world_from_lamp = turned_to(center, {});
  for (const float roughness : {0.3F, 0.7F}) {
    scene.edit(material, [&](scene::Material &value) {
      value.metallic = 1.0F;
      value.roughness = roughness;
    });
    const double alpha = double(roughness) * double(roughness);
    // The small one is small relative to the wider lobe.
    for (const auto &[is_ellipse, size] : {std::pair(false, 1.0), {true, 1.0}, {false, 0.05}, {true, 0.05}}) {
      test::remove_lamps(scene);
      scene::Lamp lamp;
      lamp.kind = scene::LampKind::Area;
      lamp.area_shape = is_ellipse ? scene::AreaShape::Ellipse : scene::AreaShape::Rectangle;
      lamp.area_size_x = float(size);
      lamp.area_size_y = float(0.5 * size);
      // For a radiance of 1.
      lamp.intensity = float((is_ellipse ? 0.5 * pi : 2.0) * size * size);
      test::add_lamp(scene, lamp, world_from_lamp);
      test::Renderer renderer(*device, scene, {5, 5}, {.shadow = {.kind = scene::ShadowKind::None}});
      const double expected = measure::whole_specular({.outline = is_ellipse ? measure::LampOutline::Ellipse
                                                                             : measure::LampOutline::Rectangle,
                                                       .center = center,
                                                       .axis_x = 0.5 * size * glm::dvec3(world_from_lamp[0]),
                                                       .axis_y = 0.25 * size * glm::dvec3(world_from_lamp[1])},
                                                      {.alpha = alpha, .view = view})
                                  .light;
      EXPECT_GT(expected, 0.01 * size * size);
      EXPECT_NEAR(double(renderer.picture(camera).middle().r) / expected, 1.0, 1e-3) << roughness << ' ' << size;
    }
  }
}

/** A lamp with an extent and a radiance of 1, and its shape relative to the origin. */
struct HighlightCase {
  std::string name;
  scene::Lamp lamp{};
  glm::dmat4 world_from_lamp{1.0};
  measure::LampShape shape{};
};

/** Lamps at \a center, which spread over about a third of their distance. Area lamps face the origin. */
std::vector<HighlightCase> highlight_cases(const glm::dvec3 &center)
{
  const double distance = glm::length(center);
  const glm::dmat4 world_from_lamp = turned_to(center, {});
  const glm::dvec3 axis_x(world_from_lamp[0]);
  const glm::dvec3 axis_y(world_from_lamp[1]);
  std::vector<HighlightCase> cases;
  const auto add = [&](const char *name, scene::LampKind kind, measure::LampOutline outline, const glm::dvec3 &at,
                       double half_x, double half_y) -> scene::Lamp & {
    HighlightCase &added =
        cases.emplace_back(HighlightCase{name, {}, world_from_lamp, {outline, at, half_x * axis_x, half_y * axis_y}});
    added.lamp.kind = kind;
    return added.lamp;
  };
  for (const bool is_ellipse : {false, true}) {
    scene::Lamp &area =
        add(is_ellipse ? "ellipse" : "rectangle", scene::LampKind::Area,
            is_ellipse ? measure::LampOutline::Ellipse : measure::LampOutline::Rectangle, center, 0.5, 0.25);
    area.area_shape = is_ellipse ? scene::AreaShape::Ellipse : scene::AreaShape::Rectangle;
    area.area_size_x = 1.0F;
    area.area_size_y = 0.5F;
    area.intensity = float(is_ellipse ? 0.5 * pi : 2.0);
  }
  for (const scene::LampKind kind : {scene::LampKind::Point, scene::LampKind::Spot}) {
    scene::Lamp &round =
        add(kind == scene::LampKind::Spot ? "spot" : "point", kind, measure::LampOutline::Round, center, 0.3, 0.3);
    round.radius = 0.3F;
    round.intensity = float(pi * 0.09);
    round.spot_outer_angle = 1.0F;
  }
  const double half_angle = 0.2;
  scene::Lamp &sun = add("sun", scene::LampKind::Sun, measure::LampOutline::Round, center / distance,
                         std::tan(half_angle), std::tan(half_angle));
  sun.angle = float(2.0 * half_angle);
  sun.intensity = float(pi * std::pow(std::sin(half_angle), 2.0));
  return cases;
}

class HighlightTest : public LampLightTest {
 protected:
  /** Radiance of the ground at the origin, a metal of \a roughness, towards \a view. */
  double highlight(const HighlightCase &one, float roughness, const glm::dvec3 &view, int sample_count,
                   scene::ShadowKind shadow = scene::ShadowKind::None)
  {
    scene.edit(material, [&](scene::Material &value) {
      value.metallic = 1.0F;
      value.roughness = roughness;
    });
    test::remove_lamps(scene);
    test::add_lamp(scene, one.lamp, one.world_from_lamp);
    scene::PlacedCamera camera = camera_above(1.0, 1e-4);
    camera.world_from_camera = glm::inverse(glm::lookAt(view, glm::dvec3(0.0), glm::dvec3(0, 1, 0)));
    test::Renderer renderer(*device, scene, {5, 5}, {.shadow = {.kind = shadow}, .sample_count = sample_count});
    const test::Picture picture = renderer.picture(camera);
    EXPECT_EQ(picture.non_finite_count(), 0U);
    return double(picture.middle().r);
  }

  static constexpr double view_angle = 0.8;
  const glm::dvec3 view{std::sin(view_angle), 0.0, std::cos(view_angle)};
};

TEST_F(HighlightTest, OfNarrowLobesIsTheClosedFormWithAnyNumberOfSamples)
{
  // The mirrored view is inside of the lamps, and outside of them.
  for (const glm::dvec3 &center : {glm::dvec3(-1.1, 0.1, 1.15), glm::dvec3(-1.0, 0.5, 1.2)}) {
    for (const HighlightCase &one : highlight_cases(center)) {
      const double expected =
          measure::whole_specular(one.shape, {.alpha = double(0.2F) * double(0.2F), .view = view}).light;
      EXPECT_GT(expected, 0.001);
      for (const int sample_count : {1, 2, 5, 16}) {
        EXPECT_NEAR(highlight(one, 0.2F, view, sample_count) / expected, 1.0, 2e-3)
            << one.name << ", " << sample_count << " samples, " << center.y;
      }
    }
  }
}

TEST_F(HighlightTest, OfALampThatCrossesTheHorizonIsTheClosedForm)
{
  for (const HighlightCase &one : highlight_cases({-1.6, 0.0, 0.1})) {
    const glm::dvec3 low(std::sin(1.45), 0.0, std::cos(1.45));
    const double alpha = double(0.2F) * double(0.2F);
    const double expected = measure::whole_specular(one.shape, {.alpha = alpha, .view = low}).light;
    EXPECT_GT(expected, 0.01);
    // The part of the points that are above the horizon is a fraction of 64.
    EXPECT_NEAR(highlight(one, 0.2F, low, 64) / expected, 1.0, 0.05) << one.name;
  }
}

TEST_F(HighlightTest, OfAHalfHiddenLampConverges)
{
  const glm::dvec3 center(-1.1, 0.1, 1.15);
  const HighlightCase one = highlight_cases(center).front();
  // A wall directly in front of the half of the lamp on the side of its -y.
  test::add_object(scene, test::add_square_mesh(scene, material),
                   glm::translate(one.world_from_lamp, glm::dvec3(0.0, -1.0, -0.01)));
  measure::LampShape seen = one.shape;
  seen.center += 0.5 * one.shape.axis_y;
  seen.axis_y *= 0.5;
  for (const float roughness : {0.3F, 0.45F}) {
    const double alpha = double(roughness) * double(roughness);
    const double expected = measure::integrated_specular(seen, {.alpha = alpha, .view = view}, 4096).value;
    EXPECT_GT(expected, 0.01);
    EXPECT_NEAR(highlight(one, roughness, view, 512, scene::ShadowKind::Hard) / expected, 1.0, 0.03) << roughness;
  }
}

struct PenumbraLamp {
  const char *name;
  scene::LampKind kind;
  scene::AreaShape shape = scene::AreaShape::Rectangle;
};

void PrintTo(const PenumbraLamp &lamp, std::ostream *stream)
{
  *stream << lamp.name;
}

/**
 * A ground, and above it a half plane whose straight edge is below the centre of a lamp that is 1 m high. The ratio of
 * a case is that of the widths of penumbra and lamp, which by similar triangles is that of the distances from the edge
 * to the ground and to the lamp. Of a sun, it is that of the penumbra's width and the height of the edge.
 */
class PenumbraTest : public test::SharedDeviceTest, public testing::WithParamInterface<PenumbraLamp> {
 protected:
  PenumbraTest()
  {
    ground = test::add_object(scene, square, glm::dmat4(1.0));
    half_plane = test::add_object(scene, square, glm::dmat4(1.0));
  }
  /** \a ball: radius of a ball, divided by its distance to the edge. Small in samples, \see decision 0012. */
  void place(double ratio, double ball = 0.1)
  {
    const PenumbraLamp &param = GetParam();
    scene::Lamp lamp;
    lamp.kind = param.kind;
    lamp.area_shape = param.shape;
    double radius = 0.0;
    // Enough for ten texels in half of the penumbra.
    double texels = 512.0;
    if (param.kind == scene::LampKind::Sun) {
      edge_m = 0.5;
      half_m = 0.5 * ratio * edge_m;
      const double angle = std::atan(0.5 * ratio);
      lamp.angle = float(2.0 * angle);
      // The mean of |tan t cos φ| over the directions at angles up to `angle`.
      mean_offset_m = edge_m * 2.0 / pi * (std::log((1.0 + std::sin(angle)) / std::cos(angle)) - std::sin(angle)) /
                      (1.0 - std::cos(angle));
    }
    else {
      edge_m = ratio / (1.0 + ratio);
      radius = param.kind == scene::LampKind::Area ? 0.3 : ball * (1.0 - edge_m);
      half_m = ratio * radius;
      mean_offset_m = param.kind == scene::LampKind::Area && param.shape == scene::AreaShape::Rectangle
                          ? half_m / 2.0
                          : half_m * 4.0 / (3.0 * pi);
      lamp.radius = float(radius);
      lamp.area_size_x = float(2.0 * radius);
      lamp.area_size_y = float(radius);
      const double cone = 1.2 * (3.5 * half_m + radius);
      lamp.spot_outer_angle = float(std::atan(cone));
      texels = param.kind == scene::LampKind::Spot ? 20.0 * cone / half_m : 20.0 * (half_m + 1.0 / half_m);
    }
    lamp.shadow.size = std::clamp(int(texels), 256, 2048);
    test::remove_lamps(scene);
    test::add_lamp(scene, lamp, glm::translate(glm::dmat4(1.0), {0, 0, 1}));
    const double extent_m = 4.0 * (half_m + radius);
    scene.set_transform(ground, glm::scale(glm::dmat4(1.0), glm::dvec3(extent_m)));
    scene.set_transform(half_plane,
                        glm::scale(glm::translate(glm::dmat4(1.0), {-extent_m, 0.0, edge_m}), glm::dvec3(extent_m)));
    // From below the half plane.
    camera = camera_above(0.5 * edge_m, 2.5 * half_m, double(size_px.y) / size_px.x);
  }
  /**
   * A caster without a shadow in the picture, which widens the search for casters. For suns it is parallel to the
   * light, and \a height times as high as the edge. For other lamps it is above them, at a distance of 1 / \a height m.
   */
  scene::Handle<scene::Node> add_nearer_caster(double height)
  {
    const bool is_sun = GetParam().kind == scene::LampKind::Sun;
    const glm::dvec3 center =
        is_sun ? glm::dvec3(-2.0 * half_m, 0.0, 0.5 * height * edge_m) : glm::dvec3(0.0, 0.0, 1.0 + 1.0 / height);
    const glm::dmat4 placed = glm::translate(glm::dmat4(1.0), center);
    return test::add_object(scene, square,
                            is_sun ? glm::scale(glm::rotate(placed, 0.5 * pi, glm::dvec3(0, 1, 0)),
                                                glm::dvec3(0.5 * height * edge_m, 0.1 * half_m, 1.0))
                                   : glm::scale(placed, glm::dvec3(0.1)));
  }
  /**
   * Width of the penumbra relative to the true one. The width is the mean distance from the edge's shadow, weighted by
   * the slope of visibility.
   */
  [[nodiscard]] double width_ratio(const std::vector<float> &visibilities) const
  {
    // Three times as wide as half of the penumbra, in the middle of the picture.
    const int row = size_px.y / 2 - 8;
    const int column = size_px.x / 5;
    double sum = 0.0;
    for (int x = column; x < size_px.x - column; x++) {
      double visibility = 0.0;
      for (int y = row; y < row + 16; y++) {
        visibility += double(visibilities.at(std::size_t(y * size_px.x + x))) / 16.0;
      }
      sum += std::abs(visibility - (x < size_px.x / 2 ? 0.0 : 1.0));
    }
    return sum * 5.0 * half_m / size_px.x / mean_offset_m;
  }
  double width_ratio_of_samples(double ratio, int sample_count)
  {
    place(ratio);
    SceneRenderer renderer(*device, scene, size_px,
                           {.shadow = {.is_fitted_to_depth = true}, .sample_count = sample_count});
    renderer.sync();
    return width_ratio(render_surface_layers(renderer, camera, sample_count, {.visible_lamps = {0}}).visibilities[0]);
  }
  double width_ratio_of_one_frame(double ratio)
  {
    // The smallest penumbra of a ball of 0.1 would be a texel of the cube.
    place(ratio, ratio < 0.02 ? 0.3 : 0.1);
    return width_ratio(visibilities_of_one_frame(*device, scene, camera, size_px));
  }

  scene::Scene scene;
  scene::Handle<scene::Mesh> square = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(1.0F)));
  scene::Handle<scene::Node> ground;
  scene::Handle<scene::Node> half_plane;
  scene::PlacedCamera camera;
  /** The picture is five times as wide as half of the penumbra. */
  glm::ivec2 size_px{96, 16};
  /** Height of the edge, half the width of the penumbra, and its mean distance from the middle. */
  double edge_m = 0.0;
  double half_m = 0.0;
  double mean_offset_m = 0.0;
};

TEST_P(PenumbraTest, OfSamplesIsAsWideAsSimilarTrianglesSay)
{
  for (const double ratio : {0.01, 0.1, 1.0}) {
    EXPECT_NEAR(width_ratio_of_samples(ratio, 128), 1.0, 0.01) << ratio;
  }
}

TEST_P(PenumbraTest, OfOneFrameIsAsWideAsSimilarTrianglesSay)
{
  for (const double ratio : {0.02, 0.3, 10.0}) {
    EXPECT_NEAR(width_ratio_of_one_frame(ratio), 1.0, 0.1) << ratio;
  }
}

class PenumbraSceneTest : public test::SharedDeviceTest {};

TEST_F(PenumbraSceneTest, CastersBehindTheReceiverDoNotDarkenIt)
{
  scene::Scene scene;
  const auto square = test::add_square_mesh(scene, test::add_material(scene, glm::vec3(1.0F)));
  const auto upright_at = [&](double x, double half_height) {
    const glm::dmat4 upright = glm::rotate(glm::translate(glm::dmat4(1.0), {x, 0, 0}), 0.5 * pi, glm::dvec3(0, 1, 0));
    return test::add_object(scene, square, glm::scale(upright, glm::dvec3(half_height, 3.0, 1.0)));
  };
  test::add_object(scene, square, glm::scale(glm::dmat4(1.0), glm::dvec3(8.0)));
  // The light is low, so that the plane of the ground is far behind the lookups. The shadow of the edge is at the
  // origin.
  scene::Lamp lamp;
  lamp.kind = scene::LampKind::Point;
  lamp.radius = 0.25F;
  test::add_lamp(scene, lamp, glm::translate(glm::dmat4(1.0), {-2, 0, 1}));
  upright_at(-1.0, 0.5);
  const auto wall = upright_at(0.4, 1.0);
  const scene::PlacedCamera camera = camera_above(10.0, 0.35);
  test::Renderer renderer(*device, scene, {32, 32});
  const test::Picture with_wall = renderer.picture(camera);
  scene.remove(wall);
  renderer.sync();
  const test::Picture without = renderer.picture(camera);
  float brightest = 0.0F;
  float darkest = 1e9F;
  for (std::size_t i = 0; i < without.pixels.size(); i++) {
    EXPECT_EQ(with_wall.pixels[i].r, without.pixels[i].r) << i;
    brightest = std::max(brightest, without.pixels[i].r);
    darkest = std::min(darkest, without.pixels[i].r);
  }
  EXPECT_LT(darkest, 0.2F * brightest) << "a penumbra crosses the picture";
}

/** Also of a lamp whose centre is below the horizon. */
TEST_F(PenumbraSceneTest, TheHorizonOfAGroundWithoutCastersHidesNothingMore)
{
  for (const double height : {0.1, -0.1, -0.3}) {
    scene::Scene scene;
    test::add_object(scene, test::add_square_mesh(scene, test::add_material(scene, glm::vec3(1.0F))), glm::dmat4(1.0));
    scene::Lamp lamp;
    lamp.kind = scene::LampKind::Point;
    lamp.radius = 0.5F;
    test::add_lamp(scene, lamp, glm::translate(glm::dmat4(1.0), {2, 0, height}));
    for (const float visibility : visibilities_of_one_frame(*device, scene, camera_above(10.0, 0.9), {32, 32})) {
      ASSERT_EQ(visibility, 1.0F) << height;
    }
  }
}

/** The side of a ball that faces the lamp is nearer to it than the edge that hides the lamp. */
TEST_F(PenumbraSceneTest, BelowABallThatHidesTheLampIsLittleLight)
{
  for (const scene::LampKind kind : {scene::LampKind::Area, scene::LampKind::Point, scene::LampKind::Sun}) {
    scene::Scene scene;
    const auto material = test::add_material(scene, glm::vec3(1.0F));
    test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1.0), glm::dvec3(8.0)));
    // Seen from the origin, half of the ball's angle is 0.675, and half of the lamp's at most 0.55.
    scene::Lamp lamp;
    lamp.kind = kind;
    lamp.area_shape = scene::AreaShape::Ellipse;
    lamp.area_size_x = lamp.area_size_y = 2.6F;
    lamp.radius = 1.3F;
    lamp.angle = 0.9F;
    test::add_lamp(scene, lamp, glm::translate(glm::dmat4(1.0), {0, 0, 3}));
    const auto ball = test::add_object(scene, test::add_sphere_mesh(scene, material),
                                       glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, 0.8}), glm::dvec3(0.5)));
    test::Renderer renderer(*device, scene, {16, 16});
    const auto mean = [&] {
      float sum = 0.0F;
      for (const glm::vec4 &pixel : renderer.picture(camera_above(0.25, 0.02)).pixels) {
        sum += pixel.r / (16.0F * 16.0F);
      }
      return sum;
    };
    const float below = mean();
    scene.remove(ball);
    renderer.sync();
    // The truth is 0. Without the lookups on the disk of the smallest gap, area and point lamps leave 0.30.
    EXPECT_LT(below / mean(), 0.01F) << int(kind);
  }
}

/** Each part of a ball has another gap. The smallest one is at its edge, and gives the width of the penumbra. */
TEST_F(PenumbraSceneTest, OfABallIsLikeThatOfManySamples)
{
  scene::Scene scene;
  const auto material = test::add_material(scene, glm::vec3(1.0F));
  test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1.0), glm::dvec3(8.0)));
  test::add_object(scene, test::add_sphere_mesh(scene, material),
                   glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, 0.8}), glm::dvec3(0.6)));
  scene::Lamp lamp;
  lamp.kind = scene::LampKind::Area;
  lamp.area_size_x = 2.0F;
  lamp.area_size_y = 0.7F;
  test::add_lamp(scene, lamp, glm::translate(glm::dmat4(1.0), {0, 0, 3}));
  const glm::ivec2 size_px{64, 64};
  const scene::PlacedCamera camera = camera_above(0.15, 1.5);
  const std::vector<float> visibilities = visibilities_of_one_frame(*device, scene, camera, size_px);
  const int sample_count = 256;
  SceneRenderer renderer(*device, scene, size_px,
                         {.shadow = {.is_fitted_to_depth = true}, .sample_count = sample_count});
  renderer.sync();
  const std::vector<float> truth =
      render_surface_layers(renderer, camera, sample_count, {.visible_lamps = {0}}).visibilities[0];
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.size(); i++) {
    squares += std::pow(double(visibilities[i] - truth[i]), 2.0);
  }
  // 0.051. Without the lookups on the disk of the smallest gap: 0.059.
  EXPECT_LT(std::sqrt(squares / double(truth.size())), 0.055);
}

/** Surfaces that nothing hides from a lamp with a size, in pictures of one sample. */
class LitPenumbraTest : public test::SharedDeviceTest {
 protected:
  /** The least quotient of a pixel with and without shadows. The truth is 1. */
  float least_visibility(const scene::PlacedCamera &camera, glm::ivec2 size_px)
  {
    return std::ranges::min(visibilities_of_one_frame(*device, scene, camera, size_px));
  }

  scene::Scene scene;
  scene::Handle<scene::Material> material = test::add_material(scene, glm::vec3(1.0F));
};

TEST_F(LitPenumbraTest, FoldsAlongTheLightHaveNoDarkLines)
{
  // Heights differ only across the folds, and the light comes along them, so that each point sees all of the sun.
  constexpr int rows = 120;
  scene::Mesh folds;
  folds.material = material;
  for (int y = 0; y <= rows; y++) {
    const double across = 2.0 * y / rows - 1.0;
    const double phase = 20.0 * pi * across;
    for (const double along : {-1.0, 1.0}) {
      folds.positions.emplace_back(along, across, 0.03 * std::cos(phase));
      folds.normals.push_back(glm::normalize(glm::vec3(0.0F, float(0.6 * pi * std::sin(phase)), 1.0F)));
    }
    if (y < rows) {
      const auto first = std::uint32_t(2 * y);
      for (const std::uint32_t i : {0U, 1U, 3U, 0U, 3U, 2U}) {
        folds.indices.push_back(first + i);
      }
    }
  }
  test::add_object(scene, scene.add(std::move(folds)), glm::scale(glm::dmat4(1.0), glm::dvec3(100.0)));
  scene::Lamp sun;
  sun.kind = scene::LampKind::Sun;
  sun.angle = 0.00925F;
  sun.shadow.size = 512;
  const double elevation = 0.26;
  test::add_lamp(scene, sun, turned_to({std::cos(elevation), 0.0, std::sin(elevation)}, {0, 0, 0}));
  EXPECT_GT(least_visibility(camera_above(200.0, 60.0), {128, 128}), 0.9F);
}

TEST_F(LitPenumbraTest, TheGroundAtTheFootOfALitWallHasNoDarkDashes)
{
  const auto square = test::add_square_mesh(scene, material);
  test::add_object(scene, square, glm::scale(glm::dmat4(1.0), glm::dvec3(4.0)));
  // The foot of the wall is oblique to the rows of the map.
  const glm::dmat4 turned = glm::rotate(glm::dmat4(1.0), 0.3, glm::dvec3(0, 0, 1));
  const glm::dmat4 upright = glm::rotate(turned, 0.5 * pi, glm::dvec3(0, 1, 0));
  test::add_object(scene, square, glm::scale(upright, glm::dvec3(1.0, 4.0, 1.0)));
  scene::Lamp lamp;
  lamp.kind = scene::LampKind::Point;
  lamp.radius = 0.1F;
  // Columns along the foot of the wall, rows from it to 0.04 m in front of it.
  scene::PlacedCamera camera = camera_above(0.8, 0.32, 1.0 / 16.0);
  camera.world_from_camera = glm::rotate(glm::translate(turned, {0.02, 0.0, 0.8}), 0.5 * pi, glm::dvec3(0, 0, 1));
  for (const double height : {2.0, 0.7}) {
    test::remove_lamps(scene);
    test::add_lamp(scene, lamp, glm::translate(turned, {2.0, 0.0, height}));
    EXPECT_GT(least_visibility(camera, {256, 16}), 0.9F) << height;
  }
}

using SlowPenumbraTest = PenumbraTest;

TEST_P(SlowPenumbraTest, OfSamplesIsAsWideAsSimilarTrianglesSay)
{
  for (const double ratio : {0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0}) {
    EXPECT_NEAR(width_ratio_of_samples(ratio, 256), 1.0, 0.01) << ratio;
  }
}

TEST_P(SlowPenumbraTest, OfOneFrameIsAsWideAsSimilarTrianglesSay)
{
  for (const double ratio : {0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.4, 2.0, 3.0, 5.0, 7.0, 10.0}) {
    const double width = width_ratio_of_one_frame(ratio);
    EXPECT_NEAR(width, 1.0, 0.1) << ratio;
    RecordProperty(fmt::format("ratio_{}", ratio), fmt::format("{:.2f}", width));
  }
}

TEST_P(SlowPenumbraTest, OfOneFrameIsAsWideWithACasterOfAnyHeight)
{
  for (const double ratio : {0.05, 0.5}) {
    for (const double height : {3.0, 10.0, 30.0, 100.0}) {
      place(ratio);
      const auto other = add_nearer_caster(height);
      const double width = width_ratio_of_one_frame(ratio);
      EXPECT_NEAR(width, 1.0, 0.1) << ratio << " " << height;
      RecordProperty(fmt::format("ratio_{}_height_{}", ratio, height), fmt::format("{:.2f}", width));
      scene.remove(other);
    }
  }
}

const PenumbraLamp penumbra_lamps[] = {
    {"Point", scene::LampKind::Point},
    {"Spot", scene::LampKind::Spot},
    {"Sun", scene::LampKind::Sun},
    {"Rectangle", scene::LampKind::Area},
    {"Ellipse", scene::LampKind::Area, scene::AreaShape::Ellipse},
};
const auto penumbra_name = [](const testing::TestParamInfo<PenumbraLamp> &test) {
  return std::string(test.param.name);
};

INSTANTIATE_TEST_SUITE_P(Each, PenumbraTest, testing::ValuesIn(penumbra_lamps), penumbra_name);
INSTANTIATE_TEST_SUITE_P(Each, SlowPenumbraTest, testing::ValuesIn(penumbra_lamps), penumbra_name);

}  // namespace
}  // namespace gnomon::eevee
