#include <algorithm>
#include <functional>
#include <iterator>
#include <ostream>

#include "client/cli/cell_text.hpp"
#include "client/cli/session.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/outbox.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/tables/table.hpp"

namespace kinship::cli {
namespace {

constexpr const char* kOutboxHelp = "Its folder (default: that of --server and --domain)";

/// That of the server that the command line names, unless a folder is named.
/// \throws Failure(NotFound) if there is none: a look makes none.
link::Outbox open_outbox(const Session& session, const std::filesystem::path& named) {
  const std::filesystem::path folder =
      named.empty() ? link::default_outbox_folder(session.domain, session.host) : named;
  if (!std::filesystem::is_directory(folder / "pending"))
    throw Failure(ErrorCode::NotFound, "'" + folder.string() + "' is no outbox");
  return link::Outbox(folder);
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

/// Which of the reports that are set aside or rejected a command is about.
struct Chosen {
  std::vector<std::string> named;  ///< UUIDs
  bool is_rejected = false;        ///< none named: those that are rejected, not those set aside
  std::filesystem::path outbox;    ///< its folder; empty: that of the server
};

std::shared_ptr<Chosen> add_choice(CLI::App& command) {
  auto chosen = std::make_shared<Chosen>();
  command.add_option("reports", chosen->named, "Their UUIDs (default: all that are set aside)")
      ->type_name("UUID");
  command.add_flag("--rejected", chosen->is_rejected,
                   "All that the server refused or that are damaged");
  command.add_option("--outbox", chosen->outbox, kOutboxHelp)->type_name("FOLDER");
  return chosen;
}

/// Calls `act` on each chosen report; \return how many there were.
/// \throws Failure(InvalidInput or NotFound) naming the one that is no UUID or is not kept apart.
std::size_t for_each_chosen(const Chosen& chosen, const link::Outbox& outbox,
                            const std::function<bool(const Uuid&)>& act) {
  std::size_t count = 0;
  for (const std::string& text : chosen.named) {
    const std::optional<Uuid> report = Uuid::parse(text);
    if (!report)
      throw Failure(ErrorCode::InvalidInput, "'" + text + "' is no UUID of a report");
    if (!act(*report))
      throw Failure(ErrorCode::NotFound,
                    "report " + report->text() + " is neither set aside nor rejected");
    ++count;
  }
  if (chosen.named.empty())
    for (const Uuid& report :
         chosen.is_rejected ? outbox.reports_rejected() : outbox.reports_set_aside())
      count += act(report) ? 1 : 0;
  return count;
}

int resend(const Session& session, const Chosen& chosen) {
  link::Outbox outbox = open_outbox(session, chosen.outbox);
  const std::size_t sent =
      for_each_chosen(chosen, outbox, [&](const Uuid& report) { return outbox.resend(report); });
  session.out << count_text(sent, "report")
              << " pending again; the next program with this outbox sends them\n";
  return kDone;
}

int drop(const Session& session, const Chosen& chosen, bool is_confirmed) {
  link::Outbox outbox = open_outbox(session, chosen.outbox);
  std::vector<Uuid> kept = outbox.reports_set_aside();
  std::ranges::copy(outbox.reports_rejected(), std::back_inserter(kept));
  const std::size_t dropped = for_each_chosen(chosen, outbox, [&](const Uuid& report) {
    return is_confirmed ? outbox.drop(report) : std::ranges::count(kept, report) > 0;
  });
  session.out << count_text(dropped, "report")
              << (is_confirmed ? " deleted\n" : " would be deleted for good: say --yes\n");
  return kDone;
}

}  // namespace

void add_outbox(CLI::App& app, Session& session) {
  CLI::App* group =
      add_group(app, session, "outbox", "Reports on this host that have no receipt (no server)");
  CLI::App* list = add_command(*group, "list", "Reports that are waiting, set aside or rejected",
                               "kinship outbox list\n  kinship outbox list --outbox FOLDER --json");
  const auto list_folder = std::make_shared<std::filesystem::path>();
  list->add_option("--outbox", *list_folder, kOutboxHelp)->type_name("FOLDER");
  add_json(*list, session);
  on_run(*list, session, [&session, list_folder] {
    return list_outbox(session, open_outbox(session, *list_folder));
  });
  CLI::App* again = add_command(*group, "resend",
                                "Offer reports that are set aside or rejected to the server again",
                                "kinship outbox resend\n  kinship outbox resend --rejected\n"
                                "  kinship outbox resend 11d0b6f0-3b1c-4b7e-9f2a-0b7de01c5a77");
  on_run(*again, session,
         [&session, chosen = add_choice(*again)] { return resend(session, *chosen); });
  CLI::App* away = add_command(*group, "drop", "Delete reports that are set aside or rejected",
                               "kinship outbox drop --rejected --yes\n"
                               "  kinship outbox drop 11d0b6f0-3b1c-4b7e-9f2a-0b7de01c5a77 --yes");
  const auto is_confirmed = std::make_shared<bool>(false);
  away->add_flag("--yes", *is_confirmed, "Delete them; without it only said");
  on_run(*away, session, [&session, chosen = add_choice(*away), is_confirmed] {
    return drop(session, *chosen, *is_confirmed);
  });
}

}  // namespace kinship::cli
