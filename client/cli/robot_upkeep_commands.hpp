#pragma once

#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

/// Commands that rename and remove registered robots.
namespace kinship::cli {

/// `robots rename`: another label for a robot; its old label becomes free.
/// \param robot  its label or the beginning of its digest.
int rename_robot(link::Client& server, const std::string& robot, const std::string& label,
                 bool json, std::ostream& out, std::ostream& err);

/// `robots remove`: deletes a robot without attempts; otherwise retires its paths.
/// \param confirmed  false: for a robot with attempts, prints the effect and returns kWrongUsage.
int remove_robot(link::Client& server, const std::string& robot, bool confirmed, bool json,
                 std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
