// SPDX-License-Identifier: MIT
#include "draw_viewport.hh"

#include "gpu/gpu_testing.hh"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <functional>

namespace gnomon::draw {
namespace {

using test::error_of;
using test::expect_contains;

using Log = std::vector<std::string>;

/** Logs its calls. */
class LoggingEngine final : public Engine {
 public:
  struct Data : EngineViewportData {
    void resized() override
    {
      resizes++;
      texture = {};
    }
    int syncs = 0;
    int resizes = 0;
    gpu::Texture texture;
  };

  LoggingEngine(std::string name, Log &log) : name_(std::move(name)), log_(log) {}

  std::string_view name() const override
  {
    return name_;
  }
  void init(Viewport &viewport) override
  {
    auto &data = viewport.engine_data<Data>(*this);
    data.syncs++;
    data.texture = viewport.device().create_texture({.name = name_});
    log_.push_back(name_ + " init");
  }
  void cache_init(Viewport & /*viewport*/) override
  {
    log_.push_back(name_ + " cache_init");
  }
  void cache_populate(Viewport & /*viewport*/, const ObjectBuffer &objects, ObjectIndex object) override
  {
    if (object == fails_at) {
      throw gpu::Error("object {} fails", object);
    }
    log_.push_back(fmt::format("{} cache_populate {} at {}", name_, object, objects.world_from_object(object)[3].x));
  }
  void cache_finish(Viewport & /*viewport*/) override
  {
    log_.push_back(name_ + " cache_finish");
  }
  void draw_scene(Viewport &viewport, const View &view) override
  {
    samples.push_back(viewport.samples_drawn());
    if (fails_to_draw) {
      throw gpu::Error("no draw");
    }
    log_.push_back(fmt::format("{} draw_scene {}", name_, view.is_perspective() ? "perspective" : "parallel"));
  }

  /** cache_populate throws for this object. */
  ObjectIndex fails_at = object_identity;
  bool fails_to_draw = false;
  /** Viewport::samples_drawn at each draw. */
  std::vector<int> samples;

 private:
  std::string name_;
  Log &log_;
};

class ViewportTest : public testing::Test {
 protected:
  static glm::mat4 at(float x)
  {
    return glm::translate(glm::mat4(1), {x, 0, 0});
  }
  /** Lines that a sync of \a viewport logs. */
  Log synced(Viewport &viewport, std::initializer_list<Engine *> engines)
  {
    log.clear();
    viewport.sync(std::vector<Engine *>(engines), objects);
    return log;
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  Log log;
  LoggingEngine a{"a", log};
  LoggingEngine b{"b", log};
  ObjectBuffer objects;
};

TEST_F(ViewportTest, CallsEnginesInOrder)
{
  objects.add(at(5));
  objects.add(at(2));
  Viewport viewport(*device, {8, 4});
  // For each engine: init, cache_init, each object in the order of the indices, cache_finish.
  EXPECT_EQ(synced(viewport, {&a, &b}),
            (Log{"a init", "a cache_init", "a cache_populate 1 at 5", "a cache_populate 2 at 2", "a cache_finish",
                 "b init", "b cache_init", "b cache_populate 1 at 5", "b cache_populate 2 at 2", "b cache_finish"}));
  log.clear();
  const std::vector<Engine *> engines = {&a, &b};
  viewport.draw(engines, View(glm::mat4(1), perspective(1, 1, 0.1F, 10)));
  viewport.draw(engines, View(glm::mat4(1), orthographic(1, 1, 0.1F, 10)));
  EXPECT_EQ(log, (Log{"a draw_scene perspective", "b draw_scene perspective", "a draw_scene parallel",
                      "b draw_scene parallel"}));
}

TEST_F(ViewportTest, HandsOverOnlyTheObjectsThatChanged)
{
  for (int i = 1; i <= 4; i++) {
    objects.add(at(float(i)));
  }
  Viewport viewport(*device, {8, 4});
  synced(viewport, {&a});
  EXPECT_EQ(synced(viewport, {&a}), (Log{"a init", "a cache_finish"})) << "nothing changed";
  objects.set(3, at(30), 0, {});
  objects.set(1, at(10), 0, {});
  objects.set(2, at(2), 0, {});
  EXPECT_EQ(synced(viewport, {&a}),
            (Log{"a init", "a cache_populate 1 at 10", "a cache_populate 3 at 30", "a cache_finish"}));
  EXPECT_EQ(synced(viewport, {&a}), (Log{"a init", "a cache_finish"}));
}

TEST_F(ViewportTest, BeginsAnewWhereObjectsWereAddedOrRemoved)
{
  for (int i = 1; i <= 3; i++) {
    objects.add(at(float(i)));
  }
  Viewport viewport(*device, {8, 4});
  synced(viewport, {&a});
  objects.remove(2);
  EXPECT_EQ(synced(viewport, {&a}),
            (Log{"a init", "a cache_init", "a cache_populate 1 at 1", "a cache_populate 3 at 3", "a cache_finish"}));
  objects.add(at(7));
  EXPECT_EQ(synced(viewport, {&a}), (Log{"a init", "a cache_init", "a cache_populate 1 at 1", "a cache_populate 2 at 7",
                                         "a cache_populate 3 at 3", "a cache_finish"}));
  EXPECT_EQ(synced(viewport, {&a}), (Log{"a init", "a cache_finish"}));
}

TEST_F(ViewportTest, ChangesAreCountedForEachEngineAndViewport)
{
  objects.add(at(1));
  Viewport viewport(*device, {8, 4});
  Viewport other(*device, {8, 4});
  synced(viewport, {&a});
  objects.set(1, at(2), 0, {});
  const Log all_of_b = {"b init", "b cache_init", "b cache_populate 1 at 2", "b cache_finish"};
  EXPECT_EQ(synced(viewport, {&b}), all_of_b) << "its first sync";
  EXPECT_EQ(synced(viewport, {&a}), (Log{"a init", "a cache_populate 1 at 2", "a cache_finish"}));
  EXPECT_EQ(synced(other, {&b}), all_of_b) << "its first sync of this viewport";
}

TEST_F(ViewportTest, AFailedSyncIsRepeatedWhole)
{
  for (int i = 1; i <= 3; i++) {
    objects.add(at(float(i)));
  }
  Viewport viewport(*device, {8, 4});
  synced(viewport, {&a, &b});
  objects.set(1, at(10), 0, {});
  objects.set(3, at(30), 0, {});
  a.fails_at = 3;
  EXPECT_THROW(synced(viewport, {&a, &b}), gpu::Error);
  EXPECT_EQ(log, (Log{"a init", "a cache_populate 1 at 10"})) << "the engine after the failed one was not called";
  a.fails_at = object_identity;
  EXPECT_EQ(
      synced(viewport, {&a, &b}),
      (Log{"a init", "a cache_init", "a cache_populate 1 at 10", "a cache_populate 2 at 2", "a cache_populate 3 at 30",
           "a cache_finish", "b init", "b cache_populate 1 at 10", "b cache_populate 3 at 30", "b cache_finish"}));
}

TEST_F(ViewportTest, KeepsTheDataOfAnEngineApartFromSyncToSync)
{
  Viewport viewport(*device, {8, 4});
  Viewport other(*device, {8, 4});
  synced(viewport, {&a});
  synced(viewport, {&a, &b});
  synced(other, {&a});
  EXPECT_EQ(viewport.engine_data<LoggingEngine::Data>(a).syncs, 2);
  EXPECT_EQ(viewport.engine_data<LoggingEngine::Data>(b).syncs, 1);
  EXPECT_EQ(other.engine_data<LoggingEngine::Data>(a).syncs, 1);
}

TEST_F(ViewportTest, RemovedEngineLeavesNothingAndBeginsAnew)
{
  objects.add(at(1));
  Viewport viewport(*device, {8, 4});
  viewport.remove_engine(a);
  synced(viewport, {&b});
  const std::size_t memory = device->memory_bytes();
  synced(viewport, {&a});
  EXPECT_GT(device->memory_bytes(), memory);
  viewport.remove_engine(a);
  EXPECT_EQ(device->memory_bytes(), memory);
  EXPECT_EQ(device->live_resources(), std::vector<std::string>{"texture 'b'"});
  EXPECT_EQ(viewport.engine_data<LoggingEngine::Data>(b).syncs, 1) << "the other engine's data";
  EXPECT_EQ(synced(viewport, {&a}), (Log{"a init", "a cache_init", "a cache_populate 1 at 1", "a cache_finish"}));
}

TEST_F(ViewportTest, ResizeFreesTheDepthAndTellsTheEngines)
{
  objects.add(at(1));
  Viewport viewport(*device, {8, 4});
  static_cast<void>(viewport.depth_texture());
  synced(viewport, {&a, &b});
  viewport.resize({8, 4});
  EXPECT_EQ(viewport.engine_data<LoggingEngine::Data>(a).resizes, 0) << "the same size";
  EXPECT_TRUE(viewport.has_depth_texture());
  viewport.resize({6, 10});
  EXPECT_EQ(viewport.size_px(), glm::ivec2(6, 10));
  EXPECT_EQ(viewport.engine_data<LoggingEngine::Data>(a).resizes, 1);
  EXPECT_EQ(viewport.engine_data<LoggingEngine::Data>(b).resizes, 1);
  EXPECT_EQ(device->live_resources(), std::vector<std::string>());
  const gpu::TextureDesc &depth = viewport.depth_texture().desc();
  EXPECT_EQ(glm::ivec2(depth.width, depth.height), glm::ivec2(8, 12)) << "with a guard band of one pixel";
  // The objects are unchanged.
  EXPECT_EQ(synced(viewport, {&a}), (Log{"a init", "a cache_finish"}));
}

TEST_F(ViewportTest, WithoutRoomForAGuardBandThereIsNone)
{
  gpu::Limits limits;
  limits.texture_size_max = 16;
  const auto small = gpu::create_null_device(limits);
  Viewport viewport(*small, {16, 14});
  EXPECT_EQ(viewport.guard_px(), glm::ivec2(0, 1));
  EXPECT_EQ(viewport.drawn_size_px(), glm::ivec2(16, 16));
  EXPECT_NO_THROW(static_cast<void>(viewport.depth_texture()));
  viewport.resize({14, 8});
  EXPECT_EQ(viewport.drawn_size_px(), glm::ivec2(16, 10));
}

TEST_F(ViewportTest, ARegionNeedsTheNeighboursOfItsPixels)
{
  Viewport viewport(*device, {8, 4});
  EXPECT_EQ(viewport.region(), (gpu::Rectangle{{0, 0}, {8, 4}}));
  EXPECT_TRUE(viewport.drawn_region().is_whole());
  viewport.set_region({{2, 0}, {3, 4}});
  EXPECT_EQ(viewport.drawn_region(), (gpu::Rectangle{{2, 0}, {5, 6}}));
  viewport.resize({6, 4});
  EXPECT_TRUE(viewport.drawn_region().is_whole());
}

TEST_F(ViewportTest, ResizeToASizePastTheLimitChangesNothing)
{
  gpu::Limits limits;
  limits.texture_size_max = 16;
  const auto small = gpu::create_null_device(limits);
  Viewport viewport(*small, {8, 4});
  static_cast<void>(viewport.depth_texture());
  synced(viewport, {&a});
  for (const glm::ivec2 &size_px : {glm::ivec2(17, 4), glm::ivec2(4, 17), glm::ivec2(0, 4), glm::ivec2(4, -1)}) {
    expect_contains(error_of([&] { viewport.resize(size_px); }),
                    fmt::format("{}x{} pixels are not from 1x1 to 16x16", size_px.x, size_px.y));
  }
  EXPECT_EQ(viewport.size_px(), glm::ivec2(8, 4));
  EXPECT_TRUE(viewport.has_depth_texture());
  EXPECT_EQ(viewport.engine_data<LoggingEngine::Data>(a).resizes, 0);
}

TEST_F(ViewportTest, APictureBeginsAnewWithItsViewItsSizeAFailureAndARestart)
{
  Viewport viewport(*device, {8, 4});
  const std::vector<Engine *> engines = {&a};
  const View first(glm::mat4(1), perspective(1, 1, 0.1F, 10));
  const View second(at(1), perspective(1, 1, 0.1F, 10));
  const auto samples_of = [&](const std::function<void()> &change, const View &view) {
    a.samples.clear();
    viewport.sync(engines, objects);
    viewport.draw(engines, first);
    viewport.draw(engines, first);
    change();
    viewport.sync(engines, objects);
    viewport.draw(engines, view);
    viewport.restart();
    return a.samples;
  };
  const auto nothing = [] {};
  EXPECT_EQ(samples_of(nothing, first), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(samples_of(nothing, second), (std::vector<int>{0, 1, 0}));
  EXPECT_EQ(samples_of([&] { viewport.resize({8, 5}); }, first), (std::vector<int>{0, 1, 0}));
  EXPECT_EQ(samples_of([&] { viewport.resize({8, 5}); }, first), (std::vector<int>{0, 1, 2})) << "the same size";
  EXPECT_EQ(samples_of([&] { viewport.restart(); }, first), (std::vector<int>{0, 1, 0}));
  const auto fail = [&] {
    a.fails_to_draw = true;
    EXPECT_THROW(viewport.draw(engines, first), gpu::Error);
    a.fails_to_draw = false;
  };
  EXPECT_EQ(samples_of(fail, first), (std::vector<int>{0, 1, 2, 0}));
}

TEST(Viewport, SharesADepthOfItsSize)
{
  const auto device = gpu::create_null_device();
  Viewport viewport(*device, {8, 4});
  EXPECT_FALSE(viewport.has_depth_texture()) << "no engine asked for it";
  const gpu::TextureDesc &depth = viewport.depth_texture().desc();
  EXPECT_EQ(glm::ivec2(depth.width, depth.height), glm::ivec2(10, 6)) << "with a guard band of one pixel";
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

TEST_F(ViewportTest, PartsCoverEachRowOfASampleOnce)
{
  /** Notes the parts that it draws. */
  class PartEngine final : public Engine {
   public:
    std::string_view name() const override
    {
      return "parts";
    }
    void init(Viewport & /*viewport*/) override {}
    void cache_init(Viewport & /*viewport*/) override {}
    void cache_populate(Viewport & /*viewport*/, const ObjectBuffer & /*objects*/, ObjectIndex /*object*/) override {}
    void cache_finish(Viewport & /*viewport*/) override {}
    void draw_scene(Viewport &viewport, const View & /*view*/) override
    {
      if (viewport.is_writing()) {
        writes++;
        return;
      }
      if (extends_at == int(parts.size())) {
        viewport.extend_part();
      }
      parts.push_back(viewport.part());
      regions.push_back(viewport.part_region());
    }
    int extends_at = -1;
    int writes = 0;
    std::vector<SamplePart> parts;
    std::vector<gpu::Rectangle> regions;
  };
  PartEngine engine;
  const std::vector<Engine *> engines = {&engine};
  const View view(glm::mat4(1), perspective(1, 1, 0.1F, 10));
  Viewport viewport(*device, {8, 11});
  const std::vector<Engine *> both = {&engine, &a};
  viewport.sync(both, objects);
  // 13 rows with the guard band.
  const auto draw = [&](int rows) {
    viewport.set_rows_max(rows);
    viewport.draw(engines, view);
  };
  draw(0);
  EXPECT_TRUE(engine.parts.back().is_first && !engine.parts.back().is_last && engine.parts.back().row_count == 0);
  EXPECT_TRUE(viewport.has_begun_sample());
  for (const int rows : {5, 3, 9}) {
    EXPECT_EQ(viewport.samples_drawn(), 0);
    draw(rows);
    EXPECT_FALSE(engine.parts.back().is_first);
  }
  EXPECT_EQ(viewport.samples_drawn(), 1);
  EXPECT_TRUE(engine.parts.back().is_last);
  EXPECT_EQ(engine.regions[1], (gpu::Rectangle{{0, 0}, {10, 5}}));
  EXPECT_EQ(engine.regions[2], (gpu::Rectangle{{0, 5}, {10, 3}}));
  EXPECT_EQ(engine.regions[3], (gpu::Rectangle{{0, 8}, {10, 5}}));
  viewport.write(engines, {});
  EXPECT_EQ(engine.writes, 1);
  EXPECT_EQ(viewport.samples_drawn(), 1);

  // An engine whose pixels depend on each other draws all that are left.
  draw(4);
  engine.extends_at = int(engine.parts.size());
  draw(1);
  EXPECT_EQ(engine.regions.back(), (gpu::Rectangle{{0, 4}, {10, 9}}));
  EXPECT_EQ(viewport.samples_drawn(), 2);
  // A restart forgets the part of a sample.
  draw(4);
  const std::uint64_t restarts = viewport.restart_count();
  viewport.restart();
  EXPECT_EQ(viewport.restart_count(), restarts + 1);
  draw(4);
  EXPECT_TRUE(engine.parts.back().is_first);
  EXPECT_EQ(engine.parts.back().row, 0);
  // Parts are those of the region.
  viewport.set_region({{2, 3}, {4, 6}});
  draw(5);
  EXPECT_EQ(engine.regions.back(), (gpu::Rectangle{{2, 3}, {6, 5}}));
  draw(5);
  EXPECT_EQ(engine.regions.back(), (gpu::Rectangle{{2, 8}, {6, 3}}));
  EXPECT_EQ(viewport.samples_drawn(), 1);
  // With several engines, each draw is a whole sample.
  viewport.draw(both, view);
  EXPECT_EQ(viewport.samples_drawn(), 1);
  EXPECT_TRUE(engine.parts.back().is_first && engine.parts.back().is_last);
}

TEST_F(ViewportTest, ARegionOfAPictureCannotBeScaled)
{
  const TargetTexture target(*device, "target", gpu::Format::RGBA8, {20, 20});
  Viewport viewport(*device, {8, 4});
  const std::vector<Engine *> engines = {&a};
  const View view(glm::mat4(1), perspective(1, 1, 0.1F, 10));
  Target scaled = target.target();
  scaled.size_px = {16, 8};
  viewport.sync(engines, objects);
  viewport.draw(engines, view, scaled);
  EXPECT_EQ(viewport.target().size_px, glm::ivec2(16, 8));
  viewport.set_region({{0, 0}, {4, 4}});
  expect_contains(error_of([&] { viewport.draw(engines, view, scaled); }), "a region of a picture cannot be scaled");
  scaled.size_px = {8, 4};
  viewport.draw(engines, view, scaled);
  for (const glm::ivec2 wrong : {glm::ivec2(21, 8), glm::ivec2(-1, 4), glm::ivec2(0, 4)}) {
    scaled.size_px = wrong;
    expect_contains(error_of([&] { viewport.draw(engines, view, scaled); }), "does not fit");
  }
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

}  // namespace
}  // namespace gnomon::draw
