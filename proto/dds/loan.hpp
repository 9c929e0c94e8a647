#pragma once

#include <dds/dds.h>

#include <array>
#include <cstddef>
#include <string_view>

#include "proto/dds/entity.hpp"

namespace kinship::dds {

/// Up to 16 samples taken from a reader and returned to it on destruction. For sources of
/// proto/dds only.
class Loan {
 public:
  static constexpr std::size_t kMaxSamples = 16;

  /// \throws Failure(Internal) if they cannot be taken.
  Loan(const Entity& reader, std::string_view what) : reader_(reader.get()) {
    const auto capacity = static_cast<std::uint32_t>(samples_.size());
    count_ = require(dds_take(reader_, samples_.data(), infos_.data(), capacity, capacity), what);
  }
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;
  ~Loan() {
    if (count_ > 0)
      dds_return_loan(reader_, samples_.data(), count_);
  }

  /// Handle of the writer of a sample.
  std::uint64_t writer(std::size_t i) const noexcept { return infos_[i].publication_handle; }

  /// Handle of the instance of a sample, and whether that is still there.
  std::uint64_t instance(std::size_t i) const noexcept { return infos_[i].instance_handle; }
  bool is_alive(std::size_t i) const noexcept {
    return infos_[i].instance_state == DDS_ALIVE_INSTANCE_STATE;
  }

  std::size_t size() const noexcept { return static_cast<std::size_t>(count_); }

  /// The message, or null if this sample only has the state of an instance.
  const void* operator[](std::size_t i) const noexcept {
    return infos_[i].valid_data ? samples_[i] : nullptr;
  }

 private:
  Handle reader_;
  std::array<void*, kMaxSamples> samples_{};  // null: Cyclone DDS lends its own
  std::array<dds_sample_info_t, kMaxSamples> infos_{};
  std::int32_t count_ = 0;
};

}  // namespace kinship::dds
