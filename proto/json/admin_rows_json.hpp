#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "proto/types/audit.hpp"
#include "proto/types/backup_summary.hpp"
#include "proto/types/client_use.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

/// The rows of the admin conversation and of `--json` listings: the server writes them, clients
/// read them. Member names are those of the structs and never change.
namespace kinship::json {

/// Name of a row in a refusal; empty: the value is not a row.
template <typename Row>
inline constexpr std::string_view kRowName = {};
template <>
inline constexpr std::string_view kRowName<RobotSummary> = "robot";
template <>
inline constexpr std::string_view kRowName<TaskSummary> = "task";
template <>
inline constexpr std::string_view kRowName<PathSummary> = "path";
template <>
inline constexpr std::string_view kRowName<AttemptSummary> = "attempt";
template <>
inline constexpr std::string_view kRowName<DistributionSummary> = "distribution";
template <>
inline constexpr std::string_view kRowName<ServerStatus> = "status";
template <>
inline constexpr std::string_view kRowName<Explanation> = "explanation";
template <>
inline constexpr std::string_view kRowName<Eviction> = "eviction";
template <>
inline constexpr std::string_view kRowName<Retirement> = "retirement";
template <>
inline constexpr std::string_view kRowName<RobotRemoval> = "robot removal";
template <>
inline constexpr std::string_view kRowName<Job> = "job";
template <>
inline constexpr std::string_view kRowName<ClientUse> = "client";
template <>
inline constexpr std::string_view kRowName<BackupSummary> = "backup";
template <>
inline constexpr std::string_view kRowName<AuditEntry> = "audit entry";

template <typename Row>
concept AdminRow = !kRowName<Row>.empty();

/// A new row is instantiated in the source.
template <AdminRow Row>
std::string to_json(const Row& row);

/// The distribution of an Explanation may lack its mixture (weights, means, covariances null).
template <AdminRow Row>
Result<Row> row_from_json(std::string_view text);

/// The document of `kinship backup download --json`: `{"file", "bytes", "sha256"}`.
std::string download_to_json(const std::string& file, std::uint64_t bytes, const Digest& sha256);

}  // namespace kinship::json
