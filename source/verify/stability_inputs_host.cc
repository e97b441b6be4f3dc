// SPDX-License-Identifier: MIT
#include "internal/stability_inputs.hh"

#include "shadows/shadow_octahedral_store.hh"
#include "shadows/shadows.hh"

#include "measure_scene.hh"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace gnomon::verify {

namespace {

using namespace measure;

/** A ground, a box above it, and a lamp of each kind with a shadow. */
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

/** Settings with small resources. */
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

/** Number of non-finite values in the blocks of shadows. */
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
Outcome draw_on_null(const scene::Scene &scene, const eevee::Settings &settings, glm::ivec2 size_px = {16, 16},
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
  renderer.draw(lit_camera(), target, {.progress = [](int samples_drawn) { return samples_drawn < 64; }});
  const eevee::Report report = renderer.inspect().report();
  Outcome outcome{shadow_block_faults(renderer.inspect().shadows()), report.limits};
  outcome.messages.insert(outcome.messages.end(), report.warnings.begin(), report.warnings.end());
  return outcome;
}

void add_settings_inputs(std::vector<StabilityCase> &cases)
{
  constexpr Expected rejected = Expected::Rejected;
  const auto add = [&](const char *name, const char *unit, const char *expected_text, Numbers values,
                       std::function<void(eevee::Settings &, double)> set,
                       scene::ShadowKind kind = scene::ShadowKind::Hard) {
    cases.push_back(input_case<double>("settings", name, "frame with these settings", unit, expected_text,
                                       std::move(values), [set = std::move(set), kind](const double &value) {
                                         eevee::Settings settings = small_settings(kind);
                                         set(settings, value);
                                         return draw_on_null(lit_scene(), settings);
                                       }));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  // NaN has the parameter -1e9, because NaN cannot be plotted.
  const auto with_nan = [&](Numbers values) { return values + Numbers{{-1e9, nan, rejected}}; };
  const Numbers sizes = inputs({1, 2, 16, 16384}, Expected::Accepted) + inputs({-1, 0, 16385, 2147483647}, rejected);
  add("cube size", "texels", "size", sizes, [](eevee::Settings &s, double v) {
    s.shadow.cube_size_px = int(v);
    s.shadow.memory_bytes_max = std::size_t(1) << 40U;
  });
  add("map size", "texels", "size", sizes, [](eevee::Settings &s, double v) {
    s.shadow.map_size_px = int(v);
    s.shadow.memory_bytes_max = std::size_t(1) << 40U;
  });
  add(
      "octahedral size", "texels", "size",
      inputs({4, 512, 8192}, Expected::Accepted) + inputs({-1, 0, 3, 8193}, rejected),
      [](eevee::Settings &s, double v) {
        s.shadow.esm.size_px = int(v);
        s.shadow.memory_bytes_max = std::size_t(1) << 40U;
      },
      scene::ShadowKind::Esm);
  add("shadow memory", "bytes", "sizes are lowered",
      inputs({1e9}, Expected::Accepted) + inputs({1, 1000, 10000}, Expected::Reported),
      [](eevee::Settings &s, double v) { s.shadow.memory_bytes_max = std::size_t(v); });
  add(
      "exponent", "1/m", "exponent",
      with_nan(inputs({0.01, 1, 1e4}, Expected::Accepted) + inputs({-1, 0, 1e-40, 0.0099, 10001, 1e38}, rejected)),
      [](eevee::Settings &s, double v) { s.shadow.esm.exponent = float(v); }, scene::ShadowKind::Esm);
  add(
      "bias of exponential maps", "", "bias",
      with_nan(inputs({0, 1, 100}, Expected::Accepted) + inputs({-1, 101, 1e38}, rejected)),
      [](eevee::Settings &s, double v) { s.shadow.esm.bias = float(v); }, scene::ShadowKind::Evsm);
  add(
      "filter angle", "rad", "filter_angle",
      with_nan(inputs({0, 1e-40, 0.785}, Expected::Accepted) + inputs({-1, 0.786, 1e38}, rejected)),
      [](eevee::Settings &s, double v) { s.shadow.esm.filter_angle = float(v); }, scene::ShadowKind::Esm);
  add("cascades", "maps a sun", "cascade_count",
      inputs({0, 1, 4}, Expected::Accepted) + inputs({-1, 5, 100, 1000000}, rejected),
      [](eevee::Settings &s, double v) { s.shadow.cascades.count = int(v); });
  add("cascade lambda", "", "lambda",
      with_nan(inputs({0, 0.8, 1}, Expected::Accepted) + inputs({-0.1, 1.1, 1e38}, rejected)),
      [](eevee::Settings &s, double v) {
        s.shadow.cascades.count = 4;
        s.shadow.cascades.lambda = float(v);
      });
  add(
      "pcf width", "texels", "pcf", inputs({0, 1, 3, 5}, Expected::Accepted) + inputs({-1, 2, 7, 1000}, rejected),
      [](eevee::Settings &s, double v) { s.shadow.pcf.width = int(v); }, scene::ShadowKind::Pcf);
  add(
      "pcf taps", "lookups", "pcf", inputs({1, 64}, Expected::Accepted) + inputs({-1, 0, 65, 1e6}, rejected),
      [](eevee::Settings &s, double v) { s.shadow.pcf = {.width = 0, .taps = int(v)}; }, scene::ShadowKind::Pcf);
  add("samples", "samples a pixel", "sample_count",
      inputs({0, 1, 2, 64}, Expected::Accepted) + inputs({-1, -100, 65537}, rejected),
      [](eevee::Settings &s, double v) { s.sample_count = int(v); });
  add("noise threshold", "relative difference", "noise_threshold",
      with_nan(inputs({0, 1e-45, 1, 1000}, Expected::Accepted) + inputs({-1, -1e-30, 1001, 1e38}, rejected)),
      [](eevee::Settings &s, double v) {
        s.sample_count = 8;
        s.noise_threshold = float(v);
      });
  cases.push_back(input_case<double>(
      "settings", "exposure", "frame with this target", "stops", "exposure",
      with_nan(inputs({-100, 0, 100}, Expected::Accepted) + inputs({-1e9, 128, 1e38}, rejected)), [](const double &v) {
        return draw_on_null(lit_scene(), small_settings(), {16, 16}, float(v));
      }));
  cases.push_back(input_case<glm::ivec2>(
      "settings", "viewport", "frame of this size",
      "1 1x1, 2 16384x1, 3 1x16384, 4 16384x16384, 5 0x1, 6 1x0, 7 -1x1, 8 16385x1, 9 1x16385", "viewport: ",
      {{1, {1, 1}},
       {2, {16384, 1}},
       {3, {1, 16384}},
       {4, {16384, 16384}},
       {5, {0, 1}, rejected},
       {6, {1, 0}, rejected},
       {7, {-1, 1}, rejected},
       {8, {16385, 1}, rejected},
       {9, {1, 16385}, rejected}},
      [](const glm::ivec2 &size_px) {
        // The picture is not read back, because 16384x16384 would need 4 GiB.
        return draw_on_null(lit_scene(), small_settings(), size_px);
      }));
}

/** Cases of lamps in a scene made by a host. */
void add_host_lamp_inputs(std::vector<StabilityCase> &cases)
{
  constexpr Expected rejected = Expected::Rejected;
  const auto add = [&](const char *name, const char *unit, const char *expected_text, scene::ShadowKind kind,
                       Numbers values, std::function<void(scene::LampShadow &, double)> set) {
    cases.push_back(input_case<double>("host", name, "frame of a scene with this lamp", unit, expected_text,
                                       std::move(values), [set = std::move(set), kind](const double &value) {
                                         scene::Scene scene = lit_scene();
                                         scene.edit(scene.lamps().first(),
                                                    [&](scene::Lamp &lamp) { set(lamp.shadow, value); });
                                         return draw_on_null(scene, small_settings(kind));
                                       }));
  };
  add("lamp's shadow size", "texels", "'lamp0'", scene::ShadowKind::Hard,
      inputs({1, 16, 1024, 16384}, Expected::Accepted) + inputs({-1, 0, 16385}, rejected),
      [](scene::LampShadow &shadow, double v) { shadow.size = int(v); });
  add("lamp's octahedral size", "texels", "lamp 'lamp0': shadow_esm_size_px", scene::ShadowKind::Esm,
      inputs({4, 64}, Expected::Accepted) + inputs({-1, 0, 3, 8193}, rejected),
      [](scene::LampShadow &shadow, double v) { shadow.esm_size = int(v); });
  add("lamp's exponent", "1/m", "lamp 'lamp0': shadow_exponent", scene::ShadowKind::Esm,
      inputs({0.01, 1e4}, Expected::Accepted) + inputs({-1, 0, 1e-40, 10001, 1e38}, rejected),
      [](scene::LampShadow &shadow, double v) { shadow.exponent = float(v); });
  add("lamp's filter", "rad", "lamp 'lamp0': ", scene::ShadowKind::Evsm,
      inputs({0, 0.785}, Expected::Accepted) + inputs({-1, 0.786, 1e38}, rejected),
      [](scene::LampShadow &shadow, double v) { shadow.filter_angle = float(v); });
  add("lamp's clip distances", "m", "", scene::ShadowKind::Hard,
      inputs({1e-12, 1e-6, 1.0, 1e6, 5e11}, Expected::Accepted), [](scene::LampShadow &shadow, double v) {
        shadow.clip_start = float(v);
        shadow.clip_end = float(2.0 * v);
      });

  struct Count {
    const char *name;
    scene::LampKind kind;
    scene::ShadowKind shadow;
    int most;
    /** A lamp above `most` is reported. */
    bool is_limit = true;
  };
  for (const Count &count : {Count{"points", scene::LampKind::Point, scene::ShadowKind::None, LIGHT_MAX + 1, false},
                             {"suns", scene::LampKind::Sun, scene::ShadowKind::None, LIGHT_MAX + 1, false},
                             {"spots", scene::LampKind::Spot, scene::ShadowKind::None, LIGHT_MAX + 1, false},
                             {"hemis", scene::LampKind::Hemi, scene::ShadowKind::None, LIGHT_MAX + 1, false},
                             {"cubes", scene::LampKind::Point, scene::ShadowKind::Hard, SHADOW_CUBE_MAX},
                             {"spots' maps", scene::LampKind::Spot, scene::ShadowKind::Pcf, SHADOW_MAP_MAX},
                             {"suns' maps", scene::LampKind::Sun, scene::ShadowKind::Hard, SHADOW_MAP_MAX},
                             {"octahedral layers", scene::LampKind::Point, scene::ShadowKind::Esm, ESM_MAX}}) {
    std::vector<Input<int>> values;
    for (const int n : {0, 1, count.most - 1, count.most}) {
      values.push_back({double(n), n});
    }
    if (count.is_limit) {
      values.push_back({double(count.most + 1), count.most + 1, Expected::Reported});
    }
    cases.push_back(input_case<int>(
        "host", fmt::format("count of {}", count.name), "frame of this many lamps; lamps above the limit are reported",
        "lamps", fmt::format("'lamp{}'", count.most), values, [count](const int &n) {
          scene::Scene scene = lit_scene();
          remove_lamps(scene);
          for (int i = 0; i < n; i++) {
            add_lamp(scene, count.kind, {0.01F * float(i), 0, 5}, {0, 0, -1}, 1.0F);
          }
          eevee::Settings settings = small_settings(count.shadow);
          settings.shadow.esm.size_px = 8;
          settings.shadow.cascades.count = 1;
          Outcome outcome = draw_on_null(scene, settings);
          // Below the limit no lamp is reported.
          const bool is_named =
              std::ranges::any_of(outcome.messages, [](const auto &m) { return m.find("lamps l") != m.npos; });
          outcome.fault_count += n <= count.most && is_named ? 1 : 0;
          return outcome;
        }));
  }
}

constexpr const char *matrix_kinds =
    "1 NaN, 2 infinity, 3 -infinity, 4 zero, 5 flat, 6 sheared, 7 mirrored, 8 1e-20, 9 1e12";

/** Matrices that are not finite, followed by finite ones. */
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

std::vector<Input<int>> matrix_inputs(int first_accepted)
{
  std::vector<Input<int>> values;
  for (int kind = 1; kind <= 9; kind++) {
    values.push_back({double(kind), kind, kind < first_accepted ? Expected::Rejected : Expected::Accepted});
  }
  return values;
}

void add_host_call_inputs(std::vector<StabilityCase> &cases)
{
  for (const auto &[name, shadow] : {std::pair("object matrices, hard shadows", scene::ShadowKind::Hard),
                                     {"object matrices, exponential shadows", scene::ShadowKind::Esm}}) {
    cases.push_back(input_case<int>("host", name, "frame of an object with this matrix", matrix_kinds, "node 'object1'",
                                    matrix_inputs(4), [shadow = shadow](const int &kind) {
                                      scene::Scene scene = lit_scene();
                                      scene.set_transform(scene.objects()[1].node, odd_matrix(kind));
                                      return draw_on_null(scene, small_settings(shadow));
                                    }));
  }
  cases.push_back(input_case<float>("host", "culling volumes", "frame of an object with this radius", float_kinds,
                                    "object 2", float_inputs({2, 3, 4, 5, 6, 7}, Expected::Rejected),
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
                                      return Outcome{shadow_block_faults(renderer.inspect().shadows()), {}};
                                    }));
  // A view without an inverse is refused.
  std::vector<Input<int>> views = matrix_inputs(6);
  cases.push_back(
      input_case<int>("host", "view matrices", "frame of this view", matrix_kinds, "view", views, [](const int &kind) {
        const scene::Scene scene = lit_scene();
        const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
        Renderer renderer(*device, scene, {16, 16}, small_settings());
        const draw::View view = eevee::view_of(lit_camera(), {16, 16});
        const std::array<draw::Engine *, 1> engines = {&renderer.engine};
        renderer.viewport.draw(engines, {odd_matrix(kind) * view.view_from_world(), view.clip_from_view()});
        return Outcome{shadow_block_faults(renderer.inspect().shadows()), {}};
      }));
  cases.push_back(input_case<glm::vec2>(
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
        return Outcome{non_finite(view.clip_from_world()) + shadow_block_faults(renderer.inspect().shadows()), {}};
      }));
}

}  // namespace

void add_host_inputs(std::vector<StabilityCase> &cases)
{
  add_settings_inputs(cases);
  add_host_lamp_inputs(cases);
  add_host_call_inputs(cases);
}

}  // namespace gnomon::verify
