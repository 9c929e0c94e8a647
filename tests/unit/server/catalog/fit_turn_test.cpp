#include "server/catalog/fit_turn.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <thread>

#include "proto/types/failure.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/troubled_store.hpp"

namespace kinship::catalog::fit_turn_test {
namespace {

constexpr FitTurn::Patience kQuick{.longest = std::chrono::milliseconds(60'000),
                                   .between_looks = std::chrono::milliseconds(1)};

/// What the code of a failure says; nothing if there was none.
template <typename Call>
std::optional<ErrorCode> code_of(Call call) {
  try {
    call();
  } catch (const Failure& failure) {
    return failure.code();
  }
  return std::nullopt;
}

class FitTurnTest : public testing::Test {
 protected:
  /// Another server has the right for so many looks; then it is free.
  void busy_for(int looks) {
    store_.on_fit_right = [this, looks]() -> std::optional<store::FitRight> {
      if (++looks_ <= looks)
        return std::nullopt;
      return store::FitRight{.fence = 7};
    };
  }

  const test::TemporaryDirectory directory_;
  const std::unique_ptr<store::Store> real_ = store::open_sqlite_store(directory_ / "fleet.db");
  store::TroubledStore store_{*real_};
  const Digest id_{{1, 2, 3}};
  std::stop_source stop_;
  int looks_ = 0;
};

TEST_F(FitTurnTest, AServerThatIsAloneHasItAtOnceAndNobodyElseMadeAnything) {
  const FitTurn turn(store_, id_, stop_.get_token());
  EXPECT_FALSE(turn.has_others());
}

TEST_F(FitTurnTest, WaitsForAnotherServerAndGivesBackWhatItHas) {
  busy_for(3);
  {
    const FitTurn turn(store_, id_, stop_.get_token(), kQuick);
    EXPECT_EQ(looks_, 4);
    EXPECT_TRUE(turn.has_others());
    EXPECT_EQ(turn.right().fence, 7U);
    EXPECT_TRUE(store_.given_back().empty());
  }
  ASSERT_EQ(store_.given_back().size(), 1U);
  EXPECT_EQ(store_.given_back()[0], (std::pair{id_, std::uint64_t{7}}));
}

TEST_F(FitTurnTest, WhoStopsWhileItWaitsHasNothingToGiveBack) {
  store_.on_fit_right = [this]() -> std::optional<store::FitRight> {
    if (++looks_ == 2)
      stop_.request_stop();
    return std::nullopt;
  };
  EXPECT_EQ(code_of([&] { const FitTurn turn(store_, id_, stop_.get_token(), kQuick); }),
            ErrorCode::Unavailable);
  EXPECT_EQ(looks_, 2);
  EXPECT_TRUE(store_.given_back().empty());
}

TEST_F(FitTurnTest, AStopEndsTheWaitBeforeTheNextLook) {
  constexpr FitTurn::Patience kSlow{.longest = std::chrono::hours(1),
                                    .between_looks = std::chrono::hours(1)};
  std::jthread stopper;
  store_.on_fit_right = [&]() -> std::optional<store::FitRight> {
    stopper = std::jthread([this] { stop_.request_stop(); });
    return std::nullopt;
  };
  EXPECT_EQ(code_of([&] { const FitTurn turn(store_, id_, stop_.get_token(), kSlow); }),
            ErrorCode::Unavailable);
}

TEST_F(FitTurnTest, AnotherServerThatTakesTooLongIsWaitedForLater) {
  busy_for(1'000'000);
  EXPECT_EQ(code_of([&] {
              const FitTurn turn(store_, id_, stop_.get_token(),
                                 {.longest = std::chrono::milliseconds(5),
                                  .between_looks = std::chrono::milliseconds(1)});
            }),
            ErrorCode::Unavailable);
  EXPECT_TRUE(store_.given_back().empty());
}

TEST_F(FitTurnTest, AnErrorOfTheStoreEndsTheWait) {
  store_.on_fit_right = [this]() -> std::optional<store::FitRight> {
    if (++looks_ == 2)
      throw Failure(ErrorCode::Storage, "the database does not answer");
    return std::nullopt;
  };
  EXPECT_EQ(code_of([&] { const FitTurn turn(store_, id_, stop_.get_token(), kQuick); }),
            ErrorCode::Storage);
  EXPECT_TRUE(store_.given_back().empty());
}

}  // namespace
}  // namespace kinship::catalog::fit_turn_test
