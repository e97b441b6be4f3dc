// SPDX-License-Identifier: MIT
#include "measure_stability.hh"

#include "internal/measure_contract.hh"
#include "internal/measure_gltf.hh"
#include "internal/measure_scene.hh"

#include "gltf_import.hh"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace gnomon::measure {

namespace {

using nlohmann::json;

/** What a door has to do with a value. */
enum class Wanted {
  /** Take it, and hand on what is within the contract. */
  Kept,
  /** Leave it out or mend it, with a warning or limit that names it. */
  Named,
  /** Throw, with one line that names it. */
  Refused,
};

/** A value at a door. */
template <typename T = double>
struct Try {
  /** As the sample gives it. */
  double parameter = 0.0;
  T value{};
  Wanted wanted = Wanted::Kept;
};

using Numbers = std::vector<Try<>>;

/** For numbers, which are their own parameter. */
Numbers tries(std::initializer_list<double> values, Wanted wanted)
{
  Numbers result;
  for (const double value : values) {
    result.push_back({value, value, wanted});
  }
  return result;
}

Numbers operator+(Numbers a, const Numbers &b)
{
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/** What came through a door. */
struct Passed {
  /** Values that are not as the contract has them. */
  std::size_t fault_count = 0;
  /** Warnings and limits. */
  std::vector<std::string> messages;
};

/** Faults of a door: what it let through, a word that was not said, a refusal that was not wanted. */
double door_error(Wanted wanted, const std::string &word, const std::function<Passed()> &pass)
{
  const auto names_it = [&](const std::string &message) {
    return message.find(word) != message.npos && message.find('\n') == message.npos;
  };
  try {
    const Passed passed = pass();
    const bool is_silent = wanted == Wanted::Named && !std::ranges::any_of(passed.messages, names_it);
    return double(passed.fault_count) + (wanted == Wanted::Refused || is_silent ? 1.0 : 0.0);
  }
  catch (const gnomon::gltf::ImportError &error) {
    return wanted == Wanted::Refused && names_it(error.what()) ? 0.0 : 1.0;
  }
  catch (const scene::InvalidEdit &error) {
    return wanted == Wanted::Refused && names_it(error.what()) ? 0.0 : 1.0;
  }
  catch (const gpu::Error &error) {
    return wanted == Wanted::Refused && names_it(error.what()) ? 0.0 : 1.0;
  }
}

/** \a word: what messages have to hold. \a pass: what is done with a value. */
template <typename T>
StabilityCase door_case(std::string group, std::string name, std::string quantity, std::string parameter,
                        std::string word, std::vector<Try<T>> values, std::function<Passed(const T &)> pass)
{
  StabilityCase one;
  one.group = std::move(group);
  one.name = std::move(name);
  one.quantity = std::move(quantity);
  one.parameter = std::move(parameter);
  one.reference = "contract of the door";
  one.unit = "faults";
  one.bound = 0.0;
  one.run = [word = std::move(word), values = std::move(values), pass = std::move(pass)] {
    std::vector<StabilitySample> samples;
    for (const Try<T> &each : values) {
      samples.push_back({each.parameter, door_error(each.wanted, word, [&] { return pass(each.value); })});
    }
    return samples;
  };
  return one;
}

// ---- Files ----

Passed import_text(const std::string &text)
{
  const gltf::TemporaryFolder folder;
  const scene::Scene scene = gnomon::gltf::import_gltf(folder.write("scene.gltf", text));
  return {contract_faults(scene).size(), scene.warnings};
}

/** Places of the nodes in small_scene. */
enum Node : int { Thing, Eye, Flat, Bulb, Sun, Spot, Panel };

/** One of everything that has numbers. */
gltf::GltfBuilder small_scene()
{
  gltf::GltfBuilder builder = gltf::triangle_scene();
  builder.document["meshes"][0]["primitives"][0]["material"] = 0;
  builder.append("materials", {{"name", "paint"},
                               {"pbrMetallicRoughness", json::object()},
                               {"extensions",
                                {{"KHR_materials_specular", json::object()},
                                 {"KHR_materials_emissive_strength", json::object()},
                                 {"KHR_materials_ior", json::object()}}}});
  builder.document["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}, {"zfar", 10.0}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 1.0}, {"ymag", 1.0}, {"znear", 0.0}, {"zfar", 10.0}}}}};
  builder.node({{"name", "eye"}, {"camera", 0}, {"translation", {0, 0, 5}}});
  builder.node({{"name", "flat"}, {"camera", 1}, {"translation", {0, 0, 5}}});
  builder.light({{"type", "point"}, {"intensity", 100.0}}, json::object());
  builder.light({{"type", "directional"}, {"intensity", 100.0}}, json::object());
  builder.light({{"type", "spot"}, {"intensity", 100.0}, {"spot", json::object()}}, json::object());
  builder.node({{"name", "panel"}, {"extras", {{"gnomon_lamp", "area"}}}});
  return builder;
}

/** small_scene with one number changed. \a path: an RFC 6901 pointer. */
StabilityCase number_case(const std::string &name, const std::string &path, const std::string &unit,
                          const std::string &word, Numbers values)
{
  return door_case<double>("gltf", name, "scene of a file with that value at " + path, unit, word, std::move(values),
                           [path](const double &value) {
                             gltf::GltfBuilder builder = small_scene();
                             builder.document[json::json_pointer(path)] = value;
                             return import_text(builder.gltf());
                           });
}

std::string light_path(int light, const std::string &key)
{
  return "/extensions/KHR_lights_punctual/lights/" + std::to_string(light) + "/" + key;
}

std::string extra_path(int node, const std::string &key)
{
  return "/nodes/" + std::to_string(node) + "/extras/" + key;
}

void add_lamp_cases(std::vector<StabilityCase> &cases)
{
  constexpr Wanted kept = Wanted::Kept;
  constexpr Wanted refused = Wanted::Refused;
  // Beyond what a product of two such numbers leaves finite, below 0, and beyond float.
  const Numbers outside = tries({-1e300, -1.0, -1e-300, 1.01e12, 1e38, 1e39, 1e300}, refused);
  const Numbers not_negative = tries({0.0, 5e-324, 1e-300, 1e-40, 1.0, 1e12}, kept) + outside;
  const Numbers length = tries({1e-12, 1.0, 1e12}, kept) + tries({5e-324, 1e-300, 1e-40, 9e-13}, refused) + outside;
  for (const auto &[light, kind] : {std::pair(0, "point"), {1, "sun"}, {2, "spot"}}) {
    cases.push_back(number_case(fmt::format("{} intensity", kind), light_path(light, "intensity"), "cd or lux",
                                "intensity is", not_negative));
  }
  cases.push_back(number_case("point range", light_path(0, "range"), "m", "range is", length + tries({0.0}, kept)));
  cases.push_back(number_case(
      "spot outer cone", light_path(2, "spot/outerConeAngle"), "rad", "outerConeAngle is",
      tries({1e-9, 1e-3, 1.0, 1.5707963}, kept) + tries({-1.0, 0.0, 1e-300, 1e-46, 1.58, 3.2, 1e300}, refused)));
  cases.push_back(number_case("spot inner cone", light_path(2, "spot/innerConeAngle"), "rad", "innerConeAngle is",
                              tries({0.0, 1e-300, 0.7}, kept) + tries({-1.0, -1e-300, 0.8, 1e300}, refused)));
  cases.push_back(door_case<double>("gltf", "lamp color", "scene of a file with that factor in a lamp's colour",
                                    "factor", "color is", not_negative, [](const double &value) {
                                      gltf::GltfBuilder builder = small_scene();
                                      builder.document[json::json_pointer(light_path(0, "color"))] = {1.0, value, 0.5};
                                      return import_text(builder.gltf());
                                    }));
  struct Extra {
    int node;
    const char *key;
    const char *unit;
    Numbers values;
  };
  const Numbers texels = tries({1.0, 4.0, 16384.0}, kept) + tries({-1.0, 0.0, 0.5, 4.5, 16385.0, 1e300}, refused);
  const std::vector<Extra> extras = {
      {Bulb, "gnomon_radius", "m", not_negative},
      {Sun, "gnomon_angle", "rad", tries({0.0, 1e-300, 3.14159}, kept) + tries({-1.0, 3.15, 1e300}, refused)},
      {Spot, "gnomon_spot_blend", "", tries({0.0, 1e-300, 1.0}, kept) + tries({-1e-300, -1.0, 1.01, 1e300}, refused)},
      {Bulb, "gnomon_shadow_size", "texels", texels},
      {Bulb, "gnomon_esm_size", "texels", texels},
      {Bulb, "gnomon_exponent", "1/m",
       tries({0.01, 1.0, 1e4}, kept) + tries({-1.0, 0.0, 1e-300, 0.0099, 10001.0, 1e300}, refused)},
      {Bulb, "gnomon_bias", "", tries({0.0, 1e-300, 100.0}, kept) + tries({-1e-300, -1.0, 101.0, 1e300}, refused)},
      {Bulb, "gnomon_clip_start", "m", length},
      {Bulb, "gnomon_clip_end", "m", length},
      {Bulb, "gnomon_filter_radius", "degrees",
       tries({0.0, 1e-300, 45.0}, kept) + tries({-1e-300, -1.0, 45.1, 1e300}, refused)},
      {Panel, "gnomon_size_x", "m", length},
      {Panel, "gnomon_size_y", "m", length},
      {Panel, "gnomon_power", "W", not_negative},
  };
  for (const Extra &extra : extras) {
    cases.push_back(number_case(extra.key, extra_path(extra.node, extra.key), extra.unit,
                                std::string(extra.key) + " is", extra.values));
  }
  cases.push_back(door_case<json>(
      "gltf", "extras of a wrong type", "scene of a file whose gnomon_exponent is no number",
      "1 string, 2 true, 3 null, 4 array, 5 object", "gnomon_exponent is",
      {{1, "1", refused}, {2, true, refused}, {3, nullptr, refused}, {4, {1.0}, refused}, {5, json::object(), refused}},
      [](const json &value) {
        gltf::GltfBuilder builder = small_scene();
        builder.document[json::json_pointer(extra_path(Bulb, "gnomon_exponent"))] = value;
        return import_text(builder.gltf());
      }));
  cases.push_back(door_case<int>("gltf", "lamp count", "scene of a file with so many lamps", "lamps", "no lamp",
                                 {{0, 0, Wanted::Named}, {1, 1}, {255, 255}, {256, 256}, {2000, 2000}},
                                 [](const int &count) {
                                   gltf::GltfBuilder builder = gltf::triangle_scene();
                                   for (int i = 0; i < count; i++) {
                                     builder.light({{"type", "point"}});
                                   }
                                   return import_text(builder.gltf());
                                 }));
}

void add_camera_cases(std::vector<StabilityCase> &cases)
{
  const auto add = [&](const char *name, const char *path, const char *unit, const char *word,
                       std::initializer_list<double> kept, std::initializer_list<double> left_out) {
    cases.push_back(number_case(name, path, unit, word, tries(kept, Wanted::Kept) + tries(left_out, Wanted::Named)));
  };
  add("camera angle", "/cameras/0/perspective/yfov", "rad", "left out: yfov", {1e-5, 1.0, 3.1415},
      {-1e300, -1.0, 0.0, 1e-300, 3.1416, 7.0, 1e300});
  add("camera near", "/cameras/0/perspective/znear", "m", "left out: z", {1e-12, 1e-6, 9.0},
      {-1.0, 0.0, 1e-300, 1e-13, 10.0, 11.0, 1e300});
  add("camera far", "/cameras/0/perspective/zfar", "m", "left out: zfar", {0.0, 0.2, 1e9, 1e12},
      {-1.0, 1e-300, 0.1, 1.1e12, 1e300});
  add("camera aspect", "/cameras/0/perspective/aspectRatio", "", "left out: aspectRatio", {0.0, 1e-5, 1.0, 1e6},
      {-1.0, 1e-300, 1e7, 1e300});
  add("camera width", "/cameras/1/orthographic/xmag", "m", "left out: xmag", {1e-12, 1.0, 1e12},
      {-1.0, 0.0, 1e-300, 1e-13, 1e13, 1e300});
  add("parallel near", "/cameras/1/orthographic/znear", "m", "left out: z", {0.0, 1e-300, 9.0},
      {-1.0, 10.0, 11.0, 1e300});
  add("parallel far", "/cameras/1/orthographic/zfar", "m", "left out: zfar", {1e-6, 1e12}, {-1.0, 0.0, 1e-300, 1e300});
}

void add_material_cases(std::vector<StabilityCase> &cases)
{
  const std::string material = "/materials/0/";
  const Numbers share = tries({0.0, 5e-324, 1e-40, 1.0}, Wanted::Kept) +
                        tries({-1e300, -1.0, -1e-300, 1.0001, 1e39, 1e300}, Wanted::Named);
  const Numbers open = tries({0.0, 5e-324, 1.0, 1e9}, Wanted::Kept) + tries({-1.0, 1.01e9, 1e39, 1e300}, Wanted::Named);
  const auto add = [&](const std::string &name, const std::string &path, const Numbers &values) {
    cases.push_back(number_case(name, material + path, "factor", path.substr(path.rfind('/') + 1) + " is", values));
  };
  add("metallic", "pbrMetallicRoughness/metallicFactor", share);
  add("roughness", "pbrMetallicRoughness/roughnessFactor", share);
  add("alpha cutoff", "alphaCutoff", share);
  add("specular", "extensions/KHR_materials_specular/specularFactor", share);
  add("emissive strength", "extensions/KHR_materials_emissive_strength/emissiveStrength", open);
  add("ior", "extensions/KHR_materials_ior/ior",
      tries({0.0, 1.0, 1.5, 1e9, 1e300}, Wanted::Kept) + tries({-1e300, -1.0, 1e-300, 0.99}, Wanted::Named));
  const auto add_color = [&](const std::string &name, const std::string &path, const json &color,
                             const Numbers &values) {
    cases.push_back(door_case<double>("gltf", name, "scene of a file with that factor in " + path, "factor",
                                      path.substr(path.rfind('/') + 1) + " is", values,
                                      [path = material + path, color](const double &value) {
                                        gltf::GltfBuilder builder = small_scene();
                                        json changed = color;
                                        changed[1] = value;
                                        builder.document[json::json_pointer(path)] = changed;
                                        return import_text(builder.gltf());
                                      }));
  };
  add_color("base color", "pbrMetallicRoughness/baseColorFactor", {0.5, 0.5, 0.5, 1.0}, share);
  add_color("emissive", "emissiveFactor", {0.5, 0.5, 0.5}, share);
  add_color("specular color", "extensions/KHR_materials_specular/specularColorFactor", {0.5, 0.5, 0.5}, open);
}

/** A good triangle, and one beside it of which \a spoil changes the last corner's x. */
gltf::GltfBuilder two_triangles(float x)
{
  gltf::GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, x, 1, 1});
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}})}});
  return builder;
}

constexpr const char *float_kinds = "1 NaN, 2 infinity, 3 -infinity, 4 1e30, 5 1e-40, 6 0, 7 largest float";

std::vector<Try<float>> odd_floats(std::initializer_list<int> kept, Wanted otherwise)
{
  using Float = std::numeric_limits<float>;
  const std::array<float, 7> values = {Float::quiet_NaN(), Float::infinity(), -Float::infinity(), 1e30F, 1e-40F, 0.0F,
                                       Float::max()};
  std::vector<Try<float>> result;
  for (int i = 1; i <= 7; i++) {
    const bool is_kept = std::ranges::find(kept, i) != kept.end();
    result.push_back({double(i), values[std::size_t(i) - 1], is_kept ? Wanted::Kept : otherwise});
  }
  return result;
}

void add_mesh_cases(std::vector<StabilityCase> &cases)
{
  const auto add_floats = [&](const char *name, const char *quantity, const char *word, std::vector<Try<float>> values,
                              std::function<gltf::GltfBuilder(float)> make) {
    cases.push_back(door_case<float>("gltf", name, quantity, float_kinds, word, std::move(values),
                                     [make = std::move(make)](const float &x) { return import_text(make(x).gltf()); }));
  };
  add_floats("positions", "scene of a file with such a coordinate", "a position is not finite",
             odd_floats({5, 6}, Wanted::Named), two_triangles);
  add_floats("normals", "scene of a file with such normals", "normal replaced", odd_floats({4, 5, 7}, Wanted::Named),
             [](float x) {
               gltf::GltfBuilder builder = two_triangles(0.0F);
               builder.document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = builder.accessor(
                   std::vector<float>{0, 0, 1, 0, 0, 1, x, x, x, 0, 0, 1, 0, 0, 1, 0, x, 0}, gltf::Float32, "VEC3");
               return builder;
             });
  add_floats("texture coordinates", "scene of a file with such texture coordinates", "texture coordinate replaced",
             odd_floats({5, 6}, Wanted::Named), [](float x) {
               gltf::GltfBuilder builder = two_triangles(0.0F);
               json &primitive = builder.document["meshes"][0]["primitives"][0];
               primitive["material"] = 0;
               primitive["attributes"]["TEXCOORD_0"] =
                   builder.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, x, 0, 0, x}, gltf::Float32, "VEC2");
               builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
               builder.append("textures", {{"source", 0}});
               // One white texel.
               builder.append("images",
                              {{"uri",
                                "data:image/png;base64,"
                                "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAA"
                                "AABJRU5ErkJggg=="}});
               return builder;
             });
  // Corners of the second triangle along a line; the last is off it by the parameter.
  cases.push_back(door_case<float>(
      "gltf", "flat triangles", "scene of a file with a triangle of that height", "m", "it has no area",
      {{0.0, 0.0F, Wanted::Named}, {1e-40, 1e-40F}, {1e-30, 1e-30F}, {1e-7, 1e-7F}, {1.0, 1.0F}},
      [](const float &height) {
        gltf::GltfBuilder builder;
        const int positions = builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 2, height, 0});
        builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}})}});
        return import_text(builder.gltf());
      }));
  cases.push_back(door_case<std::uint32_t>(
      "gltf", "vertex indices", "scene of a file with that index", "index", "a vertex index is out of range",
      {{0, 0, Wanted::Named}, {5, 5}, {6, 6, Wanted::Named}, {4294967295.0, 0xFFFFFFFFU, Wanted::Named}},
      [](const std::uint32_t &index) {
        gltf::GltfBuilder builder = two_triangles(0.0F);
        builder.document["meshes"][0]["primitives"][0]["indices"] =
            builder.accessor(std::vector<std::uint32_t>{0, 1, 2, 3, 4, index}, gltf::Uint32, "SCALAR");
        // Index 0 makes a triangle between the two; it is only there to be kept.
        Passed passed = import_text(builder.gltf());
        if (index == 0) {
          passed.messages.emplace_back("a vertex index is out of range");
        }
        return passed;
      }));
}

void add_node_cases(std::vector<StabilityCase> &cases)
{
  const auto add_matrices = [&](const char *name, const char *parameter, const char *word,
                                std::vector<Try<json>> values) {
    cases.push_back(door_case<json>("gltf", name, "scene of a file with that node, an object, lamp or camera on it",
                                    parameter, word, std::move(values), [](const json &place) {
                                      Passed all;
                                      for (const int node : {Thing, Eye, Bulb, Sun, Spot, Panel}) {
                                        gltf::GltfBuilder builder = small_scene();
                                        // Something is left where this is left out.
                                        builder.node({{"mesh", 0}});
                                        json &changed = builder.document["nodes"][node];
                                        changed.erase("translation");
                                        changed.update(place);
                                        const Passed passed = import_text(builder.gltf());
                                        all.fault_count += passed.fault_count;
                                        all.messages.insert(all.messages.end(), passed.messages.begin(),
                                                            passed.messages.end());
                                      }
                                      return all;
                                    }));
  };
  const auto matrix = [](std::initializer_list<double> columns, double x = 0.0, double bottom = 0.0) {
    json values = columns;
    for (const int at : {3, 7, 11}) {
      values.insert(values.begin() + at, bottom);
    }
    values.insert(values.end(), {x, 0.0, 0.0, 1.0});
    return json{{"matrix", values}};
  };
  constexpr Wanted named = Wanted::Named;
  add_matrices("node matrices", "1 sheared, 2 mirrored, 3 flat, 4 a line, 5 zero, 6 1e-40, 7 1e12, 8 a slight shear",
               "matrix",
               {{1, matrix({1, 0, 0, 5, 1, 0, 0, 3, 1})},
                {2, matrix({-1, 0, 0, 0, 1, 0, 0, 0, 1})},
                {3, matrix({1, 0, 0, 0, 1, 0, 0, 0, 0})},
                {4, matrix({1, 0, 0, 1, 0, 0, 1, 0, 0})},
                {5, matrix({0, 0, 0, 0, 0, 0, 0, 0, 0})},
                {6, matrix({1e-40, 0, 0, 0, 1e-40, 0, 0, 0, 1e-40})},
                {7, matrix({1e11, 0, 0, 0, 1e11, 0, 0, 0, 1e11})},
                {8, matrix({1, 0, 0, 1, 1e-30, 0, 0, 0, 1})}});
  add_matrices("node matrices out of range", "1 1e13 m, 2 1e300, 3 -1e300 m, 4 a last row", "matrix",
               {{1, matrix({1, 0, 0, 0, 1, 0, 0, 0, 1}, 1e13), named},
                {2, matrix({1e300, 0, 0, 0, 1e300, 0, 0, 0, 1e300}), named},
                {3, matrix({1, 0, 0, 0, 1, 0, 0, 0, 1}, -1e300), named},
                {4, matrix({1, 0, 0, 0, 1, 0, 0, 0, 1}, 0.0, 0.5), named}});
  add_matrices("node rotations", "1 zero, 2 1e-300, 3 1e300", "rotation has no length",
               {{1, {{"rotation", {0, 0, 0, 0}}}, named},
                {2, {{"rotation", {1e-300, 0, 0, 1e-300}}}},
                {3, {{"rotation", {1e300, 0, 0, 1e300}}}}});
  add_matrices("node scales", "1 zero, 2 1e-300, 3 1e300, 4 1e-20 of 1e20", "left out",
               {{1, {{"scale", {0, 0, 0}}}},
                {2, {{"scale", {1e-300, 1, 1}}}},
                {3, {{"scale", {1e300, 1, 1}}}, named},
                {4, {{"scale", {1e-20, 1e11, -1e11}}}}});
  // A number that JSON has and no float: one place after another.
  const std::vector<std::string> paths = {"/nodes/0/translation",
                                          light_path(0, "intensity"),
                                          light_path(2, "spot/outerConeAngle"),
                                          "/cameras/0/perspective/yfov",
                                          "/materials/0/pbrMetallicRoughness/metallicFactor",
                                          extra_path(Bulb, "gnomon_exponent")};
  std::vector<Try<std::string>> places;
  for (const std::string &path : paths) {
    places.push_back({double(places.size() + 1), path, Wanted::Refused});
  }
  cases.push_back(
      door_case<std::string>("gltf", "1e999", "scene of a file with a number beyond double", "place", "JSON", places,
                             [](const std::string &path) {
                               gltf::GltfBuilder builder = small_scene();
                               const bool is_vector = path.ends_with("translation");
                               builder.document[json::json_pointer(path)] = is_vector ? json{0, "@", 0} : json("@");
                               std::string text = builder.gltf();
                               text.replace(text.find("\"@\""), 3, "1e999");
                               return import_text(text);
                             }));
}

// ---- Settings, and what a host hands over ----

/** A ground, a box above it, and a lamp of each kind that has a shadow. */
scene::Scene lit_scene()
{
  scene::Scene scene;
  const auto material = add_material(scene, glm::vec3(0.8F));
  add_object(scene, add_square_mesh(scene, material), glm::scale(glm::mat4(1.0F), glm::vec3(4.0F)));
  add_object(scene, add_box_mesh(scene, material), glm::translate(glm::mat4(1.0F), {0, 0, 2}));
  add_lamp(scene, scene::LampKind::Point, {1, 0, 5}, {0, 0, -1}, 10.0F);
  add_lamp(scene, scene::LampKind::Sun, {}, {0.2F, 0, -1}, 1.0F);
  add_lamp(scene, scene::LampKind::Spot, {-1, 0, 5}, {0, 0, -1}, 10.0F);
  return scene;
}

const scene::PlacedCamera &lit_camera()
{
  static const scene::PlacedCamera camera = camera_at({0, -6, 4}, {0, 0, 0});
  return camera;
}

/** Settings so small that a null device is asked for little. */
eevee::Settings small_settings(scene::ShadowKind kind = scene::ShadowKind::Hard)
{
  eevee::Settings settings;
  settings.shadow.kind = kind;
  settings.shadow.cube_size_px = settings.shadow.map_size_px = 16;
  settings.shadow.esm.size_px = 32;
  return settings;
}

std::size_t non_finite(std::initializer_list<float> values)
{
  return std::size_t(std::ranges::count_if(values, [](float value) { return !std::isfinite(value); }));
}

std::size_t non_finite(const glm::mat4 &matrix)
{
  std::size_t count = 0;
  for (int column = 0; column < 4; column++) {
    count += non_finite({matrix[column].x, matrix[column].y, matrix[column].z, matrix[column].w});
  }
  return count;
}

/** What the shaders would read that is not finite. */
std::size_t shadow_block_faults(const eevee::Shadows &shadows)
{
  std::size_t count = 0;
  for (const shared::ShadowCubeData &cube : shadows.block_data().cubes) {
    count += non_finite({cube.near, cube.far, cube.texel_size, cube.bias});
  }
  for (const shared::ShadowMapData &map : shadows.block_data().maps) {
    count += non_finite(map.texco_from_world) + non_finite({map.texel_size, map.rounding, map.far, map.bias});
  }
  for (std::size_t i = 0; i < shadows.scene().octahedral().size(); i++) {
    const shared::EsmData &data = shadows.scene().octahedral().data(i);
    count += non_finite({data.exponent, data.bias, data.range, data.filter_angle});
  }
  return count;
}

/** A frame on a device that draws nothing. */
Passed draw_on_null(const scene::Scene &scene, const eevee::Settings &settings, glm::ivec2 size_px = {16, 16},
                    std::optional<float> exposure = std::nullopt)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  std::optional<draw::TargetTexture> display;
  draw::Target target;
  if (exposure) {
    display.emplace(*device, "display", gpu::Format::RGBA8, size_px);
    target = display->target();
    target.exposure = *exposure;
  }
  Renderer renderer(*device, scene, size_px, settings);
  renderer.draw(lit_camera(), target);
  const eevee::Report report = renderer.engine.report(renderer.viewport);
  Passed passed{shadow_block_faults(renderer.engine.shadows(renderer.viewport)), report.limits};
  passed.messages.insert(passed.messages.end(), report.warnings.begin(), report.warnings.end());
  return passed;
}

void add_settings_cases(std::vector<StabilityCase> &cases)
{
  constexpr Wanted refused = Wanted::Refused;
  const auto add = [&](const char *name, const char *unit, const char *word, Numbers values,
                       std::function<void(eevee::Settings &, double)> set,
                       scene::ShadowKind kind = scene::ShadowKind::Hard) {
    cases.push_back(door_case<double>("settings", name, "frame by those settings", unit, word, std::move(values),
                                      [set = std::move(set), kind](const double &value) {
                                        eevee::Settings settings = small_settings(kind);
                                        set(settings, value);
                                        return draw_on_null(lit_scene(), settings);
                                      }));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  // NaN is no parameter to print: it stands at -1e9 there.
  const auto with_nan = [&](Numbers values) { return values + Numbers{{-1e9, nan, refused}}; };
  const Numbers sizes =
      tries({1, 2, 16, 16384}, Wanted::Kept) + tries({-1, 0}, refused) + tries({16385, 2147483647}, Wanted::Named);
  add("cube size", "texels", "size", sizes, [](eevee::Settings &s, double v) {
    s.shadow.cube_size_px = int(v);
    s.shadow.memory_bytes_max = std::size_t(1) << 40U;
  });
  add("map size", "texels", "size", sizes, [](eevee::Settings &s, double v) {
    s.shadow.map_size_px = int(v);
    s.shadow.memory_bytes_max = std::size_t(1) << 40U;
  });
  add(
      "octahedral size", "texels", "size", tries({4, 512, 8192}, Wanted::Kept) + tries({-1, 0, 3, 8193}, refused),
      [](eevee::Settings &s, double v) {
        s.shadow.esm.size_px = int(v);
        s.shadow.memory_bytes_max = std::size_t(1) << 40U;
      },
      scene::ShadowKind::Esm);
  add("shadow memory", "bytes", "sizes are lowered",
      tries({1e9}, Wanted::Kept) + tries({0, 1, 1000, 10000}, Wanted::Named),
      [](eevee::Settings &s, double v) { s.shadow.memory_bytes_max = std::size_t(v); });
  add(
      "exponent", "1/m", "exponent",
      with_nan(tries({0.01, 1, 1e4}, Wanted::Kept) + tries({-1, 0, 1e-40, 0.0099, 10001, 1e38}, refused)),
      [](eevee::Settings &s, double v) { s.shadow.esm.exponent = float(v); }, scene::ShadowKind::Esm);
  add(
      "bias of exponential maps", "", "bias",
      with_nan(tries({0, 1, 1e3}, Wanted::Kept) + tries({-1, 1001, 1e38}, refused)),
      [](eevee::Settings &s, double v) { s.shadow.esm.bias = float(v); }, scene::ShadowKind::Evsm);
  add(
      "filter angle", "rad", "filter angle",
      with_nan(tries({0, 1e-40, 0.5}, Wanted::Kept) + tries({-1, 0.51, 1e38}, refused)),
      [](eevee::Settings &s, double v) { s.shadow.esm.filter_angle = float(v); }, scene::ShadowKind::Esm);
  add("cascades", "maps a sun", "cascades", tries({0, 1, 4}, Wanted::Kept) + tries({-1, 5, 100, 1000000}, refused),
      [](eevee::Settings &s, double v) { s.shadow.cascades.count = int(v); });
  add("cascade lambda", "", "lambda", with_nan(tries({0, 0.8, 1}, Wanted::Kept) + tries({-0.1, 1.1, 1e38}, refused)),
      [](eevee::Settings &s, double v) {
        s.shadow.cascades.count = 4;
        s.shadow.cascades.lambda = float(v);
      });
  add(
      "pcf width", "texels", "pcf", tries({0, 1, 3, 5}, Wanted::Kept) + tries({-1, 2, 7, 1000}, refused),
      [](eevee::Settings &s, double v) { s.shadow.pcf.width = int(v); }, scene::ShadowKind::Pcf);
  add(
      "pcf taps", "lookups", "pcf", tries({1, 64}, Wanted::Kept) + tries({-1, 0, 65, 1e6}, refused),
      [](eevee::Settings &s, double v) { s.shadow.pcf = {.width = 0, .taps = int(v)}; }, scene::ShadowKind::Pcf);
  add("samples", "samples a pixel", "sample_count", tries({1, 2, 64}, Wanted::Kept) + tries({-1, 0}, refused),
      [](eevee::Settings &s, double v) { s.sample_count = int(v); });
  cases.push_back(door_case<double>("settings", "exposure", "frame with such a target", "stops", "exposure",
                                    with_nan(tries({-100, 0, 100}, Wanted::Kept) + tries({-1e9, 128, 1e38}, refused)),
                                    [](const double &v) {
                                      return draw_on_null(lit_scene(), small_settings(), {16, 16}, float(v));
                                    }));
  cases.push_back(door_case<glm::ivec2>(
      "settings", "viewport", "frame of that size",
      "1 1x1, 2 16384x1, 3 1x16384, 4 16384x16384, 5 0x1, 6 1x0, 7 -1x1, 8 16385x1, 9 1x16385", "viewport: ",
      {{1, {1, 1}},
       {2, {16384, 1}},
       {3, {1, 16384}},
       {4, {16384, 16384}},
       {5, {0, 1}, refused},
       {6, {1, 0}, refused},
       {7, {-1, 1}, refused},
       {8, {16385, 1}, refused},
       {9, {1, 16385}, refused}},
      [](const glm::ivec2 &size_px) {
        // Nothing is read back: 16384x16384 would be 4 GiB.
        return draw_on_null(lit_scene(), small_settings(), size_px);
      }));
}

/** \a lamp changed, of a scene made by a host. */
void add_host_lamp_cases(std::vector<StabilityCase> &cases)
{
  constexpr Wanted refused = Wanted::Refused;
  const auto add = [&](const char *name, const char *unit, const char *word, scene::ShadowKind kind, Numbers values,
                       std::function<void(scene::LampShadow &, double)> set) {
    cases.push_back(door_case<double>("host", name, "frame of a scene with such a lamp", unit, word, std::move(values),
                                      [set = std::move(set), kind](const double &value) {
                                        scene::Scene scene = lit_scene();
                                        scene.edit(scene.lamps().first(),
                                                   [&](scene::Lamp &lamp) { set(lamp.shadow, value); });
                                        return draw_on_null(scene, small_settings(kind));
                                      }));
  };
  add("lamp's shadow size", "texels", "'lamp0'", scene::ShadowKind::Hard,
      tries({1, 16, 1024}, Wanted::Kept) + tries({-1, 0}, refused) + tries({16385}, Wanted::Named),
      [](scene::LampShadow &shadow, double v) { shadow.size = int(v); });
  add("lamp's octahedral size", "texels", "lamp 'lamp0': size", scene::ShadowKind::Esm,
      tries({4, 64}, Wanted::Kept) + tries({-1, 0, 3, 8193}, refused),
      [](scene::LampShadow &shadow, double v) { shadow.esm_size = int(v); });
  add("lamp's exponent", "1/m", "lamp 'lamp0': exponent", scene::ShadowKind::Esm,
      tries({0.01, 1e4}, Wanted::Kept) + tries({-1, 0, 1e-40, 10001, 1e38}, refused),
      [](scene::LampShadow &shadow, double v) { shadow.exponent = float(v); });
  add("lamp's filter", "rad", "lamp 'lamp0': filter angle", scene::ShadowKind::Evsm,
      tries({0, 0.5}, Wanted::Kept) + tries({-1, 0.51, 1e38}, refused),
      [](scene::LampShadow &shadow, double v) { shadow.filter_radius = float(v); });
  // glTF's length_range: what an importer lets in.
  add("lamp's clip distances", "m", "", scene::ShadowKind::Hard, tries({1e-12, 1e-6, 1.0, 1e6, 1e12}, Wanted::Kept),
      [](scene::LampShadow &shadow, double v) {
        shadow.clip_start = float(v);
        shadow.clip_end = float(2.0 * v);
      });

  struct Count {
    const char *name;
    scene::LampKind kind;
    scene::ShadowKind shadow;
    int most;
  };
  for (const Count &count : {Count{"points", scene::LampKind::Point, scene::ShadowKind::None, LIGHT_MAX},
                             {"suns", scene::LampKind::Sun, scene::ShadowKind::None, LIGHT_MAX},
                             {"spots", scene::LampKind::Spot, scene::ShadowKind::None, LIGHT_MAX},
                             {"hemis", scene::LampKind::Hemi, scene::ShadowKind::None, LIGHT_MAX},
                             {"cubes", scene::LampKind::Point, scene::ShadowKind::Hard, SHADOW_CUBE_MAX},
                             {"spots' maps", scene::LampKind::Spot, scene::ShadowKind::Pcf, SHADOW_MAP_MAX},
                             {"suns' maps", scene::LampKind::Sun, scene::ShadowKind::Hard, SHADOW_MAP_MAX},
                             {"octahedral layers", scene::LampKind::Point, scene::ShadowKind::Esm, ESM_MAX}}) {
    std::vector<Try<int>> values;
    for (const int n : {0, 1, count.most - 1, count.most}) {
      values.push_back({double(n), n});
    }
    values.push_back({double(count.most + 1), count.most + 1, Wanted::Named});
    cases.push_back(door_case<int>(
        "host", fmt::format("count of {}", count.name), "frame of so many lamps; those that lose are named", "lamps",
        fmt::format("'lamp{}'", count.most), values, [count](const int &n) {
          scene::Scene scene = lit_scene();
          remove_lamps(scene);
          for (int i = 0; i < n; i++) {
            add_lamp(scene, count.kind, {0.01F * float(i), 0, 5}, {0, 0, -1}, 1.0F);
          }
          eevee::Settings settings = small_settings(count.shadow);
          settings.shadow.esm.size_px = 8;
          settings.shadow.cascades.count = 1;
          Passed passed = draw_on_null(scene, settings);
          // No lamp is lost before the limit.
          const bool is_named =
              std::ranges::any_of(passed.messages, [](const auto &m) { return m.find("lamps l") != m.npos; });
          passed.fault_count += n <= count.most && is_named ? 1 : 0;
          return passed;
        }));
  }
}

constexpr const char *matrix_kinds =
    "1 NaN, 2 infinity, 3 -infinity, 4 zero, 5 flat, 6 sheared, 7 mirrored, 8 1e-20, 9 1e12";

/** Matrices that are not finite, and then those that are. */
glm::mat4 odd_matrix(int kind)
{
  using Float = std::numeric_limits<float>;
  glm::mat4 matrix(1.0F);
  switch (kind) {
    case 1: matrix[1][1] = Float::quiet_NaN(); break;
    case 2: matrix[3][0] = Float::infinity(); break;
    case 3: matrix[3][2] = -Float::infinity(); break;
    case 4: matrix = glm::scale(matrix, glm::vec3(0.0F)); break;
    case 5: matrix[2][2] = 0.0F; break;
    case 6: matrix[1][0] = 5.0F; break;
    case 7: matrix[0][0] = -1.0F; break;
    case 8: matrix = glm::scale(matrix, glm::vec3(1e-20F)); break;
    case 9: matrix = glm::scale(matrix, glm::vec3(1e12F)); break;
    default: break;
  }
  return matrix;
}

std::vector<Try<int>> matrix_tries(int first_kept)
{
  std::vector<Try<int>> values;
  for (int kind = 1; kind <= 9; kind++) {
    values.push_back({double(kind), kind, kind < first_kept ? Wanted::Refused : Wanted::Kept});
  }
  return values;
}

void add_host_call_cases(std::vector<StabilityCase> &cases)
{
  for (const auto &[name, shadow] : {std::pair("object matrices, hard shadows", scene::ShadowKind::Hard),
                                     {"object matrices, exponential shadows", scene::ShadowKind::Esm}}) {
    cases.push_back(door_case<int>("host", name, "frame of an object with that matrix", matrix_kinds, "node 'object1'",
                                   matrix_tries(4), [shadow](const int &kind) {
                                     scene::Scene scene = lit_scene();
                                     scene.set_transform(scene.objects()[1].node, odd_matrix(kind));
                                     return draw_on_null(scene, small_settings(shadow));
                                   }));
  }
  cases.push_back(door_case<float>("host", "culling volumes", "frame of an object with that radius", float_kinds,
                                   "object 2", odd_floats({2, 3, 4, 5, 6, 7}, Wanted::Refused),
                                   [](const float &radius) {
                                     const scene::Scene scene = lit_scene();
                                     const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
                                     Renderer renderer(*device, scene, {16, 16}, small_settings());
                                     draw::ObjectBuffer &objects = renderer.render_scene.objects();
                                     const draw::ObjectIndex last = objects.index_end() - 1;
                                     draw::CullingVolume volume = objects.volume(last);
                                     volume.radius = radius;
                                     objects.set(last, objects.world_from_object(last), 0, volume);
                                     const std::array<draw::Engine *, 1> engines = {&renderer.engine};
                                     renderer.viewport.sync(engines, objects);
                                     renderer.draw(lit_camera());
                                     return Passed{shadow_block_faults(renderer.engine.shadows(renderer.viewport)), {}};
                                   }));
  // A view without an inverse sees nothing from nowhere.
  std::vector<Try<int>> views = matrix_tries(6);
  cases.push_back(door_case<int>(
      "host", "view matrices", "frame from such a view", matrix_kinds, "view", views, [](const int &kind) {
        const scene::Scene scene = lit_scene();
        const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
        Renderer renderer(*device, scene, {16, 16}, small_settings());
        const draw::View view = eevee::view_of(lit_camera(), {16, 16});
        const std::array<draw::Engine *, 1> engines = {&renderer.engine};
        renderer.viewport.draw(engines, {odd_matrix(kind) * view.view_from_world(), view.clip_from_view()});
        return Passed{shadow_block_faults(renderer.engine.shadows(renderer.viewport)), {}};
      }));
  cases.push_back(door_case<glm::vec2>(
      "host", "near and far", "frame of a camera with near and far", "far / near", "",
      {{1.001, {1.0F, 1.001F}},
       {1e3, {1.0F, 1e3F}},
       {1e9, {1e-6F, 1e3F}},
       {1e18, {1e-6F, 1e12F}},
       {1e24, {1e-12F, 1e12F}},
       {0.0, {1e-12F, 0.0F}}},
      [](const glm::vec2 &near_far) {
        scene::PlacedCamera camera = lit_camera();
        camera.near = near_far.x;
        camera.far = near_far.y;
        const scene::Scene scene = lit_scene();
        const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
        Renderer renderer(*device, scene, {16, 16}, small_settings());
        renderer.draw(camera);
        const draw::View view = eevee::view_of(camera, {16, 16});
        return Passed{
            non_finite(view.clip_from_world()) + shadow_block_faults(renderer.engine.shadows(renderer.viewport)), {}};
      }));
}

}  // namespace

std::vector<StabilityCase> input_stability_cases()
{
  std::vector<StabilityCase> cases;
  add_lamp_cases(cases);
  add_camera_cases(cases);
  add_material_cases(cases);
  add_mesh_cases(cases);
  add_node_cases(cases);
  add_settings_cases(cases);
  add_host_lamp_cases(cases);
  add_host_call_cases(cases);
  return cases;
}

}  // namespace gnomon::measure
