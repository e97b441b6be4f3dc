// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_buffer.hh"
#include "gpu_framebuffer.hh"
#include "gpu_state.hh"

#include <optional>
#include <span>

namespace gnomon::gpu {

class Device;

enum class CommandKind : std::uint32_t {
  BeginPass,
  EndPass,
  SetShader,
  SetState,
  BindUniform,
  BindStorage,
  BindTexture,
  PushConstants,
  Draw,
  DrawProcedural,
  Update,
};

/** Vertex input `draw_instance` of one instance of a draw. */
struct DrawInstance {
  /** Index in the object block. */
  std::uint32_t object = 0;
  /** Meaning defined by the shader, such as the ordinal of an instance or a cube face. */
  std::uint32_t value = 0;
};

/** An indexed draw, in the layout of indirect draws in OpenGL and Vulkan. */
struct DrawIndirect {
  std::uint32_t index_count = 0;
  std::uint32_t instance_count = 0;
  std::uint32_t first_index = 0;
  std::int32_t base_vertex = 0;
  /** Index in CommandList::instances. */
  std::uint32_t first_instance = 0;
};

/** The meaning of `slot`, `id`, `first` and `count` depends on the kind; see the functions of CommandList. */
struct Command {
  CommandKind kind = CommandKind::EndPass;
  std::uint32_t slot = 0;
  ResourceId id = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/**
 * Work for a device as plain data: flat arrays that name resources by id. A list may be recorded on one thread and
 * submitted on another, submitted several times, printed and compared. It keeps no resource alive; validate() and
 * Device::submit report ids of destroyed resources.
 *
 * Draws must be recorded between begin_pass and end_pass, updates outside of passes. Shader, bindings and push
 * constants stay in effect until they are replaced or the list ends. The state must be set in each pass.
 */
class CommandList {
 public:
  /** Begin to draw into \a framebuffer. \a actions: the treatment of its content, and the viewport. */
  void begin_pass(std::string_view name, const Framebuffer &framebuffer, const PassActions &actions);
  /** The same for a framebuffer of the host's. LoadAction::DontCare keeps the content. */
  void begin_pass(std::string_view name, const HostFramebuffer &framebuffer, const PassActions &actions);
  void end_pass();

  void set_shader(ResourceId shader);
  void set_state(State state);
  void bind_uniform(int slot, const BufferRange &range);
  void bind_storage(int slot, const BufferRange &range);
  /** 0 and 0: no texture. A shader that declares the texture then reads zeros, and 1 from a depth comparison. */
  void bind_texture(int slot, ResourceId texture, ResourceId sampler);
  /**
   * Set the content of the block push_constant_block_name of later draws, at its slot. Copies \a bytes.
   * \return the copy, which may be written until the next call
   */
  std::span<std::byte> push_constants(int slot, std::span<const std::byte> bytes);
  /** Draw `draws[first, first + count)` with the current shader, state and bindings. */
  void draw(std::uint32_t first, std::uint32_t count);
  /** Draw triangles of \a vertex_count vertices without attributes. */
  void draw_procedural(std::uint32_t vertex_count, std::uint32_t instance_count);
  /** Write \a bytes to the buffer, in order with the other commands. They are copied now. */
  void update(const Buffer &buffer, std::size_t offset_bytes, std::span<const std::byte> bytes);

  void clear();

  /** Appended by the caller, before the draw() that refers to them. */
  std::vector<DrawIndirect> draws;
  std::vector<DrawInstance> instances;

  struct PassInfo {
    /** \see name_of */
    std::uint32_t name_first = 0;
    std::uint32_t name_size = 0;
    /** 0: `host_framebuffer`. */
    ResourceId framebuffer = 0;
    PassActions actions{};
    std::optional<HostFramebuffer> host_framebuffer{};
  };
  [[nodiscard]] const std::vector<Command> &commands() const
  {
    return commands_;
  }
  /** Indexed by `first` of BeginPass. */
  [[nodiscard]] const std::vector<PassInfo> &passes() const
  {
    return passes_;
  }
  [[nodiscard]] std::string_view name_of(const PassInfo &pass) const
  {
    return std::string_view(names_).substr(pass.name_first, pass.name_size);
  }
  /**
   * Data of PushConstants and Update: `first` is the offset in it and `count` the size. `slot` of Update is the offset
   * in the written buffer.
   */
  [[nodiscard]] const std::vector<std::byte> &bytes() const
  {
    return bytes_;
  }

  /** One line for each command. \a device supplies the names of the resources. */
  [[nodiscard]] std::string serialize(const Device &device) const;

 private:
  void begin_pass(std::string_view name, PassInfo pass);
  std::uint32_t append_bytes(std::span<const std::byte> bytes);

  std::vector<Command> commands_;
  std::vector<PassInfo> passes_;
  /** Of all passes, one after the other, so that a list that is cleared and filled again allocates nothing. */
  std::string names_;
  std::vector<std::byte> bytes_;
};

}  // namespace gnomon::gpu
