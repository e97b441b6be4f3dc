// SPDX-License-Identifier: MIT
#include "shader_check_mangled.hh"

#include "gpu_shader_text.hh"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <span>
#include <utility>

namespace gnomon::shader_check {

namespace {

struct Word {
  std::string_view mark;
  std::string_view text;
};

/** Takes the first of \a words whose mark follows. \return nullptr: none does */
const Word *take_word(gpu::TextScanner &scanner, std::span<const Word> words)
{
  for (const Word &word : words) {
    if (scanner.take(word.mark)) {
      return &word;
    }
  }
  return nullptr;
}

// Longer marks first, as a shorter one may begin them.
constexpr std::array<Word, 15> scalars = {{{"f16", "float16_t"},
                                           {"i8", "int8_t"},
                                           {"u8", "uint8_t"},
                                           {"i16", "int16_t"},
                                           {"u16", "uint16_t"},
                                           {"i64", "int64_t"},
                                           {"u64", "uint64_t"},
                                           {"au", "atomic_uint"},
                                           {"as", "accelerationStructureEXT"},
                                           {"rq", "rayQueryEXT"},
                                           {"f", "float"},
                                           {"i", "int"},
                                           {"u", "uint"},
                                           {"b", "bool"},
                                           {"d", "double"}}};
/** How the names of vectors and matrices begin. */
constexpr std::array<Word, 12> vectors = {{{"f16", "f16"},
                                           {"i8", "i8"},
                                           {"u8", "u8"},
                                           {"i16", "i16"},
                                           {"u16", "u16"},
                                           {"i64", "i64"},
                                           {"u64", "u64"},
                                           {"f", ""},
                                           {"i", "i"},
                                           {"u", "u"},
                                           {"b", "b"},
                                           {"d", "d"}}};
/** How the names of samplers and images begin. */
constexpr std::array<Word, 5> texels = {{{"f16", "f16"}, {"i64", "i64"}, {"u64", "u64"}, {"i", "i"}, {"u", "u"}}};
constexpr std::array<Word, 3> opaque = {{{"I", "image"}, {"t", "texture"}, {"s", "sampler"}}};
constexpr std::array<Word, 7> shapes = {
    {{"1", "1D"}, {"2", "2D"}, {"3", "3D"}, {"C", "Cube"}, {"R2", "2DRect"}, {"B", "Buffer"}, {"P", "subpass"}}};

std::optional<std::string> take_type(gpu::TextScanner &scanner);

/** A number of one digit, such as that of a vector's components; 0: there is none. */
char take_digit(gpu::TextScanner &scanner)
{
  const std::string_view rest = scanner.rest();
  const char digit = rest.empty() ? '\0' : rest.front();
  return digit >= '1' && digit <= '4' && scanner.take(rest.substr(0, 1)) ? digit : '\0';
}

/** `struct-NAME` and the types of its members behind `-`. */
std::optional<std::string> take_struct(gpu::TextScanner &scanner)
{
  const std::string name(scanner.take_word());
  while (scanner.take("-")) {
    if (!take_type(scanner)) {
      return std::nullopt;
    }
  }
  return name;
}

/** A sampler, texture or image. \return empty: another type follows, and nothing is taken */
std::optional<std::string> take_opaque(gpu::TextScanner &scanner)
{
  gpu::TextScanner ahead = scanner;
  if (ahead.take("p")) {
    const bool is_shadow = ahead.take("S");
    ahead.take("1");
    scanner = ahead;
    return is_shadow ? "samplerShadow" : "sampler";
  }
  const Word *texel = take_word(ahead, texels);
  const Word *kind = take_word(ahead, opaque);
  const bool is_array = kind != nullptr && ahead.take("A");
  const bool is_shadow = kind != nullptr && ahead.take("S");
  const Word *shape = kind == nullptr ? nullptr : take_word(ahead, shapes);
  if (shape == nullptr) {
    return std::nullopt;
  }
  const bool has_samples = ahead.take("M");
  scanner = ahead;
  const std::string name = shape->mark == "P" ? "subpassInput" : std::string(kind->text) + std::string(shape->text);
  return fmt::format("{}{}{}{}{}", texel == nullptr ? "" : texel->text, name, has_samples ? "MS" : "",
                     is_array ? "Array" : "", is_shadow ? "Shadow" : "");
}

/** A type without its arrays. */
std::optional<std::string> take_element(gpu::TextScanner &scanner)
{
  const bool is_matrix = scanner.take("m");
  if (is_matrix || scanner.take("v")) {
    const Word *start = take_word(scanner, vectors);
    const char count = take_digit(scanner);
    const char rows = is_matrix ? take_digit(scanner) : count;
    if (start == nullptr || count == '\0' || rows == '\0') {
      return std::nullopt;
    }
    return !is_matrix      ? fmt::format("{}vec{}", start->text, count)
           : count == rows ? fmt::format("{}mat{}", start->text, count)
                           : fmt::format("{}mat{}x{}", start->text, count, rows);
  }
  std::optional<std::string> name = scanner.take("struct-") ? take_struct(scanner) : take_opaque(scanner);
  if (!name) {
    const Word *scalar = take_word(scanner, scalars);
    name = scalar == nullptr ? std::nullopt : std::optional<std::string>(scalar->text);
  }
  // The one component.
  return name && scanner.take("1") ? name : std::nullopt;
}

std::optional<std::string> take_type(gpu::TextScanner &scanner)
{
  std::optional<std::string> name = take_element(scanner);
  while (name && scanner.take("[")) {
    const std::string_view size = scanner.rest().substr(0, scanner.rest().find(']'));
    scanner.take(size);
    scanner.take("]");
    // An array without a size has 0. The size of one by a specialisation constant is no number.
    const bool is_number = size != "0" && size.find_first_not_of("0123456789") == std::string_view::npos;
    *name += fmt::format("[{}]", is_number ? size : "");
  }
  return name;
}

/** The parameters behind `(`, of which each ends with `;`. */
std::optional<std::string> take_parameters(gpu::TextScanner &scanner)
{
  std::string list;
  while (!scanner.rest().empty() && !scanner.rest().starts_with(' ') && !scanner.rest().starts_with('\n')) {
    const std::optional<std::string> type = take_type(scanner);
    if (!type || !scanner.take(";")) {
      return std::nullopt;
    }
    list += (list.empty() ? "" : ", ") + *type;
  }
  return list;
}

}  // namespace

std::string with_plain_functions(std::string_view text)
{
  std::string result;
  while (!text.empty()) {
    gpu::TextScanner scanner(text);
    const std::string_view name = scanner.take_word();
    if (!name.empty() && scanner.take("(")) {
      if (const std::optional<std::string> parameters = take_parameters(scanner)) {
        result += fmt::format("{}({})", name, *parameters);
        text = scanner.rest();
        continue;
      }
    }
    const std::size_t size = name.empty() ? 1 : name.size();
    result += text.substr(0, size);
    text.remove_prefix(size);
  }
  return result;
}

}  // namespace gnomon::shader_check
