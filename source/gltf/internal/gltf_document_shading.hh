// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_json.hh"
#include "internal/gltf_model.hh"

/**
 * Reads the elements of a document whose references, if any, are checked where they are used. Internal to source/gltf.
 */
namespace gnomon::gltf {

/** All of these throw a Fault that names the place. */
void read_material(const Place &place, const JsonValue &value, Model::Material &material);
void read_texture(const Place &place, const JsonValue &value, Model::Texture &texture);
void read_sampler(const Place &place, const JsonValue &value, Model::Sampler &sampler);
void read_image(const Place &place, const JsonValue &value, Model::Image &image);
void read_camera(const Place &place, const JsonValue &value, Model::Camera &camera);
void read_light(const Place &place, const JsonValue &value, Model::Light &light);
void read_image_light(const Place &place, const JsonValue &value, Model::ImageLight &light);

}  // namespace gnomon::gltf
