// SPDX-License-Identifier: MIT
#include "cli_process.hh"

#include "cli_setting_options.hh"

#include "gltf_import.hh"
#include "render_display.hh"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

/** The options of `gnomon render` for the rows of settings. */
namespace gnomon::cli {
namespace {

using CliSettings = test::ProgramTest;

template <typename Visit>
void for_each_setting(Visit &&visit)
{
  eevee::Settings::for_each_property(visit);
  eevee::ShadowSettings::for_each_property(visit);
  render_scene::Display::for_each_property(visit);
  gltf::ImportOptions::for_each_property(visit);
}

/** A number as an option takes it. */
std::string number_text(double number)
{
  return fmt::format("{:.13g}", number);
}

TEST_F(CliSettings, EachOptionIsInTheHelpAndTakesWhatItsRowAllows)
{
  const std::string help = run("render --help").out;
  // The scene is missing, so that right options end with status 1.
  const std::string render = "render missing.glb -o out.png --backend null ";
  ASSERT_EQ(run(render).status, 1);
  // By option: values that are right. Values of several options share a process.
  std::map<std::string, std::vector<std::string>> right;
  for_each_setting([&](const auto &row) {
    if (row.option.empty()) {
      return;
    }
    const std::string option = "--" + std::string(row.option);
    EXPECT_NE(help.find("\n  " + option + ' '), std::string::npos) << option;
    using Value = typename scene::PresentValue<typename std::decay_t<decltype(row)>::Value>::Type;
    const auto take = [&](std::string_view value) { right[option].emplace_back(value); };
    const auto refuse = [&](const std::string &value) {
      EXPECT_EQ(run(render + option + ' ' + value).status, 2) << option << ' ' << value;
    };
    if constexpr (std::is_enum_v<Value>) {
      std::ranges::for_each(scene::words<Value>, take);
      refuse("word");
    }
    else if constexpr (std::is_same_v<Value, bool>) {
      std::ranges::for_each(row.switch_words, take);
      refuse("true");
    }
    else if constexpr (std::is_arithmetic_v<Value>) {
      const scene::ShownLimits limits = scene::shown_limits(row, std::is_integral_v<Value>);
      // --samples 0 needs --time-limit.
      const bool takes_zero = !row.zero.empty() && row.option != "samples";
      take(number_text(limits.max));
      // Rows with the same option have other limits.
      if (row.option != "shadow-size") {
        take(number_text(limits.min));
        EXPECT_NE(help.find(fmt::format("in [{:.10g} - {:.10g}]", limits.min, limits.max)), std::string::npos)
            << option;
        if (!takes_zero || limits.min != 1.0) {
          refuse(number_text(limits.min - 1.0));
        }
        refuse(number_text(limits.max + std::max(1.0, 0.01 * limits.max)));
      }
      refuse("nan");
      if (takes_zero) {
        take("0");
      }
      if (!row.automatic.empty()) {
        take(row.automatic);
      }
    }
  });
  for (std::size_t i = 0;; i++) {
    std::vector<std::string> arguments;
    for (const auto &[option, values] : right) {
      if (i < values.size()) {
        arguments.push_back(option + ' ' + values[i]);
      }
    }
    if (arguments.empty()) {
      break;
    }
    const test::Finished finished = run(render + fmt::format("{}", fmt::join(arguments, " ")));
    EXPECT_EQ(finished.status, 1) << fmt::format("{}\n", fmt::join(arguments, "\n")) << finished.err;
  }
}

TEST_F(CliSettings, OptionsHaveHeadersAndEachExclusionIsASentenceThatFailuresRepeat)
{
  const std::string help = run("render --help").out;
  for (const char *group : {"Picture:", "Shadows:", "Scene:", "Animation:", "Parts of a picture:",
                            "Choice of samples and shadows:", "Reports and measurement:"}) {
    EXPECT_NE(help.find("\n" + std::string(group) + '\n'), std::string::npos) << group;
  }
  EXPECT_EQ(help.find("Excludes:"), std::string::npos);
  for (const char *options :
       {"--max-error 0.1 --max-time 3", "--max-error 0.1 --samples 4", "--max-time 3 --pcf 5x5",
        "--max-error 0.1 --cube-pass best", "--max-time 3 --debug cascades", "--time-limit 1 --tile 1/2",
        "--time-limit 1 --sample-range 0-1", "--frames 1-2 --repeat 2", "--debug cascades --aov depth"}) {
    const test::Finished finished = run(std::string("render missing.glb -o out#.exr ") + options);
    EXPECT_EQ(finished.status, 2) << options;
    const std::size_t sentence = finished.err.find("were given. ");
    ASSERT_NE(sentence, std::string::npos) << finished.err;
    const std::string text = finished.err.substr(sentence + 12, finished.err.find('\n') - sentence - 12);
    EXPECT_NE(help.find("\n  " + text), std::string::npos) << text;
  }
}

TEST_F(CliSettings, AReportHasThePicturesSettingsByTheirNames)
{
  const test::Finished finished =
      run("render '" GNOMON_SOURCE
          "/examples/scenes/plaza.glb' --backend null --size 16x8 --samples 3 --json out.json "
          "--shadow-size 100 --pcf disk:7 --specular multi --seed 5 --exposure 1.5 --emissive-points auto "
          "--cascade-range depth --shadow-memory 3 --view raw");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const nlohmann::json settings = nlohmann::json::parse(read("out.json")).at("settings");
  for_each_setting([&](const auto &row) { EXPECT_TRUE(settings.contains(std::string(row.name))) << row.name; });
  const nlohmann::json expected = {{"sample_count", 3},
                                   {"cube_size_px", 100},
                                   {"map_size_px", 100},
                                   {"esm_size_px", 100},
                                   {"pcf", "disk:7"},
                                   {"has_multiscatter", true},
                                   {"seed", 5},
                                   {"exposure", 1.5},
                                   {"is_fitted_to_depth", true},
                                   {"shadow_bytes_max", 3 << 20},
                                   {"view_transform", "raw"},
                                   {"shadow_kind", "hard"},
                                   {"shadow_exponent", nullptr},
                                   {"emissive_point_count", nullptr},
                                   {"background", nullptr},
                                   {"can_resize_cascades", false}};
  for (const auto &[name, value] : expected.items()) {
    EXPECT_EQ(settings.at(name), value) << name;
  }
}

TEST_F(CliSettings, OneOptionSetsTheSizesOfAllShadowsAsFarAsTheirLimitsAllow)
{
  for (const int size : {0, 16385}) {
    EXPECT_EQ(run(fmt::format("render missing.glb -o out.exr --shadow-size {}", size)).status, 2) << size;
  }
  for (const auto &[size, layer] : {std::pair(1, 4), {16384, 8192}}) {
    const test::Finished finished =
        run(fmt::format("render '{}/examples/scenes/plaza.glb' --backend null --size 16x8 --json out.json "
                        "--shadow-size {}",
                        GNOMON_SOURCE, size));
    ASSERT_EQ(finished.status, 0) << finished.err;
    const nlohmann::json settings = nlohmann::json::parse(read("out.json")).at("settings");
    EXPECT_EQ(settings.at("cube_size_px"), size);
    EXPECT_EQ(settings.at("map_size_px"), size);
    EXPECT_EQ(settings.at("esm_size_px"), layer);
  }
}

}  // namespace
}  // namespace gnomon::cli
