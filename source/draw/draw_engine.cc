// SPDX-License-Identifier: MIT
#include "draw_engine.hh"

#include "gpu_error.hh"

#include <algorithm>
#include <atomic>

namespace gnomon::draw {

Engine::Engine()
{
  static std::atomic<std::uint64_t> next = 1;
  id_ = next++;
}

void EngineRegistry::add(EngineType type)
{
  if (std::ranges::find(types_, type.name, &EngineType::name) != types_.end()) {
    throw gpu::Error("engine '{}' is registered already", type.name);
  }
  types_.push_back(std::move(type));
}

std::unique_ptr<Engine> EngineRegistry::create(std::string_view name) const
{
  const auto type = std::ranges::find(types_, name, &EngineType::name);
  if (type == types_.end()) {
    throw gpu::Error("no engine '{}'; registered: {}", name, fmt::join(names(), ", "));
  }
  return type->create();
}

std::vector<std::string> EngineRegistry::names() const
{
  std::vector<std::string> names;
  for (const EngineType &type : types_) {
    names.push_back(type.name);
  }
  return names;
}

}  // namespace gnomon::draw
