// SPDX-License-Identifier: MIT
// Scenes of which a host has meshes and images on the device.
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"

#include "gpu/gpu_host_framebuffer.hh"
#include "gpu/gpu_testing.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <thread>

namespace gnomon::eevee {
namespace {

constexpr glm::ivec2 picture_size_px(48, 36);

/** Buffers of the host with the shape of a mesh. */
class HostMesh {
 public:
  explicit HostMesh(const scene::Mesh &mesh)
  {
    glCreateBuffers(GLsizei(names_.size()), names_.data());
    write(mesh);
    const std::vector<std::uint16_t> indices(mesh.indices.begin(), mesh.indices.end());
    glNamedBufferData(names_[3], GLsizeiptr(indices.size() * 2), indices.data(), GL_STATIC_DRAW);
    batch = {.positions = {names_[0], 0, sizeof(glm::vec3)},
             .normals = {names_[1], 0, sizeof(glm::vec3)},
             .uvs = {mesh.uvs.empty() ? 0 : names_[2], 0, sizeof(glm::vec2)},
             .vertex_count = std::uint32_t(mesh.positions.size()),
             .index_buffer = names_[3],
             .index_count = std::uint32_t(indices.size()),
             .index_type = gpu::HostBatch::IndexType::Uint16};
  }
  ~HostMesh()
  {
    glDeleteBuffers(GLsizei(names_.size()), names_.data());
  }
  HostMesh(const HostMesh &) = delete;
  HostMesh &operator=(const HostMesh &) = delete;
  void write(const scene::Mesh &mesh) const
  {
    const auto data = [](GLuint name, const auto &values) {
      const auto bytes = std::as_bytes(std::span(values));
      glNamedBufferData(name, GLsizeiptr(bytes.size()), bytes.data(), GL_DYNAMIC_DRAW);
    };
    data(names_[0], mesh.positions);
    data(names_[1], mesh.normals);
    data(names_[2], mesh.uvs);
  }

  gpu::HostBatch batch;

 private:
  /** Positions, normals, uvs, indices. */
  std::array<GLuint, 4> names_{};
};

/** The mesh with its shape in buffers of the host. */
scene::Mesh without_vertices(const scene::Mesh &mesh)
{
  return {.name = mesh.name,
          .material = mesh.material,
          .host_shape = scene::HostShape{.bounds = mesh.bounds, .has_uvs = !mesh.uvs.empty()}};
}

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
    SceneRenderer renderer(*device, of, picture_size_px, settings);
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
  SceneRenderer renderer(*device, host_scene, picture_size_px, settings);
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
  SceneRenderer renderer(*device, host_scene, picture_size_px, settings);
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
  glTextureStorage2D(name, 1, GL_SRGB8_ALPHA8, 2, 2);
  glTextureSubImage2D(name, 0, 0, 0, 2, 2, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  scene::Scene host_scene = scene;
  const scene::Handle<scene::Image> image = scene.textures()[texture].image;
  host_scene.replace(image, scene::Image{"stand-in", 1, 1, {0, 0, 0, 255}});
  SceneRenderer renderer(*device, host_scene, picture_size_px, settings);
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

TEST_P(EeveeHostResourcesTest, BuffersThatAreTooSmallAreNamedAndTheNextSyncIsWhole)
{
  const HostMesh host_box(scene.meshes()[box]);
  scene::Scene host_scene = scene;
  host_scene.replace(box, without_vertices(scene.meshes()[box]));
  SceneRenderer renderer(*device, host_scene, picture_size_px, settings);
  gpu::HostBatch wrong = host_box.batch;
  wrong.vertex_count = 1000;
  renderer.render_scene().set_host_batch(box, wrong);
  test::expect_contains(test::error_of([&] { drawn(renderer); }), "batch 'box': buffer");
  renderer.render_scene().set_host_batch(box, host_box.batch);
  EXPECT_EQ(drawn(renderer), drawn(scene));
}

TEST_P(EeveeHostResourcesTest, FramesThatAnotherThreadPreparesDrawThem)
{
  const std::vector<glm::vec4> truth = drawn(scene);
  const HostMesh host_box(scene.meshes()[box]);
  scene::Scene host_scene = scene;
  host_scene.replace(box, without_vertices(scene.meshes()[box]));
  SceneRenderer renderer(*device, host_scene, picture_size_px, settings);
  renderer.render_scene().set_host_batch(box, host_box.batch);
  gpu::Packet packet;
  bool is_complete = false;
  // Fits that follow depths settle some frames later.
  for (int frame = 0; frame < 40 && !is_complete; frame++) {
    std::thread([&] { is_complete = renderer.prepare(packet, camera); }).join();
    device->submit(packet);
  }
  EXPECT_TRUE(is_complete);
  const std::vector<glm::vec4> picture = renderer.read_picture();
  for (std::size_t i = 0; i < picture.size(); i++) {
    ASSERT_LT(glm::distance(picture[i], truth[i]), 0.1F) << "pixel " << i;
  }
}

}  // namespace
}  // namespace gnomon::eevee
