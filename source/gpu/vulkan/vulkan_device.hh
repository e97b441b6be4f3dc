// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include "internal/gpu_id_table.hh"
#include "vulkan_descriptors.hh"
#include "vulkan_images.hh"
#include "vulkan_pipelines.hh"
#include "vulkan_stream.hh"

#include <memory>
#include <optional>

namespace gnomon::gpu {

class VulkanDevice final : public Device {
 public:
  VulkanDevice(std::unique_ptr<VulkanContext> context, const VulkanDeviceDesc &desc);
  ~VulkanDevice() override;

  /** \a window: the device can present to it; nullptr: to none. \throws Error */
  [[nodiscard]] static std::unique_ptr<Device> create(const VulkanDeviceDesc &desc, GLFWwindow *window);

  void finish() override;
  std::string description() const override
  {
    return context_->description;
  }
  [[nodiscard]] VulkanContext &context()
  {
    return *context_;
  }
  /** Destroy retired resources at once, without waiting for the device, which is lost. */
  void destroy_retired()
  {
    submissions_.end();
  }
  /** Send \a text to the message sink. */
  void tell(std::string_view text) const
  {
    message(text);
  }

 private:
  /** A pool is a buffer that all batches share: one for each VertexStream, and a last one for the indices. */
  static constexpr std::size_t index_pool = vertex_stream_count;
  static constexpr std::size_t pool_count = vertex_stream_count + 1;
  using Pools = std::array<VulkanBuffer, pool_count>;
  using PoolSizes = std::array<VkDeviceSize, pool_count>;

  struct VulkanTexture {
    /** For TextureKind::Flat and Array. */
    VulkanImage image;
    /** For TextureKind::Buffer. */
    VulkanBuffer buffer;
    VkBufferView buffer_view = VK_NULL_HANDLE;
    TextureDesc desc;
    /** Copy of the image for passes that look up their own attachments (PassActions::reads_attachments). */
    std::optional<VulkanImage> copy;
  };
  struct VulkanAttachment {
    ResourceId texture = 0;
    /** Indexed by whether the pass encodes colours. */
    std::array<VkImageView, 2> views{};
    std::array<VkFormat, 2> formats{};
    std::uint32_t layers = 1;
  };
  struct VulkanHostImage {
    VulkanImage image;
    /** Passes draw into it, if the host's rows are in the other order. */
    std::optional<VulkanImage> turned;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
    /** Between begin_image and end_image. */
    bool is_taken = false;

    VulkanImage &drawn()
    {
      return turned ? *turned : image;
    }
  };
  struct VulkanFramebuffer {
    std::string name;
    /** Its only attachment, which is no texture; nullptr: the attachments are textures. */
    std::shared_ptr<VulkanHostImage> host;
    std::vector<VulkanAttachment> colors;
    std::optional<VulkanAttachment> depth;
    glm::ivec2 size_px{0};
    std::uint32_t layer_count = 1;
  };
  /** A pair of timestamp queries, and the submission that has the last one. */
  struct TimeMarks {
    VkQueryPool queries = VK_NULL_HANDLE;
    std::uint64_t number = 0;
  };
  struct Timer {
    std::string name;
    /** Marked, oldest first, and not read yet. The last one may lack its end. */
    std::vector<TimeMarks> pending;
    std::vector<TimeMarks> unused;
    bool has_begun = false;
    /** Sum of the times that were read. */
    double seconds = 0.0;
  };
  /** Placeholders for bindings that a list does not set: black texels, and zeros. */
  struct Dummies {
    /** Index 0: colours; 1: depths. Each image has one layer, and its view is that of an array. */
    std::array<VulkanImage, 2> images;
    std::array<VkImageView, 2> flat_views{};
    std::array<VkSampler, 2> samplers{};
    VulkanBuffer buffer;
    VkBufferView buffer_view = VK_NULL_HANDLE;
    /** The colour of vertices of a host that have none. */
    VulkanBuffer white;
  };
  /** A texture that a list has bound to a slot. */
  struct BoundTexture {
    ResourceId texture = 0;
    ResourceId sampler = 0;
  };
  /** State that the commands of a list have set so far. */
  struct ListState {
    VulkanProgram *program = nullptr;
    std::vector<VkDescriptorBufferInfo> uniforms;
    std::vector<VkDescriptorBufferInfo> storages;
    std::vector<BoundTexture> textures;
    ResourceId objects = 0;
    /** nullptr: draws are of batches in the shared buffers. */
    const HostBatch *host_batch = nullptr;
    std::span<const std::byte> push_constants;
    VulkanStream::Place instances;
    VulkanStream::Place draws;
    /** The open pass; nullptr outside of passes. */
    const CommandList::PassInfo *pass = nullptr;
    PipelineKey pipeline;
    /** Textures that the pass looks up while it draws into them. */
    std::vector<ResourceId> copied;
    // State of the command buffer. It is set again only after changes.
    VkPipeline bound_pipeline = VK_NULL_HANDLE;
    bool has_new_bindings = true;
    bool has_new_push_constants = false;
    bool has_new_vertices = true;
  };
  /** The textures that the draws of a pass look up. */
  using PassTextures = std::vector<ResourceId>;

  /** \throws Error with the messages of the validation layers */
  void check(std::string_view what)
  {
    context_->check_messages(what);
  }
  /** check() after the creation of a resource, which is destroyed before an error is thrown. */
  void check_made(ResourceKind kind, ResourceId id, std::string_view what);
  void create_dummies();
  void destroy_dummies();

  void texture_create(ResourceId id, const TextureDesc &desc) override;
  void sampler_create(ResourceId id, const SamplerDesc &desc) override;
  void framebuffer_create(ResourceId id, const FramebufferLayout &layout) override;
  void host_framebuffer_create(ResourceId id, const std::string &name, const HostImage &image) override;
  void image_take(const Operation::TakeImage &take) override;
  void buffer_create(ResourceId id, const BufferDesc &desc) override;
  void batch_create(const BatchDesc &desc, const BatchRange &range, std::uint32_t vertex_capacity,
                    std::uint32_t index_capacity) override;
  void batch_update(std::uint32_t first_vertex, const BatchDesc &values) override;
  void host_batch_create(ResourceId id, const std::string &name, const HostBatch &batch) override;
  void shader_create(const Operation::CreateShader &create, std::vector<std::byte> &compiled) override;
  void timer_query_create(ResourceId id, const std::string &name) override;
  void resource_destroy(ResourceKind kind, ResourceId id) override;
  bool driver_trim() override;
  void buffer_update(ResourceId id, std::size_t offset_bytes, std::span<const std::byte> bytes) override;
  void texture_upload(ResourceId id, int layer, std::span<const std::byte> texels) override;
  void mipmaps_generate(ResourceId id) override;
  void layers_copy(ResourceId source, ResourceId target, glm::ivec2 size_px, int layers) override;
  void texture_read(ResourceId id, int layer, std::span<std::byte> texels) override;
  void list_submit(const CommandList &list) override;
  void time_mark(ResourceId query, bool is_end) override;
  std::optional<double> seconds_take(ResourceId query) override;

  /** \throws Error if the device does not use that of a host, which has \a whats */
  void check_host(std::string_view what, std::string_view whats) const;
  [[nodiscard]] VulkanImage make_host_image(std::string_view what, const TextureDesc &desc);
  [[nodiscard]] VulkanAttachment make_attachment(std::string_view what, const AttachmentLayout &layout);
  void destroy_attachment(const VulkanAttachment &attachment);
  void destroy_framebuffer(const VulkanFramebuffer &framebuffer);
  /** Copies all texels in the other order of rows. */
  void turn(VulkanImage &from, VulkanImage &to);
  [[nodiscard]] VkSampler make_sampler(std::string_view what, const VkSamplerCreateInfo &info);
  void grow_pools(const BatchDesc &desc, const PoolSizes &sizes);
  /** Copies \a bytes to \a buffer, in the order of the commands. */
  void write(const VulkanBuffer &buffer, VkDeviceSize offset_bytes, std::span<const std::byte> bytes);
  /** Waits for the recorded commands if their uploads are large, so that their memory is used again. Not within a list.
   */
  void finish_large_uploads();
  /** Reads the pending times of \a timer: those which the device has, or \a waits for all. */
  void read_times(Timer &timer, bool waits);

  /** The textures that the draws of each pass of \a list look up. */
  [[nodiscard]] std::vector<PassTextures> textures_of_passes(const CommandList &list);
  void execute(const CommandList &list);
  /** \throws Error if \a framebuffer of the host's image cannot be drawn into. */
  static void check_host_image(std::string_view pass_name, const VulkanFramebuffer &framebuffer,
                               const PassActions &actions);
  void begin_pass(std::string_view name, const CommandList::PassInfo &pass, const PassTextures &used);
  /** Make the textures \a used ready for lookups of the pass. */
  void prepare_lookups(const VulkanFramebuffer &framebuffer, const PassActions &actions, const PassTextures &used);
  /** Copies the texture \a id for a pass that looks it up while it draws into it. */
  void copy_attachment(ResourceId id);
  void end_pass();
  void set_state(State state);
  void bind_texture(const Command &command, std::vector<BoundTexture> &textures);
  /** Sets the state of the next draw. \return false if there is nothing to draw from */
  bool prepare_draw(bool is_procedural);
  void bind_descriptors();
  void bind_vertices();
  /** The texture that is bound to \a binding. */
  [[nodiscard]] VkDescriptorImageInfo image_info(const VulkanBinding &binding);

  std::unique_ptr<VulkanContext> context_;
  SpirvCompiler compile_;
  VulkanMemory memory_;
  VulkanSubmissions submissions_;
  VulkanStream stream_;
  VulkanDescriptors descriptors_;
  VulkanBarriers barriers_;

  IdTable<VulkanTexture> textures_{ResourceKind::Texture};
  IdTable<VkSampler> samplers_{ResourceKind::Sampler};
  IdTable<VulkanFramebuffer> framebuffers_{ResourceKind::Framebuffer};
  IdTable<VulkanBuffer> buffers_{ResourceKind::Buffer};
  IdTable<HostBatch> host_batches_{ResourceKind::Batch};
  IdTable<std::shared_ptr<VulkanProgram>> programs_{ResourceKind::Shader};
  IdTable<Timer> timers_{ResourceKind::TimerQuery};

  Pools pools_{};
  Dummies dummies_;
  ListState list_;
};

}  // namespace gnomon::gpu
