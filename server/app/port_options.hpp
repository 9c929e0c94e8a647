#pragma once

#include <string>

#include "server/app/options.hpp"

namespace CLI {  // NOLINT: theirs
class App;
}  // namespace CLI

namespace kinship::app {

/// Adds the options of the ports for metrics, for the console, and for ROS 2 nodes.
void add_port_options(CLI::App& app, ServerOptions& options);

/// The reason not to serve the console with these options; empty: none.
std::string console_fault(const ServerOptions& options);

/// The same for ROS 2 nodes.
std::string ros2_fault(const ServerOptions& options);

}  // namespace kinship::app
