// SPDX-License-Identifier: MIT
// `gnomon shaders check FILES`: what the program adds to check_program: names of files, outputs, processes, the cache.
#include "cli_process.hh"
#include "cli_workers.hh"
#include "shader_check.hh"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <thread>

namespace gnomon {
namespace {

using test::Finished;

class ShaderFilesTest : public test::ProgramTest {
 protected:
  Finished check(const std::string &arguments)
  {
    return run("shaders check " + arguments);
  }
  void write_file(const std::string &path, const std::string &text)
  {
    std::filesystem::create_directories((folder / path).parent_path());
    write(path, text);
  }
};

const std::string fragment_head = "#version 450\nlayout(location = 0) out vec4 c;\n";

TEST_F(ShaderFilesTest, AFileOfAnotherKindIsAnErrorOfThatFileAlone)
{
  write("good.frag", fragment_head + "void main() { c = vec4(1); }\n");
  write("bad.comp", "#version 450\nvoid main() { oops; }\n");
  write("scene.hlsl", "float4 main() : SV_Target { return 1; }\n");
  write("notes.glsl", "float f;\n");
  std::filesystem::create_directory(folder / "folder.vert");
  const Finished finished = check("good.frag scene.hlsl notes.glsl missing.rgen folder.vert bad.comp");
  EXPECT_EQ(finished.status, 1);
  for (const std::string line :
       {"scene.hlsl:1: error: HLSL is not checked [stage]", "notes.glsl:1: error: its name ends in none of",
        "missing.rgen:1: error: there is no such regular file", "folder.vert:1: error: there is no such regular file",
        "bad.comp:2: error: 'oops'", "4 programs, 4 variants"}) {
    EXPECT_NE(finished.out.find(line), std::string::npos) << line << " is not in:\n" << finished.out;
  }
  EXPECT_EQ(finished.out.find("good.frag:"), std::string::npos) << finished.out;
}

TEST_F(ShaderFilesTest, StagesBetweenThatLieBesideBelongToTheProgram)
{
  for (const auto &[before, after] : {std::pair("p.", ""), std::pair("p.", ".glsl"), std::pair("p_", ".glsl")}) {
    const auto path = [start = before, end = after](const std::string &stage) { return start + stage + end; };
    write(path("vert"), "#version 450\nvoid main() { gl_Position = vec4(0); }\n");
    write(path("geom"),
          "#version 450\nlayout(points) in;\nlayout(points, max_vertices = 1) out;\n"
          "layout(location = 3) out vec3 n;\nvoid main() { n = vec3(1); EmitVertex(); }\n");
    write(path("frag"), fragment_head + "layout(location = 3) in vec3 n;\nvoid main() { c = vec4(n, 1); }\n");
    EXPECT_EQ(check(path("frag") + " " + path("vert")).status, 0) << path("geom");
    EXPECT_EQ(check(path("vert") + " " + path("geom") + " " + path("frag")).status, 0);
    std::filesystem::remove(folder / path("geom"));
    EXPECT_EQ(check(path("vert") + " " + path("frag")).status, 1) << "no stage writes the input";
  }
}

TEST_F(ShaderFilesTest, AnySubsetOfAProgramsStagesIsRight)
{
  const std::vector<std::pair<std::string, std::string>> files = {
      {"q.vert", "layout(location = 0) out vec3 a;\nvoid main() { a = vec3(1); gl_Position = vec4(a, 1); }\n"},
      {"q_tesc.glsl",
       "layout(vertices = 3) out;\nlayout(location = 0) in vec3 a[];\nlayout(location = 1) out vec3 b[];\n"
       "void main() { b[gl_InvocationID] = a[gl_InvocationID]; }\n"},
      {"q.tese",
       "layout(triangles) in;\nlayout(location = 1) in vec3 b[];\nlayout(location = 2) out vec3 d;\n"
       "void main() { d = b[0]; gl_Position = vec4(d, 1); }\n"},
      {"q.geom.glsl",
       "layout(triangles) in;\nlayout(triangle_strip, max_vertices = 3) out;\nlayout(location = 2) in vec3 d[];\n"
       "layout(location = 3) out vec3 e;\nvoid main() { e = d[0]; EmitVertex(); }\n"},
      {"q.frag",
       "layout(location = 3) in vec3 e;\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(e, 1); }\n"}};
  for (const auto &[path, text] : files) {
    write(path, "#version 450\n" + text);
  }
  for (unsigned int subset = 1; subset < 1U << files.size(); subset++) {
    std::string paths;
    for (std::size_t i = 0; i < files.size(); i++) {
      paths += (subset & 1U << i) != 0 ? files[i].first + " " : "";
    }
    const Finished finished = check(paths + "--target vulkan");
    EXPECT_EQ(finished.status, 0) << paths << finished.out;
    EXPECT_NE(finished.out.find(": 0 errors, 0 warnings"), std::string::npos) << paths << finished.out;
  }
  std::filesystem::remove(folder / "q.tese");
  EXPECT_EQ(check("q_tesc.glsl q.frag --target vulkan").status, 0) << "they are not linked across a gap";
}

TEST_F(ShaderFilesTest, TheLastDefinitionOfAMacroIsTheOneThatCounts)
{
  write("n.frag", fragment_head + "#if N != 2\noops\n#endif\nvoid main() { c = vec4(N); }\n");
  EXPECT_EQ(check("n.frag -D N=2").status, 0);
  const Finished twice = check("n.frag -D N=1 -D N=2");
  EXPECT_EQ(twice.status, 0) << twice.out;
  EXPECT_EQ(check("n.frag -D N=2 -D N=1").status, 1);
  write(
      "m.json",
      R"({"defines": ["N=1"], "programs": [{"files": ["n.frag"], "defines": ["N=3"], "permutations": {"N": [4, 5]}}]})");
  EXPECT_EQ(check("--manifest m.json -D N=2").status, 0);
  const Finished wrong = check("n.frag -D N=2 -D 'A(x,x)=1'");
  EXPECT_EQ(wrong.out.find("n.frag:1: error: '#define A(x,x) 1': "), 0U) << wrong.out;
}

TEST_F(ShaderFilesTest, OutputIsJsonOrSarifWhateverTheCompilerPrints)
{
  // glslang prints about old versions to stdout. Names and texts may be no UTF-8.
  write("old.frag", "#version 110\nvoid main() { gl_FragColor = oops; }\n");
  write("latin.frag", "#version 450\n#error gr\xFC\xDF\"e\\\n// \xFF\nvoid main() { }\n");
  write("empty.frag", "");
  write("binary.frag", std::string("\0\x01\x02\xFF#version\n", 13));
  for (const std::string target : {"auto", "opengl", "opengl-spirv", "es", "vulkan", "vulkan1.0", "all"}) {
    for (const std::string format : {"json", "sarif"}) {
      const Finished finished =
          check("old.frag latin.frag empty.frag binary.frag --format " + format + " --target " + target);
      EXPECT_EQ(finished.status, 1) << finished.err;
      EXPECT_TRUE(nlohmann::json::accept(finished.out)) << format << target << finished.out;
    }
  }
}

TEST_F(ShaderFilesTest, AProgramThatTakesTooLongIsEndedAndOthersAreChecked)
{
  std::string macros = "#define A0 1.0 +\n";
  for (int i = 1; i < 40; i++) {
    macros += "#define A" + std::to_string(i) + " A" + std::to_string(i - 1) + " A" + std::to_string(i - 1) + "\n";
  }
  write("endless.frag", fragment_head + macros + "void main() { c = vec4(A39 1.0); }\n");
  write("good.frag", fragment_head + "void main() { c = vec4(1); }\n");
  write("bad.frag", fragment_head + "void main() { c = oops; }\n");
  const auto start = std::chrono::steady_clock::now();
  const Finished finished = check("endless.frag good.frag bad.frag --time-limit 3");
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 60.0);
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.out.find("endless.frag:1: error: the check of this program takes more than "), std::string::npos)
      << finished.out;
  EXPECT_NE(finished.out.find("[limit]"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("bad.frag:3: error: 'oops'"), std::string::npos) << finished.out;
  EXPECT_EQ(check("good.frag --time-limit 0").status, 2);
}

TEST_F(ShaderFilesTest, AMistakeBehindWhichTheCompilerCrashesHasItsLine)
{
  write("crash.frag",
        "#version 450\n#extension GL_EXT_buffer_reference : require\nlayout(buffer_reference) buffer Ref { int v; };\n"
        "layout(location = 0) out vec4 c;\nvoid main() { c = vec4(Ref(uvec2(0)).v); }\n");
  write("bad.frag", fragment_head + "void main() { c = oops; c = again; }\n");
  const Finished finished = check("crash.frag bad.frag --target vulkan1.2");
  EXPECT_EQ(finished.status, 1);
  for (const std::string line : {"crash.frag:5: error: ", "bad.frag:3: error: 'oops'", "bad.frag:3: error: 'again'"}) {
    EXPECT_NE(finished.out.find(line), std::string::npos) << line << " is not in:\n" << finished.out;
  }
  EXPECT_EQ(finished.out.find("[limit]"), std::string::npos) << finished.out;
}

TEST_F(ShaderFilesTest, AFileThatIsGivenTwiceIsCheckedOnce)
{
  write("bad.frag", fragment_head + "void main() { c = oops; }\n");
  EXPECT_NE(check("bad.frag ./bad.frag").out.find("1 programs, 1 variants"), std::string::npos);
  const Finished missing = check("missing.frag");
  EXPECT_EQ(missing.out.find("has no version"), std::string::npos) << missing.out;
}

TEST(Workers, TheLimitIsOfCpuTime)
{
  cli::WorkLimits limits;
  limits.seconds = 0.25;
  const std::vector<cli::WorkResult> results = cli::run_in_workers(
      2, limits,
      [](std::size_t index) {
        if (index == 0) {
          // A waiting job uses no CPU time, as on a machine that is busy with other work.
          std::this_thread::sleep_for(std::chrono::milliseconds(600));
          return std::string("done");
        }
        for (std::atomic<int> turns = 0;; turns++) {
        }
      },
      [](std::size_t) {});
  EXPECT_EQ(results[0].bytes, "done") << results[0].failure;
  EXPECT_EQ(results[1].failure, "takes more than 0.25 s, the limit of --time-limit");
}

TEST_F(ShaderFilesTest, OtherEndingsAndLinkedFoldersAreRead)
{
  const std::string vertex = "layout(location = 0) out vec3 n;\nvoid main() { n = vec3(1); gl_Position = vec4(0); }\n";
  const std::string fragment = "layout(location = 0) in vec3 n;\nvoid main() { c = vec4(n, oops); }\n";
  for (const auto &[first, second] :
       {std::pair("p.vs", "p.fs"), {"p.vsh", "p.fsh"}, {"p_vs.glsl", "p_fs.glsl"}, {"p.vs.glsl", "p.frag"}}) {
    write(first, "#version 450\n" + vertex);
    write(second, fragment_head + fragment);
    const Finished finished = check(std::string(first) + " " + second);
    EXPECT_EQ(finished.out.find(std::string(second) + ":4: error: 'oops'"), 0U) << finished.out << finished.err;
    EXPECT_NE(finished.out.find("1 programs, 1 variants"), std::string::npos) << finished.out;
    write("m.json",
          std::string(R"({"programs": [{"files": [")") + first + R"(", {"path": "any.glsl", "stage": "frag"}]}]})");
    write("any.glsl", fragment_head + fragment);
    EXPECT_EQ(check("--manifest m.json").out.find("any.glsl:4: error: 'oops'"), 0U);
  }
  for (const std::string name : {"x.gs", "x.gsh", "x.cs", "x.csh", "x.tcs", "x.tes"}) {
    write(name, "oops\n");
    EXPECT_EQ(check(name + " --target opengl").out.find(name + ":1: error: "), 0U) << name;
  }
  write_file("real/sub/a.glsl", "#include \"../b.glsl\"\n");
  write_file("real/b.glsl", "float b() { return 1.0; }\n");
  write_file("project/s.frag", fragment_head + "#include \"common/a.glsl\"\nvoid main() { c = vec4(b()); }\n");
  std::filesystem::create_directory_symlink("../real/sub", folder / "project/common");
  const Finished linked = check("project/s.frag");
  EXPECT_EQ(linked.status, 0) << linked.out;
  std::filesystem::create_directory_symlink("project", folder / "link");
  write_file("real/sub/m.json", R"({"include_folders": ["../"], "programs": [{"files": ["../t.frag"]}]})");
  write_file("real/t.frag", fragment_head + "#include <b.glsl>\nvoid main() { c = vec4(b()); }\n");
  const Finished manifest = check("--manifest project/common/m.json");
  EXPECT_EQ(manifest.status, 0) << manifest.out << manifest.err;
}

TEST_F(ShaderFilesTest, SpirvIsWritten)
{
  write("a.vert", "#version 450\nvoid main() { gl_Position = vec4(0); }\n");
  write("a.frag", fragment_head + "void main() { c = vec4(1); }\n");
  const auto is_spirv = [&](const std::string &path) {
    return std::filesystem::exists(folder / path) && read(path).starts_with("\x03\x02\x23\x07");
  };
  EXPECT_EQ(check("a.frag -o one.spv").status, 0);
  EXPECT_TRUE(is_spirv("one.spv"));
  EXPECT_EQ(check("a.vert a.frag -o all").status, 0);
  EXPECT_TRUE(is_spirv("all/a.vert.spv") && is_spirv("all/a.frag.spv"));
  write("a.frag", "broken");
  EXPECT_EQ(check("a.frag -o broken.spv").status, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "broken.spv"));
  EXPECT_EQ(check("a.frag -o a.frag").status, 2) << "an input is not overwritten";
  EXPECT_EQ(read("a.frag"), "broken");
  EXPECT_EQ(check("a.vert -o x.spv --target all").status, 2);
  write("old.frag", "void main() { gl_FragColor = vec4(1); }\n");
  for (const std::string target : {"auto", "opengl", "es"}) {
    const Finished finished = check("old.frag -o old.spv --target " + target);
    EXPECT_EQ(finished.status, 1) << target;
    EXPECT_EQ(finished.out.find("old.frag:1: error: there is no SPIR-V for OpenGL "), 0U) << finished.out;
    EXPECT_FALSE(std::filesystem::exists(folder / "old.spv"));
  }
}

TEST_F(ShaderFilesTest, DepfileNamesWhatWasRead)
{
  write_file("in clude/b.glsl", "float b = 1.0;\n");
  write("a.frag",
        "#version 450\n#extension GL_GOOGLE_include_directive : require\n#include \"b.glsl\"\n"
        "layout(location = 0) out vec4 c;\nvoid main() { c = vec4(b); }\n");
  const std::string text = "a.spv: \\\n  a.frag \\\n  in\\ clude/b.glsl\n";
  const Finished finished = check("a.frag -I 'in clude' -MD -MF a.d -o a.spv");
  EXPECT_EQ(finished.status, 0) << finished.out << finished.err;
  EXPECT_EQ(read("a.d"), text);
  EXPECT_EQ(check("a.frag -I 'in clude' -MD -MF b.d -MT a.spv").status, 0);
  EXPECT_EQ(read("b.d"), text);
  EXPECT_EQ(check("a.frag -I 'in clude' --depfile c.d --depfile-target a.spv").status, 0);
  EXPECT_EQ(read("c.d"), text);
  EXPECT_EQ(check("a.frag -MF d.d").status, 2) << "no target";
  // Characters of make's own.
  write("c:d#e$f.frag", fragment_head + "void main() { c = vec4(1); }\n");
  EXPECT_EQ(check("'c:d#e$f.frag' -MF e.d -MT 'x:y.spv'").status, 0);
  EXPECT_EQ(read("e.d"), "x\\:y.spv: \\\n  c\\:d\\#e$$f.frag\n");
  EXPECT_EQ(check("a.frag -MD -o a.spv").status, 2) << "no depfile";
}

TEST_F(ShaderFilesTest, NoOutputReplacesAnInclude)
{
  const std::string text = "vec4 one() { return vec4(1); }\n";
  write_file("lib/one.glsl", text);
  write("a.frag", fragment_head + "#include \"one.glsl\"\nvoid main() { c = one(); }\n");
  write("m.json", R"({"include_folders": ["lib"], "programs": [{"files": ["a.frag"]}]})");
  std::filesystem::create_symlink("lib/one.glsl", folder / "link.spv");
  std::filesystem::create_hard_link(folder / "lib/one.glsl", folder / "hard.spv");
  for (const std::string arguments :
       {"a.frag -I lib -o lib/one.glsl", "a.frag -I lib -o ./lib/../lib/one.glsl", "a.frag -I lib -o link.spv",
        "a.frag -I lib -o hard.spv", "a.frag -I lib -o a.spv -MD -MF lib/one.glsl", "a.frag -I lib -MF link.spv -MT t",
        "--manifest m.json -MF lib/one.glsl -MT t", "a.frag -I lib --cache cache -o lib/one.glsl",
        "a.frag -I lib --cache cache -o lib/one.glsl"}) {
    const Finished finished = check(arguments + " --target vulkan");
    EXPECT_EQ(finished.status, 2) << arguments << finished.out;
    EXPECT_NE(finished.err.find("would replace an include"), std::string::npos) << arguments << finished.err;
    EXPECT_NE(finished.err.find("lib/one.glsl"), std::string::npos) << arguments << finished.err;
    EXPECT_EQ(read("lib/one.glsl"), text) << arguments;
    write("lib/one.glsl", text);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "a.spv")) << "another output is not written either";
}

TEST_F(ShaderFilesTest, CacheKnowsWhatTheResultDependsOn)
{
  write_file("lib/b.glsl", "float b = 1.0;\n");
  write("a.frag",
        "#version 450\n#extension GL_GOOGLE_include_directive : require\n#include \"b.glsl\"\n"
        "layout(binding = 0) uniform sampler2D t;\nlayout(location = 0) out vec4 c;\n"
        "#ifdef BAD\nbad\n#endif\nvoid main() { c = vec4(b); }\n");
  // Without the summary's time.
  const auto result = [&](const std::string &arguments) {
    const Finished finished = check("a.frag -I lib --cache cache " + arguments);
    return std::to_string(finished.status) + finished.out.substr(0, finished.out.rfind(" warnings, "));
  };
  const auto entries = [&] {
    const std::filesystem::directory_iterator begin(folder / "cache");
    return std::distance(begin, std::filesystem::directory_iterator());
  };
  const std::string first = result("");
  EXPECT_EQ(first.find("0a.frag:4: warning: texture 't'"), 0U) << first;
  EXPECT_EQ(entries(), 1);
  const std::filesystem::path entry = *std::filesystem::directory_iterator(folder / "cache");
  const auto time = std::filesystem::last_write_time(entry);
  EXPECT_EQ(result(""), first);
  EXPECT_EQ(std::filesystem::last_write_time(entry), time) << "it was read, not made again";
  EXPECT_EQ(entries(), 1);
  EXPECT_EQ(result("-D BAD")[0], '1');
  EXPECT_EQ(result("-Werror")[0], '1');
  EXPECT_EQ(result("-Wno-unused-binding").find("warning:"), std::string::npos);
  EXPECT_EQ(result("--target vulkan1.0")[0], '0');
  EXPECT_EQ(entries(), 5);
  EXPECT_EQ(result(""), first);
  write_file("lib/b.glsl", "oops\n");
  EXPECT_NE(result("").find("lib/b.glsl:"), std::string::npos) << "the include has changed";
  write_file("lib/b.glsl", "float b = 1.0;\n");
  EXPECT_EQ(result(""), first);
  write_file("lib/b.glsl", "float b = 1.0;\n#if 0\n#include \"d.glsl\"\n#endif\n");
  write("lib/d.glsl", "#extension GL_ARB_gl_spirv : enable\n");
  EXPECT_NE(result("").find("OpenGL 4.5"), std::string::npos) << result("");
  write("lib/d.glsl", "");
  EXPECT_EQ(result(""), first) << "an include that only chose the target has changed";
  write_file("lib/b.glsl", "float b = 1.0;\n");
  write("b.glsl", "oops\n");
  EXPECT_NE(result("").find("b.glsl:"), std::string::npos) << "a file now stands where none was";
  std::filesystem::remove(folder / "b.glsl");
  for (const auto &kept : std::filesystem::directory_iterator(folder / "cache")) {
    std::filesystem::resize_file(kept, std::filesystem::file_size(kept) / 2);
  }
  EXPECT_EQ(result(""), first) << "damaged entries are written again";
  const std::string name = "cache/" + entry.filename().string();
  const std::string whole = read(name);
  constexpr std::size_t place_count = 16;
  for (std::size_t i = 0; i < place_count; i++) {
    std::string damaged = whole;
    const std::size_t place = i * damaged.size() / place_count;
    damaged[place] = char(damaged[place] ^ 0x15);
    write_file(name, damaged);
    EXPECT_EQ(result(""), first) << "byte " << place << " is damaged";
  }
}

TEST_F(ShaderFilesTest, ACacheThatCannotBeUsedIsNamedOnce)
{
  write("a.frag", fragment_head + "void main() { c = vec4(1); }\n");
  write("b.frag", fragment_head + "void main() { c = vec4(1); }\n");
  for (const std::string cache : {"a.frag", "a.frag/cache", "/proc/cache"}) {
    const Finished finished = check("a.frag b.frag --cache " + cache);
    EXPECT_EQ(finished.status, 0) << finished.out;
    EXPECT_EQ(finished.err.find("warning: --cache keeps nothing: "), 0U) << cache << finished.err;
    EXPECT_EQ(finished.err.find("warning", 1), std::string::npos) << finished.err;
    EXPECT_NE(finished.err.find(cache), std::string::npos) << finished.err;
  }
}

TEST_F(ShaderFilesTest, CacheKnowsTheEnginesShaders)
{
  std::filesystem::copy(GNOMON_SOURCE "/shaders", folder / "tree", std::filesystem::copy_options::recursive);
  const std::string arguments = "--shaders tree --program eevee_film --cache cache";
  const Finished first = check(arguments);
  EXPECT_EQ(first.status, 0) << first.out;
  const auto newest = [&] {
    auto time = std::filesystem::file_time_type::min();
    for (const auto &entry : std::filesystem::directory_iterator(folder / "cache")) {
      time = std::max(time, std::filesystem::last_write_time(entry));
    }
    return time;
  };
  const auto time = newest();
  EXPECT_EQ(check(arguments).out.substr(0, 60), first.out.substr(0, 60));
  EXPECT_EQ(newest(), time) << "all were read";
  const std::string file = "tree/eevee/eevee_film_frag.glsl";
  ASSERT_TRUE(std::filesystem::exists(folder / file));
  write(file, read(file) + "\noops\n");
  const Finished edited = check(arguments);
  EXPECT_EQ(edited.status, 1);
  EXPECT_EQ(edited.out.find(file + ":"), 0U) << edited.out;
}

TEST_F(ShaderFilesTest, AManifestNamesProgramsPermutationsAndTargets)
{
  write_file("p/lib/common.glsl", "vec4 common_value() { return vec4(N); }\n");
  write_file("p/lit.vert", "#version 450\nvoid main() { gl_Position = vec4(0); }\n");
  write_file("p/other.frag", fragment_head +
                                 "#include \"common.glsl\"\n#if defined(FOG) && LIGHTS == 4\noops\n#endif\n"
                                 "void main() { c = common_value() * LIGHTS; }\n");
  write_file("p/shaders.json",
             R"({"include_folders": ["lib"], "defines": ["N=2"], "targets": ["vulkan1.0", "vulkan1.3"],
    "programs": [{"name": "lit", "files": ["lit.vert", "other.frag"], "permutations": {"FOG": [null, true], "LIGHTS": [1, 4, 8]}},
                 {"files": ["lit.vert"], "targets": ["opengl"]}]})");
  const Finished finished = check("--manifest p/shaders.json --format json -MF d -MT t");
  EXPECT_EQ(finished.status, 1) << finished.err;
  const nlohmann::json json = nlohmann::json::parse(finished.out);
  EXPECT_EQ(json["programs"], 2);
  EXPECT_EQ(json["variants"], 7);
  ASSERT_EQ(json["errors"], 1) << finished.out;
  EXPECT_EQ(json["messages"][0]["file"], "p/other.frag");
  ASSERT_EQ(json["messages"][0]["where"].size(), 2U) << "two targets of one permutation";
  EXPECT_EQ(json["messages"][0]["where"][0]["variant"], "N 2 FOG 1 LIGHTS 4");
  EXPECT_EQ(read("d"), "t: \\\n  p/shaders.json \\\n  p/lit.vert \\\n  p/other.frag \\\n  p/lib/common.glsl\n");
  EXPECT_EQ(check("--manifest p/shaders.json lit.vert").status, 2);
  EXPECT_EQ(check("--manifest p/shaders.json -o spirv").status, 2);
  EXPECT_EQ(check("--manifest p/none.json").status, 1);
}

TEST_F(ShaderFilesTest, AManifestIsReadAsItsSchemaSays)
{
  const nlohmann::json schema = nlohmann::json::parse(std::ifstream(GNOMON_SOURCE "/doc/shader-manifest.schema.json"));
  std::vector<std::string_view> stages;
  std::ranges::transform(shader_check::stage_names(), std::back_inserter(stages), &shader_check::StageName::ending);
  EXPECT_EQ(schema["$defs"]["file"]["oneOf"][1]["properties"]["stage"]["enum"], nlohmann::json(stages));
  write("lit.vert", "#version 450\nvoid main() { gl_Position = vec4(0); }\n");
  write("lit.frag", fragment_head + "void main() { c = vec4(1); }\n");
  write("blur.comp", "#version 450\nlayout(local_size_x = 1) in;\nvoid main() {}\n");
  for (const nlohmann::json &example : schema["examples"]) {
    write("m.json", example.dump());
    const Finished finished = check("--manifest m.json");
    EXPECT_EQ(finished.status, 0) << finished.out << finished.err;
  }
  const auto rejected = [&](const nlohmann::json &manifest, const std::string &place) {
    write("m.json", manifest.dump());
    const Finished finished = check("--manifest m.json");
    EXPECT_EQ(finished.status, 1) << manifest;
    EXPECT_NE(finished.err.find("m.json: " + place), std::string::npos) << manifest << finished.err;
    EXPECT_EQ(finished.out, "");
  };
  const nlohmann::json right = {{"programs", {{{"files", {"lit.vert"}}}}}};
  // Each property of the schema is known, and has another type than this.
  for (const auto &[key, value] : schema["properties"].items()) {
    nlohmann::json wrong = right;
    wrong[key] = 7;
    if (key != "$schema") {
      rejected(wrong, "/" + key);
    }
  }
  for (const auto &[key, value] : schema["properties"]["programs"]["items"]["properties"].items()) {
    nlohmann::json wrong = right;
    wrong["programs"][0][key] = 7;
    rejected(wrong, "/programs/0/" + key);
  }
  nlohmann::json wrong = right;
  wrong["program"] = 1;
  rejected(wrong, "the whole: 'program' is unknown");
  wrong = right;
  wrong["programs"][0]["targets"] = {"vulkan9"};
  rejected(wrong, "/programs/0/targets/0: 'vulkan9' is no target");
  wrong = right;
  wrong["features"] = {"nope"};
  rejected(wrong, "/features/0: 'nope' is no feature");
  wrong = right;
  wrong["programs"][0]["permutations"] = {{"1X", {1}}};
  rejected(wrong, "/programs/0/permutations/1X: '1X' is no name of a macro");
  wrong = right;
  wrong["programs"][0]["defines"] = {"1X=1"};
  rejected(wrong, "/programs/0/defines/0: NAME or NAME=VALUE is needed");
  wrong["programs"][0] = {{"files", {"lit.vert", "./lit.vert"}}};
  rejected(wrong, "/programs/0/files/1: the program has this file twice");
  wrong["programs"][0] = {{"files", {{{"path", "any.glsl"}, {"stage", "vertex"}}}}};
  rejected(wrong, "/programs/0/files/0/stage: 'vertex' is no stage; there are vert, ");
  wrong["programs"][0] = {{"files", {{{"path", "any.glsl"}, {"stage", "vert"}, {"entry", "main"}}}}};
  rejected(wrong, "/programs/0/files/0: 'entry' is unknown");
  wrong["programs"][0] = {{"files", {"any.glsl"}}};
  rejected(wrong, "/programs/0/files/0: its name gives no stage");
  std::vector<int> many(300);
  wrong["programs"][0] = {{"files", {"lit.vert"}}, {"permutations", {{"A", many}, {"B", many}}}};
  rejected(wrong, "/programs/0/permutations/B: the program has more than 65536 permutations");
  rejected(nlohmann::json::array(), "the whole: an object is needed");
  write("m.json", "{\"programs\":\n [}");
  EXPECT_NE(check("--manifest m.json").err.find("m.json:2: no JSON: "), std::string::npos);
  write("m.json", "");
  EXPECT_NE(check("--manifest m.json").err.find("m.json:1: no JSON: "), std::string::npos);
  for (const nlohmann::json &target : schema["$defs"]["target"]["enum"]) {
    nlohmann::json known = right;
    known["targets"] = nlohmann::json::array({target});
    write("m.json", known.dump());
    EXPECT_EQ(check("--manifest m.json").err, "") << target;
  }
}

TEST_F(ShaderFilesTest, NothingInAManifestIsLost)
{
  write("lit.vert", "#version 450\nvoid main() { gl_Position = vec4(0); }\n");
  write("lit.frag", fragment_head + "void main() { c = vec4(1); }\n");
  write("bad.frag", fragment_head + "void main() { oops; }\n");
  write("m.json", R"({"programs": [{"files": ["lit.vert", "lit.frag"]}, {"files": ["lit.vert", "bad.frag"]},
    {"name": "lit", "files": ["lit.vert"]}]})");
  const Finished three = check("--manifest m.json");
  EXPECT_NE(three.out.find("3 programs, 3 variants"), std::string::npos) << three.out;
  EXPECT_NE(three.out.find("(lit 2; "), std::string::npos) << three.out;
  for (const std::string twice :
       {"{\"programs\": [{\"files\": [\"bad.frag\"]}],\n\"programs\": [{\"files\": [\"lit.frag\"]}]}",
        "{\"programs\": [{\"files\": [\"bad.frag\"],\n\"files\": [\"lit.frag\"]}]}"}) {
    write("m.json", twice);
    const Finished finished = check("--manifest m.json");
    EXPECT_EQ(finished.status, 1) << twice;
    EXPECT_NE(finished.err.find("m.json:2: an object has the key '"), std::string::npos) << finished.err;
  }
  write("n.frag", fragment_head + "#ifndef N\noops\n#endif\nN void main() { c = vec4(1); }\n");
  write("m.json", R"({"programs": [{"files": ["n.frag"], "permutations": {"N": ["", "/**/"]}}]})");
  const Finished empty = check("--manifest m.json");
  EXPECT_EQ(empty.status, 0) << empty.out << empty.err;
  write("through.sh", "#!/bin/sh\ncat m.json | '" GNOMON_PROGRAM "' \"$@\"\n");
  std::filesystem::permissions(folder / "through.sh", std::filesystem::perms::owner_all);
  const Finished piped = run("shaders check --manifest /dev/stdin", folder / "through.sh");
  EXPECT_EQ(piped.status, 0) << piped.out << piped.err;
}

TEST_F(ShaderFilesTest, ControlCharactersOfNamesDoNotReachTheTerminal)
{
  write("a\x1B[31m.frag", "#version 450\n#line 1 \"b\x7F\"\nvoid main() { oops; }\n");
  write("m.json", R"({"programs": [{"name": "c\u001b[31m\nd\u007f", "files": ["a\u001b[31m.frag"]}]})");
  for (const char *arguments : {"--manifest m.json", "a*.frag"}) {
    const std::string out = check(arguments).out;
    EXPECT_NE(out.find("error: 'oops' : undeclared identifier [compile] ("), std::string::npos) << out;
    EXPECT_TRUE(std::ranges::none_of(out, [](char c) { return (c >= 0 && c < ' ' && c != '\n') || c == '\x7F'; }))
        << out;
  }
  EXPECT_NE(check("--manifest m.json").out.find("(c?[31m?d?; "), std::string::npos) << check("--manifest m.json").out;
  const nlohmann::json json = nlohmann::json::parse(check("--manifest m.json --format json").out);
  EXPECT_EQ(json["messages"][0]["where"][0]["shader"], "c\x1B[31m\nd\x7F") << json;
}

TEST_F(ShaderFilesTest, AnEditorGivesTheTextOfAFile)
{
  write("text.txt", fragment_head + "#include \"near.glsl\"\nvoid main() { c = vec4(near_value + oops); }\n");
  write_file("shaders/near.glsl", "float near_value = 1.0;\n");
  write_file("shaders/a.frag", "what was saved\n");
  write("through.sh", "#!/bin/sh\nexec '" GNOMON_PROGRAM "' \"$@\" < text.txt\n");
  std::filesystem::permissions(folder / "through.sh", std::filesystem::perms::owner_all);
  for (const std::string path : {"shaders/a.frag", "shaders/new.frag"}) {
    const Finished finished = run("shaders check --stdin " + path + " --format json", folder / "through.sh");
    EXPECT_EQ(finished.status, 1) << finished.err;
    const nlohmann::json json = nlohmann::json::parse(finished.out);
    ASSERT_GE(json["messages"].size(), 1U) << finished.out;
    EXPECT_EQ(json["messages"][0]["file"], path);
    EXPECT_EQ(json["messages"][0]["line"], 4);
  }
  EXPECT_EQ(run("shaders check --stdin shaders/near.glsl --stage frag", folder / "through.sh").status, 1);
}

TEST_F(ShaderFilesTest, AMessageOnANegativeLineHasNone)
{
  // glslang counts on from the greatest line to the least.
  write("a.frag", "#version 450\n#line 2147483647\n\nvoid main() { oops; }\n");
  const std::string text = "'oops' : undeclared identifier";
  const Finished plain = check("a.frag");
  EXPECT_EQ(plain.out.find("a.frag: error: " + text), 0U) << plain.out;
  EXPECT_EQ(plain.out.find('\x02'), std::string::npos) << plain.out;
  const nlohmann::json json = nlohmann::json::parse(check("a.frag --format json").out)["messages"];
  ASSERT_EQ(json.size(), 1U) << json;
  EXPECT_EQ(json[0]["text"], text);
  EXPECT_FALSE(json[0].contains("line")) << json;
  const nlohmann::json results = nlohmann::json::parse(check("a.frag --format sarif").out)["runs"][0]["results"];
  ASSERT_EQ(results.size(), 1U) << results;
  const nlohmann::json place = results[0]["locations"][0]["physicalLocation"];
  EXPECT_EQ(place["artifactLocation"]["uri"], "a.frag") << place;
  EXPECT_FALSE(place.contains("region")) << place;
}

TEST_F(ShaderFilesTest, StandardInputThatCannotBeReadIsNoEmptyShader)
{
  write("a.frag", fragment_head + "void main() { c = vec4(1); }\n");
  for (const std::string from : {"<&-", "0> written", "< ."}) {
    write("through.sh", "#!/bin/sh\nexec '" + std::string(GNOMON_PROGRAM) + "' \"$@\" " + from + "\n");
    std::filesystem::permissions(folder / "through.sh", std::filesystem::perms::owner_all);
    const Finished finished = run("shaders check --stdin a.frag", folder / "through.sh");
    EXPECT_EQ(finished.status, 1) << from << finished.out;
    EXPECT_NE(finished.err.find("standard input cannot be read"), std::string::npos) << from << finished.err;
  }
  std::filesystem::create_directory(folder / "d");
  std::filesystem::create_symlink("a.frag", folder / "link.frag");
  for (const std::string path : {"./a.frag", "d/../a.frag", "link.frag"}) {
    write("through.sh", "#!/bin/sh\necho oops | '" + std::string(GNOMON_PROGRAM) + "' \"$@\"\n");
    const Finished finished = run("shaders check a.frag --stdin " + path, folder / "through.sh");
    EXPECT_EQ(finished.status, 1);
    EXPECT_NE(finished.out.find("1 programs"), std::string::npos) << path << finished.out;
    EXPECT_EQ(finished.out.find("a.frag:1: error"), 0U) << path << finished.out;
  }
}

TEST_F(ShaderFilesTest, LevelsAreOptions)
{
  write("a.frag",
        "#version 450\nlayout(binding = 0) uniform sampler2D t;\nlayout(location = 0) out vec4 c;\n"
        "void main() { c = vec4(1.0); }\n");
  EXPECT_EQ(check("a.frag").status, 0);
  EXPECT_EQ(check("a.frag -Werror").status, 1);
  EXPECT_EQ(check("a.frag -Werror=unused-binding -Wblock-array").status, 1);
  EXPECT_EQ(check("a.frag -Wno-unused-binding -Werror").status, 0);
  const Finished unknown = check("a.frag -Wunguarded");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("unguarded-math"), std::string::npos) << "the known ones are listed: " << unknown.err;
  EXPECT_EQ(check("a.frag -Wno-compile").status, 2) << "a mistake that no level removes";
}

}  // namespace
}  // namespace gnomon
