#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <tuple>

#include "server/store/postgres/postgres_store.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "server/store/values/prepared_attempt.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/store/postgres/fresh_database.hpp"

/// Random reports with many retries and repeated paths against a model that holds what the
/// contract says in a few maps, on each engine; the store is reopened now and then.
namespace kinship::store::store_model_test {
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

/// The order in which a capped store keeps contents: by the digest of the path, at the placement
/// that all attempts here have.
Digest rank_of(std::uint64_t content) {
  Attempt attempt = test::make_attempt(Digest(), kTasks[0], 1);
  attempt.path = test::make_path(content);
  return prepare(std::move(attempt)).value().path->content;
}

class Model {
 public:
  /// \param cap  of paths per robot and task; 0: none.
  explicit Model(std::size_t cap) : cap_(cap) {}

  ReceiptStatus add(std::uint64_t uuid, const Body& body) {
    if (const auto earlier = attempts_.find(uuid); earlier != attempts_.end())
      return earlier->second == body ? ReceiptStatus::Duplicate : ReceiptStatus::Refused;
    attempts_.emplace(uuid, body);
    if (body.content == 0)
      return ReceiptStatus::Recorded;
    std::set<std::uint64_t>& kept = paths_[{body.robot, body.task}];
    if (kept.contains(body.content))
      return ReceiptStatus::Duplicate;  // of the path that is in use
    if (cap_ > 0 && kept.size() == cap_) {
      const std::uint64_t last = *std::ranges::max_element(kept, {}, rank_of);
      ++dropped_;
      if (rank_of(last) < rank_of(body.content)) {
        never_kept_.insert(uuid);
        return ReceiptStatus::Recorded;
      }
      kept.erase(last);
      for (const auto& [other, other_body] : attempts_)
        if (other_body == Body{body.robot, body.task, last})
          retired_reports_.insert(other);
    }
    kept.insert(body.content);
    changed_.emplace(body.robot, body.task);
    return ReceiptStatus::Stored;
  }
  /// \return how many paths it retires; nothing if the report is unknown or brought none.
  std::optional<std::size_t> retire(std::uint64_t uuid) {
    const auto found = attempts_.find(uuid);
    if (found == attempts_.end() || found->second.content == 0 || never_kept_.contains(uuid))
      return std::nullopt;
    // A report stands for the path of its content that was in use when it came.
    const Body& body = found->second;
    if (retired_reports_.contains(uuid))
      return 0;
    for (const auto& [other, other_body] : attempts_)
      if (other_body == body)
        retired_reports_.insert(other);
    paths_[{body.robot, body.task}].erase(body.content);
    raise_retired({body.robot, body.task});
    return 1;
  }
  std::size_t reset(std::size_t task) {
    std::size_t count = 0;
    for (auto& [pair, contents] : paths_)
      if (pair.second == task && !contents.empty()) {
        count += contents.size();
        contents.clear();
        raise_retired(pair);
      }
    for (const auto& [uuid, body] : attempts_)
      if (body.task == task)
        retired_reports_.insert(uuid);
    return count;
  }
  void commit() {
    for (const auto& pair : changed_)
      ++generations_[pair];
    changed_.clear();
  }
  std::uint64_t retired_generation(std::size_t robot, std::size_t task) {
    return retired_generations_[{robot, task}];
  }

  std::uint64_t generation(std::size_t robot, std::size_t task) {
    return generations_[{robot, task}];
  }
  std::set<std::uint64_t>& paths(std::size_t robot, std::size_t task) {
    return paths_[{robot, task}];
  }
  std::size_t attempts() const { return attempts_.size(); }
  std::size_t dropped() const { return dropped_; }

 private:
  using Pair = std::pair<std::size_t, std::size_t>;

  void raise_retired(const Pair& pair) { retired_generations_[pair] = ++generations_[pair]; }

  std::size_t cap_;
  std::size_t dropped_ = 0;             // paths, in all
  std::set<std::uint64_t> never_kept_;  // reports beyond the cap
  std::map<std::uint64_t, Body> attempts_;
  std::map<Pair, std::set<std::uint64_t>> paths_;
  std::map<Pair, std::uint64_t> generations_;
  std::map<Pair, std::uint64_t> retired_generations_;
  std::set<std::uint64_t> retired_reports_;  // their path is retired
  std::set<Pair> changed_;
};

enum class Engine { Sqlite, Postgres };

/// The engine, and the cap of paths per robot and task; 0: none.
class StoreModel : public testing::TestWithParam<std::tuple<Engine, std::size_t>> {
 protected:
  Engine engine() const { return std::get<0>(GetParam()); }
  std::size_t cap() const { return std::get<1>(GetParam()); }
  void SetUp() override {
    if (const std::string missing = test::missing_postgres();
        engine() == Engine::Postgres && !missing.empty())
      GTEST_SKIP() << missing;
  }
  void open() {
    store_.reset();
    store_ = engine() == Engine::Sqlite
                 ? open_sqlite_store(directory_ / "s.db", {.max_paths_per_pair = cap()})
                 : open_postgres_store(FreshDatabases::of_program().url(directory_.path()),
                                       {.max_paths_per_pair = cap()});
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
    EXPECT_EQ(store_->status().dropped_paths, model_.dropped());
    for (std::size_t robot = 0; robot < robots_.size(); ++robot)
      for (std::size_t task = 0; task < kTasks.size(); ++task) {
        const Digest& digest = robots_[robot].digest;
        EXPECT_EQ(store_->generation(digest, kTasks[task]), model_.generation(robot, task));
        for (const ExperienceSummary& summary : store_->experience(kTasks[task]))
          if (summary.robot == digest) {
            EXPECT_EQ(summary.paths, model_.paths(robot, task).size());
            EXPECT_EQ(summary.retired_generation, model_.retired_generation(robot, task));
          }
        const auto stored =
            store_->read_paths(digest, kTasks[task], {.after_id = 0, .limit = 1000});
        EXPECT_EQ(stored.size(), model_.paths(robot, task).size());
        for (const std::uint64_t content : model_.paths(robot, task))
          EXPECT_TRUE(std::ranges::any_of(stored, [&](const StoredPath& path) {
            return path.path.waypoints() == test::make_path(content).waypoints();
          })) << content;
      }
  }

  void retire_one(std::uint64_t uuid) {
    const Result<Retirement> retired = store_->retire_path(test::id_from<Uuid>(uuid));
    const std::optional<std::size_t> expected = model_.retire(uuid);
    ASSERT_EQ(retired.has_value(), expected.has_value());
    EXPECT_EQ(expected ? retired->paths : 0, expected.value_or(0));
    EXPECT_EQ(expected ? retired->robots.size() : 0, expected.value_or(0));
  }
  void reset_one(std::size_t task) {
    const Result<Retirement> reset = store_->reset_task(kTasks[task]);
    if (!reset)
      return;  // nobody has reported it yet
    EXPECT_EQ(reset->paths, model_.reset(task));
  }

  std::mt19937_64 generator_{kSeed};
  const test::TemporaryDirectory directory_;
  const std::vector<RobotRecord> robots_ = {test::make_robot("panda", 1),
                                            test::make_robot("iiwa", 2)};
  std::unique_ptr<Store> store_;
  Model model_{cap()};
};

std::string name_of_case(const testing::TestParamInfo<StoreModel::ParamType>& info) {
  const auto [engine, cap] = info.param;
  return (engine == Engine::Sqlite ? "Sqlite" : "Postgres") + std::to_string(cap);
}
INSTANTIATE_TEST_SUITE_P(WithCaps, StoreModel,
                         testing::Combine(testing::Values(Engine::Sqlite, Engine::Postgres),
                                          testing::Values(0, 1, 3)),
                         name_of_case);

TEST_P(StoreModel, EveryReceiptAndEveryReadingIsAsTheContractSays) {
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
    if (generator_() % 4 == 0)
      retire_one(generator_() % kUuids);
    if (generator_() % 30 == 0)
      reset_one(generator_() % kTasks.size());
    if (generator_() % 10 == 0)
      open();
    if (batch % 20 == 19)
      check_all();
  }
}

}  // namespace
}  // namespace kinship::store::store_model_test
