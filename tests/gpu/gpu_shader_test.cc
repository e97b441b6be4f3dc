// SPDX-License-Identifier: MIT
#include "gpu/gpu_testing.hh"

namespace gnomon::gpu {
namespace {

using test::error_of;
using test::expect_contains;
using test::ShaderTexts;
using test::VERSION;

std::string preprocessed(const ShaderTexts &texts, std::vector<std::string> defines = {})
{
  return preprocess({"test", "main", "", "", std::move(defines)}, texts.files()).at(0).text;
}

std::size_t count_of(std::string_view text, std::string_view part)
{
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) {
    count++;
  }
  return count;
}

TEST(Preprocess, StagesAreThoseThatHaveAPath)
{
  const ShaderTexts texts{{{"a", VERSION + "A\n"}, {"b", VERSION + "B\n"}, {"c", VERSION + "C\n"}}};
  const std::vector<ShaderSource> three = preprocess({"test", "a", "b", "c", {}}, texts.files());
  ASSERT_EQ(three.size(), 3U);
  EXPECT_EQ(three[0].stage, ShaderStage::Vertex);
  EXPECT_EQ(three[1].stage, ShaderStage::Geometry);
  EXPECT_EQ(three[2].stage, ShaderStage::Fragment);
  expect_contains(three[1].text, "B");
  const std::vector<ShaderSource> two = preprocess({"test", "a", "", "c", {}}, texts.files());
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[1].stage, ShaderStage::Fragment);
}

TEST(Preprocess, PutsAnIncludeInItsPlaceOnce)
{
  const ShaderTexts texts{
      {{"main", VERSION + "before\n#include \"lib\"\nbetween\n  #  include \"lib\" // again\nafter\n"},
       {"lib", "library\n"}}};
  const std::string text = preprocessed(texts);
  EXPECT_EQ(count_of(text, "library"), 1U);
  EXPECT_LT(text.find("before"), text.find("library"));
  EXPECT_LT(text.find("library"), text.find("between"));
  EXPECT_EQ(text.find("include"), std::string::npos);
}

TEST(Preprocess, CycleOfIncludesEnds)
{
  const ShaderTexts texts{{{"main", VERSION + "#include \"a\"\nmain text\n"},
                           {"a", "#include \"b\"\na text\n"},
                           {"b", "#include \"a\"\n#include \"b\"\n#include \"main\"\nb text\n"}}};
  const std::string text = preprocessed(texts);
  EXPECT_EQ(count_of(text, "main text"), 1U);
  EXPECT_EQ(count_of(text, "a text"), 1U);
  EXPECT_EQ(count_of(text, "b text"), 1U);
  EXPECT_LT(text.find("b text"), text.find("a text"));
}

TEST(Preprocess, HeadersThatIncludeAllBeforeThemStandOnceEach)
{
  ShaderTexts texts{{{"main", VERSION + "#include \"h15\"\n"}}};
  for (int i = 0; i < 16; i++) {
    std::string text = fmt::format("#ifndef H{0}\n#define H{0}\n", i);
    for (int j = i - 1; j >= 0; j--) {
      text += fmt::format("#include \"h{}\"\n", j);
    }
    texts.texts[fmt::format("h{}", i)] = text + "header text\n#endif\n";
  }
  EXPECT_EQ(count_of(preprocessed(texts), "header text"), 16U);
}

TEST(Preprocess, MissingIncludeNamesFileAndLine)
{
  const ShaderTexts texts{{{"main", VERSION + "\n#include \"lib\"\n"}, {"lib", "one\ntwo\n#include \"lost\"\n"}}};
  const std::string message = error_of([&] { preprocessed(texts); });
  expect_contains(message, "lib:3");
  expect_contains(message, "'lost'");
}

TEST(Preprocess, MissingFileNamesShaderAndFile)
{
  const std::string message = error_of([&] { preprocessed({}); });
  expect_contains(message, "shader 'test'");
  expect_contains(message, "'main'");
}

TEST(Preprocess, MissingVersionIsAnErrorThatNamesTheFile)
{
  const std::string message = error_of([&] { preprocessed({{{"main", "void main() {}\n"}}}); });
  expect_contains(message, "main");
  expect_contains(message, "#version");
  expect_contains(message, "'test'");
}

TEST(Preprocess, TakesLinesThatEndAsOnWindows)
{
  const ShaderTexts texts{{{"main", "#version 450 core\r\n#include \"lib\"\r\nvoid main() {}\r\n"},
                           {"lib", "#pragma once\r\nlibrary\r\n"}}};
  const std::string text = preprocessed(texts);
  EXPECT_EQ(count_of(text, "library"), 1U);
  EXPECT_EQ(count_of(text, "pragma"), 0U);
}

TEST(Preprocess, DefinesFollowTheVersion)
{
  const ShaderTexts texts{{{"main", "// First a comment.\n" + VERSION + "rest\n"}}};
  const std::string text = preprocessed(texts, {"PLAIN", "COUNT 6"});
  const std::size_t version = text.find("#version 450 core\n");
  const std::size_t plain = text.find("#define PLAIN\n");
  const std::size_t count = text.find("#define COUNT 6\n");
  ASSERT_NE(plain, std::string::npos);
  ASSERT_NE(count, std::string::npos);
  EXPECT_LT(version, plain);
  EXPECT_LT(plain, count);
  EXPECT_LT(count, text.find("rest"));
}

// std::regex overflowed the stack on these.
TEST(Preprocess, LinesMayHaveAnyLength)
{
  const std::string text(400'000, 'a');
  expect_contains(preprocessed({{{"main", VERSION + "#define LONG " + text + "\n"}}}), text);
  expect_contains(preprocessed({{{"main", VERSION + std::string(400'000, ' ') + "rest\n"}}}), " rest\n");
  const std::string message = error_of([&] { preprocessed({{{"main", VERSION + "#include \"" + text + "\"\n"}}}); });
  expect_contains(message, "main:2");
}

TEST(Preprocess, PragmaOnceIsLeftOutAndItsLineKept)
{
  const ShaderTexts texts{{{"main", VERSION + "#include \"lib\"\n"}, {"lib", "#pragma once\nbroken_here\n"}}};
  EXPECT_EQ(count_of(preprocessed(texts), "pragma"), 0U);
  expect_contains(preprocessed(texts), "#line 1 1\n\nbroken_here\n#endif\n#line 3 0\n");
}

TEST(Preprocess, LeavesOutBranchesThatNoCompilerReads)
{
  const ShaderTexts texts{
      {{"main", VERSION + "#ifdef PLAIN\n#include \"lib\"\n#elif defined(OTHER)\n#include \"lost\"\n" +
                    "#else\nskipped\n#endif\nafter\n"},
       {"lib", "#define OTHER\nlibrary\n"}}};
  const std::string with = preprocessed(texts, {"PLAIN"});
  EXPECT_EQ(count_of(with, "library"), 1U);
  EXPECT_EQ(count_of(with, "skipped"), 0U);
  expect_contains(with, "#else\n#line 7 0\n\n#endif\n");
  const std::string without =
      preprocessed({{{"main", VERSION + "#ifdef PLAIN\n#include \"lost\"\n#else\nkept\n#endif\n"}}});
  expect_contains(without, "#ifdef PLAIN\n\n#else\nkept\n#endif\n");
}

TEST(Preprocess, KeepsBranchesThatCompilersDecide)
{
  for (const char *condition : {"#ifdef VULKAN", "#ifndef GL_KHR_vulkan_glsl", "#if 0", "#if __VERSION__ > 450",
                                "#if !defined(A) && COUNT > 2", "#ifdef A B"}) {
    expect_contains(preprocessed({{{"main", VERSION + condition + "\nkept\n#endif\n"}}}), "kept");
  }
}

// glslang does not see these where it skips a branch.
TEST(Preprocess, CommentsMayPrecedeTheEndOfABranchThatIsLeftOut)
{
  const std::string text =
      preprocessed({{{"main", VERSION + "#ifdef OFF\nskipped /* b\n*/ #endif /* c\n*/ kept\n/* d */ #define ON\n" +
                                  "#ifdef ON\nread\n#else\nskipped\n#endif\n"}}});
  expect_contains(text, "#ifdef OFF\n\n#endif /* c\n*/ kept\n");
  expect_contains(text, "#ifdef ON\nread\n#else\n\n#endif\n");
}

TEST(Preprocess, AMacroThatIsDefinedOutsideIsNoIncludeGuard)
{
  const ShaderTexts texts{
      {{"main", VERSION + "#include \"lib\"\n"}, {"lib", "#ifndef COUNT\n#define COUNT 4\n#else\nother\n#endif\n"}}};
  EXPECT_EQ(count_of(preprocessed(texts, {"COUNT 64"}), "other"), 1U);
  EXPECT_EQ(count_of(preprocessed(texts), "other"), 0U);
}

TEST(ShaderSource, NamesTheFilesOfALog)
{
  const ShaderSource source{ShaderStage::Vertex, "", {"main.glsl", "lib.glsl"}};
  EXPECT_EQ(source.name_files("ERROR: 1:15: 'x' : undeclared"), "ERROR: lib.glsl:15: 'x' : undeclared\n");
  EXPECT_EQ(source.name_files("1:15(3): error: x\n0:2(1): warning: 3:4\n"),
            "lib.glsl:15(3): error: x\nmain.glsl:2(1): warning: 3:4\n");
  // NVIDIA.
  EXPECT_EQ(source.name_files("1(15) : error C1503: undefined variable\n0(2) : warning C7050: 3(4) :\n"),
            "lib.glsl:15 : error C1503: undefined variable\nmain.glsl:2 : warning C7050: 3(4) :\n");
  EXPECT_EQ(source.name_files("7(1) : error C0000: no such file"), "7(1) : error C0000: no such file\n");
  EXPECT_EQ(source.name_files("99999999999999999999:1: x"), "99999999999999999999:1: x\n");
  EXPECT_EQ(source.name_files("WARNING: 7:1: no such file"), "WARNING: 7:1: no such file\n");
  EXPECT_EQ(source.name_files("nothing to name, 0:1"), "nothing to name, 0:1\n");
}

}  // namespace
}  // namespace gnomon::gpu
