// SPDX-License-Identifier: MIT
// `gnomon bench sync`. It needs no driver, but a minute of CPU time under the sanitizers that tests without a driver
// have.
#include "cli_process.hh"

#include <nlohmann/json.hpp>

namespace gnomon {
namespace {

using nlohmann::json;

using BenchSyncTest = test::ProgramTest;

TEST_F(BenchSyncTest, MeasuresEditsAmongManyTriangles)
{
  ASSERT_EQ(run("bench sync --rounds 1 --json sync.json").status, 0);
  const json rows = json::parse(read("sync.json"))["rows"];
  ASSERT_EQ(rows.size(), 5U);
  EXPECT_EQ(rows[0]["ratio_to_first"], 1.0);
  for (const json &row : rows) {
    EXPECT_GT(row["seconds"]["median"], 0.0) << row;
    EXPECT_GT(row["ratio_to_first"], 0.0) << row;
  }
}

}  // namespace
}  // namespace gnomon
