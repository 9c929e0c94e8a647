#include "server/rehearsal/recorded_query.hpp"

#include <charconv>
#include <map>
#include <string_view>
#include <utility>

#include "robots/kinematics/forward_kinematics.hpp"
#include "server/fitting/selected_experience.hpp"

namespace kinship::rehearsal {
namespace {

constexpr std::size_t kPage = 128;

using SharedScene = std::shared_ptr<const RecordedScene>;

/// The number behind `name` in "a=1 b=2"; nothing if it is not there or not within its limits.
std::optional<double> option(std::string_view options, std::string_view name, double least,
                             double most) {
  const std::size_t at = options.find(name);
  if (at == std::string_view::npos || (at > 0 && options[at - 1] != ' '))
    return std::nullopt;
  const std::string_view text = options.substr(at + name.size());
  double value = 0;
  if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc() ||
      !(value >= least && value <= most))
    return std::nullopt;
  return value;
}

/// Reads the queries of one key.
class QueryReader {
 public:
  QueryReader(const store::ExperienceStore& store, runtime::RobotRegistry& robots,
              const fitting::DistributionKey& key)
      : store_(store), robots_(robots), key_(key) {}

  void read(const store::ExperienceSummary& source, std::uint64_t wanted,
            const std::stop_token& stop) {
    const auto robot = robots_.find(source.robot);
    if (!robot)
      return;
    store::PathRange range{
        .after_id = 0, .limit = kPage, .since_ms = key_.since_ms, .generation = source.generation};
    std::uint64_t index = 0;
    while (!stop.stop_requested()) {
      const std::vector<store::StoredPath> page = store_.read_paths(source.robot, key_.task, range);
      if (page.empty())
        return;
      range.after_id = page.back().id;
      for (const store::StoredPath& stored : page) {
        if ((index + 1) * wanted / source.paths > index * wanted / source.paths)
          add(stored, **robot);
        ++index;
      }
    }
  }

  RecordedQueries take() {
    if (newest_) {
      const std::optional<Attempt> attempt = store_.find_attempt(*newest_);
      if (attempt) {
        constexpr double kLeastStep = 1e-3, kMostStep = 1, kMostOvershoot = 10;
        const std::string_view options = attempt->record.planner_options;
        found_.steps.step =
            option(options, "step=", kLeastStep, kMostStep).value_or(found_.steps.step);
        found_.steps.overshoot =
            option(options, "overshoot=", 1, kMostOvershoot).value_or(found_.steps.overshoot);
      }
    }
    return std::move(found_);
  }

 private:
  void add(const store::StoredPath& stored, const runtime::Robot& robot) {
    const Eigen::Index last = stored.path.size() - 1;
    if (stored.path.dof() != robot.chain.dof() || last < 1)
      return;
    SharedScene scene;
    if (stored.scene_id) {
      scene = find_scene(*stored.scene_id);
      if (!scene)
        return;  // without its obstacles it is another query
    }
    const Eigen::Isometry3d T_task_base =
        stored.T_task_base.value_or(Eigen::Isometry3d::Identity());
    const Eigen::VectorXd start = stored.path.waypoints().col(0);
    RecordedQuery query{
        stored.report_uuid,
        T_task_base,
        T_task_base * kinematics::T_base_transfer(robot.chain, start),
        T_task_base * kinematics::T_base_transfer(robot.chain, stored.path.waypoints().col(last)),
        std::nullopt,
        std::move(scene)};
    if (robot.digest == key_.robot)
      query.own = stored.path.waypoints();
    found_.queries.push_back(std::move(query));
    newest_ = stored.report_uuid;
  }

  SharedScene find_scene(std::int64_t id) {
    const auto known = scenes_.find(id);
    if (known != scenes_.end())
      return known->second;
    std::optional<RecordedScene> scene = store_.read_scene(id);
    SharedScene shared = scene ? std::make_shared<const RecordedScene>(*std::move(scene)) : nullptr;
    return scenes_.emplace(id, std::move(shared)).first->second;
  }

  const store::ExperienceStore& store_;
  runtime::RobotRegistry& robots_;
  const fitting::DistributionKey& key_;
  std::map<std::int64_t, SharedScene> scenes_;
  std::optional<Uuid> newest_;
  RecordedQueries found_;
};

}  // namespace

RecordedQueries read_queries(const store::ExperienceStore& store, runtime::RobotRegistry& robots,
                             const fitting::DistributionKey& key, std::size_t most,
                             const std::stop_token& stop) {
  const std::vector<store::ExperienceSummary> experience =
      fitting::selected_experience(key, store.experience(key.task));
  std::vector<std::uint64_t> counts;
  counts.reserve(experience.size());
  for (const store::ExperienceSummary& source : experience)
    counts.push_back(source.paths);
  const std::vector<std::uint64_t> shares = fitting::share_paths(counts, most, Weighting::Sources);
  QueryReader reader(store, robots, key);
  for (std::size_t i = 0; i < experience.size(); ++i)
    if (shares[i] > 0)
      reader.read(experience[i], shares[i], stop);
  return reader.take();
}

}  // namespace kinship::rehearsal
