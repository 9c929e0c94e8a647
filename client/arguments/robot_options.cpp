#include "client/arguments/robot_options.hpp"

#include <CLI/CLI.hpp>

namespace kinship::arguments {

void add_robot_options(CLI::App& app, models::RobotArguments& arguments) {
  app.add_option("--base", arguments.base_link, "base link (required with a URDF file)");
  app.add_option("--tip", arguments.tip_link, "tip link (required with a URDF file)");
  app.add_option("--label", arguments.label, "name for people (default: the folder's or file's)");
  app.add_option("--transfer", arguments.transfer,
                 "transfer frame in the tip link, \"x y z qx qy qz qw\"");
  app.add_option("--axes", arguments.axes,
                 "coordinates that matter, of x,y,z,roll,pitch,yaw (default: all)");
  app.add_option("--hold", arguments.held,
                 "JOINT=VALUE of a joint off the chain, rad or m; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--srdf", arguments.srdf,
                 "SRDF file; the links of its disable_collisions are never checked against each "
                 "other");
  app.add_option("--package", arguments.packages,
                 "NAME=DIR, where meshes named package://NAME/... are; may be repeated")
      ->allow_extra_args(false);
}

}  // namespace kinship::arguments
