// SPDX-License-Identifier: MIT
#include "gpu/gpu_testing.hh"

#include "gpu_framebuffer_stack.hh"

namespace gnomon::gpu {
namespace {

using test::error_of;
using test::expect_contains;

TEST(State, PrintsItsNamesInOrder)
{
  EXPECT_EQ(to_string(State::None), "none");
  EXPECT_EQ(to_string(State::DepthClamp), "depth_clamp");
  EXPECT_EQ(to_string(State::DepthNearerEqual | State::WriteDepth), "write_depth depth_nearer_equal");
  EXPECT_EQ(to_string(State((1U << 9) - 1)),
            "write_color write_depth depth_nearer_equal depth_equal cull_back cull_front front_clockwise blend_add "
            "depth_clamp");
}

TEST(State, HasEachOfItsBitsAndNoOther)
{
  const State state = State::WriteColor | State::CullFront;
  EXPECT_TRUE(has(state, State::WriteColor));
  EXPECT_TRUE(has(state, State::CullFront));
  EXPECT_FALSE(has(state, State::CullBack));
  EXPECT_FALSE(has(state, State::None));
}

/** Resources of the tests below. */
class CommandListTest : public testing::Test {
 protected:
  std::unique_ptr<Device> device = create_null_device();
  Texture color = device->create_texture({.name = "hdr", .width = 4, .height = 4});
  Texture depth = device->create_texture({.name = "depth", .format = Format::Depth32F, .width = 4, .height = 4});
  Sampler sampler = device->create_sampler({.name = "linear"});
  Framebuffer framebuffer = device->create_framebuffer({"scene", {{&color}}, {&depth}});
  Framebuffer other = device->create_framebuffer({"shadow", {}, {&depth}});
  Buffer block = device->create_buffer({.name = "light_block", .size_bytes = 512});
  Buffer store = device->create_buffer({"object_block", BufferKind::Storage, 512});
  Shader shader = test::make_shader(*device, "flat", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  Batch batch = test::full_triangle(*device, 0);
  CommandList list;
};

TEST_F(CommandListTest, SerializesEachCommandAsALine)
{
  const glm::vec4 value(1);
  list.update(block, 32, std::as_bytes(std::span(&value, 1)));
  list.begin_pass("main", framebuffer,
                  {.color_load = LoadAction::DontCare,
                   .depth_load = LoadAction::Load,
                   .depth_store = StoreAction::DontCare,
                   .depth_bias = {-1, -2}});
  list.set_shader(shader.id());
  list.set_state(State::WriteColor | State::CullBack);
  list.bind_uniform(9, {block.id()});
  list.bind_uniform(10, {block.id(), 256, 64});
  list.bind_storage(0, {store.id(), 16, 32});
  list.bind_texture(16, color.id(), sampler.id());
  test::push_constants(list, shader, value);
  list.draws.push_back({3, 2, 0, 0, 0});
  list.draws.push_back({6, 1, 3, 3, 2});
  list.instances.resize(3);
  list.draw(0, 2);
  list.bind_instances(store.id());
  list.draw(1, 1);
  list.bind_instances(0);
  list.draw_procedural(3, 6);
  list.end_pass();
  EXPECT_EQ(list.serialize(*device),
            "update light_block 16 bytes at 32\n"
            "begin main -> scene color dont_care/store depth load/dont_care bias -1, -2\n"
            "  shader flat\n"
            "  state write_color cull_back\n"
            "  uniform light_block -> 9\n"
            "  uniform light_block -> 10 [256, 320)\n"
            "  storage object_block -> 0 [16, 48)\n"
            "  texture hdr linear -> 16\n"
            "  push_constants 16 bytes\n"
            "  draw 1 triangles x2, instances from 0\n"
            "  draw 2 triangles x1, instances from 2\n"
            "  instances of object_block\n"
            "  draw 2 triangles x1, instances from 2\n"
            "  instances of the list\n"
            "  draw_procedural 3 vertices x6\n"
            "end\n");
}

TEST_F(CommandListTest, PrintsAViewportThatIsNotTheWhole)
{
  list.begin_pass("main", framebuffer, {.viewport = {.size_px = {3, 2}}});
  list.end_pass();
  EXPECT_EQ(list.serialize(*device),
            "begin main -> scene color clear/store depth clear/store viewport 3x2\n"
            "end\n");
}

TEST_F(CommandListTest, PrintsAFramebufferOfTheHostAndARectangle)
{
  const Rectangle part{{10, 20}, {3, 2}};
  list.begin_pass("main", HostFramebuffer{.name = 7, .size_px = {64, 48}},
                  {.color_load = LoadAction::Load, .viewport = part, .scissor = part, .is_srgb_encoded = true});
  list.end_pass();
  EXPECT_EQ(list.serialize(*device),
            "begin main -> host framebuffer color load/store depth clear/store viewport 3x2 at 10,20"
            " scissor 3x2 at 10,20 srgb\n"
            "end\n");
}

TEST_F(CommandListTest, CopiesBytesWhenTheyAreRecorded)
{
  glm::vec4 value(1);
  list.update(block, 0, std::as_bytes(std::span(&value, 1)));
  value = glm::vec4(2);
  test::push_constants(list, shader, value);
  value = glm::vec4(3);
  ASSERT_EQ(list.commands().size(), 2U);
  for (std::size_t i = 0; i < 2; i++) {
    const Command &command = list.commands()[i];
    ASSERT_EQ(command.count, sizeof(value));
    glm::vec4 recorded;
    std::memcpy(&recorded, list.bytes().data() + command.first, sizeof(recorded));
    EXPECT_EQ(recorded, glm::vec4(float(i) + 1));
  }
}

TEST_F(CommandListTest, ClearLeavesNothing)
{
  list.begin_pass("main", framebuffer, {});
  list.set_shader(shader.id());
  test::push_constants(list, shader, glm::vec4(0));
  test::append_draw(list, batch);
  list.end_pass();
  list.clear();
  EXPECT_TRUE(list.commands().empty() && list.passes().empty() && list.bytes().empty() && list.draws.empty() &&
              list.instances.empty());
  EXPECT_EQ(list.serialize(*device), "");
}

TEST_F(CommandListTest, OutlivesItsResourcesAsText)
{
  list.bind_texture(3, color.id(), sampler.id());
  framebuffer = Framebuffer();
  color = Texture();
  sampler = Sampler();
  EXPECT_FALSE(list.serialize(*device).empty());
}

using CommandListInternalErrorTest = CommandListTest;

TEST_F(CommandListInternalErrorTest, UpdatePastTheBufferIsAnAssertion)
{
  test::expect_internal_error([&] { list.update(block, 500, std::vector<std::byte>(16)); },
                              "16 bytes at 500 do not fit into 512");
}

// The stack of seed 001, for which Pop and Top of an empty stack are undefined.
using FramebufferStackTest = CommandListTest;

TEST_F(FramebufferStackTest, PopOnEmptyIsAnErrorAndChangesNothing)
{
  FramebufferStack stack(list);
  expect_contains(error_of([&] { stack.pop(); }), "pop");
  EXPECT_TRUE(stack.is_empty());
  EXPECT_TRUE(list.commands().empty());
  // Afterwards the stack works as before.
  stack.push("main", framebuffer, {});
  stack.pop();
  EXPECT_THROW(stack.pop(), Error);
  EXPECT_EQ(list.serialize(*device), "begin main -> scene color clear/store depth clear/store\nend\n");
}

TEST_F(FramebufferStackTest, TopOfEmptyIsAnErrorAndChangesNothing)
{
  FramebufferStack stack(list);
  expect_contains(error_of([&] { static_cast<void>(stack.top()); }), "top");
  EXPECT_TRUE(stack.is_empty());
  EXPECT_TRUE(list.commands().empty());
}

TEST_F(FramebufferStackTest, PopResumesThePassBelowWithWhatItHadDrawn)
{
  FramebufferStack stack(list);
  stack.push("main", framebuffer, {.clear_color = glm::vec4(1)});
  EXPECT_EQ(&stack.top(), &framebuffer);
  stack.push("shadow", other, {});
  EXPECT_EQ(&stack.top(), &other);
  stack.push("inner", framebuffer, {.color_load = LoadAction::DontCare});
  EXPECT_EQ(&stack.top(), &framebuffer);
  stack.pop();
  EXPECT_EQ(&stack.top(), &other);
  stack.pop();
  EXPECT_EQ(&stack.top(), &framebuffer);
  EXPECT_FALSE(stack.is_empty());
  stack.pop();
  EXPECT_TRUE(stack.is_empty());
  EXPECT_EQ(list.serialize(*device),
            "begin main -> scene color clear/store depth clear/store\n"
            "end\n"
            "begin shadow -> shadow color clear/store depth clear/store\n"
            "end\n"
            "begin inner -> scene color dont_care/store depth clear/store\n"
            "end\n"
            "begin shadow -> shadow color load/store depth load/store\n"
            "end\n"
            "begin main -> scene color load/store depth load/store\n"
            "end\n");
}

TEST_F(FramebufferStackTest, PassThatDiscardsCannotBeSuspended)
{
  for (const bool is_color : {true, false}) {
    list.clear();
    FramebufferStack stack(list);
    PassActions actions;
    (is_color ? actions.color_store : actions.depth_store) = StoreAction::DontCare;
    stack.push("below", framebuffer, actions);
    const std::string before = list.serialize(*device);
    const std::string message = error_of([&] { stack.push("above", other, {}); });
    expect_contains(message, "'above'");
    expect_contains(message, "'below'");
    EXPECT_EQ(&stack.top(), &framebuffer);
    EXPECT_EQ(list.serialize(*device), before);
    stack.pop();
    EXPECT_TRUE(stack.is_empty());
  }
}

}  // namespace
}  // namespace gnomon::gpu
