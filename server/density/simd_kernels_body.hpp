// The kernels, in vectors of kLanes numbers. Included once by each source that is compiled for one
// instruction set and has defined kLanes; nothing here may have external linkage, nor call a
// function that has: it would be shared with code for machines without the instructions.

#include <utility>

namespace kinship::density {
namespace {

using Vector __attribute__((vector_size(8 * kLanes))) = double;
using Whole __attribute__((vector_size(8 * kLanes))) = long long;

constexpr int kVectors = kBlockPoints / kLanes;
constexpr int kFixedDimensions = 8;  // up to here there is code for each dimension

inline Vector load(const double* from) {
  Vector value;
  __builtin_memcpy(&value, from, sizeof value);
  return value;
}

inline void store(double* to, Vector value) { __builtin_memcpy(to, &value, sizeof value); }

inline Vector spread(double value) { return value - Vector{}; }

inline Vector greater(Vector a, Vector b) { return a > b ? a : b; }

inline Vector lesser(Vector a, Vector b) { return a < b ? a : b; }

inline Vector magnitude(Vector a) { return a < 0 ? -a : a; }

/// Source lane of a lane of the vector that two become: of groups of `kStep` lanes each in turn,
/// the first or the second ones.
template <int kStep, bool kSecond>
constexpr int source_of(int lane) {
  const int within = lane % (2 * kStep), group = lane - within;
  return within < kStep ? group + within + (kSecond ? kStep : 0)
                        : kLanes + group + within - (kSecond ? 0 : kStep);
}

template <int kStep, bool kSecond, int... kLane>
inline Vector taken(Vector a, Vector b, std::integer_sequence<int, kLane...>) {
  return __builtin_shufflevector(a, b, source_of<kStep, kSecond>(kLane)...);
}

/// The sums of kCount vectors in a row, each in a lane of its own if they are kLanes; of fewer, in
/// parts, which are repeated.
template <int kCount>
inline Vector sums_of(const Vector* vectors) {
  if constexpr (kCount == 1) {
    return vectors[0];
  } else {
    constexpr int kStep = kCount / 2;
    const Vector a = sums_of<kStep>(vectors), b = sums_of<kStep>(vectors + kStep);
    constexpr auto kAll = std::make_integer_sequence<int, kLanes>();
    return taken<kStep, false>(a, b, kAll) + taken<kStep, true>(a, b, kAll);
  }
}

/// Reduces a vector to one number: combines each lane with the one `kStep` further, then with half
/// the step, down to 1.
template <int kStep = kLanes / 2, typename Choose>
inline double folded(Vector value, const Choose& choose) {
  if constexpr (kStep == 0) {
    return value[0];
  } else {
    constexpr auto kAll = std::make_integer_sequence<int, kLanes>();
    return folded<kStep / 2>(choose(value, taken<kStep, true>(value, value, kAll)), choose);
  }
}

inline double sum_of(Vector value) {
  return folded(value, [](Vector a, Vector b) { return a + b; });
}

inline double greatest_of(Vector value) { return folded(value, greater); }

/// exp of numbers that are not positive, to 2e-16 relative: powers of two times the Taylor series
/// on [-ln 2 / 2, ln 2 / 2]. Below -300 it is exp(-300): nothing beside 1, but no subnormal number,
/// with which the products that follow are 30 times slower on some processors.
inline Vector exponential(Vector x) {
  x = greater(x, spread(-300));
  constexpr double kRounder = 6755399441055744.0;  // 1.5 * 2^52: the sum's low bits are the integer
  const Vector shifted = x * 1.4426950408889634 + kRounder;
  const Vector power = shifted - kRounder;
  const Vector r = x - power * 6.93147180369123816490e-01 - power * 1.90821492927058770002e-10;
  constexpr double kSeries[] = {
      1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040, 1.0 / 720,
      1.0 / 120,      1.0 / 24,      1.0 / 6,      0.5,         1,          1};
  Vector value = r * (1.0 / 479001600) + kSeries[0];
#pragma GCC unroll 11
  for (int i = 1; i < 12; ++i)
    value = value * r + kSeries[i];
  return reinterpret_cast<Vector>(reinterpret_cast<Whole>(value) +
                                  (reinterpret_cast<Whole>(shifted) << 52));
}

/// ln of numbers from 1 to 2^50, to 2e-16 of the greater of it and 1: exponent times ln 2 plus
/// 2 artanh((m - 1) / (m + 1)) with m in [1/sqrt 2, sqrt 2].
inline Vector logarithm(Vector x) {
  const Whole bits = reinterpret_cast<Whole>(x);
  const Whole half = bits + ((1023LL << 52) - 0x3FE6A09E667F3BCDLL);  // m >= sqrt 2 carries
  const Whole exponent = (half >> 52) - 1023;
  const Vector m = reinterpret_cast<Vector>(bits - (exponent << 52));
  const Vector s = (m - 1) / (m + 1);
  const Vector t = s * s;
  Vector series = t * (1.0 / 21) + 1.0 / 19;
#pragma GCC unroll 9
  for (int i = 17; i >= 1; i -= 2)
    series = series * t + 1.0 / i;
  return 2 * s * series + __builtin_convertvector(exponent, Vector) * 0.6931471805599453;
}

void bounds(int dimension, const double* components, int stride, const double* centre,
            const double* half_widths, double* out) {
  for (int k = 0; k < stride; k += kLanes) {
    const double* entry = components + k;
    const Vector scale = load(entry);
    Vector least{}, most{}, middle{};
    for (int i = 0; i < dimension; ++i) {
      entry += stride;
      Vector y = -load(entry);
      Vector reach{};
      for (int j = 0; j <= i; ++j) {
        entry += stride;
        const Vector whitening = load(entry);
        y += whitening * centre[j];
        reach += magnitude(whitening) * half_widths[j];
      }
      middle += y * y;
      y = magnitude(y);
      const Vector near = greater(y - reach, Vector{});
      least += near * near;
      most += (y + reach) * (y + reach);
    }
    store(out + k, scale - least);
    store(out + stride + k, scale - most);
    store(out + 2 * stride + k, scale - middle);
  }
}

/// The results of log_terms besides the terms.
struct Largest {
  double* largest;
  Vector excess = spread(-1.7e308);
  Vector least = spread(1.7e308);

  void add(int point, Vector term) {
    const Vector before = load(largest + point);
    excess = greater(excess, term - before);
    const Vector after = greater(before, term);
    least = lesser(least, after);
    store(largest + point, after);
  }
  double finish(double* least_largest) const {
    *least_largest = -greatest_of(-least);
    return greatest_of(excess);
  }
};

template <int kDimension>
double log_terms_fixed(const double* points, const double* component, double* terms,
                       double* largest, double* least_largest) {
  constexpr int kStreams = kLanes == 8 ? 2 : 1;  // as many as there are registers for
  Largest extremes{largest};
  for (int v = 0; v < kVectors; v += kStreams) {
    Vector x[kStreams][kFixedDimensions];
#pragma GCC unroll 8
    for (int i = 0; i < kDimension; ++i)
#pragma GCC unroll 2
      for (int s = 0; s < kStreams; ++s)
        x[s][i] = load(points + i * kBlockPoints + (v + s) * kLanes);
    Vector term[kStreams];
#pragma GCC unroll 2
    for (int s = 0; s < kStreams; ++s)
      term[s] = spread(component[0]);
    const double* entry = component + 1;
#pragma GCC unroll 8
    for (int i = 0; i < kDimension; ++i) {
      Vector y[kStreams];
#pragma GCC unroll 2
      for (int s = 0; s < kStreams; ++s)
        y[s] = x[s][0] * entry[1] - entry[0];
#pragma GCC unroll 8
      for (int j = 1; j <= i; ++j)
#pragma GCC unroll 2
        for (int s = 0; s < kStreams; ++s)
          y[s] += x[s][j] * entry[1 + j];
#pragma GCC unroll 2
      for (int s = 0; s < kStreams; ++s)
        term[s] -= y[s] * y[s];
      entry += i + 2;
    }
#pragma GCC unroll 2
    for (int s = 0; s < kStreams; ++s) {
      store(terms + (v + s) * kLanes, term[s]);
      extremes.add((v + s) * kLanes, term[s]);
    }
  }
  return extremes.finish(least_largest);
}

double log_terms_any(int dimension, const double* points, const double* component, double* terms,
                     double* largest, double* least_largest) {
  constexpr int kStreams = 4;
  Largest extremes{largest};
  for (int point = 0; point < kBlockPoints; point += kStreams * kLanes) {
    Vector term[kStreams];
    for (Vector& value : term)
      value = spread(component[0]);
    const double* entry = component + 1;
    for (int i = 0; i < dimension; ++i) {
      Vector y[kStreams];
      for (Vector& value : y)
        value = spread(-entry[0]);
      for (int j = 0; j <= i; ++j)
#pragma GCC unroll 4
        for (int s = 0; s < kStreams; ++s)
          y[s] += load(points + j * kBlockPoints + point + s * kLanes) * entry[1 + j];
#pragma GCC unroll 4
      for (int s = 0; s < kStreams; ++s)
        term[s] -= y[s] * y[s];
      entry += i + 2;
    }
    for (int s = 0; s < kStreams; ++s) {
      store(terms + point + s * kLanes, term[s]);
      extremes.add(point + s * kLanes, term[s]);
    }
  }
  return extremes.finish(least_largest);
}

double log_terms(int dimension, const double* points, const double* component, double* terms,
                 double* largest, double* least_largest) {
  switch (dimension) {
    case 2:
      return log_terms_fixed<2>(points, component, terms, largest, least_largest);
    case 3:
      return log_terms_fixed<3>(points, component, terms, largest, least_largest);
    case 4:
      return log_terms_fixed<4>(points, component, terms, largest, least_largest);
    case 5:
      return log_terms_fixed<5>(points, component, terms, largest, least_largest);
    case 6:
      return log_terms_fixed<6>(points, component, terms, largest, least_largest);
    case 7:
      return log_terms_fixed<7>(points, component, terms, largest, least_largest);
    case 8:
      return log_terms_fixed<8>(points, component, terms, largest, least_largest);
    default:
      return log_terms_any(dimension, points, component, terms, largest, least_largest);
  }
}

void responsibilities(int count, double* terms, const double* largest, double* peaks,
                      double* log_densities) {
  double factors[kBlockPoints];
  for (int point = 0; point < kBlockPoints; point += kLanes) {
    const Vector top = load(largest + point);
    Vector sum{};
    for (int k = 0; k < count; ++k) {
      const Vector value = exponential(load(terms + k * kBlockPoints + point) - top);
      store(terms + k * kBlockPoints + point, value);
      sum += value;
    }
    store(factors + point, 1 / sum);
    store(log_densities + point, top + logarithm(sum));
  }
  for (int k = 0; k < count; ++k) {
    Vector peak{};
    for (int point = 0; point < kBlockPoints; point += kLanes) {
      const Vector value = load(terms + k * kBlockPoints + point) * load(factors + point);
      store(terms + k * kBlockPoints + point, value);
      peak = greater(peak, value);
    }
    peaks[k] = greatest_of(peak);
  }
}

/// The rows kBegin to kEnd - 1 of the moments: row 0 is that of the feature 1, row i that of
/// joint i - 1.
template <int kDimension, int kBegin, int kEnd>
void add_moment_rows(const double* points, const double* responsibilities, const double* weights,
                     double* sums) {
  constexpr int kFirst = kBegin * (kDimension + 1) - kBegin * (kBegin - 1) / 2;
  constexpr int kCount = kEnd * (kDimension + 1) - kEnd * (kEnd - 1) / 2 - kFirst;
  constexpr int kPadded = (kCount + kLanes - 1) / kLanes * kLanes;
  Vector sum[static_cast<unsigned>(kPadded)]{};
  for (int point = 0; point < kBlockPoints; point += kLanes) {
    const Vector mass = load(responsibilities + point) * load(weights + point);
    int entry = 0;
#pragma GCC unroll 9
    for (int row = kBegin; row < kEnd; ++row) {
      const Vector factor =
          row == 0 ? mass : mass * load(points + (row - 1) * kBlockPoints + point);
      if (row == 0)
        sum[entry++] += mass;
#pragma GCC unroll 9
      for (int column = row == 0 ? 1 : row; column <= kDimension; ++column)
        sum[entry++] += factor * load(points + (column - 1) * kBlockPoints + point);
    }
  }
  constexpr int kWhole = kCount / kLanes * kLanes;
#pragma GCC unroll 8
  for (int entry = 0; entry < kWhole; entry += kLanes)
    store(sums + kFirst + entry, load(sums + kFirst + entry) + sums_of<kLanes>(sum + entry));
  if constexpr (kWhole < kCount) {
    const Vector rest = sums_of<kLanes>(sum + kWhole);
#pragma GCC unroll 8
    for (int entry = kWhole; entry < kCount; ++entry)
      sums[kFirst + entry] += rest[entry - kWhole];
  }
}

/// End of a group of rows that begins at `begin`, such that its sums fit the registers.
constexpr int end_of_rows(int dimension, int begin) {
  const int registers = kLanes == 8 ? 26 : 12;
  int count = 0, end = begin;
  while (end <= dimension && (end == begin || count + dimension + 1 - end <= registers))
    count += dimension + 1 - end++;
  return end;
}

template <int kDimension, int kBegin = 0>
void add_moments_fixed(const double* points, const double* responsibilities, const double* weights,
                       double* sums) {
  constexpr int kEnd = end_of_rows(kDimension, kBegin);
  add_moment_rows<kDimension, kBegin, kEnd>(points, responsibilities, weights, sums);
  if constexpr (kEnd <= kDimension)
    add_moments_fixed<kDimension, kEnd>(points, responsibilities, weights, sums);
}

/// The sums of `factors` times each of `count` rows.
inline void add_products(int count, const double* factors, const double* rows, double* sums) {
  constexpr int kRows = 4;
  int row = 0;
  for (; row + kRows <= count; row += kRows) {
    Vector sum[kRows]{};
    for (int point = 0; point < kBlockPoints; point += kLanes)
#pragma GCC unroll 4
      for (int i = 0; i < kRows; ++i)
        sum[i] += load(factors + point) * load(rows + (row + i) * kBlockPoints + point);
    for (int i = 0; i < kRows; ++i)
      sums[row + i] += sum_of(sum[i]);
  }
  for (; row < count; ++row) {
    Vector sum{};
    for (int point = 0; point < kBlockPoints; point += kLanes)
      sum += load(factors + point) * load(rows + row * kBlockPoints + point);
    sums[row] += sum_of(sum);
  }
}

void add_moments_any(int dimension, const double* points, const double* responsibilities,
                     const double* weights, double* sums) {
  double masses[kBlockPoints];
  double factors[kBlockPoints];
  Vector total{};
  for (int point = 0; point < kBlockPoints; point += kLanes) {
    const Vector mass = load(responsibilities + point) * load(weights + point);
    store(masses + point, mass);
    total += mass;
  }
  *sums++ += sum_of(total);
  add_products(dimension, masses, points, sums);
  sums += dimension;
  for (int i = 0; i < dimension; ++i) {
    const double* row = points + i * kBlockPoints;
    for (int point = 0; point < kBlockPoints; point += kLanes)
      store(factors + point, load(masses + point) * load(row + point));
    add_products(dimension - i, factors, row, sums);
    sums += dimension - i;
  }
}

void add_moments(int dimension, const double* points, const double* responsibilities,
                 const double* weights, double* sums) {
  switch (dimension) {
    case 2:
      return add_moments_fixed<2>(points, responsibilities, weights, sums);
    case 3:
      return add_moments_fixed<3>(points, responsibilities, weights, sums);
    case 4:
      return add_moments_fixed<4>(points, responsibilities, weights, sums);
    case 5:
      return add_moments_fixed<5>(points, responsibilities, weights, sums);
    case 6:
      return add_moments_fixed<6>(points, responsibilities, weights, sums);
    case 7:
      return add_moments_fixed<7>(points, responsibilities, weights, sums);
    case 8:
      return add_moments_fixed<8>(points, responsibilities, weights, sums);
    default:
      return add_moments_any(dimension, points, responsibilities, weights, sums);
  }
}

double nearer(int dimension, const double* points, const double* weights, const double* centre,
              const double* before, double* after) {
  Vector sum{};
  for (int point = 0; point < kBlockPoints; point += kLanes) {
    Vector squared{};
    for (int i = 0; i < dimension; ++i) {
      const Vector difference = load(points + i * kBlockPoints + point) - centre[i];
      squared += difference * difference;
    }
    squared = lesser(squared, load(before + point));
    store(after + point, squared);
    sum += load(weights + point) * squared;
  }
  return sum_of(sum);
}

void nearest(int dimension, const double* points, int count, const double* centres,
             double* chosen) {
  for (int point = 0; point < kBlockPoints; point += kLanes) {
    Vector least = spread(1.7e308), choice{};
    for (int k = 0; k < count; ++k) {
      Vector squared{};
      for (int i = 0; i < dimension; ++i) {
        const Vector difference =
            load(points + i * kBlockPoints + point) - centres[k * dimension + i];
        squared += difference * difference;
      }
      choice = squared < least ? spread(k) : choice;
      least = lesser(squared, least);
    }
    store(chosen + point, choice);
  }
}

constexpr SimdKernels kernels(const char* name) {
  return {name, bounds, log_terms, responsibilities, add_moments, nearer, nearest};
}

}  // namespace
}  // namespace kinship::density
