#include <unistd.h>

#include <iostream>

#include "client/arguments/command_options.hpp"
#include "client/arguments/number_range.hpp"
#include "client/cli/compare_command.hpp"
#include "client/cli/init_command.hpp"
#include "client/cli/kinematics_commands.hpp"
#include "client/cli/link_commands.hpp"
#include "client/cli/robot_commands.hpp"
#include "client/cli/session.hpp"
#include "client/cli/show_commands.hpp"
#include "client/cli/srdf_command.hpp"
#include "client/cli/terminal.hpp"
#include "client/cli/upkeep_commands.hpp"
#include "robots/collision/edge_prover.hpp"
#include "robots/models/chain_file.hpp"

namespace kinship::cli {
namespace {

void add_robot_arguments(CLI::App& command, models::RobotArguments& robot) {
  command
      .add_option(
          "robot", robot.source,
          "Folder with a chain.toml ('kinship robots init' makes one), URDF file, or a robot that "
          "comes along, e.g. panda")
      ->required()
      ->type_name("FILE");
  arguments::add_robot_options(command, robot);
}

/// Which solutions of a pose are wanted.
void add_choice(CLI::App& command, int& max_solutions, double& min_distance) {
  command
      .add_option("--max-solutions", max_solutions,
                  "Solutions per pose at most (default 8; 0: all)")
      ->check(arguments::between(0, 1000));
  command
      .add_option("--min-distance", min_distance,
                  "Between the solutions of a pose, joint units (default 0.2)")
      ->check(arguments::between(0.0, 100.0));
}

void add_init(CLI::App& group, Session& session) {
  const auto options = std::make_shared<InitOptions>();
  CLI::App* command = add_command(
      group, "init", "Write the chain.toml of a URDF: then its folder is all that commands need",
      "kinship robots init arm.urdf -o arm\n"
      "  kinship robots init arm.urdf -o arm --base base_link --tip tool0 --transfer \"0 0 0.12 0 "
      "0 0 1\" --package arm_description=src/arm_description --srdf arm.srdf\n"
      "  kinship robots check arm");
  command->add_option("urdf", options->robot.source, "URDF file, also xacro")
      ->required()
      ->type_name("FILE");
  arguments::add_robot_options(*command, options->robot);
  command
      ->add_option("--limit-slack", options->robot.limit_slack,
                   "A start or goal beyond a joint limit by less is moved onto it, joint units")
      ->check(arguments::between(0.0, models::kMaxLimitSlack));
  command
      ->add_option("-o,--output", options->folder,
                   "Folder of the chain.toml, made if it is not there (default: the URDF's)")
      ->type_name("FOLDER");
  command->add_flag("--force", options->force, "Replace a chain.toml that is there");
  on_run(*command, session, [&session, options] {
    const bool asks = isatty(STDIN_FILENO) == 1 && is_terminal(session.err);
    return init_robot(*options, asks ? &std::cin : nullptr, session.out, session.err);
  });
}

void add_check(CLI::App& group, Session& session) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* command = add_command(group, "check", "What Kinship makes of a robot (no server)",
                                  "kinship robots check ur10e.urdf --base base_link --tip tool0");
  add_robot_arguments(*command, options->robot);
  command->add_option("--poses", options->poses, "Reachable poses to solve (default 200)")
      ->check(arguments::between(1, 1'000'000));
  add_choice(*command, options->max_solutions, options->min_distance);
  command->add_option("--seed", options->seed, "Of the poses and solutions (default 0)")
      ->check(CLI::NonNegativeNumber);
  add_json(*command, session);
  on_run(*command, session, [&session, options] {
    options->json = session.json;
    return check_robot(*options, session.out, session.err);
  });
}

constexpr const char* kPlacementHelp =
    "Base pose in the task frame (placement), \"x y z qx qy qz qw\": poses are then in the task "
    "frame";

void add_forward(CLI::App& group, Session& session) {
  const auto options = std::make_shared<ForwardCommandOptions>();
  CLI::App* command =
      add_command(group, "fk", "Where configurations put tip link and transfer frame (no server)",
                  "kinship robots fk robots/models/ur10e --q \"0 -1.57 1.57 0 1.57 0\"\n"
                  "kinship robots fk robots/models/ur10e --configurations starts.jsonl --json");
  add_robot_arguments(*command, options->robot);
  CLI::Option_group* configurations = command->add_option_group("configurations");
  arguments::add_numbers(*configurations, "--q", options->configuration,
                         "Joint values, rad or m, with blanks or commas");
  configurations
      ->add_option("--configurations", options->configurations, "File with lines [q_1, q_2, ...]")
      ->type_name("FILE");
  configurations->require_option(1);
  arguments::add_numbers(*command, "--placement", options->placement, kPlacementHelp);
  add_json(*command, session);
  on_run(*command, session, [&session, options] {
    options->json = session.json;
    return place_configurations(*options, session.out, session.err);
  });
}

void add_inverse(CLI::App& group, Session& session) {
  const auto options = std::make_shared<InverseCommandOptions>();
  CLI::App* command = add_command(
      group, "ik", "Inverse kinematics of a pose of the tip link or transfer frame (no server)",
      "kinship robots ik robots/models/ur10e --pose \"0.5 0.1 0.4 0 1 0 0\" --json\n"
      "kinship robots ik robots/models/ur10e --pose \"0.5 0.1 0.4 1 0 0 0\" --frame transfer "
      "--collision-free --scene my.problems.jsonl");
  add_robot_arguments(*command, options->robot);
  CLI::Option_group* poses = command->add_option_group("poses");
  arguments::add_numbers(*poses, "--pose", options->pose,
                         "Of the frame in base link, \"x y z qx qy qz qw\"");
  poses->add_option("--poses", options->poses, "File with lines [x, y, z, qx, qy, qz, qw]")
      ->type_name("FILE");
  poses->require_option(1);
  command
      ->add_option("--frame", options->frame,
                   "Whose pose it is: tip, or transfer as in the goals of problems (default tip)")
      ->check(CLI::IsMember({"tip", "transfer"}));
  arguments::add_numbers(*command, "--placement", options->placement, kPlacementHelp);
  command->add_flag("--collision-free", options->collision_free,
                    "Leave out solutions in which the robot touches itself or the scene");
  command
      ->add_option("--clearance", options->clearance_m,
                   "With --collision-free: what comes nearer touches, m, as kinship-plan has it "
                   "(default 0.001)")
      ->check(arguments::between(collision::kLeastClearance_m, collision::kLargestRoom_m));
  command
      ->add_option("--scene", options->scene,
                   "Problem file: scene, attached objects and placement of its first problem, "
                   "for --collision-free")
      ->type_name("FILE");
  add_choice(*command, options->max_solutions, options->min_distance);
  command->add_option("--seed", options->seed, "Equal seed, equal solutions (default 0)")
      ->check(CLI::NonNegativeNumber);
  add_json(*command, session);
  on_run(*command, session, [&session, options] {
    options->json = session.json;
    return solve_poses(*options, session.out, session.err);
  });
}

void add_register(CLI::App& group, Session& session) {
  const auto robot = std::make_shared<models::RobotArguments>();
  CLI::App* command =
      add_command(group, "register", "Hand a robot's description to the server",
                  "kinship robots register arm.urdf --base base_link --tip tool0 --label arm7");
  add_robot_arguments(*command, *robot);
  arguments::add_without_meshes(*command, *robot);
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, robot](link::Client& server) {
    return register_robot(server, *robot, session.json, session.out, session.err);
  });
}

void add_compare(CLI::App& group, Session& session) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App* command = add_command(
      group, "compare", "What the experience of each robot is worth to each other one on a task",
      "kinship robots compare --task box_to_shelf\n"
      "kinship robots compare --task box_to_shelf --targets ur10e --placement \"ur10e=0 0 0.6 0 0 "
      "0 1\"\n"
      "kinship robots compare --task box_to_shelf --output worths.html");
  command->add_option("--task", options->task, "Task whose experience is meant")
      ->required()
      ->type_name("TASK");
  command
      ->add_option(
          "--targets", options->targets,
          "Robots that would use it: labels or digests, separated by commas (default: all)")
      ->type_name("ROBOT")
      ->delimiter(',');
  command->add_option("--placement", options->placements,
                      "\"LABEL=x y z qx qy qz qw\": base pose of a robot in the task frame "
                      "(default: as in its newest path of the task); may be repeated");
  const auto wait_s = std::make_shared<double>(120);
  command->add_option("--wait", *wait_s, "Seconds for one pair (default 120)")
      ->check(arguments::between(0.0, 3600.0));
  add_page_output(*command, options->output);
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, options, wait_s](link::Client& server) {
    options->wait = milliseconds(*wait_s);
    options->json = session.json;
    options->progress = session.shows_progress();
    return compare_robots(server, *options, session.out, session.err);
  });
}

void add_links(CLI::App& group, Session& session) {
  const auto options = std::make_shared<LinksOptions>();
  CLI::App* command = add_command(
      group, "links",
      "The links of a URDF, their joints and solids, and which could be base and tip (no server)",
      "kinship robots links arm.urdf\n"
      "  kinship robots links arm.urdf --base base_link --tip tool0 --json");
  add_robot_arguments(*command, options->robot);
  add_json(*command, session);
  on_run(*command, session, [&session, options] {
    options->json = session.json;
    return list_links(*options, session.out, session.err);
  });
}

void add_frames(CLI::App& group, Session& session) {
  const auto options = std::make_shared<FramesOptions>();
  CLI::App* command = add_command(
      group, "frames", "Where the links and the transfer frame are at a configuration (no server)",
      "kinship robots frames arm.urdf\n"
      "  kinship robots frames robots/models/ur10e --q \"0 -1.57 1.57 0 1.57 0\"");
  add_robot_arguments(*command, options->robot);
  arguments::add_numbers(
      *command, "--q", options->configuration,
      "Joint values, rad or m, with blanks or commas (default: 0, within the limits)");
  arguments::add_numbers(*command, "--placement", options->placement, kPlacementHelp);
  add_json(*command, session);
  on_run(*command, session, [&session, options] {
    options->json = session.json;
    return list_frames(*options, session.out, session.err);
  });
}

void add_suggest_srdf(CLI::App& group, Session& session) {
  const auto options = std::make_shared<SuggestSrdfOptions>();
  CLI::App* command = add_command(
      group, "suggest-srdf",
      "Which links need not be checked against each other, sampled, as an SRDF (no server)",
      "kinship robots suggest-srdf arm.urdf --base base_link --tip tool0 --output arm.srdf\n"
      "  kinship robots check arm.urdf --base base_link --tip tool0 --srdf arm.srdf");
  add_robot_arguments(*command, options->robot);
  command->add_option("--samples", options->samples, "Random configurations (default 10000)")
      ->check(arguments::between(100, 100'000'000));
  command->add_option("--seed", options->seed, "Of the configurations (default 0)")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--check-default", options->checks_default,
                    "Check also pairs that touch where all joints are at 0");
  command->add_option("--output", options->output, "SRDF file (default: standard output)")
      ->type_name("FILE");
  add_json(*command, session, "What was found as one JSON document on standard output");
  on_run(*command, session, [&session, options] {
    options->json = session.json;
    options->progress = session.shows_progress();
    return suggest_srdf(*options, session.out, session.err);
  });
}

void add_rename(CLI::App& group, Session& session) {
  struct Options {
    std::string robot, label;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      group, "rename", "Give a robot another label; the one it had is free for another robot",
      "kinship robots rename cell1 cell1_without_gripper");
  command->add_option("robot", options->robot, "Label, or four digits of its digest or more")
      ->required()
      ->type_name("ROBOT");
  command->add_option("label", options->label, "New label, 1 to 64 of A-Z a-z 0-9 _ . : -")
      ->required();
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, options](link::Client& server) {
    return rename_robot(server, options->robot, options->label, session.json, session.out,
                        session.err);
  });
}

void add_remove(CLI::App& group, Session& session) {
  struct Options {
    std::string robot;
    bool yes = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      group, "remove",
      "Take a robot out: one without attempts is deleted, of another the paths are retired",
      "kinship robots remove cell1\n  kinship robots remove cell1 --yes");
  command->add_option("robot", options->robot, "Label, or four digits of its digest or more")
      ->required()
      ->type_name("ROBOT");
  command->add_flag("--yes", options->yes,
                    "Do it; without, it is only said what would happen (exit code 2)");
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, options](link::Client& server) {
    return remove_robot(server, options->robot, options->yes, session.json, session.out,
                        session.err);
  });
}

}  // namespace

void add_robots(CLI::App& app, Session& session) {
  CLI::App* robots =
      add_group(app, session, "robots", "Registered robots; inverse kinematics of any");
  add_one(*robots, session,
          {"show", "robot", "Label, or four digits of its digest or more",
           "A robot by label or beginning of its digest", "kinship robots show ur10e"},
          show_robot);
  add_plot(*robots, session,
           {"plot", "robot", "Label, or four digits of its digest or more",
            "A page that shows a robot as the server sees it; its joints can be moved",
            "kinship robots plot ur10e --output ur10e.html"},
           plot_robot);
  add_register(*robots, session);
  add_rename(*robots, session);
  add_remove(*robots, session);
  add_init(*robots, session);
  add_check(*robots, session);
  add_links(*robots, session);
  add_frames(*robots, session);
  add_suggest_srdf(*robots, session);
  add_forward(*robots, session);
  add_inverse(*robots, session);
  add_compare(*robots, session);
}

}  // namespace kinship::cli
