// SPDX-License-Identifier: MIT
#include "cli_output.hh"
#include "cli_picture.hh"
#include "cli_process.hh"

#include <nlohmann/json.hpp>

#include <sys/stat.h>
#include <array>
#include <cstring>

namespace gnomon {
namespace {

namespace fs = std::filesystem;
using test::Finished;

/** Outputs of the program, of all kinds. */
class OutputsTest : public test::ProgramTest {
 protected:
  OutputsTest()
  {
    fs::copy(GNOMON_SOURCE "/examples/scenes/spots.glb", folder / "s.glb");
    cli::write_exr(folder / "a.exr", {8, 8}, std::vector<float>(256, 0.5F), {});
    cli::write_exr(folder / "b.exr", {8, 8}, std::vector<float>(256, 0.25F), {});
  }
  /** Commands whose output has the name NAME. */
  static std::vector<std::pair<std::string, std::string>> commands()
  {
    const std::string render = "render s.glb --size 16x16 --samples 1 ";
    return {{render + "-o NAME", "o.exr"},
            {render + "-o NAME --aov normal", "o.exr"},
            {render + "-o NAME", "o.png"},
            {render + "-o NAME --tile 1/2", "o.exr"},
            {render + "--backend null --json NAME", "o.json"},
            {render + "--backend null --trace NAME", "o.trace"},
            {"compare a.exr b.exr --json NAME", "o.json"},
            {"compare a.exr b.exr --difference NAME", "o.exr"},
            {"compare a.exr b.exr --difference NAME", "o.png"},
            {"merge a.exr -o NAME", "o.exr"},
            {"bench cull --count-max 1000 --rounds 1 --json NAME", "o.json"}};
  }
  static std::string named(std::string command, const std::string &name)
  {
    return command.replace(command.find("NAME"), std::strlen("NAME"), name);
  }
};

TEST_F(OutputsTest, AnOutputThatCannotBeWrittenIsNamedAndTheOldFileStays)
{
  for (const auto &[command, name] : commands()) {
    write(name, "old");
    const std::size_t count = file_count();
    // No byte of a regular file can be written. Messages go through a pipe.
    const Finished finished = run(named(command, name),
                                  "/bin/sh' -c 'm=$(ulimit -f 0; \"$0\" \"$@\" 2>&1 >/dev/null); s=$?; echo \"$m\" "
                                  ">&2; exit $s' '" GNOMON_PROGRAM);
    EXPECT_EQ(finished.status, 1) << command;
    EXPECT_NE(finished.err.find("gnomon: " + name + ": cannot be written: "), std::string::npos)
        << command << ": " << finished.err;
    EXPECT_EQ(read(name), "old") << command;
    EXPECT_EQ(file_count(), count) << command;
    fs::remove(folder / name);
  }
}

TEST_F(OutputsTest, OutputsGoThroughLinksToPipesAndDevices)
{
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0666), 0);
  for (const auto &[command, name] : commands()) {
    fs::create_symlink("fifo", folder / name);
    write("reader", "");
    const Finished finished =
        run(named(command, name),
            "/bin/sh' -c 'cat fifo > reader & timeout 60 \"$0\" \"$@\"; s=$?; wait; exit $s' '" GNOMON_PROGRAM);
    EXPECT_EQ(finished.status, 0) << command << ": " << finished.err;
    EXPECT_TRUE(fs::is_fifo(folder / name)) << command;
    const std::string content = read("reader");
    fs::remove(folder / name);
    fs::create_symlink("target", folder / name);
    EXPECT_EQ(run(named(command, name)).status, 0) << command;
    EXPECT_TRUE(fs::is_symlink(folder / name)) << command;
    EXPECT_FALSE(read("target").empty()) << command;
    // Reports have times.
    if (name != "o.json" && name != "o.trace") {
      EXPECT_TRUE(content == read("target")) << command;
    }
    EXPECT_EQ(content.empty(), false) << command;
    fs::remove(folder / name);
    fs::create_symlink("/dev/full", folder / name);
    const Finished full = run(named(command, name));
    EXPECT_EQ(full.status, 5) << command;
    EXPECT_NE(full.err.find(name + ": cannot be written: No space left on device"), std::string::npos) << full.err;
    fs::remove(folder / name);
    fs::remove(folder / "target");
  }
}

TEST_F(OutputsTest, TextIsNotMixedWithAnOutputOnStandardOutput)
{
  for (const auto &[command, name] : commands()) {
    fs::create_symlink("/dev/stdout", folder / name);
    const Finished finished = run(named(command, name) + " | cat > piped; true");
    EXPECT_EQ(finished.status, 0) << finished.err;
    const std::string piped = read("piped");
    fs::remove(folder / name);
    if (name == "o.json" || name == "o.trace") {
      EXPECT_TRUE(nlohmann::json::accept(piped)) << command << ": " << piped.substr(0, 200);
      continue;
    }
    ASSERT_EQ(run(named(command, name)).status, 0) << command;
    EXPECT_TRUE(piped == read(name)) << command << ": " << piped.size();
    fs::remove(folder / name);
  }
}

TEST_F(OutputsTest, AnInputOrAnotherOutputIsNotReplaced)
{
  // A scene whose file names a buffer, an image, a surface function and a world.
  write("m.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"uri":"m.bin","byteLength":36}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"images":[{"uri":"i%20m.png"}],"textures":[{"source":0}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,0,-1],"max":[1,0,1]}],
    "materials":[{"extras":{"gnomon_surface":"m.surface.glsl"}},
      {"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
    "nodes":[{"mesh":0}],"scenes":[{"nodes":[0],"extras":{"gnomon_world":"a.exr"}}],"scene":0})");
  const std::array<float, 9> triangle{-1, 0, -1, 1, 0, -1, 0, 0, 1};
  write("m.bin", std::string(reinterpret_cast<const char *>(triangle.data()), sizeof(triangle)));
  write("i m.png", "no picture");
  write("m.surface.glsl", "void surface(inout Surface surface) {}");
  fs::create_hard_link(folder / "m.bin", folder / "hard.json");
  fs::create_symlink("s.glb", folder / "link.json");
  fs::create_symlink(".", folder / "here");
  fs::create_symlink("later.exr", folder / "f3.exr");
  fs::create_directory(folder / "report");
  fs::create_symlink("../s.glb", folder / "report" / "report.csv");
  fs::create_directory(folder / "stability");
  fs::create_symlink("index.html", folder / "stability" / "stability.csv");
  const std::string render = "render s.glb --size 16x16 --samples 1 ";
  const std::string render_m = "render m.gltf --size 16x16 --samples 1 ";
  const auto content = [&] {
    std::string all;
    for (const char *name : {"s.glb", "a.exr", "b.exr", "m.gltf", "m.bin", "i m.png", "m.surface.glsl"}) {
      all += read(name);
    }
    return all;
  };
  const std::string before = content();
  for (const std::string &command : {
           render + "-o o.exr --json s.glb",
           render + "-o o.exr --trace s.glb",
           render + "-o o.exr --json " + (folder / "s.glb").string(),
           render + "-o o.exr --json here/./here/s.glb",
           render + "-o o.exr --trace link.json",
           render + "-o o.exr --json o.exr",
           render + "-o o.exr --json r --trace ./r",
           render + "-o o.exr --json here/o.exr",
           render + "-o b.exr --world b.exr",
           render + "-o o#.exr --frames 0-9 --json o7.exr",
           render + "-o f#.exr --frames 2-4 --trace later.exr",
           render_m + "-o o.exr --json m.bin",
           render_m + "-o o.exr --json hard.json",
           render_m + "-o 'i m.png'",
           render_m + "-o o.exr --trace m.surface.glsl",
           render_m + "-o a.exr",
           std::string("compare a.exr b.exr --difference a.exr"),
           std::string("compare a.exr b.exr --difference here/b.exr"),
           std::string("compare a.exr b.exr --json b.exr"),
           std::string("compare a.exr b.exr --difference d.exr --json d.exr"),
           std::string("merge a.exr -o a.exr"),
           std::string("merge a.exr -o here/a.exr"),
           std::string("report s.glb -o report"),
           std::string("stability -o stability --group space"),
           std::string("bench memory s.glb --json s.glb"),
           std::string("bench start s.glb --json link.json"),
       }) {
    const Finished finished = run(command);
    EXPECT_EQ(finished.status, 2) << command << ": " << finished.err;
    EXPECT_TRUE(content() == before) << command;
    EXPECT_FALSE(fs::exists(folder / "o.exr")) << command;
    EXPECT_TRUE(finished.err.find("would replace") != std::string::npos ||
                finished.err.find("is the same file as") != std::string::npos)
        << command << ": " << finished.err;
  }
  EXPECT_EQ(run(render + "-o o.exr --json /dev/null --trace /dev/null").status, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(OutputsTest, AFullOrClosedStandardOutputIsAFailure)
{
  for (const std::string command :
       {"--version", "--help", "info s.glb", "render --help", "shaders list", "shaders check --program eevee_depth",
        "shaders reflect eevee_depth", "compare a.exr b.exr", "merge a.exr -o m.exr",
        "render s.glb -o o.exr --size 16x16 --samples 1", "stability -o f --group space"}) {
    for (const std::string stdout_of : {">/dev/full", ">&-"}) {
      const Finished finished = run(command, "/bin/sh' -c '\"$0\" \"$@\" " + stdout_of + "' '" GNOMON_PROGRAM);
      EXPECT_EQ(finished.status, 1) << command << stdout_of << finished.err;
      EXPECT_NE(finished.err.find("gnomon: standard output: cannot be written"), std::string::npos)
          << command << stdout_of << finished.err;
    }
  }
  // A closed stream does not take the place of a file that is opened later.
  EXPECT_EQ(
      run("compare a.exr b.exr --difference d.exr", "/bin/sh' -c '\"$0\" \"$@\" <&- >&- 2>&-' '" GNOMON_PROGRAM).status,
      1);
  EXPECT_EQ(cli::read_picture(folder / "d.exr").size_px, glm::ivec2(8, 8));
  // Messages that are lost do not end the work.
  EXPECT_EQ(run("compare a.exr b.exr --max-rmse 0", "/bin/sh' -c '\"$0\" \"$@\" 2>/dev/full' '" GNOMON_PROGRAM).status,
            1);
  EXPECT_EQ(run("info s.glb", "/bin/sh' -c '\"$0\" \"$@\" 2>/dev/full' '" GNOMON_PROGRAM).status, 0);
}

TEST_F(OutputsTest, PermissionsOfAnExistingFileStay)
{
  write("o.exr", "old");
  fs::permissions(folder / "o.exr", fs::perms(0604));
  ASSERT_EQ(run("render s.glb -o o.exr --size 16x16 --samples 1").status, 0);
  EXPECT_EQ(unsigned(fs::status(folder / "o.exr").permissions()), 0604U);
}

}  // namespace
}  // namespace gnomon
