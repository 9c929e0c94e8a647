#pragma once

#include <string>
#include <vector>

#include "proto/codec/message.hpp"
#include "proto/ros2/wire.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

/// Values to messages of ROS nodes.
namespace kinship::ros2 {

template <typename Wire>
using Message = codec::Message<Wire>;

/// \param report  whose receipt it is; without one in the reply: to be sent again.
Message<wire::Receipt> to_receipt(const ReportReply& reply, const Uuid& report);
Message<wire::Receipt> to_receipt(const Error& error, const Uuid& report);

/// \param joints  names of the chain's, base first; empty: not known.
Message<wire::Registered> to_registered(const RegisterReply& reply, const Uuid& registration,
                                        const std::vector<std::string>& joints);

Message<wire::DistributionAnswer> to_answer(const FetchReply& reply, const Uuid& query);

/// \param distribution  has a mixture.
Message<wire::Distribution> to_distribution(const Distribution& distribution,
                                            const std::vector<std::string>& joints);

Message<wire::Status> to_status(const Result<ServerStatus>& status, const Uuid& query);

/// Whether an answer holds for now only: its node is to ask again.
bool asks_again(const wire::Receipt& receipt);
bool asks_again(const wire::Registered& answer);
bool asks_again(const wire::DistributionAnswer& answer);
bool asks_again(const wire::Status& status);
/// Answers of services: their calls are not repeated.
template <typename Response>
bool asks_again(const Response& /*response*/) {
  return false;
}

}  // namespace kinship::ros2
