// SPDX-License-Identifier: MIT
#include "device/sim_transport.hpp"

#include <algorithm>
#include <cmath>

namespace popcut {
namespace {

using std::chrono::nanoseconds;

// Full-speed USB moves about this much in bulk.
constexpr double kBytesPerSecond = 1e6;

nanoseconds seconds(double value) { return nanoseconds(std::llround(value * 1e9)); }

Error gone() { return {ErrorKind::DeviceGone, "", "the cutter was unplugged; check its cable"}; }

Error too_late(const char* what) { return {ErrorKind::Timeout, "", what}; }

}  // namespace

SimTransport::SimTransport(SimCutter cutter, std::vector<SimFault> faults)
    : cutter_(std::move(cutter)), faults_(std::move(faults)) {
  std::stable_sort(faults_.begin(), faults_.end(),
                   [](const SimFault& a, const SimFault& b) { return a.at_byte < b.at_byte; });
}

void SimTransport::run_until(nanoseconds time) {
  for (;;) {
    const auto due =
        std::min_element(presses_.begin(), presses_.end(),
                         [](const Press& a, const Press& b) { return a.time < b.time; });
    if (due == presses_.end() || due->time > time) break;
    const Press press = *due;
    presses_.erase(due);
    cutter_.run_until(press.time);
    switch (press.button) {
      case Button::Resume:
        cutter_.resume();
        break;
      case Button::Cancel:
        cutter_.cancel();
        break;
      case Button::LoadMedia:
        cutter_.load_media();
        break;
    }
  }
  cutter_.run_until(time);
}

std::size_t SimTransport::before_fault(std::size_t bytes) const {
  if (next_fault_ == faults_.size()) return bytes;
  const std::uint64_t left = faults_[next_fault_].at_byte - cutter_.accepted_bytes();
  return std::min<std::uint64_t>(bytes, left);
}

bool SimTransport::strike() {
  bool ends = false;
  while (next_fault_ < faults_.size() && faults_[next_fault_].at_byte <= cutter_.accepted_bytes()) {
    const SimFault& fault = faults_[next_fault_++];
    const nanoseconds later = now() + seconds(fault.seconds);
    switch (fault.kind) {
      case SimFault::Kind::Unplug:
        unplugged_ = true;
        break;
      case SimFault::Kind::ShortWrite:
        ends = true;
        break;
      case SimFault::Kind::Nak:
        nak_until_ = later;
        break;
      case SimFault::Kind::Silence:
        silent_until_ = later;
        break;
      case SimFault::Kind::Garbage:
        garbage_ += fault.text;
        break;
      case SimFault::Kind::Pause:
        cutter_.pause();
        if (fault.seconds > 0) presses_.push_back({later, Button::Resume});
        break;
      case SimFault::Kind::Cancel:
        cutter_.pause();
        presses_.push_back({later, Button::Cancel});
        break;
      case SimFault::Kind::MediaOut:
        cutter_.unload_media();
        if (fault.seconds > 0) presses_.push_back({later, Button::LoadMedia});
        break;
    }
  }
  return ends;
}

Transport::WriteEnd SimTransport::write(std::span<const std::byte> bytes, Deadline until) {
  std::size_t taken = 0;
  for (;;) {
    const bool ends = strike();
    if (unplugged_) return {taken, gone()};
    if (taken == bytes.size()) return {taken, std::nullopt};
    if (ends) return {taken, too_late("the write ended early")};
    if (now() < nak_until_) {
      run_until(std::min(nak_until_, until));
      if (now() >= until && now() < nak_until_)
        return {taken, too_late("the cutter takes no data")};
      continue;
    }
    const std::size_t piece = before_fault(bytes.size() - taken);
    const std::size_t got = cutter_.accept(bytes.subspan(taken, piece));
    taken += got;
    run_until(now() + seconds(static_cast<double>(got) / kBytesPerSecond));
    if (got > 0) continue;
    // The buffer is full: back-pressure until the machine has moved on.
    nanoseconds next = cutter_.next_event().value_or(until);
    for (const Press& press : presses_) next = std::min(next, press.time);
    run_until(std::clamp(next, now(), std::max(until, now())));
    if (now() >= until) return {taken, too_late("the cutter takes no data")};
  }
}

Result<std::vector<std::byte>> SimTransport::read(Deadline until) {
  for (;;) {
    if (unplugged_) return tl::unexpected(gone());
    std::vector<std::byte> bytes;
    for (const char c : garbage_) bytes.push_back(static_cast<std::byte>(c));
    garbage_.clear();
    const std::vector<std::byte> replies = cutter_.take_replies();
    if (now() >= silent_until_) bytes.insert(bytes.end(), replies.begin(), replies.end());
    if (!bytes.empty()) return bytes;
    if (now() >= until) return tl::unexpected(too_late("no reply came"));
    // A reply may come of what has still to be carried out.
    nanoseconds next = until;
    if (const auto reply = cutter_.next_reply()) next = std::min(next, *reply);
    if (const auto event = cutter_.next_event()) next = std::min(next, *event);
    for (const Press& press : presses_) next = std::min(next, press.time);
    run_until(std::max(next, now()));
  }
}

void SimTransport::wait(nanoseconds duration) {
  run_until(now() + std::max(duration, nanoseconds(0)));
}

}  // namespace popcut
