// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
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

/** Reports a failure that another attempt or another machine may not have: no device, or no memory on it. */
struct TransientError : Error {
  using Error::Error;
};

/** Reports that the driver has lost the context. The device and its resources can then only be destroyed. */
struct DeviceLost : TransientError {
  using TransientError::TransientError;
};

/**
 * Reports a violated precondition: an error in the library, or in the program that calls it. The message names the
 * file, the line, the condition and its values. The scene is unchanged and can be saved. The engine, the viewport or
 * the renderer that was called may be destroyed, and new ones be made on the same device.
 */
class InternalError : public std::logic_error {
 public:
  /** \a file: the path of a source file. */
  InternalError(std::string_view file, int line, std::string_view condition, std::string_view message);

  /** Name of the source file, without its folder. */
  [[nodiscard]] const std::string &file() const
  {
    return file_;
  }
  [[nodiscard]] int line() const
  {
    return line_;
  }
  /** The text of the condition that does not hold. */
  [[nodiscard]] const std::string &condition() const
  {
    return condition_;
  }

 private:
  std::string file_;
  int line_;
  std::string condition_;
};

/** \throws InternalError \see GNOMON_ASSERT */
[[noreturn]] void assertion_failed(const char *file, int line, const char *condition, std::string_view message);

}  // namespace gnomon::gpu

/**
 * Throws gnomon::gpu::InternalError if the condition is false. For preconditions that only a programming error can
 * violate; a call in the wrong order, which a host can make, is a gpu::Error that names the missing call. The arguments
 * after the condition are an fmt format string and its values. The check is also compiled in release builds, so do not
 * use it in loops over draws. Do not use it in destructors and in functions that are noexcept, which would end the
 * program.
 */
#define GNOMON_ASSERT(condition, ...) \
  ((condition) ? void(0) : ::gnomon::gpu::assertion_failed(__FILE__, __LINE__, #condition, fmt::format(__VA_ARGS__)))
