#include "server/console/status_text.hpp"

#include <chrono>
#include <filesystem>
#include <numeric>

#include "pages/page/json_text.hpp"
#include "proto/json/admin_rows_json.hpp"

namespace kinship::console {
namespace {

using metrics::Histogram;

/// Of the file system that a store's file lies on; null for a database.
std::string disk_of(const std::string& store_file) {
  std::error_code none;
  const std::filesystem::space_info space = std::filesystem::space(store_file, none);
  if (none)
    return "null";
  return page::object(
      {{"free", std::to_string(space.available)}, {"capacity", std::to_string(space.capacity)}});
}

std::uint64_t number_of(const metrics::Counter& counter) { return counter.value(); }
std::uint64_t number_of(const Histogram& histogram) {
  std::uint64_t sum = 0;
  for (std::size_t bucket = 0; bucket <= Histogram::kBounds_s.size(); ++bucket)
    sum += histogram.count(bucket);
  return sum;
}

template <typename Names, typename Values>
std::string numbers(const Names& names, const Values& values) {
  std::string json = "{";
  for (std::size_t i = 0; i < names.size(); ++i)
    json += (i > 0 ? "," : "") + page::json_string(names[i]) + ":" +
            std::to_string(number_of(values[i]));
  return json + "}";
}

std::string json_of(const Histogram& histogram) {
  std::vector<std::uint64_t> counts;
  for (std::size_t bucket = 0; bucket <= Histogram::kBounds_s.size(); ++bucket)
    counts.push_back(histogram.count(bucket));
  return page::object(
      {{"bounds_s", page::list(Histogram::kBounds_s, page::number)},
       {"counts", page::list(counts, [](std::uint64_t count) { return std::to_string(count); })}});
}

}  // namespace

std::string status_text(const service::Service& service) noexcept {
  try {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const ServerStatus status = service.status();
    const service::Measures& measures = service.measures();
    return page::object(
        {{"now_ms",
          std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(now).count())},
         {"status", json::to_json(status)},
         {"disk", disk_of(status.store_file)},
         {"attempts", numbers(service::kReceiptNames, measures.attempts)},
         {"fetches", numbers(service::kFetchOutcomeNames, measures.fetches)},
         {"receipts", json_of(measures.receipts)}});
  } catch (const std::exception& exception) {
    return page::object({{"message", page::json_string(exception.what())}});
  }
}

}  // namespace kinship::console
