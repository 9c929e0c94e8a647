#include "server/service/service.hpp"

#include <gtest/gtest.h>

#include "tests/unit/server/service/service_fixture.hpp"

namespace kinship::service::service_test {
namespace {

class ServiceTest : public ServiceFixture {};

TEST_F(ServiceTest, StatusCountsWhatWasDoneSinceTheStart) {
  advance(std::chrono::seconds(90));
  Attempt bad = fleet::solved(teacher_, "shelf", 50);
  bad.path = fleet::solved(pupil_, "shelf", 50).path;  // of another number of joints
  std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 6, 1);
  attempts.push_back(bad);
  report(attempts);
  fetch(request_for(teacher_));
  const ServerStatus status = service_->status();
  EXPECT_EQ(status.version, "1.2.3");
  EXPECT_EQ(status.uptime_s, 90U);
  EXPECT_EQ(status.robots, 3U);
  EXPECT_EQ(status.tasks, 1U);
  EXPECT_EQ(status.paths, 6U);
  EXPECT_EQ(status.distributions, 1U);
  EXPECT_EQ(status.reports_received, 7U);
  EXPECT_EQ(status.reports_refused, 1U);
  EXPECT_EQ(status.fits, 1U);
  EXPECT_TRUE(status.writable);
}

TEST_F(ServiceTest, StatusAndMetricsTellWhenTheServersCertificateEnds) {
  const auto metric = [this] {
    const std::string name = "\nkinship_credentials_expiry_timestamp_seconds ";
    metrics::Exposition page;
    service_->expose(page);
    const std::size_t at = page.text().find(name);
    return at == std::string::npos ? -1 : std::stod(page.text().substr(at + name.size()));
  };
  EXPECT_EQ(service_->status().credentials_expire_ms, 0);
  EXPECT_EQ(metric(), 0) << "without security";
  adjust_ = [](ServiceOptions& options) { options.credentials_expire_ms = 2'000'000'000'500; };
  start();
  EXPECT_EQ(service_->status().credentials_expire_ms, 2'000'000'000'500);
  EXPECT_EQ(metric(), 2'000'000'000.5);
}

TEST_F(ServiceTest, ReceiptsOfWhatTheDecoderRefusedAreInTheReply) {
  const Receipt refused{Uuid::random(), ReceiptStatus::Refused, "path: 1 waypoint"};
  std::promise<ReportReply> done;
  service_->reports().report({fleet::solved(teacher_, "shelf", 2, 1), {refused}},
                             [&](const ReportReply& reply) { done.set_value(reply); });
  const ReportReply reply = done.get_future().get();
  EXPECT_EQ(reply.store_epoch, service_->status().store_epoch);
  ASSERT_EQ(reply.receipts.size(), 3U);
  EXPECT_EQ(reply.receipts[0].status, ReceiptStatus::Stored);
  EXPECT_EQ(reply.receipts[2].report_uuid, refused.report_uuid);
  EXPECT_EQ(service_->status().reports_refused, 1U);
  EXPECT_NE(log().find("1 of 3 attempts refused, first: path: 1 waypoint"), std::string::npos)
      << log();
}

TEST_F(ServiceTest, TheLogTellsOfRobotsAndFits) {
  report(fleet::solved(teacher_, "shelf", 6, 1));
  const FetchReply reply = fetch(request_for(pupil_));
  EXPECT_NE(log().find("register 'teacher': robot " + teacher_.digest.short_hex()),
            std::string::npos)
      << log();
  EXPECT_NE(log().find("fit " + reply.distribution->id.short_hex() + " revision 1 for robot " +
                       pupil_.digest.short_hex() + ", task 'shelf': "),
            std::string::npos)
      << log();
}

TEST_F(ServiceTest, ShutdownAnswersEveryReportAndRefusesNoneForGood) {
  std::vector<std::future<ReportReply>> replies;
  for (std::uint64_t i = 0; i < 50; ++i) {
    const auto promise = std::make_shared<std::promise<ReportReply>>();
    replies.push_back(promise->get_future());
    service_->reports().report({{fleet::solved(teacher_, "shelf", i)}, {}},
                               [promise](const ReportReply& reply) { promise->set_value(reply); });
  }
  service_->shutdown();
  for (std::future<ReportReply>& reply : replies) {
    ASSERT_EQ(reply.wait_for(std::chrono::seconds(0)), std::future_status::ready);
    EXPECT_EQ(reply.get().receipts[0].status, ReceiptStatus::Stored);
  }
  EXPECT_EQ(report({fleet::solved(teacher_, "shelf", 99)}).receipts[0].status,
            ReceiptStatus::TryAgain);
}

TEST_F(ServiceTest, OnceStoppedRegisteringIsLeftUnansweredAndAdministrationFails) {
  service_->shutdown();
  bool answered = false;
  service_->registration().register_robot(fleet::teacher(),
                                          [&](const RegisterReply&) { answered = true; });
  EXPECT_FALSE(answered);
  EXPECT_EQ(administer(fleet::question(AdminVerb::Status)).status, AdminStatus::Failed);
}

}  // namespace
}  // namespace kinship::service::service_test
