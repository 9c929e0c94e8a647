#include <unistd.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <iterator>
#include <ostream>

#include "client/cli/cell_text.hpp"
#include "client/cli/session.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
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

/// Which of the reports that do not wait a command is about.
struct Chosen {
  std::vector<std::string> named;  ///< UUIDs
  bool is_rejected = false;        ///< none named: those that are rejected, not those set aside
  bool is_all = false;             ///< instead those that were acknowledged, or of older stores
  std::filesystem::path outbox;    ///< its folder; empty: that of the server
};

/// \param all  what --all is about.
std::shared_ptr<Chosen> add_choice(CLI::App& command, const std::string& all) {
  auto chosen = std::make_shared<Chosen>();
  command
      .add_option("reports", chosen->named,
                  "Their UUIDs, or eight digits or more of each (default: all that are set "
                  "aside)")
      ->type_name("UUID");
  command.add_flag("--rejected", chosen->is_rejected,
                   "All that the server refused or that are damaged");
  command.add_flag("--all", chosen->is_all, all)->excludes("--rejected")->excludes("reports");
  command.add_option("--outbox", chosen->outbox, kOutboxHelp)->type_name("FOLDER");
  return chosen;
}

/// The reports that are kept apart.
std::vector<Uuid> kept_in(const link::Outbox& outbox) {
  std::vector<Uuid> kept = outbox.reports_set_aside();
  std::ranges::copy(outbox.reports_rejected(), std::back_inserter(kept));
  return kept;
}

/// The report of a UUID, or the only one that is kept apart and begins with its first digits.
/// \throws Failure(InvalidInput or NotFound)
Uuid report_named(const std::string& text, const link::Outbox& outbox) {
  constexpr std::size_t kMinDigits = 8;  // as of reports at a server
  if (const std::optional<Uuid> report = Uuid::parse(text))
    return *report;
  if (text.size() < kMinDigits || text.find_first_not_of("0123456789abcdef-") != std::string::npos)
    throw Failure(ErrorCode::InvalidInput, "'" + text + "' is no UUID of a report, nor its first " +
                                               std::to_string(kMinDigits) + " digits or more");
  std::vector<Uuid> alike = kept_in(outbox);
  std::erase_if(alike, [&](const Uuid& each) { return !each.text().starts_with(text); });
  if (alike.empty())
    throw Failure(ErrorCode::NotFound, "report " + text + " is neither set aside nor rejected");
  if (alike.size() > 1)
    throw Failure(ErrorCode::InvalidInput,
                  std::to_string(alike.size()) + " reports begin with '" + text + "'");
  return alike.front();
}

/// Calls `act` on each chosen report; \return how many there were.
/// \throws Failure(InvalidInput or NotFound) naming the one that is no UUID or is not kept apart.
std::size_t for_each_chosen(const Chosen& chosen, const link::Outbox& outbox,
                            const std::function<bool(const Uuid&)>& act) {
  std::size_t count = 0;
  for (const std::string& text : chosen.named) {
    const Uuid report = report_named(text, outbox);
    if (!act(report))
      throw Failure(ErrorCode::NotFound,
                    "report " + report.text() + " is neither set aside nor rejected");
    ++count;
  }
  if (chosen.named.empty())
    for (const Uuid& report :
         chosen.is_rejected ? outbox.reports_rejected() : outbox.reports_set_aside())
      count += act(report) ? 1U : 0U;
  return count;
}

void tell_resent(const Session& session, std::size_t reports) {
  session.out << count_text(reports, "report")
              << " pending again; the next program with this outbox sends them\n";
}

int resend(const Session& session, const Chosen& chosen) {
  link::Outbox outbox = open_outbox(session, chosen.outbox);
  if (chosen.is_all)
    tell_resent(session, outbox.resend_acknowledged());
  else
    tell_resent(session, for_each_chosen(chosen, outbox, [&](const Uuid& report) {
                  return outbox.resend(report);
                }));
  if (const std::string kept = describe(outbox.kept_of_older_stores()); !kept.empty())
    session.err << "outbox: " << kept << '\n';
  return kDone;
}

std::size_t count_of(const std::vector<link::KeptReports>& stores) {
  std::size_t count = 0;
  for (const link::KeptReports& each : stores)
    count += each.reports;
  return count;
}

void tell_dropped(const Session& session, std::size_t reports, bool is_confirmed) {
  session.out << count_text(reports, "report")
              << (is_confirmed ? " deleted\n" : " would be deleted for good: say --yes\n");
}

int drop(const Session& session, const Chosen& chosen, bool is_confirmed) {
  link::Outbox outbox = open_outbox(session, chosen.outbox);
  if (chosen.is_all) {
    const std::vector<link::KeptReports> stores = outbox.kept_of_older_stores();
    tell_dropped(session, is_confirmed ? outbox.drop_of_older_stores(stores) : count_of(stores),
                 is_confirmed);
    return kDone;
  }
  const std::vector<Uuid> kept = kept_in(outbox);
  const std::size_t dropped = for_each_chosen(chosen, outbox, [&](const Uuid& report) {
    return is_confirmed ? outbox.drop(report) : std::ranges::count(kept, report) > 0;
  });
  tell_dropped(session, dropped, is_confirmed);
  return kDone;
}

/// Lists them, and asks a person what becomes of those of older stores.
int look(const Session& session, const std::filesystem::path& folder) {
  link::Outbox outbox = open_outbox(session, folder);
  list_outbox(session, outbox);
  const std::vector<link::KeptReports> stores = outbox.kept_of_older_stores();
  const std::string kept = describe(stores);
  if (kept.empty() || !is_terminal(session.out) || isatty(STDIN_FILENO) != 1)
    return kDone;
  session.out << kept << ".\nSend them, delete them, or leave them there? [send/delete/leave] "
              << std::flush;
  std::string answer;
  std::getline(std::cin, answer);
  if (answer == "send")
    tell_resent(session, outbox.resend_acknowledged());
  else if (answer == "delete")
    tell_dropped(session, outbox.drop_of_older_stores(stores), true);
  else
    session.out << "They are left there.\n";
  return kDone;
}

}  // namespace

void tell_of_older_reports(const Session& session, link::Client& server) {
  try {
    const auto folder = link::default_outbox_folder(session.domain, session.host);
    if (!std::filesystem::is_directory(folder / "pending"))
      return;
    const auto status = link::row_of<ServerStatus>(server, AdminRequest());
    if (!status)
      return;
    const link::Outbox outbox(folder);
    if (const auto kept = describe(outbox.kept_beside(status->store_epoch)); !kept.empty())
      session.err << "outbox: " << kept << '\n';
  } catch (const Failure&) {  // there is none that this user may look into
  }
}

void add_outbox(CLI::App& app, Session& session) {
  CLI::App* group = add_group(app, session, "outbox",
                              "Reports on this host without a receipt or of an older store; "
                              "alone: list them, ask on a terminal");
  const auto folder = std::make_shared<std::filesystem::path>();
  group->add_option("--outbox", *folder, kOutboxHelp)->type_name("FOLDER");
  group->require_subcommand(0, 1);
  group->callback([&session, group, folder] {
    if (group->get_subcommands().empty())
      session.command = [&session, folder] { return look(session, *folder); };
  });
  CLI::App* list = add_command(*group, "list", "Reports that are waiting, set aside or rejected",
                               "kinship outbox list\n  kinship outbox list --outbox FOLDER --json");
  const auto list_folder = std::make_shared<std::filesystem::path>();
  list->add_option("--outbox", *list_folder, kOutboxHelp)->type_name("FOLDER");
  add_json(*list, session);
  on_run(*list, session, [&session, list_folder] {
    return list_outbox(session, open_outbox(session, *list_folder));
  });
  CLI::App* again =
      add_command(*group, "resend",
                  "Offer reports that are set aside, rejected or acknowledged to the server again",
                  "kinship outbox resend\n  kinship outbox resend --rejected\n"
                  "  kinship outbox resend --all          to a store that lost them\n"
                  "  kinship outbox resend 11d0b6f0-3b1c-4b7e-9f2a-0b7de01c5a77");
  const auto again_chosen = add_choice(
      *again, "Instead all that are kept of older stores or were acknowledged by this one");
  on_run(*again, session, [&session, again_chosen] { return resend(session, *again_chosen); });
  CLI::App* away =
      add_command(*group, "drop", "Delete reports that are set aside, rejected or of older stores",
                  "kinship outbox drop --rejected --yes\n"
                  "  kinship outbox drop --all --yes      of a store that was given up\n"
                  "  kinship outbox drop 11d0b6f0-3b1c-4b7e-9f2a-0b7de01c5a77 --yes");
  const auto is_confirmed = std::make_shared<bool>(false);
  away->add_flag("--yes", *is_confirmed, "Delete them; without it only said");
  const auto away_chosen = add_choice(*away, "Instead all that are kept of older stores");
  on_run(*away, session, [&session, away_chosen, is_confirmed] {
    return drop(session, *away_chosen, *is_confirmed);
  });
}

}  // namespace kinship::cli
