// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

namespace gnomon::reference {

/**
 * Call \a work with 0 to count - 1, each once, on \a thread_count threads (0: one a processor), in no order. What one
 * of the calls throws ends the work and is thrown here.
 */
void parallel_for(std::size_t count, unsigned thread_count, const std::function<void(std::size_t index)> &work);

}  // namespace gnomon::reference
