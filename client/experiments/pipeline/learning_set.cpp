#include "client/experiments/pipeline/learning_set.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <utility>

#include "client/experiments/pipeline/compressed_file.hpp"
#include "client/experiments/pipeline/parallel_for.hpp"
#include "client/guided/attempt_record.hpp"
#include "client/guided/scene_record.hpp"
#include "proto/files/lines.hpp"
#include "proto/files/output_file.hpp"
#include "proto/json/experience_line.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/sha256.hpp"

namespace kinship::experiments {
namespace {

/// A report UUID that follows from what is reported: equal words, equal UUID.
Uuid uuid_of(const std::string& task, const std::string& who, std::uint64_t index) {
  const Digest digest = Sha256().add(task).add(who).add(index).finish();
  Uuid uuid;
  std::copy_n(digest.bytes.begin(), uuid.bytes.size(), uuid.bytes.begin());
  constexpr std::uint8_t kVersion8 = 0x80, kVariant = 0x80;
  uuid.bytes[6] = static_cast<std::uint8_t>((uuid.bytes[6] & 0x0fU) | kVersion8);
  uuid.bytes[8] = static_cast<std::uint8_t>((uuid.bytes[8] & 0x3fU) | kVariant);
  return uuid;
}

/// A path with few digits, so that learning sets can be kept with the code: far below what
/// the resolution of checks can tell.
Path rounded(const Path& path, const kinematics::Chain& chain) {
  constexpr double kDigits = 1e6;
  Eigen::MatrixXd waypoints = (path.waypoints() * kDigits).array().round() / kDigits;
  for (auto&& q : waypoints.colwise())
    q = q.cwiseMax(chain.lower()).cwiseMin(chain.upper());
  return Path(std::move(waypoints));
}

/// The learning set of one robot while it is recorded.
class Recording {
 public:
  Recording(const Study& study, const StudyMember& member, std::size_t robot,
            const RecordingOptions& options)
      : study_(study),
        member_(member),
        seed_(seed_of(InstanceSet::Learning, robot)),
        options_(options),
        file_(options.folder / (member.label() + ".jsonl")) {
    if (expand_file(file_))
      read();
    write();
    stream_.open(file_, std::ios::app);
  }

  void run() {
    parallel_for(options_.threads, options_.instances, [this](std::size_t i) {
      const auto index = static_cast<std::uint32_t>(i);
      if (!has(index))
        add(index, plan(index));
      if (options_.recorded)
        options_.recorded();
    });
    stream_.close();
    write();
  }

  std::vector<Attempt> attempts() const {
    std::vector<Attempt> attempts;
    for (const auto& [index, attempt] : attempts_)
      if (index < options_.instances)
        attempts.push_back(attempt);
    return attempts;
  }

 private:
  void read() {
    constexpr std::uint32_t kMaxInstances = 100'000;
    std::map<Uuid, std::uint32_t> indices;
    for (std::uint32_t index = 0; index < kMaxInstances; ++index)
      indices.emplace(uuid_of(study_.name, member_.label(), index), index);
    std::ifstream stream = files::open_input(file_);
    files::for_each_line(stream, file_.string(), [&](const files::Line& line) {
      if (!line.text)
        throw Failure(line.text.error());
      const auto content = json::experience_line_from_json(*line.text);
      if (!content)
        return false;  // an interruption cut it off
      if (const auto* named = std::get_if<json::NamedAttempt>(&*content))
        keep(named->attempt, indices, line.number);
      return true;
    });
  }

  void keep(const Attempt& attempt, const std::map<Uuid, std::uint32_t>& indices,
            std::size_t line) {
    const auto known = indices.find(attempt.report_uuid);
    if (known == indices.end() || attempt.robot != member_.digest)
      throw Failure(ErrorCode::Conflict, "'" + file_.string() + "' line " + std::to_string(line) +
                                             " is no attempt of study '" + study_.name +
                                             "' by robot '" + member_.label() +
                                             "' as they are now");
    attempts_.insert_or_assign(known->second, attempt);
  }

  void write() const {
    files::OutputFile output(file_, std::cout);
    output.stream() << json::to_experience_line(member_.robot.description) << '\n';
    for (const auto& [index, attempt] : attempts_)
      output.stream() << json::to_json(attempt) << '\n';
    output.keep();
  }

  bool has(std::uint32_t index) {
    const std::lock_guard lock(mutex_);
    return attempts_.contains(index);
  }

  Attempt plan(std::uint32_t index) const {
    guided::PlanSettings settings = study_.settings;
    settings.overshoot = 1;
    settings.shortcut_checks = kLearningShortcutChecks;
    const Problem problem = read_instance(member_, seed_, index);
    const guided::PlannedProblem planned = guided::plan_problem(
        member_.planned, problem, guided::QueryGuidance{}, settings, [] { return false; });
    if (!planned.attempted)
      throw Failure(ErrorCode::Internal, problem.name + ": " + planned.result.reason);
    const guided::Reporter reporter{member_.digest, "experiments", study_.name};
    Attempt attempt = guided::make_attempt(reporter, problem, planned, settings);
    attempt.report_uuid = uuid_of(study_.name, member_.label(), index);
    attempt.scene = guided::SceneRecords().record(member_.robot.chain, problem).value_or_throw();
    if (attempt.path)
      attempt.path = rounded(*attempt.path, member_.robot.chain);
    return attempt;
  }

  void add(std::uint32_t index, Attempt attempt) {
    const std::lock_guard lock(mutex_);
    stream_ << json::to_json(attempt) << std::endl;
    if (!stream_)
      throw Failure(ErrorCode::Storage, "'" + file_.string() + "' cannot be written");
    attempts_.emplace(index, std::move(attempt));
  }

  const Study& study_;
  const StudyMember& member_;
  const std::uint64_t seed_;
  const RecordingOptions& options_;
  const std::filesystem::path file_;
  std::mutex mutex_;  // guards what follows
  std::map<std::uint32_t, Attempt> attempts_;
  std::ofstream stream_;
};

}  // namespace

std::vector<Attempt> record_learning_set(const Study& study, const std::vector<StudyMember>& fleet,
                                         std::size_t robot, const RecordingOptions& options) {
  Recording recording(study, fleet.at(robot), robot, options);
  recording.run();
  return recording.attempts();
}

std::vector<Attempt> renamed(const std::vector<Attempt>& attempts, const std::string& task,
                             std::size_t count) {
  std::vector<Attempt> result(
      attempts.begin(),
      attempts.begin() + static_cast<std::ptrdiff_t>(std::min(count, attempts.size())));
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i].report_uuid = uuid_of(task, result[i].report_uuid.text(), i);
    result[i].task = task;
  }
  return result;
}

}  // namespace kinship::experiments
