#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace kinship::test {

/// What a program may ask a disk to change; bits of a mask.
enum class DiskCall : unsigned { Write = 1, Truncate = 2, Sync = 4, Name = 8, SyncDirectory = 16 };
inline constexpr unsigned kEveryDiskCall = 31;
constexpr unsigned operator|(DiskCall a, DiskCall b) {
  return static_cast<unsigned>(a) | static_cast<unsigned>(b);
}

/// Some calls from now on fail; then the disk is well again.
struct DiskFault {
  unsigned calls = kEveryDiskCall;  ///< which of them are meant
  std::uint64_t first = 0;  ///< the first that fails, counting those that are meant from now
  std::uint64_t count = 1;  ///< how many in a row fail
  int error = EIO;          ///< what they say
  std::string name = {};    ///< only calls on the file made under this name; empty: on all
};

/// The files of one directory, by name.
using DiskImage = std::map<std::string, std::vector<std::uint8_t>>;

/// The disk under one directory of this process. What is written goes to the real file, which is
/// the page cache and what is read; beside that the disk keeps what is durable of each file, and
/// what a power cut at this instant could leave.
///
/// Follows Linux: only fsync makes bytes durable, only fsync of the directory makes names durable
/// (they become so in the order of their changes), and pages of a failed fsync become clean: they
/// are read as long as the process lives, and are on no disk unless they are written again.
///
/// The calls come from disk_calls.cpp, which stands in front of the C library. One disk at a time;
/// files made in its directory before count as durable; folders in it are no part of it. SQLite's
/// shared memory (-shm) is not: nothing of it outlives a process.
class SimulatedDisk {
 public:
  SimulatedDisk(const std::filesystem::path& directory, std::uint64_t seed);
  SimulatedDisk(const SimulatedDisk&) = delete;
  SimulatedDisk& operator=(const SimulatedDisk&) = delete;
  ~SimulatedDisk();

  /// \param before  called before each change with its number, from 0, while all other changes
  ///                wait. It may ask for an image(); it must not write.
  void on_change(std::function<void(std::uint64_t)> before);
  std::uint64_t changes() const;  ///< so far

  void lie(bool lies);  ///< fsync says yes and does nothing, like a disk with a careless cache
  void fail(const DiskFault& fault);
  std::uint64_t failed() const;            ///< calls that failed by fail()
  void set_capacity(std::uint64_t bytes);  ///< of all files; what would need more fails: ENOSPC
  std::uint64_t used() const;              ///< bytes of all files

  /// What is there after a power cut now: of what is not durable, nothing, everything, or of each
  /// write all, none or some of its sectors of 512 bytes.
  DiskImage image();

  // What disk_calls.cpp asks, each with the call that does it for real.
  using Call = std::function<long()>;
  static SimulatedDisk* active() noexcept;
  long open(const char* name, int flags, const Call& call);
  long write(int file, const void* bytes, std::size_t size, std::int64_t at, const Call& call);
  long truncate(int file, std::int64_t size, const Call& call);
  long allocate(int file, std::int64_t size, const Call& call);  ///< returns errno
  long sync(int file, const Call& call);
  long unlink(const char* name, const Call& call);
  long rename(const char* from, const char* to, bool exchange, const Call& call);
  long link(const char* from, const char* to, const Call& call);
  std::optional<std::uint64_t> room(const char* name) const;  ///< none: as the real disk says

 private:
  struct Change {
    bool truncates = false;
    std::uint64_t at = 0;  // or the new size
    std::vector<std::uint8_t> bytes;
  };
  struct File {
    std::string name;  // that it was made under
    std::uint64_t size = 0;
    std::vector<std::uint8_t> durable;
    std::vector<Change> pending;
  };
  using Names = std::map<std::string, std::shared_ptr<File>>;
  enum class Kept { Nothing, Everything, Some };

  std::shared_ptr<File> adopt(const std::filesystem::path& path);
  std::shared_ptr<File> find(int file) const;
  std::optional<std::string> name_here(const char* name) const;
  int begin(DiskCall call, const std::string& name);
  bool has_room(const File& file, std::uint64_t size) const;
  void rename_to(Names names);
  void apply(std::vector<std::uint8_t>& bytes, const Change& change, Kept kept);
  void lose_pending(File& file);

  const std::filesystem::path directory_;
  std::uint64_t inode_ = 0;  // of the directory
  mutable std::recursive_mutex mutex_;
  std::mt19937_64 generator_;                             // guarded by mutex_, like all below
  std::map<std::uint64_t, std::shared_ptr<File>> files_;  // by inode
  std::vector<Names>
      names_;  // since the directory was synced: the first is durable, the last is now
  std::function<void(std::uint64_t)> before_;
  std::uint64_t changes_ = 0;
  bool lies_ = false;
  std::optional<DiskFault> fault_;
  std::uint64_t meant_ = 0;  // calls that the fault means
  std::uint64_t failed_ = 0;
  std::uint64_t capacity_ = UINT64_MAX;
};

}  // namespace kinship::test
