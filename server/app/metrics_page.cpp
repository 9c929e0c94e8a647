#include "server/app/metrics_page.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "proto/dds/packet_guard.hpp"
#include "server/app/process_metrics.hpp"

namespace kinship::app {

std::string metrics_page(const service::Service& service, std::size_t clients) {
  metrics::Exposition page;
  page.family("kinship_build_info", metrics::Type::Gauge, "The server's version; always 1.");
  page.sample(std::uint64_t{1}, {{"version", KINSHIP_VERSION}, {"compiler", __VERSION__}});
  page.gauge("kinship_clients", "Clients on the network that could ask for something now.",
             std::uint64_t{clients});
  page.gauge("kinship_participants", "Participants of other processes that are known.",
             std::uint64_t{dds::known_peers()});
  page.family("kinship_dropped_packets_total", metrics::Type::Counter,
              "Packets that were dropped before anything was made of them, by reason.");
  for (const dds::DroppedPackets& each : dds::dropped_packets()) {
    std::string reason(each.reason);
    std::ranges::replace(reason, ' ', '_');
    page.sample(each.count, {{"reason", reason}});
  }
  service.expose(page);
  expose_process(page);
  return page.text();
}

http::Handler metrics_handler(std::function<std::string()> page,
                              std::chrono::milliseconds page_age) {
  using Clock = std::chrono::steady_clock;
  return [page = std::move(page), page_age, text = std::string(),
          made = std::optional<Clock::time_point>()](const http::Request& request,
                                                     const http::Answer& answer) mutable {
    if (request.path != "/metrics")
      return answer(http::text_reply(404, "there is /metrics only"));
    if (request.method != "GET" && request.method != "HEAD") {
      http::Reply reply = http::text_reply(405, "GET and HEAD only");
      reply.fields = {{"Allow", "GET, HEAD"}};
      return answer(std::move(reply));
    }
    if (!made || Clock::now() - *made >= page_age) {
      text = page();
      made = Clock::now();
    }
    answer({.type = "text/plain; version=0.0.4; charset=utf-8", .body = text});
  };
}

}  // namespace kinship::app
