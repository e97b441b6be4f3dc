// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_error.hh"
#include "gpu_resource.hh"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gnomon::gpu {

/** Returns the text of a shader file by its path below `shaders/`; nothing if there is no such file. */
using ShaderFiles = std::function<std::optional<std::string_view>(std::string_view path)>;

/** Returns the path that `#include "NAMED"` in the file \a includer refers to. */
using IncludePath = std::function<std::string(std::string_view named, std::string_view includer)>;

/** A shader as data. */
struct ShaderDesc {
  std::string name;
  /** Paths below `shaders/`. Geometry may be empty. Each begins with `#version 450 core`. */
  std::string vertex_path;
  std::string geometry_path;
  std::string fragment_path;
  /** "NAME" or "NAME value", defined in every stage. */
  std::vector<std::string> defines;
};

enum class BindingKind : std::uint8_t { UniformBlock, StorageBlock, Texture };

[[nodiscard]] std::string_view to_string(BindingKind kind);

/** The block of small per-group values; see ShaderInterface::push_constant_members. */
inline constexpr std::string_view push_constant_block_name = "push_constant_block";

/**
 * The blocks, textures and push constants that a program reads, by name. glslang reflects them
 * (shader_check_reflection.hh), so that they do not depend on the driver.
 */
struct ShaderInterface {
  struct Member {
    /** Of a block's member, arrays and structs resolved: `lights[0].color`. */
    std::string name;
    std::uint32_t offset_bytes = 0;
    /** Distance to the next member, so padding is included. */
    std::uint32_t size_bytes = 0;

    bool operator==(const Member &) const = default;
  };
  struct Binding {
    /** The name of the block, not of its instance; or the name of the sampler. */
    std::string name;
    BindingKind kind = BindingKind::UniformBlock;
    /** `layout(binding = …)`. */
    int slot = 0;
    /** Blocks: std140 size. Textures: 0. */
    std::uint32_t size_bytes = 0;
    /** Blocks: sorted by offset; of an array, the first element only. */
    std::vector<Member> members;

    bool operator==(const Binding &) const = default;
  };
  /** Sorted by kind, then slot. The push-constant block is not among them. */
  std::vector<Binding> bindings;
  /** Members of the block push_constant_block_name. */
  std::vector<Member> push_constant_members;
  /** 0: the program has no push constants. */
  std::uint32_t push_constant_size_bytes = 0;
  /** The uniform slot that stands for push constants where the API has none. */
  int push_constant_slot = 0;

  bool operator==(const ShaderInterface &) const = default;

  /** nullptr: the program reads nothing of this name. */
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

/** One stage with its includes in place. glslang and the driver both compile this text. */
struct ShaderSource {
  ShaderStage stage = ShaderStage::Vertex;
  std::string text;
  /** Source string number in `#line` → path. */
  std::vector<std::string> files;

  /** \a log with the position of each message, `N:LINE` or `N(LINE)`, replaced by `FILE:LINE`. */
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
 * Put includes and defines in place. Without \a include_path, the path in `#include "PATH"` is relative to `shaders/`.
 * Each stage includes a file once, so that headers need no guard and a cycle ends.
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
