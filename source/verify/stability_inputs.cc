// SPDX-License-Identifier: MIT
#include "internal/stability_inputs.hh"

#include "gltf_import.hh"
#include "gpu_error.hh"
#include "scene.hh"

#include <algorithm>

namespace gnomon::verify {

double fault_count(Expected expected, const std::string &expected_text, const std::function<Outcome()> &use)
{
  const auto names_it = [&](const std::string &message) {
    return message.find(expected_text) != message.npos && message.find('\n') == message.npos;
  };
  try {
    const Outcome outcome = use();
    const bool is_silent = expected == Expected::Reported && !std::ranges::any_of(outcome.messages, names_it);
    return double(outcome.fault_count) + (expected == Expected::Rejected || is_silent ? 1.0 : 0.0);
  }
  catch (const gnomon::gltf::ImportError &error) {
    return expected == Expected::Rejected && names_it(error.what()) ? 0.0 : 1.0;
  }
  catch (const scene::InvalidEdit &error) {
    return expected == Expected::Rejected && names_it(error.what()) ? 0.0 : 1.0;
  }
  catch (const gpu::Error &error) {
    return expected == Expected::Rejected && names_it(error.what()) ? 0.0 : 1.0;
  }
}

std::vector<StabilityCase> input_stability_cases()
{
  std::vector<StabilityCase> cases;
  add_gltf_inputs(cases);
  add_host_inputs(cases);
  return cases;
}

}  // namespace gnomon::verify
