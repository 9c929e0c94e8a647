#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/field.hpp"
#include "proto/types/uuid.hpp"

namespace kinship {

/// Result of a full check of a store. Paths quarantined before as damaged are not problems.
struct StoreCheck {
  struct Table {
    std::string name;
    std::uint64_t rows = 0;
    std::uint64_t problems = 0;
  };

  std::string file;
  Uuid epoch;
  std::uint32_t schema_version = 0;
  std::string release;  ///< version of Kinship that last wrote reports; empty: before 0.2.0
  std::uint64_t bytes = 0;
  std::vector<Table> tables;
  std::uint64_t damaged_paths = 0;  ///< quarantined before
  std::uint64_t retired_paths = 0;
  std::uint64_t problems = 0;         ///< of all tables, and of the file
  std::vector<std::string> messages;  ///< of the first problems, one each; each names the row
};

template <>
inline constexpr std::tuple kFieldsOf<StoreCheck::Table>{
    Field{"name", &StoreCheck::Table::name}, Field{"rows", &StoreCheck::Table::rows},
    Field{"problems", &StoreCheck::Table::problems}};

template <>
inline constexpr std::tuple kFieldsOf<StoreCheck>{
    Field{"file", &StoreCheck::file},
    Field{"epoch", &StoreCheck::epoch},
    Field{"schema_version", &StoreCheck::schema_version},
    Field{"release", &StoreCheck::release},
    Field{"bytes", &StoreCheck::bytes},
    Field{"tables", &StoreCheck::tables},
    Field{"damaged_paths", &StoreCheck::damaged_paths},
    Field{"retired_paths", &StoreCheck::retired_paths},
    Field{"problems", &StoreCheck::problems},
    Field{"messages", &StoreCheck::messages}};

}  // namespace kinship
