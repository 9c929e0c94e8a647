#include "proto/evidence/machine_speed.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

namespace kinship::evidence {
namespace {

constexpr int kTurns = 1500;
constexpr double kReference_s = 50e-6;  // that the reference machine needs for them
constexpr double kTries_s = 0.4e-3;     // after which no other try begins

double thread_now_s() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// A point after as many turns about x, y and z in turn, each by an angle of its own.
double turned(double angle) {
  double x = 0.3, y = 0.4, z = 0.5;
  for (int i = 0; i < kTurns; ++i) {
    const double sine = std::sin(angle), cosine = std::cos(angle);
    const double turned_y = cosine * y - sine * z, turned_z = sine * y + cosine * z;
    y = turned_z;
    z = x;
    x = turned_y;
    angle += y;
  }
  return x;
}

double measure() {
  const double begin_s = thread_now_s();
  double fastest_s = std::numeric_limits<double>::max();
  for (double now_s = begin_s; now_s - begin_s < kTries_s;) {
    volatile double angle = 0.1;  // so that it is computed here, each time
    volatile const double point = turned(angle);
    static_cast<void>(point);
    const double end_s = thread_now_s();
    fastest_s = std::min(fastest_s, end_s - now_s);
    now_s = end_s;
  }
  return kReference_s / std::max(fastest_s, 1e-6);
}

}  // namespace

double machine_speed() {
  static const double kSpeed = measure();
  return kSpeed;
}

}  // namespace kinship::evidence
