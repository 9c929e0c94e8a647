#include <chrono>

#include "client/arguments/number_range.hpp"
#include "client/cli/backup_commands.hpp"
#include "client/cli/console_command.hpp"
#include "client/cli/listings.hpp"
#include "client/cli/session.hpp"
#include "client/cli/show_commands.hpp"
#include "client/cli/watch_command.hpp"

namespace kinship::cli {
namespace {

constexpr int kMaxShownClients = 100'000;

void add_status(CLI::App& app, Session& session) {
  CLI::App* command = add_command(app, "status", "Server, store, queues, counters",
                                  "kinship status --json\n  kinship status --clients -o wide");
  const auto clients = std::make_shared<bool>(false);
  command->add_flag("--clients", *clients,
                    "Who takes how much of the server, most first; with --limit only so many");
  const auto limit = std::make_shared<std::size_t>(0);
  command->add_option("--limit", *limit, "Clients at most; 0: all")
      ->check(arguments::between(0, kMaxShownClients))
      ->needs("--clients");
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, clients, limit](link::Client& server) {
    if (*clients)
      return list_clients(server, *limit, session.json, session.out, session.err);
    return show_status(server, session.json, session.out, session.err);
  });
}

void add_download(CLI::App& backup, Session& session) {
  const auto options = std::make_shared<DownloadOptions>();
  CLI::App* command = add_command(
      backup, "download",
      "Fetch a backup from the server into a file here, with its digest checked",
      "kinship backup download monday.db --to /mnt/safe/monday.db\n"
      "  kinship backup download monday.db       again, after it was interrupted: it goes on");
  command->add_option("name", options->name, "As 'kinship backup list' names it")
      ->required()
      ->type_name("NAME");
  command
      ->add_option("--to", options->to,
                   "New file here; default: of that name, in this folder. Until it is whole it is "
                   "called FILE.part, where the next download goes on")
      ->type_name("FILE");
  const auto patience_s = std::make_shared<int>(60);
  constexpr int kDay_s = 86'400;
  command
      ->add_option("--patience", *patience_s,
                   "Seconds to go on asking a server that does not answer")
      ->check(arguments::between(1, kDay_s))
      ->capture_default_str();
  add_json(*command, session);
  on_run(*command, session, [&session, options, patience_s] {
    options->json = session.json;
    options->progress = session.shows_progress();
    options->patience = std::chrono::seconds(*patience_s);
    return session.with_server([&](link::Client& server) {
      return download_backup(server, *options, session.out, session.err);
    });
  });
}

void add_backup(CLI::App& app, Session& session) {
  const auto options = std::make_shared<BackupOptions>();
  CLI::App* command = add_command(app, "backup", "Copy the store of the running server into a file",
                                  "kinship backup monday.db\n  kinship backup monday.db --no-wait\n"
                                  "  kinship backup list\n"
                                  "  kinship backup download monday.db --to /mnt/safe/monday.db");
  CLI::Option* name =
      command
          ->add_option("name", options->name,
                       "New file in the server's folder of backups (kinshipd --backup-folder), "
                       "which the server writes: a bare name of A-Z a-z 0-9 _ . -, never one that "
                       "is there")
          ->type_name("NAME");
  CLI::Option* no_wait =
      command->add_flag("!--no-wait", options->wait, "Print the job and leave it to itself");
  const auto waiting = add_job_wait(*command, session);
  command->get_option("--wait")->excludes(no_wait);
  add_json(*command, session);
  command->require_subcommand(0, 1);
  add_listings(*command, session);
  add_download(*command, session);
  command->callback([&session, command, name, options, waiting] {
    if (!command->get_subcommands().empty())
      return;
    if (name->empty())
      throw CLI::RequiredError("name");
    session.command = [&session, options, waiting] {
      options->waiting = waiting();
      options->json = session.json;
      return session.with_server([&](link::Client& server) {
        return back_up(server, *options, session.out, session.err);
      });
    };
  });
}

void add_watch(CLI::App& app, Session& session) {
  const auto options = std::make_shared<WatchOptions>();
  CLI::App* command = add_command(
      app, "watch", "Reports, fetches, fits and refusals as they happen, until Control-C",
      "kinship watch\n  kinship watch --task box_to_shelf --json\n"
      "  kinship watch --every 60 >> fleet.log      rates and what guidance brought, each minute");
  command->add_option("--task", options->task, "Only events of this task")->type_name("TASK");
  command
      ->add_option("--robot", options->robot, "Only events of this robot: label or digest prefix")
      ->type_name("ROBOT");
  const auto every_s = std::make_shared<int>(0);
  constexpr int kDay_s = 86'400;
  CLI::Option* every =
      command
          ->add_option("--every", *every_s,
                       "Seconds between lines with rates and with what guidance brought; without, "
                       "a terminal has them in its last line")
          ->check(arguments::between(1, kDay_s));
  add_json(*command, session, "One JSON document a line on standard output, one an event");
  command->get_option("--json")->excludes(every);
  on_run(*command, session, [&session, options, every_s] {
    options->json = session.json;
    options->every = std::chrono::seconds(*every_s);
    options->place = session.host + ", domain " + std::to_string(session.domain);
    const sigset_t until = block_end_signals();
    return session.with_server([&](link::Client& server) {
      return watch_events(server, *options, until, session.out, session.err);
    });
  });
}

void add_audit(CLI::App& app, Session& session) {
  const auto options = std::make_shared<AuditOptions>();
  const auto since = std::make_shared<std::string>();
  CLI::App* command =
      add_command(app, "audit", "The audit log: who changed what, or was refused; newest first",
                  "kinship audit --since 90m\n  kinship audit --who anna --json");
  command->add_option("--who", options->who, "Only of this name in a certificate");
  add_since(*command, *since);
  constexpr std::size_t kMostRows = 1'000'000'000;
  command->add_option("--limit", options->limit, "Rows at most (default: all)")
      ->check(CLI::Range(std::size_t{0}, kMostRows));
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, options, since](link::Client& server) {
    options->json = session.json;
    options->since_ms = since_ms(*since);
    return list_audit(server, *options, session.out, session.err);
  });
}

void add_console(CLI::App& app, Session& session) {
  CLI::App* command = add_command(
      app, "console", "The link to the server's live console, for a browser on this machine",
      "kinship console\n  xdg-open \"$(kinship console)\"");
  const auto file = std::make_shared<std::filesystem::path>();
  command
      ->add_option("--file", *file,
                   "File with the link, which admits to all that the server knows; default: "
                   "STORE.console of the store that the server names")
      ->type_name("FILE");
  on_run_with_server(*command, session, [&session, file](link::Client& server) {
    return print_console_link(server, *file, session.out, session.err);
  });
}

}  // namespace

void add_server_commands(CLI::App& app, Session& session) {
  add_status(app, session);
  add_backup(app, session);
  add_watch(app, session);
  add_audit(app, session);
  add_console(app, session);
}

void add_jobs(CLI::App& app, Session& session) {
  constexpr const char* kJob = "Its id, or the beginning of it";
  CLI::App* jobs = add_group(app, session, "jobs", "What takes the server long: backups, exports");
  const auto id = std::make_shared<std::string>();
  CLI::App* wait =
      add_command(*jobs, "wait", "Wait for the end of a job", "kinship jobs wait 3f9a0c11");
  wait->add_option("job", *id, kJob)->required()->type_name("JOB");
  const auto waiting = add_job_wait(*wait, session);
  add_json(*wait, session);
  on_run_with_server(*wait, session, [&session, id, waiting](link::Client& server) {
    return wait_for_job(server, *id, waiting(), session.json, session.out, session.err);
  });
  add_one(*jobs, session,
          {"cancel", "job", kJob, "End a job early", "kinship jobs cancel 3f9a0c11"}, cancel_job);
}

}  // namespace kinship::cli
