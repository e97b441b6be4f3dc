// SPDX-License-Identifier: MIT
#include "draw/draw_pass_fixture.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <thread>

namespace gnomon::draw {
namespace {

using test::dump;
using test::make_shader;

TEST(Pass, SerializesEveryKindOfBindingAndCall)
{
  const auto device = gpu::create_null_device();
  const test::EverythingPass everything(*device);
  EXPECT_EQ(everything.pass.serialize(*device), test::EverythingPass::TEXT);
}

TEST(Pass, CallsOfHostBatchesFollowTheOthersAndShareCommands)
{
  const auto device = gpu::create_null_device();
  const gpu::Shader shader = make_shader(*device, "calls", R"(
#include "draw/draw_object_lib.glsl"
void main()
{
  gl_Position = vec4(vertex_position_ws().xyz, 1);
})",
                                         R"(
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(1);
})");
  const gpu::Batch shared = test::full_triangle(*device, 0.0F);
  const gpu::HostBatch host{.positions = {1, 0, 12}, .vertex_count = 3, .index_buffer = 2, .index_count = 3};
  const gpu::Batch first = device->create_batch("first", host);
  const gpu::Batch second = device->create_batch("second", host);
  ObjectBuffer objects;
  // The last one is outside of the view.
  for (const float x : {0.0F, 0.1F, 0.2F, 0.3F, 100.0F}) {
    objects.add(glm::translate(glm::mat4(1), {x, 0, 0}), 0, {{x, 0, 0}, 0.1F});
  }
  objects.upload(*device);
  Pass pass("pass", gpu::State::WriteColor, &objects);
  ShadingGroup &group = pass.group(shader);
  group.call(first, 1);
  group.call(first, 2);
  group.call(second, 3);
  group.call(shared, 4);
  group.call(first, 5);
  const gpu::Texture picture = device->create_texture({.name = "picture"});
  const gpu::Framebuffer framebuffer = device->create_framebuffer({"picture", {{&picture}}, {}});
  gpu::CommandList list;
  list.begin_pass("pass", framebuffer, {});
  const RecordCounts counts = pass.record(View(), list);
  list.end_pass();
  EXPECT_EQ(counts.drawn, 4U);
  EXPECT_EQ(counts.culled, 1U);
  const std::string text = list.serialize(*device);
  EXPECT_EQ(text.substr(text.find("  instances")), R"(  instances of object_block
  draw 1 triangles x1, instances from 4
  batch first of the host
  instances of object_block
  draw 1 triangles x2, instances from 1
  batch second of the host
  instances of object_block
  draw 1 triangles x1, instances from 3
  shared batches
end
)");
  device->submit(list);
  test::expect_contains(pass.serialize(*device), "call 1 triangles from 0 of the host's, object 3");
}

TEST(Pass, AGroupWhoseHostBatchesAreAllCulledRecordsNothing)
{
  const auto device = gpu::create_null_device();
  const gpu::Shader shader = make_shader(*device, "everything", test::EVERYTHING_VERT, test::EVERYTHING_FRAG);
  const gpu::Batch batch = device->create_batch(
      "host", gpu::HostBatch{.positions = {1, 0, 12}, .vertex_count = 3, .index_buffer = 2, .index_count = 3});
  ObjectBuffer objects;
  objects.add(glm::mat4(1), 0, {{100, 0, 0}, 0.1F});
  objects.upload(*device);
  Pass pass("pass", gpu::State::WriteColor, &objects);
  ShadingGroup &group = pass.group(shader);
  group.call(batch, 1);
  InstanceCall &instances = group.instances(batch);
  gpu::CommandList list;
  EXPECT_EQ(pass.record(View(), list).culled, 1U);
  EXPECT_TRUE(list.commands().empty());
  instances.add(1);
  EXPECT_EQ(pass.record(View(), list).drawn, 1U);
  EXPECT_EQ(list.draws.size(), 1U);
}

TEST(Pass, DrawsItsGroupsInTheOrderThatIsSet)
{
  const auto device = gpu::create_null_device();
  const gpu::Shader shader = make_shader(*device, "everything", test::EVERYTHING_VERT, test::EVERYTHING_FRAG);
  Pass pass("pass", gpu::State::WriteColor);
  for (const gpu::State state : {gpu::State::CullBack, gpu::State::CullFront, gpu::State::WriteDepth}) {
    draw::ShadingGroup &group = pass.group(shader);
    group.state_enable(state);
    group.call_procedural();
  }
  const auto recorded = [&] {
    gpu::CommandList list;
    pass.record(View(), list);
    return list.serialize(*device);
  };
  const std::string as_made = recorded();
  EXPECT_LT(as_made.find("cull_back"), as_made.find("cull_front"));
  pass.set_order({2, 1});
  const std::string ordered = recorded();
  EXPECT_EQ(ordered.find("cull_back"), std::string::npos);
  EXPECT_LT(ordered.find("write_depth"), ordered.find("cull_front"));
  pass.clear();
  pass.group(shader).call_procedural();
  gpu::CommandList list;
  EXPECT_EQ(pass.record(View(), list).drawn, 1U) << "another set of groups has an order of its own";
}

TEST(Pass, RecordsWhatItHoldsInOrder)
{
  const auto device = gpu::create_null_device();
  test::EverythingPass everything(*device);
  everything.face = 0x01020304;
  gpu::CommandList list;
  everything.pass.record(View(), list);
  EXPECT_EQ(list.serialize(*device),
            "  shader everything\n"
            "  state write_color depth_nearer_equal cull_back blend_add\n"
            "  storage object_block -> 0\n"
            "  uniform view -> 9\n"
            "  uniform light -> 10 [256, 272)\n"
            "  storage materials -> 1\n"
            "  storage materials -> 2 [0, 16)\n"
            "  texture hdr linear -> 16\n"
            "  texture hdr linear -> 17\n"
            "  push_constants 32 bytes\n"
            "  instances of object_block\n"
            "  draw 2 triangles x2, instances from 0\n"
            "  draw 1 triangles x1, instances from 5\n"
            "  instances of the list\n"
            "  draw 1 triangles x4, instances from 0\n"
            "  draw 2 triangles x6, instances from 4\n"
            "  draw_procedural 6 vertices x3\n"
            "  shader everything\n"
            "  state write_color depth_nearer_equal\n"
            "  push_constants 32 bytes\n");
  // color at 0, face at 16, bias at 20.
  struct {
    glm::vec4 color;
    int face;
    float bias;
  } constants{};
  std::memcpy(&constants, list.bytes().data(), sizeof(constants));
  EXPECT_EQ(constants.color, glm::vec4(1));
  EXPECT_EQ(constants.face, 0x01020304);
  EXPECT_EQ(constants.bias, 0) << "what was never given is zero";
}

TEST(Pass, LeavesStateOffForOneRecordAlone)
{
  const auto device = gpu::create_null_device();
  const test::EverythingPass everything(*device);
  gpu::CommandList list;
  // A state bit of the pass, one of the group, and one of neither.
  everything.pass.record(View(), list, gpu::State::DepthNearerEqual | gpu::State::BlendAdd | gpu::State::DepthClamp);
  const std::string text = list.serialize(*device);
  EXPECT_NE(text.find("  state write_color cull_back\n"), std::string::npos) << text;
  EXPECT_NE(text.find("  state write_color\n"), std::string::npos) << text;
  EXPECT_EQ(everything.pass.serialize(*device), test::EverythingPass::TEXT) << "the pass itself is as it was";
  list.clear();
  everything.pass.record(View(), list);
  EXPECT_NE(list.serialize(*device).find("  state write_color depth_nearer_equal cull_back blend_add\n"),
            std::string::npos);
}

TEST(Pass, ClearForgetsGroupsAndKeepsTheRest)
{
  const auto device = gpu::create_null_device();
  test::EverythingPass everything(*device);
  EXPECT_FALSE(everything.pass.is_empty());
  everything.pass.clear();
  EXPECT_TRUE(everything.pass.is_empty());
  EXPECT_EQ(everything.pass.serialize(*device), "everything [write_color depth_nearer_equal]\n");
  gpu::CommandList list;
  everything.pass.record(View(), list);
  EXPECT_TRUE(list.commands().empty());
}

/** A group over the shader that reads one of each kind. */
class ShadingGroupTest : public testing::Test {
 protected:
  void SetUp() override
  {
    objects.upload(*device);
  }
  /** Records \a pass before and after \a change. \return whether the lists differ. */
  template <typename Change>
  bool is_changed_by(Change &&change)
  {
    gpu::CommandList before;
    pass.record(View(), before);
    change();
    gpu::CommandList after;
    pass.record(View(), after);
    return dump(before) != dump(after);
  }
  std::string recorded()
  {
    gpu::CommandList list;
    pass.record(view, list);
    return list.serialize(*device);
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  gpu::Shader shader = make_shader(*device, "everything", test::EVERYTHING_VERT, test::EVERYTHING_FRAG);
  gpu::Buffer block = device->create_buffer({.name = "block", .size_bytes = 512});
  gpu::Buffer other = device->create_buffer({.name = "other", .size_bytes = 512});
  gpu::Buffer store = device->create_buffer({"store", gpu::BufferKind::Storage, 512});
  gpu::Texture picture = device->create_texture({.name = "picture"});
  gpu::Texture mask = device->create_texture({.name = "mask"});
  gpu::Sampler sampler = device->create_sampler({.name = "nearest"});
  gpu::Sampler linear = device->create_sampler({.name = "linear"});
  gpu::Batch a = test::full_triangle(*device, 0.5F, "a");
  gpu::Batch b = test::full_triangle(*device, 0.5F, "b");
  ObjectBuffer objects;
  View view;
  Pass pass{"pass", gpu::State::WriteColor, &objects};
  ShadingGroup &group = pass.group(shader);
};

TEST_F(ShadingGroupTest, UniformByReferenceIsReadAtEachRecord)
{
  gpu::BufferRange range{block.id(), 0, 16};
  group.bind_uniform_ref("light_block", &range);
  EXPECT_TRUE(is_changed_by([&] { range.offset_bytes = 256; }));
  EXPECT_TRUE(is_changed_by([&] { range.buffer = other.id(); }));
  EXPECT_FALSE(is_changed_by([] {}));
}

TEST_F(ShadingGroupTest, UniformByValueIsThatOfItsBinding)
{
  group.bind_uniform("light_block", block);
  EXPECT_FALSE(is_changed_by([&] { std::swap(block, other); }));
}

TEST_F(ShadingGroupTest, StorageByReferenceIsReadAtEachRecord)
{
  gpu::BufferRange range{store.id(), 0, 16};
  group.bind_storage_ref("material_block", &range);
  EXPECT_TRUE(is_changed_by([&] { range.size_bytes = 32; }));
}

TEST_F(ShadingGroupTest, TextureByReferenceIsReadAtEachRecord)
{
  TextureBinding binding{picture.id(), sampler.id()};
  group.bind_texture_ref("picture", &binding);
  EXPECT_TRUE(is_changed_by([&] { binding.texture = mask.id(); }));
  EXPECT_TRUE(is_changed_by([&] { binding.sampler = linear.id(); }));
}

TEST_F(ShadingGroupTest, TextureByValueIsThatOfItsBinding)
{
  group.bind_texture("picture", picture, sampler);
  EXPECT_FALSE(is_changed_by([&] {
    std::swap(picture, mask);
    std::swap(sampler, linear);
  }));
}

TEST_F(ShadingGroupTest, IsCurrentUntilAResourceThatItBindsByValueIsDestroyed)
{
  EXPECT_TRUE(pass.is_current(*device));
  const auto bind = [&] {
    pass.clear();
    ShadingGroup &bound = pass.group(shader);
    bound.bind_uniform("light_block", block);
    bound.bind_storage("material_block", store);
    bound.bind_texture("picture", picture, sampler);
    EXPECT_TRUE(pass.is_current(*device));
  };
  bind();
  block = {};
  EXPECT_FALSE(pass.is_current(*device));
  // It gets the same index, and another id.
  block = device->create_buffer({.name = "block", .size_bytes = 512});
  EXPECT_FALSE(pass.is_current(*device));
  bind();
  store = {};
  EXPECT_FALSE(pass.is_current(*device));
  store = device->create_buffer({"store", gpu::BufferKind::Storage, 512});
  bind();
  picture = {};
  EXPECT_FALSE(pass.is_current(*device));
  picture = device->create_texture({.name = "picture"});
  bind();
  sampler = {};
  EXPECT_FALSE(pass.is_current(*device));
}

TEST_F(ShadingGroupTest, ResourcesByReferenceDoNotMakeItOutOfDate)
{
  gpu::BufferRange range{block.id(), 0, 16};
  TextureBinding binding{picture.id(), sampler.id()};
  group.bind_uniform_ref("light_block", &range);
  group.bind_texture_ref("picture", &binding);
  block = {};
  picture = {};
  EXPECT_TRUE(pass.is_current(*device));
}

TEST_F(ShadingGroupTest, ConstantByReferenceIsReadAtEachRecordAndByValueIsNot)
{
  int face = 1;
  glm::vec4 color(1);
  group.constant_ref("face", &face);
  group.constant("color", color);
  EXPECT_TRUE(is_changed_by([&] { face = 2; }));
  EXPECT_FALSE(is_changed_by([&] { color = glm::vec4(2); }));
}

TEST_F(ShadingGroupTest, UnknownNamesBindNothing)
{
  const std::string before = pass.serialize(*device);
  const gpu::BufferRange range{block.id()};
  const TextureBinding binding{picture.id(), sampler.id()};
  const double large = 1;
  group.bind_uniform("lost", block);
  group.bind_uniform_ref("lost", &range);
  group.bind_storage("lost", store);
  group.bind_storage_ref("lost", &range);
  group.bind_texture("lost", picture, sampler);
  group.bind_texture_ref("lost", &binding);
  group.constant("lost", 1);
  group.constant_ref("lost", &large);
  // An existing name of another kind of binding.
  group.bind_uniform("material_block", block);
  group.bind_storage("light_block", store);
  group.bind_texture("light_block", picture, sampler);
  group.constant("picture", 1);
  EXPECT_EQ(pass.serialize(*device), before);
  EXPECT_EQ(recorded(), "  shader everything\n  state write_color\n  push_constants 32 bytes\n");
}

TEST_F(ShadingGroupTest, LaterBindingOfANameReplacesTheEarlier)
{
  const gpu::BufferRange range{block.id(), 256, 16};
  const TextureBinding binding{mask.id(), linear.id()};
  group.bind_uniform("light_block", other);
  group.bind_uniform_ref("light_block", &range);
  group.bind_texture_ref("picture", &binding);
  group.bind_texture("picture", picture, sampler);
  EXPECT_EQ(recorded(),
            "  shader everything\n"
            "  state write_color\n"
            "  uniform block -> 10 [256, 272)\n"
            "  texture picture nearest -> 16\n"
            "  push_constants 32 bytes\n");
  EXPECT_EQ(pass.serialize(*device),
            "pass [write_color]\n"
            "  group everything\n"
            "    uniform light_block -> 10 by reference\n"
            "    texture picture -> 16 = picture\n");
}

TEST_F(ShadingGroupTest, LaterConstantReplacesTheEarlier)
{
  const int referenced = 7;
  const auto face = [&] {
    gpu::CommandList list;
    pass.record(View(), list);
    int value = 0;
    std::memcpy(&value, list.bytes().data() + 16, sizeof(value));
    return value;
  };
  group.constant("face", 1);
  EXPECT_EQ(face(), 1);
  group.constant_ref("face", &referenced);
  EXPECT_EQ(face(), 7);
  group.constant("face", 3);
  EXPECT_EQ(face(), 3);
  EXPECT_EQ(pass.serialize(*device), "pass [write_color]\n  group everything\n    constant face\n");
}

using ShadingGroupInternalErrorTest = ShadingGroupTest;

TEST_F(ShadingGroupInternalErrorTest, ConstantLargerThanItsMemberIsAnAssertion)
{
  test::expect_internal_error([&] { group.constant("face", glm::vec4(1)); }, "'face'.*'everything'.*4 bytes, not 16");
}

TEST_F(ShadingGroupInternalErrorTest, MatrixWithoutAnObjectBufferIsAnAssertion)
{
  Pass plain("plain", gpu::State::None);
  test::expect_internal_error([&] { plain.group(shader).call(a, glm::mat4(1)); }, "'everything'");
}

/** Each draw with its batch's first index and its instances: object/value. */
std::string drawn(const Pass &pass, const View &view)
{
  gpu::CommandList list;
  pass.record(view, list);
  std::string text;
  bool are_objects = false;
  for (const gpu::Command &command : list.commands()) {
    are_objects = command.kind == gpu::CommandKind::BindInstances ? command.id != 0 : are_objects;
    if (command.kind != gpu::CommandKind::Draw) {
      continue;
    }
    for (const gpu::DrawIndirect &draw : std::span(list.draws).subspan(command.first, command.count)) {
      text += draw.first_index / 3 == 0 ? "a:" : "b:";
      for (std::uint32_t i = 0; i < draw.instance_count; i++) {
        const std::uint32_t place = draw.first_instance + i;
        const gpu::DrawInstance instance = are_objects ? gpu::DrawInstance{place, 0} : list.instances[place];
        text += fmt::format(" {}/{}", instance.object, instance.value);
      }
      text += "\n";
    }
  }
  return text;
}

TEST_F(ShadingGroupTest, ConsecutiveObjectsOfABatchAreOneDrawAndTheOrderHolds)
{
  group.call(a, 10);
  group.call(a, 11);
  group.call(b, 12);
  group.call(a, 13);
  group.call(a, 14);
  group.call(a, 15);
  group.call(a, 17);
  group.call(a, 16);
  EXPECT_EQ(drawn(pass, view),
            "a: 10/0 11/0\n"
            "b: 12/0\n"
            "a: 13/0 14/0 15/0\n"
            "a: 17/0\n"
            "a: 16/0\n");
}

TEST_F(ShadingGroupTest, CallsWithoutObjectsAreInstancesOfTheList)
{
  Pass plain("plain", gpu::State::None);
  ShadingGroup &calls = plain.group(shader);
  calls.call(a);
  calls.call(a);
  calls.instances(a).add(0, 3);
  calls.call(b);
  EXPECT_EQ(drawn(plain, view), "a: 0/0 0/0\nb: 0/0\na: 0/3\n");
}

TEST_F(ShadingGroupTest, CallsOfAGroupAreOneCommandAndInstanceCallsAnother)
{
  for (ObjectIndex i = 0; i < 10; i++) {
    group.call(i % 2 == 0 ? a : b, i);
  }
  group.instances(a).add(1);
  group.instances(b).add(2);
  gpu::CommandList list;
  // After the commands of another pass.
  list.draws.resize(3);
  list.instances.resize(5);
  pass.record(view, list);
  const std::vector<gpu::Command> &commands = list.commands();
  ASSERT_GE(commands.size(), 4U);
  const std::span<const gpu::Command> last = std::span(commands).last(4);
  EXPECT_EQ(last[0].kind, gpu::CommandKind::BindInstances);
  EXPECT_EQ(last[0].id, objects.buffer().id());
  EXPECT_EQ(last[1].kind, gpu::CommandKind::Draw);
  EXPECT_EQ(last[1].first, 3U);
  EXPECT_EQ(last[1].count, 10U);
  EXPECT_EQ(last[2].kind, gpu::CommandKind::BindInstances);
  EXPECT_EQ(last[2].id, 0U);
  EXPECT_EQ(last[3].kind, gpu::CommandKind::Draw);
  EXPECT_EQ(last[3].first, 13U);
  EXPECT_EQ(last[3].count, 2U);
  EXPECT_EQ(list.draws[4].first_instance, 1U) << "the object";
  EXPECT_EQ(list.draws[13].first_instance, 5U) << "in the list";
  EXPECT_EQ(list.draws[14].first_instance, 6U);
}

TEST_F(ShadingGroupTest, CallsOfDifferentGroupsAreNotJoined)
{
  ShadingGroup &second = pass.group(shader);
  group.call(a, 1);
  second.call(a, 2);
  EXPECT_EQ(drawn(pass, view), "a: 1/0\na: 2/0\n");
}

TEST_F(ShadingGroupTest, CallOfAnEmptyBatchDoesNotSwallowTheNext)
{
  // An empty batch takes no space: the next one has the same position.
  const gpu::Batch empty = device->create_batch({.name = "empty", .positions = {}, .normals = {}, .indices = {}});
  const gpu::Batch next = test::full_triangle(*device, 0.5F);
  ASSERT_EQ(empty.range().first_index, next.range().first_index);
  for (const bool is_empty_first : {true, false}) {
    pass.clear();
    ShadingGroup &calls = pass.group(shader);
    calls.call(is_empty_first ? empty : next, 1);
    calls.call(is_empty_first ? next : empty, 1);
    gpu::CommandList list;
    pass.record(view, list);
    std::uint32_t index_count = 0;
    for (const gpu::DrawIndirect &draw : list.draws) {
      index_count += draw.index_count * draw.instance_count;
    }
    EXPECT_EQ(index_count, 3U);
  }
}

TEST_F(ShadingGroupTest, InstancesOfOneObjectAreTheSixFacesOfACube)
{
  InstanceCall &faces = group.instances(a);
  for (std::uint32_t i = 0; i < 6; i++) {
    faces.add(4, i);
  }
  EXPECT_EQ(drawn(pass, view), "a: 4/0 4/1 4/2 4/3 4/4 4/5\n");
}

TEST_F(ShadingGroupTest, InstancesChangeBetweenRecords)
{
  InstanceCall &instances = group.instances(a);
  EXPECT_EQ(drawn(pass, view), "") << "none are no draw";
  instances.add(8, 3);
  instances.add(9);
  instances.add(4, 2);
  EXPECT_EQ(drawn(pass, view), "a: 8/3 9/0 4/2\n");
  instances.clear();
  EXPECT_EQ(drawn(pass, view), "");
  // The reference is kept while further groups are created.
  std::vector<InstanceCall *> more;
  for (int i = 0; i < 100; i++) {
    more.push_back(&group.instances(b));
  }
  instances.add(1);
  more[0]->add(2);
  EXPECT_EQ(drawn(pass, view), "a: 1/0\nb: 2/0\n");
}

TEST_F(ShadingGroupTest, MatrixOfACallIsInTheObjectBuffer)
{
  const glm::mat4 matrix(3);
  group.call(a, matrix);
  group.call(a, matrix);
  EXPECT_EQ(objects.size(), 3U);
  EXPECT_EQ(drawn(pass, view), "a: 1/0 2/0\n");
}

TEST_F(ShadingGroupTest, CallOutsideTheViewIsLeftOut)
{
  view = View(glm::mat4(1), perspective(1, 1, 1, 100));
  group.call(a, 1, {{0, 0, -10}, 1});
  group.call(a, 2, {{0, 0, 10}, 1});
  group.call(a, 3, {{0, 0, -10}, 1});
  group.call(b, 4, {{500, 0, -10}, 1});
  group.call(a, 5, {{500, 0, -10}, -1});
  EXPECT_EQ(drawn(pass, view), "a: 1/0\na: 3/0\na: 5/0\n");
  EXPECT_EQ(
      drawn(pass, View(glm::lookAt(glm::vec3(0), glm::vec3(0, 0, 1), glm::vec3(0, 1, 0)), perspective(1, 1, 1, 100))),
      "a: 2/0\na: 5/0\n");
}

TEST_F(ShadingGroupTest, VolumeOfAMovedObjectIsReadAtEachRecord)
{
  view = View(glm::mat4(1), perspective(1, 1, 1, 100));
  const CullingVolume seen{{0, 0, -10}, 1};
  const CullingVolume hidden{{0, 0, 10}, 1};
  const ObjectIndex object = objects.add(glm::mat4(1), 0, hidden);
  group.call(a, object);
  group.call(a, object, seen);
  EXPECT_EQ(drawn(pass, view), "a: 1/0\n") << "the call with a volume of its own alone";
  objects.set(object, glm::mat4(1), 0, seen);
  EXPECT_EQ(drawn(pass, view), "a: 1/0\na: 1/0\n");
  objects.set(object, glm::mat4(1), 0, hidden);
  gpu::CommandList list;
  const RecordCounts counts = pass.record(view, list);
  EXPECT_EQ(counts.drawn, 1U);
  EXPECT_EQ(counts.culled, 1U);
  objects.set(object, glm::mat4(1), 0, {});
  EXPECT_EQ(drawn(pass, view), "a: 1/0\na: 1/0\n") << "an object without a volume is always drawn";
}

TEST_F(ShadingGroupTest, ProceduralNeedsNoBatch)
{
  group.call_procedural();
  group.call_procedural(4, 2);
  EXPECT_EQ(recorded(),
            "  shader everything\n"
            "  state write_color\n"
            "  push_constants 32 bytes\n"
            "  draw_procedural 3 vertices x1\n"
            "  draw_procedural 12 vertices x2\n");
}

TEST(Pass, RecordsOnOneThreadAndIsSubmittedOnAnother)
{
  const auto device = gpu::create_null_device();
  const test::EverythingPass everything(*device);
  const gpu::Texture target = device->create_texture({.name = "target"});
  const gpu::Framebuffer framebuffer = device->create_framebuffer({"target", {{&target}}, {}});
  const auto record = [&](gpu::CommandList &list) {
    list.begin_pass("pass", framebuffer, {});
    for (int i = 0; i < 100; i++) {
      everything.pass.record(View(), list);
    }
    list.end_pass();
  };
  gpu::CommandList here;
  record(here);
  // Several threads read one pass concurrently.
  std::array<gpu::CommandList, 4> lists;
  std::vector<std::thread> threads;
  for (gpu::CommandList &list : lists) {
    threads.emplace_back([&] { record(list); });
  }
  for (std::thread &thread : threads) {
    thread.join();
  }
  for (const gpu::CommandList &list : lists) {
    EXPECT_EQ(dump(list), dump(here));
    device->submit(list);
  }
  EXPECT_EQ(device->counters().passes, 4U);
  EXPECT_EQ(device->counters().instances, 4U * 100U * (2 + 5 + 6 + 3));
}

}  // namespace
}  // namespace gnomon::draw
