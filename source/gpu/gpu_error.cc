// SPDX-License-Identifier: MIT
#include "gpu_error.hh"

namespace gnomon::gpu {

static std::string_view name_of(std::string_view file)
{
  return file.substr(file.find_last_of('/') + 1);
}

InternalError::InternalError(std::string_view file, int line, std::string_view condition, std::string_view message)
    : std::logic_error(
          fmt::format("internal error at {}:{}: {} does not hold: {}", name_of(file), line, condition, message)),
      file_(name_of(file)),
      line_(line),
      condition_(condition)
{
}

void assertion_failed(const char *file, int line, const char *condition, std::string_view message)
{
  throw InternalError(file, line, condition, message);
}

}  // namespace gnomon::gpu
