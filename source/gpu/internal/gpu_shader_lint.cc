// SPDX-License-Identifier: MIT
#include "gpu_shader_lint.hh"

#include <glslang/MachineIndependent/localintermediate.h>

#include <algorithm>
#include <regex>
#include <sstream>

namespace gnomon::gpu {

using glslang::TIntermAggregate;
using glslang::TIntermBinary;
using glslang::TIntermediate;
using glslang::TIntermLoop;
using glslang::TIntermSelection;
using glslang::TIntermSymbol;
using glslang::TIntermTraverser;
using glslang::TIntermTyped;
using glslang::TIntermUnary;
using glslang::TOperator;
using glslang::TType;
using glslang::TVisit;

namespace {

bool is_word(char c)
{
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/** Where \a word stands in \a text as a whole word, from \a from on. */
std::size_t find_word(std::string_view text, std::string_view word, std::size_t from = 0)
{
  for (std::size_t at = text.find(word, from); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_word(text[at - 1])) && (end == text.size() || !is_word(text[end]))) {
      return at;
    }
  }
  return std::string_view::npos;
}

/** \a line without comments. \a is_in_comment: whether it begins, then ends, inside of one. */
std::string without_comments(std::string_view line, bool &is_in_comment)
{
  std::string code;
  for (std::size_t i = 0; i < line.size(); i++) {
    const std::string_view two = line.substr(i, 2);
    if (is_in_comment) {
      if (two == "*/") {
        is_in_comment = false;
        i++;
      }
    }
    else if (two == "/*") {
      is_in_comment = true;
      i++;
    }
    else if (two == "//") {
      break;
    }
    else {
      code += line[i];
    }
  }
  return code;
}

SourcePosition position_of(const glslang::TSourceLoc &loc)
{
  return {std::size_t(std::max(loc.string, 0)), std::max(loc.line, 1)};
}

std::string text_of(const glslang::TString &text)
{
  return {text.data(), text.size()};
}

}  // namespace

SourceLines::SourceLines(const ShaderSource &source)
{
  static const std::regex position_pattern(R"(^#line (\d+) (\d+)$)");
  std::istringstream stream(source.text);
  SourcePosition position;
  bool is_in_comment = false;
  for (std::string text; std::getline(stream, text);) {
    std::smatch match;
    if (std::regex_match(text, match, position_pattern)) {
      position = {std::stoul(match[2]), std::stoi(match[1])};
      continue;
    }
    std::string code = without_comments(text, is_in_comment);
    lines_.push_back({position, std::move(text), std::move(code)});
    position.line++;
  }
}

std::string_view SourceLines::line(SourcePosition position) const
{
  const auto found = std::ranges::find(lines_, position, &Line::position);
  return found == lines_.end() ? std::string_view() : std::string_view(found->text);
}

SourcePosition SourceLines::find_declaration(std::string_view name, std::string_view keyword) const
{
  const Line *first = nullptr;
  for (const Line &line : lines_) {
    const std::size_t at = find_word(line.code, name);
    if (at == std::string_view::npos) {
      continue;
    }
    if (find_word(std::string_view(line.code).substr(0, at), keyword) != std::string_view::npos) {
      return line.position;
    }
    first = first == nullptr ? &line : first;
  }
  return first == nullptr ? SourcePosition() : first->position;
}

namespace {

/** \a is_arrayed: one element a vertex, which is not a part of the type. */
std::string type_name(const TType &type, bool is_arrayed = false)
{
  static const std::map<glslang::TBasicType, std::pair<const char *, const char *>> names = {
      {glslang::EbtFloat, {"float", ""}},
      {glslang::EbtDouble, {"double", "d"}},
      {glslang::EbtInt, {"int", "i"}},
      {glslang::EbtUint, {"uint", "u"}},
      {glslang::EbtBool, {"bool", "b"}}};
  const auto found = names.find(type.getBasicType());
  std::string name;
  if (type.isStruct()) {
    name = text_of(type.getTypeName());
  }
  else if (found == names.end()) {
    name = "sampler";
  }
  else if (type.isMatrix()) {
    name = fmt::format("{}mat{}x{}", found->second.second, type.getMatrixCols(), type.getMatrixRows());
  }
  else if (type.getVectorSize() > 1) {
    name = fmt::format("{}vec{}", found->second.second, type.getVectorSize());
  }
  else {
    name = found->second.first;
  }
  const int dimension_count = type.isArray() ? type.getArraySizes()->getNumDims() : 0;
  for (int i = is_arrayed ? 1 : 0; i < dimension_count; i++) {
    name += fmt::format("[{}]", type.getArraySizes()->getDimSize(i));
  }
  return name;
}

/** An expression's root and the members taken from it: `12.3`. Empty: no such expression. Swizzles do not count. */
std::string access_path(const TIntermNode *node)
{
  if (const TIntermSymbol *symbol = node->getAsSymbolNode()) {
    return std::to_string(symbol->getId());
  }
  const TIntermBinary *binary = node->getAsBinaryNode();
  if (binary == nullptr) {
    return {};
  }
  const std::string left = access_path(binary->getLeft());
  const auto *index = binary->getRight()->getAsConstantUnion();
  if (left.empty() || binary->getOp() == glslang::EOpVectorSwizzle) {
    return left;
  }
  if (binary->getOp() == glslang::EOpIndexDirectStruct && index != nullptr) {
    return fmt::format("{}.{}", left, index->getConstArray()[0].getIConst());
  }
  return binary->getOp() == glslang::EOpIndexDirect ? left : std::string();
}

/** Whether one path is the other or a part of it. */
bool overlap(std::string_view a, std::string_view b)
{
  const auto [shorter, longer] = a.size() < b.size() ? std::pair(a, b) : std::pair(b, a);
  return longer.starts_with(shorter) && (longer.size() == shorter.size() || longer[shorter.size()] == '.');
}

const TIntermSymbol *root_symbol(const TIntermNode *node)
{
  while (node->getAsBinaryNode() != nullptr) {
    node = node->getAsBinaryNode()->getLeft();
  }
  return node->getAsSymbolNode();
}

bool is_assignment(TOperator op)
{
  switch (op) {
    case glslang::EOpAssign:
    case glslang::EOpPostIncrement:
    case glslang::EOpPostDecrement:
    case glslang::EOpPreIncrement:
    case glslang::EOpPreDecrement: return true;
    default: return op >= glslang::EOpAddAssign && op <= glslang::EOpRightShiftAssign;
  }
}

/** The paths that an expression reads. */
class PathCollector : public TIntermTraverser {
 public:
  std::set<std::string> paths;

  void visitSymbol(TIntermSymbol *symbol) override
  {
    paths.insert(access_path(symbol));
  }
  bool visitBinary(TVisit, TIntermBinary *binary) override
  {
    const std::string whole = access_path(binary);
    if (whole.empty()) {
      return true;
    }
    paths.insert(whole);
    return false;
  }
};

std::set<std::string> paths_of(TIntermNode *node)
{
  PathCollector collector;
  node->traverse(&collector);
  return collector.paths;
}

/** What a function assigns, and what it tests. */
class FunctionFacts : public TIntermTraverser {
 public:
  struct Value {
    int count = 0;
    TIntermTyped *expression = nullptr;
  };
  /** By path. */
  std::map<std::string, Value> values;
  std::set<std::string> tested;

  explicit FunctionFacts(TIntermNode *function)
  {
    function->traverse(this);
    // A test of what was computed from something tests that, too.
    for (bool is_new = true; is_new;) {
      is_new = false;
      for (const std::string &known : std::set<std::string>(tested)) {
        const auto value = values.find(known);
        if (value != values.end() && value->second.expression != nullptr) {
          for (const std::string &source : paths_of(value->second.expression)) {
            is_new |= tested.insert(source).second;
          }
        }
      }
    }
  }

  bool visitBinary(TVisit, TIntermBinary *binary) override
  {
    if (is_assignment(binary->getOp())) {
      assign(binary->getLeft(), binary->getOp() == glslang::EOpAssign ? binary->getRight() : nullptr);
    }
    return true;
  }
  bool visitUnary(TVisit, TIntermUnary *unary) override
  {
    if (is_assignment(unary->getOp())) {
      assign(unary->getOperand(), nullptr);
    }
    return true;
  }
  bool visitAggregate(TVisit, TIntermAggregate *aggregate) override
  {
    const auto &qualifiers = aggregate->getQualifierList();
    for (std::size_t i = 0; i < qualifiers.size() && i < aggregate->getSequence().size(); i++) {
      if (qualifiers[i] == glslang::EvqOut || qualifiers[i] == glslang::EvqInOut) {
        assign(aggregate->getSequence()[i], nullptr);
      }
    }
    return true;
  }
  bool visitSelection(TVisit, TIntermSelection *selection) override
  {
    tested.merge(paths_of(selection->getCondition()));
    return true;
  }
  bool visitLoop(TVisit, TIntermLoop *loop) override
  {
    if (loop->getTest() != nullptr) {
      tested.merge(paths_of(loop->getTest()));
    }
    return true;
  }

  /** The only value that a local has, as far as it is one; else \a node. */
  TIntermTyped *resolved(TIntermTyped *node) const
  {
    for (int i = 0; i < 4; i++) {
      const auto value = values.find(node->getAsSymbolNode() != nullptr ? access_path(node) : std::string());
      if (value == values.end() || value->second.count != 1 || value->second.expression == nullptr) {
        break;
      }
      node = value->second.expression;
    }
    return node;
  }
  bool is_tested(TIntermTyped *node) const
  {
    const std::set<std::string> read = paths_of(node);
    return std::ranges::any_of(read, [&](const std::string &one) {
      return std::ranges::any_of(tested, [&](const std::string &test) { return overlap(one, test); });
    });
  }

 private:
  void assign(TIntermNode *to, TIntermTyped *expression)
  {
    const TIntermSymbol *symbol = root_symbol(to);
    if (symbol == nullptr) {
      return;
    }
    Value &value = values[std::to_string(symbol->getId())];
    value.count++;
    // A swizzle or a member: the whole has no one value.
    value.expression = value.count == 1 && to->getAsSymbolNode() != nullptr ? expression : nullptr;
  }
};

/** The arguments of a built-in function or an operator. */
std::vector<TIntermTyped *> arguments_of(TIntermTyped *node)
{
  if (auto *aggregate = node->getAsAggregate()) {
    std::vector<TIntermTyped *> arguments;
    for (TIntermNode *argument : aggregate->getSequence()) {
      if (argument->getAsTyped() != nullptr) {
        arguments.push_back(argument->getAsTyped());
      }
    }
    return arguments;
  }
  if (auto *binary = node->getAsBinaryNode()) {
    return {binary->getLeft(), binary->getRight()};
  }
  if (auto *unary = node->getAsUnaryNode()) {
    return {unary->getOperand()};
  }
  return {};
}

TOperator operator_of(const TIntermTyped *node)
{
  const auto *operation = node->getAsOperator();
  return operation == nullptr ? glslang::EOpNull : operation->getOp();
}

/** Whether an expression lies in [0, 1] by its outermost function. */
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

/** Why \a op may fail on \a argument, where that can be told from the expression; else nothing. */
std::string danger(const FunctionFacts &facts, TOperator op, TIntermTyped *argument)
{
  TIntermTyped *value = facts.resolved(argument);
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
    case glslang::EOpAsin: return is_dot ? "by rounding a scalar product may lie beyond [-1, 1]" : "";
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

/** Whether a comparison in a loop's test has a side that the loop moves on, by `++`, `+=`, `i = i + …` and the like. */
class LoopSteps : public TIntermTraverser {
 public:
  explicit LoopSteps(TIntermLoop *loop)
  {
    for (TIntermNode *part : {loop->getBody(), static_cast<TIntermNode *>(loop->getTerminal())}) {
      if (part != nullptr) {
        part->traverse(this);
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
    const bool is_step = binary->getOp() != glslang::EOpAssign || (binary->getRight()->getAsBinaryNode() != nullptr &&
                                                                   paths_of(binary->getRight()).contains(target));
    if (!target.empty() && is_step) {
      stepped_.insert(target);
    }
    return true;
  }
  bool bound(TIntermTyped *test) const
  {
    if (test == nullptr || test->getAsConstantUnion() != nullptr) {
      return false;
    }
    // A test with a step of its own, `i-- > 0`, or one that calls a function, is taken for what it looks like.
    const std::vector<TIntermTyped *> sides = arguments_of(test);
    switch (operator_of(test)) {
      case glslang::EOpLogicalAnd: return std::ranges::any_of(sides, [&](TIntermTyped *side) { return bound(side); });
      case glslang::EOpLessThan:
      case glslang::EOpGreaterThan:
      case glslang::EOpLessThanEqual:
      case glslang::EOpGreaterThanEqual:
      case glslang::EOpEqual:
      case glslang::EOpNotEqual:
        return std::ranges::any_of(sides, [&](TIntermTyped *side) {
          return is_assignment(operator_of(side)) ||
                 std::ranges::any_of(paths_of(side), [&](const std::string &read) { return stepped_.contains(read); });
        });
      default: return false;
    }
  }

 private:
  std::set<std::string> stepped_;
};

/** Reads one function. */
class FunctionLint : public TIntermTraverser {
 public:
  FunctionLint(TIntermNode *function, const SourceLines &lines, std::vector<LintFinding> &findings)
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
    if (!LoopSteps(loop).bound(loop->getTest())) {
      // A loop itself has no position.
      const TIntermNode *known = loop->getTest() != nullptr ? loop->getTest() : loop->getBody();
      const glslang::TSourceLoc loc = loop->getLoc().line > 0 || known == nullptr ? loop->getLoc() : known->getLoc();
      add("unbounded-loop", loc,
          "nothing bounds the loop: no comparison in its condition has a side that the loop steps");
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

  /** A member of a block that becomes another type without a word. glslang's tree does not tell: its text does. */
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
    const std::string_view line = lines_.line(position_of(symbol->getLoc()));
    const std::size_t at = start.empty() ? std::string_view::npos : find_word(line, start);
    // Twice in a line: which one is meant cannot be told.
    if (at == std::string_view::npos || find_word(line, start, at + 1) != std::string_view::npos) {
      return;
    }
    static const std::regex constructor(R"(\b(bool|u?int|float|double|[biud]?vec[234])\s*\(\s*$)");
    const std::string before(line.substr(0, at));
    if (!std::regex_search(before, constructor)) {
      add("implicit-conversion", symbol->getLoc(),
          fmt::format("a block's member of type {} becomes {} implicitly: say {}(…)", type_name(operand->getType()),
                      type_name(unary->getType()), type_name(unary->getType())));
    }
  }

  /** The name that a block's member begins with in the text: the instance's, or the member's where there is none. */
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
    findings_.push_back({rule, position_of(loc), std::move(text), false});
  }

  FunctionFacts facts_;
  const SourceLines &lines_;
  std::vector<LintFinding> &findings_;
};

/** Functions, what they call, and what they use of the outside. */
class StageReader : public TIntermTraverser {
 public:
  std::vector<TIntermAggregate *> functions;
  std::map<std::string, std::set<std::string>> calls;
  std::set<long long> used;

  bool visitAggregate(TVisit, TIntermAggregate *aggregate) override
  {
    if (aggregate->getOp() == glslang::EOpLinkerObjects) {
      return false;
    }
    if (aggregate->getOp() == glslang::EOpFunction) {
      functions.push_back(aggregate);
      function_ = text_of(aggregate->getName());
    }
    else if (aggregate->getOp() == glslang::EOpFunctionCall) {
      calls[function_].insert(text_of(aggregate->getName()));
    }
    return true;
  }
  void visitSymbol(TIntermSymbol *symbol) override
  {
    used.insert(symbol->getId());
  }

 private:
  std::string function_;
};

bool reaches(const std::map<std::string, std::set<std::string>> &calls, const std::string &from, const std::string &to,
             std::set<std::string> &seen)
{
  const auto found = calls.find(from);
  return found != calls.end() && std::ranges::any_of(found->second, [&](const std::string &callee) {
           return callee == to || (seen.insert(callee).second && reaches(calls, callee, to, seen));
         });
}

void find_recursion(const StageReader &reader, std::vector<LintFinding> &findings)
{
  for (const TIntermAggregate *function : reader.functions) {
    const std::string name = text_of(function->getName());
    std::set<std::string> seen;
    if (reaches(reader.calls, name, name, seen)) {
      findings.push_back({"recursion", position_of(function->getLoc()),
                          fmt::format("function '{}' calls itself, directly or through others, which GLSL forbids",
                                      name.substr(0, name.find('('))),
                          true});
    }
  }
}

/** An array of what does not fill rows of 16 bytes: C++ packs it, std140 does not. */
void check_array(const TType &type, const BlockMember &member, bool is_std140, std::vector<LintFinding> &findings)
{
  if (type.isMatrix() && type.getMatrixRows() != 4) {
    findings.push_back({"block-array", member.position,
                        fmt::format("'{}': a matrix with {} rows takes 16 bytes a column in a block; C++ has {}",
                                    member.name, type.getMatrixRows(), 4 * type.getMatrixRows()),
                        type.getMatrixRows() == 3});
  }
  else if (type.isArray() && type.isVector() && type.getVectorSize() == 3) {
    findings.push_back(
        {"block-array", member.position,
         fmt::format("'{}': an array of vec3 takes 16 bytes an element in a block; C++ has 12", member.name), true});
  }
  else if (type.isArray() && is_std140 && !type.isMatrix() && type.getVectorSize() < 4 &&
           type.getBasicType() != glslang::EbtDouble) {
    findings.push_back(
        {"block-array", member.position,
         fmt::format("'{}': an array of {} takes 16 bytes an element in a std140 block; C++ has {}", member.name,
                     type.getVectorSize() == 1 ? "scalars" : "vec2", 4 * type.getVectorSize()),
         false});
  }
}

void add_members(const TType &type, const std::string &prefix, const std::string &structure, bool is_std140,
                 Declaration &block, std::vector<LintFinding> &findings)
{
  for (const glslang::TTypeLoc &entry : *type.getStruct()) {
    const std::string name = prefix + text_of(entry.type->getFieldName());
    if (entry.type->isStruct()) {
      add_members(*entry.type, name + (entry.type->isArray() ? "[0]." : "."), text_of(entry.type->getTypeName()),
                  is_std140, block, findings);
      continue;
    }
    block.members.push_back({name, structure, position_of(entry.loc)});
    check_array(*entry.type, block.members.back(), is_std140, findings);
  }
}

int location_count(const TType &type, EShLanguage language)
{
  // Of an array with an element a vertex, an element.
  const bool is_arrayed = language == EShLangGeometry && type.getQualifier().isPipeInput() && type.isArray();
  const int count = TIntermediate::computeTypeLocationSize(type, language);
  const int vertices = is_arrayed ? std::max(type.getOuterArraySize(), 1) : 1;
  return std::max(count / vertices, 1);
}

/** One object of the stage's interface, if it is one of those that are looked at. */
void add_declaration(const TIntermSymbol &symbol, const StageReader &reader, const SourceLines &lines,
                     EShLanguage language, StageFacts &facts)
{
  const TType &type = symbol.getType();
  const glslang::TQualifier &qualifier = type.getQualifier();
  const bool is_block = type.getBasicType() == glslang::EbtBlock;
  Declaration declaration;
  declaration.name = text_of(is_block ? type.getTypeName() : symbol.getName());
  declaration.type = &type;
  declaration.is_used = reader.used.contains(symbol.getId());
  declaration.set = qualifier.hasSet() ? int(qualifier.layoutSet) : 0;
  declaration.slot = qualifier.hasBinding() ? int(qualifier.layoutBinding) : -1;
  declaration.location = qualifier.hasLocation() ? int(qualifier.layoutLocation) : -1;
  if (declaration.name.starts_with("gl_") || qualifier.builtIn != glslang::EbvNone) {
    return;
  }
  if (qualifier.isUniformOrBuffer()) {
    const bool is_buffer = qualifier.storage == glslang::EvqBuffer;
    declaration.position = lines.find_declaration(declaration.name, is_buffer ? "buffer" : "uniform");
    if (is_block) {
      add_members(type, "", "", qualifier.layoutPacking == glslang::ElpStd140, declaration, facts.findings);
      if (qualifier.isPushConstant() || declaration.name == push_constant_block_name) {
        facts.has_push_constants = true;
        // Which slot it stands in is the target's affair.
        declaration.slot = qualifier.isPushConstant() ? -1 : declaration.slot;
      }
      (is_buffer ? facts.storage_blocks : facts.uniform_blocks).push_back(std::move(declaration));
    }
    else if (type.containsOpaque()) {
      facts.textures.push_back(std::move(declaration));
    }
  }
  else if (qualifier.isPipeInput() || qualifier.isPipeOutput()) {
    declaration.position = lines.find_declaration(declaration.name, qualifier.isPipeInput() ? "in" : "out");
    declaration.location_count = location_count(type, language);
    (qualifier.isPipeInput() ? facts.inputs : facts.outputs).push_back(std::move(declaration));
  }
}

}  // namespace

StageFacts read_stage(const TIntermediate &tree, const SourceLines &lines)
{
  StageFacts facts;
  TIntermNode *root = tree.getTreeRoot();
  if (root == nullptr) {
    return facts;
  }
  StageReader reader;
  root->traverse(&reader);
  if (const TIntermAggregate *objects = tree.findLinkerObjects()) {
    for (const TIntermNode *object : objects->getSequence()) {
      if (const TIntermSymbol *symbol = object->getAsSymbolNode()) {
        add_declaration(*symbol, reader, lines, tree.getStage(), facts);
      }
    }
  }
  find_recursion(reader, facts.findings);
  for (TIntermAggregate *function : reader.functions) {
    FunctionLint(function, lines, facts.findings);
  }
  std::erase_if(facts.findings, [&](const LintFinding &finding) {
    return !finding.is_error &&
           lines.line(finding.position).find(fmt::format("shader-check: {}", finding.rule)) != std::string_view::npos;
  });
  return facts;
}

std::string interface_type(const Declaration &declaration, bool is_arrayed)
{
  return type_name(*declaration.type, is_arrayed);
}

}  // namespace gnomon::gpu
