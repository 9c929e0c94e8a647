#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/planning_budget.hpp"
#include "robots/planning/repetition_roadmap.hpp"
#include "robots/planning/tree.hpp"

/// The roadmap behind plan_roadmap; for this library's sources only.
namespace kinship::planning {

/// The configurations to check between two, both included, at most a step apart: dof x n. Empty if
/// there is no way.
using Way = std::function<std::optional<Eigen::MatrixXd>(const Eigen::VectorXd& from,
                                                         const Eigen::VectorXd& to)>;
/// Moves a configuration onto a constraint. False if that fails.
using Project = std::function<bool(Eigen::VectorXd& q)>;

/// Vertices and edges of a query, and the results of their checks.
class RoadmapGraph {
 public:
  /// \param goals  at least one; start and goals were found free.
  RoadmapGraph(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals, Way way);

  /// Adds the components' vertices and edges, as plan_roadmap describes.
  void add_components(const ConfigurationSampler& sampler, const Project& project,
                      const RoadmapOptions& options, std::mt19937_64& generator);

  /// Searches the cheapest path without known collisions and checks it, until one is free.
  /// \param max_checks  of the budget, to be spent here.
  /// \return            dof x n from start to a goal; empty if there is none, or no budget.
  std::optional<Eigen::MatrixXd> search(PlanningBudget& budget, std::uint64_t max_checks);

  /// The tree of free edges from the start, or from the goals.
  Tree reached_from_start() const { return reached(0, 1); }
  Tree reached_from_goals() const { return reached(1, goal_count_); }

 private:
  enum class State { Unknown, Free, Blocked };

  struct Vertex {
    Eigen::VectorXd q;
    int component = -1;  // none: start or goal
    State state = State::Unknown;
    std::vector<std::size_t> edges;
  };

  struct Edge {
    std::size_t a = 0, b = 0;
    double length = 0, doubt = 0;
    State state = State::Unknown;
    Eigen::MatrixXd way;  // from a to b, if free
  };

  void link(std::size_t a, std::size_t b, double doubt);
  void link_ends(const class ComponentShapes& shapes, int connections);
  std::vector<std::size_t> cheapest_path() const;
  bool check(const std::vector<std::size_t>& path, PlanningBudget& budget);
  bool check_vertices(const std::vector<std::size_t>& path, PlanningBudget& budget);
  bool check_edge(Edge& edge, PlanningBudget& budget) const;
  bool is_goal(std::size_t vertex) const { return vertex >= 1 && vertex <= goal_count_; }
  std::size_t other_end(const Edge& edge, std::size_t vertex) const {
    return edge.a == vertex ? edge.b : edge.a;
  }
  Eigen::MatrixXd way_from(const Edge& edge, std::size_t vertex) const;
  Eigen::MatrixXd waypoints(const std::vector<std::size_t>& path) const;
  Tree reached(std::size_t first_root, std::size_t count) const;

  Way way_;
  std::size_t goal_count_;
  std::vector<Vertex> vertices_;  // start, goals, then the components' vertices
  std::vector<Edge> edges_;
};

}  // namespace kinship::planning
