#include "robots/models/robot_arguments.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "proto/types/limits.hpp"

namespace kinship::models::model_folder_test {
namespace {

const std::string kNames = "label = 'r'\nbase = 'b'\ntip = 't'\n";
const std::string kTransfer = "transfer = [0, 0, 0.5, 0, 0, 0, 1]\n";

/// A folder that is deleted with all it holds.
class ModelFolder : public testing::Test {  // NOLINT: GoogleTest deletes it
 protected:
  ModelFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "kinship_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~ModelFolder() override { std::filesystem::remove_all(folder_); }

  void write(std::string_view file, const std::string& text) {
    std::ofstream(folder_ / file, std::ios::binary) << text;
  }

  /// The message for this chain.toml beside an empty URDF, without the path of the file.
  std::string message(const std::string& chain) {
    write(kChainFile, chain);
    write(kUrdfFile, "<robot/>");
    const auto description = read_model_folder(folder_);
    if (description)
      return "fine";
    const std::string& text = description.error().message;
    return text.substr(text.find(".toml: ") + 7);
  }

  std::filesystem::path folder_;
};

TEST_F(ModelFolder, GivesAllThatTheFilesSay) {
  write(kUrdfFile, "<robot/>");
  write(kChainFile, kNames + kTransfer +
                        "axes = ['x', 'yaw']\nnever_colliding = [['a', 'b'], ['c', 'd']]\n"
                        "[hold]\nfinger = 0.25\nlid = 1\n");
  const RobotDescription description = read_model_folder(folder_).value_or_throw();
  EXPECT_EQ(description.label, "r");
  EXPECT_EQ(description.base_link, "b");
  EXPECT_EQ(description.tip_link, "t");
  EXPECT_EQ(description.urdf, "<robot/>");
  EXPECT_TRUE(description.T_tip_transfer.translation().isApprox(Eigen::Vector3d(0, 0, 0.5)));
  EXPECT_EQ(description.task_axes.matters, (std::array{true, false, false, false, false, true}));
  EXPECT_EQ(description.held_joints, (std::map<std::string, double>{{"finger", 0.25}, {"lid", 1}}));
  ASSERT_EQ(description.never_colliding.size(), 2U);
  EXPECT_EQ(description.never_colliding[1], (std::pair<std::string, std::string>("c", "d")));
}

TEST_F(ModelFolder, TakesAllAxesAndHoldsNothingByDefault) {
  EXPECT_EQ(message(kNames + kTransfer), "fine");
  const RobotDescription description = read_model_folder(folder_).value_or_throw();
  EXPECT_TRUE(description.task_axes.all());
  EXPECT_TRUE(description.held_joints.empty());
}

TEST_F(ModelFolder, NamesTheFieldOfWhatItRefuses) {
  EXPECT_EQ(message(kTransfer), "label: must be there, as text");
  EXPECT_EQ(message("label = 'two words'\n" + kTransfer),
            "label: byte 4 is not one of A-Z a-z 0-9 _ . : -");
  EXPECT_EQ(message(kNames), "transfer: must be there: [x, y, z, qx, qy, qz, qw]");
  EXPECT_EQ(message(kNames + "transfer = [1, 2]"), "transfer: has 2 numbers, must have 7");
  EXPECT_EQ(message(kNames + "transfer = [0, 0, 'z', 0, 0, 0, 1]"),
            "transfer: holds something that is not a number");
  EXPECT_NE(message(kNames + "transfer = [0, 0, nan, 0, 0, 0, 1]").find("number 3 of 7"),
            std::string::npos);
  EXPECT_EQ(message(kNames + kTransfer + "axes = ['w']"),
            "axes: 'w' is not one of x, y, z, roll, pitch, yaw");
  EXPECT_EQ(message(kNames + kTransfer + "hold = [1]"),
            "hold: must be a table of joints and values");
  EXPECT_EQ(message(kNames + kTransfer + "never_colliding = [['a', 'b'], ['c']]"),
            "never_colliding: pair 2 is not [link, link]");
  EXPECT_EQ(message(kNames + kTransfer + "tipp = 't'"),
            "tipp: is not a field of this file (did you mean 'tip'?)");
  EXPECT_EQ(message(kNames + kTransfer + "limit_slack = 0.2"),
            "limit_slack: 0.2 is not from 0 to 0.1, joint units");
  EXPECT_EQ(message(kNames + kTransfer + "srdf = ''"), "srdf: is empty");
  EXPECT_EQ(message(kNames + kTransfer + "collision_from_visual = 1"),
            "collision_from_visual: must be true or false");
  EXPECT_EQ(message(kNames + kTransfer + "[packages]\narm = 3"),
            "packages.arm: must be a folder, as text");
  EXPECT_EQ(message(kNames + kTransfer + "[packages]\narm = 'nowhere'"),
            "packages.arm: '" + (folder_ / "nowhere").string() + "': no such folder");
  EXPECT_EQ(message(kNames + kTransfer + "[xacro]\nprefix = 1"), "xacro.prefix: must be text");
  EXPECT_NE(message(kNames + "axes = ?\n").find("line 4: "), std::string::npos);
}

TEST_F(ModelFolder, NamesFilesAndFoldersRelativeToItself) {
  for (const char* name : {"meshes", "src", "more", "other"})
    std::filesystem::create_directory(folder_ / name);
  write("src/arm.urdf", "<robot name='arm'/>");
  write(kChainFile, "urdf = 'src/arm.urdf'\n" + kNames + kTransfer +
                        "mesh_folders = ['meshes']\nlimit_slack = 0.01\n"
                        "without_collision = ['cable']\n[packages]\narm = 'src'\nhand = 'more'\n");
  EXPECT_EQ(read_model_folder(folder_).value_or_throw().urdf, "<robot name='arm'/>");
  const RobotArguments given{.source = folder_,
                             .packages = {"hand=" + (folder_ / "other").string()},
                             .mesh_folders = {"first"}};
  const RobotArguments all = resolve(given).value_or_throw().arguments;
  EXPECT_EQ(all.source, folder_ / "src/arm.urdf");
  EXPECT_EQ(all.packages, (std::vector{"hand=" + (folder_ / "other").string(),
                                       "arm=" + (folder_ / "src").string()}))
      << "arguments count before the file";
  EXPECT_EQ(all.mesh_folders, (std::vector<std::filesystem::path>{"first", folder_ / "meshes"}));
  EXPECT_EQ(all.without_collision, std::vector<std::string>{"cable"});
  EXPECT_EQ(all.limit_slack, 0.01);
  EXPECT_EQ(describe_robot({.source = folder_, .limit_slack = 0}).value_or_throw().limit_slack, 0);
}

TEST_F(ModelFolder, IsReadAsItIsWritten) {
  write("a \"b\".urdf", "<robot/>");
  std::filesystem::create_directory(folder_ / "p");
  ChainFile chain{.label = "r", .base_link = "b\\1", .tip_link = "t"};
  chain.T_tip_transfer.translation() = Eigen::Vector3d(0.1, -1e-7, 1.0 / 3);
  chain.task_axes = parse_task_axes({"x", "yaw"}).value_or_throw();
  chain.held = {{"finger joint", 0.25}};
  chain.never_colliding = {{"a", "b"}};
  chain.urdf = "a \"b\".urdf";
  chain.srdf = "x.srdf";
  chain.packages = {{"arm", "p"}};
  chain.mesh_folders = {"p"};
  chain.xacro = {"name:=a b"};
  chain.collision_from_visual = true;
  chain.without_collision = {"c"};
  chain.limit_slack = 1e-5;
  write(kChainFile, chain_file_text(chain));
  const ChainFile again = read_chain_file(folder_).value_or_throw();
  EXPECT_EQ(again.label, chain.label);
  EXPECT_EQ(again.base_link, chain.base_link);
  EXPECT_EQ(again.T_tip_transfer.matrix(), chain.T_tip_transfer.matrix());
  EXPECT_EQ(again.task_axes, chain.task_axes);
  EXPECT_EQ(again.held, chain.held);
  EXPECT_EQ(again.never_colliding, chain.never_colliding);
  EXPECT_EQ(again.urdf, folder_ / chain.urdf);
  EXPECT_EQ(again.srdf, folder_ / "x.srdf");
  EXPECT_EQ(again.packages.at("arm"), folder_ / "p");
  EXPECT_EQ(again.mesh_folders, std::vector{folder_ / "p"});
  EXPECT_EQ(again.xacro, chain.xacro);
  EXPECT_TRUE(again.collision_from_visual);
  EXPECT_EQ(again.without_collision, chain.without_collision);
  EXPECT_EQ(again.limit_slack, chain.limit_slack);
}

TEST_F(ModelFolder, SaysWhichFileIsMissing) {
  const auto empty = read_model_folder(folder_);
  EXPECT_EQ(empty.error().code, ErrorCode::NotFound);
  EXPECT_EQ(empty.error().message, (folder_ / "chain.toml").string() + ": no such file");
  write(kChainFile, kNames + kTransfer);
  EXPECT_EQ(read_model_folder(folder_).error().message,
            (folder_ / "robot.urdf").string() + ": no such file");
}

TEST_F(ModelFolder, RefusesAUrdfThatIsTooLarge) {
  write(kChainFile, kNames + kTransfer);
  write(kUrdfFile, std::string(kMaxUrdfBytes, ' '));
  EXPECT_TRUE(read_model_folder(folder_));
  write(kUrdfFile, std::string(kMaxUrdfBytes + 1, ' '));
  EXPECT_EQ(read_model_folder(folder_).error().code, ErrorCode::TooLarge);
}

}  // namespace
}  // namespace kinship::models::model_folder_test
