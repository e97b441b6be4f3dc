// SPDX-License-Identifier: MIT
#include "gpu/gpu_gl_state_table.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

namespace gnomon::test {

namespace {

struct Capability {
  const char *name;
  GLenum value;
};
constexpr Capability CAPABILITIES[] = {
    {"GL_BLEND", GL_BLEND},
    {"GL_CLIP_DISTANCE0", GL_CLIP_DISTANCE0},
    {"GL_CLIP_DISTANCE1", GL_CLIP_DISTANCE1},
    {"GL_CLIP_DISTANCE2", GL_CLIP_DISTANCE2},
    {"GL_CLIP_DISTANCE3", GL_CLIP_DISTANCE3},
    {"GL_CLIP_DISTANCE4", GL_CLIP_DISTANCE4},
    {"GL_CLIP_DISTANCE5", GL_CLIP_DISTANCE5},
    {"GL_CLIP_DISTANCE6", GL_CLIP_DISTANCE6},
    {"GL_CLIP_DISTANCE7", GL_CLIP_DISTANCE7},
    {"GL_COLOR_LOGIC_OP", GL_COLOR_LOGIC_OP},
    {"GL_CULL_FACE", GL_CULL_FACE},
    {"GL_DEBUG_OUTPUT", GL_DEBUG_OUTPUT},
    {"GL_DEBUG_OUTPUT_SYNCHRONOUS", GL_DEBUG_OUTPUT_SYNCHRONOUS},
    {"GL_DEPTH_CLAMP", GL_DEPTH_CLAMP},
    {"GL_DEPTH_TEST", GL_DEPTH_TEST},
    {"GL_DITHER", GL_DITHER},
    {"GL_FRAMEBUFFER_SRGB", GL_FRAMEBUFFER_SRGB},
    {"GL_LINE_SMOOTH", GL_LINE_SMOOTH},
    {"GL_MULTISAMPLE", GL_MULTISAMPLE},
    {"GL_POLYGON_OFFSET_FILL", GL_POLYGON_OFFSET_FILL},
    {"GL_POLYGON_OFFSET_LINE", GL_POLYGON_OFFSET_LINE},
    {"GL_POLYGON_OFFSET_POINT", GL_POLYGON_OFFSET_POINT},
    {"GL_POLYGON_SMOOTH", GL_POLYGON_SMOOTH},
    {"GL_PRIMITIVE_RESTART", GL_PRIMITIVE_RESTART},
    {"GL_PRIMITIVE_RESTART_FIXED_INDEX", GL_PRIMITIVE_RESTART_FIXED_INDEX},
    {"GL_PROGRAM_POINT_SIZE", GL_PROGRAM_POINT_SIZE},
    {"GL_RASTERIZER_DISCARD", GL_RASTERIZER_DISCARD},
    {"GL_SAMPLE_ALPHA_TO_COVERAGE", GL_SAMPLE_ALPHA_TO_COVERAGE},
    {"GL_SAMPLE_ALPHA_TO_ONE", GL_SAMPLE_ALPHA_TO_ONE},
    {"GL_SAMPLE_COVERAGE", GL_SAMPLE_COVERAGE},
    {"GL_SAMPLE_MASK", GL_SAMPLE_MASK},
    {"GL_SAMPLE_SHADING", GL_SAMPLE_SHADING},
    {"GL_SCISSOR_TEST", GL_SCISSOR_TEST},
    {"GL_STENCIL_TEST", GL_STENCIL_TEST},
    {"GL_TEXTURE_CUBE_MAP_SEAMLESS", GL_TEXTURE_CUBE_MAP_SEAMLESS},
};

struct Value {
  const char *name;
  GLenum value;
  std::size_t count;
};
constexpr Value VALUES[] = {
    {"GL_ACTIVE_TEXTURE", GL_ACTIVE_TEXTURE, 1},
    {"GL_ARRAY_BUFFER_BINDING", GL_ARRAY_BUFFER_BINDING, 1},
    {"GL_ATOMIC_COUNTER_BUFFER_BINDING", GL_ATOMIC_COUNTER_BUFFER_BINDING, 1},
    {"GL_BLEND_COLOR", GL_BLEND_COLOR, 4},
    {"GL_CLAMP_READ_COLOR", GL_CLAMP_READ_COLOR, 1},
    {"GL_CLIP_ORIGIN", GL_CLIP_ORIGIN, 1},
    {"GL_CLIP_DEPTH_MODE", GL_CLIP_DEPTH_MODE, 1},
    {"GL_COLOR_CLEAR_VALUE", GL_COLOR_CLEAR_VALUE, 4},
    {"GL_COPY_READ_BUFFER_BINDING", GL_COPY_READ_BUFFER_BINDING, 1},
    {"GL_COPY_WRITE_BUFFER_BINDING", GL_COPY_WRITE_BUFFER_BINDING, 1},
    {"GL_CULL_FACE_MODE", GL_CULL_FACE_MODE, 1},
    {"GL_CURRENT_PROGRAM", GL_CURRENT_PROGRAM, 1},
    {"GL_DEBUG_GROUP_STACK_DEPTH", GL_DEBUG_GROUP_STACK_DEPTH, 1},
    {"GL_DEPTH_CLEAR_VALUE", GL_DEPTH_CLEAR_VALUE, 1},
    {"GL_DEPTH_FUNC", GL_DEPTH_FUNC, 1},
    {"GL_DEPTH_WRITEMASK", GL_DEPTH_WRITEMASK, 1},
    {"GL_DISPATCH_INDIRECT_BUFFER_BINDING", GL_DISPATCH_INDIRECT_BUFFER_BINDING, 1},
    {"GL_DRAW_INDIRECT_BUFFER_BINDING", GL_DRAW_INDIRECT_BUFFER_BINDING, 1},
    {"GL_DRAW_FRAMEBUFFER_BINDING", GL_DRAW_FRAMEBUFFER_BINDING, 1},
    {"GL_DRAW_BUFFER0", GL_DRAW_BUFFER0, 1},
    {"GL_ELEMENT_ARRAY_BUFFER_BINDING", GL_ELEMENT_ARRAY_BUFFER_BINDING, 1},
    {"GL_FRAGMENT_SHADER_DERIVATIVE_HINT", GL_FRAGMENT_SHADER_DERIVATIVE_HINT, 1},
    {"GL_FRONT_FACE", GL_FRONT_FACE, 1},
    {"GL_LINE_SMOOTH_HINT", GL_LINE_SMOOTH_HINT, 1},
    {"GL_LINE_WIDTH", GL_LINE_WIDTH, 1},
    {"GL_LOGIC_OP_MODE", GL_LOGIC_OP_MODE, 1},
    {"GL_MIN_SAMPLE_SHADING_VALUE", GL_MIN_SAMPLE_SHADING_VALUE, 1},
    {"GL_PACK_ALIGNMENT", GL_PACK_ALIGNMENT, 1},
    {"GL_PACK_SWAP_BYTES", GL_PACK_SWAP_BYTES, 1},
    {"GL_PACK_LSB_FIRST", GL_PACK_LSB_FIRST, 1},
    {"GL_PACK_ROW_LENGTH", GL_PACK_ROW_LENGTH, 1},
    {"GL_PACK_SKIP_PIXELS", GL_PACK_SKIP_PIXELS, 1},
    {"GL_PACK_SKIP_ROWS", GL_PACK_SKIP_ROWS, 1},
    {"GL_PACK_IMAGE_HEIGHT", GL_PACK_IMAGE_HEIGHT, 1},
    {"GL_PACK_SKIP_IMAGES", GL_PACK_SKIP_IMAGES, 1},
    {"GL_PACK_COMPRESSED_BLOCK_WIDTH", GL_PACK_COMPRESSED_BLOCK_WIDTH, 1},
    {"GL_PACK_COMPRESSED_BLOCK_HEIGHT", GL_PACK_COMPRESSED_BLOCK_HEIGHT, 1},
    {"GL_PACK_COMPRESSED_BLOCK_DEPTH", GL_PACK_COMPRESSED_BLOCK_DEPTH, 1},
    {"GL_PACK_COMPRESSED_BLOCK_SIZE", GL_PACK_COMPRESSED_BLOCK_SIZE, 1},
    {"GL_UNPACK_ALIGNMENT", GL_UNPACK_ALIGNMENT, 1},
    {"GL_UNPACK_SWAP_BYTES", GL_UNPACK_SWAP_BYTES, 1},
    {"GL_UNPACK_LSB_FIRST", GL_UNPACK_LSB_FIRST, 1},
    {"GL_UNPACK_ROW_LENGTH", GL_UNPACK_ROW_LENGTH, 1},
    {"GL_UNPACK_SKIP_PIXELS", GL_UNPACK_SKIP_PIXELS, 1},
    {"GL_UNPACK_SKIP_ROWS", GL_UNPACK_SKIP_ROWS, 1},
    {"GL_UNPACK_IMAGE_HEIGHT", GL_UNPACK_IMAGE_HEIGHT, 1},
    {"GL_UNPACK_SKIP_IMAGES", GL_UNPACK_SKIP_IMAGES, 1},
    {"GL_UNPACK_COMPRESSED_BLOCK_WIDTH", GL_UNPACK_COMPRESSED_BLOCK_WIDTH, 1},
    {"GL_UNPACK_COMPRESSED_BLOCK_HEIGHT", GL_UNPACK_COMPRESSED_BLOCK_HEIGHT, 1},
    {"GL_UNPACK_COMPRESSED_BLOCK_DEPTH", GL_UNPACK_COMPRESSED_BLOCK_DEPTH, 1},
    {"GL_UNPACK_COMPRESSED_BLOCK_SIZE", GL_UNPACK_COMPRESSED_BLOCK_SIZE, 1},
    {"GL_PATCH_VERTICES", GL_PATCH_VERTICES, 1},
    {"GL_PATCH_DEFAULT_INNER_LEVEL", GL_PATCH_DEFAULT_INNER_LEVEL, 2},
    {"GL_PATCH_DEFAULT_OUTER_LEVEL", GL_PATCH_DEFAULT_OUTER_LEVEL, 4},
    {"GL_PIXEL_PACK_BUFFER_BINDING", GL_PIXEL_PACK_BUFFER_BINDING, 1},
    {"GL_PIXEL_UNPACK_BUFFER_BINDING", GL_PIXEL_UNPACK_BUFFER_BINDING, 1},
    {"GL_POINT_FADE_THRESHOLD_SIZE", GL_POINT_FADE_THRESHOLD_SIZE, 1},
    {"GL_POINT_SIZE", GL_POINT_SIZE, 1},
    {"GL_POINT_SPRITE_COORD_ORIGIN", GL_POINT_SPRITE_COORD_ORIGIN, 1},
    {"GL_POLYGON_MODE", GL_POLYGON_MODE, 1},
    {"GL_POLYGON_OFFSET_FACTOR", GL_POLYGON_OFFSET_FACTOR, 1},
    {"GL_POLYGON_OFFSET_UNITS", GL_POLYGON_OFFSET_UNITS, 1},
    {"GL_POLYGON_SMOOTH_HINT", GL_POLYGON_SMOOTH_HINT, 1},
    {"GL_PRIMITIVE_RESTART_INDEX", GL_PRIMITIVE_RESTART_INDEX, 1},
    {"GL_PROGRAM_PIPELINE_BINDING", GL_PROGRAM_PIPELINE_BINDING, 1},
    {"GL_PROVOKING_VERTEX", GL_PROVOKING_VERTEX, 1},
    {"GL_QUERY_BUFFER_BINDING", GL_QUERY_BUFFER_BINDING, 1},
    {"GL_READ_BUFFER", GL_READ_BUFFER, 1},
    {"GL_READ_FRAMEBUFFER_BINDING", GL_READ_FRAMEBUFFER_BINDING, 1},
    {"GL_RENDERBUFFER_BINDING", GL_RENDERBUFFER_BINDING, 1},
    {"GL_SAMPLE_COVERAGE_VALUE", GL_SAMPLE_COVERAGE_VALUE, 1},
    {"GL_SAMPLE_COVERAGE_INVERT", GL_SAMPLE_COVERAGE_INVERT, 1},
    {"GL_SHADER_STORAGE_BUFFER_BINDING", GL_SHADER_STORAGE_BUFFER_BINDING, 1},
    {"GL_STENCIL_FUNC", GL_STENCIL_FUNC, 1},
    {"GL_STENCIL_REF", GL_STENCIL_REF, 1},
    {"GL_STENCIL_VALUE_MASK", GL_STENCIL_VALUE_MASK, 1},
    {"GL_STENCIL_WRITEMASK", GL_STENCIL_WRITEMASK, 1},
    {"GL_STENCIL_FAIL", GL_STENCIL_FAIL, 1},
    {"GL_STENCIL_PASS_DEPTH_FAIL", GL_STENCIL_PASS_DEPTH_FAIL, 1},
    {"GL_STENCIL_PASS_DEPTH_PASS", GL_STENCIL_PASS_DEPTH_PASS, 1},
    {"GL_STENCIL_BACK_FUNC", GL_STENCIL_BACK_FUNC, 1},
    {"GL_STENCIL_BACK_REF", GL_STENCIL_BACK_REF, 1},
    {"GL_STENCIL_BACK_VALUE_MASK", GL_STENCIL_BACK_VALUE_MASK, 1},
    {"GL_STENCIL_BACK_WRITEMASK", GL_STENCIL_BACK_WRITEMASK, 1},
    {"GL_STENCIL_BACK_FAIL", GL_STENCIL_BACK_FAIL, 1},
    {"GL_STENCIL_BACK_PASS_DEPTH_FAIL", GL_STENCIL_BACK_PASS_DEPTH_FAIL, 1},
    {"GL_STENCIL_BACK_PASS_DEPTH_PASS", GL_STENCIL_BACK_PASS_DEPTH_PASS, 1},
    {"GL_STENCIL_CLEAR_VALUE", GL_STENCIL_CLEAR_VALUE, 1},
    {"GL_TEXTURE_BUFFER_BINDING", GL_TEXTURE_BUFFER_BINDING, 1},
    {"GL_TEXTURE_COMPRESSION_HINT", GL_TEXTURE_COMPRESSION_HINT, 1},
    {"GL_TRANSFORM_FEEDBACK_BINDING", GL_TRANSFORM_FEEDBACK_BINDING, 1},
    {"GL_TRANSFORM_FEEDBACK_BUFFER_BINDING", GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, 1},
    {"GL_UNIFORM_BUFFER_BINDING", GL_UNIFORM_BUFFER_BINDING, 1},
    {"GL_VERTEX_ARRAY_BINDING", GL_VERTEX_ARRAY_BINDING, 1},
};

struct Binding {
  const char *name;
  GLenum value;
};

/** A deleted program exists while it is current. */
GLboolean is_kept_program(GLuint name)
{
  GLint is_deleted = GL_TRUE;
  if (glIsProgram(name)) {
    glGetProgramiv(name, GL_DELETE_STATUS, &is_deleted);
  }
  return GLboolean(!is_deleted);
}

constexpr std::array<Binding, 11> TEXTURE_BINDINGS = {{
    {"GL_TEXTURE_BINDING_1D", GL_TEXTURE_BINDING_1D},
    {"GL_TEXTURE_BINDING_2D", GL_TEXTURE_BINDING_2D},
    {"GL_TEXTURE_BINDING_3D", GL_TEXTURE_BINDING_3D},
    {"GL_TEXTURE_BINDING_1D_ARRAY", GL_TEXTURE_BINDING_1D_ARRAY},
    {"GL_TEXTURE_BINDING_2D_ARRAY", GL_TEXTURE_BINDING_2D_ARRAY},
    {"GL_TEXTURE_BINDING_RECTANGLE", GL_TEXTURE_BINDING_RECTANGLE},
    {"GL_TEXTURE_BINDING_BUFFER", GL_TEXTURE_BINDING_BUFFER},
    {"GL_TEXTURE_BINDING_CUBE_MAP", GL_TEXTURE_BINDING_CUBE_MAP},
    {"GL_TEXTURE_BINDING_CUBE_MAP_ARRAY", GL_TEXTURE_BINDING_CUBE_MAP_ARRAY},
    {"GL_TEXTURE_BINDING_2D_MULTISAMPLE", GL_TEXTURE_BINDING_2D_MULTISAMPLE},
    {"GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY", GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY},
}};

/** Buffer targets with indexed bindings: binding, start, size. */
struct IndexedTarget {
  const char *name;
  GLenum target;
  GLenum binding;
  GLenum start;
  GLenum size;
  GLuint count;
};
constexpr IndexedTarget INDEXED_TARGETS[] = {
    {"GL_UNIFORM_BUFFER", GL_UNIFORM_BUFFER, GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE,
     36},
    {"GL_SHADER_STORAGE_BUFFER", GL_SHADER_STORAGE_BUFFER, GL_SHADER_STORAGE_BUFFER_BINDING,
     GL_SHADER_STORAGE_BUFFER_START, GL_SHADER_STORAGE_BUFFER_SIZE, 8},
    {"GL_ATOMIC_COUNTER_BUFFER", GL_ATOMIC_COUNTER_BUFFER, GL_ATOMIC_COUNTER_BUFFER_BINDING,
     GL_ATOMIC_COUNTER_BUFFER_START, GL_ATOMIC_COUNTER_BUFFER_SIZE, 1},
    {"GL_TRANSFORM_FEEDBACK_BUFFER", GL_TRANSFORM_FEEDBACK_BUFFER, GL_TRANSFORM_FEEDBACK_BUFFER_BINDING,
     GL_TRANSFORM_FEEDBACK_BUFFER_START, GL_TRANSFORM_FEEDBACK_BUFFER_SIZE, 4},
};

constexpr std::array<GLuint, 6> UNITS = {0, 3, 16, 17, 24, 31};
constexpr GLuint DRAW_BUFFERS = 8;
constexpr GLuint VIEWPORTS = 16;

/** Function that says whether the object exists that is bound at \a binding; nullptr: \a binding is no name. */
IsObject object_kind_of(GLenum binding)
{
  switch (binding) {
    case GL_ARRAY_BUFFER_BINDING:
    case GL_ATOMIC_COUNTER_BUFFER_BINDING:
    case GL_COPY_READ_BUFFER_BINDING:
    case GL_COPY_WRITE_BUFFER_BINDING:
    case GL_DISPATCH_INDIRECT_BUFFER_BINDING:
    case GL_DRAW_INDIRECT_BUFFER_BINDING:
    case GL_ELEMENT_ARRAY_BUFFER_BINDING:
    case GL_PIXEL_PACK_BUFFER_BINDING:
    case GL_PIXEL_UNPACK_BUFFER_BINDING:
    case GL_QUERY_BUFFER_BINDING:
    case GL_SHADER_STORAGE_BUFFER_BINDING:
    case GL_TEXTURE_BUFFER_BINDING:
    case GL_TRANSFORM_FEEDBACK_BUFFER_BINDING:
    case GL_UNIFORM_BUFFER_BINDING: return glIsBuffer;
    case GL_CURRENT_PROGRAM: return is_kept_program;
    case GL_PROGRAM_PIPELINE_BINDING: return glIsProgramPipeline;
    case GL_DRAW_FRAMEBUFFER_BINDING:
    case GL_READ_FRAMEBUFFER_BINDING: return glIsFramebuffer;
    case GL_RENDERBUFFER_BINDING: return glIsRenderbuffer;
    case GL_TRANSFORM_FEEDBACK_BINDING: return glIsTransformFeedback;
    case GL_VERTEX_ARRAY_BINDING: return glIsVertexArray;
    default: return nullptr;
  }
}

std::vector<double> indexed_integers(GLenum name, GLuint index, std::size_t count)
{
  std::array<GLint, 4> values{};
  glGetIntegeri_v(name, index, values.data());
  return {values.begin(), values.begin() + std::ptrdiff_t(count)};
}

void GLAPIENTRY ignore_message(GLenum /*source*/, GLenum /*type*/, GLuint /*id*/, GLenum /*severity*/,
                               GLsizei /*length*/, const GLchar * /*text*/, const void * /*user*/)
{
}

GLuint compiled_program()
{
  const GLuint program = glCreateProgram();
  for (const auto &[kind, text] :
       {std::pair(GL_VERTEX_SHADER, "#version 450 core\nvoid main() { gl_Position = vec4(0); }\n"),
        std::pair(GL_FRAGMENT_SHADER,
                  "#version 450 core\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(1); }\n")}) {
    const GLuint shader = glCreateShader(GLenum(kind));
    const char *source = text;
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  return program;
}

}  // namespace

HostObjects::HostObjects()
{
  glCreateBuffers(1, &buffer);
  glNamedBufferData(buffer, 65536, nullptr, GL_STATIC_DRAW);
  for (std::size_t i = 0; i < textures.size(); i++) {
    glCreateTextures(texture_targets[i], 1, &textures[i]);
  }
  glTextureStorage2D(textures[1], 1, GL_RGBA8, 64, 48);
  glClearTexImage(textures[1], 0, GL_RGBA, GL_UNSIGNED_BYTE, std::array<GLubyte, 4>{255, 255, 255, 255}.data());
  glTextureStorage3D(textures[4], 1, GL_RGBA8, 4, 4, 2);
  glClearTexImage(textures[4], 0, GL_RGBA, GL_UNSIGNED_BYTE, std::array<GLubyte, 4>{255, 255, 255, 255}.data());
  glCreateSamplers(1, &sampler);
  glCreateVertexArrays(1, &vertex_array);
  glVertexArrayElementBuffer(vertex_array, buffer);
  for (GLuint i = 0; i < 4; i++) {
    glVertexArrayVertexBuffer(vertex_array, i, buffer, 0, 16);
  }
  program = compiled_program();
  glCreateProgramPipelines(1, &pipeline);
  glCreateFramebuffers(1, &draw_framebuffer);
  glNamedFramebufferTexture(draw_framebuffer, GL_COLOR_ATTACHMENT0, textures[1], 0);
  glNamedFramebufferDrawBuffer(draw_framebuffer, GL_COLOR_ATTACHMENT0);
  glCreateFramebuffers(1, &read_framebuffer);
  glNamedFramebufferTexture(read_framebuffer, GL_COLOR_ATTACHMENT1, textures[1], 0);
  glNamedFramebufferReadBuffer(read_framebuffer, GL_COLOR_ATTACHMENT1);
  glCreateRenderbuffers(1, &renderbuffer);
  glCreateTransformFeedbacks(1, &transform_feedback);
}

HostObjects::~HostObjects()
{
  glDebugMessageCallback(nullptr, nullptr);
  glBindTransformFeedback(GL_TRANSFORM_FEEDBACK, 0);
  glUseProgram(0);
  // Mesa's error for a deleted pipeline.
  static_cast<void>(glGetError());
  for (const Kind &kind : kinds()) {
    (this->*kind.destroy)();
  }
}

const std::vector<HostObjects::Kind> &HostObjects::kinds()
{
  static const std::vector<Kind> kinds = {
      {"buffer", true, &HostObjects::delete_buffer},
      {"textures", true, &HostObjects::delete_textures},
      {"sampler", true, &HostObjects::delete_sampler},
      {"renderbuffer", true, &HostObjects::delete_renderbuffer},
      {"program", true, &HostObjects::delete_program},
      {"vertex array", false, &HostObjects::delete_vertex_array},
      {"pipeline", false, &HostObjects::delete_pipeline},
      {"framebuffers", false, &HostObjects::delete_framebuffers},
      {"transform feedback", false, &HostObjects::delete_transform_feedback},
  };
  return kinds;
}

void HostObjects::delete_buffer()
{
  glDeleteBuffers(1, &buffer);
  buffer = 0;
}

void HostObjects::delete_textures()
{
  glDeleteTextures(GLsizei(textures.size()), textures.data());
  textures = {};
}

void HostObjects::delete_sampler()
{
  glDeleteSamplers(1, &sampler);
  sampler = 0;
}

void HostObjects::delete_renderbuffer()
{
  glDeleteRenderbuffers(1, &renderbuffer);
  renderbuffer = 0;
}

void HostObjects::delete_program()
{
  glDeleteProgram(program);
  program = 0;
}

void HostObjects::delete_vertex_array()
{
  glDeleteVertexArrays(1, &vertex_array);
  vertex_array = 0;
}

void HostObjects::delete_pipeline()
{
  glDeleteProgramPipelines(1, &pipeline);
  pipeline = 0;
}

void HostObjects::delete_framebuffers()
{
  glDeleteFramebuffers(1, &draw_framebuffer);
  glDeleteFramebuffers(1, &read_framebuffer);
  draw_framebuffer = read_framebuffer = 0;
}

void HostObjects::delete_transform_feedback()
{
  glDeleteTransformFeedbacks(1, &transform_feedback);
  transform_feedback = 0;
}

std::vector<StateItem> state_table()
{
  std::vector<StateItem> table;
  for (const Capability &capability : CAPABILITIES) {
    table.push_back({capability.name, [&] { return std::vector<double>{double(glIsEnabled(capability.value))}; }});
  }
  for (const Value &value : VALUES) {
    table.push_back({value.name,
                     [&] {
                       std::array<GLdouble, 16> values{};
                       glGetDoublev(value.value, values.data());
                       return std::vector<double>(values.begin(), values.begin() + std::ptrdiff_t(value.count));
                     },
                     object_kind_of(value.value)});
  }
  for (const GLuint unit : UNITS) {
    const auto of_unit = [&](const char *name, GLenum value, IsObject is_object) {
      table.push_back({fmt::format("{}, unit {}", name, unit),
                       [unit, value] {
                         GLint active = 0;
                         glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
                         glActiveTexture(GL_TEXTURE0 + unit);
                         GLint binding = 0;
                         glGetIntegerv(value, &binding);
                         glActiveTexture(GLenum(active));
                         return std::vector<double>{double(binding)};
                       },
                       is_object});
    };
    for (const Binding &binding : TEXTURE_BINDINGS) {
      of_unit(binding.name, binding.value, glIsTexture);
    }
    of_unit("GL_SAMPLER_BINDING", GL_SAMPLER_BINDING, glIsSampler);
  }
  for (const IndexedTarget &target : INDEXED_TARGETS) {
    for (GLuint i = 0; i < target.count; i++) {
      table.push_back({fmt::format("{} {}", target.name, i),
                       [&target, i] {
                         std::vector<double> values = indexed_integers(target.binding, i, 1);
                         for (const GLenum name : {target.start, target.size}) {
                           GLint64 value = 0;
                           glGetInteger64i_v(name, i, &value);
                           values.push_back(double(value));
                         }
                         return values;
                       },
                       glIsBuffer});
    }
  }
  for (GLuint i = 0; i < DRAW_BUFFERS; i++) {
    table.push_back({fmt::format("GL_BLEND, draw buffer {}", i),
                     [i] { return std::vector<double>{double(glIsEnabledi(GL_BLEND, i))}; }});
    table.push_back({fmt::format("GL_COLOR_WRITEMASK, draw buffer {}", i),
                     [i] { return indexed_integers(GL_COLOR_WRITEMASK, i, 4); }});
    for (const Binding &blend : {Binding{"GL_BLEND_SRC_RGB", GL_BLEND_SRC_RGB},
                                 {"GL_BLEND_DST_RGB", GL_BLEND_DST_RGB},
                                 {"GL_BLEND_SRC_ALPHA", GL_BLEND_SRC_ALPHA},
                                 {"GL_BLEND_DST_ALPHA", GL_BLEND_DST_ALPHA},
                                 {"GL_BLEND_EQUATION_RGB", GL_BLEND_EQUATION_RGB},
                                 {"GL_BLEND_EQUATION_ALPHA", GL_BLEND_EQUATION_ALPHA}}) {
      table.push_back({fmt::format("{}, draw buffer {}", blend.name, i),
                       [i, name = blend.value] { return indexed_integers(name, i, 1); }});
    }
  }
  for (GLuint i = 0; i < VIEWPORTS; i++) {
    table.push_back({fmt::format("GL_VIEWPORT {}", i), [i] {
                       std::array<GLfloat, 4> values{};
                       glGetFloati_v(GL_VIEWPORT, i, values.data());
                       return std::vector<double>(values.begin(), values.end());
                     }});
    table.push_back({fmt::format("GL_DEPTH_RANGE {}", i), [i] {
                       std::array<GLdouble, 2> values{};
                       glGetDoublei_v(GL_DEPTH_RANGE, i, values.data());
                       return std::vector<double>(values.begin(), values.end());
                     }});
    table.push_back({fmt::format("GL_SCISSOR_BOX {}", i), [i] { return indexed_integers(GL_SCISSOR_BOX, i, 4); }});
    table.push_back({fmt::format("GL_SCISSOR_TEST {}", i),
                     [i] { return std::vector<double>{double(glIsEnabledi(GL_SCISSOR_TEST, i))}; }});
  }
  for (GLuint i = 0; i < 4; i++) {
    table.push_back({fmt::format("GL_CURRENT_VERTEX_ATTRIB {}", i), [i] {
                       std::array<GLdouble, 4> values{};
                       glGetVertexAttribdv(i, GL_CURRENT_VERTEX_ATTRIB, values.data());
                       return std::vector<double>(values.begin(), values.end());
                     }});
    table.push_back({fmt::format("GL_IMAGE_BINDING_NAME {}", i),
                     [i] { return indexed_integers(GL_IMAGE_BINDING_NAME, i, 1); }, glIsTexture});
    table.push_back({fmt::format("GL_VERTEX_BINDING_BUFFER {}", i),
                     [i] { return indexed_integers(GL_VERTEX_BINDING_BUFFER, i, 1); }, glIsBuffer});
  }
  table.push_back({"GL_SAMPLE_MASK_VALUE 0", [] { return indexed_integers(GL_SAMPLE_MASK_VALUE, 0, 1); }});
  for (const Binding &query : {Binding{"GL_SAMPLES_PASSED", GL_SAMPLES_PASSED},
                               {"GL_ANY_SAMPLES_PASSED", GL_ANY_SAMPLES_PASSED},
                               {"GL_PRIMITIVES_GENERATED", GL_PRIMITIVES_GENERATED},
                               {"GL_TIME_ELAPSED", GL_TIME_ELAPSED}}) {
    table.push_back({fmt::format("GL_CURRENT_QUERY of {}", query.name), [target = query.value] {
                       GLint value = 0;
                       glGetQueryiv(target, GL_CURRENT_QUERY, &value);
                       return std::vector<double>{double(value)};
                     }});
  }
  table.push_back({"GL_DEBUG_CALLBACK_FUNCTION", [] {
                     void *function = nullptr;
                     glGetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &function);
                     return std::vector<double>{double(reinterpret_cast<std::uintptr_t>(function))};
                   }});
  return table;
}

void set_unusual_state(const HostObjects &objects)
{
  for (const Capability &capability : CAPABILITIES) {
    // Setting primitive restart with a fixed index, and so on: the opposite of the initial value.
    if (glIsEnabled(capability.value)) {
      glDisable(capability.value);
    }
    else {
      glEnable(capability.value);
    }
  }
  for (std::size_t i = 0; i < UNITS.size(); i++) {
    glActiveTexture(GL_TEXTURE0 + UNITS[i]);
    for (std::size_t j = 0; j < objects.textures.size(); j++) {
      glBindTexture(HostObjects::texture_targets[j], objects.textures[j]);
    }
    glBindSampler(UNITS[i], objects.sampler);
  }
  glActiveTexture(GL_TEXTURE5);
  for (const IndexedTarget &target : INDEXED_TARGETS) {
    if (target.target == GL_TRANSFORM_FEEDBACK_BUFFER) {
      glBindTransformFeedback(GL_TRANSFORM_FEEDBACK, objects.transform_feedback);
    }
    for (GLuint i = 0; i < target.count; i++) {
      if (i % 3 == 2) {
        glBindBufferBase(target.target, i, objects.buffer);
      }
      else {
        glBindBufferRange(target.target, i, objects.buffer, GLintptr(256) * GLintptr(i + 1), 512 + 16 * GLsizeiptr(i));
      }
    }
  }
  for (const GLenum target : {GL_ARRAY_BUFFER, GL_ATOMIC_COUNTER_BUFFER, GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER,
                              GL_DISPATCH_INDIRECT_BUFFER, GL_DRAW_INDIRECT_BUFFER, GL_PIXEL_PACK_BUFFER,
                              GL_PIXEL_UNPACK_BUFFER, GL_QUERY_BUFFER, GL_SHADER_STORAGE_BUFFER, GL_TEXTURE_BUFFER,
                              GL_TRANSFORM_FEEDBACK_BUFFER, GL_UNIFORM_BUFFER}) {
    glBindBuffer(target, objects.buffer);
  }
  for (GLuint i = 0; i < DRAW_BUFFERS; i++) {
    if (i % 3 == 1) {
      glDisablei(GL_BLEND, i);
    }
    glColorMaski(i, i % 2 == 0, i % 2 == 1, GL_FALSE, i % 3 == 0);
    glBlendFuncSeparatei(i, GL_CONSTANT_COLOR, GL_DST_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_SRC_ALPHA);
    glBlendEquationSeparatei(i, GL_FUNC_SUBTRACT, i % 2 == 0 ? GL_MAX : GL_MIN);
  }
  for (GLuint i = 0; i < VIEWPORTS; i++) {
    const auto f = float(i);
    glViewportIndexedf(i, 1.0F + f, 2.0F + f, 3.5F + f, 4.0F + f);
    glDepthRangeIndexed(i, 0.25 + 0.01 * i, 0.75);
    glScissorIndexed(i, 1 + GLint(i), 2, 1, 1);
    if (i % 4 == 3) {
      glDisablei(GL_SCISSOR_TEST, i);
    }
  }
  for (GLuint i = 0; i < 4; i++) {
    glVertexAttrib4d(i, 1.0, 2.0, 3.0, 4.0 + i);
    glBindImageTexture(i, objects.textures[1], 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA8);
  }
  glBlendColor(0.1F, 0.2F, 0.3F, 0.4F);
  glClampColor(GL_CLAMP_READ_COLOR, GL_TRUE);
  glClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  glClearColor(0.5F, 0.6F, 0.7F, 0.8F);
  glCullFace(GL_FRONT_AND_BACK);
  glUseProgram(objects.program);
  glBindProgramPipeline(objects.pipeline);
  glClearDepth(0.3);
  glDepthFunc(GL_NEVER);
  glDepthMask(GL_FALSE);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, objects.draw_framebuffer);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, objects.read_framebuffer);
  glBindRenderbuffer(GL_RENDERBUFFER, objects.renderbuffer);
  glBindVertexArray(objects.vertex_array);
  glHint(GL_FRAGMENT_SHADER_DERIVATIVE_HINT, GL_NICEST);
  glHint(GL_LINE_SMOOTH_HINT, GL_FASTEST);
  glHint(GL_POLYGON_SMOOTH_HINT, GL_FASTEST);
  glHint(GL_TEXTURE_COMPRESSION_HINT, GL_NICEST);
  glFrontFace(GL_CW);
  glLineWidth(1.5F);
  glLogicOp(GL_XOR);
  glMinSampleShading(0.5F);
  for (const auto &[pack, unpack, value] :
       {std::tuple(GL_PACK_ALIGNMENT, GL_UNPACK_ALIGNMENT, 8), std::tuple(GL_PACK_SWAP_BYTES, GL_UNPACK_SWAP_BYTES, 1),
        std::tuple(GL_PACK_LSB_FIRST, GL_UNPACK_LSB_FIRST, 1), std::tuple(GL_PACK_ROW_LENGTH, GL_UNPACK_ROW_LENGTH, 17),
        std::tuple(GL_PACK_SKIP_PIXELS, GL_UNPACK_SKIP_PIXELS, 1),
        std::tuple(GL_PACK_SKIP_ROWS, GL_UNPACK_SKIP_ROWS, 2),
        std::tuple(GL_PACK_IMAGE_HEIGHT, GL_UNPACK_IMAGE_HEIGHT, 19),
        std::tuple(GL_PACK_SKIP_IMAGES, GL_UNPACK_SKIP_IMAGES, 3),
        std::tuple(GL_PACK_COMPRESSED_BLOCK_WIDTH, GL_UNPACK_COMPRESSED_BLOCK_WIDTH, 4),
        std::tuple(GL_PACK_COMPRESSED_BLOCK_HEIGHT, GL_UNPACK_COMPRESSED_BLOCK_HEIGHT, 4),
        std::tuple(GL_PACK_COMPRESSED_BLOCK_DEPTH, GL_UNPACK_COMPRESSED_BLOCK_DEPTH, 1),
        std::tuple(GL_PACK_COMPRESSED_BLOCK_SIZE, GL_UNPACK_COMPRESSED_BLOCK_SIZE, 16)}) {
    glPixelStorei(GLenum(pack), value);
    glPixelStorei(GLenum(unpack), value);
  }
  glPatchParameteri(GL_PATCH_VERTICES, 7);
  glPatchParameterfv(GL_PATCH_DEFAULT_INNER_LEVEL, std::array<GLfloat, 2>{2, 3}.data());
  glPatchParameterfv(GL_PATCH_DEFAULT_OUTER_LEVEL, std::array<GLfloat, 4>{4, 5, 6, 7}.data());
  glPointParameterf(GL_POINT_FADE_THRESHOLD_SIZE, 3.0F);
  glPointSize(2.0F);
  glPointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, GL_LOWER_LEFT);
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  glPolygonOffset(1.5F, 2.5F);
  glPrimitiveRestartIndex(1);
  glProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
  glSampleCoverage(0.25F, GL_TRUE);
  glSampleMaski(0, 0x5U);
  glClearStencil(3);
  for (const auto &[face, offset] : {std::pair(GL_FRONT, 0), std::pair(GL_BACK, 10)}) {
    glStencilFuncSeparate(GLenum(face), GL_NEVER, 1 + offset, 0x3U);
    glStencilMaskSeparate(GLenum(face), 0x7U);
    glStencilOpSeparate(GLenum(face), GL_INCR, GL_DECR, GL_INVERT);
  }
  glDebugMessageCallback(&ignore_message, nullptr);
}

StateSnapshot::StateSnapshot(const std::vector<StateItem> &table, const StateSnapshot *deletions) : table_(table)
{
  for (const StateItem &item : table) {
    const bool was_deleted = deletions && deletions->are_deleted_[values_.size()];
    values_.push_back(item.read());
    const double name = values_.back().front();
    are_deleted_.push_back(was_deleted || (item.is_object && name != 0 && !item.is_object(GLuint(name))));
  }
}

std::vector<std::string> StateSnapshot::deleted() const
{
  std::vector<std::string> names;
  for (std::size_t i = 0; i < table_.size(); i++) {
    if (are_deleted_[i]) {
      names.push_back(table_[i].name);
    }
  }
  return names;
}

std::vector<std::string> StateSnapshot::differences() const
{
  std::vector<std::string> found;
  for (std::size_t i = 0; i < table_.size(); i++) {
    const std::vector<double> now = table_[i].read();
    const bool is_unbound = are_deleted_[i] && std::ranges::count(now, 0.0) == std::ptrdiff_t(now.size());
    if (now != values_[i] && !is_unbound) {
      found.push_back(
          fmt::format("{}: was {}, is {}", table_[i].name, fmt::join(values_[i], " "), fmt::join(now, " ")));
    }
  }
  return found;
}

}  // namespace gnomon::test
