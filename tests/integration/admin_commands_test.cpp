// What people do with `kinship`, as a process, against kinshipd as a process.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "proto/json/admin_rows_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "tests/integration/admin_commands.hpp"
#include "tests/support/places.hpp"

namespace kinship::admin_commands_test {
namespace {

/// The verbs that the help of a command lists.
std::vector<std::string> verbs_of(std::vector<std::string> words) {
  words.emplace_back("--help");
  const std::string help = test::run_to_end("kinship", words).out;
  std::vector<std::string> verbs;
  const std::string heading = "\nSubcommands:\n";
  const std::size_t list = help.find(heading);
  std::istringstream lines(list == std::string::npos ? "" : help.substr(list + heading.size()));
  for (std::string line; std::getline(lines, line) && !line.empty();)
    if (line.starts_with("  ") && std::isalpha(static_cast<unsigned char>(line[2])) != 0)
      verbs.push_back(line.substr(2, line.find(' ', 2) - 2));
  return verbs;
}

TEST_F(AdminCommands, EveryListingIsATableAndADocument) {
  teach(server_);
  std::set<std::string> seen;
  for (const std::string& noun : verbs_of({}))
    for (const std::string& verb : verbs_of({noun})) {
      if (test::run_to_end("kinship", {noun, verb, "--help"}).out.find("Rows at most") ==
          std::string::npos)
        continue;
      seen.insert(noun);
      const Answer table = server_.kinship(noun + ' ' + verb + " -o wide");
      EXPECT_EQ(table.code, 0) << noun << ' ' << verb << ": " << table.err;
      const Answer document = server_.kinship(noun + ' ' + verb + " --json");
      EXPECT_EQ(document.code, 0) << noun << ' ' << verb << ": " << document.err;
      const auto rows = nlohmann::json::parse(document.out).at("rows").size();
      EXPECT_EQ(count_lines(table.out), rows + 1) << table.out;  // headings, or (none)
    }
  EXPECT_EQ(seen, (std::set<std::string>{"attempts", "backup", "distributions", "jobs", "paths",
                                         "robots", "tasks"}));
}

TEST_F(AdminCommands, ARobotThatBreaksARuleIsWrongUsage) {
  const std::string model = test::source_dir() + "/robots/models/ur10e/robot.urdf";
  expect_has(
      server_.ends(2, "robots register " + model + " --base nowhere --tip tool0 --label arm").err,
      "nowhere");
}

TEST_F(AdminCommands, WhatIsExportedTeachesAnEmptyServerAndOnlyOnce) {
  teach(server_);
  server_.ends(0, "paths export --output " + file("all.jsonl"));
  EXPECT_EQ(count_lines(test::read_text(folder_ / "all.jsonl")), 8U);  // panda and seven attempts

  const Server empty(folder_ / "empty.db");
  const Answer first = empty.ends(0, "paths import " + file("all.jsonl") + " --json");
  EXPECT_EQ(first.out,
            "{\"format\":\"kinship.path-import/"
            "1\",\"robots\":1,\"stored\":6,\"known\":0,\"recorded\":1,\"refused\":0}\n");
  const Answer again = empty.ends(0, "paths import " + file("all.jsonl") + " --json");
  EXPECT_EQ(again.out,
            "{\"format\":\"kinship.path-import/"
            "1\",\"robots\":1,\"stored\":0,\"known\":7,\"recorded\":0,\"refused\":0}\n");

  const Answer copy = empty.ends(0, "paths export");
  EXPECT_EQ(copy.out, test::read_text(folder_ / "all.jsonl"));
}

TEST_F(AdminCommands, ABrokenLineInTheMiddleIsNamedAndTheOthersArrive) {
  teach(server_);
  std::istringstream lines(server_.kinship("paths export --task sweep").out);
  std::ofstream broken(folder_ / "broken.jsonl");
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number)
    broken << (number == 4 ? line.substr(0, line.size() / 2) : line) << '\n';
  broken.close();
  const Server empty(folder_ / "empty.db");
  const Answer answer = empty.ends(1, "paths import " + file("broken.jsonl") + " --json");
  expect_has(answer.err, "line 4: ");
  expect_has(answer.out, "\"refused\":1");
  EXPECT_EQ(count_lines(empty.kinship("paths export").out), 7U);
}

TEST_F(AdminCommands, ImportKnowsRobotsByLabelAndNamesThoseItDoesNotKnow) {
  teach(server_);
  std::istringstream lines(server_.kinship("paths export").out);
  std::ofstream labelled(folder_ / "labelled.jsonl");
  const std::string digest = attempts_.front().robot.hex();
  std::string line;
  std::getline(lines, line);
  labelled << line << "\n\n";
  for (int number = 0; std::getline(lines, line); ++number)
    labelled << line.replace(line.find(digest), digest.size(), number == 2 ? "nobody" : "panda")
             << '\n';
  labelled.close();
  const Server empty(folder_ / "empty.db");
  const Answer answer = empty.ends(1, "paths import " + file("labelled.jsonl"));
  expect_has(answer.err, "line 5: ");  // the blank one counts
  expect_has(answer.err, "'nobody'");
  EXPECT_EQ(count_lines(empty.kinship("paths export").out), 7U);
}

TEST_F(AdminCommands, ARetiredPathIsListedAsSuchAndNotExported) {
  teach(server_);
  const std::string id = attempts_.front().report_uuid.text();
  expect_has(server_.ends(2, "paths retire " + id).err, "would retire the path of " + id);
  EXPECT_NE(server_.kinship("paths export").out.find(id), std::string::npos);
  const Answer retired = server_.ends(0, "paths retire " + id.substr(0, 13) + " --yes");
  expect_has(retired.out, "1 path of task 'sweep' retired");
  expect_has(server_.ends(0, "paths retire " + id + " --yes").out, "retired already");
  EXPECT_EQ(server_.kinship("paths export").out.find(id), std::string::npos);
  expect_has(server_.ends(0, "paths list --json").out, "\"retired_ms\":1");
  server_.ends(3, "paths retire " + Uuid::random().text() + " --yes");
  server_.ends(2, "paths retire seven --yes");

  const Answer restored = server_.ends(0, "paths restore " + id + " --json");
  EXPECT_EQ(json::row_from_json<Restoration>(restored.out).value_or_throw().paths, 1U);
  EXPECT_EQ(count_lines(server_.kinship("paths export").out), 8U);
  expect_has(server_.ends(0, "paths restore " + id).out, "1 in use already");
  server_.ends(2, "paths restore");
  server_.ends(3, "paths restore " + Uuid::random().text());
}

TEST_F(AdminCommands, ATaskIsRenamedAndRemovedAndAWrongNameIsAnsweredWithTheNearest) {
  teach(server_);
  expect_has(server_.ends(3, "tasks show swep").err, "did you mean 'sweep'");
  expect_has(server_.ends(3, "tasks experience swep").err, "did you mean 'sweep'");
  expect_has(server_.ends(3, "distributions fetch --task swep --robot panda").err,
             "did you mean 'sweep'");
  expect_has(server_.ends(3, "robots show pandar").err, "did you mean 'panda'");
  expect_has(server_.ends(3, "paths restore --task sweep").out, "0 paths of task 'sweep' restored");
  expect_has(server_.ends(0, "tasks rename sweep swipe").out,
             "is called 'swipe' now, with 6 paths");
  server_.ends(3, "tasks show sweep");
  server_.ends(0, "distributions fetch --task swipe --robot panda");
  server_.ends(2, "tasks rename swipe no/name");
  expect_has(server_.ends(2, "tasks remove swipe").err, "would retire 6 paths of 'swipe'");
  const Answer removed = server_.ends(0, "tasks remove swipe --yes --json");
  EXPECT_EQ(json::row_from_json<TaskRemoval>(removed.out).value_or_throw().attempts, 7U);
  EXPECT_EQ(server_.ends(0, "tasks list").out, "(none)\n");
  server_.ends(3, "distributions fetch --task swipe --robot panda");
  expect_has(server_.ends(0, "paths restore --task swipe").out, "6 paths of task 'swipe' restored");
  server_.ends(0, "tasks show swipe");
  EXPECT_EQ(server_.kinship("status").out.find("admin verb"), std::string::npos);
}

TEST_F(AdminCommands, CallsOfOneProgramAreOneClient) {
  teach(server_);
  for (int i = 0; i < 3; ++i)
    server_.ends(0, "tasks list");
  server_.ends(3, "tasks show nothing");
  const Answer table = server_.ends(0, "status --clients");
  std::istringstream lines(table.out);
  std::string row;
  while (std::getline(lines, row) && !row.starts_with("kinship on "))
    continue;
  std::istringstream words(row);
  std::string name, on, host;
  int calls = 0;
  words >> name >> on >> host >> calls;
  EXPECT_GE(calls, 5) << table.out;
  expect_has(server_.ends(0, "status --clients --json").out, "\"program\":\"kinship\"");
}

TEST_F(AdminCommands, TheExperienceOfATaskIsListed) {
  teach(server_);
  const Answer table = server_.ends(0, "tasks experience sweep");
  EXPECT_EQ(count_lines(table.out), 8U) << table.out;
  expect_has(table.out, "\npanda ");
  expect_has(table.out, "\n6 of 6 paths\n");
  const std::string two = std::to_string(2 * experience_bytes(kExperiencePoses));
  const Answer few = server_.kinship("tasks experience sweep --max-bytes " + two);
  expect_has(few.out, "\n2 of 6 paths\n");
  const Answer document = server_.ends(0, "tasks experience sweep --json --max-bytes " + two);
  EXPECT_EQ(document.out.find(R"({"format":"kinship.task-experience/1","revision":")"), 0U)
      << document.out;
  expect_has(document.out, "\"paths_known\":6,\"paths\":[{\"path\":\"");
  server_.ends(3, "tasks experience dance");
  server_.ends(2, "tasks experience sweep --max-bytes 0");
}

TEST_F(AdminCommands, ATaskIsResetOnlyWhenThatIsMeant) {
  teach(server_);
  expect_has(server_.ends(2, "tasks reset sweep").err, "would retire 6 paths of 1 robot:");
  EXPECT_EQ(count_lines(server_.kinship("paths export").out), 8U);
  const Answer reset = server_.ends(0, "tasks reset sweep --yes --json");
  EXPECT_EQ(json::row_from_json<Retirement>(reset.out).value_or_throw().paths, 6U);
  EXPECT_EQ(server_.kinship("paths export").out.find("\"solved\""), std::string::npos);
  server_.ends(3, "distributions fetch --task sweep --robot ur10e");
  server_.ends(3, "tasks reset dance --yes");
  const Answer again = server_.ends(0, "tasks reset sweep");
  EXPECT_EQ(again.out, "nothing to do: retired already\n");
  const Answer document = server_.ends(0, "tasks reset sweep --json");
  EXPECT_EQ(json::row_from_json<Retirement>(document.out).value_or_throw().paths, 0U);
}

TEST_F(AdminCommands, ABackupOfARunningServerIsAStore) {
  teach(server_);
  const Answer backup = server_.ends(0, "backup copy.db --json");
  const Job job = json::row_from_json<Job>(backup.out).value_or_throw();
  EXPECT_EQ(job.state, JobState::Done);
  expect_has(server_.ends(0, "jobs list").out, job.id);
  server_.ends(0, "jobs wait " + job.id);
  server_.ends(3, "jobs wait 00000000");
  const Server copy(folder_ / "copy.db");
  EXPECT_EQ(copy.kinship("paths export").out, server_.kinship("paths export").out);
  EXPECT_NE(server_.kinship("backup copy.db").code, 0);  // it is there already
}

TEST_F(AdminCommands, ADistributionIsMadeOfChosenSourcesAndForgotten) {
  teach(server_);
  expect_has(
      server_.ends(0, "distributions fetch --task sweep --robot ur10e --sources panda --wait 100")
          .out,
      "only of " + attempts_.front().robot.short_hex());
  server_.ends(3, "distributions fetch --task sweep --robot ur10e --sources nobody");
  const Answer later =
      server_.kinship("distributions fetch --task sweep --robot ur10e --since 2100-01-01");
  EXPECT_NE(later.code, 0) << later.out;
  const Answer listed = server_.kinship("distributions list --json --limit 1");
  const std::string id = listed.out.substr(listed.out.find("\"id\":\"") + 6, 64);
  server_.ends(0, "distributions evict " + id);
  server_.ends(3, "distributions show " + id);
}

TEST_F(AdminCommands, KernelsAreFetchedSampledExplainedAndKept) {
  teach(server_);
  const auto fetch = [&](const std::string& also) {
    return server_.ends(
        0, "distributions fetch --task sweep --robot ur10e --wait 100 --estimator kde" + also);
  };
  const Answer fetched = fetch(" --json");
  const Distribution kernels = json::distribution_from_json(fetched.out).value_or_throw();
  EXPECT_EQ(kernels.profile, "default,estimator=kde");
  ASSERT_TRUE(kernels.mixture && kernels.mixture->shares_covariance());
  const Eigen::MatrixXd& centres = kernels.mixture->means();
  EXPECT_GT(centres.cols(), 100);
  EXPECT_EQ(centres.cast<float>().cast<double>(), centres);
  const Eigen::VectorXd lower = kernels.limits.row(0).transpose();
  const Eigen::VectorXd upper = kernels.limits.row(1).transpose();
  EXPECT_GE((centres.colwise() - lower).minCoeff(), 0);
  EXPECT_LE((centres.colwise() - upper).maxCoeff(), 0);
  EXPECT_NE(fetch("").out.find("\nbandwidth "), std::string::npos);
  const Answer samples = fetch(" --samples 500");
  EXPECT_EQ(count_lines(samples.out), 501U) << samples.err;
  server_.ends(
      0, "distributions explain --task sweep --robot ur10e --profile default --estimator kde");

  server_.process().terminate();
  server_.start();
  const Answer kept = fetch(" --json");
  const Distribution again = json::distribution_from_json(kept.out).value_or_throw();
  EXPECT_EQ(again.id, kernels.id);
  EXPECT_EQ(again.revision, kernels.revision);
  EXPECT_EQ(again.mixture->means(), centres);
}

TEST_F(AdminCommands, TheConfigurationsOfADistributionAreThoseOfItsFit) {
  teach(server_);
  const std::string wish = " --task sweep --robot ur10e --wait 100 ";
  const Answer fetched = server_.ends(0, "distributions fetch" + wish + "--json");
  const Distribution distribution = json::distribution_from_json(fetched.out).value_or_throw();
  server_.ends(0, "configurations export" + wish + "--output=" + file("rows.csv"));
  const std::string text = test::read_text(folder_ / "rows.csv");
  EXPECT_TRUE(text.starts_with("path_id,source_robot,pose_index,")) << text.substr(0, 200);
  EXPECT_EQ(count_lines(text), distribution.configurations + 1);
  EXPECT_EQ(server_.kinship("configurations export --distribution " + distribution.id.hex()).out,
            text);
  server_.ends(2, "configurations export");
  server_.ends(3, "configurations export --task dance --robot ur10e");
}

TEST_F(AdminCommands, AnExplanationTellsHowADistributionStandsToTheExperienceOfNow) {
  teach(server_);
  const Answer answer =
      server_.ends(0, "distributions explain --task sweep --robot ur10e --wait 100");
  expect_has(answer.out, "is that of the fit");
  expect_has(answer.out, "EXPERIENCE NOW");
  const std::string id = answer.out.substr(answer.out.find("distribution  ") + 14, 12);
  server_.ends(0, "distributions explain --distribution " + id + " --json");
  server_.ends(3, "distributions explain --distribution 0000");
}

TEST_F(AdminCommands, WhatWasRehearsedIsExplainedAndCounted) {
  teach(server_);
  const auto explain = [&](const std::string& also) {
    return server_.ends(0, "distributions explain --task sweep --robot panda --wait 100" + also)
        .out;
  };
  EXPECT_NE(explain("").find("\nnot rehearsed yet: "), std::string::npos);
  const FetchReply reply = fetch_rehearsed(server_);
  ASSERT_TRUE(reply.rehearsal) << reply.message;
  EXPECT_TRUE(reply.rehearsal->is_complete);

  const std::string table = explain("");
  expect_has(table, "\nrehearsed on 6 recorded queries, ");
  expect_has(table, "  chosen\n");
  const Explanation explanation =
      json::row_from_json<Explanation>(explain(" --json")).value_or_throw();
  EXPECT_EQ(explanation.rehearsal, reply.rehearsal);

  const ServerStatus status =
      json::row_from_json<ServerStatus>(server_.kinship("status --json").out).value_or_throw();
  EXPECT_EQ(status.rehearsals, 1U);
  EXPECT_EQ(status.queued_rehearsals, 0U);
  EXPECT_EQ(status.rehearsal_time_s, reply.rehearsal->processor_time_s);
  expect_has(server_.ends(0, "status").out, "\nrehearsals     1 done, 0 queued, ");
}

TEST_F(AdminCommands, RobotsAreComparedByWhatExperienceIsWorthToThem) {
  teach(server_);
  const std::string compare = "robots compare --task sweep --wait 200";
  const Answer panda = server_.ends(0, compare + " --targets panda --progress");
  expect_has(panda.out, "\nTARGET \\ SOURCE  panda\npanda            ");
  expect_has(panda.out, "originally solved a query is excluded, also on the diagonal");
  expect_has(panda.err, "rehearsing 1 of 1: panda with the experience of panda");

  // Nobody knows where the UR10e stands.
  expect_has(server_.ends(1, compare).out,
             "ur10e from panda: where its base stands is not known: --placement");
  expect_has(
      server_.ends(0, compare + " --targets ur10e --placement 'ur10e=0 0 0 0 0 0 1' --json").out,
      "\"queries\":");

  server_.ends(3, compare + " --targets nobody");
  server_.ends(2, compare + " --placement '0 0 0 0 0 0 1'");
  server_.ends(2, compare + " --placement 'nobody=0 0 0 0 0 0 1'");
  server_.ends(3, "robots compare --task unheard");
}

TEST_F(AdminCommands, AServerBelowItsWatermarkOfFreeSpaceSaysSo) {
  const Server full(folder_ / "full.db", {"--free-space-watermark-mb", "1073741824"});  // 1 PB
  const std::string said = full.kinship("status").out;
  expect_has(said, "not writable: the file system at '/");
  expect_has(said, "below 1073741824 MB no report is taken");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "full.db.ballast"));
  const Server well(folder_ / "well.db", {"--ballast-mb", "2"});
  EXPECT_EQ(std::filesystem::file_size(folder_ / "well.db.ballast"), std::uintmax_t{2} << 20U);
}

}  // namespace
}  // namespace kinship::admin_commands_test
