// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_batch.hh"
#include "gpu_buffer.hh"
#include "gpu_shader.hh"
#include "gpu_texture.hh"

#include <string>
#include <variant>
#include <vector>

namespace gnomon::gpu {

/** Limits of a device. A resource that exceeds one is refused by an Error that names the resource and the limit. */
struct Limits {
  int texture_size_max = 16384;
  int array_layers_max = 2048;
  std::size_t uniform_block_bytes_max = 65536;
  std::size_t storage_block_bytes_max = std::size_t(1) << 27U;
  int color_attachment_max = 8;
  /** Of the offset of a bound range, in bytes. */
  std::uint32_t uniform_offset_alignment = 256;
  /** Storage blocks that one stage may declare. OpenGL guarantees 8 in the fragment stage and none in the others. */
  int vertex_storage_block_max = 8;
  int geometry_storage_block_max = 8;
  int fragment_storage_block_max = 8;
  /** Vertex shaders may write `gl_Layer` (GL_ARB_shader_viewport_layer_array). */
  bool has_vertex_layer = true;
};

/** Work that a device has done since it was created. */
struct Counters {
  std::uint64_t passes = 0;
  /** Entries of DrawIndirect, and procedural draws. */
  std::uint64_t draws = 0;
  std::uint64_t instances = 0;
  std::uint64_t triangles = 0;
  std::uint64_t shader_binds = 0;
  std::uint64_t shaders_made = 0;
  /** Of shaders_made, those whose program the driver took from the disk cache. */
  std::uint64_t shaders_from_cache = 0;
  std::uint64_t textures_made = 0;
  /** Bytes written to buffers, batches and textures. */
  std::uint64_t upload_bytes = 0;
};

/** Description of one live resource for reports. */
struct LiveResource {
  ResourceKind kind = ResourceKind::Texture;
  std::string name;
  /** Textures: "WIDTHxHEIGHTxLAYERS FORMAT"; shaders: their defines, a space between two; others: empty. */
  std::string detail;
  /** Size of the content of a texture, buffer or batch; 0 for other kinds. */
  std::size_t size_bytes = 0;
  /** Bytes that the CPU has written to it since its creation. Draws into it are not counted. */
  std::uint64_t upload_bytes = 0;
};

/** A texture that is attached to a framebuffer. */
struct AttachedTexture {
  ResourceId texture = 0;
  std::string name;
};

/** Description of a framebuffer as validation needs it. */
struct FramebufferInfo {
  std::vector<AttachedTexture> attachments;
  glm::ivec2 size_px{0};
};

/** Description of a live resource as validation needs it. Timer queries have no `desc`. */
struct ResourceInfo {
  std::string name;
  std::variant<std::monostate, TextureDesc, SamplerDesc, FramebufferInfo, BufferDesc, BatchRange, ShaderInterface> desc;
};

}  // namespace gnomon::gpu
