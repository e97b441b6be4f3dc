// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace gnomon::memory {

/**
 * Advises the system to back memory that is not written yet with large pages, so that large arrays cause few page
 * faults. The content does not change. Without effect below 4 MiB, and on systems that have no such advice.
 */
void prefer_large_pages(const void *begin, std::size_t byte_count);

}  // namespace gnomon::memory
