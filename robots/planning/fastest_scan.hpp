#pragma once

#include "robots/planning/nearest_scan.hpp"

/// For this library's sources only.
namespace kinship::planning {

struct Scans {
  NearestScan nodes;
  BoxDistances boxes;
};

/// Those for what this machine knows.
const Scans& fastest_scans();

}  // namespace kinship::planning
