// Text as URDF and as SRDF: a chain whose links are where numbers say, pairs of its links, or a
// refusal in words.

#include "robots/geometry/link_shapes.hpp"
#include "robots/geometry/srdf.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/fuzz/demand.hpp"

namespace kinship::fuzz {
namespace {

constexpr const char* kArm = R"(<robot name="arm">
<link name="base"/><link name="upper"/><link name="tip"/>
<joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="b" type="revolute"><parent link="upper"/><child link="tip"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)";

RobotDescription described(std::string urdf) {
  RobotDescription description;
  description.label = "arm";
  description.urdf = std::move(urdf);
  description.base_link = "base";
  description.tip_link = "tip";
  return description;
}

void try_urdf(std::string text) {
  const RobotDescription description = described(std::move(text));
  const auto chain = kinematics::read_chain(description);
  demand_words(chain);
  if (!chain)
    return;
  const Eigen::VectorXd middle = 0.5 * (chain->lower().cwiseMax(-10) + chain->upper().cwiseMin(10));
  for (const Eigen::Isometry3d& pose : kinematics::link_poses(*chain, middle))
    demand(pose.matrix().allFinite(), "links have finite poses");
}

void try_srdf(std::string_view text) {
  static const auto kChain = kinematics::read_chain(described(kArm));
  const auto pairs = geometry::read_srdf(text, *kChain);
  demand_words(pairs);
}

}  // namespace
}  // namespace kinship::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0)
    return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] == 's')
    kinship::fuzz::try_srdf(text);
  else
    kinship::fuzz::try_urdf(text);
  return 0;
}
