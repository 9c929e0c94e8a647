#pragma once

#include <string>

#include "proto/manual/usage.hpp"

namespace kinship::manual {

struct ManPageFrame {
  int section = 1;  ///< 1: a user's program, 8: a server
  std::string version, date;
  std::string see_also;  ///< "kinship(1), kinshipd(8)"
};

/// The manual page of a program, for man(1).
std::string man_page(const CommandUsage& program, const ManPageFrame& frame);

}  // namespace kinship::manual
