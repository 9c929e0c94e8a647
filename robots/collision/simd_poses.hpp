// Where the joints, links and bodies of KINSHIP_SIMD_WIDTH configurations are. Included only by the
// units that are compiled for one instruction set.
#pragma once

#include "robots/collision/lanes.hpp"
#include "robots/collision/simd_distance.hpp"
#include "robots/collision/simd_floats.hpp"

namespace kinship::collision {
namespace {

/// Configurations of one group: the poses of its joints and, as far as needed, its spheres.
class Poses {
 protected:
  /// \param first  lane of the question
  Poses(const LaneScene& scene, LaneQuestion& question, int first, float* places)
      : scene_(scene), question_(question), places_(places), first_(first) {
    place_joints(question, first);
    for (int i = 0; i < scene.links; ++i) {
      const LaneLink& link = scene.link[i];
      is_at_[i] = false;
      for (int body = link.first; body < link.first + link.count; ++body)
        is_placed_[body] = false;
    }
  }

  /// Its centre, and the motion of its bodies.
  void place_link(int index) {
    const LaneLink& link = scene_.link[index];
    link_centers_[index] = moved(frames_[link.joint], link.center);
    if (question_.moves)
      bound_motion(index);
  }

  /// Growth of a link's bodies towards standing ones.
  Wide standing_growth(int link) const {
    const Wide room = all(question_.standing_room);
    return question_.moves ? room + motions_[link][0] : room;
  }

  /// The same towards those of an earlier link.
  Wide moving_growth(int link, const LaneLinkPair& pair) const {
    const Wide room = all(question_.moving_room);
    return question_.moves
               ? room + motions_[link][pair.both + 1] + motions_[pair.other][pair.both + 1]
               : room;
  }

  /// Bounds the way of a link's points while the joints change, as the frame of each joint before
  /// it sees it ([k]: of the k-th joint, counted from 1), and in the scene's ([0]): joint by joint,
  /// a point is never farther from a joint's axis than it is here, and what it moved. Source: as
  /// MotionBounds.
  void bound_motion(int index) {
    constexpr float kRounding = 1 + 1e-5F;
    const LaneLink& link = scene_.link[index];
    const float radius = link.radius + 4 * scene_.slack;
    Wide motion = {};
    for (int k = link.joint; k >= 0; k = scene_.joints[k].before) {
      motions_[index][k + 1] = motion;
      const Wide change = load(question_.change[k] + first_);
      if (scene_.joints[k].slides) {
        motion += change;
        continue;
      }
      const WideFrame& frame = frames_[k];
      const WidePoint across =
          cross(minus(link_centers_[index], {frame.p[0], frame.p[1], frame.p[2]}, all(1)),
                {frame.R[2], frame.R[5], frame.R[8]});
      motion += change * (root(dot(across, across)) * kRounding + radius + motion) * kRounding;
    }
    motions_[index][0] = motion;
  }

  /// A link and its bodies, unless they are placed.
  void place_once(int index) {
    if (is_at_[index])
      return;
    place_link(index);
    place_bodies(index);
  }

  void place_bodies(int index) {
    if (is_at_[index])
      return;
    is_at_[index] = true;
    const LaneLink& link = scene_.link[index];
    for (int body = link.first; body < link.first + link.count; ++body)
      centers_[body] = moved(frames_[link.joint], scene_.body[body].form.center);
  }

  float* place_of(int sphere) const { return places_ + kPlaceRows * KINSHIP_SIMD_WIDTH * sphere; }

  WidePoint sphere(int index) const {
    const float* const place = place_of(index);
    return {load(place), load(place + KINSHIP_SIMD_WIDTH), load(place + 2 * KINSHIP_SIMD_WIDTH)};
  }

  void place_spheres(int index) {
    if (is_placed_[index])
      return;
    is_placed_[index] = true;
    const LaneBody& body = scene_.body[index];
    for (int i = body.first; i < body.first + body.count; ++i) {
      const WidePoint at = moved(frames_[body.joint], scene_.spheres[i].center);
      float* const place = place_of(i);
      store(place, at.x);
      store(place + KINSHIP_SIMD_WIDTH, at.y);
      store(place + 2 * KINSHIP_SIMD_WIDTH, at.z);
    }
  }

  const LaneScene& scene_;
  LaneQuestion& question_;
  float* places_;
  int first_;  // lane of the question
  WideFrame frames_[kLaneJoints];
  WidePoint link_centers_[kLaneJoints], centers_[kLaneBodies];

 private:
  void place_joints(const LaneQuestion& question, int first) {
    WideFrame frame = standing(scene_.joints[0].R, scene_.joints[0].p);
    for (int j = 0; j < scene_.moving_joints; ++j) {
      const LaneJoint& joint = scene_.joints[j];
      if (joint.is_tilt) {
        tilt(joint.R[7], joint.R[8], joint.p, frame);
      } else if (joint.before >= 0) {
        if (joint.before != j - 1)
          frame = frames_[joint.before];
        follow(joint.R, joint.p, frame);
      } else if (j > 0) {
        frame = standing(joint.R, joint.p);
      }
      const Wide q = load(question.q[j] + first);
      if (joint.slides) {
        frame.p[0] += q * frame.R[2];
        frame.p[1] += q * frame.R[5];
        frame.p[2] += q * frame.R[8];
      } else {
        Wide sine, cosine;
        sine_cosine(q, sine, cosine);
        turn(sine, cosine, frame);
      }
      frames_[j] = frame;
    }
  }

  Wide motions_[kLaneJoints][kLaneJoints + 1];  // of each link, as bound_motion() says
  bool is_at_[kLaneJoints], is_placed_[kLaneBodies];
};

}  // namespace
}  // namespace kinship::collision
