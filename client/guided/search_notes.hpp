#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "client/guided/contact_notes.hpp"
#include "client/guided/plan_settings.hpp"
#include "proto/types/problem.hpp"
#include "proto/types/search_record.hpp"
#include "robots/planning/is_free.hpp"
#include "robots/planning/tree.hpp"

namespace kinship::guided {

/// What is noted of a search while it runs, to explain it afterwards: some of the configurations
/// that were refused, spread over all of them, and the trees, which are handed over when the search
/// ends. Which bodies touched is asked after the search, so that it costs the search next to
/// nothing.
class SearchNotes {
 public:
  SearchNotes(RecordSearch wanted, Eigen::Index dof);

  bool is_wanted() const noexcept { return wanted_ != RecordSearch::Never; }

  /// The same check, which notes what it refuses. \param is_free  borrowed by the returned check,
  /// as is this object.
  planning::IsFree watched(const planning::IsFree& is_free);

  /// For BirrtOptions::trees; null if nothing is wanted.
  planning::TreePair* trees() noexcept { return is_wanted() ? &trees_ : nullptr; }

  /// Whether a query that ended so has a record.
  bool has_record(bool is_solved, double processor_time_s, double slow_time_s) const noexcept;

  /// \param start   empty: none was found.
  /// \param goals   dof x n, also those that touch something; the first kMaxSearchGoals are taken.
  /// \param reason  why it was not solved; empty: it was.
  /// \return nothing if it breaks a rule of the contract, e.g. by an odd name.
  std::optional<SearchRecord> record(const Problem& problem, const Eigen::VectorXd& start,
                                     const Eigen::MatrixXd& goals, const std::string& reason,
                                     const FindNear& find_near) const;

 private:
  static constexpr Eigen::Index kKept = 128;  // of the refused configurations

  void note(const Eigen::Ref<const Eigen::VectorXd>& q);

  RecordSearch wanted_;
  Eigen::MatrixXd refused_;                // dof x kKept
  Eigen::Index kept_ = 0;                  // of its columns
  std::size_t refusals_ = 0, stride_ = 1;  // each stride_-th is kept
  planning::TreePair trees_;
};

}  // namespace kinship::guided
