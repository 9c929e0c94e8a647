#pragma once

#include "proto/codec/arena.hpp"
#include "proto/codec/reader.hpp"
#include "proto/idl/fetch.h"
#include "proto/types/task_experience.hpp"

/// The experience of a task as part of a reply. For the sources of this folder only.
namespace kinship::codec {

void write_part(const TaskExperience& experience, Arena& arena, kinship_wire_TaskExperience& wire);
void read_part(const kinship_wire_TaskExperience& wire, Reader& reader, TaskExperience& experience);

}  // namespace kinship::codec
