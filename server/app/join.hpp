#pragma once

#include "proto/dds/participant.hpp"
#include "server/app/options.hpp"

namespace kinship::app {

/// Joins the domain as its server.
/// \throws Failure(Unavailable) if that cannot be. If a port of the domain is taken the message
///         says by whom, another kinshipd or other software, and what to do.
dds::Participant join_domain(const ServerOptions& options);

}  // namespace kinship::app
