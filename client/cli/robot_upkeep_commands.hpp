#pragma once

#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

/// Registered robots that get another label, or are taken out.
namespace kinship::cli {

/// `robots rename`: another label for a robot; the one it had is free from then on.
/// \param robot  its label or the beginning of its digest.
int rename_robot(link::Client& server, const std::string& robot, const std::string& label,
                 bool json, std::ostream& out, std::ostream& err);

/// `robots remove`: a robot without attempts is deleted; the paths of another are retired.
/// \param confirmed  false: of a robot with attempts it is said what would happen, and
///                   kWrongUsage returned.
int remove_robot(link::Client& server, const std::string& robot, bool confirmed, bool json,
                 std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
