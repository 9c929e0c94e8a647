#pragma once

#include "robots/planning/nearest_scan.hpp"

/// For this library's sources only.
namespace kinship::planning {

struct Scans {
  NearestScan nodes;
  BoxDistances boxes;
};

/// The scans for this machine's instruction set.
const Scans& fastest_scans();

}  // namespace kinship::planning
