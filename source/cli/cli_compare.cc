// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_output.hh"
#include "cli_picture.hh"

#include "measure_image_error.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace gnomon::cli {

namespace {

struct CompareOptions {
  std::string picture;
  std::string reference;
  std::string difference;
  float difference_scale = 1.0F;
  std::string json;
  /** One for each of `errors`; empty: any error is accepted. */
  std::array<std::optional<double>, 4> maxima;
};

/** An error that is printed, and may have a maximum. */
struct NamedError {
  const char *name;
  const char *option;
  const char *json_key;
  const char *description;
  double measure::ImageError::*value;
};

constexpr std::array<NamedError, 4> errors = {{
    {"RMSE", "--max-rmse", "rmse", "Root of the mean square difference over R, G and B", &measure::ImageError::rmse},
    {"relative MSE", "--max-relative-mse", "relative_mse",
     "Mean of the square difference over the reference's square plus 0.01", &measure::ImageError::relative_mse},
    {"p99", "--max-p99", "p99", "Difference that 99 % of the pixels do not exceed", &measure::ImageError::p99},
    {"FLIP", "--max-flip", "flip", "Mean visible difference on a display, 0 to 1", &measure::ImageError::flip},
}};

void write_difference(const CompareOptions &options, const Picture &picture, const Picture &reference)
{
  const std::vector<glm::vec4> difference =
      measure::difference(picture.pixels, reference.pixels, options.difference_scale);
  if (std::filesystem::path(options.difference).extension() == ".png") {
    write_png(options.difference, picture.size_px, measure::display_bytes(difference), {});
  }
  else {
    write_exr(options.difference, picture.size_px, floats(difference), {});
  }
}

void write_errors(const CompareOptions &options, const measure::ImageError &error)
{
  nlohmann::json json = {
      {"picture", options.picture}, {"reference", options.reference}, {"non_finite_count", error.non_finite_count}};
  for (const NamedError &one : errors) {
    // JSON has no NaN: null stands for an error that non-finite values leave undefined.
    json[one.json_key] = error.*one.value;
  }
  write_json(options.json, json);
}

Status compare(const CompareOptions &options)
{
  output::Roles roles;
  roles.add_input(options.picture, "the picture");
  roles.add_input(options.reference, "the reference");
  roles.add_output(options.json, "--json");
  roles.add_output(options.difference, "--difference");
  keep_text_from(roles);
  const Picture picture = read_picture(options.picture);
  const Picture reference = read_picture(options.reference);
  for (const auto &[path, of] : {std::pair(&options.picture, &picture), std::pair(&options.reference, &reference)}) {
    for (const std::string &warning : of->warnings) {
      print_message("gnomon: warning: {}: {}\n", *path, warning);
    }
  }
  if (picture.size_px != reference.size_px) {
    throw std::runtime_error(fmt::format("{}: is {}x{} pixels, and {} is {}x{}", options.picture, picture.size_px.x,
                                         picture.size_px.y, options.reference, reference.size_px.x,
                                         reference.size_px.y));
  }
  const measure::ImageError error = measure::image_error(picture.size_px, picture.pixels, reference.pixels);
  fmt::print("{:<13} {}\n", "non-finite", error.non_finite_count);
  for (const NamedError &one : errors) {
    fmt::print("{:<13} {:.6g}\n", one.name, error.*one.value);
  }
  write_errors(options, error);
  if (error.non_finite_count > 0) {
    print_message("gnomon: {}: {} values of the picture or the reference are NaN or infinite\n", options.picture,
                  error.non_finite_count);
    return Status::NonFinite;
  }
  if (!options.difference.empty()) {
    write_difference(options, picture, reference);
  }
  std::string above;
  for (std::size_t i = 0; i < errors.size(); i++) {
    const double value = error.*errors[i].value;
    if (options.maxima[i] && value > *options.maxima[i]) {
      above += fmt::format("{}{} {:.6g} is above {:g}", above.empty() ? "" : ", ", errors[i].name, value,
                           *options.maxima[i]);
    }
  }
  if (!above.empty()) {
    throw std::runtime_error(fmt::format("{}: {}", options.picture, above));
  }
  return Status::Done;
}

}  // namespace

void add_compare(CLI::App &app, Status &status)
{
  CLI::App *command = app.add_subcommand("compare", "Errors of a picture against a reference");
  auto o = std::make_shared<CompareOptions>();
  command
      ->add_option(
          "picture", o->picture,
          "EXR, HDR: scene-linear; PNG, JPEG, WebP: decoded by the sRGB curve. Transparent pixels are compared as "
          "if over black")
      ->required();
  command
      ->add_option("reference", o->reference, "A picture of the same size; of EXR files, display windows are compared")
      ->required();
  for (std::size_t i = 0; i < errors.size(); i++) {
    command
        ->add_option(errors[i].option, o->maxima[i], fmt::format("{}; above it the status is 1", errors[i].description))
        ->check(number_range(0.0, 1e30));
  }
  command->add_option("--difference", o->difference, "OUT.exr or OUT.png: the absolute difference of each value")
      ->check([](const std::string &path) {
        const std::string extension = std::filesystem::path(path).extension().string();
        return extension == ".exr" || extension == ".png" ? std::string() : "must end in .exr or .png";
      });
  command->add_option("--difference-scale", o->difference_scale, "Multiplies that difference")
      ->capture_default_str()
      ->check(number_range(1e-6, 1e6));
  command->add_option("--json", o->json, "Write the errors to this file");
  command->callback([o, &status] { status = compare(*o); });
}

}  // namespace gnomon::cli
