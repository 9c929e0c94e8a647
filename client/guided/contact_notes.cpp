#include "client/guided/contact_notes.hpp"

#include <algorithm>
#include <iomanip>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <utility>

namespace kinship::guided {
namespace {

constexpr std::size_t kNoted = 200;     // more say nothing new
constexpr std::size_t kThingsTold = 3;  // on one line
constexpr std::size_t kNamesTold = 4;   // of bodies that touch one of them

std::string millimetres(double length_m) {
  std::ostringstream text;
  text << std::setprecision(3) << 1e3 * length_m << " mm";
  return text.str();
}

/// Something that is touched, or that something is too near to.
struct Touched {
  std::string text;                            // "touches 'wall'"
  std::size_t configurations = 0;              // in which it is
  std::map<std::string, std::size_t> by = {};  // bodies that touch it, in how many of them
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

std::string near_text(const collision::NearPair& near) {
  const std::string first = "'" + near.first + "' ", second = "'" + near.second + "'";
  return near.clearance_m > 0 ? first + "is " + millimetres(near.clearance_m) + " from " + second +
                                    ", nearer than the clearance of " + millimetres(near.asked_m)
                              : first + "touches " + second;
}

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

Eigen::MatrixXd ContactNotes::noted() const {
  Eigen::MatrixXd configurations(colliding_.empty() ? 0 : colliding_.front().size(),
                                 std::ssize(colliding_));
  for (Eigen::Index i = 0; i < configurations.cols(); ++i)
    configurations.col(i) = colliding_[static_cast<std::size_t>(i)];
  return configurations;
}

std::string ContactNotes::text() {
  std::map<std::string, Touched> things;
  for (const Eigen::VectorXd& q : colliding_) {
    std::set<std::string> touched;
    for (const auto& near : find_near_(q)) {
      const std::string what =
          (near.clearance_m > 0 ? "is less than " + millimetres(near.asked_m) + " from '"
                                : "touches '") +
          near.second + "'";
      ++things[what].by[near.first];
      touched.insert(what);
    }
    for (const std::string& what : touched)
      ++things[what].configurations;
  }
  std::vector<Touched> told;
  for (auto& [what, touched] : things) {
    touched.text = what;
    told.push_back(std::move(touched));
  }
  std::ranges::stable_sort(told, std::greater{}, &Touched::configurations);
  std::string text;
  for (std::size_t i = 0; i < std::min(kThingsTold, told.size()); ++i) {
    text += (i == 0 ? "" : ", ") + names_text(told[i]) + " " + told[i].text;
    if (colliding_.size() > 1)
      text += " in " + std::to_string(told[i].configurations) + " of " +
              std::to_string(colliding_.size()) + (i == 0 ? " configurations" : "");
  }
  return text;
}

}  // namespace kinship::guided
