// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace gnomon::gpu {

/** Whether a condition holds. Unknown: it depends on macros that the compiler may define. */
enum class Truth : std::uint8_t { No, Unknown, Yes };

[[nodiscard]] Truth negation(Truth a);
[[nodiscard]] Truth conjunction(Truth a, Truth b);
[[nodiscard]] Truth disjunction(Truth a, Truth b);

/**
 * The macros that a shader defines, for the conditions of `#if`, `#ifdef`, `#ifndef` and `#elif` that test whether
 * macros are defined. All other conditions are Unknown, as compilers alone know the values of expressions.
 */
class ShaderMacros {
 public:
  /** Follow `#define` or `#undef`, which stands where \a is_reached. An empty \a name may be any. */
  void set_defined(std::string_view name, Truth is_defined, Truth is_reached);
  /** \a directive: `if`, `ifdef`, `ifndef` or `elif`; \a condition: the rest of its line. */
  [[nodiscard]] Truth holds(std::string_view directive, std::string_view condition) const;
  [[nodiscard]] Truth is_defined(std::string_view name) const;

 private:
  std::map<std::string, Truth, std::less<>> defined_;
  bool are_all_unknown_ = false;
};

}  // namespace gnomon::gpu
