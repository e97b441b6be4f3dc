// SPDX-License-Identifier: MIT
#include "shader_check_tree.hh"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

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

std::string text_of(const glslang::TString &text)
{
  return {text.data(), text.size()};
}

SourcePosition position_of(const glslang::TSourceLoc &loc, const SourceLines &lines)
{
  return loc.name == nullptr ? lines.position(std::to_string(std::max(loc.string, 0)), loc.line, loc.column)
                             : lines.position({loc.name->data(), loc.name->size()}, loc.line, loc.column);
}

DeclaredType declared_type(const glslang::TType &type)
{
  static const std::map<glslang::TBasicType, std::pair<const char *, const char *>> names = {
      {glslang::EbtFloat, {"float", ""}},
      {glslang::EbtDouble, {"double", "d"}},
      {glslang::EbtInt, {"int", "i"}},
      {glslang::EbtUint, {"uint", "u"}},
      {glslang::EbtBool, {"bool", "b"}}};
  const auto found = names.find(type.getBasicType());
  DeclaredType result;
  if (type.isStruct()) {
    result.is_struct = true;
    result.name = text_of(type.getTypeName());
  }
  else if (found == names.end()) {
    result.name = type.getBasicType() == glslang::EbtSampler ? text_of(type.getSampler().getString()) : "sampler";
  }
  else {
    result.scalar = found->second.first;
    result.name = result.scalar;
    if (type.isMatrix()) {
      result.row_count = type.getMatrixRows();
      result.name = fmt::format("{}mat{}x{}", found->second.second, type.getMatrixCols(), result.row_count);
    }
    else if (type.getVectorSize() > 1) {
      result.vector_size = type.getVectorSize();
      result.name = fmt::format("{}vec{}", found->second.second, result.vector_size);
    }
  }
  for (int i = 0; i < (type.isArray() ? type.getArraySizes()->getNumDims() : 0); i++) {
    result.array_sizes.push_back(type.getArraySizes()->getDimSize(i));
  }
  return result;
}

std::string access_path(const TIntermNode *node)
{
  if (const TIntermSymbol *symbol = node->getAsSymbolNode()) {
    return std::to_string(symbol->getId());
  }
  const TIntermBinary *binary = node->getAsBinaryNode();
  if (binary == nullptr) {
    return {};
  }
  switch (binary->getOp()) {
    case glslang::EOpVectorSwizzle:
    case glslang::EOpIndexDirect: return access_path(binary->getLeft());
    case glslang::EOpIndexDirectStruct: {
      const std::string left = access_path(binary->getLeft());
      const auto *index = binary->getRight()->getAsConstantUnion();
      return left.empty() || index == nullptr ? std::string()
                                              : fmt::format("{}.{}", left, index->getConstArray()[0].getIConst());
    }
    default: return {};
  }
}

namespace {

/** Whether the paths are equal or one contains the other. */
bool overlap(std::string_view a, std::string_view b)
{
  const auto [shorter, longer] = a.size() < b.size() ? std::pair(a, b) : std::pair(b, a);
  return longer.starts_with(shorter) && (longer.size() == shorter.size() || longer[shorter.size()] == '.');
}

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

}  // namespace

std::set<std::string> paths_of(TIntermNode *node)
{
  PathCollector collector;
  node->traverse(&collector);
  return collector.paths;
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

FunctionFacts::FunctionFacts(TIntermNode *function)
{
  function->traverse(this);
  // A test of a value also tests the values that it was computed from.
  for (bool is_new = true; is_new;) {
    is_new = false;
    for (const std::string &known : std::set<std::string>(tested_)) {
      const auto value = values_.find(known);
      if (value != values_.end() && value->second.expression != nullptr) {
        for (const std::string &source : paths_of(value->second.expression)) {
          is_new |= tested_.insert(source).second;
        }
      }
    }
  }
}

bool FunctionFacts::visitBinary(TVisit, TIntermBinary *binary)
{
  if (is_assignment(binary->getOp())) {
    assign(binary->getLeft(), binary->getOp() == glslang::EOpAssign ? binary->getRight() : nullptr);
  }
  return true;
}

bool FunctionFacts::visitUnary(TVisit, TIntermUnary *unary)
{
  if (is_assignment(unary->getOp())) {
    assign(unary->getOperand(), nullptr);
  }
  return true;
}

bool FunctionFacts::visitAggregate(TVisit, TIntermAggregate *aggregate)
{
  const auto &qualifiers = aggregate->getQualifierList();
  for (std::size_t i = 0; i < qualifiers.size() && i < aggregate->getSequence().size(); i++) {
    if (qualifiers[i] == glslang::EvqOut || qualifiers[i] == glslang::EvqInOut) {
      assign(aggregate->getSequence()[i], nullptr);
    }
  }
  return true;
}

bool FunctionFacts::visitSelection(TVisit, TIntermSelection *selection)
{
  tested_.merge(paths_of(selection->getCondition()));
  return true;
}

bool FunctionFacts::visitLoop(TVisit, TIntermLoop *loop)
{
  if (loop->getTest() != nullptr) {
    tested_.merge(paths_of(loop->getTest()));
  }
  return true;
}

TIntermTyped *FunctionFacts::resolved(TIntermTyped *node) const
{
  for (int i = 0; i < 4; i++) {
    const auto value = values_.find(node->getAsSymbolNode() != nullptr ? access_path(node) : std::string());
    if (value == values_.end() || value->second.assignment_count != 1 || value->second.expression == nullptr) {
      break;
    }
    node = value->second.expression;
  }
  return node;
}

bool FunctionFacts::is_tested(TIntermTyped *node) const
{
  const std::set<std::string> read = paths_of(node);
  return std::ranges::any_of(read, [&](const std::string &one) {
    return std::ranges::any_of(tested_, [&](const std::string &test) { return overlap(one, test); });
  });
}

void FunctionFacts::assign(TIntermNode *to, TIntermTyped *expression)
{
  const TIntermSymbol *symbol = root_symbol(to);
  if (symbol == nullptr) {
    return;
  }
  Value &value = values_[std::to_string(symbol->getId())];
  value.assignment_count++;
  // For a swizzle or a member, no expression gives the whole value.
  value.expression = value.assignment_count == 1 && to->getAsSymbolNode() != nullptr ? expression : nullptr;
}

}  // namespace gnomon::shader_check
