// For every machine: two numbers at a time, which on x86-64 is SSE2.

#include "server/density/block_kernels.hpp"

namespace {
constexpr int kLanes = 2;
}

#include "server/density/block_kernels_body.hpp"

namespace kinship::density {
extern const BlockKernels kBaselineKernels;
constinit const BlockKernels kBaselineKernels = kernels("baseline");
}  // namespace kinship::density
