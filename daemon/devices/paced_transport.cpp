// SPDX-License-Identifier: MIT
#include "daemon/devices/paced_transport.hpp"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

namespace popcut::daemon {
namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

constexpr nanoseconds kSlice = std::chrono::milliseconds(50);

}  // namespace

PacedTransport::PacedTransport(SimTransport sim, double scale, std::function<void()> beat,
                               std::function<void(std::span<const std::byte>)> received)
    : sim_(std::move(sim)),
      scale_(scale),
      beat_(std::move(beat)),
      received_(std::move(received)),
      begun_(steady_clock::now()) {}

nanoseconds PacedTransport::due() const {
  if (!(scale_ > 0)) return sim_.now();
  const nanoseconds passed = steady_clock::now() - begun_;
  return nanoseconds(std::llround(static_cast<double>(passed.count()) * scale_));
}

void PacedTransport::catch_up() {
  beat_();
  if (const nanoseconds late = due() - sim_.now(); late.count() > 0) sim_.wait(late);
}

void PacedTransport::let_pass() {
  beat_();
  if (!(scale_ > 0)) return;
  for (;;) {
    const nanoseconds ahead = sim_.now() - due();
    if (ahead.count() <= 0) return;
    const double real_ns = static_cast<double>(ahead.count()) / scale_;
    std::this_thread::sleep_for(std::min(kSlice, nanoseconds(std::llround(real_ns))));
    beat_();
  }
}

Transport::WriteEnd PacedTransport::write(std::span<const std::byte> bytes, Deadline until) {
  catch_up();
  const WriteEnd end = sim_.write(bytes, until);
  if (received_ && end.taken + end.in_doubt > 0)
    received_(bytes.first(std::min(bytes.size(), end.taken + end.in_doubt)));
  let_pass();
  return end;
}

Result<std::vector<std::byte>> PacedTransport::read(Deadline until) {
  catch_up();
  auto bytes = sim_.read(until);
  let_pass();
  return bytes;
}

nanoseconds PacedTransport::now() const { return std::max(sim_.now(), due()); }

void PacedTransport::wait(nanoseconds duration) {
  catch_up();
  sim_.wait(duration);
  let_pass();
}

Transport::WriteEnd BeatingTransport::write(std::span<const std::byte> bytes, Deadline until) {
  beat_();
  const auto begun = std::chrono::steady_clock::now();
  WriteEnd end = inner_.write(bytes, until);
  if (figures_ != nullptr) {
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
    figures_->note_write(took.count());
    // A machine whose buffer is full takes a part in time; that is no error.
    if (end.error && end.error->kind != ErrorKind::Timeout)
      figures_->note_error(*end.error, end.taken > 0 || end.in_doubt > 0);
  }
  beat_();
  return end;
}

Result<std::vector<std::byte>> BeatingTransport::read(Deadline until) {
  beat_();
  auto bytes = inner_.read(until);
  // Only the session can judge whether an answer is late.
  if (figures_ != nullptr && !bytes && bytes.error().kind != ErrorKind::Timeout)
    figures_->note_error(bytes.error(), false);
  beat_();
  return bytes;
}

void BeatingTransport::wait(nanoseconds duration) {
  constexpr nanoseconds kLong = std::chrono::milliseconds(500);
  const nanoseconds until = inner_.now() + std::max(duration, nanoseconds(0));
  for (;;) {
    beat_();
    const nanoseconds before = inner_.now();
    const nanoseconds left = until - before;
    if (left.count() <= 0) return;
    inner_.wait(std::min(left, kLong));
    // A wait that ends early says that something happened.
    if (inner_.now() - before < std::min(left, kLong) / 2) return;
  }
}

}  // namespace popcut::daemon
