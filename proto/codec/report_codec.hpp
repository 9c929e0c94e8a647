#pragma once

#include "proto/codec/message.hpp"
#include "proto/idl/report.h"

namespace kinship::codec {

/// \param request  its attempts are valid (validate(Attempt)).
/// \return TooLarge if the batch is.
Result<Message<kinship_wire_ReportRequest>> encode(const Head& head, const ReportRequest& request);

/// Attempts that break a rule become refused receipts; the others are not affected. \return an
/// error only if the batch has too many attempts.
Result<ReportRequest> decode(const kinship_wire_ReportRequest& wire);

Result<Message<kinship_wire_ReportReply>> encode(const Head& head, const ReportReply& reply);
Result<ReportReply> decode(const kinship_wire_ReportReply& wire);

}  // namespace kinship::codec
