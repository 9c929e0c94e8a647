#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace kinship::test {

inline std::filesystem::path disk_root() { return std::filesystem::temp_directory_path(); }

/// A folder in memory if there is one with 1 GB of room, unless TMPDIR says where to go. Stores are
/// synced after every batch, for which a test on a disk waits most of its time; a process that is
/// killed leaves the same files in both.
inline std::filesystem::path memory_root() {
  constexpr std::uintmax_t kRoom = std::uintmax_t{1} << 30U;
  const std::filesystem::path memory = "/dev/shm";
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(memory, error);
  const bool has_room = !error && space.available >= kRoom && ::access(memory.c_str(), W_OK) == 0;
  return has_room && !std::getenv("TMPDIR") ? memory : disk_root();
}

/// A directory of a test's own; gone with everything in it on destruction.
class TemporaryDirectory {
 public:
  /// \param root  disk_root() for what measures a disk.
  explicit TemporaryDirectory(const std::filesystem::path& root = memory_root()) {
    std::string name = (root / "kinship-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw std::runtime_error("mkdtemp: " + name);
    path_ = name;
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  const std::filesystem::path& path() const noexcept { return path_; }
  std::filesystem::path operator/(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace kinship::test
