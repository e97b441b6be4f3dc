// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string_view>

namespace gnomon::gpu {

/**
 * Bad input or device: the message names the object, the file where there is one, and the reason.
 * What threw is left as it was before the call.
 */
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;

  template <typename... Args>
  explicit Error(fmt::format_string<Args...> format, Args &&...args)
      : std::runtime_error(fmt::format(format, std::forward<Args>(args)...))
  {
  }
};

/** Print \a message and abort. \see GNOMON_ASSERT */
[[noreturn]] void assertion_failed(const char *file, int line, const char *condition, std::string_view message);

}  // namespace gnomon::gpu

/**
 * A contract between programmers. What follows the condition is an fmt format string and the values at fault.
 * Stays on in release builds, so it does not belong in a loop over draws.
 */
#define GNOMON_ASSERT(condition, ...) \
  ((condition) ? void(0) : ::gnomon::gpu::assertion_failed(__FILE__, __LINE__, #condition, fmt::format(__VA_ARGS__)))
