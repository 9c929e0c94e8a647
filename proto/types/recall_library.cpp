#include "proto/types/recall_library.hpp"

#include <algorithm>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/rules.hpp"

namespace kinship {
namespace {

constexpr std::size_t kBitsOfByte = 8;

std::string name_of(const char* what, std::size_t index) {
  return std::string("recall: ") + what + " " + std::to_string(index) + ": ";
}

void check_counts(const RecallLibrary& library, Rules& rules) {
  rules.that(library.revision != 0, "recall: revision 0")
      .not_negative("recall: search_checks", library.search_checks)
      .not_negative("recall: try_checks", library.try_checks)
      .at_most("recall: anchors", library.anchors.size(), kMaxRecallAnchors)
      .at_most("recall: queries", library.queries.size(), kMaxRecallQueries)
      .at_most("recall: paths", library.paths.size(), kMaxRecallPaths)
      .at_most("recall: modes", library.modes.size(), kMaxWarpModes);
  for (const std::string& anchor : library.anchors)
    rules.not_empty("recall: anchor", anchor).text("recall: anchor", anchor, kMaxLinkNameBytes);
  const std::size_t bits = library.queries.size() * library.paths.size() * library.modes.size();
  const std::size_t bytes = (bits + kBitsOfByte - 1) / kBitsOfByte;
  for (const auto& [what, bits_of] :
       {std::pair("solves: ", &library.solves), std::pair("reaches: ", &library.reaches)})
    rules.that(bits_of->size() == bytes, "recall: " + (what + std::to_string(bits_of->size())) +
                                             " bytes are not " + std::to_string(bytes));
}

void check_query(const RecallQuery& query, std::size_t index, const RecallLibrary& library,
                 Rules& rules) {
  const std::string name = name_of("query", index);
  const Eigen::Index dof = library.queries.front().start.size();
  rules.between(name + "dof", static_cast<double>(query.start.size()), 1, kMaxDof);
  for (const auto& [what, configuration] :
       {std::pair("start: ", &query.start), std::pair("goal: ", &query.goal)})
    rules
        .that(configuration->size() == dof, name + what + std::to_string(configuration->size()) +
                                                " joints are not " + std::to_string(dof))
        .that(configuration->allFinite(), name + what + "not finite")
        .that(!(configuration->size() > 0 && configuration->cwiseAbs().maxCoeff() > kMaxJointValue),
              name + what + "a joint is beyond 10000");
  rules.pose(name + "T_task_base", query.T_task_base)
      .that(query.T_task_anchors.size() == library.anchors.size(),
            name + std::to_string(query.T_task_anchors.size()) + " poses of " +
                std::to_string(library.anchors.size()) + " anchors");
  for (const Eigen::Isometry3d& T_task_anchor : query.T_task_anchors)
    rules.pose(name + "T_task_anchors", T_task_anchor);
}

void check_path(const RecallPath& path, std::size_t index, const RecallLibrary& library,
                Rules& rules) {
  const std::string name = name_of("path", index);
  rules.that(path.query < library.queries.size(), name + "query " + std::to_string(path.query) +
                                                      " of " +
                                                      std::to_string(library.queries.size()));
  if (rules.broken())
    return;
  const Eigen::Index dof = library.queries.front().start.size();
  rules
      .that(path.waypoints.rows() == dof && path.waypoints.cols() == kRecallWaypoints,
            name + std::to_string(path.waypoints.rows()) + " x " +
                std::to_string(path.waypoints.cols()) + " waypoints are not " +
                std::to_string(dof) + " x " + std::to_string(kRecallWaypoints))
      .that(path.waypoints.cast<float>().allFinite(), name + "not finite as float")
      .that(!(path.waypoints.size() > 0 && path.waypoints.cwiseAbs().maxCoeff() > kMaxJointValue),
            name + "a joint is beyond 10000");
}

}  // namespace

std::optional<Error> validate(const RecallLibrary& library) {
  Rules rules;
  check_counts(library, rules);
  for (std::size_t i = 0; i < library.modes.size() && !rules.broken(); ++i)
    rules
        .between(name_of("mode", i) + "blend", library.modes[i].blend, 0,
                 static_cast<double>(kMaxWarpBlends - 1))
        .between(name_of("mode", i) + "frame", library.modes[i].frame, 0,
                 static_cast<double>(kTaskFrame + library.anchors.size()));
  for (std::size_t i = 0; i < library.queries.size() && !rules.broken(); ++i)
    check_query(library.queries[i], i, library, rules);
  for (std::size_t i = 0; i < library.paths.size() && !rules.broken(); ++i)
    check_path(library.paths[i], i, library, rules);
  return rules.broken();
}

std::size_t recall_bytes(const RecallLibrary& library) {
  constexpr std::size_t kFixed = 160, kAnchor = 16, kQuery = 168, kPath = 32, kMode = 8;
  constexpr std::size_t kNumbersOfPose = 7;
  std::size_t bytes =
      kFixed + kMode * library.modes.size() + library.solves.size() + library.reaches.size();
  for (const std::string& anchor : library.anchors)
    bytes += kAnchor + anchor.size();
  for (const RecallQuery& query : library.queries)
    bytes += kQuery + sizeof(double) * (static_cast<std::size_t>(query.start.size()) +
                                        static_cast<std::size_t>(query.goal.size()) +
                                        kNumbersOfPose * query.T_task_anchors.size());
  for (const RecallPath& path : library.paths)
    bytes += kPath + sizeof(float) * static_cast<std::size_t>(path.waypoints.size());
  return bytes;
}

}  // namespace kinship
