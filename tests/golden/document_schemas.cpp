#include "proto/json/admin_rows_json.hpp"
#include "proto/json/distribution_fields.hpp"
#include "proto/json/format.hpp"
#include "proto/json/result_fields.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/credential_list.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/publications.hpp"
#include "proto/types/robot_check.hpp"
#include "proto/types/robot_links.hpp"
#include "proto/types/search_record.hpp"
#include "proto/types/store_check.hpp"
#include "proto/types/task_axes.hpp"
#include "tests/golden/schema_of.hpp"

namespace kinship::test {
namespace {

using json::Format;

DocumentSchema document(const Format& format, const std::string& what, const Schema& object) {
  const std::string name = json::to_text(format).substr(std::string_view("kinship.").size());
  std::string file = name;
  std::ranges::replace(file, '/', '-');
  Schema schema;
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["$id"] = "urn:kinship:" + file;
  schema["title"] = json::to_text(format);
  schema["description"] = what;
  Schema properties = {{"format", {{"const", json::to_text(format)}}}};
  properties.update(object.at("properties"));
  schema["type"] = "object";
  schema["properties"] = std::move(properties);
  schema["required"] = {"format"};
  for (const auto& name_of_member : object.at("required"))
    schema["required"].push_back(name_of_member);
  schema["additionalProperties"] = false;
  return {file + ".schema.json", std::move(schema)};
}

DocumentSchema document(const Format& format, const std::string& what, const Members& members) {
  return document(format, what, object_of(members));
}

Schema configurations() { return list_of(configuration()); }
Schema pairs_of_names() { return list_of(exactly(2, text(kMaxLinkNameBytes)), kMaxCollisionPairs); }
Schema name() { return {{"type", "string"}, {"minLength", 1}, {"maxLength", kMaxLinkNameBytes}}; }
Schema extent() { return {{"type", "number"}, {"exclusiveMinimum", 0}}; }

Schema alternatives(std::initializer_list<Schema> schemas) {
  Schema schema;
  schema["anyOf"] = Schema::array();
  for (const Schema& each : schemas)
    schema["anyOf"].push_back(each);
  return schema;
}

Schema shape(bool may_be_mesh) {
  Schema schema = alternatives(
      {object_of({{"box", exactly(3, extent())}}), object_of({{"cylinder", exactly(2, extent())}}),
       object_of({{"sphere", extent()}}), object_of({{"capsule", exactly(2, extent())}})});
  if (may_be_mesh)
    schema["anyOf"].push_back(object_of({{"mesh", text()}, {"scale", exactly(3, number()), true}}));
  return schema;
}

/// The lists of solids, which a scene may lack.
Members solids() {
  const Member approximate{"approximate", boolean(), true};
  const Schema round = object_of({{"name", name()},
                                  {"pose", pose()},
                                  {"radius", extent()},
                                  {"length", extent()},
                                  approximate});
  return {{"boxes",
           list_of(object_of(
               {{"name", name()}, {"pose", pose()}, {"size", exactly(3, extent())}, approximate})),
           true},
          {"cylinders", list_of(round), true},
          {"spheres",
           list_of(object_of({{"name", name()},
                              {"center", exactly(3, number())},
                              {"radius", extent()},
                              approximate})),
           true},
          {"capsules", list_of(round), true}};
}

Schema scene() {
  return object_of(joined(
      {solids(),
       {{"meshes",
         list_of(object_of({{"name", name()},
                            {"file", text()},
                            {"pose", pose()},
                            {"scale", exactly(3, number()), true}})),
         true},
        {"clouds",
         list_of(object_of(
             {{"name", name()}, {"file", text()}, {"pose", pose()}, {"voxel", number(), true}})),
         true}}}));
}

Schema region() {
  return object_of(
      {{"T0_w", pose()}, {"Tw_e", pose()}, {"Bw", exactly(6, exactly(2, or_null(number())))}});
}

Schema recorded_scene() {
  return object_of(joined({solids(),
                           {{"held",
                             list_of(object_of({{"name", name()},
                                                {"shape", shape(false)},
                                                {"T_transfer_object", pose()},
                                                {"approximate", boolean(), true}})),
                             true},
                            {"allowed_collisions", pairs_of_names(), true},
                            {"constraint", or_null(region()), true}}}));
}

Schema search_record() {
  const Schema tree =
      object_of({{"configurations", configurations()}, {"parents", list_of(integer())}});
  return object_of({{"start", configuration(), true},
                    {"goals", configurations(), true},
                    {"start_pose", or_null(pose()), true},
                    {"goal_pose", or_null(pose()), true},
                    {"blockers", list_of(schema_of<Blocker>(), kMaxBlockers), true},
                    {"goal_contacts", list_of(schema_of<GoalContact>(), kMaxGoalContacts), true},
                    {"last_free", configuration(), true},
                    {"trees", list_of(tree, kMaxSearchTrees), true},
                    {"allowed_collisions", pairs_of_names(), true},
                    {"seed", count(), true},
                    {"reason", text(kMaxMessageBytes), true}});
}

DocumentSchema attempt() {
  return document(
      json::kAttemptFormat,
      "An attempt of a planner: a line of paths export and import, a file of an outbox, attempts "
      "show, paths show. robot: digest or label; waypoints: null if unsolved.",
      Members{{"report_uuid", uuid()},
              {"task", text(kMaxTaskBytes)},
              {"robot", text(kMaxLabelBytes)},
              {"machine", text(kMaxMachineBytes), true},
              {"T_task_base", or_null(pose()), true},
              {"waypoints", or_null(configurations()), true},
              {"record", schema_of<PlanningRecord>()},
              {"scene", or_null(recorded_scene()), true},
              {"search", or_null(search_record()), true}});
}

Schema robot_description() {
  const Schema axes = list_of(words(kTaskAxisNames), kTaskAxisNames.size());
  const Schema held = {{"type", "object"}, {"additionalProperties", number()}};
  const Schema solids = object_of({{"solids", list_of(object_of({{"link", text(kMaxLinkNameBytes)},
                                                                 {"shape", shape(false)},
                                                                 {"T_link_shape", pose()}}))},
                                   {"unfiltered", pairs_of_names()}});
  const Schema mesh = object_of({{"link", text(kMaxLinkNameBytes)},
                                 {"role", words(Words<MeshRole>::kWords)},
                                 {"T_link_mesh", pose()},
                                 {"rgba", exactly(4, number()), true},
                                 {"error_m", number(), true},
                                 {"content", digest()}});
  return object_of({{"label", text(kMaxLabelBytes)},
                    {"urdf", text(kMaxUrdfBytes)},
                    {"base_link", text(kMaxLinkNameBytes)},
                    {"tip_link", text(kMaxLinkNameBytes)},
                    {"T_tip_transfer", pose(), true},
                    {"task_axes", axes, true},
                    {"held_joints", held, true},
                    {"never_colliding", pairs_of_names(), true},
                    {"mesh_solids", solids, true},
                    {"meshes", list_of(mesh), true}});
}

DocumentSchema problem() {
  const Schema attached = object_of({{"name", name()},
                                     {"link", name()},
                                     {"shape", shape(true)},
                                     {"T_link_object", pose()},
                                     {"touch_links", list_of(name()), true}});
  return document(json::kProblemFormat, "What kinship-plan plans; a line of its problem file.",
                  Members{{"name", text(kMaxTaskBytes)},
                          {"T_task_base", or_null(pose()), true},
                          {"start", alternatives({configuration(), object_of({{"pose", pose()}})})},
                          {"goal", alternatives({object_of({{"configurations", configurations()}}),
                                                 object_of({{"pose", pose()}})})},
                          {"scene", or_null(scene()), true},
                          {"attached", or_null(list_of(attached)), true},
                          {"allowed_collisions", or_null(pairs_of_names()), true},
                          {"constraint", or_null(region()), true},
                          {"time_limit_s", number(), true},
                          {"seed", count(), true}});
}

DocumentSchema result() {
  return document(json::kResultFormat,
                  "What kinship-plan found; a line of its results, in input order.",
                  joined({members_of(json::kEffort),
                          {{"start", or_null(configuration()), true},
                           {"waypoints", or_null(configurations()), true},
                           {"guidance", or_null(object_of(members_of(json::kGuidance))), true}},
                          members_of(json::kReasons)}));
}

/// \param may_lack_mixture  a ready one, too.
Schema distribution() {
  const Schema scores =
      list_of(object_of({{"K", count()}, {"score", number()}}), kMaxComponentScores);
  const Schema rows = or_null(list_of(list_of(configuration())));
  return object_of(joined({members_of(json::kProvenance),
                           {{"weights", or_null(configuration()), true},
                            {"means", or_null(configurations()), true},
                            {"covariances", rows, true},
                            {"limits", list_of(exactly(2, number()), kMaxDof)},
                            {"cuts", or_null(list_of(or_null(number()), kMaxDof)), true},
                            {"k_curve", or_null(scores), true},
                            {"held_out_score", or_null(number()), true}},
                           members_of(json::kAdvice),
                           members_of(json::kFit),
                           members_of(kLastFieldsOfDistribution)}));
}

Schema explanation() {
  return object_of({{"distribution", distribution()},
                    {"experience", list_of(schema_of<Explanation::Now>(), kMaxSources)},
                    {"behind", boolean()},
                    {"next_fit", text(kMaxMessageBytes)},
                    {"rehearsal", or_null(schema_of<Rehearsal>()), true}});
}

DocumentSchema task_experience() {
  const Schema path =
      object_of({{"path", uuid()}, {"source", digest()}, {"poses", list_of(pose())}});
  return document(
      json::kTaskExperienceFormat,
      "tasks experience: ways of the hand, poses of the transfer frame in the task frame.",
      Members{{"revision", matching("^[0-9a-f]{16}$")},
              {"paths_known", count()},
              {"paths", list_of(path)}});
}

DocumentSchema recorded_search() {
  return document(json::kSearchFormat,
                  "How the trees of a search grew; a line of kinship-plan --searches.",
                  Members{{"name", text(kMaxTaskBytes)},
                          {"nodes", configurations()},
                          {"parents", list_of(integer())},
                          {"checks", list_of(count())},
                          {"path", list_of(count())}});
}

void add_kinematics(std::vector<DocumentSchema>& all) {
  all.push_back(document(json::kInverseKinematicsFormat, "robots ik; a line for each pose.",
                         Members{{"solver", text()},
                                 {"solutions", configurations()},
                                 {"reason", or_null(text())},
                                 {"time_us", number()},
                                 {"colliding", count(), true}}));
  all.push_back(
      document(json::kForwardKinematicsFormat, "robots fk; a line for each configuration.",
               Members{{"q", configuration()},
                       {"frame", words(std::initializer_list<std::string_view>{"task", "base"})},
                       {"tip", pose()},
                       {"transfer", pose()}}));
}

void add_robot_answers(std::vector<DocumentSchema>& all) {
  const Schema guide = or_null(words(Words<Guide>::kWords));
  const Schema pair = object_of({{"target", digest()},
                                 {"target_label", text()},
                                 {"source", digest()},
                                 {"source_label", text()},
                                 {"worth", or_null(number())},
                                 {"worth_by_time", or_null(number())},
                                 {"worth_by_checks", or_null(number())},
                                 {"without_experience", guide},
                                 {"with_experience", guide},
                                 {"rehearsal", or_null(schema_of<Rehearsal>())},
                                 {"message", text()}});
  all.push_back(document(json::kRobotComparisonFormat,
                         "robots compare: what the experience of each source is worth to a target.",
                         Members{{"task", text()}, {"rows", list_of(pair)}}));
  all.push_back(document(json::kRobotCheckFormat, "robots check.",
                         Members{{"robot", digest()},
                                 {"base_link", text()},
                                 {"tip_link", text()},
                                 {"dof", count()},
                                 {"joints", list_of(schema_of<CheckedJoint>())},
                                 {"structure", text()},
                                 {"solver", text()},
                                 {"poses", count()},
                                 {"poses_without_solution", count()},
                                 {"solutions_per_pose", number()},
                                 {"time_per_pose_us", number()},
                                 {"reach_m", number()},
                                 {"transfer_distance_m", number()},
                                 {"links", list_of(schema_of<CheckedLink>())}}));
  all.push_back(document(json::kRobotRegistrationFormat, "robots register.",
                         Members{{"robot", digest()},
                                 {"label", text()},
                                 {"known", boolean()},
                                 {"dof", count()},
                                 {"solver", text()},
                                 {"same_arms", list_of(text())},
                                 {"geometry", text()},
                                 {"geometry_grade", words(Words<GeometryGrade>::kWords)},
                                 {"took_geometry", boolean()},
                                 {"meshes", text()},
                                 {"meshes_missing", count()}}));
  Schema described = robot_description();
  described["properties"]["format"] = {{"const", json::to_text(json::kRobotDescriptionFormat)}};
  all.push_back(
      document(json::kRobotDetailsFormat, "robots show.",
               Members{{"robot", schema_of<RobotSummary>()}, {"description", described}}));
  all.push_back(
      document(json::kRobotLinksFormat, "robots links.", members_of(kFieldsOf<RobotLinks>)));
  all.push_back(
      document(json::kRobotFramesFormat, "robots frames.", members_of(kFieldsOf<RobotFrames>)));
  all.push_back(document(json::kSrdfSuggestionFormat, "robots suggest-srdf.",
                         members_of(kFieldsOf<SrdfSuggestion>)));
}

/// The documents of single rows and of listings of them.
void add_rows(std::vector<DocumentSchema>& all) {
  const auto add_single = [&]<typename Row>(const Row* /*of*/, const std::string& of) {
    all.push_back(document(json::kFormatOf<Row>, of, members_of(kFieldsOf<Row>)));
  };
  const auto add_list = [&]<typename Row>(const Row* /*of*/, const std::string& of) {
    all.push_back(
        document(json::kListFormatOf<Row>, of, Members{{"rows", list_of(schema_of<Row>())}}));
  };
  const auto of = []<typename Row>(std::type_identity<Row>) { return static_cast<Row*>(nullptr); };
  add_single(of(std::type_identity<RobotSummary>()), "robots rename.");
  add_single(of(std::type_identity<TaskSummary>()), "tasks show, tasks rename.");
  add_single(of(std::type_identity<ServerStatus>()), "status.");
  add_single(of(std::type_identity<Eviction>()), "distributions evict.");
  add_single(of(std::type_identity<Retirement>()), "paths retire, tasks reset.");
  add_single(of(std::type_identity<Restoration>()), "paths restore.");
  add_single(of(std::type_identity<RobotRemoval>()), "robots remove.");
  add_single(of(std::type_identity<TaskRemoval>()), "tasks remove.");
  add_single(of(std::type_identity<Job>()), "jobs wait, jobs cancel, backup now.");
  add_list(of(std::type_identity<RobotSummary>()), "robots list.");
  add_list(of(std::type_identity<TaskSummary>()), "tasks list.");
  add_list(of(std::type_identity<PathSummary>()), "paths list.");
  add_list(of(std::type_identity<AttemptSummary>()), "attempts list.");
  add_list(of(std::type_identity<DistributionSummary>()), "distributions list.");
  add_list(of(std::type_identity<Job>()), "jobs list.");
  add_list(of(std::type_identity<ClientUse>()), "status --clients.");
  add_list(of(std::type_identity<BackupSummary>()), "backup list.");
  add_list(of(std::type_identity<AuditEntry>()), "audit.");
}

}  // namespace

std::vector<DocumentSchema> document_schemas() {
  std::vector<DocumentSchema> all = {
      attempt(),
      problem(),
      result(),
      recorded_search(),
      task_experience(),
      document(json::kDistributionFormat, "distributions fetch, distributions show.",
               distribution()),
      document(json::kFormatOf<Explanation>, "distributions explain.", explanation()),
      document(json::kRobotDescriptionFormat, "A robot that waits in an outbox.",
               robot_description()),
      document(json::kExperienceRobotFormat,
               "A robot of an experience file, before the attempts that need it.",
               Members{{"robot_description", robot_description()}}),
      document(json::kEventFormat, "What happens at a server; a line of watch.",
               members_of(kFieldsOf<Event>)),
      document(json::kStoreCheckFormat, "kinshipd check.", members_of(kFieldsOf<StoreCheck>)),
      document(json::kCredentialListFormat, "kinshipd secure list.",
               members_of(kFieldsOf<CredentialList>)),
      document(json::kBackupDownloadFormat, "backup download.",
               Members{{"file", text()}, {"bytes", count()}, {"sha256", digest()}}),
      document(json::kOutboxListFormat, "outbox list.",
               Members{{"rows", list_of(object_of(
                                    {{"file", text()}, {"state", text()}, {"why", text()}}))}}),
      document(json::kPathImportFormat, "paths import: how many of each.",
               Members{{"robots", count()},
                       {"stored", count()},
                       {"known", count()},
                       {"recorded", count()},
                       {"refused", count()}})};
  add_kinematics(all);
  add_robot_answers(all);
  add_rows(all);
  return all;
}

}  // namespace kinship::test
