// SPDX-License-Identifier: MIT
#include "shader_check_function.hh"

#include "gpu_shader_text.hh"
#include "shader_check_tree.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

namespace gnomon::shader_check {

using glslang::TIntermAggregate;
using glslang::TIntermBinary;
using glslang::TIntermLoop;
using glslang::TIntermSelection;
using glslang::TIntermSymbol;
using glslang::TIntermTraverser;
using glslang::TIntermTyped;
using glslang::TIntermUnary;
using glslang::TOperator;
using glslang::TVisit;

namespace {

/** Whether the outermost function of an expression limits it to [0, 1]. */
bool is_share(const TIntermTyped *node)
{
  switch (operator_of(node)) {
    case glslang::EOpClamp:
    case glslang::EOpFract:
    case glslang::EOpSmoothStep:
    case glslang::EOpStep: return true;
    case glslang::EOpMul:
      return is_share(node->getAsBinaryNode()->getLeft()) && is_share(node->getAsBinaryNode()->getRight());
    default: return false;
  }
}

/** `1 - x` with x in [0, 1]. */
bool is_rest_of_one(const FunctionFacts &facts, TIntermTyped *node)
{
  const auto *binary = node->getAsBinaryNode();
  return binary != nullptr && binary->getOp() == glslang::EOpSub &&
         binary->getLeft()->getAsConstantUnion() != nullptr && is_share(facts.resolved(binary->getRight()));
}

/** An operation on a value: a minus, or one with a constant. */
struct BoundStep {
  TOperator op;
  double constant;
};

/** A value, and the operations on it, the last one first. */
struct BoundValue {
  TIntermTyped *value;
  std::vector<BoundStep> steps;
};

/**
 * The value that \a node is computed from without leaving a side of [-1, 1]: by a minus, a constant factor of at least
 * 1, or one bound. With two bounds, as of `min(max(x, -1.0), 1.0)`, the inner one is returned.
 */
BoundValue without_one_bound(const FunctionFacts &facts, TIntermTyped *node)
{
  const auto is_constant = [](TIntermTyped *one) { return one->getAsConstantUnion() != nullptr; };
  const auto constant = [](TIntermTyped *one) { return one->getAsConstantUnion()->getConstArray()[0].getDConst(); };
  const auto keeps_size = [&](TIntermTyped *one) { return is_constant(one) && std::abs(constant(one)) >= 1.0; };
  bool has_bound = false;
  std::vector<BoundStep> steps;
  // A global variable may be computed from itself: `x = -x`.
  std::set<TIntermTyped *> seen;
  for (node = facts.resolved(node); seen.insert(node).second; node = facts.resolved(node)) {
    const TOperator op = operator_of(node);
    const std::vector<TIntermTyped *> parts = arguments_of(node);
    const bool is_bound = (op == glslang::EOpMax || op == glslang::EOpMin) && !has_bound;
    if (op == glslang::EOpNegative) {
      steps.push_back({op, -1.0});
      node = parts[0];
    }
    else if ((is_bound && is_constant(parts[0]) != is_constant(parts[1])) ||
             (op == glslang::EOpMul && (keeps_size(parts[0]) || keeps_size(parts[1])))) {
      const bool is_first = is_constant(parts[0]);
      steps.push_back({op, constant(parts[is_first ? 0 : 1])});
      node = parts[is_first ? 1 : 0];
      has_bound |= is_bound;
    }
    else {
      break;
    }
  }
  return {node, std::move(steps)};
}

/** Whether the steps lead from each value that is 0 or more into [-1, 1]. */
bool bound_square(const std::vector<BoundStep> &steps)
{
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const double constant = step->constant;
    switch (step->op) {
      case glslang::EOpMin:
        low = std::min(low, constant);
        high = std::min(high, constant);
        break;
      case glslang::EOpMax:
        low = std::max(low, constant);
        high = std::max(high, constant);
        break;
      default:
        low *= constant;
        high *= constant;
        if (constant < 0.0) {
          std::swap(low, high);
        }
        break;
    }
  }
  return low >= -1.0 && high <= 1.0;
}

/** The reason for which \a op may fail for \a argument, as far as the expression shows it; otherwise empty. */
std::string danger(const FunctionFacts &facts, TOperator op, TIntermTyped *argument)
{
  const bool is_arc = op == glslang::EOpAcos || op == glslang::EOpAsin;
  const BoundValue bound = is_arc ? without_one_bound(facts, argument) : BoundValue{facts.resolved(argument), {}};
  TIntermTyped *value = bound.value;
  const TOperator source = operator_of(value);
  const bool is_difference = source == glslang::EOpSub;
  const bool is_dot = source == glslang::EOpDot;
  bool is_square = false;
  if (is_dot) {
    const std::vector<TIntermTyped *> factors = arguments_of(value);
    const std::string path = access_path(factors[0]);
    is_square = !path.empty() && path == access_path(factors[1]);
  }
  const bool is_length = source == glslang::EOpLength || source == glslang::EOpDistance;
  switch (op) {
    case glslang::EOpAcos:
    case glslang::EOpAsin:
      return is_dot && !(is_square && bound_square(bound.steps)) ? "by rounding a scalar product may lie beyond [-1, 1]"
                                                                 : "";
    case glslang::EOpSqrt:
    case glslang::EOpPow:
      return (is_difference && !is_rest_of_one(facts, value)) || (is_dot && !is_square) ? "it may be below 0" : "";
    case glslang::EOpInverseSqrt:
    case glslang::EOpLog:
    case glslang::EOpLog2: return is_difference || is_dot || is_length ? "it may be 0 or below" : "";
    case glslang::EOpNormalize: return is_difference || source == glslang::EOpCross ? "it may be the zero vector" : "";
    case glslang::EOpDiv:
    case glslang::EOpDivAssign: return is_difference || is_dot || is_length ? "it may be 0" : "";
    default: return {};
  }
}

std::string_view operator_name(TOperator op)
{
  switch (op) {
    case glslang::EOpAcos: return "acos of";
    case glslang::EOpAsin: return "asin of";
    case glslang::EOpSqrt: return "sqrt of";
    case glslang::EOpPow: return "pow of";
    case glslang::EOpInverseSqrt: return "inversesqrt of";
    case glslang::EOpLog: return "log of";
    case glslang::EOpLog2: return "log2 of";
    case glslang::EOpNormalize: return "normalize of";
    default: return "division by";
  }
}

/** Whether \a op may return another value each time. */
bool is_call(TOperator op)
{
  return op == glslang::EOpFunctionCall || op == glslang::EOpRayQueryProceed ||
         (op >= glslang::EOpAtomicAdd && op <= glslang::EOpAtomicCounterCompSwap) ||
         (op >= glslang::EOpImageAtomicAdd && op <= glslang::EOpImageAtomicStore);
}

/** Whether an expression has a call, or a step such as `i--`. */
class Calls : public TIntermTraverser {
 public:
  bool is_any = false;

  bool visitUnary(TVisit, TIntermUnary *unary) override
  {
    return note(unary->getOp());
  }
  bool visitBinary(TVisit, TIntermBinary *binary) override
  {
    return note(binary->getOp());
  }
  bool visitAggregate(TVisit, TIntermAggregate *aggregate) override
  {
    return note(aggregate->getOp());
  }

 private:
  bool note(TOperator op)
  {
    is_any |= is_call(op) || is_assignment(op);
    return !is_any;
  }
};

/**
 * Values that a loop steps: by `++`, `+=`, a function's parameter or an assignment that reads the value itself
 * (`i = i + 1`, also by way of others), and values that are computed from stepped ones.
 */
class LoopSteps : public TIntermTraverser {
 public:
  explicit LoopSteps(TIntermLoop *loop)
  {
    for (TIntermNode *part : {loop->getBody(), static_cast<TIntermNode *>(loop->getTerminal())}) {
      if (part != nullptr) {
        part->traverse(this);
      }
    }
    add_cycles();
    // Each new one makes those stepped that are computed from it.
    std::vector<std::string> open(stepped_.begin(), stepped_.end());
    while (!open.empty()) {
      const std::string value = std::move(open.back());
      open.pop_back();
      for (const std::string &target : readers_[value]) {
        if (stepped_.insert(target).second) {
          open.push_back(target);
        }
      }
    }
  }
  bool visitUnary(TVisit, TIntermUnary *unary) override
  {
    if (is_assignment(unary->getOp())) {
      stepped_.insert(access_path(unary->getOperand()));
    }
    return true;
  }
  bool visitBinary(TVisit, TIntermBinary *binary) override
  {
    const std::string target = is_assignment(binary->getOp()) ? access_path(binary->getLeft()) : std::string();
    if (target.empty()) {
      return true;
    }
    if (binary->getOp() != glslang::EOpAssign) {
      stepped_.insert(target);
      return true;
    }
    for (const std::string &read : paths_of(binary->getRight())) {
      readers_[read].insert(target);
      if (is_arithmetic(binary->getRight())) {
        arithmetic_[target].insert(read);
      }
    }
    return true;
  }
  bool visitAggregate(TVisit, TIntermAggregate *aggregate) override
  {
    const auto &qualifiers = aggregate->getQualifierList();
    for (std::size_t i = 0; i < qualifiers.size() && i < aggregate->getSequence().size(); i++) {
      if (qualifiers[i] == glslang::EvqOut || qualifiers[i] == glslang::EvqInOut) {
        stepped_.insert(access_path(aggregate->getSequence()[i]));
      }
    }
    return true;
  }
  /** Whether \a test changes from one turn to the next. */
  bool bound(TIntermTyped *test) const
  {
    if (test == nullptr) {
      return false;
    }
    if (const auto *constant = test->getAsConstantUnion()) {
      return !constant->getConstArray()[0].getBConst();
    }
    const auto is_bound = [&](TIntermTyped *side) { return bound(side); };
    switch (operator_of(test)) {
      case glslang::EOpLogicalAnd: return std::ranges::any_of(arguments_of(test), is_bound);
      case glslang::EOpLogicalOr: return std::ranges::all_of(arguments_of(test), is_bound);
      default: break;
    }
    Calls calls;
    test->traverse(&calls);
    return calls.is_any ||
           std::ranges::any_of(paths_of(test), [&](const std::string &read) { return stepped_.contains(read); });
  }

 private:
  /** Whether \a node is made by operators and not by a built-in function, which may have a limit: `e = fract(e)`. */
  static bool is_arithmetic(TIntermTyped *node)
  {
    const TOperator op = operator_of(node);
    return node->getAsBinaryNode() != nullptr || node->getAsSymbolNode() != nullptr ||
           node->getAsSelectionNode() != nullptr || is_call(op) || op == glslang::EOpNegative ||
           op == glslang::EOpLogicalNot || op == glslang::EOpBitwiseNot ||
           (op > glslang::EOpConstructGuardStart && op < glslang::EOpConstructGuardEnd) ||
           (op >= glslang::EOpConvInt8ToBool && op <= glslang::EOpConvDoubleToFloat);
  }
  /** Adds the values that are computed from themselves, by Kahn's algorithm. */
  void add_cycles()
  {
    std::map<std::string, std::size_t> open_reads;
    std::vector<std::string> done;
    for (const auto &[target, reads] : arithmetic_) {
      const auto count =
          std::ranges::count_if(reads, [&](const std::string &read) { return arithmetic_.contains(read); });
      open_reads[target] = std::size_t(count);
      if (count == 0) {
        done.push_back(target);
      }
    }
    while (!done.empty()) {
      const std::string value = std::move(done.back());
      done.pop_back();
      open_reads.erase(value);
      for (const std::string &target : readers_[value]) {
        const auto reader = open_reads.find(target);
        if (reader != open_reads.end() && arithmetic_[target].contains(value) && --reader->second == 0) {
          done.push_back(target);
        }
      }
    }
    for (const auto &[target, count] : open_reads) {
      stepped_.insert(target);
    }
  }

  std::set<std::string> stepped_;
  /** The values that an assignment by arithmetic reads, by the value that it sets. */
  std::map<std::string, std::set<std::string>> arithmetic_;
  /** The values that assignments compute from a value, by that value. */
  std::map<std::string, std::set<std::string>> readers_;
};

/** Whether a loop has a break, return or discard that is reached under no condition, or under one that changes. */
class LoopExits : public TIntermTraverser {
 public:
  bool is_any = false;

  LoopExits(TIntermLoop *loop, const LoopSteps &steps) : steps_(steps)
  {
    if (loop->getBody() != nullptr) {
      loop->getBody()->traverse(this);
    }
  }
  bool visitSelection(TVisit, TIntermSelection *selection) override
  {
    within(selection->getCondition(), false, {selection->getTrueBlock(), selection->getFalseBlock()});
    return false;
  }
  bool visitSwitch(TVisit, glslang::TIntermSwitch *choice) override
  {
    within(choice->getCondition()->getAsTyped(), true, {choice->getBody()});
    return false;
  }
  bool visitLoop(TVisit, TIntermLoop *loop) override
  {
    within(loop->getTest(), true, {loop->getBody()});
    return false;
  }
  bool visitBranch(TVisit, glslang::TIntermBranch *branch) override
  {
    const bool is_continue = branch->getFlowOp() == glslang::EOpContinue || branch->getFlowOp() == glslang::EOpCase ||
                             branch->getFlowOp() == glslang::EOpDefault;
    const bool is_inner_break = branch->getFlowOp() == glslang::EOpBreak && inner_count_ > 0;
    is_any |= !is_continue && !is_inner_break && (condition_count_ == 0 || bound_count_ > 0);
    return true;
  }

 private:
  /** \a takes_breaks: a break within \a parts leaves them and not the loop. */
  void within(TIntermTyped *condition, bool takes_breaks, std::initializer_list<TIntermNode *> parts)
  {
    const int is_condition = condition == nullptr ? 0 : 1;
    const int is_bound = steps_.bound(condition) ? 1 : 0;
    const int is_inner = takes_breaks ? 1 : 0;
    condition_count_ += is_condition;
    bound_count_ += is_bound;
    inner_count_ += is_inner;
    for (TIntermNode *part : parts) {
      if (part != nullptr) {
        part->traverse(this);
      }
    }
    condition_count_ -= is_condition;
    bound_count_ -= is_bound;
    inner_count_ -= is_inner;
  }

  const LoopSteps &steps_;
  int condition_count_ = 0;
  int bound_count_ = 0;
  int inner_count_ = 0;
};

/** Whether \a text ends with a constructor and its opening parenthesis: `float(`. */
bool ends_with_constructor(std::string_view text)
{
  const auto trim = [&] { text.remove_suffix(text.size() - (text.find_last_not_of(" \t") + 1)); };
  trim();
  if (!text.ends_with('(')) {
    return false;
  }
  text.remove_suffix(1);
  trim();
  const auto begin = std::find_if_not(text.rbegin(), text.rend(), gpu::is_word_character);
  const std::string_view word = text.substr(std::size_t(text.rend() - begin));
  static constexpr std::array constructors = {"bool",  "int",   "uint",  "float", "double", "bvec2", "bvec3",
                                              "bvec4", "ivec2", "ivec3", "ivec4", "uvec2",  "uvec3", "uvec4",
                                              "dvec2", "dvec3", "dvec4", "vec2",  "vec3",   "vec4"};
  return std::ranges::find(constructors, word) != constructors.end();
}

/** Reads one function. */
class FunctionLint : public TIntermTraverser {
 public:
  FunctionLint(TIntermNode *function, const SourceLines &lines, std::vector<StageFinding> &findings)
      : facts_(function), lines_(lines), findings_(findings)
  {
    function->traverse(this);
  }

  bool visitBinary(TVisit, TIntermBinary *binary) override
  {
    if (binary->getOp() == glslang::EOpDiv || binary->getOp() == glslang::EOpDivAssign) {
      check_argument(binary->getOp(), binary->getRight(), binary->getLoc());
    }
    return true;
  }
  bool visitUnary(TVisit, TIntermUnary *unary) override
  {
    check_argument(unary->getOp(), unary->getOperand(), unary->getLoc());
    check_conversion(unary);
    return true;
  }
  bool visitAggregate(TVisit, TIntermAggregate *aggregate) override
  {
    if (aggregate->getOp() == glslang::EOpPow) {
      check_argument(glslang::EOpPow, aggregate->getSequence().front()->getAsTyped(), aggregate->getLoc());
    }
    return true;
  }
  bool visitLoop(TVisit, TIntermLoop *loop) override
  {
    const LoopSteps steps(loop);
    if (!steps.bound(loop->getTest()) && !LoopExits(loop, steps).is_any) {
      // A loop has no position; its parts have.
      const TIntermNode *known = loop->getTest() != nullptr ? loop->getTest() : loop->getBody();
      const glslang::TSourceLoc loc = loop->getLoc().line > 0 || known == nullptr ? loop->getLoc() : known->getLoc();
      add("unbounded-loop", loc,
          "the loop may not end: it steps no value that its condition or that of a break, return or discard reads");
    }
    return true;
  }

 private:
  void check_argument(TOperator op, TIntermTyped *argument, const glslang::TSourceLoc &loc)
  {
    if (argument->getAsConstantUnion() != nullptr) {
      return;
    }
    const std::string reason = danger(facts_, op, argument);
    if (!reason.empty() && !facts_.is_tested(argument) && !facts_.is_tested(facts_.resolved(argument))) {
      add("unguarded-math", loc, fmt::format("{} an unguarded value: {}", operator_name(op), reason));
    }
  }

  /**
   * Reports an implicit conversion of a block's member. glslang's tree does not distinguish it from an explicit one, so
   * the source text is used.
   */
  void check_conversion(TIntermUnary *unary)
  {
    TIntermTyped *operand = unary->getOperand();
    const TIntermSymbol *symbol = root_symbol(operand);
    if (unary->getOp() < glslang::EOpConvInt8ToBool || unary->getOp() > glslang::EOpConvDoubleToFloat ||
        symbol == nullptr || symbol->getType().getBasicType() != glslang::EbtBlock) {
      return;
    }
    const auto *parent = getParentNode() == nullptr ? nullptr : getParentNode()->getAsAggregate();
    if (parent != nullptr && parent->getOp() > glslang::EOpConstructGuardStart &&
        parent->getOp() < glslang::EOpConstructGuardEnd) {
      return;
    }
    const std::string start = first_name(operand);
    const std::string_view line = lines_.line(position_of(symbol->getLoc(), lines_));
    const std::size_t at = start.empty() ? std::string_view::npos : find_word(line, start);
    // The name occurs twice in the line, so the expression is ambiguous.
    if (at == std::string_view::npos || find_word(line, start, at + 1) != std::string_view::npos) {
      return;
    }
    if (!ends_with_constructor(line.substr(0, at))) {
      const std::string name = type_name(declared_type(unary->getType()));
      add("implicit-conversion", symbol->getLoc(),
          fmt::format("a block's member of type {} becomes {} implicitly: write {}(…)",
                      type_name(declared_type(operand->getType())), name, name));
    }
  }

  /**
   * The first name of a block's member in the source text: that of the instance, or of the member if there is no
   * instance name.
   */
  static std::string first_name(const TIntermTyped *node)
  {
    const TIntermBinary *innermost = nullptr;
    while (const TIntermBinary *binary = node->getAsBinaryNode()) {
      innermost = binary;
      node = binary->getLeft();
    }
    const TIntermSymbol *symbol = node->getAsSymbolNode();
    if (innermost == nullptr || symbol == nullptr) {
      return {};
    }
    const std::string name = text_of(symbol->getName());
    if (!name.starts_with("anon@")) {
      return name;
    }
    const auto *index = innermost->getRight()->getAsConstantUnion();
    if (innermost->getOp() != glslang::EOpIndexDirectStruct || index == nullptr) {
      return {};
    }
    const auto member = std::size_t(index->getConstArray()[0].getIConst());
    return text_of((*symbol->getType().getStruct())[member].type->getFieldName());
  }

  void add(std::string_view rule, const glslang::TSourceLoc &loc, std::string text)
  {
    findings_.push_back({rule, position_of(loc, lines_), std::move(text), false});
  }

  FunctionFacts facts_;
  const SourceLines &lines_;
  std::vector<StageFinding> &findings_;
};

}  // namespace

void check_function(TIntermNode *function, const SourceLines &lines, std::vector<StageFinding> &findings)
{
  FunctionLint(function, lines, findings);
}

}  // namespace gnomon::shader_check
