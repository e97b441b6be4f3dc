// SPDX-License-Identifier: MIT
#include "gpu/gpu_testing.hh"

#include <algorithm>
#include <set>
#include <type_traits>

namespace gnomon::gpu {
namespace {

using test::make_shader;

template <typename T>
constexpr bool IS_MOVE_ONLY = std::is_nothrow_move_constructible_v<T> &&std::is_nothrow_move_assignable_v<T> &&
                              !std::is_copy_constructible_v<T> && !std::is_copy_assignable_v<T>;
static_assert(IS_MOVE_ONLY<Resource> && IS_MOVE_ONLY<Sampler> && IS_MOVE_ONLY<Framebuffer> && IS_MOVE_ONLY<Buffer> &&
              IS_MOVE_ONLY<Batch> && IS_MOVE_ONLY<TimerQuery>);
static_assert(!std::is_copy_constructible_v<Texture> && !std::is_copy_constructible_v<Shader>);

/** One resource of each kind. */
struct Everything {
  explicit Everything(Device &device)
      : texture(device.create_texture({.name = "a texture"})),
        sampler(device.create_sampler({.name = "a sampler"})),
        framebuffer(device.create_framebuffer({.name = "a framebuffer", .colors = {{&texture}}, .depth = {}})),
        buffer(device.create_buffer({.name = "a buffer", .size_bytes = 16})),
        batch(test::full_triangle(device, 0, "a batch")),
        shader(make_shader(device, "a shader", "void main() { gl_Position = vec4(0); }", "void main() {}")),
        timer(device.create_timer_query("a timer"))
  {
  }

  Texture texture;
  Sampler sampler;
  Framebuffer framebuffer;
  Buffer buffer;
  Batch batch;
  Shader shader;
  TimerQuery timer;
};

TEST(Resource, DefaultIsEmpty)
{
  const Texture texture;
  EXPECT_FALSE(texture);
  EXPECT_EQ(texture.id(), 0U);
  EXPECT_FALSE(Shader());
  EXPECT_FALSE(Batch());
}

TEST(Resource, MoveTransfersTheResource)
{
  const auto device = create_null_device();
  Buffer first = device->create_buffer({.name = "first", .size_bytes = 16});
  const ResourceId id = first.id();
  ASSERT_NE(id, 0U);
  Buffer second = std::move(first);
  EXPECT_FALSE(first);  // NOLINT(bugprone-use-after-move): what is asked here.
  EXPECT_EQ(first.id(), 0U);
  EXPECT_EQ(second.id(), id);
  EXPECT_EQ(second.size_bytes(), 16U);
  EXPECT_EQ(device->live_resources(), std::vector<std::string>{"buffer 'first'"});
}

TEST(Resource, AssignmentFreesThePreviousResource)
{
  const auto device = create_null_device();
  Buffer kept = device->create_buffer({.name = "kept", .size_bytes = 16});
  Buffer lost = device->create_buffer({.name = "lost", .size_bytes = 16});
  lost = std::move(kept);
  EXPECT_EQ(device->live_resources(), std::vector<std::string>{"buffer 'kept'"});
  Buffer &same = lost;
  lost = std::move(same);
  EXPECT_TRUE(lost);
  lost = Buffer();
  EXPECT_TRUE(device->live_resources().empty());
}

TEST(Resource, EndOfScopeFreesEveryKind)
{
  const auto device = create_null_device();
  {
    const Everything everything(*device);
    EXPECT_EQ(device->live_resources(),
              (std::vector<std::string>{"texture 'a texture'", "sampler 'a sampler'", "framebuffer 'a framebuffer'",
                                        "buffer 'a buffer'", "batch 'a batch'", "shader 'a shader'",
                                        "timer query 'a timer'"}));
  }
  EXPECT_TRUE(device->live_resources().empty());
}

TEST(Resource, OutlivesItsDeviceHarmlessly)
{
  std::vector<std::string> messages;
  auto device = create_null_device({}, [&](std::string_view text) { messages.emplace_back(text); });
  Everything everything(*device);
  device.reset();
  EXPECT_FALSE(everything.texture);
  EXPECT_EQ(everything.buffer.id(), 0U);
  // Moves and assignments of moved-from objects.
  Texture moved = std::move(everything.texture);
  EXPECT_FALSE(moved);
  moved = Texture();
}

TEST(Device, EndNamesEveryResourceThatLives)
{
  std::vector<std::string> messages;
  auto device = create_null_device({}, [&](std::string_view text) { messages.emplace_back(text); });
  const Everything everything(*device);
  device.reset();
  ASSERT_EQ(messages.size(), 7U);
  for (const std::string resource :
       {"texture 'a texture'", "sampler 'a sampler'", "framebuffer 'a framebuffer'", "buffer 'a buffer'",
        "batch 'a batch'", "shader 'a shader'", "timer query 'a timer'"}) {
    EXPECT_EQ(std::ranges::count_if(messages, [&](const auto &text) { return text.starts_with(resource); }), 1)
        << resource;
  }
}

TEST(Device, EndIsSilentWhereAllIsFreed)
{
  std::vector<std::string> messages;
  auto device = create_null_device({}, [&](std::string_view text) { messages.emplace_back(text); });
  {
    const Everything everything(*device);
  }
  device.reset();
  EXPECT_TRUE(messages.empty());
}

TEST(Device, NeverIssuesAnIdTwice)
{
  const auto device = create_null_device();
  Buffer a = device->create_buffer({.name = "a", .size_bytes = 16});
  const Buffer b = device->create_buffer({.name = "b", .size_bytes = 16});
  EXPECT_NE(a.id(), b.id());
  const ResourceId id = a.id();
  a = Buffer();
  const Buffer c = device->create_buffer({.name = "c", .size_bytes = 16});
  EXPECT_EQ(index_of(c.id()), index_of(id)) << "the place is used again";
  EXPECT_NE(c.id(), id);
  EXPECT_EQ(device->name_of(ResourceKind::Buffer, id), "none");
  EXPECT_EQ(device->find(ResourceKind::Buffer, id), nullptr);
  EXPECT_EQ(device->name_of(ResourceKind::Buffer, c.id()), "c");
  EXPECT_EQ(device->find(ResourceKind::Buffer, c.id())->name, "c");
  EXPECT_EQ(device->name_of(ResourceKind::Buffer, b.id()), "b");
}

TEST(Device, AnIndexWithoutGenerationsIsNotUsedAgain)
{
  const auto device = create_null_device();
  std::set<ResourceId> ids;
  constexpr std::size_t count = 10000;
  for (std::size_t i = 0; i < count; i++) {
    ids.insert(device->create_sampler({.name = "s"}).id());
  }
  EXPECT_EQ(ids.size(), count);
  EXPECT_FALSE(ids.contains(0));
  EXPECT_TRUE(
      std::ranges::all_of(ids, [&](ResourceId id) { return device->find(ResourceKind::Sampler, id) == nullptr; }));
}

TEST(Device, NamesNoneWhereThereIsNoResource)
{
  const auto device = create_null_device();
  EXPECT_EQ(device->name_of(ResourceKind::Texture, 0), "none");
  EXPECT_EQ(device->name_of(ResourceKind::Texture, 77), "none");
}

TEST(Device, IdsOfDifferentKindsAreApart)
{
  const auto device = create_null_device();
  const Texture texture = device->create_texture({.name = "t"});
  const Sampler sampler = device->create_sampler({.name = "s"});
  EXPECT_EQ(texture.id(), sampler.id());
  EXPECT_EQ(device->name_of(ResourceKind::Texture, texture.id()), "t");
  EXPECT_EQ(device->name_of(ResourceKind::Sampler, sampler.id()), "s");
}

}  // namespace
}  // namespace gnomon::gpu
