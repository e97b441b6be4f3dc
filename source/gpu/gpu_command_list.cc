// SPDX-License-Identifier: MIT
#include "gpu_command_list.hh"

#include "gpu_device.hh"

namespace gnomon::gpu {

void CommandList::begin_pass(std::string_view name, const Framebuffer &framebuffer, const PassActions &actions)
{
  begin_pass(name, {.framebuffer = framebuffer.id(), .actions = actions});
}

void CommandList::begin_pass(std::string_view name, const HostFramebuffer &framebuffer, const PassActions &actions)
{
  begin_pass(name, {.actions = actions, .host_framebuffer = framebuffer});
}

void CommandList::begin_pass(std::string_view name, PassInfo pass)
{
  pass.name_first = std::uint32_t(names_.size());
  pass.name_size = std::uint32_t(name.size());
  names_ += name;
  commands_.push_back({.kind = CommandKind::BeginPass, .id = pass.framebuffer, .first = std::uint32_t(passes_.size())});
  passes_.push_back(pass);
}

void CommandList::end_pass()
{
  commands_.push_back({.kind = CommandKind::EndPass});
}

void CommandList::set_shader(ResourceId shader)
{
  commands_.push_back({.kind = CommandKind::SetShader, .id = shader});
}

void CommandList::set_state(State state)
{
  commands_.push_back({.kind = CommandKind::SetState, .first = std::uint32_t(state)});
}

void CommandList::bind_uniform(int slot, const BufferRange &range)
{
  commands_.push_back(
      {CommandKind::BindUniform, std::uint32_t(slot), range.buffer, range.offset_bytes, range.size_bytes});
}

void CommandList::bind_storage(int slot, const BufferRange &range)
{
  commands_.push_back(
      {CommandKind::BindStorage, std::uint32_t(slot), range.buffer, range.offset_bytes, range.size_bytes});
}

void CommandList::bind_texture(int slot, ResourceId texture, ResourceId sampler)
{
  commands_.push_back({.kind = CommandKind::BindTexture, .slot = std::uint32_t(slot), .id = texture, .first = sampler});
}

void CommandList::bind_instances(ResourceId objects)
{
  commands_.push_back({.kind = CommandKind::BindInstances, .id = objects});
}

void CommandList::bind_host_batch(ResourceId host_batch)
{
  commands_.push_back({.kind = CommandKind::BindHostBatch, .id = host_batch});
}

std::span<std::byte> CommandList::push_constants(int slot, std::span<const std::byte> bytes)
{
  commands_.push_back(
      {CommandKind::PushConstants, std::uint32_t(slot), 0, append_bytes(bytes), std::uint32_t(bytes.size())});
  return std::span(bytes_).last(bytes.size());
}

void CommandList::draw(std::uint32_t first, std::uint32_t count)
{
  commands_.push_back({.kind = CommandKind::Draw, .first = first, .count = count});
}

void CommandList::draw_procedural(std::uint32_t vertex_count, std::uint32_t instance_count)
{
  commands_.push_back({.kind = CommandKind::DrawProcedural, .first = vertex_count, .count = instance_count});
}

void CommandList::update(const Buffer &buffer, std::size_t offset_bytes, std::span<const std::byte> bytes)
{
  GNOMON_ASSERT(buffer && offset_bytes + bytes.size() <= buffer.size_bytes(), "{} bytes at {} do not fit into {}",
                bytes.size(), offset_bytes, buffer.size_bytes());
  commands_.push_back({CommandKind::Update, std::uint32_t(offset_bytes), buffer.id(), append_bytes(bytes),
                       std::uint32_t(bytes.size())});
}

void CommandList::clear()
{
  draws.clear();
  instances.clear();
  commands_.clear();
  passes_.clear();
  names_.clear();
  bytes_.clear();
}

std::uint32_t CommandList::append_bytes(std::span<const std::byte> bytes)
{
  const auto first = std::uint32_t(bytes_.size());
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  return first;
}

static std::string_view to_string(LoadAction action)
{
  switch (action) {
    case LoadAction::Load: return "load";
    case LoadAction::Clear: return "clear";
    case LoadAction::DontCare: return "dont_care";
  }
  return "?";
}

static std::string_view to_string(StoreAction action)
{
  return action == StoreAction::Store ? "store" : "dont_care";
}

/** Returns text such as " bias -1, -2", the constant and the slope, or an empty string for none. */
static std::string to_string(const DepthBias &bias)
{
  return bias == DepthBias() ? "" : fmt::format(" bias {}, {}", bias.constant, bias.slope);
}

/** Returns text such as " viewport 4x3 at 1,2", or an empty string for the whole framebuffer. */
static std::string to_string(std::string_view what, const Rectangle &rectangle)
{
  if (rectangle.is_whole()) {
    return {};
  }
  const glm::ivec2 origin = rectangle.origin_px;
  return fmt::format("{} {}x{}{}", what, rectangle.size_px.x, rectangle.size_px.y,
                     origin == glm::ivec2(0) ? "" : fmt::format(" at {},{}", origin.x, origin.y));
}

std::string CommandList::serialize(const Device &device) const
{
  const auto name = [&](ResourceKind kind, ResourceId id) { return device.name_of(kind, id); };
  constexpr std::array<std::string_view, 3> primitive_names = {"points", "lines", "triangles"};
  State state = State::None;
  std::string text;
  for (const Command &command : commands_) {
    switch (command.kind) {
      case CommandKind::BeginPass: {
        const PassInfo &pass = passes_[command.first];
        const PassActions &a = pass.actions;
        text += fmt::format("begin {} -> {} color {}/{} depth {}/{}{}{}{}{}{}\n", name_of(pass),
                            pass.host_framebuffer ? "host framebuffer" : name(ResourceKind::Framebuffer, command.id),
                            to_string(a.color_load), to_string(a.color_store), to_string(a.depth_load),
                            to_string(a.depth_store), to_string(a.depth_bias), to_string(" viewport", a.viewport),
                            to_string(" scissor", a.scissor), a.is_srgb_encoded ? " srgb" : "",
                            a.reads_attachments ? " reads attachments" : "");
        break;
      }
      case CommandKind::EndPass: text += "end\n"; break;
      case CommandKind::SetShader: text += fmt::format("  shader {}\n", name(ResourceKind::Shader, command.id)); break;
      case CommandKind::SetState:
        state = State(command.first);
        text += fmt::format("  state {}\n", gpu::to_string(state));
        break;
      case CommandKind::BindUniform:
      case CommandKind::BindStorage:
        text += fmt::format("  {} {} -> {}", command.kind == CommandKind::BindUniform ? "uniform" : "storage",
                            name(ResourceKind::Buffer, command.id), command.slot);
        text += command.count > 0   ? fmt::format(" [{}, {})\n", command.first, command.first + command.count)
                : command.first > 0 ? fmt::format(" [{}, end)\n", command.first)
                                    : "\n";
        break;
      case CommandKind::BindTexture:
        text += fmt::format("  texture {} {} -> {}\n", name(ResourceKind::Texture, command.id),
                            name(ResourceKind::Sampler, command.first), command.slot);
        break;
      case CommandKind::BindInstances:
        text +=
            fmt::format("  instances of {}\n", command.id == 0 ? "the list" : name(ResourceKind::Buffer, command.id));
        break;
      case CommandKind::BindHostBatch:
        text += command.id == 0 ? "  shared batches\n"
                                : fmt::format("  batch {} of the host\n", name(ResourceKind::Batch, command.id));
        break;
      case CommandKind::PushConstants: text += fmt::format("  push_constants {} bytes\n", command.count); break;
      case CommandKind::Draw:
        for (std::uint32_t i = command.first; i < command.first + command.count; i++) {
          const DrawIndirect &d = draws[i];
          text += fmt::format("  draw {} {} x{}, instances from {}\n", d.index_count / primitive_size(state),
                              primitive_names[primitive_size(state) - 1], d.instance_count, d.first_instance);
        }
        break;
      case CommandKind::DrawProcedural:
        text += fmt::format("  draw_procedural {} vertices x{}\n", command.first, command.count);
        break;
      case CommandKind::Update:
        text += fmt::format("update {} {} bytes at {}\n", name(ResourceKind::Buffer, command.id), command.count,
                            command.slot);
        break;
    }
  }
  return text;
}

}  // namespace gnomon::gpu
