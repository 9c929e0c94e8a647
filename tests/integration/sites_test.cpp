// Two sites and the memory above them: kinshipd as processes that are killed, and a real PostgreSQL
// that goes away.

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <thread>

#include "tests/support/cell.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::sites_test {
namespace {

/// A cell whose server has a store of its own and a memory above it.
class Site {
 public:
  Site(const std::filesystem::path& folder, const std::string& upstream)
      : cell_({.folder = folder,
               .store = folder / "site.db",
               .arguments = {"--upstream", upstream}}) {
    cell_.start();
    panda_ = cell_.register_model("panda").robot;
    ur10e_ = cell_.register_model("ur10e").robot;
  }

  test::Cell& cell() { return cell_; }
  std::vector<Uuid> report(std::uint64_t first, std::uint64_t count) {
    return cell_.report(panda_, first, count);
  }
  /// Durable at the site on return. \param number  of the content.
  void report_as(const Uuid& report, std::uint64_t number) {
    Attempt attempt = test::panda_attempt(panda_, "sweep", number);
    attempt.report_uuid = report;
    cell_.client().report(attempt);
    EXPECT_EQ(cell_.client().flush(test::Cell::kEnough).pending, 0U);
  }
  FetchReply fetch() { return cell_.fetch(ur10e_); }
  bool comes_true(const std::function<bool(const ServerStatus&)>& condition) {
    const auto end = std::chrono::steady_clock::now() + test::Cell::kEnough;
    while (std::chrono::steady_clock::now() < end) {
      if (condition(cell_.status()))
        return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }

 private:
  test::Cell cell_;
  Digest panda_, ur10e_;
};

class Sites : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    memory_ = std::make_unique<test::PostgresCluster>();
    url_ = memory_->create_database("kinship");
  }
  Site site(const std::string& name) const { return {folder_.path() / name, url_}; }

  std::unique_ptr<test::PostgresCluster> memory_;
  std::string url_;
  const test::TemporaryDirectory folder_;
};

TEST_F(Sites, ShareOneMemoryThroughCutLinesAndKills) {
  Site ulm = site("ulm"), bern = site("bern");

  const std::vector<Uuid> first = ulm.report(1, 8);
  EXPECT_EQ(bern.fetch().status, FetchStatus::NoExperience) << "it asks for it from now on";
  ASSERT_TRUE(bern.comes_true([](const ServerStatus& status) { return status.paths == 8; }));
  const FetchReply reply = bern.fetch();
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_EQ(reply.distribution->sources.at(0).paths, 8U);

  memory_->kill();
  ASSERT_TRUE(ulm.comes_true(
      [](const ServerStatus& status) { return !status.upstream.value().connected; }));
  ulm.fetch();  // wants the task from now on
  ASSERT_TRUE(
      ulm.comes_true([](const ServerStatus& status) { return status.upstream->tasks == 1; }));
  ulm.report(101, 5);
  bern.report(201, 4);
  EXPECT_EQ(ulm.cell().status().upstream->waiting, 5U);
  EXPECT_EQ(bern.cell().ask(AdminVerb::RetirePath, first.at(2).text()).status, AdminStatus::Ok);
  ulm.cell().kill();
  ulm.cell().start();
  memory_->start();
  bern.cell().kill();
  bern.cell().start();
  for (Site* const site : {&ulm, &bern})
    ASSERT_TRUE(site->comes_true([](const ServerStatus& status) {
      return status.attempts == 17 && status.paths == 16 && status.upstream->waiting == 0;
    })) << memory_->query("SELECT count(*) FROM attempt", "kinship");
  EXPECT_EQ(ulm.cell().status().upstream->refused, 0U);
  EXPECT_EQ(memory_->query("SELECT count(*), count(DISTINCT report_uuid) FROM attempt", "kinship"),
            "17\t17");
  EXPECT_EQ(ulm.cell().terminate(), 0);
  EXPECT_EQ(bern.cell().terminate(), 0);
}

TEST_F(Sites, NameOneUuidWithTwoContentsAndTryWhatIsRefusedAgainWhileTheLineHolds) {
  Site ulm = site("ulm"), bern = site("bern");
  const Uuid both = Uuid::random();
  ulm.report_as(both, 1);
  ASSERT_TRUE(
      ulm.comes_true([](const ServerStatus& status) { return status.upstream->sent == 1; }));
  bern.report_as(both, 2);
  ASSERT_TRUE(
      bern.comes_true([](const ServerStatus& status) { return status.upstream->refused == 1; }));
  const std::string refused = bern.cell().status().upstream->first_refused;
  EXPECT_NE(refused.find(both.text()), std::string::npos) << refused;
  EXPECT_NE(refused.find("was used for another report"), std::string::npos) << refused;

  const std::int64_t since_ms = ulm.cell().status().upstream->since_ms;
  memory_->query("ALTER TABLE attempt ADD CONSTRAINT hand CHECK (collision_checks < 0) NOT VALID",
                 "kinship");
  ulm.report(101, 3);
  ASSERT_TRUE(ulm.comes_true([](const ServerStatus& status) {
    return status.upstream->refused == 3 && status.upstream->waiting == 0;
  }));
  EXPECT_NE(ulm.cell().status().upstream->first_refused.find("[23514]"), std::string::npos);
  memory_->query("ALTER TABLE attempt DROP CONSTRAINT hand", "kinship");
  ASSERT_TRUE(
      ulm.comes_true([](const ServerStatus& status) { return status.upstream->refused == 0; }));
  EXPECT_EQ(ulm.cell().status().upstream->since_ms, since_ms) << "over the same line";
  EXPECT_EQ(memory_->query("SELECT count(*) FROM attempt", "kinship"), "4");
}

TEST_F(Sites, StopAtOnceAlsoWhileTheMemoryDoesNotAnswer) {
  Site ulm = site("ulm");
  ulm.report(1, 1);
  ASSERT_TRUE(
      ulm.comes_true([](const ServerStatus& status) { return status.upstream->sent == 1; }));
  memory_->freeze();
  ulm.report(2, 1);
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EQ(ulm.cell().terminate(), 0);
  // Whoever waits for it gives up after 10 s, and tries once more.
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(8));
  memory_->thaw();
  ulm.cell().start();
  ASSERT_TRUE(
      ulm.comes_true([](const ServerStatus& status) { return status.upstream->waiting == 0; }));
  EXPECT_EQ(memory_->query("SELECT count(*) FROM attempt", "kinship"), "2");
  EXPECT_EQ(ulm.cell().terminate(), 0);
}

}  // namespace
}  // namespace kinship::sites_test
