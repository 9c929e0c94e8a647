#include "robots/geometry/link_meshes.hpp"

#include <urdf_model/model.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/number_text.hpp"
#include "robots/kinematics/urdf_model.hpp"

namespace kinship::geometry {
namespace {

constexpr double kFinestCells = 4096;  // along the longest side
constexpr double kCoarser = 1.25;

/// A mesh that an element of the URDF names.
struct NamedMesh {
  std::string link;
  const urdf::Mesh* mesh = nullptr;
  Eigen::Isometry3d T_link_mesh;
  std::vector<double> rgba;
  MeshRole role = MeshRole::Visual;
};

using Cell = std::array<std::int64_t, 3>;

Cell cell_of(const Eigen::Vector3d& point, double edge_m) {
  const Eigen::Vector3d at = (point / edge_m).array().floor();
  return {static_cast<std::int64_t>(at.x()), static_cast<std::int64_t>(at.y()),
          static_cast<std::int64_t>(at.z())};
}

struct CellSum {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0;
};

SimplifiedMesh merge_cells(const Eigen::Matrix3Xd& corners, double edge_m) {
  std::map<Cell, CellSum> cells;
  std::vector<const CellSum*> cell_of_corner;
  for (Eigen::Index i = 0; i < corners.cols(); ++i) {
    CellSum& cell = cells[cell_of(corners.col(i), edge_m)];
    cell.sum += corners.col(i);
    cell.count += 1;
    cell_of_corner.push_back(&cell);
  }
  SimplifiedMesh merged{Eigen::Matrix3Xd(3, corners.cols()), 0};
  std::set<std::array<const CellSum*, 3>> seen;
  Eigen::Index kept = 0;
  for (std::size_t i = 0; i < cell_of_corner.size(); i += 3) {
    std::array<const CellSum*, 3> triangle = {cell_of_corner[i], cell_of_corner[i + 1],
                                              cell_of_corner[i + 2]};
    std::array<const CellSum*, 3> sorted = triangle;
    std::ranges::sort(sorted);
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2] || !seen.insert(sorted).second)
      continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto column = static_cast<Eigen::Index>(i + k);
      merged.corners.col(kept) = triangle[k]->sum / triangle[k]->count;
      merged.error_m =
          std::max(merged.error_m, (merged.corners.col(kept) - corners.col(column)).norm());
      ++kept;
    }
  }
  merged.corners.conservativeResize(3, kept);
  return merged;
}

std::vector<double> rgba_of(const urdf::Visual& visual) {
  if (!visual.material)
    return {};
  const urdf::Color& color = visual.material->color;
  std::vector<double> rgba = {color.r, color.g, color.b, color.a};
  const bool is_proper = std::ranges::all_of(rgba, [](double x) { return x >= 0 && x <= 1; });
  return is_proper && color.a > 0 ? rgba : std::vector<double>();
}

bool is_same_place(const NamedMesh& a, const NamedMesh& b) {
  return a.mesh->filename == b.mesh->filename && a.mesh->scale.x == b.mesh->scale.x &&
         a.mesh->scale.y == b.mesh->scale.y && a.mesh->scale.z == b.mesh->scale.z &&
         a.T_link_mesh.matrix() == b.T_link_mesh.matrix();
}

/// Meshes for collision before those for pictures alone.
std::vector<NamedMesh> named_meshes(const urdf::ModelInterface& model) {
  std::vector<NamedMesh> collisions, visuals;
  for (const auto& [name, link] : model.links_) {
    std::vector<NamedMesh> of_link;
    for (const auto& each : link->collision_array)
      if (each && each->geometry)
        if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(each->geometry.get()))
          of_link.push_back({name, mesh, to_isometry(each->origin), {}, MeshRole::Collision});
    for (const auto& each : link->visual_array) {
      const auto* mesh = each ? dynamic_cast<const urdf::Mesh*>(each->geometry.get()) : nullptr;
      if (mesh == nullptr)
        continue;
      const NamedMesh visual{name, mesh, to_isometry(each->origin), rgba_of(*each)};
      const auto same = std::ranges::find_if(of_link, [&](const NamedMesh& collision) {
        return collision.role == MeshRole::Collision && is_same_place(collision, visual);
      });
      if (same == of_link.end()) {
        visuals.push_back(visual);
      } else {
        same->role = MeshRole::Both;
        same->rgba = visual.rgba;
      }
    }
    collisions.insert(collisions.end(), of_link.begin(), of_link.end());
  }
  collisions.insert(collisions.end(), visuals.begin(), visuals.end());
  return collisions;
}

/// The contents that go, each once, within the caps of a robot.
class Baggage {
 public:
  explicit Baggage(LinkMeshes& to) : to_(to) {}

  void add(const NamedMesh& named, const MeshSource& source) {
    if (const std::optional<std::string> why = try_to_add(named, source))
      to_.notes.push_back("mesh '" + named.mesh->filename + "' of link '" + named.link +
                          "' stays here: " + *why);
  }

 private:
  /// \return why it stays.
  std::optional<std::string> try_to_add(const NamedMesh& named, const MeshSource& source) {
    const auto corners = source(named.mesh->filename);
    if (!corners)
      return corners.error().message;
    if (!*corners)
      return "it is not here";
    const Eigen::Vector3d scale(named.mesh->scale.x, named.mesh->scale.y, named.mesh->scale.z);
    SimplifiedMesh mesh{scale.asDiagonal() * **corners};
    const auto triangles = static_cast<std::size_t>(mesh.corners.cols() / 3);
    if (named.role == MeshRole::Visual && triangles > kMaxVisualTriangles)
      mesh = simplify(mesh.corners, kMaxVisualTriangles);
    const Result<TriangleMesh> canonical = TriangleMesh::from_corners(mesh.corners);
    if (!canonical)
      return canonical.error().message;
    if (auto why = take(*canonical))
      return why;
    if (mesh.error_m > 0)
      to_.notes.push_back("visual '" + named.mesh->filename + "' of link '" + named.link +
                          "': " + std::to_string(mesh.corners.cols() / 3) + " of " +
                          std::to_string(triangles) + " triangles go, within " +
                          number_text(std::ceil(mesh.error_m * 1e6) / 1e3) + " mm");
    to_.meshes.push_back(
        {named.link, named.role, named.T_link_mesh, named.rgba, mesh.error_m, canonical->digest()});
    return std::nullopt;
  }

  std::optional<std::string> take(const TriangleMesh& mesh) {
    const auto over = [](std::size_t bytes, std::size_t limit, const char* what) {
      return std::to_string(bytes) + " bytes" + what + " are over " + std::to_string(limit);
    };
    if (to_.meshes.size() == kMaxLinkMeshes)
      return "the robot has more than " + std::to_string(kMaxLinkMeshes);
    if (mesh.bytes() > kMaxCanonicalMeshBytes)
      return over(mesh.bytes(), kMaxCanonicalMeshBytes, "");
    if (known_.contains(mesh.digest()))
      return std::nullopt;
    MeshContent content = mesh.content();
    if (content.zlib.size() > kMaxMeshZlibBytes)
      return over(content.zlib.size(), kMaxMeshZlibBytes, ", compressed,");
    if (bytes_ + content.zlib.size() > kMaxRobotMeshBytes)
      return over(bytes_ + content.zlib.size(), kMaxRobotMeshBytes, " of all, compressed,");
    bytes_ += content.zlib.size();
    known_.insert(mesh.digest());
    to_.contents.push_back(std::move(content));
    return std::nullopt;
  }

  LinkMeshes& to_;
  std::set<Digest> known_;
  std::size_t bytes_ = 0;
};

}  // namespace

SimplifiedMesh simplify(const Eigen::Matrix3Xd& corners, std::size_t most) {
  if (static_cast<std::size_t>(corners.cols() / 3) <= most)
    return {corners, 0};
  const Eigen::Vector3d extent = corners.rowwise().maxCoeff() - corners.rowwise().minCoeff();
  const double longest_m = extent.maxCoeff();
  const auto merge = [&](int step) {
    return merge_cells(corners, longest_m / kFinestCells * std::pow(kCoarser, step));
  };
  const auto holds = [&](const SimplifiedMesh& merged) {
    return static_cast<std::size_t>(merged.corners.cols() / 3) <= most;
  };
  // Coarser cells leave fewer triangles, nearly always: where they do not, it is not the finest.
  int fine = -1, coarse = static_cast<int>(std::log(kFinestCells) / std::log(kCoarser)) - 2;
  SimplifiedMesh best = merge(coarse);
  while (coarse - fine > 1) {
    const int middle = (fine + coarse) / 2;
    if (SimplifiedMesh merged = merge(middle); holds(merged)) {
      best = std::move(merged);
      coarse = middle;
    } else {
      fine = middle;
    }
  }
  if (holds(best) && best.corners.cols() > 0)
    return best;
  return {corners.leftCols(static_cast<Eigen::Index>(3 * most)), longest_m};
}

LinkMeshes read_link_meshes(const kinematics::RobotModel& robot, const MeshSource& meshes) {
  LinkMeshes read;
  Baggage baggage(read);
  for (const NamedMesh& named : named_meshes(*robot.urdf.tree))
    baggage.add(named, meshes);
  return read;
}

}  // namespace kinship::geometry
