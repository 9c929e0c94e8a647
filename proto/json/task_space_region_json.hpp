#pragma once

#include "proto/json/reader.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/task_space_region.hpp"

/// Task space regions as parts of documents; for this library's sources only.
namespace kinship::json {

/// `{"T0_w": pose, "Tw_e": pose, "Bw": [[lower, upper] x 6]}`; null for an infinite bound.
OrderedJson region_object(const TaskSpaceRegion& region);

/// All members are required. Throws the exceptions of Reader, also for crossed bounds.
TaskSpaceRegion read_region(const Reader& reader);

}  // namespace kinship::json
