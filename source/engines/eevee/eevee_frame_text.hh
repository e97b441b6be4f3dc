// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

/** Numbers of a frame's report as text. */
namespace gnomon::eevee {

/** For example "5.9 MiB"; below 1 KiB in bytes. */
[[nodiscard]] std::string bytes_text(std::uint64_t bytes);

/** For example "12.3 ms"; in µs, ms or s. */
[[nodiscard]] std::string seconds_text(double seconds);

}  // namespace gnomon::eevee
