// A subscriber for tests: publication_listener DOMAIN prints "announcement N REVISION" for those
// whose id is N in every byte, and "event TEXT".

#include <unistd.h>

#include <iostream>
#include <mutex>
#include <string>

#include "proto/dds/publication.hpp"

int main(int /*argc*/, char** argv) {
  using namespace kinship;
  std::mutex output;
  const dds::Participant participant({.domain = static_cast<std::uint32_t>(std::stoul(argv[1]))});
  const dds::Subscriber<codec::AnnouncementPublication> announcements(
      participant, {.on_sample =
                        [&](const Announcement& announcement) {
                          const auto& id = announcement.distribution_id.bytes;
                          if (id.back() != id.front())
                            return;
                          const std::lock_guard lock(output);
                          std::cout << "announcement " << unsigned{id.front()} << ' '
                                    << announcement.revision << std::endl;
                        },
                    .on_server = {}});
  const dds::Subscriber<codec::EventPublication> events(
      participant, {.on_sample =
                        [&](const Event& event) {
                          const std::lock_guard lock(output);
                          std::cout << "event " << event.text << std::endl;
                        },
                    .on_server = {}});
  while (true)
    pause();  // until killed
}
