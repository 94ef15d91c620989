// SPDX-License-Identifier: MIT
#include "device/session/inquirer.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "protocol/program.hpp"

namespace popcut {
namespace {

constexpr std::size_t kLongestReply = 256;  // the longest known has 20 bytes
constexpr std::size_t kShownBytes = 32;     // of a reply in an error message

}  // namespace

std::chrono::nanoseconds Inquirer::later(double seconds) const {
  return transport_.now() + to_time(seconds);
}

/// Drops unread bytes. A device that never stops sending is an error, not an endless loop.
Result<void> Inquirer::drain() {
  constexpr int kMostPieces = 1000;
  for (int i = 0; i < kMostPieces; ++i) {
    const Result<std::vector<std::byte>> stale = transport_.read(transport_.now());
    if (!stale && stale.error().kind == ErrorKind::Timeout) return {};
    if (!stale) return tl::unexpected(stale.error());
  }
  return fail(ErrorKind::Refused, "",
              "the machine keeps sending data that nobody asked for; switch it off and on");
}

Result<void> Inquirer::forget() {
  if (late_reply_possible_)
    transport_.wait(later(limits_.reply_s * limits_.tries) - transport_.now());
  return drain();
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
    const std::size_t end = reply.find(limits_.reply_end);
    // Two replies to one query, or an endless one, are not an answer.
    if (end != std::string::npos && end + 1 == reply.size()) return reply.substr(0, end);
    if (end != std::string::npos || reply.size() > kLongestReply) return reply;
  }
}

/// Offers the query for `reply_s`, in slices short enough to notice `hurry`.
Transport::WriteEnd Inquirer::begin(std::string_view query) {
  constexpr double kSliceS = 0.25;
  const std::chrono::nanoseconds until = later(limits_.reply_s);
  for (;;) {
    Transport::WriteEnd end = transport_.write(std::as_bytes(std::span(query.data(), query.size())),
                                               std::min(until, later(kSliceS)));
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
  if (owed) late_reply_possible_ = true;  // nothing waits for the reply to that query
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
            fmt::format("the machine answered \"{}\", which is not a status; switch it off and "
                        "on, and check that it is a GPGL machine",
                        printable(**reply, kShownBytes)));
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
    // Long enough for a late reply to arrive, so that the next drain drops it.
    transport_.wait(later(late_reply_possible_ ? limits_.reply_s : limits_.again_s) -
                    transport_.now());
  }
}

}  // namespace popcut
