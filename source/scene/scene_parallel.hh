// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

namespace gnomon::scene {

/**
 * Calls \a work once with each index from 0 to count - 1, in any order, on \a thread_count threads (0: one for each
 * processor). An exception from a call stops the work and is rethrown here.
 */
void parallel_for(std::size_t count, unsigned thread_count, const std::function<void(std::size_t index)> &work);

}  // namespace gnomon::scene
