// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace gnomon::cli {

/** Whether messages get to a terminal, where a later line may replace them. */
[[nodiscard]] bool stderr_is_terminal();
/** Name of this machine in its network; "" if it has none. */
[[nodiscard]] std::string host_name();
/** The file of this program. */
[[nodiscard]] std::filesystem::path program_file();
/** Most memory that the process has had so far, bytes. */
[[nodiscard]] std::uint64_t memory_bytes_max();
/**
 * Opens the standard streams that are closed, because the next file would otherwise take the place of one and get what
 * is printed. What is printed to a closed output fails.
 */
void open_standard_streams();

}  // namespace gnomon::cli
