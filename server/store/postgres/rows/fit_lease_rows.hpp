#pragma once

#include <optional>
#include <string_view>

#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"

/// The rights to fit distributions, and the live servers. These rows need not survive a crash: they
/// are written without waiting for the disk or a standby.
namespace kinship::store::postgres {

/// Marks a server as alive for some seconds. Call it again within 2 s.
void note_alive(Connection& connection, const Uuid& server);
/// Removes a server that ends in order.
void note_gone(Connection& connection, const Uuid& server);

/// \return nothing while another live server has the right.
std::optional<FitRight> take_fit_right(Connection& connection, const Digest& id,
                                       const Uuid& server);
void give_back_fit_right(Connection& connection, const Digest& id, const FitRight& right);

/// Whether the right was not taken since; locks it until the transaction ends.
bool has_fit_right(Connection& connection, const Digest& id, const FitRight& right);

}  // namespace kinship::store::postgres
