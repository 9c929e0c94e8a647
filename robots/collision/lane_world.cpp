#include "robots/collision/lane_world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <iterator>

#include "proto/types/limits.hpp"
#include "proto/types/turn.hpp"

namespace kinship::collision {
namespace {

constexpr double kAlike = 1e-12;
constexpr double kOfFloats = 1 + 1e-6;  // rounded, no number is less
constexpr std::size_t kTried = 4;       // axes of so many boxes

}  // namespace

static_assert(kLaneJoints == kMaxDof);

namespace {

struct KnownSets {
  std::array<LaneSet, 4> sets;
  std::size_t count = 0;
};

KnownSets known_sets() {
  KnownSets known;
  known.sets[known.count++] = {"sse2", check_lanes_sse2};
#ifdef KINSHIP_SIMD_X86
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    known.sets[known.count++] = {"avx2", check_lanes_avx2};
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    known.sets[known.count++] = {"avx512vl", check_lanes_avx512vl};
    known.sets[known.count++] = {"avx512", check_lanes_avx512};
  }
#endif
  return known;
}

/// For so many lanes: the narrowest that has room for all, of the two that are the widest. Machines
/// that know vectors of sixteen often take twice as long for them.
const LaneSet& fastest(Eigen::Index lanes) {
  const std::span<const LaneSet> sets = lane_sets();
  return lanes <= kLanes / 2 && sets.size() > 2 ? sets[sets.size() - 2] : sets.back();
}

typedef double Pair __attribute__((vector_size(16)));
typedef long long PairBits __attribute__((vector_size(16)));

inline Pair load(const double* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof pair);
  return pair;
}

}  // namespace

std::span<const LaneSet> lane_sets() {
  static const KnownSets kKnown = known_sets();
  return {kKnown.sets.data(), kKnown.count};
}

bool LaneWorld::add_doubts(int lane, std::vector<LaneDoubt>& doubts) const {
  if (!has_room_ || (beyond_ >> lane & 1U) != 0 || question_.doubts > kLaneDoubts)
    return false;
  std::ranges::copy_if(std::span(question_.doubt).first(static_cast<std::size_t>(question_.doubts)),
                       std::back_inserter(doubts),
                       [lane](const LaneDoubt& doubt) { return (doubt.lanes >> lane & 1U) != 0; });
  return true;
}

bool LaneWorld::doubtful_pairs(int lane, std::vector<BodyPair>& pairs) {
  doubts_.clear();
  if (!add_doubts(lane, doubts_))
    return false;
  pairs.clear();
  for (const LaneDoubt& doubt : doubts_)
    pairs.emplace_back(index_of_body_[static_cast<std::size_t>(doubt.body)],
                       doubt.obstacle >= 0
                           ? index_of_obstacle_[static_cast<std::size_t>(doubt.obstacle)]
                           : index_of_body_[static_cast<std::size_t>(doubt.other)]);
  return true;
}

LaneAnswer LaneWorld::ask(const Eigen::Ref<const Eigen::MatrixXd>& qs, const LaneSet& set) {
  return answer(qs, set, LaneScope::Each);
}

LaneAnswer LaneWorld::ask(const Eigen::Ref<const Eigen::MatrixXd>& qs, LaneScope scope) {
  return answer(qs, fastest(qs.cols()), scope);
}

LaneAnswer LaneWorld::ask_grown(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                                const Eigen::Ref<const Eigen::MatrixXd>& changes,
                                const LaneRoom& room, LaneScope scope,
                                std::span<const LaneDoubt> only) {
  question_.standing_room = static_cast<float>(room.standing_m * kOfFloats);
  question_.moving_room = static_cast<float>(room.moving_m * kOfFloats);
  question_.moves = changes.cols() > 0;
  if (question_.moves)
    write_changes(changes);
  if (!only.empty()) {
    std::ranges::copy(only, std::begin(question_.pair));
    question_.pairs = static_cast<int>(only.size());
  }
  const LaneAnswer said = answer(qs, fastest(qs.cols()), scope);
  question_.standing_room = question_.moving_room = 0;
  question_.moves = false;
  question_.pairs = -1;
  return said;
}

void LaneWorld::write_changes(const Eigen::Ref<const Eigen::MatrixXd>& changes) {
  const std::size_t dof = joints_.size() - mimics_.size();
  const auto written = [](double change) {
    return static_cast<float>(std::abs(change) * kOfFloats);
  };
  for (Eigen::Index i = 0; i < changes.cols(); ++i) {
    const auto lane = static_cast<std::size_t>(i);
    for (std::size_t j = 0; j < dof; ++j)
      question_.change[j][lane] = written(changes(static_cast<Eigen::Index>(j), i));
    for (std::size_t k = 0; k < mimics_.size(); ++k)
      question_.change[dof + k][lane] =
          written(mimics_[k].multiplier * changes(static_cast<Eigen::Index>(mimics_[k].source), i));
  }
}

bool LaneWorld::write_lane(const double* q, int lane) {
  // Adding and taking away 1.5 * 2^52 rounds to the nearest integer (of values below 2^51), where
  // the library's function is a call on the baseline.
  constexpr double kRounder = 6755399441055744.0;
  PairBits outside{};  // by the sign
  const std::size_t dof = joints_.size() - mimics_.size();
  for (std::size_t j = 0; j < dof; j += 2) {
    const Pair value = j + 1 < dof ? Pair{q[j], q[j + 1]} : Pair{q[j], writing_.lower[j + 1]};
    outside |=
        PairBits(value - load(writing_.lower + j)) | PairBits(load(writing_.upper + j) - value);
    const Pair angle = value + load(writing_.offset + j);
    const Pair written =
        angle - kTurn * (angle * load(writing_.per_turn + j) + kRounder - kRounder);
    question_.q[j][lane] = static_cast<float>(written[0]);
    question_.q[j + 1][lane] = static_cast<float>(written[1]);
  }
  bool is_outside = (outside[0] | outside[1]) < 0;
  for (std::size_t i = 0; i < mimics_.size(); ++i) {
    const std::size_t j = dof + i;
    const double value = mimics_[i].multiplier * q[mimics_[i].source] + mimics_[i].offset;
    is_outside |= !(value >= writing_.lower[j] && value <= writing_.upper[j]);
    question_.q[j][lane] =
        static_cast<float>(value - kTurn * std::nearbyint(value * writing_.per_turn[j]));
  }
  if (!is_outside)
    return true;
  for (std::size_t j = 0; j < joints_.size(); ++j)
    question_.q[j][lane] = 0;
  return false;
}

std::uint32_t LaneWorld::write_question(const Eigen::Ref<const Eigen::MatrixXd>& qs) {
  const auto count = static_cast<int>(qs.cols());
  std::uint32_t beyond = 0;
  for (int lane = 0; lane < count; ++lane)
    beyond |= write_lane(qs.data() + lane * qs.outerStride(), lane) ? 0 : 1U << lane;
  // Idle lanes of the narrower sets; the other idle lanes keep the last question.
  for (int lane = count; lane % (kLanes / 2) != 0; ++lane)
    write_lane(qs.data() + (count - 1) * qs.outerStride(), lane);
  question_.count = count;
  return beyond;
}

LaneAnswer LaneWorld::answer(const Eigen::Ref<const Eigen::MatrixXd>& qs, const LaneSet& set,
                             LaneScope scope) {
  const std::uint32_t asked = (1U << qs.cols()) - 1U;
  if (!has_room_)
    return {asked, 0};
  const std::uint32_t beyond = beyond_ = write_question(qs);
  // One that is not known might hide later ones.
  question_.scope = beyond == 0 ? scope : LaneScope::Each;
  const LaneScene scene{static_cast<int>(joints_.size()),
                        static_cast<int>(links_.size()),
                        slack_,
                        joints_.data(),
                        links_.data(),
                        bodies_.data(),
                        obstacles_.data(),
                        static_cast<int>(bounds_.size()) / (6 * kLanes),
                        bounds_.data(),
                        reach_.data(),
                        spheres_.data(),
                        cover_.data(),
                        link_pairs_.data(),
                        others_.data(),
                        grid_.view()};
  set.kernel(scene, question_, places_.empty() ? nullptr : places_.front().values);
  return {(question_.maybe | beyond) & asked, question_.surely & asked & ~beyond};
}

bool is_of_quarter_turns(const Eigen::Matrix3d& R) {
  const Eigen::Array33d sizes = R.cwiseAbs().array();
  return (sizes < kAlike || (sizes - 1).abs() < kAlike).all();
}

Eigen::Matrix3d common_axes(const std::vector<Eigen::Matrix3d>& axes) {
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  std::ptrdiff_t most = 0;
  for (std::size_t i = 0; i < std::min(kTried, axes.size()); ++i) {
    const std::ptrdiff_t alike =
        std::count_if(axes.begin(), axes.end(), [&](const Eigen::Matrix3d& other) {
          return is_of_quarter_turns(axes[i].transpose() * other);
        });
    if (alike > most) {
      most = alike;
      best = axes[i];
    }
  }
  return best;
}

}  // namespace kinship::collision
