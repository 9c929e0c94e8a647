#include "client/guided/contact_notes.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace kinship::planner {
namespace {

constexpr std::size_t kNoted = 200;    // more say nothing new
constexpr std::size_t kPairsTold = 3;  // on one line

}  // namespace

void ContactNotes::note(const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (colliding_.size() < kNoted)
    colliding_.emplace_back(q);
}

planning::IsFree ContactNotes::watched(const planning::IsFree& is_free) {
  return {[&](const Eigen::VectorXd& q) {
            const bool free = is_free(q);
            if (!free)
              note(q);
            return free;
          },
          [&](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
            const Eigen::Index free = is_free.ahead(qs);
            if (free < qs.cols())
              note(qs.col(free));
            return free;
          }};
}

std::string ContactNotes::text() {
  std::map<std::pair<std::string, std::string>, std::size_t> counts;
  for (const Eigen::VectorXd& q : colliding_)
    if (const auto contact = world_.find_contact(q))
      ++counts[{contact->first, contact->second}];
  std::vector<std::pair<std::size_t, std::string>> told;
  for (const auto& [pair, count] : counts)
    told.emplace_back(count, "'" + pair.first + "' touches '" + pair.second + "' (" +
                                 std::to_string(count) + " of " +
                                 std::to_string(colliding_.size()) + ")");
  std::ranges::stable_sort(told, std::greater{}, [](const auto& each) { return each.first; });
  std::string text;
  for (std::size_t i = 0; i < std::min(kPairsTold, told.size()); ++i)
    text += (i == 0 ? "" : ", ") + told[i].second;
  return text;
}

}  // namespace kinship::planner
