#pragma once

#include <cstdint>

#include "proto/types/uuid.hpp"

namespace kinship::store {

/// A point of a store's history: the run that wrote it, and how far that had come by then. What
/// the position counts is the engine's.
struct HistoryPoint {
  Uuid run;
  std::uint64_t position = 0;

  bool operator==(const HistoryPoint&) const = default;
};

}  // namespace kinship::store
