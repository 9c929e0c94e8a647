#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

#include "client/arguments/selection_arguments.hpp"
#include "client/link/client.hpp"
#include "proto/types/distribution.hpp"

namespace kinship::cli {

/// A distribution as a command line names it: by task, robot and sources, or by its id.
struct DistributionQuery {
  std::string task;
  std::string robot;      ///< a label, or the beginning of a digest
  std::string placement;  ///< T_task_base, "x y z qx qy qz qw"; empty: the robot's newest
  std::string profile = "default";
  arguments::SelectionArguments selection;
  std::chrono::milliseconds wait{30000};
  std::string id;  ///< beginning of a distribution's id, instead of the rest; may be empty
};

/// Fetches the distribution of a query; the server makes it if needed.
/// \param command       named in messages.
/// \param allow_failed  whether a failed distribution is an answer.
/// \return empty with an exit code in `code` if there is none: kNotFound without experience,
///         kFailed if it is still pending after the wait.
std::optional<Distribution> fetch_query(link::Client& server, const DistributionQuery& query,
                                        std::string_view command, bool allow_failed,
                                        std::ostream& err, int& code);

/// The id, or its beginning, of a query's distribution; fetched unless the query has it.
/// \return empty with an exit code in `code` if there is none.
std::string id_of_query(link::Client& server, const DistributionQuery& query,
                        std::string_view command, bool allow_failed, std::ostream& err, int& code);

}  // namespace kinship::cli
