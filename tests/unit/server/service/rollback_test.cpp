// A server that learns from a client that its store was rolled back.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "tests/support/server_process.hpp"
#include "tests/unit/server/service/service_fixture.hpp"

namespace kinship::service::rollback_test {
namespace {

class RolledBack : public ServiceFixture {
 protected:
  /// The store as it was before the last report, whose token is kept.
  void SetUp() override {
    report(fleet::solved(teacher_, "shelf", 6, 1));
    fetch(request_for(pupil_));
    service_.reset();
    std::map<std::string, std::string> before;
    for (const char* const suffix : {"", ".high-water-mark"})
      before[suffix] = test::read_text(file_.string() + suffix);
    start();
    const ReportReply reply = report({fleet::solved(teacher_, "shelf", 50)});
    epoch_ = reply.store_epoch;
    lost_ = reply.consistency_token;
    service_.reset();
    for (const auto& [suffix, bytes] : before)
      std::ofstream(file_.string() + suffix, std::ios::binary | std::ios::trunc) << bytes;
    start();
  }
  ReportReply say(const ConsistencyToken& token, std::vector<Attempt> attempts = {}) {
    std::promise<ReportReply> reply;
    service_->reports().report({std::move(attempts), {}, token},
                               [&](const ReportReply& r) { reply.set_value(r); });
    return reply.get_future().get();
  }

  const std::filesystem::path file_ = directory_ / "fleet.db";
  Uuid epoch_;
  ConsistencyToken lost_;
};

TEST_F(RolledBack, IsToldByAGreetingAndBeginsAnEpochOnce) {
  EXPECT_EQ(service_->status().store_epoch, epoch_);
  const ReportReply reply = say(lost_);
  EXPECT_NE(reply.store_epoch, epoch_);
  EXPECT_TRUE(reply.receipts.empty());
  EXPECT_FALSE(reply.consistency_token.empty());
  EXPECT_EQ(service_->status().store_epoch, reply.store_epoch);
  EXPECT_EQ(service_->status().rollbacks, 1U);
  EXPECT_NE(log().find("rolled back behind receipts"), std::string::npos) << log();
  EXPECT_TRUE(is_told("rolled back behind receipts"));
  for (const ConsistencyToken& token :
       {lost_, reply.consistency_token, ConsistencyToken{}, ConsistencyToken(40, 7)})
    EXPECT_EQ(say(token).store_epoch, reply.store_epoch);
  EXPECT_EQ(service_->status().rollbacks, 1U);
}

TEST_F(RolledBack, DistributionInMemoryIsOfTheNewEpoch) {
  const FetchReply before = fetch(request_for(pupil_));
  ASSERT_TRUE(before.distribution);
  EXPECT_EQ(before.distribution->store_epoch, epoch_);
  const ReportReply reply = say(lost_);
  const FetchReply after = fetch(request_for(pupil_));
  ASSERT_TRUE(after.distribution);
  EXPECT_EQ(after.distribution->store_epoch, reply.store_epoch);
  EXPECT_EQ(after.distribution->revision, before.distribution->revision);
}

TEST_F(RolledBack, WhileNoEpochCanBeginNobodyIsGivenANewerMark) {
  service_->shutdown();
  bool is_answered = false;
  service_->reports().report({{}, {}, lost_}, [&](const ReportReply&) { is_answered = true; });
  EXPECT_FALSE(is_answered);
}

}  // namespace
}  // namespace kinship::service::rollback_test
