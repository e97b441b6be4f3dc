// SPDX-License-Identifier: MIT
#include "python_pictures.hh"

#include "gltf_export.hh"
#include "gltf_import.hh"

#include <pybind11/stl/filesystem.h>

#include <cctype>

namespace gnomon::python {

namespace {

using scene::Camera;
using scene::Lamp;
using scene::Material;
using scene::Mesh;
using scene::Node;
using scene::SurfaceFunction;

const Fields<Lamp> lamp_fields = [] {
  Fields<Lamp> fields = property_fields<Lamp>();
  add_property_fields<scene::LampShadow>(
      fields, [](auto &lamp) -> auto & { return lamp.shadow; });
  return fields;
}();

const Fields<SurfaceFunction> surface_function_fields = {
    plain_field<SurfaceFunction>("name", &SurfaceFunction::name, "For messages."),
    plain_field<SurfaceFunction>("text", &SurfaceFunction::text,
                                 "GLSL, at most 64 KiB, that defines surface(). doc/surfaces.md describes it."),
    plain_field<SurfaceFunction>("path", &SurfaceFunction::path,
                                 "The file of the text, for messages and saved scenes; empty: none."),
};

const Fields<Material> material_fields = [] {
  Fields<Material> fields = property_fields<Material>();
  fields.push_back(
      thing_field<Material, SurfaceFunction>("surface_function", &Material::surface_function,
                                             "A SurfaceFunction that edits the surface at each point, or None."));
  return with_textures(std::move(fields));
}();

/** \a what: \see rows_of */
void set_triangles(Mesh &mesh, const py::array &triangles, const std::string &what)
{
  mesh.topology = scene::Topology::Triangles;
  mesh.indices.clear();
  for (const glm::uvec3 &triangle : rows_of<glm::uvec3>(triangles, what)) {
    mesh.indices.insert(mesh.indices.end(), {triangle.x, triangle.y, triangle.z});
  }
}

const Fields<Camera> camera_fields = property_fields<Camera>();

/** Vectors, one for each position. */
template <typename Vector>
Field<Mesh> rows_field(std::string name, std::vector<Vector> Mesh::*member, std::string doc)
{
  return {std::move(name), std::move(doc), "NDArray[np.float32]",
          [=](const ScenePtr & /*scene*/, const Mesh &mesh) {
            const std::vector<Vector> &rows = mesh.*member;
            const float *numbers = rows.empty() ? nullptr : &rows.front().x;
            return py::object(array_of_rows(std::span(numbers, rows.size() * Vector::length()), Vector::length()));
          },
          [=](const ScenePtr & /*scene*/, Mesh &mesh, py::handle set) {
            mesh.*member = rows_of<Vector>(cast_to<py::array>(set), {});
          }};
}

const Fields<Mesh> mesh_fields = {
    plain_field<Mesh>("name", &Mesh::name, "For messages and files."),
    plain_field<Mesh>("extras", &Mesh::extras, std::string(scene::extras_sentence)),
    rows_field<glm::vec3>("positions", &Mesh::positions,
                          "N x 3 float32, m. Read-only; assign another array. edit() changes several arrays at once."),
    rows_field<glm::vec3>("normals", &Mesh::normals, "N x 3 float32, unit vectors. Read-only; assign another array."),
    rows_field<glm::vec2>("uvs", &Mesh::uvs,
                          "N x 2 float32, where the positions are in textures, or 0 x 2. (0, 0) is the upper left "
                          "corner, (1, 1) the lower right. Read-only; assign another array."),
    rows_field<glm::vec4>("colors", &Mesh::colors,
                          "N x 4 float32, linear red, green, blue and alpha from 0 to 1, which are multiplied with the "
                          "material's, or 0 x 4. Read-only; assign another array."),
    {"triangles",
     "M x 3 uint32, indices of positions, counter-clockwise as seen from the front. Read-only; assign another array. "
     "Meshes of lines or points from files have none.",
     "NDArray[np.uint32]",
     [](const ScenePtr & /*scene*/, const Mesh &mesh) {
       const bool is_triangles = mesh.topology == scene::Topology::Triangles;
       return py::object(array_of_rows(std::span(mesh.indices).first(is_triangles ? mesh.indices.size() : 0), 3));
     },
     [](const ScenePtr & /*scene*/, Mesh &mesh, py::handle set) { set_triangles(mesh, cast_to<py::array>(set), {}); }},
    thing_field<Mesh, Material>("material", &Mesh::material, "A Material. None: the default material."),
};

const Fields<Node> node_fields = [] {
  Fields<Node> fields = property_fields<Node>();
  const Fields<Node> content = {
      plain_field<Node>(
          "parent_from_node", &Node::parent_from_node,
          "Matrix of 4x4 float64, [row, column], m: column 3 is the position. Read-only; assign another."),
      {"position", "Position relative to the parent, m: column 3 of parent_from_node.", "Vector",
       [](const ScenePtr & /*scene*/, const Node &node) { return py::cast(glm::dvec3(node.parent_from_node[3])); },
       [](const ScenePtr & /*scene*/, Node &node, py::handle set) {
         node.parent_from_node[3] = glm::dvec4(cast_to<glm::dvec3>(set), 1.0);
       }},
      {"meshes", "A list of the meshes at the node. Assign another list to change it.", "list[Mesh]",
       [](const ScenePtr &scene, const Node &node) {
         py::list meshes;
         for (const scene::Handle<Mesh> mesh : node.meshes) {
           if (scene->scene.meshes().is_live(mesh)) {
             meshes.append(Thing<Mesh>{scene, mesh});
           }
         }
         return py::object(std::move(meshes));
       },
       [](const ScenePtr &scene, Node &node, py::handle set) {
         std::vector<scene::Handle<Mesh>> meshes;
         for (const Thing<Mesh> &mesh : cast_to<std::vector<Thing<Mesh>>>(set)) {
           meshes.push_back(handle_of(scene, mesh));
         }
         node.meshes = std::move(meshes);
       }},
      thing_field<Node, Lamp>("lamp", &Node::lamp, "A Lamp that shines along the node's -Z axis, or None."),
      thing_field<Node, Camera>("camera", &Node::camera, "A Camera that looks along the node's -Z axis, or None."),
  };
  fields.insert(fields.end(), content.begin(), content.end());
  return fields;
}();

/** Check and set members that depend on several fields. \a values: the fields that were set */
template <typename T>
void finish(T & /*value*/, const py::dict & /*values*/)
{
}

void finish(Mesh &mesh, const py::dict &values)
{
  // Tangents split vertices, so that they must wait for all arrays.
  for (const char *shape : {"positions", "normals", "uvs", "triangles"}) {
    if (values.contains(shape)) {
      add_tangents(mesh);
      return;
    }
  }
}

template <typename T>
void edit(const Fields<T> &fields, const Thing<T> &thing, const py::dict &values)
{
  T value = thing.value();
  set_fields(fields, label_of(value), thing.scene, value, values);
  finish(value, values);
  thing.scene->edited().replace(thing.handle, std::move(value));
}

/** A new value with the properties of \a values. */
template <typename T>
T made(const Fields<T> &fields, const ScenePtr &scene, const py::dict &values, T value = {})
{
  set_fields(fields, std::string(T::kind_name), scene, value, values);
  finish(value, values);
  return value;
}

template <typename T>
void define_thing(py::module_ &module, const char *name, const char *doc, const Fields<T> &fields)
{
  py::class_<Thing<T>> type(module, name, doc);
  for (const Field<T> &field : fields) {
    type.def_property(
        field.name.c_str(), [&field](const Thing<T> &thing) { return field.get(thing.scene, thing.value()); },
        [&field, &fields](const Thing<T> &thing, const py::object &value) {
          py::dict values;
          values[field.name.c_str()] = value;
          edit(fields, thing, values);
        },
        field.doc.c_str());
  }
  annotate(type, fields);
  type.def(
      "edit", [&fields](const Thing<T> &thing, const py::kwargs &values) { edit(fields, thing, values); },
      "Set several properties in one edit: all of them, or none if one is invalid.");
  type.def("__eq__", [](const Thing<T> &thing, const py::object &other) {
    return py::isinstance<Thing<T>>(other) && thing == other.cast<const Thing<T> &>();
  });
  type.def("__hash__", [](const Thing<T> &thing) {
    return std::hash<ScenePtr>()(thing.scene) ^ std::hash<scene::Handle<T>>()(thing.handle);
  });
  type.def("__repr__", [name](const Thing<T> &thing) {
    const scene::Scene &scene = thing.scene->scene;
    const T *value = scene.pool<T>().find(thing.handle);
    return value ? fmt::format("<gnomon.{} '{}'>", name, value->name) : fmt::format("<gnomon.{}, removed>", name);
  });
}

template <typename T>
void define_add(SceneClass &type, const char *name, const Fields<T> &fields, const char *doc)
{
  type.def(
      name,
      [&fields](const ScenePtr &scene, const py::kwargs &values) {
        // Before edited(): conversions run the caller's code, which may let another thread draw.
        T value = made(fields, scene, values);
        return Thing<T>{scene, scene->edited().add(std::move(value))};
      },
      doc);
}

Thing<Node> add_node(const ScenePtr &scene, const std::optional<Thing<Node>> &parent, const py::kwargs &values)
{
  Node node = made(node_fields, scene, values);
  const scene::Handle<Node> above = parent ? handle_of(scene, *parent) : scene::Handle<Node>();
  return {scene, scene->edited().add(std::move(node), above)};
}

Thing<Mesh> add_mesh(const ScenePtr &scene, const py::array &positions, const py::array &normals,
                     const py::array &triangles, const std::optional<py::array> &uvs, const py::kwargs &values)
{
  Mesh mesh;
  mesh.positions = rows_of<glm::vec3>(positions, "positions");
  mesh.normals = rows_of<glm::vec3>(normals, "normals");
  set_triangles(mesh, triangles, "triangles");
  if (uvs) {
    mesh.uvs = rows_of<glm::vec2>(*uvs, "uvs");
  }
  mesh = made(mesh_fields, scene, values, std::move(mesh));
  add_tangents(mesh);
  return {scene, scene->edited().add(std::move(mesh))};
}

/** The options that are no arguments of their own. */
Fields<gltf::ImportOptions> further_import_fields()
{
  Fields<gltf::ImportOptions> fields = property_fields<gltf::ImportOptions>();
  std::erase_if(fields, [](const auto &field) { return field.name == "variant"; });
  return fields;
}

const Fields<gltf::ImportOptions> import_fields = further_import_fields();

/** \a progress: called with the completed fraction. An exception that it raises, or a signal, ends the import. */
ScenePtr load(const std::filesystem::path &path, const std::string &variant, const py::object &progress,
              const std::optional<std::filesystem::path> &only_below, const py::kwargs &values)
{
  gltf::ImportOptions options{.variant = variant,
                              .only_below = only_below && only_below->empty() ? "." : only_below.value_or("")};
  set_fields(import_fields, "load", nullptr, options, values);
  const auto scene = std::make_shared<SharedScene>();
  // The importer would take it for an error of the file.
  std::exception_ptr raised;
  const auto report = [&](float part) {
    const py::gil_scoped_acquire locked;
    try {
      if (PyErr_CheckSignals() != 0) {
        throw py::error_already_set();
      }
      if (!progress.is_none()) {
        progress(part);
      }
    }
    catch (...) {
      raised = std::current_exception();
    }
    return !raised;
  };
  try {
    const py::gil_scoped_release unlocked;
    options.progress = report;
    scene->scene = gltf::import_gltf(path, options);
  }
  catch (const gltf::ImportCancelled &) {
    std::rethrow_exception(raised);
  }
  return scene;
}

void save(const ScenePtr &scene, const std::filesystem::path &path)
{
  const Reading reading(scene);
  const py::gil_scoped_release unlocked;
  gltf::export_gltf(scene->scene, path);
}

/** The same, with a warning of what the scene's file has and the new one has not. */
void save_with_warning(const ScenePtr &scene, const std::filesystem::path &path)
{
  std::string left_out;
  {
    // Before the file is replaced.
    const Reading reading(scene);
    const py::gil_scoped_release unlocked;
    left_out = gltf::left_out_of_export(scene->scene.path);
  }
  save(scene, path);
  const std::string text = "the scene is saved without its " + left_out;
  if (!left_out.empty() && PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) {
    throw py::error_already_set();
  }
}

/** Its values have the words of the scene as names. */
template <typename Enum>
void define_enum(py::module_ &module, const char *doc)
{
  py::enum_<Enum> type(module, enum_name<Enum>, doc);
  for (std::size_t value = 0; value < scene::words<Enum>.size(); value++) {
    std::string name(scene::words<Enum>[value]);
    std::ranges::transform(name, name.begin(), [](char letter) { return char(std::toupper(letter)); });
    type.value(name.c_str(), Enum(value));
  }
}

void define_enums(py::module_ &module)
{
  using scene::AlphaMode;
  using scene::AreaShape;
  using scene::CameraKind;
  using scene::EsmFormat;
  using scene::LampKind;
  using scene::ShadowKind;
  define_enum<LampKind>(module, "Kind of a lamp.");
  define_enum<AreaShape>(module, "Shape of an area lamp.");
  define_enum<ShadowKind>(module, "Method of a lamp's shadow. doc/shadows.md explains them.");
  define_enum<AlphaMode>(module, "How a material's alpha is used.");
  define_enum<CameraKind>(module, "Projection of a camera.");
  // Its words are no names in Python.
  py::enum_<EsmFormat>(module, enum_name<EsmFormat>, "Numbers of the layer of an exponential shadow.")
      .value("HALF", EsmFormat::Half)
      .value("FLOAT", EsmFormat::Float);
}

}  // namespace

scene::PlacedCamera camera_at(const ScenePtr &scene, const std::optional<Thing<Node>> &node)
{
  const scene::Handle<Node> wanted = node ? handle_of(scene, *node) : scene::Handle<Node>();
  for (scene::PlacedCamera &camera : scene->scene.placed_cameras()) {
    if (!node || camera.node == wanted) {
      return std::move(camera);
    }
  }
  throw scene::InvalidEdit(node ? label_of(node->value()) + ": has no camera"
                                : fmt::format("scene '{}': has no camera", scene->scene.path));
}

/** Define the classes of what a scene has. */
static void define_things(py::module_ &module)
{
  define_thing(module, "Lamp", "A lamp. It shines along the -Z axis of the nodes that have it.", lamp_fields);
  define_thing(module, "SurfaceFunction", "A function in GLSL that edits the surface of the materials that name it.",
               surface_function_fields);
  define_thing(module, "Material", "A metallic-roughness surface of glTF 2.0.", material_fields);
  define_thing(module, "Camera", "A camera. It looks along the -Z axis of the nodes that have it, +Y up.",
               camera_fields);
  define_thing(module, "Mesh", "Triangles of one material.", mesh_fields);
  define_thing(module, "Node", "A position in the scene with its contents. Nodes form trees.", node_fields);
  py::reinterpret_borrow<py::class_<Thing<Node>>>(module.attr("Node"))
      .def_property_readonly(
          "world_from_node", [](const Thing<Node> &node) { return node.scene->scene.world_from_node(node.handle); },
          "Product of all matrices from the root to the node: 4x4 float64, [row, column], m. Read-only.")
      .def_property(
          "parent",
          [](const Thing<Node> &node) {
            const scene::Handle<Node> parent = node.scene->scene.parent(node.handle);
            return parent ? std::optional(Thing<Node>{node.scene, parent}) : std::nullopt;
          },
          [](const Thing<Node> &node, const std::optional<Thing<Node>> &parent) {
            node.scene->edited().set_parent(node.handle,
                                            parent ? handle_of(node.scene, *parent) : scene::Handle<Node>());
          },
          "A Node, or None for a root. A change keeps parent_from_node.");
}

void define_scene(py::module_ &module)
{
  define_enums(module);
  SceneClass type(
      module, "Scene",
      "Nodes, meshes, materials, textures, lamps and cameras. World space is right-handed, in metres.\n\n"
      "Things are handles: their properties read and edit the scene, and raise StaleHandle once the thing is removed.");
  define_things(module);
  type.def(py::init<>(), "A scene without content.");
  for (const char *name : {"__copy__", "__deepcopy__"}) {
    type.def(name, [](const ScenePtr &scene, const py::args & /*memo*/) {
      const auto copy = std::make_shared<SharedScene>();
      const Reading reading(scene);
      copy->scene = scene->scene;
      return copy;
    });
  }
  define_pool<Node>(type, "nodes");
  define_pool<Mesh>(type, "meshes");
  define_pool<SurfaceFunction>(type, "surface_functions");
  define_pool<Material>(type, "materials");
  define_pool<Lamp>(type, "lamps");
  define_pool<Camera>(type, "cameras");
  define_add(type, "add_lamp", lamp_fields,
             "Add a lamp with these properties. It gives light at the nodes that have it.");
  define_add(type, "add_surface_function", surface_function_fields, "Add a surface function with these properties.");
  define_add(type, "add_material", material_fields, "Add a material with these properties.");
  define_add(type, "add_camera", camera_fields,
             "Add a camera with these properties. It is used at the nodes that have it.");
  type.def("add_node", &add_node, py::arg("parent") = py::none(),
           "Add a node with these properties, as the last child of `parent` or as a root.");
  type.def(
      "add_mesh", &add_mesh, py::arg("positions"), py::arg("normals"), py::arg("triangles"),
      py::arg("uvs") = py::none(),
      "Add a mesh: `positions` (m) and `normals` (unit vectors) are arrays of N x 3 float32, `triangles` of M x 3 "
      "uint32 indices, counter-clockwise as seen from the front. It is drawn at the nodes that have it. `uvs`: "
      "where the positions are in textures, N x 2 float32; (0, 0) is the upper left corner, (1, 1) the lower right. "
      "Further arguments: the properties `colors`, `name` and `material` of Mesh.");
  define_pictures(module, type);
  type.def("_save", &save);
  type.def(
      "save", &save_with_warning, py::arg("path"),
      "Write the scene as glTF 2.0: .gltf or .glb. Variants of materials and some extras of other programs are left "
      "out, with a warning. Raises FileError.");
  const auto define_extras = [&type](const char *name, std::string scene::Scene::*extras, const char *sentence) {
    type.def_property(
        name, [extras](const ScenePtr &scene) { return scene->scene.*extras; },
        [extras](const ScenePtr &scene, std::string text) { scene->edited().*extras = std::move(text); }, sentence);
  };
  define_extras("extras", &scene::Scene::extras,
                "What other programs have added to the scene in its file, as Node.extras.");
  define_extras("file_extras", &scene::Scene::file_extras,
                "What other programs have added to the file itself, as Node.extras.");
  type.def_property_readonly(
      "warnings", [](const ScenePtr &scene) { return scene->scene.warnings; },
      "One text for each thing in the file that is not read.");
  type.def_property_readonly(
      "bounds",
      [](const ScenePtr &scene) {
        const scene::Bounds bounds = scene->scene.bounds();
        return bounds.is_empty() ? std::nullopt : std::optional(std::pair(bounds.min, bounds.max));
      },
      "Lowest and highest corner of the box around all visible meshes, m. None if there are none.");
  module.def(
      "load", &load, py::arg("path"), py::arg("variant") = "", py::arg("progress") = py::none(),
      py::arg("only_below") = py::none(),
      ("Read a glTF 2.0 file. `variant`: name of a variant of its materials. `progress`: called on this thread with "
       "the part that is done, 0 to 1; what it raises ends the import. `only_below`: a folder; files that the scene "
       "names elsewhere are refused. Raises FileError." +
       add_arguments(module, "_LoadProperties", import_fields))
          .c_str());
}

}  // namespace gnomon::python
