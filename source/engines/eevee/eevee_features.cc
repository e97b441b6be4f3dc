// SPDX-License-Identifier: MIT
#include "eevee_features.hh"

#include <fmt/format.h>

#include <charconv>

namespace gnomon::eevee {

std::optional<PcfKernel> pcf_kernel_of(std::string_view text)
{
  if (text == "1" || text == "3x3" || text == "5x5") {
    return PcfKernel{.width = text[0] - '0', .taps = 0};
  }
  constexpr std::string_view disk = "disk:";
  if (!text.starts_with(disk)) {
    return std::nullopt;
  }
  int taps = 0;
  const char *end = text.data() + text.size();
  const auto [after, error] = std::from_chars(text.data() + disk.size(), end, taps);
  if (error != std::errc() || after != end || taps < 1 || taps > PcfKernel::taps_max) {
    return std::nullopt;
  }
  return PcfKernel{.width = 0, .taps = taps};
}

std::string text_of(const PcfKernel &kernel)
{
  return kernel.width == 0   ? fmt::format("disk:{}", kernel.taps)
         : kernel.width == 1 ? "1"
                             : fmt::format("{0}x{0}", kernel.width);
}

}  // namespace gnomon::eevee
