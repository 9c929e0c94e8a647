#include "server/store/sqlite/database/writer.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <atomic>
#include <future>
#include <optional>

#include "server/store/sqlite/database/call_item.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::writer_test {
namespace {

using namespace std::chrono_literals;

constexpr auto kTooLong = 30s;  // an event that has not come by then never comes

/// What became of an item, and in which commit.
struct Written {
  std::string error;      // empty: durable
  std::int64_t rows = 0;  // of table t before the item was applied
};

/// Inserts one row; a row that is there already is the item's own fault.
class InsertItem : public WriteItem {
 public:
  InsertItem(std::int64_t value, std::size_t weight) : value_(value), weight_(weight) {}

  std::future<Written> outcome() { return done_.get_future(); }
  std::size_t weight() const override { return weight_; }
  void apply(Batch& batch) override {
    rows_ = batch.database().integer("SELECT count(*) FROM t");
    batch.database().cached("INSERT INTO t VALUES (?, zeroblob(5000))")->bind(1, value_).run();
  }
  void finish(const Error* error) override {
    done_.set_value({error != nullptr ? error->message : "", rows_});
  }

 private:
  std::int64_t value_;
  std::size_t weight_;
  std::int64_t rows_ = 0;
  std::promise<Written> done_;
};

/// Meets content that SQLite makes no sense of, after which it refuses to write on in the batch.
class DamagedItem : public WriteItem {
 public:
  std::future<std::string> outcome() { return done_.get_future(); }
  void apply(Batch& batch) override {
    batch.database().cached("INSERT INTO t VALUES (1000, NULL)")->run();
    throw SqliteError(SQLITE_CORRUPT, "seen damaged");
  }
  void finish(const Error* error) override {
    done_.set_value(error != nullptr ? error->message : "");
  }

 private:
  std::promise<std::string> done_;
};

/// Finds no memory, to be written or to answer.
class HungryItem : public WriteItem {
 public:
  explicit HungryItem(bool finishes) : finishes_(finishes) {}
  std::future<std::string> outcome() { return done_.get_future(); }
  void apply(Batch& batch) override {
    batch.database().cached("INSERT INTO t VALUES (2000, NULL)")->run();
    throw std::bad_alloc();
  }
  void finish(const Error* error) override {
    if (!finishes_)
      throw std::bad_alloc();
    done_.set_value(error != nullptr ? error->message : "");
  }

 private:
  bool finishes_;
  std::promise<std::string> done_;
};

/// Holds the writer's thread inside a batch until it is let go.
class GateItem : public WriteItem {
 public:
  GateItem(std::promise<void>& entered, std::shared_future<void> open)
      : entered_(&entered), open_(std::move(open)) {}
  void apply(Batch& /*batch*/) override {
    entered_->set_value();
    open_.wait();
  }
  void finish(const Error* /*error*/) override {}

 private:
  std::promise<void>* entered_;
  std::shared_future<void> open_;
};

class WriterTest : public testing::Test {
 protected:
  WriterTest() {
    Database(file_, Access::Create)
        .execute("PRAGMA journal_mode = WAL; CREATE TABLE t (x INTEGER PRIMARY KEY, b BLOB)");
  }

  std::unique_ptr<Database> connect() {
    return std::make_unique<Database>(file_, Access::ReadWrite);
  }

  /// A disk with room for `pages` more pages.
  std::unique_ptr<Database> connect_to_small_disk(std::int64_t pages) {
    auto database = connect();
    const std::int64_t used = database->integer("PRAGMA page_count");
    database->execute("PRAGMA max_page_count = " + std::to_string(used + pages));
    return database;
  }

  std::unique_ptr<Writer> writer(std::unique_ptr<Database> first, Writer::Reopen reopen = {},
                                 std::chrono::milliseconds retry_after = 10ms) {
    if (!reopen)
      reopen = [this] { return connect(); };
    return std::make_unique<Writer>(std::move(first), std::move(reopen),
                                    WriterOptions{.batch_cap = 10, .retry_after = retry_after});
  }

  static std::future<Written> submit(Writer& writer, std::int64_t value, std::size_t weight = 1) {
    auto item = std::make_unique<InsertItem>(value, weight);
    std::future<Written> outcome = item->outcome();
    writer.submit(std::move(item));
    return outcome;
  }
  static Written get(std::future<Written> outcome) {
    if (outcome.wait_for(kTooLong) != std::future_status::ready)
      return {"no answer", 0};
    return outcome.get();
  }
  std::int64_t rows() { return connect()->integer("SELECT count(*) FROM t"); }

  const test::TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_ / "w.db";
};

TEST_F(WriterTest, FinishesAnItemWhenOthersCanReadIt) {
  const auto w = writer(connect());
  EXPECT_EQ(get(submit(*w, 1)).error, "");
  EXPECT_EQ(rows(), 1);
}

TEST_F(WriterTest, GoesOnWithoutMemoryForOneItem) {
  const auto w = writer(connect());
  for (const bool finishes : {true, false}) {
    auto hungry = std::make_unique<HungryItem>(finishes);
    std::future<std::string> outcome = hungry->outcome();
    w->submit(std::move(hungry));
    EXPECT_EQ(get(submit(*w, finishes ? 1 : 2)).error, "");
    if (finishes)
      EXPECT_EQ(outcome.get(), "no memory");
    else
      EXPECT_THROW(outcome.get(), std::future_error);  // it has no answer
  }
  EXPECT_EQ(rows(), 2);
  EXPECT_EQ(w->trouble(), "");
}

TEST_F(WriterTest, WhoWaitsForAnAnswerWithoutMemoryIsToldSo) {
  const auto make = [](Batch&) { return 1; };
  class Unanswered : public CallItem<decltype(make)> {
   public:
    using CallItem::CallItem;
    void finish(const Error*) override { throw std::bad_alloc(); }
  };
  const auto w = writer(connect());
  try {
    static_cast<void>(answer_to(*w, std::make_unique<Unanswered>(make)));
    FAIL() << "there was an answer";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Unavailable);
    EXPECT_STREQ(failure.what(), "no memory");
  }
}

TEST_F(WriterTest, CommitsTogetherWhatWaitedTogetherUpToTheCap) {
  const auto w = writer(connect());
  std::promise<void> entered;
  std::promise<void> gate;
  w->submit(std::make_unique<GateItem>(entered, gate.get_future().share()));
  entered.get_future().wait();
  std::vector<std::future<Written>> outcomes;
  for (std::int64_t i = 0; i < 4; ++i)
    outcomes.push_back(submit(*w, i, 4));  // cap 10: 2 + 2
  outcomes.push_back(submit(*w, 4, 25));   // heavier than a batch: alone
  EXPECT_EQ(w->queued(), 41U);
  gate.set_value();
  std::vector<std::int64_t> rows_before;
  for (auto& outcome : outcomes)
    rows_before.push_back(get(std::move(outcome)).rows);
  EXPECT_EQ(rows_before, (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(w->queued(), 0U);
}

TEST_F(WriterTest, UndoesAnItemWithABadRowAlone) {
  const auto w = writer(connect());
  EXPECT_EQ(get(submit(*w, 1)).error, "");
  EXPECT_NE(get(submit(*w, 1)).error.find("UNIQUE"), std::string::npos);
  EXPECT_EQ(w->trouble(), "");
  EXPECT_EQ(get(submit(*w, 2)).error, "");
  EXPECT_EQ(rows(), 2);
}

TEST_F(WriterTest, DamageUndoesTheItemThatMeetsItAndReopensNothing) {
  int reopened = 0;
  const auto w = writer(connect(), [&] {
    ++reopened;
    return connect();
  });
  std::promise<void> entered;
  std::promise<void> gate;
  w->submit(std::make_unique<GateItem>(entered, gate.get_future().share()));
  entered.get_future().wait();
  std::future<Written> before = submit(*w, 1);
  auto damaged = std::make_unique<DamagedItem>();
  std::future<std::string> said = damaged->outcome();
  w->submit(std::move(damaged));
  std::future<Written> after = submit(*w, 2);
  gate.set_value();
  EXPECT_EQ(said.get(), "seen damaged");
  EXPECT_EQ(get(std::move(before)).error, "");
  EXPECT_EQ(get(std::move(after)).error, "");
  EXPECT_EQ(w->trouble(), "");
  EXPECT_EQ(reopened, 0);
  EXPECT_EQ(rows(), 2);
}

TEST_F(WriterTest, WritesWhatIsQueuedBeforeItEnds) {
  std::vector<std::future<Written>> outcomes;
  {
    const auto w = writer(connect());
    for (std::int64_t i = 0; i < 100; ++i)
      outcomes.push_back(submit(*w, i));
  }
  for (auto& outcome : outcomes)
    EXPECT_EQ(get(std::move(outcome)).error, "");
  EXPECT_EQ(rows(), 100);
  EXPECT_FALSE(std::filesystem::exists(file_.string() + "-wal"));
}

TEST_F(WriterTest, AnswersAFullDiskReopensAndGoesOn) {
  int reopened = 0;
  const auto w = writer(connect_to_small_disk(5), [&] {
    ++reopened;
    return connect();
  });
  std::int64_t written = 0;
  Written outcome;
  for (; outcome.error.empty() && written < 100; ++written)
    outcome = get(submit(*w, written));
  EXPECT_NE(outcome.error.find("full"), std::string::npos) << outcome.error;
  EXPECT_EQ(get(submit(*w, 1000)).error, "");
  EXPECT_EQ(reopened, 1);
  EXPECT_EQ(rows(), written);  // all that were acknowledged before, not the refused one, one after
}

TEST_F(WriterTest, StaysInTroubleUntilAReopenSucceeds) {
  std::promise<void> recovered;
  int tries = 0;
  const auto w = writer(connect_to_small_disk(0), [&]() -> std::unique_ptr<Database> {
    if (++tries < 5)
      throw Failure(ErrorCode::Storage, "still broken");
    recovered.set_value();
    return connect();
  });
  EXPECT_NE(get(submit(*w, 1)).error, "");
  // No item comes, yet the writer tries again by itself.
  ASSERT_EQ(recovered.get_future().wait_for(kTooLong), std::future_status::ready);
  EXPECT_EQ(get(submit(*w, 2)).error, "");
  EXPECT_EQ(w->trouble(), "");
}

TEST_F(WriterTest, TriesToReopenOncePerRetryTimeHoweverManyItemsCome) {
  std::atomic<int> tries = 0;
  const auto reopen = [&]() -> std::unique_ptr<Database> {
    ++tries;
    throw Failure(ErrorCode::Storage, "still broken");
  };
  const auto w = writer(connect_to_small_disk(0), reopen, 1h);
  EXPECT_NE(get(submit(*w, 0)).error, "");
  for (std::int64_t i = 1; i <= 20; ++i)
    EXPECT_EQ(get(submit(*w, i)).error, "still broken");
  EXPECT_EQ(tries, 1);
}

TEST_F(WriterTest, WaitsTheRetryTimeAlsoWhenItFailsRightAfterAReopen) {
  std::atomic<int> tries = 0;
  const auto reopen = [&] {
    ++tries;
    return connect_to_small_disk(0);  // opens, but takes nothing
  };
  const auto w = writer(connect_to_small_disk(0), reopen, 1h);
  for (std::int64_t i = 0; i < 20; ++i)
    EXPECT_NE(get(submit(*w, i)).error.find("full"), std::string::npos);
  EXPECT_EQ(tries, 1);
}

TEST_F(WriterTest, AnswersItsItemsAlsoWhenItEndsInTrouble) {
  auto w = writer(connect_to_small_disk(0), []() -> std::unique_ptr<Database> {
    throw Failure(ErrorCode::Storage, "broken for good");
  });
  EXPECT_NE(get(submit(*w, 1)).error, "");
  std::future<Written> later = submit(*w, 2);
  w.reset();
  EXPECT_EQ(get(std::move(later)).error, "broken for good");
}

TEST_F(WriterTest, RaisesAGenerationOncePerBatch) {
  connect()->execute(
      "CREATE TABLE experience (task_id INTEGER, robot_id INTEGER, generation INTEGER,"
      " retired_generation INTEGER);"
      "INSERT INTO experience VALUES (1, 1, 0, 0), (1, 2, 0, 0)");
  const auto database = connect();
  Batch batch(*database);
  batch.paths_changed(1, 1);
  batch.paths_changed(1, 1);
  batch.raise_generations();
  EXPECT_EQ(database->integer("SELECT generation FROM experience WHERE robot_id = 1"), 1);
  EXPECT_EQ(database->integer("SELECT generation FROM experience WHERE robot_id = 2"), 0);
}

}  // namespace
}  // namespace kinship::store::writer_test
