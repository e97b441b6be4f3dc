// SPDX-License-Identifier: MIT
#include "cli_output.hh"
#include "cli_picture.hh"
#include "cli_process.hh"
#include "output_file.hh"

#include <nlohmann/json.hpp>

#include <sys/stat.h>
#include <array>
#include <csignal>
#include <cstring>
#include <map>
#include <sstream>

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
  const std::string plan = " --size 16x16 --samples 1 --seconds-per-frame 1 ";
  ASSERT_EQ(run("plan s.glb" + plan + "--pictures p.exr -o p.json").status, 0);
  fs::copy_file(folder / "s.glb", folder / "a.glb");
  const auto content = [&] {
    std::string all;
    for (const char *name : {"s.glb", "a.exr", "b.exr", "m.gltf", "m.bin", "i m.png", "m.surface.glsl", "p.json"}) {
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
           std::string("render a.glb m.gltf --size 16x16 --samples 1 -o '{scene}.exr'"),
           std::string("render --part p.json:0 --json p.json"),
           std::string("render --part p.json:0 --trace here/p.json"),
           "plan m.gltf" + plan + "-o m.bin",
           "plan m.gltf" + plan + "-o 'i m.png'",
           "plan m.gltf" + plan + "-o a.exr",
           "plan m.gltf" + plan + "--pictures a.exr -o o.json",
           "plan s.glb" + plan + "--world b.exr -o b.exr",
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

class SlowOutputsTest : public OutputsTest {
 protected:
  /** Runs the program under faults of the system: \a variables of faults_module.cc */
  Finished run_faulty(const std::string &command, const std::string &variables)
  {
    return run(command, "/usr/bin/env' LD_PRELOAD='" GNOMON_FAULTS "' " + variables + " '" GNOMON_PROGRAM);
  }
  [[nodiscard]] bool is_whole(const std::string &name, const std::string &right) const
  {
    // Reports have times.
    return right.empty() ? nlohmann::json::accept(read(name)) : read(name) == right;
  }
  void fail_each_call(bool is_killed);
};

/** Each call that writes an output fails once. The last run of each call has no failure, and is the next picture. */
void SlowOutputsTest::fail_each_call(bool is_killed)
{
  for (const auto &[command, name] : commands()) {
    ASSERT_EQ(run(named(command, name)).status, 0) << command;
    const std::string right = name == "o.json" || name == "o.trace" ? "" : read(name);
    ASSERT_TRUE(is_whole(name, right));
    const std::size_t count = file_count();
    for (const std::string call : {"fwrite", "fflush", "fsync", "linkat", "rename"}) {
      int failure_count = 0;
      // A header of EXR is written by some hundred calls.
      for (int at = 1;; at = call == "fwrite" ? 4 * at : at + 1) {
        write(name, "old");
        const std::string fault = call + ':' + std::to_string(at);
        SCOPED_TRACE(command + ' ' + fault);
        const Finished finished =
            run_faulty(named(command, name), "GNOMON_FAULT=" + fault + (is_killed ? " GNOMON_FAULT_KILLS=1" : ""));
        if (finished.status == 0) {
          EXPECT_TRUE(is_whole(name, right));
          break;
        }
        failure_count++;
        // After the rename, the folder is flushed.
        EXPECT_TRUE(read(name) == "old" || (call == "fsync" && is_whole(name, right)));
        EXPECT_EQ(finished.status, is_killed ? -SIGKILL : 5);
        const std::string message = "gnomon: " + name + ": cannot be written: No space left on device";
        EXPECT_EQ(finished.err.find(message) != std::string::npos, !is_killed) << finished.err;
        // A process that is killed between naming its file and renaming it leaves that name.
        EXPECT_EQ(file_count(), count + (is_killed && call == "rename" ? 1 : 0));
        output::remove_unfinished(folder, {name});
        EXPECT_EQ(file_count(), count);
      }
      EXPECT_GT(failure_count, 0) << command << ' ' << call;
    }
    fs::remove(folder / name);
  }
}

TEST_F(SlowOutputsTest, AreOldOrWholeWhicheverWriteFails)
{
  fail_each_call(false);
}

TEST_F(SlowOutputsTest, AreOldOrWholeWhereverTheProcessIsKilled)
{
  fail_each_call(true);
}

/** The environment of a process changes no picture and gives no message. */
TEST_F(SlowOutputsTest, AreThoseOfAnyHomeClockAndExtensions)
{
  const std::string command = "render '" GNOMON_SOURCE "/examples/scenes/plaza.glb' --size 48x27 --samples 2 ";
  const std::string timed = "--stop-after 1000 --time-limit 1000 --repeat 2 --json o.json";
  std::map<std::string, std::string> right;
  const auto expect_right = [&](const std::string &variables, const std::string &options = "") {
    if (!right.contains(options)) {
      EXPECT_EQ(run(command + "-o o.exr " + options).status, 0);
      right[options] = read("o.exr");
    }
    fs::remove(folder / "o.exr");
    const Finished finished = run_faulty(command + "-o o.exr " + options, variables);
    EXPECT_EQ(finished.status, 0) << variables;
    // Mesa may say that it has no cache.
    EXPECT_EQ(finished.err.find("gnomon"), std::string::npos) << variables << ": " << finished.err;
    EXPECT_TRUE(read("o.exr") == right[options]) << variables;
  };
  // Nobody can create a file there, not even root.
  expect_right("XDG_CACHE_HOME= HOME=/proc");
  expect_right("XDG_CACHE_HOME= HOME=/sys");
  expect_right("XDG_CACHE_HOME= HOME=");
  expect_right("GNOMON_FAULT_CLOCK=1", timed);
  const nlohmann::json report = nlohmann::json::parse(read("o.json"));
  for (const nlohmann::json &seconds : report["frame_seconds"]) {
    EXPECT_GT(seconds, 0.0);
    EXPECT_LT(seconds, 1000.0);
  }
  // An older driver, which has an extension or not. Drivers other than Mesa's ignore the variables.
  std::string all;
  std::istringstream names(GNOMON_OPTIONAL_EXTENSIONS);
  for (std::string name; names >> name;) {
    all += "-" + name + ' ';
    expect_right("MESA_GL_VERSION_OVERRIDE=4.5 MESA_EXTENSION_OVERRIDE=-" + name, "--backend gl");
  }
  ASSERT_FALSE(all.empty());
  expect_right("MESA_GL_VERSION_OVERRIDE=4.5 MESA_EXTENSION_OVERRIDE='" + all + "'", "--backend gl");
}

TEST_F(SlowOutputsTest, OfProcessesThatShareTheirCachesAreThoseOfEachAlone)
{
  const std::string command = "render s.glb --size 16x16 --samples 1 -o ";
  ASSERT_EQ(run(command + "o.exr").status, 0);
  const std::string right = read("o.exr");
  const std::string check = "shaders check --program eevee_depth --cache checks";
  const std::string together = "export XDG_CACHE_HOME=$PWD/cache; for i in 1 2 3 4; do \"$0\" " + command +
                               "$i.exr & \"$0\" " + check + " & done; wait";
  for (int round = 0; round < 3; round++) {
    const Finished finished = run("", "/bin/sh' -c '" + together + "' '" GNOMON_PROGRAM);
    EXPECT_EQ(finished.err, "");
    for (const char *name : {"1.exr", "2.exr", "3.exr", "4.exr"}) {
      EXPECT_TRUE(read(name) == right) << name << " in round " << round;
      fs::remove(folder / name);
    }
    const std::string clean = "0 errors, 0 warnings";
    for (std::size_t i = 0, at = 0; i < 4; i++, at += clean.size()) {
      at = finished.out.find(clean, at);
      ASSERT_NE(at, std::string::npos) << finished.out;
    }
    // The first round fills the caches, the next one finds files that are cut off.
    for (const char *cache : {"cache", "checks"}) {
      ASSERT_TRUE(fs::exists(folder / cache));
      for (const auto &entry : fs::recursive_directory_iterator(folder / cache)) {
        if (round == 0 && entry.is_regular_file()) {
          fs::resize_file(entry.path(), entry.file_size() / 2);
        }
      }
    }
  }
}

}  // namespace
}  // namespace gnomon
