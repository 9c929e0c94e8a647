#pragma once

namespace kinship::density {

/// Points per block: they fit the nearest cache with the terms of some components.
inline constexpr int kBlockPoints = 128;

/// Numbers in the packed form of a component, of its moments or of a symmetric matrix with a row
/// more: 1, d and d (d + 1) / 2 of them.
constexpr int packed_size(int dimension) { return (dimension + 1) * (dimension + 2) / 2; }

/// The inner loops of fits, compiled once per instruction set. Plain numbers only: sources that
/// include this header are compiled for instructions that not every machine has.
///
/// A block is d rows of kBlockPoints numbers: row i holds joint i of its points. A *packed*
/// component is its log scale c, then for each row i of its whitening W the offset b_i and
/// W_i0 ... W_ii; its log density at x, with its weight, is c - |W x - b|^2.
struct SimdKernels {
  const char* name;

  /// Upper and lower bounds of that log density over boxes, and its value at their centre, for
  /// several components at once.
  /// \param components   packed, number by number: entry e of component k at e * stride + k.
  /// \param stride       number of components, rounded up to a multiple of 8.
  /// \param centre, half_widths  d each.
  /// \param bounds       out: 3 x stride, upper, lower, centre.
  void (*bounds)(int dimension, const double* components, int stride, const double* centre,
                 const double* half_widths, double* bounds);

  /// The log densities of one packed component at the points of a block.
  /// \param terms    out: kBlockPoints.
  /// \param largest  in and out: kBlockPoints, the largest term of each point so far.
  /// \param least_largest  out: the least of `largest` afterwards.
  /// \return         largest amount by which a term exceeds (or, negative, stays below) the
  ///                 previous largest one of its point.
  double (*log_terms)(int dimension, const double* points, const double* component, double* terms,
                      double* largest, double* least_largest);

  /// Turns the terms of `count` components into responsibilities.
  /// \param terms    in and out: count x kBlockPoints, row by row.
  /// \param largest  kBlockPoints, of those terms.
  /// \param peaks    out: count, the greatest responsibility of each component.
  /// \param log_densities  out: kBlockPoints, logarithm of the sum of the exponentials.
  void (*responsibilities)(int count, double* terms, const double* largest, double* peaks,
                           double* log_densities);

  /// Adds the sums over a block of m, m x_i and m x_i x_j (i <= j, row by row), where m is
  /// responsibility times weight.
  /// \param sums  in and out: packed_size(d).
  void (*add_moments)(int dimension, const double* points, const double* responsibilities,
                      const double* weights, double* sums);

  /// Squared distances to the nearest centre after `centre` is added.
  /// \param before   kBlockPoints; `after`: the same with the centre, may be `before`.
  /// \return         their sum, weighted.
  double (*nearer)(int dimension, const double* points, const double* weights, const double* centre,
                   const double* before, double* after);

  /// Index of the nearest of `count` centres for each point, the first of equally near ones.
  /// \param centres  count x d, centre by centre.
  /// \param chosen   out: kBlockPoints numbers below count.
  void (*nearest)(int dimension, const double* points, int count, const double* centres,
                  double* chosen);
};

}  // namespace kinship::density
