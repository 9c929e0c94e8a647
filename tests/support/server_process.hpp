#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kinship::test {

/// A program that runs beside the test: its standard output is read here, its standard error goes
/// into a file. Killed on destruction.
class Program {
 public:
  /// \param name         of a program of Kinship, in the folder of the build; or a path.
  /// \param arguments    without the program's name.
  /// \param error_file   appended to; empty: the test's own standard error.
  /// \throws std::runtime_error if it cannot be started.
  Program(const std::string& name, const std::vector<std::string>& arguments,
          const std::filesystem::path& error_file = {});
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  pid_t pid() const noexcept { return pid_; }
  std::string read_line();  ///< next line of its output; empty at the end of it
  std::string read_all();   ///< what is left of its output, up to its end
  bool has_output() const { return has_output_within(std::chrono::milliseconds(0)); }
  /// Waits for something to read, which may be the end.
  bool has_output_within(std::chrono::milliseconds patience) const;
  void signal(int number) const;
  void kill();  ///< SIGKILL; returns when it is gone
  bool has_ended() const;

  /// Waits for its end. \return exit code, or 128 + the signal that ended it.
  int wait();

 private:
  pid_t pid_ = -1;
  int output_ = -1;
  int status_ = 0;
  bool is_running_ = true;
};

/// What a program that ended left behind.
struct Answer {
  int code = -1;
  std::string out, err;

  bool says(const std::string& words) const { return (out + err).find(words) != std::string::npos; }
};

/// The words of a line, apart at blanks; one that begins with ' goes on to the next '.
std::vector<std::string> words(const std::string& line);

/// A program from its start to its end.
Answer run_to_end(const std::string& name, const std::vector<std::string>& arguments);

/// kinshipd as a process, from its readiness line on.
class ServerProcess {
 public:
  struct Options {
    std::filesystem::path store;  ///< or a URL
    std::uint32_t domain = 0;
    std::vector<std::string> arguments = {};  ///< further ones
    std::filesystem::path log = {};           ///< appended to; empty: <store>.log
  };

  /// Returns when it serves.
  /// \throws std::runtime_error with its log if it ends before that.
  explicit ServerProcess(const Options& options);

  const std::string& ready_line() const noexcept { return ready_line_; }
  pid_t pid() const noexcept { return program_.pid(); }
  void signal(int number) const { program_.signal(number); }
  bool has_ended() const { return program_.has_ended(); }

  int terminate();  ///< SIGTERM; \return exit code
  void kill();      ///< SIGKILL; returns when it is gone

 private:
  Program program_;
  std::string ready_line_;
};

/// The text of a file; empty if there is none.
std::string read_text(const std::filesystem::path& file);

}  // namespace kinship::test
