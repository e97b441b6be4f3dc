// SPDX-License-Identifier: MIT
// `gnomon shaders`: mistakes planted in a copy of the engine's shaders, and a user's own shaders.
#include "cli_process.hh"

#include "cli_shader_programs.hh"
#include "eevee_shaders.hh"
#include "shader_check.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <functional>

namespace gnomon {
namespace {

using test::Finished;

/** Number of the first line that contains \a part, from 1; 0 if there is none. */
int line_of(const std::string &text, const std::string &part)
{
  const std::size_t at = text.find(part);
  return at == std::string::npos ? 0 : int(std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n')) + 1;
}

std::size_t count_of(const std::string &text, const std::string &part)
{
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    count++;
  }
  return count;
}

/** For example "12 programs, 34 variants"; of all engines. */
std::string programs_and_variants()
{
  const std::vector<cli::Variant> variants = cli::engine_variants();
  return std::to_string(cli::program_count(variants)) + " programs, " + std::to_string(variants.size()) + " variants";
}

class ShadersTest : public test::ProgramTest {
 protected:
  /** A copy of the engine's shaders for planted mistakes. */
  void copy_tree()
  {
    std::filesystem::copy(GNOMON_SOURCE "/shaders", folder / "tree", std::filesystem::copy_options::recursive);
  }
  void replace(const std::string &file, const std::string &from, const std::string &to)
  {
    std::string text = read("tree/" + file);
    ASSERT_EQ(count_of(text, from), 1U) << file << " holds this once no more, so plant something else: " << from;
    text.replace(text.find(from), from.size(), to);
    write("tree/" + file, text);
  }
  /** \a path below the test's folder. */
  void write_file(const std::string &path, const std::string &text)
  {
    std::filesystem::create_directories((folder / path).parent_path());
    write(path, text);
  }
};

TEST_F(ShadersTest, ListNamesEveryProgramWithItsVariantsAndPurpose)
{
  const Finished finished = run("shaders list");
  EXPECT_EQ(finished.status, 0) << finished.err;
  for (const std::string &part :
       {std::string("eevee_depth: depth of what is seen"), std::string("USE_LIGHT USE_PUNCTUAL USE_SHADOW_CUBE\n"),
        std::string("USE_PUNCTUAL: where a point, spot or area lamp shines"), programs_and_variants() + "\n"}) {
    EXPECT_NE(finished.out.find(part), std::string::npos) << part << " is not in:\n" << finished.out;
  }
  for (const eevee::ShaderDeclaration &declaration : eevee::shader_declarations()) {
    const std::string line = std::string(declaration.name) + ": " + std::string(declaration.purpose);
    EXPECT_NE(finished.out.find(line), std::string::npos) << line << " is not in:\n" << finished.out;
  }
  EXPECT_EQ(finished.out.find("USE_LIGHT USE_SHADOW_CUBE\n"), std::string::npos) << "cubes are for punctual lamps";
}

// scripts/test checks all programs, with the program that is built without sanitizers.
TEST_F(ShadersTest, AProgramOfTheEngineIsCleanInAllVariants)
{
  const Finished finished = run("shaders check --program eevee_depth");
  EXPECT_EQ(finished.status, 0);
  const auto program = std::ranges::find(eevee::shader_declarations(), "eevee_depth", &eevee::ShaderDeclaration::name);
  // One more has clip planes.
  const std::string variants = std::to_string(eevee::shader_variants(*program).size() + 1);
  EXPECT_EQ(
      finished.out.find("1 programs, " + variants + " variants, OpenGL 4.5 and Vulkan 1.2: 0 errors, 0 warnings, "), 0U)
      << finished.out;
  EXPECT_EQ(finished.err, "") << "no progress bar in a pipe";
}

TEST_F(ShadersTest, RunWithoutDisplayDriverAndHome)
{
  copy_tree();
  const std::string program =
      "env -i '" GNOMON_PROGRAM "' shaders check --program eevee_film --shaders '" + (folder / "tree").string() + "'";
  EXPECT_EQ(std::system((program + " > /dev/null 2>&1").c_str()), 0);
}

struct Planted {
  const char *name;
  /** A program with few variants that reads the edited file. */
  const char *program;
  struct Edit {
    const char *file;
    const char *from;
    const char *to;
  };
  std::vector<Edit> edits;
  /** The line of the expected message: the one that contains \a at_text after the edits. */
  const char *at_file;
  const char *at_text;
  const char *message;
  /** Number of errors: a mistake is reported once, not once for each variant. */
  std::size_t error_count = 1;
};

void PrintTo(const Planted &planted, std::ostream *stream)
{
  *stream << planted.name;
}

class PlantedMistake : public ShadersTest, public testing::WithParamInterface<Planted> {};

TEST_P(PlantedMistake, IsReportedWithFileAndLine)
{
  const Planted &planted = GetParam();
  copy_tree();
  for (const Planted::Edit &edit : planted.edits) {
    ASSERT_NO_FATAL_FAILURE(replace(edit.file, edit.from, edit.to));
  }
  const int line = line_of(read(std::string("tree/") + planted.at_file), planted.at_text);
  ASSERT_GT(line, 0);
  const Finished finished = run(std::string("shaders check --shaders tree --program ") + planted.program);
  EXPECT_EQ(finished.status, 1);
  EXPECT_EQ(count_of(finished.out, ": error: "), planted.error_count) << finished.out;
  const std::string start = "tree/" + std::string(planted.at_file) + ":" + std::to_string(line) + ": error: ";
  const std::size_t at = finished.out.find(start);
  ASSERT_NE(at, std::string::npos) << start << " is not in:\n" << finished.out;
  const std::string message = finished.out.substr(at, finished.out.find('\n', at) - at);
  EXPECT_NE(message.find(planted.message), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    All, PlantedMistake,
    testing::Values(
        Planted{"SyntaxInIncludeOfInclude",
                "eevee_depth",
                {{"shared/draw_view_shared.h", "struct ViewData {", "const float planted = ;\nstruct ViewData {"}},
                "shared/draw_view_shared.h",
                "const float planted",
                "syntax error"},
        Planted{"TypeMismatch",
                "eevee_tonemap",
                {{"draw/draw_target_frag.glsl", "void main()\n{\n", "void main()\n{\n  vec2 planted = vec3(1.0);\n"}},
                "draw/draw_target_frag.glsl",
                "vec2 planted",
                "cannot convert"},
        Planted{"MissingVarying",
                "eevee_debug_cascades",
                {{"eevee/eevee_surface_vert_lib.glsl", "layout(location = 0) out vec3 surface_position_ws;\n", ""},
                 {"eevee/eevee_surface_vert_lib.glsl", "  surface_position_ws = position_ws;\n", ""}},
                "eevee/eevee_surface_frag_lib.glsl",
                "in vec3 surface_position_ws;",
                "is no output of the vertex stage [missing-varying]"},
        Planted{"FieldInGlslOnly",
                "eevee_debug_cascades",
                {{"shared/eevee_light_shared.h", "  int shadow_index;\n", "  int shadow_index;\n  vec4 planted;\n"}},
                "shared/eevee_light_shared.h",
                "vec4 planted",
                "of struct 'LightData' in block 'light_block' is not in C++ [layout]",
                // The block's layout also differs.
                2},
        Planted{"PaddingRemoved",
                "eevee_esm_separable",
                {{"shared/eevee_esm_shared.h", "  int _pad0;\n", ""}},
                "shared/eevee_esm_shared.h",
                "struct EsmData",
                "field 'esm.lamps[0]._pad0' of struct 'EsmData' in block 'esm_block' is in C++ only [layout]"},
        Planted{"FieldsReordered",
                "eevee_debug_cascades",
                {{"shared/eevee_light_shared.h", "float spot_drop_outer;", "float planted;"},
                 {"shared/eevee_light_shared.h", "float spot_inv_width;", "float spot_drop_outer;"},
                 {"shared/eevee_light_shared.h", "float planted;", "float spot_inv_width;"}},
                "shared/eevee_light_shared.h",
                "float spot_inv_width;",
                "of struct 'LightData' in block 'light_block' is at byte 64, in C++ at byte 68 [layout]",
                2},
        Planted{"Vec3ArrayInBlock",
                "eevee_film",
                {{"eevee/eevee_film_frag.glsl", "  vec4 row_weights;\n", "  vec4 row_weights;\n  vec3 planted[3];\n"}},
                "eevee/eevee_film_frag.glsl",
                "vec3 planted[3]",
                "'planted': an array of vec3 takes 16 bytes an element"},
        Planted{
            "SlotUsedTwice",
            "eevee_tonemap",
            {{"draw/draw_target_frag.glsl", "layout(location = 0) out vec4 display;\n",
              "layout(location = 0) out vec4 display;\nlayout(binding = RADIANCE_SLOT) uniform sampler2D planted;\n"},
             {"draw/draw_target_frag.glsl", "= texelFetch(radiance_texture,",
              "= texelFetch(planted, ivec2(0), 0) + texelFetch(radiance_texture,"}},
            "draw/draw_target_frag.glsl",
            "uniform sampler2D planted",
            "has slot 18, as texture 'radiance_texture' has [slot]"},
        Planted{"OneFeatureBitOnly",
                "eevee_depth",
                {{"eevee/eevee_depth_frag.glsl", "#  else\n  bool is_open",
                  "#  else\n  float planted = undeclared_name;\n  bool is_open"}},
                "eevee/eevee_depth_frag.glsl",
                "float planted",
                "'undeclared_name' : undeclared identifier [compile] (eevee_depth, "},
        Planted{"OnlyWithClipPlanes",
                "eevee_depth",
                {{"draw/draw_clip_lib.glsl", "#ifdef USE_CLIP_PLANES\n  for",
                  "#ifdef USE_CLIP_PLANES\n  float planted = undeclared_name;\n  for"}},
                "draw/draw_clip_lib.glsl",
                "float planted",
                "'undeclared_name' : undeclared identifier [compile] (eevee_depth"},
        Planted{"OnlyWithACoarseGrid",
                "eevee_gbuffer",
                {{"eevee/eevee_surface_frag_lib.glsl", "#ifdef HAS_COARSE_GRID\n  vec2 ndc",
                  "#ifdef HAS_COARSE_GRID\n  float planted = undeclared_name;\n  vec2 ndc"}},
                "eevee/eevee_surface_frag_lib.glsl",
                "float planted",
                "'undeclared_name' : undeclared identifier [compile] (eevee_gbuffer"},
        Planted{"VulkanOnly",
                "eevee_tonemap",
                {{"draw/draw_target_frag.glsl", "layout(location = 0) out vec4 display;\n",
                  "layout(location = 0) out vec4 display;\nlayout(location = 5) uniform float planted;\n"},
                 {"draw/draw_target_frag.glsl", "radiance.rgb * exposure_scale", "radiance.rgb * planted"}},
                "draw/draw_target_frag.glsl",
                "uniform float planted",
                "(eevee_tonemap, 2 variants; Vulkan 1.2)"},
        Planted{"BlockTooLarge",
                "eevee_debug_cascades",
                {{"shared/eevee_light_shared.h", "#define LIGHT_MAX 255\n", "#define LIGHT_MAX 256\n"}},
                "eevee/eevee_light_lib.glsl",
                "uniform light_block",
                "block 'light_block' takes 16400 bytes; all devices support 16384",
                // C++ also has fewer lights.
                2},
        Planted{"OnlyWithASurfaceFunction",
                "eevee_surfaces",
                {{"eevee/eevee_lit_vert.glsl", "layout(location = 9) flat out", "layout(location = 10) flat out"},
                 {"eevee/eevee_surfaces_frag.glsl", "layout(location = 9) flat in", "layout(location = 10) flat in"}},
                "eevee/eevee_lit_vert.glsl",
                "layout(location = 10) flat out",
                "overlapping use of location 10",
                // In both stages.
                2},
        Planted{
            "Recursion",
            "eevee_tonemap",
            {{"shared/draw_view_transform_shared.h", "SHARED_END",
              "float planted(float x)\n{\n  return x < 1.0 ? x : planted(x - 1.0);\n}\nSHARED_END"},
             {"draw/draw_target_frag.glsl", "radiance.rgb * exposure_scale", "radiance.rgb * planted(exposure_scale)"}},
            "shared/draw_view_transform_shared.h",
            "float planted(float x)",
            // Without glslang's syntax tree the message is that of its linker.
            shader_check::left_out_rules(shader_check::CheckTarget::OpenGlSpirv).empty()
                ? "function 'planted' calls itself"
                : "Recursion detected: planted"}),
    [](const auto &test) { return test.param.name; });

TEST_F(ShadersTest, AVulkanOnlyMistakePassesForOpenGl)
{
  copy_tree();
  replace("draw/draw_target_frag.glsl", "layout(location = 0) out vec4 display;\n",
          "layout(location = 0) out vec4 display;\nlayout(location = 5) uniform float planted;\n");
  replace("draw/draw_target_frag.glsl", "radiance.rgb * exposure_scale", "radiance.rgb * planted");
  EXPECT_EQ(run("shaders check --shaders tree --program eevee_tonemap --target vulkan").status, 1);
  // One member of the push constants has no reader any more, which is valid.
  const Finished opengl = run("shaders check --shaders tree --program eevee_tonemap --target opengl");
  EXPECT_EQ(opengl.status, 0) << opengl.out;
}

TEST_F(ShadersTest, LayoutOfBlocksAgreesInBothColumns)
{
  const Finished finished = run("shaders layout");
  EXPECT_EQ(finished.status, 0) << finished.out << finished.err;
  // std140 layout: a matrix of four vec4, a vec3, and an int in its row.
  EXPECT_NE(finished.out.find("      64     64  view.position_ws\n      76     76  view.is_perspective\n"),
            std::string::npos)
      << finished.out;
  for (const char *block :
       {"view_block", "object_block", "material_block", "light_block", "shadow_block", "shadow_render_block"}) {
    EXPECT_NE(finished.out.find(std::string(block) + ": "), std::string::npos) << block;
  }
}

TEST_F(ShadersTest, LayoutNamesStructAndFieldThatDiffer)
{
  copy_tree();
  replace("shared/eevee_esm_shared.h", "  int _pad0;\n", "  int planted;\n");
  const int line = line_of(read("tree/shared/eevee_esm_shared.h"), "planted");
  const Finished finished = run("shaders layout --shaders tree");
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.out.find("     -     28  esm.lamps[0].planted  <-- differs"), std::string::npos) << finished.out;
  EXPECT_NE(finished.out.find("tree/shared/eevee_esm_shared.h:" + std::to_string(line) +
                              ": error: field 'esm.lamps[0].planted' of struct 'EsmData'"),
            std::string::npos)
      << finished.out;
}

TEST_F(ShadersTest, ReflectPrintsBlocksTexturesAndStageVariables)
{
  const Finished finished = run("shaders reflect eevee_lit --variant 'USE_SHADOW_MAP USE_LIGHT' --format json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const nlohmann::json json = nlohmann::json::parse(finished.out);
  const auto find = [&](const char *list, const std::string &name) {
    for (const nlohmann::json &entry : json[list]) {
      if (entry["name"] == name) {
        return entry;
      }
    }
    ADD_FAILURE() << list << " holds no " << name << ": " << finished.out;
    return nlohmann::json();
  };
  const nlohmann::json view = find("bindings", "view_block");
  EXPECT_EQ(view["kind"], "uniform");
  EXPECT_EQ(view["size"], 256);
  EXPECT_EQ(view["members"][1], nlohmann::json({{"name", "view.position_ws"},
                                                {"type", "vec3"},
                                                {"offset", 64},
                                                {"size", 12},
                                                {"arrays", nlohmann::json::array()}}));
  EXPECT_EQ(find("bindings", "shadow_maps")["kind"], "texture");
  EXPECT_EQ(find("inputs", "normal")["type"], "vec3");
  EXPECT_EQ(find("inputs", "draw_instance")["type"], "uvec2");
  EXPECT_EQ(find("outputs", "radiance"),
            nlohmann::json({{"name", "radiance"}, {"type", "vec4"}, {"location", 0}, {"component", 0}, {"index", 0}}));

  const Finished text = run("shaders reflect eevee_tonemap");
  EXPECT_NE(text.out.find("push constants 'push_constant_block', set 0, slot 8, in fragment; 96 bytes"),
            std::string::npos)
      << text.out;
  EXPECT_EQ(run("shaders reflect eevee_lit --variant USE_SHADOW_CUBE").status, 1) << "no such variant";
  EXPECT_EQ(run("shaders reflect eevee_paint").status, 1);
}

using Lines = std::vector<std::string>;

/** Sizes of arrays as `[2][3]`, from numbers or from objects with a count. */
std::string sizes_of(const nlohmann::json &arrays)
{
  std::string text;
  for (const nlohmann::json &array : arrays) {
    text += fmt::format("[{}]", (array.is_object() ? array["count"] : array).get<int>());
  }
  return text;
}

/** GLSL has several names for one type, and SPIR-V has integers for booleans in blocks. */
std::string spirv_type(std::string type)
{
  type = type.substr(0, type.find('['));
  type = type == "bool" ? "uint" : type.starts_with("bvec") ? "u" + type.substr(1) : type;
  return type.size() > 3 && type.ends_with(fmt::format("{0}x{0}", type.back())) ? type.substr(0, type.size() - 2)
                                                                                : type;
}

/** The lines about members and variables in the JSON of `gnomon shaders reflect`. */
Lines lines_of_ours(const nlohmann::json &program)
{
  Lines lines;
  for (const nlohmann::json &binding : program["bindings"]) {
    const bool is_push_constant = binding["kind"] == "push constants";
    const std::string name = is_push_constant ? "" : binding["name"];
    lines.push_back(fmt::format("{} {} {} set {} slot {} size {} {}", binding["kind"].get<std::string>(), name,
                                sizes_of(binding["counts"]), binding["set"].get<int>(), binding["slot"].get<int>(),
                                is_push_constant ? 0 : binding["size"].get<int>(),
                                spirv_type(binding["type"].get<std::string>())));
    lines.back() += binding.value("format", "");
    for (const nlohmann::json &qualifier : binding.value("qualifiers", nlohmann::json::array())) {
      lines.back() += " " + qualifier.get<std::string>();
    }
    lines.back() += fmt::format(" {} {}", binding.value("input_attachment_index", 0), binding.value("offset", 0));
    for (const nlohmann::json &member : binding["members"]) {
      const std::string path = member["name"];
      // The stride of the outermost array of the member itself: spirv-cross has no other.
      std::size_t outer = 0;
      for (std::size_t at = path.find("[0]"); at != std::string::npos; at = path.find("[0]", at + 1)) {
        outer++;
      }
      const nlohmann::json &arrays = member["arrays"];
      lines.push_back(fmt::format("{} {} at {} {} {} stride {} matrix {} {}", name, path, member["offset"].get<int>(),
                                  spirv_type(member["type"]), sizes_of(arrays),
                                  outer < arrays.size() ? arrays[outer]["stride"].get<int>() : 0,
                                  member.value("matrix_stride", 0), member.value("row_major", false)));
    }
  }
  for (const char *list : {"inputs", "outputs"}) {
    for (const nlohmann::json &variable : program[list]) {
      const std::string type = variable["type"];
      lines.push_back(fmt::format("{} {} {}{} {} {}", list, variable["name"].get<std::string>(), spirv_type(type),
                                  type.substr(std::min(type.find('['), type.size())), variable["location"].get<int>(),
                                  variable["index"].get<int>()));
    }
  }
  for (const nlohmann::json &constant : program["constants"]) {
    lines.push_back(fmt::format("constant {} {} {} {}", constant["id"].get<int>(), constant["name"].get<std::string>(),
                                constant["type"].get<std::string>(), constant["value"].dump()));
  }
  for (const nlohmann::json &workgroup : program["workgroups"]) {
    for (std::size_t i = 0; i < 3; i++) {
      const int id = workgroup["constant_ids"][i];
      lines.push_back(fmt::format("workgroup {} {} {}", i, id >= 0, id >= 0 ? id : workgroup["size"][i].get<int>()));
    }
  }
  std::ranges::sort(lines);
  return lines;
}

/** The same from spirv-cross's reflection of a stage. */
class CrossLines {
 public:
  explicit CrossLines(const nlohmann::json &reflection) : types_(reflection.value("types", nlohmann::json::object()))
  {
    for (const auto &[list, kind] : {std::pair("ubos", "uniform"),
                                     {"ssbos", "storage"},
                                     {"push_constants", "push constants"},
                                     {"textures", "texture"},
                                     {"separate_images", "texture"},
                                     {"separate_samplers", "sampler"},
                                     {"images", "image"},
                                     {"subpass_inputs", "subpass input"},
                                     {"acceleration_structures", "acceleration structure"},
                                     {"counters", "atomic counter"}}) {
      for (const nlohmann::json &entry : reflection.value(list, nlohmann::json::array())) {
        add_binding(entry, kind);
      }
    }
    for (const char *list : {"inputs", "outputs"}) {
      for (const nlohmann::json &entry : reflection.value(list, nlohmann::json::array())) {
        add_variable(entry, list);
      }
    }
    for (const nlohmann::json &constant : reflection.value("specialization_constants", nlohmann::json::array())) {
      lines.push_back(fmt::format("constant {} {} {} {}", constant["id"].get<int>(),
                                  constant["name"].get<std::string>(), constant["type"].get<std::string>(),
                                  constant["default_value"].dump()));
    }
    const nlohmann::json &entry = reflection["entryPoints"][0];
    for (std::size_t i = 0; i < entry.value("workgroup_size", nlohmann::json::array()).size(); i++) {
      lines.push_back(fmt::format("workgroup {} {} {}", i, entry["workgroup_size_is_spec_constant_id"][i].get<bool>(),
                                  entry["workgroup_size"][i].get<int>()));
    }
    std::ranges::sort(lines);
    lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  }
  Lines lines;

 private:
  /** The innermost array is the first in spirv-cross's. */
  static nlohmann::json arrays_of(const nlohmann::json &entry)
  {
    nlohmann::json sizes = entry.value("array", nlohmann::json::array());
    std::reverse(sizes.begin(), sizes.end());
    return sizes;
  }

  static std::string type_of(const nlohmann::json &entry)
  {
    return entry["type"] == "accelerationStructureNV" ? "accelerationStructureEXT" : entry["type"].get<std::string>();
  }

  void add_binding(const nlohmann::json &entry, const std::string &kind)
  {
    const bool is_push_constant = kind == "push constants";
    const bool is_block = types_.contains(entry["type"].get<std::string>());
    const std::string name = is_push_constant ? "" : entry["name"];
    lines.push_back(fmt::format("{} {} {} set {} slot {} size {} {}{}", kind, name, sizes_of(arrays_of(entry)),
                                entry.value("set", 0), entry.value("binding", -1), entry.value("block_size", 0),
                                is_block ? "" : type_of(entry), entry.value("format", "")));
    for (const char *qualifier : {"readonly", "writeonly", "restrict", "coherent", "volatile"}) {
      lines.back() += entry.value(qualifier, false) ? fmt::format(" {}", qualifier) : "";
    }
    lines.back() += fmt::format(" {} {}", entry.value("input_attachment_index", 0), entry.value("offset", 0));
    if (is_block) {
      add_members(entry["type"], name, "", 0, "");
    }
  }

  void add_members(const std::string &type, const std::string &block, const std::string &prefix, int first_byte,
                   const std::string &outer)
  {
    for (const nlohmann::json &member : types_[type]["members"]) {
      std::string path = prefix + member["name"].get<std::string>();
      const std::string inner = member["type"];
      const int offset = first_byte + member["offset"].get<int>();
      const std::string sizes = outer + sizes_of(arrays_of(member));
      if (types_.contains(inner)) {
        for (std::size_t i = 0; i < arrays_of(member).size(); i++) {
          path += "[0]";
        }
        add_members(inner, block, path + ".", offset, sizes);
        continue;
      }
      lines.push_back(fmt::format("{} {} at {} {} {} stride {} matrix {} {}", block, path, offset, inner, sizes,
                                  member.value("array_stride", 0), member.value("matrix_stride", 0),
                                  member.value("row_major", false)));
    }
  }

  void add_variable(const nlohmann::json &entry, const char *list)
  {
    const std::string name = entry["name"];
    const std::string type = entry["type"];
    // A block has the name of its type.
    if (types_.contains(type) && types_[type]["name"] == name) {
      int location = entry.value("location", -1);
      for (const nlohmann::json &member : types_[type]["members"]) {
        const std::string inner = member["type"];
        location = member.value("location", location);
        lines.push_back(fmt::format("{} {}.{} {}{} {} 0", list, name, member["name"].get<std::string>(), inner,
                                    sizes_of(arrays_of(member)), location));
        int count = inner.starts_with("mat") ? inner[3] - '0' : 1;
        for (const nlohmann::json &size : arrays_of(member)) {
          count *= size.get<int>();
        }
        location += count;
      }
      return;
    }
    nlohmann::json sizes = arrays_of(entry);
    // The vertices of a primitive.
    if (name.ends_with("_each")) {
      sizes.erase(0);
    }
    lines.push_back(fmt::format("{} {} {}{} {} {}", list, name,
                                types_.contains(type) ? types_[type]["name"].get<std::string>() : type, sizes_of(sizes),
                                entry.value("location", -1), entry.value("index", 0)));
  }

  const nlohmann::json types_;
};

TEST_F(ShadersTest, ReflectOfFilesAgreesWithSpirvCross)
{
  struct Case {
    const char *file;
    const char *target;
    const char *text;
  };
  for (const auto &[file, target, text] : {
           Case{"a.vert", "vulkan1.2",
                "layout(location = 0) in vec3 position; layout(location = 3) in uvec4 joints; layout(location = 5) in "
                "dmat3x2 wide;\n"
                "struct Bone { mat3x4 m; vec3 scale; bool is_on; };\n"
                "layout(set = 1, binding = 2) uniform Pose { Bone bones[2][3]; float weights[3]; bvec2 flags[2];\n"
                "  layout(row_major) mat4x3 r; layout(row_major) mat2 q[4]; mat3 c; } pose[2];\n"
                "layout(push_constant, row_major) uniform Draw { vec4 color; int index; mat3x2 m; } draw;\n"
                "layout(location = 1, component = 1) out vec3 normal; layout(location = 1) out float side;\n"
                "layout(location = 2) out Block { vec4 a; mat2 b; flat ivec2 c[2]; } block;\n"
                "struct Pair { vec2 a; float b[2]; };\nlayout(location = 9) out Pair pair;\n"
                "void main() { normal = pose[1].bones[1][joints.x].scale * pose[0].weights[1] * draw.color.x;\n"
                "  side = float(wide[0].x); block.a = vec4(1); block.b = mat2(1); block.c[0] = ivec2(1); pair.a = "
                "vec2(1);\n"
                "  gl_Position = vec4(position, draw.index); }\n"},
           Case{"b.frag", "vulkan1.1",
                "layout(location = 1) in vec3 normal; layout(location = 0, index = 0) out vec4 color;\n"
                "layout(location = 0, index = 1) out vec4 factor; layout(constant_id = 7) const float SCALE = 0.5;\n"
                "layout(constant_id = 8) const bool IS_ON = true; layout(constant_id = 9) const int COUNT = -3;\n"
                "layout(constant_id = 10) const uint MASK = 4000000000u;\n"
                "layout(set = 0, binding = 5) uniform sampler2DArrayShadow shadows[4];\n"
                "layout(set = 0, binding = 9) uniform usamplerBuffer table;\n"
                "layout(set = 0, binding = 16, rgba8ui) uniform readonly restrict uimage3D cells;\n"
                "layout(set = 0, binding = 17, r11f_g11f_b10f) uniform writeonly image2DArray films[2];\n"
                "layout(set = 0, binding = 19) uniform writeonly image2D plain;\n"
                "layout(set = 3, binding = 1) uniform sampler smooth_sampler;\n"
                "layout(set = 3, binding = 2) uniform itexture2DMSArray samples;\n"
                "layout(set = 3, binding = 3) uniform texture2D base;\n"
                "layout(set = 3, binding = 4, input_attachment_index = 2) uniform usubpassInputMS attached;\n"
                "layout(set = 2, binding = 0, std430) coherent buffer Hits { uint count; vec2 places[][3]; } hits;\n"
                "layout(set = 2, binding = 1, std430) readonly buffer Rows { mat3 first; bool flags[]; } rows[3];\n"
                "layout(set = 2, binding = 4, std140) uniform Loose { vec3 a; float b; };\n"
                "void main() { color = vec4(normal, texture(shadows[1], vec4(normal, 0))) * "
                "hits.places[hits.count][1].x\n"
                "  * imageLoad(cells, ivec3(normal)).x * texelFetch(table, 3).x * SCALE * float(COUNT) * float(MASK) * "
                "subpassLoad(attached, "
                "1).x;\n"
                "  factor = texture(sampler2D(base, smooth_sampler), vec2(b)) * texelFetch(samples, ivec3(1), 2);\n"
                "  if (IS_ON && rows[2].flags[1]) { imageStore(films[1], ivec3(0), color); imageStore(plain, ivec2(0), "
                "color); } "
                "}\n"},
           Case{"c.comp", "vulkan1.2",
                "layout(local_size_x_id = 4, local_size_y = 3, local_size_z_id = 6) in;\n"
                "layout(binding = 0) buffer Values { uint values[]; };\n"
                "void main() { values[0] = gl_WorkGroupSize.x; }\n"},
           Case{"d.comp", "vulkan1.3",
                "layout(local_size_x_id = 2, local_size_y_id = 5, local_size_z_id = 3) in;\n"
                "layout(binding = 0) volatile buffer Values { uint values[]; };\nvoid main() { values[0] = 1; }\n"},
           Case{"e.comp", "opengl-spirv",
                "layout(local_size_x = 64) in;\nlayout(binding = 0, offset = 8) uniform atomic_uint hits;\n"
                "layout(binding = 3, std430) writeonly buffer Values { uint values[]; };\n"
                "void main() { values[0] = atomicCounterIncrement(hits); }\n"},
           Case{"f.rgen", "vulkan1.2",
                "#extension GL_EXT_ray_tracing : require\n"
                "layout(set = 1, binding = 3) uniform accelerationStructureEXT worlds[2];\n"
                "layout(location = 0) rayPayloadEXT vec4 payload;\nvoid main() {\n"
                "  traceRayEXT(worlds[1], 0, 255, 0, 0, 0, vec3(0), 0.0, vec3(1), 1.0, 0); }\n"},
           Case{"g.tese", "vulkan1.0",
                "layout(triangles) in;\nlayout(location = 0) in vec3 p_each[]; layout(location = 1) patch in vec4 "
                "tint[2];\n"
                "layout(location = 4) out dvec3 wide;\n"
                "void main() { gl_Position = vec4(p_each[0], 1) * tint[1]; wide = dvec3(1); }\n"},
       }) {
    SCOPED_TRACE(file);
    write(file, fmt::format("#version 460\n#extension GL_EXT_samplerless_texture_functions : enable\n{}", text));
    const Finished check = run(fmt::format("shaders check {0} --target {1} -o {0}.spv", file, target));
    ASSERT_EQ(check.status, 0) << check.out << check.err;
    const Finished finished = run(fmt::format("shaders reflect {} --target {} --format json", file, target));
    ASSERT_EQ(finished.status, 0) << finished.err;
    const Finished cross = run(fmt::format("{}.spv --reflect", file), "spirv-cross");
    ASSERT_EQ(cross.status, 0) << cross.err << "\ninstall spirv-cross (scripts/setup tests)";
    const Lines ours = lines_of_ours(nlohmann::json::parse(finished.out).at(0));
    EXPECT_EQ(ours, CrossLines(nlohmann::json::parse(cross.out)).lines) << finished.out;
    EXPECT_FALSE(ours.empty());
  }
}

/** The entry \a name of \a list. */
nlohmann::json entry_of(const nlohmann::json &list, const std::string &name)
{
  const auto found = std::ranges::find_if(list, [&](const nlohmann::json &entry) { return entry["name"] == name; });
  return found == list.end() ? nlohmann::json() : *found;
}

TEST_F(ShadersTest, ReflectOfFilesHasWhatSpirvCrossHasNot)
{
  write("m.vert",
        "#version 460\nlayout(location = 1, component = 2) in vec2 uv;\n"
        "struct Bone { vec3 scale; bool is_on; };\n"
        "layout(set = 1, binding = 2) uniform Pose { Bone bones[2]; bvec3 flags[4]; uint count; } pose[3];\n"
        "layout(push_constant) uniform Draw { layout(offset = 0) vec4 a; } draw;\n"
        "void main() { gl_Position = draw.a * float(pose[1].bones[0].is_on) * uv.x; }\n");
  write("m.frag",
        "#version 460\nlayout(location = 0) out vec4 color;\n"
        "layout(push_constant) uniform Draw { layout(offset = 64) vec4 b; } draw;\nvoid main() { color = draw.b; }\n");
  const Finished finished = run("shaders reflect m.vert m.frag --target vulkan --format json");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const nlohmann::json program = nlohmann::json::parse(finished.out).at(0);
  EXPECT_EQ(entry_of(program["inputs"], "uv")["component"], 2);
  const nlohmann::json pose = entry_of(program["bindings"], "Pose");
  EXPECT_EQ(pose["counts"], nlohmann::json({3}));
  EXPECT_EQ(entry_of(pose["members"], "bones[0].is_on")["type"], "bool");
  EXPECT_EQ(entry_of(pose["members"], "flags")["type"], "bvec3[4]");
  EXPECT_EQ(entry_of(pose["members"], "count")["type"], "uint");
  // std140: a bone is a vec3 and a bool in a row of 16 bytes.
  EXPECT_EQ(entry_of(pose["members"], "bones[0].is_on")["arrays"], nlohmann::json({{{"count", 2}, {"stride", 16}}}));
  Lines draws;
  for (const nlohmann::json &binding : program["bindings"]) {
    if (binding["name"] == "Draw") {
      draws.push_back(fmt::format("{} {} at {}", binding["stages"][0].get<std::string>(),
                                  binding["members"][0]["name"].get<std::string>(),
                                  binding["members"][0]["offset"].get<int>()));
    }
  }
  EXPECT_EQ(draws, (Lines{"vertex a at 0", "fragment b at 64"})) << "each stage has its part of the push constants";
  const Finished text = run("shaders reflect m.vert m.frag --target vulkan");
  for (const std::string part : {"input vec2 'uv', location 1, component 2\n",
                                 "uniform 'Pose'[3], set 1, slot 2, in vertex", "bool bones[0].is_on, stride 16"}) {
    EXPECT_NE(text.out.find(part), std::string::npos) << part << " is not in:\n" << text.out;
  }
}

TEST_F(ShadersTest, LayoutOfFilesIsThatOfStructsThatTheCompilerLaysOut)
{
  write("m.frag",
        "#version 450\n"
        "struct Light { vec3 position; float radius; mat3 basis; vec2 cells[2][3]; };\n"
        "layout(std140, binding = 1) uniform Scene { mat4 view; Light lights[4][2]; int count; float weights[3]; } s;\n"
        "layout(std430, binding = 2) buffer Hits { uint count; Light places[]; } h;\n"
        "layout(location = 0) out vec4 color;\n"
        "void main() { color = s.view[0] * s.lights[s.count][1].radius * s.weights[1] * h.places[h.count].radius; }\n");
  // `Rows` is 16 bytes for each element, as std140 has them; std430 packs vec2 into 8.
  const std::string header =
      "struct Rows { alignas(16) float v[2]; };\n"
      "struct Light { float position[3]; float radius; float basis[3][4]; Rows cells[2][3]; };\n"
      "namespace app { struct Scene { float view[16]; Light lights[4][2]; int count; Rows weights[3]; }; }\n"
      "struct Hits { unsigned count; };\n"
      "struct Place { float position[3]; float radius; float basis[3][4]; float cells[2][3][2]; };\n";
  const std::string structs =
      " --struct m.hh:app::Scene --struct m.hh:Light=Scene.lights --struct m.hh:Hits --struct m.hh:Place=Hits.places";
  const auto compile = [&](const std::string &text) {
    write("m.hh", text);
    const Finished source = run("shaders layout m.frag" + structs);
    EXPECT_EQ(source.status, 0) << source.err;
    write("layout.cc", source.out);
    return run("-std=c++20 -fsyntax-only layout.cc", "c++");
  };
  const Finished equal = compile(header);
  EXPECT_EQ(equal.status, 0) << equal.err;
  for (const auto &[from, to, member] : {std::tuple("float radius; ", "", "lights[0][0].radius"),
                                         {"lights[4][2]", "lights[3][2]", "lights[0][0].position"},
                                         {"lights[4][2]", "lights[5][2]", "lights[0][0].position"},
                                         {"lights[4][2]", "lights[4][3]", "lights[0][0].position"},
                                         {"weights[3]", "weights[2]", "weights"},
                                         {"weights[3]", "weights[4]", "weights"},
                                         {"cells[2][3]", "cells[2][4]", "lights[0][0].cells"},
                                         {"v[2]", "v[2], w[4]", "weights"},
                                         {"basis[3][4]", "basis[3][3]", "lights[0][0].basis"},
                                         {"alignas(16) ", "", "weights"},
                                         {"int count", "char count", "count"},
                                         {"cells[2][3][2]", "cells[2][3][4]", "places"}}) {
    std::string changed = header;
    changed.replace(changed.find(from), std::string(from).size(), to);
    const Finished finished = compile(changed);
    EXPECT_NE(finished.status, 0) << to;
    EXPECT_NE(finished.err.find(fmt::format("'{}' of block", member)), std::string::npos) << finished.err;
  }
  for (const auto &[arguments, status, message] :
       {std::tuple("m.frag --struct m.hh:Other", 1, "no shader uses a block 'Other'; used are: Hits, Scene"),
        {"m.frag --struct m.hh:Other=Scene.view", 1, "block 'Scene' has no struct 'view'"},
        {"m.frag --struct m.hh", 2, "must be HEADER:NAME"},
        {"--struct m.hh:Scene", 2, "are for files"},
        {"m.frag", 2, "files need --struct"},
        {"none.frag --struct m.hh:Scene", 1, "none.frag"}}) {
    const Finished bad = run(fmt::format("shaders layout {}", arguments));
    EXPECT_EQ(bad.status, status) << arguments;
    EXPECT_NE(bad.err.find(message), std::string::npos) << bad.err;
  }
  // Arrays of structs at the end of a block, and blocks whose first member has an offset.
  write("m.frag",
        "#version 450\nstruct Light { vec4 a; };\n"
        "layout(push_constant) uniform Draw { layout(offset = 16) vec4 color; Light lights[2]; } d;\n"
        "layout(location = 0) out vec4 color; void main() { color = d.color * d.lights[1].a; }\n");
  for (const auto &[text, is_equal] :
       {std::pair(
            "struct V { float v[4]; }; struct Light { V a; }; struct Draw { V start; V color; Light lights[2]; };",
            true),
        {"struct V { float v[4]; }; struct Light { V a; }; struct Draw { V start; V color; Light lights[1]; };", false},
        {"struct V { float v[4]; }; struct Light { V a; }; struct Draw { V color; Light lights[3]; };", false}}) {
    write("m.hh", text);
    const Finished source = run("shaders layout m.frag --struct m.hh:Draw");
    ASSERT_EQ(source.status, 0) << source.err;
    write("layout.cc", source.out);
    EXPECT_EQ(run("-std=c++20 -fsyntax-only layout.cc", "c++").status == 0, is_equal) << text;
  }
  EXPECT_NE(run("shaders reflect m.frag").out.find("vec4 lights[0].a, stride 16\n"), std::string::npos);
}

TEST_F(ShadersTest, ReflectOfFilesReadsOpenGlAndNamesErrors)
{
  write("old.frag",
        "#version 330\nuniform sampler2D image; in vec2 uv; out vec4 color;\n"
        "void main() { color = texture(image, uv); }\n");
  const Finished old = run("shaders reflect old.frag");
  EXPECT_EQ(old.status, 0) << old.err;
  EXPECT_NE(old.out.find("texture sampler2D 'image', set 0, slot"), std::string::npos) << old.out;
  write("loose.vert",
        "#version 330\nuniform mat4 view[2]; uniform float unused;\nvoid main() { gl_Position = view[1][0]; }\n");
  write("loose.frag",
        "#version 430\nstruct Lamp { vec3 color; float power[2]; };\nlayout(location = 4) uniform Lamp lamps[3];\n"
        "layout(location = 20) uniform bool on; uniform mat4 view[2]; uniform struct { sampler2D map; int n; } m;\n"
        "out vec4 c;\nvoid main() { c = on ? vec4(lamps[1].color, lamps[0].power[1]) : view[0][m.n] * "
        "texture(m.map, vec2(0)); }\n");
  const Finished loose = run("shaders reflect loose.vert loose.frag --format json");
  ASSERT_EQ(loose.status, 0) << loose.err;
  const auto uniform = [](const char *name, const char *type, int location) {
    return nlohmann::json{{"name", name}, {"type", type}, {"location", location}};
  };
  EXPECT_EQ(nlohmann::json::parse(loose.out)[0]["uniforms"],
            (nlohmann::json{uniform("view", "mat4x4[2]", -1), uniform("m.map", "sampler2D", -1),
                            uniform("m.n", "int", -1), uniform("lamps[0].color", "vec3", 4),
                            uniform("lamps[0].power", "float[2]", 5), uniform("on", "bool", 20)}));
  EXPECT_NE(run("shaders reflect loose.vert").out.find("uniform mat4x4[2] 'view', location -1\n"), std::string::npos);
  write("bad.frag", "#version 450\nvoid main()\n{\n  x = 1;\n}\n");
  const Finished bad = run("shaders reflect bad.frag");
  EXPECT_EQ(bad.status, 1);
  EXPECT_NE(bad.err.find("bad.frag:4: "), std::string::npos) << bad.err;
  write("es.frag", "#version 100\nvoid main() { gl_FragColor = vec4(1.0); }\n");
  const Finished es = run("shaders reflect es.frag");
  EXPECT_EQ(es.status, 1);
  EXPECT_NE(es.err.find("no SPIR-V"), std::string::npos) << es.err;
  EXPECT_EQ(run("shaders reflect old.frag --variant USE_LIGHT").status, 2);
  EXPECT_EQ(run("shaders reflect eevee_lit -D N=1").status, 2);
}

const std::string VERSION = "#version 450 core\n";

TEST_F(ShadersTest, AUsersShaderIsCheckedFromAnyFolderWithItsIncludesAndDefines)
{
  write_file("user/shaders/sky.frag", VERSION +
                                          "#include \"lib/near.glsl\"\n#include \"far.glsl\"\n"
                                          "layout(location = 0) out vec4 color;\n"
                                          "void main() { color = vec4(near_value(), far_value(), COUNT, 1.0); }\n");
  write_file("user/shaders/lib/near.glsl", "#include \"beside.glsl\"\nfloat near_value() { return beside; }\n");
  write_file("user/shaders/lib/beside.glsl", "const float beside = 1.0;\n");
  write_file("user/more/far.glsl",
             "#ifdef BROKEN\nfloat broken = nothing;\n#endif\nfloat far_value() { return 2.0; }\n");
  // From a folder that is unrelated to the files.
  const std::string check = "shaders check user/shaders/sky.frag ";
  const Finished fine = run(check + "-I user/more -D COUNT=3");
  EXPECT_EQ(fine.status, 0) << fine.out << fine.err;
  EXPECT_EQ(fine.out.find("1 programs, 1 variants, Vulkan 1.2: 0 errors"), 0U) << fine.out;

  const Finished no_folder = run(check + "-D COUNT=3");
  EXPECT_EQ(no_folder.status, 1);
  EXPECT_EQ(no_folder.out.find("user/shaders/sky.frag:3: error: no shader file 'user/shaders/far.glsl' [include]"), 0U)
      << no_folder.out;
  const Finished no_define = run(check + "-I user/more");
  EXPECT_EQ(no_define.status, 1);
  EXPECT_EQ(no_define.out.find("user/shaders/sky.frag:5: error: 'COUNT'"), 0U) << no_define.out;
  const Finished broken = run(check + "-I user/more -D COUNT=3 -D BROKEN");
  EXPECT_EQ(broken.status, 1);
  EXPECT_EQ(broken.out.find("user/more/far.glsl:2: error: 'nothing' : undeclared identifier"), 0U) << broken.out;
}

TEST_F(ShadersTest, FilesOfOneNameAreLinked)
{
  write_file("user/a_vert.glsl", VERSION + "void main() { gl_Position = vec4(0.0); }\n");
  write_file("user/a_frag.glsl", VERSION +
                                     "layout(location = 0) in vec2 uv;\nlayout(location = 0) out vec4 color;\n"
                                     "void main() { color = vec4(uv, 0.0, 1.0); }\n");
  EXPECT_EQ(run("shaders check user/a_frag.glsl").status, 0) << "alone it may be right";
  const Finished finished = run("shaders check user/a_vert.glsl user/a_frag.glsl --target vulkan");
  EXPECT_EQ(finished.status, 1);
  EXPECT_EQ(finished.out.find("user/a_frag.glsl:2: error: input 'uv', location 0, is no output of the vertex stage"),
            0U)
      << finished.out;
}

TEST_F(ShadersTest, UnknownStageOfAFileIsWrongUsage)
{
  write_file("user/plain.glsl", VERSION + "void main() {}\n");
  const Finished asked = run("shaders check user/plain.glsl");
  EXPECT_EQ(asked.status, 2);
  EXPECT_NE(asked.err.find("--stage"), std::string::npos) << asked.err;
  EXPECT_EQ(run("shaders check user/plain.glsl --stage frag").status, 0);
}

TEST_F(ShadersTest, ASurfaceFunctionIsCheckedInTheProgramsThatDrawWithIt)
{
  const std::string head = "void surface(SurfaceInputs inputs, inout StandardSurface result)\n{\n";
  write_file("user/good.surface.glsl",
             head + "  result.base_color = texture(specular_texture, inputs.uv).rgb * inputs.position_ws;\n}\n");
  const Finished good = run("shaders check user/good.surface.glsl");
  EXPECT_EQ(good.status, 0) << good.out;
  EXPECT_NE(good.out.find(": 0 errors, 0 warnings"), std::string::npos) << good.out;
  write_file("user/bad_surface.glsl", head + "  result.base_colour = vec3(1.0);\n}\n");
  const Finished bad = run("shaders check user/good.surface.glsl user/bad_surface.glsl --target opengl");
  EXPECT_EQ(bad.status, 1);
  EXPECT_EQ(bad.out.find("user/bad_surface.glsl:3: error: 'base_colour'"), 0U) << bad.out;
  write_file("user/plain.glsl", "#include \"other.glsl\"\n" + head + "}\n");
  const Finished including = run("shaders check user/plain.glsl --stage surface");
  EXPECT_EQ(including.status, 1);
  EXPECT_EQ(including.out.find("user/plain.glsl:1: error: a surface function has no #include [include]"), 0U)
      << including.out;
  EXPECT_EQ(run("shaders check user/none.surface.glsl").status, 1);
}

TEST_F(ShadersTest, WarningsDoNotFail)
{
  write_file("a.frag", VERSION +
                           "layout(location = 0) in vec3 a;\nlayout(location = 0) out float angle;\n"
                           "layout(binding = 1) uniform sampler2D unread;\nvoid main() { angle = a.x; }\n");
  const Finished finished = run("shaders check a.frag");
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.out.find("a.frag:4: warning: texture 'unread' is declared and never read"), 0U) << finished.out;
}

TEST_F(ShadersTest, JsonHoldsTheMessageWithItsVariants)
{
  copy_tree();
  replace("eevee/eevee_depth_frag.glsl", "is_open) {\n    discard;\n",
          "is_open) {\n    float planted = undeclared_name;\n");
  const Finished finished = run("shaders check --shaders tree --program eevee_depth --format json");
  EXPECT_EQ(finished.status, 1);
  const nlohmann::json json = nlohmann::json::parse(finished.out);
  EXPECT_EQ(json["variants"], 4) << "without a mask, with one, with one of a full material, and this with clip planes";
  EXPECT_EQ(json["errors"], 1);
  ASSERT_EQ(json["messages"].size(), 1U);
  const nlohmann::json &message = json["messages"][0];
  EXPECT_EQ(message["severity"], "error");
  EXPECT_EQ(message["file"], "tree/eevee/eevee_depth_frag.glsl");
  EXPECT_EQ(message["line"], line_of(read("tree/eevee/eevee_depth_frag.glsl"), "planted"));
  EXPECT_EQ(message["rule"], "compile");
  EXPECT_EQ(message["where"].size(), 6) << "three variants, two targets";
  for (const nlohmann::json &where : message["where"]) {
    EXPECT_NE(where["variant"].get<std::string>().find("USE_ALPHA_MASK"), std::string::npos);
  }
}

TEST_F(ShadersTest, SarifHoldsRulesAndThePlace)
{
  write_file("with space/a.frag", VERSION + "void main() { return 1; }\n");
  const Finished finished = run("shaders check 'with space/a.frag' --format sarif");
  EXPECT_EQ(finished.status, 1);
  const nlohmann::json json = nlohmann::json::parse(finished.out);
  EXPECT_EQ(json["version"], "2.1.0");
  const nlohmann::json &run = json["runs"][0];
  ASSERT_EQ(run["results"].size(), 1U);
  const nlohmann::json &result = run["results"][0];
  EXPECT_EQ(result["level"], "error");
  EXPECT_NE(result["message"]["text"].get<std::string>().find("void function cannot return a value"),
            std::string::npos);
  const nlohmann::json &place = result["locations"][0]["physicalLocation"];
  EXPECT_EQ(place["artifactLocation"]["uri"], "with%20space/a.frag");
  EXPECT_EQ(place["region"]["startLine"], 2);
  const nlohmann::json &rules = run["tool"]["driver"]["rules"];
  EXPECT_TRUE(std::ranges::any_of(rules, [&](const nlohmann::json &rule) { return rule["id"] == result["ruleId"]; }));
}

TEST_F(ShadersTest, WrongUsageHasStatusTwoAndMissingFilesStatusOne)
{
  for (const std::string arguments :
       {"shaders", "shaders paint", "shaders check --format xml", "shaders check --target metal", "shaders check -D A",
        "shaders check a.frag --shaders tree", "shaders check a.frag -D =1", "shaders check a.frag -D 1X=2",
        "shaders check a.frag -D 'A(x=1'", "shaders reflect"}) {
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.status, 2) << arguments;
    EXPECT_FALSE(finished.err.empty()) << arguments;
  }
  const Finished folder_missing = run("shaders check --shaders nowhere");
  EXPECT_EQ(folder_missing.status, 1);
  EXPECT_NE(folder_missing.err.find("nowhere"), std::string::npos);
  const Finished file_missing = run("shaders check nowhere.frag");
  EXPECT_EQ(file_missing.status, 1);
  EXPECT_EQ(file_missing.out.find("nowhere.frag:1: error: "), 0U) << file_missing.out;
  std::filesystem::create_directory(folder / "empty");
  EXPECT_EQ(run("shaders check --shaders empty").status, 1);
}

}  // namespace
}  // namespace gnomon
