#include "robots/geometry/known_shapes.hpp"

#include <urdf_model/model.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "proto/types/limits.hpp"
#include "robots/geometry/fitted_shape.hpp"
#include "robots/geometry/mesh_cover.hpp"
#include "robots/kinematics/urdf_model.hpp"

namespace kinship::geometry {
namespace {

std::string counted(int count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/// \return the link's index, or why it can have no solids.
Result<int> link_of_solid(const std::string& name, const RobotShapes& shapes,
                          const kinematics::Chain& chain) {
  const int link = chain.find_link(name);
  if (link < 0)
    return invalid_input("mesh_solids: no link named '" + name + "'");
  if (!std::binary_search(shapes.left_out.begin(), shapes.left_out.end(), link))
    return invalid_input("mesh_solids: link '" + name + "' has no mesh");
  return link;
}

/// Adds solids and pairs; `covered` receives the links that have solids.
std::optional<Error> add_solids(const MeshSolids& mesh_solids, const kinematics::Chain& chain,
                                RobotShapes& shapes, std::set<int>& covered) {
  for (const LinkSolid& solid : mesh_solids.solids) {
    const Result<int> link = link_of_solid(solid.link, shapes, chain);
    if (!link)
      return link.error();
    if (const auto why = broken_rule(solid.shape))
      return invalid_input("mesh_solids: link '" + solid.link + "': " + *why);
    shapes.shapes.push_back({*link, solid.shape, solid.T_link_shape, true});
    covered.insert(*link);
  }
  std::stable_sort(shapes.shapes.begin(), shapes.shapes.end(),
                   [](const LinkShape& a, const LinkShape& b) { return a.link < b.link; });
  for (const auto& [first, second] : mesh_solids.unfiltered) {
    const int a = chain.find_link(first), b = chain.find_link(second);
    if (a < 0 || b < 0)
      return invalid_input("mesh_solids: no link named '" + (a < 0 ? first : second) + "'");
    if (a != b)
      shapes.never_colliding.emplace_back(std::min(a, b), std::max(a, b));
  }
  auto& pairs = shapes.never_colliding;
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return std::nullopt;
}

/// Meshes for collision of each link that has some in the URDF, by index.
std::map<int, int> count_meshes(const kinematics::RobotModel& robot) {
  std::map<int, int> meshes;
  for (const auto& [name, link] : robot.urdf.tree->links_)
    for (const auto& collision : link->collision_array)
      if (collision && dynamic_cast<const urdf::Mesh*>(collision->geometry.get()) != nullptr)
        ++meshes[robot.chain.find_link(name)];
  return meshes;
}

/// \return the solid with the triangles of a mesh; nothing if its content is not here.
std::optional<LinkShape> read_shape(const LinkMesh& mesh, int link, const FindMesh& find) {
  const std::optional<MeshContent> content = find(mesh.content);
  const auto triangles = content ? TriangleMesh::read(*content)
                                 : Result<TriangleMesh>(invalid_input("it is not here"));
  if (!triangles)
    return std::nullopt;
  const auto fitted = fit_mesh(triangles->corners());
  if (!fitted)
    return std::nullopt;
  return LinkShape{link, fitted->fitted.shape, mesh.T_link_mesh * fitted->fitted.T_points_shape,
                   true, fitted->triangles};
}

/// Of all meshes of a robot, each as often as it is named: what a client names little of could
/// else take gigabytes here.
constexpr std::size_t kMaxRobotTriangles = 1'000'000;

/// Adds the meshes of all links in place of their solids.
/// \return false, and nothing changes, if one is not here, or they have more than
///         kMaxRobotTriangles.
bool add_meshes(const kinematics::RobotModel& robot, const FindMesh& find, KnownShapes& known) {
  if (!find || !names_all_meshes(robot))
    return false;
  std::vector<LinkShape> read;
  std::set<int> links;
  std::size_t triangles = 0;
  for (const LinkMesh& mesh : robot.description.meshes) {
    if (!is_collision(mesh))
      continue;
    const int link = robot.chain.find_link(mesh.link);
    std::optional<LinkShape> shape = read_shape(mesh, link, find);
    if (!shape)
      return false;
    triangles += static_cast<std::size_t>(shape->triangles->cols()) / 3;
    if (triangles > kMaxRobotTriangles)
      return false;
    read.push_back(*std::move(shape));
    links.insert(link);
  }
  std::vector<LinkShape>& shapes = known.shapes.shapes;
  std::ranges::move(read, std::back_inserter(shapes));
  std::ranges::stable_sort(shapes, {}, &LinkShape::link);
  known.shapes.left_out.clear();
  known.mesh_links = static_cast<int>(links.size());
  return true;
}

/// Of all meshes of a robot: half a second of a thread that other requests wait for. Those of
/// cover_links() take some ten a triangle.
constexpr std::size_t kMaxRobotTests = 50'000'000;

/// Whether the solids of each link hold its meshes: they are what a client says they are.
/// \param known  with the triangles.
bool hold_meshes(const RobotShapes& covers, const RobotShapes& known, std::size_t& tests_left) {
  std::map<int, std::vector<FittedShape>> solids;
  for (const LinkShape& shape : covers.shapes)
    if (shape.approximate)
      solids[shape.link].push_back({shape.shape, shape.T_link_shape});
  return std::ranges::all_of(known.shapes, [&](const LinkShape& shape) {
    return !shape.triangles ||
           hold(solids[shape.link], Eigen::Matrix3Xd(shape.T_link_shape * *shape.triangles),
                tests_left);
  });
}

/// The solids, each as much larger as hold() has them: what is apart for them is apart.
/// \param shapes  without what the solids stand for.
/// \param known   with the triangles; learns whether it took too many tests to tell.
/// \return null if they do not hold the meshes, as far as was tested.
std::shared_ptr<const RobotShapes> covers_of(const kinematics::RobotModel& robot,
                                             RobotShapes shapes, KnownShapes& known) {
  std::set<int> covered;
  std::size_t tests_left = kMaxRobotTests;
  if (add_solids(robot.description.mesh_solids, robot.chain, shapes, covered) ||
      !std::ranges::all_of(shapes.left_out, [&](int link) { return covered.contains(link); }) ||
      !hold_meshes(shapes, known.shapes, tests_left)) {
    known.are_covers_untested = tests_left == 0;
    return nullptr;
  }
  for (LinkShape& shape : shapes.shapes)
    if (shape.approximate)
      shape.shape = grown(shape.shape, kCoverMargin_m);
  return std::make_shared<const RobotShapes>(std::move(shapes));
}

GeometryGrade grade_of(const KnownShapes& known) {
  if (known.shapes.shapes.empty())
    return GeometryGrade::None;
  if (known.unknown_links > 0)
    return GeometryGrade::Partial;
  return known.approximate_links > 0 ? GeometryGrade::Approximate : GeometryGrade::Exact;
}

}  // namespace

bool names_all_meshes(const kinematics::RobotModel& robot) {
  std::map<int, int> named;
  for (const LinkMesh& mesh : robot.description.meshes)
    if (is_collision(mesh))
      ++named[robot.chain.find_link(mesh.link)];
  return !named.empty() && named == count_meshes(robot);
}

Result<KnownShapes> read_known_shapes(const kinematics::RobotModel& robot, const FindMesh& find) {
  const MeshSolids& mesh_solids = robot.description.mesh_solids;
  auto shapes = read_shapes(robot, leave_out_mesh);
  if (!shapes)
    return shapes.error();
  KnownShapes known;
  known.shapes = *std::move(shapes);
  const RobotShapes without_meshes = known.shapes;
  if (add_meshes(robot, find, known)) {
    known.covers = covers_of(robot, without_meshes, known);
    std::set<int> links;
    for (const LinkShape& shape : known.shapes.shapes)
      links.insert(shape.link);
    known.exact_links = static_cast<int>(links.size()) - known.mesh_links;
    known.grade = grade_of(known);
    return known;
  }
  const std::size_t pairs_before = known.shapes.never_colliding.size();
  std::set<int> covered;
  if (const auto error = add_solids(mesh_solids, robot.chain, known.shapes, covered))
    return *error;
  std::erase_if(known.shapes.left_out, [&](int link) { return covered.contains(link); });
  std::set<int> with_shape;
  for (const LinkShape& shape : known.shapes.shapes)
    with_shape.insert(shape.link);
  for (const int link : covered)
    with_shape.erase(link);
  for (const int link : known.shapes.left_out)
    with_shape.erase(link);
  known.exact_links = static_cast<int>(with_shape.size());
  known.approximate_links = static_cast<int>(covered.size());
  known.unknown_links = static_cast<int>(known.shapes.left_out.size());
  known.mesh_solids = static_cast<int>(mesh_solids.solids.size());
  known.unfiltered_pairs = static_cast<int>(known.shapes.never_colliding.size() - pairs_before);
  known.grade = grade_of(known);
  return known;
}

std::string describe(const KnownShapes& known) {
  if (known.exact_links + known.mesh_links + known.approximate_links + known.unknown_links == 0)
    return "no link has a collision shape";
  std::string words;
  const auto add = [&words](const std::string& part) {
    words += (words.empty() ? "" : ", ") + part;
  };
  if (known.exact_links > 0)
    add(counted(known.exact_links, "link") + " by exact shapes");
  if (known.mesh_links > 0)
    add(counted(known.mesh_links, "link") + " by the triangles of their meshes" +
        (known.are_covers_untested ? " alone (too many to test the solids around them)" : ""));
  if (known.approximate_links > 0) {
    std::string part = counted(known.approximate_links, "link") + " by " +
                       counted(known.mesh_solids, "solid") + " around meshes (approximate";
    if (known.unfiltered_pairs > 0)
      part += "; " + counted(known.unfiltered_pairs, "pair") + " of links not compared";
    add(part + ")");
  }
  if (known.unknown_links > 0)
    add(counted(known.unknown_links, "link") + " unknown, with meshes that only its clients have");
  return words;
}

Result<MeshSolids> cover_links(const RobotShapes& shapes, const kinematics::Chain& chain) {
  MeshSolids mesh_solids;
  for (const LinkShape& shape : shapes.shapes) {
    if (!shape.triangles)
      continue;
    for (const FittedShape& fitted : cover_mesh(*shape.triangles))
      mesh_solids.solids.push_back({chain.links()[static_cast<std::size_t>(shape.link)].name,
                                    fitted.shape, shape.T_link_shape * fitted.T_points_shape});
  }
  if (const auto error = check_mesh_solids(mesh_solids))
    return *error;
  return mesh_solids;
}

RobotShapes with_solids(const RobotShapes& shapes, const MeshSolids& mesh_solids,
                        const kinematics::Chain& chain) {
  RobotShapes solid = shapes;
  std::erase_if(solid.shapes, [](const LinkShape& shape) { return shape.triangles != nullptr; });
  for (const LinkSolid& each : mesh_solids.solids)
    solid.shapes.push_back({chain.find_link(each.link), each.shape, each.T_link_shape, true});
  return solid;
}

}  // namespace kinship::geometry
