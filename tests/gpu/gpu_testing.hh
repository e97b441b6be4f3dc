// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_read.hh"
#include "shader_check_reflection.hh"
#include "shader_files.hh"

#include <glm/gtc/packing.hpp>
#include <glm/packing.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace gnomon::test {

/** Message of the gpu::Error that \a action throws; empty if it throws none. */
template <typename Action>
std::string error_of(Action &&action)
{
  try {
    action();
  }
  catch (const gpu::Error &error) {
    return error.what();
  }
  return {};
}

/** \a action throws a gpu::InternalError whose message has a match of the regular \a expression. */
template <typename Action>
void expect_internal_error(Action &&action, const std::string &expression)
{
  try {
    action();
    ADD_FAILURE() << "no internal error of '" << expression << "'";
  }
  catch (const gpu::InternalError &error) {
    EXPECT_TRUE(std::regex_search(error.what(), std::regex(expression))) << error.what();
    EXPECT_NE(std::string(error.what()).find(fmt::format("{}:{}: {}", error.file(), error.line(), error.condition())),
              std::string::npos)
        << error.what();
  }
}

inline void expect_contains(std::string_view text, std::string_view part)
{
  EXPECT_NE(text.find(part), std::string_view::npos) << "'" << part << "' is not in:\n" << text;
}

/** The first line of a complete shader file. */
inline const std::string VERSION = "#version 450 core\n";

/** Shader files of a test, with the program's as a fallback. */
struct ShaderTexts {
  std::map<std::string, std::string, std::less<>> texts;

  /** Refers to this. */
  [[nodiscard]] gpu::ShaderFiles files() const
  {
    return [this](std::string_view path) -> std::optional<std::string_view> {
      const auto found = texts.find(path);
      return found == texts.end() ? shaders::file(path) : std::optional<std::string_view>(found->second);
    };
  }
};

/** A shader of texts without `#version`, which may use the slots, VERTEX_INDEX and INSTANCE_INDEX. */
inline gpu::Shader make_shader(gpu::Device &device, const std::string &name, const std::string &vertex,
                               const std::string &fragment, const std::string &geometry = "",
                               const std::vector<gpu::ShaderConstant> &constants = {})
{
  const std::string head = R"(#version 450 core
#include "shared/slots_shared.h"
#ifdef VULKAN
#define VERTEX_INDEX gl_VertexIndex
#define INSTANCE_INDEX gl_InstanceIndex
#else
#define VERTEX_INDEX gl_VertexID
#define INSTANCE_INDEX gl_InstanceID
#endif
)";
  const ShaderTexts texts{{{"vert", head + vertex}, {"geom", head + geometry}, {"frag", head + fragment}}};
  return device.create_shader({name, "vert", geometry.empty() ? "" : "geom", "frag", {}, constants}, texts.files(),
                              shader_check::reflect);
}

/** Vertices are clip coordinates; passes on the values of the draw's instance. */
inline constexpr const char *CLIP_SPACE_VERT = R"(
layout(location = ATTRIBUTE_POSITION) in vec3 position;
layout(location = ATTRIBUTE_DRAW_INSTANCE) in uvec2 draw_instance;
layout(location = 0) flat out uvec2 instance;
void main()
{
  gl_Position = vec4(position, 1.0);
  instance = draw_instance;
}
)";

/** A fragment shader with one colour, the push constant `color`. */
inline constexpr const char *COLOR_FRAG = R"(
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  vec4 color;
};
layout(location = 0) out vec4 out_color;
void main()
{
  out_color = color;
}
)";

/** Covers the target at depth \a z; counter-clockwise. */
inline gpu::Batch full_triangle(gpu::Device &device, float z, const std::string &name = "full")
{
  const std::array<glm::vec3, 3> positions = {glm::vec3(-1, -1, z), glm::vec3(3, -1, z), glm::vec3(-1, 3, z)};
  const std::array<std::uint32_t, 3> indices = {0, 1, 2};
  return device.create_batch({.name = name, .positions = positions, .normals = {}, .indices = indices});
}

/** Draws the batch \a count times, with instances (\a object, 0 … count - 1). */
inline void append_draw(gpu::CommandList &list, const gpu::Batch &batch, std::uint32_t count = 1,
                        std::uint32_t object = 0)
{
  const auto first_draw = std::uint32_t(list.draws.size());
  const gpu::BatchRange &range = batch.range();
  list.draws.push_back(
      {range.index_count, count, range.first_index, range.base_vertex, std::uint32_t(list.instances.size())});
  for (std::uint32_t i = 0; i < count; i++) {
    list.instances.push_back({object, i});
  }
  list.draw(first_draw, 1);
}

template <typename T>
void push_constants(gpu::CommandList &list, const gpu::Shader &shader, const T &value)
{
  list.push_constants(shader.interface().push_constant_slot, std::as_bytes(std::span(&value, 1)));
}

/** Reads any format as floats. Missing channels are 0. */
inline std::vector<glm::vec4> decoded_texels(gpu::Device &device, const gpu::Texture &texture, int layer = 0)
{
  const std::vector<std::byte> bytes = device.read(texture, layer);
  const auto texel_bytes = std::size_t(gpu::texel_size_bytes(texture.desc().format));
  std::vector<glm::vec4> values;
  for (std::size_t offset = 0; offset < bytes.size(); offset += texel_bytes) {
    const std::byte *texel = bytes.data() + offset;
    const auto as = [&]<typename T>(T value) {
      std::memcpy(&value, texel, sizeof(T));
      return value;
    };
    switch (texture.desc().format) {
      case gpu::Format::RGBA8:
      case gpu::Format::SRGB8A8: values.push_back(glm::unpackUnorm4x8(as(std::uint32_t()))); break;
      case gpu::Format::RGBA16F: values.push_back(glm::unpackHalf4x16(as(std::uint64_t()))); break;
      case gpu::Format::RGBA32F: values.push_back(as(glm::vec4())); break;
      case gpu::Format::R16F: values.emplace_back(glm::unpackHalf1x16(as(std::uint16_t())), 0, 0, 0); break;
      case gpu::Format::RG32F: values.emplace_back(as(glm::vec2()), 0, 0); break;
      case gpu::Format::Depth16: values.emplace_back(float(as(std::uint16_t())) / 65535.0F, 0, 0, 0); break;
      case gpu::Format::Host: ADD_FAILURE() << "a texture of the host cannot be read"; break;
      case gpu::Format::R32F:
      case gpu::Format::Depth32F: values.emplace_back(as(float()), 0, 0, 0); break;
    }
  }
  return values;
}

}  // namespace gnomon::test
