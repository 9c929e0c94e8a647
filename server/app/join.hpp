#pragma once

#include "proto/dds/participant.hpp"
#include "server/app/options.hpp"

namespace kinship::app {

/// Joins the domain as its server.
/// \throws Failure(Unavailable) if that fails. If a port of the domain is taken, the message names
///         its holder, another kinshipd or other software, and a remedy.
dds::Participant join_domain(const ServerOptions& options);

}  // namespace kinship::app
