// SPDX-License-Identifier: MIT
#include "scene_image.hh"

#include "scene_parallel.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace gnomon::scene {

ImageUse use_of(const Material &material, const TextureInput &input)
{
  const bool has_hidden_texels =
      material.alpha_mode == AlphaMode::Mask ? material.alpha_cutoff > 0.0F : material.alpha_mode == AlphaMode::Blend;
  const bool covers = input.slot == &Material::base_color_texture && has_hidden_texels && !material.surface_function;
  return covers           ? material.alpha_mode == AlphaMode::Mask ? ImageUse::Mask : ImageUse::Coverage
         : input.is_color ? ImageUse::Color
                          : ImageUse::Data;
}

float decoded_srgb(float value)
{
  return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}

namespace {

/** IEC 61966-2-1. */
float encoded_srgb(float value)
{
  return value <= 0.0031308F ? 12.92F * value : 1.055F * std::pow(value, 1.0F / 2.4F) - 0.055F;
}

/** The texels that a texel of the reduced image covers along an edge. */
struct Span {
  std::uint32_t first = 0;
  /** The share of each texel from `first` on. The sum is 1. */
  std::vector<float> shares;
};

std::vector<Span> spans_of(std::uint32_t size, std::uint32_t reduced_size)
{
  std::vector<Span> spans(reduced_size);
  const double step = double(size) / reduced_size;
  for (std::uint32_t i = 0; i < reduced_size; i++) {
    const double start = i * step;
    const double end = start + step;
    Span &span = spans[i];
    span.first = std::uint32_t(start);
    for (std::uint32_t texel = span.first; texel < size && texel < end; texel++) {
      span.shares.push_back(float((std::min(end, texel + 1.0) - std::max(start, double(texel))) / step));
    }
  }
  return spans;
}

/** The mean of an area: linear colours times their weight, that weight, and the covered part. */
struct Mean {
  std::array<float, 3> weighted{};
  float weight = 0.0F;
  float part = 0.0F;
};

std::uint8_t rounded(float value)
{
  return std::uint8_t(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F)));
}

/** The parts of the texels of an image that a mask covers. */
class CoveredParts {
 public:
  /** \a image must live as long as this. */
  CoveredParts(const Image &image, const MaskCover &mask) : image_(image), least_(255.0F * mask.cutoff)
  {
    while (least_byte_ < 256 && float(least_byte_) / 255.0F < mask.cutoff) {
      least_byte_++;
    }
    if (mask.cutoff > 0.0F && mask.is_linear) {
      parts_.resize(std::size_t(image.width) * image.height);
      parallel_for(image.height, parts_.size() < 65536 ? 1 : 0, [&](std::size_t y) { filter_row(y); });
    }
  }
  /** Whether the texel itself is covered, so that its colour is seen. */
  [[nodiscard]] bool has_color(std::size_t x, std::size_t y) const
  {
    return alpha(x, y) >= least_byte_;
  }
  [[nodiscard]] float part(std::size_t x, std::size_t y) const
  {
    return parts_.empty() ? (has_color(x, y) ? 1.0F : 0.0F) : float(parts_[y * image_.width + x]) / 255.0F;
  }

 private:
  [[nodiscard]] int alpha(std::size_t x, std::size_t y) const
  {
    return image_.texels[4 * (y * image_.width + x) + 3];
  }
  /** \a at and its neighbours; the texels repeat. */
  static std::array<std::size_t, 3> around(std::size_t at, std::size_t size)
  {
    return {at > 0 ? at - 1 : size - 1, at, at + 1 < size ? at + 1 : 0};
  }

  void filter_row(std::size_t y)
  {
    const std::array<std::size_t, 3> rows = around(y, image_.height);
    // Covered texels of the three rows.
    std::vector<std::uint8_t> counts(image_.width);
    for (const std::size_t row : rows) {
      for (std::size_t x = 0; x < counts.size(); x++) {
        counts[x] = std::uint8_t(counts[x] + (has_color(x, row) ? 1 : 0));
      }
    }
    for (std::size_t x = 0; x < counts.size(); x++) {
      const std::array<std::size_t, 3> columns = around(x, image_.width);
      const int count = counts[columns[0]] + counts[x] + counts[columns[2]];
      parts_[y * image_.width + x] = count == 0 ? 0 : count == 9 ? 255 : rounded(mixed_part(columns, rows));
    }
  }

  /** The part of the middle one of nine texels. */
  [[nodiscard]] float mixed_part(const std::array<std::size_t, 3> &columns,
                                 const std::array<std::size_t, 3> &rows) const
  {
    const auto value = [&](std::size_t a, std::size_t b) { return float(alpha(columns[a], rows[b])); };
    float sum = 0.0F;
    for (const std::size_t b : {0, 2}) {
      for (const std::size_t a : {0, 2}) {
        sum += quarter(value(1, 1), value(a, 1), value(1, b), value(a, b)) / 4.0F;
      }
    }
    return sum;
  }

  /** The part of a quarter of a texel. Alphas: its own, those of its neighbours, and that of the texel between them. */
  [[nodiscard]] float quarter(float own, float beside, float above, float across) const
  {
    const int count = int(own >= least_) + int(beside >= least_) + int(above >= least_) + int(across >= least_);
    if (count % 4 == 0) {
      return float(count / 4);
    }
    // The part is exact along the axis of the greater change, as alphas are linear there.
    if (std::abs(beside - own) > std::abs(above - own)) {
      std::swap(beside, above);
    }
    constexpr int step_count = 4;
    float sum = 0.0F;
    for (int i = 0; i < step_count; i++) {
      // From the centre of the texel to its edge.
      const float x = (float(i) + 0.5F) / float(2 * step_count);
      const float centre = own + (beside - own) * x;
      const float edge = (centre + above + (across - above) * x) / 2.0F;
      const bool is_centre = centre >= least_;
      const bool is_edge = edge >= least_;
      const float to_edge = is_centre == is_edge ? 1.0F : (least_ - centre) / (edge - centre);
      sum += is_centre ? to_edge : is_edge ? 1.0F - to_edge : 0.0F;
    }
    return sum / float(step_count);
  }

  const Image &image_;
  float least_;
  int least_byte_ = 0;
  /** The covered part of each texel under the linear filter, in 1/255; empty: texels are covered or not. */
  std::vector<std::uint8_t> parts_;
};

/** The linear value of each byte. */
std::array<float, 256> decoded_bytes(ImageUse use)
{
  std::array<float, 256> decoded{};
  for (std::size_t i = 0; i < decoded.size(); i++) {
    const float value = float(i) / 255.0F;
    decoded[i] = use == ImageUse::Data ? value : decoded_srgb(value);
  }
  return decoded;
}

/** Rounds encoded values without computing them. */
class SrgbEncoder {
 public:
  SrgbEncoder()
  {
    for (std::size_t i = 0; i < limits_.size(); i++) {
      limits_[i] = decoded_srgb((float(i) + 0.5F) / 255.0F);
    }
    for (std::size_t i = 0; i < starts_.size(); i++) {
      const float low = float(i) / float(starts_.size());
      starts_[i] = std::uint8_t(std::ranges::upper_bound(limits_, low) - limits_.begin());
    }
  }

  [[nodiscard]] std::uint8_t operator()(float value) const
  {
    const auto last = float(starts_.size() - 1);
    std::size_t byte = starts_[std::size_t(std::clamp(value * float(starts_.size()), 0.0F, last))];
    while (byte < limits_.size() && value >= limits_[byte]) {
      byte++;
    }
    return std::uint8_t(byte);
  }

 private:
  /** The value from which on the next byte is nearer. */
  std::array<float, 255> limits_{};
  std::array<std::uint8_t, 4096> starts_{};
};

/** A mip level while it is made. */
struct Level {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<Mean> means;
};

/** The next coarser level. \a mean_at(x, y): that of a texel of the finer level. */
template <typename MeanAt>
Level halved(std::uint32_t width, std::uint32_t height, const MeanAt &mean_at)
{
  Level level{std::max(width / 2, 1U), std::max(height / 2, 1U), {}};
  const std::vector<Span> columns = spans_of(width, level.width);
  const std::vector<Span> rows = spans_of(height, level.height);
  level.means.resize(std::size_t(level.width) * level.height);
  parallel_for(level.height, level.means.size() < 65536 ? 1 : 0, [&](std::size_t y) {
    for (std::size_t x = 0; x < level.width; x++) {
      Mean &sum = level.means[y * level.width + x];
      for (std::size_t b = 0; b < rows[y].shares.size(); b++) {
        for (std::size_t a = 0; a < columns[x].shares.size(); a++) {
          const float share = rows[y].shares[b] * columns[x].shares[a];
          const Mean &one = mean_at(columns[x].first + a, rows[y].first + b);
          for (std::size_t c = 0; c < 3; c++) {
            sum.weighted[c] += share * one.weighted[c];
          }
          sum.weight += share * one.weight;
          sum.part += share * one.part;
        }
      }
    }
  });
  return level;
}

}  // namespace

glm::uvec2 reduced_size(glm::uvec2 size, std::uint32_t size_max)
{
  const std::uint32_t longer = std::max(size.x, size.y);
  const auto edge = [&](std::uint32_t full) {
    return std::max(std::uint32_t(std::lround(double(full) * size_max / longer)), 1U);
  };
  return longer <= size_max ? size : glm::uvec2(edge(size.x), edge(size.y));
}

/**
 * The picture of a linear filter over rows of texels, each of which is covered or not. The value at a point is the
 * covered share of the four texels around it. The texels repeat.
 */
class FilteredCover {
 public:
  FilteredCover(const std::vector<bool> &is_covered, std::size_t width)
  {
    const std::size_t height = is_covered.size() / width;
    for (std::size_t y = 0; y < height; y++) {
      for (std::size_t x = 0; x < width; x++) {
        const auto covers = [&](std::size_t a, std::size_t b) -> unsigned {
          return is_covered[(y + b) % height * width + (x + a) % width] ? 1U : 0U;
        };
        shares_[covers(0, 0) | covers(1, 0) << 1U | covers(0, 1) << 2U | covers(1, 1) << 3U] +=
            1.0 / double(is_covered.size());
      }
    }
  }

  /** The part of the image where the value is at least \a least. */
  [[nodiscard]] double part(float least) const
  {
    double sum = 0.0;
    for (unsigned corners = 0; corners < shares_.size(); corners++) {
      int count = 0;
      for (int y = 0; y < step_count && shares_[corners] > 0.0; y++) {
        for (int x = 0; x < step_count; x++) {
          const float u = (float(x) + 0.5F) / float(step_count);
          const float v = (float(y) + 0.5F) / float(step_count);
          const auto of = [&](unsigned corner) { return float(corners >> corner & 1U); };
          count += std::lerp(std::lerp(of(0), of(1), u), std::lerp(of(2), of(3), u), v) >= least ? 1 : 0;
        }
      }
      sum += shares_[corners] * count / (step_count * step_count);
    }
    return sum;
  }

  /** The value from which on the covered part is \a wanted. */
  [[nodiscard]] float least_of(double wanted) const
  {
    // A single covered texel covers its area from 0.38 on, and a single hole from 0.62 on.
    float low = 0.25F;
    float high = 0.75F;
    for (int i = 0; i < 10; i++) {
      const float middle = (low + high) / 2.0F;
      (part(middle) > wanted ? low : high) = middle;
    }
    return (low + high) / 2.0F;
  }

 private:
  static constexpr int step_count = 32;
  /** The share of each pattern of four neighbours; bit 0: the upper left one is covered. */
  std::array<double, 16> shares_{};
};

/**
 * Decides which texels are covered: those with a covered share of at least a half. \a is_diffused: the error of each
 * texel goes to its neighbours (Floyd and Steinberg, 1976), which keeps the covered share of pictures of grass and
 * nets. A texel with share 0 is never covered, because it has no color.
 */
static std::vector<bool> covered_texels(const std::vector<float> &parts, std::size_t width, bool is_diffused)
{
  std::vector<bool> is_covered(parts.size());
  std::vector<float> wanted = parts;
  for (std::size_t i = 0; i < parts.size(); i++) {
    is_covered[i] = wanted[i] >= 0.5F && parts[i] > 0.0F;
    if (!is_diffused) {
      continue;
    }
    const float error = wanted[i] - (is_covered[i] ? 1.0F : 0.0F);
    const std::size_t x = i % width;
    // Shares of sixteen go to the right, and to the three texels below. At an edge, they go to those that there are.
    struct Share {
      bool is_there;
      std::size_t at;
      float share;
    };
    const bool has_row = i + width < parts.size();
    const std::array<Share, 4> shares = {Share{x + 1 < width, i + 1, 7.0F},
                                         {has_row && x > 0, i + width - 1, 3.0F},
                                         {has_row, i + width, 5.0F},
                                         {has_row && x + 1 < width, i + width + 1, 1.0F}};
    float whole = 0.0F;
    for (const Share &one : shares) {
      whole += one.is_there ? one.share : 0.0F;
    }
    for (const Share &one : shares) {
      if (one.is_there) {
        wanted[one.at] += error * one.share / whole;
      }
    }
  }
  return is_covered;
}

/**
 * Gives texels without a covered share the mean colour of their neighbours with one, so that a filter between them
 * mixes in no hidden colour. The texels repeat.
 */
static void fill_uncovered(Image &image, const std::vector<float> &parts)
{
  const std::size_t width = image.width;
  const std::size_t height = image.height;
  for (std::size_t y = 0; y < height; y++) {
    for (std::size_t x = 0; x < width; x++) {
      if (parts[y * width + x] > 0.0F) {
        continue;
      }
      std::array<unsigned, 3> sum{};
      unsigned count = 0;
      for (std::size_t b = height - 1; b <= height + 1; b++) {
        for (std::size_t a = width - 1; a <= width + 1; a++) {
          const std::size_t at = (y + b) % height * width + (x + a) % width;
          if (parts[at] > 0.0F) {
            for (std::size_t c = 0; c < sum.size(); c++) {
              sum[c] += image.texels[4 * at + c];
            }
            count++;
          }
        }
      }
      for (std::size_t c = 0; count > 0 && c < sum.size(); c++) {
        image.texels[4 * (y * width + x) + c] = std::uint8_t((sum[c] + count / 2) / count);
      }
    }
  }
}

/**
 * Sets the alphas of a reduced mask from \a parts, the covered shares of its texels, so that a share of a half is at
 * the cutoff. \a wanted: the covered share of the image. If texels or a linear filter between them would cover another
 * share, texels get one of two alphas instead, so that the filter covers that share.
 */
static void cover(Image &image, const std::vector<float> &parts, double wanted, float cutoff)
{
  constexpr double change_max = 0.01;
  std::vector<bool> is_covered = covered_texels(parts, image.width, false);
  const double count = double(std::ranges::count(is_covered, true)) / double(parts.size());
  const bool is_diffused = std::abs(count - wanted) > change_max;
  if (is_diffused) {
    is_covered = covered_texels(parts, image.width, true);
  }
  const FilteredCover filtered(is_covered, image.width);
  const bool has_two_alphas = is_diffused || std::abs(filtered.part(0.5F) - wanted) > change_max;
  // The value that is drawn at the cutoff.
  const float at = has_two_alphas ? filtered.least_of(wanted) : 0.5F;
  const float range = std::min(cutoff / at, (1.0F - cutoff) / (1.0F - at));
  const auto least = std::uint8_t(std::clamp(std::ceil(255.0F * cutoff), 1.0F, 255.0F));
  for (std::size_t i = 0; i < parts.size(); i++) {
    const float value = !has_two_alphas ? parts[i] : is_covered[i] ? 1.0F : 0.0F;
    const std::uint8_t alpha = rounded(cutoff + (value - at) * range);
    image.texels[4 * i + 3] = is_covered[i] ? std::max(alpha, least) : std::min(alpha, std::uint8_t(least - 1));
  }
  fill_uncovered(image, parts);
}

Image reduced(Image image, std::uint32_t size_max, ImageUse use, const MaskCover &mask)
{
  const glm::uvec2 size = reduced_size({image.width, image.height}, size_max);
  if (size == glm::uvec2(image.width, image.height)) {
    return image;
  }
  const std::array<float, 256> decoded = decoded_bytes(use);
  const std::vector<Span> columns = spans_of(image.width, size.x);
  const std::vector<Span> rows = spans_of(image.height, size.y);
  Image result{std::move(image.name), std::uint32_t(columns.size()), std::uint32_t(rows.size()), {}};
  result.texels.reserve(4 * columns.size() * rows.size());
  const bool is_mask = use == ImageUse::Mask && mask.cutoff > 0.0F;
  const CoveredParts covered(image, mask);
  const bool has_alpha = use == ImageUse::Coverage || use == ImageUse::Mask;
  /** The mean of colours, of alphas, of the weights of colours and of the covered part. */
  const auto sum_of = [&](const Span &row, const Span &column, bool is_weighted) {
    std::array<float, 6> sum{};
    for (std::size_t b = 0; b < row.shares.size(); b++) {
      for (std::size_t a = 0; a < column.shares.size(); a++) {
        const float share = row.shares[b] * column.shares[a];
        const std::size_t x = column.first + a;
        const std::size_t y = row.first + b;
        const std::size_t texel = 4 * (y * image.width + x);
        const float alpha = float(image.texels[texel + 3]) / 255.0F;
        const float own_weight = !is_mask ? alpha : covered.has_color(x, y) ? 1.0F : 0.0F;
        const float weight = is_weighted ? share * own_weight : share;
        for (std::size_t c = 0; c < 3; c++) {
          sum[c] += weight * decoded[image.texels[texel + c]];
        }
        sum[3] += share * alpha;
        sum[4] += share * own_weight;
        sum[5] += is_mask ? share * covered.part(x, y) : 0.0F;
      }
    }
    return sum;
  };
  std::vector<float> parts;
  double wanted = 0.0;
  for (const Span &row : rows) {
    for (const Span &column : columns) {
      std::array<float, 6> mean = sum_of(row, column, has_alpha);
      if (has_alpha && mean[4] > 0.0F) {
        std::for_each_n(mean.begin(), 3, [&](float &value) { value /= mean[4]; });
      }
      else if (has_alpha) {
        mean = sum_of(row, column, false);
      }
      for (std::size_t c = 0; c < 4; c++) {
        result.texels.push_back(rounded(use != ImageUse::Data && c < 3 ? encoded_srgb(mean[c]) : mean[c]));
      }
      if (is_mask) {
        // A texel without a color is not covered.
        parts.push_back(mean[4] > 0.0F ? mean[5] : 0.0F);
        wanted += mean[5];
      }
    }
  }
  if (is_mask) {
    cover(result, parts, wanted / double(parts.size()), mask.cutoff);
  }
  return result;
}

std::vector<std::uint8_t> coverage_levels(const Image &image, const MaskCover &mask)
{
  const std::array<float, 256> decoded = decoded_bytes(ImageUse::Coverage);
  const SrgbEncoder encoded;
  std::vector<Level> levels{{image.width, image.height, {}}};
  const bool is_mask = mask.cutoff > 0.0F;
  const CoveredParts covered(image, mask);
  const auto mean_of_image = [&](std::size_t x, std::size_t y) {
    const std::uint8_t *texel = &image.texels[4 * (y * image.width + x)];
    const float alpha = float(texel[3]) / 255.0F;
    const float weight = !is_mask ? alpha : covered.has_color(x, y) ? 1.0F : 0.0F;
    return Mean{{weight * decoded[texel[0]], weight * decoded[texel[1]], weight * decoded[texel[2]]},
                weight,
                is_mask ? covered.part(x, y) : alpha};
  };
  while (levels.back().width > 1 || levels.back().height > 1) {
    const Level &finer = levels.back();
    const auto mean_of_level = [&](std::size_t x, std::size_t y) -> const Mean & {
      return finer.means[y * finer.width + x];
    };
    levels.push_back(levels.size() == 1 ? halved(finer.width, finer.height, mean_of_image)
                                        : halved(finer.width, finer.height, mean_of_level));
  }
  std::vector<std::size_t> starts;
  std::size_t size = 0;
  for (const Level &level : levels) {
    starts.push_back(size);
    size += std::size_t(4) * level.width * level.height;
  }
  std::vector<std::uint8_t> texels(size);
  std::ranges::copy(image.texels, texels.begin());
  for (std::size_t i = levels.size(); i-- > 0;) {
    const Level &level = levels[i];
    const Level *coarser = i + 1 < levels.size() ? &levels[i + 1] : nullptr;
    const bool is_large = std::size_t(level.width) * level.height >= 65536;
    parallel_for(level.height, is_large ? 0 : 1, [&](std::size_t y) {
      std::uint8_t *texel = &texels[starts[i] + 4 * y * level.width];
      for (std::size_t x = 0; x < level.width; x++, texel += 4) {
        const Mean *mean = i > 0 ? &level.means[y * level.width + x] : nullptr;
        if (mean) {
          texel[3] = rounded(mean->part);
        }
        if (mean && mean->weight > 0.0F) {
          for (std::size_t c = 0; c < 3; c++) {
            texel[c] = encoded(mean->weighted[c] / mean->weight);
          }
        }
        else if (coarser && (mean || texel[3] == 0)) {
          const std::size_t column = std::min<std::size_t>(x / 2, coarser->width - 1);
          const std::size_t row = std::min<std::size_t>(y / 2, coarser->height - 1);
          std::copy_n(&texels[starts[i + 1] + 4 * (row * coarser->width + column)], 3, texel);
        }
      }
    });
  }
  return texels;
}

}  // namespace gnomon::scene
