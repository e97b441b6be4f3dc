// SPDX-License-Identifier: MIT
// `gnomon stability` without a driver.
#include "cli_process.hh"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace gnomon {
namespace {

class CliStabilityTest : public test::ProgramTest {};

TEST_F(CliStabilityTest, WritesARowACaseAndTheSamplesOfEach)
{
  const test::Finished finished = run("stability --group octahedral -o out/nested");
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_TRUE(finished.err.empty()) << finished.err;
  const nlohmann::json json = nlohmann::json::parse(read("out/nested/stability.json"));
  for (const char *key : {"program", "date", "machine"}) {
    EXPECT_FALSE(json.at(key).get<std::string>().empty()) << key;
  }
  const std::size_t count = json.at("cases").size();
  EXPECT_GT(count, 20U);
  EXPECT_EQ(json.at("summary").at("cases"), count);
  EXPECT_EQ(json.at("summary").at("passed"), count);
  EXPECT_EQ(json.at("summary").at("failed"), 0);
  EXPECT_GT(json.at("summary").at("baselines"), 0);
  for (const nlohmann::json &one : json.at("cases")) {
    EXPECT_EQ(one.at("group"), "octahedral");
    EXPECT_GT(one.at("samples").size(), 4U) << one.at("name");
  }
  const std::string csv = read("out/nested/stability.csv");
  EXPECT_EQ(std::size_t(std::ranges::count(csv, '\n')), count + 1) << "a head, and a row a case";
  EXPECT_NE(csv.find("\"edge +X to +Y\""), std::string::npos);
  const std::string page = read("out/nested/index.html");
  EXPECT_NE(page.find("<canvas>"), std::string::npos);
  EXPECT_NE(page.find("edge +X to +Y"), std::string::npos);
  EXPECT_NE(finished.out.find(std::to_string(count) + " cases: " + std::to_string(count) + " passed"),
            std::string::npos)
      << finished.out;
}

TEST_F(CliStabilityTest, UnknownGroupIsWrongUsageAndListsTheGroups)
{
  const test::Finished finished = run("stability --group esms -o out");
  EXPECT_EQ(finished.status, 2);
  EXPECT_NE(finished.err.find("no group 'esms' of cases; there are: esm, depth"), std::string::npos) << finished.err;
  EXPECT_EQ(file_count(), 0U);
}

TEST_F(CliStabilityTest, InvalidFolderIsNamed)
{
  write("taken", "a file");
  const test::Finished finished = run("stability --group area -o taken");
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.err.find("taken"), std::string::npos) << finished.err;
  EXPECT_EQ(read("taken"), "a file");
}

TEST_F(CliStabilityTest, WithoutAFolderItIsWrongUsage)
{
  EXPECT_EQ(run("stability").status, 2);
}

}  // namespace
}  // namespace gnomon
