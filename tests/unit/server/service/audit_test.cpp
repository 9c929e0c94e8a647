// What the audit log says of administration, and of what it leaves out.

#include <algorithm>

#include "server/service/answered_changes.hpp"
#include "tests/unit/server/service/access_fixture.hpp"
#include "tests/unit/server/service/given_guidance.hpp"

namespace kinship::service::audit_test {
namespace {

class Audit : public AccessFixture {
 protected:
  /// A backup that nobody had made through the service.
  void make_backup(const std::string& name) {
    ASSERT_TRUE(real_store_->backup(directory_.path() / name, [](double) { return true; })
                    .value_or_throw());
  }
  AdminPage read_backup(const Caller& caller, const std::string& cursor) {
    AdminRequest read = fleet::question(AdminVerb::ReadBackup, "copy.db");
    read.cursor = cursor;
    return ask_for(caller, read);
  }
};

TEST_F(Audit, WhatCannotBeKeptInTheAuditLogIsNotDone) {
  troubled_->on_audit = [](const AuditEntry&) {
    throw Failure(ErrorCode::Storage, "no space is left");
  };
  const AdminPage backup = ask(named("otto", AccessRole::Operator), AdminVerb::Backup, "copy.db");
  EXPECT_EQ(backup.status, AdminStatus::Failed);
  EXPECT_EQ(backup.message, "no space is left");
  EXPECT_FALSE(std::filesystem::exists(directory_ / "copy.db"));
}

TEST_F(Audit, WhoIsRefusedForEverFillsNoDisk) {
  const Caller reader = named("anna", AccessRole::Reader);
  for (std::uint64_t i = 0; i < AuditRateLimit::kAtOnce + 50; ++i)
    ask(reader, AdminVerb::ResetTask, "shelf");
  EXPECT_EQ(log_entries().size(), AuditRateLimit::kAtOnce);
  ask(named("ben", AccessRole::Reader), AdminVerb::ResetTask, "shelf");
  EXPECT_EQ(log_entries().back(), "ben reset_task shelf refused") << "nobody else is hidden";
  advance(std::chrono::seconds(2));
  ask(reader, AdminVerb::ResetTask, "shelf");
  const std::vector<AuditEntry> log = real_store_->list_audit("", "", 1000).rows;
  ASSERT_EQ(log.size(), AuditRateLimit::kAtOnce + 2);
  EXPECT_NE(log[0].message.find("(50 of its own before it were not kept)"), std::string::npos)
      << log[0].message;
}

TEST_F(Audit, AChangeThatIsAskedForAgainIsAnsweredAsItWasAndIsInTheLogOnce) {
  AdminRequest rename;
  rename.verb = AdminVerb::RenameRobot;
  rename.robot = "dwarf";
  rename.argument = "giant";
  const Caller root = named("root", AccessRole::Admin);
  const auto ask_as = [&](const std::string& request_key) {
    return ask_for(root, rename, request_key);
  };
  for (int i = 0; i < 2; ++i) {
    const AdminPage page = ask_as("client 1");
    ASSERT_EQ(page.status, AdminStatus::Ok) << page.message;
    EXPECT_EQ(std::get<RobotSummary>(page.rows[0]).label, "giant");
  }
  EXPECT_EQ(log_entries(), Lines{"root rename_robot dwarf to giant done"});
  EXPECT_EQ(ask_as("client 2").status, AdminStatus::NotFound) << "another request";
  EXPECT_EQ(ask_as("client 2").status, AdminStatus::NotFound);
  EXPECT_EQ(log_entries().size(), 2U);
}

TEST_F(Audit, WhatFailsForEverFillsNoDiskButTheEndOfWhatBeganIsKept) {
  AuditTrail trail(*real_store_, clock_);
  AdminPage failed;
  failed.message = "disk I/O error";
  const Caller otto = named("otto", AccessRole::Operator);
  const auto fail = [&](AdminVerb verb) {
    for (std::uint64_t i = 0; i < AuditRateLimit::kAtOnce + 20; ++i)
      trail.not_done(audit_entry(otto, fleet::question(verb, "x")), failed);
  };
  fail(AdminVerb::EvictDistribution);
  EXPECT_EQ(log_entries().size(), AuditRateLimit::kAtOnce);
  fail(AdminVerb::ResetTask);
  EXPECT_EQ(log_entries().size(), 2 * AuditRateLimit::kAtOnce + 20);
}

TEST_F(Audit, WhoInventsClientsSharesTheAllowanceOfOne) {
  AuditRateLimit allowance(clock_);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < 2 * AuditRateLimit::kClients; ++i)
    for (std::uint64_t j = 0; j <= AuditRateLimit::kAtOnce; ++j)
      kept += allowance.take("invented " + std::to_string(i)).has_value();
  EXPECT_LE(kept, (AuditRateLimit::kClients + 1) * AuditRateLimit::kAtOnce);
  advance(std::chrono::seconds(AuditRateLimit::kAtOnce));
  EXPECT_EQ(allowance.take("honest"), 0U) << "who was quiet since makes room";
}

TEST_F(Audit, AResetThatAStopInterruptedHasFailed) {
  constexpr std::size_t kMoreThanATransactionHas = 501;
  report(fleet::solved(*teacher_, "shelf", kMoreThanATransactionHas, 1));
  std::stop_source stop;
  stop.request_stop();
  const Jobs::Options none;
  Jobs jobs(clock_, none);
  GivenGuidance guidance;
  Administration administration({.store = *real_store_,
                                 .robots = *registry_,
                                 .jobs = jobs,
                                 .clock = clock_,
                                 .guidance = guidance,
                                 .status = {},
                                 .stop = stop.get_token()});
  const AdminPage page = administration.answer(fleet::question(AdminVerb::ResetTask, "shelf"),
                                               "otto 1", named("otto", AccessRole::Operator));
  EXPECT_EQ(page.status, AdminStatus::Failed) << "it can be asked for again";
  EXPECT_NE(page.message.find("the server is stopping after"), std::string::npos) << page.message;
  EXPECT_EQ(log_entries(), (Lines{"otto reset_task shelf begun", "otto reset_task shelf failed"}));
}

TEST_F(Audit, AJobThatNeverRanHasItsEndInTheLog) {
  const Caller otto = named("otto", AccessRole::Operator),
               anna = named("anna", AccessRole::Operator);
  begin_held_job(otto);
  const AdminPage waiting = ask(anna, AdminVerb::Backup, "never.db");
  ASSERT_EQ(waiting.status, AdminStatus::Ok) << waiting.message;
  ask(anna, AdminVerb::CancelJob, std::get<Job>(waiting.rows[0]).id);
  EXPECT_EQ(log_entries().back(), "anna backup never.db failed");
  EXPECT_EQ(real_store_->list_audit("anna", "", 1).rows.at(0).message, "cancelled before it began");
  ASSERT_EQ(ask(anna, AdminVerb::Backup, "late.db").status, AdminStatus::Ok);
  troubled_->on_audit = [this](const AuditEntry& entry) {
    if (entry.target == "late.db")
      let_go();  // the server is stopping, which waits for the job that runs
  };
  service_->shutdown();
  EXPECT_EQ(real_store_->list_audit("anna", "", 1).rows.at(0).message, "the server is stopping");
  const Lines all = log_entries();
  EXPECT_EQ(std::ranges::count(all, "anna backup late.db failed"), 1);
  EXPECT_EQ(std::ranges::count_if(all, [](const auto& line) { return line.ends_with("begun"); }),
            3);
}

TEST_F(Audit, CancellingIsInTheLogWhereItIsAnothersJobThatRuns) {
  const Caller otto = named("otto", AccessRole::Operator),
               anna = named("anna", AccessRole::Operator);
  const std::string job = begin_held_job(otto);
  const AdminRequest cancel = fleet::question(AdminVerb::CancelJob, job);
  for (int i = 0; i < 2; ++i)  // sent again, as after a lost reply
    EXPECT_EQ(ask_for(anna, cancel, "anna 1").status, AdminStatus::Ok);
  const Lines cancelled = {"otto backup held.db begun", "anna cancel_job " + job + " begun",
                           "anna cancel_job " + job + " done"};
  EXPECT_EQ(log_entries(), cancelled);
  ask(otto, AdminVerb::CancelJob, job);
  EXPECT_EQ(log_entries(), cancelled) << "its own";
  let_go();
  EXPECT_EQ(end_of(job).state, JobState::Cancelled);
  const std::size_t entries = log_entries().size();
  ask(anna, AdminVerb::CancelJob, job);
  EXPECT_EQ(log_entries().size(), entries) << "it has ended";
}

TEST_F(Audit, ABackupThatIsReadWithoutHavingBeenDigestedIsInTheLogOnce) {
  make_backup("copy.db");
  const Caller otto = named("otto", AccessRole::Operator);
  for (const char* const cursor : {"100", "", "4096"})
    EXPECT_EQ(read_backup(otto, cursor).status, AdminStatus::Ok);
  EXPECT_EQ(log_entries(), Lines{"otto read_backup copy.db done"});
  EXPECT_NE(real_store_->list_audit("", "", 1).rows.at(0).after.find("from byte 100 on"),
            std::string::npos);
  EXPECT_EQ(read_backup(named("olga", AccessRole::Operator), "").status, AdminStatus::Ok);
  EXPECT_EQ(log_entries().back(), "olga read_backup copy.db done");
  start();
  read_backup(otto, "100");
  EXPECT_EQ(log_entries().size(), 3U) << "another server does not know what was before it";
  // Another file of that name.
  std::filesystem::remove(directory_ / "copy.db");
  report({fleet::solved(*teacher_, "shelf", 1)});
  make_backup("copy.db");
  read_backup(otto, "");
  EXPECT_EQ(log_entries().size(), 4U);
}

TEST_F(Audit, ADigestedBackupIsReadWithoutFurtherEntries) {
  make_backup("copy.db");
  const Caller otto = named("otto", AccessRole::Operator);
  const AdminPage digest = ask(otto, AdminVerb::HashBackup, "copy.db");
  ASSERT_EQ(digest.status, AdminStatus::Ok) << digest.message;
  end_of(std::get<Job>(digest.rows[0]).id);
  read_backup(otto, "");
  EXPECT_EQ(log_entries(),
            (Lines{"otto hash_backup copy.db begun", "otto hash_backup copy.db done"}));
}

TEST_F(Audit, NoBackupIsReadThatCannotBeKeptInTheLog) {
  make_backup("copy.db");
  troubled_->on_audit = [](const AuditEntry&) {
    throw Failure(ErrorCode::Storage, "no space is left");
  };
  const AdminPage page = read_backup(named("otto", AccessRole::Operator), "");
  EXPECT_EQ(page.status, AdminStatus::Failed);
  EXPECT_TRUE(page.rows.empty());
}

TEST_F(Audit, ADownloadForgetsNoAnswersOfOthers) {
  make_backup("copy.db");
  AdminRequest rename = fleet::question(AdminVerb::RenameRobot, "giant");
  rename.robot = "dwarf";
  const Caller root = named("root", AccessRole::Admin);
  ASSERT_EQ(ask_for(root, rename, "root 1").status, AdminStatus::Ok);
  const Caller otto = named("otto", AccessRole::Operator);
  for (std::size_t i = 0; i <= AnsweredChanges::kKept; ++i)
    ask_for(otto, fleet::question(AdminVerb::ReadBackup, "copy.db"), "otto " + std::to_string(i));
  EXPECT_EQ(ask_for(root, rename, "root 1").status, AdminStatus::Ok);
}

TEST(AnsweredChanges, AreBoundedByTheirBytes) {
  AnsweredChanges answered;
  AdminPage page;
  page.status = AdminStatus::Ok;
  page.rows.emplace_back(TextLine{std::string(AnsweredChanges::kKeptBytes / 4, 'x')});
  for (int i = 0; i < 20; ++i)
    answered.keep("request " + std::to_string(i), page);
  EXPECT_LE(answered.bytes(), AnsweredChanges::kKeptBytes);
  EXPECT_TRUE(answered.find("request 19"));
  EXPECT_FALSE(answered.find("request 0"));
  page.rows.emplace_back(TextLine{std::string(AnsweredChanges::kKeptBytes, 'x')});
  answered.keep("larger", page);
  EXPECT_FALSE(answered.find("larger"));
  EXPECT_TRUE(answered.find("request 19"));
}

}  // namespace
}  // namespace kinship::service::audit_test
