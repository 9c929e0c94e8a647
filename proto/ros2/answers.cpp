#include "proto/ros2/answers.hpp"

#include <algorithm>
#include <chrono>

#include "proto/codec/writer.hpp"

namespace kinship::ros2 {
namespace {

using codec::Arena;

void write(const Uuid& from, wire::Uuid& to) { codec::write_uuid(from, to.uuid); }

/// Of builtin_interfaces: Time or Duration.
template <typename Wire>
void write(std::chrono::milliseconds from, Wire& to) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(from);
  to.sec = static_cast<std::int32_t>(seconds.count());
  to.nanosec = static_cast<std::uint32_t>(std::chrono::nanoseconds(from - seconds).count());
}

template <typename Sequence>
void write(const std::vector<std::string>& from, Arena& arena, Sequence& to) {
  arena.resize(to, from.size());
  for (std::size_t i = 0; i < from.size(); ++i)
    to._buffer[i] = arena.text(from[i]);
}

void write(const Eigen::Isometry3d& from, wire::Pose& to) {
  const PoseArray pose = to_pose_array(from);
  to.position = {pose[0], pose[1], pose[2]};
  to.orientation = {pose[3], pose[4], pose[5], pose[6]};
}

void write_mixture(const Mixture& mixture, Arena& arena, wire::Distribution& to) {
  const Eigen::MatrixXd& means = mixture.means();
  const auto components = static_cast<std::size_t>(mixture.size());
  const auto d = static_cast<std::size_t>(mixture.dimension());
  codec::write_numbers(arena, mixture.weights().data(), components, to.weights);
  codec::write_numbers(arena, means.data(), d * components, to.means);
  arena.resize(to.covariances, mixture.covariances().size() * d * (d + 1) / 2);
  double* next = to.covariances._buffer;
  for (const Eigen::MatrixXd& covariance : mixture.covariances())
    for (Eigen::Index row = 0; row < covariance.rows(); ++row)
      for (Eigen::Index column = 0; column <= row; ++column)
        *next++ = covariance(row, column);
}

/// Statuses and grades are numbered alike in both; the .msg files name them.
template <typename Enumeration>
std::uint8_t number(Enumeration value) {
  return static_cast<std::uint8_t>(value);
}

}  // namespace

Message<wire::Receipt> to_receipt(const ReportReply& reply, const Uuid& report) {
  Message<wire::Receipt> message;
  const auto receipt = std::ranges::find(reply.receipts, report, &Receipt::report_uuid);
  const bool is_told = receipt != reply.receipts.end();
  write(report, message.wire.uuid);
  message.wire.status = number(is_told ? receipt->status : ReceiptStatus::TryAgain);
  message.wire.message = message.arena->text(is_told ? receipt->message : reply.message);
  write(reply.store_epoch, message.wire.store_epoch);
  write(reply.retry_after, message.wire.retry_after);
  return message;
}

Message<wire::Receipt> to_receipt(const Error& error, const Uuid& report) {
  return to_receipt(
      ReportReply{.store_epoch = {}, .receipts = {{report, ReceiptStatus::Refused, error.message}}},
      report);
}

Message<wire::Registered> to_registered(const RegisterReply& reply, const Uuid& registration,
                                        const std::vector<std::string>& joints) {
  Message<wire::Registered> message;
  Arena& arena = *message.arena;
  write(registration, message.wire.uuid);
  message.wire.status = number(reply.status);
  codec::write_digest(reply.robot, message.wire.robot);
  write(joints, arena, message.wire.joint_names);
  message.wire.solver = arena.text(reply.solver);
  message.wire.message = arena.text(reply.message);
  write(reply.same_arms, arena, message.wire.same_arms);
  message.wire.geometry_grade = number(reply.geometry_grade);
  message.wire.geometry = arena.text(reply.geometry);
  write(reply.retry_after, message.wire.retry_after);
  return message;
}

Message<wire::DistributionAnswer> to_answer(const FetchReply& reply, const Uuid& query) {
  Message<wire::DistributionAnswer> message;
  write(query, message.wire.uuid);
  message.wire.status = number(reply.status);
  message.wire.message = message.arena->text(reply.message);
  write(reply.retry_after, message.wire.retry_after);
  if (!reply.distribution)
    return message;
  codec::write_digest(reply.distribution->id, message.wire.distribution_id);
  message.wire.revision = reply.distribution->revision;
  if (reply.message.empty())
    message.wire.message = message.arena->text(reply.distribution->reason);
  return message;
}

Message<wire::Distribution> to_distribution(const Distribution& distribution,
                                            const std::vector<std::string>& joints) {
  Message<wire::Distribution> message;
  wire::Distribution& to = message.wire;
  Arena& arena = *message.arena;
  write(std::chrono::milliseconds(distribution.fitted_ms), to.header.stamp);
  to.header.frame_id = arena.text("");
  codec::write_digest(distribution.id, to.id);
  to.revision = distribution.revision;
  write(distribution.store_epoch, to.store_epoch);
  to.task = arena.text(distribution.task);
  codec::write_digest(distribution.robot, to.robot);
  if (distribution.T_task_base) {
    arena.resize(to.base, 1);
    write(*distribution.T_task_base, to.base._buffer[0]);
  }
  write(joints, arena, to.joint_names);
  write_mixture(distribution.mixture.value(), arena, to);
  const Eigen::MatrixX2d limits = distribution.limits.transpose();  // a column is contiguous
  const auto dof = static_cast<std::size_t>(limits.rows());
  codec::write_numbers(arena, limits.col(0).data(), dof, to.lower);
  codec::write_numbers(arena, limits.col(1).data(), dof, to.upper);
  arena.resize(to.is_continuous, dof);
  for (std::size_t i = 0; i < distribution.cuts.size(); ++i)
    to.is_continuous._buffer[i] = distribution.cuts[i].has_value();
  to.configurations = distribution.configurations;
  to.recommended_share = distribution.advice.recommended_share;
  to.message = arena.text(distribution.reason);
  return message;
}

Message<wire::Status> to_status(const Result<ServerStatus>& status, const Uuid& query) {
  Message<wire::Status> message;
  wire::Status& to = message.wire;
  Arena& arena = *message.arena;
  write(query, to.uuid);
  if (!status) {
    to.version = arena.text("");
    to.message = arena.text(status.error().message);
    return message;
  }
  to.version = arena.text(status->version);
  write(status->store_epoch, to.store_epoch);
  write(std::chrono::seconds(status->uptime_s), to.uptime);
  to.robots = status->robots;
  to.tasks = status->tasks;
  to.paths = status->paths;
  to.attempts = status->attempts;
  to.distributions = status->distributions;
  to.reports_received = status->reports_received;
  to.reports_refused = status->reports_refused;
  to.writable = status->writable;
  to.message = arena.text(status->storage_message);
  return message;
}

bool asks_again(const wire::Receipt& receipt) {
  return receipt.status == number(ReceiptStatus::TryAgain);
}

bool asks_again(const wire::Registered& answer) {
  return answer.retry_after.sec > 0 || answer.retry_after.nanosec > 0;
}

bool asks_again(const wire::DistributionAnswer& answer) {
  return answer.status == number(FetchStatus::Pending) ||
         answer.status == number(FetchStatus::Busy);
}

bool asks_again(const wire::Status& status) { return *status.version == '\0'; }

}  // namespace kinship::ros2
