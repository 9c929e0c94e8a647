#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>

namespace kinship::experiments {

/// A kinshipd of this program's own, from its readiness to its end.
class ServerProcess {
 public:
  struct Options {
    std::filesystem::path program;  ///< kinshipd
    std::filesystem::path store;    ///< its folder must exist; the log goes beside it, <store>.log
    std::uint32_t domain = 0;
    int workers = 1;  ///< threads that transfer and fit; nothing else is meant to run
  };

  /// Returns when it serves.
  /// \throws Failure(NotFound) if there is no such program, Failure(Unavailable) that names the log
  ///         if it ends before it serves.
  explicit ServerProcess(const Options& options);
  ~ServerProcess();  ///< SIGTERM, and waits for its end
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

 private:
  int wait_for_end();

  pid_t pid_ = -1;
  int output_ = -1;
};

/// The program of this name beside the running one.
std::filesystem::path sibling_program(const char* name);

}  // namespace kinship::experiments
