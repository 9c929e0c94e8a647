#include "server/sites/carry_geometry.hpp"

#include <optional>
#include <set>
#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::sites {
namespace {

std::uint64_t revision_of(const std::map<Digest, std::uint64_t>& revisions, const Digest& robot) {
  const auto found = revisions.find(robot);
  return found == revisions.end() ? 0 : found->second;
}

/// Nothing also if its row is damaged: the next registration mends it.
std::optional<store::RobotRecord> find_whole(const store::RobotStore& site, const Digest& robot) {
  try {
    return site.find_robot(robot);
  } catch (const Failure&) {
    return std::nullopt;
  }
}

/// A description with the contents of its meshes that the other store lacks.
RobotDescription with_contents(RobotDescription description, const store::RobotStore& from,
                               const store::RobotStore& to) {
  std::set<Digest> lacking;
  for (const LinkMesh& mesh : description.meshes)
    lacking.insert(mesh.content);
  for (const auto& [known, bytes] : to.known_meshes(lacking))
    lacking.erase(known);
  for (const Digest& content : lacking)
    if (std::optional<MeshContent> found = from.find_mesh(content))
      description.contents.push_back(*std::move(found));
  return description;
}

}  // namespace

GeometryExchange::GeometryExchange(store::RobotStore& here, store::RobotStore& above,
                                   TakeGeometry take_here, TakeGeometry take_above)
    : here_(here),
      above_(above),
      take_here_(std::move(take_here)),
      take_above_(std::move(take_above)) {}

void GeometryExchange::compare(const Digest& robot) {
  const std::optional<store::RobotRecord> of_site = find_whole(here_, robot);
  if (!of_site)
    return;
  const std::optional<store::RobotRecord> of_memory = above_.find_robot(robot);
  if (!of_memory)
    return;
  compared_[robot] = {of_site->geometry_revision, of_memory->geometry_revision};
  if (!take_above_(robot, with_contents(of_site->description, here_, above_)))
    take_here_(robot, with_contents(of_memory->description, above_, here_));
}

void GeometryExchange::compare_new(const Digest& robot) {
  if (!compared_.contains(robot))
    compare(robot);
}

void GeometryExchange::compare_changed() {
  const std::map<Digest, std::uint64_t> here = here_.geometry_revisions();
  const std::map<Digest, std::uint64_t> above = above_.geometry_revisions();
  std::set<Digest> robots;
  for (const auto& [robot, revision] : here)
    robots.insert(robot);
  for (const auto& [robot, revision] : above)
    robots.insert(robot);
  for (const Digest& robot : robots) {
    const auto known = compared_.find(robot);
    if (known == compared_.end() ||
        known->second != Revisions(revision_of(here, robot), revision_of(above, robot)))
      compare(robot);
  }
}

}  // namespace kinship::sites
