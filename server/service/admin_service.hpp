#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "server/service/admin_page.hpp"
#include "server/service/administration.hpp"
#include "server/service/fetch_service.hpp"
#include "server/service/jobs.hpp"
#include "server/service/report_service.hpp"
#include "server/service/service_parts.hpp"
#include "server/service/upstream.hpp"

namespace kinship::service {

/// Answers administrators, each verb on a thread where it waits for no task that may take long. May
/// be shared between threads; `done` as in Service.
class AdminService {
 public:
  /// Objects that the service uses besides ServiceParts; they outlive it.
  struct Others {
    store::Store& store;
    FetchService& fetches;
    const ReportService& reports;
    Upstream& upstream;
    std::function<ServerStatus()> status;
  };

  AdminService(const ServiceParts& parts, const Others& others);
  AdminService(const AdminService&) = delete;
  AdminService& operator=(const AdminService&) = delete;

  /// \param request_key  the request's key (catalog::client_of); see Administration::answer.
  /// \param caller  a request that it may not make (server/access) is refused first.
  void administer(AdminRequest request, const std::string& request_key,
                  const std::function<void(const AdminPage&)>& done, const Caller& caller);

  const Jobs& jobs() const noexcept { return jobs_; }
  void expire(Jobs::TimePoint now) { jobs_.expire(now); }
  /// Gives up jobs; returns when the running job and reset have ended.
  void stop();

 private:
  Jobs::Options job_options();
  Administration::Parts administration_parts();
  std::optional<Error> refusal_of(const Caller& caller, const AdminRequest& request) const;
  runtime::WorkerPool& pool_for(AdminVerb verb);
  void count(const AdminPage& page, const std::string& client);
  void count_refused(const AdminPage& page);
  std::vector<ClientUse> list_clients() const;

  const ServiceParts parts_;
  const Others others_;
  Jobs jobs_;
  Administration administration_;
  runtime::WorkerPool reset_pool_;  // last: its thread uses the above
};

}  // namespace kinship::service
