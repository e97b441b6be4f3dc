// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace gnomon::test {

/** Memory that the process has allocated and not freed, MiB; 0: the allocator does not tell, as those of sanitizers. */
inline double allocated_mib()
{
#ifdef __GLIBC__
  const struct mallinfo2 info = mallinfo2();
  return double(info.uordblks + info.hblkhd) / 0x1p20;
#else
  return 0.0;
#endif
}

}  // namespace gnomon::test
