// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** The arrays of the document whose elements keep the extras of other programs. */
inline constexpr std::array<std::string_view, 5> arrays_with_kept_extras{"scenes", "nodes", "meshes", "materials",
                                                                         "cameras"};
inline constexpr std::string_view punctual_key = "KHR_lights_punctual";
/** The array of that extension, whose elements keep them, too. */
inline constexpr std::string_view lights_key = "lights";
/** Stands for an array where the extras are those of the document. */
inline constexpr std::string_view document_extras{};

/**
 * The properties of a glTF document that the importer reads, with glTF's defaults. Indices are -1 if absent.
 *
 * Types are checked, and so are the ranges of all indices except texture and image indices.
 */
struct Model {
  enum ComponentType { Byte = 5120, UnsignedByte, Short, UnsignedShort, UnsignedInt = 5125, Float };
  enum PrimitiveMode { Points, Lines, LineLoop, LineStrip, Triangles, TriangleStrip, TriangleFan };
  /** Matrix: MAT2 or MAT3. */
  enum class ElementType { Scalar, Vec2, Vec3, Vec4, Matrix, Matrix4 };

  /** EXT_meshopt_compression of a buffer view. */
  struct Meshopt {
    int buffer = -1;
    std::uint64_t byte_offset = 0;
    std::uint64_t byte_length = 0;
    std::uint64_t byte_stride = 0;
    std::uint64_t count = 0;
    std::string mode;
    std::string filter = "NONE";
  };
  struct BufferView {
    int buffer = -1;
    std::uint64_t byte_offset = 0;
    std::uint64_t byte_length = 0;
    /** 0: elements follow each other without a gap. */
    std::uint64_t byte_stride = 0;
    std::optional<Meshopt> meshopt;
  };
  struct SparsePart {
    int buffer_view = -1;
    std::uint64_t byte_offset = 0;
    /** For sparse indices only. */
    int component_type = 0;
  };
  struct Sparse {
    std::uint64_t count = 0;
    SparsePart indices;
    SparsePart values;
  };
  struct Accessor {
    int buffer_view = -1;
    std::uint64_t byte_offset = 0;
    /** Unchecked: may be a value outside of ComponentType. */
    std::uint64_t component_type = 0;
    std::uint64_t count = 0;
    ElementType type = ElementType::Scalar;
    bool is_normalized = false;
    std::optional<Sparse> sparse;
  };
  /** KHR_draco_mesh_compression of a primitive. */
  struct Draco {
    int buffer_view = -1;
    /** Unique id in the compressed mesh for each attribute name. */
    std::map<std::string, int, std::less<>> attributes;
  };
  /** KHR_materials_variants: the material of a primitive for some of Model::variants. */
  struct VariantMaterial {
    int material = -1;
    std::vector<int> variants;
  };
  struct Primitive {
    /** Accessor of each attribute: POSITION, NORMAL, TANGENT, COLOR_0, TEXCOORD_n, JOINTS_n and WEIGHTS_n. */
    std::map<std::string, int, std::less<>> attributes;
    int indices = -1;
    int material = -1;
    /** Unchecked: may be a value outside of PrimitiveMode. */
    int mode = Triangles;
    /** Accessors of each morph target: POSITION, NORMAL and TANGENT. */
    std::vector<std::map<std::string, int, std::less<>>> targets;
    std::optional<Draco> draco;
    std::vector<VariantMaterial> variant_materials;
    /** Name of the unsupported extension that holds the data instead of the accessors; empty if there is none. */
    std::string compression;
    /** The extra gnomon_name; empty if absent. */
    std::string name;
  };
  struct Mesh {
    std::string name;
    std::vector<Primitive> primitives;
    /** Weights of the morph targets; empty: all 0. */
    std::vector<double> weights;
  };
  using Extra = std::variant<bool, double, std::string, std::vector<double>>;
  /** The extras whose key begins with "gnomon_". */
  using Extras = std::map<std::string, Extra, std::less<>>;
  /** EXT_mesh_gpu_instancing: accessors with one element for each instance; -1: absent. */
  struct Instances {
    int translation = -1;
    int rotation = -1;
    int scale = -1;
  };
  struct Node {
    std::string name;
    std::vector<int> children;
    /** Column-major. Replaces translation, rotation and scale. */
    std::optional<std::array<double, 16>> matrix;
    std::array<double, 3> translation{0.0, 0.0, 0.0};
    std::array<double, 4> rotation{0.0, 0.0, 0.0, 1.0};
    std::array<double, 3> scale{1.0, 1.0, 1.0};
    int mesh = -1;
    int camera = -1;
    int skin = -1;
    int light = -1;
    /** KHR_node_visibility: of the node and its descendants. */
    bool is_visible = true;
    std::optional<Instances> instances;
    /** Override the mesh's weights; empty if absent. */
    std::vector<double> weights;
    Extras extras;
  };
  struct Skin {
    std::string name;
    std::vector<int> joints;
    /** An accessor; -1: all identity. */
    int inverse_bind_matrices = -1;
  };
  struct AnimationSampler {
    int input = -1;
    int output = -1;
    std::string interpolation = "LINEAR";
  };
  struct AnimationChannel {
    int sampler = -1;
    int node = -1;
    std::string path;
    /** The pointer of KHR_animation_pointer; empty if absent. */
    std::string pointer;
  };
  struct Animation {
    std::string name;
    std::vector<AnimationSampler> samplers;
    std::vector<AnimationChannel> channels;
  };
  struct TextureSlot {
    int index = -1;
    int set = 0;
    std::array<double, 2> offset{0.0, 0.0};
    double rotation = 0.0;
    std::array<double, 2> scale{1.0, 1.0};
  };
  struct Material {
    std::string name;
    /** The extra gnomon_surface: a URI of a surface function; empty if absent. */
    std::string surface_uri;
    /** The extra gnomon_thickness, m, which replaces that of KHR_materials_volume. */
    std::optional<double> own_thickness;
    /**
     * Numbers of the factors that the file has, by scene::Description::name. A base colour has alpha as the fourth; 1
     * and 0 stand for true and false.
     */
    std::map<std::string_view, std::array<double, 4>> factors;
    /** By scene::TextureInput::name. */
    std::map<std::string_view, TextureSlot> textures;
    double emissive_strength = 1.0;
    /** KHR_materials_pbrSpecularGlossiness: the roughness texture has glossiness in its alpha, scaled by this. */
    std::optional<double> glossiness;
    std::string alpha_mode = "OPAQUE";

    /** nullptr: the file has none, and glTF's default counts, which is that of the scene. */
    [[nodiscard]] const std::array<double, 4> *factor(std::string_view name) const
    {
      const auto found = factors.find(name);
      return found == factors.end() ? nullptr : &found->second;
    }
    /** nullptr: there is no texture. */
    [[nodiscard]] const TextureSlot *texture(std::string_view name) const
    {
      const auto found = textures.find(name);
      return found == textures.end() || found->second.index < 0 ? nullptr : &found->second;
    }
  };
  struct Texture {
    std::string name;
    int sampler = -1;
    int source = -1;
    /** The image of EXT_texture_webp, for which `source` is the fallback. */
    int webp_source = -1;
  };
  /** Values are OpenGL's enumerants. */
  struct Sampler {
    int mag_filter = -1;
    int min_filter = -1;
    int wrap_s = 10497;
    int wrap_t = 10497;
  };
  struct Buffer {
    std::optional<std::string> uri;
    std::uint64_t byte_length = 0;
  };
  struct Image {
    std::string name;
    /** A data URI or a file name; empty if `buffer_view` has the bytes. */
    std::string uri;
    int buffer_view = -1;
  };
  struct Camera {
    std::string name;
    bool is_perspective = true;
    double yfov = 0.0;
    /** 0: absent. */
    double aspect_ratio = 0.0;
    double xmag = 0.0;
    double ymag = 0.0;
    double znear = 0.0;
    /** 0: absent. */
    double zfar = 0.0;
  };
  struct Light {
    std::string name;
    std::string type;
    std::array<double, 3> color{1.0, 1.0, 1.0};
    double intensity = 1.0;
    std::optional<double> range;
    double inner_cone_angle = 0.0;
    double outer_cone_angle = 0.78539816339744831;
  };

  /** A light of EXT_lights_image_based, whose other members are not used. */
  struct ImageLight {
    std::string name;
    std::array<double, 4> rotation{0.0, 0.0, 0.0, 1.0};
    double intensity = 1.0;
    /** Images of the faces +X, -X, +Y, -Y, +Z and -Z in full size. Neither their number nor their range is checked. */
    std::vector<int> faces;
  };
  struct Scene {
    std::vector<int> roots;
    int image_light = -1;
    Extras extras;
  };

  std::vector<std::string> extensions_required;
  /** Names of KHR_materials_variants. */
  std::vector<std::string> variants;
  /** -1: absent. */
  int scene = -1;
  std::vector<Scene> scenes;
  std::vector<Node> nodes;
  std::vector<Mesh> meshes;
  std::vector<Accessor> accessors;
  std::vector<BufferView> buffer_views;
  std::vector<Buffer> buffers;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Sampler> samplers;
  std::vector<Image> images;
  std::vector<Camera> cameras;
  std::vector<Light> lights;
  std::vector<ImageLight> image_lights;
  std::vector<Skin> skins;
  std::vector<Animation> animations;

  /**
   * JSON objects of what other programs have added, by the array of the document and the index in it.
   * \see arrays_with_kept_extras; document_extras has the index 0
   */
  std::map<std::pair<std::string_view, int>, std::string> foreign_extras;

  /** The scene that `scene` names, or the first; nullptr: the file has none. */
  [[nodiscard]] const Scene *default_scene() const
  {
    return scenes.empty() ? nullptr : &scenes[static_cast<std::size_t>(scene < 0 ? 0 : scene)];
  }
};

}  // namespace gnomon::gltf
