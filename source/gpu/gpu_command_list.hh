// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_buffer.hh"
#include "gpu_framebuffer.hh"
#include "gpu_state.hh"

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

/** What an instance of a draw hands to its vertex shader, as the input `draw_instance`. */
struct DrawInstance {
  /** Index in the object block. */
  std::uint32_t object = 0;
  /** For the shader to interpret: the ordinal of an instance, a cube face. */
  std::uint32_t value = 0;
};

/** The layout that indirect draws have in OpenGL and Vulkan alike. */
struct DrawIndirect {
  std::uint32_t index_count = 0;
  std::uint32_t instance_count = 0;
  std::uint32_t first_index = 0;
  std::int32_t base_vertex = 0;
  /** Index in CommandList::instances. */
  std::uint32_t first_instance = 0;
};

/** What `slot`, `id`, `first` and `count` mean depends on the kind; see CommandList's functions. */
struct Command {
  CommandKind kind = CommandKind::EndPass;
  std::uint32_t slot = 0;
  ResourceId id = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/**
 * Work for a device, as plain data: flat arrays, resources by id. May be filled on one thread and submitted on
 * another, submitted again, printed and compared. Keeps no resource alive.
 *
 * Draws stand between begin_pass and end_pass; updates outside of them.
 */
class CommandList {
 public:
  /** Nothing of the framebuffer but what \a actions say survives. The viewport is the whole framebuffer. */
  void begin_pass(std::string_view name, const Framebuffer &framebuffer, const PassActions &actions);
  void end_pass();

  void set_shader(ResourceId shader);
  void set_state(State state);
  void bind_uniform(int slot, const BufferRange &range);
  void bind_storage(int slot, const BufferRange &range);
  /** 0 and 0: none, for a shader that declares the texture and will not look it up. */
  void bind_texture(int slot, ResourceId texture, ResourceId sampler);
  /** For the block push_constant_block_name of the shader set before, at its slot. Copies \a bytes. */
  void push_constants(int slot, std::span<const std::byte> bytes);
  /** `draws[first, first + count)`, with the shader, state and bindings set before. */
  void draw(std::uint32_t first, std::uint32_t count);
  /** \a vertex_count vertices without attributes. */
  void draw_procedural(std::uint32_t vertex_count, std::uint32_t instance_count);
  /** Copies \a bytes now, writes them to the buffer in order with the other commands. */
  void update(const Buffer &buffer, std::size_t offset_bytes, std::span<const std::byte> bytes);

  void clear();

  /** Filled by the caller, before the draw() that names their range. */
  std::vector<DrawIndirect> draws;
  std::vector<DrawInstance> instances;

  struct PassInfo {
    std::string name;
    ResourceId framebuffer = 0;
    PassActions actions;
  };
  [[nodiscard]] const std::vector<Command> &commands() const
  {
    return commands_;
  }
  /** BeginPass: `first` is the index here. */
  [[nodiscard]] const std::vector<PassInfo> &passes() const
  {
    return passes_;
  }
  /** PushConstants and Update: `first` is the offset here, `count` the size; of Update, `slot` is the offset there. */
  [[nodiscard]] const std::vector<std::byte> &bytes() const
  {
    return bytes_;
  }

  /** One line a command, resources by the names \a device has for them. */
  [[nodiscard]] std::string serialize(const Device &device) const;

 private:
  std::uint32_t append_bytes(std::span<const std::byte> bytes);

  std::vector<Command> commands_;
  std::vector<PassInfo> passes_;
  std::vector<std::byte> bytes_;
};

}  // namespace gnomon::gpu
