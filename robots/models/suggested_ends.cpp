#include "robots/models/suggested_ends.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "robots/models/robot_arguments.hpp"
#include "robots/models/text_file.hpp"

namespace kinship::models {
namespace {

/// The names of a link and of the links above it.
std::vector<std::string> ancestry(const std::vector<kinematics::TreeLink>& tree,
                                  const std::string& name) {
  std::vector<std::string> names;
  auto at = std::ranges::find(tree, name, &kinematics::TreeLink::name);
  for (; at != tree.end(); at = at->parent < 0 ? tree.end() : tree.begin() + at->parent)
    names.push_back(at->name);
  return names;
}

/// Whether `above` is an ancestor of `below`.
bool is_above(const std::vector<kinematics::TreeLink>& tree, const std::string& above,
              const std::string& below) {
  const std::vector<std::string> names = ancestry(tree, below);
  return above != below && std::ranges::find(names, above) != names.end();
}

/// \throws Failure(InvalidInput)
void fill_in(const LinksOfFile& links, RobotArguments& arguments) {
  for (const kinematics::ChainEnds& ends : links.ends) {
    const std::string base = arguments.base_link.empty() ? ends.bases.front() : arguments.base_link;
    const std::string tip = arguments.tip_link.empty() ? ends.tips.front() : arguments.tip_link;
    if (!is_above(links.tree, base, tip))
      continue;
    arguments.base_link = base;
    arguments.tip_link = tip;
    return;
  }
  const bool has_base = !arguments.base_link.empty();
  throw Failure(ErrorCode::InvalidInput,
                has_base ? "--base '" + arguments.base_link + "': no arm begins there, give --tip"
                         : "--tip '" + arguments.tip_link + "': no arm ends there, give --base");
}

/// \throws Failure with the fault.
LinksOfFile read_links(RobotArguments& arguments) {
  const bool is_folder = is_model_folder(place_of_robot(arguments.source));
  const RobotArguments resolved = resolve(arguments).value_or_throw().arguments;
  const std::filesystem::path& file = resolved.source;
  const std::string urdf = read_expanded(file, urdf_input(resolved));
  LinksOfFile links;
  links.tree = kinematics::read_link_tree(urdf).value_or_throw();
  links.ends = kinematics::suggest_ends(links.tree);
  if (is_folder)
    return links;
  if (arguments.label.empty() && check_label(file.stem().string()))
    arguments.label = "robot";
  if (!arguments.base_link.empty() && !arguments.tip_link.empty())
    return links;
  if (links.ends.empty())
    throw Failure(ErrorCode::InvalidInput, "'" + file.string() + "': no joint moves");
  fill_in(links, arguments);
  links.is_suggested = true;
  return links;
}

}  // namespace

Result<LinksOfFile> complete_ends(RobotArguments& arguments) {
  try {
    return read_links(arguments);
  } catch (const Failure& failure) {
    return failure.error();
  }
}

}  // namespace kinship::models
