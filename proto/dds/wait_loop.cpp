#include "proto/dds/wait_loop.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>
#include <vector>

namespace kinship::dds {
namespace {

constexpr dds_attach_t kWakeUp = -1;  // attachments of readers count from 0

dds_duration_t time_until(WaitLoop::Clock::time_point when) {
  constexpr std::chrono::nanoseconds kLongest = std::chrono::hours(1);
  const auto now = WaitLoop::Clock::now();
  if (when <= now)
    return 0;
  return when - now > kLongest ? kLongest.count() : std::chrono::nanoseconds(when - now).count();
}

}  // namespace

class WaitLoop::Implementation {
 public:
  explicit Implementation(const Participant& participant)
      : waitset_(dds_create_waitset(participant.get()), "waitset"),
        wake_up_(dds_create_guardcondition(participant.get()), "guard condition") {
    require(dds_waitset_attach(waitset_.get(), wake_up_.get(), kWakeUp), "waitset");
  }

  void attach(const Entity& reader, std::function<bool()> on_data) {
    Entity condition(dds_create_readcondition(reader.get(), DDS_ANY_STATE), "read condition");
    require(dds_waitset_attach(waitset_.get(), condition.get(),
                               static_cast<dds_attach_t>(sources_.size())),
            "waitset");
    sources_.push_back({std::move(condition), std::move(on_data), false});
  }

  void every(Clock::duration period, std::function<void()> on_time) {
    timers_.push_back({period, std::move(on_time), Clock::now() + period});
  }

  void run(const std::function<Clock::time_point()>& on_wake) {
    while (!stopped_) {
      const Clock::time_point next = std::min(on_wake(), call_timers());
      if (stopped_)
        return;
      const bool has_more =
          std::ranges::any_of(sources_, [](const Source& source) { return source.has_more; });
      wait(has_more ? 0 : time_until(next));
      for (Source& source : sources_)
        if (source.has_more && !stopped_)
          source.has_more = source.on_data();
    }
  }

  void wake() { dds_set_guardcondition(wake_up_.get(), true); }

  void stop() {
    stopped_ = true;
    wake();
  }

 private:
  /// Notes who has samples.
  void wait(dds_duration_t time) {
    std::array<dds_attach_t, 16> ready{};
    const std::int32_t count =
        require(dds_waitset_wait(waitset_.get(), ready.data(), ready.size(), time), "waitset");
    bool ignored = false;
    require(dds_take_guardcondition(wake_up_.get(), &ignored), "guard condition");
    const auto end = std::min(static_cast<std::size_t>(count), ready.size());
    for (std::size_t i = 0; i < end; ++i)
      if (ready[i] != kWakeUp)
        sources_[static_cast<std::size_t>(ready[i])].has_more = true;
  }

  /// \return when the next one is due.
  Clock::time_point call_timers() {
    Clock::time_point next = Clock::time_point::max();
    for (Timer& timer : timers_) {
      if (timer.due <= Clock::now()) {
        timer.on_time();
        timer.due = Clock::now() + timer.period;
      }
      next = std::min(next, timer.due);
    }
    return next;
  }

  struct Timer {
    Clock::duration period;
    std::function<void()> on_time;
    Clock::time_point due;
  };

  struct Source {
    Entity condition;
    std::function<bool()> on_data;
    bool has_more = false;
  };

  Entity waitset_;
  Entity wake_up_;
  std::vector<Source> sources_;
  std::vector<Timer> timers_;
  std::atomic<bool> stopped_ = false;
};

WaitLoop::WaitLoop(const Participant& participant)
    : implementation_(std::make_unique<Implementation>(participant)) {}

WaitLoop::~WaitLoop() = default;

void WaitLoop::run(const std::function<Clock::time_point()>& on_wake) {
  implementation_->run(on_wake);
}

void WaitLoop::wake() { implementation_->wake(); }

void WaitLoop::stop() { implementation_->stop(); }

void WaitLoop::every(Clock::duration period, std::function<void()> on_time) {
  implementation_->every(period, std::move(on_time));
}

void WaitLoop::attach(const Entity& reader, std::function<bool()> on_data) {
  implementation_->attach(reader, std::move(on_data));
}

}  // namespace kinship::dds
