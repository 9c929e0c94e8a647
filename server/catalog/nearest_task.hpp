#pragma once

#include <functional>
#include <string>

#include "server/store/experience_store.hpp"

namespace kinship::catalog {

/// " (did you mean 'load_machine'?)" with the known task nearest to a name; empty: none is near.
/// Reads the list of tasks.
/// \param is_candidate  whether a task may be named; empty: each.
std::string nearest_task(const store::ExperienceStore& store, const std::string& task,
                         const std::function<bool(const TaskSummary&)>& is_candidate = {});

}  // namespace kinship::catalog
