#include <pybind11/stl.h>

#include <cstdint>
#include <memory>
#include <random>
#include <utility>

#include "client/python/arrays.hpp"
#include "client/python/bindings.hpp"
#include "client/python/sampled_distribution.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/mixture/log_density.hpp"
#include "proto/types/enum_text.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::python {
namespace {

using DistributionClass = py::class_<SampledDistribution, std::shared_ptr<SampledDistribution>>;

std::shared_ptr<SampledDistribution> distribution_from_json(const std::string& text) {
  return std::make_shared<SampledDistribution>(
      std::make_shared<const Distribution>(json::distribution_from_json(text).value_or_throw()));
}

/// (K, d, d); one that all components share is there once, seen K times.
py::object covariances_of(const SampledDistribution& self) {
  const Mixture& mixture = self.mixture();
  const Eigen::Index d = mixture.dimension();
  const auto count = static_cast<py::ssize_t>(mixture.covariances().size());
  Array covariances({count, d, d});
  double* next = covariances.mutable_data();
  for (const Eigen::MatrixXd& covariance : mixture.covariances()) {
    Eigen::Map<Eigen::MatrixXd>(next, d, d) = covariance;  // symmetric: either order
    next += d * d;
  }
  if (count == mixture.size())
    return covariances;
  return py::module_::import("numpy").attr("broadcast_to")(covariances,
                                                           py::make_tuple(mixture.size(), d, d));
}

py::dict provenance_of(const SampledDistribution& self) {
  const py::dict document = py::module_::import("json").attr("loads")(json::to_json(*self.value()));
  for (const char* member : {"format", "weights", "means", "covariances", "limits"})
    document.attr("pop")(member);
  return document;
}

Array sample(const SampledDistribution& self, Eigen::Index n, std::optional<std::uint64_t> seed) {
  Eigen::MatrixXd samples;
  {
    const py::gil_scoped_release unlocked;
    samples = self.sample(seed ? *seed : std::random_device{}(), n);
  }
  return to_rows(samples);
}

py::object log_density(const SampledDistribution& self, const Array& q) {
  const Configurations configurations =
      read_configurations(q, self.mixture().dimension(), "the distribution");
  Eigen::VectorXd densities;
  {
    const py::gil_scoped_release unlocked;
    densities = mixture::log_density(*self.value(), configurations.columns);
  }
  if (configurations.is_one)
    return py::float_(densities[0]);
  return to_vector(densities);
}

/// A number of the distribution, read as it is.
template <typename Value>
auto read(Value Distribution::*member) {
  return [member](const SampledDistribution& self) { return (*self.value()).*member; };
}

void bind_mixture(DistributionClass& distribution) {
  distribution
      .def_property_readonly(
          "weights",
          [](const SampledDistribution& self) { return to_vector(self.mixture().weights()); },
          "Of the components: (K,), sum 1.")
      .def_property_readonly(
          "means", [](const SampledDistribution& self) { return to_rows(self.mixture().means()); },
          "(K, dof), joint units.")
      .def_property_readonly("covariances", covariances_of,
                             "(K, dof, dof). One that all share is a read-only view of itself.")
      .def_property_readonly(
          "lower",
          [](const SampledDistribution& self) {
            return to_vector(self.value()->limits.row(0).transpose());
          },
          "Lower joint limits: (dof,).")
      .def_property_readonly(
          "upper",
          [](const SampledDistribution& self) {
            return to_vector(self.value()->limits.row(1).transpose());
          },
          "Upper joint limits: (dof,).")
      .def("sample", sample, py::arg("n"), py::arg("seed") = py::none(),
           R"(Draws n configurations inside the limits: (n, dof). Equal seed, equal samples.

Of the mixture truncated to the limits; continuous joints are turned into [-pi, pi] instead.)")
      .def("log_density", log_density, py::arg("q"),
           R"(Natural logarithm of the density of the mixture, not truncated to the limits.

q  (dof,) or (n, dof), joint units. Returns a number, or (n,).)")
      .def(
          "density",
          [](const SampledDistribution& self, const Array& q) {
            return py::module_::import("numpy").attr("exp")(log_density(self, q));
          },
          py::arg("q"), "The density itself: exp(log_density(q)).");
}

void bind_provenance(DistributionClass& distribution) {
  distribution
      .def_property_readonly(
          "id", [](const SampledDistribution& self) { return self.value()->id.hex(); },
          "What was asked for, as a digest: task, robot, placement, profile, selection.")
      .def_property_readonly("revision", read(&Distribution::revision),
                             "Counts the fits of this id.")
      .def_property_readonly("task", read(&Distribution::task), "What it is for.")
      .def_property_readonly(
          "robot", [](const SampledDistribution& self) { return self.value()->robot.hex(); },
          "Digest of the robot that it is for.")
      .def_property_readonly(
          "T_task_base",
          [](const SampledDistribution& self) { return to_matrix(self.value()->T_task_base); },
          "Where that robot stands in the task's frame: (4, 4), or None: not said.")
      .def_property_readonly(
          "state",
          [](const SampledDistribution& self) { return std::string(to_text(self.value()->state)); },
          "'ready'; 'thin': of a small part of the experience; 'failed': without a mixture.")
      .def_property_readonly("reason", read(&Distribution::reason),
                             "Why it failed; a warning otherwise, mostly empty.")
      .def_property_readonly("configurations", read(&Distribution::configurations),
                             "How many the mixture was fitted to.")
      .def_property_readonly("held_out_score", read(&Distribution::held_out_score),
                             "How well held-out paths are described, nats; None if not chosen by "
                             "that.")
      .def_property_readonly(
          "recommended_share",
          [](const SampledDistribution& self) { return self.value()->advice.recommended_share; },
          "Of guided samples, 0 to 1, as the attempts of the fleet say.")
      .def_property_readonly(
          "evidence", [](const SampledDistribution& self) { return self.value()->advice.evidence; },
          "For that share, in words.")
      .def_property_readonly("provenance", provenance_of,
                             "All that is known of how it was made, but for the mixture: sources, "
                             "fit, filters, evidence, as proto/FORMATS.md names them.");
}

/// The samples of planners: some guided, the others uniform.
class PlanSampler {
 public:
  PlanSampler(planning::ConfigurationSampler sampler, std::uint64_t seed)
      : sampler_(std::move(sampler)), generator_(seed) {}

  /// \return dof x count.
  Eigen::MatrixXd sample(Eigen::Index count) {
    if (count < 0)
      throw std::invalid_argument("sample: n is " + std::to_string(count));
    const std::scoped_lock lock(mutex_);
    Eigen::MatrixXd samples(sampler_.bounds().cols(), count);
    for (auto column : samples.colwise())
      column = sampler_.sample(generator_);
    return samples;
  }

  double share() const noexcept { return sampler_.guided_fraction(); }

 private:
  planning::ConfigurationSampler sampler_;
  std::mutex mutex_;  // guards the generator
  std::mt19937_64 generator_;
};

std::unique_ptr<PlanSampler> make_sampler(const Robot& robot, const Array& start,
                                          const std::shared_ptr<SampledDistribution>& guidance,
                                          std::optional<double> share, std::uint64_t seed) {
  const kinematics::Chain& chain = robot.chain();
  const Configurations from = read_configurations(start, chain.dof(), robot.description().label);
  if (!from.is_one)
    throw std::invalid_argument("Sampler: start is one configuration");
  const Eigen::Matrix2Xd bounds = planning::planning_bounds(chain, from.columns.col(0));
  if (!guidance)
    return std::make_unique<PlanSampler>(planning::ConfigurationSampler(bounds), seed);
  if (guidance->value()->robot != robot.digest())
    throw std::invalid_argument("Sampler: the distribution is for robot " +
                                guidance->value()->robot.short_hex() + ", not for '" +
                                robot.description().label + "', " + robot.digest().short_hex());
  return std::make_unique<PlanSampler>(
      planning::ConfigurationSampler(bounds, chain, guidance->mixture(),
                                     share.value_or(guidance->value()->advice.recommended_share)),
      seed);
}

void bind_sampler(py::module_& module) {
  py::class_<PlanSampler>(module, "Sampler",
                          "Samples for a planner: a share of them from a distribution, the others "
                          "uniform. Threads may share it.")
      .def(py::init(&make_sampler), py::arg("robot"), py::arg("start"),
           py::arg("distribution") = py::none(), py::kw_only(), py::arg("share") = py::none(),
           py::arg("seed") = 0,
           R"(A stream of samples for one query.

start         (dof,): joints wider than a turn are sampled one turn around it
distribution  None: all samples are uniform
share         of guided samples, 0 to 1; by default what the distribution recommends

Raises InvalidInput if the distribution is another robot's.)")
      .def_property_readonly("share", &PlanSampler::share, "Of guided samples, 0 to 1.")
      .def(
          "sample",
          [](PlanSampler& self, Eigen::Index n) {
            Eigen::MatrixXd samples;
            {
              const py::gil_scoped_release unlocked;
              samples = self.sample(n);
            }
            return to_rows(samples);
          },
          py::arg("n"), "The next n configurations within the limits: (n, dof).");
}

}  // namespace

void bind_distributions(py::module_& module) {
  DistributionClass distribution(module, "Distribution",
                                 "A Gaussian mixture over a robot's configurations for one task, "
                                 "and where it comes from. May be shared between threads.");
  bind_mixture(distribution);
  bind_provenance(distribution);
  distribution
      .def_static("from_json", distribution_from_json, py::arg("text"),
                  "Reads what `kinship distributions fetch --json` and to_json() write.")
      .def(
          "to_json", [](const SampledDistribution& self) { return json::to_json(*self.value()); },
          "All of it as a document; numbers come back bit by bit.")
      .def(py::pickle([](const SampledDistribution& self) { return json::to_json(*self.value()); },
                      [](const std::string& text) { return distribution_from_json(text); }))
      .def(
          "__len__", [](const SampledDistribution& self) { return self.mixture().size(); },
          "Number of components.")
      .def("__repr__", [](const SampledDistribution& self) {
        const Distribution& value = *self.value();
        return "<kinship.Distribution " + value.id.short_hex() + " revision " +
               std::to_string(value.revision) + " of '" + value.task + "', " +
               (value.mixture ? std::to_string(value.mixture->size()) + " components" : "failed") +
               ">";
      });
  bind_sampler(module);
}

}  // namespace kinship::python
