// SPDX-License-Identifier: MIT
#include "allocated.hh"
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"

#include "eevee_shadow_shared.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace gnomon::gpu {
namespace {

using test::append_draw;
using test::make_shader;

class TextureGpu : public test::GpuDeviceTest {
 protected:
  /** Evaluates the GLSL \a expression, a vec4, for each of \a inputs; `picture` of \a sampler_type is bound. */
  std::vector<glm::vec4> evaluated(const std::string &sampler_type, const std::string &expression,
                                   const std::vector<glm::vec4> &inputs, const Texture &texture, const Sampler &sampler)
  {
    const Texture result =
        device->create_texture({.name = "result", .format = Format::RGBA32F, .width = int(inputs.size()), .height = 1});
    const Framebuffer framebuffer = device->create_framebuffer({"result", {{&result}}, {}});
    const Buffer store = device->create_buffer({"input_block", BufferKind::Storage, inputs.size() * sizeof(glm::vec4)});
    device->update(store, 0, std::as_bytes(std::span(inputs)));
    const Shader shader =
        make_shader(*device, "evaluate", test::CLIP_SPACE_VERT,
                    "layout(binding = 16) uniform " + sampler_type +
                        " picture;\n"
                        "layout(std140, binding = 0) readonly buffer input_block { vec4 inputs[]; };\n"
                        "layout(location = 0) out vec4 result;\n"
                        "void main()\n{\n  vec4 v = inputs[int(gl_FragCoord.x)];\n  result = " +
                        expression + ";\n}\n");
    const Batch full = test::full_triangle(*device, 0.5F);
    CommandList list;
    list.begin_pass("evaluate", framebuffer, {});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    list.bind_storage(0, {store.id()});
    list.bind_texture(16, texture.id(), sampler.id());
    append_draw(list, full);
    list.end_pass();
    device->submit(list);
    return gpu::read_as<glm::vec4>(*device, result);
  }

  template <typename T>
  void upload(const Texture &texture, int layer, const std::vector<T> &values)
  {
    device->upload(texture, layer, std::as_bytes(std::span(values)));
  }
};

TEST_F(TextureGpu, UploadComesBackAsItWas)
{
  std::mt19937 random(5);
  for (const Format format : {Format::RGBA8, Format::SRGB8A8, Format::RGBA16F, Format::RGBA32F, Format::R16F,
                              Format::R32F, Format::Depth32F}) {
    for (const TextureKind kind : {TextureKind::Flat, TextureKind::Array, TextureKind::Buffer}) {
      if (kind == TextureKind::Buffer && (is_depth(format) || format == Format::SRGB8A8)) {
        continue;
      }
      SCOPED_TRACE(fmt::format("{} kind {}", to_string(format), int(kind)));
      const Texture texture = device->create_texture({.name = "round trip",
                                                      .kind = kind,
                                                      .format = format,
                                                      .width = 7,
                                                      .height = kind == TextureKind::Buffer ? 1 : 5,
                                                      .layers = kind == TextureKind::Array ? 3 : 1});
      std::vector<std::vector<std::byte>> layers;
      for (int layer = 0; layer < texture.desc().layers; layer++) {
        const std::size_t texel_count = std::size_t(7 * texture.desc().height);
        std::vector<std::byte> bytes;
        const auto append = [&](const auto &value) {
          const auto *first = reinterpret_cast<const std::byte *>(&value);
          bytes.insert(bytes.end(), first, first + sizeof(value));
        };
        std::uniform_real_distribution<float> uniform(0, 1);
        for (std::size_t i = 0; i < texel_count * std::size_t(gpu::texel_size_bytes(format)); i++) {
          switch (format) {
            case Format::RGBA8:
            case Format::SRGB8A8: append(std::byte(random())); break;
            case Format::RGBA16F:
            case Format::R16F:
              append(glm::packHalf1x16(uniform(random) * 100));
              i += 1;
              break;
            default:
              append(uniform(random));
              i += 3;
              break;
          }
        }
        device->upload(texture, layer, bytes);
        layers.push_back(std::move(bytes));
      }
      for (int layer = 0; layer < texture.desc().layers; layer++) {
        EXPECT_EQ(device->read(texture, layer), layers[std::size_t(layer)]) << "layer " << layer;
      }
    }
  }
}

TEST_F(TextureGpu, TexelsOfABufferAreReadByIndexAndWrittenFromTheFirst)
{
  // More than the 65 536 texels that each device has, where it has more.
  const int count = std::min(device->limits().buffer_texels_max, 70000);
  const Texture texture = device->create_texture(
      {.name = "texels", .kind = TextureKind::Buffer, .format = Format::RGBA32F, .width = count});
  std::vector<glm::vec4> texels(std::size_t(count), glm::vec4(0));
  for (std::size_t i = 0; i < texels.size(); i++) {
    texels[i] = glm::vec4(float(i), 1.0F / float(i + 1), -float(i), 1e-30F);
  }
  upload(texture, 0, texels);
  const Sampler nearest = device->create_sampler({.name = "nearest"});
  const std::vector<glm::vec4> places = {{0, 0, 0, 0}, {1, 0, 0, 0}, {65535, 0, 0, 0}, {count - 1, 0, 0, 0}};
  const auto values = [&] {
    return evaluated("samplerBuffer", "texelFetch(picture, int(v.x))", places, texture, nearest);
  };
  EXPECT_EQ(values(), (std::vector<glm::vec4>{texels[0], texels[1], texels[65535], texels.back()}));
  upload<glm::vec4>(texture, 0, {glm::vec4(7)});
  EXPECT_EQ(values(), (std::vector<glm::vec4>{glm::vec4(7), texels[1], texels[65535], texels.back()}));
}

// hazards.md: llvmpipe changes what earlier draws read if it does not know that a buffer is read.
TEST_F(TextureGpu, DrawsReadTheTexelsOfABufferAsOfTheirSubmission)
{
  const Texture texture =
      device->create_texture({.name = "texels", .kind = TextureKind::Buffer, .format = Format::R32F, .width = 4});
  const Sampler nearest = device->create_sampler({.name = "nearest"});
  const Texture result =
      device->create_texture({.name = "result", .format = Format::R32F, .width = 256, .height = 256});
  const Framebuffer framebuffer = device->create_framebuffer({"result", {{&result}}, {}});
  const Shader shader = make_shader(*device, "sum", test::CLIP_SPACE_VERT,
                                    "layout(binding = 16) uniform samplerBuffer picture;\n"
                                    "layout(location = 0) out float result;\n"
                                    "void main()\n{\n  result = texelFetch(picture, int(gl_FragCoord.x) & 3).r;\n}\n");
  const Batch full = test::full_triangle(*device, 0.5F);
  for (int i = 1; i <= 16; i++) {
    upload<float>(texture, 0, std::vector<float>(4, float(i)));
    CommandList list;
    list.begin_pass("sum", framebuffer, {.color_load = i == 1 ? LoadAction::Clear : LoadAction::Load});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor | State::BlendAdd);
    list.bind_texture(16, texture.id(), nearest.id());
    append_draw(list, full);
    list.end_pass();
    device->submit(list);
  }
  EXPECT_EQ(gpu::read_as<float>(*device, result), std::vector<float>(256 * 256, 136.0F));
}

TEST_F(TextureGpu, RowsStandFromTheBottom)
{
  const Texture texture = device->create_texture({.name = "rows", .format = Format::R32F, .width = 1, .height = 2});
  upload<float>(texture, 0, {1, 2});
  const Sampler nearest = device->create_sampler({.name = "nearest"});
  const auto values =
      evaluated("sampler2D", "texture(picture, v.xy)", {{0.5F, 0.25F, 0, 0}, {0.5F, 0.75F, 0, 0}}, texture, nearest);
  EXPECT_EQ(values[0].r, 1);
  EXPECT_EQ(values[1].r, 2);
}

TEST_F(TextureGpu, FilterIsTheNearestOrTheBlend)
{
  const Texture texture = device->create_texture({.name = "ramp", .format = Format::R32F, .width = 4, .height = 1});
  upload<float>(texture, 0, {0, 1, 2, 3});
  const std::vector<glm::vec4> inputs = {{0.375F, 0.5F, 0, 0}, {0.45F, 0.5F, 0, 0}, {0.5F, 0.5F, 0, 0}};
  const Sampler nearest = device->create_sampler({.name = "nearest"});
  const Sampler linear = device->create_sampler({.name = "linear", .filter = Filter::Linear});
  const auto steps = evaluated("sampler2D", "texture(picture, v.xy)", inputs, texture, nearest);
  EXPECT_EQ(steps[0].r, 1);
  EXPECT_EQ(steps[1].r, 1);
  const auto ramp = evaluated("sampler2D", "texture(picture, v.xy)", inputs, texture, linear);
  for (std::size_t i = 0; i < inputs.size(); i++) {
    // Texel centres are at halves; weights have eight bits at least.
    EXPECT_NEAR(ramp[i].r, inputs[i].x * 4 - 0.5F, 1.0F / 256);
  }
}

/** Bands of four rows of 0 and 1 in turn, below a footprint of 8 texels in a row and one across: its own, or both. */
TEST_F(TextureGpu, AnisotropyFiltersAlongTheFootprintOnly)
{
  if (device->limits().anisotropy_max < 8) {
    GTEST_SKIP() << "the device has no anisotropic filter";
  }
  constexpr int edge = 64;
  const Texture texture =
      device->create_texture({.name = "rows", .format = Format::RGBA8, .width = edge, .height = edge, .mip_levels = 7});
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < edge * edge; i++) {
    texels.insert(texels.end(), 4, i / edge / 4 % 2 == 0 ? 0 : 255);
  }
  upload(texture, 0, texels);
  device->generate_mipmaps(texture);
  SamplerDesc desc{.name = "linear", .filter = Filter::Linear, .mip = MipFilter::Linear};
  // The derivatives of the place: 8 texels along u for a pixel to the right, and one along v for a pixel up.
  const auto band = [&](int index, const Sampler &sampler) {
    const double middle = 4.0 * index + 2.0 - 0.5;
    const std::string place = fmt::format("vec2(8.0 * gl_FragCoord.x, gl_FragCoord.y + {:.1f}) / 64.0", middle);
    return evaluated("sampler2D", "texture(picture, " + place + ")", {glm::vec4(0.0F), glm::vec4(0.0F)}, texture,
                     sampler)[0]
        .r;
  };
  const Sampler isotropic = device->create_sampler(desc);
  // Means of 8 bits.
  EXPECT_NEAR(band(4, isotropic), 0.5F, 1.0F / 255);
  EXPECT_NEAR(band(5, isotropic), 0.5F, 1.0F / 255);
  desc.anisotropy = 8;
  const Sampler anisotropic = device->create_sampler(desc);
  // OpenGL leaves the method open, which may read neighbouring rows, too.
  EXPECT_LT(band(4, anisotropic), 0.25F);
  EXPECT_GT(band(5, anisotropic), 0.75F);
}

/** sRGB, IEC 61966-2-1. */
float srgb_decoded(float encoded)
{
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

TEST_F(TextureGpu, SrgbIsDecodedBeforeItIsFilteredAndItsAlphaIsLinear)
{
  const Texture texture = device->create_texture({.name = "srgb", .format = Format::SRGB8A8, .width = 2, .height = 1});
  upload<std::uint8_t>(texture, 0, {10, 100, 200, 51, 250, 100, 0, 255});
  const Sampler linear = device->create_sampler({.name = "linear", .filter = Filter::Linear});
  const auto values =
      evaluated("sampler2D", "texture(picture, v.xy)", {{0.25F, 0.5F, 0, 0}, {0.5F, 0.5F, 0, 0}}, texture, linear);
  // OpenGL allows an error of half a step of eight bits for a decoded value.
  const float tolerance = 0.5F / 255;
  EXPECT_NEAR(values[0].r, srgb_decoded(10 / 255.0F), tolerance);
  EXPECT_NEAR(values[0].g, srgb_decoded(100 / 255.0F), tolerance);
  EXPECT_NEAR(values[0].b, srgb_decoded(200 / 255.0F), tolerance);
  EXPECT_NEAR(values[0].a, 0.2F, tolerance);
  EXPECT_NEAR(values[1].r, 0.5F * (srgb_decoded(10 / 255.0F) + srgb_decoded(250 / 255.0F)), tolerance);
  EXPECT_NEAR(values[1].a, 0.6F, tolerance);
}

TEST_F(TextureGpu, MipmapsAreMeansOfLight)
{
  const Texture texture =
      device->create_texture({.name = "checks", .format = Format::SRGB8A8, .width = 4, .height = 4, .mip_levels = 3});
  std::vector<std::uint8_t> texels;
  for (int i = 0; i < 16; i++) {
    const std::uint8_t value = (i + i / 4) % 2 == 0 ? 255 : 0;
    texels.insert(texels.end(), {value, value, value, value});
  }
  upload(texture, 0, texels);
  device->generate_mipmaps(texture);
  const Sampler sampler = device->create_sampler({.name = "mip", .mip = MipFilter::Nearest});
  const auto values = evaluated("sampler2D", "textureLod(picture, v.xy, v.z)",
                                {{0.25F, 0.25F, 1, 0}, {0.75F, 0.25F, 1, 0}, {0.5F, 0.5F, 2, 0}}, texture, sampler);
  for (const glm::vec4 &value : values) {
    // Half of the light, which is 188 of 255 in sRGB; half of the code would be a fifth of the light.
    EXPECT_NEAR(value.r, 0.5F, 0.005F);
    EXPECT_NEAR(value.a, 0.5F, 0.005F);
  }
}

TEST_F(TextureGpu, MipFilterChoosesAndBlendsLevels)
{
  const Texture texture =
      device->create_texture({.name = "step", .format = Format::R32F, .width = 2, .height = 1, .mip_levels = 2});
  upload<float>(texture, 0, {0, 1});
  device->generate_mipmaps(texture);
  const std::vector<glm::vec4> inputs = {{0.25F, 0.5F, 0.75F, 0}};
  const auto value = [&](const SamplerDesc &desc) {
    const Sampler sampler = device->create_sampler(desc);
    return evaluated("sampler2D", "textureLod(picture, v.xy, v.z)", inputs, texture, sampler)[0].r;
  };
  EXPECT_EQ(value({.name = "none"}), 0.0F);
  EXPECT_EQ(value({.name = "nearest", .mip = MipFilter::Nearest}), 0.5F);
  EXPECT_NEAR(value({.name = "linear", .mip = MipFilter::Linear}), 0.375F, 1.0F / 256);
}

TEST_F(TextureGpu, MinifiedFilterIsItsOwn)
{
  const Texture texture = device->create_texture({.name = "ramp", .format = Format::R32F, .width = 4, .height = 1});
  upload<float>(texture, 0, {0, 1, 2, 3});
  const Sampler sampler = device->create_sampler({.name = "s", .minified = Filter::Linear});
  // The same position, magnified and minified.
  const auto values = evaluated("sampler2D", "textureGrad(picture, v.xy, vec2(v.z, 0), vec2(0, v.z))",
                                {{0.45F, 0.5F, 0.01F, 0}, {0.45F, 0.5F, 4, 0}}, texture, sampler);
  EXPECT_EQ(values[0].r, 1);
  EXPECT_NEAR(values[1].r, 1.3F, 1.0F / 256);
}

TEST_F(TextureGpu, MirroredRepeatTurnsEverySecondTimeOneAxisAlone)
{
  const Texture texture = device->create_texture({.name = "ramp", .format = Format::R32F, .width = 4, .height = 2});
  upload<float>(texture, 0, {0, 1, 2, 3, 10, 11, 12, 13});
  const Sampler sampler = device->create_sampler({.name = "mirror", .wrap_u = Wrap::MirroredRepeat});
  const auto values =
      evaluated("sampler2D", "texture(picture, v.xy)",
                {{-0.1F, 0.2F, 0, 0}, {1.1F, 0.2F, 0, 0}, {2.1F, 0.2F, 0, 0}, {0.1F, 1.2F, 0, 0}}, texture, sampler);
  EXPECT_EQ(values[0].r, 0);
  EXPECT_EQ(values[1].r, 3);
  EXPECT_EQ(values[2].r, 0);
  EXPECT_EQ(values[3].r, 10);
}

TEST_F(TextureGpu, WrapClampsOrRepeats)
{
  const Texture texture = device->create_texture({.name = "ramp", .format = Format::R32F, .width = 4, .height = 1});
  upload<float>(texture, 0, {0, 1, 2, 3});
  const std::vector<glm::vec4> inputs = {{-0.4F, 0.5F, 0, 0}, {1.4F, 0.5F, 0, 0}};
  const Sampler clamp = device->create_sampler({.name = "clamp"});
  const Sampler repeat = device->create_sampler({.name = "repeat", .wrap_u = Wrap::Repeat});
  const auto clamped = evaluated("sampler2D", "texture(picture, v.xy)", inputs, texture, clamp);
  EXPECT_EQ(clamped[0].r, 0);
  EXPECT_EQ(clamped[1].r, 3);
  const auto repeated = evaluated("sampler2D", "texture(picture, v.xy)", inputs, texture, repeat);
  EXPECT_EQ(repeated[0].r, 2);
  EXPECT_EQ(repeated[1].r, 1);
}

TEST_F(TextureGpu, DepthComparisonIsLitWhereTheReferenceIsNearerOrAsNear)
{
  const Texture texture = device->create_texture({.name = "map", .format = Format::Depth32F, .width = 2, .height = 2});
  upload<float>(texture, 0, {0.5F, 0.5F, 0.5F, 0.5F});
  const Sampler sampler = device->create_sampler({.name = "shadow", .is_depth_comparison = true});
  const auto values = evaluated("sampler2DShadow", "vec4(texture(picture, v.xyz))",
                                {{0.25F, 0.25F, 0.25F, 0},
                                 {0.25F, 0.25F, std::nextafter(0.5F, 0.0F), 0},
                                 {0.25F, 0.25F, 0.5F, 0},
                                 {0.25F, 0.25F, std::nextafter(0.5F, 1.0F), 0},
                                 {0.25F, 0.25F, 1, 0}},
                                texture, sampler);
  const std::array<float, 5> expected = {0, 0, 1, 1, 1};
  for (std::size_t i = 0; i < expected.size(); i++) {
    EXPECT_EQ(values[i].r, expected[i]) << i;
  }
}

TEST_F(TextureGpu, LinearDepthComparisonBlendsFourAnswers)
{
  const Texture texture = device->create_texture({.name = "map", .format = Format::Depth32F, .width = 2, .height = 2});
  // The reference 0.5 is behind the first layer only.
  upload<float>(texture, 0, {0.75F, 0.25F, 0.25F, 0.25F});
  const Sampler sampler =
      device->create_sampler({.name = "shadow", .filter = Filter::Linear, .is_depth_comparison = true});
  const auto values =
      evaluated("sampler2DShadow", "vec4(texture(picture, v.xyz))",
                {{0.25F, 0.25F, 0.5F, 0}, {0.5F, 0.5F, 0.5F, 0}, {0.5F, 0.25F, 0.5F, 0}, {0.75F, 0.75F, 0.5F, 0}},
                texture, sampler);
  const std::array<float, 4> expected = {0, 0.75F, 0.5F, 1};
  for (std::size_t i = 0; i < expected.size(); i++) {
    EXPECT_NEAR(values[i].r, expected[i], 1.0F / 256) << i;
  }
}

TEST_F(TextureGpu, DepthComparisonOfAnArrayNamesTheLayer)
{
  const Texture texture = device->create_texture(
      {.name = "maps", .kind = TextureKind::Array, .format = Format::Depth32F, .width = 2, .height = 2, .layers = 3});
  for (int layer = 0; layer < 3; layer++) {
    upload(texture, layer, std::vector<float>(4, 0.25F * float(layer + 1)));
  }
  const Sampler sampler = device->create_sampler({.name = "shadow", .is_depth_comparison = true});
  const auto values =
      evaluated("sampler2DArrayShadow", "vec4(texture(picture, v))",
                {{0.5F, 0.5F, 0, 0.6F}, {0.5F, 0.5F, 1, 0.6F}, {0.5F, 0.5F, 2, 0.6F}}, texture, sampler);
  EXPECT_EQ(values[0].r, 1);
  EXPECT_EQ(values[1].r, 1);
  EXPECT_EQ(values[2].r, 0);
}

TEST_F(TextureGpu, TrimGivesBackWhatTheDriverKeepsOfDestroyedTextures)
{
  if (test::allocated_mib() == 0.0) {
    GTEST_SKIP() << "the allocator does not count";
  }
  constexpr int texture_count = 24;
  const auto draw_into_textures = [&] {
    std::vector<Texture> textures;
    std::vector<Framebuffer> framebuffers;
    CommandList list;
    for (int i = 0; i < texture_count; i++) {
      textures.push_back(
          device->create_texture({.name = "big", .format = Format::RGBA32F, .width = 512, .height = 512}));
    }
    for (const Texture &texture : textures) {
      framebuffers.push_back(device->create_framebuffer({"big", {{&texture}}, {}}));
      list.begin_pass("clear", framebuffers.back(), {});
      list.end_pass();
    }
    device->submit(list);
  };
  // A first small draw, as the driver keeps what it makes for itself.
  const Texture small = device->create_texture({.name = "small", .format = Format::RGBA32F, .width = 4, .height = 4});
  const Framebuffer framebuffer = device->create_framebuffer({"small", {{&small}}, {}});
  CommandList list;
  list.begin_pass("clear", framebuffer, {});
  list.end_pass();
  device->submit(list);
  device->finish();
  const double before_mib = test::allocated_mib();
  double least_mib = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 4; i++) {
    draw_into_textures();
    device->trim();
    least_mib = std::min(least_mib, test::allocated_mib());
  }
  // The textures have 96 MiB. On a busy machine, a call may miss some, which the next one gives back. The driver's
  // queue itself grows by 1.4 MiB.
  EXPECT_LE(least_mib, before_mib + 8.0);
}

}  // namespace
}  // namespace gnomon::gpu
