// SPDX-License-Identifier: MIT
// Part of device/session/session_run.hpp: what comes before the geometry. Which machine it is, its
// settings, the registration marks.
#include <algorithm>

#include <fmt/format.h>

#include "device/session/session_run.hpp"
#include "protocol/decode.hpp"

namespace popcut {

Result<void> SessionRun::connect() {
  report(SessionPhase::Connecting);
  if (!answers_) return machine_.answers_limits ? check_limits() : Result<void>();
  Result<std::optional<DeviceStatus>> status = std::nullopt;
  for (int i = 0; i < options_.tries && status && !*status; ++i) status = inquirer_.status();
  if (!status) return tl::unexpected(status.error());
  if (!*status)
    return fail(
        ErrorKind::Timeout, "",
        fmt::format("the machine accepted no query for {:g} s; check that it is switched on and "
                    "not busy with another program",
                    options_.reply_s * options_.tries));
  if (*status == DeviceStatus::NoMedia)
    return tl::unexpected(
        refused("no media in the machine; load a sheet, then start again", ErrorReason::NoMedia));
  if (*status == DeviceStatus::Cancelled)
    return tl::unexpected(refused(
        "the last job was cancelled on the panel; wait until the machine is ready, then start "
        "again",
        ErrorReason::PanelStop));
  status_ = **status;
  if (const Result<void> ready = wait_ready(0); !ready) return ready;
  return check_identity().and_then([&] { return check_blade(); });
}

Result<void> SessionRun::check_identity() {
  Result<Identity> said = fail(ErrorKind::Timeout, "", "");
  for (int i = 0; i < options_.tries && !said; ++i) {
    const Result<std::optional<std::string>> reply = inquirer_.ask(kIdentityQuery);
    if (!reply && reply.error().kind != ErrorKind::Timeout) return tl::unexpected(reply.error());
    if (!reply || !*reply) continue;
    end_.identity = **reply;
    // A late reply to a status query is no name: the name follows.
    for (int k = 0; k < options_.tries && parse_status(end_.identity) != DeviceStatus::Unknown;
         ++k) {
      const Result<std::string> next = inquirer_.await(options_.reply_s * options_.tries);
      if (!next && next.error().kind != ErrorKind::Timeout) return tl::unexpected(next.error());
      end_.identity = next ? *next : "";
    }
    said = end_.identity.empty() ? fail(ErrorKind::Timeout, "", "") : parse_identity(end_.identity);
  }
  if (!said && said.error().kind == ErrorKind::Timeout)
    return fail(ErrorKind::Timeout, "",
                "the machine reported its status but not its name; switch it off and on");
  if (!said)
    return tl::unexpected(
        refused("the machine's name cannot be read; check that it is a " + machine_.title));
  const Result<Identity> meant = parse_identity(machine_.identity);
  if (meant && meant->model != said->model)
    return tl::unexpected(
        refused(fmt::format("the machine reports that it is a {}, not a {}; give its "
                            "name with --machine",
                            said->model, meant->model)));
  return {};
}

/// Asks which blade is in the first holder, if the program sets the depth of an autoblade only
/// where there is one. On another blade, the machine would tap it against the bed.
Result<void> SessionRun::check_blade() {
  if (!program_.ask_blade) return {};
  const std::vector<ByteRange> commands = autoblade_commands(program_);
  if (commands.empty()) return {};
  const Result<std::optional<std::string>> reply = inquirer_.ask(kToolsQuery);
  if (!reply && reply.error().kind != ErrorKind::Timeout) return tl::unexpected(reply.error());
  const Result<std::vector<int>> tools =
      reply && *reply ? parse_tools(**reply)
                      : Result<std::vector<int>>(fail(ErrorKind::Timeout, "", ""));
  if (tools && tools->front() == kAutobladeCode) return {};
  left_out_ = commands;
  end_.remarks.push_back(
      tools ? fmt::format("the machine reports in its first holder: {}; popcut does not set the "
                          "depth of a blade there",
                          tool_name(tools->front()))
            : "the machine did not say which blade it has; popcut does not set its depth. If it is "
              "an autoblade, plan with --blade autoblade");
  return {};
}

/// Asks an HPGL machine for the limits of its coordinates. A program that leaves them would be cut
/// along the edge instead, so nothing of it is sent.
Result<void> SessionRun::check_limits() {
  if (!transport_.answers()) return {};
  const Result<std::optional<std::string>> reply = inquirer_.ask(kLimitsQuery);
  if (!reply && reply.error().kind != ErrorKind::Timeout) return tl::unexpected(reply.error());
  const Result<CoordinateLimits> limits =
      reply && *reply ? parse_limits(**reply)
                      : Result<CoordinateLimits>(fail(ErrorKind::Timeout, "", ""));
  if (!limits) {
    end_.remarks.push_back(
        "the machine did not say how far it reaches (OH); popcut goes by its table");
    return {};
  }
  const Result<Program> read = decode(program_.dialect, std::as_bytes(std::span(program_.bytes)));
  if (!read) return tl::unexpected(read.error());
  if (read->points.empty()) return {};
  MachinePoint least = read->points.front(), most = least;
  for (const MachinePoint& p : read->points) {
    least = {std::min(least.a, p.a), std::min(least.b, p.b)};
    most = {std::max(most.a, p.a), std::max(most.b, p.b)};
  }
  if (least.a >= limits->least.a && least.b >= limits->least.b && most.a <= limits->most.a &&
      most.b <= limits->most.b)
    return {};
  const bool exchanged = least.b >= limits->least.a && least.a >= limits->least.b &&
                         most.b <= limits->most.a && most.a <= limits->most.b;
  return tl::unexpected(refused(fmt::format(
      "the machine reaches {:.0f},{:.0f} to {:.0f},{:.0f} of its steps, and the program goes from "
      "{:.0f},{:.0f} to {:.0f},{:.0f}; nothing was cut. {}",
      limits->least.a, limits->least.b, limits->most.a, limits->most.b, least.a, least.b, most.a,
      most.b,
      exchanged ? "It would fit with the axes exchanged: correct \"axes\" in the machine's row"
                : "Plan for a smaller sheet, or correct the machine's width_mm and length_mm")));
}

Result<void> SessionRun::settings() {
  report(SessionPhase::Settings);
  for (const ByteRange& block : program_.setup)
    if (const Result<void> sent = send_program(block.end); !sent) return sent;
  if (const Result<void> ready = wait_ready(plan_.setup_s); !ready || !answers_) return ready;
  window_said_ = window_reply();
  return {};
}

/// Registration marks: the machine searches for them and answers once, without a query; after a
/// miss it searches again from a lower start, as often as the program says.
Result<void> SessionRun::search() {
  if (program_.search.begin == program_.search.end) return {};
  report(SessionPhase::Searching);
  if (!answers_) return send(program_.search, accepted_);  // a file
  if (const Result<void> clean = inquirer_.forget(); !clean) return clean;
  if (const Result<void> sent = send(program_.search, accepted_); !sent) return sent;
  Result<bool> found = found_marks();
  for (std::size_t k = 0; found && !*found && k < program_.search_again.size(); ++k) {
    const std::string lower = search_lower(program_, program_.search_again[k]);
    if (lower.empty()) break;
    std::uint64_t beside = 0;  // these bytes are not the program's
    if (const Result<void> clean = inquirer_.forget(); !clean) return clean;
    if (const Result<void> sent = send(std::as_bytes(std::span(lower)), beside); !sent) return sent;
    found = found_marks();
    if (found && *found)
      end_.remarks.push_back(
          fmt::format("the registration marks were found in search {} only; a plan with another "
                      "mark-start finds them sooner",
                      k + 2));
  }
  if (!found) return tl::unexpected(found.error());
  if (!*found)
    return tl::unexpected(refused(
        "the registration marks were not found, and nothing was cut; check that the sheet is "
        "printed at 100 %, lies as the plan says, and has its square at the upper left; if it "
        "does, "
        "plan with another mark-start",
        ErrorReason::NoMarks));
  return wait_ready(plan_.setup_s);
}

/// What the machine says of one search. Until then no query is sent, since replies do not say what
/// they answer.
Result<bool> SessionRun::found_marks() {
  constexpr double kLongestS = 40;
  Result<std::string> reply = fail(ErrorKind::Timeout, "", "");
  for (double waited = 0; waited < kLongestS; waited += options_.poll_s) {
    reply = inquirer_.await(options_.poll_s);
    if (reply || reply.error().kind != ErrorKind::Timeout) break;
    if (cancel_asked() || give_up_asked()) {
      end_.cancelled = true;
      return tl::unexpected(refused(
          "cancelled while the machine searched for the registration marks; nothing was cut"));
    }
    report(SessionPhase::Searching);
  }
  if (!reply && reply.error().kind == ErrorKind::Timeout)
    return fail(
        ErrorKind::Timeout, "",
        fmt::format("the machine did not report within {:g} s whether it found the registration "
                    "marks; nothing was cut",
                    kLongestS));
  if (!reply) return tl::unexpected(reply.error());
  const Result<double> found = parse_number(*reply);
  return found && *found == 0;
}

}  // namespace popcut
