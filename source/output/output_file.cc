// SPDX-License-Identifier: MIT
#include "output_file.hh"

#include <fcntl.h>
#include <linux/magic.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>
#include <memory>
#include <new>
#include <utility>

namespace gnomon::output {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path &path, int error)
{
  const std::string message = path.string() + ": cannot be written: " + std::strerror(error);
  switch (error) {
    case ENOSPC:
    case EDQUOT:
    case EIO:
    case ENOMEM:
    case EMFILE:
    case ENFILE:
    // Errors of folders on another machine.
    case ESTALE:
    case ETIMEDOUT: throw TransientError(message);
    default: throw Error(message);
  }
}

/**
 * Blocks SIGPIPE and SIGXFSZ on this thread during its lifetime. Writing to a pipe without a reader, or beyond the
 * limit of the size of files, then fails with a reason and does not end the process.
 */
class BlockedSignals {
 public:
  BlockedSignals()
  {
    sigset_t pending;
    sigpending(&pending);
    sigemptyset(&signals_);
    for (const int signal : {SIGPIPE, SIGXFSZ}) {
      if (sigismember(&pending, signal) == 0) {
        sigaddset(&signals_, signal);
      }
    }
    pthread_sigmask(SIG_BLOCK, &signals_, &mask_before_);
  }
  ~BlockedSignals()
  {
    // A signal that a write has caused would be delivered once it is no longer blocked.
    const timespec no_wait{};
    while (sigtimedwait(&signals_, nullptr, &no_wait) > 0) {
    }
    pthread_sigmask(SIG_SETMASK, &mask_before_, nullptr);
  }
  BlockedSignals(const BlockedSignals &) = delete;
  BlockedSignals &operator=(const BlockedSignals &) = delete;

 private:
  /** Signals that were not pending before. */
  sigset_t signals_{};
  sigset_t mask_before_{};
};

/** An open file descriptor. */
class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor()
  {
    if (value_ >= 0) {
      ::close(value_);
    }
  }
  Descriptor(const Descriptor &) = delete;
  Descriptor &operator=(const Descriptor &) = delete;

  /** Negative where opening it failed. */
  [[nodiscard]] int value() const
  {
    return value_;
  }

 private:
  int value_;
};

/** A path without a link at its end. */
struct Place {
  fs::path path;
  /** The descriptor of this process that the path names; negative: none. */
  int descriptor = -1;
  /** Without a value: there is nothing yet. */
  std::optional<struct stat> status{};

  [[nodiscard]] fs::path folder() const
  {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
  }
  /** Whether a file with a new content takes the place; otherwise, the content is written to the existing file. */
  [[nodiscard]] bool is_replaced() const
  {
    return descriptor < 0 && (!status || S_ISREG(status->st_mode));
  }
};

bool is_in_proc(const fs::path &folder)
{
  struct statfs system {};
  return ::statfs(folder.c_str(), &system) == 0 && system.f_type == PROC_SUPER_MAGIC;
}

/** The number N of /proc/self/fd/N, which /dev/stdout and /dev/fd/N lead to. Negative for all other paths. */
int descriptor_of(const fs::path &path)
{
  std::error_code error;
  const fs::path folder = fs::canonical(path.parent_path(), error);
  if (error || (folder != fs::canonical("/proc/self", error) / "fd" &&
                folder != fs::canonical("/proc/thread-self", error) / "fd")) {
    return -1;
  }
  const std::string name = path.filename().string();
  int number = -1;
  const auto [end, failed] = std::from_chars(name.data(), name.data() + name.size(), number);
  return failed == std::errc() && end == name.data() + name.size() ? number : -1;
}

/** Follows the links at the end of \a path. \return an error number of the system, or 0 */
int find_place(const fs::path &path, Place &place)
{
  // Linux follows at most this many links.
  constexpr int link_count_max = 40;
  place.path = path;
  for (int links = 0;; links++) {
    struct stat status {};
    if (::lstat(place.path.c_str(), &status) != 0) {
      return errno == ENOENT ? 0 : errno;
    }
    place.status = status;
    if (!S_ISLNK(status.st_mode)) {
      return 0;
    }
    if (links == link_count_max) {
      return ELOOP;
    }
    // Links in /proc lead to open files, which need not have a path.
    if (is_in_proc(place.folder())) {
      place.descriptor = descriptor_of(place.path);
      const bool is_own = place.descriptor >= 0;
      return (is_own ? ::fstat(place.descriptor, &*place.status) : ::stat(place.path.c_str(), &*place.status)) == 0
                 ? 0
                 : errno;
    }
    std::error_code error;
    // The path of an absolute link replaces the folder.
    place.path = place.folder() / fs::read_symlink(place.path, error);
    if (error) {
      return error.value();
    }
    place.status.reset();
  }
}

/** \return the reason why the process may not write to \a place, an error number of the system; 0: it may */
int refusal(const Place &place)
{
  if (place.descriptor >= 0) {
    return (::fcntl(place.descriptor, F_GETFL) & O_ACCMODE) == O_RDONLY ? EBADF : 0;
  }
  if (place.status) {
    if (S_ISDIR(place.status->st_mode)) {
      return EISDIR;
    }
    if (::access(place.path.c_str(), W_OK) != 0) {
      return errno;
    }
  }
  return !place.is_replaced() || ::access(place.folder().c_str(), W_OK | X_OK) == 0 ? 0 : errno;
}

/** \throws Error that names \a path */
Place writable_place(const fs::path &path)
{
  Place place;
  int error = find_place(path, place);
  error = error == 0 ? refusal(place) : error;
  if (error != 0) {
    fail(path, error);
  }
  return place;
}

/** Names of temporary files begin with this, which names the machine, and continue with the process and a number:
 * "12-3".
 */
std::string temporary_prefix(const std::string &name)
{
  // A name has at most 255 bytes, and that of a machine at most 64.
  constexpr std::size_t size_max = 150;
  std::array<char, 65> host{};
  static_cast<void>(::gethostname(host.data(), host.size() - 1));
  return '.' + name.substr(0, size_max) + '.' + host.data() + '.';
}

/** The new content of a regular file, which has a name in the same folder only where the system needs one. */
class Replacement {
 public:
  /** \throws Error that names \a path */
  Replacement(const Place &place, const fs::path &path) : place_(place), path_(path)
  {
    constexpr mode_t mode = 0666;
    constexpr int flags = O_RDWR | O_CLOEXEC;
    int descriptor = -1;
    // A file without a name vanishes with its process. Naming it needs /proc.
    if (::access("/proc/self/fd", X_OK) == 0) {
      descriptor = ::open(place.folder().c_str(), flags | O_TMPFILE, mode);
    }
    while (descriptor < 0) {
      name_ = next_name();
      descriptor = ::open(name_.c_str(), flags | O_CREAT | O_EXCL, mode);
      if (descriptor < 0 && errno != EEXIST) {
        const int error = errno;
        name_.clear();
        fail(path, error);
      }
    }
    file_.reset(::fdopen(descriptor, "w+"));
    if (!file_) {
      throw std::bad_alloc();
    }
  }
  ~Replacement()
  {
    file_.reset();
    if (!name_.empty()) {
      ::unlink(name_.c_str());
    }
  }
  Replacement(const Replacement &) = delete;
  Replacement &operator=(const Replacement &) = delete;

  [[nodiscard]] std::FILE *file() const
  {
    return file_.get();
  }

  /** \throws Error; then the old file is there */
  void take_place(Flush flush)
  {
    const int descriptor = ::fileno(file_.get());
    check(std::fflush(file_.get()));
    if (place_.status) {
      // Before the permissions, of which it clears some. Often only the superuser may set another owner.
      static_cast<void>(!::fchown(descriptor, place_.status->st_uid, place_.status->st_gid));
      check(::fchmod(descriptor, place_.status->st_mode & 07777U));
    }
    if (flush == Flush::Disk) {
      // EINVAL: the file system has nothing to flush.
      check(::fsync(descriptor) != 0 && errno != EINVAL ? -1 : 0);
    }
    if (name_.empty()) {
      const std::string unnamed = "/proc/self/fd/" + std::to_string(descriptor);
      for (;;) {
        fs::path name = next_name();
        if (::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) {
          name_ = std::move(name);
          break;
        }
        check(errno == EEXIST ? 0 : -1);
      }
    }
    check(::rename(name_.c_str(), place_.path.c_str()));
    name_.clear();
    if (flush == Flush::Disk) {
      const Descriptor folder(::open(place_.folder().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
      // A folder that may not be read cannot be flushed.
      check(folder.value() >= 0 && ::fsync(folder.value()) != 0 && errno != EINVAL ? -1 : 0);
    }
  }

 private:
  struct Close {
    void operator()(std::FILE *file) const
    {
      std::fclose(file);
    }
  };

  void check(int result) const
  {
    if (result != 0) {
      fail(path_, errno);
    }
  }
  fs::path next_name()
  {
    return place_.folder() / (temporary_prefix(place_.path.filename().string()) + std::to_string(::getpid()) + '-' +
                              std::to_string(number_++));
  }

  const Place &place_;
  const fs::path &path_;
  std::unique_ptr<std::FILE, Close> file_;
  /** Empty: the file has none. */
  fs::path name_;
  /** Other threads may write the same file. */
  int number_ = 0;
};

/** Content in memory, for outputs in which positions cannot be sought. */
class Memory {
 public:
  Memory() : file_(::fopencookie(this, "w+", {&read, &write, &seek, nullptr}))
  {
    if (!file_) {
      throw std::bad_alloc();
    }
  }
  ~Memory()
  {
    std::fclose(file_);
  }
  Memory(const Memory &) = delete;
  Memory &operator=(const Memory &) = delete;

  [[nodiscard]] std::FILE *file() const
  {
    return file_;
  }
  /** \throws std::bad_alloc */
  [[nodiscard]] const std::string &content()
  {
    if (std::fflush(file_) != 0) {
      throw std::bad_alloc();
    }
    return content_;
  }

 private:
  static ssize_t read(void *memory, char *bytes, std::size_t size)
  {
    auto &[content, position, file] = *static_cast<Memory *>(memory);
    const std::size_t first = std::min(position, content.size());
    size = std::min(size, content.size() - first);
    std::copy_n(content.begin() + std::ptrdiff_t(first), size, bytes);
    position += size;
    return ssize_t(size);
  }
  static ssize_t write(void *memory, const char *bytes, std::size_t size)
  {
    auto &[content, position, file] = *static_cast<Memory *>(memory);
    try {
      content.resize(std::max(content.size(), position + size));
    }
    catch (const std::exception &) {
      errno = ENOMEM;
      return 0;
    }
    std::copy_n(bytes, size, content.begin() + std::ptrdiff_t(position));
    position += size;
    return ssize_t(size);
  }
  static int seek(void *memory, off64_t *offset, int origin)
  {
    auto &[content, position, file] = *static_cast<Memory *>(memory);
    const auto base = off64_t(origin == SEEK_SET ? 0 : origin == SEEK_CUR ? position : content.size());
    if (base + *offset < 0) {
      errno = EINVAL;
      return -1;
    }
    *offset += base;
    position = std::size_t(*offset);
    return 0;
  }

  std::string content_;
  std::size_t position_ = 0;
  std::FILE *file_;
};

/** Writes to a pipe, a device or a descriptor. */
void write_through(const Place &place, const fs::path &path, std::string_view content)
{
  if (place.descriptor == STDOUT_FILENO) {
    // Buffered text was printed earlier, so it is written first.
    std::fflush(stdout);
  }
  const Descriptor target(place.descriptor >= 0 ? ::fcntl(place.descriptor, F_DUPFD_CLOEXEC, 0)
                                                : ::open(place.path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
  if (target.value() < 0) {
    fail(path, errno);
  }
  while (!content.empty()) {
    const ssize_t written = ::write(target.value(), content.data(), content.size());
    if (written >= 0) {
      content.remove_prefix(std::size_t(written));
    }
    else if (errno == EAGAIN) {
      pollfd ready{target.value(), POLLOUT, 0};
      ::poll(&ready, 1, -1);
    }
    else if (errno != EINTR) {
      fail(path, errno);
    }
  }
}

}  // namespace

void Stream::check() const
{
  if (error_ != 0) {
    output::fail(path_, error_);
  }
}

void Stream::fail()
{
  error_ = error_ == 0 ? errno : error_;
  check();
}

void Stream::write(const void *bytes, std::size_t size)
{
  check();
  if (std::fwrite(bytes, 1, size, file_) != size) {
    fail();
  }
}

std::uint64_t Stream::position()
{
  const off_t position = ::ftello(file_);
  if (position < 0) {
    error_ = error_ == 0 ? errno : error_;
    return 0;
  }
  return std::uint64_t(position);
}

void Stream::seek(std::uint64_t position)
{
  check();
  if (::fseeko(file_, off_t(position), SEEK_SET) != 0) {
    fail();
  }
}

void Stream::read(void *bytes, std::size_t size)
{
  check();
  errno = EIO;
  if (std::fread(bytes, 1, size, file_) != size) {
    fail();
  }
}

void write_file(const fs::path &path, const std::function<void(Stream &stream)> &write, Flush flush)
{
  const Place place = writable_place(path);
  const BlockedSignals blocked;
  if (place.is_replaced()) {
    Replacement replacement(place, path);
    Stream stream(replacement.file(), path);
    write(stream);
    stream.check();
    replacement.take_place(flush);
    return;
  }
  Memory memory;
  Stream stream(memory.file(), path);
  write(stream);
  stream.check();
  write_through(place, path, memory.content());
}

void write_file(const fs::path &path, std::string_view content, Flush flush)
{
  write_file(
      path, [&](Stream &stream) { stream.write(content); }, flush);
}

void check_writable(const fs::path &path)
{
  static_cast<void>(writable_place(path));
}

void remove_unfinished(const fs::path &folder, const std::set<std::string> &names)
{
  std::set<std::string> prefixes;
  for (const std::string &name : names) {
    prefixes.insert(temporary_prefix(name));
  }
  std::error_code ignored;
  for (const fs::directory_entry &entry : fs::directory_iterator(folder.empty() ? "." : folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const std::size_t dot = name.rfind('.');
    const char *const end = name.data() + name.size();
    pid_t process = 0;
    int number = 0;
    const auto [dash, process_error] = std::from_chars(name.data() + dot + 1, end, process);
    if (process_error != std::errc() || process <= 0 || dash == end || *dash != '-' ||
        std::from_chars(dash + 1, end, number).ptr != end || !prefixes.contains(name.substr(0, dot + 1))) {
      continue;
    }
    // Signal 0 only asks whether the process exists.
    if (::kill(process, 0) != 0 && errno == ESRCH) {
      fs::remove(entry.path(), ignored);
    }
  }
}

std::optional<FileId> file_id(const fs::path &path)
{
  Place place;
  if (find_place(path, place) != 0 || (place.status && S_ISCHR(place.status->st_mode))) {
    return std::nullopt;
  }
  if (place.status) {
    return FileId{place.status->st_dev, place.status->st_ino, {}};
  }
  struct stat folder {};
  if (::stat(place.folder().c_str(), &folder) != 0) {
    return std::nullopt;
  }
  return FileId{folder.st_dev, folder.st_ino, place.path.filename().string()};
}

void require_readable(const fs::path &path, const std::string &prefix)
{
  Place place;
  if (find_place(path, place) == 0 && place.status && place.descriptor < 0 && !S_ISREG(place.status->st_mode)) {
    throw std::runtime_error(prefix + (S_ISDIR(place.status->st_mode) ? "is a folder" : "is no regular file"));
  }
}

}  // namespace gnomon::output
