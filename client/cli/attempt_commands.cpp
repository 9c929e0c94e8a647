#include "client/cli/attempt_commands.hpp"

#include <map>
#include <ostream>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
#include "proto/files/output_file.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::cli {
namespace {

/// Names of the parts of an object, by its own.
using PartNames = std::map<std::string, std::vector<std::string>>;

constexpr const char* kAttemptExport = "attempts export";

void add_query(const SearchRecord& search, Problem& problem) {
  problem.start = search.start;
  if (search.start.size() == 0)
    problem.T_task_start = search.T_task_start;
  problem.T_task_goal = search.T_task_goal;
  if (!search.T_task_goal)
    problem.goal_configurations = search.goals;
  problem.seed = search.seed;
}

/// A mesh or a cloud was recorded as several solids of its name; a problem's have one each.
/// \return the names of the parts of each that has several.
PartNames name_parts(std::vector<SceneObject>& objects) {
  std::map<std::string, std::vector<SceneObject*>> of_name;
  for (SceneObject& object : objects)
    of_name[object.name].push_back(&object);
  PartNames parts;
  for (const auto& [name, same] : of_name)
    for (std::size_t i = 0; same.size() > 1 && i < same.size(); ++i)
      parts[name].push_back(same[i]->name = name + "/" + std::to_string(i + 1));
  return parts;
}

/// Pairs of which a name may stand for several parts.
std::vector<std::pair<std::string, std::string>> pairs_of_parts(
    const std::vector<std::pair<std::string, std::string>>& pairs, const PartNames& parts) {
  const auto named = [&](const std::string& name) {
    const auto found = parts.find(name);
    return found == parts.end() ? std::vector{name} : found->second;
  };
  std::vector<std::pair<std::string, std::string>> all;
  for (const auto& [first, second] : pairs)
    for (const std::string& one : named(first))
      for (const std::string& other : named(second))
        all.emplace_back(one, other);
  return all;
}

PartNames add_scene(const RecordedScene& scene, const kinematics::Chain& chain, Problem& problem) {
  problem.scene.objects = scene.objects;
  for (SceneObject& object : problem.scene.objects)
    object.approximate = false;  // a problem has shapes alone
  const PartNames parts = name_parts(problem.scene.objects);
  for (const HeldObject& held : scene.held)
    problem.attached.push_back(
        {held.name, chain.tip_link(), held.shape, chain.T_tip_transfer() * held.T_transfer_object});
  problem.allowed_collisions = pairs_of_parts(scene.allowed_collisions, parts);
  problem.constraint = scene.constraint;
  return parts;
}

void add_pairs_of_links(const SearchRecord& search, const kinematics::Chain& chain,
                        const PartNames& parts, Problem& problem) {
  std::set<std::string_view> names;
  for (const SceneObject& object : problem.scene.objects)
    names.insert(object.name);
  for (const AttachedObject& attached : problem.attached)
    names.insert(attached.name);
  const auto is_known = [&](const std::string& name) {
    return names.contains(name) || chain.find_link(name) >= 0;
  };
  for (const auto& [first, second] : pairs_of_parts(search.allowed_collisions, parts))
    if (is_known(first) && is_known(second))
      problem.allowed_collisions.emplace_back(first, second);
}

Result<kinematics::Chain> chain_of(link::Client& server, const Attempt& attempt) {
  const Result<std::vector<std::string>> rows =
      link::rows_of(server, {.verb = AdminVerb::ShowRobot, .argument = attempt.robot.hex()});
  if (!rows)
    return rows.error();
  if (rows->size() < 2)
    return Error{ErrorCode::Internal, "the server does not describe the robot"};
  const auto description = json::robot_description_from_json(rows->at(1));
  return description ? kinematics::read_chain(*description) : description.error();
}

Result<Problem> fetch_problem(link::Client& server, const std::string& id) {
  const Result<std::string> row =
      link::first_row_of(server, {.verb = AdminVerb::ShowPath, .argument = id});
  if (!row)
    return row.error();
  const auto named = json::stored_attempt_from_json(*row);
  if (!named)
    return link::unreadable_row(named.error());
  const Result<kinematics::Chain> chain = chain_of(server, named->attempt);
  return chain ? problem_of(named->attempt, *chain) : chain.error();
}

}  // namespace

Result<Problem> problem_of(const Attempt& attempt, const kinematics::Chain& chain) {
  const std::string who = "attempt " + attempt.report_uuid.text() + ": ";
  if (!attempt.search)
    return Error{ErrorCode::InvalidInput,
                 who +
                     "its report brought no search record (kinship-plan --record-search), or the "
                     "server let it go (kinshipd --search-records-mb, --search-record-days)"};
  Problem problem;
  problem.name = "attempt-" + attempt.report_uuid.text();
  problem.T_task_base = attempt.T_task_base;
  add_query(*attempt.search, problem);
  if (problem.start.size() == 0 && !problem.T_task_start)
    return Error{ErrorCode::InvalidInput, who + "its record has no start"};
  if (problem.goal_configurations.cols() == 0 && !problem.T_task_goal)
    return Error{ErrorCode::InvalidInput, who + "its record has no goal"};
  PartNames parts;
  if (attempt.scene)
    parts = add_scene(*attempt.scene, chain, problem);
  add_pairs_of_links(*attempt.search, chain, parts, problem);
  if (attempt.record.time_limit_s > 0)
    problem.time_limit_s = attempt.record.time_limit_s;
  return problem;
}

int export_attempt(link::Client& server, const AttemptExportOptions& options, std::ostream& out,
                   std::ostream& err) {
  const Result<Problem> problem = fetch_problem(server, options.id);
  if (!problem)
    return refuse(kAttemptExport, problem.error(), err);
  files::OutputFile output(options.output, out);
  output.stream() << json::to_json(*problem) << '\n';
  output.keep();
  return kDone;
}

}  // namespace kinship::cli
