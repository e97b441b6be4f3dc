// SPDX-License-Identifier: MIT
// Scenes of which a host has meshes and images on the device.
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"

#include "engines/host_mesh.hh"
#include "gpu/gpu_host_framebuffer.hh"
#include "gpu/gpu_testing.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <memory>
#include <thread>

namespace gnomon::eevee {
namespace {

using test::HostMesh;
using test::without_vertices;

constexpr glm::ivec2 host_picture_size_px(48, 36);

class EeveeHostResourcesTest : public test::HostFramebufferTest {
 protected:
  /** A textured box over a ground, and a point lamp within the box's bounds, a sun and an exponential shadow. */
  void SetUp() override
  {
    HostFramebufferTest::SetUp();
    const auto plain = test::add_material(scene, {0.8F, 0.5F, 0.2F});
    const auto painted = test::add_material(scene, {1, 1, 1});
    texture = test::add_texture(scene, 2, texels);
    scene.edit(painted, [&](scene::Material &value) { value.base_color_texture = texture; });
    ground = test::add_square_mesh(scene, plain);
    box = test::add_box_mesh(scene, painted);
    test::add_object(scene, ground, glm::scale(glm::dmat4(1), glm::dvec3(3)));
    test::add_object(scene, box, glm::scale(glm::translate(glm::dmat4(1), {0.3, 0, 0.6}), glm::dvec3(0.5)));
    test::add_object(scene, box, glm::scale(glm::translate(glm::dmat4(1), {-1.2, 0.4, 0.3}), glm::dvec3(0.3)));
    test::add_lamp(scene, scene::LampKind::Sun, {0, 0, 2}, {0.3F, 0.5F, -1}, 2.0F);
    test::add_lamp(scene, scene::LampKind::Point, {1.5F, -0.5F, 1.5F}, {0, 0, -1}, 4.0F);
    const auto soft = test::add_lamp(scene, scene::LampKind::Point, {-1.5F, -0.5F, 2}, {0, 0, -1}, 4.0F);
    scene.edit(soft, [](scene::Lamp &lamp) { lamp.shadow.kind = scene::ShadowKind::Esm; });
  }
  std::vector<glm::vec4> drawn(SceneRenderer &renderer)
  {
    renderer.sync();
    renderer.draw(camera);
    return renderer.read_picture();
  }
  std::vector<glm::vec4> drawn(const scene::Scene &of)
  {
    SceneRenderer renderer(*device, of, host_picture_size_px, settings);
    return drawn(renderer);
  }

  const std::vector<std::uint8_t> texels = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255};
  scene::Scene scene;
  scene::Handle<scene::Texture> texture;
  scene::Handle<scene::Mesh> ground;
  scene::Handle<scene::Mesh> box;
  scene::PlacedCamera camera = test::camera_at({0, -5, 4}, {0, 0, 0}, 0.6F);
  const Settings settings{.shadow = {.map_size_px = 256}, .sample_count = 4};
};

INSTANTIATE_TEST_SUITE_P(, EeveeHostResourcesTest, testing::Values(test::HostKind::Egl, test::HostKind::Glx),
                         test::name_of_host);

TEST_P(EeveeHostResourcesTest, MeshesInTheHostsBuffersGiveThePictureOfUploadedOnes)
{
  const std::vector<glm::vec4> truth = drawn(scene);
  const HostMesh host_ground(scene.meshes()[ground]);
  const HostMesh host_box(scene.meshes()[box]);
  scene::Scene host_scene = scene;
  host_scene.replace(ground, without_vertices(scene.meshes()[ground]));
  host_scene.replace(box, without_vertices(scene.meshes()[box]));
  SceneRenderer renderer(*device, host_scene, host_picture_size_px, settings);
  EXPECT_NE(drawn(renderer), truth) << "nothing is drawn before the host names its buffers";
  renderer.render_scene().set_host_batch(ground, host_ground.batch);
  renderer.render_scene().set_host_batch(box, host_box.batch);
  EXPECT_EQ(drawn(renderer), truth);
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_P(EeveeHostResourcesTest, OtherContentRedrawsShadowsAndRestartsThePicture)
{
  const scene::Mesh before = scene.meshes()[box];
  scene::Mesh after = before;
  for (glm::vec3 &position : after.positions) {
    position.x *= 0.5F;
  }
  const HostMesh host_box(before);
  scene::Scene host_scene = scene;
  host_scene.replace(box, without_vertices(before));
  SceneRenderer renderer(*device, host_scene, host_picture_size_px, settings);
  renderer.render_scene().set_host_batch(box, host_box.batch);
  EXPECT_EQ(drawn(renderer), drawn(scene));
  EXPECT_TRUE(renderer.draw_sample(camera)) << "the picture is complete";
  host_box.write(after);
  renderer.render_scene().set_host_batch(box, host_box.batch);
  renderer.sync();
  EXPECT_FALSE(renderer.draw_sample(camera)) << "the picture is that of the old content";
  // The bounds may be larger than the shape, as they are where a host deforms it. Sizes of shadows follow from them.
  scene::Scene truth = scene;
  truth.replace(box, after);
  const std::vector<glm::vec4> expected = drawn(truth);
  const std::vector<glm::vec4> picture = drawn(renderer);
  std::size_t different = 0;
  for (std::size_t i = 0; i < picture.size(); i++) {
    different += glm::distance(picture[i], expected[i]) > 0.02F ? 1 : 0;
  }
  EXPECT_LT(different, picture.size() / 100);
  // With bounds of the new shape, the pictures are the same.
  scene::Mesh fitted = without_vertices(before);
  fitted.host_shape->bounds = truth.meshes()[box].bounds;
  host_scene.replace(box, fitted);
  EXPECT_EQ(drawn(renderer), expected);
  renderer.render_scene().set_host_batch(box, std::nullopt);
  scene::Scene empty = scene;
  for (const scene::Object &object : scene.objects()) {
    if (object.mesh == box) {
      empty.remove(object.node);
    }
  }
  EXPECT_EQ(drawn(renderer), drawn(empty));
}

TEST_P(EeveeHostResourcesTest, ATextureOfTheHostGivesThePictureOfAnUploadedImage)
{
  const std::vector<glm::vec4> truth = drawn(scene);
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  // One level of a texture that may have more is incomplete for a sampler that reads others.
  glBindTexture(GL_TEXTURE_2D, name);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, 2, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  glBindTexture(GL_TEXTURE_2D, 0);
  scene::Scene host_scene = scene;
  const scene::Handle<scene::Image> image = scene.textures()[texture].image;
  host_scene.replace(image, scene::Image{"stand-in", 1, 1, {0, 0, 0, 255}});
  host_scene.edit(texture, [](scene::Texture &value) { value.mip = scene::MipFilter::Linear; });
  SceneRenderer renderer(*device, host_scene, host_picture_size_px, settings);
  EXPECT_NE(drawn(renderer), truth);
  renderer.render_scene().set_host_texture(image, gpu::HostTexture{name, {2, 2}});
  EXPECT_EQ(drawn(renderer), truth);
  // Other texels: the pictures differ, and the picture before comes back with them.
  constexpr std::array<std::uint8_t, 4> black = {0, 0, 0, 255};
  glClearTexImage(name, 0, GL_RGBA, GL_UNSIGNED_BYTE, black.data());
  renderer.render_scene().set_host_texture(image, gpu::HostTexture{name, {2, 2}});
  const std::vector<glm::vec4> dark = drawn(renderer);
  renderer.render_scene().set_host_texture(image, std::nullopt);
  EXPECT_EQ(drawn(renderer), dark) << "of the black stand-in";
  glDeleteTextures(1, &name);
  EXPECT_EQ(drawn(renderer), dark);
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_P(EeveeHostResourcesTest, ShadowsFollowTheMaskInATextureOfTheHost)
{
  const auto set_mask = [&](const std::vector<std::uint8_t> &values) {
    const scene::Handle<scene::Image> image = scene.textures()[texture].image;
    scene.replace(image, scene::Image{"image", 2, 2, values});
  };
  const scene::Handle<scene::Material> painted = scene.meshes()[box].material;
  scene.edit(painted, [](scene::Material &value) { value.alpha_mode = scene::AlphaMode::Mask; });
  std::vector<std::uint8_t> left = texels;
  left[7] = left[15] = 0;
  std::vector<std::uint8_t> right = texels;
  right[3] = right[11] = 0;
  set_mask(left);
  const std::vector<glm::vec4> left_truth = drawn(scene);
  set_mask(right);
  const std::vector<glm::vec4> right_truth = drawn(scene);
  EXPECT_NE(left_truth, right_truth);

  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  glTextureStorage2D(name, 1, GL_SRGB8_ALPHA8, 2, 2);
  const auto write = [&](const std::vector<std::uint8_t> &values) {
    glTextureSubImage2D(name, 0, 0, 0, 2, 2, GL_RGBA, GL_UNSIGNED_BYTE, values.data());
  };
  // The stand-in is transparent, so that the mask has an effect.
  const scene::Handle<scene::Image> image = scene.textures()[texture].image;
  scene.replace(image, scene::Image{"stand-in", 1, 1, {0, 0, 0, 0}});
  SceneRenderer renderer(*device, scene, host_picture_size_px, settings);
  const gpu::HostTexture host{name, {2, 2}};
  write(left);
  renderer.render_scene().set_host_texture(image, host);
  EXPECT_EQ(drawn(renderer), left_truth);
  write(right);
  renderer.render_scene().set_host_texture(image, host);
  EXPECT_EQ(drawn(renderer), right_truth);
  glDeleteTextures(1, &name);
}

TEST_P(EeveeHostResourcesTest, ABudgetedPictureConvergesToTheWholeOne)
{
  const std::vector<glm::vec4> truth = drawn(scene);
  const HostMesh host_box(scene.meshes()[box]);
  scene::Scene host_scene = scene;
  host_scene.replace(box, without_vertices(scene.meshes()[box]));
  SceneRenderer renderer(*device, host_scene, host_picture_size_px, settings);
  renderer.render_scene().set_host_batch(box, host_box.batch);
  // The smallest budget draws a preview first.
  int calls = 1;
  while (!renderer.draw_within(1e-3, camera) && calls < 1000) {
    calls++;
  }
  EXPECT_GT(calls, 1);
  EXPECT_EQ(renderer.read_picture(), truth);
}

TEST_P(EeveeHostResourcesTest, BuffersThatAreTooSmallAreNamedAndTheNextSyncIsWhole)
{
  const HostMesh host_box(scene.meshes()[box]);
  scene::Scene host_scene = scene;
  host_scene.replace(box, without_vertices(scene.meshes()[box]));
  SceneRenderer renderer(*device, host_scene, host_picture_size_px, settings);
  gpu::HostBatch wrong = host_box.batch;
  wrong.vertex_count = 1000;
  renderer.render_scene().set_host_batch(box, wrong);
  test::expect_contains(test::error_of([&] { drawn(renderer); }), "batch 'box': buffer");
  renderer.render_scene().set_host_batch(box, host_box.batch);
  EXPECT_EQ(drawn(renderer), drawn(scene));
}

TEST_P(EeveeHostResourcesTest, FramesThatAnotherThreadPreparesDrawThemUntilTheirSubmission)
{
  const std::vector<glm::vec4> truth = drawn(scene);
  auto host_box = std::make_unique<HostMesh>(scene.meshes()[box]);
  scene::Scene host_scene = scene;
  host_scene.replace(box, without_vertices(scene.meshes()[box]));
  SceneRenderer renderer(*device, host_scene, host_picture_size_px, settings);
  const auto prepare = [&](gpu::Packet &packet) {
    bool is_complete = false;
    std::thread([&] { is_complete = renderer.prepare(packet, camera); }).join();
    return is_complete;
  };
  // Fits that follow depths settle some frames later.
  const auto settled = [&] {
    gpu::Packet packet;
    bool is_complete = false;
    for (int frame = 0; frame < 40 && !is_complete; frame++) {
      is_complete = prepare(packet);
      device->submit(packet);
    }
    EXPECT_TRUE(is_complete);
    return renderer.read_picture();
  };
  const auto largest_difference = [](const std::vector<glm::vec4> &a, const std::vector<glm::vec4> &b) {
    float largest = 0.0F;
    for (std::size_t i = 0; i < a.size(); i++) {
      largest = std::max(largest, glm::distance(a[i], b[i]));
    }
    return largest;
  };
  const std::vector<glm::vec4> without = settled();
  renderer.render_scene().set_host_batch(box, host_box->batch);
  EXPECT_LT(largest_difference(settled(), truth), 0.1F);
  // The packet that was prepared before the buffers were taken back draws them.
  gpu::Packet before;
  gpu::Packet after;
  prepare(before);
  renderer.render_scene().set_host_batch(box, std::nullopt);
  prepare(after);
  device->submit(before);
  host_box.reset();
  device->submit(after);
  EXPECT_LT(largest_difference(settled(), without), 0.1F);
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace gnomon::eevee
