#pragma once

#include <cstddef>
#include <string>

#include "server/service/service.hpp"

namespace kinship::app {

/// All metrics in Prometheus's text format: build, clients, service and process.
std::string metrics_page(const service::Service& service, std::size_t clients);

}  // namespace kinship::app
