// SPDX-License-Identifier: MIT
// Loads entries of the cache of programs: any files, and those that the cache stored.
#include "fuzz_file.hh"
#include "gpu_shader_cache.hh"

static const gnomon::fuzz::Folder folder;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  using namespace gnomon;
  const std::string key(32, 'a');
  const gpu::ShaderDiskCache cache(folder.path());
  const auto *bytes = reinterpret_cast<const std::byte *>(data);
  folder.write(key, {data, size});
  static_cast<void>(cache.load(key));
  cache.store(key, {std::vector<std::byte>(bytes, bytes + size)});
  const std::optional<gpu::CachedShader> loaded = cache.load(key);
  if (size > 0 && (!loaded || loaded->compiled != std::vector<std::byte>(bytes, bytes + size))) {
    __builtin_trap();
  }
  return 0;
}
