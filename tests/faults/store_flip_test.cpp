#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <random>

#include "proto/types/failure.hpp"
#include "server/store/maintenance.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/faults/store_answers.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

/// Flipped bits anywhere in a store: what comes out is right or a refusal in words.
namespace kinship::store::store_flip_test {
namespace {

namespace fs = std::filesystem;
using test::Answers;

constexpr std::uint64_t kSeed = 20261123;

int trials_of(int usual) { return test::is_long_run() ? 20 * usual : usual; }

/// Something in every table; paths, a URDF and a distribution that take several pages.
test::StoredThings make_things() {
  test::StoredThings things;
  things.robots = {test::make_robot("iiwa", 2), test::make_robot("panda", 1)};
  things.robots[0].description.urdf += "<!--" + std::string(30'000, '-') + "-->";
  things.tasks = {"bin", "shelf"};
  for (std::uint64_t number = 0; number < 60; ++number) {
    const Digest& robot = things.robots[number % 2].digest;
    const std::string& task = things.tasks[number % 3 == 0 ? 0 : 1];
    Attempt attempt = number % 7 == 3 ? test::make_unsolved(robot, task, number)
                                      : test::make_attempt(robot, task, number);
    if (attempt.path)
      attempt.path = test::make_path(number, test::kDof, number % 10 == 0 ? 1500 : 60);
    attempt.record.collision_checks = 1000 + number;
    if (number % 4 == 0)
      attempt.scene = RecordedScene{
          {{"table", BoxShape{{1, 2, 0.1 + 0.01 * static_cast<double>(number % 8)}}}}, {}, {}};
    things.attempts.push_back(std::move(attempt));
  }
  things.attempts.push_back(things.attempts[1]);  // the same path under another UUID
  things.attempts.back().report_uuid = test::id_from<Uuid>(1000);
  for (std::uint64_t number = 0; number < 3; ++number)
    things.distributions.push_back(
        test::make_distribution(things.robots[0].digest, "shelf", 100 + number));
  return things;
}

void fill(Store& store, const test::StoredThings& things) {
  for (const RobotRecord& robot : things.robots)
    static_cast<void>(store.register_robot(robot).value_or_throw());
  test::report(store, things.attempts);
  for (const Distribution& distribution : things.distributions)
    store.put_distribution(distribution);
  static_cast<void>(store.retire_path(things.attempts[8].report_uuid).value_or_throw());
  store.put_distribution(test::make_distribution(things.robots[1].digest, "bin", 200));
  store.evict_distribution(test::id_from<Digest>(200));
}

void flip(const fs::path& file, std::uint64_t bit) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  const auto offset = static_cast<std::streamoff>(bit / 8);
  stream.seekg(offset);
  const int byte = stream.get();
  stream.seekp(offset);
  stream.put(static_cast<char>(byte ^ (1 << (bit % 8))));
  ASSERT_TRUE(stream.good());
}

/// Everything is given to the store again, as its clients would; what it refuses, it says.
/// \return whether all was taken.
bool send_again(Store& store, const test::StoredThings& things) {
  bool taken = true;
  for (const RobotRecord& robot : things.robots) {
    try {
      taken = store.register_robot(robot) && taken;
    } catch (const Failure&) {
      taken = false;
    }
  }
  for (const Receipt& receipt : test::report(store, things.attempts)) {
    taken = taken && receipt.status != ReceiptStatus::TryAgain &&
            receipt.status != ReceiptStatus::Refused;
    EXPECT_TRUE(receipt.status != ReceiptStatus::TryAgain || !receipt.message.empty());
  }
  for (const Distribution& distribution : things.distributions) {
    try {
      store.put_distribution(distribution);
    } catch (const Failure&) {
      taken = false;
    }
  }
  return taken;
}

class StoreFlip : public testing::Test {
 protected:
  StoreFlip() {
    const std::unique_ptr<Store> store = open_sqlite_store(template_);
    fill(*store, things_);
    right_ = test::ask_everything(*store, things_);
  }
  /// Of what is in use: a retired path is not brought back.
  Answers missing(const Answers& answers) const {
    Answers missing;
    for (const auto& [question, answer] : right_)
      if (!answers.contains(question) && !question.ends_with(retired_))
        missing.emplace(question, answer);
    return missing;
  }
  enum class Life { Refused, Partly, Whole };

  /// Opens the store, asks it, sends everything again and asks it again.
  /// \param is_named  a check has found damage: it has to if anything is missing.
  Life live(bool is_named) const {
    try {
      const std::unique_ptr<Store> store = open_sqlite_store(file_);
      const Answers first = test::ask_everything(*store, things_);
      EXPECT_EQ(test::wrong_ones(first, right_), kNone);
      EXPECT_TRUE(is_named || missing(first).empty())
          << testing::PrintToString(*missing(first).begin());
      const bool taken = send_again(*store, things_);
      const Answers again = test::ask_everything(*store, things_);
      EXPECT_EQ(test::wrong_ones(again, right_), kNone);
      return taken && missing(again).empty() ? Life::Whole : Life::Partly;
    } catch (const Failure& failure) {
      EXPECT_TRUE(is_named) << failure.what();
      return Life::Refused;  // and it said why
    }
  }
  void expect_repair_to_mend() const {
    const Repaired repaired = repair_store(file_, [](double) {});
    for (const std::string& message : repaired.check.messages)
      EXPECT_TRUE(message.starts_with("robot: ")) << message;
    {
      const std::unique_ptr<Store> store = open_sqlite_store(file_);
      Answers answers = test::ask_everything(*store, things_);
      // What was lost is not there, and the sums are of what is.
      std::erase_if(answers, [](const auto& answer) {
        return answer.first.starts_with("guided") || answer.first.starts_with("control") ||
               answer.second == "missing";
      });
      EXPECT_EQ(test::wrong_ones(answers, right_), kNone);
      EXPECT_TRUE(send_again(*store, things_));
      const Answers again = test::ask_everything(*store, things_);
      EXPECT_EQ(test::wrong_ones(again, right_), kNone);
      EXPECT_EQ(missing(again), Answers());
    }
    const StoreCheck check = check_store(file_, [](double) {});
    EXPECT_EQ(check.problems, 0U) << testing::PrintToString(check.messages);
    fs::remove(repaired.restored.replaced);
  }
  static inline const std::vector<std::string> kNone = {};

  bool is_named_by_check(const fs::path& file) const {
    try {
      return check_store(file, [](double) {}).problems > 0;
    } catch (const Failure&) {
      return true;
    }
  }

  std::vector<fs::path> rescued_copies() const {
    std::vector<fs::path> copies;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory_.path()))
      if (entry.path().string().find(".rescued-") != std::string::npos)
        copies.push_back(entry.path());
    return copies;
  }

  const test::TemporaryDirectory directory_;
  const fs::path template_ = directory_ / "template.db";
  const fs::path file_ = directory_ / "store.db";
  const test::StoredThings things_ = make_things();
  const std::string retired_ = things_.attempts[8].report_uuid.text();
  Answers right_;
  std::mt19937_64 generator_{kSeed};
};

TEST_F(StoreFlip, TheAnswersAreThoseOfASecondReading) {
  const std::unique_ptr<Store> store = open_sqlite_store(template_);
  const Answers again = test::ask_everything(*store, things_);
  EXPECT_TRUE(test::wrong_ones(again, right_).empty());
  EXPECT_TRUE(test::wrong_ones(right_, again).empty());
  EXPECT_GT(right_.size(), 250U);
}

TEST_F(StoreFlip, NoWrongAnswerComesOutOfAClosedStoreAndWhatIsLostComesBack) {
  const int trials = trials_of(150);
  int opened = 0, mended = 0;
  for (int trial = 0; trial < trials; ++trial) {
    fs::copy_file(template_, file_, fs::copy_options::overwrite_existing);
    const std::uint64_t bit = generator_() % (8 * fs::file_size(file_));
    SCOPED_TRACE("trial " + std::to_string(trial) + ", bit " + std::to_string(bit) + ", page " +
                 std::to_string(bit / 65536 + 1));
    flip(file_, bit);
    const Life life = live(is_named_by_check(file_));
    opened += life == Life::Refused ? 0 : 1;
    mended += life == Life::Whole ? 1 : 0;
    if (life != Life::Whole)
      expect_repair_to_mend();
    if (HasFailure())
      return;
  }
  std::cout << trials << " flips: " << opened << " opened, " << mended
            << " readable again after a resend, all others after a repair and a resend\n";
  EXPECT_GT(10 * opened, 8 * trials);
  EXPECT_GT(10 * mended, 4 * trials);
}

TEST_F(StoreFlip, NoWrongAnswerComesOutOfAnOpenStoresWalAndNoCheckpointBlessesIt) {
  const int trials = trials_of(40);
  for (int trial = 0; trial < trials; ++trial) {
    fs::remove(file_);
    {
      const std::unique_ptr<Store> store = open_sqlite_store(file_, {.new_store = true});
      fill(*store, things_);
      const fs::path wal = file_.string() + "-wal";
      const std::uint64_t bit = generator_() % (8 * fs::file_size(wal));
      SCOPED_TRACE("trial " + std::to_string(trial) + ", bit " + std::to_string(bit));
      flip(wal, bit);
      ASSERT_EQ(test::wrong_ones(test::ask_everything(*store, things_), right_), kNone);
      send_again(*store, things_);
    }  // a checkpoint
    if (live(is_named_by_check(file_)) != Life::Whole)
      expect_repair_to_mend();
    if (HasFailure())
      return;
    for (const fs::path& rescued : rescued_copies())  // two of one second would have one name
      fs::remove(rescued);
  }
}

}  // namespace
}  // namespace kinship::store::store_flip_test
