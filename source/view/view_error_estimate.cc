// SPDX-License-Identifier: MIT
#include "view_error_estimate.hh"

#include <algorithm>
#include <cmath>

namespace gnomon::view {

void ErrorEstimate::add(int sample_count, std::vector<float> picture)
{
  if (picture.size() == picture_.size()) {
    double sum = 0.0;
    for (std::size_t i = 0; i < picture.size(); i++) {
      const double difference = i % 4 == 3 ? 0.0 : double(picture[i]) - double(picture_[i]);
      sum += difference * difference;
    }
    const double channels = 0.75 * double(std::max<std::size_t>(picture.size(), 4));
    value_ = std::sqrt(sum / channels);
  }
  count_ = sample_count;
  picture_ = std::move(picture);
}

}  // namespace gnomon::view
