#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace kinship::density {

/// Hands out memory that begins on a cache line, so that no vector load crosses two of them.
template <typename Value>
struct CacheLineAllocator {
  using value_type = Value;
  static constexpr std::align_val_t kLine{64};

  CacheLineAllocator() = default;
  template <typename Other>
  CacheLineAllocator(const CacheLineAllocator<Other>& /*other*/) {}

  Value* allocate(std::size_t count) {
    return static_cast<Value*>(::operator new(count * sizeof(Value), kLine));
  }
  void deallocate(Value* memory, std::size_t /*count*/) noexcept {
    ::operator delete(memory, kLine);
  }
  template <typename Other>
  bool operator==(const CacheLineAllocator<Other>& /*other*/) const {
    return true;
  }
};

using AlignedNumbers = std::vector<double, CacheLineAllocator<double>>;

}  // namespace kinship::density
