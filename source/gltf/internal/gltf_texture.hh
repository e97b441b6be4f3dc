// SPDX-License-Identifier: MIT
#pragma once

#include "gltf_import.hh"
#include "internal/gltf_file.hh"
#include "internal/gltf_image.hh"
#include "internal/gltf_progress.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * Adds textures and their images to a scene at their first use, so that unused images are not decoded. decode() decodes
 * all images together.
 */
class TextureImporter {
 public:
  /** All references but \a options must outlive the importer. */
  TextureImporter(const File &file, const ImportOptions &options, Warnings &warnings, scene::Scene &scene);

  /**
   * The scene's texture for a texture of the file, whose index may be out of range. Its image has one texel until
   * decode().
   *
   * \throws Fault that names the texture or the image, if either cannot be used.
   */
  [[nodiscard]] scene::Handle<scene::Texture> handle_of(int gltf_texture);

  /**
   * A texture whose green is 1 - \a glossiness · alpha of the file's texture and whose blue is 0, for
   * KHR_materials_pbrSpecularGlossiness. \throws Fault as handle_of
   */
  [[nodiscard]] scene::Handle<scene::Texture> roughness_of(int gltf_texture, double glossiness);

  /**
   * Decodes all images, on all processors.
   * \return the damaged images, with the reason.
   */
  [[nodiscard]] std::map<scene::Handle<scene::Image>, Fault> decode(Progress &progress);
  /** Images that decode() decodes. */
  [[nodiscard]] std::size_t image_count() const
  {
    return pending_.size();
  }

 private:
  struct Pending {
    scene::Handle<scene::Image> handle;
    /** The image file; empty if it is in one of the glTF file's buffers. */
    std::vector<unsigned char> storage;
    ImageDecoder decoder;
  };

  /** An image that decode() derives from another. \see roughness_of */
  struct Roughness {
    scene::Handle<scene::Image> handle;
    scene::Handle<scene::Image> source;
    double glossiness = 1.0;
  };

  const File &file_;
  /** \see ImportOptions */
  std::uint32_t size_max_;
  std::uint64_t texel_count_max_;
  Warnings &warnings_;
  scene::Scene &scene_;
  std::map<int, scene::Handle<scene::Texture>> handle_of_;
  std::map<std::pair<int, double>, scene::Handle<scene::Texture>> roughness_of_;
  std::vector<Roughness> derived_;
  /** By URI and buffer view, because several images may refer to the same data. */
  std::map<std::pair<std::string, int>, std::variant<scene::Handle<scene::Image>, Fault>> image_of_;
  std::vector<Pending> pending_;
  /** Texels of all images so far, after and before they are reduced. */
  std::uint64_t texel_count_ = 0;
  std::uint64_t decoded_texel_count_ = 0;

  /** Adds the texels of an image. \throws Fault that names the image, if all have too many */
  void spend(const ImageDecoder &decoder);

  /** The image of EXT_texture_webp; the texture's other one if that is absent, or its header cannot be read. */
  scene::Handle<scene::Image> image_of(const Model::Texture &texture, const std::string &what);
  /**
   * Imports each image once; later calls return the same handle or throw the same Fault. \a what names the reference,
   * whose index may be out of range.
   */
  scene::Handle<scene::Image> image_of(int gltf_image, const std::string &what);
  scene::Handle<scene::Image> import_image(int gltf_image);
};

}  // namespace gnomon::gltf
