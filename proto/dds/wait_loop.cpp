#include "proto/dds/wait_loop.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <new>
#include <utility>
#include <vector>

namespace kinship::dds {
namespace {

// Attachments: of sources' readers from 0, of their guards from kGuards.
constexpr dds_attach_t kWakeUp = -1;
constexpr dds_attach_t kGuards = 1 << 16;

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

  void attach(const Entity& reader, std::function<Clock::time_point()> on_data,
              const Entity* guard) {
    const auto number = static_cast<dds_attach_t>(sources_.size());
    Entity condition(dds_create_readcondition(reader.get(), DDS_ANY_STATE), "read condition");
    require(dds_waitset_attach(waitset_.get(), condition.get(), number), "waitset");
    if (guard)
      require(dds_waitset_attach(waitset_.get(), guard->get(), kGuards + number), "waitset");
    sources_.push_back(
        {std::move(condition), guard ? guard->get() : Handle{}, std::move(on_data), kWithSamples});
  }

  void every(Clock::duration period, std::function<void()> on_time) {
    timers_.push_back({period, std::move(on_time), Clock::now() + period});
  }

  void run(const std::function<Clock::time_point()>& on_wake) {
    while (!stopped_) {
      Clock::time_point next = unless_refused([&] { return std::min(on_wake(), call_timers()); });
      if (stopped_)
        return;
      for (const Source& source : sources_)
        next = std::min(next, source.due);
      wait(next == kAgain ? 0 : time_until(next));
      for (Source& source : sources_)
        if (source.is_due() && !stopped_)
          source.due = unless_refused(source.on_data);
    }
  }

  void wake() { dds_set_guardcondition(wake_up_.get(), true); }

  void stop() {
    stopped_ = true;
    wake();
  }

 private:
  /// Without memory a call is made again soon: it must not end the loop of all others.
  template <typename Call>
  static Clock::time_point unless_refused(const Call& call) {
    constexpr std::chrono::milliseconds kPause{50};
    try {
      return call();
    } catch (const std::bad_alloc&) {
      return Clock::now() + kPause;
    }
  }

  /// Notes which readers have samples, and which guards were set.
  void wait(dds_duration_t time) {
    std::array<dds_attach_t, 16> ready{};
    const std::int32_t count =
        require(dds_waitset_wait(waitset_.get(), ready.data(), ready.size(), time), "waitset");
    bool ignored = false;
    require(dds_take_guardcondition(wake_up_.get(), &ignored), "guard condition");
    const auto end = std::min(static_cast<std::size_t>(count), ready.size());
    for (std::size_t i = 0; i < end; ++i) {
      if (ready[i] == kWakeUp)
        continue;
      const bool is_guard = ready[i] >= kGuards;
      Source& source = sources_[static_cast<std::size_t>(is_guard ? ready[i] - kGuards : ready[i])];
      if (is_guard)
        require(dds_take_guardcondition(source.guard, &ignored), "guard condition");
      source.due = kAgain;
    }
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
    Handle guard;  // 0: none
    std::function<Clock::time_point()> on_data;
    Clock::time_point due;

    bool is_due() const { return due == kAgain || (due != kWithSamples && due <= Clock::now()); }
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

void WaitLoop::attach(const Entity& reader, std::function<Clock::time_point()> on_data,
                      const Entity* guard) {
  implementation_->attach(reader, std::move(on_data), guard);
}

}  // namespace kinship::dds
