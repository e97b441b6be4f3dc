// SPDX-License-Identifier: MIT
#include "gpu/gpu_testing.hh"

#include <numeric>

namespace gnomon::gpu {
namespace {

using test::error_of;
using test::expect_contains;

constexpr Limits SMALL = {
    .texture_size_max = 64,
    .array_layers_max = 13,
    .buffer_texels_max = 99,
    .uniform_block_bytes_max = 256,
    .storage_block_bytes_max = 1024,
    .color_attachment_max = 2,
    .uniform_offset_alignment = 16,
};

/** Expects an error of \a action that contains all \a parts, and an unchanged \a device. */
template <typename Action>
void expect_refused(Device &device, Action &&action, std::initializer_list<std::string_view> parts)
{
  const std::vector<std::string> live_before = device.live_resources();
  const Counters before = device.counters();
  const std::string message = error_of(action);
  EXPECT_FALSE(message.empty()) << "nothing thrown";
  for (const std::string_view part : parts) {
    expect_contains(message, part);
  }
  EXPECT_EQ(device.live_resources(), live_before);
  EXPECT_EQ(device.counters().textures_made, before.textures_made);
  EXPECT_EQ(device.counters().shaders_made, before.shaders_made);
  EXPECT_EQ(device.counters().upload_bytes, before.upload_bytes);
}

void expect_texture_refused(const TextureDesc &desc, std::initializer_list<std::string_view> parts)
{
  const auto device = create_null_device(SMALL);
  expect_refused(
      *device, [&] { static_cast<void>(device->create_texture(desc)); }, parts);
}

TEST(Device, RefusesTexturesPastItsLimitsByName)
{
  expect_texture_refused({.name = "wide", .width = 65}, {"texture 'wide'", "width is 65", "1 to 64"});
  expect_texture_refused({.name = "high", .height = 65}, {"texture 'high'", "height is 65", "1 to 64"});
  expect_texture_refused({.name = "none", .width = 0}, {"texture 'none'", "width is 0"});
  expect_texture_refused({.name = "less", .height = -1}, {"texture 'less'", "height is -1"});
  expect_texture_refused({.name = "flat", .layers = 2}, {"texture 'flat'", "layer count is 2", "1 to 1"});
  expect_texture_refused({.name = "deep", .kind = TextureKind::Array, .layers = 14},
                         {"texture 'deep'", "layer count is 14", "1 to 13"});
  expect_texture_refused({.name = "long", .kind = TextureKind::Buffer, .width = 100},
                         {"texture 'long'", "width is 100", "1 to 99"});
  expect_texture_refused({.name = "rows", .kind = TextureKind::Buffer, .height = 2},
                         {"texture 'rows'", "height is 2", "1 to 1"});
  expect_texture_refused({.name = "mips", .width = 16, .height = 4, .mip_levels = 6},
                         {"texture 'mips'", "mip level count is 6", "1 to 5"});
}

TEST(Device, TakesTexturesAtItsLimits)
{
  const auto device = create_null_device(SMALL);
  const Texture flat = device->create_texture({.name = "flat", .width = 64, .height = 64, .mip_levels = 7});
  const Texture array = device->create_texture({.name = "array", .kind = TextureKind::Array, .layers = 13});
  const Texture buffer = device->create_texture({.name = "buffer", .kind = TextureKind::Buffer, .width = 99});
  EXPECT_EQ(device->counters().textures_made, 3U);
}

TEST(Device, RefusesAnisotropyPastItsLimitsByName)
{
  const auto device = create_null_device({.anisotropy_max = 8});
  SamplerDesc desc{.name = "plane", .filter = Filter::Linear, .mip = MipFilter::Linear, .anisotropy = 8};
  EXPECT_TRUE(device->create_sampler(desc));
  const auto refuse = [&](std::initializer_list<std::string_view> parts) {
    expect_refused(
        *device, [&] { static_cast<void>(device->create_sampler(desc)); }, parts);
  };
  for (const int anisotropy : {-1, 0, 9}) {
    desc.anisotropy = anisotropy;
    refuse({"sampler 'plane'", fmt::format("anisotropy is {},", anisotropy), "1 to 8"});
  }
  desc.anisotropy = 2;
  desc.mip = MipFilter::None;
  refuse({"sampler 'plane'", "anisotropy is 2", "linear filters and mip levels"});
  desc.mip = MipFilter::Linear;
  desc.minified = Filter::Nearest;
  refuse({"sampler 'plane'", "linear filters and mip levels"});
  desc.minified = Filter::Linear;
  desc.filter = Filter::Nearest;
  refuse({"sampler 'plane'", "linear filters and mip levels"});
}

TEST(Device, RefusesBuffersPastItsLimitsByName)
{
  const auto device = create_null_device(SMALL);
  const auto make = [&](BufferKind kind, std::size_t size_bytes) {
    return [&device, kind, size_bytes] { static_cast<void>(device->create_buffer({"block", kind, size_bytes})); };
  };
  expect_refused(*device, make(BufferKind::Uniform, 257), {"buffer 'block'", "257 bytes", "1 to 256"});
  expect_refused(*device, make(BufferKind::Storage, 1025), {"buffer 'block'", "1025 bytes", "1 to 1024"});
  expect_refused(*device, make(BufferKind::Uniform, 0), {"buffer 'block'", "0 bytes"});
  EXPECT_TRUE(device->create_buffer({"block", BufferKind::Uniform, 256}));
  EXPECT_TRUE(device->create_buffer({"block", BufferKind::Storage, 1024}));
}

TEST(Device, RefusesFramebuffersThatDoNotFitByName)
{
  const auto device = create_null_device(SMALL);
  const Texture color = device->create_texture({.name = "color", .width = 8, .height = 4, .mip_levels = 2});
  const Texture small = device->create_texture({.name = "small", .width = 4, .height = 2});
  const Texture array =
      device->create_texture({.name = "array", .kind = TextureKind::Array, .width = 8, .height = 4, .layers = 3});
  const Texture depth = device->create_texture({.name = "depth", .format = Format::Depth32F, .width = 8, .height = 4});
  const auto make = [&](std::vector<Attachment> colors, Attachment depth_attachment = {}) {
    return [&device, colors, depth_attachment] {
      static_cast<void>(device->create_framebuffer({"target", colors, depth_attachment}));
    };
  };
  expect_refused(*device, make({{&color}, {&color}, {&color}}), {"framebuffer 'target'", "3 colour", "supports 2"});
  expect_refused(*device, make({}), {"framebuffer 'target'", "no attachments"});
  expect_refused(*device, make({{&depth}}), {"framebuffer 'target'", "'depth'", "Depth32F", "colour"});
  expect_refused(*device, make({}, {&color}), {"framebuffer 'target'", "'color'", "RGBA8", "depth"});
  expect_refused(*device, make({{&color}, {&small}}), {"framebuffer 'target'", "'small'", "4x2", "8x4"});
  expect_refused(*device, make({{&small}}, {&depth}), {"framebuffer 'target'", "'depth'", "8x4", "4x2"});
  expect_refused(*device, make({{&color, 1}}), {"framebuffer 'target'", "'color'", "layer 1"});
  expect_refused(*device, make({{&array, 3}}), {"framebuffer 'target'", "'array'", "layer 3"});
  expect_refused(*device, make({{&array, -2}}), {"framebuffer 'target'", "'array'", "layer -2"});
  expect_refused(*device, make({{.texture = &array, .layer = 1, .layer_count = 3}}),
                 {"framebuffer 'target'", "'array'", "3 layers from 1 on"});
  expect_refused(*device, make({{.texture = &array, .layer = 0, .layer_count = 0}}),
                 {"framebuffer 'target'", "'array'", "0 layers from 0 on"});
  expect_refused(*device, make({{.texture = &array, .layer = all_layers, .layer_count = 2}}),
                 {"framebuffer 'target'", "'array'", "2 layers from -1 on"});
  expect_refused(*device, make({{&color, 0, 2}}), {"framebuffer 'target'", "'color'", "mip level 2"});
  expect_refused(*device, make({{&color, 0, -1}}), {"framebuffer 'target'", "'color'", "mip level -1"});
  // The same level sizes: fits.
  const Framebuffer fits = device->create_framebuffer({"fits", {{&color, 0, 1}, {&small}}, {}});
  EXPECT_EQ(fits.size_px(), glm::ivec2(4, 2));
  EXPECT_EQ(device->create_framebuffer({"depth", {}, {&depth}}).size_px(), glm::ivec2(8, 4));
  EXPECT_TRUE(device->create_framebuffer({"slice", {{&array, 2}}, {}}));
  EXPECT_TRUE(device->create_framebuffer({"all", {{&array, all_layers}}, {}}));
  EXPECT_TRUE(device->create_framebuffer({"some", {{.texture = &array, .layer = 1, .layer_count = 2}}, {}}));
}

TEST(Device, RefusalKeepsTheIdForTheNext)
{
  const auto device = create_null_device(SMALL);
  EXPECT_THROW(static_cast<void>(device->create_buffer({.name = "big", .size_bytes = 4096})), Error);
  const Buffer buffer = device->create_buffer({.name = "fits", .size_bytes = 16});
  EXPECT_EQ(buffer.id(), 1U);
  EXPECT_EQ(device->name_of(ResourceKind::Buffer, 1), "fits");
}

TEST(Device, RefusesAShaderThatIsNoneAndMakesNothing)
{
  const auto device = create_null_device();
  const test::ShaderTexts texts{{{"v", "#version 450 core\nvoid main() { gl_Position = nothing; }\n"},
                                 {"f", "#version 450 core\nvoid main() {}\n"}}};
  expect_refused(
      *device,
      [&] {
        static_cast<void>(device->create_shader({"odd", "v", "", "f", {}}, texts.files(), shader_check::reflect));
      },
      {"shader 'odd'", "vertex", "v:2", "nothing"});
}

TEST(Device, BatchesStandApartInThePool)
{
  const auto device = create_null_device();
  std::vector<glm::vec3> positions(5);
  std::vector<std::uint32_t> indices = {0, 1, 2, 2, 3, 4};
  const Batch a = device->create_batch({"a", positions, {}, indices});
  const Batch b = device->create_batch({"b", positions, positions, indices});
  EXPECT_EQ(a.range().vertex_count, 5U);
  EXPECT_EQ(a.range().index_count, 6U);
  EXPECT_EQ(a.range().base_vertex, 0);
  EXPECT_EQ(b.range().base_vertex, 5);
  EXPECT_EQ(b.range().first_index, 6U);
}

TEST(Device, BatchPlaceIsFreedWithTheBatch)
{
  const auto device = create_null_device();
  const std::vector<glm::vec3> positions(300);
  std::vector<std::uint32_t> indices(300);
  std::iota(indices.begin(), indices.end(), 0U);
  Batch a = device->create_batch({"a", positions, {}, indices});
  const Batch b = device->create_batch({"b", positions, {}, indices});
  a = Batch();
  const Batch c = device->create_batch({"c", positions, {}, indices});
  EXPECT_EQ(c.range().base_vertex, 0);
  EXPECT_EQ(c.range().first_index, 0U);
  EXPECT_EQ(b.range().base_vertex, 300);
}

TEST(Counters, CountTheWorkOfASubmission)
{
  const auto device = create_null_device();
  const Texture texture = device->create_texture({.name = "t", .width = 2, .height = 2});
  const Framebuffer framebuffer = device->create_framebuffer({"f", {{&texture}}, {}});
  const Shader shader = test::make_shader(*device, "s", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  const Buffer buffer = device->create_buffer({.name = "b", .size_bytes = 64});
  std::vector<glm::vec3> positions(4);
  const std::vector<std::uint32_t> indices = {0, 1, 2, 2, 3, 0};
  const std::vector<glm::vec2> uvs(4);
  const Batch quad = device->create_batch({"quad", positions, positions, indices, uvs});
  EXPECT_EQ(device->counters().textures_made, 1U);
  EXPECT_EQ(device->counters().shaders_made, 1U);
  std::uint64_t bytes = 4 * 12 + 4 * 12 + 6 * 4 + 4 * 8;
  EXPECT_EQ(device->counters().upload_bytes, bytes);
  device->update(buffer, glm::vec4(0));
  device->upload(texture, 0, std::vector<std::byte>(16));
  bytes += 16 + 16;
  EXPECT_EQ(device->counters().upload_bytes, bytes);

  CommandList list;
  const glm::vec4 value(1);
  list.update(buffer, 16, std::as_bytes(std::span(&value, 1)));
  list.begin_pass("one", framebuffer, {});
  list.set_shader(shader.id());
  list.set_state(State::WriteColor);
  test::push_constants(list, shader, value);
  test::append_draw(list, quad, 3);
  test::append_draw(list, quad, 1);
  list.end_pass();
  list.begin_pass("two", framebuffer, {});
  list.set_shader(shader.id());
  list.set_state(State::WriteColor);
  list.draw_procedural(6, 5);
  list.end_pass();
  for (std::uint64_t times = 1; times <= 2; times++) {
    device->submit(list);
    const Counters &counters = device->counters();
    EXPECT_EQ(counters.passes, 2 * times);
    EXPECT_EQ(counters.shader_binds, 2 * times);
    EXPECT_EQ(counters.draws, 3 * times);
    EXPECT_EQ(counters.instances, (3 + 1 + 5) * times);
    EXPECT_EQ(counters.triangles, (2 * 3 + 2 * 1 + 2 * 5) * times);
    const std::uint64_t submitted = 16 + 2 * sizeof(DrawIndirect) + 4 * sizeof(DrawInstance);
    EXPECT_EQ(counters.upload_bytes, bytes + submitted * times);
  }
}

TEST(Device, CountsOfPassesDoNotGrowWithTheirNames)
{
  const auto device = create_null_device();
  const Texture texture = device->create_texture({.name = "t"});
  const Framebuffer framebuffer = device->create_framebuffer({"f", {{&texture}}, {}});
  CommandList list;
  for (int i = 0; i < 5000; i++) {
    list.begin_pass(fmt::format("shadow of lamp {}", i), framebuffer, {});
    list.end_pass();
  }
  device->submit(list);
  EXPECT_EQ(device->pass_counts().size(), Device::pass_name_max + 1);
  EXPECT_EQ(device->pass_counts().at(Device::other_passes), 5000 - Device::pass_name_max);
  EXPECT_EQ(device->pass_counts().at("shadow of lamp 7"), 1U);
}

TEST(Device, RefusesShadersWithMoreStorageBlocksThanAStageHas)
{
  Limits limits;
  limits.stages[std::size_t(ShaderStage::Vertex)].storage_block_max = 0;
  limits.stages[std::size_t(ShaderStage::Fragment)].storage_block_max = 1;
  const auto device = create_null_device(limits);
  const auto block = [](int slot) {
    return fmt::format("layout(std140, binding = {0}) readonly buffer block_{0} {{ vec4 v_{0}; }};\n", slot);
  };
  const std::string plain_vert = "void main() { gl_Position = vec4(0); }\n";
  const std::string reading_vert = block(0) + "void main() { gl_Position = v_0; }\n";
  const std::string plain_frag = "layout(location = 0) out vec4 c;\nvoid main() { c = vec4(0); }\n";
  const std::string one_frag = block(1) + "layout(location = 0) out vec4 c;\nvoid main() { c = v_1; }\n";
  const std::string two_frag =
      block(1) + block(2) + "layout(location = 0) out vec4 c;\nvoid main() { c = v_1 + v_2; }\n";
  EXPECT_TRUE(test::make_shader(*device, "fits", plain_vert, one_frag));
  expect_refused(*device, [&] { static_cast<void>(test::make_shader(*device, "v", reading_vert, plain_frag)); },
                 {"shader 'v'", "1 storage blocks", "vertex stage", "supports 0"});
  expect_refused(*device, [&] { static_cast<void>(test::make_shader(*device, "f", plain_vert, two_frag)); },
                 {"shader 'f'", "2 storage blocks", "fragment stage", "supports 1"});
}

TEST(Device, RefusesShadersWithMoreSamplersBlocksOrVaryingsThanTheDeviceHas)
{
  const auto fragment = [](std::string_view declared, int count) {
    std::string text;
    std::string sum = "vec4(0)";
    for (int i = 0; i < count; i++) {
      text += fmt::format(fmt::runtime(declared), i);
      sum += declared.find("sampler") == declared.npos ? fmt::format(" + v_{}", i)
                                                       : fmt::format(" + texture(v_{}, vec2(0))", i);
    }
    return text + "layout(location = 0) out vec4 c;\nvoid main() { c = " + sum + "; }\n";
  };
  const auto passes = [](std::string_view type, int location) {
    return std::pair(
        fmt::format("layout(location = {}) out {} v;\nvoid main() {{ v = {}(1); gl_Position = vec4(0); }}\n", location,
                    type, type),
        fmt::format("layout(location = {}) in {} v;\nlayout(location = 0) out vec4 c;\n"
                    "void main() {{ c = vec4(v[0], v[1]); }}\n",
                    location, type));
  };
  const std::string plain_vert = "void main() { gl_Position = vec4(0); }\n";
  const std::string_view sampler = "layout(binding = {0}) uniform sampler2D v_{0};\n";
  const std::string_view block = "layout(std140, binding = {0}) uniform block_{0} {{ vec4 v_{0}; }};\n";
  for (const int max : {3, 16, 17}) {
    Limits limits;
    limits.stages[std::size_t(ShaderStage::Fragment)].sampler_max = max;
    limits.stages[std::size_t(ShaderStage::Fragment)].uniform_block_max = max - 1;
    limits.varying_location_max = max;
    const auto device = create_null_device(limits);
    static_cast<void>(test::make_shader(*device, "s", plain_vert, fragment(sampler, max)));
    expect_refused(
        *device, [&] { static_cast<void>(test::make_shader(*device, "s", plain_vert, fragment(sampler, max + 1))); },
        {"shader 's'", fmt::format("{} samplers", max + 1), "fragment stage", fmt::format("supports {}", max)});
    static_cast<void>(test::make_shader(*device, "b", plain_vert, fragment(block, max - 1)));
    expect_refused(
        *device, [&] { static_cast<void>(test::make_shader(*device, "b", plain_vert, fragment(block, max))); },
        {"shader 'b'", fmt::format("{} uniform blocks", max), "fragment stage", fmt::format("supports {}", max - 1)});
    // A matrix takes a location for each column.
    const auto [fitting_vert, fitting_frag] = passes("mat2", max - 2);
    static_cast<void>(test::make_shader(*device, "v", fitting_vert, fitting_frag));
    const auto too_long = passes("mat2", max - 1);
    expect_refused(*device,
                   [&] { static_cast<void>(test::make_shader(*device, "v", too_long.first, too_long.second)); },
                   {"shader 'v'", fmt::format("{} locations", max + 1), fmt::format("supports {}", max)});
  }
}

TEST(NullDevice, ReadsZerosAndTakesNoTime)
{
  const auto device = create_null_device();
  const Texture texture = device->create_texture({.name = "t", .format = Format::RGBA16F, .width = 3, .height = 5});
  const std::vector<std::byte> texels = device->read(texture);
  EXPECT_EQ(texels, std::vector<std::byte>(3 * 5 * 8));
  const TimerQuery timer = device->create_timer_query("t");
  device->time_begin(timer);
  device->time_end(timer);
  EXPECT_FALSE(device->take_seconds(timer));
  EXPECT_FALSE(device->description().empty());
}

using DeviceInternalErrorTest = testing::Test;

TEST(DeviceInternalErrorTest, BrokenContractsAreAssertionsWithValues)
{
  const auto device = create_null_device();
  const Texture texture = device->create_texture({.name = "picture", .width = 2, .height = 2});
  Buffer buffer = device->create_buffer({.name = "block", .size_bytes = 16});
  test::expect_internal_error([&] { device->update(buffer, 8, std::vector<std::byte>(16)); },
                              "block.*16 bytes at 8.*16");
  test::expect_internal_error([&] { device->upload(texture, 0, std::vector<std::byte>(15)); }, "picture.*15 bytes");
  test::expect_internal_error([&] { static_cast<void>(device->read(texture, 1)); }, "picture.*layer 1");
  const std::vector<glm::vec3> positions(3);
  const std::vector<std::uint32_t> indices = {0, 1, 3};
  test::expect_internal_error(
      [&] {
        static_cast<void>(device->create_batch({"mesh", positions, {}, indices}));
      },
      "mesh.*3 vertices");
  const std::vector<glm::vec2> uvs(2);
  test::expect_internal_error(
      [&] {
        static_cast<void>(device->create_batch({"mesh", positions, {}, {}, uvs}));
      },
      "mesh.*16 bytes of attribute 3 for 3 positions");
  test::expect_internal_error(
      [&] {
        static_cast<void>(device->create_batch({"mesh", positions, std::span(positions).first(2), {}}));
      },
      "mesh.*24 bytes of attribute 1 for 3 positions");
  const Buffer moved = std::move(buffer);
  // NOLINTNEXTLINE(bugprone-use-after-move): what is asked here.
  test::expect_internal_error([&] { device->update(buffer, 0, std::vector<std::byte>(16)); }, "does not hold");
}

TEST(TextureDesc, SizeIsOfAllLevelsAndLayers)
{
  EXPECT_EQ((TextureDesc{.name = "t", .format = Format::RGBA8, .width = 5, .height = 3}.size_bytes()), 60U);
  EXPECT_EQ((TextureDesc{
                .name = "t", .kind = TextureKind::Array, .format = Format::R16F, .width = 4, .height = 2, .layers = 3}
                 .size_bytes()),
            48U);
  // 8x2, 4x1, 2x1, 1x1 of 16 bytes.
  EXPECT_EQ(
      (TextureDesc{.name = "t", .format = Format::RGBA32F, .width = 8, .height = 2, .mip_levels = 4}.size_bytes()),
      (16U + 4U + 2U + 1U) * 16U);
  EXPECT_EQ(
      (TextureDesc{
          .name = "t", .kind = TextureKind::Array, .format = Format::Depth32F, .width = 2, .height = 2, .layers = 12}
           .size_bytes()),
      4U * 4U * 12U);
}

TEST(Format, TexelsAreAsLargeAsTheirChannels)
{
  EXPECT_EQ(texel_size_bytes(Format::RGBA8), 4);
  EXPECT_EQ(texel_size_bytes(Format::SRGB8A8), 4);
  EXPECT_EQ(texel_size_bytes(Format::RGBA16F), 8);
  EXPECT_EQ(texel_size_bytes(Format::RGBA32F), 16);
  EXPECT_EQ(texel_size_bytes(Format::R16F), 2);
  EXPECT_EQ(texel_size_bytes(Format::R32F), 4);
  EXPECT_EQ(texel_size_bytes(Format::RG32F), 8);
  EXPECT_EQ(texel_size_bytes(Format::Depth32F), 4);
  EXPECT_EQ(texel_size_bytes(Format::Depth16), 2);
  EXPECT_TRUE(is_depth(Format::Depth32F));
  EXPECT_TRUE(is_depth(Format::Depth16));
  EXPECT_FALSE(is_depth(Format::R32F));
}

TEST(Device, RefusesConstantsThatAShaderLacksByName)
{
  const auto device = create_null_device();
  const std::string fragment =
      std::string(
          "SPECIALIZATION_CONSTANT(0) const int taps = 4;\nSPECIALIZATION_CONSTANT(1) const float scale = 1.0;\n") +
      test::COLOR_FRAG;
  const auto make = [&](const std::vector<ShaderConstant> &constants, const std::string &text) {
    return test::make_shader(*device, "lit", test::CLIP_SPACE_VERT, text, "", constants);
  };
  expect_refused(*device,
                 [&] {
                   make({{"tap", 1}}, fragment);
                 },
                 {"shader 'lit'", "no specialisation constant 'tap'", "taps, scale"});
  expect_refused(*device, [&] { make({{"tap", 1}}, test::COLOR_FRAG); }, {"shader 'lit'", "'tap'", "it has: none"});
  expect_refused(*device, [&] { make({{"scale", 1}}, fragment); }, {"shader 'lit'", "'scale' has the type float"});
  EXPECT_EQ(device->live(make({{"taps", 9}}, fragment)).detail, "taps=9");
}

TEST(Device, ProgramsWithOtherConstantsAreNotShared)
{
  const auto device = create_null_device();
  int made_count = 0;
  const auto share = [&](std::int32_t value) {
    const ShaderDesc desc{"lit", "vert", "", "frag", {}, {{"taps", value}}};
    return device->shared_shader(desc, "", [&](SharedShader &made) {
      made_count++;
      made.shader = test::make_shader(*device, "lit", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
    });
  };
  const auto four = share(4);
  const auto nine = share(9);
  EXPECT_EQ(share(4), four);
  EXPECT_NE(four, nine);
  EXPECT_EQ(made_count, 2);
}

TEST(Live, ListsEachResourceWithItsSizeAndWrittenBytes)
{
  const auto device = create_null_device();
  EXPECT_EQ(device->memory_bytes(), 0U);
  const Texture layers = device->create_texture(
      {.name = "layers", .kind = TextureKind::Array, .format = Format::Depth32F, .width = 8, .height = 4, .layers = 3});
  // 4 x 4, 2 x 2 and 1.
  const Texture levels = device->create_texture({.name = "levels", .width = 4, .height = 4, .mip_levels = 3});
  const Framebuffer framebuffer = device->create_framebuffer({"f", {{&levels}}, {}});
  const Buffer buffer = device->create_buffer({.name = "buffer", .size_bytes = 64});
  const std::vector<glm::vec3> positions(3);
  const std::vector<std::uint32_t> indices = {0, 1, 2};
  const Shader shader = test::make_shader(*device, "shader", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  {
    const Batch batch = device->create_batch({"batch", positions, positions, indices});
    EXPECT_EQ(device->live(batch).size_bytes, 84U) << "two times three vectors and three indices";
    EXPECT_EQ(device->live(batch).upload_bytes, 84U);
    EXPECT_EQ(device->memory_bytes(), 84U + 384U + 84U + 64U);
  }
  EXPECT_EQ(device->live(layers).detail, "8x4x3 Depth32F");
  EXPECT_EQ(device->live(layers).size_bytes, 8U * 4U * 3U * 4U);
  EXPECT_EQ(device->live(levels).detail, "4x4 RGBA8");
  EXPECT_EQ(device->live(levels).size_bytes, 4U * (16U + 4U + 1U));
  device->upload(levels, 0, std::vector<std::byte>(64));
  device->update(buffer, glm::vec4(0));
  CommandList list;
  const glm::vec4 value(1);
  list.update(buffer, 16, std::as_bytes(std::span(&value, 1)));
  list.begin_pass("pass", framebuffer, {});
  list.end_pass();
  device->submit(list);
  device->submit(list);
  EXPECT_EQ(device->live(buffer).upload_bytes, 3U * 16U);
  EXPECT_EQ(device->live(levels).upload_bytes, 64U);
  EXPECT_EQ(device->live(layers).upload_bytes, 0U);
  EXPECT_EQ(device->pass_counts(), (PassCounts{{"pass", 2}}));
  EXPECT_EQ(device->live().size(), 5U) << "the batch is gone";
  EXPECT_EQ(device->memory_bytes(), 384U + 84U + 64U);
}

}  // namespace
}  // namespace gnomon::gpu
