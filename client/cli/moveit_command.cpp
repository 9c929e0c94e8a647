#include "client/cli/moveit_command.hpp"

#include <algorithm>
#include <fstream>
#include <ostream>
#include <set>

#include "client/cli/offline_robot.hpp"
#include "client/cli/terminal.hpp"
#include "client/moveit/conversion.hpp"
#include "proto/files/output_file.hpp"
#include "proto/json/problem_json.hpp"

namespace kinship::cli {
namespace {

constexpr const char* kFromMoveIt = "problems from-moveit";
constexpr std::string_view kRequestPrefix = "request";
constexpr std::string_view kScenePrefix = "scene";

struct FilePair {
  std::filesystem::path scene, request;
};

/// The requests of a folder by name, each with the scene of the same name.
Result<std::vector<FilePair>> pairs_of_folder(const std::filesystem::path& folder) {
  std::vector<FilePair> pairs;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kRequestPrefix) || entry.path().extension() != ".yaml")
      continue;
    const auto scene = folder / (std::string(kScenePrefix) + name.substr(kRequestPrefix.size()));
    if (!std::filesystem::exists(scene))
      return Error{ErrorCode::NotFound, "'" + entry.path().string() + "' has no scene '" +
                                            scene.filename().string() + "' beside it"};
    pairs.push_back({scene, entry.path()});
  }
  if (pairs.empty())
    return Error{ErrorCode::NotFound, "--folder '" + folder.string() + "' holds no request*.yaml"};
  std::ranges::sort(pairs, {}, &FilePair::request);
  return pairs;
}

Result<std::vector<FilePair>> pairs_of(const MoveItCommandOptions& options) {
  if (!options.folder.empty())
    return pairs_of_folder(options.folder);
  const std::size_t requests = options.requests.size();
  const std::size_t scenes = options.scenes.size();
  if (scenes > 1 && scenes != requests)
    return Error{ErrorCode::InvalidInput, "--scene " + std::to_string(scenes) + " times for " +
                                              std::to_string(requests) +
                                              " requests; none, one or as many as requests"};
  std::vector<FilePair> pairs;
  for (std::size_t index = 0; index < requests; ++index) {
    const auto scene = scenes == 0 ? "" : options.scenes[scenes == 1 ? 0 : index];
    pairs.push_back({scene, options.requests[index]});
  }
  return pairs;
}

/// Writes a problem's meshes beside the problem file, each under the problem's name.
std::optional<Error> keep_meshes(moveit::Conversion& conversion,
                                 const std::filesystem::path& output) {
  if (conversion.meshes.empty())
    return std::nullopt;
  if (output.empty())
    return Error{ErrorCode::InvalidInput,
                 "the scene has meshes, which become files beside the problems: name --output"};
  const std::string folder = output.stem().string() + ".meshes";
  const auto beside = output.parent_path() / folder / conversion.problem.name;
  std::filesystem::create_directories(beside);
  for (const moveit::MeshFile& mesh : conversion.meshes) {
    std::ofstream stream(beside / mesh.name);
    if (!(stream << mesh.obj).flush())
      return Error{ErrorCode::Storage, "cannot write '" + (beside / mesh.name).string() + "'"};
  }
  const auto name_file = [&](Mesh& mesh) {
    const bool is_new = std::ranges::find(conversion.meshes, mesh.file, &moveit::MeshFile::name) !=
                        conversion.meshes.end();
    if (is_new)
      mesh.file = folder + "/" + conversion.problem.name + "/" + mesh.file;
  };
  for (SceneMesh& mesh : conversion.problem.scene.meshes)
    name_file(mesh.mesh);
  for (AttachedObject& held : conversion.problem.attached)
    if (held.mesh)
      name_file(*held.mesh);
  return std::nullopt;
}

/// The problems of a file as lines, or why there are none.
Result<std::vector<std::string>> convert_file(const moveit::ConversionInput& input,
                                              const kinematics::Chain& chain,
                                              const std::filesystem::path& output,
                                              std::set<std::string>& left_out) {
  auto conversions = moveit::read_problems(input, chain);
  if (!conversions)
    return conversions.error();
  std::vector<moveit::Conversion> all = *std::move(conversions);
  std::vector<std::string> lines;
  for (moveit::Conversion& made : all) {
    if (const auto error = keep_meshes(made, output))
      return *error;
    left_out.insert(made.left_out.begin(), made.left_out.end());
    lines.push_back(json::to_json(made.problem));
    // Faults for kinship-plan are refused here, where the message's file can be named.
    if (const auto problem = json::problem_from_json(lines.back()); !problem)
      return Error{problem.error().code, "'" + input.request.string() + "', problem '" +
                                             made.problem.name + "': " + problem.error().message};
  }
  return lines;
}

Result<std::optional<Eigen::Isometry3d>> said_placement(const std::string& text) {
  if (text.empty())
    return std::optional<Eigen::Isometry3d>();
  const auto pose = models::parse_pose(text);
  if (!pose)
    return Error{pose.error().code, "--placement: " + pose.error().message};
  return std::optional(*pose);
}

}  // namespace

int convert_moveit(const MoveItCommandOptions& options, std::ostream& out, std::ostream& err) {
  int code = kDone;
  const auto robot = read_robot(kFromMoveIt, options.robot, err, code);
  if (!robot)
    return code;
  const auto placement = said_placement(options.placement);
  if (!placement)
    return refuse(kFromMoveIt, placement.error(), err);
  const auto pairs = pairs_of(options);
  if (!pairs)
    return refuse(kFromMoveIt, pairs.error(), err);
  files::OutputFile output(options.output, out);
  std::set<std::string> left_out;
  std::size_t count = 0;
  for (const FilePair& pair : *pairs) {
    const auto lines = convert_file({.scene = pair.scene,
                                     .request = pair.request,
                                     .T_task_base = *placement,
                                     .name = pair.request.stem().string()},
                                    robot->chain, options.output, left_out);
    if (!lines)
      return refuse(kFromMoveIt, lines.error(), err);
    for (const std::string& line : *lines)
      output.stream() << line << '\n';
    count += lines->size();
  }
  output.keep();
  err << count << (count == 1 ? " problem" : " problems") << '\n';
  for (const std::string& what : left_out)
    err << "left out: " << what << '\n';
  return kDone;
}

}  // namespace kinship::cli
