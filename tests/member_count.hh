// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <utility>

/** Counts of the members of a type and of its rows (scene_property.hh), so that no member lacks a row. */
namespace gnomon::test {

template <typename T>
constexpr bool is_optional = false;
template <typename T>
constexpr bool is_optional<std::optional<T>> = true;

/** Converts to each type, or to each optional one: an optional can also be made of what converts to its value. */
template <bool IsOptional>
struct AnyValue {
  template <typename T>
  requires(is_optional<T> == IsOptional) constexpr operator T() const
  {
    return T();
  }
};

template <typename T, bool IsOptional, std::size_t... I>
constexpr bool has_members(std::index_sequence<I...> /*indices*/)
{
  return requires
  {
    T{(static_cast<void>(I), AnyValue<IsOptional>())...};
  };
}

/** Number of members of an aggregate. */
template <typename T, bool IsOptional = false, std::size_t Count = 64>
constexpr std::size_t member_count()
{
  if constexpr (has_members<T, IsOptional>(std::make_index_sequence<Count>())) {
    return Count;
  }
  else {
    return member_count<T, IsOptional, Count - 1>();
  }
}

template <typename T>
constexpr std::size_t row_count()
{
  std::size_t count = 0;
  T::for_each_property([&](const auto & /*row*/) { count++; });
  return count;
}

}  // namespace gnomon::test
