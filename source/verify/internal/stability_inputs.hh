// SPDX-License-Identifier: MIT
#pragma once

#include "internal/stability_cases.hh"

#include <algorithm>
#include <array>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

/** Helpers for the cases of inputs, and the lists of these cases. */
namespace gnomon::verify {

/** Required treatment of an input by an importer or the engine. */
enum class Expected {
  /** The input is used, and the resulting values satisfy the contract. */
  Accepted,
  /** The input is left out or replaced, and a warning or limit names it. */
  Reported,
  /** The input is refused by an error of one line that names it. */
  Rejected,
};

/** An input and its required treatment. */
template <typename T = double>
struct Input {
  /** StabilitySample::parameter of this input. */
  double parameter = 0.0;
  T value{};
  Expected expected = Expected::Accepted;
};

using Numbers = std::vector<Input<>>;

/** Numbers, each of which is its own parameter. */
inline Numbers inputs(std::initializer_list<double> values, Expected expected)
{
  Numbers result;
  for (const double value : values) {
    result.push_back({value, value, expected});
  }
  return result;
}

inline Numbers operator+(Numbers a, const Numbers &b)
{
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/** The result of using an input. */
struct Outcome {
  /** Values that violate the contract. */
  std::size_t fault_count = 0;
  /** Warnings and reported limits. */
  std::vector<std::string> messages;
};

/**
 * The number of faults of one input: values that violate the contract, a missing message, an unexpected rejection.
 * \param expected_text: a message or error must contain it.
 */
double fault_count(Expected expected, const std::string &expected_text, const std::function<Outcome()> &use);

/** A case whose error is fault_count() of each input. \param use: uses an input. */
template <typename T>
StabilityCase input_case(std::string group, std::string name, std::string quantity, std::string parameter,
                         std::string expected_text, std::vector<Input<T>> values, std::function<Outcome(const T &)> use)
{
  StabilityCase one;
  one.group = std::move(group);
  one.name = std::move(name);
  one.quantity = std::move(quantity);
  one.parameter = std::move(parameter);
  one.reference = "contract of the input";
  one.unit = "faults";
  one.bound = 0.0;
  one.run = [expected_text = std::move(expected_text), values = std::move(values), use = std::move(use)] {
    std::vector<StabilitySample> samples;
    for (const Input<T> &each : values) {
      samples.push_back({each.parameter, fault_count(each.expected, expected_text, [&] { return use(each.value); })});
    }
    return samples;
  };
  return one;
}

inline constexpr const char *float_kinds = "1 NaN, 2 infinity, 3 -infinity, 4 1e30, 5 1e-40, 6 0, 7 largest float";

inline std::vector<Input<float>> float_inputs(std::initializer_list<int> accepted, Expected otherwise)
{
  using Float = std::numeric_limits<float>;
  const std::array<float, 7> values = {Float::quiet_NaN(), Float::infinity(), -Float::infinity(), 1e30F, 1e-40F, 0.0F,
                                       Float::max()};
  std::vector<Input<float>> result;
  for (int i = 1; i <= 7; i++) {
    const bool is_accepted = std::ranges::find(accepted, i) != accepted.end();
    result.push_back({double(i), values[std::size_t(i) - 1], is_accepted ? Expected::Accepted : otherwise});
  }
  return result;
}

void add_gltf_inputs(std::vector<StabilityCase> &cases);
void add_host_inputs(std::vector<StabilityCase> &cases);

}  // namespace gnomon::verify
