// SPDX-License-Identifier: MIT
// Very long lines, names and expressions: they give a message or none, and never end the program.
#include "shader_check.hh"
#include "shader_check_reflection.hh"

#include "gpu/gpu_testing.hh"

namespace gnomon::shader_check {
namespace {

using test::error_of;
using test::ShaderTexts;

constexpr std::size_t count = 400'000;
/** Limit of a message's length: slightly more than the 400 bytes of its text. */
constexpr std::size_t message_bytes_max = 600;

/** A fragment shader that writes \a value, after \a head. */
std::string shader(const std::string &head, const std::string &value)
{
  return "#version 450 core\n" + head +
         "\nlayout(location = 0) in float x;\nlayout(location = 0) out vec4 color;\n"
         "void main() { color = vec4(" +
         value + "); }\n";
}

std::string repeated(const std::string &part, std::size_t times)
{
  std::string text;
  for (std::size_t i = 0; i < times; i++) {
    text += part;
  }
  return text;
}

std::size_t message_count(const std::string &text)
{
  const ShaderTexts texts{{{"frag", text}}};
  const std::vector<CheckMessage> messages = check_shader({"test", "", "", "frag", {}}, texts.files(), {});
  for (const CheckMessage &message : messages) {
    EXPECT_LE(message.text.size(), message_bytes_max);
    EXPECT_EQ(message.file, "frag");
  }
  return messages.size();
}

/** Message of reflect(); empty if there is none. */
std::string reflection_error(const std::string &text)
{
  const ShaderTexts texts{{{"frag", text}}};
  const auto stages = gpu::preprocess({"test", "", "", "frag", {}}, texts.files());
  return error_of([&] { static_cast<void>(reflect("test", stages)); });
}

TEST(LongInput, AMacroThatIsNotUsedIsNoMistake)
{
  EXPECT_EQ(message_count(shader("#define LONG " + repeated("word ", count / 5), "x")), 0U);
  EXPECT_EQ(message_count(shader("#define LONG " + repeated("x+", count / 2), "x")), 0U);
  EXPECT_EQ(message_count(shader("#define LONG" + std::string(count, ' ') + "x", "LONG")), 0U);
}

TEST(LongInput, ANameIsOneMessage)
{
  EXPECT_EQ(message_count(shader("#define LONG " + std::string(count, 'a'), "x")), 1U);
  EXPECT_GE(message_count(shader("#define LONG " + std::string(count, 'a'), "LONG")), 1U);
  EXPECT_GE(message_count(shader("#error " + repeated("word ", count / 5), "x")), 1U);
  EXPECT_GE(message_count(shader("#include \"" + std::string(count, 'a') + "\"", "x")), 1U);
}

TEST(LongInput, AnExpressionMayHaveManyOperators)
{
  EXPECT_EQ(message_count(shader("#define LONG " + repeated("x+", count / 2) + "x", "LONG")), 0U);
  const std::string lines = shader("", "x" + repeated("\n+x", count / 8));
  EXPECT_EQ(message_count(lines), 0U);
  EXPECT_EQ(reflection_error(lines), "");
}

TEST(LongInput, AStageAboveTheLimitIsOneMessage)
{
  const std::string text = shader(repeated("// " + std::string(100, 'a') + "\n", count / 30), "x");
  EXPECT_EQ(message_count(text), 1U);
  const std::string error = reflection_error(text);
  EXPECT_NE(error.find("more than 1048576 bytes"), std::string::npos) << error;
  const gpu::ShaderFiles files = [&](std::string_view) { return std::optional<std::string_view>(text); };
  const ProgramCheck check = check_program({"x", {{Stage::Fragment, "x.frag"}}, {}}, files, {});
  ASSERT_EQ(check.messages.size(), 1U);
  EXPECT_EQ(check.messages[0].rule, "limit");
  EXPECT_EQ(check.target_reason.find("no version"), std::string::npos) << check.target_reason;
}

TEST(LongInput, MessagesOfReflectionAreBounded)
{
  const std::string error = reflection_error(shader("#error " + repeated("word ", count / 5), "x"));
  EXPECT_FALSE(error.empty());
  EXPECT_LE(error.size(), 4 * message_bytes_max);
}

TEST(LongInput, NestingTooDeepForTheCompilerIsAMessage)
{
  EXPECT_GE(message_count(shader("", std::string(count, '-') + "x")), 1U);
  EXPECT_GE(message_count(shader("", std::string(count / 2, '(') + "x" + std::string(count / 2, ')'))), 1U);
  EXPECT_GE(message_count(shader(repeated("#if 1\n", count / 4) + repeated("#endif\n", count / 4), "x")), 1U);
}

TEST(LongInput, ACommentIsNoMistake)
{
  EXPECT_EQ(message_count(shader("/*" + std::string(count, 'a') + "*/", "x")), 0U);
  EXPECT_EQ(message_count(shader("", "x /*" + std::string(count, ' ') + "*/")), 0U);
}

TEST(LongInput, LineNumbersMayHaveAnySize)
{
  message_count(shader("#line 2147483647 0\nfloat a = nothing;", "x"));
  message_count(shader("#line 99999999999999999999 0\nfloat a = nothing;", "x"));
  message_count(shader("#line 5 99999999999999999999\nfloat a = nothing;", "x"));
}

}  // namespace
}  // namespace gnomon::shader_check
