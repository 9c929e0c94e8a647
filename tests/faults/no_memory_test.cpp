// No memory: what asked for it is put off in words, the server stays, and no receipt is lost.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <tuple>

#include "tests/faults/served_store.hpp"

namespace kinship::no_memory_test {
namespace {

namespace fs = std::filesystem;
using test::ServedStore;

constexpr rlim_t kMega = rlim_t{1} << 20U;

/// Bytes of address space that a process has.
rlim_t address_space_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/statm");
  rlim_t pages = 0;
  file >> pages;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

/// The server gets no more than this beside what it has.
void leave(const test::ServerProcess& server, rlim_t bytes) {
  const rlimit limit{address_space_of(server.pid()) + bytes, RLIM_INFINITY};
  ASSERT_EQ(prlimit(server.pid(), RLIMIT_AS, &limit, nullptr), 0);
}

void leave_all(const test::ServerProcess& server) {
  const rlimit limit{RLIM_INFINITY, RLIM_INFINITY};
  ASSERT_EQ(prlimit(server.pid(), RLIMIT_AS, &limit, nullptr), 0);
}

/// A control group with a limit of memory, of either version.
class MemoryGroup {
 public:
  MemoryGroup() {
    for (const auto& [root, limit, events] :
         {std::tuple("/sys/fs/cgroup", "memory.max", "memory.events"),
          std::tuple("/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.oom_control")}) {
      const fs::path folder = fs::path(root) / ("kinship-test-" + std::to_string(getpid()));
      std::error_code error;
      fs::create_directory(folder, error);
      if (!error && fs::exists(folder / limit)) {
        folder_ = folder;
        limit_ = folder / limit;
        events_ = folder / events;
        return;
      }
      fs::remove(folder, error);
    }
  }
  MemoryGroup(const MemoryGroup&) = delete;
  MemoryGroup& operator=(const MemoryGroup&) = delete;
  ~MemoryGroup() {
    if (is_usable())
      rmdir(folder_.c_str());
  }

  bool is_usable() const { return !folder_.empty(); }
  /// \return whether the system took it.
  bool take_in(pid_t process, rlim_t bytes) const {
    return put(limit_, std::to_string(bytes)) &&
           put(folder_ / "cgroup.procs", std::to_string(process));
  }
  bool has_killed() const {
    std::istringstream words(test::read_text(events_));
    std::string word;
    while (words >> word)
      if (word == "oom_kill" && words >> word)
        return word != "0";
    return false;
  }

 private:
  static bool put(const fs::path& file, const std::string& text) {
    std::ofstream stream(file);
    stream << text << std::flush;
    return stream.good();
  }
  fs::path folder_, limit_, events_;
};

TEST(NoMemory, ThatTheSystemEndsTheServerForLosesNothing) {
  const MemoryGroup group;
  ServedStore store;
  if (!group.is_usable() || !group.take_in(store.cell().server().pid(), 8 * kMega))
    GTEST_SKIP() << "no control group of memory can be made here";
  store.report(30);
  for (int i = 0; i < 60 && !group.has_killed(); ++i) {
    store.offer_long();
    static_cast<void>(store.cell().client().flush(std::chrono::milliseconds(500)));
  }
  EXPECT_TRUE(group.has_killed());
  store.cell().kill();
  store.cell().start();
  EXPECT_TRUE(store.has_all_receipts());
  EXPECT_EQ(store.cell().terminate(), 0);
  EXPECT_EQ(store.missing(store.file()), 0U);
  EXPECT_EQ(store.offline("check").code, 0);
}

TEST(NoMemory, PutsOffWhatAsksForItAndLosesNothing) {
  ServedStore store({"--rehearsal-cpu", "1"});
  store.report(30);
  const pid_t process = store.cell().server().pid();
  leave(store.cell().server(), 2 * kMega);
  // Fits, paths of a quarter of a megabyte, listings and a backup, all at once.
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 8; ++i)
      store.offer_long();
    FetchRequest request;
    request.task = "sweep";
    request.robot = store.robot();
    request.deadline = std::chrono::seconds(1);
    static_cast<void>(store.cell().client().fetch(request));
    static_cast<void>(store.cell().client().admin(AdminRequest{}));
  }
  leave_all(store.cell().server());
  ASSERT_EQ(::kill(process, 0), 0);
  EXPECT_TRUE(store.has_all_receipts()) << store.cell().log();
  bool is_counted = false;
  for (const TroubleCount& trouble : store.cell().status().troubles)
    is_counted |= trouble.what == "out of memory" && trouble.count > 0;
  EXPECT_TRUE(is_counted) << store.cell().log();
  EXPECT_EQ(store.cell().server().pid(), process);
  EXPECT_EQ(store.cell().terminate(), 0) << store.cell().log();
  EXPECT_EQ(store.missing(store.file()), 0U);
  EXPECT_EQ(store.offline("check").code, 0);
}

}  // namespace
}  // namespace kinship::no_memory_test
