#include "client/cli/link_commands.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <ostream>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/offline_robot.hpp"
#include "client/cli/terminal.hpp"
#include "client/cli/value_text.hpp"
#include "proto/json/robot_answers_json.hpp"
#include "proto/tables/table.hpp"
#include "robots/collision/robot_solids.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/link_tree.hpp"
#include "robots/kinematics/urdf.hpp"
#include "robots/models/suggested_ends.hpp"

namespace kinship::cli {
namespace {

using tables::Table;

constexpr const char* kLinks = "robots links";
constexpr const char* kFrames = "robots frames";

/// The part of a row that the URDF alone gives.
RobotLink row_of(const std::vector<kinematics::TreeLink>& tree, std::size_t index) {
  const kinematics::TreeLink& source = tree[index];
  RobotLink row;
  row.link = source.name;
  row.joint = source.joint.name;
  row.joint_type = source.joint.type;
  row.lower = source.joint.lower;
  row.upper = source.joint.upper;
  row.mimics = source.joint.mimics;
  row.fault = source.joint.fault;
  row.collision = source.collision;
  if (source.parent >= 0)
    row.parent = tree[static_cast<std::size_t>(source.parent)].name;
  return row;
}

std::vector<PossibleEnds> possible_ends(const std::vector<kinematics::ChainEnds>& all) {
  std::vector<PossibleEnds> possible;
  for (const kinematics::ChainEnds& ends : all)
    possible.push_back({ends.bases, ends.tips, ends.joints});
  return possible;
}

/// A robot whose base and tip may be suggested ones.
struct LookedAt {
  models::RobotArguments arguments;
  models::LinksOfFile links;
  kinematics::RobotModel robot;
};

std::optional<LookedAt> look_at(const char* command, models::RobotArguments arguments,
                                std::ostream& err, int& code) {
  auto links = models::complete_ends(arguments);
  if (!links) {
    code = refuse(command, links.error(), err);
    return std::nullopt;
  }
  auto robot = read_robot(command, arguments, err, code);
  if (!robot)
    return std::nullopt;
  return LookedAt{std::move(arguments), *std::move(links), *std::move(robot)};
}

RobotLink row_of(const LookedAt& looked_at, std::size_t index,
                 const std::map<std::string, double>& held) {
  const kinematics::Chain& chain = looked_at.robot.chain;
  RobotLink row = row_of(looked_at.links.tree, index);
  for (std::size_t i = 0; i < chain.joints().size(); ++i)
    if (const kinematics::Joint& joint = chain.joints()[i]; joint.name == row.joint) {
      row.chain_joint = i + 1;
      row.lower = joint.lower;  // the stricter of hard and soft limits
      row.upper = joint.upper;
    }
  if (const auto value = held.find(row.joint); value != held.end())
    row.held = value->second;
  const int last = chain.last_source(chain.links()[index].joint);
  row.moved_by = static_cast<std::uint64_t>(std::int64_t{last} + 1);
  return row;
}

std::vector<UncheckedLinks> unchecked_of(const kinematics::Chain& chain,
                                         const std::optional<geometry::RobotShapes>& geometry,
                                         const std::vector<RobotLink>& rows) {
  std::vector<bool> has_shape;
  for (const RobotLink& row : rows)
    has_shape.push_back(!row.collision.empty());
  std::map<std::pair<int, int>, std::string> reasons;
  if (geometry) {
    const collision::RobotSolids solids(chain, *geometry);
    for (const auto& pair : solids.parts().unchecked)
      reasons[pair] = "always";
    for (const auto& pair : geometry->never_colliding)
      reasons[pair] = "described";
  }
  for (const auto& pair : collision::neighbouring_links(chain, has_shape))
    reasons[pair] = "adjacent";
  std::vector<UncheckedLinks> unchecked;
  for (const auto& [pair, reason] : reasons)
    unchecked.push_back({chain.links()[static_cast<std::size_t>(pair.first)].name,
                         chain.links()[static_cast<std::size_t>(pair.second)].name, reason});
  return unchecked;
}

RobotLinks describe_links(const LookedAt& looked_at,
                          const std::optional<geometry::RobotShapes>& geometry) {
  const kinematics::Chain& chain = looked_at.robot.chain;
  RobotLinks links{.base_link = chain.base_link(),
                   .tip_link = chain.tip_link(),
                   .is_suggested = looked_at.links.is_suggested,
                   .possible_ends = possible_ends(looked_at.links.ends),
                   .links = {},
                   .has_geometry = geometry.has_value(),
                   .unchecked = {},
                   .mobile_base = kinematics::describe_mobile_base(looked_at.links.tree)};
  const auto held = kinematics::held_values(looked_at.robot);
  for (std::size_t i = 0; i < looked_at.links.tree.size(); ++i)
    links.links.push_back(row_of(looked_at, i, held));
  if (geometry)
    for (const geometry::LinkShape& shape : geometry->shapes)
      if (shape.approximate)
        ++links.links[static_cast<std::size_t>(shape.link)].approximated;
  links.unchecked = unchecked_of(chain, geometry, links.links);
  return links;
}

std::string limits_text(const RobotLink& row) {
  constexpr int kDigits = 3;
  if (!row.lower || !row.upper || row.joint_type == "continuous")
    return "";
  return " " + number_text(*row.lower, kDigits) + " to " + number_text(*row.upper, kDigits);
}

/// A joint's motion, with the chain's index and held value.
std::string motion_text(const RobotLink& row) {
  constexpr int kDigits = 3;
  if (row.joint.empty())
    return "root";
  std::string text = row.chain_joint ? "q" + std::to_string(*row.chain_joint) + " " : "";
  text += row.joint_type + limits_text(row);
  if (!row.mimics.empty())
    text += ", as " + row.mimics;
  if (row.held)
    text += ", held " + number_text(*row.held, kDigits);
  if (!row.fault.empty())
    text += ", WRONG: " + row.fault;
  return text;
}

std::string solids_text(const RobotLink& row) {
  std::map<std::string, std::uint64_t> counts;
  for (const std::string& kind : row.collision)
    ++counts[kind];
  std::string text;
  for (const auto& [kind, count] : counts)
    text +=
        (text.empty() ? "" : ", ") +
        (kind == "mesh" && count > 1 ? std::to_string(count) + " meshes" : count_text(count, kind));
  return text.empty() ? "-" : text;
}

/// The links as a tree is read, each below its parent, with a dot for each link above it.
void add_rows(const RobotLinks& links, const std::string& parent, std::size_t depth, Table& table) {
  for (const RobotLink& row : links.links) {
    if (row.parent != parent)
      continue;
    const bool is_base = row.link == links.base_link, is_tip = row.link == links.tip_link;
    table.add_row({std::string(depth, '.') + row.link +
                       (is_base  ? " (base)"
                        : is_tip ? " (tip)"
                                 : ""),
                   row.joint.empty() ? "-" : row.joint, motion_text(row), solids_text(row)});
    add_rows(links, row.link, depth + 1, table);
  }
}

/// One after the other below a heading, as many in a line as fit.
void print_wrapped(const std::vector<std::string>& words, std::ostream& out) {
  constexpr std::size_t kColumns = 78;
  std::string line = "   ";
  for (const std::string& word : words) {
    if (line.size() + word.size() + 2 > kColumns && line.size() > 3) {
      out << line << '\n';
      line = "   ";
    }
    line += " " + word + (&word == &words.back() ? "" : ",");
  }
  out << line << '\n';
}

void print_unchecked(const RobotLinks& links, std::ostream& out) {
  const std::map<std::string, std::string> words = {{"adjacent", "joined by one moving joint"},
                                                    {"described", "named by SRDF or chain.toml"},
                                                    {"always", "touch wherever the robot goes"}};
  for (const auto& [reason, what] : words) {
    std::vector<std::string> pairs;
    for (const UncheckedLinks& pair : links.unchecked)
      if (pair.reason == reason)
        pairs.push_back(pair.link_a + " - " + pair.link_b);
    if (!pairs.empty()) {
      out << "  " << count_text(pairs.size(), "pair") << " " << what << ":\n";
      print_wrapped(pairs, out);
    }
  }
}

/// Base and tip, and the possible ones.
void print_ends(const RobotLinks& links, std::ostream& out) {
  out << "chain       " << links.base_link << " -> " << links.tip_link;
  if (links.is_suggested)
    out << " (suggested: --base " << links.base_link << " --tip " << links.tip_link << ')';
  out << '\n';
  for (const PossibleEnds& ends : links.possible_ends)
    out << "possible    --base " << listed(ends.bases) << "; --tip " << listed(ends.tips) << ": "
        << count_text(ends.joints, "joint") << '\n';
  for (const std::string& sentence : links.mobile_base)
    out << "mobile base " << sentence << '\n';
}

void print_tree(const RobotLinks& links, std::ostream& out) {
  out << '\n';
  Table table({"LINK", "JOINT", "MOVES", "SOLIDS"});
  add_rows(links, "", 0, table);
  table.print(out);
}

void print_links(const RobotLinks& links, const RobotDescription& description, std::ostream& out) {
  print_ends(links, out);
  print_transfer(description, out);
  print_tree(links, out);
  std::uint64_t approximated = 0;
  for (const RobotLink& row : links.links)
    approximated += row.approximated;
  if (approximated > 0)
    out << "\nThe server, which has no meshes, gets solids around " << approximated
        << " of them; planning uses the triangles.\n";
  out << "\nnever checked against each other: links that no joint moves apart, and\n";
  print_unchecked(links, out);
}

bool has_faults(const models::LinksOfFile& links) {
  return std::ranges::any_of(
      links.tree, [](const kinematics::TreeLink& link) { return !link.joint.fault.empty(); });
}

/// The links of a URDF that is no robot yet, because a joint in it is wrong.
void list_faulty(const models::RobotArguments& arguments, const models::LinksOfFile& links,
                 bool json, std::ostream& out) {
  RobotLinks listing{.base_link = arguments.base_link,
                     .tip_link = arguments.tip_link,
                     .is_suggested = links.is_suggested,
                     .possible_ends = possible_ends(links.ends),
                     .links = {},
                     .has_geometry = false,
                     .unchecked = {},
                     .mobile_base = kinematics::describe_mobile_base(links.tree)};
  for (std::size_t i = 0; i < links.tree.size(); ++i)
    listing.links.push_back(row_of(links.tree, i));
  if (json) {
    out << json::to_json(listing) << '\n';
    return;
  }
  print_ends(listing, out);
  print_tree(listing, out);
}

RobotFrames describe_frames(const LookedAt& looked_at, const Eigen::VectorXd& q,
                            const std::optional<Eigen::Isometry3d>& T_task_base) {
  const kinematics::Chain& chain = looked_at.robot.chain;
  const Eigen::Isometry3d T_frame_base = T_task_base.value_or(Eigen::Isometry3d::Identity());
  RobotFrames frames{.base_link = chain.base_link(),
                     .tip_link = chain.tip_link(),
                     .q = {q.begin(), q.end()},
                     .frame = T_task_base ? "task" : "base",
                     .links = {}};
  const std::vector<Eigen::Isometry3d> poses = kinematics::link_poses(chain, q);
  for (std::size_t i = 0; i < poses.size(); ++i)
    frames.links.push_back({chain.links()[i].name, T_frame_base * poses[i]});
  frames.transfer = T_frame_base * kinematics::T_base_transfer(chain, q);
  return frames;
}

void print_frames(const RobotFrames& frames, const RobotDescription& description,
                  std::ostream& out) {
  constexpr int kDigits = 4;
  out << "poses in    "
      << (frames.frame == "task" ? std::string("task frame") : "base link " + frames.base_link)
      << "; x y z m, qx qy qz qw\n"
      << "at q        ";
  for (std::size_t i = 0; i < frames.q.size(); ++i)
    out << (i == 0 ? "" : " ") << number_text(frames.q[i], kDigits);
  out << '\n';
  print_transfer(description, out);
  out << '\n';
  Table table({"LINK", "X", "Y", "Z", "QX", "QY", "QZ", "QW"});
  const auto add = [&](const std::string& name, const Eigen::Isometry3d& pose) {
    std::vector<std::string> cells = {name};
    for (const double value : to_pose_array(pose))
      cells.push_back(number_text(value, kDigits));
    table.add_row(std::move(cells));
  };
  for (const LinkFrame& frame : frames.links)
    add(frame.link, frame.pose);
  add("(transfer frame)", frames.transfer);
  table.print(out);
}

}  // namespace

int list_links(const LinksOptions& options, std::ostream& out, std::ostream& err) {
  models::RobotArguments arguments = options.robot;
  auto tree = models::complete_ends(arguments);
  if (!tree)
    return refuse(kLinks, tree.error(), err);
  int code = kDone;
  auto robot = read_robot(kLinks, arguments, err, code);
  if (!robot && !has_faults(*tree))
    return code;
  if (!robot) {
    list_faulty(arguments, *tree, options.json, out);
    return kDone;
  }
  const LookedAt looked_at{std::move(arguments), *std::move(tree), *std::move(robot)};
  const auto geometry = read_geometry(kLinks, looked_at.arguments, looked_at.robot, err);
  const RobotLinks links = describe_links(looked_at, geometry);
  if (options.json)
    out << json::to_json(links) << '\n';
  else
    print_links(links, looked_at.robot.description, out);
  return kDone;
}

int list_frames(const FramesOptions& options, std::ostream& out, std::ostream& err) {
  int code = kDone;
  const auto looked_at = look_at(kFrames, options.robot, err, code);
  if (!looked_at)
    return code;
  const auto placement = placement_of(options.placement);
  if (!placement)
    return refuse(kFrames, placement.error(), err);
  const kinematics::Chain& chain = looked_at->robot.chain;
  Result<Eigen::VectorXd> q = Eigen::VectorXd(
      Eigen::VectorXd::Zero(chain.dof()).cwiseMax(chain.lower()).cwiseMin(chain.upper()));
  if (!options.configuration.empty())
    q = parse_configuration(options.configuration);
  if (!q)
    return refuse(kFrames, q.error(), err);
  if (const auto fault = check_configuration(chain, *q))
    return refuse(kFrames, *fault, err);
  const RobotFrames frames = describe_frames(*looked_at, *q, *placement);
  if (looked_at->links.is_suggested && !options.json)
    err << kFrames << ": base and tip are suggested ones: --base " << chain.base_link() << " --tip "
        << chain.tip_link() << '\n';
  if (options.json)
    out << json::to_json(frames) << '\n';
  else
    print_frames(frames, looked_at->robot.description, out);
  return kDone;
}

}  // namespace kinship::cli
