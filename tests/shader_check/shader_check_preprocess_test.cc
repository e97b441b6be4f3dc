// SPDX-License-Identifier: MIT
// The text that preprocess() makes means the same to glslang as the text of the file.
#include "internal/shader_check_glslang.hh"

#include "gpu/gpu_testing.hh"

#include <array>
#include <random>
#include <sstream>

namespace gnomon::shader_check {
namespace {

using test::ShaderTexts;
using test::VERSION;

/** Random directives, comments and continued lines, but no comments around directives that branch, which glslang
 * miscounts. Each other line says its number, unless a branch leaves it out. */
class RandomText {
 public:
  explicit RandomText(unsigned seed) : random_(seed) {}

  std::string text()
  {
    for (int i = 0; i < 40; i++) {
      add_line();
    }
    for (; !open_.empty(); open_.pop_back()) {
      text_ += open_.back() ? "#endif\n" : "#else\nint n = __LINE__;\n#endif\n";
    }
    return text_;
  }

 private:
  unsigned below(unsigned count)
  {
    return unsigned(random_() % count);
  }
  std::string name()
  {
    constexpr std::array<const char *, 7> names = {"A", "B", "C", "D", "VULKAN", "GL_ES", "__cplusplus"};
    return names[below(names.size())];
  }
  std::string condition(int depth)
  {
    switch (below(depth > 0 ? 7 : 3)) {
      case 0: return "defined(" + name() + ")";
      case 1: return "defined " + name();
      case 2: return below(2) == 0 ? "__VERSION__ >= 450" : "0";
      case 3: return "!" + condition(0);
      case 4: return condition(depth - 1) + " && " + condition(depth - 1);
      case 5: return condition(depth - 1) + "||" + condition(depth - 1);
      default: return "!(" + condition(depth - 1) + ")";
    }
  }
  void add_line()
  {
    switch (below(15)) {
      case 0: text_ += "#ifdef " + name() + (below(2) == 0 ? " // condition\n" : "\n"); break;
      case 1: text_ += "  #ifndef " + name() + "\n"; break;
      case 2: text_ += "# if " + condition(3) + "\n"; break;
      case 3: add_branch("#elif " + condition(2) + "\n", false); return;
      case 4: add_branch("#else\n", true); return;
      case 5:
        if (!open_.empty()) {
          open_.pop_back();
          text_ += "#endif\n";
        }
        return;
      case 6: text_ += "#define " + std::string(1, char('A' + below(4))) + " 1\n"; return;
      case 7: text_ += "#undef " + std::string(1, char('A' + below(4))) + "\n"; return;
      case 8: text_ += "/* comment\n#endif\n#ifdef A\n*/ int n = __LINE__; // /*\n"; return;
      case 9: text_ += "/* a */ /* b */ #define " + std::string(1, char('A' + below(4))) + "\n"; return;
      case 10: text_ += "/*\n*/ #undef " + std::string(1, char('A' + below(4))) + " // /*\n"; return;
      case 11: text_ += below(8) == 0 ? "#define \\\nD\n" : "int n = __LINE__; /* a\n*/ int n = __LINE__;\n"; return;
      case 12: text_ += "int n = \\\n__LINE__; // and \\\n#else /*\n"; return;
      default: text_ += "int n = __LINE__;\n"; return;
    }
    open_.push_back(false);
  }
  void add_branch(const std::string &line, bool is_else)
  {
    if (!open_.empty() && !open_.back()) {
      open_.back() = is_else;
      text_ += line;
    }
  }

  std::mt19937 random_;
  std::string text_;
  /** Whether each open branch has had its #else. */
  std::vector<bool> open_;
};

/** The lines of a vertex shader that glslang reads, without those that are empty. */
std::string read_by_glslang(gpu::ShaderSource text, CheckTarget target)
{
  StageSource source(std::move(text));
  std::istringstream lines(GlslangProgram().preprocessed(source, target));
  std::string read;
  for (std::string line; std::getline(lines, line);) {
    read += line.empty() ? line : line + "\n";
  }
  return read;
}

TEST(Preprocess, LeavesOutWhatGlslangDoesNotRead)
{
  std::size_t raw_bytes = 0;
  std::size_t bytes = 0;
  for (unsigned seed = 0; seed < 400; seed++) {
    const std::string body = RandomText(seed).text();
    const ShaderTexts texts{{{"main", VERSION + body}}};
    const gpu::ShaderSource preprocessed = gpu::preprocess({"test", "main", "", "", {}}, texts.files()).at(0);
    const std::string text = VERSION + "#line 2 0\n" + body;
    raw_bytes += text.size();
    bytes += preprocessed.text.size();
    for (const CheckTarget target : {CheckTarget::OpenGlSpirv, CheckTarget::Vulkan12}) {
      const std::string all = read_by_glslang({gpu::ShaderStage::Vertex, text, {"main"}}, target);
      EXPECT_NE(all.find("#version"), std::string::npos);
      EXPECT_EQ(read_by_glslang(preprocessed, target), all) << seed << "\n" << text;
    }
  }
  EXPECT_LT(bytes, raw_bytes * 9 / 10);
}

}  // namespace
}  // namespace gnomon::shader_check
