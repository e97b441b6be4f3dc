// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_error.hh"
#include "gpu_resource.hh"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace gnomon::gpu {

/**
 * Returns the text of the shader file at \a path, relative to `shaders/`; empty if the file does not exist. The text
 * must stay valid as long as a copy of the function exists. It is called on the thread of the call that needs the text.
 */
using ShaderFiles = std::function<std::optional<std::string_view>(std::string_view path)>;

/** Returns the path that `#include "NAMED"` in the file \a includer refers to, where NAMED is \a named. */
using IncludePath = std::function<std::string(std::string_view named, std::string_view includer)>;

/** The value of a specialisation constant: of a `const int`, or of a `const bool`, where 0 is false. */
struct ShaderConstant {
  std::string name;
  std::int32_t value = 0;
};

/** Description of a shader program. */
struct ShaderDesc {
  std::string name;
  /** Paths relative to `shaders/`. The geometry path may be empty. Each file must begin with `#version 450 core`. */
  std::string vertex_path;
  std::string geometry_path;
  std::string fragment_path;
  /** "NAME" or "NAME value", defined in every stage. */
  std::vector<std::string> defines;
  /**
   * Values of constants that the stages declare, each on a line `SPECIALIZATION_CONSTANT(ID) const TYPE NAME =
   * DEFAULT;` (shared/slots_shared.h). The others have their defaults. Vulkan compiles a text once for all values.
   */
  std::vector<ShaderConstant> constants{};
};

enum class BindingKind : std::uint8_t { UniformBlock, StorageBlock, Texture };

[[nodiscard]] std::string_view to_string(BindingKind kind);

/** GLSL name of the block that holds push constants. \see ShaderInterface::push_constant_members */
inline constexpr std::string_view push_constant_block_name = "push_constant_block";

/**
 * Named inputs of a shader. They are reflected by glslang (shader_check_reflection.hh), so they do not depend on the
 * driver.
 */
struct ShaderInterface {
  struct Member {
    /** Path of a member within its block, such as `lights[0].color`. */
    std::string name;
    std::uint32_t offset_bytes = 0;
    /** Distance to the next member, including padding. */
    std::uint32_t size_bytes = 0;

    bool operator==(const Member &) const = default;
  };
  struct Binding {
    /** Name of the block (not of its instance) or of the sampler. */
    std::string name;
    BindingKind kind = BindingKind::UniformBlock;
    /** `layout(binding = …)`. */
    int slot = 0;
    /** Blocks: std140 size. Textures: 0. */
    std::uint32_t size_bytes = 0;
    /** Blocks: sorted by offset. Arrays are listed by their first element. Textures: empty. */
    std::vector<Member> members;
    /** Mask of the stages that read the binding: bit 0 vertex, bit 1 geometry, bit 2 fragment; 0: unknown. */
    std::uint32_t stages = 0;

    /** Ignores `stages`, because variants of a program may read a block in different stages. */
    bool operator==(const Binding &other) const
    {
      return std::tie(name, kind, slot, size_bytes, members) ==
             std::tie(other.name, other.kind, other.slot, other.size_bytes, other.members);
    }
  };
  /** Sorted by kind and then by slot. Excludes the push-constant block. */
  std::vector<Binding> bindings;
  /** Members of the block push_constant_block_name, sorted by offset. */
  std::vector<Member> push_constant_members;
  /** 0: the shader has no such block. */
  std::uint32_t push_constant_size_bytes = 0;
  /** Uniform slot of the block in an API without push constants. */
  int push_constant_slot = 0;
  /** Whether the vertex shader reads fields of the object of a call. \see CommandList::bind_instances */
  bool reads_object = false;
  /** Number of locations, of four components each, up to the last one that a stage passes to the next. */
  int varying_locations = 0;

  bool operator==(const ShaderInterface &) const = default;

  /** nullptr: the shader has no such binding. */
  [[nodiscard]] const Binding *find(BindingKind kind, std::string_view name) const;
  [[nodiscard]] const Member *find_push_constant(std::string_view name) const;
};

/** Layout of a block in C++. shader_check compares it with the layout in GLSL. */
struct BlockLayout {
  struct Field {
    /** Path as in ShaderInterface::Member. Arrays have their first element: `light_data.lights[0].color`. */
    std::string_view name;
    std::size_t offset_bytes;
  };
  /** Name of the block in GLSL. */
  std::string_view name;
  /** Size of the block; of a storage block that is an array, the size of one element. */
  std::size_t size_bytes;
  std::span<const Field> fields;
};

/** A linked shader program. */
class Shader : public Resource {
 public:
  Shader() = default;
  [[nodiscard]] const std::string &name() const
  {
    return name_;
  }
  [[nodiscard]] const ShaderInterface &interface() const
  {
    return interface_;
  }

 private:
  friend class Device;
  Shader(Resource resource, std::string name, ShaderInterface interface)
      : Resource(std::move(resource)), name_(std::move(name)), interface_(std::move(interface))
  {
  }
  std::string name_;
  ShaderInterface interface_;
};

/** A program that its users on one device share. \see Device::shared_shader */
struct SharedShader {
  Shader shader;
  /** The reason, for users, why the program is not the one that was asked for; empty: it is. */
  std::string failure{};
};

enum class ShaderStage : std::uint8_t { Vertex, Geometry, Fragment };

[[nodiscard]] std::string_view to_string(ShaderStage stage);

/** Source of one stage after preprocess(). glslang and the driver compile this text. */
struct ShaderSource {
  ShaderStage stage = ShaderStage::Vertex;
  std::string text;
  /** Paths of the files, indexed by the source string number of `#line`. */
  std::vector<std::string> files;

  /** Returns \a log with the position `N:LINE` or `N(LINE)` of each message replaced by `FILE:LINE`. */
  [[nodiscard]] std::string name_files(std::string_view log) const;
};

/** An error in a shader file. The message begins with `FILE:LINE: `. */
struct SourceError : Error {
  SourceError(std::string source_file, int source_line, std::string_view reason)
      : Error("{}:{}: {}", source_file, source_line, reason),
        file(std::move(source_file)),
        line(source_line),
        text(reason)
  {
  }
  std::string file;
  int line;
  std::string text;
};

/**
 * Resolve includes and insert the defines of \a desc. Without \a include_path, `#include "PATH"` names a path relative
 * to `shaders/`. A stage includes each file once, so headers need no include guard and cyclic includes end.
 *
 * Lines that no compiler reads are empty, and their includes are not read, where this follows from the macros that the
 * text and \a desc define: most of the text of eevee's variants.
 *
 * \throws SourceError if an included file does not exist or a stage has no `#version`; Error if the file of a stage
 * does not exist
 */
[[nodiscard]] std::vector<ShaderSource> preprocess(const ShaderDesc &desc, const ShaderFiles &files,
                                                   const IncludePath &include_path = {});

/** The value of a specialisation constant of one stage. */
struct StageConstant {
  ShaderStage stage = ShaderStage::Vertex;
  std::uint32_t id = 0;
  std::int32_t value = 0;

  bool operator==(const StageConstant &) const = default;
};

/**
 * The constants of \a desc in its \a stages, sorted by stage; each id of a stage once.
 *
 * \throws Error that names the shader and the constant, if no stage declares it, or its type is not `int` or `bool`
 */
[[nodiscard]] std::vector<StageConstant> stage_constants(const ShaderDesc &desc,
                                                         const std::vector<ShaderSource> &stages);

/** \a text of a stage with the values of \a constants as defaults, for an API without specialisation. */
[[nodiscard]] std::string with_constants(std::string_view text, const std::vector<ShaderConstant> &constants);

/**
 * Returns the interface of the program \a name with these \a stages, or throws Error. The engines' shaders use a table
 * that the build generates (gpu_interface_table.hh). For shaders that are known only at run time, use
 * shader_check::reflect from the library gnomon::shader_check. It is called on the thread of the call that needs it.
 */
using ShaderReflection = std::function<ShaderInterface(std::string_view name, const std::vector<ShaderSource> &stages)>;

/** One stage of a program as SPIR-V for Vulkan. */
struct SpirvStage {
  ShaderStage stage = ShaderStage::Vertex;
  std::vector<std::uint32_t> words{};
};

/**
 * Compiles the \a stages of the program \a name for Vulkan, or throws Error that names file and line. A device of
 * Vulkan calls it on its thread. Use shader_check::compile_spirv from the library gnomon::shader_check.
 */
using SpirvCompiler =
    std::function<std::vector<SpirvStage>(std::string_view name, const std::vector<ShaderSource> &stages)>;

}  // namespace gnomon::gpu
