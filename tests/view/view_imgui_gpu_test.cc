// SPDX-License-Identifier: MIT
// The user interface as the device draws it.
#include "gpu_device_fixture.hh"
#include "gpu_read.hh"

#include "view_imgui.hh"

#include <imgui.h>
#include <glm/gtc/type_precision.hpp>

#include <functional>
#include <memory>
#include <vector>

namespace gnomon::view {
namespace {

constexpr glm::ivec2 size_px(40, 30);

class ViewInterfaceGpu : public test::SharedDeviceTest {
 protected:
  void SetUp() override
  {
    test::SharedDeviceTest::SetUp();
    if (device) {
      ImGui::CreateContext();
      ImGui::GetIO().DisplaySize = {float(size_px.x), float(size_px.y)};
      ImGui::GetIO().IniFilename = nullptr;
      renderer = std::make_unique<ImGuiBackend>(*device);
      texture = device->create_texture({.name = "window", .width = size_px.x, .height = size_px.y});
      framebuffer = device->create_framebuffer({"window", {{&texture}}, {}});
    }
  }
  void TearDown() override
  {
    if (renderer) {
      renderer.reset();
      ImGui::DestroyContext();
    }
  }
  /** Pixels that \a draw adds to an empty interface, rows from the bottom. */
  std::vector<glm::u8vec4> drawn(const std::function<void(ImDrawList &)> &draw)
  {
    ImGui::NewFrame();
    draw(*ImGui::GetForegroundDrawList());
    ImGui::Render();
    renderer->draw({.framebuffer = &framebuffer}, size_px);
    return gpu::read_as<glm::u8vec4>(*device, texture);
  }

  std::unique_ptr<ImGuiBackend> renderer;
  gpu::Texture texture;
  gpu::Framebuffer framebuffer;
};

/** A rectangle of four colours and a triangle over it, both larger than the rectangle that clips them. */
void add_shapes(ImDrawList &list)
{
  list.AddRectFilledMultiColor({2, 2}, {38, 28}, IM_COL32(255, 0, 0, 255), IM_COL32(0, 255, 0, 255),
                               IM_COL32(0, 0, 255, 255), IM_COL32(255, 255, 255, 255));
  list.AddTriangleFilled({20, -9}, {47, 33}, {-5, 25}, IM_COL32(200, 100, 50, 128));
}

TEST_F(ViewInterfaceGpu, WithinItsRectangleACommandDrawsWhatItDrawsWithout)
{
  const std::vector<glm::u8vec4> empty = drawn([](ImDrawList & /*list*/) {});
  const std::vector<glm::u8vec4> whole = drawn(&add_shapes);
  const ImVec2 low(7, 5);
  const ImVec2 high(31, 22);
  const std::vector<glm::u8vec4> clipped = drawn([&](ImDrawList &list) {
    list.PushClipRect(low, high);
    add_shapes(list);
    list.PopClipRect();
  });
  ASSERT_NE(whole, empty);
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      const std::size_t pixel = std::size_t((size_px.y - 1 - y) * size_px.x + x);
      const bool is_inside = float(x) >= low.x && float(x) < high.x && float(y) >= low.y && float(y) < high.y;
      for (int channel = 0; channel < 4; channel++) {
        // Colours between the corners of a part of a triangle are rounded to another byte.
        EXPECT_NEAR(clipped[pixel][channel], (is_inside ? whole : empty)[pixel][channel], is_inside ? 1 : 0)
            << x << ", " << y;
      }
    }
  }
}

TEST_F(ViewInterfaceGpu, NothingIsDrawnOutsideOfTheRectangle)
{
  const std::vector<glm::u8vec4> empty = drawn([](ImDrawList & /*list*/) {});
  EXPECT_EQ(drawn([](ImDrawList &list) {
              list.PushClipRect({10, 10}, {20, 20});
              list.AddRectFilled({22, 3}, {30, 28}, IM_COL32_WHITE);
              list.AddTriangleFilled({5, 21}, {25, 21}, {15, 29}, IM_COL32_WHITE);
              list.PopClipRect();
            }),
            empty);
}

}  // namespace
}  // namespace gnomon::view
