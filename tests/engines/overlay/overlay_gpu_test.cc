// SPDX-License-Identifier: MIT
#include "overlay.hh"

#include "engines/eevee/eevee_test_scene.hh"
#include "gpu_device_fixture.hh"
#include "gpu_read.hh"
#include "reference_tracer.hh"
#include "render_camera.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <map>
#include <random>
#include <set>

namespace gnomon::overlay {
namespace {

constexpr glm::ivec2 size_px{60, 40};
constexpr glm::vec4 line_color(1.0F, 0.5F, 0.0F, 1.0F);

class OverlayGpuTest : public test::SharedDeviceTest {
 protected:
  void SetUp() override
  {
    SharedDeviceTest::SetUp();
    if (device) {
      render_scene.emplace(*device, scene);
      overlay.emplace(*render_scene);
    }
  }
  [[nodiscard]] draw::View view() const
  {
    return render_scene::view_of(camera, size_px, render_scene->origin_ws());
  }
  std::optional<Hit> pick(int x, int y)
  {
    render_scene->update();
    return overlay->pick(view(), size_px, {x, y});
  }
  /** The node under the middle of the picture; an invalid handle: none. */
  scene::Handle<scene::Node> picked()
  {
    const std::optional<Hit> hit = pick(size_px.x / 2, size_px.y / 2);
    return hit ? hit->node : scene::Handle<scene::Node>();
  }
  /** A square that faces the camera. */
  scene::Handle<scene::Node> add_square(double z, scene::Handle<scene::Material> material, double half_size = 1.0)
  {
    const glm::dmat4 place = glm::translate(glm::dmat4(1), {0, 0, z});
    return test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(place, glm::dvec3(half_size)));
  }
  /** A material of which the right half is drawn. */
  scene::Handle<scene::Material> add_mask()
  {
    const auto masked = test::add_material(scene, glm::vec3(0.5F));
    const std::vector<std::uint8_t> hole_on_the_left = {255, 255, 255, 0, 255, 255, 255, 255};
    scene.edit(masked, [&](scene::Material &material) {
      material.base_color_texture = {test::add_texture(scene, 2, hole_on_the_left)};
      material.alpha_mode = scene::AlphaMode::Mask;
    });
    return masked;
  }
  /** Colours of a target of 80x60 pixels, with the picture at 10, 15, after \a draw over transparent black. */
  template <typename Draw>
  test::Picture drawn(Draw &&draw)
  {
    render_scene->update();
    const draw::TargetTexture texture(*device, "target", gpu::Format::RGBA32F, {80, 60});
    gpu::CommandList clear;
    clear.begin_pass("clear", *std::get<const gpu::Framebuffer *>(texture.target().framebuffer), {});
    clear.end_pass();
    device->submit(clear);
    draw::Target target = texture.target();
    target.origin_px = {10, 15};
    draw(target);
    return {{80, 60}, gpu::read_as<glm::vec4>(*device, texture.texture())};
  }
  test::Picture outline(std::span<const scene::Handle<scene::Node>> nodes)
  {
    return drawn(
        [&](const draw::Target &target) { overlay->draw_outline(view(), size_px, nodes, line_color, target); });
  }
  test::Picture lines(const std::vector<Line> &lines)
  {
    return drawn([&](const draw::Target &target) { overlay->draw_lines(view(), size_px, lines, target); });
  }
  /** Where the camera sees a point, in pixels of the target. */
  [[nodiscard]] glm::dvec2 seen(const glm::dvec3 &position_ws) const
  {
    const glm::dvec4 clip = glm::dmat4(view().clip_from_world()) * glm::dvec4(position_ws, 1.0);
    return glm::dvec2(10, 15) + (0.5 * glm::dvec2(clip) / clip.w + 0.5) * glm::dvec2(size_px);
  }

  /** The ray through the middle of a pixel, or beside it, in double, by the matrices that the device has as floats. */
  [[nodiscard]] reference::Ray ray_through(const glm::dvec2 &pixel) const
  {
    const glm::dmat4 world_from_clip =
        glm::inverse(glm::dmat4(view().clip_from_view()) * glm::dmat4(view().view_from_world()));
    const glm::dvec2 ndc = 2.0 * (pixel + 0.5) / glm::dvec2(size_px) - 1.0;
    const glm::dvec4 near = world_from_clip * glm::dvec4(ndc, 1.0, 1.0);
    const glm::dvec4 far = world_from_clip * glm::dvec4(ndc, 0.01, 1.0);
    const glm::dvec3 origin = glm::dvec3(near) / near.w;
    return {.origin_ws = origin + render_scene->origin_ws(),
            .direction_ws = glm::normalize(glm::dvec3(far) / far.w - origin),
            .t_min = 0.0};
  }
  /** The point that the weights of a hit's triangle give, world space. */
  [[nodiscard]] glm::dvec3 weighted(const Hit &hit) const
  {
    const scene::Mesh &mesh = scene.meshes()[hit.mesh];
    glm::dvec3 sum(0.0);
    for (std::uint32_t i = 0; i < 3; i++) {
      sum += hit.triangle->barycentric[int(i)] * glm::dvec3(mesh.positions[mesh.indices[3 * hit.triangle->index + i]]);
    }
    return glm::dvec3(scene.world_from_node(hit.node) * glm::dvec4(sum, 1.0));
  }
  /**
   * Compare what pixels pick with \a grid, which add_grid made, at \a node: its plane, cells and uvs have closed
   * forms. \a stretch: of x and y in the mesh's present pose. \return the number of pixels that show it
   */
  int expect_grid(scene::Handle<scene::Node> node, const glm::dvec2 &stretch = glm::dvec2(1.0))
  {
    const glm::dmat4 world = scene.world_from_node(node);
    const glm::dvec3 normal = glm::normalize(glm::cross(glm::dvec3(world[0]), glm::dvec3(world[1])) *
                                             (glm::determinant(glm::dmat3(world)) < 0.0 ? -1.0 : 1.0));
    int count = 0;
    for (int y = 0; y < size_px.y; y += 2) {
      for (int x = 0; x < size_px.x; x += 2) {
        const std::optional<Hit> hit = pick(x, y);
        if (!hit || hit->node != node) {
          continue;
        }
        if (!hit->triangle) {
          ADD_FAILURE() << "no triangle at " << x << ", " << y;
          continue;
        }
        const auto on_plane = [&](const glm::dvec2 &pixel) {
          const reference::Ray ray = ray_through(pixel);
          const double t = glm::dot(glm::dvec3(world[3]) - ray.origin_ws, normal) / glm::dot(ray.direction_ws, normal);
          return ray.origin_ws + t * ray.direction_ws;
        };
        const glm::dvec3 position_ws = on_plane({x, y});
        const glm::dvec2 inside = glm::dvec2(glm::inverse(world) * glm::dvec4(position_ws, 1.0)) / stretch;
        const glm::dvec2 cell_at = 0.5 * (inside + 1.0) * glm::dvec2(grid_cells);
        const glm::dvec2 part = glm::fract(cell_at);
        // At an edge that cells share, either is right.
        if (std::min({part.x, part.y, 1.0 - part.x, 1.0 - part.y, std::abs(part.x - part.y)}) < 1e-3) {
          continue;
        }
        const glm::ivec2 cell(glm::floor(cell_at));
        if (cell != glm::clamp(cell, glm::ivec2(0), grid_cells - 1)) {
          // The device moved the outline over the middle of the pixel. The nearest point of the mesh is picked.
          EXPECT_LT(glm::distance(hit->position_ws, position_ws),
                    test::vertex_shift_max_px(*device) * (glm::distance(position_ws, on_plane({x + 1, y})) +
                                                          glm::distance(position_ws, on_plane({x, y + 1}))))
              << x << ", " << y;
          continue;
        }
        EXPECT_EQ(int(hit->triangle->index), 2 * (cell.y * grid_cells.x + cell.x) + (part.x > part.y ? 0 : 1));
        // Positions of the mesh and the pose are floats.
        EXPECT_LT(glm::distance(hit->position_ws, position_ws), 1e-6) << x << ", " << y;
        EXPECT_LT(glm::distance(weighted(*hit), position_ws), 1e-6) << x << ", " << y;
        EXPECT_LT(glm::distance(glm::dvec2(hit->triangle->uv), glm::dvec2(0.5, -0.5) * inside + 0.5), 1e-6);
        EXPECT_LT(glm::distance(glm::dvec3(hit->triangle->normal_ws), normal), 1e-6);
        count++;
      }
    }
    return count;
  }
  static constexpr glm::ivec2 grid_cells{7, 5};
  /** A square of cells with two triangles each, from -1 to 1 in x and y, facing +Z, with uvs along -Y. */
  scene::Handle<scene::Mesh> add_grid(scene::Handle<scene::Material> material)
  {
    scene::Mesh mesh{.name = "grid", .material = material};
    const auto stride = std::uint32_t(grid_cells.x + 1);
    for (int y = 0; y <= grid_cells.y; y++) {
      for (int x = 0; x <= grid_cells.x; x++) {
        const glm::vec2 at = glm::vec2(x, y) / glm::vec2(grid_cells);
        mesh.positions.emplace_back(2.0F * at - 1.0F, 0.0F);
        mesh.normals.emplace_back(0, 0, 1);
        mesh.uvs.emplace_back(at.x, 1.0F - at.y);
        if (x < grid_cells.x && y < grid_cells.y) {
          const std::uint32_t i = std::uint32_t(y) * stride + std::uint32_t(x);
          mesh.indices.insert(mesh.indices.end(), {i, i + 1, i + stride + 1, i, i + stride + 1, i + stride});
        }
      }
    }
    return scene.add(std::move(mesh));
  }

  scene::Scene scene;
  scene::PlacedCamera camera = test::camera_at({0, 0, 5}, {0, 0, 0});
  std::optional<render_scene::RenderScene> render_scene;
  std::optional<Overlay> overlay;
};

TEST_F(OverlayGpuTest, EachPixelPicksTheObjectAndPositionThatItsRayMeetsFirst)
{
  // Far from the world's origin, so that positions need it.
  const glm::dvec3 middle(40000, 0, -2000);
  camera = test::camera_at({}, {});
  camera.world_from_camera = glm::inverse(glm::lookAt(middle + glm::dvec3(3, 4, 6), middle, glm::dvec3(0, 1, 0)));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> range(-1.0, 1.0);
  const auto two_sided = test::add_material(scene, glm::vec3(0.5F));
  const auto one_sided = test::add_material(scene, glm::vec3(0.5F));
  test::edit_material(scene, 1, [](scene::Material &material) { material.is_double_sided = false; });
  for (int i = 0; i < 40; i++) {
    const auto material = i % 2 == 0 ? two_sided : one_sided;
    const auto mesh = i % 4 < 2 ? test::add_box_mesh(scene, material) : test::add_square_mesh(scene, material);
    glm::dmat4 place =
        glm::translate(glm::dmat4(1), middle + 2.5 * glm::dvec3(range(random), range(random), range(random)));
    place = glm::rotate(place, 3.0 * range(random), glm::normalize(glm::dvec3(range(random), range(random), 0.1)));
    // Every third is mirrored.
    place = glm::scale(place, glm::dvec3(i % 3 == 0 ? -0.6 : 0.6, 0.3, 0.5));
    const auto node = test::add_object(scene, mesh, place);
    if (i % 8 == 7) {
      scene.edit(node, [](scene::Node &hidden) { hidden.is_visible = false; });
    }
  }
  render_scene->set_origin(render_scene::origin_near(middle, glm::dvec3(0), {}));
  const reference::Tracer tracer(scene);
  const std::vector<scene::Object> objects = scene.objects();
  const glm::dmat4 world_from_clip =
      glm::dmat4(camera.world_from_camera) * glm::inverse(glm::dmat4(view().clip_from_view()));
  const glm::dvec3 eye(camera.world_from_camera[3]);
  int hit_count = 0;
  int miss_count = 0;
  for (int y = 0; y < size_px.y; y += 3) {
    for (int x = 0; x < size_px.x; x += 3) {
      const glm::dvec2 ndc = 2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(size_px) - 1.0;
      const glm::dvec4 near = world_from_clip * glm::dvec4(ndc, 1.0, 1.0);
      const auto expected = tracer.closest(
          {.origin_ws = eye, .direction_ws = glm::dvec3(near) / near.w - eye, .t_min = 1.0}, reference::Faces::Drawn);
      const std::optional<Hit> hit = pick(x, y);
      ASSERT_EQ(hit.has_value(), expected.has_value()) << x << ", " << y;
      (hit ? hit_count : miss_count)++;
      if (hit) {
        const reference::Surface surface = tracer.surface_at(*expected);
        EXPECT_EQ(hit->node, objects[surface.object].node) << x << ", " << y;
        EXPECT_EQ(hit->mesh, objects[surface.object].mesh) << x << ", " << y;
        // Matrices relative to the origin are floats, at up to 1024 m: 6e-5 m.
        EXPECT_LT(glm::distance(hit->position_ws, surface.position_ws), 1e-3) << x << ", " << y;
      }
    }
  }
  EXPECT_GT(hit_count, 50);
  EXPECT_GT(miss_count, 50);
}

TEST_F(OverlayGpuTest, APickedTriangleIsThatOfTheCellOfAPlaneAtEachInstanceTurnedOrMirrored)
{
  const auto material = test::add_material(scene, glm::vec3(0.5F));
  test::edit_material(scene, 0, [](scene::Material &one) { one.is_double_sided = false; });
  const auto grid = add_grid(material);
  const auto placed = [&](double x, const glm::dvec3 &scale, double angle) {
    const glm::dmat4 place = glm::rotate(glm::translate(glm::dmat4(1), {x, 0.2, -0.5}), angle, {0.3, 1, 0.1});
    return test::add_object(scene, grid, glm::scale(place, scale));
  };
  const std::array nodes = {placed(-1.6, {0.7, 1.1, 1}, 0.4), placed(0.0, {-0.7, 1.1, 1}, 0.4),
                            placed(1.6, {0.7, -1.1, 1}, -0.3)};
  for (const auto node : nodes) {
    EXPECT_GT(expect_grid(node), 20);
  }
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_height = 2.0F;
  camera.half_width = 3.0F;
  EXPECT_GT(expect_grid(nodes[0]), 20) << "parallel";
  // From behind, a surface with two sides has the normal of its front.
  test::edit_material(scene, 0, [](scene::Material &one) { one.is_double_sided = true; });
  camera = test::camera_at({0, 0, -5}, {0, 0, 0});
  EXPECT_GT(expect_grid(nodes[0]), 20) << "from behind";
}

TEST_F(OverlayGpuTest, APickedTriangleOfADeformedMeshIsThatOfItsPose)
{
  const auto grid = add_grid(test::add_material(scene, glm::vec3(0.5F)));
  const auto node = test::add_object(scene, grid, glm::rotate(glm::dmat4(1), 0.3, {0, 1, 0}));
  const scene::Mesh &rest = scene.meshes()[grid];
  scene::DeformedMesh deformed;
  deformed.mesh = grid;
  deformed.node = node;
  deformed.positions = rest.positions;
  deformed.normals = rest.normals;
  deformed.targets.emplace_back();
  for (const glm::vec3 &position : rest.positions) {
    deformed.targets[0].positions.emplace_back(0.5F * position.x, -0.5F * position.y, 0.0F);
  }
  deformed.weights = {0.0};
  scene.deformed_meshes.push_back(deformed);
  EXPECT_GT(expect_grid(node), 20);
  scene::set_morph_weights(scene, node, std::array{1.0});
  scene::deform_meshes(scene);
  EXPECT_GT(expect_grid(node, {1.5, 0.5}), 20);
}

TEST_F(OverlayGpuTest, APickedTriangleOfASphereHasTheAnglesOfItsPointAndItsNormalPointsFromTheMiddle)
{
  constexpr int segments = 64;
  constexpr double step = 2.0 * M_PI / segments;
  scene::Mesh mesh{.name = "sphere", .material = test::add_material(scene, glm::vec3(0.5F))};
  for (int ring = 0; ring <= segments / 2; ring++) {
    for (int segment = 0; segment <= segments; segment++) {
      // The seam of the uvs is behind.
      const glm::dvec2 angles(step * segment - M_PI, step * ring);
      mesh.normals.emplace_back(std::sin(angles.y) * std::sin(angles.x), std::cos(angles.y),
                                std::sin(angles.y) * std::cos(angles.x));
      mesh.uvs.emplace_back(angles);
      const auto i = std::uint32_t(ring * (segments + 1) + segment);
      if (ring < segments / 2 && segment < segments) {
        mesh.indices.insert(mesh.indices.end(), {i, i + segments + 1, i + segments + 2, i, i + segments + 2, i + 1});
      }
    }
  }
  mesh.positions = mesh.normals;
  const glm::dvec3 middle(0.3, -0.2, 0.5);
  const auto node = test::add_object(scene, scene.add(std::move(mesh)), glm::translate(glm::dmat4(1), middle));
  int count = 0;
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x += 2) {
      const reference::Ray ray = ray_through({x, y});
      const glm::dvec3 from_middle = ray.origin_ws - middle;
      const double along = -glm::dot(from_middle, ray.direction_ws);
      const double past_squared = glm::dot(from_middle, from_middle) - along * along;
      const std::optional<Hit> hit = pick(x, y);
      // The triangles lie within the sphere, by up to `sagitta`.
      constexpr double sagitta = step * step / 4.0;
      EXPECT_TRUE(hit || past_squared > (1.0 - sagitta) * (1.0 - sagitta)) << x << ", " << y;
      EXPECT_TRUE(!hit || past_squared <= 1.0) << x << ", " << y;
      // Farther out, a ray moves by many triangles along the surface from the sphere to its triangle.
      if (!hit || past_squared > 0.7) {
        continue;
      }
      EXPECT_EQ(hit->node, node);
      ASSERT_TRUE(hit->triangle);
      const glm::dvec3 exact = from_middle + (along - std::sqrt(1.0 - past_squared)) * ray.direction_ws;
      EXPECT_LT(glm::distance(hit->position_ws - middle, exact), 2.0 * sagitta);
      EXPECT_LT(glm::length(glm::cross(hit->position_ws - ray.origin_ws, ray.direction_ws)), 1e-6) << "on the ray";
      EXPECT_LT(glm::distance(weighted(*hit), hit->position_ws), 1e-6);
      // Interpolation is exact to the second order in the size of a triangle; a neighbour's uvs are wrong by `step`.
      const glm::dvec3 seen = glm::normalize(hit->position_ws - middle);
      EXPECT_LT(glm::distance(glm::dvec3(hit->triangle->normal_ws), seen), step * step);
      EXPECT_NEAR(double(hit->triangle->uv.x), std::atan2(seen.x, seen.z), step * step);
      EXPECT_NEAR(double(hit->triangle->uv.y), std::acos(seen.y), step * step);
      count++;
    }
  }
  EXPECT_GT(count, 70);
}

TEST_F(OverlayGpuTest, APickedTriangleIsTheOneBehindAHoleOfTheSameMeshAndPointsHaveNone)
{
  const auto masked = add_mask();
  const auto two_squares = test::add_square_mesh(scene, masked);
  scene::Mesh mesh = scene.meshes()[two_squares];
  for (std::size_t i = 0; i < 4; i++) {
    mesh.positions.push_back(mesh.positions[i] - glm::vec3(0, 0, 1e-3F));
    mesh.normals.push_back(mesh.normals[i]);
    mesh.uvs.emplace_back(0.75F, 0.5F);  // No hole.
  }
  mesh.indices.insert(mesh.indices.end(), {4, 5, 6, 4, 6, 7});
  scene.replace(two_squares, mesh);
  test::add_object(scene, two_squares, glm::dmat4(1));
  const std::optional<Hit> hole = pick(size_px.x / 2 - 3, size_px.y / 2 + 1);
  ASSERT_TRUE(hole && hole->triangle);
  EXPECT_EQ(hole->triangle->index, 3U);
  EXPECT_NEAR(hole->position_ws.z, -1e-3, 1e-9);
  EXPECT_EQ(hole->triangle->uv, glm::vec2(0.75F, 0.5F));
  EXPECT_EQ(pick(size_px.x / 2 + 3, size_px.y / 2 + 1)->triangle->index, 0U);

  mesh.topology = scene::Topology::Lines;
  mesh.indices = {4, 5, 5, 6, 6, 7, 7, 4};
  scene.replace(two_squares, mesh);
  const glm::ivec2 corner = glm::ivec2(seen({-1, -1, -1e-3})) - glm::ivec2(10, 15);
  std::optional<Hit> line;
  for (int x = corner.x; x <= corner.x + 1; x++) {
    line = line ? line : pick(x, corner.y + 3);
  }
  ASSERT_TRUE(line);
  EXPECT_FALSE(line->triangle);
}

TEST_F(OverlayGpuTest, WhatAMaskCutsOutAndHiddenNodesLetThePixelThrough)
{
  const auto plain = test::add_material(scene, glm::vec3(0.5F));
  const auto back = add_square(-1, plain);
  const auto masked = add_mask();
  const auto front = add_square(0, masked);
  EXPECT_EQ(pick(size_px.x / 2 - 3, size_px.y / 2)->node, back);
  EXPECT_EQ(pick(size_px.x / 2 + 3, size_px.y / 2)->node, front);
  // A transform of the uvs makes the material a full one, which reads other inputs.
  scene.edit(masked, [](scene::Material &material) { material.base_color_texture.offset.x = 0.5F; });
  EXPECT_EQ(pick(size_px.x / 2 - 3, size_px.y / 2)->node, front);
  EXPECT_EQ(pick(size_px.x / 2 + 3, size_px.y / 2)->node, back);

  scene.edit(front, [](scene::Node &node) { node.is_visible = false; });
  EXPECT_EQ(picked(), back);
  scene.edit(back, [](scene::Node &node) { node.is_visible = false; });
  EXPECT_EQ(picked(), scene::Handle<scene::Node>());
}

TEST_F(OverlayGpuTest, APointIsInsideOfAnOutlineThatCrossesALineFromItAnOddNumberOfTimes)
{
  const auto square = rectangle({4, 1}, {1, 3});
  EXPECT_TRUE(is_inside(square, {2, 2}));
  EXPECT_FALSE(is_inside(square, {0.9, 2}));
  EXPECT_FALSE(is_inside(square, {2, 3.1}));
  // Rows through corners.
  const std::array<glm::dvec2, 4> diamond = {{{0, -1}, {1, 0}, {0, 1}, {-1, 0}}};
  EXPECT_TRUE(is_inside(diamond, {0, 0}));
  EXPECT_FALSE(is_inside(diamond, {-2, 0}));
  EXPECT_FALSE(is_inside(diamond, {2, 1}));
  // A star of one path: its middle is enclosed twice.
  std::vector<glm::dvec2> star;
  for (int i = 0; i < 5; i++) {
    star.emplace_back(std::sin(0.8 * M_PI * i), std::cos(0.8 * M_PI * i));
  }
  EXPECT_FALSE(is_inside(star, {0, 0}));
  EXPECT_TRUE(is_inside(star, {0, 0.8}));
  EXPECT_FALSE(is_inside(std::span(star).first(2), {0, 0.5}));
  EXPECT_FALSE(is_inside({}, {0, 0}));
}

TEST_F(OverlayGpuTest, AnAreaSelectsWhatRaysThroughItsPixelsMeetFirstOrAtAll)
{
  camera = test::camera_at({2, 3, 5}, {0, 0, 0});
  std::mt19937 random(2);
  std::uniform_real_distribution<double> range(-1.0, 1.0);
  const auto material = test::add_material(scene, glm::vec3(0.5F));
  const auto box = test::add_box_mesh(scene, material);
  const auto square = test::add_square_mesh(scene, material);
  for (int i = 0; i < 60; i++) {
    glm::dmat4 place = glm::translate(glm::dmat4(1), 2.0 * glm::dvec3(range(random), range(random), range(random)));
    place = glm::rotate(place, 3.0 * range(random), glm::normalize(glm::dvec3(range(random), range(random), 0.1)));
    test::add_object(scene, i % 2 == 0 ? box : square, glm::scale(place, glm::dvec3(0.3)));
  }
  // A second mesh, which must not make the node appear twice.
  scene.edit(test::handle_at(scene.nodes(), 0), [&](scene::Node &node) { node.meshes.push_back(square); });
  render_scene->update();
  const reference::Tracer tracer(scene);
  const std::vector<scene::Object> objects = scene.objects();
  const auto nodes_met = [&](std::span<const glm::dvec2> outline, const glm::dvec2 &offset, bool is_through) {
    std::map<std::uint32_t, int> pixels;
    for (int y = 0; y < size_px.y; y++) {
      for (int x = 0; x < size_px.x; x++) {
        if (!is_inside(outline, glm::dvec2(x, y) + 0.5)) {
          continue;
        }
        std::set<std::uint32_t> met;
        reference::Ray ray = ray_through(glm::dvec2(x, y) + offset);
        for (auto hit = tracer.closest(ray, reference::Faces::Drawn); hit;
             hit = is_through ? tracer.closest(ray, reference::Faces::Drawn) : std::nullopt) {
          met.insert(objects[tracer.surface_at(*hit).object].node.index);
          ray.t_min = hit->t + 1e-6;
        }
        for (const std::uint32_t node : met) {
          pixels[node]++;
        }
      }
    }
    return pixels;
  };
  std::size_t found_count = 0;
  std::size_t hidden_count = 0;
  for (int i = 0; i < 9; i++) {
    // Some reach beyond the picture, and those with five corners cross themselves.
    std::vector<glm::dvec2> outline;
    for (int corner = 0; corner < 3 + i % 3; corner++) {
      outline.push_back(glm::dvec2(size_px) * (0.5 + 0.6 * glm::dvec2(range(random), range(random))));
    }
    std::size_t visible_count = 0;
    for (const Reach reach : {Reach::Visible, Reach::Through}) {
      std::set<std::uint32_t> selected;
      for (const auto node : overlay->select(view(), size_px, outline, reach)) {
        EXPECT_TRUE(selected.insert(node.index).second) << "twice";
      }
      // The device rounds edges to parts of a pixel.
      std::map<std::uint32_t, int> possible;
      for (const glm::dvec2 &offset :
           {glm::dvec2(0), glm::dvec2(0.02, 0), glm::dvec2(-0.02, 0), glm::dvec2(0, 0.02), glm::dvec2(0, -0.02)}) {
        for (const auto &[node, count] : nodes_met(outline, offset, reach == Reach::Through)) {
          possible[node] += count;
        }
      }
      for (const auto &[node, count] : possible) {
        EXPECT_TRUE(count < 15 || selected.contains(node)) << i << ": " << node << " has " << count / 5 << " pixels";
      }
      for (const std::uint32_t node : selected) {
        EXPECT_TRUE(possible.contains(node)) << i << ": " << node;
      }
      found_count += selected.size();
      hidden_count += reach == Reach::Through ? selected.size() - visible_count : 0;
      visible_count = selected.size();
    }
  }
  EXPECT_GT(found_count, 100U);
  EXPECT_GT(hidden_count, 20U);
}

TEST_F(OverlayGpuTest, AnAreaSelectsTheNodesThatAreWhollyInsideWhateverCoversThem)
{
  camera = test::camera_at({2, 3, 5}, {0, 0, 0});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> range(-1.0, 1.0);
  const auto box = test::add_box_mesh(scene, test::add_material(scene, glm::vec3(0.5F)));
  for (int i = 0; i < 60; i++) {
    glm::dmat4 place = glm::translate(glm::dmat4(1), 2.5 * glm::dvec3(range(random), range(random), range(random)));
    place = glm::rotate(place, 3.0 * range(random), glm::normalize(glm::dvec3(range(random), range(random), 0.1)));
    test::add_object(scene, box, glm::scale(place, glm::dvec3(0.3)));
  }
  render_scene->update();
  // By how many pixels all corners of a box are inside of the area, or the farthest one is outside.
  const auto depth_inside = [&](scene::Handle<scene::Node> node, const glm::dvec2 &low, const glm::dvec2 &high) {
    double depth = 1e9;
    for (const glm::vec3 &corner : scene.meshes()[box].positions) {
      const glm::dvec2 at =
          seen(glm::dvec3(scene.world_from_node(node) * glm::dvec4(corner, 1.0))) - glm::dvec2(10, 15);
      depth = std::min({depth, at.x - low.x, at.y - low.y, high.x - at.x, high.y - at.y});
    }
    return depth;
  };
  int whole_count = 0;
  int part_count = 0;
  const glm::dvec2 size(size_px);
  for (int i = 0; i < 12; i++) {
    const glm::dvec2 from = size * (0.5 + 0.6 * glm::dvec2(range(random), range(random)));
    const glm::dvec2 to = size * (0.5 + 0.6 * glm::dvec2(range(random), range(random)));
    for (const Reach reach : {Reach::Visible, Reach::Through}) {
      const auto found = overlay->select(view(), size_px, rectangle(from, to), reach);
      const auto whole = overlay->select(view(), size_px, rectangle(from, to), reach, Extent::Whole);
      for (const auto node : whole) {
        EXPECT_EQ(std::ranges::count(found, node), 1);
        EXPECT_EQ(std::ranges::count(whole, node), 1);
      }
      for (const auto node : found) {
        const glm::dvec2 low = glm::max(glm::min(from, to), glm::dvec2(0.0));
        const double depth = depth_inside(node, low, glm::min(glm::max(from, to), size));
        const bool is_whole = std::ranges::count(whole, node) == 1;
        // A pixel of rounding, and corners that are less than two pixels thin where they meet a pixel's middle.
        EXPECT_TRUE(depth < 1.0 || is_whole) << i << ": " << node.index << " is " << depth << " pixels inside";
        EXPECT_TRUE(depth > -4.0 || !is_whole) << i << ": " << node.index << " is " << -depth << " pixels outside";
        whole_count += is_whole ? 1 : 0;
        part_count += depth <= -4.0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(whole_count, 20);
  EXPECT_GT(part_count, 20);
}

TEST_F(OverlayGpuTest, ANodeIsNotWhollyInsideOfALassoThatLeavesItsMiddleOutOrBeyondThePicture)
{
  const auto material = test::add_material(scene, glm::vec3(0.5F));
  const auto back = add_square(0, material);
  // A second mesh beside the first, which covers nothing of it.
  const auto front = add_square(1, material, 0.3);
  render_scene->update();
  using Nodes = std::vector<scene::Handle<scene::Node>>;
  const glm::dvec2 size(size_px);
  const auto whole = [&](std::span<const glm::dvec2> outline, Reach reach = Reach::Visible) {
    return overlay->select(view(), size_px, outline, reach, Extent::Whole);
  };
  const auto all = rectangle({0, 0}, size);
  EXPECT_EQ(whole(all), (Nodes{back, front}));
  // Around all corners of both, without the middle of the picture.
  const std::vector<glm::dvec2> notched = {{0, 0}, {29, 0}, {29, 30}, {31, 30}, {31, 0}, {60, 0}, {60, 40}, {0, 40}};
  EXPECT_EQ(overlay->select(view(), size_px, notched, Reach::Through), (Nodes{back, front}));
  EXPECT_EQ(whole(notched, Reach::Through), Nodes());
  // The front covers the part of the back that is in the area, and the back's rest is outside.
  const glm::dvec2 corner = seen({0.6, 0.6, 0}) - glm::dvec2(10, 15);
  const auto middle = rectangle(size - corner, corner);
  EXPECT_EQ(whole(middle, Reach::Through), Nodes{front});
  const auto world = scene.world_from_node(front);
  const double pixels_per_metre = seen({1, 0, 1}).x - seen({0, 0, 1}).x;
  scene.edit(front, [&](scene::Node &node) { node.parent_from_node[3].x = 0.5 * size.x / pixels_per_metre; });
  render_scene->update();
  EXPECT_EQ(overlay->select(view(), size_px, rectangle({-1e3, -1e3}, {1e3, 1e3}), Reach::Visible),
            (Nodes{back, front}));
  EXPECT_EQ(whole(rectangle({-1e3, -1e3}, {1e3, 1e3})), Nodes{back}) << "the front reaches beyond the picture";
  // A node with two meshes is inside if both are.
  scene.edit(front, [&](scene::Node &node) {
    node.parent_from_node = world;
    node.meshes.push_back(scene.nodes()[back].meshes.front());
    node.parent_from_node[0] *= 2.0;
  });
  render_scene->update();
  EXPECT_EQ(whole(all), (Nodes{back, front}));
  EXPECT_EQ(whole(middle, Reach::Through), Nodes());
}

TEST_F(OverlayGpuTest, ANodeThatReachesBehindAnOrthographicCameraIsNotWhollyInside)
{
  using Nodes = std::vector<scene::Handle<scene::Node>>;
  const auto material = test::add_material(scene, glm::vec3(0.5F));
  scene.edit(material, [](scene::Material &value) { value.is_double_sided = true; });
  const auto box = test::add_object(scene, test::add_box_mesh(scene, material), glm::dmat4(1));
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = 6.0F;
  camera.half_height = 4.0F;
  const auto found = [&](Extent extent) {
    render_scene->update();
    return overlay->select(view(), size_px, rectangle({0, 0}, glm::dvec2(size_px)), Reach::Visible, extent);
  };
  EXPECT_EQ(found(Extent::Whole), Nodes{box});
  // Its far half is seen from the inside.
  scene.edit(box, [](scene::Node &node) { node.parent_from_node[2].z = 20.0; });
  EXPECT_EQ(found(Extent::Part), Nodes{box});
  EXPECT_EQ(found(Extent::Whole), Nodes());
}

TEST_F(OverlayGpuTest, VerticesOfNoTriangleDoNotKeepANodeFromAnArea)
{
  const auto square = add_square(0, test::add_material(scene, glm::vec3(0.5F)));
  scene::Mesh mesh = scene.meshes()[scene.nodes()[square].meshes.front()];
  mesh.positions.emplace_back(100.0F, 0.0F, 0.0F);
  mesh.normals.emplace_back(mesh.normals.front());
  if (!mesh.uvs.empty()) {
    mesh.uvs.emplace_back(0.0F);
  }
  scene.replace(scene.nodes()[square].meshes.front(), std::move(mesh));
  render_scene->update();
  EXPECT_EQ(overlay->select(view(), size_px, rectangle({0, 0}, glm::dvec2(size_px)), Reach::Visible, Extent::Whole),
            std::vector{square});
}

TEST_F(OverlayGpuTest, AnAreaWithinAHoleOfAMaskOrWithoutAPixelSelectsNothingOfIt)
{
  const auto masked = add_mask();
  const auto front = add_square(0, masked);
  const auto back = add_square(-1, test::add_material(scene, glm::vec3(0.5F)));
  render_scene->update();
  using Nodes = std::vector<scene::Handle<scene::Node>>;
  const auto selected = [&](const glm::dvec2 &from, const glm::dvec2 &to, Reach reach) {
    return overlay->select(view(), size_px, rectangle(from, to), reach);
  };
  const glm::dvec2 middle = 0.5 * glm::dvec2(size_px);
  EXPECT_EQ(selected(middle - 4.0, middle - 1.0, Reach::Visible), Nodes{back});
  EXPECT_EQ(selected(middle - 4.0, middle - 1.0, Reach::Through), Nodes{back});
  EXPECT_EQ(selected(middle + 1.0, middle + 4.0, Reach::Visible), Nodes{front});
  EXPECT_EQ(selected(middle + 1.0, middle + 4.0, Reach::Through), (Nodes{front, back}));
  EXPECT_EQ(selected(glm::dvec2(-1e9), glm::dvec2(1e9), Reach::Visible), (Nodes{front, back}));
  EXPECT_EQ(selected(middle + 1.0, middle + 1.4, Reach::Visible), Nodes()) << "the middle of no pixel";
  EXPECT_EQ(selected(glm::dvec2(-5), glm::dvec2(-1), Reach::Through), Nodes()) << "beside the picture";
  EXPECT_THROW(selected(glm::dvec2(NAN), middle, Reach::Visible), gpu::Error);
}

TEST_F(OverlayGpuTest, PixelsOutsideOfThePictureHaveNothingAndEditsWithoutAnUpdateAreAnError)
{
  const auto square = add_square(0, test::add_material(scene, glm::vec3(0.5F)), 100.0);
  for (const glm::ivec2 pixel : {glm::ivec2(0, 0), size_px - 1}) {
    EXPECT_EQ(pick(pixel.x, pixel.y)->node, square);
  }
  for (const glm::ivec2 pixel :
       {glm::ivec2(-1, 5), glm::ivec2(5, -1), glm::ivec2(size_px.x, 5), glm::ivec2(5, size_px.y)}) {
    EXPECT_FALSE(pick(pixel.x, pixel.y)) << pixel.x << ", " << pixel.y;
  }
  scene.remove(square);
  EXPECT_THROW(static_cast<void>(overlay->pick(view(), size_px, {5, 5})), gpu::Error);
  EXPECT_FALSE(pick(5, 5));
}

TEST_F(OverlayGpuTest, NothingIsMadeBeforeAPixelCanSeeAnObject)
{
  set_up_on_new_device();
  const auto node = add_square(0, test::add_material(scene, glm::vec3(0.5F)), 0.1);
  EXPECT_FALSE(pick(0, 0));
  outline({});
  EXPECT_EQ(device->counters().shaders_made, 0U);
  EXPECT_EQ(device->memory_bytes(), 0U);
  EXPECT_EQ(picked(), node);
  EXPECT_EQ(device->counters().shaders_made, 1U);
}

TEST_F(OverlayGpuTest, AnOutlineFollowsTheEdgeOfTheSelectedObjectAloneAlsoWhereAnotherHidesIt)
{
  const auto material = test::add_material(scene, glm::vec3(0.5F));
  const auto square = add_square(0, material);
  add_square(1, material, 0.9);
  const test::Picture picture = outline(std::span(&square, 1));
  // Half the square's edge in pixels: 1 m at 5 m, with 20 pixels for the tangent of half the angle.
  const double half_px = 20.0 / (5.0 * std::tan(0.5 * double(camera.vertical_angle)));
  const glm::dvec2 middle = glm::dvec2(10, 15) + 0.5 * glm::dvec2(size_px);
  int line_count = 0;
  for (int y = 0; y < 60; y++) {
    for (int x = 0; x < 80; x++) {
      const glm::dvec2 from_middle = glm::abs(glm::dvec2(x, y) + 0.5 - middle);
      const double from_edge = std::max(from_middle.x, from_middle.y) - half_px;
      const glm::vec4 pixel = picture.at(x, y);
      // A line of two whole pixels at each side of the edge, the outer ones of half the strength.
      if (std::abs(from_edge) > 2.5) {
        EXPECT_EQ(pixel, glm::vec4(0)) << x << ", " << y;
      }
      else if (std::abs(from_edge) < 0.4 && std::min(from_middle.x, from_middle.y) < half_px - 3.0) {
        EXPECT_EQ(pixel, line_color) << x << ", " << y;
        line_count++;
      }
    }
  }
  EXPECT_GT(line_count, 20);
}

TEST_F(OverlayGpuTest, AnOutlineEndsAtTheEdgeOfThePicture)
{
  const auto square = add_square(0, test::add_material(scene, glm::vec3(0.5F)), 100.0);
  for (const glm::vec4 &pixel : outline(std::span(&square, 1)).pixels) {
    EXPECT_EQ(pixel, glm::vec4(0)) << "all of the picture is inside of the object";
  }
}

TEST_F(OverlayGpuTest, ALineHasItsColorAndItsWidthOnTheScreenAtEveryDistanceBetweenItsEnds)
{
  for (const double z : {0.0, 2.5}) {
    for (const float width : {1.0F, 3.0F}) {
      const Line line{{-0.7, 0.3, z}, {0.6, 0.3, z}, line_color, width};
      const test::Picture picture = lines({line});
      const glm::dvec2 from = seen(line.from_ws);
      const glm::dvec2 to = seen(line.to_ws);
      ASSERT_GT(to.x - from.x, 8.0);
      for (int x = 0; x < 80; x++) {
        double covered_px = 0.0;
        for (int y = 0; y < 60; y++) {
          const glm::vec4 pixel = picture.at(x, y);
          covered_px += double(pixel.a);
          EXPECT_EQ(glm::vec3(pixel), pixel.a * glm::vec3(line_color));
          EXPECT_TRUE(pixel.a == 0.0F || std::abs(y + 0.5 - from.y) <= 0.5 * double(width) + 1.0) << x << ", " << y;
        }
        if (x + 0.5 > from.x && x + 0.5 < to.x) {
          EXPECT_NEAR(covered_px, double(width), 1e-3) << x;
        }
        else {
          EXPECT_EQ(covered_px, 0.0) << x;
        }
      }
    }
  }
}

TEST_F(OverlayGpuTest, ObjectsHideLinesBehindThemThatAreNotOnTop)
{
  const auto square = add_square(0, test::add_material(scene, glm::vec3(0.5F)), 0.5);
  const auto line = [](double z, bool is_on_top) {
    return Line{{-0.9, 0, z}, {0.9, 0, z}, line_color, 1.0F, is_on_top};
  };
  const auto middle = [&](const test::Picture &picture) { return picture.at(10 + 30, 15 + 20).a; };
  const auto beside = [&](const test::Picture &picture) { return picture.at(int(seen({-0.8, 0, 0}).x), 15 + 20).a; };
  const test::Picture behind = lines({line(-0.1, false)});
  EXPECT_EQ(middle(behind), 0.0F);
  EXPECT_GT(beside(behind), 0.4F);
  EXPECT_GT(middle(lines({line(0.1, false)})), 0.4F) << "before the object";
  EXPECT_GT(middle(lines({line(0.0, false)})), 0.4F) << "on the object";
  EXPECT_GT(middle(lines({line(-0.1, true)})), 0.4F) << "on top";
  // Draw both kinds of lines in one call.
  EXPECT_GT(middle(lines({line(-0.1, true), line(-0.2, false)})), 0.4F);
  // The overlay uses the current state of the objects.
  scene.set_transform(square, glm::translate(glm::dmat4(1), {0, 5, 0}));
  EXPECT_GT(middle(lines({line(-0.1, false)})), 0.4F) << "the object has moved";
}

TEST_F(OverlayGpuTest, ALineThatBeginsBehindTheEyeIsDrawnFromTheNearPlaneOn)
{
  // Below the eye, from behind it to far away: it comes from the lower edge and ends near the middle.
  const test::Picture picture = lines({{{0, -0.5, 20}, {0, -0.5, -400}, line_color, 2.0F}});
  const int end_y = int(seen({0, -0.5, -400}).y);
  for (int y = 0; y < 60; y++) {
    const float alpha = picture.at(10 + 30, y).a;
    if (y >= 15 && y < end_y - 1) {
      EXPECT_GT(alpha, 0.9F) << y;
    }
    else if (y < 15 || y > end_y + 1) {
      EXPECT_EQ(alpha, 0.0F) << y;
    }
  }
  for (const glm::vec4 &pixel : lines({{{1, 0, 20}, {-1, 0, 7}, line_color, 2.0F}}).pixels) {
    EXPECT_EQ(pixel, glm::vec4(0)) << "all of it is behind the eye";
  }
}

TEST_F(OverlayGpuTest, NothingIsMadeWithoutLinesAndLinesOnTopDrawNoObject)
{
  set_up_on_new_device();
  add_square(0, test::add_material(scene, glm::vec3(0.5F)));
  // Drawing without lines creates nothing.
  lines({});
  EXPECT_EQ(device->counters().shaders_made, 0U);
  EXPECT_EQ(device->memory_bytes(), 0U);
  lines({{{-1, 0, 0}, {1, 0, 0}, line_color, 1.0F, true}});
  EXPECT_EQ(device->counters().shaders_made, 1U);
  EXPECT_EQ(runs("overlay objects"), 0U);
  // Objects are drawn for the first picture alone.
  for (int i = 0; i < 3; i++) {
    lines({{{-1, 0, 0}, {1, 0, 0}}});
  }
  EXPECT_EQ(runs("overlay objects"), 1U);
}

TEST_F(OverlayGpuTest, LinesThatAreNotFiniteOrHaveNoWidthAreNamed)
{
  for (const Line &wrong : {Line{{NAN, 0, 0}, {1, 0, 0}}, Line{{0, 0, 0}, {1, INFINITY, 0}},
                            Line{{0, 0, 0}, {1, 0, 0}, line_color, 0.0F}}) {
    try {
      lines({{{0, 0, 0}, {1, 0, 0}}, wrong});
      ADD_FAILURE();
    }
    catch (const gpu::Error &error) {
      EXPECT_NE(std::string_view(error.what()).find("line 1 "), std::string_view::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace gnomon::overlay
