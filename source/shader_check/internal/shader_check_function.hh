// SPDX-License-Identifier: MIT
// Mistakes within one function that compilers accept.
#pragma once

#include "shader_check_stage.hh"

class TIntermNode;

namespace gnomon::shader_check {

/** Appends findings of the rules `implicit-conversion`, `unbounded-loop` and `unguarded-math`. */
void check_function(TIntermNode *function, const SourceLines &lines, std::vector<StageFinding> &findings);

}  // namespace gnomon::shader_check
