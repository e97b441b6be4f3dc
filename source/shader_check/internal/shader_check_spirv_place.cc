// SPDX-License-Identifier: MIT
#include "shader_check_spirv_place.hh"

#include <spirv-tools/libspirv.h>
#include <glslang/SPIRV/spirv.hpp>

#include <map>
#include <set>

namespace gnomon::shader_check {

namespace {

class PlaceReader {
 public:
  explicit PlaceReader(std::size_t number) : number_(number) {}

  void read(const spv_parsed_instruction_t &one)
  {
    count_++;
    switch (one.opcode) {
      case spv::OpString: strings_[one.result_id] = text_at(one, 2); break;
      case spv::OpName: names_[one.words[1]] = text_at(one, 2); break;
      case spv::OpMemberName: members_[one.words[1]].push_back(text_at(one, 3)); break;
      case spv::OpLine:
        file_ = one.words[1];
        line_ = int(one.words[2]);
        break;
      case spv::OpNoLine:
      case spv::OpFunctionEnd: line_ = 0; break;
      default: break;
    }
    std::vector<std::uint32_t> ids;
    for (std::size_t i = 0; i < one.num_operands; i++) {
      const std::uint32_t id = one.words[one.operands[i].offset];
      switch (one.operands[i].type) {
        case SPV_OPERAND_TYPE_RESULT_ID: ids.insert(ids.begin(), id); break;
        case SPV_OPERAND_TYPE_TYPE_ID:
        case SPV_OPERAND_TYPE_ID: ids.push_back(id); break;
        default: break;
      }
    }
    if (count_ == number_) {
      place_.file = line_ > 0 ? strings_[file_] : "";
      place_.line = line_;
      ids_ = ids;
    }
    if (one.result_id != 0) {
      read_by_[one.result_id] = std::move(ids);
    }
  }

  /** Call it after the last instruction. */
  SpirvPlace place()
  {
    place_.members = ids_.empty() ? place_.members : members_[ids_.front()];
    std::set<std::uint32_t> seen;
    // Without a name, such as a pointer, an id stands for those that it is made of.
    for (std::size_t i = 0; i < ids_.size(); i++) {
      const std::uint32_t id = ids_[i];
      if (!seen.insert(id).second) {
        continue;
      }
      const auto name = names_.find(id);
      if (name != names_.end() && !name->second.empty()) {
        // glslang ends the name of a function with its parameters.
        place_.names.push_back(name->second.substr(0, name->second.find('(')));
      }
      else if (const auto parts = read_by_.find(id); parts != read_by_.end()) {
        ids_.insert(ids_.end(), parts->second.begin(), parts->second.end());
      }
    }
    return std::move(place_);
  }

 private:
  static std::string text_at(const spv_parsed_instruction_t &one, std::size_t word)
  {
    return reinterpret_cast<const char *>(one.words + word);
  }

  std::size_t number_;
  std::size_t count_ = 0;
  std::uint32_t file_ = 0;
  int line_ = 0;
  std::map<std::uint32_t, std::string> strings_;
  std::map<std::uint32_t, std::string> names_;
  /** Names of the members of each struct, in their order. */
  std::map<std::uint32_t, std::vector<std::string>> members_;
  /** The ids that the instruction of a result reads. */
  std::map<std::uint32_t, std::vector<std::uint32_t>> read_by_;
  std::vector<std::uint32_t> ids_;
  SpirvPlace place_;
};

}  // namespace

SpirvPlace spirv_place(std::span<const std::uint32_t> words, std::size_t number)
{
  PlaceReader reader(number);
  // The environment decides nothing about the form of instructions.
  const spv_context context = spvContextCreate(SPV_ENV_UNIVERSAL_1_6);
  const auto instruction = [](void *self, const spv_parsed_instruction_t *one) {
    static_cast<PlaceReader *>(self)->read(*one);
    return SPV_SUCCESS;
  };
  spvBinaryParse(context, &reader, words.data(), words.size(), nullptr, instruction, nullptr);
  spvContextDestroy(context);
  return reader.place();
}

}  // namespace gnomon::shader_check
