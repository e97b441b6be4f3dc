// SPDX-License-Identifier: MIT
// Draws from textures and vertex buffers of the host.
#include "gpu/gpu_gl_state_table.hh"
#include "gpu/gpu_host_framebuffer.hh"
#include "gpu/gpu_host_vertices.hh"
#include "gpu/gpu_testing.hh"

#include "gpu_device.hh"

#include <functional>

namespace gnomon::gpu {
namespace {

using test::append_draw;
using test::error_of;
using test::expect_contains;
using test::make_shader;
using test::Vertices;

constexpr int edge_px = 16;

/** A buffer of the host. */
class HostBuffer {
 public:
  explicit HostBuffer(std::span<const std::byte> bytes)
  {
    glCreateBuffers(1, &name);
    glNamedBufferData(name, GLsizeiptr(bytes.size()), bytes.data(), GL_STATIC_DRAW);
  }
  template <typename T>
  explicit HostBuffer(const std::vector<T> &values) : HostBuffer(std::as_bytes(std::span(values)))
  {
  }
  ~HostBuffer()
  {
    glDeleteBuffers(1, &name);
  }
  HostBuffer(const HostBuffer &) = delete;
  HostBuffer &operator=(const HostBuffer &) = delete;

  GLuint name = 0;
};

/** A texture of the host of 2x2 texels: red, green, blue, white from the first row on. */
class HostTexels {
 public:
  explicit HostTexels(GLenum format = GL_RGBA8, int levels = 1)
  {
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    glTextureStorage2D(name, levels, format, 2, 2);
    constexpr std::array<std::uint8_t, 16> texels = {255, 0, 0,   255, 0,   255, 0,   255,
                                                     0,   0, 255, 255, 255, 255, 255, 255};
    glTextureSubImage2D(name, 0, 0, 0, 2, 2, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  }
  ~HostTexels()
  {
    glDeleteTextures(1, &name);
  }
  HostTexels(const HostTexels &) = delete;
  HostTexels &operator=(const HostTexels &) = delete;

  GLuint name = 0;
};

class HostResourcesTest : public test::HostFramebufferTest {
 protected:
  void SetUp() override
  {
    test::HostFramebufferTest::SetUp();
    if (IsSkipped() || HasFailure()) {
      return;
    }
    picture =
        device->create_texture({.name = "picture", .format = Format::RGBA32F, .width = edge_px, .height = edge_px});
    framebuffer = device->create_framebuffer({"picture", {{&picture}}, {}});
    shader = make_shader(*device, "streams", test::streams_vert, test::streams_frag);
  }
  std::vector<glm::vec4> drawn(const std::function<void(CommandList &)> &draw)
  {
    CommandList list;
    list.begin_pass("picture", framebuffer, {.clear_color = glm::vec4(-1)});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    draw(list);
    list.end_pass();
    device->submit(list);
    return read_as<glm::vec4>(*device, picture);
  }
  static void append_host_draw(CommandList &list, const Batch &batch, std::uint32_t count = 1)
  {
    list.bind_host_batch(batch.id());
    append_draw(list, batch, count);
  }

  Texture picture;
  Framebuffer framebuffer;
  Shader shader;
};

INSTANTIATE_TEST_SUITE_P(, HostResourcesTest, testing::Values(test::HostKind::Egl, test::HostKind::Glx),
                         test::name_of_host);

TEST_P(HostResourcesTest, InterleavedBuffersOfAnyTypeDrawWhatABatchDraws)
{
  const Vertices vertices;
  const Batch copy = vertices.make_batch(*device);
  const std::vector<glm::vec4> truth = drawn([&](CommandList &list) { append_draw(list, copy); });
  EXPECT_EQ(truth[1], glm::vec4(2.0F, -3.0F, 0.5F, 0.125F));

  const test::InterleavedVertices interleaved(vertices);
  const HostBuffer vertex_buffer(interleaved.bytes);
  const HostBuffer index_buffer(interleaved.indices);
  const HostBatch host = interleaved.batch(vertex_buffer.name, index_buffer.name);
  const std::uint64_t uploads = device->counters().upload_bytes;
  Batch batch = device->create_batch("triangle", host);
  EXPECT_EQ(device->counters().upload_bytes, uploads);
  EXPECT_EQ(device->live(batch).size_bytes, 0U);
  EXPECT_EQ(drawn([&](CommandList &list) { append_host_draw(list, batch); }), truth);
  // The host's buffers are not freed with the batch.
  batch = Batch();
  EXPECT_TRUE(glIsBuffer(vertex_buffer.name) && glIsBuffer(index_buffer.name));
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_P(HostResourcesTest, AbsentStreamsAreZerosAndWhite)
{
  const Vertices vertices;
  const HostBuffer positions(vertices.positions);
  const HostBuffer indices(vertices.indices);
  const Batch batch = device->create_batch(
      "triangle",
      {.positions = {positions.name, 0, 12}, .vertex_count = 3, .index_buffer = indices.name, .index_count = 3});
  const std::vector<glm::vec4> values = drawn([&](CommandList &list) { append_host_draw(list, batch); });
  EXPECT_EQ(values[0], glm::vec4(0));
  EXPECT_EQ(values[1], glm::vec4(0));
  EXPECT_EQ(values[2], glm::vec4(0));
  EXPECT_EQ(values[3], glm::vec4(1));
  EXPECT_EQ(values[4], glm::vec4(0.25F));
}

TEST_P(HostResourcesTest, DrawsOfBothKindsFollowEachOtherInOneList)
{
  const Vertices vertices;
  std::vector<glm::vec3> nearer = vertices.positions;
  for (glm::vec3 &position : nearer) {
    position.z = 0.75F;
  }
  const HostBuffer first_positions(vertices.positions);
  const HostBuffer second_positions(nearer);
  const HostBuffer indices(vertices.indices);
  const auto make = [&](const HostBuffer &positions) {
    return device->create_batch(
        "host",
        HostBatch{
            .positions = {positions.name, 0, 12}, .vertex_count = 3, .index_buffer = indices.name, .index_count = 3});
  };
  const Batch first = make(first_positions);
  const Batch second = make(second_positions);
  const Batch shared = test::full_triangle(*device, 0.5F);
  const auto depth_after = [&](const std::function<void(CommandList &)> &draw) { return drawn(draw)[4].x; };
  const auto draw_shared = [&](CommandList &list) {
    list.bind_host_batch(0);
    append_draw(list, shared);
  };
  EXPECT_EQ(depth_after([&](CommandList &list) {
              append_host_draw(list, first);
              draw_shared(list);
            }),
            0.5F);
  EXPECT_EQ(depth_after([&](CommandList &list) {
              draw_shared(list);
              append_host_draw(list, first);
              append_host_draw(list, second, 3);
            }),
            0.75F);
  // The value of the last of three instances.
  EXPECT_EQ(drawn([&](CommandList &list) {
              append_host_draw(list, second);
              append_host_draw(list, first, 3);
            })[0],
            glm::vec4(0, 0, 0, 2));
}

TEST_P(HostResourcesTest, NoVertexArrayKeepsTheHostsBuffersAfterADraw)
{
  const Vertices vertices;
  const HostBuffer positions(vertices.positions);
  const HostBuffer indices(vertices.indices);
  const Batch batch = device->create_batch(
      "triangle",
      {.positions = {positions.name, 0, 12}, .vertex_count = 3, .index_buffer = indices.name, .index_count = 3});
  EXPECT_EQ(drawn([&](CommandList &list) { append_host_draw(list, batch); })[4].x, 0.25F);
  // A buffer that a vertex array names is not freed when its host deletes it.
  int array_count = 0;
  for (GLuint array = 1; array < 100; array++) {
    if (!glIsVertexArray(array)) {
      continue;
    }
    array_count++;
    glBindVertexArray(array);
    GLint element_buffer = 0;
    glGetIntegerv(GL_ELEMENT_ARRAY_BUFFER_BINDING, &element_buffer);
    EXPECT_NE(GLuint(element_buffer), indices.name);
    for (GLuint binding = 0; binding < 16; binding++) {
      GLint buffer = 0;
      glGetIntegeri_v(GL_VERTEX_BINDING_BUFFER, binding, &buffer);
      EXPECT_NE(GLuint(buffer), positions.name) << binding;
    }
  }
  glBindVertexArray(0);
  EXPECT_GE(array_count, 3);
}

TEST_P(HostResourcesTest, BatchesThatDoNotFitAreRefusedByName)
{
  const Vertices vertices;
  const HostBuffer positions(vertices.positions);
  const HostBuffer indices(vertices.indices);
  const HostBatch valid{
      .positions = {positions.name, 0, 12}, .vertex_count = 3, .index_buffer = indices.name, .index_count = 3};
  const auto message_of = [&](const std::function<void(HostBatch &)> &change) {
    HostBatch batch = valid;
    change(batch);
    return error_of([&] { static_cast<void>(device->create_batch("terrain", batch)); });
  };
  const std::size_t live = device->live().size();
  EXPECT_EQ(message_of([](HostBatch & /*batch*/) {}), "");
  expect_contains(message_of([](HostBatch &batch) { batch.positions.buffer = 0; }),
                  "batch 'terrain' of the host: it has no buffer of positions or of indices");
  expect_contains(message_of([](HostBatch &batch) { batch.vertex_count = 0; }), "it has indices, and no vertices");
  EXPECT_EQ(message_of([](HostBatch &batch) { batch.vertex_count = batch.index_count = 0; }), "");
  expect_contains(message_of([](HostBatch &batch) { batch.positions.stride_bytes = 0; }),
                  "the positions have a stride of 0 bytes, not of 1 to 2048");
  expect_contains(message_of([](HostBatch &batch) { batch.index_offset_bytes = 2; }), "no multiple of 4");
  expect_contains(message_of([](HostBatch &batch) { batch.positions.buffer = 4321; }),
                  "batch 'terrain': buffer 4321 of the host, with its positions, does not exist");
  expect_contains(message_of([](HostBatch &batch) { batch.vertex_count = 4; }),
                  "has 36 bytes, and its positions end at byte 48");
  expect_contains(message_of([](HostBatch &batch) { batch.index_count = 6; }),
                  "has 12 bytes, and its indices end at byte 24");
  expect_contains(message_of([&](HostBatch &batch) {
                    batch.colors = {positions.name, 24, 12};
                  }),
                  "its colours end at byte 64");
  EXPECT_EQ(device->live().size(), live);
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
#ifndef NDEBUG
  const Batch batch = device->create_batch("terrain", valid);
  CommandList list;
  const Batch shared = test::full_triangle(*device, 0.5F);
  list.bind_host_batch(shared.id());
  expect_contains(error_of([&] { device->submit(list); }), "batch 'full' is not in buffers of the host");
#endif
}

TEST_P(HostResourcesTest, TexturesAreLookedUpInTheirOwnFormatAndStayTheHosts)
{
  const Shader lookup = make_shader(*device, "lookup", test::CLIP_SPACE_VERT, R"(
layout(binding = 16) uniform sampler2D image;
layout(location = 0) out vec4 result;
void main()
{
  result = textureLod(image, gl_FragCoord.xy / 16.0, 3.0);
})");
  const Batch full = test::full_triangle(*device, 0.5F);
  const Sampler nearest = device->create_sampler({.name = "nearest"});
  const Sampler of_levels = device->create_sampler({.name = "of_levels", .mip = MipFilter::Nearest});
  const auto looked_up = [&](const HostTexels &host, bool has_mip_levels) {
    const Texture texture = device->create_texture(texture_desc("screen", {host.name, {2, 2}, has_mip_levels}));
    EXPECT_EQ(texture.desc().size_bytes(), 0U);
    return drawn([&](CommandList &list) {
      list.set_shader(lookup.id());
      list.bind_texture(16, texture.id(), has_mip_levels ? of_levels.id() : nearest.id());
      append_draw(list, full);
    });
  };
  const HostTexels linear;
  const std::vector<glm::vec4> values = looked_up(linear, false);
  EXPECT_EQ(values[0], glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(values[edge_px - 1], glm::vec4(0, 1, 0, 1));
  EXPECT_EQ(values[edge_px * (edge_px - 1)], glm::vec4(0, 0, 1, 1));
  EXPECT_TRUE(glIsTexture(linear.name));
  // Grey 128 of an sRGB format is decoded. OpenGL allows an error of half a step of eight bits.
  const HostTexels encoded(GL_SRGB8_ALPHA8);
  constexpr std::array<std::uint8_t, 4> grey = {128, 128, 128, 128};
  glClearTexImage(encoded.name, 0, GL_RGBA, GL_UNSIGNED_BYTE, grey.data());
  EXPECT_NEAR(looked_up(encoded, false)[0].x, std::pow((128.0 / 255.0 + 0.055) / 1.055, 2.4), 0.5 / 255.0);
  // Level 1 is read where the texture is said to have it.
  const HostTexels levels(GL_RGBA8, 2);
  glClearTexImage(levels.name, 1, GL_RGBA, GL_UNSIGNED_BYTE, grey.data());
  EXPECT_NEAR(looked_up(levels, true)[0].y, 128.0 / 255.0, 1e-4);
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_P(HostResourcesTest, TexturesThatCannotBeLookedUpAreRefusedByName)
{
  const HostTexels texels;
  const HostTexels integers(GL_RGBA8UI);
  GLuint array = 0;
  glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &array);
  glTextureStorage3D(array, 1, GL_RGBA8, 2, 2, 1);
  // A mutable texture of one level, which a sampler of mip levels would find incomplete.
  GLuint one_level = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &one_level);
  glBindTexture(GL_TEXTURE_2D, one_level);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 2, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glBindTexture(GL_TEXTURE_2D, 0);
  while (glGetError() != GL_NO_ERROR) {
  }
  const auto message_of = [&](const HostTexture &texture) {
    return error_of([&] { static_cast<void>(device->create_texture(texture_desc("screen", texture))); });
  };
  EXPECT_EQ(message_of({texels.name, {2, 2}}), "");
  EXPECT_EQ(message_of({one_level, {2, 2}}), "");
  // Immutable storage is complete with fewer levels.
  EXPECT_EQ(message_of({texels.name, {2, 2}, true}), "");
  expect_contains(message_of({9876, {2, 2}}), "texture 'screen': texture 9876 of the host does not exist");
  expect_contains(message_of({texels.name, {4, 2}}), "has 2x2 texels, not 4x2");
  expect_contains(message_of({array, {2, 2}}), "is not of the target GL_TEXTURE_2D");
  expect_contains(message_of({integers.name, {2, 2}}), "of floats or of normalised integers");
  expect_contains(message_of({one_level, {2, 2}, true}), "has no mip level 1");
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  glDeleteTextures(1, &array);
  glDeleteTextures(1, &one_level);
  expect_contains(message_of({0, {2, 2}}), "the name of the host's texture is 0");
}

TEST_P(HostResourcesTest, TheHostsStateIsUnchanged)
{
  const Vertices vertices;
  const HostBuffer positions(vertices.positions);
  const HostBuffer indices(vertices.indices);
  const HostTexels texels;
  const test::HostObjects objects;
  test::set_unusual_state(objects);
  const std::vector<test::StateItem> table = test::state_table();
  const test::StateSnapshot before(table);
  const Batch batch = device->create_batch(
      "triangle",
      {.positions = {positions.name, 0, 12}, .vertex_count = 3, .index_buffer = indices.name, .index_count = 3});
  const Texture texture = device->create_texture(texture_desc("screen", {texels.name, {2, 2}}));
  static_cast<void>(drawn([&](CommandList &list) { append_host_draw(list, batch); }));
  EXPECT_EQ(before.differences(), std::vector<std::string>());
}

TEST_P(HostResourcesTest, ARecordedBatchExistsAfterItsSubmission)
{
  const Vertices vertices;
  const HostBuffer positions(vertices.positions);
  const HostBuffer indices(vertices.indices);
  const HostBatch host{
      .positions = {positions.name, 0, 12}, .vertex_count = 3, .index_buffer = indices.name, .index_count = 3};
  Packet packet;
  Batch batch;
  {
    const Recording recording(*device, packet);
    batch = device->create_batch("recorded", host);
  }
  device->submit(packet);
  EXPECT_EQ(drawn([&](CommandList &list) { append_host_draw(list, batch); })[4].x, 0.25F);
  // One that cannot be made is lost with its packet.
  Batch wrong;
  {
    const Recording recording(*device, packet);
    wrong = device->create_batch(
        "wrong",
        HostBatch{
            .positions = {positions.name, 0, 12}, .vertex_count = 100, .index_buffer = indices.name, .index_count = 3});
  }
  expect_contains(error_of([&] { device->submit(packet); }), "batch 'wrong': buffer");
  {
    const Recording recording(*device, packet);
    EXPECT_FALSE(wrong);
    batch = Batch();
  }
  device->submit(packet);
  EXPECT_EQ(device->live_resources().size(), 3U);
}

}  // namespace
}  // namespace gnomon::gpu
