#pragma once

#include <memory>

#include "proto/dds/participant.hpp"
#include "proto/security/client_directory.hpp"
#include "server/app/options.hpp"

namespace kinship::app {

/// Joins the domain as its server.
/// \param clients  those it knows; null without security.
/// \throws Failure(Unavailable) if that fails. If a port of the domain is taken, the message names
///         its holder, another kinshipd or other software, and a remedy.
dds::Participant join_domain(const ServerOptions& options,
                             const std::shared_ptr<const security::ClientDirectory>& clients);

}  // namespace kinship::app
