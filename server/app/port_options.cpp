#include "server/app/port_options.hpp"

#include <CLI/CLI.hpp>

#include "proto/dds/participant.hpp"
#include "server/http/address.hpp"

namespace kinship::app {
namespace {

CLI::Validator is_port_address() {
  return {[](std::string& text) {
            const Result<http::Address> address = http::read_address(text);
            return address ? std::string() : address.error().message;
          },
          "ADDRESS:PORT"};
}

}  // namespace

void add_port_options(CLI::App& app, ServerOptions& options) {
  app.add_option("--metrics", options.metrics,
                 "Address and port where Prometheus reads /metrics, e.g. 127.0.0.1:9464, without "
                 "access control; default: nowhere")
      ->check(is_port_address());
  app.add_option("--metrics-host", options.metrics_hosts,
                 "A name by which /metrics may be asked for, besides addresses, localhost and this "
                 "machine's name; may be given again");
  app.add_option("--console", options.console,
                 "Address and port of pages for a browser, e.g. 127.0.0.1:9480, which need a token "
                 "(kinship console); another address than loopback needs --security, whose "
                 "certificate it then shows; default: nowhere")
      ->check(is_port_address());
  app.add_flag("--console-admin", options.console_admin,
               "The console may also cancel jobs, retire and restore paths, rename and remove "
               "tasks, and evict distributions, each after its name was typed; without, it only "
               "reads");
  app.add_option("--console-host", options.console_hosts,
                 "A name by which the console may be asked for, besides addresses, localhost and "
                 "this machine's name; may be given again");
  app.add_flag("--ros2", options.ros2,
               "Serve ROS 2 nodes too (messages of kinship_msgs), on the same interface; with "
               "--security only those of a keystore of SROS 2 (--ros2-enclave)");
  app.add_option("--ros2-domain", options.ros2_domain, "Of --ros2: their domain")
      ->envname("ROS_DOMAIN_ID")
      ->capture_default_str();
  app.add_option("--ros2-enclave", options.ros2_enclave,
                 "Of --ros2 with --security: the server's enclave in their keystore of SROS 2, a "
                 "folder with cert.pem, key.pem, governance.p7s, permissions.p7s and both "
                 "authorities")
      ->check(CLI::ExistingDirectory)
      ->type_name("FOLDER");
}

std::string ros2_fault(const ServerOptions& options) {
  if (!options.ros2)
    return {};  // whatever ROS_DOMAIN_ID is
  if (options.ros2_domain > dds::kMaxDomain)
    return "--ros2-domain " + std::to_string(options.ros2_domain) + " (or ROS_DOMAIN_ID) exceeds " +
           std::to_string(dds::kMaxDomain);
  if (options.security.empty() != options.ros2_enclave.empty())
    return options.security.empty()
               ? "--ros2-enclave '" + options.ros2_enclave.string() +
                     "' secures ROS 2 alone: it is for a server whose own clients have "
                     "certificates, too (--security FOLDER)"
               : "--ros2 with --security needs --ros2-enclave FOLDER: ROS 2 nodes have no "
                 "certificate of Kinship's, and would be let in without one of SROS 2";
  return !options.security.empty() && options.ros2_domain == options.domain
             ? "--ros2-domain " + std::to_string(options.ros2_domain) +
                   " (or ROS_DOMAIN_ID) is --domain's number, too: with security they have to "
                   "differ"
             : "";
}

std::string console_fault(const ServerOptions& options) {
  if (options.console.empty() || !options.security.empty())
    return {};
  const Result<http::Address> address = http::read_address(options.console);
  if (!address || http::is_loopback(*address))
    return {};
  return "--console '" + options.console +
         "' is not loopback, and without --security anybody on that network could read along";
}

}  // namespace kinship::app
