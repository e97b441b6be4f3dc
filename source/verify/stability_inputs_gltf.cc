// SPDX-License-Identifier: MIT
#include "internal/stability_inputs.hh"

#include "internal/verify_contract.hh"
#include "internal/verify_gltf.hh"

#include "gltf_import.hh"

#include <fmt/format.h>

#include <limits>

namespace gnomon::verify {

namespace {

using nlohmann::json;

Outcome import_text(const std::string &text)
{
  const gltf::TemporaryFolder folder;
  const scene::Scene scene = gnomon::gltf::import_gltf(folder.write("scene.gltf", text));
  return {contract_faults(scene).size(), scene.warnings};
}

/** Indices of the nodes in small_scene. */
enum Node : int { Thing, Eye, Flat, Bulb, Sun, Spot, Panel };

/** A scene with every element that has numbers. */
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

/** A case of small_scene with one number replaced. \a path: an RFC 6901 pointer. */
StabilityCase number_case(const std::string &name, const std::string &path, const std::string &unit,
                          const std::string &expected_text, Numbers values)
{
  return input_case<double>("gltf", name, "scene of a file with this value at " + path, unit, expected_text,
                            std::move(values), [path](const double &value) {
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

void add_lamp_inputs(std::vector<StabilityCase> &cases)
{
  constexpr Expected accepted = Expected::Accepted;
  constexpr Expected rejected = Expected::Rejected;
  // Values whose products overflow float, negative values, and values beyond float.
  const Numbers outside = inputs({-1e300, -1.0, -1e-300, 1.01e12, 1e38, 1e39, 1e300}, rejected);
  const Numbers not_negative = inputs({0.0, 5e-324, 1e-300, 1e-40, 1.0, 1e12}, accepted) + outside;
  // Intensities have a limit of their own.
  const Numbers intensity = inputs({0.0, 5e-324, 1e-300, 1e-40, 1.0, 1e12, 1e30}, accepted) +
                            inputs({-1e300, -1.0, -1e-300, 1e38, 1e39}, rejected);
  const Numbers length =
      inputs({1e-12, 1.0, 1e12}, accepted) + inputs({5e-324, 1e-300, 1e-40, 9e-13}, rejected) + outside;
  for (const auto &[light, kind] : {std::pair(0, "point"), {1, "sun"}, {2, "spot"}}) {
    cases.push_back(number_case(fmt::format("{} intensity", kind), light_path(light, "intensity"), "cd or lux",
                                "intensity is", intensity));
  }
  cases.push_back(
      number_case("point range", light_path(0, "range"), "m", "range is", length + inputs({0.0}, accepted)));
  cases.push_back(number_case(
      "spot outer cone", light_path(2, "spot/outerConeAngle"), "rad", "outerConeAngle is",
      inputs({1e-9, 1e-3, 1.0, 1.5707963}, accepted) + inputs({-1.0, 0.0, 1e-300, 1e-46, 1.58, 3.2, 1e300}, rejected)));
  cases.push_back(number_case("spot inner cone", light_path(2, "spot/innerConeAngle"), "rad", "innerConeAngle is",
                              inputs({0.0, 1e-300, 0.7}, accepted) + inputs({-1.0, -1e-300, 0.8, 1e300}, rejected)));
  cases.push_back(input_case<double>("gltf", "lamp color", "scene of a file with this factor in a lamp's colour",
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
  const Numbers texels =
      inputs({1.0, 4.0, 16384.0}, accepted) + inputs({-1.0, 0.0, 0.5, 4.5, 16385.0, 1e300}, rejected);
  const std::vector<Extra> extras = {
      {Bulb, "gnomon_radius", "m", not_negative},
      {Sun, "gnomon_angle", "rad", inputs({0.0, 1e-300, 3.14159}, accepted) + inputs({-1.0, 3.15, 1e300}, rejected)},
      {Spot, "gnomon_spot_blend", "",
       inputs({0.0, 1e-300, 1.0}, accepted) + inputs({-1e-300, -1.0, 1.01, 1e300}, rejected)},
      {Bulb, "gnomon_shadow_size", "texels", texels},
      {Bulb, "gnomon_esm_size", "texels",
       inputs({4.0, 512.0, 8192.0}, accepted) + inputs({-1.0, 0.0, 3.0, 4.5, 8193.0, 1e300}, rejected)},
      {Bulb, "gnomon_exponent", "1/m",
       inputs({0.01, 1.0, 1e4}, accepted) + inputs({-1.0, 0.0, 1e-300, 0.0099, 10001.0, 1e300}, rejected)},
      {Bulb, "gnomon_bias", "",
       inputs({0.0, 1e-300, 100.0}, accepted) + inputs({-1e-300, -1.0, 101.0, 1e300}, rejected)},
      {Bulb, "gnomon_clip_start", "m", length},
      {Bulb, "gnomon_clip_end", "m", length},
      {Bulb, "gnomon_filter_radius", "degrees",
       inputs({0.0, 1e-300, 45.0}, accepted) + inputs({-1e-300, -1.0, 45.1, 1e300}, rejected)},
      {Panel, "gnomon_size_x", "m", length},
      {Panel, "gnomon_size_y", "m", length},
      {Panel, "gnomon_power", "W", intensity},
  };
  for (const Extra &extra : extras) {
    cases.push_back(number_case(extra.key, extra_path(extra.node, extra.key), extra.unit,
                                std::string(extra.key) + " is", extra.values));
  }
  cases.push_back(input_case<json>("gltf", "extras of a wrong type",
                                   "scene of a file whose gnomon_exponent is not a number",
                                   "1 string, 2 true, 3 null, 4 array, 5 object", "gnomon_exponent is",
                                   {{1, "1", rejected},
                                    {2, true, rejected},
                                    {3, nullptr, rejected},
                                    {4, {1.0}, rejected},
                                    {5, json::object(), rejected}},
                                   [](const json &value) {
                                     gltf::GltfBuilder builder = small_scene();
                                     builder.document[json::json_pointer(extra_path(Bulb, "gnomon_exponent"))] = value;
                                     return import_text(builder.gltf());
                                   }));
  cases.push_back(input_case<int>("gltf", "lamp count", "scene of a file with this many lamps", "lamps", "no lamp",
                                  {{0, 0, Expected::Reported}, {1, 1}, {255, 255}, {256, 256}, {2000, 2000}},
                                  [](const int &count) {
                                    gltf::GltfBuilder builder = gltf::triangle_scene();
                                    for (int i = 0; i < count; i++) {
                                      builder.light({{"type", "point"}});
                                    }
                                    return import_text(builder.gltf());
                                  }));
}

void add_camera_inputs(std::vector<StabilityCase> &cases)
{
  const auto add = [&](const char *name, const char *path, const char *unit, const char *expected_text,
                       std::initializer_list<double> accepted, std::initializer_list<double> left_out) {
    cases.push_back(number_case(name, path, unit, expected_text,
                                inputs(accepted, Expected::Accepted) + inputs(left_out, Expected::Reported)));
  };
  add("camera angle", "/cameras/0/perspective/yfov", "rad", "left out: yfov", {1e-5, 1.0, 3.1415},
      {-1e300, -1.0, 0.0, 1e-300, 3.1416, 7.0, 1e300});
  add("camera near", "/cameras/0/perspective/znear", "m", "left out: z", {1e-12, 1e-6, 9.0},
      {-1.0, 0.0, 1e-300, 1e-13, 10.0, 11.0, 1e300});
  add("camera far", "/cameras/0/perspective/zfar", "m", "left out: zfar", {0.0, 0.2, 1e9, 1e12},
      {-1.0, 1e-300, 0.1, 1.1e12, 1e300});
  add("camera aspect", "/cameras/0/perspective/aspectRatio", "", "left out: aspectRatio", {0.0, 1e-5, 1.0, 1e6},
      {-1.0, 1e-300, 1e7, 1e300});
  add("camera width", "/cameras/1/orthographic/xmag", "m", "left out: xmag", {-1.0, 1e-12, 1.0, 1e12},
      {0.0, 1e-300, 1e-13, -1e-13, 1e13, -1e13, 1e300});
  add("parallel near", "/cameras/1/orthographic/znear", "m", "left out: z", {0.0, 1e-300, 9.0},
      {-1.0, 10.0, 11.0, 1e300});
  add("parallel far", "/cameras/1/orthographic/zfar", "m", "left out: zfar", {1e-6, 1e12}, {-1.0, 0.0, 1e-300, 1e300});
}

void add_material_inputs(std::vector<StabilityCase> &cases)
{
  const std::string material = "/materials/0/";
  const Numbers share = inputs({0.0, 5e-324, 1e-40, 1.0}, Expected::Accepted) +
                        inputs({-1e300, -1.0, -1e-300, 1.0001, 1e39, 1e300}, Expected::Reported);
  const auto open = [](double max) {
    return inputs({0.0, 5e-324, 1.0, max}, Expected::Accepted) +
           inputs({-1.0, 1.01 * max, 1e39, 1e300}, Expected::Reported);
  };
  const auto add = [&](const std::string &name, const std::string &path, const Numbers &values) {
    cases.push_back(number_case(name, material + path, "factor", path.substr(path.rfind('/') + 1) + " is", values));
  };
  add("metallic", "pbrMetallicRoughness/metallicFactor", share);
  add("roughness", "pbrMetallicRoughness/roughnessFactor", share);
  add("alpha cutoff", "alphaCutoff",
      inputs({0.0, 5e-324, 0.5, 1.0, 2.0}, Expected::Accepted) + inputs({-1.0, 2.01, 1e39, 1e300}, Expected::Reported));
  add("specular", "extensions/KHR_materials_specular/specularFactor", share);
  add("emissive strength", "extensions/KHR_materials_emissive_strength/emissiveStrength", open(scene::light_max));
  add("ior", "extensions/KHR_materials_ior/ior",
      inputs({0.0, 1.0, 1.5, 1e12, 1e300}, Expected::Accepted) +
          inputs({-1e300, -1.0, 1e-300, 0.99}, Expected::Reported));
  const auto add_color = [&](const std::string &name, const std::string &path, const json &color,
                             const Numbers &values) {
    cases.push_back(input_case<double>("gltf", name, "scene of a file with this factor in " + path, "factor",
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
  add_color("specular color", "extensions/KHR_materials_specular/specularColorFactor", {0.5, 0.5, 0.5},
            open(scene::number_max));
}

/** A valid triangle, and a second one whose last corner has the coordinate \a x. */
gltf::GltfBuilder two_triangles(float x)
{
  gltf::GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, x, 1, 1});
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}})}});
  return builder;
}

void add_mesh_inputs(std::vector<StabilityCase> &cases)
{
  const auto add_floats = [&](const char *name, const char *quantity, const char *expected_text,
                              std::vector<Input<float>> values, std::function<gltf::GltfBuilder(float)> make) {
    cases.push_back(
        input_case<float>("gltf", name, quantity, float_kinds, expected_text, std::move(values),
                          [make = std::move(make)](const float &x) { return import_text(make(x).gltf()); }));
  };
  add_floats("positions", "scene of a file with this coordinate", "a position is not finite",
             float_inputs({5, 6}, Expected::Reported), two_triangles);
  add_floats("normals", "scene of a file with this normal", "normal replaced",
             float_inputs({4, 5, 7}, Expected::Reported), [](float x) {
               gltf::GltfBuilder builder = two_triangles(0.0F);
               builder.document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = builder.accessor(
                   std::vector<float>{0, 0, 1, 0, 0, 1, x, x, x, 0, 0, 1, 0, 0, 1, 0, x, 0}, gltf::Float32, "VEC3");
               return builder;
             });
  add_floats("texture coordinates", "scene of a file with this texture coordinate", "texture coordinate replaced",
             float_inputs({5, 6}, Expected::Reported), [](float x) {
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
  // The corners of the second triangle are on a line, except that the parameter is the last one's distance from it.
  cases.push_back(input_case<float>(
      "gltf", "flat triangles", "scene of a file with a triangle of this height", "m", "it has no area",
      {{0.0, 0.0F, Expected::Reported}, {1e-40, 1e-40F}, {1e-30, 1e-30F}, {1e-7, 1e-7F}, {1.0, 1.0F}},
      [](const float &height) {
        gltf::GltfBuilder builder;
        const int positions = builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 2, height, 0});
        builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}})}});
        return import_text(builder.gltf());
      }));
  cases.push_back(input_case<std::uint32_t>(
      "gltf", "vertex indices", "scene of a file with this index", "index", "a vertex index is out of range",
      {{0, 0, Expected::Reported}, {5, 5}, {6, 6, Expected::Reported}, {4294967295.0, 0xFFFFFFFFU, Expected::Reported}},
      [](const std::uint32_t &index) {
        gltf::GltfBuilder builder = two_triangles(0.0F);
        builder.document["meshes"][0]["primitives"][0]["indices"] =
            builder.accessor(std::vector<std::uint32_t>{0, 1, 2, 3, 4, index}, gltf::Uint32, "SCALAR");
        // Index 0 gives a triangle between the two, which is only required to be accepted.
        Outcome outcome = import_text(builder.gltf());
        if (index == 0) {
          outcome.messages.emplace_back("a vertex index is out of range");
        }
        return outcome;
      }));
}

void add_node_inputs(std::vector<StabilityCase> &cases)
{
  const auto add_matrices = [&](const char *name, const char *parameter, const char *expected_text,
                                std::vector<Input<json>> values) {
    cases.push_back(input_case<json>("gltf", name, "scene of a file with this node and an object, lamp or camera on it",
                                     parameter, expected_text, std::move(values), [](const json &place) {
                                       Outcome all;
                                       for (const int node : {Thing, Eye, Bulb, Sun, Spot, Panel}) {
                                         gltf::GltfBuilder builder = small_scene();
                                         // Keeps the scene valid if the tested node is left out.
                                         builder.node({{"mesh", 0}});
                                         json &changed = builder.document["nodes"][node];
                                         changed.erase("translation");
                                         changed.update(place);
                                         const Outcome outcome = import_text(builder.gltf());
                                         all.fault_count += outcome.fault_count;
                                         all.messages.insert(all.messages.end(), outcome.messages.begin(),
                                                             outcome.messages.end());
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
  constexpr Expected reported = Expected::Reported;
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
               {{1, matrix({1, 0, 0, 0, 1, 0, 0, 0, 1}, 1e13), reported},
                {2, matrix({1e300, 0, 0, 0, 1e300, 0, 0, 0, 1e300}), reported},
                {3, matrix({1, 0, 0, 0, 1, 0, 0, 0, 1}, -1e300), reported},
                {4, matrix({1, 0, 0, 0, 1, 0, 0, 0, 1}, 0.0, 0.5), reported}});
  add_matrices("node rotations", "1 zero, 2 1e-300, 3 1e300", "rotation has no length",
               {{1, {{"rotation", {0, 0, 0, 0}}}, reported},
                {2, {{"rotation", {1e-300, 0, 0, 1e-300}}}},
                {3, {{"rotation", {1e300, 0, 0, 1e300}}}}});
  add_matrices("node scales", "1 zero, 2 1e-300, 3 1e300, 4 1e-20 of 1e20", "left out",
               {{1, {{"scale", {0, 0, 0}}}},
                {2, {{"scale", {1e-300, 1, 1}}}},
                {3, {{"scale", {1e300, 1, 1}}}, reported},
                {4, {{"scale", {1e-20, 1e11, -1e11}}}}});
  // Numbers that JSON can express and a float cannot, in one property after another.
  const std::vector<std::string> paths = {"/nodes/0/translation",
                                          light_path(0, "intensity"),
                                          light_path(2, "spot/outerConeAngle"),
                                          "/cameras/0/perspective/yfov",
                                          "/materials/0/pbrMetallicRoughness/metallicFactor",
                                          extra_path(Bulb, "gnomon_exponent")};
  std::vector<Input<std::string>> places;
  for (const std::string &path : paths) {
    places.push_back({double(places.size() + 1), path, Expected::Rejected});
  }
  cases.push_back(
      input_case<std::string>("gltf", "1e999", "scene of a file with a number beyond double", "place", "JSON", places,
                              [](const std::string &path) {
                                gltf::GltfBuilder builder = small_scene();
                                const bool is_vector = path.ends_with("translation");
                                builder.document[json::json_pointer(path)] = is_vector ? json{0, "@", 0} : json("@");
                                std::string text = builder.gltf();
                                text.replace(text.find("\"@\""), 3, "1e999");
                                return import_text(text);
                              }));
}

}  // namespace

void add_gltf_inputs(std::vector<StabilityCase> &cases)
{
  add_lamp_inputs(cases);
  add_camera_inputs(cases);
  add_material_inputs(cases);
  add_mesh_inputs(cases);
  add_node_inputs(cases);
}

}  // namespace gnomon::verify
