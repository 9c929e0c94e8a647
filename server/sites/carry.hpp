#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/failure.hpp"
#include "server/store/store.hpp"

/// Brings what one store has to another one. Everything may be done again: what is there is left
/// alone, and reports and retirements are only ever added.
namespace kinship::sites {

/// One way between two stores.
struct Way {
  store::Store& from;
  store::Store& to;
  /// Registers a robot at `to` that may not be there; empty: carry_robot().
  std::function<std::optional<Error>(const Digest&)> bring_robot = {};
  /// Commits at `to`; empty: `to.commit_shared`.
  std::function<void(std::vector<store::SharedReport>, store::Store::ReportsDone)> commit = {};
  /// Retires at `to`; empty: `to.retire_reports`.
  std::function<std::vector<Retirement>(std::span<const Uuid>)> retire = {};
  /// What is wrong with an attempt that is to be committed at `to`; empty: nobody looks.
  std::function<std::optional<Error>(const Attempt&)> check = {};
  /// What was retired at `to`.
  std::function<void(const Retirement&)> on_retired = [](const Retirement&) {};
  /// Called before each transaction at `to`; may take its time.
  std::function<void()> before_write = [] {};
  std::stop_token stop = {};
};

/// How much is carried at a time.
struct Piece {
  std::size_t reports = 256;                  ///< looked at together
  std::size_t commit = 256;                   ///< of them committed together
  std::size_t bytes = std::size_t{4} << 20U;  ///< of waypoints and scenes in one commit
  std::size_t retirements = 256;              ///< told in one transaction
};

/// A report that `to` does not take, and why.
struct RefusedReport {
  Uuid report_uuid;
  std::string why;
};

/// What became of reports.
struct CarriedReports {
  std::uint64_t new_there = 0;  ///< Stored, Recorded or of a content that was there
  std::uint64_t left_out = 0;   ///< that `from` cannot give: their paths are dropped or damaged
  std::vector<RefusedReport> refused;
};

struct CarriedPage {
  CarriedReports reports;
  std::size_t looked_at = 0;
  std::string cursor;  ///< of `from`: behind what is at `to`, refused or left out
  bool has_more = false;
};

/// Carries the next reports that came to `from` and all its retirements so far. A report that was
/// retired is retired at `to` before what came to `from` after that: content that was reported anew
/// stays.
/// \param task    empty: all.
/// \param cursor, retired  of `from`'s arrivals, and of its retirements, which is moved.
/// \throws Failure(Unavailable) if `to` wants it to be tried again, or it was stopped; Failure of
///         either store. The cursors are then as before: it is carried again.
CarriedPage carry_page(const Way& way, std::string_view task, const std::string& cursor,
                       std::string& retired, const Piece& piece);

/// Carries these reports; those that are known at `to` are carried too.
CarriedReports carry_reports(const Way& way, std::span<const Uuid> reports, std::string& retired,
                             const Piece& piece);

/// Carries all retirements behind a cursor, which is moved. \return how many.
std::uint64_t carry_retirements(const Way& way, std::string& cursor, const Piece& piece);

}  // namespace kinship::sites
