// Dev harness: guided queries of a study's tuning instances, from learning sets on disk.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>

#include "client/experiments/pipeline/fleet.hpp"
#include "client/experiments/pipeline/learning_set.hpp"
#include "client/experiments/shelf_problems.hpp"
#include "client/experiments/studies/study.hpp"
#include "client/planner/plan_problem.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

using namespace kinship;
using namespace kinship::experiments;

namespace {
std::vector<Eigen::Isometry3d> pose_path(const kinematics::Chain& chain, const Eigen::Isometry3d& T,
                                         const Eigen::MatrixXd& w, int n) {
  std::vector<double> s{0};
  for (Eigen::Index i = 1; i < w.cols(); ++i)
    s.push_back(s.back() + (w.col(i) - w.col(i - 1)).norm());
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < n; ++i) {
    const double at = s.back() * i / (n - 1);
    std::size_t k = 1;
    while (k + 1 < s.size() && s[k] < at) ++k;
    const double f = s[k] > s[k - 1] ? (at - s[k - 1]) / (s[k] - s[k - 1]) : 0;
    const Eigen::VectorXd q = w.col(Eigen::Index(k) - 1) + std::clamp(f, 0., 1.) * (w.col(Eigen::Index(k)) - w.col(Eigen::Index(k) - 1));
    poses.push_back(T * kinematics::T_base_transfer(chain, q));
  }
  return poses;
}
struct Variant { std::string name; planner::Guidance g; bool guided = true; planning::TrackOptions t{}; };
double quantile(std::vector<double> v, double p) { std::sort(v.begin(), v.end()); return v[std::size_t(p * double(v.size() - 1))]; }
}  // namespace

// guidance_bench STUDY LEARNING_DIR COUNT SOURCE|all-but TARGET[,..] INSTANCES SEEDS VARIANT...
int main(int argc, char** argv) {
  const std::string name = argv[1];
  Study shelf;
  if (name == "shelf") {
    shelf.name = "shelf";
    for (const char* m : {"panda", "iiwa14", "ur10e"}) shelf.robots.push_back({m, shelf_placement(m), {}});
    shelf.learning_instances = 60;
    shelf.make_instances = [](const models::LoadedRobot& robot, const StudyRobot& placed) -> DrawInstance {
      return [copy = std::make_shared<models::LoadedRobot>(robot), T = placed.T_task_base](std::uint64_t seed, std::uint32_t i) { return draw_shelf_problem(*copy, T, seed, i); };
    };
  }
  const Study& study = name == "shelf" ? shelf : find_study(name);
  const auto fleet = load_fleet(study, std::string(KINSHIP_SOURCE_DIR) + "/robots/models");
  const std::size_t count = std::stoul(argv[3]);
  const std::string source = argv[4], target = argv[5];
  const unsigned instances = std::stoul(argv[6]), seeds = std::stoul(argv[7]);
  std::map<std::string, std::vector<Attempt>> sets;
  for (std::size_t r = 0; r < fleet.size(); ++r) {
    RecordingOptions o; o.folder = argv[2]; o.instances = unsigned(std::max<std::size_t>(count, study.learning_instances)); o.threads = 2;
    sets[fleet[r].label()] = record_learning_set(study, fleet, r, o);
  }
  std::printf("%-28s %-8s %-8s n=%u | ratio mean median p95 | time | checks | cpu us/query guidance\n", "variant", "target", "source", instances * seeds);
  for (std::size_t r = 0; r < fleet.size(); ++r) {
    const auto& m = fleet[r];
    if (target != "all" && target != m.label()) continue;
    TaskExperience e;
    if (source == "straight" || source == "retreat" || source == "rules")
      for (int k = source == "retreat" ? 1 : 0; k < (source == "straight" ? 1 : 2); ++k) {
        PosePath path; path.source = m.digest;
        for (int i = 0; i < 40; ++i) {
          const double s = i / 39.0;
          path.poses.push_back(Eigen::Isometry3d(Eigen::Translation3d(0, 0, k == 1 ? -0.4 * std::min(1.0, (1 - s) / 0.5) : 0)));
        }
        e.paths.push_back(path);
      }
    for (const auto& f : fleet) {
      const bool own = &f == &m;
      if (source == "own" ? !own : source == "others" ? own : source != f.label()) continue;
      std::size_t n = 0;
      for (const Attempt& a : sets[f.label()]) {
        if (n++ >= count) break;
        if (!a.path) continue;
        e.paths.push_back({f.digest, a.report_uuid, pose_path(f.robot.chain, f.placed.T_task_base, a.path->waypoints(), getenv("POSES") ? atoi(getenv("POSES")) : 40)});
      }
    }
    if (getenv("RULE")) {
        PosePath path; path.source = m.digest;
        for (int i = 0; i < 40; ++i) {
          const double s = i / 39.0;
          path.poses.push_back(Eigen::Isometry3d(Eigen::Translation3d(50, 50, -0.4 * std::min(1.0, (1 - s) / 0.5))));
        }
        e.paths.push_back(path);
    }
    std::vector<Variant> variants;
    planner::Guidance base; base.guided_fraction = 1; base.experience = std::make_shared<planning::ExperienceGuide>(m.robot.chain, e);
    variants.push_back({"uniform", base, false});
    for (int i = 8; i < argc; ++i) {  // samples:checks:deviation:paths:tracks
      Variant v{argv[i], base};
      double a, b, d; int p, t;
      if (std::sscanf(argv[i], "%lf:%lf:%lf:%d:%d", &a, &b, &d, &p, &t) != 5) throw std::runtime_error("variant");
      v.t = {.paths = std::size_t(p), .tracks = std::size_t(t), .deviation = d, .sample_fraction = a, .check_fraction = b};
      variants.push_back(v);
    }
    std::map<std::string, std::vector<double>> checks, times; std::map<std::string, int> unsolved;
    for (unsigned i = 0; i < instances; ++i) {
      Problem p = read_instance(m, seed_of(InstanceSet::Tuning, r), i);
      const auto own = p.seed;
      for (unsigned s = 0; s < seeds; ++s) {
        p.seed = own + s;
        for (auto& v : variants) {
          planner::QueryGuidance q;
          if (v.guided) q = {.guidance = &v.g, .sampling_mode = SamplingMode::Guided};
          auto settings = study.settings; settings.tracks = v.t;
          const auto done = planner::plan_problem(m.planned, p, q, settings, [] { return false; });
          checks[v.name].push_back(double(done.result.collision_checks));
          times[v.name].push_back(done.result.planning_time_s);
          unsolved[v.name] += !done.result.solved;
        }
      }
    }
    auto mean = [](const std::vector<double>& v) { double s = 0; for (double x : v) s += x; return s / double(v.size()); };
    for (auto& v : variants) {
      const auto& u = checks["uniform"]; const auto& c = checks[v.name];
      std::printf("%-28s %-8s %-8s | %5.2f %5.2f %5.2f | %5.2f | mean %7.0f med %6.0f p95 %7.0f | unsolved %d | %.0f us\n", v.name.c_str(), m.label().c_str(), source.c_str(),
        mean(u) / mean(c), quantile(u, .5) / quantile(c, .5), quantile(u, .95) / quantile(c, .95), mean(times["uniform"]) / mean(times[v.name]), mean(c), quantile(c, .5), quantile(c, .95), unsolved[v.name], 1e6 * mean(times[v.name]));
    }
    std::fflush(stdout);
  }
}
