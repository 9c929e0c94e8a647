#include "server/store/postgres/presence.hpp"

#include <exception>

#include "server/store/postgres/rows/change_rows.hpp"
#include "server/store/postgres/rows/fit_lease_rows.hpp"

namespace kinship::store::postgres {

Presence::~Presence() {
  try {
    pool_.use([&](Connection& connection) { postgres::note_gone(connection, server_); });
  } catch (const std::exception&) {  // then it is dead a few seconds later
  }
}

StoreChanges Presence::changes_since(std::string_view cursor) {
  note_alive();
  return pool_.read_snapshot(
      [&](Connection& connection) { return postgres::changes_since(connection, cursor); });
}

void Presence::note_alive() {
  constexpr std::chrono::seconds kInterval{1};
  const auto now = std::chrono::steady_clock::now();
  {
    const std::lock_guard lock(mutex_);
    if (now - noted_ < kInterval)
      return;
    noted_ = now;
  }
  pool_.use([&](Connection& connection) { postgres::note_alive(connection, server_); });
}

std::optional<FitRight> Presence::take_fit_right(const Digest& id) {
  note_alive();  // before others are to believe in it
  return pool_.use(
      [&](Connection& connection) { return postgres::take_fit_right(connection, id, server_); });
}

void Presence::give_back_fit_right(const Digest& id, const FitRight& right) noexcept {
  try {
    pool_.use(
        [&](Connection& connection) { postgres::give_back_fit_right(connection, id, right); });
  } catch (const std::exception&) {  // free once this server takes it again, or ends
  }
}

}  // namespace kinship::store::postgres
