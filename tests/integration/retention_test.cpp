// A kinshipd that keeps a few paths of each robot and task, killed in between: what it says of the
// others.

#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "client/link/client.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::retention_test {
namespace {

using std::chrono::seconds;

class Retention : public testing::Test {
 protected:
  static constexpr std::size_t kCap = 6, kReports = 30;

  Retention() {
    start();
    panda_ = client_.register_robot(test::model_description("panda")).value_or_throw().robot;
    for (std::uint64_t seed = 1; seed <= kReports; ++seed)
      attempts_.push_back(test::panda_attempt(panda_, "sweep", seed));
  }

  void start() {
    server_.reset();
    server_ = std::make_unique<test::ServerProcess>(
        test::ServerProcess::Options{.store = folder_ / "fleet.db",
                                     .domain = domain_.number(),
                                     .arguments = {"--max-paths-per-pair", std::to_string(kCap)}});
  }
  std::string kinship(std::vector<std::string> words) {
    words.insert(words.begin(), {"--domain", std::to_string(domain_.number()), "--timeout", "60"});
    return test::run_to_end("kinship", words).out;
  }
  /// UUIDs of what can be exported.
  std::set<std::string> exported() {
    const std::string lines = kinship({"paths", "export", "--task", "sweep"});
    std::set<std::string> uuids;
    for (const Attempt& attempt : attempts_)
      if (lines.find(attempt.report_uuid.text()) != std::string::npos)
        uuids.insert(attempt.report_uuid.text());
    return uuids;
  }

  const test::ReservedDomain domain_;
  const test::TemporaryDirectory folder_;
  std::unique_ptr<test::ServerProcess> server_;
  link::Client client_{
      {.domain = domain_.number(), .outbox = {}, .has_outbox = false, .timeout = seconds(60)}};
  Digest panda_;
  std::vector<Attempt> attempts_;
};

TEST_F(Retention, NoReceiptIsLostAndEveryCountSaysWhatIsKept) {
  for (const Attempt& attempt : attempts_) {
    const std::vector<Receipt> receipts = client_.deliver({attempt}).value_or_throw();
    ASSERT_EQ(receipts.size(), 1U);
    const bool is_kept = receipts[0].status == ReceiptStatus::Stored;
    EXPECT_TRUE(is_kept || receipts[0].status == ReceiptStatus::Recorded);
    EXPECT_EQ(receipts[0].message.find("not kept") != std::string::npos, !is_kept)
        << receipts[0].message;
  }
  const std::set<std::string> kept = exported();
  EXPECT_EQ(kept.size(), kCap);
  server_->kill();
  start();
  EXPECT_EQ(exported(), kept);
  for (const Receipt& receipt : client_.deliver(attempts_).value_or_throw())
    EXPECT_EQ(receipt.status, ReceiptStatus::Duplicate) << receipt.message;
  const std::string of_all = "6 of 30";
  EXPECT_NE(kinship({"tasks", "list"}).find(of_all), std::string::npos)
      << kinship({"tasks", "list"});
  EXPECT_NE(kinship({"tasks", "show", "sweep"}).find(of_all + " paths, 30 attempts"),
            std::string::npos);
  const std::string status = kinship({"status"});
  EXPECT_NE(status.find("6 paths (24 more were beyond the cap), 30 attempts"), std::string::npos)
      << status;
  EXPECT_NE(status.find("6 of 6 paths, of the robot and task with most"), std::string::npos)
      << status;
  EXPECT_NE(status.find(" of 1024 MB of distributions in the store"), std::string::npos) << status;
  EXPECT_NE(status.find(" of 128 MB of distributions in memory"), std::string::npos) << status;
  EXPECT_NE(kinship({"paths", "list"}).find("dropped"), std::string::npos);
}

}  // namespace
}  // namespace kinship::retention_test
