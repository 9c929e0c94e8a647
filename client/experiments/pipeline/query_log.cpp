#include "client/experiments/pipeline/query_log.hpp"

#include <iostream>
#include <optional>
#include <utility>

#include "client/experiments/pipeline/compressed_file.hpp"
#include "proto/files/lines.hpp"
#include "proto/files/output_file.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

std::string describe(const std::optional<Digest>& distribution) {
  return distribution ? "distribution " + distribution->short_hex() : "no distribution";
}

/// \param drop_broken_end  whether a last line that is no result is left out instead of refused.
std::map<QueryKey, QueryResult> read_results(const std::filesystem::path& file,
                                             bool drop_broken_end) {
  std::map<QueryKey, QueryResult> results;
  std::optional<std::string> broken;
  std::ifstream stream = files::open_input(file);
  files::for_each_line(stream, file.string(), [&](const files::Line& line) {
    if (broken)
      throw Failure(ErrorCode::InvalidInput, *broken);
    const Result<QueryResult> result =
        line.text ? query_result_from_json(*line.text) : line.text.error();
    if (result)
      results.insert_or_assign(result->key, *result);
    else
      broken =
          file.string() + " line " + std::to_string(line.number) + ": " + result.error().message;
    return true;
  });
  if (broken && !drop_broken_end)
    throw Failure(ErrorCode::InvalidInput, *broken);
  return results;
}

}  // namespace

QueryLog::QueryLog(std::filesystem::path file) : file_(std::move(file)) {
  if (expand_file(file_)) {
    results_ = read_results(file_, true);
    files::OutputFile whole_lines(file_, std::cout);
    for (const auto& [key, result] : results_)
      whole_lines.stream() << to_json(result) << '\n';
    whole_lines.keep();
  }
  stream_.open(file_, std::ios::app);
  if (!stream_)
    throw Failure(ErrorCode::Storage, "'" + file_.string() + "' cannot be written");
}

bool QueryLog::has(const QueryKey& key, const std::optional<Digest>& distribution) const {
  const std::lock_guard lock(mutex_);
  const auto known = results_.find(key);
  if (known == results_.end())
    return false;
  if (known->second.distribution != distribution)
    throw Failure(ErrorCode::Conflict, "'" + file_.string() + "' holds results of " + key.robot +
                                           " guided by '" + key.guidance + "' with " +
                                           describe(known->second.distribution) + ", now it is " +
                                           describe(distribution) + ": use another folder");
  return true;
}

void QueryLog::add(const QueryResult& result) {
  const std::lock_guard lock(mutex_);
  stream_ << to_json(result) << std::endl;
  if (!stream_)
    throw Failure(ErrorCode::Storage, "'" + file_.string() + "' cannot be written");
  results_.insert_or_assign(result.key, result);
}

std::vector<QueryResult> QueryLog::results() const {
  const std::lock_guard lock(mutex_);
  std::vector<QueryResult> results;
  for (const auto& [key, result] : results_)
    results.push_back(result);
  return results;
}

std::vector<QueryResult> read_query_results(const std::filesystem::path& file) {
  expand_file(file);
  std::vector<QueryResult> results;
  for (auto& [key, result] : read_results(file, false))
    results.push_back(std::move(result));
  return results;
}

}  // namespace kinship::experiments
