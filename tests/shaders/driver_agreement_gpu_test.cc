// SPDX-License-Identifier: MIT
// The layout of a shader's blocks agrees between glslang, the driver and C++.
#include "engines/eevee/eevee_pairwise_variants.hh"

#include "eevee_blocks.hh"
#include "eevee_shaders.hh"
#include "gpu_device_fixture.hh"
#include "shader_check_reflection.hh"
#include "shader_files.hh"

#include <epoxy/gl.h>

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace gnomon::eevee {
namespace {

using gpu::BindingKind;
using Offsets = std::map<std::string, int>;

/** A variant compiled by the driver of the current context from the same text that glslang compiles. */
class DriverProgram {
 public:
  explicit DriverProgram(const std::vector<gpu::ShaderSource> &stages) : program_(glCreateProgram())
  {
    for (const gpu::ShaderSource &stage : stages) {
      const GLenum kind = stage.stage == gpu::ShaderStage::Vertex     ? GL_VERTEX_SHADER
                          : stage.stage == gpu::ShaderStage::Geometry ? GL_GEOMETRY_SHADER
                                                                      : GL_FRAGMENT_SHADER;
      const GLuint shader = glCreateShader(kind);
      const char *text = stage.text.c_str();
      glShaderSource(shader, 1, &text, nullptr);
      glCompileShader(shader);
      std::array<char, 2048> log = {};
      glGetShaderInfoLog(shader, log.size(), nullptr, log.data());
      log_ += stage.name_files(log.data());
      glAttachShader(program_, shader);
      glDeleteShader(shader);
    }
    glLinkProgram(program_);
    std::array<char, 2048> log = {};
    glGetProgramInfoLog(program_, log.size(), nullptr, log.data());
    log_ += log.data();
  }
  DriverProgram(const DriverProgram &) = delete;
  DriverProgram &operator=(const DriverProgram &) = delete;
  ~DriverProgram()
  {
    glDeleteProgram(program_);
  }

  [[nodiscard]] bool is_linked() const
  {
    GLint status = 0;
    glGetProgramiv(program_, GL_LINK_STATUS, &status);
    return status != 0;
  }
  [[nodiscard]] const std::string &log() const
  {
    return log_;
  }

  struct Block {
    int slot = 0;
    int size_bytes = 0;
    Offsets offsets;
  };
  /** The blocks, by name. */
  [[nodiscard]] std::map<std::string, Block> blocks(BindingKind kind) const
  {
    const bool is_uniform = kind == BindingKind::UniformBlock;
    const GLenum block_interface = is_uniform ? GL_UNIFORM_BLOCK : GL_SHADER_STORAGE_BLOCK;
    const GLenum member_interface = is_uniform ? GL_UNIFORM : GL_BUFFER_VARIABLE;
    std::map<std::string, Block> blocks;
    GLint count = 0;
    glGetProgramInterfaceiv(program_, block_interface, GL_ACTIVE_RESOURCES, &count);
    for (GLuint i = 0; i < GLuint(count); i++) {
      const std::string name = name_of(block_interface, i);
      Block &block = blocks[name];
      block.slot = property(block_interface, i, GL_BUFFER_BINDING);
      block.size_bytes = property(block_interface, i, GL_BUFFER_DATA_SIZE);
      std::vector<GLint> members(std::size_t(property(block_interface, i, GL_NUM_ACTIVE_VARIABLES)));
      const GLenum active = GL_ACTIVE_VARIABLES;
      glGetProgramResourceiv(program_, block_interface, i, 1, &active, GLsizei(members.size()), nullptr,
                             members.data());
      for (const GLint member : members) {
        const std::string member_name = reflected_name(name, name_of(member_interface, GLuint(member)));
        if (!member_name.empty()) {
          block.offsets[member_name] = property(member_interface, GLuint(member), GL_OFFSET);
        }
      }
    }
    return blocks;
  }

  /** The texture slots, by the name of the sampler. */
  [[nodiscard]] std::map<std::string, int> textures() const
  {
    std::map<std::string, int> textures;
    GLint count = 0;
    glGetProgramInterfaceiv(program_, GL_UNIFORM, GL_ACTIVE_RESOURCES, &count);
    for (GLuint i = 0; i < GLuint(count); i++) {
      const GLint location = property(GL_UNIFORM, i, GL_LOCATION);
      if (location >= 0) {
        GLint slot = -1;
        glGetUniformiv(program_, location, &slot);
        textures[name_of(GL_UNIFORM, i)] = slot;
      }
    }
    return textures;
  }

 private:
  [[nodiscard]] GLint property(GLenum interface, GLuint index, GLenum property) const
  {
    GLint value = 0;
    glGetProgramResourceiv(program_, interface, index, 1, &property, 1, nullptr, &value);
    return value;
  }
  [[nodiscard]] std::string name_of(GLenum interface, GLuint index) const
  {
    std::array<char, 256> name = {};
    glGetProgramResourceName(program_, interface, index, name.size(), nullptr, name.data());
    return name.data();
  }
  /** A member's name in the form of gpu::ShaderInterface; empty for members outside the first element of an array. */
  static std::string reflected_name(const std::string &block, std::string name)
  {
    if (name.starts_with(block + ".")) {
      name.erase(0, block.size() + 1);
    }
    if (name.ends_with("[0]")) {
      name.resize(name.size() - 3);
    }
    for (std::size_t i = name.find('['); i != std::string::npos; i = name.find('[', i + 1)) {
      if (name.substr(i, 3) != "[0]") {
        return {};
      }
    }
    return name;
  }

  GLuint program_;
  std::string log_;
};

Offsets offsets_of(const std::vector<gpu::ShaderInterface::Member> &members)
{
  Offsets offsets;
  for (const gpu::ShaderInterface::Member &member : members) {
    offsets[member.name] = int(member.offset_bytes);
  }
  return offsets;
}

/** Compares one variant after another with the driver, and collects what some variant must have. */
class DriverAgreement : public test::GlDeviceTest {
 protected:
  /** Checks \a variants of each program, and that some of them use each block. */
  void check(std::vector<Feature> (*variants)(const ShaderDeclaration &declaration))
  {
    for (const ShaderDeclaration &declaration : shader_declarations()) {
      for (const Feature features : variants(declaration)) {
        const gpu::ShaderDesc desc = shader_desc(declaration, features);
        SCOPED_TRACE(fmt::format("{} {}", desc.name, fmt::join(desc.defines, " ")));
        const std::vector<gpu::ShaderSource> stages = gpu::preprocess(desc, shaders::file);
        gpu::ShaderInterface interface;
        ASSERT_NO_THROW(interface = shader_check::reflect(desc.name, stages)) << "glslang";
        const DriverProgram program(stages);
        ASSERT_TRUE(program.is_linked()) << device->description() << ":\n" << program.log();
        EXPECT_EQ(program.log(), "");
        check_blocks(interface, program);
        check_textures(interface, program);
        check_structs(program);
      }
    }
    EXPECT_EQ(compared_, declared_);
    EXPECT_GT(texture_count_, 0);
    EXPECT_EQ(structs_.size(), block_layouts().size());
  }

 private:
  void check_blocks(const gpu::ShaderInterface &interface, const DriverProgram &program)
  {
    std::set<std::string> names;
    for (const BindingKind kind : {BindingKind::UniformBlock, BindingKind::StorageBlock}) {
      const auto blocks = program.blocks(kind);
      if (kind == BindingKind::UniformBlock && interface.push_constant_size_bytes > 0) {
        compare(std::string(gpu::push_constant_block_name), interface.push_constant_slot,
                interface.push_constant_size_bytes, offsets_of(interface.push_constant_members), blocks);
        names.emplace(gpu::push_constant_block_name);
      }
      for (const gpu::ShaderInterface::Binding &binding : interface.bindings) {
        if (binding.kind == kind) {
          compare(binding.name, binding.slot, binding.size_bytes, offsets_of(binding.members), blocks);
          names.insert(binding.name);
        }
      }
      for (const auto &[name, block] : blocks) {
        EXPECT_TRUE(names.contains(name)) << "the driver alone knows " << name;
      }
    }
  }

  void check_textures(const gpu::ShaderInterface &interface, const DriverProgram &program)
  {
    for (const auto &[name, slot] : program.textures()) {
      const gpu::ShaderInterface::Binding *binding = interface.find(BindingKind::Texture, name);
      ASSERT_NE(binding, nullptr) << name;
      EXPECT_EQ(binding->slot, slot) << name;
      texture_count_++;
    }
  }

  /** Compares the driver's blocks with the structs of C++. */
  void check_structs(const DriverProgram &program)
  {
    for (const BindingKind kind : {BindingKind::UniformBlock, BindingKind::StorageBlock}) {
      for (const auto &[name, block] : program.blocks(kind)) {
        const auto layout = std::ranges::find(block_layouts(), name, &gpu::BlockLayout::name);
        if (layout == block_layouts().end()) {
          EXPECT_EQ(name, gpu::push_constant_block_name) << "no struct of C++ is compared with it";
          continue;
        }
        structs_.insert(layout->name);
        // Arrays without a size are reported with one element.
        EXPECT_EQ(std::size_t(block.size_bytes), layout->size_bytes) << name;
        Offsets offsets;
        for (const auto &field : layout->fields) {
          offsets[std::string(field.name)] = int(field.offset_bytes);
        }
        EXPECT_EQ(block.offsets, offsets) << name;
      }
    }
  }

  /** Names of blocks that some variant declares, and of those that the driver has in some variant. */
  std::set<std::string> declared_;
  std::set<std::string> compared_;
  std::set<std::string_view> structs_;
  int texture_count_ = 0;

  void compare(const std::string &name, int slot, std::uint32_t size_bytes, const Offsets &offsets,
               const std::map<std::string, DriverProgram::Block> &blocks)
  {
    declared_.insert(name);
    const auto found = blocks.find(name);
    if (found == blocks.end()) {
      // This variant does not use it. Another variant must.
      return;
    }
    compared_.insert(name);
    EXPECT_EQ(found->second.slot, slot) << name;
    EXPECT_EQ(found->second.size_bytes, int(size_bytes)) << name;
    EXPECT_EQ(found->second.offsets, offsets) << name;
  }
};

// The compilers take nearly all of the time of these tests.
TEST_F(DriverAgreement, BothCompilersAcceptEachPairOfFeaturesWithoutWarningsAndHaveTheSameInterface)
{
  check(test::pairwise_variants);
}

using SlowDriverAgreement = DriverAgreement;

TEST_F(SlowDriverAgreement, BothCompilersAcceptEveryVariantWithoutWarningsAndHaveTheSameInterface)
{
  check(shader_variants);
}

}  // namespace
}  // namespace gnomon::eevee
