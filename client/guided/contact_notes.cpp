#include "client/guided/contact_notes.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace kinship::planner {
namespace {

constexpr std::size_t kNoted = 200;     // more say nothing new
constexpr std::size_t kThingsTold = 3;  // on one line
constexpr std::size_t kNamesTold = 4;   // of what touches one of them

/// Something that is touched.
struct Touched {
  std::string name;
  std::size_t configurations = 0;              // in which it is
  std::map<std::string, std::size_t> by = {};  // what touches it, in how many of them
};

/// "'l4' or 'l5'", the most frequent first.
std::string names_text(const Touched& touched) {
  std::vector<std::pair<std::string, std::size_t>> by(touched.by.begin(), touched.by.end());
  std::ranges::stable_sort(by, std::greater{}, [](const auto& each) { return each.second; });
  std::string text;
  for (std::size_t i = 0; i < std::min(kNamesTold, by.size()); ++i)
    text += (i == 0 ? "'" : " or '") + by[i].first + "'";
  return text;
}

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
  std::map<std::string, Touched> things;
  for (const Eigen::VectorXd& q : colliding_) {
    std::set<std::string> touched;
    for (const auto& [by, name] : world_.find_contacts(q)) {
      ++things[name].by[by];
      touched.insert(name);
    }
    for (const std::string& name : touched)
      ++things[name].configurations;
  }
  std::vector<Touched> told;
  for (auto& [name, touched] : things) {
    touched.name = name;
    told.push_back(std::move(touched));
  }
  std::ranges::stable_sort(told, std::greater{}, &Touched::configurations);
  std::string text;
  for (std::size_t i = 0; i < std::min(kThingsTold, told.size()); ++i) {
    text += (i == 0 ? "" : ", ") + names_text(told[i]) + " touches '" + told[i].name + "'";
    if (colliding_.size() > 1)
      text += " in " + std::to_string(told[i].configurations) + " of " +
              std::to_string(colliding_.size()) + (i == 0 ? " configurations" : "");
  }
  return text;
}

}  // namespace kinship::planner
