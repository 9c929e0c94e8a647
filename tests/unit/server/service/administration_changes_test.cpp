// The admin verbs that change something, export or begin a job, on a whole service.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "proto/types/limits.hpp"
#include "server/service/backup_files.hpp"
#include "tests/unit/server/service/service_fixture.hpp"

namespace kinship::service::administration_changes_test {
namespace {

class AdministrationChanges : public ServiceFixture {
 protected:
  AdminPage ask(AdminVerb verb, const std::string& argument = "") {
    return administer(fleet::question(verb, argument));
  }
  template <typename Row>
  static const Row& row(const AdminPage& page, std::size_t index = 0) {
    if (page.status != AdminStatus::Ok)
      throw std::runtime_error(page.message);
    return std::get<Row>(page.rows.at(index));
  }
  /// The job that a verb began, when it has ended. Its clock stands still.
  Job end_of(const AdminPage& begun) {
    AdminRequest request = fleet::question(AdminVerb::ShowJob, row<Job>(begun).id);
    request.deadline = std::chrono::seconds(30);
    return row<Job>(administer(request));
  }
  std::vector<std::string> rows_of(const std::string& job, std::uint32_t limit) {
    AdminRequest request = fleet::question(AdminVerb::JobRows, job);
    request.limit = limit;
    std::vector<std::string> rows;
    do {
      const AdminPage page = administer(request);
      for (std::size_t i = 0; i < page.rows.size(); ++i)
        rows.push_back(row<TextLine>(page, i).text);
      request.cursor = page.next_cursor;
    } while (!request.cursor.empty());
    return rows;
  }
  std::vector<AdminRow> export_all(const std::string& robot, const std::string& task,
                                   std::uint32_t limit) {
    AdminRequest request = fleet::question(AdminVerb::ExportPaths);
    request.robot = robot;
    request.task = task;
    request.limit = limit;
    std::vector<AdminRow> rows;
    do {
      AdminPage page = administer(request);
      EXPECT_EQ(page.status, AdminStatus::Ok) << page.message;
      EXPECT_LE(page.rows.size(), limit);
      std::move(page.rows.begin(), page.rows.end(), std::back_inserter(rows));
      request.cursor = page.next_cursor;
    } while (!request.cursor.empty());
    return rows;
  }
  static AdminRequest restoration_of(const std::string& task) {
    AdminRequest request = fleet::question(AdminVerb::RestorePath);
    request.task = task;
    return request;
  }
  Distribution fetched(const std::string& profile = "default") {
    FetchRequest request = request_for(pupil_);
    request.profile = profile;
    const FetchReply reply = fetch(request);
    if (!reply.distribution)
      throw std::runtime_error(reply.message);
    return *reply.distribution;
  }
};

TEST_F(AdministrationChanges, AnExportBeginsWithTheRobotsItNeeds) {
  report(fleet::solved(teacher_, "shelf", 3, 1));
  report(fleet::solved(pupil_, "shelf", 2, 1));
  report({fleet::unsolved(pupil_.digest, "bin")});
  for (const std::uint32_t limit : {1U, 2U, 100U}) {
    const std::vector<AdminRow> rows = export_all("", "shelf", limit);
    ASSERT_EQ(rows.size(), 7U);
    std::set<std::string> labels;
    for (std::size_t i = 0; i < 2; ++i)
      labels.insert(std::get<ExportedRobot>(rows[i]).description.label);
    EXPECT_EQ(labels, (std::set<std::string>{"pupil", "teacher"}));
    for (std::size_t i = 2; i < rows.size(); ++i)
      EXPECT_TRUE(std::get<Attempt>(rows[i]).path);
  }
  EXPECT_EQ(export_all("teacher", "", 100).size(), 4U);
  EXPECT_EQ(export_all("", "", 100).size(), 2U + 6U);
  EXPECT_EQ(export_all("dwarf", "", 100).size(), 0U);
}

TEST_F(AdministrationChanges, ARetiredPathIsNotExported) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 2, 1);
  report(attempts);
  const AdminPage page = ask(AdminVerb::RetirePath, attempts[0].report_uuid.text());
  EXPECT_EQ(row<Retirement>(page).paths, 1U);
  EXPECT_EQ(row<Retirement>(page).task, "shelf");
  EXPECT_EQ(row<Retirement>(ask(AdminVerb::RetirePath, attempts[0].report_uuid.text())).paths, 0U);
  const std::vector<AdminRow> rows = export_all("", "shelf", 100);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(std::get<Attempt>(rows[1]).report_uuid, attempts[1].report_uuid);
  EXPECT_NE(log().find("task 'shelf': path " + attempts[0].report_uuid.text()), std::string::npos);
}

TEST_F(AdministrationChanges, ARestoredPathIsInUseAgainUnderAUuidOfItsOwn) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 3, 1);
  report(attempts);
  const std::string uuid = attempts[0].report_uuid.text();
  ASSERT_EQ(ask(AdminVerb::RetirePath, uuid).status, AdminStatus::Ok);
  const Restoration restored = row<Restoration>(ask(AdminVerb::RestorePath, uuid));
  EXPECT_EQ(restored.task, "shelf");
  EXPECT_EQ(restored.paths, 1U);
  EXPECT_EQ(restored.in_use + restored.lost, 0U) << restored.reason;
  const Attempt again = row<Attempt>(ask(AdminVerb::ShowPath, restored.report_uuid.text()));
  EXPECT_EQ(again.path->waypoints(), attempts[0].path->waypoints());
  EXPECT_NE(again.record.planner_options.find(uuid), std::string::npos);
  EXPECT_EQ(again.record.sampling_mode, SamplingMode::Uniform) << "evidence counts once";
  EXPECT_EQ(row<TaskSummary>(ask(AdminVerb::ShowTask, "shelf")).paths, 3U);
  const Restoration known = row<Restoration>(ask(AdminVerb::RestorePath, uuid));
  EXPECT_EQ(known.paths, 0U);
  EXPECT_EQ(known.in_use, 1U);
  // The restored one may be retired, and the first one restored once more.
  ASSERT_EQ(ask(AdminVerb::RetirePath, restored.report_uuid.text()).status, AdminStatus::Ok);
  EXPECT_EQ(row<Restoration>(ask(AdminVerb::RestorePath, uuid)).paths, 1U);
  EXPECT_EQ(row<TaskSummary>(ask(AdminVerb::ShowTask, "shelf")).paths, 3U);
}

TEST_F(AdministrationChanges, AResetTaskIsRestoredWhole) {
  report(fleet::solved(teacher_, "shelf", 4, 1));
  report({fleet::unsolved(teacher_.digest, "shelf")});
  ASSERT_EQ(ask(AdminVerb::ResetTask, "shelf").status, AdminStatus::Ok);
  AdminRequest request = restoration_of("shelf");
  EXPECT_EQ(row<Restoration>(administer(request)).paths, 4U);
  EXPECT_EQ(row<TaskSummary>(ask(AdminVerb::ShowTask, "shelf")).paths, 4U);
  const Restoration again = row<Restoration>(administer(request));
  EXPECT_EQ(again.paths, 0U);
  EXPECT_EQ(again.in_use, 4U);
  EXPECT_EQ(ask(AdminVerb::RestorePath).status, AdminStatus::Refused) << "all of everything";
}

TEST_F(AdministrationChanges, ARenamedTaskKeepsItsPathsAndAnOldReportItsName) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "lod", 2, 1);
  report(attempts);
  report(fleet::solved(teacher_, "table", 1, 9));
  AdminRequest request = fleet::question(AdminVerb::RenameTask, "load");
  request.task = "lod";
  EXPECT_EQ(row<TaskSummary>(administer(request)).paths, 2U);
  EXPECT_EQ(ask(AdminVerb::ShowTask, "lod").status, AdminStatus::NotFound);
  EXPECT_EQ(row<Attempt>(ask(AdminVerb::ShowPath, attempts[0].report_uuid.text())).task, "load");
  EXPECT_EQ(report({attempts[0]}).receipts.at(0).status, ReceiptStatus::Duplicate) << "sent again";
  EXPECT_EQ(report(fleet::solved(teacher_, "lod", 1, 5)).receipts.at(0).status,
            ReceiptStatus::Stored);
  EXPECT_EQ(row<TaskSummary>(ask(AdminVerb::ShowTask, "lod")).paths, 1U);
  const AdminPage onto = administer(request);
  EXPECT_EQ(onto.status, AdminStatus::Refused);
  EXPECT_NE(onto.message.find("'load' exists"), std::string::npos) << onto.message;
  request.argument = "no name";
  EXPECT_EQ(administer(request).status, AdminStatus::Refused);
}

TEST_F(AdministrationChanges, ARemovedTaskIsListedAgainOnceItIsReported) {
  report(fleet::solved(teacher_, "lod", 2, 1));
  report(fleet::solved(teacher_, "shelf", 1, 9));
  const TaskRemoval removal = row<TaskRemoval>(ask(AdminVerb::RemoveTask, "lod"));
  EXPECT_EQ(removal.paths, 2U);
  EXPECT_EQ(removal.attempts, 2U);
  EXPECT_EQ(ask(AdminVerb::ListTasks).rows.size(), 1U);
  EXPECT_EQ(ask(AdminVerb::RemoveTask, "lod").status, AdminStatus::NotFound);
  report(fleet::solved(teacher_, "lod", 1, 5));
  EXPECT_EQ(row<TaskSummary>(ask(AdminVerb::ShowTask, "lod")).paths, 1U);
  EXPECT_EQ(ask(AdminVerb::ListTasks).rows.size(), 2U);
  ASSERT_EQ(ask(AdminVerb::RemoveTask, "lod").status, AdminStatus::Ok);
  AdminRequest request = restoration_of("lod");
  EXPECT_EQ(row<Restoration>(administer(request)).paths, 3U);
  EXPECT_EQ(row<TaskSummary>(ask(AdminVerb::ShowTask, "lod")).paths, 3U);
  request.task = "lud";
  EXPECT_EQ(administer(request).status, AdminStatus::NotFound);
}

TEST_F(AdministrationChanges, ARemovedTaskIsRestoredAndListedAgain) {
  report(fleet::solved(teacher_, "lod", 2, 1));
  ASSERT_EQ(ask(AdminVerb::RemoveTask, "lod").status, AdminStatus::Ok);
  AdminRequest request = restoration_of("lid");
  EXPECT_EQ(administer(request).status, AdminStatus::NotFound);
  request.task = "lod";
  EXPECT_EQ(row<Restoration>(administer(request)).paths, 2U);
  EXPECT_EQ(row<TaskSummary>(ask(AdminVerb::ShowTask, "lod")).paths, 2U);
}

TEST_F(AdministrationChanges, ATaskWithoutPathsIsRestoredOnlyWhileItIsThere) {
  report({fleet::unsolved(teacher_.digest, "bin")});
  AdminRequest request = restoration_of("bin");
  EXPECT_EQ(row<Restoration>(administer(request)).paths, 0U);
  ASSERT_EQ(ask(AdminVerb::RemoveTask, "bin").status, AdminStatus::Ok);
  EXPECT_EQ(administer(request).status, AdminStatus::NotFound);
}

TEST_F(AdministrationChanges, GuidanceFollowsWhatIsRenamedRemovedAndRestored) {
  report(fleet::solved(teacher_, "shelf", 4, 1));
  const auto status_of = [this](const std::string& task) {
    FetchRequest request = request_for(pupil_);
    request.task = task;
    return fetch(request).status;
  };
  ASSERT_EQ(status_of("shelf"), FetchStatus::Ready);
  AdminRequest rename = fleet::question(AdminVerb::RenameTask, "rack");
  rename.task = "shelf";
  ASSERT_EQ(administer(rename).status, AdminStatus::Ok);
  EXPECT_EQ(status_of("shelf"), FetchStatus::NoExperience);
  EXPECT_EQ(status_of("rack"), FetchStatus::Ready);
  ASSERT_EQ(ask(AdminVerb::RemoveTask, "rack").status, AdminStatus::Ok);
  EXPECT_EQ(status_of("rack"), FetchStatus::NoExperience);
  ASSERT_EQ(row<Restoration>(administer(restoration_of("rack"))).paths, 4U);
  EXPECT_EQ(status_of("rack"), FetchStatus::Ready);
}

TEST_F(AdministrationChanges, RestoredPathsKeepTheirOrder) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 3, 1);
  for (const Attempt& attempt : attempts)
    report({attempt});
  ASSERT_EQ(ask(AdminVerb::ResetTask, "shelf").status, AdminStatus::Ok);
  ASSERT_EQ(row<Restoration>(administer(restoration_of("shelf"))).paths, 3U);
  const std::vector<AdminRow> rows = export_all("teacher", "shelf", 100);
  ASSERT_EQ(rows.size(), 1U + attempts.size());
  for (std::size_t i = 0; i < attempts.size(); ++i)
    EXPECT_EQ(std::get<Attempt>(rows[i + 1]).path->waypoints(), attempts[i].path->waypoints());
}

TEST_F(AdministrationChanges, AnUnknownNameIsAnsweredWithTheNearest) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "load_machine", 1, 1);
  report(attempts);
  EXPECT_EQ(ask(AdminVerb::ShowTask, "lod_machine").message,
            "no task 'lod_machine' (did you mean 'load_machine'?)");
  EXPECT_EQ(ask(AdminVerb::ShowRobot, "techer").message,
            "no robot 'techer' (did you mean 'teacher'?)");
  FetchRequest request = request_for(pupil_);
  request.task = "lod_machine";
  EXPECT_EQ(fetch(request).message,
            "no paths of task 'lod_machine' (did you mean 'load_machine'?)");
  const std::string uuid = attempts[0].report_uuid.text();
  EXPECT_EQ(row<Attempt>(ask(AdminVerb::ShowPath, uuid.substr(0, 8))).report_uuid,
            attempts[0].report_uuid);
  EXPECT_EQ(ask(AdminVerb::ShowPath, uuid.substr(0, 7)).status, AdminStatus::Refused);
  EXPECT_EQ(ask(AdminVerb::ShowPath, "ffffffff").status, AdminStatus::NotFound);
  for (const TroubleCount& trouble : service_->status().troubles)
    EXPECT_NE(trouble.what, "admin verb refused") << trouble.last;
}

TEST_F(AdministrationChanges, ABackupNeverTouchesWhatIsThere) {
  std::ofstream(directory_ / "thesis.txt") << "irreplaceable";
  std::filesystem::create_symlink("nowhere", directory_ / "link");
  std::filesystem::create_directory(directory_ / "folder");
  const auto answer = [this](const std::string& name) {
    const AdminPage page = ask(AdminVerb::Backup, name);
    EXPECT_EQ(page.status, AdminStatus::Refused) << name;
    return page.message;
  };
  for (const std::string name : {"thesis.txt", "link", "folder"})
    EXPECT_NE(answer(name).find(name + "': is there already"), std::string::npos) << answer(name);
  for (const std::string name : {"fleet.db", "fleet.db-journal", "fleet.db.backup-4"})
    EXPECT_NE(answer(name).find("is a name of the store"), std::string::npos) << answer(name);
  EXPECT_NE(answer("copy.db.part").find("is being written"), std::string::npos);
  EXPECT_TRUE(ask(AdminVerb::ListJobs).rows.empty());
  std::ifstream thesis(directory_ / "thesis.txt");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(thesis), {}), "irreplaceable");
}

TEST_F(AdministrationChanges, ABackupHasABareNameAndStaysInItsFolder) {
  const test::TemporaryDirectory elsewhere;
  std::filesystem::create_directory(directory_ / "backups");
  std::filesystem::create_directory_symlink(elsewhere.path(), directory_ / "backups" / "out");
  adjust_ = [this](ServiceOptions& options) { options.backups.folder = directory_ / "backups"; };
  start();
  for (const std::string& name :
       {(elsewhere / "copy.db").string(), (directory_ / "backups" / "copy.db").string(),
        std::string("../copy.db"), std::string("out/copy.db"), std::string(".."), std::string(""),
        std::string(".copy.db"), std::string("-copy.db"), std::string("a b"), std::string("a\nb"),
        std::string(129, 'a')})
    for (const AdminVerb verb : {AdminVerb::Backup, AdminVerb::HashBackup, AdminVerb::ReadBackup}) {
      const AdminPage page = ask(verb, name);
      EXPECT_EQ(page.status, AdminStatus::Refused) << name;
      EXPECT_NE(page.message.find("is no bare name"), std::string::npos) << page.message;
      EXPECT_NE(page.message.find("--backup-folder"), std::string::npos);
    }
  const Job job = end_of(ask(AdminVerb::Backup, "monday.db"));
  EXPECT_EQ(job.state, JobState::Done) << job.message;
  EXPECT_TRUE(std::filesystem::exists(directory_ / "backups" / "monday.db"));
  std::filesystem::remove_all(directory_ / "backups");
  EXPECT_NE(ask(AdminVerb::Backup, "monday.db").message.find("there is no folder"),
            std::string::npos);
}

TEST(BackupFolder, IsThatOfTheStoreIfTheStoreIsAFile) {
  const std::string database = "postgresql://kinship@db1 (and 1 more)/fleet";
  EXPECT_EQ(folder_of({}, "/srv/fleet.db").value_or_throw(), "/srv");
  EXPECT_EQ(folder_of({.folder = "/backups"}, database).value_or_throw(), "/backups");
  const auto none = folder_of({}, database);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find(database), std::string::npos) << none.error().message;
  EXPECT_NE(none.error().message.find("--backup-folder"), std::string::npos);
}

TEST_F(AdministrationChanges, AnotherProgramsDatabaseIsNoBackup) {
  ASSERT_EQ(end_of(ask(AdminVerb::Backup, "monday.db")).state, JobState::Done);
  std::ifstream copy(directory_ / "monday.db", std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(copy), {}};
  constexpr std::size_t kApplicationAt = 68;  // of SQLite's header
  bytes.replace(bytes.find("KINS", kApplicationAt), 4, 4, '\0');
  std::ofstream(directory_ / "other.db", std::ios::binary) << bytes;
  const AdminPage list = ask(AdminVerb::ListBackups);
  ASSERT_EQ(list.rows.size(), 1U);
  EXPECT_EQ(row<BackupSummary>(list).name, "monday.db");
  for (const AdminVerb verb : {AdminVerb::HashBackup, AdminVerb::ReadBackup})
    EXPECT_EQ(ask(verb, "other.db").status, AdminStatus::NotFound);
}

TEST_F(AdministrationChanges, ABackupWithoutRoomIsRefusedWithBothNumbers) {
  adjust_ = [](ServiceOptions& options) {
    options.backups.free_bytes = [](const std::filesystem::path&) { return std::uint64_t{4096}; };
  };
  start();
  const AdminPage page = ask(AdminVerb::Backup, "copy.db");
  EXPECT_EQ(page.status, AdminStatus::Refused);
  EXPECT_NE(page.message.find("needs up to " + std::to_string(service_->status().store_bytes) +
                              " bytes, but its file system has 4096 left"),
            std::string::npos)
      << page.message;
  EXPECT_FALSE(std::filesystem::exists(directory_ / "copy.db"));
}

TEST_F(AdministrationChanges, ARetiredDistributionIsListedAndShownAsOne) {
  report(fleet::solved(teacher_, "shelf", 6, 1));
  const std::string id = fetched().id.hex();
  EXPECT_FALSE(row<DistributionSummary>(ask(AdminVerb::ListDistributions)).retired);
  EXPECT_EQ(row<Distribution>(ask(AdminVerb::ShowDistribution, id)).reason.find("retired"),
            std::string::npos);
  ask(AdminVerb::ResetTask, "shelf");
  EXPECT_TRUE(row<DistributionSummary>(ask(AdminVerb::ListDistributions)).retired);
  EXPECT_NE(row<Distribution>(ask(AdminVerb::ShowDistribution, id)).reason.find("retired"),
            std::string::npos);
}

TEST_F(AdministrationChanges, ExportSaysWhichConfigurationsWereHeldOut) {
  report(fleet::solved(teacher_, "shelf", 15, 1));
  const Distribution distribution = fetched("default,components=auto");
  ASSERT_FALSE(distribution.component_scores.empty());
  const Job job = end_of(ask(AdminVerb::ExportConfigurations, distribution.id.hex().substr(0, 8)));
  ASSERT_EQ(job.state, JobState::Done) << job.message;
  std::map<std::string, std::set<std::string>> flags_of_path;
  const std::vector<std::string> rows = rows_of(job.id, 1000);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    std::istringstream line(rows[i]);
    std::vector<std::string> fields;
    for (std::string field; std::getline(line, field, ',');)
      fields.push_back(field);
    flags_of_path[fields[0]].insert(fields[5]);
  }
  EXPECT_EQ(flags_of_path.size(), 15U);
  EXPECT_EQ(std::count_if(flags_of_path.begin(), flags_of_path.end(),
                          [](const auto& path) { return path.second.count("1") > 0; }),
            3);  // a fifth of the paths, and whole ones
  for (const auto& [path, flags] : flags_of_path)
    EXPECT_EQ(flags.size(), 1U) << path;
}

TEST_F(AdministrationChanges, ConfigurationsAreExportedExactlyAsTheFitSawThem) {
  report(fleet::solved(teacher_, "shelf", 6, 1));
  report(fleet::solved(pupil_, "shelf", 2, 100));
  const Distribution distribution = fetched();
  report(fleet::solved(teacher_, "shelf", 3, 50));  // later ones do not matter
  const Job job = end_of(ask(AdminVerb::ExportConfigurations, distribution.id.hex().substr(0, 8)));
  ASSERT_EQ(job.state, JobState::Done) << job.message;
  EXPECT_EQ(job.rows, distribution.configurations + 1);
  for (const std::uint32_t limit : {7U, 1000U}) {
    const std::vector<std::string> rows = rows_of(job.id, limit);
    ASSERT_EQ(rows.size(), distribution.configurations + 1);
    EXPECT_EQ(rows[0],
              "path_id,source_robot,pose_index,solution_index,weight,held_out,q_1,q_2,q_3,q_4");
    double sum = 0;
    std::set<std::string> paths;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      std::istringstream line(rows[i]);
      std::vector<std::string> fields;
      for (std::string field; std::getline(line, field, ',');)
        fields.push_back(field);
      ASSERT_EQ(fields.size(), 10U) << rows[i];
      paths.insert(fields[0]);
      EXPECT_TRUE(fields[1] == teacher_.digest.hex() || fields[1] == pupil_.digest.hex());
      EXPECT_EQ(fields[5], "0");
      sum += std::stod(fields[4]);
      for (std::size_t joint = 6; joint < 10; ++joint)
        EXPECT_LE(std::abs(std::stod(fields[joint])), fleet::kLimit_rad);
    }
    EXPECT_NEAR(sum, static_cast<double>(distribution.configurations), 1e-6);
    EXPECT_EQ(paths.size(), 8U);
  }
}

TEST_F(AdministrationChanges, ConfigurationsOfRetiredPathsAreNotExported) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 6, 1);
  report(attempts);
  const Distribution distribution = fetched();
  ask(AdminVerb::RetirePath, attempts[0].report_uuid.text());
  EXPECT_NE(ask(AdminVerb::ExportConfigurations, distribution.id.hex()).status, AdminStatus::Ok);
}

TEST_F(AdministrationChanges, AnEvictedDistributionIsFittedAgainWithTheNextRevision) {
  report(fleet::solved(teacher_, "shelf", 6, 1));
  const Distribution first = fetched();
  const AdminPage page = ask(AdminVerb::EvictDistribution, first.id.hex().substr(0, 12));
  EXPECT_EQ(row<Eviction>(page).id, first.id);
  EXPECT_EQ(ask(AdminVerb::ShowDistribution, first.id.hex()).status, AdminStatus::NotFound);
  EXPECT_EQ(ask(AdminVerb::EvictDistribution, first.id.hex()).status, AdminStatus::NotFound);
  const Distribution second = fetched();
  EXPECT_EQ(second.id, first.id);
  EXPECT_EQ(second.revision, first.revision + 1);
}

TEST_F(AdministrationChanges, AnExplanationSaysHowADistributionStands) {
  report(fleet::solved(teacher_, "shelf", 6, 1));
  const std::string id = fetched().id.hex();
  const Explanation fresh = row<Explanation>(ask(AdminVerb::ExplainDistribution, id));
  EXPECT_FALSE(fresh.behind);
  EXPECT_FALSE(fresh.distribution.mixture);
  ASSERT_EQ(fresh.experience.size(), 1U);
  EXPECT_EQ(fresh.experience[0].label, "teacher");
  EXPECT_EQ(fresh.experience[0].paths, 6U);
  EXPECT_EQ(fresh.next_fit,
            "when the paths have grown by 5, or by 5 % if that is more (6 paths then, 6 now)");
  report(fleet::solved(teacher_, "shelf", 5, 50));
  const Explanation behind = row<Explanation>(ask(AdminVerb::ExplainDistribution, id));
  EXPECT_TRUE(behind.behind);
  EXPECT_TRUE(behind.next_fit.starts_with("in 10 s at the earliest")) << behind.next_fit;
  advance(std::chrono::seconds(10));
  EXPECT_TRUE(row<Explanation>(ask(AdminVerb::ExplainDistribution, id))
                  .next_fit.starts_with("at the next fetch"));
}

TEST_F(AdministrationChanges, AnExplanationGivesTheAdviceOfNow) {
  report(fleet::solved(teacher_, "shelf", 6, 1));
  const std::string id = fetched().id.hex();
  const auto advice_now = [&] {
    const AdminPage page = ask(AdminVerb::ExplainDistribution, id);
    return row<Explanation>(page).distribution.advice;
  };
  // What is read from the store is read in the background.
  const auto advice_without = [&](const char* beginning) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    Advice advice = advice_now();
    while (advice.evidence.starts_with(beginning) && std::chrono::steady_clock::now() < end)
      advice = advice_now();
    return advice;
  };
  advice_without("attempts are being counted");
  std::vector<Attempt> attempts = fleet::solved(pupil_, "shelf", 20, 500);
  for (std::size_t i = 0; i < attempts.size(); ++i) {
    attempts[i].record.sampling_mode = i % 2 == 0 ? SamplingMode::Guided : SamplingMode::Control;
    attempts[i].record.collision_checks = i % 2 == 0 ? 900 + i : 100 + i;
    attempts[i].record.distribution_id = fetched().id;  // what it does not name is judged weakly
  }
  report(attempts);
  const Advice advice = advice_without("default;");
  EXPECT_EQ(advice.recommended_share, 0) << advice.evidence;
  EXPECT_EQ(advice.guided.value().attempts, 10U);
  EXPECT_EQ(advice.control.value().checks_per_solution, 110);
  report(attempts);  // duplicates
  EXPECT_EQ(advice_now().guided.value().attempts, 10U);
  start();  // the store has them, too
  EXPECT_EQ(advice_without("attempts are being counted").evidence, advice.evidence);
}

TEST_F(AdministrationChanges, EventsTellWhatHappened) {
  report(fleet::solved(teacher_, "shelf", 6, 1));
  Attempt bad = fleet::solved(teacher_, "shelf", 9);
  bad.path = fleet::solved(pupil_, "shelf", 9).path;  // of another number of joints
  report({bad});
  fetched();
  ask(AdminVerb::ResetTask, "shelf");
  for (const char* expected :
       {"registered||teacher|", "report|shelf|teacher|6 stored",
        "refusal|||1 of 1 attempts refused", "fit|shelf|pupil|",
        "fetch|shelf|pupil|ready: distribution ", "admin|shelf||reset: 6 paths retired"})
    EXPECT_TRUE(is_told(expected)) << expected << "\nin\n" << events();
}

TEST_F(AdministrationChanges, StatusCountsJobs) {
  EXPECT_EQ(row<ServerStatus>(ask(AdminVerb::Status)).jobs, 0U);
  end_of(ask(AdminVerb::Backup, "copy.db"));
  EXPECT_EQ(row<ServerStatus>(ask(AdminVerb::Status)).jobs, 0U);
}

}  // namespace
}  // namespace kinship::service::administration_changes_test
