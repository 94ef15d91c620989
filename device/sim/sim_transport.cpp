// SPDX-License-Identifier: MIT
#include "device/sim/sim_transport.hpp"

#include <algorithm>
#include <utility>

namespace popcut {
namespace {

using std::chrono::nanoseconds;

// Full-speed USB moves about this much in bulk.
constexpr double kBytesPerSecond = 1e6;

constexpr std::size_t kPacketBytes = 64;

Error gone() { return {ErrorKind::DeviceGone, "", "the cutter was unplugged; check its cable"}; }

Error stalled() {
  return {
      ErrorKind::Refused, "",
      "the cutter stalled while receiving data; switch it off and on, check the sheet, then start "
      "again",
      ErrorReason::Stalled};
}

Error too_late(const char* what) { return {ErrorKind::Timeout, "", what}; }

}  // namespace

SimTransport::SimTransport(SimCutter cutter, std::vector<SimFault> faults)
    : cutter_(std::move(cutter)) {
  for (SimFault& fault : faults)
    (fault.at_path ? path_faults_ : faults_).push_back(std::move(fault));
  std::stable_sort(faults_.begin(), faults_.end(),
                   [](const SimFault& a, const SimFault& b) { return a.at_byte < b.at_byte; });
  std::stable_sort(path_faults_.begin(), path_faults_.end(),
                   [](const SimFault& a, const SimFault& b) { return *a.at_path < *b.at_path; });
}

void SimTransport::run_until(nanoseconds time) {
  for (;;) {
    const auto due =
        std::min_element(presses_.begin(), presses_.end(),
                         [](const Press& a, const Press& b) { return a.time < b.time; });
    if (due == presses_.end() || due->time > time) break;
    const Press press = *due;
    presses_.erase(due);
    run_clock(press.time);
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
      case Button::Replug:
        unplugged_ = false;
        break;
    }
  }
  run_clock(time);
}

/// Runs the cutter, event by event while a fault waits for a stroke.
void SimTransport::run_clock(nanoseconds time) {
  while (next_path_fault_ < path_faults_.size()) {
    strike_paths();
    const auto event = cutter_.next_event();
    if (!event || *event > time) break;
    cutter_.run_until(*event);
  }
  cutter_.run_until(time);
  strike_paths();
}

std::size_t SimTransport::before_fault(std::size_t bytes) const {
  if (next_fault_ == faults_.size()) return bytes;
  const std::uint64_t left = faults_[next_fault_].at_byte - cutter_.accepted_bytes();
  return std::min<std::uint64_t>(bytes, left);
}

void SimTransport::strike() {
  while (next_fault_ < faults_.size() && faults_[next_fault_].at_byte <= cutter_.accepted_bytes())
    strike(faults_[next_fault_++]);
}

void SimTransport::strike_paths() {
  const auto begun = [&] { return cutter_.trace().strokes.size(); };
  while (next_path_fault_ < path_faults_.size() &&
         *path_faults_[next_path_fault_].at_path <= begun())
    strike(path_faults_[next_path_fault_++]);
}

void SimTransport::strike(const SimFault& fault) {
  struck_ = now();
  const nanoseconds later = now() + to_time(fault.seconds);
  switch (fault.kind) {
    case SimFault::Kind::Unplug:
      unplugged_ = true;
      if (fault.seconds > 0) presses_.push_back({later, Button::Replug});
      break;
    case SimFault::Kind::ShortWrite:
      write_ends_ = true;
      break;
    case SimFault::Kind::Stall:
      stalls_ = true;
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
    case SimFault::Kind::WrongName:
      cutter_.answer_as(fault.text);
      break;
    case SimFault::Kind::NoMarks:
      cutter_.lose_marks();
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

Transport::WriteEnd SimTransport::write(std::span<const std::byte> bytes, Deadline until) {
  std::size_t taken = 0;
  for (;;) {
    strike();
    if (unplugged_) return {taken, gone()};
    if (taken == bytes.size()) return {taken, std::nullopt};
    if (std::exchange(write_ends_, false)) return {taken, too_late("the write ended early")};
    if (std::exchange(stalls_, false)) {
      // Half a packet has arrived, but the bus does not say so.
      const std::size_t rest = std::min(bytes.size() - taken, kPacketBytes);
      static_cast<void>(cutter_.accept(bytes.subspan(taken, rest / 2)));
      return {taken, stalled(), rest};
    }
    if (now() < nak_until_) {
      run_until(std::min(nak_until_, until));
      if (now() >= until && now() < nak_until_)
        return {taken, too_late("the cutter takes no data")};
      continue;
    }
    const std::size_t piece = before_fault(bytes.size() - taken);
    const std::size_t got = cutter_.accept(bytes.subspan(taken, piece));
    taken += got;
    run_until(now() + to_time(static_cast<double>(got) / kBytesPerSecond));
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
    if (now() >= until) return tl::unexpected(too_late("no reply arrived"));
    // Commands that are still to be executed may produce a reply.
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
