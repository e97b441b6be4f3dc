// SPDX-License-Identifier: MIT
#include "internal/gltf_environment.hh"

#include "internal/gltf_image.hh"
#include "internal/gltf_node.hh"
#include "internal/gltf_report.hh"
#include "scene_parallel.hh"

#include <glm/common.hpp>
#include <glm/gtc/color_space.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace gnomon::gltf {

namespace {

constexpr std::size_t face_count = 6;
/** Most texels of a face. With so many, the picture has 400 MB. */
constexpr std::uint64_t environment_texel_count_max = std::uint64_t(2048) * 2048;

/** A place on a face: from -1 to 1, to the right and down its image. */
struct FacePlace {
  std::size_t face;
  double s;
  double t;
};

/** OpenGL 4.6, table 8.19. \pre direction is not 0 */
FacePlace face_place(const glm::dvec3 &direction)
{
  const glm::dvec3 size = glm::abs(direction);
  const double largest = std::max({size.x, size.y, size.z});
  const glm::dvec3 at = direction / largest;
  if (size.x == largest) {
    return at.x > 0.0 ? FacePlace{0, -at.z, -at.y} : FacePlace{1, at.z, -at.y};
  }
  if (size.y == largest) {
    return at.y > 0.0 ? FacePlace{2, at.x, at.z} : FacePlace{3, at.x, -at.z};
  }
  return at.z > 0.0 ? FacePlace{4, at.x, -at.y} : FacePlace{5, -at.x, -at.y};
}

class CubeMap {
 public:
  /** \a faces: squares of one size */
  explicit CubeMap(std::vector<scene::Image> faces) : faces_(std::move(faces)), edge_(int(faces_.front().width))
  {
    for (std::size_t i = 0; i < linear_.size(); i++) {
      linear_[i] = glm::convertSRGBToLinear(glm::vec3(static_cast<float>(i) / 255.0F)).r;
    }
  }

  [[nodiscard]] int edge() const
  {
    return edge_;
  }

  /** Bilinear within a face. */
  [[nodiscard]] glm::vec3 radiance(const glm::dvec3 &direction) const
  {
    const auto [face, s, t] = face_place(direction);
    const auto texel_of = [this](double place) {
      return std::clamp(0.5 * (place + 1.0) * edge_ - 0.5, 0.0, double(edge_ - 1));
    };
    const double x = texel_of(s);
    const double y = texel_of(t);
    const int left = int(x);
    const int top = int(y);
    const int right = std::min(left + 1, edge_ - 1);
    const int bottom = std::min(top + 1, edge_ - 1);
    const auto across = static_cast<float>(x - left);
    const auto down = static_cast<float>(y - top);
    return glm::mix(glm::mix(texel(face, left, top), texel(face, right, top), across),
                    glm::mix(texel(face, left, bottom), texel(face, right, bottom), across), down);
  }

 private:
  std::vector<scene::Image> faces_;
  int edge_;
  std::array<float, 256> linear_{};

  [[nodiscard]] glm::vec3 texel(std::size_t face, int x, int y) const
  {
    const std::uint8_t *rgbd = &faces_[face].texels[4 * (std::size_t(y) * std::size_t(edge_) + std::size_t(x))];
    const float divisor = static_cast<float>(std::max<int>(rgbd[3], 1)) / 255.0F;
    return glm::vec3(linear_[rgbd[0]], linear_[rgbd[1]], linear_[rgbd[2]]) / divisor;
  }
};

std::vector<scene::Image> read_faces(const File &file, const Model::ImageLight &light, const std::string &what)
{
  if (light.faces.size() != face_count) {
    throw Fault(what,
                "its specularImages begin with " + std::to_string(light.faces.size()) + " images, and must with 6");
  }
  std::vector<scene::Image> faces(face_count);
  scene::parallel_for(face_count, 0, [&](std::size_t i) {
    const int index = light.faces[i];
    const Model::Image &image = element(file.model.images, index, what + ": image of a face");
    const std::string name = label("image", image.name, static_cast<std::size_t>(index));
    const EncodedImage encoded = encoded_image(file, image, name);
    ImageDecoder decoder(encoded.bytes, name);
    if (decoder.texel_count() > environment_texel_count_max) {
      throw Fault(name, "is too large for a face of an image-based light, which may have 2048x2048 texels");
    }
    faces[i] = decoder.read();
  });
  for (const scene::Image &face : faces) {
    const std::uint32_t edge = faces.front().width;
    if (face.width != edge || face.height != edge) {
      throw Fault(what, "its faces are not squares of one size: one has " + std::to_string(face.width) + 'x' +
                            std::to_string(face.height) + " texels, and the first a width of " + std::to_string(edge));
    }
  }
  return faces;
}

}  // namespace

scene::WorldPicture environment_picture(const File &file, const Model::ImageLight &light, const std::string &what)
{
  constexpr double pi = std::numbers::pi;
  const CubeMap cube(read_faces(file, light, what));
  const auto &[x, y, z, w] = light.rotation;
  const glm::dmat3 cube_from_world =
      glm::transpose(glm::dmat3(matrix_from(glm::dvec3(0.0), {x, y, z, w}, glm::dvec3(1.0))));
  scene::WorldPicture picture;
  picture.width = 4 * cube.edge();
  picture.height = 2 * cube.edge();
  picture.texels.resize(std::size_t(picture.width) * std::size_t(picture.height));
  // Texels of a cube are smaller near its corners than those of the picture. Four samples a texel miss none of them.
  constexpr std::array<double, 2> places = {0.25, 0.75};
  scene::parallel_for(std::size_t(picture.height), 0, [&](std::size_t row) {
    for (int column = 0; column < picture.width; column++) {
      glm::vec3 sum(0.0F);
      for (const double down : places) {
        const double elevation = (0.5 - (double(row) + down) / picture.height) * pi;
        const double y_ws = std::sin(elevation);
        const double radius = std::cos(elevation);
        for (const double across : places) {
          const double azimuth = ((column + across) / picture.width - 0.5) * 2.0 * pi;
          sum +=
              cube.radiance(cube_from_world * glm::dvec3(radius * std::cos(azimuth), y_ws, radius * std::sin(azimuth)));
        }
      }
      picture.texels[row * std::size_t(picture.width) + std::size_t(column)] = 0.25F * sum;
    }
  });
  return picture;
}

}  // namespace gnomon::gltf
