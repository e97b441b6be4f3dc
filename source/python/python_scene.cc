// SPDX-License-Identifier: MIT
#include "python_pictures.hh"

#include "gltf_export.hh"
#include "gltf_import.hh"

#include <pybind11/stl/filesystem.h>

#include <numbers>

namespace gnomon::python {

namespace {

using scene::Camera;
using scene::Lamp;
using scene::Material;
using scene::Mesh;
using scene::Node;
using scene::SurfaceFunction;
using std::numbers::pi;

const Fields<Lamp> lamp_fields = {
    plain_field<Lamp>("name", &Lamp::name, "For messages and files."),
    plain_field<Lamp>("kind", &Lamp::kind, "A LampKind."),
    number_field<Lamp>("color", &Lamp::color, 0, float_max, "Linear red, green and blue, at least 0."),
    number_field<Lamp>(
        "intensity", &Lamp::intensity, 0, float_max,
        "Point and spot: radiant intensity, W/sr. Sun: irradiance on a surface that faces it, W/m²; hemi "
        "the same, of a sky over the half space behind it. Area: power, W. At least 0."),
    number_field<Lamp>("radius", &Lamp::radius, 0, 1e12, "Point and spot: radius, m, at least 0. 0: a hard shadow."),
    number_field<Lamp>("angle", &Lamp::angle, 0, pi, "Sun: angular diameter, rad, 0 to π. 0: a hard shadow."),
    number_field<Lamp>("spot_outer_angle", &Lamp::spot_outer_angle, 1e-9, 0.5 * pi + 1e-6,
                       "Spot: half the opening angle, rad, above 0 to π/2."),
    number_field<Lamp>("spot_blend", &Lamp::spot_blend, 0, 1, "Spot: width of the soft edge, 0 to 1. 0: a hard edge."),
    number_field<Lamp>("range", &Lamp::range, 0, float_max,
                       "Point and spot: no light beyond, m, at least 0. 0: no limit."),
    plain_field<Lamp>("area_shape", &Lamp::area_shape, "Area: an AreaShape."),
    number_field<Lamp>("area_size_x", &Lamp::area_size_x, 1e-9, 1e9, "Area: full edge length or diameter, m, above 0."),
    number_field<Lamp>("area_size_y", &Lamp::area_size_y, 1e-9, 1e9, "Area: full edge length or diameter, m, above 0."),
    plain_field<Lamp>(
        "shadow_kind", [](auto &lamp) -> auto & { return lamp.shadow.kind; },
        "A ShadowKind. None: that of the renderer."),
    optional_field<Lamp>(
        "shadow_size_px", [](auto &lamp) -> auto & { return lamp.shadow.size; }, 1, 16384,
        "Texels along an edge of the depth map or of a cube's face, 1 to 16384. None: that of the renderer."),
    optional_field<Lamp>(
        "shadow_bias", [](auto &lamp) -> auto & { return lamp.shadow.bias; }, 0, 100,
        "Factor of the bias that is derived from the texel size, 0 to 100. None: 1."),
    optional_field<Lamp>(
        "shadow_clip_start", [](auto &lamp) -> auto & { return lamp.shadow.clip_start; }, 1e-9, float_max,
        "Casters that are nearer to the lamp cast no shadow, m, above 0. None: all cast one."),
    optional_field<Lamp>(
        "shadow_clip_end", [](auto &lamp) -> auto & { return lamp.shadow.clip_end; }, 1e-9, float_max,
        "Casters that are farther from the lamp cast no shadow, m, above shadow_clip_start. None: all cast one."),
    optional_field<Lamp>(
        "shadow_exponent", [](auto &lamp) -> auto & { return lamp.shadow.exponent; }, 0.01, 1e4,
        "ESM and EVSM: exponent, 1/m, 0.01 to 1e4. None: it follows the size and the lamp's range."),
    optional_field<Lamp>(
        "shadow_filter_angle", [](auto &lamp) -> auto & { return lamp.shadow.filter_angle; }, 0, 0.25 * pi,
        "ESM and EVSM: half the opening angle of the filter, rad, 0 to π/4. None: that of a texel."),
    optional_field<Lamp>(
        "shadow_esm_size_px", [](auto &lamp) -> auto & { return lamp.shadow.esm_size; }, 1, 16384,
        "ESM and EVSM: texels along an edge of the octahedral map, 1 to 16384. None: that of the renderer."),
};

const Fields<SurfaceFunction> surface_function_fields = {
    plain_field<SurfaceFunction>("name", &SurfaceFunction::name, "For messages."),
    plain_field<SurfaceFunction>("text", &SurfaceFunction::text,
                                 "GLSL, at most 64 KiB, that defines surface(). doc/surfaces.md describes it."),
    plain_field<SurfaceFunction>("path", &SurfaceFunction::path,
                                 "The file of the text, for messages and saved scenes; empty: none."),
};

const Fields<Material> material_fields = with_textures({
    plain_field<Material>("name", &Material::name, "For messages and files."),
    number_field<Material>("base_color", &Material::base_color, 0, 1, "Linear red, green and blue, 0 to 1."),
    number_field<Material>("alpha", &Material::alpha, 0, 1, "0 to 1; has an effect by alpha_mode."),
    plain_field<Material>("alpha_mode", &Material::alpha_mode, "An AlphaMode."),
    number_field<Material>("alpha_cutoff", &Material::alpha_cutoff, 0, float_max,
                           "AlphaMode.MASK: the surface is cut out where alpha is below."),
    number_field<Material>("metallic", &Material::metallic, 0, 1, "0 to 1."),
    number_field<Material>("roughness", &Material::roughness, 0, 1, "Perceptual, 0 to 1."),
    number_field<Material>("normal_scale", &Material::normal_scale, -float_max, float_max,
                           "Factor of the normal texture's red and green."),
    number_field<Material>("occlusion_strength", &Material::occlusion_strength, 0, 1, "0: no occlusion; to 1."),
    number_field<Material>("specular", &Material::specular, 0, 1,
                           "Factor of dielectric reflection, 0 to 1. 0: a Lambertian surface."),
    number_field<Material>("specular_color", &Material::specular_color, 0, float_max,
                           "Tint of dielectric reflection, at least 0."),
    number_field<Material>("coat", &Material::coat, 0, 1, "Part of the surface under a clear coat, 0 to 1."),
    number_field<Material>("coat_roughness", &Material::coat_roughness, 0, 1, "Perceptual, 0 to 1."),
    number_field<Material>("coat_normal_scale", &Material::coat_normal_scale, -float_max, float_max,
                           "Factor of the coat's normal texture."),
    number_field<Material>("sheen_color", &Material::sheen_color, 0, 1, "Reflectance of fibres, 0 to 1."),
    number_field<Material>("sheen_roughness", &Material::sheen_roughness, 0, 1, "Perceptual, 0 to 1."),
    number_field<Material>("anisotropy", &Material::anisotropy, 0, 1,
                           "How much rougher the base is along one direction, 0 to 1. Meshes need tangents."),
    number_field<Material>("anisotropy_rotation", &Material::anisotropy_rotation, -float_max, float_max,
                           "Angle of that direction from the tangent, radians, counter-clockwise."),
    number_field<Material>(
        "transmission", &Material::transmission, 0, 1,
        "Part of the light that passes the surface, 0 (opaque) to 1. The other values of glass need it."),
    number_field<Material>(
        "thickness", &Material::thickness, 0, float_max,
        "Length of the light's way inside of the object, object space. 0: a thin wall, no refraction."),
    number_field<Material>("ior", &Material::ior, 1, float_max,
                           "Index of refraction of the volume, at least 1. It does not change the reflection."),
    number_field<Material>("attenuation_distance", &Material::attenuation_distance, 0, float_max,
                           "Metres after which attenuation_color is left of white light. 0: nothing is absorbed."),
    number_field<Material>("attenuation_color", &Material::attenuation_color, 0, 1, "Red, green and blue, 0 to 1."),
    number_field<Material>("emissive", &Material::emissive, 0, float_max,
                           "Emitted radiance, W/(sr m²), red, green and blue, at least 0."),
    plain_field<Material>("is_unlit", &Material::is_unlit, "The radiance is the base colour."),
    plain_field<Material>("is_double_sided", &Material::is_double_sided, "False: back faces are not drawn."),
    thing_field<Material, SurfaceFunction>("surface_function", &Material::surface_function,
                                           "A SurfaceFunction that edits the surface at each point, or None."),
});

/** \a what: \see rows_of */
void set_triangles(Mesh &mesh, const py::array &triangles, const std::string &what)
{
  mesh.topology = scene::Topology::Triangles;
  mesh.indices.clear();
  for (const glm::uvec3 &triangle : rows_of<glm::uvec3>(triangles, what)) {
    mesh.indices.insert(mesh.indices.end(), {triangle.x, triangle.y, triangle.z});
  }
}

/** Far beyond any use, and within what a projection in single precision can hold. */
constexpr double camera_length_max = 1e9;
constexpr double camera_length_min = 1e-9;

const Fields<Camera> camera_fields = {
    plain_field<Camera>("name", &Camera::name, "For messages and files."),
    plain_field<Camera>("kind", &Camera::kind, "A CameraKind."),
    number_field<Camera>("vertical_angle", &Camera::vertical_angle, 1e-6, 3.1415,
                         "Perspective: full vertical angle, rad, above 0 and below π."),
    number_field<Camera>("aspect", &Camera::aspect, 0, 1e6,
                         "Perspective: width / height of the frame. 0: that of the picture."),
    number_field<Camera>("half_width", &Camera::half_width, camera_length_min, camera_length_max,
                         "Orthographic: half the width of the frame, m, above 0."),
    number_field<Camera>("half_height", &Camera::half_height, camera_length_min, camera_length_max,
                         "Orthographic: half the height of the frame, m, above 0."),
    number_field<Camera>("near", &Camera::near, -camera_length_max, camera_length_max,
                         "Distance of the near plane, m; above 0 where perspective."),
    number_field<Camera>("far", &Camera::far, 0, float_max, "Distance of the far plane, m. 0: infinite."),
};

/** Vectors, one for each position. */
template <typename Vector>
Field<Mesh> rows_field(std::string name, std::vector<Vector> Mesh::*member, std::string doc)
{
  return {std::move(name), std::move(doc),
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
    rows_field<glm::vec3>("positions", &Mesh::positions,
                          "N x 3 float32, m. Read-only; assign another array. edit() changes several arrays at once."),
    rows_field<glm::vec3>("normals", &Mesh::normals, "N x 3 float32, unit vectors. Read-only; assign another array."),
    rows_field<glm::vec2>("uvs", &Mesh::uvs,
                          "N x 2 float32, where the positions are in textures, or 0 x 2. (0, 0) is the upper left "
                          "corner, (1, 1) the lower right. Read-only; assign another array."),
    {"triangles",
     "M x 3 uint32, indices of positions, counter-clockwise as seen from the front. Read-only; assign another array. "
     "Meshes of lines or points from files have none.",
     [](const ScenePtr & /*scene*/, const Mesh &mesh) {
       const bool is_triangles = mesh.topology == scene::Topology::Triangles;
       return py::object(array_of_rows(std::span(mesh.indices).first(is_triangles ? mesh.indices.size() : 0), 3));
     },
     [](const ScenePtr & /*scene*/, Mesh &mesh, py::handle set) { set_triangles(mesh, cast_to<py::array>(set), {}); }},
    thing_field<Mesh, Material>("material", &Mesh::material, "A Material. None: the default material."),
};

const Fields<Node> node_fields = {
    plain_field<Node>("name", &Node::name, "For messages and files."),
    plain_field<Node>("parent_from_node", &Node::parent_from_node,
                      "Matrix of 4x4 float64, [row, column], m: column 3 is the position. Read-only; assign another."),
    {"position", "Position relative to the parent, m: column 3 of parent_from_node.",
     [](const ScenePtr & /*scene*/, const Node &node) { return py::cast(glm::dvec3(node.parent_from_node[3])); },
     [](const ScenePtr & /*scene*/, Node &node, py::handle set) {
       node.parent_from_node[3] = glm::dvec4(cast_to<glm::dvec3>(set), 1.0);
     }},
    {"meshes", "A list of the meshes at the node. Assign another list to change it.",
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
    plain_field<Node>("is_visible", &Node::is_visible,
                      "False: neither the node nor its descendants are drawn or shine."),
    plain_field<Node>("casts_shadow", &Node::casts_shadow, "Whether the node's meshes cast shadows."),
    plain_field<Node>("receives_shadow", &Node::receives_shadow, "Whether the node's meshes receive shadows."),
};

/** Checks and sets what depends on several fields. \a values: those that were set */
template <typename T>
void finish(T & /*value*/, const py::dict & /*values*/)
{
}

void finish(Camera &camera, const py::dict & /*values*/)
{
  if (camera.kind == scene::CameraKind::Perspective && camera.near < camera_length_min) {
    throw scene::InvalidEdit(fmt::format("camera '{}': near {} is not above 0", camera.name, camera.near));
  }
}

void finish(Lamp &lamp, const py::dict & /*values*/)
{
  const scene::LampShadow &shadow = lamp.shadow;
  if (shadow.clip_start && shadow.clip_end && *shadow.clip_end <= *shadow.clip_start) {
    throw scene::InvalidEdit(fmt::format("lamp '{}': shadow_clip_end {} is not above shadow_clip_start {}", lamp.name,
                                         *shadow.clip_end, *shadow.clip_start));
  }
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
  add_tangents(mesh);
  mesh = made(mesh_fields, scene, values, std::move(mesh));
  return {scene, scene->edited().add(std::move(mesh))};
}

/** \a progress: called with the part that is done; what it raises, and signals, end the import. */
ScenePtr load(const std::filesystem::path &path, const std::string &variant, const py::object &progress,
              const std::optional<std::filesystem::path> &only_below)
{
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
    scene->scene =
        gltf::import_gltf(path, {.variant = variant,
                                 .only_below = only_below && only_below->empty() ? "." : only_below.value_or(""),
                                 .progress = report});
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

void define_enums(py::module_ &module)
{
  using scene::AlphaMode;
  using scene::AreaShape;
  using scene::CameraKind;
  using scene::LampKind;
  using scene::ShadowKind;
  py::enum_<LampKind>(module, "LampKind", "Kind of a lamp.")
      .value("POINT", LampKind::Point)
      .value("SUN", LampKind::Sun)
      .value("SPOT", LampKind::Spot)
      .value("HEMI", LampKind::Hemi)
      .value("AREA", LampKind::Area);
  py::enum_<AreaShape>(module, "AreaShape", "Shape of an area lamp.")
      .value("RECTANGLE", AreaShape::Rectangle)
      .value("ELLIPSE", AreaShape::Ellipse);
  py::enum_<ShadowKind>(module, "ShadowKind", "Method of a lamp's shadow. doc/shadows.md explains them.")
      .value("NONE", ShadowKind::None)
      .value("HARD", ShadowKind::Hard)
      .value("PCF", ShadowKind::Pcf)
      .value("ESM", ShadowKind::Esm)
      .value("EVSM", ShadowKind::Evsm);
  py::enum_<AlphaMode>(module, "AlphaMode", "How a material's alpha is used.")
      .value("OPAQUE", AlphaMode::Opaque)
      .value("MASK", AlphaMode::Mask)
      .value("BLEND", AlphaMode::Blend);
  py::enum_<CameraKind>(module, "CameraKind", "Projection of a camera.")
      .value("PERSPECTIVE", CameraKind::Perspective)
      .value("ORTHOGRAPHIC", CameraKind::Orthographic);
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

void define_scene(py::module_ &module)
{
  define_enums(module);
  SceneClass type(
      module, "Scene",
      "Nodes, meshes, materials, textures, lamps and cameras. World space is right-handed, in metres.\n\n"
      "Things are handles: their properties read and edit the scene, and raise StaleHandle once the thing is removed.");
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

  type.def(py::init<>(), "A scene without content.");
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
      "where the positions are in textures, N x 2 float32; (0, 0) is the upper left corner, (1, 1) the lower right.");
  define_pictures(module, type);
  type.def("save", &save, py::arg("path"), "Write the scene as glTF 2.0: .gltf or .glb. Raises FileError.");
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
      "Read a glTF 2.0 file. `variant`: name of a variant of its materials. `progress`: called on this thread with "
      "the part that is done, 0 to 1; what it raises ends the import. `only_below`: a folder; files that the scene "
      "names elsewhere are refused. Raises "
      "FileError.");
}

}  // namespace gnomon::python
