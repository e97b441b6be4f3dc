// SPDX-License-Identifier: MIT
#include "shared_functions.hh"

// Must follow the headers above.
#include "shared_function_list.h"

namespace gnomon::verify {

std::span<const CompiledFunction<float>> functions_in_float()
{
  return shared::compiled_functions;
}

}  // namespace gnomon::verify
