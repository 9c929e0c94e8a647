#pragma once

#include <memory>

#include "proto/dds/participant.hpp"
#include "proto/security/client_directory.hpp"
#include "server/app/options.hpp"

namespace kinship::app {

/// Joins the domain as its server, at its first place that is free: a ROS node may have the first.
/// \param clients  those it knows; null without security.
/// \throws Failure(Unavailable) if that fails. If another kinshipd has the domain, or other
/// software
///         all its places, the message names the holder and a remedy.
dds::Participant join_domain(const ServerOptions& options,
                             const std::shared_ptr<const security::ClientDirectory>& clients);

}  // namespace kinship::app
