// SPDX-License-Identifier: MIT
#include "gpu_device.hh"

namespace gnomon::gpu {

namespace {

/** Checks and counts are done by the base class; nothing is drawn. */
class NullDevice final : public Device {
 public:
  NullDevice(const Limits &limits, MessageSink sink) : Device(limits, std::move(sink)) {}
  ~NullDevice() override
  {
    free_live_resources();
  }

  void finish() override {}
  void time_begin(const TimerQuery & /*query*/) override {}
  void time_end(const TimerQuery & /*query*/) override {}
  std::optional<double> elapsed_seconds(const TimerQuery & /*query*/) override
  {
    return std::nullopt;
  }
  std::string description() const override
  {
    return "null backend (records, draws nothing)";
  }

 private:
  void texture_create(ResourceId /*id*/, const TextureDesc & /*desc*/) override {}
  void sampler_create(ResourceId /*id*/, const SamplerDesc & /*desc*/) override {}
  void framebuffer_create(ResourceId /*id*/, const FramebufferDesc & /*desc*/) override {}
  void buffer_create(ResourceId /*id*/, const BufferDesc & /*desc*/) override {}
  void batch_create(const BatchDesc & /*desc*/, const BatchRange & /*range*/, std::uint32_t /*vertex_capacity*/,
                    std::uint32_t /*index_capacity*/) override
  {
  }
  void shader_create(ResourceId /*id*/, const ShaderDesc & /*desc*/, const std::vector<ShaderSource> & /*stages*/,
                     std::vector<std::byte> & /*compiled*/) override
  {
  }
  void timer_query_create(ResourceId /*id*/, const std::string & /*name*/) override {}
  void resource_destroy(ResourceKind /*kind*/, ResourceId /*id*/) override {}
  void buffer_update(ResourceId /*id*/, std::size_t /*offset_bytes*/, std::span<const std::byte> /*bytes*/) override {}
  void texture_upload(const Texture & /*texture*/, int /*layer*/, std::span<const std::byte> /*texels*/) override {}
  void mipmaps_generate(const Texture & /*texture*/) override {}
  void layers_copy(const Texture & /*source*/, const Texture & /*target*/, glm::ivec2 /*size_px*/,
                   int /*layers*/) override
  {
  }
  void texture_read(const Texture & /*texture*/, int /*layer*/, std::span<std::byte> texels) override
  {
    std::fill(texels.begin(), texels.end(), std::byte(0));
  }
  void list_submit(const CommandList & /*list*/) override {}
};

}  // namespace

std::unique_ptr<Device> create_null_device(const Limits &limits, MessageSink sink)
{
  return std::make_unique<NullDevice>(limits, std::move(sink));
}

}  // namespace gnomon::gpu
