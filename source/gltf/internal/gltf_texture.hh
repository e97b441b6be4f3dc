// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_image.hh"
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
 * Appends textures and their images to a scene, each at its first use, so that no other image is decoded. Images are
 * decoded together, by decode().
 */
class TextureImporter {
 public:
  /** Keeps references. */
  TextureImporter(const File &file, Warnings &warnings, scene::Scene &scene);

  /**
   * The scene's texture for a texture of the file, whose index may be out of range. Its image has one texel until
   * decode().
   *
   * \throws Fault that names the texture or the image, when it cannot be looked up.
   */
  [[nodiscard]] scene::Handle<scene::Texture> handle_of(int gltf_texture);

  /** Decode all images, on all processors. \return those that are damaged, with the reason. */
  [[nodiscard]] std::map<scene::Handle<scene::Image>, Fault> decode();

 private:
  struct Pending {
    scene::Handle<scene::Image> handle;
    /** Empty where the file's buffers hold the bytes. */
    std::vector<unsigned char> storage;
    ImageDecoder decoder;
  };

  const File &file_;
  Warnings &warnings_;
  scene::Scene &scene_;
  std::map<int, scene::Handle<scene::Texture>> handle_of_;
  /** By URI and buffer view: files name an image more than once. */
  std::map<std::pair<std::string, int>, std::variant<scene::Handle<scene::Image>, Fault>> image_of_;
  std::vector<Pending> pending_;
  /** Texels of all images so far. */
  std::uint64_t texel_count_ = 0;

  /** Once for each image, also if it fails. */
  scene::Handle<scene::Image> image_of(int gltf_image);
  scene::Handle<scene::Image> import_image(int gltf_image);
};

}  // namespace gnomon::gltf
