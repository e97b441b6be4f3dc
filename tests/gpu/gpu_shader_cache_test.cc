// SPDX-License-Identifier: MIT
#include "gpu_shader_cache.hh"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>

namespace gnomon::gpu {
namespace {

namespace fs = std::filesystem;

class ShaderDiskCacheTest : public testing::Test {
 protected:
  ShaderDiskCacheTest()
  {
    std::string pattern = (fs::temp_directory_path() / "gnomon_cache.XXXXXX").string();
    folder = mkdtemp(pattern.data());
    shader.compiled = {std::byte(0), std::byte(255), std::byte(10)};
  }
  ~ShaderDiskCacheTest() override
  {
    fs::permissions(folder, fs::perms::owner_all);
    fs::remove_all(folder);
  }

  fs::path folder;
  CachedShader shader;
};

TEST_F(ShaderDiskCacheTest, GivesBackWhatWasStored)
{
  const ShaderDiskCache cache(folder / "deep" / "er");
  cache.store("key", shader);
  const std::optional<CachedShader> loaded = cache.load("key");
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->compiled, shader.compiled);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "deep" / "er"), fs::directory_iterator()), 1);
}

TEST_F(ShaderDiskCacheTest, HasNoEntryThatWasNotStored)
{
  EXPECT_FALSE(ShaderDiskCache(folder).load("key"));
  EXPECT_FALSE(ShaderDiskCache(folder / "nowhere").load("key"));
  const ShaderDiskCache none{fs::path()};
  none.store("key", shader);
  EXPECT_FALSE(none.load("key"));
}

TEST_F(ShaderDiskCacheTest, AShaderWithoutABinaryIsNotStored)
{
  shader.compiled.clear();
  const ShaderDiskCache cache(folder);
  cache.store("key", shader);
  EXPECT_FALSE(fs::exists(folder / "key"));
}

TEST_F(ShaderDiskCacheTest, AnyChangedByteIsNoEntryAndIsReplaced)
{
  const ShaderDiskCache cache(folder);
  cache.store("key", shader);
  std::ifstream input(folder / "key", std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(input), std::istreambuf_iterator<char>()};
  for (std::size_t i = 0; i < whole.size(); i++) {
    std::string changed = whole;
    changed[i] = char(changed[i] ^ 0x21);
    std::ofstream(folder / "key", std::ios::binary) << changed;
    EXPECT_FALSE(cache.load("key")) << "byte " << i;
    std::ofstream(folder / "key", std::ios::binary) << whole.substr(0, i);
    EXPECT_FALSE(cache.load("key")) << "cut at " << i;
  }
  cache.store("key", shader);
  EXPECT_TRUE(cache.load("key"));
}

TEST_F(ShaderDiskCacheTest, AFolderInTheWayOfTheFileIsNoEntry)
{
  fs::create_directories(folder / "key" / "inside");
  const ShaderDiskCache cache(folder);
  EXPECT_FALSE(cache.load("key"));
  cache.store("key", shader);
  EXPECT_FALSE(cache.load("key"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1) << "nothing is left beside";
}

TEST_F(ShaderDiskCacheTest, AFileInTheWayOfTheFolderIsHarmless)
{
  std::ofstream(folder / "file") << "not a folder";
  const ShaderDiskCache cache(folder / "file");
  cache.store("key", shader);
  EXPECT_FALSE(cache.load("key"));
}

TEST_F(ShaderDiskCacheTest, RemovesTheFilesThatWereUsedLeastRecently)
{
  const auto key = [](int i) { return fmt::format("{:032x}", i); };
  // A file that does not belong to the cache.
  std::ofstream(folder / "notes.txt") << std::string(100000, ' ');
  const fs::file_time_type past = fs::file_time_type::clock::now() - std::chrono::hours(100);
  const auto set_age = [&](int i) { fs::last_write_time(folder / key(i), past + std::chrono::minutes(i)); };
  const ShaderDiskCache measured(folder);
  measured.store(key(0), shader);
  set_age(0);
  const std::uintmax_t file_size = fs::file_size(folder / key(0));
  const ShaderDiskCache cache(folder, 5 * file_size + file_size / 2);
  for (int i = 1; i < 5; i++) {
    cache.store(key(i), shader);
    set_age(i);
  }
  EXPECT_TRUE(cache.load(key(0))) << "five fit";
  for (int i = 5; i < 8; i++) {
    cache.store(key(i), shader);
  }
  for (int i = 0; i < 8; i++) {
    // The first was used by the load above.
    EXPECT_EQ(fs::exists(folder / key(i)), i == 0 || i > 3) << i;
  }
  EXPECT_TRUE(fs::exists(folder / "notes.txt"));
  // A file larger than the bound remains until the next.
  const ShaderDiskCache tiny(folder, 1);
  tiny.store(key(20), shader);
  EXPECT_TRUE(tiny.load(key(20)));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2);
}

TEST(ShaderDiskCacheKey, DependsOnAllThatTheResultDoes)
{
  const std::vector<ShaderSource> stages = {{ShaderStage::Vertex, "a", {}}, {ShaderStage::Fragment, "b", {}}};
  const std::string key = ShaderDiskCache::key_of(stages, "driver 1");
  EXPECT_EQ(key, ShaderDiskCache::key_of(stages, "driver 1"));
  EXPECT_NE(key, ShaderDiskCache::key_of(stages, "driver 2"));
  EXPECT_NE(key, ShaderDiskCache::key_of({stages[0]}, "driver 1"));
  EXPECT_NE(key,
            ShaderDiskCache::key_of({{ShaderStage::Vertex, "b", {}}, {ShaderStage::Fragment, "a", {}}}, "driver 1"));
  EXPECT_NE(key,
            ShaderDiskCache::key_of({{ShaderStage::Vertex, "ab", {}}, {ShaderStage::Fragment, "", {}}}, "driver 1"));
}

}  // namespace
}  // namespace gnomon::gpu
