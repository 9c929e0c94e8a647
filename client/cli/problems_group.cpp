#include "client/arguments/command_options.hpp"
#include "client/cli/moveit_command.hpp"
#include "client/cli/session.hpp"

namespace kinship::cli {

void add_problems(CLI::App& app, Session& session) {
  CLI::App* problems = add_group(app, session, "problems", "Planning problems, for kinship-plan");
  const auto options = std::make_shared<MoveItCommandOptions>();
  CLI::App* command = add_command(
      *problems, "from-moveit", "Problems out of MoveIt's scenes and requests (no server)",
      "kinship problems from-moveit robots/models/panda --scene scene.yaml --request request.yaml "
      "--output panda.problems.jsonl\n"
      "kinship problems from-moveit robots/models/panda --folder shelf_panda --output "
      "shelf.problems.jsonl");
  command
      ->add_option("robot", options->robot.source,
                   "Folder with a chain.toml, URDF file, or a robot that comes along, e.g. panda")
      ->required()
      ->type_name("FILE");
  arguments::add_robot_options(*command, options->robot);
  CLI::Option_group* files = command->add_option_group("files");
  CLI::Option* requests =
      files
          ->add_option("--request", options->requests,
                       "moveit_msgs/MotionPlanRequest as YAML, one or several documents; may "
                       "be repeated")
          ->check(CLI::ExistingFile);
  files
      ->add_option("--folder", options->folder,
                   "Folder of a benchmark set: request*.yaml, each with its scene*.yaml")
      ->check(CLI::ExistingDirectory)
      ->excludes(requests);
  files->require_option(1);
  command
      ->add_option("--scene", options->scenes,
                   "moveit_msgs/PlanningScene as YAML, or RViz's .scene file, for all requests or "
                   "one for each; of "
                   "several documents one for each of the requests' file")
      ->check(CLI::ExistingFile)
      ->needs(requests);
  arguments::add_numbers(
      *command, "--placement", options->placement,
      "Base pose in the task frame (placement), \"x y z qx qy qz qw\" (default: the task "
      "frame is MoveIt's planning frame, that of the URDF's root link)");
  command
      ->add_option("--output", options->output,
                   "Problem file (default: standard output); meshes go into a folder beside it")
      ->type_name("FILE");
  on_run(*command, session,
         [&session, options] { return convert_moveit(*options, session.out, session.err); });
}

}  // namespace kinship::cli
