#include "server/app/console_server.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "proto/security/admin_token.hpp"
#include "proto/security/certificate.hpp"
#include "proto/security/credentials.hpp"
#include "proto/security/private_files.hpp"
#include "proto/security/security_folder.hpp"
#include "server/app/admin_reply.hpp"
#include "server/app/database_url.hpp"

namespace kinship::app {
namespace {

/// Beside the store, or where it would be if it were a file.
std::filesystem::path file_beside_store(const ServerOptions& options, const char* ending) {
  std::filesystem::path store =
      is_database_url(options.store.string()) ? default_store() : options.store;
  return store += ending;
}

/// Names and addresses by which browsers may ask for the console.
std::vector<std::string> hosts_of(const ServerOptions& options, const http::Address& address) {
  std::vector<std::string> hosts = {"localhost", "127.0.0.1", "::1", http::name_of_this_machine()};
  if (address.address != "0.0.0.0" && address.address != "::")
    hosts.push_back(address.address);
  hosts.insert(hosts.end(), options.console_hosts.begin(), options.console_hosts.end());
  std::erase_if(hosts, [](const std::string& host) { return !security::is_host(host); });
  return hosts;
}

/// One that names the hosts; without the authority's key the server's own, which names none.
std::optional<http::CertificateFiles> certificate_of(const ServerOptions& options,
                                                     const http::Address& address) {
  if (options.security.empty())
    return std::nullopt;
  const security::SecurityFolder folder(options.security);
  try {
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    const security::HostCertificate own = folder.host_certificate(hosts_of(options, address), now);
    return http::CertificateFiles{own.certificate, own.key};
  } catch (const Failure& failure) {
    spdlog::warn(
        "the console shows the server's certificate, which names no host: browsers will "
        "complain ({})",
        failure.what());
  }
  const security::CredentialFiles files(folder.server_credentials());
  return http::CertificateFiles{files.certificate, files.key};
}

}  // namespace

std::optional<http::Port> open_console_port(const ServerOptions& options) {
  if (options.console.empty())
    return std::nullopt;
  const http::Address address = http::read_address(options.console).value_or_throw();
  http::PortUse use{"the console", "--console"};
  if (!http::is_loopback(address))
    use.tls = certificate_of(options, address);
  return http::Port(address, use);
}

ConsoleServer::ConsoleServer(http::Port port, const ServerOptions& options,
                             service::Service& service, console::Broadcast& broadcast)
    : link_file_(file_beside_store(options, ".console")) {
  const std::filesystem::path token_file = file_beside_store(options, ".console-token");
  const bool is_new = !std::filesystem::exists(token_file);
  const std::string url = port.url();
  console_.emplace(std::move(port), service, broadcast,
                   console::ConsoleOptions{
                       .token = security::make_admin_token(token_file).hex(),
                       .is_admin = options.console_admin,
                       .hosts = options.console_hosts,
                       .to_json = [](const service::AdminRow& row) { return to_json(row); }});
  security::replace_file(link_file_, console_->link() + '\n', security::Readers::Owner);
  if (is_new)
    spdlog::info("console at {}", console_->link());
  else
    spdlog::info("console at {} with the token in '{}'; kinship console prints the link", url,
                 token_file.string());
}

ConsoleServer::~ConsoleServer() {
  console_.reset();
  std::error_code ignored;
  std::filesystem::remove(link_file_, ignored);
}

}  // namespace kinship::app
