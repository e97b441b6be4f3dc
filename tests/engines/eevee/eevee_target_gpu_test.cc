// SPDX-License-Identifier: MIT
// Pictures in a host's framebuffers, within its context.
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"

#include "gpu/gpu_host_framebuffer.hh"
#include "gpu/gpu_testing.hh"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <set>

namespace gnomon::eevee {
namespace {

using test::HostPicture;
using test::Pixels;

constexpr glm::ivec2 target_size_px(24, 18);
constexpr glm::ivec2 host_size_px(37, 29);
constexpr glm::ivec2 origin_px(7, 5);
constexpr gpu::Rectangle rectangle{origin_px, target_size_px};
constexpr glm::dvec3 eye(0, -5, 4);

class TargetGpuTest : public test::HostFramebufferTest {
 protected:
  void SetUp() override
  {
    HostFramebufferTest::SetUp();
    const auto plain = test::add_material(scene, {0.8F, 0.5F, 0.2F});
    test::add_object(scene, test::add_square_mesh(scene, plain), glm::scale(glm::dmat4(1), glm::dvec3(2)));
    test::add_object(scene, test::add_box_mesh(scene, plain),
                     glm::scale(glm::translate(glm::dmat4(1), {0.3, 0, 0.5}), glm::dvec3(0.5)));
    test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0.3F, 0.5F, -1}, 3.0F);
  }
  static draw::Target target_of(const HostPicture &host, draw::Encoding encoding)
  {
    draw::Target target;
    target.framebuffer = host.framebuffer();
    target.origin_px = origin_px;
    target.encoding = encoding;
    return target;
  }
  /** The whole picture as an 8-bit display shows it. */
  Pixels offline()
  {
    const draw::TargetTexture display(*device, "display", gpu::Format::RGBA8, target_size_px);
    SceneRenderer renderer(*device, scene, target_size_px, settings);
    renderer.sync();
    renderer.draw(camera, {}, display.target());
    return {target_size_px, gpu::read_as<std::array<std::uint8_t, 4>>(*device, display.texture())};
  }
  /** The largest difference of a byte within the rectangle. */
  static int difference(const Pixels &pixels, const Pixels &picture)
  {
    int largest = 0;
    for (int y = 0; y < target_size_px.y; y++) {
      for (int x = 0; x < target_size_px.x; x++) {
        const std::array<int, 4> a = pixels.at(origin_px.x + x, origin_px.y + y);
        const std::array<int, 4> b = picture.at(x, y);
        for (std::size_t c = 0; c < 4; c++) {
          largest = std::max(largest, std::abs(a[c] - b[c]));
        }
      }
    }
    return largest;
  }

  scene::Scene scene;
  scene::PlacedCamera camera = test::camera_at(eye, {0, 0, 0}, 0.6F);
  const Settings settings{.shadow = {.map_size_px = 256}, .sample_count = 4};
};

INSTANTIATE_TEST_SUITE_P(, TargetGpuTest, testing::Values(test::HostKind::Egl, test::HostKind::Glx),
                         test::name_of_host);

TEST_P(TargetGpuTest, AFramebufferThatChangesEveryFrameGetsThePictureAndKeepsTheRest)
{
  const Pixels truth = offline();
  ASSERT_GT(truth.at(target_size_px.x / 2, 2)[0], 100);
  SceneRenderer renderer(*device, scene, target_size_px, settings);
  renderer.sync();
  std::vector<std::unique_ptr<HostPicture>> hosts;
  for (int frame = 0; frame < 6; frame++) {
    const HostPicture &host = *hosts.emplace_back(std::make_unique<HostPicture>(host_size_px, GL_SRGB8_ALPHA8, 4));
    const Pixels before = host.pixels();
    const auto encoding = frame % 2 == 0 ? draw::Encoding::SrgbFormat : draw::Encoding::Display;
    const bool is_complete = renderer.draw_sample(camera, target_of(host, encoding));
    EXPECT_EQ(is_complete, frame >= 3);
    const Pixels pixels = host.pixels();
    test::expect_equal_outside(rectangle, pixels, before);
    if (is_complete) {
      // The driver's sRGB table and the shader's formula differ by one step of 255.
      EXPECT_LE(difference(pixels, truth), encoding == draw::Encoding::Display ? 0 : 1) << "frame " << frame;
    }
    else {
      // The middle of a plane is equal in all samples, and therefore in their mean.
      const std::array<int, 4> middle = pixels.at(origin_px.x + target_size_px.x / 2, origin_px.y + 2);
      for (std::size_t c = 0; c < 4; c++) {
        EXPECT_NEAR(middle[c], truth.at(target_size_px.x / 2, 2)[c], 1) << "frame " << frame;
      }
    }
  }
  EXPECT_NE(hosts[0]->framebuffer().name, hosts[5]->framebuffer().name);
}

TEST_P(TargetGpuTest, PreviewsAndPartsWithinABudgetKeepTheRest)
{
  const Pixels truth = offline();
  SceneRenderer renderer(*device, scene, target_size_px, settings);
  std::unique_ptr<HostPicture> last;
  std::set<BudgetReport::Kind> kinds;
  bool is_complete = false;
  for (int frame = 0; !is_complete && frame < 300; frame++) {
    const bool is_srgb = frame % 2 == 0;
    // The last one is deleted after the next is made, so that it has another name.
    auto host = is_srgb ? std::make_unique<HostPicture>(host_size_px, GL_SRGB8_ALPHA8, 4)
                        : std::make_unique<HostPicture>(host_size_px, GL_RGBA8, 0);
    ASSERT_TRUE(!last || host->framebuffer().name != last->framebuffer().name);
    const Pixels before = host->pixels();
    draw::Target target = target_of(*host, is_srgb ? draw::Encoding::SrgbFormat : draw::Encoding::Display);
    target.depth = draw::HostDepth{.clip_from_view = glm::perspectiveRH_NO(0.6, 4.0 / 3.0, 0.5, 1000.0)};
    // The least time, until the preview has given way to the first sample. Then all that is left, in one call.
    const bool is_refining = kinds.contains(BudgetReport::Kind::Refining);
    is_complete =
        renderer.draw_within(is_refining ? BudgetController::budget_max : BudgetController::budget_min, camera, target);
    kinds.insert(renderer.budget_report().kind);
    const Pixels pixels = host->pixels();
    test::expect_equal_outside(rectangle, pixels, before);
    test::expect_drawn_inside(rectangle, pixels, before);
    if (!is_srgb) {
      test::expect_filled_depth_outside(rectangle, host->depths(), host_size_px);
    }
    if (is_complete) {
      // The driver's sRGB table and the shader's formula differ by one step of 255.
      EXPECT_LE(difference(pixels, truth), is_srgb ? 1 : 0);
    }
    last = std::move(host);
  }
  EXPECT_TRUE(is_complete);
  EXPECT_EQ(kinds.size(), 3U) << "previews, parts and the complete picture";
}

TEST_P(TargetGpuTest, SceneLinearIsTheRadiance)
{
  SceneRenderer renderer(*device, scene, target_size_px, settings);
  renderer.sync();
  const draw::TargetTexture linear(*device, "linear", gpu::Format::RGBA32F, target_size_px);
  draw::Target target = linear.target();
  target.encoding = draw::Encoding::SceneLinear;
  target.exposure = 3.0F;
  renderer.draw(camera, {}, target);
  EXPECT_EQ(device->read(linear.texture()), device->read(renderer.engine().radiance(renderer.viewport())));
}

/** A host's program that draws everything at one distance. */
class HostProgram {
 public:
  HostProgram()
  {
    const auto compile = [&](GLenum kind, const char *text) {
      const GLuint shader = glCreateShader(kind);
      glShaderSource(shader, 1, &text, nullptr);
      glCompileShader(shader);
      glAttachShader(name_, shader);
      glDeleteShader(shader);
    };
    compile(GL_VERTEX_SHADER, R"(#version 450 core
layout(location = 0) uniform mat4 clip_from_view;
layout(location = 1) uniform float distance;
void main()
{
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
  gl_Position = clip_from_view * vec4(corner * 100.0, -distance, 1.0);
})");
    compile(GL_FRAGMENT_SHADER, R"(#version 450 core
layout(location = 0) out vec4 color;
void main()
{
  color = vec4(1, 0, 1, 1);
})");
    glLinkProgram(name_);
    glCreateVertexArrays(1, &vertex_array_);
  }
  ~HostProgram()
  {
    glDeleteProgram(name_);
    glDeleteVertexArrays(1, &vertex_array_);
  }
  HostProgram(const HostProgram &) = delete;
  HostProgram &operator=(const HostProgram &) = delete;
  void draw(const glm::mat4 &clip_from_view, float distance, GLenum function) const
  {
    glUseProgram(name_);
    glBindVertexArray(vertex_array_);
    glUniformMatrix4fv(0, 1, GL_FALSE, glm::value_ptr(clip_from_view));
    glUniform1f(1, distance);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(function);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glUseProgram(0);
    glBindVertexArray(0);
  }

 private:
  GLuint name_ = glCreateProgram();
  GLuint vertex_array_ = 0;
};

TEST_P(TargetGpuTest, TheHostsGeometryIsHiddenByWhatIsNearer)
{
  // A floor to the horizon: its distance along the view is known in every pixel.
  test::remove_objects(scene);
  const auto plain = test::add_material(scene, {0.8F, 0.5F, 0.2F});
  test::add_object(scene, test::add_square_mesh(scene, plain), glm::scale(glm::dmat4(1), glm::dvec3(200)));
  SceneRenderer renderer(*device, scene, target_size_px, settings);
  renderer.sync();
  const draw::View view = renderer.view_of(camera);
  const double tan_y = 1.0 / double(view.clip_from_view()[1][1]);
  const double aspect = double(target_size_px.x) / double(target_size_px.y);
  const double angle = 2.0 * std::atan(tan_y);
  glm::dmat4 reversed(0.0);
  reversed[0][0] = 1.0 / (tan_y * aspect);
  reversed[1][1] = 1.0 / tan_y;
  reversed[2][3] = -1.0;
  reversed[3][2] = 0.05;
  const HostProgram program;
  for (const bool is_reversed : {false, true}) {
    const draw::HostDepth depth{
        .clip_from_view = is_reversed ? reversed : glm::perspectiveRH_NO(angle, aspect, 0.5, 1000.0),
        .is_zero_to_one = is_reversed};
    const HostPicture host(host_size_px, GL_RGBA8, 0);
    host.clear_depth(is_reversed ? 0.0F : 1.0F);
    draw::Target target = target_of(host, draw::Encoding::Display);
    target.depth = depth;
    renderer.draw(camera, {}, target);
    const Pixels picture = host.pixels();
    const std::vector<float> depths = host.depths();
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, host.framebuffer().name);
    glViewport(origin_px.x, origin_px.y, target_size_px.x, target_size_px.y);
    glClipControl(GL_LOWER_LEFT, is_reversed ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
    constexpr float host_distance = 6.5F;
    program.draw(glm::mat4(depth.clip_from_view), host_distance, is_reversed ? GL_GREATER : GL_LESS);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    const Pixels composed = host.pixels();
    test::expect_equal_outside(rectangle, composed, picture);
    int hidden = 0;
    for (int y = 0; y < target_size_px.y; y++) {
      for (int x = 0; x < target_size_px.x; x++) {
        const glm::dvec2 ndc = 2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(target_size_px) - 1.0;
        const glm::dvec3 along_vs(ndc.x * tan_y * aspect, ndc.y * tan_y, -1.0);
        const glm::dvec3 along_ws = glm::dmat3(camera.world_from_camera) * along_vs;
        const double distance = eye.z / -along_ws.z;
        const glm::dvec4 clip = depth.clip_from_view * glm::dvec4(0, 0, -distance, 1);
        const double stored = is_reversed ? clip.z / clip.w : 0.5 * clip.z / clip.w + 0.5;
        const glm::ivec2 pixel = origin_px + glm::ivec2(x, y);
        // Depths are interpolated between the corners of a floor of 400 m.
        EXPECT_NEAR(double(depths[std::size_t(pixel.y * host_size_px.x + pixel.x)]), stored, 2e-6) << x << ", " << y;
        const bool is_hidden = distance < double(host_distance);
        hidden += is_hidden ? 1 : 0;
        EXPECT_EQ(composed.at(pixel.x, pixel.y),
                  is_hidden ? picture.at(pixel.x, pixel.y) : (std::array<int, 4>{255, 0, 255, 255}))
            << x << ", " << y << " at " << distance << " m";
      }
    }
    EXPECT_GT(hidden, target_size_px.x * target_size_px.y / 5);
    EXPECT_LT(hidden, target_size_px.x * target_size_px.y * 4 / 5);
    host.clear_depth(0.5F);
    renderer.draw(test::camera_at(eye, eye + glm::dvec3(0, 1, 10), 0.6F), {}, target);
    const float seen = host.depths()[std::size_t((origin_px.y + 1) * host_size_px.x + origin_px.x + 1)];
    EXPECT_EQ(seen, is_reversed ? 0.0F : 1.0F) << "nothing is seen: the host's farthest depth";
  }
}

TEST_P(TargetGpuTest, OverLiesOnTheHostsContentWhereItIsNearer)
{
  SceneRenderer renderer(*device, scene, target_size_px, settings);
  renderer.sync();
  const HostPicture replaced(host_size_px, GL_RGBA8, 0);
  const draw::Target target = target_of(replaced, draw::Encoding::Display);
  renderer.draw(camera, {}, target);
  const Pixels picture = replaced.pixels();

  const HostPicture host(host_size_px, GL_RGBA8, 0);
  const Pixels before = host.pixels();
  draw::Target over = target_of(host, draw::Encoding::Display);
  over.composition = draw::Composition::Over;
  over.depth = draw::HostDepth{.clip_from_view = glm::perspectiveRH_NO(0.6, 4.0 / 3.0, 0.5, 1000.0)};
  host.clear_depth(0.0F);
  renderer.draw_sample(camera, over);
  EXPECT_EQ(host.pixels(), before) << "all of the host's is nearer";
  host.clear_depth(1.0F);
  renderer.draw_sample(camera, over);
  const Pixels pixels = host.pixels();
  test::expect_equal_outside(rectangle, pixels, before);
  int empty = 0;
  for (int y = 0; y < host_size_px.y; y++) {
    for (int x = 0; x < host_size_px.x; x++) {
      if (!test::is_inside(rectangle, x, y)) {
        continue;
      }
      const std::array<int, 4> drawn = picture.at(x, y);
      const bool is_surface = host.depths()[std::size_t(y * host_size_px.x + x)] < 1.0F;
      empty += is_surface ? 0 : 1;
      for (std::size_t c = 0; c < 4; c++) {
        const double expected =
            is_surface ? drawn[c] + (255 - drawn[3]) / 255.0 * before.at(x, y)[c] : before.at(x, y)[c];
        EXPECT_NEAR(pixels.at(x, y)[c], std::min(expected, 255.0), is_surface ? 2 : 0) << x << ", " << y;
      }
    }
  }
  EXPECT_GT(empty, 0);
}

TEST_P(TargetGpuTest, StraightColorsAreThoseOfTheSurfaces)
{
  test::remove_objects(scene);
  const auto glass = test::add_material(scene, glm::vec3(0.0F));
  scene.edit(glass, [](scene::Material &material) {
    material.emissive = {1.5F, 0.5F, 0.0F};
    material.alpha_mode = scene::AlphaMode::Blend;
    material.alpha = 0.25F;
    material.specular = 0.0F;
  });
  test::add_object(scene, test::add_square_mesh(scene, glass), glm::dmat4(1));
  SceneRenderer renderer(*device, scene, target_size_px, settings);
  renderer.sync();
  const draw::TargetTexture display(*device, "display", gpu::Format::RGBA8, target_size_px);
  draw::Target target = display.target();
  target.composition = draw::Composition::ReplaceStraight;
  target.exposure = -1.0F;
  renderer.draw(camera, {}, target);
  const Pixels pixels{target_size_px, gpu::read_as<std::array<std::uint8_t, 4>>(*device, display.texture())};
  // 0.75 and 0.25 by sRGB's transfer function.
  EXPECT_EQ(pixels.at(target_size_px.x / 2, target_size_px.y / 2), (std::array<int, 4>{225, 137, 0, 64}));
  EXPECT_EQ(pixels.at(0, target_size_px.y - 1), (std::array<int, 4>{0, 0, 0, 0}));
  int edge = 0;
  for (int i = 0; i < target_size_px.x * target_size_px.y; i++) {
    const std::array<int, 4> pixel = pixels.at(i % target_size_px.x, i / target_size_px.x);
    edge += pixel[3] > 0 && pixel[3] < 64;
    if (pixel[3] > 0) {
      EXPECT_EQ(pixel[0], 225) << "also where it covers a part of the pixel, " << i;
    }
  }
  EXPECT_GT(edge, 4);
}

TEST_P(TargetGpuTest, BlendedSurfacesLieOverTheHostsContentAndChangeNoDepth)
{
  test::remove_objects(scene);
  const auto glass = test::add_material(scene, glm::vec3(0.0F));
  scene.edit(glass, [](scene::Material &material) {
    material.emissive = {0.9F, 0.4F, 0.1F};
    material.alpha_mode = scene::AlphaMode::Blend;
    material.alpha = 0.6F;
  });
  test::add_object(scene, test::add_square_mesh(scene, glass), glm::scale(glm::dmat4(1), glm::dvec3(200)));
  SceneRenderer renderer(*device, scene, target_size_px, settings);
  renderer.sync();
  const HostPicture replaced(host_size_px, GL_RGBA8, 0);
  renderer.draw(camera, {}, target_of(replaced, draw::Encoding::Display));
  const Pixels picture = replaced.pixels();
  const HostPicture host(host_size_px, GL_RGBA8, 0);
  const Pixels before = host.pixels();
  host.clear_depth(0.25F);
  draw::Target over = target_of(host, draw::Encoding::Display);
  over.composition = draw::Composition::Over;
  over.depth = draw::HostDepth{.clip_from_view = glm::perspectiveRH_NO(0.6, 4.0 / 3.0, 0.5, 1000.0)};
  renderer.draw_sample(camera, over);
  const Pixels pixels = host.pixels();
  test::expect_equal_outside(rectangle, pixels, before);
  EXPECT_TRUE(std::ranges::all_of(host.depths(), [](float depth) { return std::abs(depth - 0.25F) < 1e-6F; }));
  for (int y = origin_px.y; y < origin_px.y + target_size_px.y; y++) {
    for (int x = origin_px.x; x < origin_px.x + target_size_px.x; x++) {
      ASSERT_NEAR(picture.at(x, y)[3], 0.6 * 255.0, 1);
      for (std::size_t c = 0; c < 3; c++) {
        EXPECT_NEAR(pixels.at(x, y)[c], std::min(picture.at(x, y)[c] + 0.4 * before.at(x, y)[c], 255.0), 2);
      }
    }
  }
}

}  // namespace
}  // namespace gnomon::eevee
