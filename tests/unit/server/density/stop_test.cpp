// A fit that nobody waits for any more ends soon, whatever it is at.

#include <gtest/gtest.h>
#include <pthread.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <latch>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "proto/types/stopped.hpp"
#include "server/density/fit.hpp"
#include "server/density/kernel_density.hpp"
#include "server/density/merge.hpp"

namespace kinship::density::stop_test {
namespace {

using namespace std::chrono_literals;

constexpr Eigen::Index kDof = 7;
constexpr Eigen::Index kCount = 150'000;

/// Bundles along 300 paths of 500 configurations.
struct Data {
  Data() : configurations(kDof, kCount), weights(Eigen::VectorXd::Ones(kCount)) {
    std::mt19937_64 generator(7);
    std::normal_distribution<double> noise(0, 0.2);
    for (Eigen::Index i = 0; i < kCount; ++i) {
      for (Eigen::Index joint = 0; joint < kDof; ++joint)
        configurations(joint, i) = static_cast<double>((i / 500 + joint) % 5) + noise(generator);
      path_of_configuration.push_back(static_cast<std::uint32_t>(i / 500));
    }
  }
  Eigen::MatrixXd configurations;
  Eigen::VectorXd weights;
  std::vector<std::uint32_t> path_of_configuration;
};

const Data& data() {
  static const Data kData;
  return kData;
}

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

using Work = std::function<void(const std::stop_token&)>;

/// Lets a work begin and stops it after a while. \return what it computed from then on, s of its
/// thread, which has no others; nothing if it was over by then.
std::optional<double> time_to_stop(const Work& work, std::chrono::milliseconds after) {
  std::stop_source source;
  std::optional<double> end_s;
  clockid_t clock{};
  std::latch begun(1);
  std::thread thread([&] {
    pthread_getcpuclockid(pthread_self(), &clock);
    begun.count_down();
    try {
      work(source.get_token());
    } catch (const Stopped&) {
      end_s = seconds_of(CLOCK_THREAD_CPUTIME_ID);
    }
  });
  begun.wait();
  std::this_thread::sleep_for(after);  // what it is at then is a matter of time
  const double asked_s = seconds_of(clock);
  source.request_stop();
  thread.join();
  return end_s ? std::optional(*end_s - asked_s) : std::nullopt;
}

FitOptions mixture_of(int components, double prior) {
  FitOptions options;
  options.components = components;
  options.prior = prior;
  options.path_of_configuration = data().path_of_configuration;
  return options;
}

void fit(FitOptions options, const std::stop_token& stop) {
  options.computation.stop = stop;
  static_cast<void>(fit_mixture(data().configurations, data().weights, options));
}

FitOptions only_started(int components) {
  FitOptions options = mixture_of(components, 0);
  options.max_iterations = 0;
  return options;
}

/// Computing time of a fit that ends after its start: what this machine and build can do, s.
double reference_s() {
  static const double kReference_s = [options = only_started(900)] {
    const double begun_s = seconds_of(CLOCK_THREAD_CPUTIME_ID);
    fit(options, {});
    return seconds_of(CLOCK_THREAD_CPUTIME_ID) - begun_s;
  }();
  return kReference_s;
}

/// Stopped at several moments, each ends within a fraction of the reference's computing time.
void expect_stops(const char* what, const Work& work) {
  const double kSoon_s = 0.25 * reference_s();
  constexpr int kEnough = 3;
  double most_s = 0;
  int stopped = 0;
  for (const auto after : {1ms, 20ms, 60ms, 150ms, 300ms, 700ms}) {
    const std::optional<double> left_s = time_to_stop(work, after);
    if (!left_s)
      break;  // it was over by itself
    ++stopped;
    EXPECT_LT(*left_s, kSoon_s) << what << " after " << after.count() << " ms";
    most_s = std::max(most_s, *left_s);
  }
  EXPECT_GE(stopped, kEnough) << what;
  testing::Test::RecordProperty(what, std::to_string(most_s));
}

TEST(StoppedFit, OfAThousandComponentsEndsSoon) {
  expect_stops("mixture", [](const std::stop_token& stop) { fit(mixture_of(1000, 20), stop); });
}

TEST(StoppedFit, ThatChoosesItsComponentsAndPriorEndsSoon) {
  expect_stops("choice",
               [](const std::stop_token& stop) { fit(mixture_of(0, kChosenPrior), stop); });
}

TEST(StoppedFit, OfKernelsEndsSoon) {
  expect_stops("kernels", [](const std::stop_token& stop) {
    KernelDensityOptions options;
    options.floors_of_joints = Eigen::VectorXd::Constant(kDof, 1e-4);
    options.path_of_configuration = data().path_of_configuration;
    options.computation.stop = stop;
    static_cast<void>(estimate_kernel_density(data().configurations, data().weights, options));
  });
}

TEST(StoppedFit, FromTheMixtureBeforeEndsSoon) {
  const Mixture before = fit_mixture(data().configurations, data().weights, only_started(900))
                             .value_or_throw()
                             .mixture;
  FitOptions options = mixture_of(890, 0);
  options.warm_start = {before, std::vector<std::uint8_t>(kCount, 0)};
  for (std::size_t i = 0; i < kCount; i += 7)
    options.warm_start->is_new[i] = 1;
  expect_stops("warm", [&](const std::stop_token& stop) { fit(options, stop); });
}

TEST(StoppedFit, BeforeItBeganComputesNothing) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(fit(mixture_of(50, 0), source.get_token()), Stopped);
  const Mixture pair(Eigen::Vector2d(0.5, 0.5), Eigen::Matrix2d::Identity(),
                     {Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Identity()});
  EXPECT_THROW(static_cast<void>(merged(pair, 1, source.get_token())), Stopped);
}

}  // namespace
}  // namespace kinship::density::stop_test
