// Two sites and the memory above them: kinshipd as processes that are killed, and a real PostgreSQL
// that goes away.

#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "client/link/client.hpp"
#include "proto/json/summaries_json.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::sites_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

constexpr seconds kEnough{120};  // the machine may have other work

/// A domain with a server that has a store of its own, and a client.
class Site {
 public:
  Site(const std::filesystem::path& folder, std::string name, std::string upstream)
      : folder_(folder), name_(std::move(name)), upstream_(std::move(upstream)) {
    start();
    client_ =
        std::make_unique<link::Client>(link::ClientOptions{.domain = domain_.number(),
                                                           .outbox = folder_ / (name_ + "_outbox"),
                                                           .timeout = seconds(60)});
    panda = register_model("panda");
    ur10e = register_model("ur10e");
  }

  void start() {
    server_ = std::make_unique<test::ServerProcess>(
        test::ServerProcess::Options{.store = folder_ / (name_ + ".db"),
                                     .domain = domain_.number(),
                                     .arguments = {"--upstream", upstream_}});
  }
  void kill() { server_->kill(); }
  int terminate() { return server_->terminate(); }
  /// So many sweeps more, durable here on return.
  std::vector<Uuid> report(int count) {
    std::vector<Uuid> reports;
    for (int i = 0; i < count; ++i) {
      const Attempt attempt = test::panda_attempt(panda, "sweep", seed_++);
      reports.push_back(attempt.report_uuid);
      client_->report(attempt);
    }
    EXPECT_EQ(client_->flush(kEnough).pending, 0U);
    return reports;
  }
  FetchReply fetch() {
    FetchRequest request;
    request.task = "sweep";
    request.robot = ur10e;
    request.profile = "paper";  // the cheapest fits
    request.deadline = seconds(30);
    return client_->fetch(request).value_or_throw();
  }
  ServerStatus status() {
    const AdminReply reply = client_->admin({}).value_or_throw();
    return json::server_status_from_json(reply.rows.at(0)).value_or_throw();
  }
  void retire(const Uuid& report) {
    AdminRequest request;
    request.verb = AdminVerb::RetirePath;
    request.argument = report.text();
    EXPECT_EQ(client_->admin(request).value_or_throw().status, AdminStatus::Ok);
  }
  template <typename Condition>
  bool comes_true(Condition condition) {
    const auto end = Clock::now() + kEnough;
    while (Clock::now() < end) {
      if (condition(status()))
        return true;
      std::this_thread::sleep_for(milliseconds(100));
    }
    return false;
  }

  Digest panda, ur10e;

 private:
  Digest register_model(const std::string& model) {
    return client_->register_robot(test::model_description(model)).value_or_throw().robot;
  }

  const std::filesystem::path folder_;
  const std::string name_, upstream_;
  const test::ReservedDomain domain_;
  std::unique_ptr<test::ServerProcess> server_;
  std::unique_ptr<link::Client> client_;
  std::uint64_t seed_ = std::hash<std::string>()(name_) % 1000;
};

TEST(Sites, ShareOneMemoryThroughCutLinesAndKills) {
  if (const std::string missing = test::missing_postgres(); !missing.empty())
    GTEST_SKIP() << missing;
  test::PostgresCluster memory;
  const std::string url = memory.create_database("kinship");
  const test::TemporaryDirectory folder;
  Site ulm(folder.path(), "ulm", url), bern(folder.path(), "bern", url);

  const std::vector<Uuid> first = ulm.report(8);
  EXPECT_EQ(bern.fetch().status, FetchStatus::NoExperience) << "it asks for it from now on";
  ASSERT_TRUE(bern.comes_true([](const ServerStatus& status) { return status.paths == 8; }));
  const FetchReply reply = bern.fetch();
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_EQ(reply.distribution->sources.at(0).paths, 8U);

  memory.kill();
  ASSERT_TRUE(ulm.comes_true(
      [](const ServerStatus& status) { return !status.upstream.value().connected; }));
  ulm.fetch();  // wants the task from now on
  ASSERT_TRUE(
      ulm.comes_true([](const ServerStatus& status) { return status.upstream->tasks == 1; }));
  ulm.report(5);
  bern.report(4);
  EXPECT_EQ(ulm.status().upstream->waiting, 5U);
  bern.retire(first.at(2));
  ulm.kill();
  ulm.start();
  memory.start();
  bern.kill();
  bern.start();
  for (Site* const site : {&ulm, &bern})
    ASSERT_TRUE(site->comes_true([](const ServerStatus& status) {
      return status.attempts == 17 && status.paths == 16 && status.upstream->waiting == 0;
    })) << memory.query("SELECT count(*) FROM attempt", "kinship");
  EXPECT_EQ(ulm.status().upstream->refused, 0U);
  EXPECT_EQ(memory.query("SELECT count(*), count(DISTINCT report_uuid) FROM attempt", "kinship"),
            "17\t17");
  EXPECT_EQ(ulm.terminate(), 0);
  EXPECT_EQ(bern.terminate(), 0);
}

TEST(Sites, StopAtOnceAlsoWhileTheMemoryDoesNotAnswer) {
  if (const std::string missing = test::missing_postgres(); !missing.empty())
    GTEST_SKIP() << missing;
  test::PostgresCluster memory;
  const std::string url = memory.create_database("kinship");
  const test::TemporaryDirectory folder;
  Site ulm(folder.path(), "ulm", url);
  ulm.report(1);
  ASSERT_TRUE(
      ulm.comes_true([](const ServerStatus& status) { return status.upstream->sent == 1; }));
  memory.freeze();
  ulm.report(1);
  const auto began = Clock::now();
  EXPECT_EQ(ulm.terminate(), 0);
  // Whoever waits for it gives up after 10 s, and tries once more.
  EXPECT_LT(Clock::now() - began, seconds(8));
  memory.thaw();
  ulm.start();
  ASSERT_TRUE(
      ulm.comes_true([](const ServerStatus& status) { return status.upstream->waiting == 0; }));
  EXPECT_EQ(memory.query("SELECT count(*) FROM attempt", "kinship"), "2");
  EXPECT_EQ(ulm.terminate(), 0);
}

}  // namespace
}  // namespace kinship::sites_test
