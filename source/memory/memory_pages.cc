// SPDX-License-Identifier: MIT
#include "memory_pages.hh"

#ifdef __linux__
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#endif

namespace gnomon::memory {

void prefer_large_pages([[maybe_unused]] const void *begin, [[maybe_unused]] std::size_t byte_count)
{
#ifdef __linux__
  // Two large pages of x86-64: less may hold none.
  constexpr std::size_t byte_count_min = std::size_t(4) << 20U;
  if (byte_count < byte_count_min) {
    return;
  }
  const auto page = std::uintptr_t(sysconf(_SC_PAGESIZE));
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + page - 1) / page * page;
  const std::uintptr_t end = (address + byte_count) / page * page;
  // Fails where the system was built without large pages, which changes nothing.
  static_cast<void>(madvise(reinterpret_cast<void *>(first), end - first, MADV_HUGEPAGE));
#endif
}

}  // namespace gnomon::memory
