#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "proto/types/turn.hpp"
#include "robots/collision/lane_world.hpp"
#include "robots/kinematics/joint_motion.hpp"

/// Makes a LaneWorld of a robot and its surroundings.
namespace kinship::collision {
namespace {

void write(const Eigen::Vector3d& vector, float (&values)[3]) {
  for (int i = 0; i < 3; ++i)
    values[i] = static_cast<float>(vector[i]);
}

void write(const Eigen::Matrix3d& matrix, float (&rows)[9]) {
  for (int i = 0; i < 9; ++i)
    rows[i] = static_cast<float>(matrix(i / 3, i % 3));
}

/// \param T  of the shape in the frame that moves it.
LaneForm lane_form(const Shape& shape, const Eigen::Isometry3d& T) {
  LaneForm form{};
  write(T.linear(), form.axes);
  write(T.translation(), form.center);
  if (const auto* box = std::get_if<BoxShape>(&shape)) {
    const bool is_aligned = is_of_quarter_turns(T.linear());
    form.shape = is_aligned ? LaneShape::AlignedBox : LaneShape::Box;
    if (is_aligned)
      write(Eigen::Matrix3d::Identity().eval(), form.axes);
    const Eigen::Vector3d half = box->size / 2;
    write(is_aligned ? Eigen::Vector3d(T.linear().cwiseAbs() * half) : half, form.half);
    return form;
  }
  double length_m = 0, radius_m = 0;
  form.shape = LaneShape::Capsule;
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape)) {
    form.shape = LaneShape::Cylinder;
    length_m = cylinder->length_m;
    radius_m = cylinder->radius_m;
  } else if (const auto* capsule = std::get_if<CapsuleShape>(&shape)) {
    length_m = capsule->length_m;
    radius_m = capsule->radius_m;
  } else {
    radius_m = std::get<SphereShape>(shape).radius_m;
  }
  form.half[2] = static_cast<float>(length_m / 2);
  form.radius = static_cast<float>(radius_m);
  return form;
}

Eigen::Isometry3d turned_to(const Eigen::Vector3d& axis) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = kinematics::rotation_of_z_to(axis);
  return T;
}

}  // namespace

/// Fills a LaneWorld.
class LaneWorldMaker {
 public:
  LaneWorldMaker(LaneWorld& world, const kinematics::Chain& chain, const std::vector<Body>& bodies,
                 const std::vector<BodyPair>& pairs)
      : world_(world),
        chain_(chain),
        bodies_(bodies),
        pairs_(pairs),
        in_lanes_(bodies.size(), -1) {}

  void make() {
    world_.has_room_ = chain_.moving_joints() <= kLaneJoints;
    if (!world_.has_room_)
      return;
    find_axes();
    add_joints();
    drop_out_of_reach();
    find_slack();
    world_.slack_ = static_cast<float>(slack_m_);
    add_moving();
    add_links();
    add_obstacles();
    add_bounds();
    add_pairs();
  }

 private:
  /// Boxes along the axes are asked about at half the cost of others, and furniture stands square.
  void find_axes() {
    std::vector<Eigen::Matrix3d> axes;
    for (const Body& body : bodies_)
      if (body.kind == BodyKind::Obstacle && std::holds_alternative<BoxShape>(body.solid.shape()))
        axes.push_back(body.T_joint_body.linear());
    T_scene_base_.linear() = common_axes(axes).transpose();
  }

  void add_joints() {
    constexpr double kFarthest = 1e6;  // rad: its rest after full turns is still exact
    LaneWorld::Writing& writing = world_.writing_;
    std::ranges::fill(writing.lower, -kFarthest);
    std::ranges::fill(writing.upper, kFarthest);
    std::ranges::fill(writing.per_turn, 1 / kTurn);
    first_joint_ = chain_.joints().front().T_previous_joint.translation();
    for (int j = 0; j < chain_.moving_joints(); ++j)
      add_joint(j);
    for (const kinematics::MimicJoint& mimic : chain_.mimics())
      world_.mimics_.push_back(
          {static_cast<std::size_t>(mimic.source), mimic.multiplier, mimic.offset});
  }

  void add_joint(int index) {
    const auto j = static_cast<std::size_t>(index);
    const kinematics::Joint& joint = chain_.moving_joint(index);
    const bool slides = joint.type == kinematics::JointType::Prismatic;
    LaneJoint lane{};
    lane.slides = slides;
    lane.before = chain_.joint_before(index);
    const auto before = static_cast<std::size_t>(lane.before);
    const Eigen::Isometry3d T_joint_turned = turned_to(joint.axis);
    Eigen::Isometry3d T = (lane.before < 0 ? T_scene_base_ : T_turned_moving_[before]) *
                          joint.T_previous_joint * T_joint_turned;
    // The turns of a rotation about the z axes before and after it are added to the joints' angles;
    // of a mimic joint not, since the frame before it is shared with others.
    lane.is_tilt = index > 0 && index < chain_.dof() && !slides && !world_.joints_.back().slides;
    if (lane.is_tilt)
      keep_tilt(j, T);
    if (slides) {
      LaneWorld::Writing& writing = world_.writing_;
      writing.lower[j] = joint.lower;
      writing.upper[j] = joint.upper;
      writing.per_turn[j] = 0;
    }
    write(T.linear(), lane.R);
    write(T.translation(), lane.p);
    world_.joints_.push_back(lane);
    T_turned_moving_.push_back(T_joint_turned.inverse());
    const Eigen::Vector3d& p = joint.T_previous_joint.translation();
    double reach_m = lane.before < 0 ? (p - first_joint_).norm() : reaches_m_[before] + p.norm();
    if (slides)
      reach_m += std::max(std::abs(joint.lower), std::abs(joint.upper));
    reaches_m_.push_back(reach_m);
  }

  /// Leaves of a joint's pose in the frame before it the turn about the x axis; the rest is moved
  /// to both joints' angles.
  void keep_tilt(std::size_t joint, Eigen::Isometry3d& T) {
    const kinematics::AxisTurns turns = kinematics::axis_turns(T.linear());
    const Eigen::AngleAxisd back(-turns.before, Eigen::Vector3d::UnitZ());
    world_.writing_.offset[joint - 1] += turns.before;
    world_.writing_.offset[joint] = turns.after;
    T_turned_moving_.back() = back * T_turned_moving_.back();
    T = back * T;
    T.linear() =
        Eigen::AngleAxisd(std::atan2(turns.tilt_sine, turns.tilt_cosine), Eigen::Vector3d::UnitX())
            .toRotationMatrix();
  }

  /// The farthest that a moving body's points get from the first joint's origin, m.
  double reach_of(const Body& body) const {
    return reaches_m_[static_cast<std::size_t>(body.joint)] +
           body.T_joint_body.translation().norm() + body.solid.radius_m();
  }

  /// Pairs of a body and an obstacle that it never gets to.
  void drop_out_of_reach() {
    constexpr double kSlack_m = kLargestRoom_m + 1e-3;
    std::erase_if(pairs_, [this](const BodyPair& pair) {
      const Body &a = bodies_[pair.first], &b = bodies_[pair.second];
      if (a.joint >= 0 && b.joint >= 0)
        return false;
      const Body &moving = a.joint >= 0 ? a : b, &standing = a.joint >= 0 ? b : a;
      const Eigen::Vector3d from = standing.T_joint_body.linear().transpose() *
                                   (first_joint_ - standing.T_joint_body.translation());
      const double distance =
          (from.cwiseAbs() - standing.solid.half_extents_m()).cwiseMax(0).norm();
      return distance > reach_of(moving) + kSlack_m;
    });
  }

  /// The bound of rounding errors: of floats, some an operation, joint after joint.
  void find_slack() {
    constexpr double kOfAJoint = 5e-7, kAtLeast_m = 1e-6;
    double extent_m = first_joint_.norm();
    for (const auto& [first, second] : pairs_)
      for (const Body* body : {&bodies_[first], &bodies_[second]})
        extent_m = std::max(extent_m, body->joint >= 0 ? first_joint_.norm() + reach_of(*body)
                                                       : body->T_joint_body.translation().norm() +
                                                             body->solid.radius_m());
    slack_m_ =
        kAtLeast_m + kOfAJoint * (2.0 + static_cast<double>(chain_.moving_joints())) * extent_m;
  }

  LaneSphere lane_sphere(const Eigen::Isometry3d& T, const CoverSphere& sphere) const {
    LaneSphere lane{};
    write(T * sphere.center, lane.center);
    write(T * sphere.point, lane.point);
    lane.outer = static_cast<float>(sphere.outer_m + slack_m_);
    lane.inner = static_cast<float>(std::max(sphere.inner_m - slack_m_, 0.0));
    return lane;
  }

  /// \return the first's index.
  int add_spheres(const Eigen::Isometry3d& T, const std::vector<CoverSphere>& cover) {
    const int first = static_cast<int>(world_.spheres_.size());
    for (const CoverSphere& sphere : cover)
      world_.spheres_.push_back(lane_sphere(T, sphere));
    return first;
  }

  static int in_lanes(int count) { return (count + kLanes - 1) / kLanes * kLanes; }

  /// The last spheres once more, row after row. \return the first number's index.
  int add_cover(std::size_t count) {
    constexpr float kFarAway_m = 1e9F;
    const std::size_t first = world_.cover_.size(), from = world_.spheres_.size() - count;
    const auto room = static_cast<std::size_t>(in_lanes(static_cast<int>(count)));
    world_.cover_.resize(first + kCoverRows * room, 0);
    for (std::size_t i = 0; i < room; ++i) {
      float* const row = world_.cover_.data() + first + i;
      if (i >= count) {
        row[0] = kFarAway_m;
        continue;
      }
      const LaneSphere& sphere = world_.spheres_[from + i];
      for (std::size_t axis = 0; axis < 3; ++axis)
        row[axis * room] = sphere.center[axis];
      row[3 * room] = sphere.outer;
      row[4 * room] = sphere.inner;
    }
    return static_cast<int>(first);
  }

  /// Bodies that move and are in a pair, the last joints' first: they collide most.
  void add_moving() {
    std::vector<bool> is_in_a_pair(bodies_.size(), false);
    for (const auto& [first, second] : pairs_)
      is_in_a_pair[first] = is_in_a_pair[second] = true;
    std::vector<std::size_t> order;
    for (std::size_t body = 0; body < bodies_.size(); ++body)
      if (is_in_a_pair[body] && bodies_[body].joint >= 0)
        order.push_back(body);
    std::ranges::stable_sort(order, std::greater(),
                             [this](std::size_t body) { return bodies_[body].joint; });
    world_.has_room_ = order.size() <= kLaneBodies;
    for (const std::size_t index : order) {
      const Body& body = bodies_[index];
      const Eigen::Isometry3d T =
          T_turned_moving_[static_cast<std::size_t>(body.joint)] * body.T_joint_body;
      const std::vector<CoverSphere>& cover = body.solid.cover();
      in_lanes_[index] = static_cast<int>(world_.bodies_.size());
      world_.index_of_body_.push_back(index);
      world_.bodies_.push_back({.joint = body.joint,
                                .link = 0,
                                .form = lane_form(body.solid.shape(), T),
                                .is_solid = !body.solid.is_hollow(),
                                .radius = static_cast<float>(body.solid.radius_m() + slack_m_),
                                .first = add_spheres(T, cover),
                                .count = static_cast<int>(cover.size()),
                                .first_cover = add_cover(cover.size()),
                                .room = in_lanes(static_cast<int>(cover.size())),
                                .first_reach = 0});
    }
    world_.places_.resize(kPlaceRows * world_.spheres_.size());
  }

  void add_links() {
    std::vector<LaneBody>& bodies = world_.bodies_;
    for (std::size_t first = 0, end = 0; first < bodies.size(); first = end) {
      Eigen::AlignedBox3d box;
      while (end < bodies.size() && bodies[end].joint == bodies[first].joint) {
        const Eigen::Vector3d center = center_of(bodies[end]);
        const Eigen::Vector3d half = Eigen::Vector3d::Constant(bodies[end].radius);
        box.extend(Eigen::AlignedBox3d(center - half, center + half));
        bodies[end++].link = static_cast<int>(world_.links_.size());
      }
      LaneLink link{};
      link.joint = bodies[first].joint;
      write(box.center(), link.center);
      double radius_m = 0;
      for (std::size_t i = first; i < end; ++i)
        radius_m =
            std::max(radius_m, (center_of(bodies[i]) - box.center()).norm() + bodies[i].radius);
      link.radius = static_cast<float>(radius_m + slack_m_);
      link.first = static_cast<int>(first);
      link.count = static_cast<int>(end - first);
      world_.links_.push_back(link);
    }
  }

  static Eigen::Vector3d center_of(const LaneBody& body) {
    return {body.form.center[0], body.form.center[1], body.form.center[2]};
  }

  void add_obstacles() {
    for (const auto& [first, second] : pairs_)
      for (const std::size_t index : {first, second}) {
        const Body& body = bodies_[index];
        if (body.joint >= 0 || in_lanes_[index] >= 0)
          continue;
        LaneObstacle obstacle{};
        const Eigen::Isometry3d T = T_scene_base_ * body.T_joint_body;
        obstacle.form = lane_form(body.solid.shape(), T);
        obstacle.is_solid = !body.solid.is_hollow();
        if (body.solid.is_hollow()) {
          obstacle.first = add_spheres(T, body.solid.cover());
          obstacle.count = static_cast<int>(body.solid.cover().size());
          obstacle.is_in_grid = add_cubes(body, T);
        }
        in_lanes_[index] = static_cast<int>(world_.obstacles_.size());
        world_.obstacles_.push_back(obstacle);
        world_.index_of_obstacle_.push_back(index);
        const Eigen::Vector3d half = T.linear().cwiseAbs() * body.solid.half_extents_m();
        boxes_.emplace_back(T.translation() - half, T.translation() + half);
      }
    world_.grid_ = DistanceGrid(cubes_, cube_m_, T_scene_grid_);
  }

  /// Adds a block to the grid: of the first cloud, whose blocks have one orientation and one
  /// lattice. \return whether it is of that cloud.
  bool add_cubes(const Body& body, const Eigen::Isometry3d& T_scene_body) {
    if (body.solid.cube_m() == 0 || (!cubes_.empty() && body.name != cloud_))
      return false;
    if (cubes_.empty()) {
      cloud_ = body.name;
      cube_m_ = body.solid.cube_m();
      T_scene_grid_ = T_scene_body;
    }
    const Eigen::Vector3d p_grid_body =
        T_scene_grid_.inverse(Eigen::Isometry) * T_scene_body.translation();
    for (const Eigen::AlignedBox3d& cube : body.solid.cubes())
      cubes_.emplace_back(cube.min() + p_grid_body, cube.max() + p_grid_body);
    return true;
  }

  /// The boxes along the axes around the obstacles, with room for rounding.
  void add_bounds() {
    const double room_m = 1e-5 + 4 * slack_m_;
    constexpr auto kNowhere = std::numeric_limits<float>::infinity();
    blocks_ = (boxes_.size() + kLanes - 1) / kLanes;
    world_.bounds_.resize(6 * kLanes * blocks_);
    for (std::size_t i = 0; i < kLanes * blocks_; ++i) {
      float* const lane = world_.bounds_.data() + i / kLanes * 6 * kLanes + i % kLanes;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto row = static_cast<Eigen::Index>(axis);
        const bool is_there = i < boxes_.size();
        lane[axis * kLanes] =
            is_there ? static_cast<float>(boxes_[i].min()[row] - room_m) : kNowhere;
        lane[(axis + 3) * kLanes] =
            is_there ? static_cast<float>(boxes_[i].max()[row] + room_m) : -kNowhere;
      }
    }
  }

  void add_pairs() {
    const std::size_t links = world_.links_.size();
    world_.reach_.resize((links + world_.bodies_.size()) * blocks_);
    const auto first_reach = [this](std::size_t row) { return static_cast<int>(row * blocks_); };
    for (std::size_t i = 0; i < links; ++i)
      world_.links_[i].first_reach = first_reach(i);
    for (std::size_t i = 0; i < world_.bodies_.size(); ++i)
      world_.bodies_[i].first_reach = first_reach(links + i);
    std::vector<LaneOther> others;
    for (const auto& [first, second] : pairs_) {
      const auto [before, after] = std::minmax(in_lanes_[first], in_lanes_[second]);
      if (bodies_[first].joint >= 0 && bodies_[second].joint >= 0)
        others.push_back(
            {.body = after,
             .other = before,
             .reach = body_at(after).radius + body_at(before).radius,
             .link_reach = body_at(after).radius + world_.links_[link_of(before)].radius,
             .next = 0});
      else if (bodies_[first].joint < 0)
        add_obstacle_of(in_lanes_[second], in_lanes_[first]);
      else
        add_obstacle_of(in_lanes_[first], in_lanes_[second]);
    }
    add_link_pairs(others);
  }

  const LaneBody& body_at(int body) const { return world_.bodies_[static_cast<std::size_t>(body)]; }
  std::size_t link_of(int body) const { return static_cast<std::size_t>(body_at(body).link); }

  void add_obstacle_of(int body, int obstacle) {
    for (const int first : {body_at(body).first_reach, world_.links_[link_of(body)].first_reach})
      world_.reach_[static_cast<std::size_t>(first + obstacle / kLanes)] |= 1U
                                                                            << (obstacle % kLanes);
  }

  /// The pairs of bodies, ordered by their links.
  void add_link_pairs(const std::vector<LaneOther>& others) {
    const std::size_t links = world_.links_.size();
    std::vector<int> count(links * links);
    const auto cell = [&](const LaneOther& pair) {
      return link_of(pair.body) * links + link_of(pair.other);
    };
    for (const LaneOther& pair : others)
      ++count[cell(pair)];
    std::vector<int> next(links * links);
    int first = 0;
    for (std::size_t i = 0; i < links; ++i) {
      LaneLink& link = world_.links_[i];
      link.first_pair = static_cast<int>(world_.link_pairs_.size());
      for (std::size_t k = 0; k <= i; ++k) {
        const int its = count[i * links + k];
        if (its == 0)
          continue;
        const LaneLink& other = world_.links_[k];
        world_.link_pairs_.push_back({.other = static_cast<int>(k),
                                      .both = chain_.joint_before_both(link.joint, other.joint),
                                      .reach = link.radius + other.radius,
                                      .first = first,
                                      .count = its});
        next[i * links + k] = first;
        first += its;
      }
      link.pairs = static_cast<int>(world_.link_pairs_.size()) - link.first_pair;
    }
    world_.others_.resize(others.size());
    for (const LaneOther& pair : others)
      world_.others_[static_cast<std::size_t>(next[cell(pair)]++)] = pair;
    for (const LaneLinkPair& pair : world_.link_pairs_) {
      int end = pair.first + pair.count;
      for (int i = end; i-- > pair.first;) {
        LaneOther& its = world_.others_[static_cast<std::size_t>(i)];
        if (i + 1 < pair.first + pair.count &&
            world_.others_[static_cast<std::size_t>(i) + 1].body != its.body)
          end = i + 1;
        its.next = end;
      }
    }
  }

  LaneWorld& world_;
  const kinematics::Chain& chain_;
  const std::vector<Body>& bodies_;
  std::vector<BodyPair> pairs_;
  std::vector<Eigen::Isometry3d> T_turned_moving_;  // one a joint
  std::vector<double> reaches_m_;                   // of each joint's origin from the first's
  Eigen::Vector3d first_joint_ = Eigen::Vector3d::Zero();
  double slack_m_ = 0;
  Eigen::Isometry3d T_scene_base_ = Eigen::Isometry3d::Identity();
  std::vector<Eigen::AlignedBox3d> boxes_;  // around each of the lane's obstacles
  std::vector<Eigen::AlignedBox3d> cubes_;  // of the cloud that is in the grid, in its frame
  std::string cloud_;
  double cube_m_ = 0;
  Eigen::Isometry3d T_scene_grid_ = Eigen::Isometry3d::Identity();
  std::size_t blocks_ = 0;     // of kLanes obstacles
  std::vector<int> in_lanes_;  // of each body: the lane's body or obstacle; -1: it is in no pair
};

LaneWorld::LaneWorld(const kinematics::Chain& chain, const std::vector<Body>& bodies,
                     const std::vector<BodyPair>& pairs)
    : question_() {
  question_.likely_body = question_.pairs = -1;
  LaneWorldMaker(*this, chain, bodies, pairs).make();
}

}  // namespace kinship::collision
