#pragma once

#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

namespace kinship::test {

/// A file system of a given size in a folder, in a mount namespace that this thread and the
/// processes it starts from now on share: nobody else sees it, and it goes with them.
class SmallFileSystem {
 public:
  SmallFileSystem(std::filesystem::path folder, const std::string& size)
      : folder_(std::move(folder)) {
    if (unshare(CLONE_NEWNS) == 0 &&
        mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
        mount("tmpfs", folder_.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0)
      is_mounted_ = true;
    else
      why_ = std::strerror(errno);
  }
  SmallFileSystem(const SmallFileSystem&) = delete;
  SmallFileSystem& operator=(const SmallFileSystem&) = delete;
  ~SmallFileSystem() {
    if (is_mounted_)
      umount2(folder_.c_str(), MNT_DETACH);
  }

  bool is_mounted() const { return is_mounted_; }
  const std::string& why() const { return why_; }  ///< it is not

  void resize(const std::string& size) const {
    if (mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT, ("size=" + size).c_str()) != 0)
      throw std::runtime_error(std::string("resizing a file system: ") + std::strerror(errno));
  }
  /// Names of all that is there, each after a space.
  std::string names() const {
    std::string names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      names += ' ' + entry.path().filename().string();
    return names;
  }

 private:
  std::filesystem::path folder_;
  bool is_mounted_ = false;
  std::string why_;
};

}  // namespace kinship::test
