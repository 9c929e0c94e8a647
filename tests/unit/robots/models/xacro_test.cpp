#include "robots/models/xacro.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "proto/types/failure.hpp"
#include "robots/models/robot_arguments.hpp"
#include "robots/models/suggested_ends.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::models::xacro_test {
namespace {

constexpr const char* kXacro = "<robot name='r'><link name='${prefix}a'/></robot>";

/// A program of the name `xacro` in PATH. Debian has no package of ROS's: this one does what is
/// said here.
class XacroProgram : public testing::Test {
 public:
  XacroProgram() : path_(std::getenv("PATH")) {  // NOLINT(concurrency-mt-unsafe)
    setenv("PATH", (folder_.path().string() + ":" + path_).c_str(), 1);  // NOLINT
  }
  ~XacroProgram() override { setenv("PATH", path_.c_str(), 1); }  // NOLINT(concurrency-mt-unsafe)

 protected:
  /// \param script  in sh.
  void does(const std::string& script) const {
    const auto file = folder_ / "xacro";
    std::ofstream(file) << "#!/bin/sh\n" << script << "\n";
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
    return folder_.path() / name;
  }

  test::TemporaryDirectory folder_;

 private:
  std::string path_;
};

std::string complaint(const std::filesystem::path& file, const XacroInput& input) {
  try {
    return "no: " + read_expanded(file, input);
  } catch (const Failure& failure) {
    return failure.what();
  }
}

TEST_F(XacroProgram, IsGivenTheFileAndItsArguments) {
  does("printf '%s|' \"$@\"");
  const auto file = write("-arm.urdf.xacro", kXacro);
  EXPECT_EQ(
      read_expanded(
          file, {.arguments = {"prefix:=left ", "x:=$(y)"}, .max_bytes = 1000, .ending = ".urdf"}),
      file.string() + "|prefix:=left |x:=$(y)|");
}

TEST_F(XacroProgram, MakesARobotOfAFileWhereverOneIsRead) {
  does("sed \"s/[$]{prefix}/${2#prefix:=}/; s/<tip/<!--/; s/tip>/-->/\" \"$1\"");
  const auto file = write("arm.urdf.xacro", R"(<robot name="r"><link name="${prefix}base"/>
    <link name="hand"/><joint name="j" type="revolute"><parent link="left_base"/>
    <child link="hand"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
    </joint></robot>)");
  RobotArguments arguments{.source = file, .xacro = {"prefix:=left_"}};
  const auto ends = complete_ends(arguments);
  ASSERT_TRUE(ends) << ends.error().message;
  EXPECT_EQ(arguments.base_link, "left_base");
  const auto robot = describe_robot(arguments);
  ASSERT_TRUE(robot) << robot.error().message;
  EXPECT_EQ(robot->description.label, "arm");
  EXPECT_NE(robot->description.urdf.find("\"left_base\""), std::string::npos);

  const auto srdf = write("arm.srdf.xacro",
                          "<robot name='r'><disable_collisions link1='${prefix}base' "
                          "link2='hand'/></robot>");
  arguments.srdf = srdf;
  const auto with_pairs = describe_robot(arguments);
  ASSERT_TRUE(with_pairs) << with_pairs.error().message;
  ASSERT_EQ(with_pairs->description.never_colliding.size(), 1U);
  EXPECT_EQ(with_pairs->description.never_colliding[0].first, "left_base");
}

TEST_F(XacroProgram, IsNotRunForAFileThatIsNoXacro) {
  does("exit 9");
  const auto file = write("arm.xacro", "<robot name='r'><link name='a'/></robot>");
  EXPECT_EQ(read_expanded(file, {.arguments = {}, .max_bytes = 100, .ending = ".urdf"}),
            "<robot name='r'><link name='a'/></robot>");
}

TEST_F(XacroProgram, ItsFailureIsTold) {
  does("echo \"no such package: arm\" >&2; exit 3");
  const auto file = write("arm.xacro", kXacro);
  EXPECT_EQ(complaint(file, {.arguments = {}, .max_bytes = 100, .ending = ".urdf"}),
            "'" + file.string() + "': xacro: it failed (exit code 3): no such package: arm");
}

TEST_F(XacroProgram, IsStoppedWhenItWritesTooMuch) {
  does("yes");
  const auto file = write("arm.xacro", kXacro);
  EXPECT_EQ(complaint(file, {.arguments = {}, .max_bytes = 100, .ending = ".urdf"}),
            "'" + file.string() + "': xacro: what it makes exceeds 100 bytes");
}

TEST_F(XacroProgram, AnArgumentHasANameAndIsNoOption) {
  const auto file = write("arm.xacro", kXacro);
  for (const std::string argument : {"prefix=a", ":=a", "--inorder:=a", ""})
    EXPECT_EQ(complaint(file, {.arguments = {argument}, .max_bytes = 100, .ending = ".urdf"}),
              "--xacro-argument '" + argument + "': must be NAME:=VALUE");
}

TEST_F(XacroProgram, WithoutItTheErrorSaysWhereItComesFrom) {
  const auto file = write("arm.urdf.xacro", kXacro);
  setenv("PATH", folder_.path().c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  const std::string message =
      complaint(file, {.arguments = {}, .max_bytes = 100, .ending = ".urdf"});
  EXPECT_NE(message.find("line 1: '${prefix'"), std::string::npos) << message;
  EXPECT_NE(message.find("no program xacro in PATH"), std::string::npos) << message;
  EXPECT_NE(message.find("> arm.urdf"), std::string::npos) << message;
}

}  // namespace
}  // namespace kinship::models::xacro_test
