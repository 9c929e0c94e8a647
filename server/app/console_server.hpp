#pragma once

#include <filesystem>
#include <optional>

#include "server/app/options.hpp"
#include "server/console/console.hpp"
#include "server/http/listener.hpp"
#include "server/service/service.hpp"

namespace kinship::app {

/// Binds the port of `--console`; nothing without the option.
/// \throws Failure(Unavailable) if it cannot be bound, or its certificate cannot be used.
std::optional<http::Port> open_console_port(const ServerOptions& options);

/// The console while it is served. Its token lies in STORE.console-token, its link, which
/// `kinship console` prints, in STORE.console as long as it is served; both with mode 0600.
class ConsoleServer {
 public:
  /// \param service, broadcast  outlive it.
  /// \throws Failure if the files cannot be written.
  ConsoleServer(http::Port port, const ServerOptions& options, service::Service& service,
                console::Broadcast& broadcast);
  ~ConsoleServer();
  ConsoleServer(const ConsoleServer&) = delete;
  ConsoleServer& operator=(const ConsoleServer&) = delete;

 private:
  std::filesystem::path link_file_;
  std::optional<console::Console> console_;
};

}  // namespace kinship::app
