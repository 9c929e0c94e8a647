// Plans along kinds of constraint, uniform, the first path, without shortening: ours, all lines of
// which are proven, beside RRTConnect in OMPL's constrained spaces. All know the same goals, ask
// the same world and hold the same equations to the same tolerance. Each has the range and step of
// least mean time on the tuning seeds. Processor time of a plan. A query without an answer, or with
// one that leaves the constraint, counts the limit; answers that touch something between their
// steps are only told.
//
//   constrained_bench       the figures, on the test seeds
//   constrained_bench tune  every range and step on the tuning seeds

#include <array>
#include <cstdio>
#include <functional>
#include <iostream>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "robots/planning/birrt.hpp"
#include "robots/planning/proven_path.hpp"
#include "tests/bench/constrained_cells.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/manifold_spaces.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/shelf_cell.hpp"

namespace kinship::bench {
namespace {

constexpr int kQueries = 30, kTuningQueries = 10;
constexpr std::uint64_t kTuningSeed = 100'000;
constexpr double kLimit_s = 0.5;
constexpr double kClearance_m = 1e-4;  // of a proven line
constexpr double kStep = 0.1;          // ours, joint units

constexpr std::array<std::pair<SpaceKind, const char*>, 4> kSpaces = {
    {{SpaceKind::Projected, "OMPL's projected space"},
     {SpaceKind::OurProjection, "OMPL's projected space, our projection"},
     {SpaceKind::Atlas, "OMPL's atlas"},
     {SpaceKind::TangentBundle, "OMPL's tangent bundle"}}};

/// Range and step of each space for a kind of constraint.
struct Reach {
  double range = 0, delta = 0.1;  ///< see SpaceOptions
};

/// Of least mean time on the tuning seeds, in the order of the kinds and spaces.
constexpr std::array<std::array<Reach, kSpaces.size()>, kConstraintKinds.size()> kTuned = {
    {{{{1}, {2}, {0}, {0}}},
     {{{4}, {0}, {0}, {0, 0.05}}},
     {{{0.5}, {0.5}, {0}, {0}}},
     {{{4}, {0}, {0}, {0}}},
     {{{4}, {4}, {2}, {0}}},
     {{{1}, {1}}}}};

/// A cell with its world, and the configurations between which a plan is wanted.
struct Query {
  const kinematics::Chain& chain;
  ConstrainedCell cell;
  collision::CollisionWorld world;
  Eigen::VectorXd start;
  Eigen::MatrixXd goals;
  std::uint64_t seed;

  Eigen::Matrix2Xd bounds() const { return planning::planning_bounds(chain, start); }
  planning::RegionConstraint constraint() const {
    return {chain, cell.region, Eigen::Isometry3d::Identity(), bounds()};
  }
};

/// What a planner is told of the query.
struct Answer {
  std::optional<Eigen::MatrixXd> way;  ///< dof x n: every configuration that it passes
  double time_s = 0;
  std::uint64_t checks = 0, projections = 0;
};

using Planner = std::function<Answer(Query&)>;

std::vector<Query> draw_queries(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                                const ConstraintKind& kind, std::uint64_t first_seed, int count) {
  std::vector<Query> queries;
  for (std::uint64_t seed = first_seed; std::cmp_less(queries.size(), count); ++seed) {
    if (seed - first_seed > 20 * static_cast<std::uint64_t>(count))
      throw std::runtime_error(std::string(kind.name) + ": too few cells have a start and a goal");
    std::mt19937_64 generator(seed);
    ConstrainedCell cell = kind.make(chain, generator);
    collision::CollisionWorld world(chain, shapes, cell.surroundings);
    const Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
    const Eigen::MatrixXd starts = free_configurations(chain, world, cell.T_base_start, middle);
    if (starts.cols() == 0)
      continue;
    const Eigen::VectorXd start = starts.col(
        static_cast<Eigen::Index>(generator() % static_cast<std::uint64_t>(starts.cols())));
    Eigen::MatrixXd goals(chain.dof(), 0);
    for (const Eigen::Isometry3d& T_base_goal : cell.T_base_goals) {
      const Eigen::MatrixXd more = free_configurations(chain, world, T_base_goal, start);
      goals.conservativeResize(Eigen::NoChange, goals.cols() + more.cols());
      goals.rightCols(more.cols()) = more;
    }
    if (goals.cols() > 0)
      queries.push_back({chain, std::move(cell), std::move(world), start, goals, seed});
  }
  return queries;
}

/// Every line of the answer is proven to be free, as kinship-plan does it.
Answer plan_ours(Query& query, double step) {
  const double begin_s = thread_cpu_s();
  const Eigen::Matrix2Xd bounds = query.bounds();
  const planning::ConfigurationSampler sampler(bounds);
  planning::RegionConstraint constraint(query.chain, query.cell.region,
                                        Eigen::Isometry3d::Identity(), bounds);
  planning::BirrtOptions options;
  options.step = step;
  options.max_checks = std::numeric_limits<std::uint64_t>::max();
  options.time_limit = std::chrono::duration<double>(kLimit_s);
  std::mt19937_64 generator(query.seed);
  collision::EdgeProver prover(query.world);
  const planning::IsFree is_free = planning::proven_in(prover, {.clearance_m = kClearance_m});
  const auto plan = [&](const Eigen::VectorXd& from, const Eigen::MatrixXd& to) {
    return planning::plan_cbirrt2(from, to, {is_free, constraint}, sampler, options, generator);
  };
  planning::PlanSummary summary = plan(query.start, query.goals);
  if (summary.waypoints) {
    const planning::ProvenPath path = planning::shorten_and_prove(
        *summary.waypoints, step, is_free,
        [](const Eigen::MatrixXd& waypoints, const planning::IsFree&) {
          return planning::ShortcutSummary{waypoints};
        },
        [&](const Eigen::VectorXd& from, const Eigen::VectorXd& to, double finer) {
          options.step = finer;
          return plan(from, to);
        });
    summary.collision_checks += path.collision_checks;
    summary.waypoints.reset();
    if (path.reason == planning::NoPath::None)
      summary.waypoints = path.waypoints;
  }
  Answer answer{std::move(summary.waypoints), thread_cpu_s() - begin_s};
  answer.checks = summary.collision_checks;
  answer.projections = constraint.projections();
  return answer;
}

/// The time is that of OMPL's solve(), without setting it up.
Answer plan_with_ompl(Query& query, const SpaceOptions& options) {
  planning::RegionConstraint constraint = query.constraint();
  ompl::RNG::setSeed(query.seed + 1);
  const ManifoldQuery::IsFree is_free = [&](const Eigen::VectorXd& q) {
    return !query.world.collides(q);
  };
  ManifoldQuery manifold(
      query.bounds(),
      std::make_shared<RegionEquations>(query.chain.dof(), query.cell.region, constraint,
                                        options.kind != SpaceKind::OurProjection),
      options, is_free);
  manifold.pose(query.start, query.goals);
  const std::uint64_t before = query.world.checks(), projected = constraint.projections();
  const double begin_s = thread_cpu_s();
  const bool solved = manifold.solve([&] { return thread_cpu_s() - begin_s >= kLimit_s; });
  Answer answer{std::nullopt, thread_cpu_s() - begin_s};
  answer.checks = query.world.checks() - before;
  answer.projections = constraint.projections() - projected;
  if (solved)
    answer.way = manifold.way();
  return answer;
}

/// What is wrong with an answer.
struct Faults {
  bool strays = false;   ///< not from the start to a goal, out of bounds, or steps too far apart
  bool off = false;      ///< off the constraint at a configuration, or farther off between two
  bool touches = false;  ///< collides

  bool refuses() const { return strays || off; }
};

/// Looks every hundredth of a joint unit.
Faults verify(Query& query, const Eigen::MatrixXd& way) {
  constexpr double kLook = 0.01, kFarApart = 0.2, kRounding = 1e-6;
  using Constraint = planning::RegionConstraint;
  const Constraint constraint = query.constraint();
  const Eigen::Matrix2Xd bounds = query.bounds();
  const Eigen::VectorXd end = way.rightCols<1>();
  Faults faults;
  faults.strays = (way.col(0) - query.start).norm() > kRounding ||
                  (query.goals.colwise() - end).colwise().norm().minCoeff() > kRounding;
  for (Eigen::Index i = 0; i < way.cols(); ++i) {
    const Eigen::VectorXd q = way.col(i), last = way.col(std::max<Eigen::Index>(i - 1, 0));
    const double apart = (q - last).norm();
    faults.strays |= apart > kFarApart + kRounding ||
                     ((q - bounds.row(0).transpose()).array() < -kRounding).any() ||
                     ((q - bounds.row(1).transpose()).array() > kRounding).any();
    faults.off |= constraint.distance(q) > Constraint::kWaypointTolerance + kRounding;
    const int looks = std::max(1, static_cast<int>(std::ceil(apart / kLook)));
    for (int look = 1; look <= looks; ++look) {
      const Eigen::VectorXd between = last + (q - last) * look / looks;
      faults.off |= constraint.distance(between) > Constraint::kBetweenTolerance;
      faults.touches |= query.world.collides(between);
    }
  }
  return faults;
}

/// What a planner did in the queries of one kind.
struct Score {
  std::vector<double> times_ms;        ///< the limit where there is no answer, or a refused one
  double checks = 0, projections = 0;  ///< a query
  std::size_t answered = 0, refused = 0, touching = 0;

  double mean_ms() const {
    return std::accumulate(times_ms.begin(), times_ms.end(), 0.0) /
           static_cast<double>(times_ms.size());
  }
};

Score score_of(const Planner& plan, std::vector<Query>& queries) {
  Score score;
  const double share = 1 / static_cast<double>(queries.size());
  for (Query& query : queries) {
    const Answer answer = plan(query);
    const Faults faults = answer.way ? verify(query, *answer.way) : Faults{};
    score.times_ms.push_back(1e3 * (answer.way && !faults.refuses() ? answer.time_s : kLimit_s));
    score.checks += share * static_cast<double>(answer.checks);
    score.projections += share * static_cast<double>(answer.projections);
    score.answered += answer.way ? 1U : 0U;
    score.refused += faults.refuses() ? 1U : 0U;
    score.touching += faults.touches ? 1U : 0U;
  }
  return score;
}

std::string text_of(const Score& score) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(),
                "mean %.3f, 95 %% %.3f ms, answers %zu of %zu, refused %zu, touching between steps "
                "%zu, checks %.0f, projections %.0f",
                score.mean_ms(), percentile(score.times_ms, 0.95), score.answered,
                score.times_ms.size(), score.refused, score.touching, score.checks,
                score.projections);
  return text.data();
}

/// A region is no manifold, and its inside has no tangent space.
bool suits(SpaceKind space, const ConstraintKind& kind) {
  return kind.is_manifold || space == SpaceKind::Projected || space == SpaceKind::OurProjection;
}

void tune(const kinematics::Chain& chain, const geometry::RobotShapes& shapes) {
  for (const ConstraintKind& kind : kConstraintKinds) {
    std::vector<Query> queries = draw_queries(chain, shapes, kind, kTuningSeed, kTuningQueries);
    const auto show = [&](const std::string& name, const Planner& plan) {
      const Score score = score_of(plan, queries);
      std::cout << kind.name << ", " << name << ": median " << median(score.times_ms) << ", "
                << text_of(score) << std::endl;
    };
    for (const double step : {0.05, kStep, 0.15})
      show("step " + std::to_string(step), [&](Query& query) { return plan_ours(query, step); });
    for (const auto& [space, name] : kSpaces)
      if (suits(space, kind))
        for (const double delta : {0.05, 0.1})
          for (const double range : {0.0, 0.5, 1.0, 2.0, 4.0})
            show(std::string(name) + ", delta " + std::to_string(delta) + ", range " +
                     std::to_string(range),
                 [&, space = space](Query& query) {
                   return plan_with_ompl(query, {space, range, delta});
                 });
  }
}

void measure(const kinematics::Chain& chain, const geometry::RobotShapes& shapes) {
  for (std::size_t i = 0; i < kConstraintKinds.size(); ++i) {
    const ConstraintKind& kind = kConstraintKinds[i];
    std::vector<Query> queries = draw_queries(chain, shapes, kind, 0, kQueries);
    const Score ours = score_of([](Query& query) { return plan_ours(query, kStep); }, queries);
    for (std::size_t j = 0; j < kSpaces.size(); ++j) {
      const auto& [space, name] = kSpaces[j];
      if (!suits(space, kind))
        continue;
      const Reach& reach = kTuned[i][j];
      const SpaceOptions options{space, reach.range, reach.delta};
      const Score theirs =
          score_of([&](Query& query) { return plan_with_ompl(query, options); }, queries);
      const bool is_claim = i == 0 && space == SpaceKind::Projected;
      print({.name = std::string("panda ") + kind.name + ", median, to " + name,
             .value = median(ours.times_ms),
             .unit = "ms",
             .reference = Reference{name, median(theirs.times_ms)},
             .ratio_budget = is_claim ? std::optional(0.1) : std::nullopt,
             .note = text_of(ours) + "; theirs: " + text_of(theirs)});
    }
  }
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  const std::string word = argc > 1 ? argv[1] : "";
  if (argc > 2 || (argc == 2 && word != "tune")) {
    std::cerr << "usage: constrained_bench [tune]\n";
    return 2;
  }
  const auto chain = kinship::test::model_chain("panda");
  const auto shapes = kinship::bench::model_shapes("panda");
  if (word == "tune")
    kinship::bench::tune(chain, shapes);
  else
    kinship::bench::measure(chain, shapes);
}
