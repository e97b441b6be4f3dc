// SPDX-License-Identifier: MIT
#include "cli_shaders.hh"

#include "cli_output.hh"
#include "cli_shader_jobs.hh"
#include "cli_shader_manifest.hh"
#include "cli_shader_programs.hh"

#include "eevee_programs.hh"
#include "scene_types.hh"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <iterator>
#include <set>
#include <stdexcept>
#include <system_error>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

struct CheckArguments {
  std::vector<std::string> files;
  std::vector<std::string> include_folders;
  std::vector<std::string> defines;
  std::vector<std::string> levels;
  std::vector<std::string> features;
  std::string stage;
  std::string target;
  std::string format = "text";
  std::string shaders;
  std::string program;
  std::string manifest;
  std::string cache;
  /** A path: its text comes from standard input. */
  std::string input;
  std::string output;
  std::string depfile;
  std::string depfile_target;
  double time_limit = WorkLimits().seconds;
};

/** `all`: as the engines' own shaders are checked. */
std::vector<shader_check::CheckTarget> targets_of(const std::string &name)
{
  if (name == "all" || name == "auto" || name.empty()) {
    return {shader_check::CheckTarget::OpenGlSpirv, shader_check::CheckTarget::Vulkan12};
  }
  return {target_of(name)};
}

/** Reads the values of -W: NAME, no-NAME, error=NAME and error. */
void read_levels(const std::vector<std::string> &arguments, shader_check::RuleLevels &levels, bool &is_strict)
{
  using shader_check::RuleLevel;
  for (const std::string &argument : arguments) {
    if (argument == "error") {
      is_strict = true;
      continue;
    }
    const bool is_off = argument.starts_with("no-");
    const bool is_error = argument.starts_with("error=");
    const std::string name = argument.substr(is_off ? 3 : is_error ? 6 : 0);
    const auto rule = std::ranges::find(shader_check::check_rules(), name, &shader_check::CheckRule::name);
    if (rule == shader_check::check_rules().end() || !rule->is_optional) {
      std::string known;
      for (const shader_check::CheckRule &other : shader_check::check_rules()) {
        known += other.is_optional ? fmt::format("{}{}", known.empty() ? "" : ", ", other.name) : "";
      }
      throw UsageError(fmt::format("-W{}: {} '{}'; the rules with a level are {}", argument,
                                   rule == shader_check::check_rules().end() ? "no rule" : "no level for rule", name,
                                   known));
    }
    levels[name] = is_off ? RuleLevel::Off : is_error ? RuleLevel::Error : RuleLevel::Warning;
  }
}

/** Runs \a jobs and puts their messages together. */
ShaderReport report_of(const std::vector<ShaderJob> &jobs, const gpu::ShaderFiles &files,
                       const CheckArguments &arguments, std::vector<shader_check::ProgramCheck> *checks = nullptr)
{
  const auto start = std::chrono::steady_clock::now();
  JobOptions options;
  options.limits.seconds = arguments.time_limit;
  options.cache = arguments.cache;
  options.files = files;
  std::vector<shader_check::ProgramCheck> results = run_jobs(jobs, options);
  ShaderReport report;
  for (std::size_t i = 0; i < jobs.size(); i++) {
    std::ranges::copy(results[i].messages, std::back_inserter(report.messages));
    if (!results[i].target_reason.empty()) {
      report.choices.push_back({jobs[i].program, results[i].target, results[i].target_reason});
    }
    if (std::ranges::find(report.targets, results[i].target) == report.targets.end()) {
      report.targets.push_back(results[i].target);
    }
  }
  if (checks != nullptr) {
    *checks = std::move(results);
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

/** \a words in an unambiguous form, as a part of a key. */
std::string text_of(const std::vector<std::string> &words)
{
  std::string text = fmt::format("list {}\n", words.size());
  for (const std::string &word : words) {
    text += word + "\n";
  }
  return text;
}

std::string text_of(const shader_check::RuleLevels &levels)
{
  std::string text;
  for (const auto &[rule, level] : levels) {
    text += fmt::format("{}={}\n", rule, int(level));
  }
  return text;
}

/** Checks all of \a descs of Gnomon for all of \a targets. */
ShaderReport check_all(const std::vector<gpu::ShaderDesc> &descs, const gpu::ShaderFiles &files,
                       const CheckArguments &arguments)
{
  shader_check::CheckOptions options;
  options.blocks = engine_blocks();
  options.is_block_size_strict = true;
  read_levels(arguments.levels, options.levels, options.is_strict);
  std::string blocks;
  for (const gpu::BlockLayout &block : options.blocks) {
    blocks += fmt::format("{} {}\n", block.name, block.size_bytes);
    for (const gpu::BlockLayout::Field &field : block.fields) {
      blocks += fmt::format(" {} {}\n", field.name, field.offset_bytes);
    }
  }
  std::vector<ShaderJob> jobs;
  for (const gpu::ShaderDesc &desc : descs) {
    for (const shader_check::CheckTarget target : targets_of(arguments.target)) {
      const auto check = [&desc, &files, &options, target](shader_check::StageErrors errors) {
        shader_check::CheckOptions job = options;
        job.stage_errors = errors;
        job.target = target;
        shader_check::ProgramCheck result;
        const gpu::ShaderFiles noted = [&](std::string_view path) {
          const std::optional<std::string_view> text = files(path);
          (text ? result.files : result.absent).emplace_back(path);
          return text;
        };
        result.messages = shader_check::check_shader(desc, noted, job);
        for (std::vector<std::string> *paths : {&result.files, &result.absent}) {
          std::ranges::sort(*paths);
          paths->erase(std::unique(paths->begin(), paths->end()), paths->end());
        }
        result.target = target;
        return result;
      };
      jobs.push_back({check, desc.name, desc.vertex_path, target,
                      fmt::format("{} {}\n{}\n{}\n{}\n{}\n{}\n{}", int(target), options.is_strict, blocks, desc.name,
                                  desc.vertex_path, desc.geometry_path, desc.fragment_path,
                                  text_of(desc.defines) + text_of(options.levels))});
    }
  }
  ShaderReport report = report_of(jobs, files, arguments);
  report.variant_count = descs.size();
  return report;
}

/**
 * The programs that draw with a surface function: of each, the variant with the fewest features and the one with the
 * most. Together they have all inputs and outputs that stages share.
 */
std::vector<gpu::ShaderDesc> descs_with_surface_function()
{
  std::vector<gpu::ShaderDesc> descs;
  for (const eevee::ShaderDeclaration &declaration : eevee::shader_declarations()) {
    const std::vector<eevee::Feature> variants = eevee::surface_function_variants(declaration);
    for (std::size_t i = 0; i < variants.size(); i += std::max<std::size_t>(variants.size() - 1, 1)) {
      descs.push_back(with_surface_function(shader_desc(declaration, variants[i]), declaration));
    }
  }
  return descs;
}

ShaderReport check_engine(const CheckArguments &arguments)
{
  const EngineFiles files(arguments.shaders);
  std::vector<gpu::ShaderDesc> descs;
  const std::vector<Variant> variants = engine_variants();
  for (const Variant &variant : variants) {
    if (arguments.program.empty() || variant.desc.name == arguments.program) {
      descs.push_back(variant.desc);
    }
  }
  if (descs.empty()) {
    throw_no_program(arguments.program);
  }
  for (const gpu::ShaderDesc &desc : descs_with_surface_function()) {
    // eevee_depth_function has one in all its variants, which are above.
    const bool is_known = std::ranges::any_of(
        descs, [&](const gpu::ShaderDesc &known) { return known.name == desc.name && known.defines == desc.defines; });
    if (!is_known && (arguments.program.empty() || desc.name == arguments.program)) {
      descs.push_back(desc);
    }
  }
  ShaderReport report = check_all(descs, files.files(), arguments);
  report.program_count = arguments.program.empty() ? program_count(variants) : 1;
  for (shader_check::CheckMessage &message : report.messages) {
    message.file = files.shown(message.file);
  }
  return report;
}

/** A surface function in the programs that draw with it. */
ShaderReport check_surface_function(const std::string &file, const CheckArguments &arguments)
{
  shader_check::FolderFiles own{fs::path()};
  const std::optional<std::string_view> text = own.text(file);
  const auto failed = [&](int line, std::string reason) {
    ShaderReport report;
    report.messages.push_back({shader_check::Severity::Error, file, line, std::move(reason), "include", file, ""});
    report.targets = targets_of(arguments.target);
    return report;
  };
  if (!text) {
    return failed(1, "there is no such file");
  }
  if (text->size() > scene::SurfaceFunction::text_bytes_max) {
    return failed(1, fmt::format("it has more than {} bytes", scene::SurfaceFunction::text_bytes_max));
  }
  if (const auto fault = eevee::surface_function_fault(*text)) {
    return failed(fault->line, fault->reason);
  }
  const EngineFiles engine("");
  ShaderReport report = check_all(
      descs_with_surface_function(),
      [&](std::string_view path) { return path == eevee::surface_function_file ? text : engine.files()(path); },
      arguments);
  for (shader_check::CheckMessage &message : report.messages) {
    message.file = message.file == eevee::surface_function_file ? file : engine.shown(message.file);
  }
  return report;
}

/** Write a file for make and ninja: \a target depends on \a files. */
void write_depfile(const std::string &path, const std::string &target, const std::vector<std::string> &files)
{
  const auto escaped = [](const std::string &file) {
    std::string text;
    for (const char c : file) {
      // A colon ends the targets of a line.
      const bool is_marked = c == ' ' || c == '#' || c == ':';
      text += is_marked ? fmt::format("\\{}", c) : c == '$' ? std::string("$$") : std::string(1, c);
    }
    return text;
  };
  std::string text = escaped(target) + ":";
  for (const std::string &file : files) {
    text += fmt::format(" \\\n  {}", escaped(file));
  }
  output::write_file(path, text + "\n");
}

bool is_output_folder(const CheckArguments &arguments)
{
  return arguments.files.size() > 1 || fs::is_directory(arguments.output);
}

/** Where -o puts the SPIR-V of \a file. */
fs::path output_path(const CheckArguments &arguments, const std::string &file)
{
  return is_output_folder(arguments) ? fs::path(arguments.output) / (fs::path(file).filename().string() + ".spv")
                                     : fs::path(arguments.output);
}

/**
 * The files that are known before shaders are read. \throws output::Conflict if an output would replace an input or
 * another output
 */
output::Roles roles_of(const std::vector<ShaderManifest::Entry> &entries, const CheckArguments &arguments)
{
  output::Roles roles;
  roles.add_input(arguments.manifest, "--manifest");
  for (const std::string &file : arguments.files) {
    roles.add_input(file, "a shader");
  }
  for (const ShaderManifest::Entry &entry : entries) {
    for (const shader_check::Program::File &file : entry.program.files) {
      roles.add_input(file.path, "a shader");
    }
  }
  if (!arguments.output.empty()) {
    if (is_output_folder(arguments)) {
      fs::create_directories(arguments.output);
    }
    for (const ShaderManifest::Entry &entry : entries) {
      for (const shader_check::Program::File &file : entry.program.files) {
        roles.add_output(output_path(arguments, file.path), "the SPIR-V of " + file.path);
      }
    }
  }
  roles.add_output(arguments.depfile, "-MF");
  keep_text_from(roles);
  return roles;
}

/** Writes the SPIR-V of \a checks: of one file to the path of -o, of more into that folder. */
void write_output(const std::vector<ShaderManifest::Entry> &entries,
                  const std::vector<shader_check::ProgramCheck> &checks, const CheckArguments &arguments)
{
  for (std::size_t i = 0; i < checks.size(); i++) {
    for (const auto &[stage, words] : checks[i].spirv) {
      const auto file = std::ranges::find(entries[i].program.files, stage, &shader_check::Program::File::stage);
      output::write_file(output_path(arguments, file->path),
                         {reinterpret_cast<const char *>(words.data()), words.size() * sizeof(std::uint32_t)});
    }
  }
}

/** Adds an error for each of \a checks without mistakes of which there is no SPIR-V to write. */
void add_missing_output(const std::vector<ShaderManifest::Entry> &entries,
                        const std::vector<shader_check::ProgramCheck> &checks, const CheckArguments &arguments,
                        ShaderReport &report)
{
  for (std::size_t i = 0; i < checks.size(); i++) {
    const shader_check::CheckTarget target = checks[i].target;
    if (!checks[i].has_errors() && !has_spirv(target)) {
      const shader_check::Program &program = entries[i].program;
      report.messages.push_back(
          {shader_check::Severity::Error, program.files.front().path, 1,
           fmt::format("there is no SPIR-V for {}, so that -o {} is not written; --target vulkan, "
                       "vulkan1.0 to vulkan1.3 and opengl-spirv make it",
                       to_string(target), arguments.output),
           "spirv", program.name, "", target});
    }
  }
}

/**
 * The programs of FILES: files whose names differ only in the stage belong to one. \a others gets the messages about
 * files that are no stages.
 */
ShaderManifest programs_of_files(const CheckArguments &arguments, ShaderReport &others)
{
  std::vector<shader_check::Program> programs;
  std::set<fs::path> given;
  for (const std::string &file : arguments.files) {
    if (!given.insert(fs::path(file).lexically_normal()).second) {
      continue;
    }
    if (arguments.stage == "surface" || (arguments.stage.empty() && is_surface_function(file))) {
      const ShaderReport report = check_surface_function(file, arguments);
      std::ranges::copy(report.messages, std::back_inserter(others.messages));
      others.program_count++;
      others.variant_count += report.variant_count;
      others.seconds += report.seconds;
      others.targets = report.targets;
      continue;
    }
    const std::optional<shader_check::Stage> stage =
        stage_of(arguments.stage.empty() ? fs::path(file) : fs::path("." + arguments.stage));
    if (stage) {
      add_file(programs, *stage, file);
    }
    else {
      others.messages.push_back({shader_check::Severity::Error, file, 1, unknown_stage(file), "stage", file, ""});
    }
  }
  ShaderManifest project;
  complete(programs);
  for (shader_check::Program &program : programs) {
    project.entries.push_back({std::move(program), {}});
  }
  return project;
}

/** The targets of \a entry; without a value: as its files say. */
std::vector<std::optional<shader_check::CheckTarget>> targets_of(const ShaderManifest::Entry &entry,
                                                                 const std::string &option)
{
  std::vector<std::optional<shader_check::CheckTarget>> targets;
  const bool is_option = !option.empty() && option != "auto";
  for (const std::string &name : is_option ? std::vector{option} : entry.targets) {
    std::ranges::copy(targets_of(name), std::back_inserter(targets));
  }
  return targets.empty() ? std::vector<std::optional<shader_check::CheckTarget>>{std::nullopt} : targets;
}

/** A job for each program and target. \a options: those without a target. All arguments must outlive the jobs. */
std::vector<ShaderJob> jobs_of(const ShaderManifest &project, const gpu::ShaderFiles &files,
                               const shader_check::ProgramOptions &options, const CheckArguments &arguments)
{
  std::vector<ShaderJob> jobs;
  for (const ShaderManifest::Entry &entry : project.entries) {
    const shader_check::Program &program = entry.program;
    for (const std::optional<shader_check::CheckTarget> target : targets_of(entry, arguments.target)) {
      shader_check::ProgramOptions job = options;
      job.target = target;
      const bool has_output = !arguments.output.empty();
      const auto check = [&program, &files, job, has_output](shader_check::StageErrors errors) {
        shader_check::ProgramOptions job_options = job;
        job_options.stage_errors = errors;
        shader_check::ProgramCheck result = shader_check::check_program(program, files, job_options);
        if (!has_output) {
          result.spirv.clear();
        }
        return result;
      };
      std::string key =
          fmt::format("{}\n{}\n{}\n{}\n", target ? int(*target) : -1, has_output, job.is_strict, program.name);
      for (const shader_check::Program::File &file : program.files) {
        key += fmt::format("file {} {}\n", int(file.stage), file.path);
      }
      key += text_of(program.defines) + text_of(job.include_folders) + text_of(job.features) + text_of(job.levels);
      jobs.push_back({check, program.name, program.files.front().path,
                      target.value_or(shader_check::CheckTarget::OpenGl), std::move(key)});
    }
  }
  return jobs;
}

/** Writes --depfile: the files that \a checks have read. */
void write_dependencies(std::span<const shader_check::ProgramCheck> checks, const CheckArguments &arguments)
{
  std::vector<std::string> read;
  if (!arguments.manifest.empty()) {
    read.push_back(arguments.manifest);
  }
  for (const shader_check::ProgramCheck &check : checks) {
    for (const std::string &path : check.files) {
      if (std::ranges::find(read, path) == read.end()) {
        read.push_back(path);
      }
    }
  }
  write_depfile(arguments.depfile, arguments.depfile_target.empty() ? arguments.output : arguments.depfile_target,
                read);
}

/** The text on standard input, as far as a stage may have it. \throws std::runtime_error */
std::string read_standard_input()
{
  // A longer text is refused, so that its rest is not needed.
  std::string text(shader_check::stage_bytes_max + 1, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), stdin));
  if (std::ferror(stdin) != 0) {
    throw std::runtime_error(
        fmt::format("--stdin: standard input cannot be read: {}", std::generic_category().message(errno)));
  }
  return text;
}

/** Checks FILES, or the programs of --manifest. */
ShaderReport check_files(const CheckArguments &arguments, bool &is_any_checked)
{
  ShaderReport others;
  ShaderManifest project =
      arguments.manifest.empty() ? programs_of_files(arguments, others) : read_shader_manifest(arguments.manifest);
  is_any_checked = !project.entries.empty() || others.program_count > 0;
  for (ShaderManifest::Entry &entry : project.entries) {
    add_defines(entry.program.defines, arguments.defines);
  }
  output::Roles roles = roles_of(project.entries, arguments);
  shader_check::FolderFiles folder{fs::path()};
  const std::string input = arguments.input.empty() ? std::string() : read_standard_input();
  const gpu::ShaderFiles files = [&](std::string_view path) {
    return !arguments.input.empty() && path == arguments.input ? std::optional<std::string_view>(input)
                                                               : folder.text(path);
  };
  shader_check::ProgramOptions options;
  options.include_folders = arguments.include_folders;
  std::ranges::copy(project.include_folders, std::back_inserter(options.include_folders));
  options.features = project.features;
  std::ranges::copy(arguments.features, std::back_inserter(options.features));
  // The levels of the command line are read last and take precedence.
  read_levels(project.levels, options.levels, options.is_strict);
  read_levels(arguments.levels, options.levels, options.is_strict);
  const std::vector<ShaderJob> jobs = jobs_of(project, files, options, arguments);
  std::vector<shader_check::ProgramCheck> checks;
  ShaderReport report = report_of(jobs, files, arguments, &checks);
  for (const shader_check::ProgramCheck &check : checks) {
    for (const std::string &path : check.files) {
      roles.add_input(path, "an include");
    }
  }
  if (!arguments.output.empty()) {
    add_missing_output(project.entries, checks, arguments, report);
  }
  if (!arguments.output.empty() && !report.has_errors()) {
    write_output(project.entries, checks, arguments);
  }
  if (!arguments.depfile.empty()) {
    write_dependencies(checks, arguments);
  }
  std::set<std::string_view> names;
  for (const ShaderManifest::Entry &entry : project.entries) {
    names.insert(entry.program.name);
  }
  report.program_count = names.size() + others.program_count;
  report.variant_count = project.entries.size() + others.variant_count;
  std::ranges::copy(others.messages, std::back_inserter(report.messages));
  for (const shader_check::CheckTarget target : others.targets) {
    if (std::ranges::find(report.targets, target) == report.targets.end()) {
      report.targets.push_back(target);
    }
  }
  report.seconds += others.seconds;
  return report;
}

void require_usage(const CheckArguments &a)
{
  if (!a.files.empty() + !a.shaders.empty() + !a.manifest.empty() > 1) {
    throw UsageError("--shaders, --manifest and FILES exclude each other");
  }
  if (!a.manifest.empty() && !(a.output.empty() && a.stage.empty())) {
    throw UsageError("-o and --stage are for FILES");
  }
  if (a.files.empty() && a.manifest.empty() &&
      !(a.include_folders.empty() && a.defines.empty() && a.stage.empty() && a.features.empty() && a.output.empty() &&
        a.depfile.empty())) {
    throw UsageError("-I, -D, -o, -MF, --stage, --feature and --stdin are for FILES");
  }
  if (!a.output.empty() && a.target == "all") {
    throw UsageError("-o needs one target");
  }
  if (!a.depfile.empty() && a.depfile_target.empty() && a.output.empty()) {
    throw UsageError("-MF needs -MT TARGET or -o: the file that depends on the shaders");
  }
}

Status check(CheckArguments arguments)
{
  if (!arguments.input.empty()) {
    const std::optional<output::FileId> input = output::file_id(arguments.input);
    const auto file = std::ranges::find_if(arguments.files, [&](const std::string &path) {
      return path == arguments.input || (input && output::file_id(path) == input);
    });
    if (file == arguments.files.end()) {
      arguments.files.push_back(arguments.input);
    }
    else {
      arguments.input = *file;
    }
  }
  require_usage(arguments);
  bool is_any_checked = true;
  const ShaderReport report = arguments.files.empty() && arguments.manifest.empty()
                                  ? check_engine(arguments)
                                  : check_files(arguments, is_any_checked);
  fmt::print("{}", arguments.format == "json"    ? to_json(report)
                   : arguments.format == "sarif" ? to_sarif(report)
                                                 : to_text(report));
  if (!is_any_checked) {
    throw UsageError(fmt::format("{}: {}", arguments.files.front(), unknown_stage(arguments.files.front())));
  }
  return report.has_errors() ? Status::Failed : Status::Done;
}

}  // namespace

void add_shaders_check(CLI::App &shaders, Status &status)
{
  CLI::App *command = shaders.add_subcommand("check", "Find mistakes in shaders; needs no driver");
  auto a = std::make_shared<CheckArguments>();
  command->add_option("files", a->files, "Shaders to check (default: all variants of the engine's shaders)");
  add_source_options(*command, a->include_folders, a->defines);
  std::vector<std::string> stages{"surface"};
  for (const shader_check::StageName &stage : shader_check::stage_names()) {
    stages.emplace_back(stage.ending);
  }
  command->add_option("--stage", a->stage, "Stage of FILES (default: from their names)")->check(CLI::IsMember(stages));
  std::vector<std::string> targets = target_names();
  targets.emplace_back("all");
  command
      ->add_option("--target", a->target,
                   "opengl (GLSL as drivers compile it), opengl-spirv, es, vulkan (1.2), vulkan1.0 to vulkan1.3, all "
                   "(opengl-spirv and vulkan; the default of the engine's shaders), auto (as FILES say; their default)")
      ->check(CLI::IsMember(targets));
  command->add_option("-W", a->levels, "Level of a rule: -WRULE, -Wno-RULE, -Werror=RULE; -Werror: of all warnings")
      ->allow_extra_args(false);
  const auto features = shader_check::device_features();
  command->add_option("--feature", a->features, "A feature of devices that FILES may assume, such as scalarBlockLayout")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(std::vector<std::string>(features.begin(), features.end())));
  command->add_option("--time-limit", a->time_limit, "Seconds of CPU time for each program and target")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--manifest", a->manifest, "File of programs, permutations and targets, in place of FILES");
  command->add_option("--cache", a->cache, "Folder of results by the content of all files that were read");
  command->add_option("--stdin", a->input, "A path of FILES whose text comes from standard input, as an editor has it");
  command->add_option("-o", a->output, "File for the SPIR-V, or a folder for that of several FILES");
  command->add_option("--depfile,--MF", a->depfile, "-MD -MF FILE: writes the files that were read for make and ninja");
  command->add_flag("--MD")->description("With -MF, as compilers have it")->needs("--depfile");
  command->add_option("--depfile-target,--MT", a->depfile_target,
                      "-MT NAME: what depends on them (default: that of -o)");
  command->add_option("--format", a->format, "text, json, sarif")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json", "sarif"}));
  command->add_option("--shaders", a->shaders, "Folder of the engine's shaders (default: those in the program)");
  command->add_option("--program", a->program, "Check only this program of the engine, by its name in 'shaders list'");
  command->callback([a, &status] { status = check(*a); });
}

}  // namespace gnomon::cli
