#include "robots/recall/recall.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "robots/planning/path_vertices.hpp"

namespace kinship::recall {
namespace {

/// Checks whole paths of one query.
class WholePaths {
 public:
  WholePaths(const planning::IsFree& is_free, double step) : is_free_(is_free), step_(step) {}

  /// \param stride  between the configurations that are checked first: a power of two.
  /// \return the path as RecallSummary has it, if it is free.
  std::optional<Eigen::MatrixXd> check(const Eigen::MatrixXd& path, Eigen::Index stride) {
    const bool proves = is_free_.proves_edges();
    Eigen::MatrixXd way = proves ? path : planning::densified(path, step_);
    order_from_coarse(way.cols(), proves ? std::min<Eigen::Index>(stride, kProvenStride) : stride);
    asked_.resize(way.rows(), planning::kTogether);
    for (std::size_t done = 0; done < order_.size();) {
      const std::size_t count =
          std::min(order_.size() - done, static_cast<std::size_t>(planning::kTogether));
      for (std::size_t i = 0; i < count; ++i)
        asked_.col(static_cast<Eigen::Index>(i)) = way.col(order_[done + i]);
      const Eigen::Index free = is_free_.ahead(asked_.leftCols(static_cast<Eigen::Index>(count)));
      const bool are_all = free == static_cast<Eigen::Index>(count);
      checks_ += static_cast<std::uint64_t>(free) + (are_all ? 0 : 1);
      if (!are_all)
        return std::nullopt;
      done += count;
    }
    if (proves && !is_free_.way_is_free(way))
      return std::nullopt;
    return way;
  }

  bool is_free(const Eigen::VectorXd& q) {
    ++checks_;
    return is_free_(q);
  }

  std::uint64_t checks() const { return checks_; }

 private:
  static constexpr Eigen::Index kProvenStride = 4;

  /// The last configuration, then every one but the first.
  void order_from_coarse(Eigen::Index count, Eigen::Index stride) {
    order_.clear();
    order_.push_back(count - 1);
    for (Eigen::Index s = stride; s >= 1; s /= 2)
      for (Eigen::Index i = s; i < count - 1; i += s)
        if (s == stride || i % (2 * s) != 0)
          order_.push_back(i);
  }

  const planning::IsFree& is_free_;
  const double step_;
  std::vector<Eigen::Index> order_;
  Eigen::MatrixXd asked_;
  std::uint64_t checks_ = 0;
};

constexpr Eigen::Index kStride = 8, kLineStride = 16;

}  // namespace

std::optional<Eigen::MatrixXd> whole_if_free(const Eigen::MatrixXd& path,
                                             const planning::IsFree& is_free, double step,
                                             std::uint64_t& checks) {
  WholePaths paths(is_free, step);
  auto whole = paths.check(path, kStride);
  checks += paths.checks();
  return whole;
}

RecallSummary recall(const RecallGuide& guide, const Query& query, const planning::IsFree& is_free,
                     const RecallOptions& options) {
  RecallSummary summary;
  Ranking ranking(guide, query, options.trust);
  WholePaths paths(is_free, options.step);
  const double most =
      std::max(kChecksOfFailedTry, options.most_spent * guide.library().search_checks);
  double missed = 1;  // chance that no try works
  std::optional<Candidate> candidate = ranking.next(options.step);
  if (candidate && paths.is_free(query.start)) {
    bool is_line_tried = false;
    for (; candidate && static_cast<double>(paths.checks()) < most;
         candidate = ranking.next(options.step)) {
      if (const auto warped = guide.warp(query, *candidate)) {
        if (!std::exchange(is_line_tried, true)) {
          Eigen::MatrixXd line(query.start.size(), 2);
          line << query.start, warped->rightCols<1>();
          summary.waypoints = paths.check(line, kLineStride);
          if (summary.waypoints)
            break;
        }
        ++summary.tries;
        missed *= 1 - ranking.chance();
        summary.waypoints = paths.check(*warped, kStride);
        if (summary.waypoints)
          break;
      }
      ranking.fail();
    }
  }
  summary.expected = 1 - missed;
  summary.collision_checks = paths.checks();
  return summary;
}

}  // namespace kinship::recall
