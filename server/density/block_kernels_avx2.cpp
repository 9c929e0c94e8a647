// Compiled with AVX2 and FMA instructions: see CMakeLists.txt and block_kernels_body.hpp for what
// that forbids.

#if defined(__x86_64__)

#include "server/density/block_kernels.hpp"

namespace {
constexpr int kLanes = 4;
}

#include "server/density/block_kernels_body.hpp"

namespace kinship::density {
extern const BlockKernels kAvx2Kernels;
constinit const BlockKernels kAvx2Kernels = kernels("avx2");
}  // namespace kinship::density

#endif
