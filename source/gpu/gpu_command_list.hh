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
  BindInstances,
  BindHostBatch,
  PushConstants,
  Draw,
  DrawProcedural,
  Update,
};

/** An instance of the list: the vertex input `draw_instance`. \see CommandList::bind_instances */
struct DrawInstance {
  /** Index of an object in `object_block`. */
  std::uint32_t object = 0;
  /** The shader defines its meaning, for example a cube face. */
  std::uint32_t value = 0;
};

/** An indexed draw, in the memory layout of indirect draws in OpenGL and Vulkan. */
struct DrawIndirect {
  std::uint32_t index_count = 0;
  std::uint32_t instance_count = 0;
  std::uint32_t first_index = 0;
  std::int32_t base_vertex = 0;
  /** Index in CommandList::instances, or of an object. \see CommandList::bind_instances */
  std::uint32_t first_instance = 0;
};

/** One command. The meaning of `slot`, `id`, `first` and `count` depends on the kind; see CommandList. */
struct Command {
  CommandKind kind = CommandKind::EndPass;
  std::uint32_t slot = 0;
  ResourceId id = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/**
 * Commands for a device as plain data: flat arrays that name resources by id. A list may be recorded on one thread and
 * submitted on another, and it may be submitted several times and printed. It keeps no resource alive; validate() and
 * Device::submit report ids of destroyed resources.
 *
 * Record draws between begin_pass and end_pass, and updates outside of passes. Shader, bindings and push constants stay
 * in effect until they are replaced or the list ends. The state must be set in each pass.
 */
class CommandList {
 public:
  /** Begin a pass that draws into \a framebuffer. */
  void begin_pass(std::string_view name, const Framebuffer &framebuffer, const PassActions &actions);
  /** The same for a framebuffer of the host. LoadAction::DontCare and StoreAction::DontCare keep its content. */
  void begin_pass(std::string_view name, const HostFramebuffer &framebuffer, const PassActions &actions);
  void end_pass();

  void set_shader(ResourceId shader);
  void set_state(State state);
  void bind_uniform(int slot, const BufferRange &range);
  void bind_storage(int slot, const BufferRange &range);
  /**
   * \a texture and \a sampler may both be 0: a lookup then returns zeros, and a depth comparison with a reference of at
   * least 0 returns 1.
   */
  void bind_texture(int slot, ResourceId texture, ResourceId sampler);
  /**
   * Take the instances of the following draws from \a objects, an array of shared::ObjectData: the fields of an object
   * are vertex inputs of its instance. 0: take them from `instances`, as draws do before the first call.
   */
  void bind_instances(ResourceId objects);
  /**
   * The following draws draw parts of the batch \a host_batch, which is in buffers of the host. 0: of batches in the
   * shared buffers, as before the first call.
   */
  void bind_host_batch(ResourceId host_batch);
  /**
   * Set the content of the push-constant block for the following draws. \a slot: ShaderInterface::push_constant_slot.
   * \return the copy of \a bytes in this list, which the caller may change until the next call
   */
  std::span<std::byte> push_constants(int slot, std::span<const std::byte> bytes);
  /** Draw the entries [first, first + count) of `draws` with the current shader, state and bindings. */
  void draw(std::uint32_t first, std::uint32_t count);
  /** Draw triangles without vertex attributes. \a vertex_count: three for each triangle */
  void draw_procedural(std::uint32_t vertex_count, std::uint32_t instance_count);
  /** Write \a bytes to \a buffer between the preceding and the following commands. The bytes are copied now. */
  void update(const Buffer &buffer, std::size_t offset_bytes, std::span<const std::byte> bytes);

  void clear();

  /** The caller appends entries before it calls the draw() that refers to them. */
  std::vector<DrawIndirect> draws;
  std::vector<DrawInstance> instances;

  struct PassInfo {
    /** \see name_of */
    std::uint32_t name_first = 0;
    std::uint32_t name_size = 0;
    /** 0: the pass draws into `host_framebuffer`. */
    ResourceId framebuffer = 0;
    PassActions actions{};
    std::optional<HostFramebuffer> host_framebuffer{};
  };
  [[nodiscard]] const std::vector<Command> &commands() const
  {
    return commands_;
  }
  /** Indexed by Command::first of BeginPass. */
  [[nodiscard]] const std::vector<PassInfo> &passes() const
  {
    return passes_;
  }
  [[nodiscard]] std::string_view name_of(const PassInfo &pass) const
  {
    return std::string_view(names_).substr(pass.name_first, pass.name_size);
  }
  /**
   * Data of the commands PushConstants and Update. Command::first is the offset in this array and Command::count the
   * size. Command::slot of Update is the offset in the written buffer.
   */
  [[nodiscard]] const std::vector<std::byte> &bytes() const
  {
    return bytes_;
  }

  /** Text with one line for each command. \a device supplies the names of the resources. */
  [[nodiscard]] std::string serialize(const Device &device) const;

 private:
  void begin_pass(std::string_view name, PassInfo pass);
  std::uint32_t append_bytes(std::span<const std::byte> bytes);

  std::vector<Command> commands_;
  std::vector<PassInfo> passes_;
  /** Names of all passes in one string, so that refilling a cleared list allocates no memory. */
  std::string names_;
  std::vector<std::byte> bytes_;
};

}  // namespace gnomon::gpu
