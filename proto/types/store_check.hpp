#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "proto/types/uuid.hpp"

namespace kinship {

/// What a full check of a store found. Paths that were set aside before as damaged are no problem.
struct StoreCheck {
  struct Table {
    std::string name;
    std::uint64_t rows = 0;
    std::uint64_t problems = 0;
  };

  std::string file;
  Uuid epoch;
  std::uint32_t schema_version = 0;
  std::uint64_t bytes = 0;
  std::vector<Table> tables;
  std::uint64_t damaged_paths = 0;  ///< set aside before
  std::uint64_t retired_paths = 0;
  std::uint64_t problems = 0;         ///< of all tables, and of the file
  std::vector<std::string> messages;  ///< one a problem, the first of them; each names the row
};

}  // namespace kinship
