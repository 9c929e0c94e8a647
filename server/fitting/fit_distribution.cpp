#include "server/fitting/fit_distribution.hpp"

#include <algorithm>
#include <chrono>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/stopped.hpp"
#include "server/density/fit.hpp"
#include "server/density/kernel_density.hpp"
#include "server/fitting/branch_cuts.hpp"
#include "server/fitting/describe_filters.hpp"
#include "server/fitting/describe_sources.hpp"
#include "server/fitting/pooled_configurations.hpp"
#include "server/fitting/profile_advice.hpp"
#include "server/fitting/selected_experience.hpp"
#include "server/fitting/source_transfer.hpp"
#include "server/fitting/warm_refit.hpp"

namespace kinship::fitting {
namespace {

/// A distribution before its fit.
Distribution begun(const DistributionKey& key, const FitContext& context,
                   const kinematics::Chain& target) {
  Distribution distribution;
  distribution.id = identify(key);
  distribution.store_epoch = context.store.epoch();
  distribution.task = key.task;
  distribution.robot = key.robot;
  distribution.T_task_base = key.T_task_base;
  distribution.profile = key.profile.name;
  distribution.selection = {key.sources, key.profile.density.weighting, key.since_ms};
  distribution.engines = engines();
  distribution.limits = limits_with({}, target);
  return distribution;
}

/// The share of poses solved at the source of a sample: each source counts by its mass.
double solved_share(const std::vector<Source>& sources) {
  double share = 0;
  for (const Source& source : sources)
    if (source.poses > 0)
      share += source.mass * static_cast<double>(source.poses_solved) /
               static_cast<double>(source.poses);
  return share;
}

/// Added to the variance of each joint.
Eigen::VectorXd covariance_floors(const kinematics::Chain& chain,
                                  const DensityParameters& parameters) {
  Eigen::VectorXd floors(chain.dof());
  for (Eigen::Index joint = 0; joint < chain.dof(); ++joint)
    floors[joint] =
        chain.joints()[static_cast<std::size_t>(joint)].type == kinematics::JointType::Prismatic
            ? parameters.covariance_floor_m2
            : parameters.covariance_floor;
  return floors;
}

/// The same summary of the other estimator.
Result<density::FitSummary> fit_kernels(const Eigen::MatrixXd& configurations,
                                        const Eigen::VectorXd& weights,
                                        const density::KernelDensityOptions& options) {
  Result<density::KernelDensity> estimate =
      density::estimate_kernel_density(configurations, weights, options);
  if (!estimate)
    return estimate.error();
  density::KernelDensity made = std::move(estimate).value();
  return density::FitSummary{std::move(made.mixture), {}, {}, made.held_out_score};
}

const KnownPaths* known_of(const FitMemory::State& before) {
  return before ? &before->paths : nullptr;
}

/// Which configurations come from paths that a fit did not use.
std::vector<std::uint8_t> new_configurations(const PooledConfigurations& pool,
                                             const KnownPaths& before) {
  std::set<Uuid> known;
  for (const auto& [id, path] : before)
    known.insert(path.report);
  std::vector<std::uint8_t> is_new;
  is_new.reserve(static_cast<std::size_t>(pool.size()));
  for (const PooledConfigurations::PooledPath& pooled : pool.paths())
    is_new.insert(is_new.end(), static_cast<std::size_t>(pooled.path->configurations.cols()),
                  known.count(pooled.report) > 0 ? 0 : 1);
  return is_new;
}

/// One fit on its way.
class Fit {
 public:
  Fit(const DistributionKey& key, const FitContext& context, const std::stop_token& stop)
      : key_(key),
        context_(context),
        stop_(stop),
        target_(context.robots.find(key.robot).value_or_throw()),
        transfer_(context.store, context.robots, key, *target_,
                  {.known = known_of(context.before),
                   .threads = context.fit_threads,
                   .leaves_out = context.leaves_out,
                   .memory = context.memory,
                   .targets = context.targets}) {}

  /// \throws Stopped.
  FitOutcome run();

 private:
  using TimePoint = std::chrono::steady_clock::time_point;

  void fit(Distribution& distribution, WarmState& warm_state) const;
  Result<density::FitSummary> fit_mixture(Distribution& distribution,
                                          const Eigen::VectorXd& weights,
                                          const std::vector<double>& masses) const;
  FitOrigin origin(const std::string& why_full) const;
  void save(const Distribution& distribution, const std::vector<double>& masses,
            WarmState& warm_state) const;
  void fail(Distribution& distribution, const std::string& message) const;
  double seconds_since(TimePoint begin) const {
    return std::chrono::duration<double>(context_.clock.now() - begin).count();
  }

  const DistributionKey& key_;
  const FitContext& context_;
  const std::stop_token& stop_;
  runtime::RobotRegistry::RobotPointer target_;
  SourceTransfer transfer_;
  std::vector<SourceSummary> sources_;
};

FitOutcome Fit::run() {
  const std::vector<store::ExperienceSummary> experience =
      selected_experience(key_, context_.store.experience(key_.task));
  const TimePoint begin = context_.clock.now();
  sources_ = transfer_sources(transfer_, key_, experience, context_.max_paths, stop_);
  throw_if_stopped(stop_);
  if (std::all_of(sources_.begin(), sources_.end(),
                  [](const SourceSummary& summary) { return summary.paths_selected == 0; }))
    return {FitOutcome::Kind::NoExperience, std::nullopt};

  Distribution distribution = begun(key_, context_, target_->chain);
  for (const SourceSummary& summary : sources_)
    distribution.sources.push_back(summary.source);
  distribution.transfer_time_s = seconds_since(begin);
  distribution.filters = describe_filters(key_.profile.transfer, *target_, sources_);
  auto warm_state = std::make_shared<WarmState>();
  warm_state->paths = transfer_.used();
  fit(distribution, *warm_state);
  distribution.fitted_ms = context_.clock.unix_ms();
  return {FitOutcome::Kind::Fitted, std::move(distribution), std::move(warm_state)};
}

FitOrigin Fit::origin(const std::string& why_full) const {
  const KnownPaths& used = transfer_.used();
  FitOrigin origin;
  origin.paths = origin.new_paths = used.size();
  origin.transferred = transfer_.transferred();
  origin.reason = why_full;
  if (why_full.empty()) {
    origin.from_revision = context_.before->revision;
    origin.full_revision = context_.before->full.revision;
    origin.new_paths -= context_.before->paths.size();  // each of them is used again
  }
  return origin;
}

Result<density::FitSummary> Fit::fit_mixture(Distribution& distribution,
                                             const Eigen::VectorXd& weights,
                                             const std::vector<double>& masses) const {
  const PooledConfigurations& pool = transfer_.pool();
  const DensityParameters& parameters = key_.profile.density;
  Eigen::MatrixXd configurations = pool.configurations();
  const WarmState* const before = context_.before.get();
  const std::string why =
      why_full({key_, transfer_.used(), sources_, masses, configurations, target_->chain}, before);
  distribution.fit = origin(why);
  distribution.cuts = why.empty() ? before->cuts : find_cuts(target_->chain, configurations);
  distribution.limits = limits_with(distribution.cuts, target_->chain);
  wrap(distribution.cuts, configurations);
  throw_if_stopped(stop_);
  const density::Computation computation{.threads = context_.fit_threads, .stop = stop_};
  if (parameters.estimator == Estimator::Kernels) {
    density::KernelDensityOptions kernels;
    kernels.floors_of_joints = covariance_floors(target_->chain, parameters);
    kernels.seed = key_.profile.seed;
    kernels.computation = computation;
    kernels.path_of_configuration = pool.path_of_configuration();
    kernels.limits = distribution.limits;
    return fit_kernels(configurations, weights, kernels);
  }
  density::FitOptions options;
  options.components = parameters.components;
  options.prior = parameters.prior;
  options.floors_of_joints = covariance_floors(target_->chain, parameters);
  options.seed = key_.profile.seed;
  options.limits = distribution.limits;
  options.computation = computation;
  if (why.empty())
    options.warm_start = {*before->mixture, new_configurations(pool, before->paths),
                          before->full.prior_scatter};
  else if (options.components == 0 || options.prior == kChosenPrior)
    options.path_of_configuration = pool.path_of_configuration();
  return density::fit_mixture(configurations, weights, options);
}

void Fit::fit(Distribution& distribution, WarmState& warm_state) const {
  const PooledConfigurations& pool = transfer_.pool();
  distribution.configurations = static_cast<std::uint64_t>(pool.size());
  if (pool.size() == 0)
    return fail(distribution, "nothing could be transferred to '" + target_->label + "'");
  const TimePoint begin = context_.clock.now();
  const Eigen::VectorXd weights = pool.weights(key_.profile.density);
  const std::vector<double> masses = pool.masses(weights);
  for (std::size_t i = 0; i < masses.size(); ++i)
    distribution.sources[i].mass = masses[i];
  Result<density::FitSummary> fitted = fit_mixture(distribution, weights, masses);
  distribution.fit_time_s = seconds_since(begin);
  if (!fitted)
    return fail(distribution, std::to_string(pool.size()) + " configurations for '" +
                                  target_->label +
                                  "' could not be fitted: " + fitted.error().message);
  distribution.state = solved_share(distribution.sources) < kThinShare ? DistributionState::Thin
                                                                       : DistributionState::Ready;
  const bool is_full = distribution.fit->from_revision == 0;  // else they were chosen before
  distribution.held_out_score =
      is_full ? fitted->held_out_score : context_.before->full.held_out_score;
  distribution.component_scores = is_full ? fitted->curve : context_.before->full.component_scores;
  const Eigen::MatrixXd prior_scatter = fitted->prior_scatter;
  distribution.mixture = std::move(fitted).value().mixture;
  distribution.reason = describe_warnings(sources_, key_.T_task_base.has_value());
  Profile profile = key_.profile;
  profile.recommended_share = first_share(profile, distribution.state);
  distribution.advice = advice_of_profile(profile);
  save(distribution, masses, warm_state);
  warm_state.full.prior_scatter = prior_scatter;
}

/// For the next fit.
void Fit::save(const Distribution& distribution, const std::vector<double>& masses,
               WarmState& warm_state) const {
  warm_state.sources = used_sources(sources_);
  warm_state.mixture = distribution.mixture;
  warm_state.cuts = distribution.cuts;
  if (distribution.fit->from_revision > 0)
    warm_state.full = context_.before->full;
  else
    warm_state.full = {.revision = 0,
                       .paths = distribution.fit->paths,
                       .masses = used_masses(sources_, masses),
                       .held_out_score = distribution.held_out_score,
                       .component_scores = distribution.component_scores};
}

void Fit::fail(Distribution& distribution, const std::string& message) const {
  distribution.state = DistributionState::Failed;
  distribution.fit.reset();
  distribution.reason = message + ": " + describe_sources(sources_);
  const std::string also = describe_warnings(sources_, key_.T_task_base.has_value());
  if (!also.empty())
    distribution.reason += "; " + also;
  distribution.reason = cut_text(distribution.reason, kMaxMessageBytes);
  distribution.advice = advice_without_mixture();
}

}  // namespace

FitOutcome fit_distribution(const DistributionKey& key, const FitContext& context,
                            const std::stop_token& stop) {
  try {
    return Fit(key, context, stop).run();
  } catch (const Stopped&) {
    return {FitOutcome::Kind::Abandoned, std::nullopt};
  }
}

Distribution failed_distribution(const DistributionKey& key, const FitContext& context,
                                 const std::string& reason) {
  const runtime::RobotRegistry::RobotPointer target =
      context.robots.find(key.robot).value_or_throw();
  Distribution distribution = begun(key, context, target->chain);
  for (const store::ExperienceSummary& experience :
       selected_experience(key, context.store.experience(key.task))) {
    distribution.sources.push_back(source_of(experience));
    if (const Result<runtime::RobotRegistry::RobotPointer> robot =
            context.robots.find(experience.robot))
      distribution.sources.back().label = robot.value()->label;
  }
  distribution.state = DistributionState::Failed;
  distribution.reason = cut_text(reason, kMaxMessageBytes);
  distribution.advice = advice_without_mixture();
  distribution.fitted_ms = context.clock.unix_ms();
  return distribution;
}

}  // namespace kinship::fitting
