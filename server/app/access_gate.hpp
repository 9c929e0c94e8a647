#pragma once

#include <functional>
#include <string>

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "server/service/fetch_service.hpp"
#include "server/service/registration_service.hpp"
#include "server/service/report_service.hpp"

/// Checks registrations, reports and fetches against server/access: a request that the client's
/// certificate does not allow is refused with the client, the request and the reason.
/// Administration is refused in the service, which writes it to the audit log.
namespace kinship::app {

void register_robot(service::RegistrationService& registration, const Caller& caller,
                    RobotDescription description,
                    const std::function<void(const RegisterReply&)>& done);

/// Checks each attempt by itself: the others of its batch are taken. The machine stored with an
/// attempt is the name in the certificate, whatever the report says.
void report(service::ReportService& reports, service::RegistrationService& robots,
            const Caller& caller, ReportRequest request,
            const std::function<void(const ReportReply&)>& done);

/// \param waiter  see FetchService::fetch.
void fetch(service::FetchService& fetches, service::RegistrationService& robots,
           const Caller& caller, const FetchRequest& request, const std::string& waiter,
           const std::function<void(const FetchReply&)>& done);

}  // namespace kinship::app
