// SPDX-License-Identifier: MIT
#pragma once

#include "gpu/gpu_host_contexts.hh"

#include "gpu_device.hh"

#include <epoxy/gl.h>

#include <array>
#include <vector>

namespace gnomon::test {

/** Bytes of a framebuffer, rows from the bottom. */
struct Pixels {
  glm::ivec2 size_px{0};
  std::vector<std::array<std::uint8_t, 4>> values;

  [[nodiscard]] std::array<int, 4> at(int x, int y) const
  {
    const auto &value = values.at(std::size_t(y) * std::size_t(size_px.x) + std::size_t(x));
    return {value[0], value[1], value[2], value[3]};
  }
  bool operator==(const Pixels &) const = default;
};

inline bool is_inside(const gpu::Rectangle &rectangle, int x, int y)
{
  const glm::ivec2 pixel = glm::ivec2(x, y) - rectangle.origin_px;
  return pixel.x >= 0 && pixel.y >= 0 && pixel.x < rectangle.size_px.x && pixel.y < rectangle.size_px.y;
}

/** A host's framebuffer of a colour texture and a depth buffer, filled with a pattern that differs in every pixel. */
class HostPicture {
 public:
  static constexpr float filled_depth = 0.5F;

  /** \a samples: 0 for a texture that is not multisampled. */
  HostPicture(glm::ivec2 size_px, GLenum format, int samples) : size_px_(size_px), format_(format), samples_(samples)
  {
    glCreateFramebuffers(1, &name_);
    glCreateTextures(samples > 0 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D, 1, &texture_);
    glCreateRenderbuffers(1, &depth_);
    if (samples > 0) {
      glTextureStorage2DMultisample(texture_, samples, format, size_px.x, size_px.y, GL_TRUE);
      glNamedRenderbufferStorageMultisample(depth_, samples, GL_DEPTH_COMPONENT32F, size_px.x, size_px.y);
    }
    else {
      glTextureStorage2D(texture_, 1, format, size_px.x, size_px.y);
      glNamedRenderbufferStorage(depth_, GL_DEPTH_COMPONENT32F, size_px.x, size_px.y);
    }
    glNamedFramebufferTexture(name_, GL_COLOR_ATTACHMENT0, texture_, 0);
    glNamedFramebufferRenderbuffer(name_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
    fill();
  }
  ~HostPicture()
  {
    glDeleteFramebuffers(1, &name_);
    glDeleteTextures(1, &texture_);
    glDeleteRenderbuffers(1, &depth_);
  }
  HostPicture(const HostPicture &) = delete;
  HostPicture &operator=(const HostPicture &) = delete;

  [[nodiscard]] gpu::HostFramebuffer framebuffer() const
  {
    return {.name = name_, .size_px = size_px_};
  }
  [[nodiscard]] GLuint texture() const
  {
    return texture_;
  }
  void clear_depth(float depth) const
  {
    glClearNamedFramebufferfv(name_, GL_DEPTH, 0, &depth);
  }
  /** The mean of each pixel's samples, as stored. */
  [[nodiscard]] Pixels pixels() const
  {
    if (samples_ > 0) {
      const HostPicture resolved(size_px_, format_, 0);
      glBlitNamedFramebuffer(name_, resolved.name_, 0, 0, size_px_.x, size_px_.y, 0, 0, size_px_.x, size_px_.y,
                             GL_COLOR_BUFFER_BIT, GL_NEAREST);
      return resolved.pixels();
    }
    Pixels pixels{size_px_,
                  std::vector<std::array<std::uint8_t, 4>>(std::size_t(size_px_.x) * std::size_t(size_px_.y))};
    glGetTextureImage(texture_, 0, GL_RGBA, GL_UNSIGNED_BYTE, GLsizei(pixels.values.size() * 4), pixels.values.data());
    return pixels;
  }
  /** \pre not multisampled */
  [[nodiscard]] std::vector<float> depths() const
  {
    std::vector<float> depths(std::size_t(size_px_.x) * std::size_t(size_px_.y));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, name_);
    glReadPixels(0, 0, size_px_.x, size_px_.y, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    return depths;
  }

 private:
  void fill() const
  {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, name_);
    glEnable(GL_SCISSOR_TEST);
    for (int y = 0; y < size_px_.y; y++) {
      for (int x = 0; x < size_px_.x; x++) {
        glScissor(x, y, 1, 1);
        glClearColor(float((37 * x + 91 * y) % 256) / 255.0F, float((53 * x + 29 * y) % 256) / 255.0F,
                     float((11 * x + 71 * y) % 256) / 255.0F, float((17 * x + 13 * y) % 256) / 255.0F);
        glClear(GL_COLOR_BUFFER_BIT);
      }
    }
    glDisable(GL_SCISSOR_TEST);
    glClearColor(0, 0, 0, 0);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    clear_depth(filled_depth);
  }

  glm::ivec2 size_px_;
  GLenum format_;
  int samples_;
  GLuint name_ = 0;
  GLuint texture_ = 0;
  GLuint depth_ = 0;
};

/** Outside of \a rectangle, \a pixels equal \a before. */
inline void expect_equal_outside(const gpu::Rectangle &rectangle, const Pixels &pixels, const Pixels &before)
{
  for (int y = 0; y < before.size_px.y; y++) {
    for (int x = 0; x < before.size_px.x; x++) {
      if (!is_inside(rectangle, x, y)) {
        ASSERT_EQ(pixels.at(x, y), before.at(x, y)) << x << ", " << y;
      }
    }
  }
}

/** Within \a rectangle, at least nine tenths of \a pixels differ from \a before; few of a picture's equal the pattern.
 */
inline void expect_drawn_inside(const gpu::Rectangle &rectangle, const Pixels &pixels, const Pixels &before)
{
  int changed = 0;
  for (int y = 0; y < rectangle.size_px.y; y++) {
    for (int x = 0; x < rectangle.size_px.x; x++) {
      const glm::ivec2 pixel = rectangle.origin_px + glm::ivec2(x, y);
      changed += pixels.at(pixel.x, pixel.y) != before.at(pixel.x, pixel.y) ? 1 : 0;
    }
  }
  EXPECT_GE(10 * changed, 9 * rectangle.size_px.x * rectangle.size_px.y);
}

/** Outside of \a rectangle, \a depths of \a size_px are those that HostPicture was filled with. */
inline void expect_filled_depth_outside(const gpu::Rectangle &rectangle, const std::vector<float> &depths,
                                        glm::ivec2 size_px)
{
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      if (!is_inside(rectangle, x, y)) {
        ASSERT_EQ(depths[std::size_t(y * size_px.x + x)], HostPicture::filled_depth) << x << ", " << y;
      }
    }
  }
}

/** A host's context and a device on it. */
class HostFramebufferTest : public HostContextTest {
 protected:
  void SetUp() override
  {
    HostContextTest::SetUp();
    if (!IsSkipped() && !HasFailure()) {
      device = gpu::create_gl_device({.context = gpu::ContextKind::Host});
    }
  }

  std::unique_ptr<gpu::Device> device;
};

}  // namespace gnomon::test
