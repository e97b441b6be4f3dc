// SPDX-License-Identifier: MIT
// check_program: any GLSL of others. The texts are made from parts, so that no name, stage or version is special.
#include "shader_check.hh"

#include "gpu/gpu_testing.hh"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

namespace gnomon::shader_check {
namespace {

using test::ShaderTexts;
using Texts = std::map<std::string, std::string>;

/** The stage by the part behind the last dot, which is an ending of stage_names(). */
Stage stage_named(const std::string &path)
{
  const std::string ending = path.substr(path.rfind('.') + 1);
  const auto found = std::ranges::find(stage_names(), ending, &StageName::ending);
  EXPECT_NE(found, stage_names().end()) << path;
  return found->stage;
}

/** Checks the files of \a texts whose names end in a stage; others are there for includes. */
ProgramCheck check_texts(const Texts &texts, ProgramOptions options = {}, const std::vector<std::string> &defines = {})
{
  Program program{"test", {}, defines};
  for (const auto &[path, text] : texts) {
    if (!path.ends_with(".glsl")) {
      program.files.push_back({stage_named(path), path});
    }
  }
  const gpu::ShaderFiles files = [&texts](std::string_view path) -> std::optional<std::string_view> {
    const auto found = texts.find(std::string(path));
    return found == texts.end() ? std::nullopt : std::optional<std::string_view>(found->second);
  };
  options.stage_errors = StageErrors::All;
  return check_program(program, files, options);
}

std::string messages_of(const ProgramCheck &check)
{
  std::string text;
  for (const CheckMessage &m : check.messages) {
    text += fmt::format("{}:{}: {}: {} [{}]\n", m.file, m.line, to_string(m.severity), m.text, m.rule);
  }
  return text;
}

ProgramOptions for_target(CheckTarget target)
{
  ProgramOptions options;
  options.target = target;
  return options;
}

constexpr std::array vulkan_targets = {CheckTarget::Vulkan10, CheckTarget::Vulkan11, CheckTarget::Vulkan12,
                                       CheckTarget::Vulkan13};

TEST(CheckProgram, PushConstantsHaveAnyNameInAnyStage)
{
  for (const std::string name : {"Push", "pc", "push_constant_block", "Constants1", "U_"}) {
    for (const std::string instance : {"", "p", "push_constants"}) {
      const std::string block =
          "#version 450\nlayout(push_constant) uniform " + name + " { mat4 m; vec4 v; } " + instance + ";\n";
      const std::string v = (instance.empty() ? "" : instance + ".") + "v";
      const Texts stages = {
          {"a.vert", block + "void main() { gl_Position = " + v + "; }\n"},
          {"b.frag", block + "layout(location = 0) out vec4 c;\nvoid main() { c = " + v + "; }\n"},
          {"c.comp", block +
                         "layout(local_size_x = 4) in;\nlayout(r32f, binding = 0) uniform image2D i;\n"
                         "void main() { imageStore(i, ivec2(0), " +
                         v + "); }\n"},
          {"d.geom", block +
                         "layout(points) in;\nlayout(points, max_vertices = 1) out;\n"
                         "void main() { gl_Position = " +
                         v + "; EmitVertex(); }\n"},
          {"e.tese", block + "layout(triangles) in;\nvoid main() { gl_Position = " + v + "; }\n"}};
      for (const auto &[path, text] : stages) {
        for (const CheckTarget target : vulkan_targets) {
          EXPECT_EQ(messages_of(check_texts({{path, text}}, for_target(target))), "") << text << to_string(target);
        }
        EXPECT_TRUE(is_vulkan(check_texts({{path, text}}).target)) << text;
      }
    }
  }
}

struct Connection {
  std::string output;
  std::string input;
  std::string read;
  /** The line of the mistake and its rule; line 0: there is none. */
  int line = 0;
  std::string rule{};
};

TEST(CheckProgram, MembersOfBlocksAndStructsAreConnectedInVulkan)
{
  const std::string pair = "struct S {\nvec4 a;\nvec4 b;\n};\n";
  const std::string other_pair = "struct S {\nvec4 a;\nvec2 b;\n};\n";
  const std::string array = "struct S {\nvec4 a;\nvec4 b[2];\n};\n";
  const std::vector<Connection> connections = {
      {"layout(location = 0) out B { vec4 x; vec4 y; } o;", "layout(location = 0) in B {\nvec4 x;\nvec4 y;\n} i;",
       "i.y"},
      {"layout(location = 0) out B { vec4 x; } o;", "layout(location = 0) in B {\nvec4 x;\nvec4 y;\n} i;", "i.x + i.y",
       4, "missing-varying"},
      // A member that is not read needs no output.
      {"layout(location = 0) out B { vec4 x; } o;", "layout(location = 0) in B {\nvec4 x;\nvec4 y;\n} i;", "i.x"},
      {"layout(location = 0) out B { vec4 x; vec2 y; } o;", "layout(location = 0) in B {\nvec4 x;\nvec4 y;\n} i;",
       "i.y", 4, "varying-type"},
      {"out B { layout(location = 0) vec4 x; layout(location = 2) vec4 y; } o;",
       "in B {\nlayout(location = 0) vec4 x;\nlayout(location = 1) vec4 y;\n} i;", "i.y", 4, "missing-varying"},
      // Names of blocks and members do not count, and a member may be connected to a variable.
      {"layout(location = 1) out Other { vec4 x; mat2 m; vec4 y; } o;",
       "layout(location = 1) in vec4 x;\nlayout(location = 2) in B {\nmat2 m;\nvec4 z;\n} i;", "x + i.z + i.m[0].xyxy"},
      {"layout(location = 1) out Other { vec4 x; mat2 m; vec4 y; } o;",
       "layout(location = 1) in vec4 x;\nlayout(location = 4) in B {\nvec2 z;\n} i;", "x + i.z.xyxy", 4,
       "varying-type"},
      {pair + "layout(location = 0) out S s;", pair + "layout(location = 0) in S s;", "s.a + s.b"},
      {other_pair + "layout(location = 0) out S s;", pair + "layout(location = 0) in S s;", "s.a", 4, "varying-type"},
      {array + "layout(location = 0) out S s;", pair + "layout(location = 0) in S s;", "s.a", 4, "varying-type"},
      {"struct S { vec4 a; };\nlayout(location = 0) out S s;", pair + "layout(location = 0) in S s;", "s.a", 6,
       "varying-type"},
      {pair + "layout(location = 0) out B { S s[2]; } o;", pair + "layout(location = 0) in B {\nS s[2];\n} i;",
       "i.s[1].b"},
      {other_pair + "layout(location = 0) out B { S s[2]; } o;", pair + "layout(location = 0) in B {\nS s[2];\n} i;",
       "i.s[1].b", 4, "varying-type"},
      {pair + "layout(location = 0) out B { S s[2]; } o;", pair + "layout(location = 0) in B {\nS s[3];\n} i;",
       "i.s[1].b", 3, "varying-type"},
  };
  for (const Connection &one : connections) {
    const std::string messages = messages_of(
        check_texts({{"x.vert", "#version 450\n" + one.output + "\nvoid main() { gl_Position = vec4(0); }\n"},
                     {"x.frag", "#version 450\n" + one.input +
                                    "\nlayout(location = 0) out vec4 c;\nvoid main() { c = " + one.read + "; }\n"}},
                    for_target(CheckTarget::Vulkan12)));
    const std::size_t at = messages.find(fmt::format("x.frag:{}: error: ", one.line));
    EXPECT_EQ(messages.find(": error: ") != std::string::npos, one.line > 0) << one.output << one.input << messages;
    if (one.line > 0) {
      ASSERT_NE(at, std::string::npos) << one.output << one.input << messages;
      EXPECT_NE(messages.substr(at, messages.find('\n', at) - at).find("[" + one.rule + "]"), std::string::npos)
          << messages;
    }
  }
}

TEST(CheckProgram, StagesThatADriverDoesNotLinkAreErrors)
{
  if (!left_out_rules(CheckTarget::OpenGl).empty()) {
    GTEST_SKIP() << "declarations of OpenGL need glslang's syntax tree, which this build has not";
  }
  const auto is_linked = [](const std::string &vertex, const std::string &fragment, CheckTarget target) {
    const ProgramCheck check = check_texts({{"x.vert", vertex}, {"x.frag", fragment}}, for_target(target));
    EXPECT_TRUE(!check.has_errors() || messages_of(check).find("[link]") != std::string::npos) << messages_of(check);
    return !check.has_errors();
  };
  // Mesa 22 links the same programs, except that it takes `smooth` for another qualifier than none before 4.40.
  for (const int version : {130, 150, 330, 400, 430, 440, 450, 460}) {
    for (const std::string output : {"", "smooth ", "flat ", "noperspective "}) {
      for (const std::string input : {"", "smooth ", "flat ", "noperspective "}) {
        const auto plain = [](const std::string &word) { return word == "smooth " ? std::string() : word; };
        const std::string head = fmt::format("#version {}\n", version);
        EXPECT_EQ(is_linked(head + output + "out vec4 v;\nvoid main() { gl_Position = v = vec4(1); }\n",
                            head + input + "in vec4 v;\nout vec4 c;\nvoid main() { c = v; }\n", CheckTarget::OpenGl),
                  version >= 440 || plain(output) == plain(input))
            << version << output << input;
      }
    }
  }
  for (const int version : {120, 130, 330, 410, 420, 450}) {
    const std::string head = fmt::format("#version {}\n", version);
    const bool is_old = version < 130;
    EXPECT_EQ(is_linked(head + "invariant " + (is_old ? "varying" : "out") +
                            " vec4 v;\nvoid main() { gl_Position = v = vec4(1); }\n",
                        head + (is_old ? "varying vec4 v;\n" : "in vec4 v;\nout vec4 c;\n") + "void main() { " +
                            (is_old ? "gl_FragColor" : "c") + " = v; }\n",
                        CheckTarget::OpenGl),
              version >= 420)
        << version;
  }
  const std::map<std::string, std::pair<std::string, std::string>> es = {
      {"", {"varying vec4 v;\n", "gl_FragColor"}},
      {"#version 300 es\n", {"in vec4 v;\nout vec4 c;\n", "c"}},
      {"#version 310 es\n", {"in vec4 v;\nout vec4 c;\n", "c"}}};
  for (const auto &[before, vertex] : es) {
    for (const auto &[after, fragment] : es) {
      EXPECT_EQ(is_linked(before + (before.empty() ? "varying" : "out") +
                              " vec4 v;\nvoid main() { gl_Position = v = vec4(1.0); }\n",
                          after + "precision mediump float;\n" + fragment.first + "void main() { " + fragment.second +
                              " = v; }\n",
                          CheckTarget::Es),
                before == after)
          << before << after;
    }
  }
  for (const bool is_es3 : {true, false}) {
    for (const bool is_used : {true, false}) {
      const std::string version = is_es3 ? "#version 300 es\n" : "";
      EXPECT_EQ(
          is_linked(
              version + "uniform highp vec4 tint;\nvoid main() { gl_Position = " + (is_used ? "tint" : "vec4(1.0)") +
                  "; }\n",
              version + "precision mediump float;\nuniform vec4 tint;\n" +
                  (is_es3 ? "out vec4 c;\nvoid main() { c = tint; }\n" : "void main() { gl_FragColor = tint; }\n"),
              CheckTarget::Es),
          !is_es3 && !is_used)
          << version << is_used;
    }
  }
  EXPECT_FALSE(is_linked("#version 300 es\nvoid main() { gl_Position = vec4(1.0); }\n",
                         "#version 330\nout vec4 c;\nvoid main() { c = vec4(1); }\n", CheckTarget::OpenGl));
}

TEST(CheckProgram, ALevelCommentIsReadOrNamed)
{
  const auto out_of = [](const std::string &file, const std::string &line) {
    return messages_of(
        check_texts({{"x.frag", "#version 450\n" + file +
                                    "\nlayout(location = 0) out vec4 c;\nlayout(binding = 0) uniform sampler2D t;" +
                                    line + "\nvoid main() { c = vec4(1); }\n"}}));
  };
  for (const std::string start :
       {"// shader-check: ", "//shader-check:", "//  shader-check :  ", "/* shader-check:\t"}) {
    const std::string end = start.starts_with("/*") ? " */" : "";
    for (const std::string equals : {"=", " = ", "= "}) {
      const std::string out = out_of(start + "unused-binding" + equals + "off" + end, "");
      EXPECT_EQ(out, "") << start << equals;
      const std::string error = out_of(start + "unused-binding" + equals + "error, why" + end, "");
      EXPECT_NE(error.find("x.frag:4: error: "), std::string::npos) << start << equals << error;
    }
    const std::string out = out_of("", start + "unused-binding, why" + end);
    EXPECT_EQ(out, "") << start;
    for (const auto &[comment, message] :
         {std::pair("unused-bindings=off", "there is no rule 'unused-bindings'"),
          {"unused-bindings", "there is no rule 'unused-bindings'"},
          {"unused-binding=none", "there is no level 'none'; there are off, warning and error"},
          {"unused-binding =", "there is no level ''"},
          {"link=off", "rule 'link' has no level"}}) {
      const std::string fault = out_of(start + comment + end, "");
      EXPECT_NE(fault.find(fmt::format("x.frag:2: warning: {}", message)), std::string::npos)
          << start << comment << fault;
      EXPECT_NE(fault.find("[level-comment]"), std::string::npos) << fault;
      EXPECT_NE(fault.find("[unused-binding]"), std::string::npos) << fault;
    }
  }
}

TEST(CheckProgram, VaryingsOfOpenGlAreConnectedAsByADriver)
{
  if (!left_out_rules(CheckTarget::OpenGl).empty()) {
    GTEST_SKIP() << "declarations of OpenGL need glslang's syntax tree, which this build has not";
  }
  struct Pair {
    std::string vertex;
    std::string fragment;
    bool is_linked;
  };
  const std::string head = "#version 450 compatibility\n";
  // Mesa 22 has these verdicts.
  for (const auto &[vertex, fragment, is_linked] : {
           Pair{"#version 120\n#pragma STDGL invariant(all)\nvarying vec4 v;\nvoid main() { gl_Position = v = vec4(1); "
                "}\n",
                "#version 120\ninvariant varying vec4 v;\nvoid main() { gl_FragColor = v; }\n", true},
           {"varying vec4 gl_TexCoord[2];\nvoid main() { gl_Position = gl_TexCoord[0] = vec4(1); }\n",
            "varying vec4 gl_TexCoord[1];\nvoid main() { gl_FragColor = gl_TexCoord[0]; }\n", true},
           {head + "layout(location = 3) out vec4 v;\nvoid main() { v = vec4(1); }\n",
            head + "in vec4 v;\nvoid main() { gl_FragColor = v; }\n", false},
           {head + "layout(location = 3) out vec4 v;\nvoid main() { v = vec4(1); }\n",
            head + "layout(location = 3) in vec4 w;\nvoid main() { gl_FragColor = w; }\n", true},
           {head + "out B { float a[]; } b;\nvoid main() { b.a[1] = 1; }\n",
            head + "in B { float a[2]; } b;\nvoid main() { gl_FragColor = vec4(b.a[1]); }\n", true},
           {head + "layout(location = 0) out float a[3];\nlayout(location = 0, component = 1) out vec2 b[3];\n"
                   "void main() { a[1] = 1; b[1] = vec2(1); }\n",
            head + "layout(location = 0, component = 1) in vec2 c[3];\nlayout(location = 0) in float d[3];\n"
                   "void main() { gl_FragColor = vec4(c[1], d[1], 1); }\n",
            true},
           {head + "layout(location = 0) flat out double a;\nlayout(location = 0, component = 2) flat out double b;\n"
                   "void main() { a = b = 1; }\n",
            head + "layout(location = 0, component = 2) flat in double c;\nlayout(location = 0) flat in double d;\n"
                   "void main() { gl_FragColor = vec4(c, d, 1, 1); }\n",
            true},
       }) {
    const ProgramCheck check = check_texts({{"x.vert", vertex}, {"x.frag", fragment}}, for_target(CheckTarget::OpenGl));
    EXPECT_EQ(!check.has_errors(), is_linked) << vertex << fragment << messages_of(check);
  }
  for (const std::string size : {"[2]", "[3]"}) {
    const std::string version = "#version 410\n";
    const ProgramCheck check = check_texts(
        {{"x.tesc",
          version + "layout(vertices = 3) out;\npatch out vec4 tint[3];\nvoid main() { tint[1] = vec4(1); }\n"},
         {"x.tese", version + "layout(triangles) in;\npatch in vec4 tint" + size +
                        ";\nvoid main() { gl_Position = tint[1]; }\n"}},
        for_target(CheckTarget::OpenGl));
    EXPECT_EQ(!check.has_errors(), size == "[3]") << messages_of(check);
  }
}

TEST(CheckProgram, AnInputThatIsAPartOfOutputsIsWrittenAsAWhole)
{
  for (const auto &[outputs, input, is_written] :
       {std::tuple("layout(location = 2) out mat4 m;", "layout(location = 4) in mat2x4 v;", true),
        {"layout(location = 2) out mat4 m;", "layout(location = 5) in mat2x4 v;", false},
        {"layout(location = 2) out vec4 m[3]; layout(location = 5) out vec4 n;", "layout(location = 4) in vec4 v[2];",
         true},
        {"layout(location = 2) out vec4 m[3]; layout(location = 6) out vec4 n;", "layout(location = 4) in vec4 v[2];",
         false},
        {"layout(location = 2) out vec4 m[3]; layout(location = 6) out vec4 n;", "layout(location = 1) in vec4 v[2];",
         false}}) {
    const ProgramCheck check = check_texts(
        {{"x.vert", fmt::format("#version 450\n{}\nvoid main() {{ gl_Position = vec4(0); }}\n", outputs)},
         {"x.frag",
          fmt::format("#version 450\n{}\nlayout(location = 0) out vec4 c;\nvoid main() {{ c = v[1]; }}\n", input)}},
        for_target(CheckTarget::Vulkan12));
    EXPECT_EQ(messages_of(check).find("[missing-varying]") == std::string::npos, is_written) << messages_of(check);
  }
}

TEST(CheckProgram, UniformsOfOpenGlHaveLocationsOfTheirOwn)
{
  if (!left_out_rules(CheckTarget::OpenGl).empty()) {
    GTEST_SKIP() << "declarations of OpenGL need glslang's syntax tree, which this build has not";
  }
  const auto message = [](const std::string &first, const std::string &second, const std::string &fragment) {
    return messages_of(check_texts(
        {{"x.vert", "#version 430\n" + first + "\n" + second + "\nvoid main() { gl_Position = vec4(0); }\n"},
         {"x.frag", "#version 430\n" + fragment + "\nout vec4 c;\nvoid main() { c = vec4(1); }\n"}},
        for_target(CheckTarget::OpenGl)));
  };
  // Mesa 22 links those without a line.
  for (const auto &[first, second, fragment, line] :
       {std::tuple("layout(location = 1) uniform float a;", "layout(location = 2) uniform float b;",
                   "layout(location = 1) uniform float a;", ""),
        {"layout(location = 1) uniform float a;", "", "layout(location = 1) uniform float b;",
         "x.frag:2: error: uniform 'b' has location 1, which uniform 'a' has in the vertex stage [link]"},
        {"layout(location = 2) uniform float c;", "layout(location = 2) uniform float a;", "",
         "x.vert:3: error: 'location' : overlapping use of location 2 [compile]"},
        {"layout(location = 1) uniform mat4 a[2];", "", "layout(location = 2) uniform vec2 b[3];",
         "x.frag:2: error: uniform 'b' has location 2, which uniform 'a' has"},
        {"layout(location = 1) uniform mat4 a[2];", "", "layout(location = 3) uniform vec2 b[3];", ""},
        {"layout(location = 1) uniform vec4 a[3];", "", "layout(location = 3) uniform sampler2D t;",
         "x.frag:2: error: uniform 't' has location 3, which uniform 'a' has in the vertex stage"},
        {"struct S { vec4 x; float y[2]; }; layout(location = 1) uniform S a;", "",
         "layout(location = 4) uniform sampler2D t;", ""},
        {"struct S { vec4 x; float y[2]; }; layout(location = 1) uniform S a;", "",
         "layout(location = 3) uniform sampler2D t;", "x.frag:2: error: uniform 't' has location 3"}}) {
    const std::string out = message(first, second, fragment);
    EXPECT_EQ(out.find("error: ") == std::string::npos, std::string(line).empty()) << out;
    EXPECT_NE(out.find(line), std::string::npos) << out;
  }
}

TEST(CheckProgram, SeveralShadersOfAStageAreLinked)
{
  if (!left_out_rules(CheckTarget::OpenGl).empty()) {
    GTEST_SKIP() << "declarations of OpenGL need glslang's syntax tree, which this build has not";
  }
  const std::string version = "#version 330\n";
  const Texts right = {
      {"a.vert", version + "vec4 place();\nvoid pass();\nvoid main() { gl_Position = place(); pass(); }\n"},
      {"b.vert", version + "uniform mat4 matrix;\nvec4 place() { return matrix[0]; }\n"},
      {"c.vert", version + "out vec2 uv;\nvoid pass() { uv = vec2(1); }\n"},
      {"d.frag", version + "vec4 shade();\nout vec4 c;\nvoid main() { c = shade(); }\n"},
      {"e.frag", version + "in vec2 uv;\nuniform sampler2D t;\nuniform mat4 matrix;\n"
                           "vec4 shade() { return texture(t, uv) + matrix[1]; }\n"}};
  const ProgramCheck check = check_texts(right);
  EXPECT_EQ(messages_of(check), "");
  EXPECT_EQ(check.target, CheckTarget::OpenGl);
  EXPECT_EQ(check.target_reason, "a.vert and b.vert are of one stage, which OpenGL alone links");
  // Mesa 22 refuses the same programs, and says nothing where there is a warning.
  for (const auto &[path, from, to, message] : {
           std::tuple("b.vert", "place()", "other()", "[link]"),
           {"c.vert", "void pass()", "void main() {} void pass()", "[link]"},
           {"e.frag", "mat4 matrix", "vec4 matrix", "[link]"},
           {"e.frag", "in vec2 uv", "flat in vec2 uv", "e.frag:2: error: input 'uv' is flat"},
           {"c.vert", "out vec2 uv;", "out vec2 uv; out vec4 rest;",
            "c.vert:2: warning: output 'rest' is not read by the fragment stage [unread-output]"},
           {"e.frag", "uniform sampler2D t;", "uniform sampler2D t, u;",
            "e.frag:3: warning: texture 'u' is declared and never read [unused-binding]"},
           {"c.vert", "out vec2 uv;", "out vec2 uv; out vec4 rest; // shader-check: unread-output, kept", ""},
       }) {
    Texts changed = right;
    std::string &text = changed.at(path);
    text.replace(text.find(from), std::string(from).size(), to);
    const std::string out = messages_of(check_texts(changed));
    EXPECT_EQ(out.empty(), std::string(message).empty()) << path << to << out;
    EXPECT_NE(out.find(message), std::string::npos) << path << to << out;
  }
  Texts sizes = right;
  sizes.at("b.vert") += "uniform float weights[2];\nfloat first() { return weights[0]; }\n";
  sizes.at("c.vert") += "uniform float weights[3];\nfloat last() { return weights[2]; }\n";
  EXPECT_NE(messages_of(check_texts(sizes)).find("[link]"), std::string::npos) << messages_of(check_texts(sizes));
  for (const CheckTarget target : {CheckTarget::OpenGlSpirv, CheckTarget::Es, CheckTarget::Vulkan12}) {
    EXPECT_NE(messages_of(check_texts(right, for_target(target)))
                  .find(fmt::format("b.vert:1: error: a.vert has the vertex stage as well. Only OpenGL links several "
                                    "shaders of one stage, and the target is {} [link]",
                                    to_string(target))),
              std::string::npos)
        << to_string(target);
  }
}

TEST(CheckProgram, OneNameHasOneKindInAllStages)
{
  const auto message = [](const std::string &vertex, const std::string &fragment, CheckTarget target) {
    return messages_of(check_texts(
        {{"x.vert", "#version 450\n" + vertex + "\nvoid main() { gl_Position = " +
                        (vertex.find("sampler") == std::string::npos ? "b.v" : "texture(t, vec2(0))") + "; }\n"},
         {"x.frag", "#version 450\nlayout(location = 0) out vec4 c;\n" + fragment + "\nvoid main() { c = " +
                        (fragment.find("sampler") == std::string::npos ? "b.v" : "texture(t, vec3(0))") + "; }\n"}},
        for_target(target)));
  };
  const std::string uniform = "layout(binding = 0) uniform B { vec4 v; } b;";
  const std::string storage = "layout(binding = 1) buffer B { vec4 v; } b;";
  for (const auto &[vertex, fragment, file] :
       {std::tuple(uniform, storage, "x.frag:3"), {storage, uniform, "x.vert:2"}}) {
    const std::string out = message(vertex, fragment, CheckTarget::Vulkan12);
    EXPECT_NE(out.find(std::string(file) + ": warning: 'B' is a storage block here"), std::string::npos) << out;
    EXPECT_NE(out.find("[block-match]"), std::string::npos) << out;
  }
  const std::string out = message("layout(binding = 0) uniform sampler2D t;",
                                  "layout(binding = 0) uniform samplerCube t;", CheckTarget::OpenGl);
  if (left_out_rules(CheckTarget::OpenGl).empty()) {
    EXPECT_NE(out.find("x.frag:3: error: texture 't' is samplerCube here and sampler2D in an earlier stage [link]"),
              std::string::npos)
        << out;
  }
  // A file in UTF-32 is named in both orders of bytes, with and without a mark.
  for (const bool has_mark : {true, false}) {
    for (const bool is_little : {true, false}) {
      std::string wide = !has_mark ? "" : is_little ? std::string("\xFF\xFE\0\0", 4) : std::string("\0\0\xFE\xFF", 4);
      for (const char c : std::string("#version 450\n")) {
        wide += is_little ? std::string{c, 0, 0, 0} : std::string{0, 0, 0, c};
      }
      const std::string out_of_wide = messages_of(check_texts({{"w.frag", wide}}));
      EXPECT_EQ(out_of_wide.find("w.frag:1: error: the file is text in UTF-32"), 0U) << out_of_wide;
    }
  }
}

TEST(CheckProgram, EveryStageIsCompiled)
{
  const std::string rays = "#version 460\n#extension GL_EXT_ray_tracing : require\n";
  const std::string payload = rays + "layout(location = 0) rayPayloadInEXT vec4 payload;\n";
  const std::string mesh = "#version 450\n#extension GL_EXT_mesh_shader : require\nlayout(local_size_x = 1) in;\n";
  const std::map<Stage, std::string> texts = {
      {Stage::Vertex, "#version 450\nvoid main() { gl_Position = vec4(0); }\n"},
      {Stage::TessControl, "#version 450\nlayout(vertices = 3) out;\nvoid main() { gl_TessLevelOuter[0] = 1.0; }\n"},
      {Stage::TessEvaluation, "#version 450\nlayout(triangles) in;\nvoid main() { gl_Position = vec4(0); }\n"},
      {Stage::Geometry,
       "#version 450\nlayout(points) in;\nlayout(points, max_vertices = 1) out;\n"
       "void main() { EmitVertex(); }\n"},
      {Stage::Fragment, "#version 450\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(1); }\n"},
      {Stage::Compute, "#version 450\nlayout(local_size_x = 64) in;\nvoid main() { barrier(); }\n"},
      {Stage::Task, mesh + "void main() { EmitMeshTasksEXT(1, 1, 1); }\n"},
      {Stage::Mesh, mesh + "layout(triangles, max_vertices = 3, max_primitives = 1) out;\n"
                           "void main() { SetMeshOutputsEXT(0, 0); }\n"},
      {Stage::RayGeneration,
       rays + "layout(location = 0) rayPayloadEXT vec4 payload;\nvoid main() { payload = vec4(0); }\n"},
      {Stage::Intersection, rays + "hitAttributeEXT vec2 at;\nvoid main() { reportIntersectionEXT(1.0, 0u); }\n"},
      {Stage::AnyHit, payload + "void main() { ignoreIntersectionEXT; }\n"},
      {Stage::ClosestHit, payload + "void main() { payload = vec4(1); }\n"},
      {Stage::Miss, payload + "void main() { payload = vec4(0); }\n"},
      {Stage::Callable, rays + "layout(location = 0) callableDataInEXT vec4 d;\nvoid main() { d = vec4(0); }\n"}};
  ASSERT_EQ(texts.size(), stage_names().size());
  for (const StageName &stage : stage_names()) {
    std::string text = texts.at(stage.stage);
    const std::string path = fmt::format("any.{}", stage.ending);
    const ProgramCheck check = check_texts({{path, text}}, for_target(CheckTarget::Vulkan12));
    EXPECT_EQ(messages_of(check), "") << text;
    ASSERT_EQ(check.spirv.size(), 1U);
    EXPECT_EQ(check.spirv[0].first, stage.stage);
    EXPECT_EQ(check.spirv[0].second.at(0), 0x07230203U) << "the first word of SPIR-V";
    EXPECT_TRUE(is_vulkan(check_texts({{path, text}}).target) || stage.stage == Stage::Vertex) << text;
    text.replace(text.rfind('}'), 1, "oops; }");
    const ProgramCheck broken = check_texts({{path, text}}, for_target(CheckTarget::Vulkan12));
    const int line = int(std::ranges::count(text.substr(0, text.find("oops")), '\n')) + 1;
    ASSERT_FALSE(broken.messages.empty()) << text;
    EXPECT_EQ(messages_of(broken).find(fmt::format("{}:{}: error: 'oops' : undeclared identifier", path, line)), 0U)
        << messages_of(broken);
    EXPECT_TRUE(broken.spirv.empty());
  }
}

TEST(CheckProgram, StagesBetweenVertexAndFragmentPassVaryingsOn)
{
  const auto program = [](int location, const std::string &type) {
    const std::string at = fmt::format("layout(location = {}) ", location);
    return Texts{
        {"p.vert", "#version 450\n" + at + "out " + type + " from_vertex;\nvoid main() { from_vertex = " + type +
                       "(1); gl_Position = vec4(0); }\n"},
        {"p.tesc", "#version 450\nlayout(vertices = 3) out;\n" + at + "in " + type + " read[];\n" + at + "out " + type +
                       " kept[];\nvoid main() { kept[gl_InvocationID] = read[gl_InvocationID]; "
                       "gl_TessLevelOuter[0] = 1.0; }\n"},
        {"p.tese", "#version 450\nlayout(triangles) in;\n" + at + "in " + type + " kept[];\n" +
                       fmt::format("layout(location = {}) out {} normal;\n", location + 1, type) +
                       "void main() { normal = kept[0]; gl_Position = vec4(0); }\n"},
        {"p.frag", fmt::format("#version 450\nlayout(location = {}) in {} normal;\nlayout(location = 0) out vec4 c;\n",
                               location + 1, type) +
                       "void main() { c = vec4(1) * normal[0]; }\n"}};
  };
  for (const int location : {0, 3, 7}) {
    for (const std::string type : {"vec2", "vec3", "vec4"}) {
      const Texts all = program(location, type);
      EXPECT_EQ(messages_of(check_texts(all, for_target(CheckTarget::Vulkan12))), "") << location << type;
      Texts without = all;
      without.erase("p.tesc");
      without.erase("p.tese");
      EXPECT_NE(messages_of(check_texts(without, for_target(CheckTarget::Vulkan12))).find("[missing-varying]"),
                std::string::npos);
    }
  }
}

TEST(CheckProgram, AGeometryStagePassesInputsThrough)
{
  for (const auto &[declaration, name] :
       {std::pair("layout(location = 1, passthrough) in vec3 n[];\n", "vec3 n;\n"),
        {"layout(location = 1, passthrough) in B { vec3 n; } b[];\n", "B { vec3 n; };\n"}}) {
    const auto program = [&, block = std::string(name)](const std::string &geometry) {
      return Texts{{"p.vert", "#version 450\nlayout(location = 1) out " + block +
                                  "void main() { n = vec3(1); gl_Position = vec4(0); }\n"},
                   {"p.geom",
                    "#version 450\n#extension GL_NV_geometry_shader_passthrough : require\n"
                    "layout(triangles) in;\n" +
                        geometry + "void main() { gl_Layer = 1; }\n"},
                   {"p.frag", "#version 450\nlayout(location = 1) in " + block +
                                  "layout(location = 0) out vec4 c;\nvoid main() { c = vec4(n, 1); }\n"}};
    };
    EXPECT_EQ(messages_of(check_texts(program(declaration), for_target(CheckTarget::Vulkan12))), "") << declaration;
  }
}

TEST(CheckProgram, BlocksOfOneNameMayDifferInVulkan)
{
  const auto program = [](const std::string &vertex, const std::string &fragment) {
    return Texts{{"p.vert", "#version 450\n" + vertex + "\nvoid main() { gl_Position = vec4(b.v[0]); }\n"},
                 {"p.frag", "#version 450\nlayout(location = 0) out vec4 c;\n" + fragment +
                                "\nvoid main() { c = vec4(b.v[0]); }\n"}};
  };
  const std::string one = "layout(binding = 0) uniform Any { vec4 v; } b;";
  for (const std::string &other : {std::string("layout(binding = 1) uniform Any { vec4 v; } b;"),
                                   std::string("layout(binding = 0) uniform Any { vec2 v; } b;"),
                                   std::string("layout(binding = 0) uniform Any { vec4 v; vec4 w; } b;")}) {
    for (const CheckTarget target : vulkan_targets) {
      const ProgramCheck check = check_texts(program(one, other), for_target(target));
      EXPECT_FALSE(check.has_errors()) << messages_of(check);
      EXPECT_NE(messages_of(check).find("warning: "), std::string::npos) << other;
      EXPECT_NE(messages_of(check).find("[block-match]"), std::string::npos) << messages_of(check);
      EXPECT_EQ(check.spirv.size(), 2U);
    }
    EXPECT_TRUE(check_texts(program(one, other), for_target(CheckTarget::OpenGl)).has_errors()) << other;
  }
  const Texts constants = program("layout(push_constant) uniform P { vec4 v; } b;",
                                  "layout(push_constant) uniform P { layout(offset = 16) vec2 v; } b;");
  EXPECT_EQ(messages_of(check_texts(constants, for_target(CheckTarget::Vulkan12))), "");
}

struct Dialect {
  std::string version;
  CheckTarget target;
  bool has_out = true;
};

std::vector<Dialect> dialects()
{
  std::vector<Dialect> all;
  for (const int version : {110, 120, 130, 140, 150, 330, 400, 410, 420, 430, 440, 450, 460}) {
    all.push_back({fmt::format("#version {}\n", version), CheckTarget::OpenGl, version >= 130});
    if (version >= 150) {
      all.push_back({fmt::format("#version {} core\n", version), CheckTarget::OpenGl, true});
      all.push_back({fmt::format("  #  version {}   compatibility\n", version), CheckTarget::OpenGl, true});
    }
  }
  all.push_back({"", CheckTarget::OpenGl, false});
  all.push_back({"#version 100\n", CheckTarget::Es, false});
  for (const int version : {300, 310, 320}) {
    all.push_back({fmt::format("#version {} es\n", version), CheckTarget::Es, true});
  }
  return all;
}

/** A fragment shader whose color is \a value. Its declarations name no location or binding. */
std::string fragment_of(const Dialect &dialect, const std::string &value)
{
  const std::string precision = dialect.target == CheckTarget::Es ? "precision mediump float;\n" : "";
  return dialect.version + precision + (dialect.has_out ? "in vec2 uv;\nout vec4 result;\n" : "varying vec2 uv;\n") +
         "uniform sampler2D picture;\n" + "void main() { " + (dialect.has_out ? "result" : "gl_FragColor") + " =\n" +
         value + "\n; }\n";
}

TEST(CheckProgram, EveryVersionOfOpenGlAndEsIsCompiledAndRecognised)
{
  for (const Dialect &dialect : dialects()) {
    const std::string read = dialect.has_out ? "texture(picture, uv)" : "texture2D(picture, uv)";
    const Texts texts{{"x.frag", fragment_of(dialect, read)}};
    EXPECT_EQ(messages_of(check_texts(texts, for_target(dialect.target))), "") << texts.at("x.frag");
    const ProgramCheck found = check_texts(texts);
    EXPECT_EQ(found.target, dialect.target) << texts.at("x.frag") << found.target_reason;
    EXPECT_EQ(messages_of(found), "") << texts.at("x.frag");
    EXPECT_FALSE(found.target_reason.empty());
    EXPECT_TRUE(check_texts(texts, for_target(dialect.target)).target_reason.empty());
  }
}

/** A fragment shader that includes by \a lines and returns \a value. */
std::string including(const std::string &lines, const std::string &value)
{
  return "#version 450\n#extension GL_GOOGLE_include_directive : require\n" + lines +
         "layout(location = 0) out vec4 c;\nvoid main() { c = vec4(" + value + "); }\n";
}

TEST(CheckProgram, TheTargetFollowsFromSigns)
{
  const std::string out = "layout(location = 0) out vec4 c;\n";
  const std::string main = "void main() { c = vec4(1.0); }\n";
  std::vector<std::pair<std::string, CheckTarget>> fragments = {
      {"#version 330\n#ifdef VULKAN\nlayout(push_constant) uniform P { float k; };\n#else\nuniform float k;\n#endif\n"
       "out vec4 c;\nvoid main() { c = vec4(k); }\n",
       CheckTarget::OpenGl},
      {"#version 450\n#ifdef GL_SPIRV\n#extension GL_ARB_gl_spirv : enable\n#endif\nuniform float k;\nout vec4 c;\n"
       "void main() { c = vec4(k); }\n",
       CheckTarget::OpenGl},
      {"#version 450\n#ifdef FOG\nvoid f() {\n#else\nvoid g() {\n#endif\n}\nuniform float k;\n" + out + main,
       CheckTarget::OpenGl},
      {"varying lowp vec2 uv; uniform lowp sampler2D t; void main() { gl_FragColor = texture2D(t, uv); }\n",
       CheckTarget::Es},
      {"#ifdef GL_ES\nprecision mediump float;\n#endif\nvarying vec2 uv;\nvoid main() { gl_FragColor = vec4(uv, 0, 1); "
       "}\n",
       CheckTarget::Es},
      {"#ifdef GL_ES\nprecision mediump float;\n#endif\nvoid main() { gl_FragColor = gl_Color; }\n",
       CheckTarget::OpenGl},
      {"#version 450\n#extension GL_EXT_shader_explicit_arithmetic_types_int64 : enable\nuniform float k;\nout vec4 "
       "c;\n"
       "void main() { c = vec4(k, float(uint64_t(1)), 0, 0); }\n",
       CheckTarget::OpenGl},
      {"#version 450\n#extension GL_EXT_nonuniform_qualifier : enable\n" + out + main, CheckTarget::Vulkan12},
      {"#version 450\n#ifdef VULKAN\nlayout(push_constant) uniform P { float k; };\n#else\nconst float k = "
       "1.0;\n#endif\n" +
           out + "void main() { c = vec4(k); }\n",
       CheckTarget::Vulkan12}};
  for (const auto &[text, target] : fragments) {
    const ProgramCheck check = check_texts({{"x.frag", text}});
    EXPECT_EQ(check.target, target) << text << check.target_reason;
    EXPECT_EQ(messages_of(check), "") << text;
  }
  for (const std::string version : {"310 es", "320 es", "450"}) {
    for (const std::string sign : {"layout(constant_id = 3) const int N = 4;\n", "layout(local_size_x_id = 0) in;\n",
                                   "layout(local_size_y_id = 1) in;\n", "layout(local_size_z_id = 2) in;\n"}) {
      const ProgramCheck check = check_texts(
          {{"x.comp", "#version " + version + "\nlayout(local_size_x = 1) in;\n" + sign + "void main() {}\n"}});
      EXPECT_TRUE(is_vulkan(check.target)) << version << sign << check.target_reason;
    }
  }
  const std::string guarded =
      "#ifndef A_H\n#define A_H\nlayout(push_constant) uniform P { float k; };\n#endif // A_H\n";
  const ProgramCheck check =
      check_texts({{"a.glsl", guarded},
                   {"x.frag", "#version 450\n#include \"a.glsl\"\nout vec4 c;\nvoid main() { c = vec4(k); }\n"}});
  EXPECT_TRUE(is_vulkan(check.target)) << "an include guard is no condition: " << check.target_reason;
}

TEST(CheckProgram, TheResultNamesTheFilesThatChoseTheTarget)
{
  const Texts texts = {{"x.frag",
                        "#version 450\n#if 0\n#include \"a.glsl\"\n#include \"none.glsl\"\n#endif\n"
                        "layout(location = 0) out vec4 c;\nvoid main() { c = vec4(1); }\n"},
                       {"a.glsl", "float a;\n"}};
  const ProgramCheck check = check_texts(texts);
  EXPECT_EQ(check.files, (std::vector<std::string>{"x.frag", "a.glsl"}));
  EXPECT_EQ(check.absent, (std::vector<std::string>{"none.glsl"}));
  EXPECT_EQ(check_texts(texts, for_target(CheckTarget::Vulkan12)).files, (std::vector<std::string>{"x.frag"}));
}

TEST(CheckProgram, AVersionOfDesktopIsNoneOfEs)
{
  for (const Dialect &dialect : dialects()) {
    const ProgramCheck check = check_texts({{"x.frag", dialect.version + "precision mediump float;\nvoid main() {}\n"}},
                                           for_target(CheckTarget::Es));
    const bool is_es = dialect.target == CheckTarget::Es || dialect.version.empty();
    EXPECT_EQ(messages_of(check).find("x.frag:1: error: version ") == 0, !is_es)
        << dialect.version << messages_of(check);
  }
}

TEST(CheckProgram, AFileThatIsNoTextIsNamed)
{
  const std::string text = "#version 450\nvoid main() {}\n";
  for (const std::string mark : {"\xFF\xFE", ""}) {
    std::string wide = mark;
    for (const char c : text) {
      wide += c;
      wide += '\0';
    }
    const ProgramCheck check = check_texts({{"x.frag", wide}});
    EXPECT_EQ(messages_of(check).find("x.frag:1: error: the file is text in UTF-16"), 0U) << messages_of(check);
    EXPECT_EQ(check.messages.size(), 1U) << messages_of(check);
  }
  EXPECT_EQ(
      messages_of(check_texts({{"x.frag", std::string("\n\0x;\n", 5)}})).find("x.frag:2: error: the file has a NUL"),
      0U);
  for (const std::string mark : {"\xFF\xFE", "\xFE\xFF"}) {
    EXPECT_EQ(messages_of(check_texts({{"x.frag", mark}})),
              "x.frag:1: error: the file is text in UTF-16; save it as UTF-8 without a byte-order mark [compile]\n")
        << "a file of the mark alone";
  }
  const ProgramCheck check = check_texts({{"x.frag", text + std::string("\0;\n", 3)}});
  EXPECT_EQ(check.target_reason, "");
  EXPECT_EQ(messages_of(check),
            "x.frag:3: error: the file has a NUL byte (0x00) here, which GLSL does not allow [compile]\n");
}

TEST(CheckProgram, OneOfSeveralShadersOfAStageMayBeCheckedAlone)
{
  const std::string body = "vec4 shade(vec2 uv)";
  const std::string library = "#version 330\nuniform sampler2D t;\n" + body + " { return texture(t, uv); }\n";
  const std::string user = "#version 330\n" + body + ";\nin vec2 uv;\nout vec4 c;\nvoid main() { c = shade(uv); }\n";
  const std::string geometry = "#version 330\nvoid f() { EmitVertex(); }\n";
  for (const auto &[path, text] :
       {std::pair("x.frag", library), std::pair("x.frag", user), std::pair("x.geom", geometry)}) {
    EXPECT_EQ(messages_of(check_texts({{path, text}}, for_target(CheckTarget::OpenGl))), "") << text;
  }
  EXPECT_NE(messages_of(check_texts({{"x.frag", "#version 330\nfloat f(float x) { return f(x); }\nvoid main() {}\n"}},
                                    for_target(CheckTarget::OpenGl)))
                .find("[recursion]"),
            std::string::npos);
  const std::string vertex = "#version 330\nout vec2 uv;\nvoid main() { gl_Position = vec4(0); uv = vec2(0); }\n";
  EXPECT_NE(messages_of(check_texts({{"x.vert", vertex}, {"x.frag", user}}, for_target(CheckTarget::OpenGl)))
                .find("No function definition"),
            std::string::npos)
      << "a program must be whole";
}

TEST(CheckProgram, AFunctionWithoutABodyIsNamedAsInGlsl)
{
  const std::string other = "#version 430\nvoid other() {}\n";
  const auto message_about = [&](const std::string &declared, const std::string &parameters,
                                 const std::string &arguments) {
    const std::string text = fmt::format(
        "#version 430\nstruct Inner {{ vec2 a[2]; bool b; }};\nstruct Lamp {{ Inner i; mat3x2 m; }};\n{} value;\n"
        "void call({});\nvoid main() {{ call({}); }}\n",
        declared, parameters, arguments);
    const Program program{"test", {{Stage::Vertex, "a.vert"}, {Stage::Vertex, "b.vert"}}, {}};
    const gpu::ShaderFiles files = [&](std::string_view path) -> std::optional<std::string_view> {
      return path == "a.vert" ? text : other;
    };
    return messages_of(check_program(program, files, for_target(CheckTarget::OpenGl)));
  };
  std::istringstream types(
      "float int uint bool double vec2 ivec3 uvec4 bvec2 dvec3 mat3 mat2x4 dmat4x3 Lamp Inner float[3] Lamp[2] "
      "vec4[2][3] mat4[5] sampler2D isampler3D usamplerCubeArray sampler2DArrayShadow samplerCubeShadow sampler2DMS "
      "sampler2DMSArray sampler2DRect samplerBuffer sampler1DShadow");
  for (std::string type; types >> type;) {
    const std::string uniform = type.find("sampler") == std::string::npos ? "" : "uniform ";
    EXPECT_EQ(message_about(uniform + type, type, "value"),
              fmt::format("a.vert:5: error: Linking vertex stage: No function definition (body) found: call({}) "
                          "[link]\n",
                          type));
  }
  EXPECT_NE(message_about("Lamp", "Lamp, int, vec3", "value, 1, vec3(1)").find("call(Lamp, int, vec3) [link]"),
            std::string::npos);
}

TEST(CheckProgram, AVectorMayBeReadInPart)
{
  const Texts texts = {
      {"x.vert", "#version 450\nlayout(location = 0) out vec4 v;\nvoid main() { v = vec4(1); gl_Position = v; }\n"},
      {"x.frag",
       "#version 450\nlayout(location = 0) in vec3 v;\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(v, 1); "
       "}\n"}};
  EXPECT_EQ(messages_of(check_texts(texts, for_target(CheckTarget::Vulkan13))), "");
  ProgramOptions options = for_target(CheckTarget::Vulkan12);
  EXPECT_NE(messages_of(check_texts(texts, options)).find("[varying-type]"), std::string::npos);
  options.features = {"maintenance4"};
  EXPECT_EQ(messages_of(check_texts(texts, options)), "");
}

TEST(CheckProgram, BuiltInBlocksMayDiffer)
{
  const Texts texts = {{"x.vert", "#version 450\nvoid main() { gl_Position = vec4(0); }\n"},
                       {"x.geom",
                        "#version 450\nlayout(triangles) in;\nlayout(triangle_strip, max_vertices = 3) out;\n"
                        "in gl_PerVertex { vec4 gl_Position; } gl_in[];\n"
                        "void main() { gl_Position = gl_in[0].gl_Position; EmitVertex(); }\n"}};
  EXPECT_EQ(messages_of(check_texts(texts, for_target(CheckTarget::Vulkan12))), "");
}

TEST(CheckProgram, WhatAnIncludeGuardSkipsIsNotCounted)
{
  const std::string filler = "// " + std::string(stage_bytes_max / 8, 'a') + "\n";
  const auto check = [&](const std::string &header, const std::string &between) {
    std::string includes;
    for (int i = 0; i < 12; i++) {
      includes += "#include \"a.glsl\"\n" + between;
    }
    return messages_of(
        check_texts({{"x.frag", including(includes, "1.0")}, {"a.glsl", header}}, for_target(CheckTarget::Vulkan12)));
  };
  const std::string guarded = "#ifndef A\n#define A\n" + filler + "#endif\n";
  EXPECT_EQ(check(guarded, ""), "");
  EXPECT_EQ(
      check("/* a header\n*/\n # ifndef A // once\n#define A 1\n#if 1\n" + filler + "#else\n#endif\n#endif /* A */\n",
            ""),
      "");
  for (const auto &[header, between] :
       {std::pair(filler, ""), std::pair(guarded + "#define B\n", ""), std::pair("#define B\n" + guarded, ""),
        std::pair("#ifndef A\n#define B\n" + filler + "#endif\n", ""),
        std::pair("#ifndef A\n#define A\n#else\n" + filler + "#endif\n", ""), std::pair(guarded, "#undef A\n"),
        std::pair(guarded, "#un\\\ndef A\n")}) {
    EXPECT_NE(check(header, between).find("[limit]"), std::string::npos) << check(header, between);
  }
}

TEST(CheckProgram, LineDirectivesMoveLinesAndFiles)
{
  for (const Dialect &dialect : dialects()) {
    // Before GLSL 3.30, `#line N` names the line itself; later, and in ES, the next one.
    const bool names_itself = std::set<std::string>{"",
                                                    "#version 110\n",
                                                    "#version 120\n",
                                                    "#version 130\n",
                                                    "#version 140\n",
                                                    "#version 150\n",
                                                    "#version 150 core\n",
                                                    "  #  version 150   compatibility\n"}
                                  .contains(dialect.version);
    for (const auto &[directive, file] : {std::pair("#line 70", "x.frag"), std::pair("# line 70 3", "x.frag")}) {
      const ProgramCheck check = check_texts({{"x.frag", fragment_of(dialect, fmt::format("{}\noops", directive))}},
                                             for_target(dialect.target));
      EXPECT_EQ(messages_of(check).find(fmt::format("{}:{}: error: 'oops'", file, names_itself ? 71 : 70)), 0U)
          << dialect.version << messages_of(check);
    }
  }
  const ProgramCheck numbered = check_texts(
      {{"x.frag", "#version 450\n#include \"s/h.glsl\"\nlayout(location = 0) out vec4 c;\nvoid main() {}\n"},
       {"s/h.glsl", "#line 10 3\nfloat f() { return oops; }\n"}},
      for_target(CheckTarget::Vulkan12));
  EXPECT_EQ(messages_of(numbered).find("s/h.glsl:10: error: 'oops'"), 0U) << messages_of(numbered);
  for (const std::string name : {"gen/material.glsl", "a b.nut", "C:/x.hlsl", "12"}) {
    const std::string text =
        "#version 450\n#extension GL_GOOGLE_cpp_style_line_directive : require\n"
        "layout(location = 0) out vec4 c;\nvoid main() {\n#line 101 \"" +
        name + "\"\n  c = vec4(oops);\n}\n";
    const ProgramCheck check = check_texts({{"x.frag", text}}, for_target(CheckTarget::Vulkan12));
    EXPECT_EQ(messages_of(check).find((name == "12" ? "x.frag" : name) + ":101: error: 'oops'"), 0U)
        << messages_of(check);
  }
}

TEST(CheckProgram, TheTakenLineDirectivesCount)
{
  const std::string unused = "layout(binding = 2) uniform sampler2D unused;\n";
  const std::string end = "layout(location = 0) out vec4 c;\nvoid main() { c = vec4(1); }\n";
  const Texts files = {{"lib/x.glsl", "#line 1 \"gen.tpl\"\n#include \"y.glsl\"\n"},
                       {"lib/y.glsl", "float y;\n\n"},
                       {"lib/z.glsl", "#line __LINE__ + 20\n" + unused}};
  for (const auto &[lines, place] : {std::pair("#ifdef GEN\n#line 900 \"gen.tpl\"\n#endif\n", "x.frag:5"),
                                     {"#line __LINE__ \"gen.tpl\"\n", "gen.tpl:2"},
                                     {"#line 50+50\n", "x.frag:100"},
                                     {"#define N 3\n#line N * (N + 4)\n\n", "x.frag:22"},
                                     {"#line 10\n#line __LINE__ + 5\n", "x.frag:15"},
                                     {"#line 0\n\n#line __LINE__ + 5\n", "x.frag:6"},
                                     {"#include \"lib/x.glsl\"\n\n#line __LINE__ + 5 \"b\"\n", "b:9"},
                                     {"#line 7 \"a\"\n#include \"lib/x.glsl\"\n", "a:8"},
                                     {"#include \"lib/z.glsl\"\n//", "lib/z.glsl:21"}}) {
    Texts texts = files;
    texts["x.frag"] = std::string("#version 450\n") + lines + unused + end;
    const std::string found = messages_of(check_texts(texts, for_target(CheckTarget::Vulkan12)));
    EXPECT_EQ(found, std::string(place) + ": warning: texture 'unused' is declared and never read [unused-binding]\n")
        << lines;
    // The compiler's own lines are the reference.
    texts["x.frag"] = std::string("#version 450\n") + lines + "oops\n" + end;
    texts["lib/z.glsl"] = "#line __LINE__ + 20\noops\n";
    const std::string reference = messages_of(check_texts(texts, for_target(CheckTarget::Vulkan12)));
    EXPECT_EQ(reference.find(std::string(place) + ": error: "), 0U) << lines << reference;
  }
  // A negative line is no line of a file; after the greatest, glslang counts on from the least.
  for (const char *number : {"-5", "-2147483647", "2147483646", "2147483647", "-5 \"a.glsl\"", "-5 2"}) {
    const std::string text = fmt::format(
        "#version 450\n#line {}\n\nlayout(location = 0) out vec4 c;\n"
        "void main() {{ oops; }}\n",
        number);
    const std::string negative = messages_of(check_texts({{"x.frag", text}}, for_target(CheckTarget::Vulkan12)));
    const std::string file = std::string_view(number).ends_with('"') ? "a.glsl" : "x.frag";
    EXPECT_EQ(negative, file + ":0: error: 'oops' : undeclared identifier [compile]\n") << number;
  }
}

TEST(CheckProgram, AnErrorInAnIncludeIsNoErrorOfItsIncluders)
{
  const std::string head = "#version 450\n#extension GL_GOOGLE_include_directive : require\n";
  const std::string tail = "layout(location = 0) out vec4 c;\nvoid main() { c = vec4(f()); }\n";
  for (const std::string inner : {"float f() {\n  return oops;\n}\n", "float f() { return oops; }\n",
                                  "#line 2 \"other.glsl\"\nfloat f() { return oops; }\n"}) {
    const Texts files = {{"inner.glsl", inner},
                         {"outer.glsl", "#include \"inner.glsl\"\nfloat g() { return f(); }\n"},
                         {"x.frag", head + "#include \"outer.glsl\"\n" + tail}};
    const std::string messages = messages_of(check_texts(files, for_target(CheckTarget::Vulkan12)));
    EXPECT_EQ(std::ranges::count(messages, '\n'), 1) << messages;
    EXPECT_NE(messages.find("'oops' : undeclared identifier"), std::string::npos) << messages;
    EXPECT_EQ(messages.find("x.frag"), std::string::npos) << messages;
  }
  // A missing file does not hide the next one.
  const std::string missing =
      messages_of(check_texts({{"inner.glsl", "#include \"a.glsl\"\n"},
                               {"x.frag", head + "#include \"inner.glsl\"\n#include \"b.glsl\"\n" + tail}},
                              for_target(CheckTarget::Vulkan12)));
  EXPECT_EQ(missing.find("inner.glsl:1: error: "), 0U) << missing;
  EXPECT_NE(missing.find("x.frag:4: error: "), std::string::npos) << missing;
}

TEST(CheckProgram, AllErrorsOfAStageAreReportedInTheOrderOfTheCompiler)
{
  const std::string body =
      "layout(location = 0) out vec4 c;\nvoid main() {\n  c = vec4(f() + oops_a);\n  c.x = oops_b;\n}\n";
  const std::string head = "#version 450\n#include \"inner.glsl\"\n";
  // glslc reports the same errors. After an include that fails, errors follow from its missing declarations.
  const std::string both = messages_of(check_texts(
      {{"inner.glsl", "float f() { return oops; }\n"}, {"x.frag", head + body}}, for_target(CheckTarget::Vulkan12)));
  EXPECT_EQ(both,
            "inner.glsl:1: error: 'oops' : undeclared identifier [compile]\n"
            "x.frag:5: error: 'oops_a' : undeclared identifier [compile]\n"
            "x.frag:6: error: 'oops_b' : undeclared identifier [compile]\n");
  const std::string missing = messages_of(
      check_texts({{"x.frag", head + "#ifndef F\n#error no F\n#endif\n" + body}}, for_target(CheckTarget::Vulkan12)));
  std::vector<std::string> places;
  std::istringstream lines(missing);
  for (std::string line; std::getline(lines, line);) {
    places.push_back(line.substr(0, line.find(": error")));
  }
  EXPECT_EQ(places, (std::vector<std::string>{"x.frag:2", "x.frag:4", "x.frag:8", "x.frag:8", "x.frag:9"})) << missing;
  // A syntax error ends the stage.
  const std::string syntax = messages_of(check_texts(
      {{"inner.glsl", "float f() { return 1.0 2.0; }\n"}, {"x.frag", head + body}}, for_target(CheckTarget::Vulkan12)));
  EXPECT_EQ(std::ranges::count(syntax, '\n'), 1) << syntax;
  EXPECT_EQ(syntax.find("inner.glsl:1: error: "), 0U) << syntax;
}

TEST(CheckProgram, AnErrorOfTheLinkerIsOneMessageInTheOrderOfTheCompiler)
{
  // glslang prints its second line as an error, too.
  const std::string block =
      "#version 440\nlayout(xfb_buffer = 0, xfb_stride = 20) out B { layout(xfb_offset = 16) vec4 v; };\n";
  const ProgramCheck stride =
      check_texts({{"a.vert", block + "void main() { v = vec4(1); }\n"}}, for_target(CheckTarget::OpenGl));
  ASSERT_EQ(stride.messages.size(), 1U) << messages_of(stride);
  EXPECT_EQ(stride.messages[0].text,
            "Linking vertex stage: xfb_stride is too small to hold all buffer entries: xfb_buffer 0, xfb_stride 20, "
            "minimum stride needed: 32");
  // By the alphabet, the layouts would come first.
  for (const std::string text : {"#version 450\nlayout(points) out;\n", "#version 450\n"}) {
    const ProgramCheck check = check_texts({{"b.geom", text}}, for_target(CheckTarget::Vulkan12));
    ASSERT_GT(check.messages.size(), 1U) << text;
    EXPECT_NE(check.messages[0].text.find("Missing entry point"), std::string::npos) << messages_of(check);
  }
}

TEST(CheckProgram, CarriageReturnsAloneEndLines)
{
  const Texts files = {
      {"lib.glsl", "// shader-check: unguarded-math=error\rfloat f(vec2 a) { return acos(dot(a, a)); }\r"},
      {"x.frag",
       "#version 330\r#include \"lib.glsl\"\rin vec2 uv; // a comment\runiform float k;\r"
       "out vec4 c;\rvoid main() { c = vec4(f(uv)) * k; }\r"}};
  const ProgramCheck check = check_texts(files);
  EXPECT_EQ(check.target, CheckTarget::OpenGl) << check.target_reason;
  if (left_out_rules(CheckTarget::OpenGl).empty()) {
    EXPECT_EQ(messages_of(check).find("lib.glsl:2: error: acos of "), 0U) << messages_of(check);
  }
}

TEST(CheckProgram, AFileNumberThatIsTooGreatIsNoDefine)
{
  const std::string messages =
      messages_of(check_texts({{"x.frag", "#version 450\n#line 5 99999999999999999999\nvoid main() { oops; }\n"}},
                              for_target(CheckTarget::Vulkan12)));
  EXPECT_EQ(messages,
            "x.frag:2: error: '' : numeric literal too big [compile]\n"
            "x.frag:5: error: 'oops' : undeclared identifier [compile]\n");
}

TEST(CheckProgram, NamesThatAreKeywordsElsewhereStayInMessages)
{
  for (const std::string name : {"highp", "mediump", "highp_value", "not_highp"}) {
    const ProgramCheck check =
        check_texts({{"x.frag", "#version 110\nvoid main() {\n  gl_FragColor = vec4(" + name + ");\n}\n"}},
                    for_target(CheckTarget::OpenGl));
    EXPECT_EQ(messages_of(check).find(fmt::format("x.frag:3: error: '{}' : undeclared identifier", name)), 0U)
        << messages_of(check);
  }
}

TEST(CheckProgram, IncludesAreThoseOfTheCompiler)
{
  ProgramOptions options = for_target(CheckTarget::Vulkan12);
  options.include_folders = {"lib", "other"};
  const Texts files = {{"s/near.glsl", "float near_value() { return 1.0; }\n"},
                       {"lib/far.glsl", "#include \"deep.glsl\"\nfloat far_value() { return deep; }\n"},
                       {"lib/deep.glsl", "const float deep = 2.0;\n"},
                       {"other/NAME.glsl", "float NAME() { return 3.0; }\n"},
                       {"lib/bad.glsl", "\n\nfloat bad() { return oops; }\n"}};
  const auto check = [&](const std::string &lines, const std::string &value) {
    Texts texts = files;
    texts["s/x.frag"] = including(lines, value);
    return check_texts(texts, options);
  };
  const std::pair<std::string, std::string> right[] = {
      {"#include \"near.glsl\"\n", "near_value()"},
      {"#include <far.glsl>\n", "far_value()"},
      {"  #  include \"far.glsl\" // a comment\n", "far_value()"},
      {"/* #include \"none.glsl\" */\n", "1.0"},
      {"/*\n#include \"none.glsl\"\n*/\n", "1.0"},
      {"// #include \"none.glsl\"\n", "1.0"},
      {"#if 0\n#include \"none.glsl\"\n#endif\n", "1.0"},
      {"#ifdef NOPE\n#include <none.glsl>\n#else\n#include \"near.glsl\"\n#endif\n", "near_value()"},
      {"#define NAME one\n#include \"NAME.glsl\"\n#undef NAME\n#define NAME two\n#include <NAME.glsl>\n",
       "one() + two()"}};
  for (const auto &[lines, value] : right) {
    EXPECT_EQ(messages_of(check(lines, value)), "") << lines;
  }
  // The system finds the file behind a link to a folder, and the text does not.
  Texts linked = files;
  linked["s/x.frag"] = including("#include \"link/a.glsl\"\n", "up()");
  linked["s/link/a.glsl"] = "#include \"../near.glsl\"\n#include \"../b.glsl\"\n";
  linked["s/link/../b.glsl"] = "float up() { return near_value(); }\n";
  const ProgramCheck through = check_texts(linked, options);
  EXPECT_EQ(messages_of(through), "");
  EXPECT_EQ(through.files, (std::vector<std::string>{"s/x.frag", "s/link/a.glsl", "s/near.glsl", "s/link/../b.glsl"}));
  EXPECT_EQ(messages_of(check("#include <near.glsl>\n", "1.0"))
                .find("s/x.frag:3: error: no shader file 'near.glsl' in the folders of -I [include]"),
            0U);
  EXPECT_EQ(messages_of(check("\n#include \"none.glsl\"\n", "1.0"))
                .find("s/x.frag:4: error: no shader file 's/none.glsl' [include]"),
            0U)
      << messages_of(check("\n#include \"none.glsl\"\n", "1.0"));
  EXPECT_EQ(messages_of(check("#include <bad.glsl>\n", "bad()")).find("lib/bad.glsl:3: error: 'oops'"), 0U);
  const ProgramCheck read = check("#include \"far.glsl\"\n", "far_value()");
  EXPECT_EQ(read.files, (std::vector<std::string>{"s/x.frag", "lib/far.glsl", "lib/deep.glsl"}));
  EXPECT_EQ(read.absent, (std::vector<std::string>{"s/far.glsl"})) << "a file here would change the result";
}

TEST(CheckProgram, AnIncludeWithoutAnEndIsAMessage)
{
  Texts texts{{"x.frag", including("#include \"a.glsl\"\n", "1.0")}, {"a.glsl", "#include \"a.glsl\"\n"}};
  EXPECT_EQ(messages_of(check_texts(texts)),
            "a.glsl:1: error: 'a.glsl' includes itself, at a depth of more than 200 [include]\n");
  texts["a.glsl"] = "\n#include \"b.glsl\"\n";
  texts["b.glsl"] = "#include \"c.glsl\"\n";
  texts["c.glsl"] = "#include \"a.glsl\"\n";
  EXPECT_EQ(messages_of(check_texts(texts)),
            "b.glsl:1: error: 'b.glsl' includes itself by way of 'c.glsl', 'a.glsl', at a depth of more than 200 "
            "[include]\n");
  texts["c.glsl"] = "#include \"x.frag\"\n";
  EXPECT_EQ(messages_of(check_texts(texts)),
            "c.glsl:1: error: 'x.frag' includes itself by way of 'a.glsl', 'b.glsl', 'c.glsl', which a file with "
            "#version cannot do [include]\n");
  texts["x.frag"] = including("#include \"x.frag\"\n", "1.0");
  EXPECT_EQ(messages_of(check_texts(texts)),
            "x.frag:3: error: 'x.frag' includes itself, which a file with #version cannot do [include]\n");
  texts["x.frag"] = including("#include \"0.glsl\"\n", "1.0");
  for (int i = 0; i < 201; i++) {
    texts[fmt::format("{}.glsl", i)] = fmt::format("#include \"{}.glsl\"\n", i + 1);
  }
  EXPECT_EQ(messages_of(check_texts(texts)),
            "199.glsl:1: error: '200.glsl' is included at a depth of more than 200 [include]\n");
  // Each level would have a message of its own.
  texts["a.glsl"] = "#include \"a.glsl\"\n#include \"a.glsl\"\n";
  texts["b.glsl"] = "float b = 1.0;\n";
  texts["x.frag"] = including("#include \"a.glsl\"\n#include \"b.glsl\"\n", "1.0");
  EXPECT_EQ(messages_of(check_texts(texts)),
            "a.glsl:1: error: 'a.glsl' includes itself, at a depth of more than 200 [include]\n");
  ProgramOptions with_folder;
  with_folder.include_folders = {"."};
  EXPECT_EQ(messages_of(check_texts(texts, with_folder)),
            "a.glsl:1: error: 'a.glsl' includes itself, at a depth of more than 200 [include]\n");
  texts["x.frag"] = including("#include <a.glsl>\n#include <absent.glsl>\n", "1.0");
  EXPECT_EQ(messages_of(check_texts(texts, with_folder)),
            "a.glsl:1: error: 'a.glsl' includes itself, at a depth of more than 200 [include]\n"
            "x.frag:4: error: no shader file 'absent.glsl' in the folders of -I [include]\n");
  texts["a.glsl"] = "#ifndef A\n#define A\n#include \"a.glsl\"\nfloat a = 1.0;\n#endif\n";
  texts["x.frag"] = including("#include \"a.glsl\"\n#include \"a.glsl\"\n", "a");
  EXPECT_EQ(messages_of(check_texts(texts)), "") << "a guard ends it";
}

TEST(CheckProgram, AByteOrderMarkIsNamed)
{
  const std::string mark = "\xEF\xBB\xBF";
  const std::string text = including("#include \"a.glsl\"\n", "a");
  const Texts in_stage{{"x.frag", mark + text}, {"a.glsl", "float a = 1.0;\n"}};
  EXPECT_EQ(messages_of(check_texts(in_stage)).find("x.frag:1: error: the file begins with a byte-order mark"), 0U)
      << messages_of(check_texts(in_stage));
  EXPECT_TRUE(is_vulkan(check_texts(in_stage).target));
  const Texts in_include{{"x.frag", text}, {"a.glsl", mark + "float a = 1.0;\n"}};
  EXPECT_EQ(messages_of(check_texts(in_include)).find("a.glsl:1: error: the file begins with a byte-order mark"), 0U);
}

TEST(CheckProgram, RulesOfGnomonsOwnBlocksAreOff)
{
  const std::string out = "#version 450\nlayout(location = 0) out vec4 c;\nlayout(location = 0) in vec2 u;\n";
  const std::string texts[] = {
      "layout(std430, binding = 1) readonly buffer B { vec3 p[]; };\nvoid main() { c = vec4(p[0], u.x); }\n",
      "layout(std140, binding = 1) uniform B { float p[4]; mat3 m[2]; };\nvoid main() { c = vec4(m[1][2], p[2] + u.x); "
      "}\n",
      "layout(binding = 1) uniform sampler2D a;\nlayout(binding = 1) uniform texture2D b;\n"
      "layout(binding = 2) uniform sampler s;\nvoid main() { c = texture(a, u) + texture(sampler2D(b, s), u); }\n"};
  for (const std::string &text : texts) {
    EXPECT_EQ(messages_of(check_texts({{"x.frag", out + text}})), "");
  }
  ProgramOptions options;
  options.levels = {{"block-array", RuleLevel::Warning}, {"slot", RuleLevel::Error}};
  EXPECT_NE(messages_of(check_texts({{"x.frag", out + texts[0]}}, options)).find("x.frag:4: warning: 'p'"),
            std::string::npos);
  EXPECT_NE(messages_of(check_texts({{"x.frag", out + texts[2]}}, options)).find("x.frag:5: error: "),
            std::string::npos)
      << messages_of(check_texts({{"x.frag", out + texts[2]}}, options));
}

TEST(CheckProgram, OpenGlCountsImagesAndTexturesApart)
{
  const std::string text =
      "#version 450\nlayout(location = 0) in vec2 u;\nlayout(location = 0) out vec4 c;\n"
      "layout(r32f, binding = 0) uniform image2D i;\nlayout(binding = 0) uniform sampler2D s;\n"
      "void main() { c = texture(s, u); imageStore(i, ivec2(0), c); }\n";
  for (const CheckTarget target : {CheckTarget::OpenGl, CheckTarget::OpenGlSpirv}) {
    ProgramOptions options = for_target(target);
    options.levels["slot"] = RuleLevel::Error;
    EXPECT_EQ(messages_of(check_texts({{"x.frag", text}}, options)), "");
  }
  ProgramOptions options = for_target(CheckTarget::Vulkan12);
  options.levels["slot"] = RuleLevel::Error;
  EXPECT_NE(messages_of(check_texts({{"x.frag", text}}, options)).find("[slot]"), std::string::npos);
}

TEST(CheckProgram, SubgroupsAreForOpenGlToo)
{
  for (const std::string extension : {"arithmetic", "ballot", "shuffle"}) {
    const std::string use = extension == "arithmetic" ? "subgroupAdd(x)"
                            : extension == "ballot"   ? "subgroupBroadcastFirst(x)"
                                                      : "subgroupShuffle(x, 0u)";
    const std::string text = "#version 450\n#extension GL_KHR_shader_subgroup_" + extension +
                             " : require\nlayout(location = 0) in float x;\nlayout(location = 0) out vec4 c;\n"
                             "void main() { c = vec4(" +
                             use + "); }\n";
    for (const CheckTarget target : {CheckTarget::OpenGl, CheckTarget::Vulkan11, CheckTarget::Vulkan12}) {
      EXPECT_EQ(messages_of(check_texts({{"x.frag", text}}, for_target(target))), "") << text << to_string(target);
    }
  }
}

TEST(CheckProgram, LevelsAreSetForACallAFileAndALine)
{
  const auto text = [](const std::string &comment, const std::string &at_line) {
    return comment +
           "#version 450\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(1.0); }\n"
           "layout(binding = 0) uniform sampler2D t;" +
           at_line + "\n";
  };
  const auto severity = [&](const std::string &source, const ProgramOptions &options) {
    const ProgramCheck check = check_texts({{"x.frag", source}}, options);
    return check.messages.empty() ? std::string("off") : std::string(to_string(check.messages[0].severity));
  };
  EXPECT_EQ(severity(text("", ""), {}), "warning");
  for (const auto &[level, name] : {std::pair(RuleLevel::Off, "off"), std::pair(RuleLevel::Warning, "warning"),
                                    std::pair(RuleLevel::Error, "error")}) {
    ProgramOptions options;
    options.levels["unused-binding"] = level;
    EXPECT_EQ(severity(text("", ""), options), name);
    const std::string comment = std::string("// shader-check: unused-binding=") + name + "\n";
    EXPECT_EQ(severity(text(comment, ""), {}), name);
    options.levels["unused-binding"] = RuleLevel::Error;
    EXPECT_EQ(severity(text(comment, ""), options), name) << "the comment precedes";
  }
  ProgramOptions strict;
  strict.is_strict = true;
  EXPECT_EQ(severity(text("", ""), strict), "error");
  // A warning of the compiler.
  const std::string precision =
      "#version 440\nlayout(location = 0) out vec4 c;\nvoid main() { lowp float f = 1.0; c = vec4(f); }\n";
  EXPECT_EQ(severity(precision, {}), "warning");
  EXPECT_EQ(severity("// shader-check: compile-warning=off\n" + precision, {}), "off");
  EXPECT_EQ(severity(precision, strict), "error");
  strict.levels["compile-warning"] = RuleLevel::Off;
  EXPECT_EQ(severity(precision, strict), "off");
  EXPECT_EQ(severity(text("", " // shader-check: unused-binding, hosts bind it"), {}), "off");
  EXPECT_EQ(severity(text("", " // shader-check: unused"), {}), "warning");
}

TEST(CheckProgram, AFeatureOfDevicesIsAWarningUntilItIsAssumed)
{
  const std::string text =
      "#version 450\n#extension GL_EXT_scalar_block_layout : require\n"
      "layout(scalar, binding = 0) uniform B { vec3 u; vec3 v; };\n"
      "layout(location = 0) out vec4 c;\nvoid main() { c = vec4(u + v, 1); }\n";
  ProgramOptions options = for_target(CheckTarget::Vulkan12);
  const ProgramCheck check = check_texts({{"x.frag", text}}, options);
  ASSERT_EQ(check.messages.size(), 1U) << messages_of(check);
  EXPECT_EQ(check.messages[0].severity, Severity::Warning);
  EXPECT_NE(check.messages[0].text.find("--feature scalarBlockLayout"), std::string::npos) << check.messages[0].text;
  options.features = {"scalarBlockLayout"};
  EXPECT_EQ(messages_of(check_texts({{"x.frag", text}}, options)), "");
}

TEST(CheckProgram, AMistakeInSpirvHasItsPlace)
{
  // A declaration, by its name and that of its member.
  const std::string scalar =
      "#version 450\n#extension GL_EXT_scalar_block_layout : require\n"
      "layout(scalar, binding = 0) uniform B {\n  vec3 u;\n  vec3 v;\n  float w[2];\n} b;\n"
      "layout(location = 0) out vec4 c;\nvoid main() { c = vec4(b.u + b.v, b.w[1]); }\n";
  const ProgramCheck layout = check_texts({{"x.frag", scalar}}, for_target(CheckTarget::Vulkan12));
  ASSERT_EQ(layout.messages.size(), 1U) << messages_of(layout);
  EXPECT_EQ(layout.messages[0].line, 5) << messages_of(layout);
  // An instruction: its image is combined with its sampler before the branch of the operator `?`.
  const std::string declarations =
      "layout(location = 0) out vec4 c;\nlayout(location = 0) in float u;\nlayout(binding = 0) uniform texture2D t;\n"
      "layout(binding = 1) uniform sampler s;\nfloat f(float x) { return x * 2.0; }\n";
  const std::string sample = "c = texture(sampler2D(t, s),\nvec2(u > 0.0 ? f(f(u)) : f(u), 0.0));\n";
  const std::string version = "#version 450\n";
  for (const auto &[texts, file, line] :
       {std::tuple(Texts{{"x.frag", version + declarations + "void main() {\n\n" + sample + "}\n"}}, "x.frag", 9),
        {Texts{{"x.frag", version + declarations + "#line 70 \"a/made.glsl\"\nvoid main() {\n" + sample + "}\n"}},
         "a/made.glsl", 71},
        {Texts{{"x.frag", version + "#include \"i.glsl\"\nvoid main() { g(); }\n"},
               {"i.glsl", declarations + "void g() {\n" + sample + "}\n"}},
         "i.glsl", 7}}) {
    const ProgramCheck check = check_texts(texts, for_target(CheckTarget::Vulkan12));
    // Versions of glslang without the tree make valid SPIR-V of it.
    if (check.messages.empty() && !left_out_rules(CheckTarget::Vulkan12).empty()) {
      continue;
    }
    ASSERT_EQ(check.messages.size(), 1U) << messages_of(check);
    EXPECT_EQ(check.messages[0].rule, "spirv");
    EXPECT_EQ(check.messages[0].file, file);
    EXPECT_EQ(check.messages[0].line, line) << messages_of(check);
  }
}

/** CPU time of this process. */
double cpu_seconds()
{
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

TEST(CheckProgram, TimeIsLinearInTheLength)
{
  const auto seconds = [](int function_count) {
    std::string text = "#version 450\nlayout(location = 0) in vec2 uv;\nlayout(location = 0) out vec4 c;\n";
    std::string body;
    for (int i = 0; i < function_count; i++) {
      text += fmt::format("float g{0}(float x) {{ return sin(x) + {0}.0; }}\n", i);
      body += fmt::format("  s += g{}(uv.x);\n", i);
    }
    text += "void main() {\n  float s = 0.0;\n" + body + "  c = vec4(s);\n}\n";
    // Other programs slow down caches and cores, so that the least of three counts.
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; i++) {
      const double start = cpu_seconds();
      EXPECT_EQ(messages_of(check_texts({{"x.frag", text}})), "");
      least = std::min(least, cpu_seconds() - start);
    }
    return least;
  };
  const double first = seconds(300);
  // Four times the length takes four times as long, or 16 times if a step is quadratic.
  EXPECT_LT(seconds(1200), 8.0 * first);
}

TEST(CheckProgram, TimeIsLinearInTheNumberOfIncludedFiles)
{
  // Each file includes the next one twice: 2^40 paths, of which conditions take none or guards take one.
  for (const bool is_guarded : {false, true}) {
    Texts texts{{"x.frag", including("#include \"x0.glsl\"\n", "1.0")}};
    for (int i = 0; i < 40; i++) {
      const std::string next = fmt::format("#include \"x{}.glsl\"\n", i + 1);
      texts[fmt::format("x{}.glsl", i)] =
          is_guarded ? fmt::format("#ifndef Q{0}\n#define Q{0}\n{1}{1}#endif\n", i, next)
                     : fmt::format("#ifdef Q{0}\n{1}#endif\n#ifdef R{0}\n{1}#endif\n", i, next);
    }
    texts["x40.glsl"] = "";
    const double start = cpu_seconds();
    EXPECT_EQ(messages_of(check_texts(texts)), "");
    EXPECT_LT(cpu_seconds() - start, 5.0);
  }
}

/** The pages of rules, each with the examples in its text. */
TEST(CheckRules, EachHasAPageWhoseExampleShowsIt)
{
  std::ifstream file(GNOMON_SOURCE "/doc/shader-rules.md");
  std::ostringstream content;
  content << file.rdbuf();
  const std::string page = content.str();
  for (const CheckRule &rule : check_rules()) {
    const std::string heading = fmt::format("\n## {}\n", rule.name);
    const std::size_t at = page.find(heading);
    ASSERT_NE(at, std::string::npos) << rule.name << " has no page";
    const std::string section = page.substr(at, page.find("\n## ", at + 1) - at);
    Texts texts;
    std::set<std::string> marked;
    for (std::size_t from = section.find("```glsl "); from != std::string::npos;
         from = section.find("```glsl ", from)) {
      const std::size_t name_end = section.find('\n', from);
      const std::size_t end = section.find("```", name_end);
      const std::string name = section.substr(from + 8, name_end - from - 8);
      texts[name] = section.substr(name_end + 1, end - name_end - 1);
      std::istringstream lines(texts[name]);
      int number = 1;
      for (std::string line; std::getline(lines, line); number++) {
        if (line.ends_with(fmt::format("// {}", rule.name))) {
          marked.insert(fmt::format("{}:{}: ", name, number));
        }
      }
      from = end;
    }
    // The rules `stage` and `limit` are the program's, `layout` compares C++ structs.
    EXPECT_EQ(texts.empty(), rule.name == "stage" || rule.name == "limit" || rule.name == "layout") << rule.name;
    if (texts.empty()) {
      continue;
    }
    ProgramOptions options;
    if (rule.is_own) {
      options.levels[std::string(rule.name)] = RuleLevel::Error;
    }
    const ProgramCheck check = check_texts(texts, options);
    if (std::ranges::count(left_out_rules(check.target), rule.name) > 0) {
      continue;
    }
    const std::string messages = messages_of(check);
    EXPECT_NE(messages.find(fmt::format("[{}]\n", rule.name)), std::string::npos) << rule.name << ":\n" << messages;
    EXPECT_TRUE(marked.empty() ||
                std::ranges::any_of(
                    marked, [&](const std::string &place) { return messages.find(place) != std::string::npos; }))
        << rule.name << ":\n"
        << messages;
  }
}

}  // namespace
}  // namespace gnomon::shader_check
