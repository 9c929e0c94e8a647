// What people do with `kinship`, as a process, against kinshipd as a process.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "proto/json/admin_rows_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "tests/integration/admin_commands.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::admin_commands_test {
namespace {

/// The verbs that the help of a command lists.
std::vector<std::string> verbs_of(std::vector<std::string> words) {
  words.emplace_back("--help");
  const std::string help = test::run_to_end("kinship", words).out;
  std::vector<std::string> verbs;
  std::istringstream lines(help.substr(std::min(help.find("\nSubcommands:\n"), help.size())));
  for (std::string line; std::getline(lines, line);)
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
      const Answer table = server_.kinship({noun, verb, "-o", "wide"});
      EXPECT_EQ(table.code, 0) << noun << ' ' << verb << ": " << table.err;
      const Answer document = server_.kinship({noun, verb, "--json"});
      EXPECT_EQ(document.code, 0) << noun << ' ' << verb << ": " << document.err;
      const auto rows = nlohmann::json::parse(document.out).at("rows").size();
      EXPECT_EQ(count_lines(table.out), rows + 1) << table.out;  // headings, or (none)
    }
  EXPECT_EQ(seen,
            (std::set<std::string>{"backup", "distributions", "jobs", "paths", "robots", "tasks"}));
}

TEST_F(AdminCommands, WhatIsExportedTeachesAnEmptyServerAndOnlyOnce) {
  teach(server_);
  const Answer exported = server_.kinship({"paths", "export", "--output", file("all.jsonl")});
  ASSERT_EQ(exported.code, 0) << exported.err;
  EXPECT_EQ(count_lines(test::read_text(folder_ / "all.jsonl")), 8U);  // panda and seven attempts

  const Server empty(folder_ / "empty.db");
  const Answer first = empty.kinship({"paths", "import", file("all.jsonl"), "--json"});
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.out, "{\"robots\":1,\"stored\":6,\"known\":0,\"recorded\":1,\"refused\":0}\n");
  const Answer again = empty.kinship({"paths", "import", file("all.jsonl"), "--json"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(again.out, "{\"robots\":1,\"stored\":0,\"known\":7,\"recorded\":0,\"refused\":0}\n");

  const Answer copy = empty.kinship({"paths", "export"});
  EXPECT_EQ(copy.code, 0) << copy.err;
  EXPECT_EQ(copy.out, test::read_text(folder_ / "all.jsonl"));
}

TEST_F(AdminCommands, ABrokenLineInTheMiddleIsNamedAndTheOthersArrive) {
  teach(server_);
  std::istringstream lines(server_.kinship({"paths", "export", "--task", "sweep"}).out);
  std::ofstream broken(folder_ / "broken.jsonl");
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number)
    broken << (number == 4 ? line.substr(0, line.size() / 2) : line) << '\n';
  broken.close();
  const Server empty(folder_ / "empty.db");
  const Answer answer = empty.kinship({"paths", "import", file("broken.jsonl"), "--json"});
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.err.find("line 4: "), std::string::npos) << answer.err;
  EXPECT_NE(answer.out.find("\"refused\":1"), std::string::npos) << answer.out;
  EXPECT_EQ(count_lines(empty.kinship({"paths", "export"}).out), 7U);
}

TEST_F(AdminCommands, ImportKnowsRobotsByLabelAndNamesThoseItDoesNotKnow) {
  teach(server_);
  std::istringstream lines(server_.kinship({"paths", "export"}).out);
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
  const Answer answer = empty.kinship({"paths", "import", file("labelled.jsonl")});
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.err.find("line 5: "), std::string::npos) << answer.err;  // the blank one counts
  EXPECT_NE(answer.err.find("'nobody'"), std::string::npos) << answer.err;
  EXPECT_EQ(count_lines(empty.kinship({"paths", "export"}).out), 7U);
}

TEST_F(AdminCommands, AnExportThatFailsLeavesTheFileOfYesterday) {
  teach(server_);
  std::ofstream(folder_ / "all.jsonl") << "yesterday\n";
  const Answer answer =
      server_.kinship({"paths", "export", "--task", "dance", "--output", file("all.jsonl")});
  EXPECT_EQ(answer.code, 3) << answer.err;
  EXPECT_EQ(test::read_text(folder_ / "all.jsonl"), "yesterday\n");
}

TEST_F(AdminCommands, ARetiredPathIsListedAsSuchAndNotExported) {
  teach(server_);
  const std::string id = attempts_.front().report_uuid.text();
  const Answer retired = server_.kinship({"paths", "retire", id});
  EXPECT_EQ(retired.code, 0) << retired.err;
  EXPECT_NE(retired.out.find("1 path of task 'sweep' retired"), std::string::npos) << retired.out;
  const Answer again = server_.kinship({"paths", "retire", id});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_NE(again.out.find("retired already"), std::string::npos) << again.out;
  EXPECT_EQ(server_.kinship({"paths", "export"}).out.find(id), std::string::npos);
  EXPECT_NE(server_.kinship({"paths", "list", "--json"}).out.find("\"retired_ms\":1"),
            std::string::npos);
  EXPECT_EQ(server_.kinship({"paths", "retire", Uuid::random().text()}).code, 3);
  EXPECT_EQ(server_.kinship({"paths", "retire", "seven"}).code, 2);
}

TEST_F(AdminCommands, TheExperienceOfATaskIsListed) {
  teach(server_);
  const Answer table = server_.kinship({"tasks", "experience", "sweep"});
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_EQ(count_lines(table.out), 8U) << table.out;
  EXPECT_NE(table.out.find("\npanda "), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("\n6 of 6 paths\n"), std::string::npos) << table.out;
  const std::string two = std::to_string(2 * experience_bytes(kExperiencePoses));
  const Answer few = server_.kinship({"tasks", "experience", "sweep", "--max-bytes", two});
  EXPECT_NE(few.out.find("\n2 of 6 paths\n"), std::string::npos) << few.out;
  const Answer document =
      server_.kinship({"tasks", "experience", "sweep", "--json", "--max-bytes", two});
  EXPECT_EQ(document.code, 0) << document.err;
  EXPECT_EQ(document.out.find("{\"revision\":\""), 0U) << document.out;
  EXPECT_NE(document.out.find("\"paths_known\":6,\"paths\":[{\"path\":\""), std::string::npos);
  EXPECT_EQ(server_.kinship({"tasks", "experience", "dance"}).code, 3);
  EXPECT_EQ(server_.kinship({"tasks", "experience", "sweep", "--max-bytes", "0"}).code, 2);
}

TEST_F(AdminCommands, ATaskIsResetOnlyWhenThatIsMeant) {
  teach(server_);
  const Answer asked = server_.kinship({"tasks", "reset", "sweep"});
  EXPECT_EQ(asked.code, 2);
  EXPECT_NE(asked.err.find("would retire 6 paths of 1 robot:"), std::string::npos) << asked.err;
  EXPECT_EQ(count_lines(server_.kinship({"paths", "export"}).out), 8U);
  const Answer reset = server_.kinship({"tasks", "reset", "sweep", "--yes", "--json"});
  EXPECT_EQ(reset.code, 0) << reset.err;
  EXPECT_EQ(json::row_from_json<Retirement>(reset.out).value_or_throw().paths, 6U);
  EXPECT_EQ(server_.kinship({"paths", "export"}).out.find("\"solved\""), std::string::npos);
  const Answer fetched =
      server_.kinship({"distributions", "fetch", "--task", "sweep", "--robot", "ur10e"});
  EXPECT_EQ(fetched.code, 3) << fetched.err;
  EXPECT_EQ(server_.kinship({"tasks", "reset", "dance", "--yes"}).code, 3);
  const Answer again = server_.kinship({"tasks", "reset", "sweep"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(again.out, "nothing to do: retired already\n");
  const Answer document = server_.kinship({"tasks", "reset", "sweep", "--json"});
  EXPECT_EQ(document.code, 0) << document.err;
  EXPECT_EQ(json::row_from_json<Retirement>(document.out).value_or_throw().paths, 0U);
}

TEST_F(AdminCommands, ABackupOfARunningServerIsAStore) {
  teach(server_);
  const Answer backup = server_.kinship({"backup", "copy.db", "--json"});
  ASSERT_EQ(backup.code, 0) << backup.err;
  const Job job = json::row_from_json<Job>(backup.out).value_or_throw();
  EXPECT_EQ(job.state, JobState::Done);
  EXPECT_NE(server_.kinship({"jobs", "list"}).out.find(job.id), std::string::npos);
  EXPECT_EQ(server_.kinship({"jobs", "wait", job.id}).code, 0);
  EXPECT_EQ(server_.kinship({"jobs", "wait", "00000000"}).code, 3);
  const Server copy(folder_ / "copy.db");
  EXPECT_EQ(copy.kinship({"paths", "export"}).out, server_.kinship({"paths", "export"}).out);
  EXPECT_NE(server_.kinship({"backup", "copy.db"}).code, 0);  // it is there already
}

TEST_F(AdminCommands, ADistributionIsMadeOfChosenSourcesAndForgotten) {
  teach(server_);
  const Answer fetched = server_.kinship({"distributions", "fetch", "--task", "sweep", "--robot",
                                          "ur10e", "--sources", "panda", "--wait", "100"});
  ASSERT_EQ(fetched.code, 0) << fetched.err;
  EXPECT_NE(fetched.out.find("only of " + attempts_.front().robot.short_hex()), std::string::npos)
      << fetched.out;
  const Answer nobody = server_.kinship(
      {"distributions", "fetch", "--task", "sweep", "--robot", "ur10e", "--sources", "nobody"});
  EXPECT_EQ(nobody.code, 3) << nobody.err;
  const Answer later = server_.kinship(
      {"distributions", "fetch", "--task", "sweep", "--robot", "ur10e", "--since", "2100-01-01"});
  EXPECT_NE(later.code, 0) << later.out;
  const Answer listed = server_.kinship({"distributions", "list", "--json", "--limit", "1"});
  const std::string id = listed.out.substr(listed.out.find("\"id\":\"") + 6, 64);
  EXPECT_EQ(server_.kinship({"distributions", "evict", id}).code, 0);
  EXPECT_EQ(server_.kinship({"distributions", "show", id}).code, 3);
}

TEST_F(AdminCommands, KernelsAreFetchedSampledExplainedAndKept) {
  teach(server_);
  const auto fetch = [&](const std::vector<std::string>& also) {
    std::vector<std::string> words = {"distributions", "fetch",  "--task", "sweep",       "--robot",
                                      "ur10e",         "--wait", "100",    "--estimator", "kde"};
    words.insert(words.end(), also.begin(), also.end());
    return server_.kinship(words);
  };
  const Answer fetched = fetch({"--json"});
  ASSERT_EQ(fetched.code, 0) << fetched.err;
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
  EXPECT_NE(fetch({}).out.find("\nbandwidth "), std::string::npos);
  const Answer samples = fetch({"--samples", "500"});
  EXPECT_EQ(count_lines(samples.out), 501U) << samples.err;
  const Answer explained =
      server_.kinship({"distributions", "explain", "--task", "sweep", "--robot", "ur10e",
                       "--profile", "default", "--estimator", "kde"});
  EXPECT_EQ(explained.code, 0) << explained.err;

  server_.process().terminate();
  server_.start();
  const Answer kept = fetch({"--json"});
  ASSERT_EQ(kept.code, 0) << kept.err;
  const Distribution again = json::distribution_from_json(kept.out).value_or_throw();
  EXPECT_EQ(again.id, kernels.id);
  EXPECT_EQ(again.revision, kernels.revision);
  EXPECT_EQ(again.mixture->means(), centres);
}

TEST_F(AdminCommands, TheConfigurationsOfADistributionAreThoseOfItsFit) {
  teach(server_);
  const std::vector<std::string> wish = {"--task", "sweep", "--robot", "ur10e", "--wait", "100"};
  const auto with = [&](std::vector<std::string> words, const std::string& last) {
    words.insert(words.end(), wish.begin(), wish.end());
    words.push_back(last);
    return words;
  };
  const Answer fetched = server_.kinship(with({"distributions", "fetch"}, "--json"));
  ASSERT_EQ(fetched.code, 0) << fetched.err;
  const Distribution distribution = json::distribution_from_json(fetched.out).value_or_throw();
  const Answer rows =
      server_.kinship(with({"configurations", "export"}, "--output=" + file("rows.csv")));
  ASSERT_EQ(rows.code, 0) << rows.err;
  const std::string text = test::read_text(folder_ / "rows.csv");
  EXPECT_TRUE(text.starts_with("path_id,source_robot,pose_index,")) << text.substr(0, 200);
  EXPECT_EQ(count_lines(text), distribution.configurations + 1);
  EXPECT_EQ(
      server_.kinship({"configurations", "export", "--distribution", distribution.id.hex()}).out,
      text);
  EXPECT_EQ(server_.kinship({"configurations", "export"}).code, 2);
  EXPECT_EQ(
      server_.kinship({"configurations", "export", "--task", "dance", "--robot", "ur10e"}).code, 3);
}

TEST_F(AdminCommands, AnExplanationTellsHowADistributionStandsToTheExperienceOfNow) {
  teach(server_);
  const Answer answer = server_.kinship(
      {"distributions", "explain", "--task", "sweep", "--robot", "ur10e", "--wait", "100"});
  ASSERT_EQ(answer.code, 0) << answer.err;
  EXPECT_NE(answer.out.find("is that of the fit"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("EXPERIENCE NOW"), std::string::npos) << answer.out;
  const std::string id = answer.out.substr(answer.out.find("distribution  ") + 14, 12);
  EXPECT_EQ(server_.kinship({"distributions", "explain", "--distribution", id, "--json"}).code, 0);
  EXPECT_EQ(server_.kinship({"distributions", "explain", "--distribution", "0000"}).code, 3);
}

TEST_F(AdminCommands, WhatWasRehearsedIsExplainedAndCounted) {
  teach(server_);
  const auto explain = [&](const std::vector<std::string>& also) {
    std::vector<std::string> words = {"distributions", "explain", "--task", "sweep",
                                      "--robot",       "panda",   "--wait", "100"};
    words.insert(words.end(), also.begin(), also.end());
    const Answer answer = server_.kinship(words);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return answer.out;
  };
  EXPECT_NE(explain({}).find("\nnot rehearsed yet: "), std::string::npos);
  const FetchReply reply = fetch_rehearsed(server_);
  ASSERT_TRUE(reply.rehearsal) << reply.message;
  EXPECT_TRUE(reply.rehearsal->is_complete);

  const std::string table = explain({});
  EXPECT_NE(table.find("\nrehearsed on 6 recorded queries, "), std::string::npos) << table;
  EXPECT_NE(table.find("  chosen\n"), std::string::npos) << table;
  const Explanation explanation =
      json::row_from_json<Explanation>(explain({"--json"})).value_or_throw();
  EXPECT_EQ(explanation.rehearsal, reply.rehearsal);

  const ServerStatus status =
      json::row_from_json<ServerStatus>(server_.kinship({"status", "--json"}).out).value_or_throw();
  EXPECT_EQ(status.rehearsals, 1U);
  EXPECT_EQ(status.queued_rehearsals, 0U);
  EXPECT_EQ(status.rehearsal_time_s, reply.rehearsal->processor_time_s);
  EXPECT_NE(server_.kinship({"status"}).out.find("\nrehearsals     1 done, 0 queued, "),
            std::string::npos);
}

TEST_F(AdminCommands, TheHostOfTheServerIsAnOptionOrComesFromTheEnvironment) {
  EXPECT_EQ(server_.kinship({"--server", "127.0.0.1", "status"}).code, 0);
  const Answer nobody = server_.kinship({"--server", "nobody.invalid", "status"}, "0.5");
  EXPECT_EQ(nobody.code, 4);
  EXPECT_NE(nobody.err.find("nobody.invalid"), std::string::npos) << nobody.err;
  setenv("KINSHIP_SERVER", "nobody.invalid", 1);
  EXPECT_EQ(server_.kinship({"status"}, "0.5").code, nobody.code);
  EXPECT_EQ(server_.kinship({"--server", "127.0.0.1", "status"}).code, 0);
  unsetenv("KINSHIP_SERVER");
}

TEST_F(AdminCommands, RobotsAreComparedByWhatExperienceIsWorthToThem) {
  teach(server_);
  const std::vector<std::string> compare = {"robots", "compare", "--task",
                                            "sweep",  "--wait",  "200"};
  const Answer panda = server_.kinship(with(compare, {"--targets", "panda", "--progress"}));
  EXPECT_EQ(panda.code, 0) << panda.err;
  EXPECT_NE(panda.out.find("\nTARGET \\ SOURCE  panda\npanda            "), std::string::npos)
      << panda.out;
  EXPECT_NE(panda.out.find("answered a query never guides that query again, also on the diagonal"),
            std::string::npos)
      << panda.out;
  EXPECT_NE(panda.err.find("rehearsing 1 of 1: panda with the experience of panda"),
            std::string::npos);

  const Answer unplaced = server_.kinship(compare);  // nobody knows where the UR10e stands
  EXPECT_EQ(unplaced.code, 1);
  EXPECT_NE(unplaced.out.find("ur10e from panda: where its base stands is not known: --placement"),
            std::string::npos)
      << unplaced.out;
  const Answer placed = server_.kinship(
      with(compare, {"--targets", "ur10e", "--placement", "ur10e=0 0 0 0 0 0 1", "--json"}));
  EXPECT_EQ(placed.code, 0) << placed.err;
  EXPECT_NE(placed.out.find("\"queries\":"), std::string::npos) << placed.out;

  EXPECT_EQ(server_.kinship(with(compare, {"--targets", "nobody"})).code, 3);
  EXPECT_EQ(server_.kinship(with(compare, {"--placement", "0 0 0 0 0 0 1"})).code, 2);
  EXPECT_EQ(server_.kinship(with(compare, {"--placement", "nobody=0 0 0 0 0 0 1"})).code, 2);
  EXPECT_EQ(server_.kinship({"robots", "compare", "--task", "unheard"}).code, 3);
}

TEST_F(AdminCommands, AServerThatMayNotRehearseDoesNot) {
  const Server idle(folder_ / "idle.db", {"--rehearsal-cpu", "0"});
  teach(idle);
  const FetchReply reply = fetch_rehearsed(idle);
  EXPECT_TRUE(reply.experience) << reply.message;
  EXPECT_FALSE(reply.rehearsal);
  EXPECT_NE(idle.kinship({"status"}).out.find("\nrehearsals     0 done, 0 queued, 0.0 s"),
            std::string::npos);
}

TEST_F(AdminCommands, AServerBelowItsWatermarkOfFreeSpaceSaysSo) {
  const Server full(folder_ / "full.db", {"--free-space-watermark-mb", "1073741824"});  // 1 PB
  const std::string said = full.kinship({"status"}).out;
  EXPECT_NE(said.find("not writable: the file system at '/"), std::string::npos) << said;
  EXPECT_NE(said.find("below 1073741824 MB no report is taken"), std::string::npos) << said;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "full.db.ballast"));
  const Server well(folder_ / "well.db", {"--ballast-mb", "2"});
  EXPECT_EQ(std::filesystem::file_size(folder_ / "well.db.ballast"), std::uintmax_t{2} << 20U);
}

TEST_F(AdminCommands, ARobotThatBreaksARuleIsWrongUsage) {
  const std::string model = test::source_dir() + "/robots/models/ur10e/robot.urdf";
  const Answer answer = server_.kinship(
      {"robots", "register", model, "--base", "nowhere", "--tip", "tool0", "--label", "arm"});
  EXPECT_EQ(answer.code, 2) << answer.err;
  EXPECT_NE(answer.err.find("nowhere"), std::string::npos) << answer.err;
}

}  // namespace
}  // namespace kinship::admin_commands_test
