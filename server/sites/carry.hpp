#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/failure.hpp"
#include "server/store/store.hpp"

/// Copies reports and retirements from one store to another. Every step may be repeated: existing
/// data is not changed, and reports and retirements are only ever added.
namespace kinship::sites {

/// One direction between two stores.
struct Way {
  store::Store& from;
  store::Store& to;
  /// Registers a robot at `to` unless it is there; empty: carry_robot().
  std::function<std::optional<Error>(const Digest&)> bring_robot = {};
  /// Commits at `to`; empty: `to.commit_replicated`.
  std::function<void(std::vector<store::ReplicatedReport>, store::Store::ReportsDone)> commit = {};
  /// Retires at `to`; empty: `to.retire_reports`.
  std::function<std::vector<Retirement>(std::span<const Uuid>)> retire = {};
  /// The fault of an attempt before it is committed at `to`; empty: no check.
  std::function<std::optional<Error>(const Attempt&)> check = {};
  /// Called with each retirement at `to`.
  std::function<void(const Retirement&)> on_retired = [](const Retirement&) {};
  /// Called before each transaction at `to`; may take its time.
  std::function<void()> before_write = [] {};
  std::stop_token stop = {};
};

/// Sizes of a step.
struct Piece {
  std::size_t reports = 256;                  ///< listed together
  std::size_t commit = 256;                   ///< committed together
  std::size_t bytes = std::size_t{4} << 20U;  ///< of waypoints and scenes in one commit
  std::size_t retirements = 256;              ///< in one transaction
};

/// A report that `to` refuses, and why.
struct RefusedReport {
  Uuid report_uuid;
  std::string why;
  bool is_put_off = false;  ///< by its database, alone; else it breaks a rule there
};

/// Outcome of carried reports.
struct CarriedReports {
  std::uint64_t new_there = 0;  ///< Stored, Recorded or Duplicate
  std::uint64_t left_out = 0;   ///< unreadable at `from`: their paths are dropped or damaged
  std::vector<RefusedReport> refused;
};

struct CarriedPage {
  CarriedReports reports;
  std::size_t looked_at = 0;
  std::string cursor;  ///< of `from`: behind what is at `to`, refused or left out
  bool has_more = false;
};

/// Carries the next reports that came to `from` and all its retirements so far. A retired report is
/// retired at `to` before later reports are carried: content that was reported again stays. A
/// report that `to` knows with another body is carried, too: `to` refuses it in words. \param task
/// empty: all. \param cursor, retired  of `from`'s arrivals, and of its retirements; the latter is
/// advanced. \throws Failure(Unavailable) if `to` answers TryAgain, or it was stopped; Failure of
/// either
///         store. The page is then carried again from `cursor`.
CarriedPage carry_page(const Way& way, std::string_view task, const std::string& cursor,
                       std::string& retired, const Piece& piece);

/// Carries these reports, including those known at `to`.
CarriedReports carry_reports(const Way& way, std::span<const Uuid> reports, std::string& retired,
                             const Piece& piece);

/// Carries all retirements behind a cursor and advances it. \return their number.
std::uint64_t carry_retirements(const Way& way, std::string& cursor, const Piece& piece);

}  // namespace kinship::sites
