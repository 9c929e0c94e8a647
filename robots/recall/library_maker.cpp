#include "robots/recall/library_maker.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <span>
#include <utility>

#include "proto/types/sha256.hpp"
#include "proto/types/split_mix.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/birrt.hpp"
#include "robots/planning/guided_sampler.hpp"
#include "robots/planning/path_vertices.hpp"
#include "robots/planning/planning_budget.hpp"
#include "robots/planning/shortcut.hpp"
#include "robots/recall/anchors.hpp"
#include "robots/recall/clear_path.hpp"
#include "robots/recall/recall.hpp"

namespace kinship::recall {
namespace {

constexpr std::size_t kProbed = 16;       // queries by which modes are chosen
constexpr std::size_t kTriedPaths = 128;  // on a query; RecallGuide learns from 64 of them
constexpr double kWorthKeeping = 0.6;     // of the best mode's success
constexpr double kUsualTryChecks = 40;    // where none was measured
constexpr std::size_t kMostModes = 4;
constexpr std::uint64_t kPlans = 3;   // uniform ones of a query, of which the shortest is kept
constexpr double kAnotherGoal = 0.1;  // joint units, from the goal reached
constexpr double kLeastClearance_m = 0.004;  // where there is no room for the others

std::vector<std::uint8_t> no_bits(const RecallLibrary& library) {
  return std::vector<std::uint8_t>(
      (library.queries.size() * library.paths.size() * library.modes.size() + 7) / 8);
}

void set_bit(std::vector<std::uint8_t>& bits, std::size_t at) {
  bits[at / 8] = static_cast<std::uint8_t>(bits[at / 8] | 1U << (at % 8));
}

/// All blends with all frames that furniture may keep, and one with the goal's.
std::vector<WarpMode> all_modes(std::size_t anchors) {
  std::vector<WarpMode> modes;
  for (std::uint32_t frame = kTaskFrame; frame < kFirstAnchor + anchors; ++frame)
    for (std::uint32_t blend = 0; blend < kWarpBlends.size(); ++blend)
      modes.push_back({blend, frame});
  modes.push_back({1, kGoalFrame});
  return modes;
}

/// A number that other content has another of. Never 0.
std::uint64_t revision_of(const RecallLibrary& library) {
  Sha256 digest;
  for (const RecallQuery& query : library.queries)
    digest.add(query.report.bytes).add(query.goal);
  for (const RecallPath& path : library.paths)
    digest.add(path.waypoints);
  digest.add(library.solves).add(library.reaches);
  const Digest whole = digest.finish();
  std::uint64_t revision = 0;
  for (std::size_t i = 0; i < sizeof revision; ++i)
    revision = revision << 8 | whole.bytes[i];
  return std::max<std::uint64_t>(revision, 1);
}

}  // namespace

/// A query's obstacles, and what is free among them.
struct LibraryMaker::World {
  World(const LibraryMaker& maker, const PosedQuery& posed, double larger_by_m = 0)
      : world(maker.solids_, enlarged(posed.surroundings, larger_by_m)),
        is_free(planning::free_in(world, maker.options_.before)) {
    if (posed.constraint)
      constraint.emplace(maker.chain_, *posed.constraint, posed.surroundings.T_task_base,
                         posed.bounds);
  }

  /// Null: none.
  planning::RegionConstraint* constraint_or_null() { return constraint ? &*constraint : nullptr; }

  collision::CollisionWorld world;
  planning::IsFree is_free;
  std::optional<planning::RegionConstraint> constraint;
};

LibraryMaker::LibraryMaker(const kinematics::Chain& chain, const collision::RobotSolids& solids,
                           std::vector<PosedQuery> queries, LibraryMakerOptions options)
    : chain_(chain),
      solids_(solids),
      queries_(std::move(queries)),
      options_(std::move(options)),
      no_experience_(std::make_shared<planning::ExperienceGuide>(chain, TaskExperience{})) {
  constexpr std::size_t kMostBytes = 512 * 1024;  // of waypoints, in a message
  const std::size_t bytes =
      sizeof(float) * kRecallWaypoints * static_cast<std::size_t>(chain.dof());
  max_paths_ = std::min(options_.max_paths, kMostBytes / bytes);
  const std::size_t clear = queries_.size() * options_.clearances_m.size();
  if (!queries_.empty() && clear < max_paths_)
    branches_ = std::min<std::size_t>(static_cast<std::size_t>(options_.branches),
                                      (max_paths_ - clear) / queries_.size());
  advance();
}

/// To the first phase from here that has a part left.
void LibraryMaker::advance() {
  while (phase_ != Phase::Done && next_ >= parts_of_phase()) {
    next_ = 0;
    spent_s_ = 0;
    if (phase_ == Phase::Solve)
      begin_probe();
    else if (phase_ == Phase::Probe)
      begin_tries();
    else
      finish();
  }
}

std::size_t LibraryMaker::parts_of_phase() const {
  if (phase_ == Phase::Solve)
    return queries_.size();
  return phase_ == Phase::Probe ? std::min(kProbed, library_.queries.size())
                                : library_.queries.size();
}

bool LibraryMaker::step() {
  if (phase_ == Phase::Done)
    return false;
  const double begin_s = planning::thread_time_s();
  if (phase_ == Phase::Solve)
    solve(next_);
  else if (phase_ == Phase::Probe)
    probe(next_ * library_.queries.size() / parts_of_phase());
  else
    try_all(next_);
  ++next_;
  spent_s_ += planning::thread_time_s() - begin_s;
  if (spent_s_ > options_.max_phase_s)  // what is left of the phase is left out
    next_ = parts_of_phase();
  advance();
  return true;
}

planning::PlanSummary LibraryMaker::plan(const PosedQuery& posed, World& world,
                                         const Eigen::MatrixXd& goals, Guide guide,
                                         std::uint64_t seed) const {
  planning::BirrtOptions options;
  options.step = options_.step;
  options.max_checks = options_.max_checks;
  options.time_limit = kNoTimeLimit;
  std::mt19937_64 generator(seed);
  const planning::TrackQuery query{posed.surroundings.T_task_base, posed.bounds, posed.start,
                                   goals};
  const auto sampler =
      planning::guided_sampler(chain_, query, nullptr, no_experience_, {.guide = guide}).sampler;
  return planning::plan_trees(posed.start, goals, {world.is_free, world.constraint_or_null()},
                              sampler, options, generator);
}

/// A recorded answer at the steps of a plan; nothing if it does not keep the constraint.
std::optional<Eigen::MatrixXd> LibraryMaker::as_planned(const Eigen::MatrixXd& answer,
                                                        World& world) const {
  if (!world.constraint)
    return answer;
  for (const auto& q : answer.colwise())
    if (!world.constraint->holds(q))
      return std::nullopt;
  return planning::ConstrainedStepper(options_.step, *world.constraint).way_through(answer);
}

/// The shortest answer once each is shortened a little: a way around is long however it is
/// polished.
Eigen::MatrixXd LibraryMaker::shortest(const std::vector<Eigen::MatrixXd>& answers,
                                       World& world) const {
  const planning::ShortcutOptions options{options_.step, 500};
  Eigen::MatrixXd best;
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::MatrixXd& answer : answers) {
    std::mt19937_64 generator(answers.size());
    Eigen::MatrixXd shorter =
        planning::shortcut(answer, world.is_free, world.constraint_or_null(), options, generator)
            .waypoints;
    const double length = planning::path_length(shorter);
    if (length < least) {
      least = length;
      best = std::move(shorter);
    }
  }
  return best;
}

/// Solves a query and keeps its paths with clearance.
void LibraryMaker::solve(std::size_t query) {
  const PosedQuery& posed = queries_[query];
  World world(*this, posed);
  const std::uint64_t seed = split_mixed((query + 1) * kSplitMixStep);
  const planning::PlanSummary found = plan(posed, world, posed.goals, Guide::None, seed);
  const planning::PlanSummary backed = plan(posed, world, posed.goals, Guide::Retreat, seed);
  planned_ += found.collision_checks > 0 ? 1 : 0;
  planned_s_ += found.planning_time_s;
  uniform_checks_ += static_cast<double>(found.collision_checks);
  retreat_checks_ += static_cast<double>(backed.collision_checks);
  // A query that the robot answered asked for the goal of that answer.
  const Eigen::MatrixXd goals =
      posed.solution ? Eigen::MatrixXd(posed.solution->rightCols<1>()) : posed.goals;
  std::vector<Eigen::MatrixXd> answers;
  if (auto own = posed.solution ? as_planned(*posed.solution, world) : std::nullopt)
    answers.push_back(*std::move(own));
  for (const planning::PlanSummary* each : {&found, &backed})
    if (!posed.solution && each->waypoints)
      answers.push_back(*each->waypoints);
  for (std::uint64_t again = 1; again < kPlans; ++again)
    if (auto other = plan(posed, world, goals, Guide::None, seed + again); other.waypoints)
      answers.push_back(*std::move(other.waypoints));
  if (answers.empty())
    return;
  const Eigen::MatrixXd raw = shortest(answers, world);
  RecallQuery solved;
  solved.report = posed.report;
  solved.is_synthetic = !posed.solution.has_value();
  solved.T_task_base = posed.surroundings.T_task_base;
  solved.start = posed.start;
  solved.goal = raw.rightCols<1>();
  posed_of_.push_back(query);
  library_.queries.push_back(std::move(solved));
  const std::size_t before = library_.paths.size();
  add_clear_paths(posed, raw, options_.clearances_m);
  if (library_.paths.size() == before)
    add_clear_paths(posed, raw, {&kLeastClearance_m, 1});
  if (library_.paths.size() == before)
    add_path(raw);

  const Eigen::VectorXd from_goal =
      (posed.goals.colwise() - library_.queries.back().goal).colwise().norm();
  const Eigen::VectorXd from_start = (posed.goals.colwise() - posed.start).colwise().norm();
  std::vector<Eigen::Index> others;
  for (Eigen::Index i = 0; i < posed.goals.cols(); ++i)
    if (from_goal[i] > kAnotherGoal)
      others.push_back(i);
  std::ranges::stable_sort(others, {}, [&](Eigen::Index goal) { return from_start[goal]; });
  others.resize(std::min(others.size(), branches_));
  for (const Eigen::Index other : others)
    if (const planning::PlanSummary branch =
            plan(posed, world, posed.goals.col(other), Guide::Retreat, seed);
        branch.waypoints)
      add_clear_paths(posed, *branch.waypoints, {options_.clearances_m.data(), 1});
}

void LibraryMaker::add_clear_paths(const PosedQuery& posed, const Eigen::MatrixXd& raw,
                                   std::span<const double> clearances_m) {
  for (const double clearance_m : clearances_m) {
    World larger(*this, posed, clearance_m);
    const ClearPathOptions options{.step = options_.step,
                                   .plan_checks = options_.max_checks,
                                   .constraint = larger.constraint_or_null()};
    std::mt19937_64 generator(library_.paths.size());
    if (const auto clear = clear_path(raw, larger.is_free, posed.bounds, options, generator))
      add_path(*clear);
  }
}

/// Of the newest query.
void LibraryMaker::add_path(const Eigen::MatrixXd& path) {
  library_.paths.push_back(
      {static_cast<std::uint32_t>(library_.queries.size() - 1), equal_parts(path)});
}

/// Chooses the anchors, and tries every mode on a few queries.
void LibraryMaker::begin_probe() {
  phase_ = Phase::Probe;
  std::vector<const std::vector<SceneObject>*> scenes;
  for (const std::size_t query : posed_of_)
    scenes.push_back(&queries_[query].surroundings.scene.objects);
  library_.anchors = choose_anchors(scenes, kMaxRecallAnchors);
  for (std::size_t i = 0; i < library_.queries.size(); ++i)
    for (const auto& T_task_anchor : find_anchors(library_.anchors, *scenes[i]))
      library_.queries[i].T_task_anchors.push_back(*T_task_anchor);
  library_.modes = all_modes(library_.anchors.size());
  worked_.assign(library_.modes.size(), 0);
  library_.solves = library_.reaches = no_bits(library_);
  guide_.emplace(chain_, library_);
}

Query LibraryMaker::query_of(std::size_t query, World& world, bool is_pose) const {
  const RecallQuery& solved = library_.queries[query];
  Query wanted;
  wanted.T_task_base = solved.T_task_base;
  wanted.bounds = queries_[posed_of_[query]].bounds;
  wanted.start = solved.start;
  if (is_pose)
    wanted.T_base_goal = kinematics::T_base_transfer(chain_, solved.goal);
  else
    wanted.goals = solved.goal;
  wanted.constraint = world.constraint_or_null();
  wanted.T_task_anchors.assign(solved.T_task_anchors.begin(), solved.T_task_anchors.end());
  return wanted;
}

bool LibraryMaker::works(const planning::IsFree& is_free, const Query& query,
                         const Candidate& candidate) {
  const double begin_s = planning::thread_time_s();
  RecallSummary summary;
  auto warp = guide_->warp(query, candidate);
  if (warp && is_goal_free(*warp, is_free, summary) &&
      is_way_free(*warp, is_free, options_.step, summary))
    return true;
  failed_s_ += planning::thread_time_s() - begin_s;
  ++failed_;
  return false;
}

void LibraryMaker::probe(std::size_t query) {
  World world(*this, queries_[posed_of_[query]]);
  const Query wanted = query_of(query, world, true);
  for (std::size_t path = 0; path < library_.paths.size(); ++path)
    for (std::size_t mode = 0; mode < library_.modes.size(); ++mode)
      if (!guide_->answers(path, query) && works(world.is_free, wanted, {path, mode, -1}))
        ++worked_[mode];
}

/// Keeps the modes that did best.
void LibraryMaker::begin_tries() {
  phase_ = Phase::Try;
  const std::size_t best = std::ranges::max(worked_);
  std::vector<std::size_t> order(worked_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{},
                           [this](std::size_t mode) { return worked_[mode]; });
  std::vector<WarpMode> kept;
  for (const std::size_t mode : order)
    if (kept.size() < kMostModes &&
        static_cast<double>(worked_[mode]) >= kWorthKeeping * static_cast<double>(best))
      kept.push_back(library_.modes[mode]);
  library_.modes = std::move(kept);
  library_.solves = library_.reaches = no_bits(library_);
  guide_.emplace(chain_, library_);
}

/// Fills the rows of one query: with the paths near enough to be tried on queries like it.
void LibraryMaker::try_all(std::size_t query) {
  World world(*this, queries_[posed_of_[query]]);
  const auto fill = [&](RecallGuide::Metric metric, std::vector<std::uint8_t>& bits) {
    const bool is_pose = metric == RecallGuide::Metric::Poses;
    const Query wanted = query_of(query, world, is_pose);
    for (const std::size_t path : guide_->nearest_paths(metric, query, kTriedPaths))
      for (std::size_t mode = 0; mode < library_.modes.size(); ++mode)
        if (works(world.is_free, wanted, {path, mode, is_pose ? -1 : 0}))
          set_bit(bits, library_.bit(query, path, mode));
  };
  fill(RecallGuide::Metric::Configurations, library_.solves);
  fill(RecallGuide::Metric::Poses, library_.reaches);
}

/// Queries that a path solves in any mode.
std::vector<bool> LibraryMaker::solved_by(std::size_t path) const {
  std::vector<bool> solved(library_.queries.size());
  for (std::size_t query = 0; query < solved.size(); ++query)
    for (std::size_t mode = 0; mode < library_.modes.size(); ++mode) {
      const std::size_t bit = library_.bit(query, path, mode);
      solved[query] =
          solved[query] || bit_of(library_.solves, bit) || bit_of(library_.reaches, bit);
    }
  return solved;
}

/// The order of paths: each next one solves most of what those before solve least.
std::vector<std::size_t> LibraryMaker::best_first() const {
  constexpr std::size_t kFewReports = 3;  // too few to tell what a path is worth
  std::set<Uuid> reports;
  for (const RecallQuery& query : library_.queries)
    reports.insert(query.report);
  std::vector<std::vector<bool>> solved;
  for (std::size_t path = 0; path < library_.paths.size(); ++path)
    solved.push_back(solved_by(path));
  std::vector<double> worth(library_.queries.size(), 1);
  std::vector<bool> is_taken(library_.paths.size());
  std::vector<std::size_t> order;
  while (order.size() < std::min(max_paths_, library_.paths.size())) {
    double most = reports.size() < kFewReports ? -1 : 0;
    std::optional<std::size_t> best;
    for (std::size_t path = 0; path < solved.size(); ++path) {
      double gain = 0;
      for (std::size_t query = 0; query < worth.size(); ++query)
        gain += solved[path][query] ? worth[query] : 0;
      if (!is_taken[path] && gain > most) {
        most = gain;
        best = path;
      }
    }
    if (!best)
      break;
    is_taken[*best] = true;
    order.push_back(*best);
    constexpr double kSolvedAgain = 0.5;
    for (std::size_t query = 0; query < worth.size(); ++query)
      worth[query] *= solved[*best][query] ? kSolvedAgain : 1;
  }
  return order;
}

void LibraryMaker::finish() {
  phase_ = Phase::Done;
  const std::vector<std::size_t> order = best_first();
  RecallLibrary kept = library_;
  kept.paths.clear();
  for (const std::size_t path : order)
    kept.paths.push_back(library_.paths[path]);
  kept.solves = kept.reaches = no_bits(kept);
  for (std::size_t query = 0; query < kept.queries.size(); ++query)
    for (std::size_t path = 0; path < order.size(); ++path)
      for (std::size_t mode = 0; mode < kept.modes.size(); ++mode) {
        const std::size_t from = library_.bit(query, order[path], mode);
        const std::size_t to = kept.bit(query, path, mode);
        if (bit_of(library_.solves, from))
          set_bit(kept.solves, to);
        if (bit_of(library_.reaches, from))
          set_bit(kept.reaches, to);
      }
  if (planned_ > 0)
    kept.search_checks =
        std::min(uniform_checks_, 2 * retreat_checks_) / static_cast<double>(planned_);
  kept.try_checks = kUsualTryChecks;
  if (failed_ > 0 && planned_s_ > 0)
    kept.try_checks = failed_s_ / static_cast<double>(failed_) * uniform_checks_ / planned_s_;
  kept.revision = revision_of(kept);
  library_ = std::move(kept);
}

std::optional<RecallLibrary> LibraryMaker::take() {
  if (phase_ != Phase::Done || library_.paths.empty())
    return std::nullopt;
  return std::move(library_);
}

}  // namespace kinship::recall
