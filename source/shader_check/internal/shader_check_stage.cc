// SPDX-License-Identifier: MIT
#include "shader_check_stage.hh"

#include "shader_check_function.hh"
#include "shader_check_tree.hh"

#include <algorithm>
#include <map>
#include <set>

namespace gnomon::shader_check {

using glslang::TIntermAggregate;
using glslang::TIntermediate;
using glslang::TIntermSymbol;
using glslang::TIntermTraverser;
using glslang::TType;
using glslang::TVisit;

namespace {

/** Reads functions, their calls and the globals that they use. */
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

void find_recursion(const StageReader &reader, std::vector<StageFinding> &findings)
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

/** Reports arrays of elements that do not fill rows of 16 bytes: C++ packs them, std140 does not. */
void check_array(const TType &type, const BlockMember &member, bool is_std140, std::vector<StageFinding> &findings)
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
                 Declaration &block, std::vector<StageFinding> &findings)
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
  // Inputs of a geometry shader are arrays over the vertices; use the element type.
  const bool is_arrayed = language == EShLangGeometry && type.getQualifier().isPipeInput() && type.isArray();
  const int count = TIntermediate::computeTypeLocationSize(type, language);
  const int vertices = is_arrayed ? std::max(type.getOuterArraySize(), 1) : 1;
  return std::max(count / vertices, 1);
}

/** Adds an object of the stage's interface, if it is a block, texture, input or output. */
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
      if (qualifier.isPushConstant() || declaration.name == gpu::push_constant_block_name) {
        // The slot of push constants depends on the target.
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
    check_function(function, lines, facts.findings);
  }
  std::erase_if(facts.findings, [&](const StageFinding &finding) {
    return !finding.is_error &&
           lines.line(finding.position).find(fmt::format("shader-check: {}", finding.rule)) != std::string_view::npos;
  });
  return facts;
}

}  // namespace gnomon::shader_check
