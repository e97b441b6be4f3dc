// SPDX-License-Identifier: MIT
// `gnomon bench` without a driver: counts, not times.
#include "cli_process.hh"

#include <nlohmann/json.hpp>

#include <map>

namespace gnomon {
namespace {

using nlohmann::json;
using test::Finished;

class BenchTest : public test::ProgramTest {};

TEST_F(BenchTest, ShadowsMeasuresAllCubePasses)
{
  const Finished finished = run("bench shadows --backend null --rounds 3 --json bench.json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json bench = json::parse(read("bench.json"));
  std::map<int, std::map<std::string, json>> rows;
  for (const json &row : bench["rows"]) {
    rows[row["casters"]][row["way"]] = row;
    EXPECT_GT(row["seconds"]["median"], 0.0);
    EXPECT_LE(row["seconds"]["low"], row["seconds"]["median"]);
    EXPECT_GE(row["seconds"]["high"], row["seconds"]["median"]);
  }
  ASSERT_EQ(rows.size(), 3U);
  for (auto &[casters, by_way] : rows) {
    ASSERT_EQ(by_way.size(), 4U) << casters;
    // Every caster is in one face, few are in two.
    EXPECT_GE(by_way["six"]["instances"], casters);
    EXPECT_LE(by_way["six"]["instances"], 3 * casters);
    for (const char *way : {"geometry", "layered"}) {
      EXPECT_EQ(by_way[way]["instances"], by_way["six"]["instances"]);
      EXPECT_EQ(by_way[way]["passes"], 1);
      EXPECT_LE(by_way[way]["draws"], by_way["six"]["draws"]);
    }
    EXPECT_EQ(by_way["six"]["passes"], 6);
    EXPECT_EQ(by_way["culled"]["passes"], 6);
    EXPECT_GE(by_way["culled"]["instances"], by_way["six"]["instances"]) << "a view culls spheres, a face mask boxes";
  }
}

TEST_F(BenchTest, RecordCullAndImportCompareWithABaseline)
{
  const auto check = [](const json &rows, std::size_t count) {
    ASSERT_EQ(rows.size(), count);
    EXPECT_EQ(rows[0]["ratio_to_first"], 1.0);
    for (const json &row : rows) {
      EXPECT_GT(row["seconds"]["median"], 0.0) << row;
      EXPECT_GT(row["ratio_to_first"], 0.0) << row;
    }
  };
  ASSERT_EQ(run("bench record --rounds 1 --json record.json").status, 0);
  check(json::parse(read("record.json"))["rows"], 4);
  for (const std::string group : {"cull", "import"}) {
    ASSERT_EQ(run("bench " + group + " --rounds 1 --count-max 1000 --json counts.json").status, 0);
    const json counts = json::parse(read("counts.json"))["counts"];
    ASSERT_EQ(counts.size(), 1U);
    check(counts[0]["rows"], 2);
  }
}

TEST_F(BenchTest, GrowthFitsTheTimesOfEachKindOfWork)
{
  const Finished finished = run("bench growth --backend null --rounds 1 --count-max 1000 --json bench.json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json bench = json::parse(read("bench.json"));
  ASSERT_EQ(bench["work"].size(), 5U);
  for (const json &work : bench["work"]) {
    EXPECT_EQ(work["rows"].size(), 3U) << work;
    EXPECT_TRUE(work["exponent"].is_number()) << work;
    for (const json &row : work["rows"]) {
      EXPECT_GT(row["seconds"]["median"], 0.0) << row;
    }
  }
}

TEST_F(BenchTest, LeftOutComparesTenScenesWithTheFullOne)
{
  const Finished finished = run("bench left-out --backend null --rounds 1 --json bench.json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json bench = json::parse(read("bench.json"));
  ASSERT_EQ(bench["rows"].size(), 11U);
  const json &full = bench["rows"][0];
  EXPECT_EQ(full["scene"], "full");
  EXPECT_EQ(full["warm_ratio_to_full"], 1.0);
  for (const json &row : bench["rows"]) {
    EXPECT_GT(row["first_seconds"]["median"], 0.0) << row;
    EXPECT_LE(row["memory_bytes"], full["memory_bytes"]) << row;
    EXPECT_LE(row["passes"], full["passes"]) << row;
  }
}

TEST_F(BenchTest, LampsMeasuresFewAndMany)
{
  const Finished finished = run("bench lamps --backend null --rounds 1 --json bench.json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json bench = json::parse(read("bench.json"));
  EXPECT_TRUE(bench["growth_exponent"].is_number());
  std::map<std::string, std::vector<int>> lamps;
  for (const json &row : bench["rows"]) {
    lamps[row["hall"]].push_back(row["lamps"]);
    EXPECT_GT(row["seconds_of_lists"]["median"], 0.0) << row;
    EXPECT_EQ(row.contains("seconds_of_all"), row["lamps"] <= 255) << row;
    EXPECT_LT(row["memory_bytes"], 64 << 20) << row;
    EXPECT_EQ(row.contains("seconds_of_first"), row["hall"] == "90 m") << row;
  }
  EXPECT_EQ(lamps, (std::map<std::string, std::vector<int>>{{"90 m", {8, 32, 128}},
                                                            {"growing", {1, 8, 32, 128, 1024, 10000}}}));
}

TEST_F(BenchTest, FramesOfAStillPictureDrawAndUploadNothing)
{
  const Finished finished =
      run("bench frames '" GNOMON_SOURCE "/examples/scenes/spots.glb' --backend null --frames 12 --json bench.json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json bench = json::parse(read("bench.json"));
  ASSERT_EQ(bench["rows"].size(), 1U);
  const json &row = bench["rows"][0];
  const auto expect_times = [](const json &times, std::initializer_list<const char *> names) {
    for (const char *what : names) {
      EXPECT_LE(times[what]["p50"], times[what]["p95"]) << what;
      EXPECT_LE(times[what]["p95"], times[what]["longest"]) << what;
    }
  };
  expect_times(row, {"control", "moved_lamp", "small_arithmetic", "large_arithmetic", "uncached_arithmetic"});
  EXPECT_GT(row["moved_lamp"]["p50"], row["control"]["p50"]);
  for (const json &budget : {row, row["offline"]}) {
    expect_times(budget, {"moved_camera", "refined"});
    EXPECT_EQ(budget["still"], json({{"draws", 0}, {"upload_bytes", 0}}));
    EXPECT_EQ(budget["difference_rms"], 0.0);
  }
}

TEST_F(BenchTest, MemoryOfAPictureWithTwoLampsHasALimit)
{
  const Finished finished = run("bench memory '" GNOMON_SOURCE "/examples/scenes/plaza.glb' '" GNOMON_SOURCE
                                "/examples/scenes/spots.glb' --backend null --json bench.json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json bench = json::parse(read("bench.json"));
  ASSERT_EQ(bench["rows"].size(), 4U);
  for (const json &row : bench["rows"]) {
    EXPECT_GT(row["shadow_bytes"], 0) << row;
    EXPECT_LT(row["bytes_without_shadows"], row["bytes"]) << row;
  }
  // plaza, one sample, a point lamp and a sun.
  EXPECT_LE(bench["rows"][0]["bytes"], 40 << 20);
  EXPECT_EQ(run("bench memory absent.glb --backend null").status, 1);
  EXPECT_EQ(run("bench memory '" GNOMON_SOURCE "/examples/scenes/plaza.glb' --size 0x1 --backend null").status, 2);
}

TEST_F(BenchTest, LightComparesApproximationsWithIntegrals)
{
  const Finished finished = run("bench light --points 1 --json bench.json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json bench = json::parse(read("bench.json"));
  std::map<std::string, int> rows;
  for (const json &row : bench["rows"]) {
    rows[row["light"]]++;
    EXPECT_GT(row["cases"], 0) << row;
    for (const char *approximation : {"whole", "point"}) {
      EXPECT_EQ(row[approximation]["bad"], 0) << row;
      EXPECT_LE(row[approximation]["median"], row[approximation]["p95"]) << row;
      EXPECT_LE(row[approximation]["p95"], row[approximation]["largest"]) << row;
    }
  }
  EXPECT_EQ(rows, (std::map<std::string, int>{{"diffuse", 14}, {"specular", 23}}));
}

TEST_F(BenchTest, StartRunsTheProgramBesideAnEmptyProcess)
{
  const Finished finished = run("bench start --backend null --rounds 1 --json bench.json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const json bench = json::parse(read("bench.json"));
  ASSERT_EQ(bench["rows"].size(), 5U);
  EXPECT_EQ(bench["rows"][0]["what"], "/bin/true");
  for (const json &row : bench["rows"]) {
    EXPECT_GT(row["seconds"]["median"], 0.0) << row;
    EXPECT_GE(row["peak_bytes"], bench["rows"][0]["peak_bytes"]) << row;
  }
  EXPECT_EQ(run("bench start absent.glb --backend null --rounds 1").status, 1);
}

}  // namespace
}  // namespace gnomon
