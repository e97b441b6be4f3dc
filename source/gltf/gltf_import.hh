// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gnomon::gltf {

/** The units of the numbers of lamps of KHR_lights_punctual. */
enum class LampUnits {
  /** Candela and lux, as the extension says. The import warns of a file that looks like Raw. */
  Lumen,
  /** W/sr and W/m², which exporters call "unitless". */
  Raw,
  /** Raw, with a warning, if the file looks like Raw; otherwise Lumen. */
  Auto,
};

}  // namespace gnomon::gltf

namespace gnomon::scene {

template <>
inline constexpr std::array<std::string_view, 3> words<gltf::LampUnits>{"lumen", "raw", "auto"};

}  // namespace gnomon::scene

namespace gnomon::gltf {

/** Thrown if a file cannot be imported. The message names the file and the reason. */
struct ImportError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** Thrown if a file has no variant of the name that ImportOptions asks for. The message lists those that it has. */
struct UnknownVariant : ImportError {
  using ImportError::ImportError;
};

/** Thrown if there is not enough memory for the scene. The message names the file. */
struct ImportOutOfMemory : ImportError {
  using ImportError::ImportError;
};

/** Thrown if ImportOptions::progress has ended an import. The message names the file. */
struct ImportCancelled : ImportError {
  using ImportError::ImportError;
};

/**
 * Receives the fraction of an import that is done, in [0, 1]. It never decreases, and is 1 in the last call. Returns
 * false to end the import.
 */
using ReportProgress = std::function<bool(float fraction)>;

/**
 * Reads the equirectangular picture of a world from a file, which is regular and at most 4 GiB large. Throws an
 * exception whose message names the reason.
 */
using ReadPicture = std::function<scene::WorldPicture(const std::filesystem::path &path)>;

struct ImportOptions {
  std::string variant{};
  /**
   * Most texels along an edge of an image of a material; larger images are reduced (scene::reduced). 0: no limit.
   * Images are replaced by stand-ins, with a warning, if an edge has more than 16384 texels after the reduction, or
   * before it one image has more than 2^28 texels or all together have more than 2^32.
   */
  std::uint32_t texture_size_max = 0;
  /**
   * Most bytes of all images, at 4 bytes for each texel after the reduction; the default is 32 images of 4096x4096. It
   * is needed because a file of kilobytes may decompress to gigabytes. Images beyond the limit are replaced by
   * stand-ins, with a warning.
   */
  std::size_t image_bytes_max = std::size_t(1) << 31U;
  /**
   * Most vertices and indices that are read for all meshes together. Meshes may share bytes of the file, so that its
   * size does not limit them. A file with more is refused.
   */
  std::size_t element_count_max = std::size_t(1) << 28U;
  /**
   * For scenes from untrusted sources: buffers, images, pictures of worlds and surface functions are read only from
   * files below this folder, after links are resolved. The scene's own file may be elsewhere. Empty: files may be
   * anywhere.
   */
  std::filesystem::path only_below{};
  /** A file looks raw if it has no world and no other lamps, and all its lamps are far too dim to be seen. */
  LampUnits lamp_units = LampUnits::Lumen;
  /** For worlds whose picture is a file. Without it, they are left out, with a warning. */
  ReadPicture read_picture{};
  /**
   * Called on the thread of import_gltf, at most some hundred times: after the file is read, and between meshes, nodes
   * and images, each of which is read without a call. May be empty.
   */
  ReportProgress progress{};

  /** Visits the rows of all members but those that only a host sets. */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

template <typename Visit>
constexpr void ImportOptions::for_each_property(Visit &&visit)
{
  using scene::property;
  visit(property(&ImportOptions::variant, {.name = "variant",
                                           .option = "variant",
                                           .sentence = "Name of the variant of materials (KHR_materials_variants). "
                                                       "Empty: the materials of no variant."}));
  visit(property(&ImportOptions::texture_size_max, {.name = "texture_size_max",
                                                    .option = "texture-size-max",
                                                    .unit = "px",
                                                    .min = 1,
                                                    .max = 1 << 20,
                                                    .zero = "no limit",
                                                    .sentence = "Most texels along an edge of an image of a material; "
                                                                "larger ones are reduced. 0: no limit."}));
  visit(property(&ImportOptions::image_bytes_max,
                 {.name = "image_bytes_max",
                  .option = "image-memory",
                  .unit = "bytes",
                  .min = 1 << 20U,
                  .max = double(std::uint64_t(1) << 40U),
                  .sentence = "Most memory of all images; those beyond are replaced by stand-ins."}));
  visit(property(&ImportOptions::element_count_max,
                 {.name = "element_count_max",
                  .option = "vertices-max",
                  .min = 1,
                  .max = double(std::uint64_t(1) << 40U),
                  .sentence = "Most vertices and indices of all meshes; a file with more is refused."}));
  visit(
      property(&ImportOptions::lamp_units,
               {.name = "lamp_units",
                .option = "lamp-units",
                .sentence = "Numbers of lamps: lumen, candela and lux, as glTF says; raw, W/sr and W/m², of files that "
                            "were exported unitless; auto, raw where all lamps are far too dim to be seen."}));
}

/**
 * Reads a glTF 2.0 file: `.gltf` with external files or data URIs, or `.glb`.
 *
 * The node tree of the default scene keeps its local transforms. Each mesh primitive becomes a mesh of its nodes.
 * `doc/conventions.md` defines units and extras (`gnomon_*`), and which of other programs are kept. Unsupported
 * elements are left out and reported in Scene::warnings. A camera is added if the file has none, and a lamp if it has
 * neither a lamp nor a world.
 *
 * \throws ImportError if the file is missing, unreadable or malformed, or if nothing in it can be drawn.
 * \throws UnknownVariant, ImportCancelled, ImportOutOfMemory
 */
[[nodiscard]] scene::Scene import_gltf(const std::filesystem::path &path, const ImportOptions &options = {});

/**
 * The regular files that the file at \a path names: buffers, images, surface functions and worlds, whether the scene
 * uses them or not. Reads the document alone. Empty if it cannot be read: import_gltf has the reason.
 */
[[nodiscard]] std::vector<std::string> files_named_by(const std::filesystem::path &path);

}  // namespace gnomon::gltf
