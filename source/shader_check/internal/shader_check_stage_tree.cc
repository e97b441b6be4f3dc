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
  /** Members of blocks that are used: the id of the block and the index of the member. */
  std::set<std::pair<long long, std::size_t>> used_members;

  StageReader() : TIntermTraverser(true, false, true) {}

  bool visitAggregate(TVisit visit, TIntermAggregate *aggregate) override
  {
    if (aggregate->getOp() == glslang::EOpLinkerObjects) {
      return false;
    }
    if (visit == glslang::EvPostVisit) {
      // Initializers of globals stand between functions.
      if (aggregate->getOp() == glslang::EOpFunction) {
        function_.clear();
      }
      return true;
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
  bool visitBinary(TVisit /*visit*/, glslang::TIntermBinary *binary) override
  {
    if (binary->getOp() == glslang::EOpIndexDirectStruct && binary->getRight()->getAsConstantUnion() != nullptr) {
      const glslang::TIntermTyped *owner = binary->getLeft();
      for (const glslang::TIntermBinary *element = owner->getAsBinaryNode();
           element != nullptr && element->getOp() != glslang::EOpIndexDirectStruct;
           element = owner->getAsBinaryNode()) {
        owner = element->getLeft();
      }
      if (const TIntermSymbol *symbol = owner->getAsSymbolNode()) {
        used_members.emplace(symbol->getId(),
                             std::size_t(binary->getRight()->getAsConstantUnion()->getConstArray()[0].getIConst()));
      }
    }
    return true;
  }
  void visitSymbol(TIntermSymbol *symbol) override
  {
    used.insert(symbol->getId());
  }

 private:
  /** Empty: outside of functions. */
  std::string function_;
};

/** The functions that call themselves, directly or through others, by Tarjan's algorithm. */
class Recursion {
 public:
  explicit Recursion(const std::map<std::string, std::set<std::string>> &calls) : calls_(calls)
  {
    for (const auto &[name, callees] : calls) {
      if (!nodes_.contains(name)) {
        visit(name);
      }
    }
  }
  bool contains(const std::string &name) const
  {
    return found_.contains(name);
  }

 private:
  struct Node {
    std::size_t index;
    std::size_t low;
    bool is_open = true;
  };

  Node &visit(const std::string &name)
  {
    Node &node = nodes_.emplace(name, Node{nodes_.size(), nodes_.size()}).first->second;
    open_.push_back(name);
    bool is_found = false;
    if (const auto calls = calls_.find(name); calls != calls_.end()) {
      for (const std::string &callee : calls->second) {
        const auto known = nodes_.find(callee);
        const Node &other = known == nodes_.end() ? visit(callee) : known->second;
        if (other.is_open) {
          node.low = std::min(node.low, other.low);
        }
        is_found |= callee == name;
      }
    }
    if (node.low == node.index) {
      is_found |= open_.back() != name;
      for (bool is_last = false; !is_last;) {
        const std::string member = open_.back();
        open_.pop_back();
        nodes_.at(member).is_open = false;
        if (is_found) {
          found_.insert(member);
        }
        is_last = member == name;
      }
    }
    return node;
  }

  const std::map<std::string, std::set<std::string>> &calls_;
  std::map<std::string, Node> nodes_;
  std::vector<std::string> open_;
  std::set<std::string> found_;
};

void find_recursion(const StageReader &reader, const SourceLines &lines, std::vector<StageFinding> &findings)
{
  const Recursion recursion(reader.calls);
  for (const TIntermAggregate *function : reader.functions) {
    const std::string name = text_of(function->getName());
    if (recursion.contains(name)) {
      findings.push_back({"recursion", position_of(function->getLoc(), lines),
                          fmt::format("function '{}' calls itself, directly or through others, which GLSL forbids",
                                      name.substr(0, name.find('('))),
                          true});
    }
  }
}

void add_members(const TType &type, const std::string &prefix, const std::string &structure, bool is_std140,
                 const SourceLines &lines, Declaration &block, std::vector<StageFinding> &findings)
{
  for (const glslang::TTypeLoc &entry : *type.getStruct()) {
    const std::string name = prefix + text_of(entry.type->getFieldName());
    if (entry.type->isStruct()) {
      std::string first = name;
      for (int i = 0; entry.type->isArray() && i < entry.type->getArraySizes()->getNumDims(); i++) {
        first += "[0]";
      }
      add_members(*entry.type, first + ".", text_of(entry.type->getTypeName()), is_std140, lines, block, findings);
      continue;
    }
    block.members.push_back({name, structure, position_of(entry.loc, lines)});
    check_array(declared_type(*entry.type), is_std140, block.members.back(), findings);
  }
}

/** Adds the members of the struct \a type of an input or output. \a outer: the sizes of the arrays around it. */
void add_fields(const TType &type, const std::string &prefix, const std::vector<int> &outer, const SourceLines &lines,
                std::vector<BlockMember> &fields)
{
  for (const glslang::TTypeLoc &entry : *type.getStruct()) {
    BlockMember field{prefix + text_of(entry.type->getFieldName()), text_of(type.getTypeName()),
                      position_of(entry.loc, lines), declared_type(*entry.type)};
    field.type.array_sizes.insert(field.type.array_sizes.begin(), outer.begin(), outer.end());
    if (entry.type->isStruct()) {
      add_fields(*entry.type, field.name + ".", field.type.array_sizes, lines, fields);
    }
    else {
      fields.push_back(std::move(field));
    }
  }
}

/** Sets the locations that an input or output of \a type takes, and its members. */
void set_locations(Declaration &declaration, const TType &type, bool is_arrayed, const SourceLines &lines,
                   EShLanguage language)
{
  const glslang::TQualifier &qualifier = type.getQualifier();
  declaration.type = declared_type(type);
  declaration.is_arrayed = is_arrayed;
  declaration.location = qualifier.hasLocation() ? int(qualifier.layoutLocation) : -1;
  const int count = TIntermediate::computeTypeLocationSize(type, language);
  const int elements = is_arrayed && type.isArray() ? std::max(type.getOuterArraySize(), 1) : 1;
  declaration.location_count = std::max(count / elements, 1);
  const bool is_wide = is_64_bit(declaration.type) && type.getVectorSize() > 2;
  if (!is_wide || (language == EShLangVertex && qualifier.isPipeInput())) {
    set_components(declaration, qualifier.hasComponent() ? int(qualifier.layoutComponent) : 0);
  }
  if (type.isStruct()) {
    std::vector<int> outer = declaration.type.array_sizes;
    outer.erase(outer.begin(), outer.begin() + (is_arrayed && !outer.empty() ? 1 : 0));
    add_fields(type, declaration.name + ".", outer, lines, declaration.members);
  }
}

/** Adds an input or output of \a symbol. The members of a block with locations are connected one by one. */
void add_varying(Declaration declaration, const TIntermSymbol &symbol, const StageReader &reader,
                 const SourceLines &lines, EShLanguage language, std::vector<Declaration> &list)
{
  const TType &type = symbol.getType();
  const glslang::TQualifier &qualifier = type.getQualifier();
  const bool is_arrayed = qualifier.isArrayedIo(language);
  declaration.is_captured = qualifier.hasXfbOffset();
  declaration.is_flat = qualifier.flat;
  declaration.is_no_perspective = qualifier.nopersp;
  declaration.is_invariant = qualifier.invariant;
  const auto has_location = [](const glslang::TTypeLoc &entry) { return entry.type->getQualifier().hasLocation(); };
  const bool is_block = type.getBasicType() == glslang::EbtBlock;
  // The elements of other arrays of blocks have locations of their own.
  const bool is_one = declaration.type.array_sizes.size() == (is_arrayed ? 1U : 0U);
  if (!is_block || !((qualifier.hasLocation() && is_one) || std::ranges::any_of(*type.getStruct(), has_location))) {
    set_locations(declaration, type, is_arrayed, lines, language);
    list.push_back(std::move(declaration));
    return;
  }
  declaration.is_block_used = declaration.is_used;
  int next_location = qualifier.hasLocation() ? int(qualifier.layoutLocation) : -1;
  for (std::size_t i = 0; i < type.getStruct()->size(); i++) {
    const glslang::TTypeLoc &entry = (*type.getStruct())[i];
    Declaration member = declaration;
    member.name += "." + text_of(entry.type->getFieldName());
    member.position = position_of(entry.loc, lines);
    // A stage that only passes the block through uses all members.
    member.is_used = reader.used_members.contains({symbol.getId(), i}) || qualifier.layoutPassthrough;
    member.is_captured |= entry.type->getQualifier().hasXfbOffset();
    set_locations(member, *entry.type, false, lines, language);
    member.location = member.location < 0 ? next_location : member.location;
    next_location = member.location < 0 ? -1 : member.location + member.location_count;
    list.push_back(std::move(member));
  }
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
  declaration.type = declared_type(type);
  declaration.is_used = reader.used.contains(symbol.getId());
  declaration.set = qualifier.hasSet() ? int(qualifier.layoutSet) : 0;
  declaration.slot = qualifier.hasBinding() ? int(qualifier.layoutBinding) : -1;
  if (declaration.name.starts_with("gl_") || qualifier.builtIn != glslang::EbvNone) {
    return;
  }
  if (qualifier.isUniformOrBuffer()) {
    const bool is_buffer = qualifier.storage == glslang::EvqBuffer;
    declaration.position = lines.find_declaration(declaration.name, is_buffer ? "buffer" : "uniform");
    if (is_block) {
      add_members(type, "", "", qualifier.layoutPacking == glslang::ElpStd140, lines, declaration, facts.findings);
      declaration.is_push_constant = qualifier.isPushConstant() || declaration.name == gpu::push_constant_block_name;
      declaration.size_bytes = std::uint32_t(TIntermediate::getBlockSize(type));
      // The slot of push constants depends on the target.
      declaration.slot = qualifier.isPushConstant() ? -1 : declaration.slot;
      (is_buffer ? facts.storage_blocks : facts.uniform_blocks).push_back(std::move(declaration));
    }
    else {
      facts.uniforms.push_back(declaration);
      if (qualifier.hasLocation()) {
        facts.uniforms.back().location = int(qualifier.layoutLocation);
        facts.uniforms.back().location_count = TIntermediate::computeTypeUniformLocationSize(type);
      }
      if (type.containsOpaque()) {
        declaration.is_image = type.getBasicType() == glslang::EbtSampler && type.getSampler().isImage();
        facts.textures.push_back(std::move(declaration));
      }
    }
  }
  else if (qualifier.isPipeInput() || qualifier.isPipeOutput()) {
    declaration.position = lines.find_declaration(declaration.name, qualifier.isPipeInput() ? "in" : "out");
    if (qualifier.layoutPassthrough) {
      // GL_NV_geometry_shader_passthrough: the stage writes it as it reads it.
      declaration.is_used = true;
      add_varying(declaration, symbol, reader, lines, language, facts.outputs);
    }
    add_varying(std::move(declaration), symbol, reader, lines, language,
                qualifier.isPipeInput() ? facts.inputs : facts.outputs);
  }
}

}  // namespace

StageFacts read_tree(const TIntermediate &tree, const SourceLines &lines, bool with_mistakes)
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
  if (!with_mistakes) {
    return facts;
  }
  find_recursion(reader, lines, facts.findings);
  for (TIntermAggregate *function : reader.functions) {
    check_function(function, lines, facts.findings);
  }
  return facts;
}

}  // namespace gnomon::shader_check
