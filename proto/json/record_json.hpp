#pragma once

#include "proto/json/reader.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/attempt.hpp"

/// The planning record, a part of experiences and of path rows; for this library's sources only.
namespace kinship::json {

OrderedJson record_object(const PlanningRecord& record);

/// Required: outcome, planning_time_s, collision_checks; the rest has PlanningRecord's defaults.
PlanningRecord read_record(const Reader& reader);

}  // namespace kinship::json
