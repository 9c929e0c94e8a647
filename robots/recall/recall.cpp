#include "robots/recall/recall.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "robots/planning/path_vertices.hpp"

namespace kinship::recall {
namespace {

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

/// Whether the lines of a path are free whose ends are: proven, or checked from coarse to fine.
/// \return the path as RecallSummary::waypoints has it; nothing if they are not.
std::optional<Eigen::MatrixXd> lines_if_free(const Eigen::MatrixXd& path,
                                             const planning::IsFree& is_free, double step,
                                             std::uint64_t& checks) {
  constexpr Eigen::Index kStride = 8;
  if (is_free.proves_edges())
    return is_free.way_is_free(path) ? std::optional(path) : std::nullopt;
  Eigen::MatrixXd dense = planning::densified(path, step);
  Asked asked(is_free, checks);
  for (Eigen::Index stride = kStride; stride >= 1; stride /= 2)
    for (Eigen::Index i = stride; i < dense.cols() - 1; i += stride)
      if ((stride == kStride || i % (2 * stride) != 0) && !asked.add(dense.col(i)))
        return std::nullopt;
  return asked.are_free() ? std::optional(std::move(dense)) : std::nullopt;
}

}  // namespace

std::optional<Eigen::MatrixXd> whole_if_free(Warp& warp, const planning::IsFree& is_free,
                                             double step, std::uint64_t& checks) {
  const Eigen::MatrixXd& path = warp.waypoints();
  Asked asked(is_free, checks);
  if (!asked.add(path.rightCols<1>()))
    return std::nullopt;
  constexpr Eigen::Index kCoarse = 4;
  for (Eigen::Index stride = kCoarse; stride >= 1; stride /= 4) {
    warp.compute(stride, stride);
    for (Eigen::Index i = stride; i < path.cols() - 1; i += stride)
      if ((stride == kCoarse || i % kCoarse != 0) && !asked.add(path.col(i)))
        return std::nullopt;
    if (!asked.are_free())
      return std::nullopt;
  }
  return lines_if_free(path, is_free, step, checks);
}

RecallSummary recall(const RecallGuide& guide, const Query& query, const planning::IsFree& is_free,
                     const RecallOptions& options) {
  RecallSummary summary;
  Ranking ranking(guide, query, options.trust);
  const RecallLibrary& library = guide.library();
  const double most = options.most_spent * library.search_checks;
  double missed = 1;  // chance that no try works
  std::uint64_t& checks = summary.collision_checks;
  std::optional<Candidate> candidate = ranking.next(options.step);
  if (candidate) {
    ++checks;
    if (!is_free(query.start))
      return summary;
  }
  for (; candidate && static_cast<double>(checks) < most; candidate = ranking.next(options.step)) {
    if (auto warp = guide.warp(query, *candidate)) {
      if (summary.tries++ == 0) {
        Eigen::MatrixXd line(query.start.size(), 2);
        line << query.start, warp->waypoints().rightCols<1>();
        summary.waypoints = lines_if_free(line, is_free, options.step, checks);
      }
      missed *= 1 - ranking.chance();
      if (!summary.waypoints)
        summary.waypoints = whole_if_free(*warp, is_free, options.step, checks);
      if (summary.waypoints)
        break;
    }
    ranking.fail();
  }
  summary.expected = 1 - missed;
  return summary;
}

}  // namespace kinship::recall
