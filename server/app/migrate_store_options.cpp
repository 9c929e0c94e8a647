#include "server/app/migrate_store_options.hpp"

#include <CLI/CLI.hpp>
#include <memory>

namespace kinship::app {
namespace {

constexpr const char* kMigrateStoreFooter =
    R"(The server of the source may go on serving: then what is there is copied, and the exit code is 1. Stop it and run
the same command again: it copies what came since, compares each row, and from then on the target may be
served, the source not any more. Whatever ends it, the same command goes on. A password belongs into
~/.pgpass. Exit codes: 0 done, 1 not done yet or failed, 2 wrong usage, 3 no such store.

Examples:
  kinshipd migrate-store --from fleet.db --to 'postgresql://kinship@db1,db2/fleet'
  kinshipd migrate-store --from 'postgresql://kinship@db1,db2/fleet' --to fleet.db
  kinshipd migrate-store --give-up --to 'postgresql://kinship@db1,db2/fleet'    removes what was copied
  kinshipd migrate-store --give-up --from fleet.db       it was moved, but shall be served again)";

}  // namespace

void add_migrate_store(CLI::App& app, std::optional<MigrateStoreOptions>& options) {
  CLI::App* const command =
      app.add_subcommand("migrate-store",
                         "Move a store into a PostgreSQL database, or out of one, row by row")
          ->configurable(false);
  command->footer(kMigrateStoreFooter);
  const auto filled = std::make_shared<MigrateStoreOptions>();
  CLI::Option* const from =
      command->add_option("--from", filled->from, "The store that is there")->type_name("FILE|URL");
  CLI::Option* const to =
      command->add_option("--to", filled->to, "Where it shall be; nothing may be there yet")
          ->type_name("FILE|URL");
  command->add_flag("--give-up", filled->give_up,
                    "End a move: remove what was copied to --to, or let --from be served again");
  command->callback([&options, filled, from, to] {
    if (filled->give_up && from->count() + to->count() == 0)
      throw CLI::RequiredError("--give-up needs --from or --to: it");
    if (!filled->give_up)
      for (const CLI::Option* const option : {from, to})
        if (option->count() == 0)
          throw CLI::RequiredError(option->get_name());
    options = *filled;
  });
}

}  // namespace kinship::app
