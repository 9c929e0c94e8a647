#pragma once

#include <cstddef>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/exit_code.hpp"
#include "proto/types/result.hpp"

namespace kinship::cli {

/// Writes an error after `command`. \return its exit code.
int refuse(std::string_view command, const Error& error, std::ostream& err);

/// Options of a listing.
struct ListOptions {
  std::string robot, task;  ///< filters; empty: all
  std::size_t limit = 0;    ///< rows in all; 0: every row
  bool json = false;
};

/// Calls `use` with each row of a list verb, page after page, until there are no more or
/// `options.limit` is reached.
/// \param use  returns false to stop.
/// \return an exit code; an error is on `err`, after `command`.
int for_each_row(link::Client& server, AdminVerb verb, const ListOptions& options,
                 std::string_view command, std::ostream& err,
                 const std::function<bool(const std::string& row)>& use);

/// A whole listing as one document, {"rows": [...]}.
int print_rows_as_json(link::Client& server, AdminVerb verb, const ListOptions& options,
                       std::string_view command, std::ostream& out, std::ostream& err);

/// The table of a list verb.
template <json::AdminRow Row>
struct Listing {
  AdminVerb verb;
  std::string command;                                            ///< named in messages
  tables::Table table;                                            ///< its headings
  std::function<std::vector<std::string>(const Row& row)> cells;  ///< one for each heading
};

/// Lists rows in a table, or as JSON. \return an exit code.
template <json::AdminRow Row>
int list_rows(link::Client& server, Listing<Row> listing, const ListOptions& options,
              std::ostream& out, std::ostream& err) {
  if (options.json)
    return print_rows_as_json(server, listing.verb, options, listing.command, out, err);
  std::optional<Error> broken;
  const int code = for_each_row(
      server, listing.verb, options, listing.command, err, [&](const std::string& text) {
        const Result<Row> row = json::row_from_json<Row>(text);
        if (row)
          listing.table.add_row(listing.cells(*row));
        else
          broken =
              Error{ErrorCode::Internal, "cannot read the server's row: " + row.error().message};
        return !broken;
      });
  if (code == kDone && broken)
    return refuse(listing.command, *broken, err);
  if (code == kDone)
    listing.table.print(out);
  return code;
}

/// The rows of a show verb. Empty with an exit code in `code` if there are none.
std::vector<std::string> show_rows(link::Client& server, AdminVerb verb,
                                   const std::string& argument, std::string_view command,
                                   std::ostream& err, int& code);

}  // namespace kinship::cli
