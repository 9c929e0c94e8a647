#include "client/cli/console_command.hpp"

#include <ostream>
#include <utility>

#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
#include "proto/files/file.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/types/exit_code.hpp"

namespace kinship::cli {
namespace {

constexpr const char* kCommand = "console";
constexpr std::size_t kMaxLinkBytes = 4096;

}  // namespace

int print_console_link(link::Client& server, std::filesystem::path file, std::ostream& out,
                       std::ostream& err) {
  if (file.empty()) {
    const auto row = link::first_row_of(server, {.verb = AdminVerb::Status});
    if (!row)
      return refuse(kCommand, row.error(), err);
    file = json::row_from_json<ServerStatus>(*row).value_or_throw().store_file + ".console";
  }
  if (std::error_code none; !std::filesystem::exists(file, none))
    return refuse(kCommand,
                  {ErrorCode::NotFound,
                   "no file '" + file.string() +
                       "': 'kinshipd --console 127.0.0.1:9480' serves a console and writes it; it "
                       "lies on the server's machine (--file names another place)"},
                  err);
  try {
    out << files::read_regular_file(file, kMaxLinkBytes);
  } catch (const Failure& failure) {
    return refuse(kCommand, failure.error(), err);
  }
  return kDone;
}

}  // namespace kinship::cli
