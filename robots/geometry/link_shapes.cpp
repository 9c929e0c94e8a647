#include "robots/geometry/link_shapes.hpp"

#include <tinyxml2.h>
#include <urdf_model/model.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "robots/geometry/fitted_shape.hpp"
#include "robots/kinematics/urdf_model.hpp"

namespace kinship::geometry {
namespace {

/// Index of a sphere of that link, radius and centre in the link's frame.
std::optional<std::size_t> find_sphere(const std::vector<LinkShape>& shapes, int link,
                                       double radius_m, const Eigen::Vector3d& p_link_center) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto* sphere = std::get_if<SphereShape>(&shapes[i].shape);
    if (sphere != nullptr && shapes[i].link == link &&
        std::abs(sphere->radius_m - radius_m) <= kFusionTolerance_m &&
        (shapes[i].T_link_shape.translation() - p_link_center).norm() <= kFusionTolerance_m)
      return i;
  }
  return std::nullopt;
}

std::optional<Shape> to_shape(const urdf::Geometry& geometry) {
  if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry))
    return BoxShape{{box->dim.x, box->dim.y, box->dim.z}};
  if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry))
    return CylinderShape{cylinder->radius, cylinder->length};
  if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry))
    return SphereShape{sphere->radius};
  return std::nullopt;
}

/// A scaled mesh; nothing if it is to be left out.
Result<std::optional<FittedMesh>> read_fitted(const urdf::Mesh& mesh, const MeshSource& meshes) {
  const auto corners = meshes(mesh.filename);
  if (!corners)
    return corners.error();
  if (!*corners)
    return std::optional<FittedMesh>();
  const Eigen::Vector3d scale(mesh.scale.x, mesh.scale.y, mesh.scale.z);
  if (!(scale.array().abs() > 0).all())
    return invalid_input("mesh '" + mesh.filename + "': its scale has a 0, which leaves no solid");
  auto fitted = fit_mesh(scale.asDiagonal() * **corners);
  if (!fitted)
    return invalid_input("mesh '" + mesh.filename + "': " + fitted.error().message);
  return std::optional<FittedMesh>(*std::move(fitted));
}

/// The shape of one collision element; nothing if the element is empty or its mesh left out.
Result<std::optional<LinkShape>> read_collision(const urdf::Collision& collision, int link,
                                                const MeshSource& meshes) {
  if (!collision.geometry)
    return std::optional<LinkShape>();
  LinkShape result;
  result.link = link;
  result.T_link_shape = to_isometry(collision.origin);
  if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(collision.geometry.get())) {
    const auto fitted = read_fitted(*mesh, meshes);
    if (!fitted)
      return fitted.error();
    if (!*fitted)
      return std::optional<LinkShape>();
    result.shape = (*fitted)->fitted.shape;
    result.T_link_shape = result.T_link_shape * (*fitted)->fitted.T_points_shape;
    result.triangles = (*fitted)->triangles;
    result.approximate = true;
  } else if (const auto shape = to_shape(*collision.geometry)) {
    result.shape = *shape;
  } else {
    return invalid_input("its collision geometry is of no known kind");
  }
  if (const auto why = broken_rule(result.shape))
    return invalid_input(*why);
  if (!result.T_link_shape.matrix().allFinite())
    return invalid_input("collision origin is not finite");
  return std::optional<LinkShape>(result);
}

struct LinksRead {
  std::vector<LinkShape> shapes;
  std::vector<int> left_out, visual_only, from_visual;
};

/// Whether any of these elements has a geometry.
template <typename Elements>
bool has_geometry(const Elements& elements) {
  return std::ranges::any_of(elements, [](const auto& element) {
    return element != nullptr && element->geometry != nullptr;
  });
}

/// Notes whether a link is only drawn, or has its visuals for its solids.
void note_visuals(const urdf::Link& link, int index, LinksRead& read) {
  if (!has_geometry(link.collision_array) && has_geometry(link.visual_array))
    read.visual_only.push_back(index);
  if (std::ranges::any_of(link.collision_array, [](const auto& collision) {
        return collision != nullptr && collision->name == kFromVisual;
      }))
    read.from_visual.push_back(index);
}

Result<LinksRead> read_links(const urdf::ModelInterface& model, const kinematics::Chain& chain,
                             const MeshSource& meshes) {
  LinksRead read;
  std::vector<LinkShape>& shapes = read.shapes;
  for (const auto& [name, link] : model.links_) {
    const int index = chain.find_link(name);
    if (index < 0)
      return invalid_input("link '" + name + "' of the URDF is not a link of the chain");
    note_visuals(*link, index, read);
    for (const auto& collision : link->collision_array) {
      if (!collision)
        continue;
      const auto shape = read_collision(*collision, index, meshes);
      if (!shape)
        return Error{shape.error().code, "link '" + name + "': " + shape.error().message};
      if (*shape)
        shapes.push_back(**shape);
      else if (collision->geometry)
        read.left_out.push_back(index);
    }
  }
  std::stable_sort(shapes.begin(), shapes.end(),
                   [](const LinkShape& a, const LinkShape& b) { return a.link < b.link; });
  std::ranges::sort(read.left_out);
  std::ranges::sort(read.visual_only);
  std::ranges::sort(read.from_visual);
  read.left_out.erase(std::unique(read.left_out.begin(), read.left_out.end()), read.left_out.end());
  return read;
}

Error no_such_link(const std::string& first, const std::string& second, const std::string& name) {
  return invalid_input("never-colliding pair ('" + first + "', '" + second + "'): no link named '" +
                       name + "'");
}

Result<std::vector<std::pair<int, int>>> read_pairs(const RobotDescription& description,
                                                    const kinematics::Chain& chain) {
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [first, second] : description.never_colliding) {
    const int a = chain.find_link(first);
    const int b = chain.find_link(second);
    if (a < 0 || b < 0)
      return no_such_link(first, second, a < 0 ? first : second);
    if (a != b)
      pairs.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

void add_collision(const tinyxml2::XMLElement& visual, tinyxml2::XMLElement& link) {
  tinyxml2::XMLDocument& document = *link.GetDocument();
  tinyxml2::XMLElement* const collision = document.NewElement("collision");
  collision->SetAttribute("name", kFromVisual);
  for (const char* part : {"origin", "geometry"})
    if (const tinyxml2::XMLElement* const found = visual.FirstChildElement(part))
      collision->InsertEndChild(found->DeepClone(&document));
  link.InsertEndChild(collision);
}

}  // namespace

Eigen::Isometry3d to_isometry(const urdf::Pose& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << pose.position.x, pose.position.y, pose.position.z;
  const Eigen::Quaterniond rotation(pose.rotation.w, pose.rotation.x, pose.rotation.y,
                                    pose.rotation.z);
  T.linear() = rotation.normalized().toRotationMatrix();
  return T;
}

std::vector<LinkShape> fuse_capsules(const std::vector<LinkShape>& shapes) {
  std::vector<LinkShape> fused = shapes;
  std::vector<bool> covered(shapes.size(), false);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto* cylinder = std::get_if<CylinderShape>(&shapes[i].shape);
    if (cylinder == nullptr)
      continue;
    const Eigen::Vector3d p_shape_end(0, 0, cylinder->length_m / 2);
    const auto top = find_sphere(shapes, shapes[i].link, cylinder->radius_m,
                                 shapes[i].T_link_shape * p_shape_end);
    const auto bottom = find_sphere(shapes, shapes[i].link, cylinder->radius_m,
                                    shapes[i].T_link_shape * -p_shape_end);
    if (!top || !bottom || top == bottom)
      continue;
    covered[*top] = covered[*bottom] = true;
    fused[i].shape = CapsuleShape{cylinder->radius_m, cylinder->length_m};
  }
  std::vector<LinkShape> kept;
  for (std::size_t i = 0; i < fused.size(); ++i)
    if (!covered[i])
      kept.push_back(fused[i]);
  return kept;
}

Result<std::optional<Eigen::Matrix3Xd>> refuse_mesh(const std::string& uri) {
  return invalid_input("mesh '" + uri + "' is out of reach here");
}

Result<std::optional<Eigen::Matrix3Xd>> leave_out_mesh(const std::string& /*uri*/) {
  return std::optional<Eigen::Matrix3Xd>();
}

Result<RobotShapes> read_shapes(const kinematics::RobotModel& robot, const MeshSource& meshes) {
  // urdfdom goes on without the element that it cannot read: a solid must not vanish like that.
  if (robot.urdf.complaints.find("collision element") != std::string::npos)
    return invalid_input("URDF: " + robot.urdf.complaints);
  auto links = read_links(*robot.urdf.tree, robot.chain, meshes);
  if (!links)
    return links.error();
  auto pairs = read_pairs(robot.description, robot.chain);
  if (!pairs)
    return pairs.error();
  return RobotShapes{fuse_capsules(links->shapes), *std::move(pairs), links->left_out,
                     links->visual_only, links->from_visual};
}

Result<std::string> with_visual_solids(const std::string& urdf,
                                       const std::vector<std::string>& except) {
  tinyxml2::XMLDocument document;
  if (document.Parse(urdf.data(), urdf.size()) != tinyxml2::XML_SUCCESS)
    return invalid_input("URDF: line " + std::to_string(document.ErrorLineNum()) +
                         ": not well-formed XML");
  tinyxml2::XMLElement* const robot = document.FirstChildElement("robot");
  if (robot == nullptr)
    return invalid_input("URDF: no <robot> element");
  for (auto* link = robot->FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    const char* const name = link->Attribute("name");
    if (link->FirstChildElement("collision") != nullptr ||
        (name != nullptr && std::ranges::count(except, name) > 0))
      continue;
    for (const auto* visual = link->FirstChildElement("visual"); visual != nullptr;
         visual = visual->NextSiblingElement("visual"))
      add_collision(*visual, *link);
  }
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return std::string(printer.CStr());
}

}  // namespace kinship::geometry
