// Changes by other servers of the same store, and their consequences for this one's memory.

#include <set>
#include <string>

#include "server/service/service.hpp"

namespace kinship::service {

void Service::take_changes(const store::StoreChanges& changes) {
  for (const Digest& robot : changes.robots)
    if (!robots_.read_again(robot)) {
      catalog_.forget_robot(robot);
      advice_.forget(robot);
    }
  std::set<std::string> grown, retired;
  for (const store::ChangedExperience& pair : changes.experience) {
    grown.insert(pair.task);
    advice_.read_again(pair.task, pair.now.robot);
    std::uint64_t& known = retired_generations_[{pair.task, pair.now.robot}];
    if (pair.now.retired_generation > known)
      retired.insert(pair.task);
    known = pair.now.retired_generation;
  }
  for (const std::string& task : retired)
    forget_task(task);
  for (const std::string& task : grown)
    if (!retired.contains(task))
      new_experience(task);
  for (const Digest& id : changes.evicted)
    catalog_.evict(id);
}

void Service::forget_task(const std::string& task) {
  experience_.forget(task);
  rehearsals_.forget(task);
  catalog_.forget(task);
}

void Service::new_experience(std::string_view task) {
  experience_.new_experience(task);
  rehearsals_.new_experience(task);
  catalog_.new_experience(task);
}

}  // namespace kinship::service
