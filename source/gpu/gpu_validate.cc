// SPDX-License-Identifier: MIT
#include "gpu_validate.hh"

#include "gpu_device.hh"

#include "draw_object_shared.h"

#include <algorithm>
#include <array>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::gpu {

namespace {

std::string_view name_of(CommandKind kind)
{
  switch (kind) {
    case CommandKind::BeginPass: return "begin_pass";
    case CommandKind::EndPass: return "end_pass";
    case CommandKind::SetShader: return "set_shader";
    case CommandKind::SetState: return "set_state";
    case CommandKind::BindUniform: return "bind_uniform";
    case CommandKind::BindStorage: return "bind_storage";
    case CommandKind::BindTexture: return "bind_texture";
    case CommandKind::BindInstances: return "bind_instances";
    case CommandKind::BindHostBatch: return "bind_host_batch";
    case CommandKind::PushConstants: return "push_constants";
    case CommandKind::Draw: return "draw";
    case CommandKind::DrawProcedural: return "draw_procedural";
    case CommandKind::Update: return "update";
  }
  return "?";
}

class Validator {
 public:
  Validator(const CommandList &list, const Device &device) : list_(list), device_(device) {}

  void run()
  {
    for (const Command &command : list_.commands()) {
      check(command);
      command_index_++;
    }
    if (pass_) {
      throw Error("command list: pass '{}' is not ended", list_.name_of(*pass_));
    }
  }

 private:
  /** The buffer range, texture or push constants of one slot. */
  struct Bound {
    int slot = 0;
    ResourceId id = 0;
    /** Buffers and push constants: size of the bound range. Textures: 0. */
    std::size_t size_bytes = 0;
  };

  template <typename... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> format, Args &&...args) const
  {
    const std::string reason = fmt::format(format, std::forward<Args>(args)...);
    throw Error("command list: {}, command {} ({}): {}",
                pass_ ? fmt::format("pass '{}'", list_.name_of(*pass_)) : std::string("outside of a pass"),
                command_index_, name_of(list_.commands()[command_index_].kind), reason);
  }

  /** Description of the resource \a id. Fails if \a id is 0 or stale. */
  const ResourceInfo &live(ResourceKind kind, ResourceId id) const
  {
    const ResourceInfo *info = id == 0 ? nullptr : device_.find(kind, id);
    if (!info) {
      fail("{} id {} (index {}, generation {}) is {}", to_string(kind), id, index_of(id), generation_of(id),
           id == 0 ? "0, which names no resource" : "stale: the resource was destroyed");
    }
    return *info;
  }

  void check(const Command &command)
  {
    switch (command.kind) {
      case CommandKind::BeginPass: begin_pass(command); break;
      case CommandKind::EndPass:
        if (!pass_) {
          fail("there is no pass to end");
        }
        pass_ = nullptr;
        break;
      case CommandKind::SetShader: shader_ = &live(ResourceKind::Shader, command.id); break;
      case CommandKind::SetState: set_state(State(command.first)); break;
      case CommandKind::BindUniform: bind_buffer(command, BufferKind::Uniform, uniforms_); break;
      case CommandKind::BindStorage: bind_buffer(command, BufferKind::Storage, storages_); break;
      case CommandKind::BindTexture: bind_texture(command); break;
      case CommandKind::BindInstances: bind_instances(command); break;
      case CommandKind::BindHostBatch: bind_host_batch(command); break;
      case CommandKind::PushConstants: push_constants_ = {int(command.slot), 0, command.count}; break;
      case CommandKind::Draw:
        check_draw_state();
        draw(command);
        break;
      case CommandKind::DrawProcedural: check_draw_state(); break;
      case CommandKind::Update: update(command); break;
    }
  }

  void begin_pass(const Command &command)
  {
    const CommandList::PassInfo &pass = list_.passes()[command.first];
    if (pass_) {
      fail("pass '{}' begins inside it", list_.name_of(pass));
    }
    pass_ = &pass;
    has_state_ = false;
    attachments_ = {};
    glm::ivec2 size_px;
    if (pass.host_framebuffer) {
      size_px = pass.host_framebuffer->size_px;
    }
    else {
      const auto &framebuffer = std::get<FramebufferInfo>(live(ResourceKind::Framebuffer, command.id).desc);
      attachments_ = framebuffer.attachments;
      size_px = framebuffer.size_px;
    }
    for (const AttachedTexture &attached : attachments_) {
      if (!device_.find(ResourceKind::Texture, attached.texture)) {
        fail("framebuffer {}: texture '{}' that is attached to it was destroyed", framebuffer_name(), attached.name);
      }
    }
    check_rectangle(size_px, "viewport", pass.actions.viewport);
    check_rectangle(size_px, "scissor", pass.actions.scissor);
  }

  /** Name of the current pass's framebuffer, for messages. */
  [[nodiscard]] std::string framebuffer_name() const
  {
    return pass_->host_framebuffer
               ? std::string("of the host")
               : fmt::format("'{}'", device_.name_of(ResourceKind::Framebuffer, pass_->framebuffer));
  }

  void check_rectangle(glm::ivec2 size_px, std::string_view what, const Rectangle &rectangle) const
  {
    const glm::ivec2 first = rectangle.origin_px;
    const glm::ivec2 end = first + rectangle.size_px;
    if (!rectangle.is_whole() && (first.x < 0 || first.y < 0 || rectangle.size_px.x < 1 || rectangle.size_px.y < 1 ||
                                  end.x > size_px.x || end.y > size_px.y)) {
      fail("framebuffer {}: a {} of {}x{} px at {},{} does not fit into {}x{} px", framebuffer_name(), what,
           rectangle.size_px.x, rectangle.size_px.y, first.x, first.y, size_px.x, size_px.y);
    }
  }

  static void set_bound(std::pmr::vector<Bound> &bounds, const Bound &bound)
  {
    const auto same = std::ranges::find(bounds, bound.slot, &Bound::slot);
    if (same == bounds.end()) {
      bounds.push_back(bound);
    }
    else {
      *same = bound;
    }
  }

  void check_slot(std::uint32_t slot) const
  {
    if (int(slot) < 0) {
      fail("slot {} is negative", int(slot));
    }
  }

  void bind_buffer(const Command &command, BufferKind kind, std::pmr::vector<Bound> &bounds)
  {
    check_slot(command.slot);
    const ResourceInfo &info = live(ResourceKind::Buffer, command.id);
    const auto &desc = std::get<BufferDesc>(info.desc);
    if (kind == BufferKind::Storage && desc.kind == BufferKind::Uniform) {
      fail("buffer '{}' is a uniform buffer", info.name);
    }
    const std::uint32_t alignment = device_.limits().uniform_offset_alignment;
    if (command.first % alignment != 0) {
      fail("buffer '{}': offset {} is no multiple of {}", info.name, command.first, alignment);
    }
    const std::size_t end = std::size_t(command.first) + command.count;
    if (end > desc.size_bytes || command.first >= desc.size_bytes) {
      fail("buffer '{}': bytes [{}, {}) exceed its {} bytes", info.name, command.first, end, desc.size_bytes);
    }
    const std::size_t size = command.count > 0 ? command.count : desc.size_bytes - command.first;
    const std::size_t max = device_.limits().uniform_block_bytes_max;
    if (kind == BufferKind::Uniform && size > max) {
      fail("buffer '{}': a range of {} bytes, and a uniform block of this device has at most {}", info.name, size, max);
    }
    set_bound(bounds, {int(command.slot), command.id, size});
  }

  void bind_texture(const Command &command)
  {
    check_slot(command.slot);
    if (command.id != 0 || command.first != 0) {
      const ResourceInfo &texture = live(ResourceKind::Texture, command.id);
      const ResourceInfo &sampler = live(ResourceKind::Sampler, command.first);
      const bool is_comparison = std::get<SamplerDesc>(sampler.desc).is_depth_comparison;
      const Format format = std::get<TextureDesc>(texture.desc).format;
      if (is_comparison && !is_depth(format)) {
        fail("sampler '{}' compares depths, and texture '{}' of format {} has none", sampler.name, texture.name,
             to_string(format));
      }
    }
    set_bound(textures_, {int(command.slot), command.id, 0});
  }

  void bind_instances(const Command &command)
  {
    objects_ = command.id == 0 ? nullptr : &live(ResourceKind::Buffer, command.id);
    if (objects_ && std::get<BufferDesc>(objects_->desc).kind != BufferKind::Storage) {
      fail("buffer '{}' is no storage buffer", objects_->name);
    }
  }

  void bind_host_batch(const Command &command)
  {
    host_batch_ = command.id == 0 ? nullptr : &live(ResourceKind::Batch, command.id);
    if (host_batch_ && std::get<BatchRange>(host_batch_->desc).host_batch == 0) {
      fail("batch '{}' is not in buffers of the host", host_batch_->name);
    }
  }

  /** Whether the draw stays within the bound batch of the host, or within live batches in the shared buffers. */
  [[nodiscard]] bool has_batch_data(const DrawIndirect &draw) const
  {
    if (!host_batch_) {
      return device_.has_batch_data(draw.first_index, draw.index_count, draw.base_vertex);
    }
    const auto &range = std::get<BatchRange>(host_batch_->desc);
    return draw.base_vertex == 0 && draw.first_index >= range.first_index &&
           std::size_t(draw.first_index) + draw.index_count <= std::size_t(range.first_index) + range.index_count;
  }

  void set_state(State state)
  {
    if (has(state, State::Wireframe) && !device_.limits().has_wireframe) {
      fail("this device draws no triangles as their edges (Limits::has_wireframe)");
    }
    has_state_ = true;
  }

  void check_draw_state() const
  {
    if (!pass_) {
      fail("a draw must be inside a pass");
    }
    if (!shader_) {
      fail("no shader is set");
    }
    if (!has_state_) {
      fail("shader '{}': no state is set in this pass", shader_->name);
    }
    const auto &interface = std::get<ShaderInterface>(shader_->desc);
    for (const ShaderInterface::Binding &binding : interface.bindings) {
      const bool is_texture = binding.kind == BindingKind::Texture;
      const std::pmr::vector<Bound> &bounds = is_texture                                  ? textures_
                                              : binding.kind == BindingKind::UniformBlock ? uniforms_
                                                                                          : storages_;
      const auto bound = std::ranges::find(bounds, binding.slot, &Bound::slot);
      if (bound == bounds.end()) {
        fail("shader '{}': {} '{}' at slot {} is not bound", shader_->name, to_string(binding.kind), binding.name,
             binding.slot);
      }
      if (is_texture) {
        check_sampled(binding, *bound);
      }
      else {
        check_block(binding, *bound);
      }
    }
    if (interface.push_constant_size_bytes > 0) {
      check_push_constants(interface);
    }
  }

  void check_block(const ShaderInterface::Binding &binding, const Bound &bound) const
  {
    const ResourceKind kind = ResourceKind::Buffer;
    const ResourceInfo &buffer = live(kind, bound.id);
    if (binding.kind == BindingKind::UniformBlock && bound.size_bytes < binding.size_bytes) {
      fail("shader '{}': uniform '{}' has {} bytes, and {} of buffer '{}' are bound", shader_->name, binding.name,
           binding.size_bytes, bound.size_bytes, buffer.name);
    }
  }

  void check_sampled(const ShaderInterface::Binding &binding, const Bound &bound) const
  {
    if (bound.id == 0 || pass_->actions.reads_attachments) {
      return;
    }
    for (const AttachedTexture &attached : attachments_) {
      if (attached.texture == bound.id) {
        fail("shader '{}': feedback loop: texture '{}' at slot {} ('{}') is attached to the framebuffer", shader_->name,
             attached.name, binding.slot, binding.name);
      }
    }
  }

  void check_push_constants(const ShaderInterface &interface) const
  {
    if (!push_constants_ || push_constants_->slot != interface.push_constant_slot) {
      fail("shader '{}': its push constants at slot {} are not set", shader_->name, interface.push_constant_slot);
    }
    const ShaderInterface::Member &last = interface.push_constant_members.back();
    const std::size_t needed = last.offset_bytes + last.size_bytes;
    if (push_constants_->size_bytes < needed || push_constants_->size_bytes > interface.push_constant_size_bytes) {
      fail("shader '{}': {} bytes of push constants are set, and its block has {}", shader_->name,
           push_constants_->size_bytes, interface.push_constant_size_bytes);
    }
  }

  void draw(const Command &command) const
  {
    if (!objects_ && std::get<ShaderInterface>(shader_->desc).reads_object) {
      fail("shader '{}' reads the object of a call, and the instances are those of the list", shader_->name);
    }
    const std::size_t end = std::size_t(command.first) + command.count;
    if (end > list_.draws.size()) {
      fail("draws [{}, {}) exceed the list's {} draws", command.first, end, list_.draws.size());
    }
    const std::size_t instance_count =
        objects_ ? std::get<BufferDesc>(objects_->desc).size_bytes / sizeof(shared::ObjectData)
                 : list_.instances.size();
    for (std::size_t i = command.first; i < end; i++) {
      const DrawIndirect &draw = list_.draws[i];
      const std::size_t instance_end = std::size_t(draw.first_instance) + draw.instance_count;
      if (instance_end > instance_count) {
        fail("draw {}: instances [{}, {}) exceed the {}", i, draw.first_instance, instance_end,
             objects_ ? fmt::format("{} objects of buffer '{}'", instance_count, objects_->name)
                      : fmt::format("list's {} instances", instance_count));
      }
      if (draw.index_count > 0 && draw.instance_count > 0 && !has_batch_data(draw)) {
        fail("draw {}: indices [{}, {}) from vertex {} on belong to {}", i, draw.first_index,
             std::size_t(draw.first_index) + draw.index_count, draw.base_vertex,
             host_batch_ ? fmt::format("more than batch '{}' of the host", host_batch_->name) : "no live batch");
      }
    }
  }

  void update(const Command &command) const
  {
    const ResourceInfo &info = live(ResourceKind::Buffer, command.id);
    if (pass_) {
      fail("buffer '{}' cannot be written inside a pass", info.name);
    }
    const std::size_t size = std::get<BufferDesc>(info.desc).size_bytes;
    const std::size_t end = std::size_t(command.slot) + command.count;
    if (end > size) {
      fail("buffer '{}': bytes [{}, {}) exceed its {} bytes", info.name, command.slot, end, size);
    }
  }

  const CommandList &list_;
  const Device &device_;
  std::size_t command_index_ = 0;
  /** nullptr: outside of a pass. */
  const CommandList::PassInfo *pass_ = nullptr;
  /** Attachments of the current pass's framebuffer. */
  std::span<const AttachedTexture> attachments_;
  const ResourceInfo *shader_ = nullptr;
  /** nullptr: instances are those of the list. */
  const ResourceInfo *objects_ = nullptr;
  /** nullptr: batches are those in the shared buffers. */
  const ResourceInfo *host_batch_ = nullptr;
  /** Whether the current pass has set a state. */
  bool has_state_ = false;
  // Memory of the vectors below. It usually suffices, so that validation allocates no heap memory.
  std::array<std::byte, 4096> memory_;
  std::pmr::monotonic_buffer_resource resource_{memory_.data(), memory_.size()};
  std::pmr::vector<Bound> uniforms_{&resource_};
  std::pmr::vector<Bound> storages_{&resource_};
  std::pmr::vector<Bound> textures_{&resource_};
  std::optional<Bound> push_constants_;
};

}  // namespace

void validate(const CommandList &list, const Device &device)
{
  Validator(list, device).run();
}

}  // namespace gnomon::gpu
