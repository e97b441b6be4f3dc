// SPDX-License-Identifier: MIT
// Built with ThreadSanitizer, too.
#include "gltf_background_import.hh"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <thread>
#include <vector>

namespace gnomon::gltf {
namespace {

const std::filesystem::path spots = std::filesystem::path(GNOMON_SOURCE) / "examples/scenes/spots.glb";

void expect_same(const scene::Scene &first, const scene::Scene &second)
{
  ASSERT_EQ(first.nodes().size(), second.nodes().size());
  ASSERT_EQ(first.meshes().size(), second.meshes().size());
  EXPECT_EQ(first.path, second.path);
  EXPECT_EQ(first.warnings, second.warnings);
  for (const auto &[handle, mesh] : first.meshes()) {
    EXPECT_EQ(mesh.positions, second.meshes()[handle].positions) << mesh.name;
  }
}

template <typename Work>
std::string message_of_cancelled(Work &&work)
{
  try {
    work();
  }
  catch (const ImportCancelled &error) {
    return error.what();
  }
  ADD_FAILURE() << "not cancelled";
  return {};
}

TEST(ImportProgress, RisesFrom0To1OnTheImportingThread)
{
  std::vector<float> parts;
  const std::thread::id thread = std::this_thread::get_id();
  const auto progress = [&](float part) {
    EXPECT_EQ(std::this_thread::get_id(), thread);
    parts.push_back(part);
    return true;
  };
  static_cast<void>(import_gltf(spots, {.progress = progress}));
  ASSERT_GE(parts.size(), 6U);
  EXPECT_LE(parts.size(), 300U);
  EXPECT_EQ(parts.front(), 0.0F);
  EXPECT_EQ(parts.back(), 1.0F);
  EXPECT_TRUE(std::is_sorted(parts.begin(), parts.end()));
}

TEST(ImportProgress, EndsTheImportAtAnyStepWithAMessageThatNamesTheFile)
{
  const scene::Scene whole = import_gltf(spots);
  int call_count = 0;
  static_cast<void>(import_gltf(spots, {.progress = [&](float) { return ++call_count > 0; }}));
  for (int last = 0; last < call_count; last++) {
    int calls = 0;
    const auto progress = [&](float) { return calls++ != last; };
    const std::string text =
        message_of_cancelled([&] { static_cast<void>(import_gltf(spots, {.progress = progress})); });
    EXPECT_EQ(text, spots.string() + ": the import was cancelled");
    EXPECT_EQ(calls, last + 1) << "called after it was ended";
  }
  expect_same(import_gltf(spots), whole);
}

TEST(BackgroundImportTest, GivesTheSceneOfImportGltf)
{
  BackgroundImport import(spots);
  EXPECT_EQ(import.path(), spots);
  float before = 0.0F;
  while (!import.is_done()) {
    const float now = import.progress();
    EXPECT_GE(now, before);
    before = now;
    std::this_thread::yield();
  }
  EXPECT_EQ(import.progress(), 1.0F);
  expect_same(import.take(), import_gltf(spots));
}

TEST(BackgroundImportTest, ThrowsForABrokenFileWhenItIsTaken)
{
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("gnomon_broken_" + std::to_string(::getpid()) + ".glb");
  std::ofstream(path) << "this is no glTF";
  BackgroundImport import(path);
  try {
    static_cast<void>(import.take());
    ADD_FAILURE() << "taken";
  }
  catch (const ImportError &error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(path.string() + ": ")) << error.what();
  }
  EXPECT_TRUE(import.is_done());
  std::filesystem::remove(path);
}

TEST(BackgroundImportTest, EndsAtTheNextStepAfterCancel)
{
  std::promise<void> begun;
  std::promise<void> cancelled;
  int calls = 0;
  const auto progress = [&](float) {
    if (calls++ == 0) {
      begun.set_value();
      cancelled.get_future().wait();
    }
    return true;
  };
  BackgroundImport import(spots, {.progress = progress});
  begun.get_future().wait();
  EXPECT_FALSE(import.is_done());
  import.cancel();
  cancelled.set_value();
  EXPECT_EQ(message_of_cancelled([&] { static_cast<void>(import.take()); }),
            spots.string() + ": the import was cancelled");
  EXPECT_EQ(calls, 1);
  EXPECT_LT(import.progress(), 1.0F);
}

TEST(BackgroundImportTest, IsCancelledAndJoinedByItsDestructor)
{
  std::atomic<bool> is_alive = true;
  std::atomic<int> calls = 0;
  const auto progress = [&](float) {
    EXPECT_TRUE(is_alive);
    calls++;
    return true;
  };
  for (int i = 0; i < 20; i++) {
    const BackgroundImport import(spots, {.progress = progress});
    while (i % 2 == 1 && calls == 0) {
      std::this_thread::yield();
    }
  }
  is_alive = false;
  const int calls_before = calls;
  std::this_thread::yield();
  EXPECT_EQ(calls, calls_before);
}

}  // namespace
}  // namespace gnomon::gltf
