#include "robots/recall/recall.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "robots/planning/path_vertices.hpp"

namespace kinship::recall {
namespace {

constexpr Eigen::Index kCoarse = 4;  // between waypoints that are checked first
constexpr std::size_t kMostFailed = 3;

/// Asks which configurations are free, many at once, until one is not.
class Asked {
 public:
  Asked(const planning::IsFree& is_free, std::uint64_t& checks)
      : is_free_(is_free), checks_(checks) {}

  /// \return false: one was not free, and nothing more is asked.
  bool add(const Eigen::Ref<const Eigen::VectorXd>& q) {
    if (count_ == 0)
      asked_.resize(q.size(), planning::kTogether);
    asked_.col(count_++) = q;
    return count_ < planning::kTogether || are_free();
  }

  /// Asks about those that were added since.
  bool are_free() {
    if (count_ == 0)
      return true;
    const Eigen::Index free = is_free_.ahead(asked_.leftCols(count_));
    const bool are_all = free == count_;
    checks_ += static_cast<std::uint64_t>(free) + (are_all ? 0 : 1);
    count_ = 0;
    return are_all;
  }

 private:
  const planning::IsFree& is_free_;
  std::uint64_t& checks_;
  Eigen::MatrixXd asked_;
  Eigen::Index count_ = 0;
};

/// Whether the lines of a path are proven free.
bool are_lines_proven(const Eigen::MatrixXd& path, const planning::IsFree& is_free,
                      RecallSummary& summary) {
  for (Eigen::Index at = 0; at + 1 < path.cols(); at += planning::kTogether) {
    const Eigen::Index lines = std::min<Eigen::Index>(planning::kTogether, path.cols() - 1 - at);
    if (!is_free.way_is_free(path.middleCols(at, lines + 1)))
      return false;
  }
  summary.waypoints = path;
  return true;
}

/// Whether the ways along a constraint are free between waypoints that hold it, and are free.
bool are_lines_free(const Eigen::MatrixXd& path, const planning::IsFree& is_free,
                    planning::RegionConstraint& constraint, double step, RecallSummary& summary) {
  auto way = planning::ConstrainedStepper(step, constraint).way_through(path);
  if (!way)
    return false;
  std::vector<bool> is_asked(static_cast<std::size_t>(way->cols()));
  for (Eigen::Index i = 0, line = 0; i < way->cols() && line < path.cols(); ++i)
    if (way->col(i) == path.col(line)) {
      is_asked[static_cast<std::size_t>(i)] = true;
      ++line;
    }
  Asked asked(is_free, summary.collision_checks);
  planning::MiddlesFirst middles(way->cols() - 1);
  for (Eigen::Index next = middles.next(); next != 0; next = middles.next())
    if (!is_asked[static_cast<std::size_t>(next)] && !asked.add(way->col(next)))
      return false;
  if (!asked.are_free() || (is_free.proves_edges() && !are_lines_proven(*way, is_free, summary)))
    return false;
  summary.waypoints = *std::move(way);
  return true;
}

/// Whether the lines of a path are free whose ends are: proven, or checked from coarse to fine.
bool are_lines_free(const Eigen::MatrixXd& path, const planning::IsFree& is_free, double step,
                    RecallSummary& summary) {
  constexpr std::size_t kStride = 8;
  if (is_free.proves_edges())
    return are_lines_proven(path, is_free, summary);
  Eigen::MatrixXd dense = planning::densified(path, step);
  std::vector<Eigen::Index> between;  // of the ends of lines
  for (Eigen::Index line = 0, at = 0; line + 1 < path.cols(); ++line) {
    const Eigen::Index parts =
        planning::count_of_parts((path.col(line + 1) - path.col(line)).norm(), step);
    for (Eigen::Index part = 1; part < parts; ++part)
      between.push_back(at + part);
    at += parts;
  }
  Asked asked(is_free, summary.collision_checks);
  for (std::size_t stride = kStride; stride >= 1; stride /= 2)
    for (std::size_t i = stride - 1; i < between.size(); i += stride)
      if ((stride == kStride || (i + 1) % (2 * stride) != 0) && !asked.add(dense.col(between[i])))
        return false;
  if (!asked.are_free())
    return false;
  summary.waypoints = std::move(dense);
  return true;
}

}  // namespace

bool is_goal_free(const Warp& warp, const planning::IsFree& is_free, RecallSummary& summary) {
  const Eigen::VectorXd goal = warp.waypoints().rightCols<1>();
  if (!goal.allFinite() || (warp.constraint() != nullptr && !warp.constraint()->holds(goal)))
    return false;
  ++summary.collision_checks;
  return is_free(goal);
}

bool is_way_free(Warp& warp, const planning::IsFree& is_free, double step, RecallSummary& summary) {
  const Eigen::MatrixXd& path = warp.waypoints();
  Asked asked(is_free, summary.collision_checks);
  for (Eigen::Index stride = kCoarse; stride >= 1; stride /= kCoarse) {
    warp.compute(stride, stride == kCoarse ? kRecallWaypoints : kCoarse);
    for (Eigen::Index i = stride; i < path.cols() - 1; i += stride)
      if ((stride == kCoarse || i % kCoarse != 0) &&
          !(path.col(i).allFinite() && asked.add(path.col(i))))
        return false;
    if (!asked.are_free())
      return false;
  }
  return warp.constraint() != nullptr
             ? are_lines_free(path, is_free, *warp.constraint(), step, summary)
             : are_lines_free(path, is_free, step, summary);
}

std::vector<Eigen::MatrixXd> whole(std::vector<Warp>& failed) {
  std::vector<Eigen::MatrixXd> paths;
  for (Warp& warp : failed) {
    warp.compute(1, kCoarse);
    paths.push_back(warp.waypoints());
  }
  return paths;
}

RecallSummary recall(const RecallGuide& guide, const Query& query, const planning::IsFree& is_free,
                     const RecallOptions& options) {
  RecallSummary summary;
  Ranking ranking(guide, query, options.trust);
  const RecallLibrary& library = guide.library();
  const double most = options.trust * options.most_spent * library.search_checks;
  const double try_checks = std::max(library.try_checks, 1.0);
  double missed = 1;  // chance that no try works
  std::optional<Candidate> candidate = ranking.next(options.step);
  if (candidate) {
    ++summary.collision_checks;
    if ((query.constraint != nullptr && !query.constraint->holds(query.start)) ||
        !is_free(query.start))
      return summary;
  }
  bool is_line_tried = false;
  for (; candidate && static_cast<double>(summary.tries) * try_checks <= most &&
         summary.collision_checks < options.max_checks;
       candidate = ranking.next(options.step)) {
    ++summary.tries;
    auto warp = guide.warp(query, *candidate);
    if (!warp || !is_goal_free(*warp, is_free, summary)) {
      missed *= 1 - ranking.chance();
      ranking.fail_at_goal();
      continue;
    }
    if (query.constraint == nullptr && !std::exchange(is_line_tried, true)) {
      Eigen::MatrixXd line(query.start.size(), 2);
      line << query.start, warp->waypoints().rightCols<1>();
      summary.is_straight_line = are_lines_free(line, is_free, options.step, summary);
      if (summary.is_straight_line)
        break;
    }
    missed *= 1 - ranking.chance();
    if (is_way_free(*warp, is_free, options.step, summary))
      break;
    ranking.fail();
    summary.failed.reserve(kMostFailed);
    if (summary.failed.size() < kMostFailed)
      summary.failed.push_back(*std::move(warp));
  }
  summary.expected = 1 - missed;
  return summary;
}

}  // namespace kinship::recall
