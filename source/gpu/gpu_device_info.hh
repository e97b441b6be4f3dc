// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_batch.hh"
#include "gpu_buffer.hh"
#include "gpu_shader.hh"
#include "gpu_texture.hh"

#include <array>
#include <string>
#include <variant>
#include <vector>

namespace gnomon::gpu {

/** Limits of a device. Creating a resource that exceeds a limit throws an Error naming the resource and the limit. */
struct Limits {
  int texture_size_max = 16384;
  int array_layers_max = 2048;
  /** Texels of a texture of TextureKind::Buffer. */
  int buffer_texels_max = 65536;
  std::size_t uniform_block_bytes_max = 65536;
  std::size_t storage_block_bytes_max = std::size_t(1) << 27U;
  /** Largest ShaderInterface::push_constant_size_bytes. Vulkan guarantees 128. */
  std::size_t push_constant_bytes_max = 65536;
  int color_attachment_max = 8;
  /** Largest SamplerDesc::anisotropy; 1 where the device has none. */
  int anisotropy_max = 16;
  /** The driver draws on the CPU. In Mesa's, the time of an anisotropic lookup grows with the texels that it covers. */
  bool is_software = false;
  /**
   * The rasteriser moves each vertex, with the values that are interpolated from it, to a grid with 2^subpixel_bits
   * cells along a pixel's edge. Vulkan: read from the device; SwiftShader has 4. OpenGL: 8, which is common, is
   * assumed.
   */
  int subpixel_bits = 8;
  /** Alignment in bytes of BufferRange::offset_bytes, for uniform and storage blocks. */
  std::uint32_t uniform_offset_alignment = 256;
  /** Maximum numbers of resources that one stage of a program reads. */
  struct Stage {
    /** OpenGL guarantees 8 in the fragment stage and 0 in the others. */
    int storage_block_max = 8;
    /** OpenGL guarantees 14. */
    int uniform_block_max = 14;
    /** OpenGL guarantees 16, and common devices have 32. */
    int sampler_max = 32;
  };
  /** Indexed by ShaderStage. */
  std::array<Stage, 3> stages{};
  /** Maximum of ShaderInterface::varying_locations. OpenGL guarantees 16, and common devices have 31 or 32. */
  int varying_location_max = 31;
  /** Whether vertex shaders may write `gl_Layer` (GL_ARB_shader_viewport_layer_array; Vulkan's shaderOutputLayer). */
  bool has_vertex_layer = true;
  /** Whether programs may have a geometry stage. OpenGL has it. */
  bool has_geometry_shader = true;
  /** Whether State::Wireframe can be used. OpenGL has it; Vulkan's fillModeNonSolid. */
  bool has_wireframe = true;
  /** Whether specialisation constants are set after compilation; otherwise, their values become part of the text. */
  bool has_specialization = false;
};

/** Work that a device has done since it was created. */
struct Counters {
  std::uint64_t passes = 0;
  /** Number of DrawIndirect entries and of procedural draws. */
  std::uint64_t draws = 0;
  std::uint64_t instances = 0;
  std::uint64_t triangles = 0;
  std::uint64_t shader_binds = 0;
  std::uint64_t shaders_made = 0;
  /** Number of created shaders whose compiled form was loaded from the disk cache. Included in shaders_made. */
  std::uint64_t shaders_from_cache = 0;
  /** Vulkan: combinations of a program with states and formats, each of which takes a part of its compilation. */
  std::uint64_t pipelines_made = 0;
  std::uint64_t textures_made = 0;
  /** Bytes that the CPU has sent: writes to buffers, batches and textures, and the draws and instances of lists. */
  std::uint64_t upload_bytes = 0;
};

/** Description of a live resource for reports. */
struct LiveResource {
  ResourceKind kind = ResourceKind::Texture;
  std::string name;
  /** Textures: "WIDTHxHEIGHT FORMAT" or "WIDTHxHEIGHTxLAYERS FORMAT". Shaders: defines and constants with spaces.
   * Others: empty. */
  std::string detail;
  /** Bytes of content of a texture, buffer or batch; 0 for other kinds. */
  std::size_t size_bytes = 0;
  /** Bytes that the CPU has written to the resource since its creation. Excludes draws into it. */
  std::uint64_t upload_bytes = 0;
};

/** A texture that is attached to a framebuffer. */
struct AttachedTexture {
  ResourceId texture = 0;
  std::string name;
};

/** Description of a framebuffer for validation. */
struct FramebufferInfo {
  std::vector<AttachedTexture> attachments;
  glm::ivec2 size_px{0};
};

/** Description of a live resource for validation. Timer queries have no `desc`. */
struct ResourceInfo {
  std::string name;
  std::variant<std::monostate, TextureDesc, SamplerDesc, FramebufferInfo, BufferDesc, BatchRange, ShaderInterface> desc;
};

}  // namespace gnomon::gpu
