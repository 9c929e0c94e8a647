#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/store/store.hpp"
#include "server/store/values/bytes.hpp"

/// How a robot stands in its row.
namespace kinship::store {

/// Bit 0 is x, bit 5 yaw.
std::int64_t mask_of(const TaskAxes& axes);
TaskAxes axes_of(std::int64_t mask);

/// Whether it has a row in `robot_geometry`, which is then under its checksum.
bool has_geometry_row(const RobotRecord& robot);

/// The checksum of all of a robot.
/// \param T_tip_transfer, mesh_solids  as stored: a pose does not come back from its 7 numbers to
/// the last bit.
std::uint32_t robot_crc(const RobotRecord& robot, Bytes T_tip_transfer, Bytes mesh_solids);

/// Takes what was stored as blobs into a robot, the rest of which is read.
/// \param robot  without T_tip_transfer and mesh_solids.
/// \return nothing if the checksum is another one, or they are none.
std::optional<RobotRecord> complete_robot(RobotRecord robot, Bytes T_tip_transfer,
                                          Bytes mesh_solids, std::int64_t crc);

/// InvalidInput if T_tip_transfer does not come back from its row.
std::optional<Error> find_pose_fault(const RobotDescription& description);

/// A known robot as it is written anew when better geometry of it comes: its label stays, and when
/// it was registered.
/// \param before  as it is now; nothing: it is not there, or damaged.
/// \return nothing, and nothing is to be written, if `better` is not one revision ahead of it.
std::optional<RobotRecord> with_better_geometry(const std::optional<RobotRecord>& before,
                                                RobotRecord better);

/// The label of a removed robot's row, which nobody can register: labels have no blanks. It says
/// that the robot is removed, to whoever reads the row or the index of labels alone.
std::string removed_label(const Digest& robot);
bool is_removed_label(std::string_view label);

/// Conflict, and what can be done.
Error label_conflict(const std::string& label);

}  // namespace kinship::store
