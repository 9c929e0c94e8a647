#pragma once

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include "client/experiments/pipeline/experience_server.hpp"
#include "client/experiments/pipeline/fleet.hpp"
#include "client/experiments/pipeline/query_log.hpp"
#include "client/experiments/pipeline/query_runner.hpp"
#include "client/experiments/pipeline/study_run.hpp"

namespace kinship::experiments {

/// Where a study keeps what it has.
struct StudyFiles {
  StudyFiles(const Study& study, const RunOptions& options);

  std::filesystem::path folder;
  std::filesystem::path learning;       ///< folder of learning sets
  std::filesystem::path store;          ///< of its kinshipd
  std::filesystem::path calibration;    ///< results of calibration queries
  std::filesystem::path test;           ///< results of test queries
  std::filesystem::path tuning;         ///< results of tuning queries
  std::filesystem::path distributions;  ///< as they were fetched, one a line
  std::filesystem::path runs;           ///< of the test set
  std::filesystem::path description;    ///< of the study, for its analysis
  std::filesystem::path tuning_pairs;   ///< what the last tuning run compared

  /// Results of a side study.
  std::filesystem::path side(const std::string& name) const { return folder / (name + ".jsonl"); }
};

/// Learning instances of each robot: fewer in a quick run.
std::uint32_t learning_instances(const Study& study, const RunOptions& options);

/// A study under way: its fleet, its learning sets and its server.
class StudySession {
 public:
  /// Loads the fleet. \throws Failure(Conflict) if the folder holds results and `resume` is not
  /// set; others as load_fleet says.
  StudySession(const Study& study, const RunOptions& options, std::ostream& messages);

  const std::vector<StudyMember>& fleet() const noexcept { return fleet_; }
  const StudyFiles& files() const noexcept { return files_; }

  /// Records what is missing of the learning sets.
  void record();

  /// Of each robot; after record().
  const std::vector<std::vector<Attempt>>& learning_sets() const noexcept { return learning_sets_; }

  /// The same, then starts the server and hands them over.
  void learn();

  /// Also hands over the first `count` attempts of each learning set under another task.
  void report_as(const std::string& task, std::size_t count);

  /// After learn(). \return what the server made of it; told on `messages`.
  Fetched fetch(const DistributionWish& wish);

  /// \param stage  for messages.
  void run(const std::string& stage, const std::vector<Cell>& cells, QueryPlan plan, QueryLog& log);

 private:
  const Study& study_;
  const RunOptions options_;
  std::ostream& messages_;
  const StudyFiles files_;
  const std::vector<StudyMember> fleet_;
  std::vector<std::vector<Attempt>> learning_sets_;
  std::unique_ptr<ExperienceServer> server_;
};

}  // namespace kinship::experiments
