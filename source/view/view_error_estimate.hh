// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

namespace gnomon::view {

/**
 * Estimates the RMSE of a progressive picture from its samples: the RMS difference between the mean of n samples and
 * the mean of the first k, n >= 2 k. For independent samples of variance v, the squared difference is v (1 / k - 1 /
 * n). For n = 2 k this equals the squared RMSE v / n; for larger n it is larger. An error common to all samples is not
 * detected.
 */
class ErrorEstimate {
 public:
  /** Start a new picture. */
  void restart()
  {
    *this = {};
  }
  /** Whether add should be called at \a sample_count: at twice the samples of the last added picture, at least 2. */
  [[nodiscard]] bool is_due(int sample_count) const
  {
    return sample_count >= 2 * count_;
  }
  /** \a picture: the mean of \a sample_count samples, four floats each pixel, of which the last is alpha. */
  void add(int sample_count, std::vector<float> picture);
  /** RMSE of the last picture over all pixels and the channels red, green and blue. Empty before the second picture. */
  [[nodiscard]] std::optional<double> value() const
  {
    return value_;
  }

 private:
  /** The number of samples of the last picture; 1: there is no picture. */
  int count_ = 1;
  std::vector<float> picture_;
  std::optional<double> value_;
};

}  // namespace gnomon::view
