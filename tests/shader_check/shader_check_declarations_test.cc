// SPDX-License-Identifier: MIT
// The declarations of stages, as glslang's syntax tree and its SPIR-V give them. What is right follows from GLSL.
#include "internal/shader_check_compilation.hh"

#include <gtest/gtest.h>

#include <algorithm>

namespace gnomon::shader_check {
namespace {

std::string text_of(const Declaration &d)
{
  std::string text = fmt::format("{} {} line {}{}", type_name(d.type, d.is_arrayed), d.name, d.position.line,
                                 d.is_used ? "" : " unused");
  if (d.location >= 0) {
    text += fmt::format(" location {}+{}", d.location, d.location_count);
    text += d.component_count > 0 ? fmt::format(" component {}+{}", d.component, d.component_count) : "";
    text += d.is_captured ? " captured" : "";
  }
  return text;
}

std::string text_of_binding(const Declaration &d)
{
  std::string text = text_of(d) + fmt::format(" set {} slot {}", d.set, d.slot);
  text += d.is_push_constant ? " push constants" : "";
  text += d.is_image ? " image" : "";
  for (const BlockMember &member : d.members) {
    text += fmt::format(", {}{}{}:{}", member.structure, member.structure.empty() ? "" : "::", member.name,
                        member.position.line);
  }
  return text;
}

/** All declarations, sorted, one a line. */
std::string text_of(const StageFacts &facts)
{
  std::vector<std::string> lines;
  for (const Declaration &block : facts.uniform_blocks) {
    lines.push_back(fmt::format("uniform {} bytes {}", text_of_binding(block), (block.size_bytes + 15) / 16 * 16));
  }
  for (const Declaration &block : facts.storage_blocks) {
    lines.push_back("buffer " + text_of_binding(block));
  }
  for (const Declaration &texture : facts.textures) {
    lines.push_back("texture " + text_of_binding(texture));
  }
  for (const Declaration &input : facts.inputs) {
    lines.push_back("in " + text_of(input));
  }
  for (const Declaration &output : facts.outputs) {
    lines.push_back("out " + text_of(output));
  }
  for (const StageFinding &finding : facts.findings) {
    lines.push_back(fmt::format("{} line {}: {}", finding.rule, finding.position.line, finding.text));
  }
  std::ranges::sort(lines);
  std::string text;
  for (const std::string &line : lines) {
    text += line + "\n";
  }
  return text;
}

/** Expects that the declarations of \a source, sorted, are \a right. */
void expect_declarations(Stage stage, const std::string &source, const std::string &right,
                         CheckTarget target = CheckTarget::Vulkan12)
{
  SCOPED_TRACE(source);
  with_large_stack([&] {
    const gpu::ShaderFiles none = [](std::string_view) { return std::nullopt; };
    Compilation compilation;
    ASSERT_TRUE(
        compilation.add(std::make_unique<StageSource>(stage, "x", "#version 460\n" + source, std::vector<std::string>(),
                                                      none, std::span<const std::string>()),
                        target))
        << compilation.glslang.log();
    ASSERT_TRUE(compilation.glslang.link()) << compilation.glslang.log();
    compilation.read_facts(true, false);
    EXPECT_EQ(text_of(compilation.facts[0]), right);
    const StageFacts spirv = read_spirv(compilation.spirv(0).words, stage, compilation.lines[0]);
    EXPECT_EQ(text_of(spirv), right) << "from SPIR-V";
  });
}

TEST(Declarations, OfInputsAndOutputs)
{
  expect_declarations(Stage::Vertex,
                      "layout(location = 0) in dmat3 a;\nlayout(location = 6) in uvec2 b[2];\n"
                      "layout(location = 0, component = 1) out vec2 c;\nlayout(location = 1) out mat3x2 d[2];\n"
                      "layout(location = 8) flat out dvec3 e;\nstruct S { vec4 x; float y[2]; };\n"
                      "layout(location = 10) out S f;\nlayout(location = 20) out flat ivec3 g;\n"
                      "void main() { c = vec2(b[1]); gl_Position = vec4(a[0], gl_VertexIndex); }\n",
                      "in dmat3x3 a line 2 location 0+3\n"
                      "in uvec2[2] b line 3 location 6+2 component 0+2\n"
                      "out S f line 8 unused location 10+3\n"
                      "out dvec3 e line 6 unused location 8+2\n"
                      "out ivec3 g line 9 unused location 20+1 component 0+3\n"
                      "out mat3x2[2] d line 5 unused location 1+6\n"
                      "out vec2 c line 4 location 0+1 component 1+2\n");
}

TEST(Declarations, OfMembersOfBlocksThatStagesShare)
{
  expect_declarations(Stage::Vertex,
                      "layout(location = 3) out Block {\nvec4 a;\nfloat b[3];\nlayout(location = 9) vec2 c;\n} block;\n"
                      "void main() { block.b[1] = 2.0; }\n",
                      "out float[3] Block.b line 4 location 4+3 component 0+1\n"
                      "out vec2 Block.c line 5 unused location 9+1 component 0+2\n"
                      "out vec4 Block.a line 3 unused location 3+1 component 0+4\n");
  expect_declarations(Stage::Geometry,
                      "layout(points) in;\nlayout(points, max_vertices = 1) out;\n"
                      "layout(location = 2) in Block {\nmat2 a;\nvec3 b;\n} block[];\n"
                      "void main() { gl_Position = block[0].b.xyzz; EmitVertex(); }\n",
                      "in mat2x2 Block.a line 5 unused location 2+2\n"
                      "in vec3 Block.b line 6 location 4+1 component 0+3\n");
}

TEST(Declarations, OfVerticesAndPatches)
{
  expect_declarations(
      Stage::Geometry,
      "layout(triangles) in;\nlayout(points, max_vertices = 1) out;\nlayout(location = 0) in vec3 a[];\n"
      "layout(location = 1) in vec2 b[][4];\nlayout(location = 0) out vec3 c[2];\n"
      "void main() { c[0] = a[1]; EmitVertex(); }\n",
      "in vec2[4] b line 5 unused location 1+4 component 0+2\n"
      "in vec3 a line 4 location 0+1 component 0+3\n"
      "out vec3[2] c line 6 location 0+2 component 0+3\n");
  expect_declarations(Stage::TessControl,
                      "layout(vertices = 3) out;\nlayout(location = 0) in vec3 a[];\n"
                      "layout(location = 0) out vec3 b[];\nlayout(location = 1) patch out vec3 c;\n"
                      "void main() { b[gl_InvocationID] = a[gl_InvocationID]; c = a[0]; }\n",
                      "in vec3 a line 3 location 0+1 component 0+3\n"
                      "out vec3 b line 4 location 0+1 component 0+3\n"
                      "out vec3 c line 5 location 1+1 component 0+3\n");
  expect_declarations(
      Stage::TessEvaluation,
      "layout(triangles) in;\nlayout(location = 0) in vec3 a[];\nlayout(location = 1) patch in vec3 b;\n"
      "layout(location = 0) out vec3 c;\nvoid main() { c = a[0] + b; }\n",
      "in vec3 a line 3 location 0+1 component 0+3\n"
      "in vec3 b line 4 location 1+1 component 0+3\n"
      "out vec3 c line 5 location 0+1 component 0+3\n");
  expect_declarations(Stage::Vertex,
                      "layout(xfb_buffer = 0) out;\nlayout(location = 0, xfb_offset = 0) out vec4 a;\n"
                      "layout(location = 1) out vec4 b;\nvoid main() { a = b = vec4(0.0); }\n",
                      "out vec4 a line 3 location 0+1 component 0+4 captured\n"
                      "out vec4 b line 4 location 1+1 component 0+4\n");
}

TEST(Declarations, OfUniformBlocks)
{
  expect_declarations(
      Stage::Fragment,
      "struct Inner {\nfloat x;\nvec3 y;\n};\n"
      "layout(set = 1, binding = 3, std140) uniform Block {\nvec4 a;\nInner b[2];\nmat4 c;\nvec2 d;\n} blocks[2];\n"
      "layout(binding = 5) uniform Unused { float e; };\n"
      "layout(push_constant) uniform Push { layout(offset = 16) vec4 f; float g; } push;\n"
      "layout(location = 0) out vec4 color;\n"
      "void main() { color = blocks[1].c[0] + push.f; }\n",
      // Block: 16, two of 32, 64 and 8 bytes.
      "out vec4 color line 14 location 0+1 component 0+4\n"
      "uniform Block[2] Block line 6 set 1 slot 3, a:7, Inner::b[0].x:3, Inner::b[0].y:4, c:9, d:10 "
      "bytes 160\n"
      "uniform Push Push line 13 set 0 slot -1 push constants, f:13, g:13 bytes 48\n"
      "uniform Unused Unused line 12 unused set 0 slot 5, e:12 bytes 16\n");
}

TEST(Declarations, OfStorageBlocksAndTextures)
{
  for (const CheckTarget target : {CheckTarget::Vulkan10, CheckTarget::Vulkan12, CheckTarget::OpenGlSpirv}) {
    expect_declarations(Stage::Compute,
                        "layout(local_size_x = 1) in;\nstruct Item { vec4 x; uint y; };\n"
                        "layout(binding = 0, std430) buffer Block {\nuint count;\nItem items[];\n} block;\n"
                        "layout(binding = 1) uniform sampler2D a;\nlayout(binding = 2, r32f) uniform image2D b;\n"
                        "layout(binding = 4) uniform sampler2DShadow c[3];\n"
                        "void main() { block.items[0].x = texture(a, vec2(0.0)); }\n",
                        "buffer Block Block line 4 set 0 slot 0, count:5, Item::items[0].x:3, Item::items[0].y:3\n"
                        "texture image2D b line 9 unused set 0 slot 2 image\n"
                        "texture sampler2D a line 8 set 0 slot 1\n"
                        "texture sampler2DShadow[3] c line 10 unused set 0 slot 4\n",
                        target);
  }
}

TEST(Declarations, ArraysWhoseElementsCppPacks)
{
  expect_declarations(
      Stage::Compute,
      "layout(local_size_x = 1) in;\nlayout(binding = 0, std140) uniform Rows {\nfloat a[2];\nvec3 b[2];\n"
      "vec4 c[2];\nmat3 d;\ndouble e[2];\n} rows;\n"
      "layout(binding = 1, std430) readonly buffer Packed { float f[2]; vec2 g[2]; } packed;\n"
      "void main() {}\n",
      "block-array line 4: 'a': an array of scalars takes 16 bytes an element in a std140 block; C++ has 4\n"
      "block-array line 5: 'b': an array of vec3 takes 16 bytes an element in a block; C++ has 12\n"
      "block-array line 7: 'd': a matrix with 3 rows takes 16 bytes a column in a block; C++ has 12\n"
      "buffer Packed Packed line 10 unused set 0 slot 1, f:10, g:10\n"
      "uniform Rows Rows line 3 unused set 0 slot 0, a:4, b:5, c:6, d:7, e:8 bytes 176\n");
}

}  // namespace
}  // namespace gnomon::shader_check
