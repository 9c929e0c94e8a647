#pragma once

#include <cstddef>
#include <memory>

#include "proto/dds/participant.hpp"
#include "proto/dds/wait_loop.hpp"
#include "proto/security/admin_token.hpp"
#include "server/service/service.hpp"

namespace kinship::app {

/// The four conversations as kinshipd offers them: decoded requests go to the service, its replies
/// go back. Long work happens on threads of the service.
class Endpoints {
 public:
  /// \param participant, loop, service  outlive the endpoints.
  /// \param token  that changes need to show; outlives them. Null: none.
  /// \throws Failure(Internal) if a DDS entity cannot be created.
  Endpoints(const dds::Participant& participant, dds::WaitLoop& loop, service::Service& service,
            security::AdminTokenCheck* token);
  ~Endpoints();
  Endpoints(const Endpoints&) = delete;
  Endpoints& operator=(const Endpoints&) = delete;

  /// Clients on the network that could ask for something now. Callable from any thread.
  std::size_t clients() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::app
