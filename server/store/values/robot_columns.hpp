#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/store/store.hpp"
#include "server/store/values/bytes.hpp"

/// A robot in its row.
namespace kinship::store {

/// Bit 0 is x, bit 5 yaw.
std::int64_t mask_of(const TaskAxes& axes);
TaskAxes axes_of(std::int64_t mask);

/// Whether the robot has a row in `robot_geometry`, which its checksum then covers.
bool has_geometry_row(const RobotRecord& robot);

/// The checksum of a whole robot.
/// \param T_tip_transfer, mesh_solids  as stored: a pose read from its 7 numbers may differ in its
///                                     last bit.
std::uint32_t robot_crc(const RobotRecord& robot, Bytes T_tip_transfer, Bytes mesh_solids);

/// Adds the values stored as blobs to a robot.
/// \param robot  without T_tip_transfer and mesh_solids.
/// \return nothing if the checksum is wrong or a blob cannot be decoded.
std::optional<RobotRecord> complete_robot(RobotRecord robot, Bytes T_tip_transfer,
                                          Bytes mesh_solids, std::int64_t crc);

/// InvalidInput if T_tip_transfer could not be read back from its row.
std::optional<Error> find_pose_fault(const RobotDescription& description);

/// The new row of a known robot with better geometry; its label and registration time stay.
/// \param before  the current row; nothing: missing or damaged.
/// \return nothing if `better` is not one revision ahead of `before`; then nothing is to be
///         written.
std::optional<RobotRecord> with_better_geometry(const std::optional<RobotRecord>& before,
                                                RobotRecord better);

/// The label of a removed robot's row. It cannot be registered, as labels have no blanks, and marks
/// the robot as removed in the row and in the index of labels.
std::string removed_label(const Digest& robot);
bool is_removed_label(std::string_view label);

/// Conflict, with advice.
Error label_conflict(const std::string& label);

}  // namespace kinship::store
