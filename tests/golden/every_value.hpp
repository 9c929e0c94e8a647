#pragma once

#include <string>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/backup_summary.hpp"
#include "proto/types/client_use.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/credential_list.hpp"
#include "proto/types/problem.hpp"
#include "proto/types/publications.hpp"
#include "proto/types/robot_check.hpp"
#include "proto/types/store_check.hpp"
#include "proto/types/summaries.hpp"

/// Values in which every field is set, each to something else: two fields that change places change
/// the bytes. They keep the rules of the contract.
namespace kinship::test {

class Distinct;
ModeEvidence every_evidence(Distinct& next);
PlanningRecord every_record(Distinct& next);

/// Numbers, texts and ids that do not repeat; equal for equal beginnings.
class Distinct {
 public:
  explicit Distinct(std::uint64_t first) : next_(first) {}

  std::uint64_t count() { return ++next_; }
  std::uint32_t count32() { return static_cast<std::uint32_t>(count()); }
  std::int64_t time_ms() { return 1'700'000'000'000 + static_cast<std::int64_t>(count()); }
  double real() { return static_cast<double>(count()) + 0.375; }
  double share() { return static_cast<double>(count()) / 4096; }
  std::string text(const std::string& what) { return what + " " + std::to_string(count()); }
  std::string name(const std::string& what) { return what + "_" + std::to_string(count()); }

  template <typename Id>
  Id id() {
    Id id;
    const std::uint64_t number = count();
    for (std::size_t i = 0; i < id.bytes.size(); ++i)
      id.bytes[i] = static_cast<std::uint8_t>(number + 7 * i);
    return id;
  }

  /// Turned by a right angle about z, so that its seven numbers come out the same everywhere.
  Eigen::Isometry3d pose() {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    T.translation() << real() / 1024, -real() / 1024, real() / 1024;
    return T;
  }

  Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd numbers(rows, columns);
    for (double& number : numbers.reshaped())
      number = real() / 1024;
    return numbers;
  }

  /// A value whose table says what fields it has: each is set, and not to its default.
  template <Described Value>
  Value described() {
    Value value;
    for_each_field<Value>(
        [&](const auto& field) { set(value.*field.member, std::string(field.name), field.rules); });
    return value;
  }

 private:
  template <typename T>
  void set(T& value, const std::string& what, const FieldRules& rules) {
    if constexpr (std::is_same_v<T, bool>) {
      value = !value;
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(value == T{} ? 1 : 0);
    } else if constexpr (std::is_integral_v<T>) {
      value = static_cast<T>(what.ends_with("_ms") ? time_ms() : std::int64_t{count32()});
    } else if constexpr (std::is_floating_point_v<T>) {
      value = rules.max <= 1 ? share() : real();
    } else if constexpr (std::is_same_v<T, std::string>) {
      value = name(what);
    } else if constexpr (std::is_same_v<T, Eigen::Isometry3d>) {
      value = pose();
    } else if constexpr (kIsOptional<T>) {
      set(value.emplace(), what, rules);
    } else if constexpr (kIsList<T>) {
      value.resize(2);
      for (auto& element : value)
        set(element, what, {});
    } else if constexpr (std::is_same_v<T, PlanningRecord>) {
      value = every_record(*this);
    } else if constexpr (std::is_same_v<T, ModeEvidence>) {
      value = every_evidence(*this);
    } else if constexpr (Described<T>) {
      value = described<T>();
    } else {
      value = id<T>();
    }
  }

  std::uint64_t next_;
};

inline constexpr Eigen::Index kJoints = 4;  ///< of paths and mixtures

RobotDescription every_robot_description();
RecordedScene every_recorded_scene();
SearchRecord every_search_record();
Attempt every_attempt();            ///< solved, with a scene and a search record
Attempt every_unsolved_attempt();   ///< without all that may be missing
Distribution every_distribution();  ///< a mixture of two components, four joints
Distribution every_kernels();       ///< the same, three kernels
Distribution every_failure();       ///< without all that may be missing
Selection every_selection();
Rehearsal every_rehearsal();

Explanation every_explanation();
Problem every_problem();            ///< to configurations, in a scene
Problem every_pose_problem();       ///< to a pose
Problem every_problem_from_pose();  ///< to a pose, too
ProblemResult every_problem_result();
InverseAnswer every_inverse_answer();
RobotCheck every_robot_check();

Announcement every_announcement();
Event every_event();

RegisterReply every_register_reply();
ReportRequest every_report_request();
ReportReply every_report_reply();
FetchRequest every_fetch_request();
FetchReply every_fetch_reply();
AdminRequest every_admin_request();
AdminReply every_admin_reply();

}  // namespace kinship::test
