#include "client/arguments/command_options.hpp"

#include <CLI/CLI.hpp>
#include <chrono>

#include "client/arguments/number_range.hpp"
#include "proto/manual/manual.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::arguments {
namespace {

/// The fault, as CLI11 wants it of a check; empty: none.
template <typename T>
std::string complaint(const Result<T>& result) {
  return result ? std::string() : result.error().message;
}

}  // namespace

std::vector<CLI::Option*> add_profile_options(CLI::App& app, std::string& profile) {
  CLI::Option* const named =
      app.add_option("--profile", profile,
                     "profile of the distribution: default or paper, and what is to be different")
          ->capture_default_str();
  // CLI11 reads options in the order they were added: this one finds the profile complete.
  CLI::Option* const estimator =
      app.add_option_function<std::string>(
             "--estimator",
             [&profile](const std::string& word) { profile += ",estimator=" + word; },
             "gmm: a Gaussian mixture; kde: a kernel density estimate (default: the profile's)")
          ->check(CLI::IsMember({"gmm", "kde"}));
  return {named, estimator};
}

CLI::Option* add_numbers(CLI::App& app, const std::string& name, std::string& text,
                         const std::string& description) {
  return app.add_option(name, text, description)
      ->type_name(manual::kNumbers)
      ->check([](const std::string& word) { return complaint(models::parse_numbers(word)); });
}

void add_robot_options(CLI::App& app, models::RobotArguments& arguments) {
  app.add_option("--base", arguments.base_link, "base link (required with a URDF file)");
  app.add_option("--tip", arguments.tip_link, "tip link (required with a URDF file)");
  app.add_option("--label", arguments.label, "name for people (default: the folder's or file's)");
  add_numbers(app, "--transfer", arguments.transfer,
              "transfer frame (TCP, grasp frame) in the tip link, \"x y z qx qy qz qw\"");
  app.add_option("--axes", arguments.axes,
                 "coordinates that matter, of x,y,z,roll,pitch,yaw (default: all)");
  app.add_option("--hold", arguments.held,
                 "JOINT=VALUE of a joint off the chain, rad or m; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--srdf", arguments.srdf,
                 "SRDF file; the links of its disable_collisions are never checked against each "
                 "other")
      ->type_name("FILE");
  app.add_option("--package", arguments.packages,
                 "NAME=DIR, where meshes named package://NAME/... are, before AMENT_PREFIX_PATH, "
                 "ROS_PACKAGE_PATH and a package.xml above the URDF; may be repeated")
      ->allow_extra_args(false);
  app.add_option(
         "--mesh-folder", arguments.mesh_folders,
         "DIR where meshes are looked for that are not where the URDF says; may be repeated")
      ->allow_extra_args(false)
      ->type_name("FOLDER");
  app.add_option("--xacro-argument", arguments.xacro,
                 "NAME:=VALUE for a URDF or SRDF that is xacro, which the program xacro expands; "
                 "may be repeated")
      ->allow_extra_args(false);
  app.add_flag("--collision-from-visual", arguments.collision_from_visual,
               "links that are drawn and have no collision solids: what is drawn is taken for "
               "solid");
  app.add_option("--without-collision", arguments.without_collision,
                 "LINK that is drawn and needs no collision solid; may be repeated")
      ->allow_extra_args(false);
}

void add_without_meshes(CLI::App& app, models::RobotArguments& arguments) {
  app.add_flag("--without-meshes", arguments.without_meshes,
               "keep the robot's meshes here: the server gets only the solids around them");
}

void add_selection_options(CLI::App& app, SelectionArguments& arguments) {
  app.add_option("--sources", arguments.sources,
                 "only experience of these robots: labels or digests, separated by commas")
      ->type_name("ROBOT")
      ->check([](const std::string& text) { return complaint(parse_robot_names(text)); });
  app.add_option("--weighting", arguments.weighting,
                 "sources: every robot the same; paths: by number of paths (default: the "
                 "profile's)")
      ->check([](const std::string& text) { return complaint(parse_word<Weighting>(text)); });
  app.add_option("--since", arguments.since,
                 "only experience received since a date or time in UTC (2026-11-21T05:32), an age "
                 "(90m, 12h, 14d, 2w) or a Unix time in ms")
      ->check([](const std::string& text) {
        return complaint(parse_since(text, std::chrono::system_clock::now()));
      });
}

void add_server_address(CLI::App& app, const ServerAddress& address) {
  constexpr std::uint32_t kMaxDomain = 230;
  app.add_option("--server", address.host, "host of kinshipd: a name or an address")
      ->envname("KINSHIP_SERVER")
      ->capture_default_str();
  app.add_option("--domain", address.domain, "DDS domain")
      ->envname("KINSHIP_DOMAIN")
      ->check(between<std::uint32_t>(0, kMaxDomain))
      ->capture_default_str();
  app.add_option("--security", address.security,
                 "folder of credentials, made by 'kinshipd secure add' (default: none)")
      ->envname("KINSHIP_SECURITY")
      ->type_name("FOLDER");
}

}  // namespace kinship::arguments
