// SPDX-License-Identifier: MIT
#include "shader_check_reflection.hh"

#include "gpu/gpu_testing.hh"

#include "draw_object_shared.h"
#include "draw_view_shared.h"
#include "eevee_light_shared.h"
#include "eevee_material_shared.h"
#include "eevee_shadow_shared.h"
#include "slots_shared.h"

#include <fmt/format.h>

#include <algorithm>

namespace gnomon::shader_check {
namespace {

using test::error_of;
using test::expect_contains;
using test::ShaderTexts;
using test::VERSION;

const std::string EMPTY_MAIN = VERSION + "void main() {}\n";

/** Reflects a program of \a vertex, a complete file, and an empty fragment stage. */
gpu::ShaderInterface reflected(std::string vertex, const std::string &fragment = EMPTY_MAIN, ShaderTexts texts = {})
{
  texts.texts["vert"] = std::move(vertex);
  texts.texts["frag"] = fragment;
  return reflect("test", gpu::preprocess({"test", "vert", "", "frag", {}}, texts.files()));
}

TEST(Reflect, AnIncludeInABranchThatIsNotTakenDoesNotTakeTheFileFromOthers)
{
  const ShaderTexts texts{
      {{"lib", "float value = 1.0;\n"}, {"guarded", "#ifndef GUARDED\n#define GUARDED\n#include \"lib\"\n#endif\n"}}};
  for (const std::string branch :
       {"#ifdef NEVER\n#include \"lib\"\n#endif\n", "#ifdef NEVER\n#include \"guarded\"\n#endif\n",
        "#if 1\n#else\n#include \"lib\"\n#endif\n", "#if 1\n#include \"lib\"\n#endif\n", ""}) {
    EXPECT_EQ(error_of([&] {
                reflected(VERSION + branch +
                              "#include \"guarded\"\n#include \"lib\"\nvoid main() { gl_Position.x = value; }\n",
                          EMPTY_MAIN, texts);
              }),
              "")
        << branch;
  }
}

TEST(Reflect, AnObjectIsReadWhereAnyOfItsFieldsIs)
{
  const auto reads_object = [](const std::string &value) {
    return reflected(VERSION +
                     "layout(location = 0) in vec3 position;\nlayout(location = 2) in uvec2 draw_instance;\n"
                     "layout(location = 6) in vec4 color;\nlayout(location = 7) in mat4 matrix;\n"
                     "layout(location = 14) in uint value;\nlayout(location = 15) in uint other;\n"
                     "void main() { gl_Position = vec4(" +
                     value + "); }\n")
        .reads_object;
  };
  EXPECT_FALSE(reads_object("position, draw_instance.x")) << "those that are declared and not read are left out";
  EXPECT_FALSE(reads_object("color.xyz, other"));
  EXPECT_TRUE(reads_object("matrix[3]"));
  EXPECT_TRUE(reads_object("position, value"));
}

TEST(Reflect, MembersOfArraysAreThoseOfTheFirstElement)
{
  const gpu::ShaderInterface interface =
      reflected(VERSION +
                "struct Inner { vec3 a; float b; };\nstruct Outer { Inner inner[2]; float c; };\n"
                "layout(std140, binding = 0) uniform test_block { Outer outer[3]; float grid[2][3]; vec4 end; };\n"
                "void main() { gl_Position = end; }\n");
  std::vector<std::string> members;
  for (const gpu::ShaderInterface::Member &member : interface.bindings.at(0).members) {
    members.push_back(fmt::format("{} {} {}", member.name, member.offset_bytes, member.size_bytes));
  }
  EXPECT_EQ(members, (std::vector<std::string>{"outer[0].inner[0].a 0 12", "outer[0].inner[0].b 12 4",
                                               "outer[0].c 32 16", "grid[0] 144 48", "end 240 16"}));
}

TEST(Reflect, VaryingsAreCountedUpToTheLastLocation)
{
  const auto locations = [](const std::string &declarations) {
    return reflected(VERSION + declarations + "void main() { gl_Position = vec4(0); }\n").varying_locations;
  };
  EXPECT_EQ(locations(""), 0);
  EXPECT_EQ(locations("layout(location = 0) out float a;\n"), 1);
  EXPECT_EQ(locations("layout(location = 7) out vec4 a;\nlayout(location = 2) out vec2 b;\n"), 8);
  EXPECT_EQ(locations("layout(location = 3) out mat3 a;\n"), 6);
  EXPECT_EQ(locations("layout(location = 3) out vec2 a[5];\n"), 8);
}

/** Expects that the compile error of \a vertex names line \a line of \a path. */
void expect_error_at(const std::string &vertex, const ShaderTexts &texts, const std::string &path_and_line)
{
  const std::string message = error_of([&] { reflected(vertex, EMPTY_MAIN, texts); });
  expect_contains(message, "shader 'test', vertex stage");
  expect_contains(message, path_and_line + ":");
  expect_contains(message, "undeclared");
}

TEST(Reflect, ErrorNamesFileAndLineThroughNestedIncludes)
{
  const std::string wrong = "float f_wrong = undeclared_name;\n";
  const ShaderTexts fine{
      {{"outer", "#pragma once\nfloat a;\n#include \"inner\"\nfloat b;\n"}, {"inner", "float c;\n\nfloat d;\n"}}};
  // In a nested include; after it; in the file itself before and after the includes.
  ShaderTexts texts = fine;
  texts.texts["inner"] = "float c;\n\n" + wrong;
  expect_error_at(VERSION + "\n#include \"outer\"\nvoid main() {}\n", texts, "inner:3");
  texts = fine;
  texts.texts["outer"] = "float a;\n#include \"inner\"\nfloat b;\n" + wrong;
  expect_error_at(VERSION + "\n#include \"outer\"\nvoid main() {}\n", texts, "outer:4");
  expect_error_at(VERSION + wrong + "#include \"outer\"\nvoid main() {}\n", fine, "vert:2");
  expect_error_at(VERSION + "#include \"outer\"\n#include \"outer\"\n#include \"inner\"\n" + wrong + "void main() {}\n",
                  fine, "vert:5");
}

TEST(Reflect, ErrorNamesTheLineBehindAnIncludeThatIsNotTaken)
{
  const ShaderTexts texts{{{"lib", "float a;\nfloat b;\nfloat c;\n"}}};
  const std::string wrong = "float f_wrong = undeclared_name;\nvoid main() {}\n";
  expect_error_at(VERSION + "#ifdef NEVER\n#include \"lib\"\n#endif\n" + wrong, texts, "vert:5");
  expect_error_at(VERSION + "#ifdef NEVER\n#include \"lib\"\n#else\n" + wrong + "#endif\n", texts, "vert:5");
  expect_error_at(VERSION + "#if 0\n#if 1\n#include \"lib\"\n#endif\n#elif 1\n" + wrong + "#endif\n", texts, "vert:7");
}

TEST(Reflect, ErrorNamesTheLineBehindDefines)
{
  ShaderTexts texts{{{"vert", VERSION + "void main() { undeclared_name = 1; }\n"}, {"frag", EMPTY_MAIN}}};
  const std::string message = error_of([&] {
    static_cast<void>(reflect("test", gpu::preprocess({"test", "vert", "", "frag", {"A", "B 1", "C"}}, texts.files())));
  });
  expect_contains(message, "vert:2:");
}

TEST(Reflect, ErrorNamesTheStage)
{
  expect_contains(error_of([&] { reflected(EMPTY_MAIN, VERSION + "void main() { return 1; }\n"); }), "fragment stage");
}

TEST(Reflect, DefinesReachTheCompiler)
{
  ShaderTexts texts{{{"vert", VERSION + "#if COUNT != 6\n#error wrong\n#endif\nvoid main() {}\n"},
                     {"frag", VERSION + "#ifndef PLAIN\n#error missing\n#endif\nvoid main() {}\n"}}};
  const auto compile = [&](std::vector<std::string> defines) {
    return error_of([&] {
      static_cast<void>(
          reflect("test", gpu::preprocess({"test", "vert", "", "frag", std::move(defines)}, texts.files())));
    });
  };
  EXPECT_EQ(compile({"COUNT 6", "PLAIN"}), "");
  EXPECT_NE(compile({"COUNT 5", "PLAIN"}), "");
  EXPECT_NE(compile({"COUNT 6"}), "");
}

TEST(Reflect, LinkMismatchIsAnErrorThatNamesTheShader)
{
  const std::string message = error_of([&] {
    reflected(VERSION + "layout(location = 0) out vec4 v;\nvoid main() { v = vec4(0); gl_Position = v; }\n",
              VERSION +
                  "layout(location = 0) in vec3 v;\nlayout(location = 0) out vec4 o;\n"
                  "void main() { o = vec4(v, 1); }\n");
  });
  expect_contains(message, "'test'");
  expect_contains(message, "link");
}

TEST(Reflect, FindsBlocksAndTexturesByNameWithSlotsAndSizes)
{
  const gpu::ShaderInterface interface = reflected(VERSION + R"(
layout(std140, binding = 3) uniform view_block { mat4 clip_from_world; vec3 position; } named_instance;
layout(std140, binding = 7) uniform plain_block { float a; vec3 b; float c[3]; };
layout(std140, binding = 2) readonly buffer object_block { vec4 header; };
void main() { gl_Position = named_instance.clip_from_world * vec4(b, a + c[2]) + header; }
)",
                                                   VERSION + R"(
layout(binding = 16) uniform sampler2DArrayShadow shadow_maps;
layout(binding = 17) uniform samplerCube sky;
layout(std140, binding = 3) uniform view_block { mat4 clip_from_world; vec3 position; } view;
layout(location = 0) out vec4 color;
void main() { color = texture(sky, view.position) * texture(shadow_maps, vec4(0)); }
)");
  struct Expected {
    const char *name;
    gpu::BindingKind kind;
    int slot;
    std::uint32_t size_bytes;
  };
  // By kind, then slot. plain_block: a at 0, b at 16 (c cannot share its row: arrays align to 16), c 32 to 80.
  const std::vector<Expected> expected = {
      {"view_block", gpu::BindingKind::UniformBlock, 3, 80},
      {"plain_block", gpu::BindingKind::UniformBlock, 7, 80},
      {"object_block", gpu::BindingKind::StorageBlock, 2, 16},
      {"shadow_maps", gpu::BindingKind::Texture, 16, 0},
      {"sky", gpu::BindingKind::Texture, 17, 0},
  };
  ASSERT_EQ(interface.bindings.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); i++) {
    const gpu::ShaderInterface::Binding &binding = interface.bindings[i];
    EXPECT_EQ(binding.name, expected[i].name);
    EXPECT_EQ(binding.kind, expected[i].kind) << binding.name;
    EXPECT_EQ(binding.slot, expected[i].slot) << binding.name;
    EXPECT_EQ(binding.size_bytes, expected[i].size_bytes) << binding.name;
    EXPECT_EQ(interface.find(binding.kind, binding.name), &binding);
  }
  EXPECT_EQ(interface.find(gpu::BindingKind::Texture, "view_block"), nullptr) << "kinds are apart";
  EXPECT_EQ(interface.find(gpu::BindingKind::UniformBlock, "named_instance"), nullptr);
  EXPECT_EQ(interface.push_constant_size_bytes, 0U);
  EXPECT_TRUE(interface.push_constant_members.empty());
}

TEST(Reflect, ABindingIsReadWhereACalledFunctionOrAGlobalReadsIt)
{
  const std::string called = "layout(std140, binding = 1) uniform called_block { vec4 a; };\n";
  const auto bindings = [&](const std::string &value) {
    const gpu::ShaderInterface interface = reflected(
        VERSION + called +
            "layout(std140, binding = 2) uniform uncalled_block { vec4 b; };\n"
            "layout(std140, binding = 3) uniform global_block { vec4 c; } instance;\n"
            "layout(binding = 4) uniform sampler2D pictures[2];\n"
            "layout(binding = 5) uniform sampler2D untaken;\nconst bool is_taken = false;\n"
            "float from_called() { return a.x; }\nfloat from_uncalled() { return b.x; }\nfloat global = instance.c.x;\n"
            "void main()\n{\n  gl_Position = vec4(from_called() * global" +
            value + ");\n  if (is_taken) { gl_Position += texture(untaken, vec2(0)); }\n}\n",
        VERSION + called + "layout(location = 0) out vec4 o;\nvoid main() { o = a; }\n");
    std::vector<std::string> texts;
    for (const gpu::ShaderInterface::Binding &binding : interface.bindings) {
      texts.push_back(fmt::format("{} {} {}", binding.name, binding.slot, binding.stages));
    }
    return texts;
  };
  std::vector<std::string> expected{"called_block 1 5", "global_block 3 1", "untaken 5 1"};
  EXPECT_EQ(bindings(""), expected);
  // With an array, glslang 12 says that all stages read all textures, and glslang 15 does not.
  expected = {"called_block 1 5", "global_block 3 1", "pictures 4 1", "untaken 5 1"};
  const std::vector<std::string> in_all_stages{"called_block 1 5", "global_block 3 1", "pictures 4 5", "untaken 5 5"};
  const std::vector<std::string> with_array = bindings(" + texture(pictures[1], vec2(0)).x");
  EXPECT_TRUE(with_array == expected || with_array == in_all_stages) << testing::PrintToString(with_array);
}

TEST(Reflect, KeepsPushConstantsApartWithOffsetsOfTheirMembers)
{
  for (const std::string instance : {"", " constants"}) {
    const std::string prefix = instance.empty() ? "" : "constants.";
    const gpu::ShaderInterface interface =
        reflected(VERSION + "#include \"shared/slots_shared.h\"\n" +
                  "PUSH_CONSTANT_LAYOUT uniform push_constant_block\n"
                  "{\n  float first;\n  vec3 direction;\n  int face;\n  mat4 matrix;\n  vec2 last;\n}" +
                  instance + ";\nvoid main() { gl_Position = " + prefix + "matrix * vec4(" + prefix + "direction, " +
                  prefix + "first) * float(" + prefix + "face) + " + prefix + "last.xyxy; }\n");
    EXPECT_TRUE(interface.bindings.empty());
    EXPECT_EQ(interface.push_constant_slot, PUSH_CONSTANT_SLOT);
    // std140: vec3 aligns to 16, the int fills its row, a matrix is four rows.
    const std::vector<std::pair<std::string, std::uint32_t>> expected = {
        {"first", 0}, {"direction", 16}, {"face", 28}, {"matrix", 32}, {"last", 96}};
    ASSERT_EQ(interface.push_constant_members.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); i++) {
      EXPECT_EQ(interface.push_constant_members[i].name, expected[i].first);
      EXPECT_EQ(interface.push_constant_members[i].offset_bytes, expected[i].second) << expected[i].first;
    }
    EXPECT_EQ(interface.find_push_constant("face")->size_bytes, 4U);
    EXPECT_EQ(interface.find_push_constant("matrix")->size_bytes, 64U);
    EXPECT_EQ(interface.find_push_constant("lost"), nullptr);
    // The vec2 ends at 104, its row at 112: what a driver demands to be bound.
    EXPECT_EQ(interface.push_constant_size_bytes, 112U);
  }
}

TEST(Reflect, SlotSharedByTwoOfAKindIsAnErrorThatNamesBoth)
{
  const std::string message = error_of([&] {
    reflected(VERSION +
              "layout(std140, binding = 4) uniform a_block { vec4 a; };\n"
              "layout(std140, binding = 4) uniform b_block { vec4 b; };\n"
              "void main() { gl_Position = a + b; }\n");
  });
  expect_contains(message, "'test'");
  expect_contains(message, "'a_block'");
  expect_contains(message, "'b_block'");
  expect_contains(message, "slot 4");
}

TEST(Reflect, SlotSharedAcrossStagesIsAnErrorToo)
{
  const std::string message = error_of([&] {
    reflected(
        VERSION + "layout(binding = 5) uniform sampler2D a;\nvoid main() { gl_Position = texture(a, vec2(0)); }\n",
        VERSION +
            "layout(binding = 5) uniform sampler2D b;\nlayout(location = 0) out vec4 o;\n"
            "void main() { o = texture(b, vec2(0)); }\n");
  });
  expect_contains(message, "slot 5");
}

TEST(Reflect, SlotOfThePushConstantsIsTakenToo)
{
  const std::string message = error_of([&] {
    reflected(VERSION +
              "#include \"shared/slots_shared.h\"\n"
              "PUSH_CONSTANT_LAYOUT uniform push_constant_block { vec4 a; };\n"
              "layout(std140, binding = PUSH_CONSTANT_SLOT) uniform b_block { vec4 b; };\n"
              "void main() { gl_Position = a + b; }\n");
  });
  expect_contains(message, "'b_block'");
  expect_contains(message, "slot 8");
}

TEST(Reflect, BindingWithoutASlotIsAnErrorThatNamesIt)
{
  const auto refusal = [](const std::string &declaration, const std::string &use) {
    return error_of([&] { reflected(VERSION + declaration + "\nvoid main() { gl_Position = " + use + "; }\n"); });
  };
  expect_contains(refusal("layout(std140) uniform a_block { vec4 a; };", "a"), "'a_block'");
  expect_contains(refusal("uniform sampler2D picture;", "texture(picture, vec2(0))"), "'picture'");
  // Uniforms outside of blocks: Vulkan has none.
  expect_contains(refusal("uniform vec4 plain;", "plain"), "'plain'");
  EXPECT_EQ(refusal("layout(std140, binding = 0) uniform a_block { vec4 a; };", "a"), "");
}

TEST(Reflect, BlockOfASharedStructIsAsLargeAsInCpp)
{
  // Struct, its header, what C++ says of two of it.
  struct Shared {
    const char *type;
    const char *header;
    std::size_t size_bytes;
  };
  using namespace shared;
  for (const Shared &one : {Shared{"ObjectData", "draw_object_shared.h", sizeof(ObjectData)},
                            Shared{"ViewData", "draw_view_shared.h", sizeof(ViewData)},
                            Shared{"LightData", "eevee_light_shared.h", sizeof(LightData)},
                            Shared{"LightBlock", "eevee_light_shared.h", sizeof(LightBlock)},
                            Shared{"MaterialData", "eevee_material_shared.h", sizeof(MaterialData)},
                            Shared{"ShadowCubeData", "eevee_shadow_shared.h", sizeof(ShadowCubeData)},
                            Shared{"ShadowMapData", "eevee_shadow_shared.h", sizeof(ShadowMapData)},
                            Shared{"ShadowBlock", "eevee_shadow_shared.h", sizeof(ShadowBlock)},
                            Shared{"ShadowRenderBlock", "eevee_shadow_shared.h", sizeof(ShadowRenderBlock)}}) {
    SCOPED_TRACE(one.type);
    const std::string type = one.type;
    // In an array, std140 rounds the stride up to 16: equal sizes mean no padding that C++ lacks.
    const gpu::ShaderInterface interface = reflected(VERSION + "#include \"shared/" + one.header +
                                                     "\"\nlayout(std140, binding = 0) uniform test_block { " + type +
                                                     " data[2]; vec4 end; };\nvoid main() { gl_Position = end; }\n");
    const gpu::ShaderInterface::Binding *block = interface.find(gpu::BindingKind::UniformBlock, "test_block");
    ASSERT_TRUE(block);
    EXPECT_EQ(block->size_bytes, 2 * one.size_bytes + 16);
  }
}

}  // namespace
}  // namespace gnomon::shader_check
