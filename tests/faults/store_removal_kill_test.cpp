#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

/// kill -9 while a robot is removed: it is there, or it is out; never a part of it.
namespace kinship::store::store_removal_kill_test {
namespace {

constexpr std::uint64_t kPaths = 700;  // of more than one transaction
constexpr int kKills = 14;

const RobotRecord& robot() {
  static const RobotRecord kRobot = test::make_robot("panda", 1);
  return kRobot;
}

void fill(const std::filesystem::path& file) {
  const std::unique_ptr<Store> store = open_sqlite_store(file);
  ASSERT_TRUE(store->register_robot(robot()));
  std::vector<Attempt> attempts;
  for (std::uint64_t number = 0; number < kPaths; ++number)
    attempts.push_back(test::make_attempt(robot().digest, "shelf", number));
  test::report(*store, std::move(attempts));
  store->put_distribution(test::make_distribution(robot().digest, "shelf", 5));
}

void remove_until_killed(const std::filesystem::path& file, std::chrono::microseconds life) {
  int ready[2] = {};
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const std::unique_ptr<Store> store = open_sqlite_store(file);
    if (write(ready[1], "r", 1) != 1)
      _exit(2);
    _exit(store->remove_robot(robot().digest) ? 0 : 3);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  std::this_thread::sleep_for(life);
  kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  close(ready[0]);
  close(ready[1]);
}

/// \return whether it is out.
bool check_whole(const std::filesystem::path& file) {
  const std::unique_ptr<Store> store = open_sqlite_store(file);
  const bool is_there = store->find_robot(robot().digest).has_value();
  const std::size_t in_use =
      store->read_paths(robot().digest, "shelf", {.after_id = 0, .limit = 10'000}).size();
  EXPECT_EQ(store->status().attempts, kPaths);
  EXPECT_EQ(store->list_paths({}, "", "", 10'000).rows.size(), kPaths);
  EXPECT_EQ(store->find_distribution(test::id_from<Digest>(5)).has_value(), is_there);
  EXPECT_EQ(store->status().robots, is_there ? 1U : 0U);
  EXPECT_EQ(store->status().paths, in_use);
  if (is_there) {
    EXPECT_TRUE(in_use == kPaths || in_use == kPaths - 500) << in_use;
    EXPECT_EQ(store->register_robot(test::make_robot("panda", 2)).error().code,
              ErrorCode::Conflict);
  } else {
    EXPECT_EQ(in_use, 0U);
  }
  return !is_there;
}

TEST(StoreRemovalKill, ARobotIsThereOrOut) {
  // However long a removal takes here: closer and closer to its end, from before and after.
  std::chrono::duration<double, std::milli> life(2);
  int out = 0;
  for (int kill = 0; kill < kKills; ++kill) {
    const test::TemporaryDirectory directory;
    const std::filesystem::path file = directory / "experience.db";
    fill(file);
    if (HasFatalFailure())
      return;
    remove_until_killed(file, std::chrono::duration_cast<std::chrono::microseconds>(life));
    if (HasFatalFailure())
      return;
    const bool is_out = check_whole(file);
    out += is_out ? 1 : 0;
    life *= is_out ? 0.85 : out == 0 ? 2 : 1.2;
    EXPECT_TRUE(check_store(file, [](double) {}).messages.empty());
  }
  EXPECT_GT(out, 0) << "every kill came before the removal";
  EXPECT_LT(out, kKills) << "every kill came after it";
}

}  // namespace
}  // namespace kinship::store::store_removal_kill_test
