#include "server/runtime/worker_pool.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::runtime {

WorkerPool::WorkerPool(const Options& options)
    : queue_limit_(options.queue_limit),
      client_limit_(options.client_limit),
      thread_count_(std::max<std::size_t>(options.threads, 1)) {
  threads_.reserve(thread_count_);
  try {
    for (std::size_t i = 0; i < thread_count_; ++i)
      threads_.emplace_back([this, niceness = options.niceness] { work(niceness); });
  } catch (const std::system_error& error) {
    const std::string begun = std::to_string(threads_.size());
    stop(Leftovers::Abandon);
    throw Failure(ErrorCode::Internal, "only " + begun + " of " + std::to_string(thread_count_) +
                                           " threads could be begun: " + error.what());
  }
}

WorkerPool::~WorkerPool() { stop(Leftovers::Abandon); }

bool WorkerPool::submit(Priority priority, Job job) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_ || interactive_.size() + background_.size() >= queue_limit_)
      return false;
    if (client_limit_ > 0 && !job.client.empty() &&
        interactive_.size_of(job.client) >= client_limit_)
      return false;
    const std::string client = job.client;
    (priority == Priority::Interactive ? interactive_ : background_).push(client, std::move(job));
  }
  wake_.notify_one();
  return true;
}

void WorkerPool::stop(Leftovers leftovers) {
  std::vector<Job> abandoned;
  std::vector<std::thread> threads;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    threads.swap(threads_);
    if (leftovers == Leftovers::Abandon) {
      for (FairQueue<Job>* const queue : {&interactive_, &background_})
        while (!queue->empty())
          abandoned.push_back(queue->pop());
    }
  }
  wake_.notify_all();
  for (const Job& job : abandoned)
    if (job.abandon)
      job.abandon();
  for (std::thread& thread : threads)
    thread.join();
}

std::size_t WorkerPool::queued() const {
  const std::lock_guard lock(mutex_);
  return interactive_.size() + background_.size();
}

std::size_t WorkerPool::queued_of(const std::string& client) const {
  const std::lock_guard lock(mutex_);
  return interactive_.size_of(client);
}

void WorkerPool::work(int niceness) {
  // Linux keeps a nice value per thread; failing to lower it changes no result.
  if (niceness > 0)
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness);
  Job job;
  while (next_job(job)) {
    try {
      job.run();
    } catch (const std::bad_alloc&) {  // counted (memory_reserve); its client asks again
    }
    job = {};  // its references end here, not when the next job comes
  }
}

bool WorkerPool::next_job(Job& job) {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return stopping_ || !interactive_.empty() || !background_.empty(); });
  FairQueue<Job>& queue = interactive_.empty() ? background_ : interactive_;
  if (queue.empty())
    return false;
  job = queue.pop();
  return true;
}

}  // namespace kinship::runtime
