#pragma once

#include <yaml-cpp/yaml.h>

#include <string_view>

namespace kinship::moveit {

/// A message of ROS 2 as a middleware serialises it (CDR of DDS, encapsulation first), as the
/// document that `ros2 topic echo` would write. Untrusted bytes.
/// \param message  of members_of().
/// \throws Failure(InvalidInput) that names the member for bytes that are no such message,
///         Failure(TooLarge) above kMaxCdrValues values.
/// Source: OMG, DDS-RTPS 2.3, section 10; CORBA 3.3, part 2, section 9.3.
YAML::Node read_cdr(std::string_view bytes, std::string_view message);

inline constexpr std::size_t kMaxCdrValues = 500'000;  ///< numbers and texts of a message

}  // namespace kinship::moveit
