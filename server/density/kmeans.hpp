#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

namespace kinship::density {

/// Chooses start centres among points, each with probability proportional to its weight times its
/// squared distance to the nearest centre so far; the best of 2 + ln(count) tries each time.
/// \param points   d x n, joint units.
/// \param weights  n, positive.
/// \param count    at least 1.
/// \return         d x at most `count`: fewer if there are fewer distinct points.
/// Source: Arthur and Vassilvitskii, k-means++: the advantages of careful seeding (2007).
Eigen::MatrixXd choose_centres(const Eigen::Ref<const Eigen::MatrixXd>& points,
                               const Eigen::Ref<const Eigen::VectorXd>& weights, Eigen::Index count,
                               std::mt19937_64& generator);

/// For each point the index of the nearest centre, the lowest of equally near ones.
std::vector<Eigen::Index> nearest_centres(const Eigen::Ref<const Eigen::MatrixXd>& points,
                                          const Eigen::Ref<const Eigen::MatrixXd>& centres);

/// Lloyd's iterations: each centre moves to the weighted mean of the points nearest to it, until
/// no point changes sides or `max_iterations` are done. A centre without points stays.
Eigen::MatrixXd move_centres(const Eigen::Ref<const Eigen::MatrixXd>& points,
                             const Eigen::Ref<const Eigen::VectorXd>& weights,
                             Eigen::MatrixXd centres, int max_iterations);

}  // namespace kinship::density
