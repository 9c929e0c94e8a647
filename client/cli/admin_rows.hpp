#pragma once

#include <cstddef>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "client/link/client.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/exit_code.hpp"
#include "proto/types/result.hpp"

namespace kinship::cli {

/// Says what went wrong, after `command`. \return its exit code.
int refuse(std::string_view command, const Error& error, std::ostream& err);

/// How a listing is wanted.
struct ListOptions {
  std::string robot, task;  ///< filters; empty: all
  std::size_t limit = 0;    ///< rows in all; 0: every row
  bool json = false;
};

/// Calls `use` with each row of a list verb, page after page, until there are no more or
/// `options.limit` is reached.
/// \param use  returns false to stop.
/// \return an exit code; what went wrong is on `err`, after `command`.
int for_each_row(link::Client& server, AdminVerb verb, const ListOptions& options,
                 std::string_view command, std::ostream& err,
                 const std::function<bool(const std::string& row)>& use);

/// A whole listing as one document, {"rows": [...]}.
int print_rows_as_json(link::Client& server, AdminVerb verb, const ListOptions& options,
                       std::string_view command, std::ostream& out, std::ostream& err);

/// The rows of a show verb. Empty with an exit code in `code` if there are none.
std::vector<std::string> show_rows(link::Client& server, AdminVerb verb,
                                   const std::string& argument, std::string_view command,
                                   std::ostream& err, int& code);

}  // namespace kinship::cli
