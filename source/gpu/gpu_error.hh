// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string_view>

namespace gnomon::gpu {

/**
 * Reports invalid input or a failure of the device. The message names the object, the file if there is one, and the
 * reason. The object whose function throws is unchanged, unless the function documents otherwise.
 */
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;

  template <typename... Args>
  explicit Error(fmt::format_string<Args...> format, Args &&...args)
      : std::runtime_error(fmt::format(format, std::forward<Args>(args)...))
  {
  }
};

/** Reports that the driver has lost the context. The device and its resources can then only be destroyed. */
struct DeviceLost : Error {
  using Error::Error;
};

/** Print \a message and abort. \see GNOMON_ASSERT */
[[noreturn]] void assertion_failed(const char *file, int line, const char *condition, std::string_view message);

}  // namespace gnomon::gpu

/**
 * Aborts if the condition is false. For preconditions that only a programming error can violate. The arguments after
 * the condition are an fmt format string and its values. The check is also compiled in release builds, so do not use it
 * in loops over draws.
 */
#define GNOMON_ASSERT(condition, ...) \
  ((condition) ? void(0) : ::gnomon::gpu::assertion_failed(__FILE__, __LINE__, #condition, fmt::format(__VA_ARGS__)))
