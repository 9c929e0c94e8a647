// Whether configurations collide, KINSHIP_SIMD_WIDTH at once. Included only by the units that are
// compiled for one instruction set.

#include "robots/collision/lanes.hpp"
#include "robots/collision/simd_distance.hpp"
#include "robots/collision/simd_floats.hpp"
#include "robots/collision/simd_poses.hpp"
#include "robots/collision/simd_separation.hpp"

namespace kinship::collision {
namespace {

constexpr unsigned kAllOfAGroup = (1U << KINSHIP_SIMD_WIDTH) - 1U;

/// The result for a group of lanes.
struct Verdict {
  unsigned maybe = 0, surely = 0;
};

/// Checks the configurations of one group.
class Group : Poses {
 public:
  /// \param first  lane of the question
  Group(const LaneScene& scene, LaneQuestion& question, int first, float* places)
      : Poses(scene, question, first, places) {
    for (int i = 0; i < scene.links; ++i)
      for (int body = scene.link[i].first; body < scene.link[i].first + scene.link[i].count; ++body)
        is_near_known_[body] = false;
  }

  Verdict check() {
    if (question_.pairs >= 0) {
      check_pairs();
      return verdict_;
    }
    for (int i = 0; i < scene_.links; ++i)
      place_link(i);
    try_likely();
    for (int i = 0; i < scene_.links && verdict_.surely != kAllOfAGroup; ++i)
      check_link(i);
    for (int i = 0; i < scene_.links && verdict_.surely != kAllOfAGroup; ++i) {
      const LaneLink& link = scene_.link[i];
      for (int k = link.first_pair; k < link.first_pair + link.pairs; ++k)
        check_link_pair(i, scene_.link_pairs[k]);
    }
    return verdict_;
  }

 private:
  /// Looks at the pairs of the question only.
  void check_pairs() {
    for (int i = 0; i < question_.pairs; ++i) {
      const LaneDoubt& pair = question_.pair[i];
      const unsigned open = pair.lanes >> first_ & kAllOfAGroup & ~verdict_.surely;
      if (open == 0)
        continue;
      const int link = scene_.body[pair.body].link;
      place_once(link);
      if (pair.obstacle >= 0) {
        check_obstacle({link, pair.body, standing_growth(link)}, pair.obstacle, centers_[pair.body],
                       open);
        continue;
      }
      const int other = scene_.body[pair.other].link;
      place_once(other);
      const LaneLink& its = scene_.link[link];
      int k = its.first_pair;
      while (scene_.link_pairs[k].other != other)
        ++k;
      compare_bodies(pair.body, pair.other, open, moving_growth(link, scene_.link_pairs[k]));
    }
  }

  /// Tries the last collision first: it often recurs, and then the rest is not checked.
  void try_likely() {
    if (question_.likely_body < 0)
      return;
    const LaneBody& body = scene_.body[question_.likely_body];
    check_obstacle(
        {question_.likely_link, question_.likely_body, standing_growth(question_.likely_link)},
        question_.likely_obstacle, moved(frames_[body.joint], body.form.center), kAllOfAGroup);
  }

  /// A body, its link, and how much it has grown.
  struct Grown {
    int link, body;
    Wide growth;
  };

  /// The bodies of a link and the obstacles that its sphere reaches in some lane.
  void check_link(int index) {
    const LaneLink& link = scene_.link[index];
    const Wide growth = standing_growth(index), radius = link.radius + growth;
    const WidePoint& center = link_centers_[index];
    for (int block = 0; block < scene_.blocks; ++block) {
      unsigned open = 0;
      for (unsigned near =
               near_of_block(block, scene_.reach[link.first_reach + block], center, radius);
           near != 0; near &= near - 1) {
        const int which = __builtin_ctz(near);
        if (link.count == 1 ||
            (reach(scene_.obstacle[block * kLanes + which].form, center, radius) &
             ~verdict_.surely) != 0)
          open |= 1U << which;
      }
      if (open == 0)
        continue;
      place_bodies(index);
      for (int body = link.first; body < link.first + link.count; ++body)
        check_obstacles({index, body, growth}, block, open);
    }
  }

  /// The bodies of two links that come near each other in some lane.
  void check_link_pair(int index, const LaneLinkPair& pair) {
    const Wide growth = moving_growth(index, pair);
    const Wide limit = pair.reach + growth;
    if ((below(distance2(link_centers_[index], link_centers_[pair.other]), limit * limit) &
         ~verdict_.surely) == 0)
      return;
    place_bodies(index);
    place_bodies(pair.other);
    for (int i = pair.first; i < pair.first + pair.count;) {
      const LaneOther& first = scene_.others[i];
      const WidePoint center = centers_[first.body];
      const Wide link_limit = first.link_reach + growth;
      if (below(distance2(center, link_centers_[pair.other]), link_limit * link_limit) == 0) {
        i = first.next;
        continue;
      }
      for (const int end = first.next; i < end; ++i) {
        const LaneOther& other = scene_.others[i];
        const Wide its = other.reach + growth;
        const unsigned near =
            below(distance2(center, centers_[other.other]), its * its) & ~verdict_.surely;
        if (near != 0)
          compare_bodies(other.body, other.other, near, growth);
      }
    }
  }

  /// Obstacles of a block whose boxes overlap the box around spheres in all lanes.
  /// \param open  those that matter
  KINSHIP_SIMD_INLINE unsigned near_of_block(int block, unsigned open, const WidePoint& center,
                                             Wide radius) const {
    if (open == 0)
      return 0;
    const WidePoint low = {all(least(center.x - radius)), all(least(center.y - radius)),
                           all(least(center.z - radius))};
    const WidePoint high = {all(largest(center.x + radius)), all(largest(center.y + radius)),
                            all(largest(center.z + radius))};
    unsigned near = 0;
    for (int part = 0; part < kLanes; part += KINSHIP_SIMD_WIDTH) {
      const float* const bounds = scene_.bounds + block * 6 * kLanes + part;
      const unsigned overlap =
          below(load(bounds), high.x) & below(load(bounds + kLanes), high.y) &
          below(load(bounds + 2 * kLanes), high.z) & below(low.x, load(bounds + 3 * kLanes)) &
          below(low.y, load(bounds + 4 * kLanes)) & below(low.z, load(bounds + 5 * kLanes));
      near |= overlap << part;
    }
    return open & near;
  }

  /// A body and obstacles of a block. \param open  those that matter
  KINSHIP_SIMD_INLINE void check_obstacles(const Grown& grown, int block, unsigned open) {
    const LaneBody& body = scene_.body[grown.body];
    open &= scene_.reach[body.first_reach + block];
    if (open == 0)
      return;
    const WidePoint& center = centers_[grown.body];
    const WidePoint half = extents(body, grown.growth);
    for (; open != 0; open &= open - 1) {
      const int lane = __builtin_ctz(open);
      const unsigned within =
          overlap(scene_.bounds + block * 6 * kLanes + lane, center, half) & ~verdict_.surely;
      if (within != 0)
        check_obstacle(grown, block * kLanes + lane, center, within);
    }
  }

  /// Half extents of a grown body along the scene's axes, in each lane.
  KINSHIP_SIMD_INLINE WidePoint extents(const LaneBody& body, Wide growth) const {
    const LaneForm& form = body.form;
    const WideFrame& frame = frames_[body.joint];
    const float(&A)[9] = form.axes;
    const WidePoint z = turned(frame, A[2], A[5], A[8]);
    const Wide more = 4 * scene_.slack + growth + (is_box(form) ? 0.0F : form.radius);
    WidePoint half = {absolute(z.x) * form.half[2] + more, absolute(z.y) * form.half[2] + more,
                      absolute(z.z) * form.half[2] + more};
    if (!is_box(form))
      return half;
    const WidePoint x = turned(frame, A[0], A[3], A[6]), y = turned(frame, A[1], A[4], A[7]);
    half.x += absolute(x.x) * form.half[0] + absolute(y.x) * form.half[1];
    half.y += absolute(x.y) * form.half[0] + absolute(y.y) * form.half[1];
    half.z += absolute(x.z) * form.half[0] + absolute(y.z) * form.half[1];
    return half;
  }

  /// \param open  lanes that matter
  KINSHIP_SIMD_INLINE void check_obstacle(const Grown& grown, int which, const WidePoint& center,
                                          unsigned open) {
    const LaneObstacle& obstacle = scene_.obstacle[which];
    const unsigned near =
        reach(obstacle.form, center, scene_.body[grown.body].radius + grown.growth) & open;
    if (near == 0)
      return;
    const unsigned before = verdict_.surely;
    compare_closely(grown, which, near);
    if (verdict_.surely != before) {
      question_.likely_link = grown.link;
      question_.likely_body = grown.body;
      question_.likely_obstacle = which;
    }
  }

  /// A grown body and the cloud; keeps the distances of its spheres.
  Verdict near_cloud(const Grown& grown) {
    const int index = grown.body;
    if (is_near_known_[index])
      return near_cloud_[index];
    is_near_known_[index] = true;
    const LaneBody& body = scene_.body[index];
    const WideFrame& frame = frames_[body.joint];
    Verdict found;
    const unsigned around =
        below(distance_of_cloud(scene_.grid, moved(frame, body.form.center), scene_.slack),
              body.radius + grown.growth + Wide{});
    if (around != 0) {
      place_spheres(index);
      for (int i = body.first; i < body.first + body.count; ++i) {
        const LaneSphere& its = scene_.spheres[i];
        const Wide distance = distance_of_cloud(scene_.grid, sphere(i), scene_.slack);
        store(place_of(i) + 3 * KINSHIP_SIMD_WIDTH, distance);
        const unsigned near = below(distance, its.outer + grown.growth + Wide{}) & around;
        found.maybe |= near;
        if ((near & ~found.surely) != 0 && scene_.grid.is_exact)
          found.surely |= within_cloud(scene_.grid, moved(frame, its.point), scene_.slack);
      }
    }
    return near_cloud_[index] = found;
  }

  /// Lanes in which a sphere reaches the spheres that cover a surface. \param open  that matter
  unsigned reach_surface(const LaneObstacle& obstacle, const WidePoint& at, Wide radius,
                         unsigned open) const {
    unsigned reached = 0;
    for (int i = obstacle.first; i < obstacle.first + obstacle.count && (open & ~reached) != 0;
         ++i) {
      const LaneSphere& its = scene_.spheres[i];
      const Wide limit = radius + its.outer;
      const WidePoint center = {all(its.center[0]), all(its.center[1]), all(its.center[2])};
      reached |= below(distance2(at, center), limit * limit);
    }
    return open & reached;
  }

  /// A body and an obstacle, closely. \param near  lanes that matter
  void compare_closely(const Grown& grown, int which, unsigned near) {
    const int index = grown.body;
    const Wide growth = grown.growth;
    const LaneObstacle& obstacle = scene_.obstacle[which];
    const LaneBody& body = scene_.body[index];
    const Verdict cloud = obstacle.is_in_grid ? near_cloud(grown) : Verdict{near, 0};
    if ((near &= cloud.maybe) == 0)
      return;
    const bool few = __builtin_popcount(near) * (body.room / KINSHIP_SIMD_WIDTH) < body.count;
    Verdict found = few && obstacle.is_solid ? compare_lanes(body, obstacle.form, growth, near)
                                             : compare_spheres(index, obstacle, growth, near);
    found.surely |= found.maybe & cloud.surely;
    conclude(found, {0, index, which, -1}, [&](unsigned open) {
      Planes planes =
          separated(placed(body.form, frames_[body.joint]), body.form, standing(obstacle.form),
                    obstacle.form, Margin{scene_.slack, growth}, open);
      if (!body.is_solid || !obstacle.is_solid)
        planes.overlapping = 0;
      return planes;
    });
  }

  /// One lane after the other, many spheres at once.
  Verdict compare_lanes(const LaneBody& body, const LaneForm& form, Wide growth,
                        unsigned near) const {
    const float extra = form.shape == LaneShape::Capsule ? form.radius : 0.0F;
    Verdict found;
    for (; near != 0; near &= near - 1) {
      const int lane = __builtin_ctz(near);
      const WideFrame& all_lanes = frames_[body.joint];
      WideFrame frame;
      for (int i = 0; i < 9; ++i)
        frame.R[i] = all(all_lanes.R[i][lane]);
      for (int i = 0; i < 3; ++i)
        frame.p[i] = all(all_lanes.p[i][lane]);
      unsigned touched = 0, inside = 0;
      for (int i = 0; i < body.room; i += KINSHIP_SIMD_WIDTH) {
        const float* const row = scene_.cover + body.first_cover + i;
        const Wide x = load(row), y = load(row + body.room), z = load(row + 2 * body.room);
        const Wide outer = load(row + 3 * body.room) + (extra + growth[lane]);
        const Wide inner = load(row + 4 * body.room);
        const WidePoint at = {frame.R[0] * x + frame.R[1] * y + frame.R[2] * z + frame.p[0],
                              frame.R[3] * x + frame.R[4] * y + frame.R[5] * z + frame.p[1],
                              frame.R[6] * x + frame.R[7] * y + frame.R[8] * z + frame.p[2]};
        const Wide squared = distance2(form, at);
        const Wide within = inner + extra;
        touched |= below(squared, outer * outer);
        inside |= below(squared, within * within) & below(Wide{}, inner);
      }
      found.maybe |= touched != 0 ? 1U << lane : 0U;
      found.surely |= inside != 0 ? 1U << lane : 0U;
    }
    return found;
  }

  /// One sphere after the other, all lanes at once.
  Verdict compare_spheres(int index, const LaneObstacle& obstacle, Wide growth, unsigned near) {
    const LaneBody& body = scene_.body[index];
    place_spheres(index);
    const float extra = obstacle.form.shape == LaneShape::Capsule ? obstacle.form.radius : 0.0F;
    const bool is_hollow = !body.is_solid || !obstacle.is_solid;  // so nothing collides surely
    Verdict found;
    for (int i = body.first; i < body.first + body.count; ++i) {
      const LaneSphere& its = scene_.spheres[i];
      const WidePoint at = sphere(i);
      const Wide squared = distance2(obstacle.form, at);
      const Wide outer = its.outer + extra + growth;
      const float inner = its.inner + extra;
      unsigned touched = below(squared, outer * outer) & near;
      if (touched == 0)
        continue;
      if (obstacle.is_in_grid)
        touched &= below(load(place_of(i) + 3 * KINSHIP_SIMD_WIDTH), its.outer + growth + Wide{});
      else if (!obstacle.is_solid)
        touched = reach_surface(obstacle, at, its.outer + growth, touched);
      else if (its.inner > 0)
        found.surely |= below(squared, all(inner * inner)) & near;
      found.maybe |= touched;
      near &= ~(is_hollow ? found.maybe : found.surely);  // of those nothing else matters
      if (near == 0)
        break;
    }
    return found;
  }

  /// Two bodies, closely.
  void compare_bodies(int first, int second, unsigned near, Wide growth) {
    place_spheres(first);
    place_spheres(second);
    const LaneBody &a = scene_.body[first], &b = scene_.body[second];
    Verdict found;
    for (int i = a.first; i < a.first + a.count; ++i) {
      const WidePoint at = sphere(i);
      const LaneSphere& its = scene_.spheres[i];
      const Wide around = its.outer + b.radius + growth;
      if ((below(distance2(at, centers_[second]), around * around) & near) == 0)
        continue;
      for (int j = b.first; j < b.first + b.count; ++j) {
        const LaneSphere& others = scene_.spheres[j];
        const Wide squared = distance2(at, sphere(j));
        const Wide outer = its.outer + others.outer + growth;
        const float inner = its.inner + others.inner;
        found.maybe |= below(squared, outer * outer) & near;
        if (its.inner > 0 && others.inner > 0)
          found.surely |= below(squared, all(inner * inner)) & near;
      }
    }
    conclude(found, {0, first, -1, second}, [&](unsigned open) {
      Planes planes =
          separated(placed(a.form, frames_[a.joint]), a.form, placed(b.form, frames_[b.joint]),
                    b.form, Margin{scene_.slack, growth}, open);
      if (!a.is_solid || !b.is_solid)
        planes.overlapping = 0;
      return planes;
    });
  }

  /// \param planes  gives the result of planes between the two for some lanes; called only where
  ///                needed.
  template <typename Ask>
  KINSHIP_SIMD_INLINE void conclude(Verdict found, LaneDoubt doubt, const Ask& planes) {
    if (found.maybe == 0)
      return;
    unsigned open = found.maybe & ~found.surely;
    if (open != 0) {
      const Planes said = planes(open);
      found.maybe &= ~(open & said.apart);
      found.surely |= open & said.overlapping & ~said.apart;
      open &= ~said.apart & ~said.overlapping;
    }
    if (open != 0) {
      doubt.lanes = open << first_;
      if (question_.doubts < kLaneDoubts)
        question_.doubt[question_.doubts] = doubt;
      ++question_.doubts;
    }
    // Bits from the first one on, if those behind it do not matter.
    unsigned surely = found.surely;
    if (surely != 0 && question_.scope == LaneScope::All)
      surely = kAllOfAGroup;
    else if (question_.scope == LaneScope::Ahead)
      surely = (0U - (surely & (0U - surely))) & kAllOfAGroup;
    verdict_.maybe |= found.maybe | surely;
    verdict_.surely |= surely;
  }

  Verdict verdict_;
  bool is_near_known_[kLaneBodies];
  Verdict near_cloud_[kLaneBodies];
};

void check_lanes(const LaneScene& scene, LaneQuestion& question, float* places) {
  question.maybe = question.surely = 0;
  question.doubts = 0;
  for (int first = 0; first < question.count; first += KINSHIP_SIMD_WIDTH) {
    const Verdict verdict = Group(scene, question, first, places).check();
    question.maybe |= verdict.maybe << first;
    question.surely |= verdict.surely << first;
    if (question.scope != LaneScope::Each && verdict.surely != 0)
      break;  // what comes behind is not looked at
  }
}

}  // namespace
}  // namespace kinship::collision
