// SPDX-License-Identifier: MIT
#include "shader_check_compilation.hh"

#include "shader_check_log.hh"

#include <glslang/MachineIndependent/localintermediate.h>

#include <algorithm>

namespace gnomon::shader_check {

bool Compilation::add(std::unique_ptr<StageSource> source, CheckTarget target)
{
  const bool is_done = glslang.add(*source, target);
  sources.push_back(std::move(source));
  SourceLines &added = lines.emplace_back(*sources.back());
  const glslang::TIntermediate *parsed = glslang.intermediate(sources.size() - 1);
  // Before version 3.30, `#line N` sets its own line.
  added.read(parsed == nullptr || parsed->getProfile() == EEsProfile || parsed->getVersion() >= 330);
  return is_done;
}

void Compilation::read_facts()
{
  for (std::size_t i = 0; i < sources.size(); i++) {
    facts.push_back(tree(i) == nullptr ? StageFacts() : read_stage(*tree(i), lines[i]));
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
  if (!compilation.glslang.link()) {
    throw gpu::Error("shader '{}' does not link:\n{}", desc.name, bounded_lines(compilation.glslang.log()));
  }
  compilation.read_facts();
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
