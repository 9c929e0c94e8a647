#include "client/experiments/pipeline/study_session.hpp"

#include <algorithm>
#include <ostream>

#include "client/experiments/pipeline/compressed_file.hpp"
#include "client/experiments/pipeline/learning_set.hpp"
#include "client/experiments/pipeline/run_progress.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

void tell(const Distribution& distribution, const std::string& target, std::ostream& messages) {
  messages << "distribution " << distribution.id.short_hex() << " for " << target << ':';
  for (const Source& source : distribution.sources)
    messages << ' ' << source.label << " (" << source.paths << " paths, " << source.poses_solved
             << " of " << source.poses << " poses)";
  messages << ", " << distribution.configurations << " configurations, transfer "
           << distribution.transfer_time_s << " s, fit " << distribution.fit_time_s << " s";
  if (!distribution.reason.empty())
    messages << "; " << distribution.reason;
  messages << std::endl;
}

std::string folder_name(const Study& study, const RunOptions& options) {
  const std::string learning = options.learning > 0 ? "-" + std::to_string(options.learning) : "";
  return study.name + learning + (options.quick ? "-quick" : "");
}

}  // namespace

StudyFiles::StudyFiles(const Study& study, const RunOptions& options)
    : folder(options.folder / folder_name(study, options)),
      learning(folder / "learning"),
      store(folder / "store" / "experience.db"),
      calibration(folder / "calibration.jsonl"),
      test(folder / "test.jsonl"),
      tuning(folder / "tuning.jsonl"),
      distributions(folder / "distributions.jsonl"),
      runs(folder / "runs.jsonl"),
      description(folder / "study.json"),
      tuning_pairs(folder / "tuning.json") {}

std::uint32_t learning_instances(const Study& study, const RunOptions& options) {
  const std::uint32_t wished = options.learning > 0 ? options.learning : study.learning_instances;
  return options.quick ? std::min(kQuickLearning, wished) : wished;
}

StudySession::StudySession(const Study& study, const RunOptions& options, std::ostream& messages)
    : study_(study),
      options_(options),
      messages_(messages),
      files_(study, options),
      fleet_(load_fleet(study, options.models)) {
  if (!options.resume && std::filesystem::exists(files_.folder))
    throw Failure(ErrorCode::Conflict,
                  "'" + files_.folder.string() +
                      "' is there already: go on with --resume, or name another folder");
  std::filesystem::create_directories(files_.learning);
  std::filesystem::create_directories(files_.store.parent_path());
}

void StudySession::record() {
  RecordingOptions recording;
  recording.folder = files_.learning;
  recording.instances = learning_instances(study_, options_);
  recording.threads = options_.threads;
  RunProgress progress(messages_, study_.name + ": learning sets",
                       fleet_.size() * recording.instances);
  recording.recorded = [&progress] { progress.advance(); };
  for (std::size_t robot = 0; robot < fleet_.size(); ++robot) {
    learning_sets_.push_back(record_learning_set(study_, fleet_, robot, recording));
    compress_file(files_.learning / (fleet_[robot].label() + ".jsonl"));
  }
  progress.finish();
}

void StudySession::learn() {
  record();
  const auto program = options_.kinshipd.empty() ? sibling_program("kinshipd") : options_.kinshipd;
  server_ = std::make_unique<ExperienceServer>(
      ServerProcess::Options{program, files_.store, options_.domain, options_.threads}, fleet_);
  for (const std::vector<Attempt>& attempts : learning_sets_)
    server_->report(attempts);
}

void StudySession::report_as(const std::string& task, std::size_t count) {
  for (const std::vector<Attempt>& attempts : learning_sets_)
    server_->report(renamed(attempts, task, count));
}

Fetched StudySession::fetch(const DistributionWish& wish) {
  Fetched fetched = server_->fetch(wish);
  tell(fetched.distribution, fleet_.at(wish.target).label(), messages_);
  return fetched;
}

void StudySession::run(const std::string& stage, const std::vector<Cell>& cells, QueryPlan plan,
                       QueryLog& log) {
  RunProgress progress(messages_, study_.name + ": " + stage,
                       cells.size() * plan.instances * plan.seeds);
  plan.threads = options_.threads;
  plan.answered = [&progress] { progress.advance(); };
  run_queries(fleet_, cells, plan, log);
  progress.finish();
}

}  // namespace kinship::experiments
