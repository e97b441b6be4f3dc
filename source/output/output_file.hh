// SPDX-License-Identifier: MIT
#pragma once

#include <compare>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>

/**
 * Writing of files. All functions may be called on any thread.
 *
 * A path names the target of its links: symbolic links are followed, also to a file that does not exist yet. A regular
 * file is replaced as a whole, and keeps its permissions and, as far as the process may set it, its owner. Another name
 * of it (a hard link) keeps the old content. A pipe, a device or a descriptor of the process (`/dev/stdout`,
 * `/dev/fd/3`) is written to.
 */
namespace gnomon::output {

/** Thrown if a file cannot be written. The message names the file, as the caller spelt it, and the reason. */
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** A failure that another attempt may not have: the disk is full or fails, or the system lacks memory or descriptors.
 */
struct TransientError : Error {
  using Error::Error;
};

/**
 * \throws std::runtime_error, \a prefix and "is a folder" or "is no regular file": opening a pipe or a device may never
 * end. Descriptors of the process are allowed, such as `/dev/stdin` and those that a shell makes for `<(…)`. A missing
 * file is no error here.
 */
void require_readable(const std::filesystem::path &path, const std::string &prefix = {});

/** Content that is being written. Positions count bytes from 0. */
class Stream {
 public:
  /** \a file stays the caller's. \a path: for messages */
  Stream(std::FILE *file, const std::filesystem::path &path) : file_(file), path_(path) {}

  /** \throws Error, also if an earlier call failed */
  void write(const void *bytes, std::size_t size);
  void write(std::string_view text)
  {
    write(text.data(), text.size());
  }
  /** 0 if it is unknown, which check() reports: destructors of writers ask for it. */
  [[nodiscard]] std::uint64_t position();
  /** Continue at \a position. If it is before the end, the following bytes are overwritten. \throws Error, as write */
  void seek(std::uint64_t position);
  /** The next \a size bytes, which were written before. Call seek between writes and reads. \throws Error, as write */
  void read(void *bytes, std::size_t size);
  /** Report an earlier failure, for writers that lose exceptions. \throws Error if a call has failed */
  void check() const;

 private:
  void fail();

  std::FILE *file_;
  const std::filesystem::path &path_;
  /** The reason of the first failure, an error number of the system. */
  int error_ = 0;
};

enum class Flush {
  /** The content and its name are on the disk when the function returns. */
  Disk,
  /** For caches, whose readers recognise and discard damaged files. */
  None,
};

/**
 * Writes the bytes that \a write gives to a Stream. On any failure, and if the process ends at any moment, a regular
 * file has its old content, or does not exist if it did not before. Exceptions of \a write are passed on. Other outputs
 * get no byte unless \a write returns.
 *
 * \throws Error also for an existing file or folder without permission to write
 */
void write_file(const std::filesystem::path &path, const std::function<void(Stream &stream)> &write,
                Flush flush = Flush::Disk);
void write_file(const std::filesystem::path &path, std::string_view content, Flush flush = Flush::Disk);

/**
 * Checks before long work that write_file will find a folder and a file, or another output, that it may write to.
 * \throws Error
 */
void check_writable(const std::filesystem::path &path);

/**
 * Removes the temporary files that write_file left in \a folder because its process was killed, on file systems that
 * have no files without a name. Only those of files in \a names that a process of this machine has begun and that no
 * longer runs: other machines may write to the same folder.
 */
void remove_unfinished(const std::filesystem::path &folder, const std::set<std::string> &names);

/** Identity of the file that a path leads to. All spellings, links and hard links of a file have the same identity. */
struct FileId {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  /** Name of a file that does not exist; the numbers are then those of its folder. Empty for an existing file. */
  std::string name;

  std::strong_ordering operator<=>(const FileId &) const = default;
};

/** Empty where there is neither a file nor a folder for it, and for terminals, /dev/null and other character devices.
 */
[[nodiscard]] std::optional<FileId> file_id(const std::filesystem::path &path);

}  // namespace gnomon::output
