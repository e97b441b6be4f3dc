// SPDX-License-Identifier: MIT
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace gnomon::gpu {
namespace {

using test::append_draw;
using test::make_shader;
using test::push_constants;

/** Object and value of the draw's instance, and other values of a pixel. */
constexpr const char *INSTANCE_FRAG = R"(
layout(location = 0) flat in uvec2 instance;
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(instance, gl_FragCoord.xy);
})";

/** A picture of GRID x GRID cells, one pixel each. */
class DrawGpu : public test::GpuDeviceTest {
 protected:
  static constexpr int GRID = 16;

  void SetUp() override
  {
    GpuDeviceTest::SetUp();
    if (!device) {
      return;
    }
    picture = device->create_texture({.name = "picture", .format = Format::RGBA32F, .width = GRID, .height = GRID});
    framebuffer = device->create_framebuffer({"picture", {{&picture}}, {}});
  }

  /** A quad over one cell, of a fan around its centre: \a rim_count triangles. */
  Batch cell(int x, int y, int rim_count = 4, std::span<const glm::vec3> normals = {}) const
  {
    const auto clip = [](float cell_position) { return cell_position * 2.0F / float(GRID) - 1.0F; };
    std::vector<glm::vec3> positions = {{clip(float(x) + 0.5F), clip(float(y) + 0.5F), 0.5F}};
    std::vector<std::uint32_t> indices;
    for (int i = 0; i < rim_count; i++) {
      // From the corners of the square, so that the whole pixel is covered; more points lie on its lower edge.
      const int corner = std::min(i, 3);
      float along = corner == 0 || corner == 3 ? 0.0F : 1.0F;
      if (i > 3) {
        along = 0.0F;
      }
      const float up = corner >= 2 ? 1.0F : 0.0F;
      positions.emplace_back(clip(float(x) + along), clip(float(y) + up), 0.5F);
      indices.insert(indices.end(), {0, std::uint32_t(i + 1), std::uint32_t((i + 1) % rim_count + 1)});
    }
    return device->create_batch({fmt::format("cell {} {}", x, y), positions, normals, indices});
  }

  void begin(CommandList &list, const Shader &shader, State state = State::WriteColor) const
  {
    list.begin_pass("draw", framebuffer, {.clear_color = glm::vec4(-1)});
    list.set_shader(shader.id());
    list.set_state(state);
  }

  std::vector<glm::vec4> submitted(const CommandList &list)
  {
    device->submit(list);
    return gpu::read_as<glm::vec4>(*device, picture);
  }

  static std::size_t at(int x, int y)
  {
    return std::size_t(y) * GRID + std::size_t(x);
  }

  Texture picture;
  Framebuffer framebuffer;
};

TEST_F(DrawGpu, OneCommandDrawsManyBatchesEachWithItsInstances)
{
  const Shader shader = make_shader(*device, "instance", test::CLIP_SPACE_VERT, INSTANCE_FRAG);
  CommandList list;
  begin(list, shader);
  std::vector<Batch> cells;
  for (int x = 0; x < GRID; x++) {
    cells.push_back(cell(x, x));
    const BatchRange &range = cells.back().range();
    // The second of two instances remains visible.
    list.draws.push_back(
        {range.index_count, 2, range.first_index, range.base_vertex, std::uint32_t(list.instances.size())});
    list.instances.push_back({7, 7});
    list.instances.push_back({std::uint32_t(1000 + x), std::uint32_t(x * x)});
  }
  list.draw(0, std::uint32_t(list.draws.size()));
  list.end_pass();
  const std::vector<glm::vec4> pixels = submitted(list);
  for (int y = 0; y < GRID; y++) {
    for (int x = 0; x < GRID; x++) {
      const glm::vec4 expected = x == y ? glm::vec4(1000 + x, x * x, x + 0.5, y + 0.5) : glm::vec4(-1);
      EXPECT_EQ(pixels[at(x, y)], expected) << x << " " << y;
    }
  }
  EXPECT_EQ(device->counters().draws, std::uint64_t(GRID));
  EXPECT_EQ(device->counters().triangles, std::uint64_t(GRID) * 2 * 4);
}

TEST_F(DrawGpu, CommandMayBeginInTheMiddleOfTheDraws)
{
  const Shader shader = make_shader(*device, "instance", test::CLIP_SPACE_VERT, INSTANCE_FRAG);
  CommandList list;
  begin(list, shader);
  std::vector<Batch> cells;
  for (int x = 0; x < 4; x++) {
    cells.push_back(cell(x, 0));
    const BatchRange &range = cells.back().range();
    list.draws.push_back({range.index_count, 1, range.first_index, range.base_vertex, std::uint32_t(x)});
    list.instances.push_back({0, std::uint32_t(x)});
  }
  list.draw(1, 2);
  list.end_pass();
  const std::vector<glm::vec4> pixels = submitted(list);
  EXPECT_EQ(pixels[0].y, -1);
  EXPECT_EQ(pixels[1].y, 1);
  EXPECT_EQ(pixels[2].y, 2);
  EXPECT_EQ(pixels[3].y, -1);
}

TEST_F(DrawGpu, SubmittedAgainIsTheSame)
{
  const Shader shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  const Batch full = test::full_triangle(*device, 0.5F);
  CommandList list;
  begin(list, shader, State::WriteColor | State::BlendAdd);
  push_constants(list, shader, glm::vec4(1, 2, 3, 4));
  append_draw(list, full);
  list.end_pass();
  const std::vector<glm::vec4> first = submitted(list);
  EXPECT_EQ(first[0], glm::vec4(0, 1, 2, 3));
  EXPECT_EQ(submitted(list), first);
}

TEST_F(DrawGpu, PushConstantsChangeBetweenDraws)
{
  const Shader shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  CommandList list;
  begin(list, shader);
  std::vector<Batch> cells;
  for (int x = 0; x < GRID; x++) {
    cells.push_back(cell(x, 3));
    push_constants(list, shader, glm::vec4(x, 2, 3, -x));
    append_draw(list, cells.back());
  }
  list.end_pass();
  const std::vector<glm::vec4> pixels = submitted(list);
  for (int x = 0; x < GRID; x++) {
    EXPECT_EQ(pixels[at(x, 3)], glm::vec4(x, 2, 3, -x));
  }
}

TEST_F(DrawGpu, ConstantsOfAProgramAreThoseOfItsDescriptionOrTheirDefaults)
{
  constexpr const char *vertex = R"(
layout(location = ATTRIBUTE_POSITION) in vec3 position;
SPECIALIZATION_CONSTANT(0) const int shared_count = 5;
layout(location = 0) flat out int count_of_vertex;
void main()
{
  gl_Position = vec4(position, 1.0);
  count_of_vertex = shared_count;
})";
  // The loop runs as often as the constant says. The same id is another constant in another stage.
  constexpr const char *fragment = R"(
  SPECIALIZATION_CONSTANT( 0 )  const bool is_negative = false;  // The sign.
SPECIALIZATION_CONSTANT(7) const int count = 3;
SPECIALIZATION_CONSTANT(3) const int shared_count = 5;
layout(location = 0) flat in int count_of_vertex;
layout(location = 0) out vec4 result;
void main()
{
  float sum = 0.0;
  for (int i = 0; i < count; i++) {
    sum += 1.0;
  }
  result = vec4(is_negative ? -sum : sum, count_of_vertex, shared_count, 1.0);
})";
  const Batch full = test::full_triangle(*device, 0.5F);
  const auto drawn = [&](const std::vector<ShaderConstant> &constants) {
    const Shader shader = make_shader(*device, "constants", vertex, fragment, "", constants);
    CommandList list;
    list.begin_pass("pass", framebuffer, {});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    append_draw(list, full);
    list.end_pass();
    device->submit(list);
    return read_as<glm::vec4>(*device, picture).front();
  };
  EXPECT_EQ(drawn({}), glm::vec4(3, 5, 5, 1));
  EXPECT_EQ(drawn({{"count", 4}}), glm::vec4(4, 5, 5, 1));
  EXPECT_EQ(drawn({{"is_negative", 1}, {"count", -1}}), glm::vec4(0, 5, 5, 1));
  EXPECT_EQ(drawn({{"is_negative", 2}, {"shared_count", -9}}), glm::vec4(-3, -9, -9, 1));
  EXPECT_EQ(drawn({{"is_negative", 0}}), glm::vec4(3, 5, 5, 1));
}

TEST_F(DrawGpu, PushConstantsOfDifferentSizesStandApart)
{
  const auto shader_of = [&](int count) {
    return make_shader(*device, fmt::format("array of {}", count), test::CLIP_SPACE_VERT,
                       fmt::format(R"(
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{{
  vec4 values[{0}];
}};
layout(location = 0) out vec4 result;
void main()
{{
  result = values[{0} - 1];
}})",
                                   count));
  };
  std::vector<Shader> shaders;
  for (const int count : {1, 3, 8, 16, 17, 5}) {
    if (std::size_t(count) * sizeof(glm::vec4) <= device->limits().push_constant_bytes_max) {
      shaders.push_back(shader_of(count));
    }
  }
  CommandList list;
  begin(list, shaders[0]);
  std::vector<Batch> cells;
  for (std::size_t i = 0; i < shaders.size(); i++) {
    cells.push_back(cell(int(i), 0));
    const std::size_t count = shaders[i].interface().push_constant_size_bytes / sizeof(glm::vec4);
    std::vector<glm::vec4> values(count, glm::vec4(-7));
    values.back() = glm::vec4(float(i));
    list.set_shader(shaders[i].id());
    list.push_constants(shaders[i].interface().push_constant_slot, std::as_bytes(std::span(values)));
    append_draw(list, cells.back());
  }
  list.end_pass();
  const std::vector<glm::vec4> pixels = submitted(list);
  for (std::size_t i = 0; i < shaders.size(); i++) {
    EXPECT_EQ(pixels[i], glm::vec4(float(i)));
  }
}

constexpr const char *BLOCK_FRAG = R"(
layout(std140, binding = 9) uniform color_block
{
  vec4 color;
};
layout(std140, binding = 0) readonly buffer store_block
{
  vec4 stored[];
};
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(color.xy, stored[1].xy);
})";

TEST_F(DrawGpu, UpdateIsInOrderBetweenPasses)
{
  const Shader shader = make_shader(*device, "block", test::CLIP_SPACE_VERT, BLOCK_FRAG);
  const Buffer block = device->create_buffer({.name = "color_block", .size_bytes = 16});
  const Buffer store = device->create_buffer({"store_block", BufferKind::Storage, 32});
  const Batch full = test::full_triangle(*device, 0.5F);
  constexpr int COUNT = 4;
  std::vector<Texture> pictures;
  std::vector<Framebuffer> framebuffers;
  CommandList list;
  for (int i = 0; i < COUNT; i++) {
    pictures.push_back(device->create_texture({.name = "p", .format = Format::RGBA32F, .width = 2, .height = 2}));
  }
  for (const Texture &texture : pictures) {
    framebuffers.push_back(device->create_framebuffer({"p", {{&texture}}, {}}));
  }
  device->update(block, glm::vec4(77));
  for (int i = 0; i < COUNT; i++) {
    const glm::vec4 value{float(i)};
    if (i > 0) {
      list.update(block, 0, std::as_bytes(std::span(&value, 1)));
    }
    list.update(store, 16, std::as_bytes(std::span(&value, 1)));
    list.begin_pass("draw", framebuffers[std::size_t(i)], {});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    list.bind_uniform(9, {block.id()});
    list.bind_storage(0, {store.id()});
    append_draw(list, full);
    list.end_pass();
  }
  device->submit(list);
  for (int i = 0; i < COUNT; i++) {
    const float first = i == 0 ? 77.0F : float(i);
    EXPECT_EQ(gpu::read_as<glm::vec4>(*device, pictures[std::size_t(i)])[0], glm::vec4(first, first, i, i));
  }
}

TEST_F(DrawGpu, UpdateDoesNotReachWhatWasSubmittedBefore)
{
  const Shader shader = make_shader(*device, "block", test::CLIP_SPACE_VERT, BLOCK_FRAG);
  const Buffer block = device->create_buffer({.name = "color_block", .size_bytes = 16});
  const Buffer store = device->create_buffer({"store_block", BufferKind::Storage, 32});
  const Batch full = test::full_triangle(*device, 0.5F);
  CommandList list;
  begin(list, shader);
  list.bind_uniform(9, {block.id()});
  list.bind_storage(0, {store.id()});
  append_draw(list, full);
  list.end_pass();
  const auto update = [&](float value) {
    const std::array<glm::vec4, 2> values = {glm::vec4(value), glm::vec4(value)};
    device->update(block, values[0]);
    device->update(store, 0, std::as_bytes(std::span(values)));
  };
  update(1);
  device->submit(list);
  update(2);
  EXPECT_EQ(gpu::read_as<glm::vec4>(*device, picture)[0], glm::vec4(1));
}

TEST_F(DrawGpu, RangeOfABufferIsWhatIsBound)
{
  const Shader shader = make_shader(*device, "block", test::CLIP_SPACE_VERT, BLOCK_FRAG);
  const std::uint32_t stride = std::max(device->limits().uniform_offset_alignment, 256U);
  const Buffer block = device->create_buffer({.name = "color_block", .size_bytes = std::size_t(stride) * 3});
  const Buffer store = device->create_buffer({"store_block", BufferKind::Storage, std::size_t(stride) * 3});
  for (std::uint32_t i = 0; i < 3; i++) {
    const std::array<glm::vec4, 2> values = {glm::vec4(float(i + 1)), glm::vec4(float(10 * (i + 1)))};
    device->update(block, std::size_t(i) * stride, std::as_bytes(std::span(values)));
    device->update(store, std::size_t(i) * stride, std::as_bytes(std::span(values)));
  }
  const Batch full = test::full_triangle(*device, 0.5F);
  for (const auto &[uniform, storage] : {std::pair(0U, 2U), std::pair(2U, 1U), std::pair(1U, 0U)}) {
    CommandList list;
    begin(list, shader);
    list.bind_uniform(9, {block.id(), uniform * stride, 16});
    // Size 0: to the end.
    list.bind_storage(0, {store.id(), storage * stride, 0});
    append_draw(list, full);
    list.end_pass();
    EXPECT_EQ(submitted(list)[0], glm::vec4(uniform + 1, uniform + 1, 10 * (storage + 1), 10 * (storage + 1)));
  }
}

TEST_F(DrawGpu, ProceduralCountsVerticesAndInstances)
{
  const Shader shader = make_shader(*device, "procedural", R"(
layout(location = 0) flat out uvec2 instance;
void main()
{
  // A row for each instance, of a quad of two triangles.
  vec2 corner = vec2(VERTEX_INDEX % 3 == 1 || VERTEX_INDEX == 4 ? 1 : 0, VERTEX_INDEX % 3 == 2 || VERTEX_INDEX == 4 ? 1 : 0);
  corner = VERTEX_INDEX < 3 ? corner : VERTEX_INDEX == 3 ? vec2(1, 0) : VERTEX_INDEX == 4 ? vec2(1, 1) : vec2(0, 1);
  gl_Position = vec4(corner.x * 2 - 1, (corner.y + INSTANCE_INDEX) / 8.0 - 1, 0.5, 1);
  instance = uvec2(INSTANCE_INDEX, 5);
})",
                                    INSTANCE_FRAG);
  CommandList list;
  begin(list, shader);
  list.draw_procedural(6, 3);
  list.end_pass();
  const std::vector<glm::vec4> pixels = submitted(list);
  for (int y = 0; y < GRID; y++) {
    for (int x = 0; x < GRID; x++) {
      const glm::vec4 expected = y < 3 ? glm::vec4(y, 5, x + 0.5, y + 0.5) : glm::vec4(-1);
      EXPECT_EQ(pixels[at(x, y)], expected) << x << " " << y;
    }
  }
}

TEST_F(DrawGpu, BatchesSurviveGrowthAndReuseOfThePool)
{
  const Shader shader = make_shader(*device, "instance", test::CLIP_SPACE_VERT, INSTANCE_FRAG);
  std::mt19937 random(3);
  std::vector<Batch> cells(GRID * GRID);
  const auto expect_all_cells = [&](std::uint32_t mark) {
    CommandList list;
    begin(list, shader);
    for (std::size_t i = 0; i < cells.size(); i++) {
      if (cells[i]) {
        const BatchRange &range = cells[i].range();
        list.draws.push_back(
            {range.index_count, 1, range.first_index, range.base_vertex, std::uint32_t(list.instances.size())});
        list.instances.push_back({mark, std::uint32_t(i)});
      }
    }
    list.draw(0, std::uint32_t(list.draws.size()));
    list.end_pass();
    const std::vector<glm::vec4> pixels = submitted(list);
    for (std::size_t i = 0; i < cells.size(); i++) {
      ASSERT_EQ(pixels[i].x, cells[i] ? float(mark) : -1.0F) << "cell " << i;
      ASSERT_EQ(pixels[i].y, cells[i] ? float(i) : -1.0F) << "cell " << i;
    }
  };
  const auto make = [&](std::size_t i) { cells[i] = cell(int(i) % GRID, int(i) / GRID, int(4 + random() % 60)); };
  // More than the pool's first 1024 vertices and indices, several times over.
  std::uint32_t vertex_end = 0;
  for (std::size_t i = 0; i < cells.size(); i++) {
    make(i);
    vertex_end = std::max(vertex_end, std::uint32_t(cells[i].range().base_vertex) + cells[i].range().vertex_count);
    if (i % 50 == 49) {
      expect_all_cells(std::uint32_t(i));
    }
  }
  ASSERT_GT(vertex_end, 4096U) << "the pool has not grown: this tests nothing";
  expect_all_cells(1000);
  for (std::uint32_t round = 0; round < 4; round++) {
    for (std::size_t i = 0; i < cells.size(); i++) {
      if (random() % 2 == 0) {
        cells[i] = Batch();
      }
    }
    expect_all_cells(2000 + round);
    for (std::size_t i = 0; i < cells.size(); i++) {
      if (!cells[i] && random() % 4 != 0) {
        make(i);
      }
    }
    expect_all_cells(3000 + round);
  }
}

TEST_F(DrawGpu, NormalsReachTheShaderAndAreZeroWhereNoneAreGiven)
{
  const Shader shader = make_shader(*device, "normal", R"(
layout(location = ATTRIBUTE_POSITION) in vec3 position;
layout(location = ATTRIBUTE_NORMAL) in vec3 normal;
layout(location = 0) flat out vec3 color;
void main()
{
  gl_Position = vec4(position, 1);
  color = normal;
})",
                                    R"(
layout(location = 0) flat in vec3 color;
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(color, 1);
})");
  const std::vector<glm::vec3> normals(5, glm::vec3(0.25F, -3, 1e-6F));
  Batch batch = cell(2, 2, 4, normals);
  const auto drawn = [&] {
    CommandList list;
    begin(list, shader);
    append_draw(list, batch);
    list.end_pass();
    return submitted(list)[at(2, 2)];
  };
  EXPECT_EQ(drawn(), glm::vec4(normals[0], 1));
  // At the same position of the pool.
  const std::int32_t place = batch.range().base_vertex;
  batch = Batch();
  batch = cell(2, 2, 4);
  ASSERT_EQ(batch.range().base_vertex, place);
  EXPECT_EQ(drawn(), glm::vec4(0, 0, 0, 1));
}

TEST_F(DrawGpu, UvsReachTheShaderWhereverTheirBatchStandsInThePool)
{
  const Shader shader = make_shader(*device, "uv", R"(
layout(location = ATTRIBUTE_POSITION) in vec3 position;
layout(location = ATTRIBUTE_UV) in vec2 uv;
layout(location = 0) flat out vec2 color;
void main()
{
  gl_Position = vec4(position, 1);
  color = uv;
})",
                                    R"(
layout(location = 0) flat in vec2 color;
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(color, 0, 1);
})");
  // Batches with and without uvs, enough of both that the pool grows several times.
  std::vector<Batch> batches;
  std::vector<Batch> others;
  const std::array<std::uint32_t, 3> indices = {0, 1, 2};
  for (int i = 0; i < 40; i++) {
    others.push_back(test::full_triangle(*device, 0.5F));
    const std::array<glm::vec3, 3> positions = {glm::vec3(-1, -1, 0), glm::vec3(3, -1, 0), glm::vec3(-1, 3, 0)};
    const std::vector<glm::vec2> uvs(3, glm::vec2(float(i), 0.5F));
    batches.push_back(device->create_batch({"uv", positions, {}, indices, uvs}));
  }
  for (std::size_t i = 0; i < batches.size(); i++) {
    CommandList list;
    begin(list, shader);
    append_draw(list, batches[i]);
    list.end_pass();
    EXPECT_EQ(submitted(list)[at(1, 1)], glm::vec4(float(i), 0.5F, 0, 1));
  }
}

TEST_F(DrawGpu, EmptyBatchAndEmptyListDrawNothing)
{
  const Shader shader = make_shader(*device, "instance", test::CLIP_SPACE_VERT, INSTANCE_FRAG);
  const Batch empty = device->create_batch({.name = "empty", .positions = {}, .normals = {}, .indices = {}});
  CommandList list;
  device->submit(list);
  begin(list, shader);
  append_draw(list, empty);
  list.end_pass();
  const std::vector<glm::vec4> pixels = submitted(list);
  EXPECT_EQ(std::ranges::count(pixels, glm::vec4(-1)), GRID * GRID);
}

TEST_F(DrawGpu, AStaleIdIsAnErrorInEveryBuildAndTheDeviceRemainsUsable)
{
  const Batch full = test::full_triangle(*device, 0);
  Shader shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  const auto drawing = [&](float value) {
    CommandList list;
    begin(list, shader);
    push_constants(list, shader, glm::vec4(value));
    append_draw(list, full);
    list.end_pass();
    return list;
  };
  const CommandList list = drawing(1);
  shader = make_shader(*device, "other", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  const std::string message = test::error_of([&] { device->submit(list); });
  test::expect_contains(message, "shader id");
  test::expect_contains(message, "stale");
  EXPECT_EQ(submitted(drawing(2)), std::vector<glm::vec4>(GRID * GRID, glm::vec4(2)));
}

TEST_F(DrawGpu, DeclaredSamplersThatAreNotBoundReadZeros)
{
  const Shader reader = make_shader(*device, "reader", test::CLIP_SPACE_VERT, R"(
layout(binding = 16) uniform sampler2D flat_texture;
layout(binding = 17) uniform sampler2DArray layers;
layout(binding = 18) uniform sampler2DShadow flat_depth;
layout(binding = 19) uniform sampler2DArrayShadow depth_layers;
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(texture(flat_texture, vec2(0.5)).r, texture(layers, vec3(0.5)).r, texture(flat_depth, vec3(0.5)),
                texture(depth_layers, vec4(0.5)));
})");
  const Batch full = test::full_triangle(*device, 0);
  const auto record = [&](bool is_second) {
    CommandList list;
    begin(list, reader);
    for (int slot = 16; slot < 20; slot++) {
      list.bind_texture(slot, 0, 0);
    }
    append_draw(list, full);
    if (is_second) {
      append_draw(list, full);
    }
    list.end_pass();
    return list;
  };
  for (const bool is_second : {false, true}) {
    // A reference of 0.5 is nearer than the far plane: not in shadow.
    EXPECT_EQ(submitted(record(is_second)), std::vector<glm::vec4>(GRID * GRID, glm::vec4(0, 0, 1, 1)));
  }
}

TEST_F(DrawGpu, TimerGivesFiniteSecondsThatGrowWithTheWork)
{
  const Shader shader = make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  const Texture large =
      device->create_texture({.name = "large", .format = Format::RGBA32F, .width = 512, .height = 512});
  const Framebuffer target = device->create_framebuffer({"large", {{&large}}, {}});
  const Batch full = test::full_triangle(*device, 0.5F);
  const TimerQuery timer = device->create_timer_query("timer");
  const auto seconds = [&](int count) {
    CommandList list;
    for (int i = 0; i < count; i++) {
      list.begin_pass("draw", target, {});
      list.set_shader(shader.id());
      list.set_state(State::WriteColor | State::BlendAdd);
      push_constants(list, shader, glm::vec4(1));
      append_draw(list, full, 10);
      list.end_pass();
    }
    device->time_begin(timer);
    device->submit(list);
    device->time_end(timer);
    return device->take_seconds(timer);
  };
  // Other processes only add time, so that the least of several times is compared.
  const auto least_seconds = [&](int count) {
    double least = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 5; round++) {
      const std::optional<double> time = seconds(count);
      EXPECT_TRUE(time && std::isfinite(*time));
      least = std::min(least, time.value_or(least));
    }
    return least;
  };
  static_cast<void>(seconds(1));
  const double nothing = least_seconds(0);
  const double much = least_seconds(20);
  EXPECT_GE(nothing, 0);
  EXPECT_GT(much, nothing);
  EXPECT_LT(much, 60);
}

}  // namespace
}  // namespace gnomon::gpu
