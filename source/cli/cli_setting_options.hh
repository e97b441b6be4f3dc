// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_settings.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

/** Options for the rows of settings (scene_property.hh). */
namespace gnomon::cli {

template <typename Value>
inline constexpr bool is_integer = std::is_integral_v<Value> && !std::is_same_v<Value, bool>;

/** The kind of text that an option takes: "INT", "FLOAT" or "TEXT". */
template <typename Value>
inline constexpr const char *type_text = is_integer<Value>                 ? "INT"
                                         : std::is_floating_point_v<Value> ? "FLOAT"
                                                                           : "TEXT";

/** The texts that an option takes for people: words or limits. Empty: any text, or those that the sentence lists. */
template <typename Value>
[[nodiscard]] std::string option_values_text(const scene::Description &row)
{
  std::vector<std::string_view> words;
  if constexpr (std::is_enum_v<Value>) {
    words.assign(scene::words<Value>.begin(), scene::words<Value>.end());
  }
  else if constexpr (std::is_same_v<Value, bool>) {
    words.assign(row.switch_words.begin(), row.switch_words.end());
  }
  else if constexpr (std::is_arithmetic_v<Value>) {
    const scene::ShownLimits limits = scene::shown_limits(row, is_integer<Value>);
    const std::string_view unit = scene::shown_unit(row).text;
    return fmt::format("in [{:.10g} - {:.10g}]", limits.min, limits.max) + (unit.empty() ? "" : " ") +
           std::string(unit) + (row.zero.empty() || row.min <= 0.0 ? "" : ", or 0") +
           (row.automatic.empty() ? "" : ", or ") + std::string(row.automatic);
  }
  if (!row.automatic.empty()) {
    words.push_back(row.automatic);
  }
  return words.empty() ? "" : fmt::format("{{{}}}", fmt::join(words, ","));
}

/** A default as text. An absent one has the row's word for it. */
template <typename Value>
[[nodiscard]] std::string default_text(const scene::Description &row, const Value &value)
{
  if constexpr (requires { value.has_value(); }) {
    return value ? default_text(row, *value) : std::string(row.automatic);
  }
  else {
    const bool is_zero = value == Value() && !row.zero.empty() && row.min > 0.0;
    return is_zero ? std::string(row.zero) : scene::value_text(row, value);
  }
}

/** The value that \a text stands for. Empty: none. */
template <typename Value>
[[nodiscard]] std::optional<Value> parse_value(const scene::Description &row, const std::string &text)
{
  const auto index_in = [&](const auto &words) -> std::optional<Value> {
    const auto found = std::ranges::find(words, text);
    return found == words.end() ? std::nullopt : std::optional(Value(found - words.begin()));
  };
  if constexpr (std::is_enum_v<Value>) {
    return index_in(scene::words<Value>);
  }
  else if constexpr (std::is_same_v<Value, bool>) {
    return index_in(row.switch_words);
  }
  else if constexpr (std::is_same_v<Value, std::string>) {
    return text;
  }
  else if constexpr (std::is_same_v<Value, eevee::PcfKernel>) {
    return eevee::pcf_kernel_of(text);
  }
  else {
    std::conditional_t<is_integer<Value>, std::int64_t, Value> number{};
    const scene::ShownLimits limits = scene::shown_limits(row, is_integer<Value>);
    const auto is_within = [&](auto limit_min, auto limit_max) {
      return (number >= limit_min && number <= limit_max) || (number == 0 && !row.zero.empty());
    };
    using Number = decltype(number);
    // A limit of a float is one of floats, and NaN is in none.
    if (!CLI::detail::lexical_cast(text, number) || !is_within(Number(limits.min), Number(limits.max))) {
      return std::nullopt;
    }
    return Value(double(number) / scene::shown_unit(row).factor);
  }
}

/** The changes of settings of type T by the options that were given. */
template <typename T>
using Changes = std::vector<std::function<void(T &)>>;

/** \a settings with \a changes. */
template <typename T>
[[nodiscard]] T changed(T settings, const Changes<T> &changes)
{
  for (const auto &change : changes) {
    change(settings);
  }
  return settings;
}

/** Settings of type T that pictures have without options, and when they have them: "with one sample". */
template <typename T>
struct Defaults {
  std::string when{};
  T settings{};
};

/**
 * The options of settings of type T. Rows with the same option are set together: a number that is out of the limits of
 * one of them becomes the nearest that is not.
 */
template <typename T>
class SettingOptions {
 public:
  /** \a defaults: the first are those in general. None: the scene has them. */
  explicit SettingOptions(std::vector<Defaults<T>> defaults = {Defaults<T>()}) : defaults_(std::move(defaults)) {}

  /**
   * Takes the rows of a part of T for which \a is_wanted is true for the name of the option. \a part: returns a
   * reference to the part of a T
   */
  template <typename Part, typename Access>
  void take(Access part, const std::function<bool(std::string_view)> &is_wanted = {})
  {
    Part::for_each_property([&](const auto &row) {
      using Value = typename scene::PresentValue<typename std::decay_t<decltype(row)>::Value>::Type;
      if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value> || std::is_same_v<Value, std::string> ||
                    std::is_same_v<Value, eevee::PcfKernel>) {
        if (!row.option.empty() && (!is_wanted || is_wanted(row.option))) {
          take_row<Value>(
              row, [ part, row ](auto &settings) -> auto & { return row.access(part(settings)); });
        }
      }
    });
  }

  /** Adds the options under the header \a group, in the order of their rows. Those that are given add to \a changes. */
  void add_to(CLI::App &command, const std::string &group, Changes<T> &changes) const
  {
    for (const SetTogether &set : sets_) {
      std::string sentences = set.sentences;
      if (!set.default_sentence.empty()) {
        sentences += fmt::format(" (default: {})", set.default_sentence);
      }
      CLI::Option *option = command.add_option_function<std::string>(
          "--" + set.option,
          [set, &changes](const std::string &text) {
            if (text != set.automatic || text.empty()) {
              changes.push_back([set, text](T &settings) {
                for (const auto &apply : set.apply) {
                  apply(text, settings);
                }
              });
            }
          },
          sentences);
      option->group(group)->type_name(set.type)->default_str(set.default_text);
      option->check(CLI::Validator(
          [set](const std::string &text) {
            const bool is_right = (!set.automatic.empty() && text == set.automatic) ||
                                  std::ranges::any_of(set.is_right, [&](const auto &is) { return is(text); });
            return is_right ? std::string()
                            : fmt::format("'{}' is not {}", text, set.values.empty() ? set.sentences : set.values);
          },
          set.values));
    }
  }

 private:
  struct SetTogether {
    std::string option{};
    std::string automatic{};
    std::string type{};
    std::string values{};
    std::string sentences{};
    std::string default_text{};
    std::string default_sentence{};
    std::vector<std::function<bool(const std::string &)>> is_right{};
    std::vector<std::function<void(const std::string &, T &)>> apply{};
    /** The text of each of defaults_. */
    std::vector<std::string> defaults{};
  };

  template <typename Value, typename Access>
  void take_row(const scene::Description &row, Access access)
  {
    auto set = std::ranges::find(sets_, row.option, &SetTogether::option);
    if (set == sets_.end()) {
      sets_.push_back({.option = std::string(row.option),
                       .automatic = std::string(row.automatic),
                       .type = type_text<Value>,
                       .values = option_values_text<Value>(row)});
      set = sets_.end() - 1;
      set->defaults.resize(defaults_.size());
    }
    set->sentences += (set->sentences.empty() ? "" : " ") + std::string(row.sentence);
    set->sentences += row.makes_picture ? "" : " The picture does not depend on it.";
    for (std::size_t i = 0; i < defaults_.size(); i++) {
      set->defaults[i] += (set->defaults[i].empty() ? "" : ", ") + default_text(row, access(defaults_[i].settings));
    }
    set->is_right.push_back([row](const std::string &text) { return parse_value<Value>(row, text).has_value(); });
    set->apply.push_back([row, access](const std::string &text, T &settings) {
      if (const std::optional<Value> value = parse_value<Value>(row, text)) {
        access(settings) = *value;
      }
      else if constexpr (std::is_arithmetic_v<Value>) {
        double number = 0.0;
        static_cast<void>(CLI::detail::lexical_cast(text, number));
        access(settings) = Value(row.nearest(number / scene::shown_unit(row).factor));
      }
    });
    describe_default(*set);
  }

  /** A text that an option may have: its default. Otherwise a sentence for people. */
  void describe_default(SetTogether &set) const
  {
    if (set.defaults.empty()) {
      set.default_sentence = "that of the scene";
      return;
    }
    const bool is_same = std::ranges::all_of(set.defaults, [&](const auto &text) { return text == set.defaults[0]; });
    const bool is_value = set.is_right.size() == 1 && (set.is_right[0](set.defaults[0]) ||
                                                       (!set.automatic.empty() && set.defaults[0] == set.automatic));
    set.default_text = !set.automatic.empty() ? set.automatic : is_same && is_value ? set.defaults[0] : "";
    set.default_sentence = is_same && is_value ? "" : set.defaults[0];
    for (std::size_t i = 1; i < defaults_.size() && !is_same; i++) {
      if (set.defaults[i] != set.defaults[0]) {
        set.default_sentence += fmt::format("; {} {}", defaults_[i].when, set.defaults[i]);
      }
    }
  }

  std::vector<Defaults<T>> defaults_;
  std::vector<SetTogether> sets_;
};

}  // namespace gnomon::cli
