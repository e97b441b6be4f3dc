// SPDX-License-Identifier: MIT
#include "python_pictures.hh"

#include "gltf_import.hh"
#include "image_decoder.hh"
#include "scene_tangents.hh"

#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace gnomon::python {

namespace {

using scene::Image;
using scene::Material;
using scene::Texture;

/** Largest width and height of an image, texels. The header of a damaged file may state any size. */
constexpr std::uint32_t length_max = 32768;

/** The first row is the top of the image. \throws py::type_error; py::value_error */
void set_texels(Image &image, const py::array &texels)
{
  if (!texels.dtype().equal(py::dtype::of<std::uint8_t>())) {
    throw py::type_error("texels: is an array of " + std::string(py::str(texels.dtype())) + ", not of uint8");
  }
  const bool is_image = texels.ndim() == 3 && texels.shape(0) > 0 && texels.shape(1) > 0 &&
                        (texels.shape(2) == 3 || texels.shape(2) == 4) && texels.shape(0) <= py::ssize_t(length_max) &&
                        texels.shape(1) <= py::ssize_t(length_max);
  if (!is_image) {
    throw py::value_error("texels: is not an array of height, width and 3 or 4 channels");
  }
  const auto values = py::array_t<std::uint8_t>(texels).unchecked<3>();
  image.height = std::uint32_t(texels.shape(0));
  image.width = std::uint32_t(texels.shape(1));
  image.texels.clear();
  image.texels.reserve(std::size_t(4) * image.width * image.height);
  for (py::ssize_t y = 0; y < values.shape(0); y++) {
    for (py::ssize_t x = 0; x < values.shape(1); x++) {
      for (py::ssize_t c = 0; c < 4; c++) {
        image.texels.push_back(c < values.shape(2) ? values(y, x, c) : std::uint8_t(255));
      }
    }
  }
}

Image read_image(const std::filesystem::path &path)
{
  // Opening a pipe might never end.
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw gltf::ImportError(path.string() + (std::filesystem::exists(path, error) ? ": is not a PNG, JPEG or WebP file"
                                                                                  : ": there is no such file"));
  }
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file) {
    throw gltf::ImportError(path.string() + ": cannot be read");
  }
  try {
    const std::unique_ptr<image::Decoder> decoder =
        image::open_decoder({reinterpret_cast<const unsigned char *>(bytes.data()), bytes.size()});
    if (decoder->width() > length_max || decoder->height() > length_max) {
      throw image::Error(fmt::format("{}x{} texels are too many", decoder->width(), decoder->height()));
    }
    return {path.filename().string(), decoder->width(), decoder->height(), decoder->read_rgba8()};
  }
  catch (const image::Error &fault) {
    throw gltf::ImportError(path.string() + ": " + fault.what());
  }
}

const Image &image_of(const Thing<Texture> &texture)
{
  return texture.scene->scene.images()[texture.value().image];
}

Thing<Texture> add_texture(const ScenePtr &scene, const py::object &source, const std::string &name)
{
  Image image;
  if (py::isinstance<py::array>(source)) {
    set_texels(image, source.cast<py::array>());
  }
  else {
    image = read_image(source.cast<std::filesystem::path>());
  }
  image.name = name.empty() ? image.name : name;
  scene::Scene &edited = scene->edited();
  return {scene, edited.add(Texture{.image = edited.add(std::move(image))})};
}

void set_world(const ScenePtr &scene, const glm::vec3 &color, float strength, float rotation, const py::object &picture)
{
  scene::World world{color, strength, rotation, nullptr};
  if (!picture.is_none()) {
    const auto texels = picture.cast<py::array>();
    if (texels.ndim() != 3) {
      throw py::value_error("picture: is not an array of height, width and three channels");
    }
    const auto rows = py::array(texels.attr("reshape")(-1, texels.shape(2)));
    world.picture = std::make_shared<const scene::WorldPicture>(
        scene::WorldPicture{int(texels.shape(1)), int(texels.shape(0)), rows_of<glm::vec3>(rows, "picture")});
  }
  scene->edited().set_world(std::move(world));
}

}  // namespace

Fields<Material> with_textures(Fields<Material> fields)
{
  for (const scene::TextureInput &input : scene::texture_inputs) {
    const auto slot = input.slot;
    fields.push_back({std::string(input.name),
                      input.is_color ? "A Texture, of which red, green and blue are encoded as sRGB, or None."
                                     : "A Texture of linear values, or None.",
                      "Texture | None",
                      [slot](const ScenePtr &scene, const Material &material) {
                        const scene::Handle<Texture> texture = (material.*slot).texture;
                        return scene->scene.textures().is_live(texture) ? py::cast(Thing<Texture>{scene, texture})
                                                                        : py::object(py::none());
                      },
                      [slot](const ScenePtr &scene, Material &material, py::handle set) {
                        (material.*slot).texture = set.is_none()
                                                       ? scene::Handle<Texture>()
                                                       : handle_of(scene, cast_to<Thing<Texture>>(set, " or None"));
                      }});
  }
  return fields;
}

void add_tangents(scene::Mesh &mesh)
{
  mesh.tangents.clear();
  const std::size_t count = mesh.positions.size();
  bool is_whole = !mesh.uvs.empty() && mesh.normals.size() == count &&
                  std::ranges::all_of(mesh.indices, [&](auto index) { return index < count; });
  scene::for_each_stream(mesh, [&](const auto &stream) { is_whole &= stream.empty() || stream.size() == count; });
  // Scene::add refuses a mesh whose arrays have different lengths.
  if (is_whole) {
    scene::make_tangents(mesh, {});
  }
}

void define_pictures(py::module_ &module, SceneClass &type)
{
  py::class_<Thing<Texture>>(
      module, "Texture", "An image that materials look up, repeated beyond its edges unless its file has it otherwise.")
      .def_property_readonly(
          "name", [](const Thing<Texture> &texture) { return image_of(texture).name; }, "Of its image, for messages.")
      .def_property(
          "texels",
          [](const Thing<Texture> &texture) {
            const Image &image = image_of(texture);
            py::array_t<std::uint8_t> texels({py::ssize_t(image.height), py::ssize_t(image.width), py::ssize_t(4)},
                                             image.texels.data());
            texels.attr("setflags")(py::arg("write") = false);
            return texels;
          },
          [](const Thing<Texture> &texture, const py::array &texels) {
            Image image = image_of(texture);
            set_texels(image, texels);
            texture.scene->edited().replace(texture.value().image, std::move(image));
          },
          "Height x width x 4 uint8, with the top row first: red, green, blue and alpha. A read-only copy; assign "
          "another, "
          "also of three channels, for all textures of the same image.")
      .def("__eq__",
           [](const Thing<Texture> &texture, const py::object &other) {
             return py::isinstance<Thing<Texture>>(other) && texture == other.cast<const Thing<Texture> &>();
           })
      .def("__hash__",
           [](const Thing<Texture> &texture) {
             return std::hash<ScenePtr>()(texture.scene) ^ std::hash<scene::Handle<Texture>>()(texture.handle);
           })
      .def("__repr__", [](const Thing<Texture> &texture) {
        return texture.scene->scene.textures().is_live(texture.handle)
                   ? fmt::format("<gnomon.Texture '{}'>", image_of(texture).name)
                   : std::string("<gnomon.Texture, removed>");
      });
  define_pool<Texture>(type, "textures");
  type.def(
      "add_texture", &add_texture, py::arg("source"), py::arg("name") = "",
      "Add a texture of `source`: height x width x 3 or 4 uint8, with the top row first, or the path of a PNG, JPEG or "
      "WebP file. Meshes need uvs for it. Raises FileError.");
  type.def("set_world", &set_world, py::arg("color") = glm::vec3(1.0F), py::arg("strength") = 1.0F,
           py::arg("rotation") = 0.0F, py::arg("picture") = py::none(),
           "Light from all around: color · strength · picture, W/(sr m²), at most 1e30. `rotation`: around +Y, rad. "
           "`picture`: equirectangular, height x width x 3 float32, with the top row first; None: uniform.");
  type.def(
      "remove_world", [](const ScenePtr &scene) { scene->edited().set_world(std::nullopt); },
      "Remove the light from all around.");
}

}  // namespace gnomon::python
