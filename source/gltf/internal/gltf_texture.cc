// SPDX-License-Identifier: MIT
#include "internal/gltf_texture.hh"

#include "internal/gltf_sampler.hh"
#include "scene_image.hh"
#include "scene_parallel.hh"
#include "trace.hh"

#include <algorithm>
#include <atomic>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace gnomon::gltf {

using scene::Handle;
using scene::Image;
using scene::Material;
using scene::MipFilter;
using scene::Scene;
using scene::Texture;
using scene::TextureFilter;
using scene::TextureWrap;

namespace {

/** Limit of the texels of all images before they are reduced: the time for 16 of the largest images. */
constexpr std::uint64_t decoded_texel_count_max = std::uint64_t(1) << 32U;

/** Reads one sampler. Unknown values are replaced by those of a texture without a sampler. */
class SamplerReader {
 public:
  SamplerReader(std::string what, Warnings &warnings) : what_(std::move(what)), warnings_(warnings) {}

  void read(const Model::Sampler &sampler, Texture &texture)
  {
    texture.wrap_u = wrap("wrapS", sampler.wrap_s);
    texture.wrap_v = wrap("wrapT", sampler.wrap_t);
    read_filters(sampler, texture);
  }

 private:
  std::string what_;
  Warnings &warnings_;

  void warn_unknown(const char *key, int value)
  {
    warnings_.add(what_, std::string(key) + ' ' + std::to_string(value) + " is unknown and not used");
  }

  TextureWrap wrap(const char *key, int value)
  {
    switch (value) {
      case gl_clamp_to_edge: return TextureWrap::ClampToEdge;
      case gl_mirrored_repeat: return TextureWrap::MirroredRepeat;
      case gl_repeat: return TextureWrap::Repeat;
      default: warn_unknown(key, value); return TextureWrap::Repeat;
    }
  }

  void read_filters(const Model::Sampler &sampler, Texture &texture)
  {
    switch (sampler.mag_filter) {
      case gl_nearest: texture.magnified = TextureFilter::Nearest; break;
      case gl_linear:
      case absent: break;
      default: warn_unknown("magFilter", sampler.mag_filter);
    }
    const auto set = [&texture](TextureFilter filter, MipFilter mip) {
      texture.minified = filter;
      texture.mip = mip;
    };
    switch (sampler.min_filter) {
      case gl_nearest: set(TextureFilter::Nearest, MipFilter::None); break;
      case gl_linear: set(TextureFilter::Linear, MipFilter::None); break;
      case gl_nearest_mipmap_nearest: set(TextureFilter::Nearest, MipFilter::Nearest); break;
      case gl_linear_mipmap_nearest: set(TextureFilter::Linear, MipFilter::Nearest); break;
      case gl_nearest_mipmap_linear: set(TextureFilter::Nearest, MipFilter::Linear); break;
      case gl_linear_mipmap_linear:
      case absent: break;
      default: warn_unknown("minFilter", sampler.min_filter);
    }
  }

  /** The file does not specify the filter. */
  static constexpr int absent = -1;
};

}  // namespace

TextureImporter::TextureImporter(const File &file, const ImportOptions &options, Warnings &warnings, Scene &scene)
    : file_(file),
      size_max_(options.texture_size_max),
      texel_count_max_(options.image_bytes_max / 4),
      warnings_(warnings),
      scene_(scene)
{
}

void TextureImporter::spend(const ImageDecoder &decoder)
{
  const auto check = [&](std::uint64_t count, std::uint64_t spent, std::uint64_t max, const char *limit) {
    if (count > max - spent) {
      throw LimitFault(decoder.what(), "is too large, " + decoder.size_text() +
                                           " texels: " + std::to_string(max - spent) +
                                           " are left of those that all images may have" + limit);
    }
  };
  check(decoder.kept_texel_count(), texel_count_, texel_count_max_, ", by --image-memory");
  check(decoder.texel_count(), decoded_texel_count_, decoded_texel_count_max, " before they are reduced");
  texel_count_ += decoder.kept_texel_count();
  decoded_texel_count_ += decoder.texel_count();
}

Handle<Texture> TextureImporter::handle_of(int gltf_texture)
{
  if (const auto found = handle_of_.find(gltf_texture); found != handle_of_.end()) {
    return found->second;
  }
  const Model::Texture &source = element(file_.model.textures, gltf_texture, "texture");
  const std::string what = label("texture", source.name, static_cast<std::size_t>(gltf_texture));
  Texture texture;
  if (source.sampler >= 0) {
    SamplerReader(what, warnings_).read(element(file_.model.samplers, source.sampler, what + ": sampler"), texture);
  }
  texture.image = image_of(source, what);
  return handle_of_.emplace(gltf_texture, scene_.add(texture)).first->second;
}

Handle<Texture> TextureImporter::roughness_of(int gltf_texture, double glossiness)
{
  const auto [place, is_new] = roughness_of_.try_emplace({gltf_texture, glossiness});
  if (!is_new && place->second) {
    return place->second;
  }
  Texture texture = scene_.textures()[handle_of(gltf_texture)];
  const Handle<Image> source = texture.image;
  const auto decoded = std::ranges::find(pending_, source, &Pending::handle);
  if (decoded != pending_.end()) {
    // An image of roughness is as large.
    spend(decoded->decoder);
  }
  texture.image = scene_.add(Image{"roughness of " + scene_.images()[source].name, 1, 1, {0, 0, 0, 0}});
  derived_.push_back({texture.image, source, glossiness});
  return place->second = scene_.add(texture);
}

/** \see TextureImporter::roughness_of */
static Image roughness_image(const Image &source, double glossiness, const std::string &name)
{
  Image image{name, source.width, source.height, source.texels};
  for (std::size_t i = 0; i < image.texels.size(); i += 4) {
    const double roughness = 255.0 - std::clamp(glossiness, 0.0, 1.0) * source.texels[i + 3];
    image.texels[i] = image.texels[i + 2] = 0;
    image.texels[i + 1] = static_cast<std::uint8_t>(roughness + 0.5);
    image.texels[i + 3] = 255;
  }
  return image;
}

Handle<Image> TextureImporter::image_of(const Model::Texture &texture, const std::string &what)
{
  if (texture.webp_source >= 0) {
    try {
      return image_of(texture.webp_source, what + ": source of EXT_texture_webp");
    }
    catch (const Fault &fault) {
      if (texture.source < 0) {
        throw;
      }
      warnings_.add(what, std::string("its fallback is drawn: ") + fault.what());
    }
  }
  return image_of(texture.source, what + ": source");
}

Handle<Image> TextureImporter::image_of(int gltf_image, const std::string &what)
{
  const Model::Image &source = element(file_.model.images, gltf_image, what);
  const auto [place, is_new] = image_of_.try_emplace({source.uri, source.buffer_view});
  if (is_new) {
    try {
      place->second = import_image(gltf_image);
    }
    catch (const Fault &fault) {
      place->second = fault;
    }
  }
  if (const Fault *fault = std::get_if<Fault>(&place->second)) {
    throw Fault(*fault);
  }
  return std::get<Handle<Image>>(place->second);
}

Handle<Image> TextureImporter::import_image(int gltf_image)
{
  const Model::Image &source = file_.model.images[gltf_image];
  const std::string what = label("image", source.name, static_cast<std::size_t>(gltf_image));
  EncodedImage encoded = encoded_image(file_, source, what);
  ImageDecoder decoder(encoded.bytes, what, size_max_);
  spend(decoder);
  const Handle<Image> handle =
      scene_.add(Image{source.name.empty() ? "image " + std::to_string(gltf_image) : source.name, 1, 1, {0, 0, 0, 0}});
  pending_.push_back({handle, std::move(encoded.storage), std::move(decoder)});
  return handle;
}

namespace {

struct ColorUse {
  scene::ImageUse use = scene::ImageUse::Color;
  /** The cover of the first mesh that shows a part of the image. */
  scene::MaskCover mask{};
};

/** Least alpha of the base colour's texels that cover \a mesh. Of vertices with different alphas it is that of their
 * mean. */
float texel_cutoff(const scene::Mesh &mesh, const scene::Material &material)
{
  double vertex_alpha = mesh.colors.empty() ? 1.0 : 0.0;
  for (const glm::vec4 &color : mesh.colors) {
    vertex_alpha += double(color.a) / double(mesh.colors.size());
  }
  return float(double(material.alpha_cutoff) / (double(material.alpha) * vertex_alpha));
}

/** The images that materials of \a scene use for colours. Coverage counts before Color, and Mask before both. */
std::map<Handle<Image>, ColorUse> color_images(const Scene &scene)
{
  std::map<Handle<Image>, ColorUse> images;
  for (const auto &[handle, material] : scene.materials()) {
    for (const scene::TextureInput &input : scene::texture_inputs) {
      const Texture *texture = scene.textures().find((material.*input.slot).texture);
      if (texture != nullptr && input.is_color) {
        ColorUse &known = images[texture->image];
        known.use = std::max(known.use, scene::use_of(material, input));
      }
    }
  }
  const auto base_color =
      std::ranges::find(scene::texture_inputs, &Material::base_color_texture, &scene::TextureInput::slot);
  // The importer makes materials for meshes alone.
  for (const auto &[handle, mesh] : scene.meshes()) {
    const Material &material = scene.material_of(mesh);
    const Texture *texture = scene.textures().find(material.base_color_texture.texture);
    if (texture == nullptr || scene::use_of(material, *base_color) != scene::ImageUse::Mask) {
      continue;
    }
    scene::MaskCover &known = images[texture->image].mask;
    const float cutoff = texel_cutoff(mesh, material);
    // The comparisons are false for NaN.
    if (known.cutoff == 0.0F && cutoff > 0.0F && cutoff <= 1.0F) {
      known = {cutoff, texture->magnified == scene::TextureFilter::Linear};
    }
  }
  return images;
}

}  // namespace

std::map<Handle<Image>, Fault> TextureImporter::decode(Progress &progress)
{
  const std::map<Handle<Image>, ColorUse> colors = color_images(scene_);
  std::vector<std::variant<Image, Fault>> results(pending_.size());
  const std::thread::id importing_thread = std::this_thread::get_id();
  std::atomic<std::size_t> done = 0;
  scene::parallel_for(pending_.size(), 0, [&](std::size_t i) {
    const std::size_t done_now = done++;
    if (std::this_thread::get_id() == importing_thread) {
      progress.set_done(done_now);
    }
    const trace::Span span("decode image", scene_.images()[pending_[i].handle].name);
    try {
      Image image = pending_[i].decoder.read();
      const auto color = colors.find(pending_[i].handle);
      const ColorUse use = color == colors.end() ? ColorUse{scene::ImageUse::Data} : color->second;
      results[i] = size_max_ > 0 ? reduced(std::move(image), size_max_, use.use, use.mask) : std::move(image);
    }
    catch (const Fault &fault) {
      results[i] = fault;
    }
  });
  std::map<Handle<Image>, Fault> damaged;
  for (std::size_t i = 0; i < pending_.size(); i++) {
    const Handle<Image> handle = pending_[i].handle;
    if (const Fault *fault = std::get_if<Fault>(&results[i])) {
      damaged.emplace(handle, *fault);
      continue;
    }
    Image &image = std::get<Image>(results[i]);
    image.name = scene_.images()[handle].name;
    scene_.replace(handle, std::move(image));
  }
  pending_.clear();
  for (const Roughness &derived : derived_) {
    if (const auto found = damaged.find(derived.source); found != damaged.end()) {
      damaged.emplace(derived.handle, found->second);
      continue;
    }
    scene_.replace(derived.handle, roughness_image(scene_.images()[derived.source], derived.glossiness,
                                                   scene_.images()[derived.handle].name));
  }
  derived_.clear();
  return damaged;
}

}  // namespace gnomon::gltf
