// SPDX-License-Identifier: MIT
// Helpers to read glslang's tree, whose headers glslang installs before version 14: names, types, and the values that
// expressions read, assign and test.
#pragma once

#include "shader_check_stage.hh"

#include <glslang/MachineIndependent/localintermediate.h>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace gnomon::shader_check {

[[nodiscard]] std::string text_of(const glslang::TString &text);
[[nodiscard]] SourcePosition position_of(const glslang::TSourceLoc &loc, const SourceLines &lines);
[[nodiscard]] DeclaredType declared_type(const glslang::TType &type);

/**
 * The path of a value: the id of its symbol and the indices of its members, `12.3`. Swizzles and constant array indices
 * are left out. Empty if \a node is not such an expression.
 */
[[nodiscard]] std::string access_path(const TIntermNode *node);

/** The paths of all values that an expression reads. */
[[nodiscard]] std::set<std::string> paths_of(TIntermNode *node);

/** The leftmost operand, if it is a symbol; else nullptr. */
[[nodiscard]] const glslang::TIntermSymbol *root_symbol(const TIntermNode *node);

[[nodiscard]] bool is_assignment(glslang::TOperator op);

/** The arguments of a built-in function or of an operator. */
[[nodiscard]] std::vector<glslang::TIntermTyped *> arguments_of(glslang::TIntermTyped *node);

/** EOpNull if \a node is not an operation. */
[[nodiscard]] glslang::TOperator operator_of(const glslang::TIntermTyped *node);

/** The values that a function assigns and that its conditions test. */
class FunctionFacts : public glslang::TIntermTraverser {
 public:
  explicit FunctionFacts(TIntermNode *function);

  /** The expression that is assigned to a local variable, if it is assigned once; otherwise \a node. */
  [[nodiscard]] glslang::TIntermTyped *resolved(glslang::TIntermTyped *node) const;
  /** Whether a condition tests a value that \a node reads, or a value computed from it. */
  [[nodiscard]] bool is_tested(glslang::TIntermTyped *node) const;

  bool visitBinary(glslang::TVisit, glslang::TIntermBinary *binary) override;
  bool visitUnary(glslang::TVisit, glslang::TIntermUnary *unary) override;
  bool visitAggregate(glslang::TVisit, glslang::TIntermAggregate *aggregate) override;
  bool visitSelection(glslang::TVisit, glslang::TIntermSelection *selection) override;
  bool visitLoop(glslang::TVisit, glslang::TIntermLoop *loop) override;

 private:
  struct Value {
    int assignment_count = 0;
    /** nullptr: assigned several times, in parts, or by a call. */
    glslang::TIntermTyped *expression = nullptr;
  };

  void assign(TIntermNode *to, glslang::TIntermTyped *expression);

  /** Values by path. */
  std::map<std::string, Value> values_;
  std::set<std::string> tested_;
};

}  // namespace gnomon::shader_check
