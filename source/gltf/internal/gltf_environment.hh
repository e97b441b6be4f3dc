// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "scene.hh"

#include <string>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * The cube map of a light of EXT_lights_image_based in full size, turned by the light's rotation and without its
 * intensity, as an equirectangular picture with as many texels around the horizon as the cube has.
 *
 * Faces have the axes of OpenGL's cube maps, with the first row of an image at t = 0. Colours are decoded as sRGB, and
 * then divided by alpha, which is the extension's RGBD; 0 counts as the smallest other alpha.
 *
 * \throws Fault that names \a what or the image, if a face is missing, damaged, not square or has another size than the
 * others.
 */
[[nodiscard]] scene::WorldPicture environment_picture(const File &file, const Model::ImageLight &light,
                                                      const std::string &what);

}  // namespace gnomon::gltf
