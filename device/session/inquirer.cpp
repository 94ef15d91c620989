// SPDX-License-Identifier: MIT
#include "device/session/inquirer.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr std::size_t kLongestReply = 256;  // the longest known has 20 bytes

std::string shown(std::string_view bytes) {
  std::string text;
  for (const char c : bytes.substr(0, 32))
    text += c >= ' ' && c <= '~' ? std::string(1, c)
                                 : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  return text;
}

}  // namespace

std::chrono::nanoseconds Inquirer::later(double seconds) const {
  return transport_.now() + std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

/// Drops what arrived unasked. A device that never stops talking is an error, not a loop.
Result<void> Inquirer::drain() {
  constexpr int kMostPieces = 1000;
  for (int i = 0; i < kMostPieces; ++i) {
    const Result<std::vector<std::byte>> stale = transport_.read(transport_.now());
    if (!stale && stale.error().kind == ErrorKind::Timeout) return {};
    if (!stale) return tl::unexpected(stale.error());
  }
  return fail(ErrorKind::Refused, "",
              "the machine sends without being asked and does not stop; switch it off and on");
}

Result<bool> Inquirer::pay_debt(Deadline until) {
  if (owed_.empty()) return true;
  const Transport::WriteEnd end = transport_.write(std::as_bytes(std::span(owed_)), until);
  owed_.erase(0, end.taken);
  if (end.error && end.error->kind != ErrorKind::Timeout) return tl::unexpected(*end.error);
  return owed_.empty();
}

Result<std::string> Inquirer::receive(double seconds) {
  std::string reply;
  const std::chrono::nanoseconds until = later(seconds);
  for (;;) {
    const Result<std::vector<std::byte>> piece = transport_.read(until);
    if (!piece) return tl::unexpected(piece.error());
    for (const std::byte byte : *piece) reply += static_cast<char>(byte);
    const std::size_t end = reply.find('\x03');
    // Two replies to one query, or endless ones, are no answer.
    if (end != std::string::npos && end + 1 == reply.size()) return reply.substr(0, end);
    if (end != std::string::npos || reply.size() > kLongestReply) return reply;
  }
}

/// Offers the query for `reply_s`, in pieces of time short enough for who is in a hurry.
Transport::WriteEnd Inquirer::begin(std::string_view query) {
  constexpr double kSliceS = 0.25;
  const std::chrono::nanoseconds until = later(limits_.reply_s);
  for (;;) {
    Transport::WriteEnd end =
        transport_.write(std::as_bytes(std::span(query)), std::min(until, later(kSliceS)));
    const bool waited_for = end.error && end.error->kind == ErrorKind::Timeout && end.taken == 0;
    const bool hurry = limits_.hurry != nullptr && limits_.hurry->load(std::memory_order_relaxed);
    if (!waited_for || hurry || transport_.now() >= until) return end;
  }
}

Result<std::optional<std::string>> Inquirer::ask(std::string_view query) {
  const bool owed = !owed_.empty();
  const Result<bool> paid = pay_debt(later(limits_.reply_s));
  if (!paid) return tl::unexpected(paid.error());
  if (!*paid) return std::nullopt;
  if (owed) late_reply_possible_ = true;  // nobody waits for the reply to that one
  if (const Result<void> drained = drain(); !drained) return tl::unexpected(drained.error());
  const std::chrono::nanoseconds until = later(limits_.reply_s);
  const Transport::WriteEnd end = begin(query);
  if (end.error && end.error->kind != ErrorKind::Timeout) return tl::unexpected(*end.error);
  if (end.taken == 0) return std::nullopt;
  owed_ = query.substr(end.taken);
  for (int i = 0; i < limits_.tries && !owed_.empty(); ++i)
    if (const Result<bool> rest = pay_debt(until); !rest) return tl::unexpected(rest.error());
  if (!owed_.empty()) return std::nullopt;
  Result<std::string> reply = receive(limits_.reply_s);
  if (!reply) return tl::unexpected(reply.error());
  return std::move(*reply);
}

Result<std::optional<DeviceStatus>> Inquirer::status() {
  int silent = 0;
  int nonsense = 0;
  int changes = 0;
  std::optional<DeviceStatus> doubtful;
  for (;;) {
    const Result<std::optional<std::string>> reply = ask(kStatusQuery);
    if (!reply && reply.error().kind != ErrorKind::Timeout) return tl::unexpected(reply.error());
    if (!reply) {
      late_reply_possible_ = true;
      if (++silent >= limits_.tries)
        return fail(
            ErrorKind::Timeout, "",
            fmt::format("the machine did not answer {} status queries of {:g} s each; check "
                        "that it is switched on, and its cable",
                        silent, limits_.reply_s));
      continue;
    }
    if (!reply->has_value()) return std::nullopt;
    const DeviceStatus status = parse_status(**reply);
    if (status == DeviceStatus::Unknown) {
      if (++nonsense >= limits_.tries)
        return fail(
            ErrorKind::Refused, "",
            fmt::format("the machine answered \"{}\", which is no status; switch it off and "
                        "on, and check that it is a GPGL machine",
                        shown(**reply)));
      transport_.wait(later(limits_.again_s) - transport_.now());
      continue;
    }
    const bool needs_second = status == DeviceStatus::NoMedia || status == DeviceStatus::Ready;
    if (!needs_second) return status;
    if (doubtful == status) {
      if (status == DeviceStatus::Ready) late_reply_possible_ = false;
      return status;
    }
    if (doubtful && ++changes >= limits_.tries)
      return fail(ErrorKind::Refused, "",
                  "the machine's status changes with every query; switch it off and on");
    doubtful = status;
    // Long enough for a late reply to have come, so that the next drain takes it.
    transport_.wait(later(late_reply_possible_ ? limits_.reply_s : limits_.again_s) -
                    transport_.now());
  }
}

}  // namespace popcut
