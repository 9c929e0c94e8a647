// Compiled with AVX-512 instructions: see CMakeLists.txt and simd_kernels_body.hpp for the
// restrictions.

#if defined(__x86_64__)

#include "server/density/simd_kernels.hpp"

namespace {
constexpr int kLanes = 8;
}

#include "server/density/simd_kernels_body.hpp"

namespace kinship::density {
extern const SimdKernels kAvx512SimdKernels;
constinit const SimdKernels kAvx512SimdKernels = kernels("avx512");
}  // namespace kinship::density

#endif
