// SPDX-License-Identifier: MIT
// The create functions of Device: they check descriptions against the limits, and issue ids.
#include "gpu_device.hh"

#include "gpu_range_allocator.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <iterator>

namespace gnomon::gpu {

template <typename Create>
Resource Device::make(ResourceKind kind, ResourceInfo info, std::string detail, std::size_t size_bytes, Create &&create)
{
  std::vector<Slot> &slots = slots_[std::size_t(kind)];
  std::vector<ResourceId> &free_ids = free_ids_[std::size_t(kind)];
  if (free_ids.empty()) {
    if (slots.size() > resource_count_max) {
      throw Error("{} '{}': a device can hold at most {} of them", to_string(kind), info.name, resource_count_max);
    }
    free_ids.push_back(ResourceId(slots.size()));
    slots.emplace_back();
  }
  const ResourceId id = free_ids.back();
  perform({create(id)});
  slots_[std::size_t(kind)][index_of(id)] = {id, true, std::move(info), std::move(detail), size_bytes, 0};
  free_ids.pop_back();
  if (!recording_) {
    return {link_, kind, id};
  }
  InFlight &packet = in_flight_.back();
  if (!packet.link) {
    packet.link = std::make_shared<DeviceLink>(DeviceLink{this});
    packet_links_.push_back(packet.link);
  }
  packet.created.push_back({kind, id});
  return {packet.link, kind, id};
}

Texture Device::create_texture(const TextureDesc &desc)
{
  const auto in_range = [&](std::string_view what, int value, int max) {
    if (value < 1 || value > max) {
      throw Error("texture '{}': {} is {}, but this device supports 1 to {}", desc.name, what, value, max);
    }
  };
  const bool is_buffer = desc.kind == TextureKind::Buffer;
  in_range("width", desc.width, is_buffer ? limits_.buffer_texels_max : limits_.texture_size_max);
  in_range("height", desc.height, is_buffer ? 1 : limits_.texture_size_max);
  in_range("layer count", desc.layers, desc.kind == TextureKind::Array ? limits_.array_layers_max : 1);
  in_range("mip level count", desc.mip_levels,
           is_buffer ? 1 : int(std::bit_width(unsigned(std::max(desc.width, desc.height)))));
  GNOMON_ASSERT(!is_buffer || (!is_depth(desc.format) && desc.format != Format::SRGB8A8),
                "texture '{}' of texels in a buffer has the format {}", desc.name, to_string(desc.format));
  if ((desc.format == Format::Host) != (desc.host.name != 0)) {
    throw Error("texture '{}' of format {}: the name of the host's texture is {}", desc.name, to_string(desc.format),
                desc.host.name);
  }
  GNOMON_ASSERT(desc.format != Format::Host || desc.kind == TextureKind::Flat, "texture '{}' of the host", desc.name);
  const std::string detail =
      fmt::format("{}x{}{} {}", desc.width, desc.height, desc.layers > 1 ? fmt::format("x{}", desc.layers) : "",
                  to_string(desc.format));
  Resource resource = make(ResourceKind::Texture, {desc.name, desc}, detail, desc.size_bytes(), [&](ResourceId id) {
    return Operation::CreateTexture{id, desc};
  });
  return {std::move(resource), desc};
}

Sampler Device::create_sampler(const SamplerDesc &desc)
{
  if (desc.anisotropy < 1 || desc.anisotropy > limits_.anisotropy_max) {
    throw Error("sampler '{}': anisotropy is {}, but this device supports 1 to {}", desc.name, desc.anisotropy,
                limits_.anisotropy_max);
  }
  const bool is_linear = desc.filter == Filter::Linear && desc.minified.value_or(desc.filter) == Filter::Linear;
  if (desc.anisotropy > 1 && (!is_linear || desc.mip == MipFilter::None)) {
    throw Error("sampler '{}': anisotropy is {}, which needs linear filters and mip levels", desc.name,
                desc.anisotropy);
  }
  return Sampler(make(ResourceKind::Sampler, {desc.name, desc}, {}, 0, [&](ResourceId id) {
    return Operation::CreateSampler{id, desc};
  }));
}

static AttachmentLayout layout_of(const Attachment &attachment)
{
  return {attachment.texture ? attachment.texture->id() : 0, attachment.layer, attachment.mip_level,
          attachment.layer_count};
}

Framebuffer Device::create_framebuffer(const FramebufferDesc &desc)
{
  if (int(desc.colors.size()) > limits_.color_attachment_max) {
    throw Error("framebuffer '{}': {} colour attachments, but this device supports {}", desc.name, desc.colors.size(),
                limits_.color_attachment_max);
  }
  std::vector<Attachment> attachments = desc.colors;
  if (desc.depth.texture) {
    attachments.push_back(desc.depth);
  }
  if (attachments.empty()) {
    throw Error("framebuffer '{}': it has no attachments", desc.name);
  }
  glm::ivec2 size_px{0};
  for (const Attachment &attachment : attachments) {
    GNOMON_ASSERT(attachment.texture && *attachment.texture, "framebuffer '{}'", desc.name);
    const TextureDesc &texture = attachment.texture->desc();
    GNOMON_ASSERT(texture.kind != TextureKind::Buffer, "framebuffer '{}': texture '{}' is a buffer", desc.name,
                  texture.name);
    const bool is_depth_attachment = &attachment == &attachments.back() && desc.depth.texture;
    if (is_depth(texture.format) != is_depth_attachment || texture.format == Format::Host) {
      throw Error("framebuffer '{}': texture '{}' of format {} cannot be its {} attachment", desc.name, texture.name,
                  to_string(texture.format), is_depth_attachment ? "depth" : "colour");
    }
    if (attachment.layer < all_layers || attachment.layer >= texture.layers) {
      throw Error("framebuffer '{}': texture '{}' has no layer {}", desc.name, texture.name, attachment.layer);
    }
    if (attachment.layer_count < 1 || attachment.layer + attachment.layer_count > texture.layers ||
        (attachment.layer == all_layers && attachment.layer_count > 1)) {
      throw Error("framebuffer '{}': texture '{}' has no {} layers from {} on", desc.name, texture.name,
                  attachment.layer_count, attachment.layer);
    }
    if (attachment.mip_level < 0 || attachment.mip_level >= texture.mip_levels) {
      throw Error("framebuffer '{}': texture '{}' has no mip level {}", desc.name, texture.name, attachment.mip_level);
    }
    const glm::ivec2 size{std::max(texture.width >> attachment.mip_level, 1),
                          std::max(texture.height >> attachment.mip_level, 1)};
    if (size_px != glm::ivec2(0) && size != size_px) {
      throw Error("framebuffer '{}': texture '{}' is {}x{}, another attachment {}x{}", desc.name, texture.name, size.x,
                  size.y, size_px.x, size_px.y);
    }
    size_px = size;
  }
  FramebufferInfo info{.attachments = {}, .size_px = size_px};
  for (const Attachment &attachment : attachments) {
    info.attachments.push_back({attachment.texture->id(), attachment.texture->desc().name});
  }
  FramebufferLayout layout{desc.name, {}, layout_of(desc.depth), size_px};
  std::ranges::transform(desc.colors, std::back_inserter(layout.colors), layout_of);
  return {make(ResourceKind::Framebuffer, {desc.name, std::move(info)}, {}, 0,
               [&](ResourceId id) {
                 return Operation::CreateFramebuffer{id, layout};
               }),
          size_px};
}

Framebuffer Device::create_framebuffer(const std::string &name, const HostImage &image)
{
  const auto refuse = [&](std::string_view why) { throw Error("framebuffer '{}' of the host's image: {}", name, why); };
  const glm::ivec2 size = image.size_px;
  if (!image.image) {
    refuse("there is no image");
  }
  if (size.x < 1 || size.y < 1 || std::max(size.x, size.y) > limits_.texture_size_max) {
    refuse(fmt::format("it is {}x{}, but this device supports 1 to {}", size.x, size.y, limits_.texture_size_max));
  }
  if (image.samples < 1 || (image.samples > 1 && image.rows == RowOrder::TopFirst)) {
    refuse(fmt::format("{} samples with the top row first", image.samples));
  }
  return {make(ResourceKind::Framebuffer, {name, FramebufferInfo{.attachments = {}, .size_px = size}}, "of the host", 0,
               [&](ResourceId id) {
                 return Operation::CreateHostFramebuffer{id, name, image};
               }),
          size};
}

Buffer Device::create_buffer(const BufferDesc &desc)
{
  const std::size_t max =
      desc.kind == BufferKind::Uniform ? limits_.uniform_block_bytes_max : limits_.storage_block_bytes_max;
  if (desc.size_bytes == 0 || desc.size_bytes > max) {
    throw Error("buffer '{}': {} bytes, but this device supports 1 to {}", desc.name, desc.size_bytes, max);
  }
  return {make(ResourceKind::Buffer, {desc.name, desc}, {}, desc.size_bytes,
               [&](ResourceId id) {
                 return Operation::CreateBuffer{id, desc};
               }),
          desc};
}

BatchDesc Device::kept(const BatchDesc &desc)
{
  return {.name = desc.name,
          .positions = kept(desc.positions),
          .normals = kept(desc.normals),
          .indices = kept(desc.indices),
          .uvs = kept(desc.uvs),
          .second_uvs = kept(desc.second_uvs),
          .tangents = kept(desc.tangents),
          .colors = kept(desc.colors)};
}

static void check_streams([[maybe_unused]] const BatchDesc &desc)
{
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    [[maybe_unused]] const std::size_t stream_bytes = desc.bytes(VertexStream(i)).size();
    GNOMON_ASSERT(stream_bytes == 0 || stream_bytes == desc.positions.size() * vertex_formats()[i].size_bytes,
                  "batch '{}': {} bytes of attribute {} for {} positions", desc.name, stream_bytes,
                  vertex_formats()[i].attribute, desc.positions.size());
  }
}

void Device::update(const Batch &batch, std::uint32_t first_vertex, const BatchDesc &values)
{
  check_streams(values);
  const BatchRange &range = batch.range();
  GNOMON_ASSERT(batch && range.host_batch == 0 && first_vertex + values.positions.size() <= range.vertex_count,
                "batch '{}': {} vertices from {} on do not fit into {}", name_of(ResourceKind::Batch, batch.id()),
                values.positions.size(), first_vertex, range.vertex_count);
  perform({Operation::UpdateBatch{batch.id(), std::uint32_t(range.base_vertex) + first_vertex, kept(values)}});
  count_upload(ResourceKind::Batch, batch.id(), size_bytes(values));
}

Batch Device::create_batch(const BatchDesc &desc)
{
  constexpr std::size_t count_max = std::size_t(1) << 28U;
  if (desc.positions.size() > count_max || desc.indices.size() > count_max) {
    throw Error("batch '{}': {} vertices and {} indices, but a batch can have at most {} of each", desc.name,
                desc.positions.size(), desc.indices.size(), count_max);
  }
  check_streams(desc);
  GNOMON_ASSERT(std::ranges::all_of(desc.indices, [&](auto index) { return index < desc.positions.size(); }),
                "batch '{}': an index reaches past its {} vertices", desc.name, desc.positions.size());
  const std::uint32_t vertex_capacity = vertices_->capacity();
  const std::uint32_t index_capacity = indices_->capacity();
  const BatchRange range = allocate_range(desc);
  try {
    Resource resource = make(ResourceKind::Batch, {desc.name, range}, {}, size_bytes(desc), [&](ResourceId id) {
      return Operation::CreateBatch{id, kept(desc), range, vertices_->capacity(), indices_->capacity()};
    });
    count_upload(ResourceKind::Batch, resource.id(), size_bytes(desc));
    return {std::move(resource), range};
  }
  catch (...) {
    free_range(range);
    // The backend may have failed to grow its buffers. Smaller batches still fit into the old capacity.
    vertices_->shrink(vertex_capacity);
    indices_->shrink(index_capacity);
    throw;
  }
}

Batch Device::create_batch(const std::string &name, const HostBatch &batch)
{
  const auto refuse = [&](std::string_view why) { throw Error("batch '{}' of the host: {}", name, why); };
  if (batch.positions.buffer == 0 || batch.index_buffer == 0) {
    refuse("it has no buffer of positions or of indices");
  }
  if (batch.vertex_count == 0 && batch.index_count > 0) {
    refuse("it has indices, and no vertices");
  }
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const HostStream &stream = batch.stream(VertexStream(i));
    if (stream.buffer != 0 && (stream.stride_bytes == 0 || stream.stride_bytes > host_stride_bytes_max)) {
      refuse(fmt::format("the {} have a stride of {} bytes, not of 1 to {}", to_string(VertexStream(i)),
                         stream.stride_bytes, host_stride_bytes_max));
    }
  }
  if (batch.index_offset_bytes % batch.index_size_bytes() != 0) {
    refuse(fmt::format("its indices begin at byte {}, which is no multiple of {}", batch.index_offset_bytes,
                       batch.index_size_bytes()));
  }
  BatchRange range{.first_index = batch.index_offset_bytes / batch.index_size_bytes(),
                   .index_count = batch.index_count,
                   .vertex_count = batch.vertex_count};
  Resource resource = make(ResourceKind::Batch, {name, {}}, "of the host", 0, [&](ResourceId id) {
    range.host_batch = id;
    return Operation::CreateHostBatch{id, name, batch};
  });
  slots_[std::size_t(ResourceKind::Batch)][index_of(range.host_batch)].info.desc = range;
  return {std::move(resource), range};
}

BatchRange Device::allocate_range(const BatchDesc &desc)
{
  BatchRange range;
  const auto vertex_count = std::uint32_t(desc.positions.size());
  const auto index_count = std::uint32_t(desc.indices.size());
  try {
    range.base_vertex = std::int32_t(vertices_->allocate(vertex_count));
    range.vertex_count = vertex_count;
    range.first_index = indices_->allocate(index_count);
    range.index_count = index_count;
  }
  catch (const Error &error) {
    free_range(range);
    throw Error("batch '{}': {} vertices and {} indices: {}", desc.name, vertex_count, index_count, error.what());
  }
  return range;
}

void Device::free_range(const BatchRange &range)
{
  vertices_->free(std::uint32_t(range.base_vertex), range.vertex_count);
  indices_->free(range.first_index, range.index_count);
}

static void check_limits(std::string_view name, const ShaderInterface &interface, const Limits &limits)
{
  for (const ShaderStage stage : {ShaderStage::Vertex, ShaderStage::Geometry, ShaderStage::Fragment}) {
    const auto check = [&](BindingKind kind, int max, std::string_view what) {
      const auto count = std::ranges::count_if(interface.bindings, [&](const ShaderInterface::Binding &binding) {
        return binding.kind == kind && (binding.stages & (1U << unsigned(stage))) != 0;
      });
      if (count > max) {
        throw Error("shader '{}': {} {} in the {} stage, but this device supports {}", name, count, what,
                    to_string(stage), max);
      }
    };
    const Limits::Stage &most = limits.stages[std::size_t(stage)];
    check(BindingKind::StorageBlock, most.storage_block_max, "storage blocks");
    check(BindingKind::UniformBlock, most.uniform_block_max, "uniform blocks");
    check(BindingKind::Texture, most.sampler_max, "samplers");
  }
  if (interface.push_constant_size_bytes > limits.push_constant_bytes_max) {
    throw Error("shader '{}': {} bytes of push constants, but this device supports {}", name,
                interface.push_constant_size_bytes, limits.push_constant_bytes_max);
  }
  if (interface.varying_locations > limits.varying_location_max) {
    throw Error("shader '{}': {} locations of values that a stage passes to the next, but this device supports {}",
                name, interface.varying_locations, limits.varying_location_max);
  }
}

/** The defines and constants of \a desc, with spaces. */
static std::string variant_of(const ShaderDesc &desc)
{
  std::string variant = fmt::format("{}", fmt::join(desc.defines, " "));
  for (const ShaderConstant &constant : desc.constants) {
    variant += fmt::format("{}{}={}", variant.empty() ? "" : " ", constant.name, constant.value);
  }
  return variant;
}

Shader Device::create_shader(const ShaderDesc &desc, const ShaderFiles &files, const ShaderReflection &reflection,
                             const ShaderFiles &stand_in)
{
  std::vector<ShaderSource> stages = preprocess(desc, files);
  std::vector<ShaderSource> stand_in_stages = stand_in ? preprocess(desc, stand_in) : std::vector<ShaderSource>();
  std::vector<StageConstant> constants = stage_constants(desc, stages);
  if (!desc.constants.empty() && !limits_.has_specialization) {
    for (std::vector<ShaderSource> *sources : {&stages, &stand_in_stages}) {
      for (ShaderSource &stage : *sources) {
        stage.text = with_constants(stage.text, desc.constants);
      }
    }
    constants.clear();
  }
  ShaderInterface interface = reflection(desc.name, stages);
  if (!desc.geometry_path.empty() && !limits_.has_geometry_shader) {
    throw Error("shader '{}': this device has no geometry shaders", desc.name);
  }
  check_limits(desc.name, interface, limits_);
  const std::string detail = variant_of(desc);
  Resource resource = make(ResourceKind::Shader, {desc.name, interface}, detail, 0, [&](ResourceId id) {
    std::vector<std::string> samplers;
    for (const ShaderInterface::Binding &binding : interface.bindings) {
      if (binding.kind == BindingKind::Texture) {
        samplers.push_back(binding.name);
      }
    }
    return Operation::CreateShader{
        id, desc, std::move(stages), std::move(samplers), std::move(constants), std::move(stand_in_stages)};
  });
  return {std::move(resource), desc.name, std::move(interface)};
}

std::shared_ptr<SharedShader> Device::shared_shader(const ShaderDesc &desc, std::string_view text,
                                                    const std::function<void(SharedShader &made)> &make)
{
  std::string key = fmt::format("{}\n{}\n{}\n{}\n{}\n{}", desc.name, desc.vertex_path, desc.geometry_path,
                                desc.fragment_path, variant_of(desc), text);
  auto found = shared_shaders_.find(key);
  if (found == shared_shaders_.end() || !found->second.shared->shader) {
    const auto made = std::make_shared<SharedShader>();
    make(*made);
    trim_shared_shaders(unused_shader_max);
    found = shared_shaders_.insert_or_assign(std::move(key), KeptShader{made}).first;
  }
  found->second.asked = ++shared_shaders_asked_;
  return found->second.shared;
}

void Device::trim_shared_shaders(std::size_t count_max)
{
  std::vector<std::map<std::string, KeptShader, std::less<>>::iterator> unused;
  for (auto kept = shared_shaders_.begin(); kept != shared_shaders_.end(); kept++) {
    if (kept->second.shared.use_count() == 1) {
      unused.push_back(kept);
    }
  }
  std::ranges::sort(unused, {}, [](const auto &kept) { return kept->second.asked; });
  for (std::size_t i = 0; i + count_max < unused.size(); i++) {
    shared_shaders_.erase(unused[i]);
  }
}

TimerQuery Device::create_timer_query(std::string name)
{
  return TimerQuery(make(ResourceKind::TimerQuery, {name, {}}, {}, 0, [&](ResourceId id) {
    return Operation::CreateTimerQuery{id, name};
  }));
}

}  // namespace gnomon::gpu
