#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/field.hpp"

/// Output of `robots links` and `robots frames` for a URDF. Member names are those of their JSON.
namespace kinship {

struct RobotLink {
  std::string link;
  std::string parent;                  ///< empty for the root link, as is the joint
  std::string joint;                   ///< to the parent
  std::string joint_type;              ///< revolute, continuous, prismatic, fixed, floating, planar
  std::optional<double> lower, upper;  ///< joint units; if it has limits
  std::string mimics;                  ///< the joint that it mimics; empty: none
  std::optional<std::uint64_t> chain_joint;  ///< its number in the chain, from 1
  std::optional<double> held;                ///< its value, if it moves and is not in the chain
  std::uint64_t moved_by = 0;          ///< the last joint of the chain that moves the link; 0: none
  std::vector<std::string> collision;  ///< box, cylinder, sphere or mesh, one a solid
  std::uint64_t approximated = 0;  ///< solids fitted around meshes, where the meshes can be read
  std::string fault = {};          ///< why the joint is not valid; empty: it is
};

template <>
inline constexpr std::tuple kFieldsOf<RobotLink>{
    Field{"link", &RobotLink::link},           Field{"parent", &RobotLink::parent},
    Field{"joint", &RobotLink::joint},         Field{"joint_type", &RobotLink::joint_type},
    Field{"lower", &RobotLink::lower},         Field{"upper", &RobotLink::upper},
    Field{"mimics", &RobotLink::mimics},       Field{"chain_joint", &RobotLink::chain_joint},
    Field{"held", &RobotLink::held},           Field{"moved_by", &RobotLink::moved_by},
    Field{"collision", &RobotLink::collision}, Field{"approximated", &RobotLink::approximated},
    Field{"fault", &RobotLink::fault}};

/// Two links that are never checked against each other.
struct UncheckedLinks {
  std::string link_a, link_b;
  std::string reason;  ///< adjacent, described, always
};

template <>
inline constexpr std::tuple kFieldsOf<UncheckedLinks>{Field{"link_a", &UncheckedLinks::link_a},
                                                      Field{"link_b", &UncheckedLinks::link_b},
                                                      Field{"reason", &UncheckedLinks::reason}};

/// Base and tip links that would make an arm, the likeliest first.
struct PossibleEnds {
  std::vector<std::string> bases, tips;
  std::uint64_t joints = 0;  ///< moving ones between them
};

template <>
inline constexpr std::tuple kFieldsOf<PossibleEnds>{Field{"bases", &PossibleEnds::bases},
                                                    Field{"tips", &PossibleEnds::tips},
                                                    Field{"joints", &PossibleEnds::joints}};

struct RobotLinks {
  std::string base_link, tip_link;
  bool is_suggested = false;  ///< base and tip link were not given
  std::vector<PossibleEnds> possible_ends;
  std::vector<RobotLink> links;               ///< parents before their children
  bool has_geometry = false;                  ///< the meshes could be read
  std::vector<UncheckedLinks> unchecked;      ///< without links that the same joint moves
  std::vector<std::string> mobile_base = {};  ///< joints of a mobile base, as sentences
};

template <>
inline constexpr std::tuple kFieldsOf<RobotLinks>{
    Field{"base_link", &RobotLinks::base_link},
    Field{"tip_link", &RobotLinks::tip_link},
    Field{"is_suggested", &RobotLinks::is_suggested},
    Field{"possible_ends", &RobotLinks::possible_ends},
    Field{"links", &RobotLinks::links},
    Field{"has_geometry", &RobotLinks::has_geometry},
    Field{"unchecked", &RobotLinks::unchecked},
    Field{"mobile_base", &RobotLinks::mobile_base}};

/// Number of random configurations in which two links touched, and the verdict.
struct SampledLinks {
  std::string link_a, link_b;
  std::string verdict;        ///< adjacent, always, default, never, sometimes; the last is checked
  std::uint64_t touched = 0;  ///< number of configurations
};

template <>
inline constexpr std::tuple kFieldsOf<SampledLinks>{
    Field{"link_a", &SampledLinks::link_a}, Field{"link_b", &SampledLinks::link_b},
    Field{"verdict", &SampledLinks::verdict}, Field{"touched", &SampledLinks::touched}};

/// `robots suggest-srdf`.
struct SrdfSuggestion {
  std::string base_link, tip_link;
  std::uint64_t samples = 0;
  std::uint64_t seed = 0;
  double never_bound = 0;  ///< a pair that was never seen touching does so with at most this
                           ///< probability, at a confidence of 95 %
  std::vector<SampledLinks> pairs;
};

template <>
inline constexpr std::tuple kFieldsOf<SrdfSuggestion>{
    Field{"base_link", &SrdfSuggestion::base_link},
    Field{"tip_link", &SrdfSuggestion::tip_link},
    Field{"samples", &SrdfSuggestion::samples},
    Field{"seed", &SrdfSuggestion::seed},
    Field{"never_bound", &SrdfSuggestion::never_bound},
    Field{"pairs", &SrdfSuggestion::pairs}};

struct LinkFrame {
  std::string link;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

template <>
inline constexpr std::tuple kFieldsOf<LinkFrame>{Field{"link", &LinkFrame::link},
                                                 Field{"pose", &LinkFrame::pose}};

struct RobotFrames {
  std::string base_link, tip_link;
  std::vector<double> q;  ///< joint units
  std::string frame;      ///< frame of the poses: base or task
  std::vector<LinkFrame> links;
  Eigen::Isometry3d transfer = Eigen::Isometry3d::Identity();
};

template <>
inline constexpr std::tuple kFieldsOf<RobotFrames>{Field{"base_link", &RobotFrames::base_link},
                                                   Field{"tip_link", &RobotFrames::tip_link},
                                                   Field{"q", &RobotFrames::q},
                                                   Field{"frame", &RobotFrames::frame},
                                                   Field{"links", &RobotFrames::links},
                                                   Field{"transfer", &RobotFrames::transfer}};

}  // namespace kinship
