#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "proto/types/advice.hpp"
#include "proto/types/recorded_scene.hpp"
#include "proto/types/rehearsal.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/search_record.hpp"
#include "proto/types/transferability.hpp"

/// Values of proto/types for people.
namespace kinship::cli {

std::string axes_text(const TaskAxes& axes);  ///< "x y yaw"; "all" of them

/// The parts of a description that decide how experience is transferred to the robot: transfer
/// frame, task axes, held joints; one line each, values from the 13th column on.
void print_transfer(const RobotDescription& description, std::ostream& out);

/// "stays within a task space region: z 0.2..0.4 m, roll -0.15..0.15 rad": the coordinates that
/// have a bound; "inf" where there is none on one side.
std::string region_text(const TaskSpaceRegion& region);

/// The objects of a scene and its constraint; one line each, values from the 13th column on.
void print_scene(const RecordedScene& scene, std::ostream& out);

/// What explains an attempt: why it was not solved, the bodies in the way, what its goals touch;
/// one line each, values from the 13th column on.
void print_search(const SearchRecord& search, std::ostream& out);

/// "31.2 ms, 4.21 long, hand 1.62 m, clearance 0.034 m (mean of 12)".
std::string means_text(const PathMeans& means);

/// "1.40 by time, 2.10 by checks (best without experience none, with it ways)".
std::string worth_text(const Worth& worth);

/// A server's rehearsal for people: its queries, a table of each guide's cost in processor time and
/// in collision checks, and the worth of the experience. "UNIFORM / GUIDED" is the mean without a
/// guide over that with it: above 1 the guide saves.
/// \param rehearsal  missing: there is none yet; the text says how to begin it.
void print_rehearsal(const std::optional<Rehearsal>& rehearsal, std::ostream& out);

}  // namespace kinship::cli
