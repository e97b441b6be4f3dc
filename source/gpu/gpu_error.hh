// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string_view>

namespace gnomon::gpu {

/**
 * Bad input or device. The message names the object, the file where there is one, and the reason.
 * The object whose function throws is left as it was before the call, unless the function documents otherwise.
 */
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;

  template <typename... Args>
  explicit Error(fmt::format_string<Args...> format, Args &&...args)
      : std::runtime_error(fmt::format(format, std::forward<Args>(args)...))
  {
  }
};

/** The driver reports that the context is lost. The device and its resources can only be destroyed. */
struct DeviceLost : Error {
  using Error::Error;
};

/** Print \a message and abort. \see GNOMON_ASSERT */
[[noreturn]] void assertion_failed(const char *file, int line, const char *condition, std::string_view message);

}  // namespace gnomon::gpu

/**
 * Checks a contract between programmers. The condition is followed by an fmt format string and its values.
 * The check remains in release builds, so it must not be used in a loop over draws.
 */
#define GNOMON_ASSERT(condition, ...) \
  ((condition) ? void(0) : ::gnomon::gpu::assertion_failed(__FILE__, __LINE__, #condition, fmt::format(__VA_ARGS__)))
