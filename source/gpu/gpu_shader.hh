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

/** Returns the text of a shader file by its path below `shaders/`; empty where there is no such file. */
using ShaderFiles = std::function<std::optional<std::string_view>(std::string_view path)>;

/** Returns the path that `#include "NAMED"` in the file \a includer refers to. */
using IncludePath = std::function<std::string(std::string_view named, std::string_view includer)>;

/** Description of a shader program. */
struct ShaderDesc {
  std::string name;
  /** Paths below `shaders/`. The geometry path may be empty. Each file begins with `#version 450 core`. */
  std::string vertex_path;
  std::string geometry_path;
  std::string fragment_path;
  /** "NAME" or "NAME value", defined in every stage. */
  std::vector<std::string> defines;
};

enum class BindingKind : std::uint8_t { UniformBlock, StorageBlock, Texture };

[[nodiscard]] std::string_view to_string(BindingKind kind);

/** Name of the block of small per-group values; see ShaderInterface::push_constant_members. */
inline constexpr std::string_view push_constant_block_name = "push_constant_block";

/**
 * Inputs of a shader by name. glslang reflects them (shader_check_reflection.hh), so that they do not depend on the
 * driver.
 */
struct ShaderInterface {
  struct Member {
    /** Name of a block's member with arrays and structs resolved, such as `lights[0].color`. */
    std::string name;
    std::uint32_t offset_bytes = 0;
    /** Up to the next member, including padding. */
    std::uint32_t size_bytes = 0;

    bool operator==(const Member &) const = default;
  };
  struct Binding {
    /** Name of the block, not of its instance; name of the sampler. */
    std::string name;
    BindingKind kind = BindingKind::UniformBlock;
    /** `layout(binding = …)`. */
    int slot = 0;
    /** Blocks: std140 size. Textures: 0. */
    std::uint32_t size_bytes = 0;
    /** Blocks: sorted by offset; of an array, the first element only. */
    std::vector<Member> members;
    /** Stages that read it: bit 0 vertex, bit 1 geometry, bit 2 fragment; 0: not known. */
    std::uint32_t stages = 0;

    /** Without `stages`: variants of one program read a block in different stages. */
    bool operator==(const Binding &other) const
    {
      return std::tie(name, kind, slot, size_bytes, members) ==
             std::tie(other.name, other.kind, other.slot, other.size_bytes, other.members);
    }
  };
  /** Sorted by kind, then slot, without the push-constant block. */
  std::vector<Binding> bindings;
  /** Members of the block push_constant_block_name, by offset. */
  std::vector<Member> push_constant_members;
  /** 0: the shader has no such block. */
  std::uint32_t push_constant_size_bytes = 0;
  /** Uniform slot of the block, for an API without push constants. */
  int push_constant_slot = 0;

  bool operator==(const ShaderInterface &) const = default;

  /** nullptr: the shader has no such binding. */
  [[nodiscard]] const Binding *find(BindingKind kind, std::string_view name) const;
  [[nodiscard]] const Member *find_push_constant(std::string_view name) const;
};

/** The layout of a block as C++ has it; shader_check compares it with GLSL's. */
struct BlockLayout {
  struct Field {
    /** As in ShaderInterface::Member; of an array the first element: `light_data.lights[0].color`. */
    std::string_view name;
    std::size_t offset_bytes;
  };
  /** The name of the block in GLSL. */
  std::string_view name;
  /** Of a storage block that is an array: the size of one entry. */
  std::size_t size_bytes;
  std::span<const Field> fields;
};

/** A linked program. */
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

enum class ShaderStage : std::uint8_t { Vertex, Geometry, Fragment };

[[nodiscard]] std::string_view to_string(ShaderStage stage);

/** Source of one stage with includes resolved, as glslang and the driver compile it. */
struct ShaderSource {
  ShaderStage stage = ShaderStage::Vertex;
  std::string text;
  /** Path by source string number of `#line`. */
  std::vector<std::string> files;

  /** \a log with `N:LINE` or `N(LINE)` at the start of a message replaced by `FILE:LINE`. */
  [[nodiscard]] std::string name_files(std::string_view log) const;
};

/** A mistake in a shader file; the message begins with `FILE:LINE: `. */
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
 * Insert includes and defines. Without \a include_path, `#include "PATH"` refers to a path below `shaders/`. Each file
 * is included once in a stage, so that headers need no guard and cycles end.
 *
 * \throws SourceError for an include that does not exist and for a stage without `#version`; Error for a stage's file
 * that does not exist.
 */
[[nodiscard]] std::vector<ShaderSource> preprocess(const ShaderDesc &desc, const ShaderFiles &files,
                                                   const IncludePath &include_path = {});

/**
 * Returns the interface of the program \a name with these \a stages, or throws Error. A table that the build generates
 * gives it for an engine's own shaders (gpu_interface_table.hh). For shaders that are known at run time only, pass
 * shader_check::reflect, which needs the library gnomon::shader_check.
 */
using ShaderReflection = std::function<ShaderInterface(std::string_view name, const std::vector<ShaderSource> &stages)>;

}  // namespace gnomon::gpu
