#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/publications.hpp"
#include "proto/types/recall_library.hpp"
#include "proto/types/robot_description.hpp"

namespace kinship::test {

/// Random values that keep the rules of the contract.
class RandomValues {
 public:
  explicit RandomValues(std::uint64_t seed) : generator_(seed) {}

  std::mt19937_64& generator() { return generator_; }
  int below(int limit) { return std::uniform_int_distribution<int>(0, limit - 1)(generator_); }
  bool coin() { return below(2) == 1; }
  double share() { return std::uniform_real_distribution<double>(0, 1)(generator_); }
  double number() { return std::normal_distribution<double>(0, 10)(generator_); }
  std::uint64_t count() { return generator_() >> static_cast<unsigned>(below(64)); }

  Digest digest() {
    Digest digest;
    for (auto& byte : digest.bytes)
      byte = static_cast<std::uint8_t>(generator_());
    return digest;
  }

  std::string name(int max_size) {
    std::string text(static_cast<std::size_t>(1 + below(max_size)), 'a');
    for (char& c : text)
      c = static_cast<char>('a' + below(26));
    return text;
  }

  Eigen::Isometry3d pose() {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() =
        Eigen::Quaterniond(number(), number(), number(), number()).normalized().toRotationMatrix();
    T.translation() << number(), number(), number();
    return T;
  }

  Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [this] { return number(); });
  }

  double size() { return 0.001 + share(); }

  Shape shape() {
    switch (below(4)) {
      case 0:
        return BoxShape{{size(), size(), size()}};
      case 1:
        return CylinderShape{size(), size()};
      case 2:
        return SphereShape{size()};
      default:
        return CapsuleShape{size(), size()};
    }
  }

  /// Bounds on one side, on both or on none.
  TaskSpaceRegion region() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    TaskSpaceRegion region{pose(), pose()};
    for (Eigen::Index i = 0; i < region.bounds.cols(); ++i) {
      const bool is_open = coin(), is_angle = i >= 3;
      const double lower = number();
      region.bounds(0, i) = is_open ? -kInfinity : lower;
      region.bounds(1, i) = (is_angle ? is_open : coin()) ? kInfinity : lower + share();
    }
    return region;
  }

  RecordedScene recorded_scene(int max_objects = 8) {
    RecordedScene scene;
    for (int i = below(max_objects + 1); i > 0; --i)
      scene.objects.push_back({name(30), shape(), pose()});
    for (int i = below(3); i > 0; --i)
      scene.held.push_back({name(30), shape(), pose()});
    for (const SceneObject& object : scene.objects)
      for (const HeldObject& held : scene.held)
        if (coin())
          scene.allowed_collisions.emplace_back(held.name, object.name);
    if (coin())
      scene.constraint = region();
    return scene;
  }

  /// Of a chain with `dof` joints; parts are missing at random.
  SearchRecord search_record(Eigen::Index dof) {
    SearchRecord search;
    if (coin())
      search.start = matrix(dof, 1);
    if (coin())
      search.goals = matrix(dof, 1 + below(5));
    if (coin())
      search.T_task_goal = pose();
    for (int i = below(4); i > 0; --i)
      search.blockers.push_back({name(30), name(30), count()});
    if (search.goals.cols() > 0)
      search.goal_contacts.push_back(
          {static_cast<std::uint32_t>(search.goals.cols() - 1), name(30), name(30)});
    if (coin())
      search.last_free = matrix(dof, 1);
    if (coin()) {
      SearchTree& tree = search.trees.emplace_back();
      tree.configurations = matrix(dof, 1 + below(30)).cast<float>();
      for (std::int32_t i = 0; i < tree.configurations.cols(); ++i)
        tree.parents.push_back(below(i + 1) - 1);
    }
    search.seed = count();
    search.reason = name(100);
    return search;
  }

  Attempt attempt(int max_waypoints = 50) {
    Attempt attempt;
    attempt.report_uuid = Uuid::random();
    attempt.robot = digest();
    attempt.machine = "Halle Süd " + name(20);
    attempt.task = name(128);
    if (coin())
      attempt.T_task_base = pose();
    PlanningRecord& record = attempt.record;
    record.outcome = static_cast<Outcome>(below(3));
    record.planner = name(128);
    record.planner_options = name(1024);
    record.planning_time_s = share();
    record.collision_checks = count();
    record.projections = count();
    record.time_limit_s = 10 * share();
    record.sampling_mode = static_cast<SamplingMode>(below(3));
    record.share = share();
    if (coin())
      record.distribution_id = digest();
    record.distribution_revision = count();
    record.processor_time_s = share();
    record.machine_speed = 2 * share();
    record.hand_length_m = 3 * share();
    record.least_clearance_m = share();
    if (record.outcome == Outcome::Solved)
      attempt.path = Path(matrix(1 + below(32), 2 + below(max_waypoints)));
    return attempt;
  }

  RobotDescription robot_description() {
    RobotDescription robot;
    robot.label = name(64);
    robot.urdf = "<robot>\n\t" + name(5000) + "</robot>";
    robot.base_link = name(128);
    robot.tip_link = name(128);
    robot.T_tip_transfer = pose();
    for (bool& matters : robot.task_axes.matters)
      matters = coin();
    for (int i = below(10); i > 0; --i)
      robot.held_joints[name(100)] = number();
    for (int i = below(10); i > 0; --i)
      robot.never_colliding.emplace_back(name(50), name(50));
    for (int i = below(5); i > 0; --i) {
      const bool is_altered = coin();
      robot.meshes.push_back(
          {name(50), is_altered ? MeshRole::Visual : MeshRole::Both, pose(),
           coin() ? std::vector<double>{0, 0.5, share(), 1} : std::vector<double>{},
           is_altered ? share() : 0, digest()});
    }
    return robot;
  }

  Mixture mixture(Eigen::Index dof) {
    const Eigen::Index components = 1 + below(20);
    Eigen::VectorXd weights =
        Eigen::VectorXd::NullaryExpr(components, [this] { return 0.01 + share(); });
    weights /= weights.sum();
    std::vector<Eigen::MatrixXd> covariances;
    for (Eigen::Index i = 0; i < components; ++i) {
      const Eigen::MatrixXd factor = matrix(dof, dof);
      covariances.emplace_back(factor * factor.transpose());
    }
    return {weights, matrix(dof, components), covariances};
  }

  /// A mixture whose components share a covariance, with means that f32 can hold.
  Mixture kernels(Eigen::Index dof) {
    const Eigen::Index components = 2 + below(200);
    Eigen::VectorXd weights =
        Eigen::VectorXd::NullaryExpr(components, [this] { return 0.01 + share(); });
    weights /= weights.sum();
    const Eigen::MatrixXd factor = matrix(dof, dof);
    return {weights,
            matrix(dof, components).cast<float>().cast<double>(),
            {factor * factor.transpose()}};
  }

  Selection selection() {
    Selection selection;
    for (int i = below(5); i > 0; --i)
      selection.sources.push_back(digest());
    std::sort(selection.sources.begin(), selection.sources.end());
    if (coin())
      selection.weighting = static_cast<Weighting>(below(2));
    if (coin())
      selection.since_ms = static_cast<std::int64_t>(count() / 2);
    return selection;
  }

  Source source() {
    Source source;
    for_each_field<Source>([&]<typename Of, typename T>(const Field<Of, T>& field) {
      if constexpr (std::is_same_v<T, std::uint64_t>)
        source.*field.member = count();
    });
    source.robot = digest();
    source.label = name(64);
    source.relation = static_cast<Relation>(below(3));
    source.mass = share();
    return source;
  }

  ModeEvidence evidence() {
    const std::uint64_t attempts = count();
    return {.attempts = attempts, .solved = attempts / 2, .checks_per_solution = 1000 * share()};
  }

  std::vector<JudgedAttempt> recent() {
    std::vector<JudgedAttempt> recent(static_cast<std::size_t>(below(4)));
    auto age = static_cast<std::uint32_t>(recent.size());
    for (JudgedAttempt& attempt : recent)
      attempt = {.sampling_mode = coin() ? SamplingMode::Guided : SamplingMode::Control,
                 .solved = coin(),
                 .checks = count(),
                 .age = --age,
                 .time_s = share()};
    return recent;
  }

  Rehearsal rehearsal() {
    Rehearsal rehearsal;
    rehearsal.guide = static_cast<Guide>(below(16));
    rehearsal.is_complete = coin();
    rehearsal.queries = count();
    rehearsal.left_out = count();
    rehearsal.processor_time_s = share();
    for (int i = below(17); i > 0; --i) {
      const std::uint64_t plans = count();
      rehearsal.costs.push_back(
          {static_cast<Guide>(below(16)), plans, plans / 2, 1000 * share(), 1000 * share()});
    }
    rehearsal.message = name(100);
    return rehearsal;
  }

  /// Of at least one query, path and mode; waypoints that f32 can hold.
  RecallLibrary recall_library(Eigen::Index dof, int max_paths = 5) {
    RecallLibrary library;
    library.revision = 1 + count() / 2;
    library.search_checks = 1000 * share();
    library.try_checks = 100 * share();
    for (int i = below(3); i > 0; --i)
      library.anchors.push_back(name(100));
    for (int i = 1 + below(5); i > 0; --i) {
      RecallQuery& query = library.queries.emplace_back();
      query.report = Uuid::random();
      query.is_synthetic = coin();
      query.T_task_base = pose();
      query.start = matrix(dof, 1);
      query.goal = matrix(dof, 1);
      for (std::size_t anchor = 0; anchor < library.anchors.size(); ++anchor)
        query.T_task_anchors.push_back(pose());
    }
    const auto queries = static_cast<int>(library.queries.size());
    for (int i = 1 + below(max_paths); i > 0; --i)
      library.paths.push_back({static_cast<std::uint32_t>(below(queries)),
                               matrix(dof, kRecallWaypoints).cast<float>().cast<double>()});
    const int frames = 2 + static_cast<int>(library.anchors.size());
    for (int i = 1 + below(4); i > 0; --i)
      library.modes.push_back({static_cast<std::uint32_t>(below(kMaxWarpBlends)),
                               static_cast<std::uint32_t>(below(frames))});
    for (auto* const bits : {&library.solves, &library.reaches}) {
      bits->resize((library.queries.size() * library.paths.size() * library.modes.size() + 7) / 8);
      for (std::uint8_t& byte : *bits)
        byte = static_cast<std::uint8_t>(below(256));
    }
    return library;
  }

  Announcement announcement() {
    return {.distribution_id = digest(),
            .task = name(128),
            .robot = digest(),
            .revision = count(),
            .store_epoch = Uuid::random()};
  }

  Event event() {
    return {.kind = static_cast<EventKind>(below(6)),
            .time_ms = static_cast<std::int64_t>(count() / 2),
            .task = coin() ? name(128) : "",
            .robot = coin() ? name(64) : "",
            .text = name(512)};
  }

  Distribution distribution() {
    Distribution distribution;
    distribution.id = digest();
    distribution.revision = count();
    distribution.store_epoch = Uuid::random();
    distribution.task = name(128);
    distribution.robot = digest();
    if (coin())
      distribution.T_task_base = pose();
    distribution.profile = "default";
    distribution.engines = "transfer 1, density 1";
    distribution.state = static_cast<DistributionState>(below(3));
    distribution.reason = name(100);
    for (int i = below(5); i > 0; --i)
      distribution.sources.push_back(source());
    distribution.selection = selection();
    distribution.configurations = count();
    const Eigen::Index dof = 1 + below(32);
    distribution.limits.resize(2, dof);
    distribution.limits.row(0) = matrix(1, dof);
    distribution.limits.row(1) = distribution.limits.row(0).array() + 1;
    if (has_mixture(distribution.state))
      distribution.mixture = coin() ? mixture(dof) : kernels(dof);
    if (coin())
      distribution.held_out_score = number();
    for (int components = below(40); components > 0; components -= 7)
      distribution.component_scores.push_back({components, number()});
    if (coin())
      distribution.cuts.resize(static_cast<std::size_t>(dof));
    if (!distribution.cuts.empty())
      distribution.cuts[static_cast<std::size_t>(below(static_cast<int>(dof)))] = number();
    if (coin())
      distribution.fit = FitOrigin{5, static_cast<std::uint64_t>(below(6)),
                                   9, static_cast<std::uint64_t>(below(10)),
                                   9, name(100)};
    distribution.advice.recommended_share = share();
    distribution.advice.evidence = name(100);
    if (coin())
      distribution.advice.guided = evidence();
    if (coin())
      distribution.advice.control = evidence();
    distribution.advice.guided_share = share();
    distribution.advice.recent = recent();
    distribution.fitted_ms = static_cast<std::int64_t>(count() / 2);
    distribution.transfer_time_s = share();
    distribution.fit_time_s = share();
    return distribution;
  }

 private:
  std::mt19937_64 generator_;
};

}  // namespace kinship::test
