#pragma once

#include <cstdint>
#include <string>
#include <tuple>

#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"

namespace kinship {

/// A copy of the store in the server's folder of backups.
struct BackupSummary {
  std::string name;
  std::uint64_t bytes = 0;
  std::int64_t modified_ms = 0;  ///< Unix time, UTC
};

template <>
inline constexpr std::tuple kFieldsOf<BackupSummary>{
    Field{"name", &BackupSummary::name, {.limit = kMaxBackupNameBytes}},
    Field{"bytes", &BackupSummary::bytes}, Field{"modified_ms", &BackupSummary::modified_ms}};

}  // namespace kinship
