#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/summaries.hpp"
#include "server/service/robot_registry.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// What a verb answers with: Status one ServerStatus; a list verb its summaries; ShowRobot a
/// RobotSummary, then the RobotDescription; ShowTask a TaskSummary; ShowPath an Attempt;
/// ShowDistribution a Distribution.
using AdminRow = std::variant<ServerStatus, RobotSummary, RobotDescription, TaskSummary,
                              PathSummary, Attempt, DistributionSummary, Distribution>;

/// An AdminReply whose rows are values still.
struct AdminPage {
  AdminStatus status = AdminStatus::Failed;
  std::vector<AdminRow> rows;
  std::string next_cursor;
  std::string message;
};

/// Answers the questions of administrators from the store. Robots are named by label or by a
/// digest prefix of at least four digits, paths by report UUID, distributions by an id prefix. May
/// be shared between threads.
class Administration {
 public:
  /// \param store, robots  outlive it.
  /// \param status         answers the verb Status.
  Administration(store::Store& store, RobotRegistry& robots, std::function<ServerStatus()> status)
      : store_(store), robots_(robots), status_(std::move(status)) {}

  /// Never throws: what fails is said in the page.
  AdminPage answer(const AdminRequest& request);

 private:
  AdminPage dispatch(const AdminRequest& request);
  AdminPage list_robots(const AdminRequest& request);
  AdminPage list_paths(const AdminRequest& request);
  AdminPage list_distributions(const AdminRequest& request);
  AdminPage show_robot(const std::string& name);
  AdminPage show_task(const std::string& task);
  AdminPage show_path(const std::string& uuid);
  AdminPage show_distribution(const std::string& prefix);

  Result<store::RobotRecord> find_robot(const std::string& name) const;
  std::optional<Digest> robot_filter(const AdminRequest& request) const;
  void check_task_filter(const AdminRequest& request) const;
  Result<Digest> find_distribution_id(const std::string& prefix) const;
  RobotSummary summary_of(const Digest& robot) const;
  void name_solver(RobotSummary& summary);

  store::Store& store_;
  RobotRegistry& robots_;
  std::function<ServerStatus()> status_;
};

}  // namespace kinship::service
