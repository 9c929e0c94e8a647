#include "robots/planning/roadmap_graph.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "proto/mixture/cholesky.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/guided_sampler.hpp"
#include "robots/planning/path_vertices.hpp"

namespace kinship::planning {
namespace {

constexpr int kMaxDraws = 10;  // per vertex, until one lies within the bounds
constexpr double kClose = 1;   // Bhattacharyya distance

double half_log_determinant(const Eigen::MatrixXd& factor) {
  return factor.diagonal().array().log().sum();
}

}  // namespace

/// The components of a sampler's mixture, their means moved into its bounds where a turn fits.
class ComponentShapes {
 public:
  /// \param sampler  with a mixture.
  explicit ComponentShapes(const ConfigurationSampler& sampler);

  Eigen::Index size() const noexcept { return means_.cols(); }
  Eigen::VectorXd mean(Eigen::Index k) const { return means_.col(k); }
  const Eigen::MatrixXd& factor(Eigen::Index k) const { return factors_[index(k)]; }

  /// Squared Mahalanobis distance per joint, the component's variances widened by kGateVariance.
  double doubt(Eigen::Index k, const Eigen::VectorXd& q) const;
  double min_doubt(const Eigen::VectorXd& q) const;

  /// Pairs (i < j) of close components, see plan_roadmap.
  std::vector<std::pair<Eigen::Index, Eigen::Index>> links(int neighbours) const;

 private:
  /// Of component k among covariances and their factors.
  std::size_t index(Eigen::Index k) const noexcept {
    return factors_.size() == 1 ? 0 : static_cast<std::size_t>(k);
  }
  double bhattacharyya_distance(Eigen::Index i, Eigen::Index j) const;

  Eigen::MatrixXd means_;
  std::vector<Eigen::MatrixXd> covariances_;
  std::vector<Eigen::MatrixXd> factors_, widened_factors_;  // lower Cholesky factors
};

ComponentShapes::ComponentShapes(const ConfigurationSampler& sampler)
    : means_(sampler.mixture()->means()),
      covariances_(sampler.mixture()->covariances()),
      factors_(mixture::cholesky_factors(*sampler.mixture())),
      widened_factors_(mixture::cholesky_factors(widened(*sampler.mixture()))) {
  for (Eigen::Index k = 0; k < means_.cols(); ++k)
    if (const auto moved = sampler.moved_into_bounds(means_.col(k)))
      means_.col(k) = *moved;
}

double ComponentShapes::doubt(Eigen::Index k, const Eigen::VectorXd& q) const {
  Eigen::VectorXd offset = q - means_.col(k);
  widened_factors_[index(k)].triangularView<Eigen::Lower>().solveInPlace(offset);
  return offset.squaredNorm() / static_cast<double>(offset.size());
}

double ComponentShapes::min_doubt(const Eigen::VectorXd& q) const {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < size(); ++k)
    least = std::min(least, doubt(k, q));
  return least;
}

// Kailath, The Divergence and Bhattacharyya Distance Measures in Signal Selection (1967).
double ComponentShapes::bhattacharyya_distance(Eigen::Index i, Eigen::Index j) const {
  const std::size_t first = index(i), second = index(j);
  const Eigen::MatrixXd factor = ((covariances_[first] + covariances_[second]) / 2).llt().matrixL();
  Eigen::VectorXd offset = means_.col(i) - means_.col(j);
  factor.triangularView<Eigen::Lower>().solveInPlace(offset);
  return offset.squaredNorm() / 8 + half_log_determinant(factor) -
         (half_log_determinant(factors_[first]) + half_log_determinant(factors_[second])) / 2;
}

std::vector<std::pair<Eigen::Index, Eigen::Index>> ComponentShapes::links(int neighbours) const {
  Eigen::MatrixXd distances = Eigen::MatrixXd::Zero(size(), size());
  for (Eigen::Index i = 0; i < size(); ++i)
    for (Eigen::Index j = i + 1; j < size(); ++j)
      distances(i, j) = distances(j, i) = bhattacharyya_distance(i, j);
  std::set<std::pair<Eigen::Index, Eigen::Index>> close;
  std::vector<Eigen::Index> others(static_cast<std::size_t>(size()));
  for (Eigen::Index i = 0; i < size(); ++i) {
    std::iota(others.begin(), others.end(), Eigen::Index{0});
    others.erase(others.begin() + i);
    std::stable_sort(others.begin(), others.end(), [&](Eigen::Index a, Eigen::Index b) {
      return distances(a, i) < distances(b, i);
    });
    int rank = 0;
    for (const Eigen::Index j : others)
      if (rank++ < neighbours || distances(j, i) <= kClose)
        close.emplace(std::min(i, j), std::max(i, j));
    others.push_back(0);
  }
  return {close.begin(), close.end()};
}

RoadmapGraph::RoadmapGraph(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals, Way way)
    : way_(std::move(way)), goal_count_(static_cast<std::size_t>(goals.cols())) {
  vertices_.push_back({start, -1, State::Free, {}});
  for (const auto& goal : goals.colwise())
    vertices_.push_back({goal, -1, State::Free, {}});
}

void RoadmapGraph::add_components(const ConfigurationSampler& sampler, const Project& project,
                                  const RoadmapOptions& options, std::mt19937_64& generator) {
  const ComponentShapes shapes(sampler);
  std::vector<std::vector<std::size_t>> members(static_cast<std::size_t>(shapes.size()));
  std::normal_distribution<double> normal;
  const auto add = [&](Eigen::Index k, const Eigen::VectorXd& drawn) {
    auto q = sampler.moved_into_bounds(drawn);
    if (!q || !project(*q))
      return false;
    members[static_cast<std::size_t>(k)].push_back(vertices_.size());
    vertices_.push_back({*std::move(q), static_cast<int>(k), State::Unknown, {}});
    return true;
  };
  for (Eigen::Index k = 0; k < shapes.size(); ++k) {
    add(k, shapes.mean(k));
    for (int draw = 0; draw < options.draws; ++draw)
      for (int attempt = 0; attempt < kMaxDraws; ++attempt) {
        const Eigen::VectorXd standard =
            Eigen::VectorXd::NullaryExpr(shapes.mean(k).size(), [&] { return normal(generator); });
        if (add(k, shapes.mean(k) + shapes.factor(k) * standard))
          break;
      }
  }
  const auto link_all = [&](Eigen::Index i, Eigen::Index j) {
    for (const std::size_t a : members[static_cast<std::size_t>(i)])
      for (const std::size_t b : members[static_cast<std::size_t>(j)])
        if (i != j || a < b) {
          const Eigen::VectorXd middle = (vertices_[a].q + vertices_[b].q) / 2;
          link(a, b, std::min(shapes.doubt(i, middle), shapes.doubt(j, middle)));
        }
  };
  for (Eigen::Index k = 0; k < shapes.size(); ++k)
    link_all(k, k);
  for (const auto& [i, j] : shapes.links(options.neighbours))
    link_all(i, j);
  link_ends(shapes, options.connections);
}

void RoadmapGraph::link_ends(const ComponentShapes& shapes, int connections) {
  const std::size_t first = 1 + goal_count_;
  std::vector<std::pair<double, std::size_t>> nearest;
  for (std::size_t end = 0; end < first; ++end) {
    nearest.clear();
    for (std::size_t v = first; v < vertices_.size(); ++v)
      nearest.emplace_back((vertices_[v].q - vertices_[end].q).norm(), v);
    std::sort(nearest.begin(), nearest.end());
    nearest.resize(std::min(nearest.size(), static_cast<std::size_t>(connections)));
    if (end > 0)
      nearest.emplace_back(0.0, 0);  // the start
    for (const auto& [distance, v] : nearest)
      link(end, v, shapes.min_doubt((vertices_[end].q + vertices_[v].q) / 2));
  }
}

void RoadmapGraph::link(std::size_t a, std::size_t b, double doubt) {
  const double length = (vertices_[a].q - vertices_[b].q).norm();
  if (length == 0)
    return;
  vertices_[a].edges.push_back(edges_.size());
  vertices_[b].edges.push_back(edges_.size());
  edges_.push_back({a, b, length, doubt, State::Unknown, {}});
}

std::optional<Eigen::MatrixXd> RoadmapGraph::search(PlanningBudget& budget,
                                                    std::uint64_t max_checks) {
  while (budget.checks() < max_checks && !budget.exhausted()) {
    const std::vector<std::size_t> path = cheapest_path();
    if (path.empty())
      return std::nullopt;
    if (check(path, budget))
      return waypoints(path);
  }
  return std::nullopt;
}

std::vector<std::size_t> RoadmapGraph::cheapest_path() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::size_t none = edges_.size();
  std::vector<double> costs(vertices_.size(), kInfinity), least_rest(vertices_.size(), kInfinity);
  for (std::size_t v = 0; v < vertices_.size(); ++v)
    for (std::size_t goal = 1; goal <= goal_count_; ++goal)
      least_rest[v] = std::min(least_rest[v], (vertices_[v].q - vertices_[goal].q).norm());
  std::vector<std::size_t> arrived_by(vertices_.size(), none);
  std::vector<bool> closed(vertices_.size(), false);
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  costs[0] = 0;
  open.emplace(least_rest[0], 0);
  while (!open.empty()) {
    std::size_t vertex = open.top().second;
    open.pop();
    if (closed[vertex])
      continue;
    closed[vertex] = true;
    if (is_goal(vertex)) {
      std::vector<std::size_t> path;
      for (; vertex != 0; vertex = other_end(edges_[arrived_by[vertex]], vertex))
        path.push_back(arrived_by[vertex]);
      std::reverse(path.begin(), path.end());
      return path;
    }
    for (const std::size_t e : vertices_[vertex].edges) {
      const std::size_t next = other_end(edges_[e], vertex);
      if (edges_[e].state == State::Blocked || vertices_[next].state == State::Blocked)
        continue;
      const double cost = costs[vertex] + edges_[e].length * (1 + edges_[e].doubt);
      if (cost < costs[next]) {
        costs[next] = cost;
        arrived_by[next] = e;
        open.emplace(cost + least_rest[next], next);
      }
    }
  }
  return {};
}

bool RoadmapGraph::check(const std::vector<std::size_t>& path, PlanningBudget& budget) {
  if (!check_vertices(path, budget))
    return false;
  std::vector<std::size_t> doubtful;
  for (const std::size_t e : path)
    if (edges_[e].state == State::Unknown)
      doubtful.push_back(e);
  std::stable_sort(doubtful.begin(), doubtful.end(), [&](std::size_t a, std::size_t b) {
    return edges_[a].length * edges_[a].doubt > edges_[b].length * edges_[b].doubt;
  });
  return std::all_of(doubtful.begin(), doubtful.end(),
                     [&](std::size_t e) { return check_edge(edges_[e], budget); });
}

bool RoadmapGraph::check_vertices(const std::vector<std::size_t>& path, PlanningBudget& budget) {
  bool free = true;
  for (const std::size_t e : path)
    for (const std::size_t v : {edges_[e].a, edges_[e].b}) {
      Vertex& vertex = vertices_[v];
      if (vertex.state == State::Unknown && !budget.exhausted())
        vertex.state = budget.is_free(vertex.q) ? State::Free : State::Blocked;
      free = free && vertex.state == State::Free;
    }
  return free;
}

bool RoadmapGraph::check_edge(Edge& edge, PlanningBudget& budget) const {
  auto way = way_(vertices_[edge.a].q, vertices_[edge.b].q);
  edge.state = State::Blocked;
  if (!way)
    return false;
  const Eigen::MatrixXd asked = middles_first(*way);  // its ends are free
  if (budget.free_ahead(asked) < asked.cols())
    return false;
  edge.state = State::Free;
  edge.way = *std::move(way);
  return true;
}

Eigen::MatrixXd RoadmapGraph::way_from(const Edge& edge, std::size_t vertex) const {
  if (edge.a == vertex)
    return edge.way;
  return edge.way.rowwise().reverse();
}

Eigen::MatrixXd RoadmapGraph::waypoints(const std::vector<std::size_t>& path) const {
  Eigen::MatrixXd waypoints = vertices_[0].q;
  std::size_t vertex = 0;
  for (const std::size_t e : path) {
    const Eigen::MatrixXd way = way_from(edges_[e], vertex);
    const Eigen::Index before = waypoints.cols();
    waypoints.conservativeResize(Eigen::NoChange, before + way.cols() - 1);
    waypoints.rightCols(way.cols() - 1) = way.rightCols(way.cols() - 1);
    vertex = other_end(edges_[e], vertex);
  }
  return waypoints;
}

Tree RoadmapGraph::reached(std::size_t first_root, std::size_t count) const {
  Tree tree(vertices_[0].q.size());
  std::vector<Eigen::Index> nodes(vertices_.size(), -1);
  std::queue<std::size_t> pending;
  for (std::size_t root = first_root; root < first_root + count; ++root) {
    nodes[root] = tree.add(vertices_[root].q, -1);
    pending.push(root);
  }
  for (; !pending.empty(); pending.pop()) {
    const std::size_t vertex = pending.front();
    for (const std::size_t e : vertices_[vertex].edges) {
      const std::size_t next = other_end(edges_[e], vertex);
      if (edges_[e].state != State::Free || nodes[next] >= 0)
        continue;
      const Eigen::MatrixXd way = way_from(edges_[e], vertex);
      Eigen::Index node = nodes[vertex];
      for (Eigen::Index i = 1; i < way.cols(); ++i)
        node = tree.add(way.col(i), node);
      nodes[next] = node;
      pending.push(next);
    }
  }
  return tree;
}

}  // namespace kinship::planning
