#include "server/quotas/token_bucket.hpp"

#include <gtest/gtest.h>

namespace kinship::quotas::token_bucket_test {
namespace {

using std::chrono::seconds;

class Bucket : public testing::Test {
 protected:
  double time_until(double amount) { return bucket_.time_until(rate_, amount, now_).count(); }
  void take(double amount) { bucket_.take(rate_, amount, now_); }

  Rate rate_{.per_s = 2, .burst = 10};
  TokenBucket::TimePoint now_{seconds(1000)};
  TokenBucket bucket_{rate_, now_};
};

TEST_F(Bucket, GivesABurstAndThenAsMuchAsComesIn) {
  EXPECT_EQ(time_until(10), 0);
  take(10);
  EXPECT_DOUBLE_EQ(time_until(1), 0.5);
  now_ += seconds(3);
  EXPECT_EQ(time_until(6), 0);
  EXPECT_DOUBLE_EQ(time_until(8), 1);
  now_ += seconds(1000);
  EXPECT_EQ(time_until(10), 0);
  take(10);
  EXPECT_GT(time_until(1), 0) << "it holds no more than a burst, however long nothing was taken";
}

TEST_F(Bucket, MoreThanItHoldsIsTakenWhenItIsFullAndOwedThen) {
  EXPECT_EQ(time_until(30), 0);
  take(30);
  EXPECT_DOUBLE_EQ(time_until(10), 15) << "20 owed and 10 missing, 2 a second";
  now_ += seconds(15);
  EXPECT_TRUE(bucket_.is_full(rate_, now_));
}

TEST_F(Bucket, AClockThatGoesBackGivesNothing) {
  take(10);
  now_ -= seconds(100);
  EXPECT_DOUBLE_EQ(time_until(1), 0.5);
}

TEST_F(Bucket, WithoutABurstThereIsNoLimit) {
  rate_ = {};
  take(1e12);
  EXPECT_EQ(time_until(1e12), 0);
  EXPECT_TRUE(bucket_.is_full(rate_, now_)) << "a client without limits may be forgotten";
}

}  // namespace
}  // namespace kinship::quotas::token_bucket_test
