// SPDX-License-Identifier: MIT
#include "gpu_error.hh"

#include <cstdio>
#include <cstdlib>

namespace gnomon::gpu {

void assertion_failed(const char *file, int line, const char *condition, std::string_view message)
{
  fmt::print(stderr, "{}:{}: assertion failed: {}: {}\n", file, line, condition, message);
  std::abort();
}

}  // namespace gnomon::gpu
