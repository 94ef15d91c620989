// SPDX-License-Identifier: MIT
#include "daemon/planning/worker_memory.hpp"

#include <unistd.h>

#include <fstream>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace popcut::planning {
namespace {

constexpr std::chrono::milliseconds kMeasureEach{50};

/// What a process has in memory; 0 if it is gone.
std::uint64_t resident_bytes(pid_t pid) {
  std::ifstream file(fmt::format("/proc/{}/statm", pid));
  std::uint64_t all = 0, resident = 0;
  if (!(file >> all >> resident)) return 0;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

WorkerMemory::~WorkerMemory() {
  if (group_ >= 0) ::close(group_);
}

WorkerMemory::Place::Place(std::shared_ptr<WorkerMemory> memory, pid_t pid, std::string who)
    : memory_(std::move(memory)), pid_(pid), who_(std::move(who)) {
  if (!memory_) return;
  const std::lock_guard lock(memory_->mutex_);
  memory_->places_.push_back(this);
}

WorkerMemory::Place::~Place() {
  if (!memory_) return;
  const std::lock_guard lock(memory_->mutex_);
  memory_->places_.remove(this);
}

bool WorkerMemory::Place::must_end() {
  if (!memory_) return false;
  const std::lock_guard lock(memory_->mutex_);
  memory_->measure();
  return must_end_;
}

void WorkerMemory::measure() {
  const auto now = std::chrono::steady_clock::now();
  if (now - measured_ < kMeasureEach) return;
  measured_ = now;
  std::uint64_t all = 0;
  std::map<std::string, std::uint64_t> of_each;
  for (Place* const place : places_) {
    // One that is about to end gives its memory back.
    place->bytes_ = place->must_end_ ? 0 : resident_bytes(place->pid_);
    all += place->bytes_;
    of_each[place->who_] += place->bytes_;
  }
  if (all <= most_) return;
  Place* largest = nullptr;
  for (Place* const place : places_) {
    const auto rank = [&](const Place& one) { return std::pair(of_each[one.who_], one.bytes_); };
    if (largest == nullptr || rank(*largest) < rank(*place)) largest = place;
  }
  largest->must_end_ = true;
}

}  // namespace popcut::planning
