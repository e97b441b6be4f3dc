// SPDX-License-Identifier: MIT
#include "gpu_shader_macros.hh"

#include "gpu_shader_text.hh"

#include <algorithm>

namespace gnomon::gpu {

Truth negation(Truth a)
{
  return a == Truth::Yes ? Truth::No : a == Truth::No ? Truth::Yes : Truth::Unknown;
}

Truth conjunction(Truth a, Truth b)
{
  return std::min(a, b);
}

Truth disjunction(Truth a, Truth b)
{
  return std::max(a, b);
}

namespace {

/** A condition of `defined`, `!`, `&&`, `||` and parentheses. */
class Condition {
 public:
  Condition(std::string_view text, const ShaderMacros &macros) : scanner_(text), macros_(macros) {}

  Truth truth()
  {
    const Truth truth = any_of_terms(0);
    return is_known_form_ && scanner_.is_at_end() ? truth : Truth::Unknown;
  }

 private:
  /** Bounds the recursion. */
  static constexpr int depth_max = 32;

  bool take(std::string_view text)
  {
    return scanner_.skip_space().take(text);
  }

  Truth any_of_terms(int depth)
  {
    Truth truth = all_of_factors(depth);
    while (is_known_form_ && take("||")) {
      truth = disjunction(truth, all_of_factors(depth));
    }
    return truth;
  }

  Truth all_of_factors(int depth)
  {
    Truth truth = factor(depth);
    while (is_known_form_ && take("&&")) {
      truth = conjunction(truth, factor(depth));
    }
    return truth;
  }

  Truth factor(int depth)
  {
    if (depth < depth_max && take("!")) {
      return negation(factor(depth + 1));
    }
    if (depth < depth_max && take("(")) {
      const Truth truth = any_of_terms(depth + 1);
      is_known_form_ &= take(")");
      return truth;
    }
    if (scanner_.skip_space().take_word() == "defined") {
      const bool has_parenthesis = take("(");
      const std::string_view name = scanner_.skip_space().take_word();
      is_known_form_ &= !name.empty() && (!has_parenthesis || take(")"));
      return macros_.is_defined(name);
    }
    is_known_form_ = false;
    return Truth::Unknown;
  }

  TextScanner scanner_;
  const ShaderMacros &macros_;
  bool is_known_form_ = true;
};

}  // namespace

void ShaderMacros::set_defined(std::string_view name, Truth is_defined, Truth is_reached)
{
  are_all_unknown_ |= name.empty();
  const Truth before = this->is_defined(name);
  if (is_reached == Truth::Yes || (is_reached == Truth::Unknown && before != is_defined)) {
    defined_.insert_or_assign(std::string(name), is_reached == Truth::Yes ? is_defined : Truth::Unknown);
  }
}

Truth ShaderMacros::is_defined(std::string_view name) const
{
  if (are_all_unknown_) {
    return Truth::Unknown;
  }
  if (const auto found = defined_.find(name); found != defined_.end()) {
    return found->second;
  }
  // Names of extensions and of the API, and others that GLSL reserves. C++ alone has __cplusplus.
  const bool is_compilers = name.starts_with("GL_") || name == "VULKAN" ||
                            (name.find("__") != std::string_view::npos && name != "__cplusplus");
  return is_compilers ? Truth::Unknown : Truth::No;
}

Truth ShaderMacros::holds(std::string_view directive, std::string_view condition) const
{
  if (directive == "if" || directive == "elif") {
    return Condition(condition, *this).truth();
  }
  TextScanner scanner(condition);
  const std::string_view name = scanner.skip_space().take_word();
  if (name.empty() || !scanner.is_at_end()) {
    return Truth::Unknown;
  }
  return directive == "ifdef" ? is_defined(name) : negation(is_defined(name));
}

}  // namespace gnomon::gpu
