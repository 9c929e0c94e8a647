#pragma once

#include <cstddef>

#include "proto/ros2/kinship_msgs.h"

/// Short names of the messages of client/ros2/kinship_msgs as idlc has them in C.
namespace kinship::ros2::wire {

using Uuid = unique_identifier_msgs_msg_UUID_;
using Pose = geometry_msgs_msg_Pose;
using Duration = builtin_interfaces_msg_Duration;
using Time = builtin_interfaces_msg_Time;
using Solid = shape_msgs_msg_SolidPrimitive;

using Registration = kinship_msgs_msg_dds__Registration_;
using Registered = kinship_msgs_msg_dds__Registered_;
using PlannedPath = kinship_msgs_msg_dds__PlannedPath_;
using Receipt = kinship_msgs_msg_dds__Receipt_;
using DistributionQuery = kinship_msgs_msg_dds__DistributionQuery_;
using DistributionAnswer = kinship_msgs_msg_dds__DistributionAnswer_;
using Distribution = kinship_msgs_msg_dds__Distribution_;
using StatusQuery = kinship_msgs_msg_dds__StatusQuery_;
using Status = kinship_msgs_msg_dds__Status_;

using RegisterRequest = kinship_msgs_srv_dds__Register_Request_;
using RegisterResponse = kinship_msgs_srv_dds__Register_Response_;
using ReportRequest = kinship_msgs_srv_dds__Report_Request_;
using ReportResponse = kinship_msgs_srv_dds__Report_Response_;
using FetchRequest = kinship_msgs_srv_dds__Fetch_Request_;
using FetchResponse = kinship_msgs_srv_dds__Fetch_Response_;
using GetStatusRequest = kinship_msgs_srv_dds__GetStatus_Request_;
using GetStatusResponse = kinship_msgs_srv_dds__GetStatus_Response_;

/// Bytes at the beginning of each sample that its answer repeats: the UUID of a message, or the
/// identity of a service's request, which stands before the message.
inline constexpr std::size_t kKeyBytes = 16;
static_assert(offsetof(Registration, uuid) == 0 && offsetof(Registered, uuid) == 0 &&
              offsetof(PlannedPath, uuid) == 0 && offsetof(Receipt, uuid) == 0 &&
              offsetof(DistributionQuery, uuid) == 0 && offsetof(DistributionAnswer, uuid) == 0 &&
              offsetof(StatusQuery, uuid) == 0 && offsetof(Status, uuid) == 0);
static_assert(offsetof(RegisterRequest, registration) == kKeyBytes &&
              offsetof(ReportRequest, path) == kKeyBytes &&
              offsetof(FetchRequest, query) == kKeyBytes &&
              offsetof(GetStatusRequest, query) == kKeyBytes);

}  // namespace kinship::ros2::wire
