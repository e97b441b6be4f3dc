// SPDX-License-Identifier: MIT
#include "shader_check_sources.hh"

#include "gpu_shader_text.hh"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <set>
#include <utility>

namespace gnomon::shader_check {

namespace fs = std::filesystem;

namespace {

/** Files may include themselves under conditions, so only the depth shows an include without an end. */
constexpr std::size_t include_depth_max = 200;

std::string name_of(std::size_t file)
{
  return name_mark + std::to_string(file);
}

Stage stage_of(gpu::ShaderStage stage)
{
  switch (stage) {
    case gpu::ShaderStage::Vertex: return Stage::Vertex;
    case gpu::ShaderStage::Geometry: return Stage::Geometry;
    case gpu::ShaderStage::Fragment: break;
  }
  return Stage::Fragment;
}

}  // namespace

std::optional<std::size_t> file_named(std::string_view name)
{
  std::size_t file = 0;
  if (!name.starts_with(name_mark) ||
      std::from_chars(name.data() + 1, name.data() + name.size(), file).ptr != name.data() + name.size()) {
    return std::nullopt;
  }
  return file;
}

std::size_t find_word(std::string_view text, std::string_view word, std::size_t from)
{
  for (std::size_t at = text.find(word, from); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !gpu::is_word_character(text[at - 1])) &&
        (end == text.size() || !gpu::is_word_character(text[end]))) {
      return at;
    }
  }
  return std::string_view::npos;
}

std::string without_comments(std::string_view line, bool &is_in_comment)
{
  // Most lines have no comment.
  if (!is_in_comment && line.find('/') == std::string_view::npos) {
    return std::string(line);
  }
  std::string code;
  for (std::size_t i = 0; i < line.size(); i++) {
    const std::string_view two = line.substr(i, 2);
    if (is_in_comment) {
      if (two == "*/") {
        is_in_comment = false;
        i++;
      }
    }
    else if (two == "/*") {
      is_in_comment = true;
      i++;
      code += ' ';
    }
    else if (two == "//") {
      break;
    }
    else {
      code += line[i];
    }
  }
  return code;
}

std::string_view without_byte_order_mark(std::string_view text)
{
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.substr(text.starts_with(mark) ? mark.size() : 0);
}

std::optional<FoundFile> find_file(const fs::path &path, const gpu::ShaderFiles &files)
{
  const std::string plain = path.lexically_normal().string();
  const std::optional<std::string_view> plain_text = files(plain);
  const bool has_parent = std::ranges::find(path, fs::path("..")) != path.end();
  const std::optional<std::string_view> text =
      has_parent && path != fs::path(plain) ? files(path.string()) : std::nullopt;
  if (text && text != plain_text) {
    return FoundFile{path.string(), *text};
  }
  return plain_text ? std::optional(FoundFile{plain, *plain_text}) : std::nullopt;
}

std::optional<Version> version_in(std::string_view text)
{
  bool is_in_comment = false;
  int number = 1;
  for (std::string_view rest = text; !rest.empty(); number++) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    const std::string code = without_comments(line, is_in_comment);
    if (gpu::directive_of(code) != "version") {
      continue;
    }
    gpu::TextScanner scanner(line.substr(line.find("version")));
    scanner.take_word();
    const std::optional<int> version = scanner.skip_space().take_number();
    return version ? std::optional(Version{*version, scanner.skip_space().take_word(), number}) : std::nullopt;
  }
  return std::nullopt;
}

std::string_view include_guard_of(std::string_view text)
{
  std::string_view guard;
  int depth = 0;
  int directive_count = 0;
  bool is_in_comment = false;
  bool is_continued = false;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    const std::string code = without_comments(line, is_in_comment);
    const std::size_t last = code.find_last_not_of(" \t\r");
    if (std::exchange(is_continued, last != std::string::npos && code[last] == '\\') || last == std::string::npos) {
      continue;
    }
    const std::string_view directive = gpu::directive_of(code);
    const bool is_ended = directive_count > 0 && depth == 0;
    if (is_ended || (directive.empty() && directive_count < 2)) {
      return {};
    }
    if (directive.empty()) {
      continue;
    }
    directive_count++;
    if (directive_count <= 2) {
      gpu::TextScanner scanner(line.substr(std::min(line.find(directive), line.size())));
      scanner.take_word();
      const std::string_view name = scanner.skip_space().take_word();
      if (directive != (directive_count == 1 ? "ifndef" : "define") || (directive_count == 2 && name != guard)) {
        return {};
      }
      guard = name;
    }
    if (depth == 1 && (directive == "else" || directive == "elif")) {
      return {};
    }
    depth += directive.starts_with("if") ? 1 : directive == "endif" ? -1 : 0;
  }
  return depth == 0 && directive_count > 2 ? guard : std::string_view();
}

std::string too_long_text()
{
  return fmt::format("the stage has more than {} bytes with its includes, and at most {} are checked", stage_bytes_max,
                     stage_bytes_max);
}

/** Finds the includes of one stage for glslang. */
class StageSource::Includer : public glslang::TShader::Includer {
 public:
  Includer(StageSource &source, const gpu::ShaderFiles &files, std::span<const std::string> folders)
      : source_(source), files_(files), folders_(folders)
  {
  }

  IncludeResult *includeLocal(const char *named, const char *includer, std::size_t depth) override
  {
    const std::size_t file = file_named(includer).value_or(0);
    const fs::path beside = fs::path(source_.files_[file]).parent_path() / named;
    return find(named, depth, &beside);
  }
  IncludeResult *includeSystem(const char *named, const char *, std::size_t depth) override
  {
    // glslang asks so after a local include that failed, too. Its reason is the better one.
    const std::string earlier = std::exchange(reason_, {});
    IncludeResult *result = earlier.empty() ? find(named, depth, nullptr) : failure(earlier);
    reason_.clear();
    return result;
  }
  void releaseInclude(IncludeResult *result) override
  {
    if (result != nullptr && result->userData != nullptr) {
      delete static_cast<std::string *>(result->userData);
    }
    delete result;
  }

  /** Call it before the stage is read again. */
  void restart()
  {
    bytes_ = 0;
    skipped_bytes_ = 0;
    is_ended_ = false;
  }

 private:
  /** \a beside: is tried before the folders. */
  IncludeResult *find(const std::string &named, std::size_t depth, const fs::path *beside)
  {
    open_files_.resize(depth, 0);
    if (depth > include_depth_max && !is_ended_) {
      const std::string circle = circle_text(open_files_.back(), std::span(open_files_).first(depth - 1));
      return ended(fmt::format("{} at a depth of more than {}",
                               circle.empty() ? fmt::format("'{}' is included", named) : circle + ",",
                               include_depth_max));
    }
    if (beside != nullptr) {
      if (IncludeResult *result = open(*beside)) {
        return result;
      }
    }
    for (const std::string &folder : folders_) {
      if (IncludeResult *result = open(fs::path(folder) / named)) {
        return result;
      }
    }
    return failed(beside != nullptr ? fmt::format("no shader file '{}'", beside->lexically_normal().string())
                                    : fmt::format("no shader file '{}' in the folders of -I", named));
  }

  IncludeResult *open(const fs::path &path)
  {
    const gpu::ShaderFiles noted = [&](std::string_view tried) {
      const std::optional<std::string_view> text = files_(tried);
      if (!text && std::ranges::find(source_.absent_, tried) == source_.absent_.end()) {
        source_.absent_.emplace_back(tried);
      }
      return text;
    };
    const std::optional<FoundFile> found = find_file(path, noted);
    if (!found) {
      return nullptr;
    }
    const std::size_t file = source_.file_of(found->path);
    const std::string_view text = source_.unmarked(file, found->text);
    if (const std::string circle = circle_text(file, open_files_); !circle.empty() && version_in(text)) {
      // glslang would say of the second #version that it is not first.
      return failed(circle + ", which a file with #version cannot do");
    }
    open_files_.push_back(file);
    if (is_ended_) {
      return new IncludeResult(name_of(file), text.data(), 0, nullptr);
    }
    count(file, text);
    if (bytes_ + source_.text_.size() > stage_bytes_max) {
      return ended(too_long_text());
    }
    if (skipped_bytes_ > skipped_bytes_max) {
      return ended(fmt::format("include guards skip more than {} bytes", skipped_bytes_max));
    }
    reason_.clear();
    return new IncludeResult(name_of(file), text.data(), text.size(), nullptr);
  }

  /** How \a file includes itself; empty: it is not one of \a open, the including files from the stage's on. */
  [[nodiscard]] std::string circle_text(std::size_t file, std::span<const std::size_t> open) const
  {
    const auto last = std::find(open.rbegin(), open.rend(), file).base();
    if (last == open.begin()) {
      return {};
    }
    std::string text = fmt::format("'{}' includes itself", source_.files_[file]);
    for (auto between = last; between != open.end(); between++) {
      text += fmt::format("{}'{}'", between == last ? " by way of " : ", ", source_.files_[*between]);
    }
    return text;
  }

  /** Counts the bytes of an include. Bytes that a guard skips are counted apart: glslang only looks for its end. */
  void count(std::size_t file, std::string_view text)
  {
    if (guards_.empty()) {
      guards_.try_emplace(0);
      note_undefined(source_.text_);
    }
    const auto [guard, is_new] = guards_.try_emplace(file);
    if (is_new) {
      source_.texts_.push_back({file, text});
      guard->second = include_guard_of(text);
      note_undefined(text);
    }
    const bool is_skipped = !is_new && !guard->second.empty() && !undefines_any_ && !undefined_.contains(guard->second);
    (is_skipped ? skipped_bytes_ : bytes_) += text.size();
  }
  /** Notes the names of `#undef` in \a text. Words that a line's end splits are not read. */
  void note_undefined(std::string_view text)
  {
    constexpr std::string_view word = "undef";
    for (std::size_t at = find_word(text, word); at != std::string_view::npos; at = find_word(text, word, at + 1)) {
      gpu::TextScanner scanner(text.substr(at + word.size()));
      const std::string_view name = scanner.skip_space().take_word();
      undefined_.insert(name);
      undefines_any_ |= name.empty();
    }
    for (std::size_t at = text.find('\\'); at != std::string_view::npos; at = text.find('\\', at + 1)) {
      undefines_any_ |=
          at > 0 && gpu::is_word_character(text[at - 1]) && text.substr(at + 1).find_first_of("\r\n") == 0;
    }
  }

  /** Reaches a limit. The rest of the stage has empty includes, so that one message says so. */
  IncludeResult *ended(const std::string &reason)
  {
    is_ended_ = true;
    return failed(reason);
  }
  IncludeResult *failed(const std::string &reason)
  {
    reason_ = reason;
    return failure(reason);
  }
  static IncludeResult *failure(std::string reason)
  {
    auto *text = new std::string(std::move(reason));
    return new IncludeResult("", text->data(), text->size(), text);
  }

  StageSource &source_;
  const gpu::ShaderFiles &files_;
  std::span<const std::string> folders_;
  std::string reason_;
  /** The file of the stage and the open includes within each other, by their indices in files(). */
  std::vector<std::size_t> open_files_;
  /** Include guards by the indices of files; empty for files without one. */
  std::unordered_map<std::size_t, std::string_view> guards_;
  /** Macros that a text undefines: such a guard may skip nothing. */
  std::set<std::string_view> undefined_;
  bool undefines_any_ = false;
  static constexpr std::size_t skipped_bytes_max = 64 * stage_bytes_max;
  std::size_t bytes_ = 0;
  std::size_t skipped_bytes_ = 0;
  bool is_ended_ = false;
};

StageSource::StageSource(gpu::ShaderSource source)
    : stage_(stage_of(source.stage)), text_(std::move(source.text)), files_(std::move(source.files))
{
  texts_.push_back({0, text_});
}

StageSource::StageSource(Stage stage, std::string path, std::string_view text, const std::vector<std::string> &defines,
                         const gpu::ShaderFiles &files, std::span<const std::string> folders)
    : stage_(stage),
      // The same as in glslc: a file need not ask for the extension.
      preamble_("#extension GL_GOOGLE_include_directive : enable\n"),
      name_(name_of(0)),
      includer_(std::make_unique<Includer>(*this, files, folders))
{
  for (const std::string &define : defines) {
    preamble_ += "#define " + define + "\n";
  }
  text_ = unmarked(file_of(path), text);
  texts_.push_back({0, text_});
}

StageSource::~StageSource() = default;

glslang::TShader::Includer *StageSource::start_includer()
{
  if (includer_ != nullptr) {
    includer_->restart();
  }
  return includer_.get();
}

std::size_t StageSource::file_of(std::string_view path)
{
  const auto [entry, is_new] = indices_.try_emplace(std::string(path), files_.size());
  if (is_new) {
    files_.emplace_back(path);
  }
  return entry->second;
}

std::string_view StageSource::unmarked(std::size_t file, std::string_view text)
{
  const std::string_view plain = without_byte_order_mark(text);
  if (plain.size() < text.size() && std::ranges::find(marked_, file) == marked_.end()) {
    marked_.push_back(file);
  }
  return plain;
}

SourcePosition StageSource::position(std::string_view name, int line, int column)
{
  SourcePosition position{0, line < 0 ? 0 : std::max(line, 1), std::max(column, 0)};
  std::int64_t number = 0;
  if (const std::optional<std::size_t> file = file_named(name)) {
    position.file = *file < files_.size() ? *file : 0;
  }
  else if (std::from_chars(name.data(), name.data() + name.size(), number).ptr == name.data() + name.size()) {
    // The number of a string, or one that a `#line` of the user gave.
    const auto file = numbers_.find(std::string(name));
    position.file = includer_ == nullptr ? (number > 0 && std::size_t(number) < files_.size() ? std::size_t(number) : 0)
                    : file != numbers_.end() ? file->second
                                             : 0;
  }
  else if (!name.empty()) {
    position.file = file_of(name);
  }
  return position;
}

namespace {

int line_count(std::string_view text)
{
  return int(std::ranges::count(text, '\n')) + (text.empty() || text.ends_with('\n') ? 0 : 1);
}

/** Reads `#line LINE`, `#line LINE NUMBER` or `#line LINE "NAME"`. \return empty without a number */
std::optional<LineDirective> line_directive(std::string_view text)
{
  gpu::TextScanner scanner(text);
  scanner.skip_space().take("#");
  scanner.skip_space().take("line");
  const std::optional<int> line = scanner.skip_space().take_number();
  if (!line) {
    return std::nullopt;
  }
  LineDirective directive{*line, {}};
  const bool is_name = scanner.skip_space().take("\"");
  directive.file = is_name ? scanner.rest().substr(0, scanner.rest().find('"')) : scanner.take_word();
  return directive;
}

/** `shader-check: RULE` or `shader-check: RULE=LEVEL`. */
struct LevelComment {
  std::string_view rule;
  /** Empty: it is about its line. */
  std::optional<std::string_view> level;
  /** Behind it. */
  std::string_view rest;
};

/** The first one in \a text. Spaces around `:` and `=` are optional. */
std::optional<LevelComment> level_comment_in(std::string_view text)
{
  constexpr std::string_view mark = "shader-check";
  for (std::size_t at = text.find(mark); at != std::string_view::npos; at = text.find(mark, at + 1)) {
    std::string_view rest = text.substr(at + mark.size());
    const auto skip_space = [&] { rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size())); };
    const auto take = [&](std::string_view ends) {
      const std::string_view word = rest.substr(0, rest.find_first_of(ends));
      rest.remove_prefix(word.size());
      skip_space();
      return word;
    };
    skip_space();
    if (!rest.starts_with(':')) {
      continue;
    }
    rest.remove_prefix(1);
    skip_space();
    LevelComment comment{take("=,;:. \t\r\n"), std::nullopt, {}};
    if (rest.starts_with('=')) {
      rest.remove_prefix(1);
      skip_space();
      comment.level = take(",;:.* \t\r\n");
    }
    comment.rest = rest;
    return comment;
  }
  return std::nullopt;
}

std::optional<RuleLevel> rule_level(std::string_view word)
{
  return word == "off"       ? std::optional(RuleLevel::Off)
         : word == "warning" ? std::optional(RuleLevel::Warning)
         : word == "error"   ? std::optional(RuleLevel::Error)
                             : std::nullopt;
}

std::uint64_t key_of(SourcePosition position)
{
  return std::uint64_t(position.file) << 32U | std::uint32_t(position.line);
}

}  // namespace

bool StageSource::has_line_directives() const
{
  return has_includer() && std::ranges::any_of(texts_, [](const File &file) {
           for (std::size_t at = find_word(file.text, "line"); at != std::string_view::npos;
                at = find_word(file.text, "line", at + 1)) {
             const std::size_t before = file.text.find_last_not_of(" \t", at == 0 ? 0 : at - 1);
             if (before != std::string_view::npos && file.text[before] == '#') {
               return true;
             }
           }
           return false;
         });
}

bool StageSource::line_sets_next(CheckTarget target) const
{
  const std::optional<Version> version = version_in(text_);
  return version ? version->number == 100 || version->number >= 300 : target == CheckTarget::Es;
}

void StageSource::note_line_directives(std::string_view preprocessed, CheckTarget target)
{
  struct Place {
    std::size_t file;
    int line;
    int line_count;
  };
  // The files whose includes are open, the innermost last.
  std::vector<Place> open;
  const auto enter = [&](std::size_t file) {
    const auto text = std::ranges::find(texts_, file, &File::index);
    open.push_back({file, 1, text == texts_.end() ? 0 : line_count(text->text)});
  };
  enter(0);
  // The first line is that of the preamble.
  open.back().line = 0;
  while (!preprocessed.empty()) {
    const std::string_view text = preprocessed.substr(0, preprocessed.find('\n'));
    preprocessed.remove_prefix(std::min(text.size() + 1, preprocessed.size()));
    const auto directive = text.starts_with("#line ") ? line_directive(text) : std::nullopt;
    const std::optional<std::size_t> file = directive ? file_named(directive->file) : std::nullopt;
    if (directive && open.size() > 1 && open.back().line > open.back().line_count) {
      // glslang adds one behind each include, with the name that the including file then has.
      open.pop_back();
    }
    else if (file) {
      // And one before.
      enter(*file);
      continue;
    }
    else if (directive) {
      directives_.try_emplace({open.back().file, open.back().line}, *directive);
      // glslang joins the lines 0 and 1.
      open.back().line += directive->line == 0 && line_sets_next(target) ? 1 : 0;
    }
    open.back().line++;
  }
}

void SourceLines::read(CheckTarget target)
{
  const bool line_sets_next = source_.line_sets_next(target);
  for (const StageSource::File &file : source_.texts()) {
    SourcePosition position{file.index, 1, 0};
    bool is_in_comment = false;
    int number = 1;
    for (std::string_view rest = file.text; !rest.empty(); number++) {
      const std::string_view text = rest.substr(0, rest.find('\n'));
      rest.remove_prefix(std::min(text.size() + 1, rest.size()));
      const std::string_view directive = is_in_comment ? std::string_view() : gpu::directive_of(text);
      const std::optional<LineDirective> set = directive != "line"      ? std::nullopt
                                               : source_.has_includer() ? source_.line_directive_at(file.index, number)
                                                                        : line_directive(text);
      if (set) {
        const bool is_number = set->file.find_first_not_of("0123456789") == std::string_view::npos;
        if (is_number && source_.has_includer() && !set->file.empty()) {
          source_.note_number(set->file, file.index);
          position.file = file.index;
        }
        else if (!set->file.empty()) {
          position.file = source_.position(set->file, 1, 0).file;
        }
        position.line = set->line + (line_sets_next || set->line == std::numeric_limits<int>::max() ? 0 : 1);
        continue;
      }
      read_levels(file.index, position, text);
      const bool may_have_comment = is_in_comment || text.find('/') != std::string_view::npos;
      lines_.push_back(
          {position, text,
           may_have_comment ? std::string_view(codes_.emplace_back(without_comments(text, is_in_comment))) : text});
      // A `#line` may have any number.
      position.line += position.line < std::numeric_limits<int>::max() ? 1 : 0;
    }
  }
}

void SourceLines::read_levels(std::size_t file, SourcePosition position, std::string_view text)
{
  for (auto comment = level_comment_in(text); comment; comment = level_comment_in(comment->rest)) {
    const auto rule = std::ranges::find(check_rules(), comment->rule, &CheckRule::name);
    const std::optional<RuleLevel> level = rule_level(comment->level.value_or("off"));
    if (rule == check_rules().end()) {
      comment_faults_.push_back({position, fmt::format("there is no rule '{}'", comment->rule)});
    }
    else if (!rule->is_optional) {
      comment_faults_.push_back({position, fmt::format("rule '{}' has no level", comment->rule)});
    }
    else if (!level) {
      comment_faults_.push_back(
          {position, fmt::format("there is no level '{}'; there are off, warning and error", *comment->level)});
    }
    else if (comment->level) {
      levels_[file].insert_or_assign(std::string(comment->rule), *level);
    }
  }
}

std::optional<RuleLevel> SourceLines::level(std::size_t file, std::string_view rule) const
{
  const auto levels = levels_.find(file);
  if (levels == levels_.end()) {
    return std::nullopt;
  }
  const auto found = levels->second.find(rule);
  return found == levels->second.end() ? std::nullopt : std::optional(found->second);
}

bool SourceLines::is_excused(SourcePosition position, std::string_view rule) const
{
  for (auto comment = level_comment_in(line(position)); comment; comment = level_comment_in(comment->rest)) {
    if (comment->rule == rule && !comment->level) {
      return true;
    }
  }
  return false;
}

std::size_t SourceLines::index_of(SourcePosition position) const
{
  if (by_position_.empty()) {
    for (std::size_t i = 0; i < lines_.size(); i++) {
      by_position_.try_emplace(key_of(lines_[i].position), i);
    }
  }
  const auto found = by_position_.find(key_of(position));
  return found == by_position_.end() ? lines_.size() : found->second;
}

std::string_view SourceLines::line(SourcePosition position) const
{
  const std::size_t index = index_of(position);
  return index == lines_.size() ? std::string_view() : lines_[index].text;
}

std::optional<SourcePosition> SourceLines::find_name(std::string_view name, std::string_view keyword) const
{
  if (by_word_.empty()) {
    for (std::size_t i = 0; i < lines_.size(); i++) {
      const std::string_view code = lines_[i].code;
      for (std::size_t at = 0; at < code.size();) {
        const auto end = std::find_if_not(code.begin() + std::ptrdiff_t(at), code.end(), gpu::is_word_character);
        const std::string_view word = code.substr(at, std::size_t(end - code.begin()) - at);
        if (!word.empty() && (word[0] < '0' || word[0] > '9')) {
          std::vector<std::size_t> &found = by_word_[word];
          if (found.empty() || found.back() != i) {
            found.push_back(i);
          }
        }
        at += std::max<std::size_t>(word.size(), 1);
      }
    }
  }
  const auto found = by_word_.find(name);
  if (found == by_word_.end()) {
    return std::nullopt;
  }
  for (const std::size_t i : found->second) {
    const std::string_view code = lines_[i].code;
    if (find_word(code.substr(0, find_word(code, name)), keyword) != std::string_view::npos) {
      return lines_[i].position;
    }
  }
  return lines_[found->second.front()].position;
}

SourcePosition SourceLines::find_member(SourcePosition owner, std::string_view name) const
{
  for (std::size_t i = index_of(owner); i < lines_.size(); i++) {
    if (find_word(lines_[i].code, name) != std::string_view::npos) {
      return lines_[i].position;
    }
    if (lines_[i].code.find('}') != std::string_view::npos) {
      break;
    }
  }
  return owner;
}

SourcePosition SourceLines::find_declaration(std::string_view name, std::string_view keyword) const
{
  return find_name(name, keyword).value_or(SourcePosition());
}

}  // namespace gnomon::shader_check
