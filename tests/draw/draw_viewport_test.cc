// SPDX-License-Identifier: MIT
#include "draw_viewport.hh"

#include "gpu/gpu_testing.hh"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace gnomon::draw {
namespace {

using test::error_of;
using test::expect_contains;

using Log = std::vector<std::string>;

/** Writes down what it is asked. */
class LoggingEngine final : public Engine {
 public:
  struct Data : EngineViewportData {
    int syncs = 0;
  };

  LoggingEngine(std::string name, Log &log) : name_(std::move(name)), log_(log) {}

  std::string_view name() const override
  {
    return name_;
  }
  void init(Viewport &viewport) override
  {
    viewport.engine_data<Data>(*this).syncs++;
    log_.push_back(name_ + " init");
  }
  void cache_init(Viewport & /*viewport*/) override
  {
    log_.push_back(name_ + " cache_init");
  }
  void cache_populate(Viewport &viewport, const ObjectRef &object) override
  {
    viewport.objects().add(object.world_from_object);
    log_.push_back(fmt::format("{} cache_populate {}", name_, object.index));
  }
  void cache_finish(Viewport &viewport) override
  {
    log_.push_back(fmt::format("{} cache_finish, {} objects", name_, viewport.objects().size()));
  }
  void draw_scene(Viewport &viewport, const View &view) override
  {
    log_.push_back(fmt::format("{} draw_scene {}{}", name_, view.is_perspective() ? "perspective" : "parallel",
                               viewport.objects().buffer() ? "" : ", objects not uploaded"));
  }

 private:
  std::string name_;
  Log &log_;
};

TEST(Viewport, CallsEnginesInOrder)
{
  const auto device = gpu::create_null_device();
  Log log;
  LoggingEngine a("a", log);
  LoggingEngine b("b", log);
  const std::vector<Engine *> engines = {&a, &b};
  const std::vector<ObjectRef> objects = {{.index = 5, .volume = {}}, {.index = 2, .volume = {}}};
  Viewport viewport(*device, {8, 4});
  viewport.sync(engines, objects);
  // What counts for each engine: init, cache_init, each object in the host's order, cache_finish once all are known.
  const auto of = [&](const std::string &name) {
    Log lines;
    for (const std::string &line : log) {
      if (line.starts_with(name + " ")) {
        lines.push_back(line);
      }
    }
    return lines;
  };
  EXPECT_EQ(of("a"),
            (Log{"a init", "a cache_init", "a cache_populate 5", "a cache_populate 2", "a cache_finish, 5 objects"}));
  EXPECT_EQ(of("b"),
            (Log{"b init", "b cache_init", "b cache_populate 5", "b cache_populate 2", "b cache_finish, 5 objects"}));
  log.clear();
  viewport.draw(engines, View(glm::mat4(1), perspective(1, 1, 0.1F, 10)));
  viewport.draw(engines, View(glm::mat4(1), orthographic(1, 1, 0.1F, 10)));
  EXPECT_EQ(log, (Log{"a draw_scene perspective", "b draw_scene perspective", "a draw_scene parallel",
                      "b draw_scene parallel"}));
}

TEST(Viewport, SyncBeginsWithoutTheObjectsOfTheLast)
{
  const auto device = gpu::create_null_device();
  Log log;
  LoggingEngine engine("e", log);
  const std::vector<Engine *> engines = {&engine};
  const std::vector<ObjectRef> objects(3);
  Viewport viewport(*device, {8, 4});
  viewport.sync(engines, objects);
  EXPECT_EQ(viewport.objects().size(), 4U);
  viewport.sync(engines, std::span(objects).first(1));
  EXPECT_EQ(viewport.objects().size(), 2U);
}

TEST(Viewport, KeepsTheDataOfAnEngineApartFromSyncToSync)
{
  const auto device = gpu::create_null_device();
  Log log;
  LoggingEngine a("a", log);
  LoggingEngine b("b", log);
  Viewport viewport(*device, {8, 4});
  Viewport other(*device, {8, 4});
  const std::vector<Engine *> only_a = {&a};
  const std::vector<Engine *> both = {&a, &b};
  viewport.sync(only_a, {});
  viewport.sync(both, {});
  other.sync(only_a, {});
  EXPECT_EQ(viewport.engine_data<LoggingEngine::Data>(a).syncs, 2);
  EXPECT_EQ(viewport.engine_data<LoggingEngine::Data>(b).syncs, 1);
  EXPECT_EQ(other.engine_data<LoggingEngine::Data>(a).syncs, 1);
}

TEST(Viewport, SharesADepthOfItsSize)
{
  const auto device = gpu::create_null_device();
  Viewport viewport(*device, {8, 4});
  EXPECT_FALSE(viewport.has_depth_texture()) << "nobody asked";
  const gpu::TextureDesc &depth = viewport.depth_texture().desc();
  EXPECT_EQ(glm::ivec2(depth.width, depth.height), glm::ivec2(8, 4));
  EXPECT_EQ(depth.format, gpu::Format::Depth32F);
  EXPECT_EQ(viewport.size_px(), glm::ivec2(8, 4));
}

TEST(Viewport, PastTheLimitIsAnErrorThatMakesNothing)
{
  gpu::Limits limits;
  limits.texture_size_max = 16;
  const auto device = gpu::create_null_device(limits);
  for (const glm::ivec2 &size_px : {glm::ivec2(17, 4), glm::ivec2(4, 17), glm::ivec2(0, 4), glm::ivec2(4, -1)}) {
    expect_contains(error_of([&] { Viewport(*device, size_px); }),
                    fmt::format("{}x{} pixels are not from 1x1 to 16x16", size_px.x, size_px.y));
  }
  EXPECT_TRUE(device->live_resources().empty());
}

TEST(EngineRegistry, MakesEnginesByName)
{
  Log log;
  EngineRegistry registry;
  registry.add({"first", [&] { return std::make_unique<LoggingEngine>("1", log); }});
  registry.add({"second", [&] { return std::make_unique<LoggingEngine>("2", log); }});
  EXPECT_EQ(registry.names(), (std::vector<std::string>{"first", "second"}));
  EXPECT_EQ(registry.create("second")->name(), "2");
  EXPECT_NE(registry.create("first"), registry.create("first"));
}

TEST(EngineRegistry, NameTakenTwiceIsAnErrorAndTheFirstStays)
{
  Log log;
  EngineRegistry registry;
  registry.add({"engine", [&] { return std::make_unique<LoggingEngine>("1", log); }});
  expect_contains(error_of([&] {
                    registry.add({"engine", [&] { return std::make_unique<LoggingEngine>("2", log); }});
                  }),
                  "'engine'");
  EXPECT_EQ(registry.names(), std::vector<std::string>{"engine"});
  EXPECT_EQ(registry.create("engine")->name(), "1");
}

TEST(EngineRegistry, UnknownNameIsAnErrorThatNamesTheKnown)
{
  Log log;
  EngineRegistry registry;
  registry.add({"first", [&] { return std::make_unique<LoggingEngine>("1", log); }});
  registry.add({"second", [&] { return std::make_unique<LoggingEngine>("2", log); }});
  const std::string message = error_of([&] { static_cast<void>(registry.create("third")); });
  expect_contains(message, "'third'");
  expect_contains(message, "first, second");
}

TEST(EngineDataMap, MakesAtTheFirstAskAndKeepsInPlace)
{
  EngineDataMap<std::vector<int>> map;
  std::vector<int> &seven = map.get(7);
  EXPECT_TRUE(seven.empty());
  seven.push_back(1);
  for (std::uint32_t i = 100; i < 1000; i++) {
    map.get(i);
  }
  EXPECT_EQ(&map.get(7), &seven) << "the reference moved";
  EXPECT_EQ(map.get(7).size(), 1U);
  EXPECT_EQ(map.size(), 901U);
}

TEST(EngineDataMap, ForgetsWhatTheHostHasNoMore)
{
  EngineDataMap<int> map;
  for (std::uint32_t i = 0; i < 10; i++) {
    map.get(i) = int(i) + 1;
  }
  map.remove_from(4);
  EXPECT_EQ(map.size(), 4U);
  EXPECT_EQ(map.get(3), 4);
  EXPECT_EQ(map.get(4), 0) << "made anew";
  map.remove_from(0);
  EXPECT_EQ(map.size(), 0U);
}

}  // namespace
}  // namespace gnomon::draw
