// SPDX-License-Identifier: MIT
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/fault_control.hpp"
#include "tests/support/paths.hpp"

namespace popcut::testing {

/// The memory page that the shim shares with this test.
class FaultPage {
 public:
  explicit FaultPage(const std::string& path) : path_(path) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0 || ::ftruncate(file, 4096) != 0) throw std::runtime_error("no page: " + path);
    void* const page = ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);
    if (page == MAP_FAILED) throw std::runtime_error("no page: " + path);
    shared_ = static_cast<FaultControl*>(page);
  }
  ~FaultPage() { ::munmap(shared_, 4096); }
  FaultPage(const FaultPage&) = delete;
  FaultPage& operator=(const FaultPage&) = delete;
  FaultControl* operator->() { return shared_; }
  void calm() {
    for (auto* one :
         {&shared_->kill_at, &shared_->kill_after, &shared_->full_from, &shared_->full_until,
          &shared_->bad_sync, &shared_->last_sync, &shared_->blocked})
      *one = 0;
    shared_->clock_s = 0;
  }
  [[nodiscard]] std::vector<std::string> environment() const {
    return {"LD_PRELOAD=" + std::string(fault_shim()), std::string(kFaultControl) + "=" + path_,
            "ASAN_OPTIONS=verify_asan_link_order=0:detect_leaks=0"};
  }

 private:
  std::string path_;
  FaultControl* shared_{};
};

}  // namespace popcut::testing
