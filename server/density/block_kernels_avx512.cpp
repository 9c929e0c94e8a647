// Compiled with AVX-512 instructions: see CMakeLists.txt and block_kernels_body.hpp for what that
// forbids.

#if defined(__x86_64__)

#include "server/density/block_kernels.hpp"

namespace {
constexpr int kLanes = 8;
}

#include "server/density/block_kernels_body.hpp"

namespace kinship::density {
extern const BlockKernels kAvx512Kernels;
constinit const BlockKernels kAvx512Kernels = kernels("avx512");
}  // namespace kinship::density

#endif
