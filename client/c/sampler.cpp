#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "client/c/errors.hpp"
#include "client/c/handles.hpp"

namespace kinship::c_library {
namespace {

/// The room that a caller wants filled.
struct Room {
  size_t count, stride;
  kinship_layout layout;
};

/// \throws Failure(InvalidInput) if the layout is none or the stride too short.
void check(const Room& room, size_t dof) {
  constexpr size_t kMaxCount = size_t{1} << 28U;  // the samples are held once more in between
  if (room.layout != KINSHIP_ROWS && room.layout != KINSHIP_ARRAYS)
    throw Failure(invalid_input("layout is " + std::to_string(room.layout) + ", must be 0 or 1"));
  const size_t least = room.layout == KINSHIP_ROWS ? dof : room.count;
  if (room.stride < least)
    throw Failure(invalid_input("stride is " + std::to_string(room.stride) + ", must be at least " +
                                std::to_string(least)));
  if (room.count > kMaxCount)
    throw Failure(invalid_input("count is " + std::to_string(room.count) + ", must be at most " +
                                std::to_string(kMaxCount)));
}

/// The number in the caller's precision, the next one inside if rounding left the limits.
template <typename Number>
Number rounded(double q, double lower, double upper) {
  const Number number = static_cast<Number>(q);
  if (static_cast<double>(number) > upper)
    return std::nextafter(number, -std::numeric_limits<Number>::infinity());
  if (static_cast<double>(number) < lower)
    return std::nextafter(number, std::numeric_limits<Number>::infinity());
  return number;
}

template <typename Number>
kinship_code fill(const kinship_sampler* sampler, Number* out, const Room& room, uint64_t seed) {
  return guarded([&] {
    require(sampler, "sampler");
    if (room.count == 0)
      return KINSHIP_OK;
    require(out, "out");
    const auto dof = static_cast<size_t>(sampler->value.dimension());
    check(room, dof);
    std::mt19937_64 generator(seed);
    const Eigen::MatrixXd drawn =
        sampler->value.sample(generator, static_cast<Eigen::Index>(room.count));
    if (drawn.cols() < static_cast<Eigen::Index>(room.count))
      return remember(KINSHIP_INTERNAL, "the mixture lies outside the limits of the joints");
    for (size_t i = 0; i < room.count; ++i) {
      for (size_t j = 0; j < dof; ++j) {
        const auto joint = static_cast<Eigen::Index>(j);
        const size_t place =
            room.layout == KINSHIP_ROWS ? i * room.stride + j : j * room.stride + i;
        out[place] = rounded<Number>(drawn(joint, static_cast<Eigen::Index>(i)),
                                     sampler->limits(0, joint), sampler->limits(1, joint));
      }
      if (room.layout == KINSHIP_ROWS)
        std::fill_n(out + i * room.stride + dof, room.stride - dof, Number{0});
    }
    return KINSHIP_OK;
  });
}

}  // namespace
}  // namespace kinship::c_library

using namespace kinship::c_library;

kinship_code kinship_sampler_create(const kinship_distribution* distribution,
                                    kinship_sampler** sampler) {
  return guarded([&] {
    require(distribution, "distribution");
    require(sampler, "sampler");
    *sampler = nullptr;
    *sampler = new kinship_sampler(*distribution->value);
    return KINSHIP_OK;
  });
}

void kinship_sampler_free(kinship_sampler* sampler) { delete sampler; }

kinship_code kinship_sampler_fill(const kinship_sampler* sampler, double* out, size_t count,
                                  size_t stride, kinship_layout layout, uint64_t seed) {
  return fill(sampler, out, {count, stride, layout}, seed);
}

kinship_code kinship_sampler_fill_float(const kinship_sampler* sampler, float* out, size_t count,
                                        size_t stride, kinship_layout layout, uint64_t seed) {
  return fill(sampler, out, {count, stride, layout}, seed);
}
