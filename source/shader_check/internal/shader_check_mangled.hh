// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace gnomon::shader_check {

/**
 * \a text of glslang's linker with the functions in it as GLSL writes them: `foo(vf3;f1[2];` is `foo(vec3, float[2])`.
 * Functions with a type that is not known here stay.
 */
[[nodiscard]] std::string with_plain_functions(std::string_view text);

}  // namespace gnomon::shader_check
