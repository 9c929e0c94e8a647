#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

#include "server/http/message.hpp"
#include "server/service/service.hpp"

namespace kinship::app {

/// All metrics in Prometheus's text format: build, clients, service and process.
std::string metrics_page(const service::Service& service, std::size_t clients);

/// Answers GET /metrics alone.
/// \param page      if it throws, the reply is 503.
/// \param page_age  a page younger than this is sent again, however many requests come.
http::Handler metrics_handler(std::function<std::string()> page,
                              std::chrono::milliseconds page_age = std::chrono::milliseconds(200));

}  // namespace kinship::app
