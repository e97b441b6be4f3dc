// SPDX-License-Identifier: MIT
#include "shader_check.hh"
#include "shader_check_program.hh"
#include "shader_check_reflection.hh"

#include "gpu/gpu_testing.hh"

#include <algorithm>
#include <cstddef>
#include <thread>

namespace gnomon::shader_check {
namespace {

using test::expect_contains;
using test::ShaderTexts;
using test::VERSION;

/** The caller's text begins in line 2. */
const std::string COLOR = "layout(location = 0) out vec4 color; ";

std::vector<CheckMessage> check(const std::string &vertex, const std::string &fragment, CheckOptions options = {},
                                ShaderTexts texts = {})
{
  texts.texts["vert"] = VERSION + vertex;
  texts.texts["frag"] = VERSION + fragment;
  options.stage_errors = StageErrors::All;
  return check_shader({"test", vertex.empty() ? "" : "vert", "", fragment.empty() ? "" : "frag", {}}, texts.files(),
                      options);
}

std::vector<CheckMessage> check_fragment(const std::string &fragment, const CheckOptions &options = {})
{
  return check("", fragment, options);
}

std::string to_string(const std::vector<CheckMessage> &messages)
{
  std::string text;
  for (const CheckMessage &m : messages) {
    text += fmt::format("{}:{}: {}: {} [{}]\n", m.file, m.line, to_string(m.severity), m.text, m.rule);
  }
  return text;
}

void expect_clean(const std::vector<CheckMessage> &messages)
{
  EXPECT_EQ(to_string(messages), "");
}

/** Expects one message with this rule at this line. */
void expect_one(const std::vector<CheckMessage> &messages, Severity severity, std::string_view rule,
                std::string_view file, int line)
{
  ASSERT_EQ(messages.size(), 1U) << to_string(messages);
  EXPECT_EQ(messages[0].severity, severity) << to_string(messages);
  EXPECT_EQ(messages[0].rule, rule) << to_string(messages);
  EXPECT_EQ(messages[0].file, file) << to_string(messages);
  // After `#version`.
  EXPECT_EQ(messages[0].line, line + 1) << to_string(messages);
}

/** The body of a function with \a expression of x, a vec3 of any value. */
std::vector<CheckMessage> check_expression(const std::string &body)
{
  return check_fragment("layout(location = 0) in vec3 x; layout(location = 1) in vec3 y;" + COLOR +
                        "void step_in(inout int k) { k++; } int next(int k) { return k + 1; } "
                        "void main() { color = vec4(0.0);\n" +
                        body + "\n}\n");
}

TEST(CheckRules, EachHasANameAndAPurpose)
{
  for (const CheckRule &rule : check_rules()) {
    EXPECT_FALSE(rule.name.empty());
    EXPECT_FALSE(rule.purpose.empty());
    EXPECT_EQ(std::ranges::count(check_rules(), rule.name, &CheckRule::name), 1);
  }
}

TEST(CheckShader, MessageNamesShaderVariantAndTarget)
{
  const ShaderTexts texts{{{"frag", VERSION + "void main() { color = 1; }\n"}}};
  CheckOptions options;
  options.target = CheckTarget::Vulkan12;
  const std::vector<CheckMessage> messages =
      check_shader({"test", "", "", "frag", {"A", "B 2"}}, texts.files(), options);
  ASSERT_FALSE(messages.empty());
  EXPECT_EQ(messages[0].shader, "test");
  EXPECT_EQ(messages[0].variant, "A B 2");
  EXPECT_EQ(messages[0].target, CheckTarget::Vulkan12);
  EXPECT_EQ(messages[0].file, "frag");
  EXPECT_EQ(messages[0].line, 2);
}

TEST(CheckShader, MissingIncludesAndStagesAreReported)
{
  expect_one(check_fragment("\n#include \"lost\"\nvoid main() {}\n"), Severity::Error, "include", "frag", 2);
  const std::vector<CheckMessage> messages = check_shader({"test", "", "", "nowhere", {}}, ShaderTexts().files(), {});
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].file, "nowhere");
  EXPECT_EQ(messages[0].rule, "include");
}

TEST(CheckShader, CompileErrorsOfAllStagesAndOfEachLine)
{
  const std::vector<CheckMessage> messages =
      check("\nvoid main() { a = 1; }\n", "void main() { float b = vec2(1.0);\nint c = 1.5; }\n");
  EXPECT_EQ(std::ranges::count(messages, "compile", &CheckMessage::rule), std::ptrdiff_t(messages.size()));
  const auto at = [&](const std::string &file, int line) {
    return std::ranges::any_of(messages, [&](const CheckMessage &m) { return m.file == file && m.line == line; });
  };
  EXPECT_TRUE(at("vert", 3)) << to_string(messages);
  EXPECT_TRUE(at("frag", 2)) << to_string(messages);
}

TEST(CheckShader, ErrorsOfOneTargetAreReportedForThatTargetOnly)
{
  const std::string fragment =
      COLOR + "\nlayout(location = 3) uniform float scale;\nvoid main() { color = vec4(scale); }\n";
  expect_clean(check_fragment(fragment));
  CheckOptions vulkan;
  vulkan.target = CheckTarget::Vulkan12;
  expect_one(check_fragment(fragment, vulkan), Severity::Error, "compile", "frag", 2);
  // And the other way round: a built-in that Vulkan renamed.
  const std::string vertex = "void main() { gl_Position = vec4(gl_VertexIndex); }\n";
  expect_clean(check(vertex, "", vulkan));
  EXPECT_FALSE(check(vertex, "").empty());
}

TEST(CheckShader, VaryingsAreMatchedByLocation)
{
  const std::string vertex =
      "layout(location = 2) out mat3 m; layout(location = 5) out vec2 uv;\n"
      "void main() { gl_Position = vec4(0.0); m = mat3(1.0); uv = vec2(0.0); }\n";
  expect_clean(check(vertex, COLOR + "layout(location = 2) in mat3 a; layout(location = 5) in vec2 b;\n"
                                     "void main() { color = vec4(a * vec3(b, 1.0), 1.0); }\n"));
  const std::string reads = "void main() { color = vec4(c.x); }\n";
  expect_one(check("void main() { gl_Position = vec4(0.0); }\n", COLOR + "\nlayout(location = 7) in vec2 c;\n" + reads),
             Severity::Error, "missing-varying", "frag", 2);
  expect_one(check("layout(location = 7) out vec3 c; void main() { gl_Position = vec4(0.0); c = vec3(0.0); }\n",
                   COLOR + "\nlayout(location = 7) in vec2 c;\n" + reads),
             Severity::Error, "varying-type", "frag", 2);
  // Inputs that are declared but not read need no output.
  expect_clean(check("void main() { gl_Position = vec4(0.0); }\n",
                     COLOR + "layout(location = 7) in vec2 c; void main() { color = vec4(0.0); }\n"));
}

TEST(CheckShader, GeometryStageReadsArraysOfWhatTheVertexStageWrites)
{
  ShaderTexts texts;
  texts.texts["vert"] =
      VERSION + "layout(location = 1) out vec3 n; void main() { gl_Position = vec4(0.0); n = vec3(0.0); }\n";
  texts.texts["frag"] = VERSION + COLOR + "layout(location = 0) in vec3 n; void main() { color = vec4(n, 1.0); }\n";
  const auto check_geometry = [&](const std::string &type) {
    texts.texts["geom"] = VERSION +
                          "layout(triangles) in; layout(points, max_vertices = 1) out;\nlayout(location = 1) in " +
                          type + " n[];\nlayout(location = 0) out vec3 o;\n" +
                          "void main() { gl_Position = vec4(0.0); o = vec3(n[0].x); EmitVertex(); }\n";
    return check_shader({"test", "vert", "geom", "frag", {}}, texts.files(), {});
  };
  expect_clean(check_geometry("vec3"));
  expect_one(check_geometry("vec2"), Severity::Error, "varying-type", "geom", 2);
}

TEST(CheckShader, OutputsThatNoStageReads)
{
  const std::string vertex =
      "\nlayout(location = 1) out vec2 uv; void main() { gl_Position = vec4(0.0); uv = vec2(0.0); }\n";
  expect_one(check(vertex, COLOR + "void main() { color = vec4(0.0); }\n"), Severity::Warning, "unread-output", "vert",
             2);
  expect_clean(check(vertex, COLOR + "layout(location = 1) in vec2 uv; void main() { color = vec4(uv, uv); }\n"));
  // The next stage is unknown if a stage is checked alone.
  expect_clean(check(vertex, ""));
}

TEST(CheckShader, SlotsAreSharedInVulkanAndPerKindInOpenGl)
{
  const std::string fragment = COLOR +
                               "layout(binding = 4) uniform sampler2D a;\n"
                               "layout(binding = 4) uniform b_block { vec4 b; };\n"
                               "void main() { color = texture(a, b.xy); }\n";
  expect_clean(check_fragment(fragment));
  CheckOptions vulkan;
  vulkan.target = CheckTarget::Vulkan12;
  expect_one(check_fragment(fragment, vulkan), Severity::Error, "slot", "frag", 1);
  expect_one(
      check_fragment(COLOR + "layout(binding = 4) uniform a_block { vec4 a; };\n"
                             "layout(binding = 4) uniform b_block { vec4 b; };\nvoid main() { color = a + b; }\n"),
      Severity::Error, "slot", "frag", 2);
  expect_clean(check_fragment(COLOR + "layout(set = 0, binding = 4) uniform a_block { vec4 a; };\n"
                                      "layout(set = 1, binding = 4) uniform b_block { vec4 b; };\n"
                                      "void main() { color = a + b; }\n",
                              vulkan));
  // One message for each of the two stages.
  expect_one(check("layout(binding = 1) uniform a_block { vec4 a; }; void main() { gl_Position = a; }\n",
                   COLOR + "\nlayout(binding = 2) uniform a_block { vec4 a; }; void main() { color = a; }\n"),
             Severity::Error, "slot", "frag", 2);
}

TEST(CheckShader, BindingsThatNoStageReads)
{
  const std::string block = "\nlayout(binding = 1) uniform a_block { vec4 a; };\n";
  expect_one(check_fragment(COLOR + block + "void main() { color = vec4(0.0); }\n"), Severity::Warning,
             "unused-binding", "frag", 2);
  expect_one(check_fragment(COLOR + block + "vec4 idle() { return a; } void main() { color = vec4(0.0); }\n"),
             Severity::Warning, "unused-binding", "frag", 2);
  // A binding is used if one stage reads it.
  expect_clean(
      check(block + "void main() { gl_Position = a; }\n", COLOR + block + "void main() { color = vec4(0.0); }\n"));
  expect_one(check_fragment(COLOR + "layout(binding = 1)\nuniform sampler2D t; void main() { color = vec4(0.0); }\n"),
             Severity::Warning, "unused-binding", "frag", 2);
}

TEST(CheckShader, RecursionIsFoundThroughOtherFunctions)
{
  const std::string fragment = COLOR +
                               "float a(float x);\nfloat b(float x) { return a(x); }\n"
                               "float a(float x) { return x > 1.0 ? b(x - 1.0) : x; }\n"
                               "void main() { color = vec4(a(3.0)); }\n";
  const std::vector<CheckMessage> messages = check_fragment(fragment);
  ASSERT_FALSE(messages.empty());
  EXPECT_EQ(messages[0].rule, "recursion");
  if (!left_out_rules(CheckTarget::OpenGlSpirv).empty()) {
    GTEST_SKIP() << "the lines of all functions need glslang's syntax tree, which this build has not";
  }
  ASSERT_EQ(messages.size(), 2U) << to_string(messages);
  EXPECT_EQ(messages[0].line, 3);
  EXPECT_EQ(messages[1].line, 4);
  expect_contains(messages[1].text, "'a'");
}

TEST(CheckShader, GlobalsMayBeInitializedByTheFunctionBeforeThem)
{
  expect_clean(check_fragment(COLOR + "vec4 twice(vec4 x) { return x + x; }\nvec4 two = twice(vec4(1.0));\n"
                                      "void main() { color = two; }\n"));
}

TEST(CheckShader, ArraysInBlocksFillRows)
{
  const auto block = [&](const std::string &layout, const std::string &member) {
    return check_fragment(COLOR + "layout(" + layout + ", binding = 1) uniform a_block {\nvec4 a;\n" + member +
                          "\n}; void main() { color = a; }\n");
  };
  expect_one(block("std140", "vec3 b[4];"), Severity::Error, "block-array", "frag", 3);
  expect_one(block("std140", "mat3 b;"), Severity::Error, "block-array", "frag", 3);
  expect_one(block("std140", "float b[4];"), Severity::Warning, "block-array", "frag", 3);
  expect_clean(block("std140", "vec4 b[4]; mat4 c[2]; vec3 d; float e;"));
  // Also in a struct of the block.
  expect_one(
      check_fragment(COLOR + "struct S {\nvec3 v[2]; }; layout(std140, binding = 1) uniform a_block { S a[2]; };\n"
                             "void main() { color = vec4(a[1].v[1], 1.0); }\n"),
      Severity::Error, "block-array", "frag", 2);
}

TEST(CheckShader, BlocksLargerThanPromised)
{
  const auto block = [&](int count, bool is_strict) {
    CheckOptions options;
    options.is_block_size_strict = is_strict;
    return check_fragment(fmt::format("{}\nlayout(std140, binding = 1) uniform a_block {{ vec4 a[{}]; }};\n"
                                      "void main() {{ color = a[0]; }}\n",
                                      COLOR, count),
                          options);
  };
  expect_clean(block(16384 / 16, true));
  expect_one(block(16384 / 16 + 1, false), Severity::Warning, "block-size", "frag", 2);
  expect_one(block(16384 / 16 + 1, true), Severity::Error, "block-size", "frag", 2);
  expect_one(block(65536 / 16, false), Severity::Warning, "block-size", "frag", 2);
  expect_one(block(65536 / 16 + 1, false), Severity::Error, "block-size", "frag", 2);
}

/** `vec3 a; float b; Inner c;` as C++ has it. */
constexpr std::array<gpu::BlockLayout::Field, 4> fields = {{{"a", 0}, {"b", 12}, {"c.d", 16}, {"c.e", 20}}};

std::vector<CheckMessage> check_layout(const std::string &inner, const std::string &block, std::size_t size_bytes = 32,
                                       std::string_view name = "a_block")
{
  const std::array<gpu::BlockLayout, 1> blocks = {{{name, size_bytes, fields}}};
  CheckOptions options;
  options.blocks = blocks;
  return check_fragment(COLOR + "struct Inner {\n" + inner + "\n};\nlayout(std140, binding = 1) uniform a_block {\n" +
                            block + "\n};\nvoid main() { color = vec4(a, b) + vec4(c.d); }\n",
                        options);
}

TEST(CheckShader, BlocksAreLaidOutAsInCpp)
{
  const std::string inner = "float d; float e;";
  const std::string block = "vec3 a; float b; Inner c;";
  expect_clean(check_layout(inner, block));
  // A member of its own line: 2 in Inner, 5 in the block; the struct is at 1, the block at 4.
  expect_one(check_layout(inner, "vec3 a;\nfloat more; float b; Inner c;"), Severity::Error, "layout", "frag", 6);
  expect_one(check_layout("float d;", block), Severity::Error, "layout", "frag", 1);
  const std::vector<CheckMessage> swapped = check_layout("float e;\nfloat d;", block);
  ASSERT_EQ(swapped.size(), 2U) << to_string(swapped);
  expect_contains(swapped[0].text, "'c.e' of struct 'Inner' in block 'a_block' is at byte 16, in C++ at byte 20");
  EXPECT_EQ(swapped[0].line, 3);
  expect_one(check_layout(inner, block, 48), Severity::Error, "layout", "frag", 4);
  expect_one(check_layout(inner, block, 32, "other_block"), Severity::Error, "layout", "frag", 4);
}

TEST(CheckShader, ImplicitConversionsOfBlockMembersAreReported)
{
  if (!left_out_rules(CheckTarget::OpenGlSpirv).empty()) {
    GTEST_SKIP() << "the rule needs glslang's syntax tree, which this build has not";
  }
  const auto use = [&](const std::string &expression) {
    return check_fragment(COLOR +
                          "layout(std140, binding = 1) uniform a_block { int count; } a;\n"
                          "layout(std140, binding = 2) uniform b_block { uint flags; };\n"
                          "void main() { color = vec4(a.count > 0 ? 1.0 : 0.0, flags == 0u ? 1.0 : 0.0, 0.0, 0.0);\n" +
                          expression + "\n}\n");
  };
  expect_one(use("color *= a.count;"), Severity::Warning, "implicit-conversion", "frag", 4);
  expect_one(use("float f = flags * 0.5; color *= f;"), Severity::Warning, "implicit-conversion", "frag", 4);
  expect_clean(use("color *= float(a.count) * float( flags );"));
  expect_clean(use("int i = a.count + 1; color *= vec4(a.count, i, 0, 0);"));
}

TEST(CheckShader, UnboundedLoopsAreReported)
{
  if (!left_out_rules(CheckTarget::OpenGlSpirv).empty()) {
    GTEST_SKIP() << "the rule needs glslang's syntax tree, which this build has not";
  }
  for (const char *loop :
       {"for (int i = 0; i < 4; i++) { color += x.xyzx; }", "for (int i = 3; i >= 0; i -= 1) { color += x.xyzx; }",
        "int n = 9; while (n > 0) { n = n >> 1; color += x.xyzx; }", "int n = 9; do { n--; } while (n > 0);",
        "float t = 0.0; while (t < 1.0 && x.x > 0.0) { t += 0.1; }", "int n = 3; while (n-- > 0) { color += x.xyzx; }",
        "while (true) { color += x.xyzx; if (color.x > 1.0) break; }",
        "for (;;) { color += x.xyzx; if (color.x > 1.0) { return; } }",
        "for (;;) { color += x.xyzx; for (int i = 0; i < 4; i++) { if (color.x > float(i)) discard; } }",
        "bool go = true; int k = 0; while (go) { k++; go = k < 4; }",
        "int lo = 0, hi = 9; while (lo < hi) { int mid = (lo + hi) / 2; if (mid > 3) hi = mid; else lo = mid + 1; }",
        "int k = 0; while (k < 4) { step_in(k); }", "int k = 0; while (!(k > 3)) { k = next(k); }",
        "int k = 0; while (next(k) < 4) { color += x.xyzx; }", "while (true) { color += x.xyzx; break; }",
        "do { color += x.xyzx; } while (false);",
        "float d = 1.0; vec3 p = x; while (d > 0.1) { p += y; d = length(p); }",
        "int k = 0; while (k < 4 || k < 5) { k++; }"}) {
    SCOPED_TRACE(loop);
    expect_clean(check_expression(loop));
  }
  for (const char *loop : {"while (true) { color += x.xyzx; if (x.x > 1.0) break; }", "for (;;) { color += x.xyzx; }",
                           "for (;;) { color += x.xyzx; switch (int(color.x)) { case 1: break; } }",
                           "for (;;) { color += x.xyzx; for (int i = 0; i < 4; i++) { break; } }",
                           "int k = 0; while (k < 4 || x.x > 0.0) { k++; }",
                           "bool go = true; while (go) { color += x.xyzx; go = x.x > 0.0; }",
                           "float e = x.x; while (e > 0.1) { e = fract(e * x.y); }",
                           "int i = 0; for (int j = 0; i < 4; j++) { color += x.xyzx; }"}) {
    SCOPED_TRACE(loop);
    expect_one(check_expression(loop), Severity::Warning, "unbounded-loop", "frag", 2);
  }
}

TEST(CheckShader, UnguardedMathIsReported)
{
  if (!left_out_rules(CheckTarget::OpenGlSpirv).empty()) {
    GTEST_SKIP() << "the rule needs glslang's syntax tree, which this build has not";
  }
  for (const char *expression :
       {"color.x = acos(clamp(dot(x, y), -1.0, 1.0));", "color.x = acos(min(max(dot(x, y), -1.0), 1.0));",
        "color.x = asin(-min(1.0, max(-1.0, dot(x, y))));", "color.x = acos(0.5 * dot(x, y));",
        "color.x = acos(min(dot(x, x), 1.0));", "color.x = acos(-min(dot(x, x), 1.0));",
        "float d = -dot(x, x); color.x = asin(max(d, -1.0));", "color.x = sqrt(max(x.x - y.x, 0.0));",
        "color.x = sqrt(x.x);", "color.x = sqrt(dot(x, x));", "color.x = x.x / max(length(x), 1e-6);",
        "color.x = 1.0 / (x.x + 2.0);", "float l = length(x); color.x = l > 0.0 ? 1.0 / l : 0.0;",
        "vec3 d = x - y; if (dot(d, d) > 0.0) { color.xyz = normalize(d); }",
        "float d2 = dot(x, x); if (d2 == 0.0) { return; } color.x = inversesqrt(d2);",
        "color.x = sqrt(1.0 - clamp(x.x, 0.0, 1.0));", "color.x = pow(abs(dot(x, y)), 2.0);",
        "color.xyz = normalize(x);", "color.x = acos(dot(x, y)); // shader-check: unguarded-math, x is y's negative"}) {
    SCOPED_TRACE(expression);
    expect_clean(check_expression(expression));
  }
  for (const char *expression : {"color.x = acos(dot(x, y));",
                                 "color.x = acos(max(dot(x, y), 0.0));",
                                 "color.x = asin(-dot(x, y));",
                                 "color.x = acos(dot(x, y) * 1.0);",
                                 "color.x = acos(-min(1.0, 2.0 * dot(x, y)));",
                                 "color.x = acos(min(dot(x, x), 2.0));",
                                 "color.x = acos(-2.0 * min(dot(x, x), 1.0));",
                                 "color.x = acos(max(dot(x, x), 0.0));",
                                 "float d = max(0.0, dot(x, y)); float e = -d; color.x = acos(e);",
                                 "color.x = asin(dot(x, y));",
                                 "color.x = sqrt(1.0 - x.x * x.x);",
                                 "color.x = sqrt(dot(x, y));",
                                 "color.x = x.x / length(y);",
                                 "color.x = x.x / (x.y - y.y);",
                                 "color.x /= distance(x, y);",
                                 "float d = dot(x, y); color.x = pow(d, 2.0);",
                                 "color.xyz = normalize(x - y);",
                                 "color.xyz = normalize(cross(x, y));",
                                 "color.x = inversesqrt(dot(x, x));",
                                 "color.x = log(x.x - 1.0);"}) {
    SCOPED_TRACE(expression);
    expect_one(check_expression(expression), Severity::Warning, "unguarded-math", "frag", 2);
  }
}

TEST(CheckShader, AValueThatIsComputedFromItselfIsReadOnce)
{
  for (const char *body :
       {"value = -value; color = vec4(acos(value));", "value = 2.0 * value; color = vec4(asin(value));",
        "value = -other; other = -value; color = vec4(acos(-other));"}) {
    SCOPED_TRACE(body);
    const std::string globals = COLOR + "\nfloat value = 0.5;\nfloat other = 0.5;\n";
    const std::string fragment = globals + "void main() { " + body + " }\n";
    expect_clean(check("void main() { gl_Position = vec4(0.0); }\n", fragment));
  }
}

TEST(CheckShader, ManyThreadsFindTheSame)
{
  const std::string fragment =
      COLOR + "\nlayout(location = 7) in vec2 c;\nvoid main() { color = vec4(acos(dot(c, c.yx))); }\n";
  const std::string vertex = "void main() { gl_Position = vec4(0.0); }\n";
  const std::string alone = to_string(check(vertex, fragment));
  EXPECT_FALSE(alone.empty());
  std::vector<std::string> found(8);
  {
    std::vector<std::jthread> threads;
    for (std::string &text : found) {
      threads.emplace_back([&] {
        for (int i = 0; i < 8; i++) {
          text = to_string(check(vertex, fragment));
        }
      });
    }
  }
  for (const std::string &text : found) {
    EXPECT_EQ(text, alone);
  }
}

TEST(ProgramInterface, HasInputsOfTheFirstAndOutputsOfTheLastStage)
{
  ShaderTexts texts;
  texts.texts["vert"] = VERSION +
                        "layout(location = 4) in ivec2 b; layout(location = 0) in mat4 a;\n"
                        "layout(location = 0) out vec2 uv; void main() { gl_Position = a[b.x]; uv = vec2(0.0); }\n";
  texts.texts["frag"] = VERSION + COLOR + "layout(location = 0) in vec2 uv; void main() { color = uv.xyxy; }\n";
  const ProgramInterface variables = program_interface({"test", "vert", "", "frag", {}}, texts.files());
  ASSERT_EQ(variables.inputs.size(), 2U);
  EXPECT_EQ(variables.inputs[0].type, "mat4x4");
  EXPECT_EQ(variables.inputs[1].name, "b");
  EXPECT_EQ(variables.inputs[1].type, "ivec2");
  EXPECT_EQ(variables.inputs[1].location, 4);
  ASSERT_EQ(variables.outputs.size(), 1U);
  EXPECT_EQ(variables.outputs[0].name, "color");
}

}  // namespace
}  // namespace gnomon::shader_check
