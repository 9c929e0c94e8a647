#include "server/store/sqlite/database/transaction.hpp"

#include <sqlite3.h>

namespace kinship::store {

Transaction::Transaction(Database& database, Kind kind) : database_(&database) {
  database.cached(kind == Kind::Write ? "BEGIN IMMEDIATE" : "BEGIN")->run();
}

Transaction::~Transaction() {
  // SQLite may have rolled back by itself, on a full disk for instance. If this fails too, the
  // connection is closed soon: nothing to add here.
  if (database_->in_transaction())
    sqlite3_exec(&database_->connection(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() { database_->cached("COMMIT")->run(); }

Savepoint::Savepoint(Database& database) : database_(&database) {
  database.cached("SAVEPOINT part")->run();
}

Savepoint::~Savepoint() {
  if (open_ && database_->in_transaction())
    sqlite3_exec(&database_->connection(), "ROLLBACK TO part; RELEASE part", nullptr, nullptr,
                 nullptr);
}

void Savepoint::keep() {
  database_->cached("RELEASE part")->run();
  open_ = false;
}

}  // namespace kinship::store
