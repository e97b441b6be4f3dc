// SPDX-License-Identifier: MIT
#include "gpu_device.hh"

#include <fmt/format.h>

namespace gnomon::gpu {

namespace {

/** Draws nothing. The base class checks and counts. */
class NullDevice final : public Device {
 public:
  NullDevice(const Limits &limits, MessageSink sink, NullOperation before_operation)
      : Device(limits, std::move(sink)), before_operation_(std::move(before_operation))
  {
  }
  ~NullDevice() override
  {
    free_live_resources();
  }

  void finish() override {}
  std::string description() const override
  {
    return "null backend (records, draws nothing)";
  }

 private:
  void before(std::string_view operation) const
  {
    if (before_operation_) {
      before_operation_(operation);
    }
  }
  void texture_create(ResourceId /*id*/, const TextureDesc & /*desc*/) override
  {
    before("create texture");
  }
  void sampler_create(ResourceId /*id*/, const SamplerDesc & /*desc*/) override
  {
    before("create sampler");
  }
  void framebuffer_create(ResourceId /*id*/, const FramebufferLayout & /*layout*/) override
  {
    before("create framebuffer");
  }
  void host_framebuffer_create(ResourceId /*id*/, const std::string & /*name*/, const HostImage & /*image*/) override
  {
    before("create framebuffer");
  }
  void buffer_create(ResourceId /*id*/, const BufferDesc & /*desc*/) override
  {
    before("create buffer");
  }
  void batch_create(const BatchDesc & /*desc*/, const BatchRange & /*range*/, std::uint32_t /*vertex_capacity*/,
                    std::uint32_t /*index_capacity*/) override
  {
    before("create batch");
  }
  void batch_update(std::uint32_t /*first_vertex*/, const BatchDesc & /*values*/) override
  {
    before("update batch");
  }
  void host_batch_create(ResourceId /*id*/, const std::string & /*name*/, const HostBatch & /*batch*/) override
  {
    before("create host batch");
  }
  void shader_create(const Operation::CreateShader & /*create*/, std::vector<std::byte> & /*compiled*/) override
  {
    before("create shader");
  }
  void timer_query_create(ResourceId /*id*/, const std::string & /*name*/) override
  {
    before("create timer query");
  }
  void resource_destroy(ResourceKind kind, ResourceId /*id*/) override
  {
    before(fmt::format("destroy {}", to_string(kind)));
  }
  void buffer_update(ResourceId /*id*/, std::size_t /*offset_bytes*/, std::span<const std::byte> /*bytes*/) override
  {
    before("update");
  }
  void texture_upload(ResourceId /*id*/, int /*layer*/, std::span<const std::byte> /*texels*/) override
  {
    before("upload");
  }
  void mipmaps_generate(ResourceId /*id*/) override
  {
    before("generate mipmaps");
  }
  void layers_copy(ResourceId /*source*/, ResourceId /*target*/, glm::ivec2 /*size_px*/, int /*layers*/) override
  {
    before("copy layers");
  }
  void texture_read(ResourceId /*id*/, int /*layer*/, std::span<std::byte> texels) override
  {
    before("read");
    std::fill(texels.begin(), texels.end(), std::byte(0));
  }
  void list_submit(const CommandList & /*list*/) override
  {
    before("submit");
  }
  void time_mark(ResourceId /*query*/, bool /*is_end*/) override
  {
    before("mark time");
  }
  std::optional<double> seconds_take(ResourceId /*query*/) override
  {
    return std::nullopt;
  }

  NullOperation before_operation_;
};

}  // namespace

std::unique_ptr<Device> create_null_device(const Limits &limits, MessageSink sink, NullOperation before_operation)
{
  return std::make_unique<NullDevice>(limits, std::move(sink), std::move(before_operation));
}

}  // namespace gnomon::gpu
