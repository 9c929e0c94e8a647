#include "server/app/metrics_page.hpp"

#include "server/app/process_metrics.hpp"

namespace kinship::app {

std::string metrics_page(const service::Service& service, std::size_t clients) {
  metrics::Exposition page;
  page.family("kinship_build_info", metrics::Type::Gauge, "The server's version; always 1.");
  page.sample(std::uint64_t{1}, {{"version", KINSHIP_VERSION}, {"compiler", __VERSION__}});
  page.gauge("kinship_clients", "Clients on the network that could ask for something now.",
             std::uint64_t{clients});
  service.expose(page);
  expose_process(page);
  return page.text();
}

}  // namespace kinship::app
