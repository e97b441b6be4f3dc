// SPDX-License-Identifier: MIT
#include "shader_check_dialect.hh"

#include "gpu_shader_text.hh"
#include "shader_check_sources.hh"

#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <set>
#include <utility>

namespace gnomon::shader_check {

namespace fs = std::filesystem;

namespace {

using Words = std::span<const std::string_view>;

constexpr std::array<std::string_view, 14> vulkan_words = {
    "push_constant",   "input_attachment_index", "gl_VertexIndex",           "gl_InstanceIndex", "buffer_reference",
    "shaderRecordEXT", "shaderRecordNV",         "accelerationStructureEXT", "rayQueryEXT",      "spirv_instruction",
    "constant_id",     "local_size_x_id",        "local_size_y_id",          "local_size_z_id"};
/** Beginnings of names of extensions that only Vulkan has. */
constexpr std::array<std::string_view, 10> vulkan_extensions = {"GL_KHR_vulkan_glsl",
                                                                "GL_EXT_ray_",
                                                                "GL_NV_ray_tracing",
                                                                "GL_EXT_mesh_shader",
                                                                "GL_EXT_buffer_reference",
                                                                "GL_KHR_memory_scope_semantics",
                                                                "GL_EXT_debug_printf",
                                                                "GL_EXT_scalar_block_layout",
                                                                "GL_EXT_samplerless_texture_functions",
                                                                "GL_EXT_spirv_intrinsics"};
/** Extensions that Vulkan's shaders have more often, and OpenGL's may have. */
constexpr std::array<std::string_view, 4> likely_vulkan_extensions = {
    "GL_EXT_nonuniform_qualifier", "GL_EXT_shader_explicit_arithmetic_types", "GL_EXT_shader_16bit_storage",
    "GL_EXT_shader_8bit_storage"};
constexpr std::array<std::string_view, 6> opengl_words = {"gl_VertexID", "gl_InstanceID", "gl_FragColor",
                                                          "gl_FragData", "atomic_uint",   "subroutine"};
/** Words of OpenGL that OpenGL ES never had. */
constexpr std::array<std::string_view, 11> desktop_words = {"gl_Vertex",
                                                            "gl_Normal",
                                                            "gl_Color",
                                                            "gl_FrontColor",
                                                            "gl_TexCoord",
                                                            "gl_NormalMatrix",
                                                            "ftransform",
                                                            "gl_ModelViewMatrix",
                                                            "gl_ProjectionMatrix",
                                                            "gl_MultiTexCoord0",
                                                            "gl_ModelViewProjectionMatrix"};
constexpr std::array<std::string_view, 4> precision_words = {"precision", "highp", "mediump", "lowp"};

bool contains(Words words, std::string_view word)
{
  return std::ranges::find(words, word) != words.end();
}

bool starts_with_one(Words starts, std::string_view word)
{
  return std::ranges::any_of(starts, [&](std::string_view start) { return word.starts_with(start); });
}

/** Whether the type exists for Vulkan only: textures and samplers apart, and attachments. */
bool is_vulkan_type(std::string_view type)
{
  const std::string_view plain = type.starts_with('i') || type.starts_with('u') ? type.substr(1) : type;
  return type == "sampler" || type == "samplerShadow" || plain.starts_with("subpassInput") ||
         plain.starts_with("texture");
}

struct Sign {
  /** The first outside of conditions; empty if there is none. */
  std::string sure;
  /** The first under a condition; empty if there is none. */
  std::string conditional;

  bool is_set() const
  {
    return !sure.empty() || !conditional.empty();
  }
};

/** An `#if` whose `#endif` is not read yet. */
struct Condition {
  /** Whether it or one around it is no include guard. */
  bool is_conditional;
  /** Depths of braces and of parentheses at its begin; each of its branches begins with them. */
  int depth;
  int parentheses;
};

/** A statement outside of functions. */
struct Statement {
  std::vector<std::string_view> words;
  /** Words within the parentheses of `layout(…)`. */
  std::set<std::string_view> layout;
  int line = 1;
  /** Whether a part of it is under a condition. */
  bool is_conditional = false;
};

/** Reads files and notes signs of a target. */
class Reader {
 public:
  Reader(const gpu::ShaderFiles &files, std::span<const std::string> folders) : files_(files), folders_(folders) {}

  void read_stage(const Program::File &stage)
  {
    is_version_known_ = false;
    if (stage.stage >= Stage::RayGeneration) {
      set(vulkan_, stage.path, 1, fmt::format("the {} stage", to_string(stage.stage)));
    }
    read_file(stage.path);
    if (!is_version_known_ && files_(stage.path)) {
      set(no_version_, stage.path, 1, "no version");
    }
  }

  TargetChoice choice() const
  {
    // A file without a version is GLSL 1.10 or GLSL ES 1.00.
    const bool is_old_es = no_version_.is_set() && precision_.is_set() && desktop_.sure.empty();
    const std::string &old = is_old_es && !precision_.sure.empty() ? precision_.sure
                             : is_old_es                           ? precision_.conditional
                                                                   : no_version_.sure;
    const std::string old_es = is_old_es ? fmt::format("{} and no version", old) : std::string();
    const std::string &opengl = desktop_.sure.empty() ? opengl_.sure : desktop_.sure;
    const std::string &conditional_opengl = desktop_.conditional.empty() ? opengl_.conditional : desktop_.conditional;
    for (const auto &[target, reason] :
         {std::pair(CheckTarget::OpenGlSpirv, &spirv_.sure), std::pair(CheckTarget::Vulkan12, &vulkan_.sure),
          std::pair(CheckTarget::Es, &es_.sure), std::pair(CheckTarget::Es, &old_es),
          std::pair(CheckTarget::OpenGl, &opengl), std::pair(CheckTarget::OpenGl, &no_version_.sure),
          std::pair(CheckTarget::Vulkan12, &likely_vulkan_.sure),
          std::pair(CheckTarget::OpenGlSpirv, &spirv_.conditional),
          std::pair(CheckTarget::Vulkan12, &vulkan_.conditional), std::pair(CheckTarget::Es, &es_.conditional),
          std::pair(CheckTarget::OpenGl, &conditional_opengl)}) {
      if (!reason->empty() && (target != CheckTarget::Vulkan12 || is_vulkan_possible_)) {
        return {target, *reason};
      }
    }
    return {CheckTarget::Vulkan12, "each declaration has the location or binding that Vulkan needs"};
  }

 private:
  void set(Sign &sign, const std::string &file, int line, std::string_view what) const
  {
    std::string &text = is_conditional() ? sign.conditional : sign.sure;
    if (text.empty()) {
      text = fmt::format("{}:{} has {}", file, line, what);
    }
  }
  bool is_conditional() const
  {
    return is_statement_conditional_ || (!conditions_.empty() && conditions_.back().is_conditional);
  }

  void read_file(const std::string &path)
  {
    const std::optional<std::string_view> text = files_(path);
    if (!text || !seen_.insert(path).second) {
      return;
    }
    const std::size_t condition_count = conditions_.size();
    const bool has_guard = !include_guard_of(*text).empty();
    bool is_first_condition = true;
    int line = 0;
    int depth = 0;
    bool is_in_comment = false;
    bool is_continued = false;
    Statement statement;
    last_word_ = {};
    // The stripped lines live as long as the words of a statement.
    std::deque<std::string> lines;
    for (std::string_view rest = without_byte_order_mark(text->substr(0, stage_bytes_max)); !rest.empty();) {
      const std::string_view whole = rest.substr(0, rest.find('\n'));
      rest.remove_prefix(std::min(whole.size() + 1, rest.size()));
      line++;
      const std::string &code = lines.emplace_back(without_comments(whole, is_in_comment));
      const bool is_directive = is_continued || !gpu::directive_of(code).empty();
      if (is_directive) {
        if (!is_continued && gpu::directive_of(code).starts_with("if")) {
          const bool is_guard = std::exchange(is_first_condition, false) && has_guard;
          conditions_.push_back({is_conditional() || !is_guard, depth, parentheses_});
        }
        else if (!is_continued) {
          read_branch(code, condition_count, depth);
          read_directive(path, line, code);
        }
        const std::size_t last = code.find_last_not_of(" \t\r");
        is_continued = last != std::string::npos && code[last] == '\\';
        continue;
      }
      read_code(path, line, code, depth, statement);
    }
    conditions_.resize(std::min(conditions_.size(), condition_count));
  }

  /** Reads `#else`, `#elif` and `#endif` of a file, which begins with \a condition_count conditions. */
  void read_branch(std::string_view code, std::size_t condition_count, int &depth)
  {
    const std::string_view name = gpu::directive_of(code);
    if (conditions_.size() <= condition_count) {
      return;
    }
    if (name == "else" || name == "elif") {
      depth = conditions_.back().depth;
      parentheses_ = conditions_.back().parentheses;
    }
    else if (name == "endif") {
      conditions_.pop_back();
    }
  }

  void read_directive(const std::string &path, int line, std::string_view code)
  {
    const std::string_view name = gpu::directive_of(code);
    gpu::TextScanner scanner(code);
    scanner.skip_space().take("#");
    scanner.skip_space().take_word();
    scanner.skip_space();
    if (name == "version" && !is_version_known_) {
      read_version(path, line, scanner);
    }
    else if (name == "extension") {
      const std::string_view extension = scanner.take_word();
      if (extension == "GL_ARB_gl_spirv") {
        set(spirv_, path, line, extension);
      }
      else if (starts_with_one(vulkan_extensions, extension)) {
        set(vulkan_, path, line, extension);
      }
      else if (starts_with_one(likely_vulkan_extensions, extension)) {
        set(likely_vulkan_, path, line, extension);
      }
    }
    else if (name == "include") {
      const bool is_local = scanner.take("\"");
      if (!is_local && !scanner.take("<")) {
        return;
      }
      const std::string named(scanner.rest().substr(0, scanner.rest().find(is_local ? '"' : '>')));
      read_include(is_local ? std::optional(fs::path(path).parent_path() / named) : std::nullopt, named);
    }
  }

  void read_version(const std::string &path, int line, gpu::TextScanner &scanner)
  {
    is_version_known_ = true;
    const std::optional<int> version = scanner.take_number();
    const std::string_view profile = scanner.skip_space().take_word();
    if (!version) {
      return;
    }
    const std::string text = fmt::format("version {}{}{}", *version, profile.empty() ? "" : " ", profile);
    if (Version{*version, profile, line}.is_es()) {
      set(es_, path, line, text);
      is_vulkan_possible_ &= *version >= 310;
    }
    else if (*version < 140 || profile == "compatibility") {
      set(opengl_, path, line, text);
      is_vulkan_possible_ = false;
    }
  }

  void read_include(const std::optional<fs::path> &beside, const std::string &named)
  {
    std::optional<FoundFile> found = beside ? find_file(*beside, files_) : std::nullopt;
    for (auto folder = folders_.begin(); !found && folder != folders_.end(); ++folder) {
      found = find_file(fs::path(*folder) / named, files_);
    }
    if (found) {
      read_file(found->path);
    }
  }

  /** \a depth: of braces, of which those of blocks belong to the statement. */
  void read_code(const std::string &path, int line, std::string_view code, int &depth, Statement &statement)
  {
    while (!code.empty()) {
      const char c = code.front();
      if (!gpu::is_word_character(c)) {
        code.remove_prefix(1);
        if (c == '{') {
          depth++;
        }
        else if (c == '}') {
          depth = std::max(depth - 1, 0);
        }
        else if (c == '(' || c == ')' || c == '[') {
          parentheses_ += c == '(' ? 1 : c == ')' ? -1 : 0;
          is_layout_ = is_layout_ || (c == '(' && last_word_ == "layout");
          is_layout_ = is_layout_ && c != ')';
        }
        else if (c == ';' && depth == 0) {
          is_statement_conditional_ = statement.is_conditional;
          end_statement(path, statement);
          is_statement_conditional_ = false;
          statement = {};
          parentheses_ = 0;
        }
        if (c == '}' && depth == 0 && !is_interface(statement)) {
          statement = {};
          parentheses_ = 0;
        }
        continue;
      }
      gpu::TextScanner scanner(code);
      const std::string_view word = scanner.take_word();
      code = scanner.rest();
      note_word(path, line, word);
      last_word_ = word;
      if (statement.words.empty()) {
        statement.line = line;
      }
      const bool is_in_statement = depth == 0 && parentheses_ <= 0;
      statement.is_conditional |= (is_layout_ || is_in_statement) && is_conditional();
      if (is_layout_) {
        statement.layout.insert(word);
      }
      else if (is_in_statement) {
        statement.words.push_back(word);
      }
    }
  }

  void note_word(const std::string &path, int line, std::string_view word)
  {
    if (contains(vulkan_words, word)) {
      set(vulkan_, path, line, word);
    }
    else if (contains(opengl_words, word)) {
      set(opengl_, path, line, word);
    }
    else if (contains(desktop_words, word)) {
      set(desktop_, path, line, word);
    }
    else if (!is_version_known_ && contains(precision_words, word)) {
      set(precision_, path, line, word);
    }
  }

  static bool is_interface(const Statement &statement)
  {
    static constexpr std::array<std::string_view, 6> kinds = {"uniform", "buffer", "in", "out", "varying", "attribute"};
    return std::ranges::any_of(statement.words, [](std::string_view word) { return contains(kinds, word); });
  }

  void end_statement(const std::string &path, const Statement &statement)
  {
    const auto has = [&](std::string_view word) {
      return std::ranges::find(statement.words, word) != statement.words.end();
    };
    if (!is_interface(statement)) {
      return;
    }
    // The word after the qualifiers: a type, or the name of a block; none in `layout(local_size_x = 8) in;`.
    static constexpr std::array<std::string_view, 25> qualifiers = {
        "layout",        "uniform",  "buffer",    "in",           "out",      "flat",      "smooth",
        "noperspective", "centroid", "sample",    "patch",        "readonly", "writeonly", "coherent",
        "volatile",      "restrict", "highp",     "mediump",      "lowp",     "invariant", "precise",
        "const",         "varying",  "attribute", "nonuniformEXT"};
    const auto type =
        std::ranges::find_if(statement.words, [](std::string_view word) { return !contains(qualifiers, word); });
    if (type == statement.words.end() || type->starts_with("gl_")) {
      return;
    }
    const auto has_layout = [&](std::string_view word) { return statement.layout.contains(word); };
    if (has("varying") || has("attribute")) {
      set(opengl_, path, statement.line, has("varying") ? "varying" : "attribute");
    }
    else if (has("uniform") || has("buffer")) {
      if (has_layout("set")) {
        set(vulkan_, path, statement.line, "layout(set = …)");
      }
      else if (has("uniform") && is_vulkan_type(*type)) {
        set(vulkan_, path, statement.line, *type);
      }
      else if (!has_layout("binding") && !has_layout("push_constant") && !has_layout("buffer_reference") &&
               !has_layout("shaderRecordEXT") && !has_layout("shaderRecordNV")) {
        set(opengl_, path, statement.line,
            fmt::format("{} '{}' without a binding", has("uniform") ? "uniform" : "buffer", statement.words.back()));
      }
    }
    else if (!has_layout("location") && !has_layout("constant_id")) {
      set(opengl_, path, statement.line,
          fmt::format("{} '{}' without a location", has("in") ? "input" : "output", statement.words.back()));
    }
  }

  const gpu::ShaderFiles &files_;
  std::span<const std::string> folders_;
  std::set<std::string> seen_;
  bool is_version_known_ = false;
  bool is_vulkan_possible_ = true;
  int parentheses_ = 0;
  bool is_layout_ = false;
  std::string_view last_word_;
  Sign vulkan_;
  Sign likely_vulkan_;
  Sign spirv_;
  Sign es_;
  Sign opengl_;
  /** Sign of OpenGL that OpenGL ES does not have. */
  Sign desktop_;
  /** Sign of GLSL ES 1.00 in files without a version. */
  Sign precision_;
  Sign no_version_;
  std::vector<Condition> conditions_;
  bool is_statement_conditional_ = false;
};

}  // namespace

TargetChoice choose_target(std::span<const Program::File> stages, const gpu::ShaderFiles &files,
                           std::span<const std::string> folders)
{
  Reader reader(files, folders);
  for (const Program::File &stage : stages) {
    reader.read_stage(stage);
  }
  return reader.choice();
}

}  // namespace gnomon::shader_check
