// Two kinshipd, each with a DDS domain of its own, over one PostgreSQL database: what is done at
// one counts at the other, also if that is killed.

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "client/link/client.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::shared_store_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

constexpr seconds kEnough{60};  // the machine may have other work

/// A domain with one of the servers, and a client.
class Cell {
 public:
  Cell(const std::filesystem::path& folder, std::string url)
      : folder_(folder), url_(std::move(url)) {
    std::filesystem::create_directories(folder_);
    start();
    client_ = std::make_unique<link::Client>(link::ClientOptions{
        .domain = domain_.number(), .outbox = folder_ / "outbox", .timeout = seconds(60)});
  }

  void start() {
    server_ = std::make_unique<test::Program>(
        "kinshipd",
        std::vector<std::string>{"--store", url_, "--domain", std::to_string(domain_.number())},
        folder_ / "log");
    ASSERT_TRUE(server_->read_line().starts_with("ready "));
  }
  void kill() {
    server_->signal(SIGKILL);
    server_->wait();
  }
  int terminate() {
    server_->signal(SIGTERM);
    return server_->wait();
  }

  Digest register_model(const std::string& model) const {
    return client_->register_robot(test::model_description(model)).value_or_throw().robot;
  }
  Uuid report(const Digest& panda, std::uint64_t first, std::uint64_t count) const {
    Uuid last;
    for (std::uint64_t i = 0; i < count; ++i) {
      const Attempt attempt = test::panda_attempt(panda, "sweep", first + i);
      last = attempt.report_uuid;
      client_->report(attempt);
    }
    EXPECT_EQ(client_->flush(kEnough).pending, 0U);
    return last;
  }
  FetchReply fetch(const Digest& robot) const {
    FetchRequest request;
    request.task = "sweep";
    request.robot = robot;
    request.profile = "paper";  // the cheapest fits
    request.deadline = seconds(30);
    return client_->fetch(request).value_or_throw();
  }
  AdminStatus ask(AdminVerb verb, const std::string& argument) const {
    AdminRequest request;
    request.verb = verb;
    request.argument = argument;
    return client_->admin(request).value_or_throw().status;
  }

 private:
  const std::filesystem::path folder_;
  const std::string url_;
  const test::ReservedDomain domain_;
  std::unique_ptr<test::Program> server_;
  std::unique_ptr<link::Client> client_;
};

class SharedStore : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    cluster_ = std::make_unique<test::PostgresCluster>();
    const std::string url = cluster_->create_database("kinship");
    one_ = std::make_unique<Cell>(folder_.path() / "one", url);
    other_ = std::make_unique<Cell>(folder_.path() / "other", url);
    panda_ = one_->register_model("panda");
    ur10e_ = other_->register_model("ur10e");
  }

  const test::TemporaryDirectory folder_;
  std::unique_ptr<test::PostgresCluster> cluster_;
  std::unique_ptr<Cell> one_, other_;
  Digest panda_, ur10e_;
};

TEST_F(SharedStore, WhatOneServerIsToldTheOtherServes) {
  one_->report(panda_, 1, 8);
  const FetchReply made = other_->fetch(ur10e_);
  ASSERT_EQ(made.status, FetchStatus::Ready) << made.message;
  EXPECT_EQ(made.distribution->sources.at(0).paths, 8U);
  // Made once: the first server takes it from the store.
  const FetchReply taken = one_->fetch(ur10e_);
  ASSERT_EQ(taken.status, FetchStatus::Ready) << taken.message;
  EXPECT_EQ(taken.distribution->revision, made.distribution->revision);
}

TEST_F(SharedStore, WhatIsRetiredAtOneServerTheOtherServesNoMore) {
  one_->report(panda_, 1, 8);
  ASSERT_EQ(other_->fetch(ur10e_).status, FetchStatus::Ready);  // in its memory from now on
  ASSERT_EQ(one_->ask(AdminVerb::ResetTask, "sweep"), AdminStatus::Ok);
  const auto end = Clock::now() + kEnough;
  FetchStatus status = FetchStatus::Ready;
  while (status == FetchStatus::Ready && Clock::now() < end) {
    status = other_->fetch(ur10e_).status;
    std::this_thread::sleep_for(milliseconds(20));
  }
  EXPECT_EQ(status, FetchStatus::NoExperience);
}

TEST_F(SharedStore, AServerThatIsKilledTakesNothingAlong) {
  const Uuid report = one_->report(panda_, 1, 8);
  one_->kill();
  const FetchReply reply = other_->fetch(ur10e_);
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_EQ(other_->ask(AdminVerb::RetirePath, report.text()), AdminStatus::Ok);
  one_->start();
  one_->report(panda_, 100, 2);
  EXPECT_EQ(cluster_->query("SELECT count(*), count(DISTINCT report_uuid) FROM attempt", "kinship"),
            "10\t10");
  EXPECT_EQ(cluster_->query("SELECT paths FROM experience", "kinship"), "9");
  EXPECT_EQ(one_->terminate(), 0);
  EXPECT_EQ(other_->terminate(), 0);
}

}  // namespace
}  // namespace kinship::shared_store_test
