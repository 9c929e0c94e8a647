#include "client/cli/complete_command.hpp"

#include <functional>
#include <map>
#include <ostream>

#include "client/link/admin_rows.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/types/exit_code.hpp"
#include "proto/types/names.hpp"

namespace kinship::cli {
namespace {

struct Candidates {
  AdminVerb verb;
  std::function<std::string(const std::string& row)> word;
};

/// A row's word by `parse` and `word`; empty for a row that cannot be read.
template <typename Parse, typename Word>
std::function<std::string(const std::string& row)> word_of(Parse parse, Word word) {
  return [parse, word](const std::string& row) {
    const auto value = parse(row);
    return value ? std::string(std::invoke(word, *value)) : std::string();
  };
}

std::map<std::string, Candidates> all_candidates() {
  return {
      {"ROBOT",
       {AdminVerb::ListRobots, word_of(json::row_from_json<RobotSummary>, &RobotSummary::label)}},
      {"TASK",
       {AdminVerb::ListTasks, word_of(json::row_from_json<TaskSummary>, &TaskSummary::task)}},
      {"DISTRIBUTION",
       {AdminVerb::ListDistributions,
        word_of(json::row_from_json<DistributionSummary>,
                [](const DistributionSummary& row) { return row.id.short_hex(); })}},
      {"PATH",
       {AdminVerb::ListPaths,
        word_of(json::row_from_json<PathSummary>,
                [](const PathSummary& row) { return row.report_uuid.text(); })}},
      {"JOB", {AdminVerb::ListJobs, word_of(json::row_from_json<Job>, &Job::id)}},
  };
}

}  // namespace

int print_candidates(link::Client& server, const std::string& kind, std::ostream& out) {
  constexpr std::size_t kMost = 200;  // a page of them
  const Candidates candidates = all_candidates().at(kind);
  AdminRequest request;
  request.verb = candidates.verb;
  std::string words;
  const auto error = link::for_each_row(
      server, request,
      [&](const std::string& row) {
        // Any peer may claim to be a server: a word on a command line is a name, and no program.
        if (const std::string word = candidates.word(row); !check_label(word))
          words += word + '\n';
        return true;
      },
      kMost);
  if (!error)
    out << words;
  return kDone;
}

}  // namespace kinship::cli
