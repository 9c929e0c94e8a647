#include <ostream>

#include "client/cli/cell_text.hpp"
#include "client/cli/session.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/outbox.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/tables/table.hpp"

namespace kinship::cli {
namespace {

/// That of the server that the command line names, unless a folder is named.
/// \throws Failure(NotFound) if there is none: a look makes none.
link::Outbox open_outbox(const Session& session, const std::filesystem::path& named) {
  const std::filesystem::path folder =
      named.empty() ? link::default_outbox_folder(session.domain, session.host) : named;
  if (!std::filesystem::is_directory(folder / "pending"))
    throw Failure(ErrorCode::NotFound, "'" + folder.string() + "' is no outbox");
  return link::Outbox(folder);
}

std::shared_ptr<std::filesystem::path> add_folder(CLI::App& command) {
  auto folder = std::make_shared<std::filesystem::path>();
  command.add_option("--outbox", *folder, "Its folder (default: that of --server and --domain)")
      ->type_name("FOLDER");
  return folder;
}

int list_outbox(const Session& session, const link::Outbox& outbox) {
  const std::vector<OutboxEntry> entries = outbox.entries();
  if (session.json) {
    session.out << json::outbox_to_json(entries) << '\n';
    return kDone;
  }
  tables::Table table({"REPORT", "STATE", "WHY"});
  for (const OutboxEntry& entry : entries)
    table.add_row({entry.file, entry.state, entry.why});
  table.print(session.out);
  return kDone;
}

int resend(const Session& session, link::Outbox& outbox, const std::vector<std::string>& named) {
  std::vector<Uuid> reports;
  for (const std::string& text : named) {
    const std::optional<Uuid> report = Uuid::parse(text);
    if (!report)
      return refuse("outbox resend",
                    {ErrorCode::InvalidInput, "'" + text + "' is no UUID of a report"},
                    session.err);
    reports.push_back(*report);
  }
  if (named.empty())
    reports = outbox.reports_set_aside();
  std::size_t sent = 0;
  for (const Uuid& report : reports) {
    if (outbox.resend(report))
      ++sent;
    else if (!named.empty())
      return refuse("outbox resend",
                    {ErrorCode::NotFound, "report " + report.text() + " is not set aside"},
                    session.err);
  }
  session.out << count_text(sent, "report")
              << " pending again; the next program with this outbox sends them\n";
  return kDone;
}

}  // namespace

void add_outbox(CLI::App& app, Session& session) {
  CLI::App* group =
      add_group(app, session, "outbox", "Reports on this host that have no receipt (no server)");
  CLI::App* list =
      add_command(*group, "list", "Reports that wait, or are kept for somebody to look",
                  "kinship outbox list\n  kinship outbox list --outbox FOLDER --json");
  const auto list_folder = add_folder(*list);
  add_json(*list, session);
  on_run(*list, session, [&session, list_folder] {
    return list_outbox(session, open_outbox(session, *list_folder));
  });
  CLI::App* again = add_command(
      *group, "resend", "Offer reports that are set aside to the server again",
      "kinship outbox resend\n  kinship outbox resend 11d0b6f0-3b1c-4b7e-9f2a-0b7de01c5a77");
  const auto reports = std::make_shared<std::vector<std::string>>();
  again->add_option("reports", *reports, "Their UUIDs (default: all)")->type_name("UUID");
  const auto resend_folder = add_folder(*again);
  on_run(*again, session, [&session, reports, resend_folder] {
    link::Outbox outbox = open_outbox(session, *resend_folder);
    return resend(session, outbox, *reports);
  });
}

}  // namespace kinship::cli
