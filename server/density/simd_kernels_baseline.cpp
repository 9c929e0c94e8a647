// For every machine: two numbers at a time, which on x86-64 is SSE2.

#include "server/density/simd_kernels.hpp"

namespace {
constexpr int kLanes = 2;
}

#include "server/density/simd_kernels_body.hpp"

namespace kinship::density {
extern const SimdKernels kBaselineSimdKernels;
constinit const SimdKernels kBaselineSimdKernels = kernels("baseline");
}  // namespace kinship::density
