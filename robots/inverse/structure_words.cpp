#include <algorithm>
#include <cstdio>
#include <string>

#include "robots/inverse/closed_form.hpp"
#include "robots/inverse/elimination.hpp"
#include "robots/inverse/lane_chain.hpp"
#include "robots/inverse/task_rank.hpp"

namespace kinship::inverse {
namespace {

std::string lock_text(std::span<const int> locks) {
  std::string text;
  for (const int joint : locks)
    text += (text.empty() ? "lock q" : ", q") + std::to_string(joint + 1);
  return text.empty() ? text : text + "; ";
}

std::string deviation_text(const ClosedForm& form) {
  if (form.exact())
    return "";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), " (off by %.0e)", form.deviation());
  return text.data();
}

std::string form_text(const ClosedForm& form) {
  return form.structure_name() + deviation_text(form) + "; " + lock_text(form.locks()) +
         (form.exact() ? "closed form, " : "closed form of the nominal chain and polish, ") +
         std::to_string(form.branches()) + " branches" + (form.locks().empty() ? "" : " per lock");
}

std::string missing_text(const kinematics::Chain& chain) {
  const auto wanted = std::ranges::count(chain.task_axes().matters, true);
  const Eigen::Index rank = task_rank(chain);
  if (rank >= wanted)
    return "";
  return "; " + std::to_string(chain.dof()) +
         (chain.dof() == 1 ? " joint moves " : " joints move ") + "the transfer frame in " +
         std::to_string(rank) + " of " + std::to_string(wanted) +
         " task axes: poses off that set have no solution";
}

}  // namespace

std::string describe_structure(const kinematics::Chain& chain) {
  const ClosedFormFinding finding = find_closed_form(chain);
  std::string text;
  if (finding.form)
    text = form_text(*finding.form);
  else if (finding.left_out)
    text = finding.left_out->structure_name() + deviation_text(*finding.left_out) + "; " +
           lock_text(finding.left_out->locks()) +
           "closed form left out, random locks seldom lead within limits; numeric";
  else if (elimination_of(chain, lane_chain(chain), instruction_sets().back().kernels))
    text = "no closed form; elimination and polish, at most 16 branches";
  else
    text = "no closed form; numeric";
  return text + missing_text(chain);
}

}  // namespace kinship::inverse
