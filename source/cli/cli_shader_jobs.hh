// SPDX-License-Identifier: MIT
#pragma once

#include "cli_shader_report.hh"
#include "cli_workers.hh"

#include <filesystem>

namespace gnomon::cli {

/** The check of one program for one target. */
struct ShaderJob {
  std::function<shader_check::ProgramCheck(shader_check::StageErrors)> check;
  /** For a message about a job that does not end. */
  std::string program;
  std::string file;
  shader_check::CheckTarget target = shader_check::CheckTarget::OpenGlSpirv;
  /** All that the result depends on but the files that it names: options. */
  std::string key;
};

struct JobOptions {
  WorkLimits limits;
  /** Folder of results by the content of files; empty: none is kept. */
  std::filesystem::path cache;
  /** The files that the results name. */
  gpu::ShaderFiles files;
};

/** Runs \a jobs on all cores. \return the results in the order of jobs; a job that breaks a limit has an error. */
[[nodiscard]] std::vector<shader_check::ProgramCheck> run_jobs(const std::vector<ShaderJob> &jobs,
                                                               const JobOptions &options);

}  // namespace gnomon::cli
