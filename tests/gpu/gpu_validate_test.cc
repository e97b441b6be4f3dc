// SPDX-License-Identifier: MIT
#include "gpu/gpu_testing.hh"

#include "draw_object_shared.h"
#include "gpu_validate.hh"

namespace gnomon::gpu {
namespace {

using test::error_of;
using test::expect_contains;

/** A shader that reads one binding of each kind and push constants. */
constexpr const char *READING_FRAG = R"(
PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  vec4 color;
};
layout(std140, binding = 9) uniform light_block
{
  vec4 lights[4];
};
layout(std140, binding = 0) readonly buffer object_block
{
  vec4 objects[];
};
layout(binding = 16) uniform sampler2D radiance;
layout(location = 0) out vec4 result;
void main()
{
  result = color + lights[3] + objects[0] + texture(radiance, vec2(0));
}
)";

/** A valid list with one changed command. */
class Validation : public testing::Test {
 protected:
  static constexpr std::uint32_t ALIGNMENT = 16;

  /** Replaces the commands at the position of its name; empty: those of a valid list. */
  struct Changes {
    PassActions actions{};
    std::function<void()> before_pass{};
    std::function<void()> at_shader{};
    std::function<void()> at_state{};
    std::function<void()> at_uniform{};
    std::function<void()> at_storage{};
    std::function<void()> at_texture{};
    std::function<void()> at_constants{};
    std::function<void()> at_draw{};
    std::function<void()> at_end{};
  };

  void record(const Changes &changes)
  {
    const auto either = [](const std::function<void()> &change, auto &&otherwise) {
      if (change) {
        change();
      }
      else {
        otherwise();
      }
    };
    list.clear();
    either(changes.before_pass, [] {});
    list.begin_pass("lit", framebuffer, changes.actions);
    either(changes.at_shader, [&] { list.set_shader(shader.id()); });
    either(changes.at_state, [&] { list.set_state(State::WriteColor); });
    either(changes.at_uniform, [&] { list.bind_uniform(9, {block.id()}); });
    either(changes.at_storage, [&] { list.bind_storage(0, {store.id()}); });
    either(changes.at_texture, [&] { list.bind_texture(16, source.id(), sampler.id()); });
    either(changes.at_constants, [&] { test::push_constants(list, shader, glm::vec4(1)); });
    either(changes.at_draw, [&] { test::append_draw(list, batch); });
    either(changes.at_end, [&] { list.end_pass(); });
  }

  /** Expects a message with the pass and all \a parts. A submission gives the same message and counts nothing. */
  void expect_refused(const Changes &changes, std::initializer_list<std::string_view> parts)
  {
    record(changes);
    const std::string message = error_of([&] { validate(list, *device); });
    expect_contains(message, "command list: ");
    for (const std::string_view part : parts) {
      expect_contains(message, part);
    }
#ifndef NDEBUG
    const std::uint64_t passes = device->counters().passes;
    EXPECT_EQ(error_of([&] { device->submit(list); }), message);
    EXPECT_EQ(device->counters().passes, passes);
#endif
  }

  std::unique_ptr<Device> device = create_null_device({.uniform_offset_alignment = ALIGNMENT});
  Texture color = device->create_texture({.name = "hdr", .width = 4, .height = 4});
  Texture source = device->create_texture({.name = "source", .width = 4, .height = 4});
  Sampler sampler = device->create_sampler({.name = "linear"});
  Sampler comparison = device->create_sampler({.name = "comparison", .is_depth_comparison = true});
  Framebuffer framebuffer = device->create_framebuffer({"scene", {{&color}}, {}});
  Buffer block = device->create_buffer({.name = "light_block", .size_bytes = 64});
  Buffer store = device->create_buffer({"object_block", BufferKind::Storage, 64});
  Shader shader = test::make_shader(*device, "reading", test::CLIP_SPACE_VERT, READING_FRAG);
  Batch batch = test::full_triangle(*device, 0);
  CommandList list;
};

TEST_F(Validation, AcceptsAValidList)
{
  record({});
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "");
  device->submit(list);
  // Texture 0, which is declared to be absent.
  record({.at_texture = [&] { list.bind_texture(16, 0, 0); }});
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "");
  // Bindings stay from pass to pass; the state does not.
  record({});
  list.begin_pass("second", framebuffer, {});
  list.set_state(State::WriteColor);
  list.draw(0, 1);
  list.end_pass();
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "");
}

TEST_F(Validation, PassesAreEndedAndNotNested)
{
  expect_refused({.at_draw = [&] { list.begin_pass("inner", framebuffer, {}); }},
                 {"pass 'lit'", "command 7 (begin_pass)", "pass 'inner' begins inside"});
  expect_refused({.at_end = [&] {}}, {"pass 'lit' is not ended"});
  expect_refused({.before_pass = [&] { list.end_pass(); }},
                 {"outside of a pass", "command 0 (end_pass)", "no pass to end"});
}

TEST_F(Validation, DrawsAreInAPass)
{
  expect_refused({.before_pass = [&] { list.draw_procedural(3, 1); }},
                 {"outside of a pass", "(draw_procedural)", "must be inside a pass"});
  expect_refused({.at_end =
                      [&] {
                        list.end_pass();
                        list.draw(0, 1);
                      }},
                 {"outside of a pass", "(draw)", "must be inside a pass"});
}

TEST_F(Validation, UpdatesAreOutsideOfPasses)
{
  const auto update = [&] { list.update(block, 0, std::vector<std::byte>(16)); };
  record({.before_pass = update});
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "");
  expect_refused({.at_draw = update}, {"pass 'lit'", "(update)", "buffer 'light_block'", "inside a pass"});
}

TEST_F(Validation, ShaderAndStateAreSet)
{
  expect_refused({.at_shader = [] {}}, {"pass 'lit'", "(draw)", "no shader is set"});
  expect_refused({.at_state = [] {}}, {"(draw)", "shader 'reading'", "no state is set in this pass"});
  // State of an earlier pass does not count.
  expect_refused({.at_end =
                      [&] {
                        list.end_pass();
                        list.begin_pass("second", framebuffer, {});
                        list.draw(0, 1);
                        list.end_pass();
                      }},
                 {"pass 'second'", "no state is set in this pass"});
}

TEST_F(Validation, AWireframeNeedsADeviceThatDrawsEdges)
{
  const auto wireframe = [&] { list.set_state(State::WriteColor | State::Wireframe); };
  record({.at_state = wireframe});
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "");
  const std::unique_ptr<Device> without = create_null_device({.has_wireframe = false});
  const Texture target = without->create_texture({.name = "hdr", .width = 4, .height = 4});
  const Framebuffer whole = without->create_framebuffer({"scene", {{&target}}, {}});
  list.clear();
  list.begin_pass("edges", whole, {});
  wireframe();
  list.end_pass();
  const std::string message = error_of([&] { validate(list, *without); });
  expect_contains(message, "pass 'edges'");
  expect_contains(message, "has_wireframe");
}

TEST_F(Validation, DeclaredBindingsAreBound)
{
  expect_refused({.at_uniform = [] {}}, {"(draw)", "shader 'reading'", "uniform 'light_block' at slot 9 is not bound"});
  expect_refused({.at_storage = [] {}}, {"shader 'reading'", "storage 'object_block' at slot 0 is not bound"});
  expect_refused({.at_texture = [] {}}, {"shader 'reading'", "texture 'radiance' at slot 16 is not bound"});
  expect_refused({.at_texture = [&] { list.bind_texture(17, source.id(), sampler.id()); }},
                 {"texture 'radiance' at slot 16 is not bound"});
  expect_refused({.at_constants = [] {}}, {"shader 'reading'", "push constants at slot 8 are not set"});
}

TEST_F(Validation, PushConstantsHaveTheSizeOfTheirBlock)
{
  const auto push = [&](std::size_t size) {
    return [&, size] { list.push_constants(8, std::vector<std::byte>(size)); };
  };
  expect_refused({.at_constants = push(12)}, {"shader 'reading'", "12 bytes of push constants", "has 16"});
  expect_refused({.at_constants = push(32)}, {"shader 'reading'", "32 bytes of push constants", "has 16"});
  expect_refused({.at_constants = [&] { list.push_constants(7, std::vector<std::byte>(16)); }}, {"slot 8", "not set"});
}

TEST_F(Validation, KindsOfBuffersAllowTheirUse)
{
  // A range of a storage buffer may be a uniform block, up to the size that those may have.
  record({.at_uniform = [&] { list.bind_uniform(9, {store.id()}); }});
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "");
  const Buffer blocks = device->create_buffer({"blocks", BufferKind::Storage, 1 << 20});
  record({.at_uniform = [&] { list.bind_uniform(9, {blocks.id(), 1 << 18, 1 << 10}); }});
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "");
  expect_refused({.at_uniform = [&] { list.bind_uniform(9, {blocks.id()}); }},
                 {"(bind_uniform)", "buffer 'blocks': a range of 1048576 bytes", "at most 65536"});
  expect_refused({.at_storage = [&] { list.bind_storage(0, {block.id()}); }},
                 {"(bind_storage)", "buffer 'light_block' is a uniform buffer"});
}

TEST_F(Validation, RangesOfBuffersAreInsideAlignedAndLargeEnough)
{
  expect_refused({.at_uniform =
                      [&] {
                        list.bind_uniform(9, {block.id(), 8, 16});
                      }},
                 {"(bind_uniform)", "buffer 'light_block'", "offset 8 is no multiple of 16"});
  expect_refused({.at_uniform =
                      [&] {
                        list.bind_uniform(9, {block.id(), 16, 64});
                      }},
                 {"buffer 'light_block'", "[16, 80) exceed its 64 bytes"});
  expect_refused({.at_storage =
                      [&] {
                        list.bind_storage(0, {store.id(), 64, 0});
                      }},
                 {"(bind_storage)", "buffer 'object_block'", "exceed its 64 bytes"});
  expect_refused({.at_uniform =
                      [&] {
                        list.bind_uniform(9, {block.id(), 16, 0});
                      }},
                 {"(draw)", "uniform 'light_block' has 64 bytes, and 48 of buffer 'light_block' are bound"});
  expect_refused({.at_uniform = [&] { list.bind_uniform(-1, {block.id()}); }}, {"slot -1 is negative"});
}

TEST_F(Validation, StaleIdsAreFound)
{
  const auto stale = [&](ResourceKind kind, ResourceId id) {
    return fmt::format("{} id {} (index {}, generation {}) is stale", to_string(kind), id, index_of(id),
                       generation_of(id));
  };
  const ResourceId old_block = block.id();
  record({});
  block = Buffer();
  EXPECT_EQ(device->find(ResourceKind::Buffer, old_block), nullptr);
  expect_contains(error_of([&] { validate(list, *device); }), stale(ResourceKind::Buffer, old_block));
  // The index is reused: the old id is still stale and does not name the other buffer.
  block = device->create_buffer({.name = "other", .size_bytes = 64});
  ASSERT_EQ(index_of(block.id()), index_of(old_block));
  expect_contains(error_of([&] { validate(list, *device); }), stale(ResourceKind::Buffer, old_block));

  record({});
  const ResourceId old_texture = source.id();
  source = device->create_texture({.name = "other", .width = 4, .height = 4});
  expect_contains(error_of([&] { validate(list, *device); }), stale(ResourceKind::Texture, old_texture));
  record({});
  const ResourceId old_sampler = sampler.id();
  sampler = device->create_sampler({.name = "other"});
  expect_contains(error_of([&] { validate(list, *device); }), stale(ResourceKind::Sampler, old_sampler));
  record({});
  const ResourceId old_shader = shader.id();
  shader = test::make_shader(*device, "reading", test::CLIP_SPACE_VERT, READING_FRAG);
  expect_contains(error_of([&] { validate(list, *device); }), stale(ResourceKind::Shader, old_shader));
  record({});
  const ResourceId old_framebuffer = framebuffer.id();
  framebuffer = device->create_framebuffer({"other", {{&color}}, {}});
  expect_contains(error_of([&] { validate(list, *device); }), stale(ResourceKind::Framebuffer, old_framebuffer));

  record({.before_pass = [&] { list.update(block, 0, std::vector<std::byte>(16)); }});
  const ResourceId updated = block.id();
  block = device->create_buffer({.name = "other", .size_bytes = 64});
  expect_contains(error_of([&] { validate(list, *device); }), stale(ResourceKind::Buffer, updated));
}

TEST_F(Validation, IdsThatNameNothingAreFound)
{
  expect_refused({.at_shader = [&] { list.set_shader(0); }}, {"(set_shader)", "shader id 0", "names no resource"});
  expect_refused({.at_uniform = [&] { list.bind_uniform(9, {}); }}, {"(bind_uniform)", "buffer id 0"});
  expect_refused({.at_texture = [&] { list.bind_texture(16, source.id(), 0); }}, {"(bind_texture)", "sampler id 0"});
  expect_refused({.at_texture = [&] { list.bind_texture(16, 0, sampler.id()); }}, {"(bind_texture)", "texture id 0"});
  expect_refused({.at_shader = [&] { list.set_shader(77); }}, {"(set_shader)", "shader id 77", "stale"});
}

TEST_F(Validation, AFramebufferWhoseTextureIsGoneIsFound)
{
  color = Texture();
  expect_refused({}, {"(begin_pass)", "framebuffer 'scene'", "texture 'hdr'", "destroyed"});
}

TEST_F(Validation, FeedbackLoopsAreFound)
{
  expect_refused({.at_texture = [&] { list.bind_texture(16, color.id(), sampler.id()); }},
                 {"pass 'lit'", "(draw)", "shader 'reading'", "feedback loop: texture 'hdr' at slot 16 ('radiance')"});
  record(
      {.actions = {.reads_attachments = true}, .at_texture = [&] { list.bind_texture(16, color.id(), sampler.id()); }});
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "") << "the pass says that it reads its attachments";
  // Bound to a slot that the shader does not read.
  record({.at_draw = [&] {
    list.bind_texture(17, color.id(), sampler.id());
    test::append_draw(list, batch);
  }});
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "");
}

TEST_F(Validation, ComparisonsAreOfDepths)
{
  expect_refused({.at_texture = [&] { list.bind_texture(16, source.id(), comparison.id()); }},
                 {"(bind_texture)", "sampler 'comparison'", "texture 'source' of format RGBA8"});
}

TEST_F(Validation, ViewportsFitTheirFramebuffer)
{
  for (const glm::ivec2 size : {glm::ivec2(5, 4), glm::ivec2(4, 5), glm::ivec2(-1, 4), glm::ivec2(0, 4)}) {
    list.clear();
    list.begin_pass("lit", framebuffer, {.viewport = {.size_px = size}});
    list.end_pass();
    const std::string message = error_of([&] { validate(list, *device); });
    expect_contains(message, "framebuffer 'scene'");
    expect_contains(message, fmt::format("{}x{} px at 0,0 does not fit into 4x4 px", size.x, size.y));
  }
}

TEST_F(Validation, RectanglesFitTheHostsFramebuffer)
{
  const auto message_of = [&](const Rectangle &viewport, const Rectangle &scissor) {
    list.clear();
    list.begin_pass("lit", HostFramebuffer{.name = 1, .size_px = {8, 6}}, {.viewport = viewport, .scissor = scissor});
    list.end_pass();
    return error_of([&] { validate(list, *device); });
  };
  EXPECT_EQ(message_of({{3, 2}, {5, 4}}, {{3, 2}, {5, 4}}), "");
  EXPECT_EQ(message_of({}, {}), "");
  for (const Rectangle bad : {Rectangle{{4, 2}, {5, 4}}, Rectangle{{3, 3}, {5, 4}}, Rectangle{{-1, 0}, {5, 4}},
                              Rectangle{{0, -1}, {5, 4}}, Rectangle{{2, 2}, {0, 0}}}) {
    expect_contains(message_of(bad, {}), "framebuffer of the host: a viewport of");
    expect_contains(message_of({}, bad), "framebuffer of the host: a scissor of");
  }
}

TEST_F(Validation, InstancesAreThoseOfTheListOrOfABufferOfObjects)
{
  const Buffer objects = device->create_buffer({"objects", BufferKind::Storage, 3 * sizeof(shared::ObjectData)});
  const auto draw = [&](ResourceId bound, std::uint32_t first_instance) {
    return [&, bound, first_instance] {
      list.bind_instances(bound);
      list.draws.push_back({3, 2, 0, 0, first_instance});
      list.draw(0, 1);
    };
  };
  record({.at_draw = draw(objects.id(), 1)});
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "") << "the list itself has no instances";
  expect_refused({.at_draw = draw(objects.id(), 2)},
                 {"draw 0: instances [2, 4) exceed the 3 objects of buffer 'objects'"});
  expect_refused({.at_draw = draw(block.id(), 0)}, {"(bind_instances)", "buffer 'light_block' is no storage buffer"});
  const ResourceId gone = device->create_buffer({"gone", BufferKind::Storage, 512}).id();
  expect_refused({.at_draw = draw(gone, 0)}, {"(bind_instances)", "stale"});
  const Shader of_objects = test::make_shader(
      *device, "of_objects",
      "layout(location = ATTRIBUTE_WORLD_FROM_OBJECT) in mat4 matrix;\nvoid main() { gl_Position = matrix[0]; }\n",
      test::COLOR_FRAG);
  const auto draw_objects = [&](ResourceId bound) {
    return [&, bound] {
      list.set_shader(of_objects.id());
      draw(bound, 0)();
    };
  };
  record({.at_draw = draw_objects(objects.id())});
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "");
  expect_refused({.at_draw =
                      [&] {
                        list.instances.resize(2);
                        draw_objects(0)();
                      }},
                 {"(draw)", "shader 'of_objects' reads the object of a call, and the instances are those of the list"});
  // 0 ends the binding.
  expect_refused({.at_draw =
                      [&] {
                        list.bind_instances(objects.id());
                        draw(0, 0)();
                      }},
                 {"draw 0: instances [0, 2) exceed the list's 0 instances"});
}

TEST_F(Validation, DrawsAreInsideTheListAndTheBatches)
{
  expect_refused({.at_draw = [&] { list.draw(0, 1); }}, {"(draw)", "draws [0, 1) exceed the list's 0 draws"});
  const auto draw = [&](const DrawIndirect &indirect) {
    return [&, indirect] {
      list.draws.push_back(indirect);
      list.instances.resize(2);
      list.draw(0, 1);
    };
  };
  expect_refused({.at_draw = draw({3, 2, 0, 0, 1})}, {"draw 0: instances [1, 3) exceed the list's 2 instances"});
  expect_refused({.at_draw = draw({4, 1, 0, 0, 0})},
                 {"draw 0: indices [0, 4) from vertex 0 on belong to no live batch"});
  expect_refused({.at_draw = draw({3, 1, 0, 3, 0})}, {"from vertex 3 on belong to no live batch"});
  expect_refused({.at_draw = draw({3, 1, 0, -1, 0})}, {"from vertex -1 on belong to no live batch"});
  record({.at_draw = draw({3, 2, 0, 0, 0})});
  EXPECT_EQ(error_of([&] { validate(list, *device); }), "");
  batch = Batch();
  expect_contains(error_of([&] { validate(list, *device); }), "belong to no live batch");
}

}  // namespace
}  // namespace gnomon::gpu
