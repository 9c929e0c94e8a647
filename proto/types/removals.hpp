#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/uuid.hpp"

/// What admin verbs that take experience away, or bring it back, have done.
namespace kinship {

/// Paths that no fit uses any more. They are kept for the record.
struct Retirement {
  std::string task;
  std::uint64_t paths = 0;  ///< retired by this request; 0: all were retired before
  std::vector<Digest> robots;
};

template <>
inline constexpr std::tuple kFieldsOf<Retirement>{
    Field{"task", &Retirement::task, {.limit = kMaxTaskBytes}}, Field{"paths", &Retirement::paths},
    Field{"robots", &Retirement::robots, {.limit = kMaxSources}}};

/// Retired paths that were stored anew, each under a UUID of its own.
struct Restoration {
  std::string task;          ///< of one path, or as asked for; empty: of all
  std::uint64_t paths = 0;   ///< in use again by this request
  std::uint64_t in_use = 0;  ///< left out: their content is in use
  std::uint64_t lost = 0;    ///< left out: waypoints not kept, or not taken by the store
  Uuid report_uuid = {};     ///< of the first restored path; zero: none
  std::string reason = {};   ///< of the last one that was left out
};

template <>
inline constexpr std::tuple kFieldsOf<Restoration>{
    Field{"task", &Restoration::task, {.limit = kMaxTaskBytes}},
    Field{"paths", &Restoration::paths},
    Field{"in_use", &Restoration::in_use},
    Field{"lost", &Restoration::lost},
    Field{"report_uuid", &Restoration::report_uuid},
    Field{"reason", &Restoration::reason, {.limit = kMaxMessageBytes}}};

/// A task that is listed no more, and data removed with it.
struct TaskRemoval {
  std::string task;
  std::uint64_t paths = 0;          ///< retired now
  std::uint64_t attempts = 0;       ///< kept for the record, with their paths and UUIDs
  std::uint64_t distributions = 0;  ///< of it, deleted
};

template <>
inline constexpr std::tuple kFieldsOf<TaskRemoval>{
    Field{"task", &TaskRemoval::task, {.limit = kMaxTaskBytes}},
    Field{"paths", &TaskRemoval::paths}, Field{"attempts", &TaskRemoval::attempts},
    Field{"distributions", &TaskRemoval::distributions}};

/// A distribution that was removed from the store.
struct Eviction {
  Digest id;
};

template <>
inline constexpr std::tuple kFieldsOf<Eviction>{Field{"evicted", &Eviction::id}};

/// A removed robot, and data removed with it.
struct RobotRemoval {
  Digest robot;
  std::string label;                ///< its former label; another robot may have it now
  std::uint64_t paths = 0;          ///< retired now
  std::uint64_t attempts = 0;       ///< kept for the record, with their paths and UUIDs
  std::uint64_t distributions = 0;  ///< for it, deleted
  bool is_deleted = false;          ///< it had no attempts and was deleted completely
};

template <>
inline constexpr std::tuple kFieldsOf<RobotRemoval>{
    Field{"robot", &RobotRemoval::robot},
    Field{"label", &RobotRemoval::label, {.limit = kMaxLabelBytes}},
    Field{"paths", &RobotRemoval::paths},
    Field{"attempts", &RobotRemoval::attempts},
    Field{"distributions", &RobotRemoval::distributions},
    Field{"is_deleted", &RobotRemoval::is_deleted}};

}  // namespace kinship
