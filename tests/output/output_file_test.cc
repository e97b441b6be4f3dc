// SPDX-License-Identifier: MIT
#include "output_file.hh"
#include "output_roles.hh"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thread>

namespace gnomon::output {
namespace {

namespace fs = std::filesystem;

class OutputFileTest : public testing::Test {
 protected:
  OutputFileTest()
  {
    std::string pattern = (fs::temp_directory_path() / "gnomon.XXXXXX").string();
    folder = mkdtemp(pattern.data());
  }
  ~OutputFileTest() override
  {
    fs::remove_all(folder);
  }
  static std::string content_of(const fs::path &path)
  {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  [[nodiscard]] std::size_t file_count() const
  {
    return std::size_t(std::distance(fs::directory_iterator(folder), {}));
  }
  static std::string failure(const fs::path &path, const std::string &content = "new")
  {
    try {
      write_file(path, content);
      return "";
    }
    catch (const Error &error) {
      return error.what();
    }
  }

  fs::path folder;
};

TEST_F(OutputFileTest, AFileIsOldOrWholeAndNothingIsLeftBesideIt)
{
  const fs::path path = folder / "file.txt";
  const auto fails = [&](Stream &stream) {
    stream.write("half");
    throw std::logic_error("the writer fails");
  };
  EXPECT_THROW(write_file(path, fails), std::logic_error);
  EXPECT_EQ(file_count(), 0U);
  write_file(path, "whole");
  EXPECT_THROW(write_file(path, fails), std::logic_error);
  EXPECT_EQ(content_of(path), "whole");
  EXPECT_EQ(file_count(), 1U);
  write_file(path, "");
  EXPECT_EQ(content_of(path), "");
}

TEST_F(OutputFileTest, PositionsCanBeSoughtInAllOutputs)
{
  const fs::path fifo = folder / "fifo";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0666), 0);
  std::string read;
  std::thread reader([&] { read = content_of(fifo); });
  for (const fs::path &path : {folder / "file", fifo}) {
    write_file(path, [](Stream &stream) {
      stream.write("0123456789");
      EXPECT_EQ(stream.position(), 10U);
      std::string written(8, ' ');
      stream.seek(1);
      stream.read(written.data(), written.size());
      EXPECT_EQ(written, "12345678");
      stream.seek(2);
      stream.write("ab");
    });
    EXPECT_THROW(write_file(folder / "short",
                            [](Stream &stream) {
                              stream.write("0123");
                              stream.seek(1);
                              std::string beyond(4, ' ');
                              stream.read(beyond.data(), beyond.size());
                            }),
                 Error);
  }
  reader.join();
  EXPECT_EQ(read, "01ab456789");
  EXPECT_EQ(content_of(folder / "file"), "01ab456789");
}

TEST_F(OutputFileTest, LinksAreFollowedAlsoToFilesThatDoNotExist)
{
  fs::create_directories(folder / "a");
  fs::create_directories(folder / "b");
  fs::create_symlink("../b/second", folder / "a" / "first");
  fs::create_symlink(folder / "b" / "target", folder / "b" / "second");
  for (const std::string content : {"one", "another"}) {
    write_file(folder / "a" / "first", content);
    EXPECT_TRUE(fs::is_symlink(folder / "a" / "first"));
    EXPECT_TRUE(fs::is_symlink(folder / "b" / "second"));
    EXPECT_FALSE(fs::is_symlink(folder / "b" / "target"));
    EXPECT_EQ(content_of(folder / "b" / "target"), content);
  }
  // A folder of the path may be a link.
  fs::create_directory_symlink(folder / "b", folder / "linked");
  write_file(folder / "linked" / "second", "third");
  EXPECT_EQ(content_of(folder / "b" / "target"), "third");
  fs::create_symlink("loop", folder / "loop");
  EXPECT_NE(failure(folder / "loop").find("symbolic links"), std::string::npos) << failure(folder / "loop");
  fs::create_symlink(folder / "absent" / "file", folder / "nowhere");
  EXPECT_NE(failure(folder / "nowhere").find("nowhere: cannot be written: No such file"), std::string::npos);
}

TEST_F(OutputFileTest, PipesAndDevicesStayWhatTheyAre)
{
  const fs::path fifo = folder / "fifo";
  const fs::path link = folder / "link";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0666), 0);
  fs::create_symlink("fifo", link);
  // More than a pipe holds.
  const std::string content(1 << 20, 'x');
  std::string read;
  std::thread reader([&] { read = content_of(fifo); });
  write_file(link, content);
  reader.join();
  EXPECT_EQ(read, content);
  EXPECT_TRUE(fs::is_fifo(fifo));
  EXPECT_TRUE(fs::is_symlink(link));
  fs::create_symlink("/dev/null", folder / "null");
  write_file(folder / "null", "nothing");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  fs::create_symlink("/dev/full", folder / "full");
  EXPECT_NE(failure(folder / "full").find("full: cannot be written: No space left"), std::string::npos);
  EXPECT_EQ(file_count(), 4U);
}

TEST_F(OutputFileTest, APipeWhoseReaderLeavesIsAnErrorAndNoSignal)
{
  const fs::path fifo = folder / "fifo";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0666), 0);
  std::thread reader([&] {
    const int pipe = open(fifo.c_str(), O_RDONLY);
    char byte = 0;
    EXPECT_EQ(::read(pipe, &byte, 1), 1);
    close(pipe);
  });
  EXPECT_NE(failure(fifo, std::string(1 << 20, 'x')).find("Broken pipe"), std::string::npos);
  reader.join();
}

TEST_F(OutputFileTest, DescriptorsAreContinued)
{
  const int file = open((folder / "log").c_str(), O_WRONLY | O_CREAT, 0666);
  ASSERT_EQ(write(file, "before ", 7), 7);
  write_file("/dev/fd/" + std::to_string(file), "in between");
  write_file("/proc/self/fd/" + std::to_string(file), ", again");
  ASSERT_EQ(write(file, " after", 6), 6);
  close(file);
  EXPECT_EQ(content_of(folder / "log"), "before in between, again after");
  const int read_only = open("/dev/null", O_RDONLY);
  EXPECT_NE(failure("/dev/fd/" + std::to_string(read_only)).find("Bad file descriptor"), std::string::npos);
  close(read_only);
  EXPECT_NE(failure("/dev/fd/999"), "");
}

TEST_F(OutputFileTest, PermissionsStay)
{
  const fs::path path = folder / "file";
  const mode_t before = umask(027);
  write_file(path, "one");
  umask(before);
  EXPECT_EQ(unsigned(fs::status(path).permissions()), 0640U);
  fs::permissions(path, fs::perms(0604));
  write_file(path, "another");
  EXPECT_EQ(unsigned(fs::status(path).permissions()), 0604U);
  if (geteuid() == 0) {
    ASSERT_EQ(chown(path.c_str(), 12, 34), 0);
    write_file(path, "a third");
    struct stat status {};
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_uid, 12U);
    EXPECT_EQ(status.st_gid, 34U);
  }
}

TEST_F(OutputFileTest, PlacesThatCannotBeWrittenAreNamedBeforeTheWork)
{
  fs::create_directory(folder / "folder");
  EXPECT_NE(failure(folder / "folder").find("Is a directory"), std::string::npos);
  EXPECT_NE(failure(folder / "absent" / "file").find("absent/file: cannot be written: No such file"),
            std::string::npos);
  EXPECT_THROW(check_writable(folder / "folder"), Error);
  EXPECT_THROW(check_writable(folder / "absent" / "file"), Error);
  EXPECT_THROW(check_writable(folder / "folder" / "file" / "below"), Error);
  EXPECT_NO_THROW(check_writable(folder / "folder" / "file"));
  // The longest name that a file may have leaves no room for a longer one beside it.
  const fs::path longest = folder / std::string(255, 'x');
  EXPECT_EQ(failure(longest), "");
  EXPECT_EQ(content_of(longest), "new");
  if (geteuid() != 0) {
    write_file(folder / "read_only", "kept");
    fs::permissions(folder / "read_only", fs::perms::owner_read);
    EXPECT_NE(failure(folder / "read_only").find("Permission denied"), std::string::npos);
    EXPECT_EQ(content_of(folder / "read_only"), "kept");
  }
  EXPECT_EQ(file_count(), geteuid() != 0 ? 3U : 2U);
}

TEST_F(OutputFileTest, EachWriteMayFailAndTheOldFileStays)
{
  const fs::path path = folder / "file";
  write_file(path, "old");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  for (const std::size_t limit : {0U, 1U, 4096U, 70000U}) {
    const rlimit small{limit, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const std::string text = failure(path, std::string(limit + 1, 'x'));
    // A writer that loses the exception.
    std::string lost;
    try {
      write_file(path, [&](Stream &stream) {
        try {
          for (std::size_t i = 0; i < 100; i++) {
            stream.write(std::string(1000, 'x'));
          }
        }
        catch (const Error &) {
          stream.seek(0);
        }
      });
    }
    catch (const Error &error) {
      lost = error.what();
    }
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    EXPECT_NE(text.find("file: cannot be written: File too large"), std::string::npos) << text;
    EXPECT_NE(lost.find("file: cannot be written: File too large"), std::string::npos) << lost;
    EXPECT_EQ(content_of(path), "old");
    EXPECT_EQ(file_count(), 1U);
  }
}

TEST_F(OutputFileTest, UnfinishedFilesOfDeadProcessesAreRemoved)
{
  // No process has this number: Linux has at most 4194304.
  std::array<char, 65> host{};
  ASSERT_EQ(gethostname(host.data(), host.size() - 1), 0);
  const std::string dead = std::string(".") + host.data() + ".4194999-0";
  const std::string running = std::string(".") + host.data() + "." + std::to_string(getpid()) + "-0";
  const std::string elsewhere = ".another-machine.4194999-0";
  const std::string long_name(255, 'x');
  for (const std::string &name : {".a.exr" + dead, ".b.exr" + dead, ".a.exr" + running, ".c.exr" + dead,
                                  ".a.exr" + elsewhere, "." + long_name.substr(0, 150) + dead}) {
    std::ofstream(folder / name) << "part";
  }
  remove_unfinished(folder, {"a.exr", "b.exr", long_name});
  EXPECT_EQ(file_count(), 3U);
  EXPECT_TRUE(fs::exists(folder / (".a.exr" + running)));
  EXPECT_TRUE(fs::exists(folder / (".a.exr" + elsewhere))) << "another machine may still write it";
  EXPECT_TRUE(fs::exists(folder / (".c.exr" + dead)));
}

TEST_F(OutputFileTest, ThreadsThatWriteOneFileLeaveOneOfTheirContents)
{
  const fs::path path = folder / "file";
  std::vector<std::thread> threads;
  for (const char letter : {'a', 'b', 'c', 'd'}) {
    threads.emplace_back([&path, letter] {
      for (int i = 0; i < 20; i++) {
        write_file(path, std::string(10000, letter), Flush::None);
      }
    });
  }
  for (std::thread &thread : threads) {
    thread.join();
  }
  const std::string content = content_of(path);
  EXPECT_EQ(content, std::string(10000, content.at(0)));
  EXPECT_EQ(file_count(), 1U);
}

TEST_F(OutputFileTest, AFileHasOneIdUnderAllOfItsNames)
{
  write_file(folder / "file", "x");
  fs::create_symlink("file", folder / "link");
  fs::create_hard_link(folder / "file", folder / "hard");
  fs::create_directory_symlink(folder, folder / "here");
  fs::create_symlink("later", folder / "dangling");
  for (const char *name : {"link", "hard", "./file", "here/file", "here/here/link"}) {
    EXPECT_EQ(file_id(folder / name), file_id(folder / "file")) << name;
  }
  EXPECT_EQ(file_id(folder / "dangling"), file_id(folder / "here" / "later"));
  EXPECT_NE(file_id(folder / "later"), file_id(folder / "latest"));
  EXPECT_NE(file_id(folder / "later"), file_id(folder / "file"));
  EXPECT_FALSE(file_id("/dev/null"));
  EXPECT_FALSE(file_id(folder / "absent" / "file"));
}

TEST_F(OutputFileTest, AFileHasOneRole)
{
  write_file(folder / "in", "x");
  fs::create_symlink("in", folder / "in_link");
  Roles roles;
  roles.add_input(folder / "in", "the scene");
  roles.add_input(folder / "in_link", "the world");
  roles.add_input(folder / "absent", "--report");
  roles.add_output(folder / "out", "-o");
  roles.add_output("", "--json");
  roles.add_output("/dev/null", "--json");
  roles.add_output("/dev/null", "--trace");
  EXPECT_THROW(roles.add_output(folder / "in_link", "-o"), Conflict);
  EXPECT_THROW(roles.add_output(folder / "." / "out", "--json"), Conflict);
  write_file(folder / "out", "x");
  fs::create_hard_link(folder / "out", folder / "late");
  // The id of an output that exists by now is another; inputs are named before the outputs are written.
  Roles later;
  later.add_output(folder / "out", "-o");
  EXPECT_THROW(later.add_input(folder / "late", "the scene's file"), Conflict);
}

}  // namespace
}  // namespace gnomon::output
