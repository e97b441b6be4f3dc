// SPDX-License-Identifier: MIT
#pragma once

#include "shader_check.hh"

#include <glslang/Public/ShaderLang.h>

#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <string_view>
#include <unordered_map>

namespace gnomon::shader_check {

/** A place in a source. */
struct SourcePosition {
  /** Index in StageSource::files. */
  std::size_t file = 0;
  /** From 1; 0: none, as a `#line` has made it negative. */
  int line = 1;
  /** From 1; 0: unknown. */
  int column = 0;
};

/** Begins glslang's names of our files, of which the index follows. No name that a user writes in `#line` begins so. */
inline constexpr char name_mark = '\x02';

/** The index in StageSource::files of a name that begins with the mark; empty for other names. */
[[nodiscard]] std::optional<std::size_t> file_named(std::string_view name);

/** Offset of the first whole word \a word in \a text at or after \a from; npos if there is none. */
[[nodiscard]] std::size_t find_word(std::string_view text, std::string_view word, std::size_t from = 0);

/**
 * \a line without comments. \a is_in_comment: whether the line begins within a comment; on return, whether it ends
 * within one.
 */
[[nodiscard]] std::string without_comments(std::string_view line, bool &is_in_comment);

/** \a text without the byte-order mark (U+FEFF in UTF-8) at its begin. */
[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text);

/** A file and its name. */
struct FoundFile {
  std::string path;
  std::string_view text;
};

/**
 * The file at \a path, as the system finds it: behind a link to a folder, `..` is not the folder before it in the path.
 * Its name is the shortest one for the same text.
 */
[[nodiscard]] std::optional<FoundFile> find_file(const std::filesystem::path &path, const gpu::ShaderFiles &files);

/** The content of `#version`. */
struct Version {
  int number = 0;
  /** Empty if there is none. */
  std::string_view profile;
  /** Line of the directive, from 1. */
  int line = 1;

  [[nodiscard]] bool is_es() const
  {
    return profile == "es" || number == 100 || number == 300 || number == 310 || number == 320;
  }
};

/** The first `#version` outside of comments; empty if there is none or it has no number. */
[[nodiscard]] std::optional<Version> version_in(std::string_view text);

/**
 * The macro of an include guard: the file has nothing outside of `#ifndef NAME`, `#define NAME` … `#endif`. Empty if it
 * has none.
 */
[[nodiscard]] std::string_view include_guard_of(std::string_view text);

/** The content of `#line`. */
struct LineDirective {
  int line = 1;
  /** A name, or a number; empty: the file stays. */
  std::string file;
};

/** The message about a stage that is longer than stage_bytes_max. */
[[nodiscard]] std::string too_long_text();

/** The text of one stage as glslang gets it, the files that it consists of, and their names in messages. */
class StageSource {
 public:
  /** A stage whose includes gpu::preprocess() has put in place. Its `#line` directives number its files. */
  explicit StageSource(gpu::ShaderSource source);
  /**
   * The file \a path with \a text. glslang asks for its includes: of `"NAME"` beside the including file and then in \a
   * folders, of `<NAME>` in \a folders only. \a files must outlive the object.
   */
  StageSource(Stage stage, std::string path, std::string_view text, const std::vector<std::string> &defines,
              const gpu::ShaderFiles &files, std::span<const std::string> folders);
  ~StageSource();
  StageSource(StageSource &&other) = delete;

  [[nodiscard]] Stage stage() const
  {
    return stage_;
  }
  [[nodiscard]] const std::string &text() const
  {
    return text_;
  }
  /** Precedes the text, and has no lines in messages. */
  [[nodiscard]] const std::string &preamble() const
  {
    return preamble_;
  }
  /** The name of the text for glslang; empty if its files have numbers. */
  [[nodiscard]] const std::string &name() const
  {
    return name_;
  }
  /** For one reading of the stage; nullptr: the text has its includes. */
  [[nodiscard]] glslang::TShader::Includer *start_includer();

  /** Names of files: those that were read and those that `#line` names. */
  [[nodiscard]] const std::vector<std::string> &files() const
  {
    return files_;
  }
  /** Files that were read, with their indices in files(), in the order of their first inclusion. */
  struct File {
    std::size_t index;
    std::string_view text;
  };
  [[nodiscard]] const std::vector<File> &texts() const
  {
    return texts_;
  }
  /** Indices in files() of files that begin with a byte-order mark. Their texts here are without it. */
  [[nodiscard]] const std::vector<std::size_t> &marked() const
  {
    return marked_;
  }
  /** Paths at which an include was sought and not found. */
  [[nodiscard]] const std::vector<std::string> &absent() const
  {
    return absent_;
  }

  /** \a name: as glslang prints it. */
  [[nodiscard]] SourcePosition position(std::string_view name, int line, int column);
  /** The index in files() of \a path, which is added if it is new. */
  [[nodiscard]] std::size_t file_of(std::string_view path);
  /** Notes that `#line LINE NUMBER` in \a file gives it a number. The first file of a number keeps it in messages. */
  void note_number(std::string_view number, std::size_t file)
  {
    numbers_.try_emplace(std::string(number), file);
  }
  /** Whether a file that was read has a `#line`, and whether it is taken is for glslang to say. */
  [[nodiscard]] bool has_line_directives() const;
  /** Notes each `#line` that glslang takes, with its values. \a preprocessed: the output of its preprocessor. */
  void note_line_directives(std::string_view preprocessed, CheckTarget target);
  /** The noted `#line` at a line of a file that was read; empty: glslang does not take it. */
  [[nodiscard]] std::optional<LineDirective> line_directive_at(std::size_t file, int line) const
  {
    const auto found = directives_.find({file, line});
    return found == directives_.end() ? std::nullopt : std::optional(found->second);
  }
  /** Whether `#line N` numbers the next line, as in GLSL ES and from version 3.30 on, and not its own. */
  [[nodiscard]] bool line_sets_next(CheckTarget target) const;
  /** Whether a file may be included several times, so that its number is that of no string of glslang's. */
  [[nodiscard]] bool has_includer() const
  {
    return includer_ != nullptr;
  }

 private:
  class Includer;

  /** \a text without a byte-order mark, which it notes. */
  std::string_view unmarked(std::size_t file, std::string_view text);

  Stage stage_;
  std::string text_;
  std::string preamble_;
  std::string name_;
  std::vector<std::string> files_;
  std::unordered_map<std::string, std::size_t> indices_;
  /** Files by the numbers that `#line` gives them. */
  std::unordered_map<std::string, std::size_t> numbers_;
  std::map<std::pair<std::size_t, int>, LineDirective> directives_;
  std::vector<File> texts_;
  std::vector<std::size_t> marked_;
  std::vector<std::string> absent_;
  std::unique_ptr<Includer> includer_;
};

/** The lines of a stage and its includes, with their files. */
class SourceLines {
 public:
  explicit SourceLines(StageSource &source) : source_(source) {}
  // Lines refer to codes_, which keeps its strings in a move.
  SourceLines(const SourceLines &) = delete;
  SourceLines(SourceLines &&) = default;

  /** Call it before other functions, and once glslang has read the includes. */
  void read(CheckTarget target);

  /** StageSource::position(). */
  [[nodiscard]] SourcePosition position(std::string_view name, int line, int column) const
  {
    return source_.position(name, line, column);
  }
  /** Whether a comment on the line names \a rule: `// shader-check: RULE, reason`. */
  [[nodiscard]] bool is_excused(SourcePosition position, std::string_view rule) const;
  /** The level that a comment in a file gives to \a rule: `// shader-check: RULE=off`, `=warning` or `=error`. */
  [[nodiscard]] std::optional<RuleLevel> level(std::size_t file, std::string_view rule) const;
  /** A comment that looks as one of those above and is none. */
  struct CommentFault {
    SourcePosition position;
    std::string text;
  };
  [[nodiscard]] const std::vector<CommentFault> &comment_faults() const
  {
    return comment_faults_;
  }
  /** The line as written; empty if there is none. */
  [[nodiscard]] std::string_view line(SourcePosition position) const;
  /** The first line with \a name as a word outside of comments; preferably one where \a keyword precedes it. */
  [[nodiscard]] SourcePosition find_declaration(std::string_view name, std::string_view keyword) const;
  /** The line with \a name as a word in the block or struct that begins at \a owner; \a owner if there is none. */
  [[nodiscard]] SourcePosition find_member(SourcePosition owner, std::string_view name) const;
  /** The same as find_declaration(); empty if no line has \a name. */
  [[nodiscard]] std::optional<SourcePosition> find_name(std::string_view name, std::string_view keyword) const;

 private:
  struct Line {
    SourcePosition position;
    std::string_view text;
    /** Without comments: `text`, or a part of codes_. */
    std::string_view code;
  };

  /** Index in lines_ of the first line at \a position; lines_.size() if there is none. */
  [[nodiscard]] std::size_t index_of(SourcePosition position) const;

  StageSource &source_;
  /** Reads the comments of a line about levels. \a file: the one that they are in, whatever `#line` says. */
  void read_levels(std::size_t file, SourcePosition position, std::string_view text);

  std::vector<Line> lines_;
  std::list<std::string> codes_;
  std::map<std::size_t, RuleLevels> levels_;
  std::vector<CommentFault> comment_faults_;
  /** Indices in lines_ by file and line. Made when the first is sought. */
  mutable std::unordered_map<std::uint64_t, std::size_t> by_position_;
  /** Indices in lines_ by word. Made when the first word is sought. */
  mutable std::unordered_map<std::string_view, std::vector<std::size_t>> by_word_;
};

}  // namespace gnomon::shader_check
