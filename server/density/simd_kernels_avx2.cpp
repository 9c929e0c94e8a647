// Compiled with AVX2 and FMA instructions: see CMakeLists.txt and simd_kernels_body.hpp for the
// restrictions.

#if defined(__x86_64__)

#include "server/density/simd_kernels.hpp"

namespace {
constexpr int kLanes = 4;
}

#include "server/density/simd_kernels_body.hpp"

namespace kinship::density {
extern const SimdKernels kAvx2SimdKernels;
constinit const SimdKernels kAvx2SimdKernels = kernels("avx2");
}  // namespace kinship::density

#endif
