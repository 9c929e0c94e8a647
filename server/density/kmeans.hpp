#pragma once

#include <Eigen/Core>
#include <random>
#include <stop_token>
#include <vector>

#include "server/density/block_points.hpp"
#include "server/density/expectation_maximisation.hpp"

namespace kinship::density {

// Each of the first three throws Stopped if `stop` says so.

/// Chooses start centres among points, each with probability proportional to its weight times its
/// squared distance to the nearest centre so far; the best of 2 + ln(count) tries each time.
/// \param count  at least 1.
/// \return       d x at most `count`, relative to the points' offset: fewer if there are fewer
///               distinct points.
/// Source: Arthur and Vassilvitskii, k-means++: the advantages of careful seeding (2007).
Eigen::MatrixXd choose_centres(const BlockPoints& points, Eigen::Index count,
                               const SimdKernels& kernels, std::mt19937_64& generator,
                               const std::stop_token& stop = {});

/// For each point, in block order, the index of the nearest centre, the lowest of equally near
/// ones.
/// \param centres  d x K, relative to the points' offset.
std::vector<int> nearest_centres(const BlockPoints& points,
                                 const Eigen::Ref<const Eigen::MatrixXd>& centres,
                                 const SimdKernels& kernels, const std::stop_token& stop = {});

/// Lloyd's iterations: each centre moves to the weighted mean of the points nearest to it, until
/// no point changes sides or `max_iterations` are done. A centre without points stays.
Eigen::MatrixXd move_centres(const BlockPoints& points, Eigen::MatrixXd centres, int max_iterations,
                             const SimdKernels& kernels, const std::stop_token& stop = {});

/// The moments if each point belongs to one component entirely.
/// \param component_of_point  one index below `components` per point, in block order.
Moments moments_of_clusters(const BlockPoints& points, const std::vector<int>& component_of_point,
                            Eigen::Index components);

}  // namespace kinship::density
