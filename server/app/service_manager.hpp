#pragma once

#include <string_view>

namespace kinship::app {

/// Tells systemd, or whoever else set NOTIFY_SOCKET, how the service is, e.g. "READY=1".
/// \return false if nobody asked or the message could not be sent; nothing depends on it.
/// Source: sd_notify(3), section "Notes", which describes the protocol.
bool notify_service_manager(std::string_view state);

}  // namespace kinship::app
