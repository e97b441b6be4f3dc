// SPDX-License-Identifier: MIT
#include "gltf_import.hh"

#include "internal/gltf_animation.hh"
#include "internal/gltf_camera.hh"
#include "internal/gltf_decompress.hh"
#include "internal/gltf_deform.hh"
#include "internal/gltf_file.hh"
#include "internal/gltf_foreign_extras.hh"
#include "internal/gltf_instances.hh"
#include "internal/gltf_lamp.hh"
#include "internal/gltf_lamp_units.hh"
#include "internal/gltf_mesh.hh"
#include "internal/gltf_node.hh"
#include "internal/gltf_node_tree.hh"
#include "internal/gltf_progress.hh"
#include "internal/gltf_report.hh"
#include "internal/gltf_units.hh"
#include "internal/gltf_world.hh"
#include "scene_joints.hh"
#include "trace.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace gnomon::gltf {

using scene::Bounds;
using scene::Camera;
using scene::Handle;
using scene::Lamp;
using scene::Mesh;
using scene::Node;
using scene::PlacedCamera;
using scene::PlacedLamp;
using scene::Scene;

namespace {

/**
 * Limit of objects. Many nodes may use one mesh of many primitives, so the size of the file does not limit their
 * number.
 */
constexpr std::size_t object_count_max = std::size_t(1) << 22U;

/** Extensions that the importer reads, or whose content it may ignore. A warning names others that a file requires. */
constexpr std::array<std::string_view, 22> supported_extensions{
    "KHR_lights_punctual",        "KHR_materials_specular",  "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_mesh_quantization",   "KHR_materials_variants",
    "KHR_texture_transform",      "KHR_xmp_json_ld",         "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",    "EXT_mesh_gpu_instancing", "KHR_materials_unlit",
    "KHR_animation_pointer",      "KHR_materials_clearcoat", "KHR_materials_sheen",
    "KHR_materials_transmission", "KHR_materials_volume",    "KHR_materials_pbrSpecularGlossiness",
    "EXT_lights_image_based",     "EXT_texture_webp",        "KHR_materials_anisotropy",
    "KHR_node_visibility",
};

/** Names of required extensions that are not supported; empty if there are none. */
std::string unknown_required_extensions(const File &file)
{
  std::string names;
  for (const std::string &name : file.model.extensions_required) {
    if (std::find(supported_extensions.begin(), supported_extensions.end(), name) == supported_extensions.end()) {
      names += (names.empty() ? "" : ", ") + name;
    }
  }
  return printable(names);
}

/** Whether the matrix is finite in float and its coordinates are in range. False for NaN. */
bool is_usable(const glm::dmat4 &world)
{
  for (int column = 0; column < 4; column++) {
    for (int row = 0; row < 3; row++) {
      if (!(std::abs(world[column][row]) <= coordinate_max)) {
        return false;
      }
    }
  }
  return true;
}

bool is_usable(const Bounds &bounds)
{
  const glm::vec3 reach = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
  return reach.x <= coordinate_max && reach.y <= coordinate_max && reach.z <= coordinate_max;
}

std::size_t primitive_count(const Model &model)
{
  std::size_t count = 0;
  for (const Model::Mesh &mesh : model.meshes) {
    count += mesh.primitives.size();
  }
  return count;
}

class Importer {
 public:
  Importer(const File &file, const ImportOptions &options, Progress &progress, Warnings warnings)
      : file_(file),
        options_(options),
        progress_(progress),
        warnings_(std::move(warnings)),
        extras_(file.model, warnings_),
        meshes_(file, options, progress, extras_, warnings_, scene_)
  {
  }

  Scene import()
  {
    warn_about_file();
    const std::vector<int> roots = scene_roots(file_.model, warnings_);
    progress_.begin_phase(file_.model.nodes.size() + primitive_count(file_.model), 0.7F);
    things_.nodes.resize(file_.model.nodes.size());
    scene_.reserve_nodes(file_.model.nodes.size());
    visit_nodes(roots);
    things_.materials = meshes_.materials();
    import_skins(file_, things_.nodes, warnings_, scene_);
    import_animations(file_, things_, warnings_, scene_);
    scene::deform_meshes(scene_);
    progress_.begin_phase(meshes_.image_count(), 0.95F);
    meshes_.finish();
    scene::close_joints(scene_);
    check_anything_kept();
    progress_.begin_phase(1, 1.0F);
    import_world(file_, visible_nodes(), options_.read_picture, warnings_, scene_);
    convert_lamps(options_.lamp_units, things_, warnings_, scene_);
    add_defaults();
    scene_.file_extras = extras_.of(document_extras, 0);
    scene_.extras = extras_.of("scenes", std::max(file_.model.scene, 0));
    scene_.warnings = warnings_.messages();
    return std::move(scene_);
  }

 private:
  const File &file_;
  const ImportOptions &options_;
  Progress &progress_;
  Warnings warnings_;
  ForeignExtras extras_;
  Scene scene_;
  MeshImporter meshes_;
  ImportedThings things_;
  std::size_t lost_node_count_ = 0;
  /** Why the first node or object that is not drawn is left out; empty: none is. */
  std::string first_loss_;
  std::size_t object_count_ = 0;

  [[nodiscard]] std::string node_label(int node) const
  {
    return label("node", file_.model.nodes[node].name, static_cast<std::size_t>(node));
  }

  void warn_about_file()
  {
    if (const std::string names = unknown_required_extensions(file_); !names.empty()) {
      warnings_.add("extensionsRequired", names + " is not supported: elements that need it are left out");
    }
  }

  /**
   * Visits nodes depth first, children in order. Uses an explicit stack, because the tree may be deeper than the
   * program's stack.
   */
  void visit_nodes(const std::vector<int> &roots)
  {
    struct Siblings {
      /** Nodes that are not visited yet. */
      std::span<const int> nodes;
      /** Invalid for roots, and below a node that was left out. */
      Handle<Node> parent;
      glm::dmat4 world_from_parent;
    };
    std::vector<Siblings> stack = {{roots, {}, glm::dmat4(1.0)}};
    while (!stack.empty()) {
      Siblings &siblings = stack.back();
      if (siblings.nodes.empty()) {
        stack.pop_back();
        continue;
      }
      progress_.step();
      const int index = siblings.nodes.front();
      siblings.nodes = siblings.nodes.subspan(1);
      const Model::Node &node = file_.model.nodes[index];
      const glm::dmat4 parent_from_node = matrix_of(
          node, [&] { return node_label(index); }, warnings_);
      const glm::dmat4 world = siblings.world_from_parent * parent_from_node;
      if (is_skin_alone(node) && (!is_usable(world) || glm::determinant(world) == 0.0)) {
        import_skin_alone(index, siblings.parent);
        continue;
      }
      const Handle<Node> handle =
          import_node(index, siblings.parent, siblings.parent ? parent_from_node : world, world);
      if (!node.children.empty()) {
        stack.push_back({node.children, handle, world});
      }
    }
  }

  /** Whether the node has only a skinned mesh, so that its transform has no effect (glTF 2.0, 3.7.3.2). */
  static bool is_skin_alone(const Model::Node &node)
  {
    return node.skin >= 0 && node.mesh >= 0 && !node.instances && node.children.empty() && node.camera < 0 &&
           node.light < 0;
  }

  /**
   * Adds the node without a transform, since the inverse of its own cannot be made, below the nearest ancestor whose
   * inverse can be.
   */
  void import_skin_alone(int index, Handle<Node> parent)
  {
    bool is_visible = true;
    const auto has_inverse = [&](Handle<Node> node) {
      const glm::dmat4 world = scene_.world_from_node(node);
      return is_usable(world) && glm::determinant(world) != 0.0;
    };
    while (parent && !has_inverse(parent)) {
      is_visible = is_visible && scene_.nodes()[parent].is_visible;
      parent = scene_.parent(parent);
    }
    const glm::dmat4 world = parent ? scene_.world_from_node(parent) : glm::dmat4(1.0);
    const Handle<Node> handle = import_node(index, parent, glm::dmat4(1.0), world);
    if (!is_visible) {
      scene_.edit(handle, [](Node &node) { node.is_visible = false; });
    }
  }

  /** Adds the node. \return an invalid handle if it is left out. */
  Handle<Node> import_node(int index, Handle<Node> parent, const glm::dmat4 &parent_from_node, const glm::dmat4 &world)
  {
    if (!is_usable(world) || !is_usable(parent_from_node)) {
      warnings_.add_counted(node_label(index), 1,
                            "left out: its own matrix or that to the world is not finite or reaches beyond 1e12 m");
      lost_node_count_++;
      note_loss();
      return {};
    }
    const std::string &name = file_.model.nodes[index].name;
    Node node;
    node.name = name.empty() ? "node " + std::to_string(index) : name;
    node.parent_from_node = parent_from_node;
    read_flags(file_.model.nodes[index], index, node);
    node.extras = extras_.of("nodes", index);
    warn_of_weight_count(index);
    const std::vector<glm::dmat4> instances = instances_of(index);
    const std::size_t first_deformed = scene_.deformed_meshes.size();
    if (instances.empty()) {
      import_meshes(index, world, node);
    }
    if (std::optional<Lamp> lamp = lamp_on(file_, index, warnings_)) {
      lamp->extras = extras_.of(lights_key, file_.model.nodes[index].light);
      node.lamp = scene_.add(std::move(*lamp));
      things_.lamps[file_.model.nodes[index].light].push_back(node.lamp);
    }
    if (std::optional<Camera> camera = camera_on(file_, index, warnings_)) {
      camera->extras = extras_.of("cameras", file_.model.nodes[index].camera);
      node.camera = scene_.add(std::move(*camera));
      things_.cameras[file_.model.nodes[index].camera].push_back(node.camera);
    }
    const Handle<Node> handle = scene_.add(std::move(node), parent);
    things_.nodes[index] = handle;
    set_deformed_node(index, handle, first_deformed);
    for (std::size_t i = 0; i < instances.size(); i++) {
      import_instance(index, i, handle, instances[i], world * instances[i]);
    }
    return handle;
  }

  /** Gives the node's deformed meshes, which stand at \a first and after it, the node and its morph weights. */
  void set_deformed_node(int index, Handle<Node> handle, std::size_t first)
  {
    const Model::Node &node = file_.model.nodes[index];
    for (std::size_t i = first; i < scene_.deformed_meshes.size(); i++) {
      scene_.deformed_meshes[i].node = handle;
    }
    if (first < scene_.deformed_meshes.size()) {
      const std::vector<double> &weights = node.weights.empty() ? file_.model.meshes[node.mesh].weights : node.weights;
      scene::set_morph_weights(scene_, handle, weights);
    }
  }

  /** Warns of a number of weights that is not that of targets. A node's own weights replace those of its mesh. */
  void warn_of_weight_count(int index)
  {
    const Model::Node &node = file_.model.nodes[index];
    const Model::Mesh *mesh = node.mesh < 0 ? nullptr : &file_.model.meshes[node.mesh];
    std::size_t target_count = 0;
    for (std::size_t i = 0; mesh != nullptr && i < mesh->primitives.size(); i++) {
      target_count = std::max(target_count, mesh->primitives[i].targets.size());
    }
    const auto warn = [&](const std::string &what, const std::vector<double> &weights) {
      if (!weights.empty() && weights.size() != target_count) {
        warnings_.add(what,
                      "has " + std::to_string(weights.size()) + " weights and " + std::to_string(target_count) +
                          " morph targets; weights without a target are not used, and targets without a weight have 0");
      }
    };
    warn(node_label(index), node.weights);
    if (mesh != nullptr && node.weights.empty()) {
      warn(label("mesh", mesh->name, std::size_t(node.mesh)), mesh->weights);
    }
  }

  /** Empty if the node has no instances. */
  std::vector<glm::dmat4> instances_of(int index)
  {
    const Model::Node &node = file_.model.nodes[index];
    if (node.mesh >= 0 && node.instances) {
      try {
        return instance_matrices(file_, *node.instances);
      }
      catch (const Fault &fault) {
        warnings_.add(node_label(index), std::string("drawn once, at the node, and not as instances: ") + fault.what());
      }
    }
    return {};
  }

  /** Adds a child of the node with its meshes. */
  void import_instance(int index, std::size_t instance, Handle<Node> parent, const glm::dmat4 &parent_from_node,
                       const glm::dmat4 &world)
  {
    if (!is_usable(world) || !is_usable(parent_from_node)) {
      warnings_.add_counted(
          node_label(index), 1,
          "instance left out: its own matrix or that to the world is not finite or reaches beyond 1e12 m");
      note_loss();
      return;
    }
    Node node;
    node.name = scene_.nodes()[parent].name + '[' + std::to_string(instance) + ']';
    node.parent_from_node = parent_from_node;
    read_flags(file_.model.nodes[index], index, node);
    // The parent's, which an animation may change.
    node.is_visible = true;
    const std::size_t first_deformed = scene_.deformed_meshes.size();
    import_meshes(index, world, node);
    const Handle<Node> handle = scene_.add(std::move(node), parent);
    set_deformed_node(index, handle, first_deformed);
    things_.instances[index].push_back(handle);
  }

  /** Each node with a skin or morph targets, and each instance of one, has meshes of its own. */
  void import_meshes(int index, const glm::mat4 &world, Node &added)
  {
    const Model::Node &node = file_.model.nodes[index];
    if (node.mesh < 0) {
      return;
    }
    const bool has_skin = node.skin >= 0 && !node.instances;
    if (node.skin >= 0 && node.instances) {
      warnings_.add(node_label(index), "its instances are drawn without skin");
    }
    const bool is_own = has_skin || has_targets(file_.model, node);
    const std::vector<Handle<Mesh>> own =
        is_own ? meshes_.deformed_meshes_of(node.mesh, has_skin ? node.skin : -1) : std::vector<Handle<Mesh>>();
    for (const Handle<Mesh> mesh : is_own ? own : meshes_.meshes_of(node.mesh)) {
      if (!is_usable(transformed(scene_.meshes()[mesh].bounds, world))) {
        warnings_.add_counted(node_label(index), 1, "object left out: it reaches beyond 1e12 m");
        continue;
      }
      if (object_count_ == object_count_max) {
        throw Fault("scene", "has more than " + std::to_string(object_count_max) + " objects");
      }
      object_count_++;
      added.meshes.push_back(mesh);
    }
    if (added.meshes.empty()) {
      note_loss();
    }
  }

  /** Keeps the last message, if it is about the first element that is left out. */
  void note_loss()
  {
    if (first_loss_.empty() && !warnings_.empty()) {
      first_loss_ = warnings_.messages().back();
    }
  }

  [[nodiscard]] std::vector<int> visible_nodes() const
  {
    std::vector<int> indices;
    for (std::size_t i = 0; i < things_.nodes.size(); i++) {
      if (things_.nodes[i] && scene_.is_visible(things_.nodes[i])) {
        indices.push_back(static_cast<int>(i));
      }
    }
    return indices;
  }

  /** A file without drawable elements is a valid scene. A file whose elements are all unusable is an error. */
  void check_anything_kept()
  {
    if (object_count_ > 0) {
      return;
    }
    if (meshes_.primitive_count() == 0 && lost_node_count_ == 0) {
      warnings_.add("scene", "has nothing to draw");
      return;
    }
    const std::string names = unknown_required_extensions(file_);
    throw Fault("scene", "nothing in it can be drawn" + (names.empty() ? "" : ", and it requires " + names) + ": " +
                             first_loss_);
  }

  void add_defaults()
  {
    if (scene_.cameras().empty()) {
      scene_.is_camera_default = true;
      const PlacedCamera camera = default_camera(scene_.bounds());
      Node node;
      node.name = camera.name;
      node.parent_from_node = camera.world_from_camera;
      node.camera = scene_.add(Camera(camera));
      scene_.add(std::move(node));
      warnings_.add("scene", "has no camera: one was added that shows the whole scene, with +Y up");
    }
    if (scene_.lamps().empty() && !scene_.world()) {
      scene_.is_lamp_default = true;
      const PlacedCamera camera = scene_.placed_cameras().front();
      const PlacedLamp sun = default_sun(camera);
      Node node;
      node.name = sun.name;
      node.parent_from_node = sun.world_from_lamp;
      node.lamp = scene_.add(Lamp(sun));
      scene_.add(std::move(node));
      warnings_.add("scene", "has no lamp: a sun of 3.14 W/m2 was added, above and to the left of camera '" +
                                 printable(camera.name) + '\'');
    }
  }
};

/** Gives each primitive the material that it has in the variant \a name. \throws UnknownVariant, without a path */
void select_variant(Model &model, const std::string &name)
{
  const auto found = std::find(model.variants.begin(), model.variants.end(), name);
  if (found == model.variants.end()) {
    std::string names;
    for (const std::string &one : model.variants) {
      names += (names.empty() ? "'" : ", '") + printable(one) + '\'';
    }
    throw UnknownVariant("has no variant '" + printable(name) + "'; " +
                         (names.empty() ? "it has none" : "it has " + names));
  }
  const int variant = static_cast<int>(found - model.variants.begin());
  for (Model::Mesh &mesh : model.meshes) {
    for (Model::Primitive &primitive : mesh.primitives) {
      for (const Model::VariantMaterial &mapping : primitive.variant_materials) {
        if (std::find(mapping.variants.begin(), mapping.variants.end(), variant) != mapping.variants.end()) {
          primitive.material = mapping.material;
        }
      }
    }
  }
}

}  // namespace

Scene import_gltf(const std::filesystem::path &path, const ImportOptions &options)
{
  const auto failed = [&path](std::string_view reason) {
    return ImportError(path.string() + ": " + std::string(reason));
  };
  const trace::Span span("import", path.filename().string());
  try {
    Progress progress(options.progress);
    progress.begin_phase(1, 0.2F);
    Warnings warnings;
    File file = load_file(path, options.only_below, warnings);
    if (!options.variant.empty()) {
      select_variant(file.model, options.variant);
    }
    progress.begin_phase(file.model.buffer_views.size() + primitive_count(file.model), 0.4F);
    decompress(file, progress, warnings);
    Scene scene = Importer(file, options, progress, std::move(warnings)).import();
    scene.path = path.string();
    scene.files.push_back(scene.path);
    for (const std::filesystem::path &named : files_of(file)) {
      scene.files.push_back(named.string());
    }
    progress.finish();
    return scene;
  }
  catch (const Fault &fault) {
    throw failed(fault.what());
  }
  catch (const UnknownVariant &unknown) {
    throw UnknownVariant(path.string() + ": " + unknown.what());
  }
  catch (const Cancelled &) {
    throw ImportCancelled(path.string() + ": the import was cancelled");
  }
  catch (const std::bad_alloc &) {
    throw ImportOutOfMemory(path.string() + ": there is not enough memory for it");
  }
  catch (const std::exception &error) {
    // Libraries may throw exceptions of other types.
    throw failed(printable(error.what()));
  }
}

std::vector<std::string> files_named_by(const std::filesystem::path &path)
{
  std::vector<std::string> files;
  try {
    Warnings ignored;
    for (const std::filesystem::path &named : files_of(load_document(path, ignored))) {
      files.push_back(named.string());
    }
  }
  catch (const Fault &) {
    // import_gltf has the reason.
  }
  return files;
}

}  // namespace gnomon::gltf
