#include "server/density/instruction_set.hpp"

#include <initializer_list>

namespace kinship::density {

extern const SimdKernels kBaselineSimdKernels;
#if defined(__x86_64__)
extern const SimdKernels kAvx2SimdKernels;
extern const SimdKernels kAvx512SimdKernels;
#endif

const SimdKernels* find_simd_kernels(InstructionSet set) {
  if (set == InstructionSet::Baseline)
    return &kBaselineSimdKernels;
#if defined(__x86_64__)
  if (set == InstructionSet::Avx2 && __builtin_cpu_supports("avx2") &&
      __builtin_cpu_supports("fma"))
    return &kAvx2SimdKernels;
  if (set == InstructionSet::Avx512 && __builtin_cpu_supports("avx512f") &&
      __builtin_cpu_supports("avx512dq"))
    return &kAvx512SimdKernels;
#endif
  return nullptr;
}

const SimdKernels& widest_simd_kernels() {
  for (const InstructionSet set : {InstructionSet::Avx512, InstructionSet::Avx2})
    if (const SimdKernels* kernels = find_simd_kernels(set))
      return *kernels;
  return kBaselineSimdKernels;
}

}  // namespace kinship::density
