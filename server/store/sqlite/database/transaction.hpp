#pragma once

#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// A transaction, rolled back on destruction unless committed.
class Transaction {
 public:
  enum class Kind {
    Read,  ///< a snapshot, taken by the first statement
    Write  ///< BEGIN IMMEDIATE: takes the write lock at once
  };
  Transaction(Database& database, Kind kind);
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction();

  void commit();

 private:
  Database* database_;
};

/// A part of a write transaction that can be undone alone; undone on destruction unless kept.
/// Nested savepoints must end in reverse order: the youngest first.
class Savepoint {
 public:
  explicit Savepoint(Database& database);
  Savepoint(const Savepoint&) = delete;
  Savepoint& operator=(const Savepoint&) = delete;
  ~Savepoint();

  void keep();

 private:
  Database* database_;
  bool open_ = true;
};

}  // namespace kinship::store
