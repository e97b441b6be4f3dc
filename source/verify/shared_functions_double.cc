// SPDX-License-Identifier: MIT
#include "shared_functions.hh"

// From here on `float` is double.
#define SHARED_DOUBLE
#include "shared_function_list.h"

namespace gnomon::verify {

std::span<const CompiledFunction<double>> functions_in_double()
{
  return shared_double::compiled_functions;
}

}  // namespace gnomon::verify
