// SPDX-License-Identifier: MIT
#include "shader_check_compilation.hh"

#include "shader_check_log.hh"

#include <glslang/SPIRV/GlslangToSpv.h>
#if GNOMON_GLSLANG_TREE
#include <glslang/Include/PoolAlloc.h>
#endif

#include <algorithm>

namespace gnomon::shader_check {

bool Compilation::add(std::unique_ptr<StageSource> source, CheckTarget target, bool needs_slots, bool has_lines)
{
  target_ = target;
  const bool is_done = glslang.add(*source, target, needs_slots);
  sources.push_back(std::move(source));
  if (sources.back()->has_line_directives()) {
    sources.back()->note_line_directives(glslang.preprocessed(*sources.back(), target), target);
  }
  lines.emplace_back(*sources.back());
  if (has_lines) {
    lines.back().read(target);
  }
  return is_done;
}

Compilation::Range Compilation::stage_of(std::size_t source) const
{
  Range range{source, source + 1};
  const auto is_of_stage = [&](std::size_t i) { return sources[i]->stage() == sources[source]->stage(); };
  while (range.begin > 0 && is_of_stage(range.begin - 1)) {
    range.begin--;
  }
  while (range.end < sources.size() && is_of_stage(range.end)) {
    range.end++;
  }
  return range;
}

bool Compilation::link()
{
#if GNOMON_GLSLANG_TREE
  facts.resize(sources.size());
  // Reading a tree takes memory from the pool of the thread. Linking sets the pool of the program.
  glslang::TPoolAllocator pool;
  glslang::SetThreadPoolAllocator(&pool);
  for (std::size_t i = 0; i < sources.size(); i++) {
    // glslang joins their trees, in which the files of several sources have the same names.
    if (stage_of(i).size() > 1 && glslang.tree(i) != nullptr) {
      facts[i] = read_tree(*glslang.tree(i), lines[i], true);
    }
  }
#endif
  return glslang.link();
}

const Spirv &Compilation::spirv(std::size_t stage)
{
  spirv_.resize(sources.size());
  Spirv &result = spirv_[stage];
  if (result.words.empty()) {
    spv::SpvBuildLogger logger;
    glslang::GlslangToSpv(*tree(stage), result.words, &logger);
    result.log = logger.getAllMessages();
  }
  return result;
}

std::vector<std::uint32_t> Compilation::spirv_with_lines(std::size_t stage)
{
  glslang::SpvOptions options;
  options.generateDebugInfo = true;
  std::vector<std::uint32_t> words;
  glslang::GlslangToSpv(*tree(stage), words, &options);
  return words;
}

void Compilation::read_facts([[maybe_unused]] bool is_sound, [[maybe_unused]] bool with_mistakes)
{
  facts.resize(sources.size());
  for (std::size_t i = 0; i < sources.size(); i++) {
    if (tree(i) == nullptr || stage_of(i).size() > 1) {
      continue;
    }
#if GNOMON_GLSLANG_TREE
    facts[i] = read_tree(*tree(i), lines[i], with_mistakes);
#else
    if (is_sound && has_spirv(target_)) {
      facts[i] = read_spirv(spirv(i).words, sources[i]->stage(), lines[i]);
    }
#endif
  }
}

const std::string &Compilation::file(std::size_t stage, SourcePosition position) const
{
  const std::vector<std::string> &files = sources[stage]->files();
  return position.file < files.size() ? files[position.file] : files.front();
}

void compile(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files, Compilation &compilation)
{
  for (const gpu::ShaderSource &source : gpu::preprocess(desc, files)) {
    if (!compilation.add(std::make_unique<StageSource>(source), CheckTarget::OpenGlSpirv)) {
      throw gpu::Error("shader '{}', {} stage:\n{}", desc.name, to_string(source.stage),
                       bounded_lines(source.name_files(compilation.glslang.log())));
    }
  }
  if (!compilation.link()) {
    throw gpu::Error("shader '{}' does not link:\n{}", desc.name, bounded_lines(compilation.glslang.log()));
  }
  compilation.read_facts(true, false);
}

std::optional<StageDeclaration> find_block(const Compilation &compilation, gpu::BindingKind kind, std::string_view name)
{
  for (std::size_t i = 0; i < compilation.facts.size(); i++) {
    const StageFacts &facts = compilation.facts[i];
    const auto &blocks = kind == gpu::BindingKind::UniformBlock ? facts.uniform_blocks : facts.storage_blocks;
    const auto found = std::ranges::find(blocks, name, &Declaration::name);
    if (found != blocks.end()) {
      return StageDeclaration{i, &*found};
    }
  }
  return std::nullopt;
}

}  // namespace gnomon::shader_check
