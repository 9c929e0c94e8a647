#include "robots/planning/roadmap_graph.hpp"

#include <algorithm>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

#include "robots/planning/component_links.hpp"
#include "robots/planning/path_vertices.hpp"

namespace kinship::planning {
namespace {

constexpr int kMaxDraws = 10;  // per vertex, until one lies within the bounds

}  // namespace

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
