#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

/// Random reports with many retries and repeated paths against a model that holds what the
/// contract says in three maps; the store is reopened now and then.
namespace kinship::store {
namespace {

constexpr std::uint64_t kSeed = 20261121;
constexpr std::uint64_t kUuids = 60;
constexpr std::uint64_t kContents = 12;
const std::vector<std::string> kTasks = {"bin", "shelf", "table"};

/// What identifies the body of a random report; content 0: unsolved.
struct Body {
  std::size_t robot = 0;
  std::size_t task = 0;
  std::uint64_t content = 0;
  auto operator<=>(const Body&) const = default;
};

class Model {
 public:
  ReceiptStatus add(std::uint64_t uuid, const Body& body) {
    if (const auto earlier = attempts_.find(uuid); earlier != attempts_.end())
      return earlier->second == body ? ReceiptStatus::Duplicate : ReceiptStatus::Refused;
    attempts_.emplace(uuid, body);
    if (body.content == 0)
      return ReceiptStatus::Recorded;
    if (!paths_[{body.robot, body.task}].insert(body.content).second)
      return ReceiptStatus::Duplicate;
    changed_.emplace(body.robot, body.task);
    return ReceiptStatus::Stored;
  }
  void commit() {
    for (const auto& pair : changed_)
      ++generations_[pair];
    changed_.clear();
  }

  std::uint64_t generation(std::size_t robot, std::size_t task) {
    return generations_[{robot, task}];
  }
  std::set<std::uint64_t>& paths(std::size_t robot, std::size_t task) {
    return paths_[{robot, task}];
  }
  std::size_t attempts() const { return attempts_.size(); }

 private:
  using Pair = std::pair<std::size_t, std::size_t>;
  std::map<std::uint64_t, Body> attempts_;
  std::map<Pair, std::set<std::uint64_t>> paths_;
  std::map<Pair, std::uint64_t> generations_;
  std::set<Pair> changed_;
};

class StoreModel : public testing::Test {
 protected:
  void open() {
    store_.reset();
    store_ = open_sqlite_store(directory_ / "s.db");
  }
  Body random_body() {
    return {generator_() % robots_.size(), generator_() % kTasks.size(), generator_() % kContents};
  }
  Attempt attempt(std::uint64_t uuid, const Body& body) const {
    const Digest& robot = robots_[body.robot].digest;
    Attempt made = body.content == 0 ? test::make_unsolved(robot, kTasks[body.task], uuid)
                                     : test::make_attempt(robot, kTasks[body.task], uuid);
    if (body.content != 0)
      made.path = test::make_path(body.content);
    return made;
  }
  void check_all() {
    EXPECT_EQ(store_->status().attempts, model_.attempts());
    for (std::size_t robot = 0; robot < robots_.size(); ++robot)
      for (std::size_t task = 0; task < kTasks.size(); ++task) {
        const Digest& digest = robots_[robot].digest;
        EXPECT_EQ(store_->generation(digest, kTasks[task]), model_.generation(robot, task));
        const auto stored =
            store_->read_paths(digest, kTasks[task], {.after_id = 0, .limit = 1000});
        EXPECT_EQ(stored.size(), model_.paths(robot, task).size());
        for (const std::uint64_t content : model_.paths(robot, task))
          EXPECT_TRUE(std::ranges::any_of(stored, [&](const StoredPath& path) {
            return path.path.waypoints() == test::make_path(content).waypoints();
          })) << content;
      }
  }

  std::mt19937_64 generator_{kSeed};
  const test::TemporaryDirectory directory_;
  const std::vector<RobotRecord> robots_ = {test::make_robot("panda", 1),
                                            test::make_robot("iiwa", 2)};
  std::unique_ptr<Store> store_;
  Model model_;
};

TEST_F(StoreModel, EveryReceiptAndEveryReadingIsAsTheContractSays) {
  open();
  for (const RobotRecord& robot : robots_)
    ASSERT_TRUE(store_->register_robot(robot));
  std::map<std::uint64_t, Body> bodies;
  for (int batch = 0; batch < 120; ++batch) {
    std::vector<Attempt> attempts;
    std::vector<ReceiptStatus> expected;
    for (std::uint64_t i = generator_() % 6; i > 0; --i) {
      const std::uint64_t uuid = generator_() % kUuids;
      const Body body = generator_() % 10 == 0
                            ? random_body()  // mostly another body: refused
                            : bodies.try_emplace(uuid, random_body()).first->second;
      attempts.push_back(attempt(uuid, body));
      expected.push_back(model_.add(uuid, body));
    }
    model_.commit();
    ASSERT_EQ(test::statuses(test::report(*store_, std::move(attempts))), expected) << batch;
    if (generator_() % 10 == 0)
      open();
    if (batch % 20 == 19)
      check_all();
  }
}

}  // namespace
}  // namespace kinship::store
