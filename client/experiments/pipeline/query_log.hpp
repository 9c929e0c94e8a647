#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <vector>

#include "client/experiments/pipeline/query_result.hpp"

namespace kinship::experiments {

/// The results of a study on disk, one JSON document a line, each line whole before the next query
/// begins: a run that was interrupted goes on where it was. May be shared between threads.
class QueryLog {
 public:
  /// Opens the file, or makes it. A last line that an interruption cut off is dropped.
  /// \throws Failure(InvalidInput) that names file and line if it holds anything else than results;
  ///         Failure(Storage) if it cannot be written.
  explicit QueryLog(std::filesystem::path file);

  /// \return whether there is a result of this query.
  /// \throws Failure(Conflict) if it was guided by another distribution.
  bool has(const QueryKey& key, const std::optional<Digest>& distribution) const;

  /// \throws Failure(Storage) if it cannot be written.
  void add(const QueryResult& result);

  std::vector<QueryResult> results() const;  ///< by key

 private:
  const std::filesystem::path file_;
  mutable std::mutex mutex_;  // guards what follows
  std::map<QueryKey, QueryResult> results_;
  std::ofstream stream_;
};

/// The results in a file. \throws Failure as QueryLog's constructor says, NotFound without a file.
std::vector<QueryResult> read_query_results(const std::filesystem::path& file);

}  // namespace kinship::experiments
