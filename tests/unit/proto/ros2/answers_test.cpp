#include "proto/ros2/answers.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace kinship::ros2 {
namespace {

TEST(RosAnswers, HaveTheNodeAskAgainIfTheyHoldForNowOnly) {
  const Uuid report;
  const auto has_receipt = [&](ReceiptStatus status) {
    ReportReply reply;
    reply.receipts = {{report, status, ""}};
    return asks_again(to_receipt(reply, report).wire);
  };
  EXPECT_TRUE(has_receipt(ReceiptStatus::TryAgain));
  EXPECT_TRUE(asks_again(to_receipt(ReportReply{}, report).wire)) << "beyond a quota";
  EXPECT_FALSE(has_receipt(ReceiptStatus::Stored));
  EXPECT_FALSE(has_receipt(ReceiptStatus::Refused));

  const auto is_fetched = [&](FetchStatus status) {
    FetchReply reply;
    reply.status = status;
    return asks_again(to_answer(reply, report).wire);
  };
  EXPECT_TRUE(is_fetched(FetchStatus::Pending));
  EXPECT_TRUE(is_fetched(FetchStatus::Busy));
  EXPECT_FALSE(is_fetched(FetchStatus::NoExperience));
  EXPECT_FALSE(is_fetched(FetchStatus::Ready));

  RegisterReply registered;
  EXPECT_FALSE(asks_again(to_registered(registered, report, {}).wire));
  registered.retry_after = std::chrono::milliseconds(200);
  EXPECT_TRUE(asks_again(to_registered(registered, report, {}).wire));

  EXPECT_TRUE(asks_again(to_status(Error{ErrorCode::Unavailable, "quota"}, report).wire));
  ServerStatus status;
  status.version = "1";
  EXPECT_FALSE(asks_again(to_status(status, report).wire));
}

}  // namespace
}  // namespace kinship::ros2
