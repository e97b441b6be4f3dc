// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gnomon::shader_check {

/** The place of a SPIR-V instruction in the text of its shader. */
struct SpirvPlace {
  /** File and line of its OpLine. The file has glslang's name. Line 0: the instruction has no OpLine. */
  std::string file;
  int line = 0;
  /** Names of what it declares or reads, the nearest first. */
  std::vector<std::string> names;
  /** If it declares a struct: the names of its members. */
  std::vector<std::string> members;
};

/**
 * \a words: with debug information. \a number: of the instruction, from 1, as SPIRV-Tools counts them; 0: there is none
 * and the place is empty.
 */
[[nodiscard]] SpirvPlace spirv_place(std::span<const std::uint32_t> words, std::size_t number);

}  // namespace gnomon::shader_check
