#pragma once

#include "server/service/admin_page.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// A page of an experience file: first the robots with attempts of the request's robot and task
/// (each empty: all), over as many pages as needed, then the attempts. Without retired and damaged
/// paths, and robots whose row is damaged.
/// \param robot  the robot that the request names.
/// \throws Failure(InvalidInput) for a cursor of another listing; Failure(Storage).
AdminPage export_paths(const store::Store& store, const std::optional<Digest>& robot,
                       const AdminRequest& request);

}  // namespace kinship::service
