// A server that ends for want of memory says so, and loses no receipt.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
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

/// The process gets no more addresses than it has.
bool leave_no_more(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/statm");
  rlim_t pages = 0;
  file >> pages;
  const rlimit limit{pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)), RLIM_INFINITY};
  return pages > 0 && prlimit(process, RLIMIT_AS, &limit, nullptr) == 0;
}

TEST(NoMemory, OfAddressesEndsTheServerInWordsOrPutsOff) {
  ServedStore store;
  store.report(30);
  const test::ServerProcess& server = store.cell().server();
  ASSERT_TRUE(leave_no_more(server.pid()));
  bool has_all = false;
  for (int i = 0; i < 60 && !server.has_ended(); ++i) {
    store.offer_long();
    has_all = store.cell().client().flush(std::chrono::milliseconds(500)).pending == 0;
  }
  if (server.has_ended()) {
    EXPECT_EQ(store.cell().terminate(), 128 + SIGABRT);
    EXPECT_NE(store.cell().log().find("kinshipd: ended by itself"), std::string::npos)
        << store.cell().log();
    store.cell().start();
  } else {
    EXPECT_TRUE(has_all) << "it lives, and answers nothing\n" << store.cell().log();
  }
  EXPECT_TRUE(store.has_all_receipts());
  EXPECT_EQ(store.cell().terminate(), 0);
  EXPECT_EQ(store.missing(store.file()), 0U);
  EXPECT_EQ(store.offline("check").code, 0);
}

}  // namespace
}  // namespace kinship::no_memory_test
