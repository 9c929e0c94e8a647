#include "client/ompl/planner_data.hpp"

#include <ompl/base/PlannerDataStorage.h>

#include <algorithm>
#include <boost/archive/archive_exception.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <queue>
#include <set>
#include <string>
#include <utility>

#include "proto/types/failure.hpp"
#include "proto/types/turn.hpp"

namespace kinship::ompl_planners {
namespace {

constexpr std::uint_fast32_t kMarker = 0x5044414D;  // "PDAM", OMPL's

/// Vertices and edges of a file, without OMPL's states.
class Roadmap : private ompl::base::PlannerDataStorage {
 public:
  /// \throws Failure(InvalidInput) or an exception of Boost.
  Roadmap(std::istream& stream, const kinematics::Chain& chain) : chain_(chain), dof_(chain.dof()) {
    boost::archive::binary_iarchive archive(stream);
    Header header;
    archive >> header;
    if (header.marker != kMarker)
      throw Failure(ErrorCode::InvalidInput, "is no planner data of OMPL");
    check_signature(header.signature);
    for (std::size_t i = 0; i < header.vertex_count; ++i)
      read_vertex(archive);
    neighbours_.resize(vertices_.size());
    for (std::size_t i = 0; i < header.edge_count; ++i)
      read_edge(archive);
  }

  RoadmapPaths paths() const {
    RoadmapPaths result;
    std::set<std::size_t> used, reached;
    for (const std::size_t start : starts_) {
      const std::vector<std::size_t> before = nearest_before(start);
      for (const std::size_t goal : goals_) {
        if (before[goal] == kNone || goal == start)
          continue;
        if (result.paths.size() == kMaxRoadmapPaths)
          throw Failure(ErrorCode::TooLarge,
                        "more than " + std::to_string(kMaxRoadmapPaths) + " ways to a goal");
        reached.insert(goal);
        std::vector<std::size_t> way = {goal};
        while (way.back() != start)
          way.push_back(before[way.back()]);
        used.insert(way.begin(), way.end());
        result.paths.push_back(path_of(way));
      }
    }
    result.without_way = goals_.size() - reached.size();
    result.other_vertices = vertices_.size() - used.size();
    return result;
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  /// Of one space, not of several together: its kind and its dimension.
  void check_signature(const std::vector<int>& signature) {
    const auto is_of = [&](int kind) {
      return signature == std::vector<int>{2, kind, static_cast<int>(dof_)};
    };
    if (is_of(ompl::base::STATE_SPACE_UNKNOWN)) {
      skipped_ = sizeof(int);  // MoveIt's tag of a state
      return;
    }
    if (is_of(ompl::base::STATE_SPACE_REAL_VECTOR))
      return;
    std::string numbers;
    for (const int number : signature)
      numbers += (numbers.empty() ? "" : " ") + std::to_string(number);
    throw Failure(ErrorCode::InvalidInput,
                  "its states are not " + std::to_string(dof_) +
                      " real numbers, the robot's joints: the space's signature is (" + numbers +
                      ")");
  }

  void read_vertex(boost::archive::binary_iarchive& archive) {
    PlannerDataVertexData data{};
    archive >> data;
    const std::unique_ptr<const ompl::base::PlannerDataVertex> owner(data.v_);
    const auto bytes = static_cast<std::size_t>(dof_) * sizeof(double);
    if (data.state_.size() != skipped_ + bytes)
      throw Failure(ErrorCode::InvalidInput,
                    "a state of " + std::to_string(data.state_.size()) + " bytes");
    Eigen::VectorXd q(dof_);
    std::memcpy(q.data(), data.state_.data() + skipped_, bytes);
    if (!q.allFinite())
      throw Failure(ErrorCode::InvalidInput, "a state that is not finite");
    if (data.type_ == PlannerDataVertexData::START)
      starts_.push_back(vertices_.size());
    if (data.type_ == PlannerDataVertexData::GOAL)
      goals_.push_back(vertices_.size());
    vertices_.push_back(std::move(q));
  }

  void read_edge(boost::archive::binary_iarchive& archive) {
    PlannerDataEdgeData data{};
    archive >> data;
    const std::unique_ptr<const ompl::base::PlannerDataEdge> owner(data.e_);
    const auto [from, to] = data.endpoints_;
    if (from >= vertices_.size() || to >= vertices_.size())
      throw Failure(ErrorCode::InvalidInput, "an edge to a vertex that is not there");
    neighbours_[from].push_back(to);
    neighbours_[to].push_back(from);
  }

  /// Dijkstra's: for each vertex the one before it on its shortest way; kNone: no way, or the
  /// start.
  std::vector<std::size_t> nearest_before(std::size_t start) const {
    std::vector<double> distance(vertices_.size(), std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(vertices_.size(), kNone);
    std::priority_queue<std::pair<double, std::size_t>> open;  // by distance, negative
    distance[start] = 0;
    open.emplace(0, start);
    while (!open.empty()) {
      const auto [negative, vertex] = open.top();
      open.pop();
      if (-negative > distance[vertex])
        continue;
      for (const std::size_t next : neighbours_[vertex]) {
        const double length =
            distance[vertex] +
            (end_of_edge(vertices_[vertex], vertices_[next]) - vertices_[vertex]).norm();
        if (length >= distance[next])
          continue;
        distance[next] = length;
        before[next] = vertex;
        open.emplace(-length, next);
      }
    }
    return before;
  }

  /// The end of an edge as its motion gets there. MoveIt keeps continuous joints within a turn, and
  /// they go the shorter way; those of a space of real numbers go where the numbers do.
  Eigen::VectorXd end_of_edge(const Eigen::VectorXd& from, Eigen::VectorXd to) const {
    if (is_of_moveit())
      for (Eigen::Index i = 0; i < dof_; ++i)
        if (chain_.joints()[static_cast<std::size_t>(i)].type == kinematics::JointType::Continuous)
          to[i] -= kTurn * std::round((to[i] - from[i]) / kTurn);
    return to;
  }

  /// \param way  from the goal back.
  Path path_of(const std::vector<std::size_t>& way) const {
    Eigen::MatrixXd waypoints(dof_, static_cast<Eigen::Index>(way.size()));
    waypoints.col(0) = vertices_[way.back()];
    for (std::size_t i = 1; i < way.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      waypoints.col(column) =
          end_of_edge(waypoints.col(column - 1), vertices_[way[way.size() - 1 - i]]);
    }
    return Path(std::move(waypoints));
  }

  bool is_of_moveit() const noexcept { return skipped_ > 0; }

  const kinematics::Chain& chain_;
  Eigen::Index dof_;
  std::size_t skipped_ = 0;  // bytes of a state before its numbers
  std::vector<Eigen::VectorXd> vertices_;
  std::vector<std::size_t> starts_, goals_;
  std::vector<std::vector<std::size_t>> neighbours_;
};

}  // namespace

RoadmapPaths read_planner_data(const std::filesystem::path& file, const kinematics::Chain& chain) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw Failure(ErrorCode::NotFound, "'" + file.string() + "' cannot be read");
  const auto refuse = [&](ErrorCode code, const std::string& why) {
    throw Failure(code, "'" + file.string() + "': " + why);
  };
  try {
    return Roadmap(stream, chain).paths();
  } catch (const Failure& failure) {
    refuse(failure.code(), failure.what());
  } catch (const std::exception& error) {  // of Boost, or for want of memory
    refuse(ErrorCode::InvalidInput, std::string("is no planner data of OMPL: ") + error.what());
  }
  return {};
}

}  // namespace kinship::ompl_planners
