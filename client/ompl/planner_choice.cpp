#include "client/ompl/planner_choice.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "client/ompl/ompl_planner.hpp"

namespace kinship::ompl_planners {
namespace {

constexpr std::string_view kOmpl = "ompl:";

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : ", ") + word;
  return text;
}

guided::OtherPlanner planner_called(const std::string& name) {
  return [name](const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                const planning::Freedom& freedom, const planning::ConfigurationSampler& sampler,
                const planning::BirrtOptions& limits, std::mt19937_64& generator) {
    const OmplOptions options = {.planner = name, .limits = limits};
    return freedom.constraint != nullptr
               ? plan_with_ompl(start, goals, {freedom.is_free, *freedom.constraint}, sampler,
                                options, generator)
               : plan_with_ompl(start, goals, freedom.is_free, sampler, options, generator);
  };
}

}  // namespace

Result<guided::PlannerChoice> parse_planner(std::string_view text) {
  if (!text.starts_with(kOmpl)) {
    auto own = guided::parse_planner(text);
    if (own)
      return own;
    return Error{own.error().code, own.error().message + ", or ompl:NAME"};
  }
  const std::string name(text.substr(kOmpl.size()));
  const std::vector<std::string> names = ompl_planner_names();
  if (std::ranges::find(names, name) == names.end())
    return Error{
        ErrorCode::InvalidInput,
        "'" + name + "' is no planner of OMPL that can be guided: give one of " + joined(names)};
  return guided::PlannerChoice{guided::PlannerKind::Other, "OMPL " + name, planner_called(name)};
}

}  // namespace kinship::ompl_planners
