// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

namespace gnomon::view {

/**
 * Estimates the RMSE of a picture that refines, from its own samples: by the RMS difference between the mean of n
 * samples and that of the first k, n >= 2 k. If samples are independent, with variance v, its square is
 * v (1 / k - 1 / n), which is the square of the RMSE, v / n, where n = 2 k, and more above. An error that all samples
 * share is not seen.
 */
class ErrorEstimate {
 public:
  /** Another picture begins. */
  void restart()
  {
    *this = {};
  }
  /** Whether to add a picture of \a sample_count: it has twice the samples of the last, or at least 2 as the first. */
  [[nodiscard]] bool is_due(int sample_count) const
  {
    return sample_count >= 2 * count_;
  }
  /** \a picture: the mean of \a sample_count samples, four floats each pixel, of which the last is alpha. */
  void add(int sample_count, std::vector<float> picture);
  /** RMSE of the last picture over all pixels, red, green and blue. Empty before the second. */
  [[nodiscard]] std::optional<double> value() const
  {
    return value_;
  }

 private:
  /** Of the last picture; 1: there is none. */
  int count_ = 1;
  std::vector<float> picture_;
  std::optional<double> value_;
};

}  // namespace gnomon::view
