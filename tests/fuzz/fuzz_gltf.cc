// SPDX-License-Identifier: MIT
// Imports glTF and GLB, poses and exports what it gets. Mutates JSON as JSON.
#include "fuzz_file.hh"
#include "gltf_export.hh"
#include "gltf_import.hh"

#include <nlohmann/json.hpp>

#include <cstring>
#include <optional>
#include <random>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t *data, std::size_t size, std::size_t max_size);

namespace {

using namespace gnomon;
using nlohmann::json;

constexpr std::size_t head_size = 20;

bool is_glb(fuzz::Bytes file)
{
  return file.size() >= head_size && std::memcmp(file.data(), "glTF", 4) == 0;
}

std::uint32_t word_at(fuzz::Bytes file, std::size_t offset)
{
  std::uint32_t word = 0;
  std::memcpy(&word, file.data() + offset, sizeof(word));
  return word;
}

/** The text of the JSON in \a file, and what follows it. */
struct Parts {
  fuzz::Bytes text;
  fuzz::Bytes rest;
};

Parts parts_of(fuzz::Bytes file)
{
  if (!is_glb(file)) {
    return {file, {}};
  }
  const std::size_t size = std::min<std::size_t>(word_at(file, 12), file.size() - head_size);
  return {file.subspan(head_size, size), file.subspan(head_size + size)};
}

std::vector<std::uint8_t> file_of(std::string text, fuzz::Bytes rest, bool is_binary)
{
  std::vector<std::uint8_t> file;
  if (is_binary) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint32_t whole = std::uint32_t(head_size + text.size() + rest.size());
    const std::uint32_t head[5] = {0x46546C67, 2, whole, std::uint32_t(text.size()), 0x4E4F534A};
    const auto *bytes = reinterpret_cast<const std::uint8_t *>(head);
    file.assign(bytes, bytes + sizeof(head));
  }
  file.insert(file.end(), text.begin(), text.end());
  file.insert(file.end(), rest.begin(), rest.end());
  return file;
}

void collect(json &value, std::vector<json *> &values)
{
  values.push_back(&value);
  for (json &child : value) {
    if (value.is_structured()) {
      collect(child, values);
    }
  }
}

json number(std::minstd_rand &random)
{
  static const std::vector<json> numbers = {0,          1,          -1,   2,          3,         255,         65535,
                                            5120,       5121,       5123, 5125,       5126,      0.0,         -0.0,
                                            0.5,        1e-30,      1e30, 1e300,      -7,        4294967295U, 64,
                                            2147483647, 4294967296, 16,   1000000007, 999999999, 0x1p62,      -1e-9};
  return numbers[random() % numbers.size()];
}

void mutate(json &document, std::minstd_rand &random)
{
  std::vector<json *> values;
  collect(document, values);
  json &value = *values[random() % values.size()];
  const json &other = *values[random() % values.size()];
  switch (random() % 8) {
    case 0: value = json(other); break;
    case 1: value = number(random); break;
    case 2:
      if (value.is_array() && !value.empty()) {
        value.push_back(json(value[random() % value.size()]));
      }
      break;
    case 3:
      if (value.is_array() && !value.empty()) {
        value.erase(random() % value.size());
      }
      break;
    case 4:
      if (value.is_object() && !value.empty()) {
        value.erase(std::next(value.begin(), std::ptrdiff_t(random() % value.size())));
      }
      break;
    case 5:
      if (value.is_object() && other.is_object()) {
        value.update(json(other));
      }
      break;
    case 6:
      if (value.is_number()) {
        value = value.get<double>() + double(random() % 5) - 2.0;
      }
      break;
    default:
      if (value.is_number()) {
        value = random() % 16;
      }
      break;
  }
}

const fuzz::Folder folder;

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t *data, std::size_t size, std::size_t max_size,
                                               unsigned int seed)
{
  std::minstd_rand random(seed);
  const fuzz::Bytes file(data, size);
  const Parts parts = parts_of(file);
  json document = json::parse(parts.text.begin(), parts.text.end(), nullptr, false);
  if (document.is_discarded() || random() % 8 == 0) {
    return LLVMFuzzerMutate(data, size, max_size);
  }
  for (std::size_t i = 0; i <= random() % 4; i++) {
    mutate(document, random);
  }
  const std::vector<std::uint8_t> mutated =
      file_of(document.dump(-1, ' ', false, json::error_handler_t::replace), parts.rest, is_glb(file));
  if (mutated.size() > max_size) {
    return LLVMFuzzerMutate(data, size, max_size);
  }
  std::memcpy(data, mutated.data(), mutated.size());
  return mutated.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  const fuzz::Bytes file(data, size);
  const std::filesystem::path path = folder.write(is_glb(file) ? "scene.glb" : "scene.gltf", file);
  // Within the memory and the time that libFuzzer allows.
  const gltf::ImportOptions options{.texture_size_max = 64,
                                    .image_bytes_max = 1U << 24U,
                                    .element_count_max = 1U << 18U,
                                    .only_below = folder.path()};
  try {
    scene::Scene scene = gltf::import_gltf(path, options);
    static_cast<void>(scene.placed_lamps());
    static_cast<void>(scene.objects());
    for (const scene::Animation &animation : std::vector(scene.animations)) {
      scene::pose(scene, animation, 0.3);
    }
    gltf::export_gltf(scene, folder.path() / "saved.glb");
    static_cast<void>(gltf::import_gltf(folder.path() / "saved.glb", options));
  }
  catch (const gltf::ImportError &) {
  }
  catch (const gltf::ExportError &) {
  }
  return 0;
}
