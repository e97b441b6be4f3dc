// SPDX-License-Identifier: MIT
#include "python_fields.hh"
#include "python_renderer.hh"

#include "eevee_cryptomatte.hh"
#include "eevee_settings.hh"
#include "gltf_export.hh"
#include "gltf_import.hh"
#include "render_display.hh"

#include <array>
#include <map>
#include <set>
#include <span>
#include <string_view>

namespace gnomon::python {

namespace {

using eevee::Background;
using eevee::Settings;

/** A setting as scripts and other programs show it. */
struct Description {
  std::string label;
  std::string group;
  std::string unit;
  std::string sentence;
  std::string zero;
  double min = 0.0;
  double max = 0.0;
  std::vector<std::string> words;
  std::string type;
  py::object default_value;
};

Field<Settings> background_field()
{
  return {"background",
          "What is seen without a surface: None (transparent), 'world', or a radiance (r, g, b), W/(sr m²).",
          "Background",
          [](const ScenePtr & /*scene*/, const Settings &settings) -> py::object {
            switch (settings.background.kind) {
              case Background::Kind::None: return py::none();
              case Background::Kind::World: return py::str("world");
              case Background::Kind::Color: break;
            }
            return py::cast(settings.background.color);
          },
          [](const ScenePtr & /*scene*/, Settings &settings, py::handle set) {
            if (set.is_none()) {
              settings.background = {};
            }
            else if (py::isinstance<py::str>(set)) {
              if (set.cast<std::string>() != "world") {
                throw py::value_error("is neither None, 'world' nor three numbers");
              }
              settings.background = {Background::Kind::World};
            }
            else {
              Background background{Background::Kind::Color};
              const Field<Background> color = number_field<Background>("color", &Background::color, 0, float_max, "");
              color.set(nullptr, background, set);
              settings.background = background;
            }
          }};
}

/** A field for each row on which pictures depend. */
Fields<Settings> make_settings_fields()
{
  Fields<Settings> fields;
  const auto add = [&](const auto &row, auto part) {
    using Value = typename std::decay_t<decltype(row)>::Value;
    const auto access = [ part, row ](auto &settings) -> auto &
    {
      return row.access(part(settings));
    };
    if (!row.makes_picture) {
      return;
    }
    if constexpr (std::is_same_v<Value, Background>) {
      fields.push_back(background_field());
      describe(fields.back(), row);
    }
    else if constexpr (std::is_same_v<Value, eevee::PcfKernel>) {
      fields.push_back({std::string(row.name), std::string(row.sentence), "str",
                        [=](const ScenePtr & /*scene*/, const Settings &settings) -> py::object {
                          return py::str(eevee::text_of(access(settings)));
                        },
                        [=](const ScenePtr & /*scene*/, Settings &settings, py::handle set) {
                          const std::optional<eevee::PcfKernel> kernel =
                              eevee::pcf_kernel_of(cast_to<std::string>(set));
                          if (!kernel) {
                            throw py::value_error("is none of '1', '3x3', '5x5' and 'disk:N' with N from 1 to 64");
                          }
                          access(settings) = *kernel;
                        }});
      describe(fields.back(), row);
    }
    else {
      fields.push_back(row_field<Settings>(row, access));
    }
  };
  Settings::for_each_property([&](const auto &row) {
    add(
        row, [](auto &whole) -> auto & { return whole; });
  });
  eevee::ShadowSettings::for_each_property([&](const auto &row) {
    add(
        row, [](auto &whole) -> auto & { return whole.shadow; });
  });
  return fields;
}

constexpr int default_sample_count = 64;

const Fields<Settings> settings_fields = make_settings_fields();

void set_settings(Renderer &renderer, const py::dict &values)
{
  Settings settings = renderer.settings();
  set_fields(settings_fields, "renderer", renderer.scene(), settings, values);
  renderer.use().set_settings(settings);
}

std::shared_ptr<Renderer> make_renderer(const std::shared_ptr<Device> &device, const ScenePtr &scene,
                                        const glm::ivec2 &size_px, const py::kwargs &values)
{
  Settings settings{.sample_count = 16};
  set_fields(settings_fields, "renderer", scene, settings, values);
  return std::make_shared<Renderer>(device, scene, size_px, settings);
}

std::shared_ptr<Renderer> make_offline_renderer(const std::shared_ptr<Device> &device, const ScenePtr &scene,
                                                const glm::ivec2 &size_px, int sample_count, const py::kwargs &values)
{
  Settings settings = eevee::offline_settings(sample_count);
  set_fields(settings_fields, "renderer", scene, settings, values);
  return std::make_shared<Renderer>(device, scene, size_px, settings);
}

/** In the order of the rows. */
py::dict descriptions()
{
  const Settings settings = eevee::offline_settings(default_sample_count);
  py::dict result;
  for (const Field<Settings> &field : settings_fields) {
    const scene::Description &row = *field.row;
    std::string label(row.label.empty() ? row.name : row.label);
    result[field.name.c_str()] = Description{.label = std::move(label),
                                             .group = std::string(row.group),
                                             .unit = std::string(row.unit),
                                             .sentence = std::string(row.sentence),
                                             .zero = std::string(row.zero),
                                             .min = row.min,
                                             .max = row.max,
                                             .words = field.words,
                                             .type = field.type,
                                             .default_value = field.get(nullptr, settings)};
  }
  return result;
}

/**
 * Calls \a draw(camera, progress) without the interpreter's lock, and returns what it returns. \a progress: None, or
 * called with the number of samples after each. An exception that it raises, or a signal's handler, ends the picture.
 */
template <typename Draw>
auto drawn_by(const Renderer &renderer, const std::optional<Thing<scene::Node>> &camera, const py::object &progress,
              const Draw &draw)
{
  const scene::PlacedCamera placed = camera_at(renderer.scene(), camera);
  std::exception_ptr raised;
  const auto report = [&](int samples_drawn) {
    const py::gil_scoped_acquire locked;
    try {
      if (PyErr_CheckSignals() != 0) {
        throw py::error_already_set();
      }
      if (!progress.is_none()) {
        progress(samples_drawn);
      }
    }
    catch (...) {
      raised = std::current_exception();
    }
    return !raised;
  };
  auto result = [&] {
    const Reading reading(renderer.scene());
    const py::gil_scoped_release unlocked;
    return draw(placed, report);
  }();
  if (raised) {
    std::rethrow_exception(raised);
  }
  return result;
}

py::array_t<float> render(Renderer &renderer, const std::optional<Thing<scene::Node>> &camera, double seconds_max,
                          const py::object &progress)
{
  if (!(seconds_max > 0.0)) {
    throw py::value_error(fmt::format("render: seconds_max {} is not above 0", seconds_max));
  }
  const glm::ivec2 size_px = renderer.size_px();
  return picture_array(drawn_by(renderer, camera, progress,
                                [&](const scene::PlacedCamera &placed, const auto &report) {
                                  return renderer.render(placed, {.progress = report, .seconds_max = seconds_max});
                                }),
                       size_px);
}

py::tuple refine(Renderer &renderer, double seconds, const std::optional<Thing<scene::Node>> &camera)
{
  const glm::ivec2 size_px = renderer.size_px();
  auto [pixels, is_complete] = drawn_by(
      renderer, camera, py::none(),
      [&](const scene::PlacedCamera &placed, const auto & /*report*/) { return renderer.refine(placed, seconds); });
  if (!pixels.empty()) {
    renderer.refined = picture_array(std::move(pixels), size_px);
  }
  return py::make_tuple(renderer.refined, is_complete);
}

constexpr std::array<std::string_view, 3> encoding_words = {"linear", "display", "srgb"};

const Fields<render_scene::Display> display_fields = property_fields<render_scene::Display>();

bool draw(Renderer &renderer, double seconds, std::uint32_t framebuffer, const glm::ivec2 &framebuffer_size,
          const std::optional<glm::ivec4> &rectangle, const std::optional<Thing<scene::Node>> &camera,
          const std::string &encoding, bool is_over, const std::optional<glm::dmat4> &clip_from_view,
          const py::kwargs &display_values)
{
  const auto word = std::ranges::find(encoding_words, encoding);
  if (word == encoding_words.end()) {
    throw py::value_error(
        fmt::format("draw: encoding '{}' is none of '{}'", encoding, fmt::join(encoding_words, "', '")));
  }
  render_scene::Display display;
  set_fields(display_fields, "draw", renderer.scene(), display, display_values);
  const glm::ivec4 place = rectangle.value_or(glm::ivec4(0, 0, framebuffer_size));
  if (place.z <= 0 || place.w <= 0) {
    throw py::value_error(fmt::format("draw: a rectangle of {}x{} pixels is empty", place.z, place.w));
  }
  draw::Target target{.framebuffer = gpu::HostFramebuffer{.name = framebuffer, .size_px = framebuffer_size},
                      .origin_px = glm::ivec2(place),
                      .size_px = {place.z, place.w},
                      .encoding = draw::Encoding(word - encoding_words.begin()),
                      .composition = is_over ? draw::Composition::Over : draw::Composition::Replace};
  set_display(target, display);
  if (clip_from_view) {
    target.depth = draw::HostDepth{.clip_from_view = *clip_from_view};
  }
  return drawn_by(renderer, camera, py::none(), [&](const scene::PlacedCamera &placed, const auto & /*report*/) {
    return renderer.draw(placed, seconds, target);
  });
}

/** Whether Renderer.layers returns the layer. */
bool is_array(const eevee::PictureLayer &layer)
{
  using eevee::LayerSource;
  return layer.source != LayerSource::Visibility;
}

/** Channels of a picture_array, without a copy. A single one has no axis of its own. */
py::object channels(const py::array_t<float> &array, int first, int count)
{
  const py::object picked = count == 1 ? py::object(py::int_(first)) : py::slice(first, first + count, 1);
  return array[py::make_tuple(py::ellipsis(), picked)];
}

/** \a index_of: the number of an object's thing; -1 for none */
template <typename IndexOf>
py::array_t<std::int32_t> id_array(std::span<const glm::vec4> normal, glm::ivec2 size_px, const IndexOf &index_of)
{
  py::array_t<std::int32_t> ids({size_px.y, size_px.x});
  auto values = ids.mutable_unchecked<2>();
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      const auto pixel = std::size_t(size_px.y - 1 - y) * std::size_t(size_px.x) + std::size_t(x);
      const auto object = draw::ObjectIndex(normal[pixel].w);
      values(y, x) = object == draw::object_identity ? -1 : index_of(object);
    }
  }
  return ids;
}

/** Indices in the lists that the scene has in Python. */
template <typename T>
std::map<scene::Handle<T>, std::int32_t> indices_of(const scene::Scene &scene)
{
  std::map<scene::Handle<T>, std::int32_t> indices;
  for (const auto &item : scene.pool<T>()) {
    indices.emplace(item.handle, std::int32_t(indices.size()));
  }
  return indices;
}

void add_ids(Renderer &renderer, std::span<const glm::vec4> normal, glm::ivec2 size_px, py::dict &arrays)
{
  const scene::Scene &scene = renderer.scene()->scene;
  const render_scene::RenderScene &drawn = renderer.use().render_scene();
  const auto nodes = indices_of<scene::Node>(scene);
  arrays["node_ids"] =
      id_array(normal, size_px, [&](draw::ObjectIndex object) { return nodes.at(drawn.object(object).node); });
  const auto materials = indices_of<scene::Material>(scene);
  arrays["material_ids"] = id_array(normal, size_px, [&](draw::ObjectIndex object) {
    const auto found = materials.find(scene.meshes()[drawn.object(object).mesh].material);
    return found == materials.end() ? -1 : found->second;
  });
}

/** The sources of layers. \throws py::value_error if Renderer.layers returns none of a name */
std::set<eevee::LayerSource> layer_sources(const std::vector<std::string> &names)
{
  std::vector<std::string_view> known;
  for (const eevee::PictureLayer &layer : eevee::picture_layers) {
    if (is_array(layer)) {
      known.push_back(layer.name);
    }
  }
  std::set<eevee::LayerSource> sources;
  for (const std::string &name : names) {
    const auto layer = std::ranges::find(eevee::picture_layers, name, &eevee::PictureLayer::name);
    if (layer == eevee::picture_layers.end() || !is_array(*layer)) {
      throw py::value_error(fmt::format("layers: there is no layer '{}'; there are: {}", name, fmt::join(known, ", ")));
    }
    sources.insert(layer->source);
  }
  return sources;
}

/** Arrays by the names of \a drawn. Takes the pixels from it. */
py::dict layer_arrays(Renderer &renderer, const std::vector<std::string> &names,
                      const std::set<eevee::LayerSource> &sources, Layers &drawn)
{
  using eevee::LayerSource;
  const glm::ivec2 size_px = renderer.size_px();
  py::dict arrays;
  if (sources.contains(LayerSource::Ids)) {
    add_ids(renderer, drawn.surfaces.normal, size_px, arrays);
  }
  // Layers of one source share its array.
  std::map<LayerSource, py::array_t<float>> pixels;
  for (const auto &[source, values] : {std::pair(LayerSource::Picture, &drawn.picture),
                                       {LayerSource::Centers, &drawn.surfaces.position_depth},
                                       {LayerSource::Normals, &drawn.surfaces.normal},
                                       {LayerSource::Means, &drawn.surfaces.albedo_roughness},
                                       {LayerSource::Emission, &drawn.emission},
                                       {LayerSource::World, &drawn.world}}) {
    if (sources.contains(source)) {
      pixels.emplace(source, picture_array(std::move(*values), size_px));
    }
  }
  for (const eevee::PictureLayer &layer : eevee::picture_layers) {
    if (std::ranges::find(names, layer.name) == names.end()) {
      continue;
    }
    const int count = int(layer.channels.size());
    if (const auto found = pixels.find(layer.source); found != pixels.end()) {
      arrays[py::str(layer.name)] = channels(found->second, layer.first, count);
    }
    if (layer.source == LayerSource::Lamp) {
      for (auto &[lamp, values] : drawn.light) {
        arrays[py::str(fmt::format("{}.{}", layer.name, lamp))] =
            channels(picture_array(std::move(values), size_px), layer.first, count);
      }
    }
    if (layer.source == LayerSource::Objects || layer.source == LayerSource::Materials) {
      const std::vector<std::string> things =
          eevee::object_names(renderer.use(), layer.source == LayerSource::Materials);
      eevee::CryptomatteLayers mattes = eevee::cryptomatte_layers(drawn.surfaces.objects, things);
      for (std::size_t i = 0; i < mattes.size(); i++) {
        arrays[py::str(fmt::format("{}.{}", layer.name, i))] = picture_array(std::move(mattes[i]), size_px);
      }
    }
  }
  return arrays;
}

py::dict layers(Renderer &renderer, const std::vector<std::string> &names,
                const std::optional<Thing<scene::Node>> &camera, const py::object &progress)
{
  using eevee::LayerSource;
  const std::set<LayerSource> sources = layer_sources(names);
  const LayerRequest request{.surfaces = eevee::surface_request(names),
                             .has_light = sources.contains(LayerSource::Lamp),
                             .has_emission = sources.contains(LayerSource::Emission),
                             .has_world = sources.contains(LayerSource::World)};
  Layers drawn = drawn_by(renderer, camera, progress, [&](const scene::PlacedCamera &placed, const auto &report) {
    return renderer.render_layers(placed, {.progress = report}, request);
  });
  return layer_arrays(renderer, names, sources, drawn);
}

/** Each message of these errors names the object or file and the reason. */
void define_errors(py::module_ &module)
{
  const py::exception<std::exception> base(module, "Error", PyExc_Exception);
  py::register_exception<gltf::ImportError>(module, "FileError", base.ptr());
  static const py::handle file_error = module.attr("FileError");
  py::register_exception_translator([](std::exception_ptr thrown) {
    // Names of files may be no UTF-8, which PyErr_SetString needs.
    const auto raise_file_error = [](std::string_view message) {
      const auto text = py::reinterpret_steal<py::object>(
          PyUnicode_DecodeUTF8(message.data(), py::ssize_t(message.size()), "surrogateescape"));
      PyErr_SetObject(file_error.ptr(), text.ptr());
    };
    try {
      std::rethrow_exception(thrown);
    }
    catch (const gltf::ImportError &error) {
      raise_file_error(error.what());
    }
    catch (const gltf::ExportError &error) {
      raise_file_error(error.what());
    }
  });
  py::register_exception<scene::StaleHandle>(module, "StaleHandle", base.ptr());
  py::register_exception<scene::InvalidEdit>(module, "InvalidEdit", base.ptr());
  const auto device_error = py::register_exception<gpu::Error>(module, "DeviceError", base.ptr());
  py::register_exception<gpu::DeviceLost>(module, "DeviceLost", device_error.ptr());
}

}  // namespace

py::array_t<float> picture_array(std::vector<glm::vec4> pixels, glm::ivec2 size_px)
{
  auto owned = std::make_unique<std::vector<glm::vec4>>(std::move(pixels));
  constexpr auto value_bytes = py::ssize_t(sizeof(float));
  constexpr auto pixel_bytes = py::ssize_t(sizeof(glm::vec4));
  const py::ssize_t row_bytes = pixel_bytes * size_px.x;
  const float *top = &(owned->end() - size_px.x)->x;
  const py::capsule owner(owned.get(), [](void *vector) { delete static_cast<std::vector<glm::vec4> *>(vector); });
  static_cast<void>(owned.release());
  return {{py::ssize_t(size_px.y), py::ssize_t(size_px.x), py::ssize_t(4)},
          {-row_bytes, pixel_bytes, value_bytes},
          top,
          owner};
}

void define_device(py::module_ &module)
{
  py::class_<Device, std::shared_ptr<Device>>(module, "Device",
                                              "A GPU, or a software rasteriser. It and its renderers are used on one "
                                              "thread: the one that made it.")
      .def(py::init<const std::string &, bool>(), py::arg("backend") = "auto", py::kw_only(), py::arg("host") = false,
           "backend: 'gl', 'vulkan', or 'auto': OpenGL if it starts, otherwise Vulkan. host: draw in the context of "
           "OpenGL that is current on this thread, 4.5 core or later, for Renderer.draw; it must be current in each "
           "later call, too, and its state is restored after each. Raises DeviceError, which names each way that was "
           "tried and why it failed.")
      .def("free", &Device::free,
           "Free the device, for hosts that go on without it. Its renderers must be gone. What a device with a host "
           "has in its context is freed by this call alone.")
      .def_property_readonly(
          "description", [](Device &device) { return device.use().description(); }, "API, driver and kind of context.")
      .def_property_readonly(
          "memory_bytes", [](Device &device) { return device.use().memory_bytes(); },
          "Content of all textures, buffers and meshes on the device, bytes.");
}

/** Classes that describe a renderer's pictures and properties. */
void define_answers(py::module_ &module)
{
  py::class_<Report>(module, "Report", "Facts about a renderer's last picture.")
      .def_readonly("warnings", &Report::warnings, "One text for each thing that is not drawn.")
      .def_readonly("limits", &Report::limits, "One text for each limit that was reached.")
      .def_readonly("sample_count", &Report::sample_count, "Samples drawn for each pixel.")
      .def_readonly("frame_seconds", &Report::frame_seconds,
                    "Wall time of the picture until the device is done, without the copy of its pixels, s.")
      .def_readonly("memory_bytes", &Report::memory_bytes, "Content of everything on the device, bytes.");

  py::class_<Description>(module, "Description", "A setting as programs show it.")
      .def_readonly("label", &Description::label, "A short text, or the name of the property.")
      .def_readonly("group", &Description::group, "A header for several settings; empty: none.")
      .def_readonly("unit", &Description::unit, "Unit of the value; empty: none.")
      .def_readonly("sentence", &Description::sentence, "The meaning.")
      .def_readonly("zero", &Description::zero,
                    "The meaning of 0 where it is allowed beside the limits; empty: it is not.")
      .def_readonly("min", &Description::min, "The least number.")
      .def_readonly("max", &Description::max, "The largest number.")
      .def_readonly("words", &Description::words, "Words for the values of an enumeration, or for False and True.")
      .def_readonly("type", &Description::type, "As in the stub.")
      .def_readonly("default", &Description::default_value,
                    "The value in pictures of Renderer.offline with 64 samples.");
}

void define_drawing(py::module_ &module, py::class_<Renderer, std::shared_ptr<Renderer>> &renderer)
{
  renderer.def("render", &render, py::arg("camera") = py::none(), py::arg("seconds_max") = infinite,
               py::arg("progress") = py::none(),
               "Draw a picture: an array of height x width x 4 float32 that owns its memory. Red, green and blue are "
               "scene-linear radiance, W/(sr m²), multiplied by alpha; the top row is the first.\n\n"
               "`camera`: a node that has one; None: the first of the scene. `seconds_max`: end the picture with fewer "
               "samples, s. `progress`: called on this thread after each sample with the number of samples; what it "
               "raises ends the picture. Other threads of the interpreter run meanwhile.");
  renderer.def(
      "refine", &refine, py::arg("seconds"), py::arg("camera") = py::none(),
      "For viewports: the picture within about this time, 0.0001 to 10 s, and whether it is complete. After a "
      "change, the first call draws a whole picture, in a lower resolution and with smaller shadows if the time "
      "asks for it; later calls refine it, and return the same array as long as it has not changed. The complete one "
      "equals that of render().");
  renderer.def(
      "draw", &draw, py::arg("seconds"), py::arg("framebuffer"), py::arg("framebuffer_size"),
      py::arg("rectangle") = py::none(), py::arg("camera") = py::none(), py::kw_only(), py::arg("encoding") = "display",
      py::arg("over") = false, py::arg("clip_from_view") = py::none(),
      ("As refine(), into a framebuffer of the host, for devices of Device(host=True). Returns whether the picture is "
       "complete.\n\n"
       "`framebuffer`: its name in OpenGL; 0: the window's. `framebuffer_size`: width and height, pixels. `rectangle`: "
       "left, bottom, width and height in it, pixels; None: all of it. A picture of another size is scaled. "
       "`encoding`: 'display', 'linear' (scene-linear, for formats of floating point), or 'srgb' (for sRGB formats, "
       "which apply the transfer function). `over`: blend the picture over the content. `clip_from_view`: the host's "
       "projection, depth from -1 to 1; the picture's depth is then written, and with `over` compared." +
       add_arguments(module, "_DrawProperties", display_fields))
          .c_str());
  renderer.def(
      "layers", &layers, py::arg("names"), py::arg("camera") = py::none(), py::arg("progress") = py::none(),
      "Draw a picture and layers of it, from the same samples: a dictionary of arrays, with the top row first, by "
      "these names:\n\n"
      "'combined': what render() returns. 'depth': m along the view's axis, 1e10 without a surface. 'position': m, "
      "world "
      "space. 'normal': unit vectors, world space. 'albedo', 'roughness': multiplied by the coverage of the pixel. "
      "'light': light.NAME for each name of lamps, W/(sr m²). 'emission', 'world': the rest of the light. 'ids': "
      "node_ids and material_ids, int32 indices in the scene's nodes and materials, -1 for none. 'crypto_object', "
      "'crypto_material': crypto_object.0, .1 and .2, each with two of the nodes that cover a pixel: cryptomatte_id of "
      "the name, coverage, id, coverage.\n\n"
      "depth, position, normal and ids are those of the surface at the centre of a pixel. Blended surfaces are not in "
      "them. Arrays of the same kind share their memory. Needs a sample_count and no noise_threshold. `progress`: as "
      "in render(), for the samples of the picture.");
}

void define_renderer(py::module_ &module)
{
  py::class_<Renderer, std::shared_ptr<Renderer>> renderer(
      module, "Renderer",
      "Draws a scene lit by its lamps and its world. A change of the scene or of a property takes effect with the next "
      "render(), which repeats only the work that depends on it.");
  renderer.def(py::init(&make_renderer), py::arg("device").none(false), py::arg("scene").none(false), py::arg("size"),
               "`size`: width and height, pixels. Further arguments set properties; sample_count is 16 without one.");
  renderer.def_static(
      "offline", &make_offline_renderer, py::arg("device").none(false), py::arg("scene").none(false), py::arg("size"),
      py::arg("sample_count") = 16,
      "A renderer of pictures for which there is time, with the shadows that `gnomon render` chooses for "
      "`sample_count` "
      "samples: with 16 or more, finer ones that are fitted to what the camera sees. Their edges move when the camera "
      "moves. Further arguments set properties.");
  for (const Field<Settings> &field : settings_fields) {
    renderer.def_property(
        field.name.c_str(), [&field](const Renderer &owner) { return field.get(owner.scene(), owner.settings()); },
        [&field](Renderer &owner, const py::object &value) {
          py::dict values;
          values[field.name.c_str()] = value;
          set_settings(owner, values);
        },
        field.doc.c_str());
  }
  annotate(renderer, settings_fields);
  renderer.def_property(
      "size", &Renderer::size_px, [](Renderer &owner, const glm::ivec2 &size_px) { owner.use().resize(size_px); },
      "Width and height of the picture, pixels.");
  renderer.def_static("descriptions", &descriptions,
                      "A Description of each property, by its name, for programs that show them.");
  define_drawing(module, renderer);
  renderer.def("report", &Renderer::report, "A Report on the last picture.");

  module.def("cryptomatte_id", &eevee::cryptomatte_id, py::arg("name"),
             "The number of a name in the layers 'crypto_object' and 'crypto_material'. Its bits are those of the "
             "manifest of Cryptomatte.");
  module.def("cryptomatte_hash", &eevee::murmur_hash3, py::arg("name"),
             "MurmurHash3_32 of a name, for the metadata of Cryptomatte.");
}

}  // namespace gnomon::python

PYBIND11_MODULE(_gnomon, module)
{
  using namespace gnomon::python;
  // Classes and errors carry the name of the package.
  module.attr("__name__") = "gnomon";
  define_errors(module);
  define_scene(module);
  define_device(module);
  define_answers(module);
  define_renderer(module);
#ifdef GNOMON_PYTHON_REFERENCE
  define_reference(module);
#endif
}
