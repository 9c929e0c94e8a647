// Several kinshipd, each with a DDS domain of its own, over one PostgreSQL database: what is done
// at one counts at the others, also if that is killed.

#include <gtest/gtest.h>

#include <future>
#include <iostream>
#include <memory>
#include <string>
#include <thread>

#include "tests/support/cell.hpp"
#include "tests/support/locked_table.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/postgres_query.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::shared_store_test {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Asks until it is so; nobody tells that a server has noticed what another one did.
template <typename Condition>
bool comes_true(Condition condition) {
  const auto end = Clock::now() + test::Cell::kEnough;
  while (!condition()) {
    if (Clock::now() > end)
      return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

int fits_of(const test::Cell& cell) {
  const std::string log = cell.log();
  int fits = 0;
  for (std::size_t at = log.find(" revision "); at != std::string::npos;
       at = log.find(" revision ", at + 1))
    ++fits;
  return fits;
}

std::uint64_t used_of(const ServerStatus& status, const std::string& bound) {
  for (const BoundUse& use : status.bounds)
    if (use.what == bound)
      return use.used;
  return 0;
}

class SharedStore : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    cluster_ = std::make_unique<test::PostgresCluster>();
    url_ = cluster_->create_database("kinship");
    one_ = cell("one");
    one_->start();
    other_ = cell("other");
    other_->start();
    panda_ = one_->register_model("panda").robot;
    ur10e_ = other_->register_model("ur10e").robot;
  }
  std::unique_ptr<test::Cell> cell(const std::string& name) const { return cell(name, url_); }
  std::unique_ptr<test::Cell> cell(const std::string& name, const std::string& url) const {
    return std::make_unique<test::Cell>(
        test::Cell::Options{.folder = folder_.path() / name, .store = url});
  }
  std::future<FetchReply> begin_fetch(test::Cell& cell) const {
    return std::async(std::launch::async, [this, &cell] { return cell.fetch(ur10e_); });
  }
  std::string query(const std::string& sql) const { return cluster_->query(sql, "kinship"); }

  const test::TemporaryDirectory folder_;
  std::unique_ptr<test::PostgresCluster> cluster_;
  std::string url_;
  std::unique_ptr<test::Cell> one_, other_;
  Digest panda_, ur10e_;
};

TEST_F(SharedStore, TwoServersThatAreAskedAtOnceMakeOneFit) {
  one_->report(panda_, 1, 8);
  auto fits = std::make_unique<test::LockedTable>(url_, "fit_lease");
  std::future<FetchReply> of_one = begin_fetch(*one_), of_other = begin_fetch(*other_);
  fits->wait_until_wanted_by(2);  // both have found that there is none, and are about to make it
  fits.reset();
  const FetchReply from_one = of_one.get(), from_other = of_other.get();
  ASSERT_EQ(from_one.status, FetchStatus::Ready) << from_one.message;
  ASSERT_EQ(from_other.status, FetchStatus::Ready) << from_other.message;
  EXPECT_EQ(from_one.distribution->revision, 1U);
  EXPECT_EQ(from_other.distribution->revision, 1U);
  EXPECT_EQ(fits_of(*one_) + fits_of(*other_), 1) << one_->log() << other_->log();
}

TEST_F(SharedStore, AFitWhoseServerIsKilledIsMadeByAnother) {
  one_->report(panda_, 1, 8);
  auto paths = std::make_unique<test::LockedTable>(url_, "path");
  std::future<FetchReply> of_one = begin_fetch(*one_);
  paths->wait_until_wanted_by(1);
  ASSERT_EQ(query("SELECT fence, holder <> '' FROM fit_lease"), "1\tt") << "it fits";
  one_->kill();
  paths.reset();
  const auto killed = Clock::now();
  const FetchReply reply = other_->fetch(ur10e_);
  std::cout << "another server made the fit of a killed one after " << seconds_since(killed)
            << " s\n";
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_LT(seconds_since(killed), 20);
  EXPECT_EQ(query("SELECT fence FROM fit_lease"), "2");
  one_->start();  // its client has gone on asking
  const FetchReply late = of_one.get();
  ASSERT_EQ(late.status, FetchStatus::Ready) << late.message;
  EXPECT_EQ(late.distribution->revision, 1U);
}

TEST_F(SharedStore, WhatIsRetiredAtOneServerTheOtherServesNoMore) {
  one_->report(panda_, 1, 8);
  ASSERT_EQ(other_->fetch(ur10e_).status, FetchStatus::Ready);  // in its memory from now on
  ASSERT_EQ(one_->ask(AdminVerb::ResetTask, "sweep").status, AdminStatus::Ok);
  EXPECT_TRUE(comes_true([&] { return other_->fetch(ur10e_).status != FetchStatus::Ready; }));
  EXPECT_EQ(other_->fetch(ur10e_).status, FetchStatus::NoExperience);
}

TEST_F(SharedStore, WithoutItsDatabaseAServerKnowsItsRobotsAndServesWhatIsInMemory) {
  one_->report(panda_, 1, 8);
  const FetchReply made = one_->fetch(ur10e_);
  ASSERT_EQ(made.status, FetchStatus::Ready) << made.message;
  ASSERT_EQ(one_->register_model("ur10e").status, RegisterStatus::Known);
  const auto is_served = [&] {
    const auto began = Clock::now();
    const RegisterReply known = one_->register_model("ur10e");
    EXPECT_EQ(known.status, RegisterStatus::Known) << known.message;
    const FetchReply reply = one_->fetch(ur10e_);
    EXPECT_EQ(reply.status, FetchStatus::Ready) << reply.message;
    const double took = seconds_since(began);
    std::cout << "without the database a robot and its distribution took " << took << " s\n";
    EXPECT_LT(took, 4);  // whoever asks the database waits for 10 s and more
  };
  EXPECT_EQ(one_->status().paths, 8U);
  cluster_->freeze();
  const auto list_tasks = [&] { return one_->ask(AdminVerb::ListTasks, ""); };
  auto first = std::async(std::launch::async, list_tasks);
  auto second = std::async(std::launch::async, list_tasks);
  EXPECT_TRUE(comes_true([&] {  // one of them waits for the other, which waits for the database
    const auto began = Clock::now();
    const ServerStatus status = one_->status();
    std::cout << "its status took " << seconds_since(began) << " s: " << status.storage_message
              << '\n';
    EXPECT_LT(seconds_since(began), 4);
    EXPECT_FALSE(status.writable);
    EXPECT_FALSE(status.storage_message.empty());
    EXPECT_EQ(status.paths, 8U);
    return used_of(status, "short tasks that wait") == 1;
  }));
  is_served();
  cluster_->thaw();
  cluster_->kill();
  is_served();
}

TEST_F(SharedStore, ThePasswordOfTheDatabaseIsSaidToNobodyAlsoWhenItCannotBeReached) {
  const std::unique_ptr<test::Cell> third =
      cell("third", url_ + (url_.find('?') == std::string::npos ? "?" : "&") + "password=s3cret");
  third->start();
  EXPECT_EQ(third->status().store_file.find("s3cret"), std::string::npos);
  cluster_->kill();
  ServerStatus status;
  EXPECT_TRUE(comes_true([&] {
    status = third->status();
    return !status.writable;
  }));
  EXPECT_FALSE(status.storage_message.empty());
  EXPECT_EQ(status.storage_message.find("s3cret"), std::string::npos) << status.storage_message;
  EXPECT_EQ(third->terminate(), 0);
  EXPECT_FALSE(third->log().empty());
  EXPECT_EQ(third->log().find("s3cret"), std::string::npos) << third->log();
  try {
    third->start();  // does not begin without its database
    ADD_FAILURE();
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("postgresql://"), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find("s3cret"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace kinship::shared_store_test
