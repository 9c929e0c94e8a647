#pragma once

#include <functional>
#include <string>

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "server/service/service.hpp"

/// What clients register, report and fetch, past server/access: what their certificate does not
/// allow is refused here, with who, what and why. Administration is refused in the service, which
/// keeps that in the audit log.
namespace kinship::app {

void register_robot(service::Service& service, const Caller& caller, RobotDescription description,
                    const std::function<void(const RegisterReply&)>& done);

/// Each attempt by itself: the others of its batch are taken. What is kept as the machine of an
/// attempt is the name in the certificate, whatever the report says.
void report(service::Service& service, const Caller& caller, ReportRequest request,
            const std::function<void(const ReportReply&)>& done);

/// \param waiter  see Service::fetch.
void fetch(service::Service& service, const Caller& caller, const FetchRequest& request,
           const std::string& waiter, const std::function<void(const FetchReply&)>& done);

}  // namespace kinship::app
