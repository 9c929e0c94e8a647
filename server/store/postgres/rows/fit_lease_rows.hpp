#pragma once

#include <optional>
#include <string_view>

#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"

/// Which server fits a distribution, and which servers are alive. None of it has to survive: it is
/// written without waiting for the disk or a standby.
namespace kinship::store::postgres {

/// This server is alive for some seconds more. Call it again within 2 s.
void note_alive(Connection& connection, const Uuid& server);
/// It has ended in order.
void note_gone(Connection& connection, const Uuid& server);

/// \return nothing while another server that is alive has it.
std::optional<FitRight> take_fit_right(Connection& connection, const Digest& id,
                                       const Uuid& server);
void give_back_fit_right(Connection& connection, const Digest& id, const FitRight& right);

/// Whether nobody took it since, until the transaction ends.
bool has_fit_right(Connection& connection, const Digest& id, const FitRight& right);

}  // namespace kinship::store::postgres
