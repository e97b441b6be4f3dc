// SPDX-License-Identifier: MIT
#include "eevee_frame_text.hh"

#include <fmt/format.h>

namespace gnomon::eevee {

std::string bytes_text(std::uint64_t bytes)
{
  if (bytes < 1024) {
    return fmt::format("{} B", bytes);
  }
  return bytes < std::uint64_t(1) << 20U ? fmt::format("{:.1f} KiB", double(bytes) / 0x1p10)
                                         : fmt::format("{:.1f} MiB", double(bytes) / 0x1p20);
}

std::string seconds_text(double seconds)
{
  if (seconds >= 1.0) {
    return fmt::format("{:.2f} s", seconds);
  }
  return seconds >= 1e-3 ? fmt::format("{:.1f} ms", 1e3 * seconds) : fmt::format("{:.0f} us", 1e6 * seconds);
}

}  // namespace gnomon::eevee
