#include "robots/collision/body.hpp"

#include <algorithm>
#include <span>
#include <string_view>

#include "proto/types/failure.hpp"
#include "robots/geometry/fitted_shape.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::collision {
namespace {

constexpr std::size_t kBlocksOfACloud = 64;  // each an obstacle, so that most are far away

[[noreturn]] void refuse(const std::string& message) {
  throw Failure(ErrorCode::InvalidInput, message);
}

void require_finite(const Eigen::Isometry3d& T, const std::string& what) {
  if (!T.matrix().allFinite())
    refuse(what + ": pose is not finite");
}

Solid make_solid(const Shape& shape, const std::string& what,
                 const Eigen::Matrix3Xd* triangles = nullptr) {
  try {
    return Solid(shape, triangles);
  } catch (const Failure& failure) {
    throw Failure(failure.code(), what + ": " + failure.what());
  }
}

/// A solid and its pose in the frame that its object is given in.
struct PlacedSolid {
  Solid solid;
  Eigen::Isometry3d T_frame_solid;
};

PlacedSolid place_mesh(const Mesh& mesh, const Eigen::Isometry3d& T_frame_mesh,
                       const std::string& what) {
  const std::string named = what + ": mesh '" + mesh.file + "'";
  if (!mesh.triangles)
    refuse(named + " has not been read");
  const auto fitted = geometry::fit_mesh(*mesh.triangles);
  if (!fitted)
    refuse(named + ": " + fitted.error().message);
  return {make_solid(fitted->fitted.shape, named, fitted->triangles.get()),
          T_frame_mesh * fitted->fitted.T_points_shape};
}

const kinematics::ChainLink& link_at(const kinematics::Chain& chain, int link) {
  if (link < 0 || link >= static_cast<int>(chain.links().size()))
    refuse("link " + std::to_string(link) + " of a shape is not a link of the chain");
  return chain.links()[static_cast<std::size_t>(link)];
}

void require_link(const kinematics::Chain& chain, const std::string& name,
                  const std::string& what) {
  if (chain.find_link(name) < 0)
    refuse(what + ": no link named '" + name + "'");
}

Body make_attached(const kinematics::Chain& chain, const AttachedObject& object) {
  const std::string what = "attached object '" + object.name + "'";
  require_link(chain, object.link, what);
  for (const std::string& name : object.touch_links)
    require_link(chain, name, what);
  require_finite(object.T_link_object, what);
  const int index = chain.find_link(object.link);
  const kinematics::ChainLink& link = link_at(chain, index);
  const PlacedSolid placed =
      object.mesh ? place_mesh(*object.mesh, object.T_link_object, what)
                  : PlacedSolid{make_solid(object.shape, what), object.T_link_object};
  return {BodyKind::Attached,
          object.name,
          index,
          link.joint,
          link.T_joint_link * placed.T_frame_solid,
          placed.solid,
          object.touch_links};
}

std::string unknown_name(const std::string& first, const std::string& second,
                         const std::string& name) {
  return "allowed collision ('" + first + "', '" + second +
         "'): no link, object or attachment named '" + name + "'";
}

void require_known_names(const std::vector<Body>& bodies, const kinematics::Chain& chain,
                         const Surroundings& surroundings) {
  const auto known = [&](const std::string& name) {
    return chain.find_link(name) >= 0 ||
           std::any_of(bodies.begin(), bodies.end(),
                       [&](const Body& body) { return body.name == name; });
  };
  for (const auto& [first, second] : surroundings.allowed_collisions)
    for (const std::string& name : {first, second})
      if (!known(name))
        refuse(unknown_name(first, second, name));
}

/// Parent and children of each link.
std::vector<std::vector<int>> tree_edges(const std::vector<kinematics::ChainLink>& links) {
  std::vector<std::vector<int>> edges(links.size());
  for (std::size_t child = 0; child < links.size(); ++child) {
    const int parent = links[child].parent;
    if (parent < 0)
      continue;
    edges[child].push_back(parent);
    edges[static_cast<std::size_t>(parent)].push_back(static_cast<int>(child));
  }
  return edges;
}

/// Which pairs of some bodies may touch, by their indices, and for two links by the links', which
/// have many bodies: there are many pairs, and few of these.
class Permissions {
 public:
  Permissions(const std::vector<Body>& bodies, const Surroundings& surroundings)
      : bodies_(bodies), is_named_(bodies.size(), false) {
    for (std::size_t i = 0; i < bodies.size(); ++i)
      names_.emplace_back(bodies[i].name, i);
    std::ranges::sort(names_);
    for (const auto& [a, b] : surroundings.allowed_collisions)
      permit_all(named(a), named(b));
    for (std::size_t i = 0; i < bodies.size(); ++i)
      for (const std::string& link : bodies[i].touch_links)
        for (const Named& one : named(link))
          if (bodies[one.second].kind == BodyKind::Link)
            permit(i, one.second);
    std::ranges::sort(links_);
    std::ranges::sort(permitted_);
  }

  bool may_touch(std::size_t i, std::size_t j) const {
    if (!is_named_[i] || !is_named_[j])
      return false;
    return are_links(i, j) ? std::ranges::binary_search(links_, link_pair(i, j))
                           : std::ranges::binary_search(permitted_, BodyPair(std::minmax(i, j)));
  }

 private:
  using Named = std::pair<std::string_view, std::size_t>;

  std::span<const Named> named(std::string_view name) const {
    const auto begin = std::ranges::lower_bound(names_, Named(name, 0));
    const auto end =
        std::find_if(begin, names_.end(), [&](const Named& other) { return other.first != name; });
    return {begin, end};
  }
  bool are_links(std::size_t i, std::size_t j) const {
    return bodies_[i].kind == BodyKind::Link && bodies_[j].kind == BodyKind::Link;
  }
  std::pair<int, int> link_pair(std::size_t i, std::size_t j) const {
    return std::minmax(bodies_[i].link, bodies_[j].link);
  }

  void permit_all(std::span<const Named> some, std::span<const Named> others) {
    if (some.empty() || others.empty())
      return;
    if (are_links(some.back().second, others.back().second)) {  // all: links come first
      links_.push_back(link_pair(some.back().second, others.back().second));
      for (const std::span<const Named> both : {some, others})
        for (const Named& one : both)
          is_named_[one.second] = true;
      return;
    }
    for (const Named& one : some)
      for (const Named& other : others)
        permit(one.second, other.second);
  }
  void permit(std::size_t i, std::size_t j) {
    if (are_links(i, j))
      links_.push_back(link_pair(i, j));
    else
      permitted_.emplace_back(std::minmax(i, j));
    is_named_[i] = is_named_[j] = true;
  }

  const std::vector<Body>& bodies_;
  std::vector<Named> names_;                // ascending
  std::vector<bool> is_named_;              // in a pair
  std::vector<std::pair<int, int>> links_;  // first <= second, ascending
  std::vector<BodyPair> permitted_;         // the same
};

/// Links come first.
std::size_t first_of_no_link(const std::vector<Body>& bodies) {
  return static_cast<std::size_t>(
      std::ranges::find_if(bodies, [](const Body& body) { return body.kind != BodyKind::Link; }) -
      bodies.begin());
}

}  // namespace

std::vector<Body> link_bodies(const kinematics::Chain& chain, const geometry::RobotShapes& shapes) {
  std::vector<Body> bodies;
  for (const geometry::LinkShape& shape : shapes.shapes) {
    const kinematics::ChainLink& link = link_at(chain, shape.link);
    const std::string what = "link '" + link.name + "'";
    require_finite(shape.T_link_shape, what);
    bodies.push_back({BodyKind::Link,
                      link.name,
                      shape.link,
                      link.joint,
                      link.T_joint_link * shape.T_link_shape,
                      make_solid(shape.shape, what, shape.triangles.get()),
                      {}});
  }
  return bodies;
}

void place_bodies(const kinematics::Chain& chain, const std::vector<Body>& bodies,
                  const Eigen::Ref<const Eigen::VectorXd>& q,
                  std::vector<Eigen::Isometry3d>& T_base_bodies) {
  const std::vector<Eigen::Isometry3d> T_base_joints = kinematics::joint_poses(chain, q);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].joint >= 0)
      T_base_bodies[i] =
          T_base_joints[static_cast<std::size_t>(bodies[i].joint)] * bodies[i].T_joint_body;
}

std::vector<Eigen::Isometry3d> standing_poses(const std::vector<Body>& bodies) {
  std::vector<Eigen::Isometry3d> poses;
  for (const Body& body : bodies)
    poses.push_back(body.T_joint_body);
  return poses;
}

void add_surroundings(const kinematics::Chain& chain, const Surroundings& surroundings,
                      std::vector<Body>& bodies) {
  for (const AttachedObject& object : surroundings.attached)
    bodies.push_back(make_attached(chain, object));

  require_finite(surroundings.T_task_base, "placement of the base in the task frame");
  const Eigen::Isometry3d T_base_task = surroundings.T_task_base.inverse(Eigen::Isometry);
  const auto add_obstacle = [&](const std::string& name, const Eigen::Isometry3d& T_task_solid,
                                const Solid& solid) {
    bodies.push_back({BodyKind::Obstacle, name, -1, -1, T_base_task * T_task_solid, solid, {}});
  };
  for (const SceneObject& object : surroundings.scene.objects) {
    const std::string what = "scene object '" + object.name + "'";
    require_finite(object.T_task_object, what);
    add_obstacle(object.name, object.T_task_object, make_solid(object.shape, what));
  }
  for (const SceneMesh& object : surroundings.scene.meshes) {
    const std::string what = "scene object '" + object.name + "'";
    require_finite(object.T_task_mesh, what);
    const PlacedSolid placed = place_mesh(object.mesh, object.T_task_mesh, what);
    add_obstacle(object.name, placed.T_frame_solid, placed.solid);
  }
  for (const SceneCloud& object : surroundings.scene.clouds) {
    const std::string what = "scene object '" + object.name + "'";
    require_finite(object.T_task_cloud, what);
    const PointCloud& cloud = object.cloud;
    if (!cloud.voxels)
      refuse(what + ": point cloud '" + cloud.file + "' has not been read");
    for (const geometry::VoxelBlock& block :
         geometry::blocks_of(*cloud.voxels, cloud.voxel_m, kBlocksOfACloud))
      add_obstacle(object.name, object.T_task_cloud * Eigen::Translation3d(block.center),
                   Solid(block, cloud.voxel_m));
  }
  require_known_names(bodies, chain, surroundings);
}

std::vector<std::pair<int, int>> neighbouring_links(const kinematics::Chain& chain,
                                                    const std::vector<bool>& has_shape) {
  const auto& links = chain.links();
  const auto are_joined = [&](int first, int second) {  // by one moving joint
    const int a = links[static_cast<std::size_t>(first)].joint;
    const int b = links[static_cast<std::size_t>(second)].joint;
    return (a >= 0 && chain.joint_before(a) == b) || (b >= 0 && chain.joint_before(b) == a);
  };
  const std::vector<std::vector<int>> edges = tree_edges(links);
  std::vector<std::pair<int, int>> pairs;
  for (int first = 0; first < static_cast<int>(links.size()); ++first) {
    if (!has_shape[static_cast<std::size_t>(first)])
      continue;
    // Walk outwards through links without a shape; a tree needs no memory but where we came from.
    std::vector<std::pair<int, int>> frontier = {{first, -1}};  // link, link before it
    while (!frontier.empty()) {
      const auto [link, before] = frontier.back();
      frontier.pop_back();
      for (const int next : edges[static_cast<std::size_t>(link)]) {
        if (next == before)
          continue;
        if (!has_shape[static_cast<std::size_t>(next)])
          frontier.emplace_back(next, link);
        else if (first < next && are_joined(first, next))
          pairs.emplace_back(first, next);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

LinkPairs unchecked_links(const std::vector<Body>& bodies, const kinematics::Chain& chain,
                          const geometry::RobotShapes& shapes) {
  std::vector<bool> has_shape(chain.links().size(), false);
  for (const Body& body : bodies)
    if (body.kind == BodyKind::Link)
      has_shape[static_cast<std::size_t>(body.link)] = true;
  const auto neighbours = neighbouring_links(chain, has_shape);
  LinkPairs pairs(neighbours.begin(), neighbours.end());
  pairs.insert(shapes.never_colliding.begin(), shapes.never_colliding.end());
  return pairs;
}

std::vector<BodyPair> checked_links(const std::vector<Body>& links, const LinkPairs& unchecked) {
  std::vector<BodyPair> pairs;
  for (std::size_t i = 0; i < links.size(); ++i)
    for (std::size_t j = i + 1; j < links.size(); ++j)
      if (links[i].joint != links[j].joint &&
          !unchecked.contains(std::minmax(links[i].link, links[j].link)))
        pairs.emplace_back(i, j);
  return pairs;
}

std::vector<BodyPair> moving_pairs(const std::vector<Body>& bodies,
                                   const std::vector<BodyPair>& links,
                                   const Surroundings& surroundings) {
  const Permissions permissions(bodies, surroundings);
  std::vector<std::vector<BodyPair>> of_joint;  // by the last joint that moves either
  const auto add = [&](std::size_t i, std::size_t j) {
    if (permissions.may_touch(i, j))
      return;
    const auto joint = static_cast<std::size_t>(std::max(bodies[i].joint, bodies[j].joint));
    of_joint.resize(std::max(of_joint.size(), joint + 1));
    of_joint[joint].emplace_back(i, j);
  };
  const std::size_t others = first_of_no_link(bodies);
  auto link = links.begin();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (; link != links.end() && link->first == i; ++link)
      if (surroundings.checks_links)
        add(i, link->second);
    for (std::size_t j = std::max(i + 1, others); j < bodies.size(); ++j)
      if (bodies[i].joint != bodies[j].joint)
        add(i, j);
  }
  std::vector<BodyPair> pairs;
  for (auto joint = of_joint.rbegin(); joint != of_joint.rend(); ++joint)
    pairs.insert(pairs.end(), joint->begin(), joint->end());
  return pairs;
}

std::vector<BodyPair> standing_pairs(const std::vector<Body>& bodies,
                                     const Surroundings& surroundings) {
  const Permissions permissions(bodies, surroundings);
  std::vector<BodyPair> pairs;
  const std::size_t others = first_of_no_link(bodies);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].joint < 0 && bodies[i].kind != BodyKind::Obstacle)
      for (std::size_t j = std::max(i + 1, others); j < bodies.size(); ++j)
        if (bodies[j].kind == BodyKind::Obstacle && !permissions.may_touch(i, j))
          pairs.emplace_back(i, j);
  return pairs;
}

}  // namespace kinship::collision
