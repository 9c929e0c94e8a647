#include "server/service/fit_distribution.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/pose.hpp"
#include "server/density/fit.hpp"
#include "server/service/pooled_configurations.hpp"
#include "server/transfer/transfer.hpp"

namespace kinship::service {
namespace {

constexpr std::size_t kPathsPerRead = 64;  // bounds what one read transaction holds in memory

/// How the experience of one source robot fared.
struct SourceSummary {
  Source source;
  transfer::TransferSummary total;
  std::uint64_t paths_used = 0;
  std::uint64_t paths_left_out = 0;  // bad data
  std::string problem;               // with the robot or the first path left out
  bool has_placed = false, has_unplaced = false;
};

void add(transfer::TransferSummary& total, const transfer::TransferSummary& path) {
  total.poses += path.poses;
  total.poses_solved += path.poses_solved;
  total.out_of_reach += path.out_of_reach;
  total.outside_limits += path.outside_limits;
  total.not_converged += path.not_converged;
  total.configurations += path.configurations;
}

/// Whether item `index` of `count` is one of the `wanted` that are spread evenly over them.
bool is_chosen(std::uint64_t index, std::uint64_t count, std::uint64_t wanted) {
  return wanted >= count || (index + 1) * wanted / count > index * wanted / count;
}

/// Pose of the source's base in the target's; exactly the identity if both stand at the same
/// place up to snapping, so that a robot's own paths are taken over as they are.
Eigen::Isometry3d T_target_source(const std::optional<Eigen::Isometry3d>& T_task_target,
                                  const std::optional<Eigen::Isometry3d>& T_task_source) {
  const Eigen::Isometry3d identity = Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d target = T_task_target.value_or(identity);
  const Eigen::Isometry3d source = T_task_source.value_or(identity);
  if (snapped(source).matrix() == target.matrix())
    return Eigen::Isometry3d::Identity();
  return target.inverse(Eigen::Isometry) * source;
}

/// What a distribution says of itself before its fit.
Distribution begun(const DistributionKey& key, const FitContext& context,
                   const kinematics::Chain& target) {
  Distribution distribution;
  distribution.id = identify(key);
  distribution.store_epoch = context.store.epoch();
  distribution.task = key.task;
  distribution.robot = key.robot;
  distribution.T_task_base = key.T_task_base;
  distribution.profile = key.profile.name;
  distribution.engines = engines();
  distribution.limits.resize(2, target.dof());
  distribution.limits.row(0) = target.lower().transpose();
  distribution.limits.row(1) = target.upper().transpose();
  return distribution;
}

Source source_of(const store::ExperienceSummary& experience) {
  Source source;
  source.robot = experience.robot;
  source.label = experience.robot.short_hex();
  source.paths = experience.paths;
  source.generation = experience.generation;
  return source;
}

/// One fit on its way.
class Fit {
 public:
  Fit(const DistributionKey& key, const FitContext& context, const std::stop_token& stop)
      : key_(key),
        context_(context),
        stop_(stop),
        target_(context.robots.find(key.robot).value_or_throw()),
        pool_(target_->chain.dof()) {}

  FitOutcome run();

 private:
  using TimePoint = std::chrono::steady_clock::time_point;

  void read_source(const store::ExperienceSummary& experience, std::uint64_t wanted);
  void transfer_paths(const Robot& robot, std::uint64_t wanted, SourceSummary& summary);
  void transfer_one(const store::StoredPath& stored, const Robot& robot, SourceSummary& summary);
  void fit(Distribution& distribution) const;
  void fail(Distribution& distribution, const std::string& message) const;
  std::string sources_in_words() const;
  std::string warnings() const;
  double seconds_since(TimePoint begin) const {
    return std::chrono::duration<double>(context_.clock.now() - begin).count();
  }

  const DistributionKey& key_;
  const FitContext& context_;
  const std::stop_token& stop_;
  RobotRegistry::RobotPointer target_;
  PooledConfigurations pool_;
  std::vector<SourceSummary> sources_;
};

FitOutcome Fit::run() {
  const std::vector<store::ExperienceSummary> experience = context_.store.experience(key_.task);
  if (experience.empty())
    return {FitOutcome::Kind::NoExperience, std::nullopt};
  std::uint64_t total = 0;
  for (const auto& source : experience)
    total += source.paths;

  const TimePoint begin = context_.clock.now();
  for (const auto& source : experience) {
    const std::uint64_t share =
        total <= context_.max_paths ? source.paths : source.paths * context_.max_paths / total;
    read_source(source, std::max<std::uint64_t>(share, 1));
  }
  if (stop_.stop_requested())
    return {FitOutcome::Kind::Abandoned, std::nullopt};

  Distribution distribution = begun(key_, context_, target_->chain);
  for (const SourceSummary& summary : sources_)
    distribution.sources.push_back(summary.source);
  distribution.transfer_time_s = seconds_since(begin);
  fit(distribution);
  distribution.fitted_ms = context_.clock.unix_ms();
  return {FitOutcome::Kind::Fitted, std::move(distribution)};
}

void Fit::read_source(const store::ExperienceSummary& experience, std::uint64_t wanted) {
  SourceSummary summary;
  summary.source = source_of(experience);
  const Result<RobotRegistry::RobotPointer> robot = context_.robots.find(experience.robot);
  if (robot) {
    summary.source.label = robot.value()->label;
    transfer_paths(*robot.value(), wanted, summary);
  } else {
    summary.problem = robot.error().message;
  }
  summary.source.poses = summary.total.poses;
  summary.source.poses_solved = summary.total.poses_solved;
  sources_.push_back(std::move(summary));
}

void Fit::transfer_paths(const Robot& robot, std::uint64_t wanted, SourceSummary& summary) {
  const std::uint64_t count = summary.source.paths;
  std::int64_t last_id = 0;
  for (std::uint64_t index = 0; index < count;) {
    const std::size_t limit = std::min<std::uint64_t>(kPathsPerRead, count - index);
    const std::vector<store::StoredPath> page =
        context_.store.read_paths(robot.digest, key_.task, {.after_id = last_id, .limit = limit});
    if (page.empty())
      return;  // fewer than counted: some were set aside
    last_id = page.back().id;
    for (const store::StoredPath& stored : page) {
      if (stop_.stop_requested())
        return;
      if (is_chosen(index++, count, wanted))
        transfer_one(stored, robot, summary);
    }
  }
}

void Fit::transfer_one(const store::StoredPath& stored, const Robot& robot,
                       SourceSummary& summary) {
  try {
    if (stored.path.dof() != robot.chain.dof())
      throw Failure(ErrorCode::InvalidInput,
                    "a path of " + std::to_string(stored.path.dof()) + " joints");
    transfer::TransferredPath moved =
        transfer::transfer_path(stored.path, robot.chain, target_->chain,
                                T_target_source(key_.T_task_base, stored.T_task_base),
                                key_.profile.transfer, key_.profile.seed);
    add(summary.total, moved.summary);
    pool_.add(std::move(moved));
    (stored.T_task_base ? summary.has_placed : summary.has_unplaced) = true;
    ++summary.paths_used;
  } catch (const std::exception& exception) {  // one bad path must not cost the others
    ++summary.paths_left_out;
    if (summary.problem.empty())
      summary.problem = "path " + stored.report_uuid.text() + ": " + exception.what();
  }
}

void Fit::fit(Distribution& distribution) const {
  distribution.configurations = static_cast<std::uint64_t>(pool_.size());
  if (pool_.size() == 0)
    return fail(distribution, "nothing could be transferred to '" + target_->label + "'");
  const TimePoint begin = context_.clock.now();
  const DensityParameters& parameters = key_.profile.density;
  Result<density::FitSummary> fitted =
      density::fit_mixture(pool_.configurations(), pool_.weights(parameters.equal_path_weights),
                           {.components = parameters.components,
                            .covariance_floor = parameters.covariance_floor,
                            .seed = key_.profile.seed});
  distribution.fit_time_s = seconds_since(begin);
  if (!fitted)
    return fail(distribution, std::to_string(pool_.size()) + " configurations for '" +
                                  target_->label +
                                  "' could not be fitted: " + fitted.error().message);
  distribution.state = DistributionState::Ready;
  distribution.mixture = std::move(fitted).value().mixture;
  distribution.reason = warnings();
  distribution.advice.recommended_share = key_.profile.recommended_share;
  distribution.advice.evidence =
      "share of profile '" + key_.profile.name + "'; no attempts compared yet";
}

void Fit::fail(Distribution& distribution, const std::string& message) const {
  distribution.state = DistributionState::Failed;
  distribution.reason = message + ": " + sources_in_words();
  const std::string also = warnings();
  if (!also.empty())
    distribution.reason += "; " + also;
  distribution.reason = cut_text(distribution.reason, kMaxMessageBytes);
  distribution.advice.evidence = "no mixture";
}

std::string Fit::sources_in_words() const {
  std::string words;
  for (const SourceSummary& summary : sources_) {
    const transfer::TransferSummary& total = summary.total;
    if (!words.empty())
      words += "; ";
    words += "'" + summary.source.label + "': " + std::to_string(summary.paths_used) + " paths, " +
             std::to_string(total.poses) + " poses, " + std::to_string(total.poses_solved) +
             " solved, " + std::to_string(total.out_of_reach) + " out of reach, " +
             std::to_string(total.outside_limits) + " outside limits, " +
             std::to_string(total.not_converged) + " not converged";
  }
  return words;
}

std::string Fit::warnings() const {
  std::vector<std::string> found;
  bool placed = key_.T_task_base.has_value(), unplaced = !placed;
  for (const SourceSummary& summary : sources_) {
    const std::string name = "'" + summary.source.label + "': ";
    placed = placed || summary.has_placed;
    unplaced = unplaced || summary.has_unplaced;
    if (!summary.problem.empty())
      found.push_back(name +
                      (summary.paths_left_out > 0
                           ? std::to_string(summary.paths_left_out) + " paths left out, " + "first "
                           : "left out, ") +
                      summary.problem);
    const std::uint64_t tried = summary.paths_used + summary.paths_left_out;
    if (tried > 0 && tried < summary.source.paths)
      found.push_back(name + std::to_string(tried) + " of " + std::to_string(summary.source.paths) +
                      " paths read");
  }
  if (placed && unplaced)
    found.emplace_back("some placements are missing and were taken as the identity");
  std::string words;
  for (const std::string& warning : found)
    words += (words.empty() ? "" : "; ") + warning;
  return cut_text(words, kMaxMessageBytes);
}

}  // namespace

FitOutcome fit_distribution(const DistributionKey& key, const FitContext& context,
                            const std::stop_token& stop) {
  return Fit(key, context, stop).run();
}

Distribution failed_distribution(const DistributionKey& key, const FitContext& context,
                                 const std::string& reason) {
  const RobotRegistry::RobotPointer target = context.robots.find(key.robot).value_or_throw();
  Distribution distribution = begun(key, context, target->chain);
  for (const store::ExperienceSummary& experience : context.store.experience(key.task)) {
    distribution.sources.push_back(source_of(experience));
    if (const Result<RobotRegistry::RobotPointer> robot = context.robots.find(experience.robot))
      distribution.sources.back().label = robot.value()->label;
  }
  distribution.state = DistributionState::Failed;
  distribution.reason = cut_text(reason, kMaxMessageBytes);
  distribution.advice.evidence = "no mixture";
  distribution.fitted_ms = context.clock.unix_ms();
  return distribution;
}

}  // namespace kinship::service
