// SPDX-License-Identifier: MIT
#pragma once

#include "gltf/gltf_builder.hh"
#include "gltf_import.hh"
#include "internal/verify_contract.hh"

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace gnomon::test {

/** Expects the contract of scene.hh for imported scenes. */
inline void expect_valid(const scene::Scene &scene)
{
  EXPECT_EQ(verify::contract_faults(scene), std::vector<std::string>());
}

/** Item number \a index of a pool, in its order. \throws std::out_of_range */
template <typename T>
const T &nth(const scene::Pool<T> &things, std::size_t index)
{
  for (const auto &[handle, thing] : things) {
    if (index-- == 0) {
      return thing;
    }
  }
  throw std::out_of_range("the pool has fewer things");
}

/** The name of the node of an object. */
inline std::string object_name(const scene::Scene &scene, std::size_t index)
{
  return scene.nodes()[scene.objects().at(index).node].name;
}

inline scene::Scene import_text(const std::string &content, const std::string &name = "scene.gltf",
                                const gltf::ImportOptions &options = {})
{
  const TemporaryFolder folder;
  scene::Scene result = gltf::import_gltf(folder.write(name, content), options);
  expect_valid(result);
  return result;
}

inline scene::Scene import(const GltfBuilder &builder)
{
  return import_text(builder.gltf());
}

/** The message of the import error; empty if there was none. */
inline std::string import_error(const std::string &content, const std::string &name = "scene.gltf",
                                const gltf::ImportOptions &options = {})
{
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.write(name, content);
  try {
    (void)gltf::import_gltf(path, options);
  }
  catch (const gltf::ImportError &error) {
    const std::string message = error.what();
    const std::string prefix = path.string() + ": ";
    EXPECT_EQ(message.rfind(prefix, 0), 0U) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message.substr(std::min(prefix.size(), message.size()));
  }
  return {};
}

inline std::string import_error(const GltfBuilder &builder)
{
  return import_error(builder.gltf());
}

inline bool has_warning(const scene::Scene &scene, const std::string &part)
{
  return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                     [&](const std::string &warning) { return warning.find(part) != warning.npos; });
}

inline std::string all_warnings(const scene::Scene &scene)
{
  std::string result;
  for (const std::string &warning : scene.warnings) {
    result += warning + '\n';
  }
  return result;
}

#define EXPECT_WARNING(scene, part) EXPECT_TRUE(has_warning(scene, part)) << all_warnings(scene)
#define EXPECT_NO_WARNING(scene, part) EXPECT_FALSE(has_warning(scene, part)) << all_warnings(scene)
#define EXPECT_HAS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

}  // namespace gnomon::test
