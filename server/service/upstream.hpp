#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/summaries.hpp"
#include "server/metrics/exposition.hpp"
#include "server/service/service_parts.hpp"
#include "server/sites/forwarder.hpp"
#include "server/sites/used_tasks.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

class FetchService;
class ReportService;

/// A site's side of its exchange with the memory above it (server/sites); does nothing where there
/// is none. May be shared between threads, between start() and stop().
class Upstream {
 public:
  /// \param site  outlives the object.
  Upstream(const ServiceParts& parts, store::Store& site) : parts_(parts), site_(site) {}
  Upstream(const Upstream&) = delete;
  Upstream& operator=(const Upstream&) = delete;

  /// Begins the exchange. Before any request; data that comes down goes to the services, which
  /// outlive the exchange.
  void start(ReportService& reports, FetchService& fetches);
  /// Ends the exchange; every report that came down is committed on return.
  void stop();

  void wake();                              ///< the site has new data
  void note_task(const std::string& task);  ///< a robot of the site uses it

  /// \param attempts  in the site's store.
  /// \return nothing where there is no memory above.
  std::optional<UpstreamStatus> status(std::uint64_t attempts) const;
  void expose(metrics::Exposition& page, std::uint64_t attempts) const;

 private:
  sites::SiteHooks hooks(ReportService& reports, FetchService& fetches);

  const ServiceParts parts_;
  store::Store& site_;
  sites::UsedTasks used_tasks_;
  std::unique_ptr<sites::Forwarder> forwarder_;  // its thread uses all of the above
};

}  // namespace kinship::service
