#include "server/service/export_configurations.hpp"

#include <utility>

#include "proto/types/number_text.hpp"
#include "server/catalog/freshness.hpp"
#include "server/density/hold_out.hpp"
#include "server/fitting/branch_cuts.hpp"
#include "server/fitting/source_transfer.hpp"

namespace kinship::service {
namespace {

/// The remedy if the rows cannot be had any more.
std::string after_evicting(const Distribution& distribution) {
  return "; evict distribution " + distribution.id.short_hex() + " and fetch it again";
}

FetchRequest request_of(const Distribution& distribution) {
  FetchRequest request;
  request.task = distribution.task;
  request.robot = distribution.robot;
  request.T_task_base = distribution.T_task_base;
  request.profile = distribution.profile;
  request.selection = distribution.selection;
  return request;
}

Result<fitting::DistributionKey> key_of(const Distribution& distribution,
                                        const runtime::RobotRegistry& robots) {
  Result<fitting::DistributionKey> key =
      fitting::make_key(request_of(distribution), robots.geometry_revision(distribution.robot));
  if (key && identify(*key) == distribution.id)
    return key;
  return Error{ErrorCode::Conflict, "distribution " + distribution.id.short_hex() +
                                        " was made by other code (" + distribution.engines +
                                        ") than this server's (" + fitting::engines() +
                                        "), or with geometry of its robot that was replaced since: "
                                        "fetch it anew"};
}

/// The experience as the fit saw it: later paths have higher ids, and are not reached.
std::vector<store::ExperienceSummary> experience_then(const Distribution& distribution) {
  std::vector<store::ExperienceSummary> experience;
  for (const Source& source : distribution.sources)
    experience.push_back(
        {.robot = source.robot, .paths = source.paths, .generation = source.generation});
  return experience;
}

/// \throws Failure(Conflict) if a source became something else than for the fit.
void require_same(const Distribution& distribution,
                  const std::vector<fitting::SourceSummary>& sources) {
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Source& then = distribution.sources[i];
    const Source& now = sources[i].source;
    if (now.paths_used == then.paths_used && now.configurations == then.configurations)
      continue;
    throw Failure(ErrorCode::Conflict,
                  "robot '" + then.label + "': the fit of revision " +
                      std::to_string(distribution.revision) + " used " +
                      std::to_string(then.paths_used) + " paths and " +
                      std::to_string(then.configurations) + " configurations, now there are " +
                      std::to_string(now.paths_used) + " and " +
                      std::to_string(now.configurations) + after_evicting(distribution));
  }
}

std::string header(Eigen::Index dof) {
  std::string line = "path_id,source_robot,pose_index,solution_index,weight,held_out";
  for (Eigen::Index joint = 1; joint <= dof; ++joint)
    line += ",q_" + std::to_string(joint);
  return line;
}

void write_rows(const fitting::PooledConfigurations& pool, const Eigen::VectorXd& weights,
                const Distribution& distribution, std::uint64_t seed, JobRun& run) {
  JobRows& rows = run.rows;
  rows.add(header(distribution.limits.cols()));
  const auto count = static_cast<std::uint32_t>(pool.paths().size());
  // An incremental fit keeps the score of the fit before it, which had fewer paths.
  const bool is_incremental = distribution.fit && distribution.fit->from_revision > 0;
  const std::vector<std::uint8_t> held_out = distribution.held_out_score && !is_incremental
                                                 ? density::held_out_paths(count, seed)
                                                 : std::vector<std::uint8_t>(count, 0);
  Eigen::MatrixXd configurations = pool.configurations();
  fitting::wrap(distribution.cuts, configurations);
  Eigen::Index row = 0;
  std::size_t path_index = 0;
  for (const fitting::PooledConfigurations::PooledPath& pooled : pool.paths()) {
    if (run.should_stop())
      return;
    const std::string whose =
        pooled.report.text() + "," + distribution.sources[pooled.source].robot.hex() + ",";
    const transfer::TransferredPath& path = *pooled.path;
    const bool is_held_out = held_out[path_index++] != 0;
    for (Eigen::Index i = 0; i < path.configurations.cols(); ++i, ++row) {
      std::string line = whose + std::to_string(path.pose_index(i)) + "," +
                         std::to_string(path.solution_index(i)) + "," + number_text(weights(row)) +
                         (is_held_out ? ",1" : ",0");
      for (Eigen::Index joint = 0; joint < configurations.rows(); ++joint)
        line += "," + number_text(configurations(joint, row));
      rows.add(line);
    }
  }
}

bool run_export(const fitting::FitContext& context, const fitting::DistributionKey& key,
                const Distribution& distribution, JobRun& run) {
  const runtime::RobotRegistry::RobotPointer target =
      context.robots.find(key.robot).value_or_throw();
  fitting::SourceTransfer transfer(context.store, context.robots, key, *target,
                                   {.memory = context.memory});
  const std::vector<fitting::SourceSummary> sources = transfer_sources(
      transfer, key, experience_then(distribution), context.max_paths, run.stop_token());
  if (run.should_stop())
    return false;
  require_same(distribution, sources);
  run.set_progress(0.9);
  const fitting::PooledConfigurations& pool = transfer.pool();
  write_rows(pool, pool.weights(key.profile.density), distribution, key.profile.seed, run);
  if (run.should_stop())
    return false;
  run.message = std::to_string(pool.size()) + " configurations of revision " +
                std::to_string(distribution.revision);
  return true;
}

}  // namespace

Result<Jobs::Task> export_configurations_job(const fitting::FitContext& context,
                                             Distribution distribution,
                                             const std::string& request_key) {
  const Result<fitting::DistributionKey> key = key_of(distribution, context.robots);
  if (!key)
    return key.error();
  if (distribution.configurations == 0)
    return Error{ErrorCode::InvalidInput, "distribution " + distribution.id.short_hex() +
                                              " has no configurations: " + distribution.reason};
  if (catalog::is_retired(distribution, context.store.experience(distribution.task)))
    return Error{ErrorCode::Conflict, "paths of task '" + distribution.task +
                                          "' were retired since the fit of revision " +
                                          std::to_string(distribution.revision) +
                                          after_evicting(distribution)};
  return Jobs::Task{
      .verb = "configurations export",
      .argument = distribution.id.hex(),
      .request_key = request_key,
      .run = [context, key = *key, distribution = std::move(distribution)](JobRun& run) {
        return run_export(context, key, distribution, run);
      }};
}

}  // namespace kinship::service
