#include "server/density/instruction_set.hpp"

#include <initializer_list>

namespace kinship::density {

extern const BlockKernels kBaselineKernels;
#if defined(__x86_64__)
extern const BlockKernels kAvx2Kernels;
extern const BlockKernels kAvx512Kernels;
#endif

const BlockKernels* find_kernels(InstructionSet set) {
  if (set == InstructionSet::Baseline)
    return &kBaselineKernels;
#if defined(__x86_64__)
  if (set == InstructionSet::Avx2 && __builtin_cpu_supports("avx2") &&
      __builtin_cpu_supports("fma"))
    return &kAvx2Kernels;
  if (set == InstructionSet::Avx512 && __builtin_cpu_supports("avx512f") &&
      __builtin_cpu_supports("avx512dq"))
    return &kAvx512Kernels;
#endif
  return nullptr;
}

const BlockKernels& widest_kernels() {
  for (const InstructionSet set : {InstructionSet::Avx512, InstructionSet::Avx2})
    if (const BlockKernels* kernels = find_kernels(set))
      return *kernels;
  return kBaselineKernels;
}

}  // namespace kinship::density
