// SPDX-License-Identifier: MIT
#pragma once

#include "internal/stability_cases.hh"
#include "internal/verify_test_view.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <concepts>
#include <numbers>

/** Helpers for the cases of rendered pictures, and the lists of these cases. */
namespace gnomon::verify {

using namespace measure;
using scene::LampKind;
using scene::ShadowKind;

inline constexpr double pi = std::numbers::pi;

/** Texts of a case. \see StabilityCase */
struct CaseText {
  const char *group;
  std::string name;
  std::string quantity;
  const char *parameter;
  const char *reference;
  const char *unit = "RMSE of the mean";
};

inline constexpr const char *exact_rays = "exact rays";

/** Error of the picture at a value of the parameter. */
using ErrorAt = std::function<double(TestViewRenderer &renderer, double parameter)>;

/** All cases, and the TestViewRenderer that draws them. */
class ImageCases {
 public:
  explicit ImageCases(gpu::Device &device) : renderer_(std::make_shared<TestViewRenderer>(device)) {}

  void add(const CaseText &text, double bound, std::vector<double> parameters, ErrorAt error_at)
  {
    StabilityCase one;
    one.group = std::string(image_group_prefix) + text.group;
    one.name = text.name;
    one.quantity = text.quantity;
    one.parameter = text.parameter;
    one.reference = text.reference;
    one.unit = text.unit;
    one.bound = bound;
    one.run = [renderer = renderer_, parameters = std::move(parameters), error_at = std::move(error_at)] {
      std::vector<StabilitySample> samples;
      for (const double parameter : parameters) {
        samples.push_back({parameter, error_at(*renderer, parameter)});
      }
      return samples;
    };
    all_.push_back(std::move(one));
  }
  std::vector<StabilityCase> take()
  {
    return std::move(all_);
  }

 private:
  /** Shared with the cases. */
  std::shared_ptr<TestViewRenderer> renderer_;
  std::vector<StabilityCase> all_;
};

const char *name_of(LampKind kind);
const char *name_of(ShadowKind kind);

/** A kind of lamp and its shadow technique. */
struct Variant {
  LampKind lamp;
  ShadowKind shadow;

  [[nodiscard]] std::string name() const;
};

inline constexpr std::array<Variant, 10> variants = {{{LampKind::Point, ShadowKind::Hard},
                                                      {LampKind::Point, ShadowKind::Pcf},
                                                      {LampKind::Point, ShadowKind::Esm},
                                                      {LampKind::Point, ShadowKind::Evsm},
                                                      {LampKind::Spot, ShadowKind::Hard},
                                                      {LampKind::Spot, ShadowKind::Pcf},
                                                      {LampKind::Spot, ShadowKind::Esm},
                                                      {LampKind::Spot, ShadowKind::Evsm},
                                                      {LampKind::Sun, ShadowKind::Hard},
                                                      {LampKind::Sun, ShadowKind::Pcf}}};

/**
 * Bounds of the relative RMSE to the ray-traced picture. The pictures differ at edges, because both have 16 samples per
 * pixel at different positions. Measured: 0.012 to 0.024 for sharp shadows of layers this coarse, 0.023 to 0.041 for
 * exponential ones. For comparison, a missing shadow gives 0.25 and a shift by one pixel 0.1.
 */
inline constexpr double sharp_bound = 0.03;
inline constexpr double soft_bound = 0.055;

inline double bound_of(ShadowKind shadow)
{
  return shadow == ShadowKind::Esm || shadow == ShadowKind::Evsm ? soft_bound : sharp_bound;
}

inline constexpr std::array<LampKind, 3> lamp_kinds = {LampKind::Point, LampKind::Spot, LampKind::Sun};

inline glm::mat4 moved(const glm::vec3 &by)
{
  return glm::translate(glm::mat4(1.0F), by);
}

inline glm::mat4 scaled(const glm::vec3 &by)
{
  return glm::scale(glm::mat4(1.0F), by);
}

/** Change the first lamp of a test view. */
template <std::invocable<scene::Lamp &> Change>
void edit_lamp(TestView &test_view, Change change)
{
  test_view.scene.edit(test_view.scene.lamps().first(), change);
}

/** Change the first material of a test view. */
template <std::invocable<scene::Material &> Change>
void edit_material(TestView &test_view, Change change)
{
  test_view.scene.edit(test_view.scene.materials().first(), change);
}

/** A rotated box, a tilted plate above it and a ground. A third of the ground is in shadow. */
TestView table(LampKind kind);

/** A ground that fills the picture, seen from straight above. */
TestView ground(LampKind kind, const glm::vec3 &lamp_position, const glm::vec3 &forward);

inline DrawSettings with(ShadowKind shadow, glm::ivec2 size_px = DrawSettings().size_px, int sample_count = 16)
{
  return {shadow, size_px, sample_count};
}

void add_camera_images(ImageCases &cases);
void add_count_images(ImageCases &cases);
void add_fold_images(ImageCases &cases);
void add_lamp_images(ImageCases &cases);
void add_placement_images(ImageCases &cases);
void add_surface_images(ImageCases &cases);

}  // namespace gnomon::verify
