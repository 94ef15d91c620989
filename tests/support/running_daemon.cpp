// SPDX-License-Identifier: MIT
#include "tests/support/running_daemon.hpp"
#include "tests/support/paths.hpp"

#include <chrono>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "tests/support/received_log.hpp"

namespace popcut::testing {
namespace {

constexpr int kColumns = 14;
constexpr int kStepMm = 12;

int left_mm(int line) { return 10 + line % kColumns * kStepMm; }
int top_mm(int line) { return 10 + line / kColumns * 4; }

[[noreturn]] void give_up(const std::string& why) { throw std::runtime_error(why); }

}  // namespace

bool happens(const std::function<bool()>& holds, double seconds) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

RunningDaemon::RunningDaemon(double time_scale, const std::string& more, const std::string& device)
    : daemon_(popcutd_program(), time_scale, more, device) {}

void RunningDaemon::open(const std::vector<std::string>& environment) {
  if (!daemon_.start(environment)) give_up("popcutd does not serve: " + daemon_.log());
  const auto address = client::parse_address("unix:" + daemon_.socket());
  client::HttpClient http({*address}, "");
  api_ = std::make_unique<client::Api>(std::move(http));
}

RunningDaemon::Json RunningDaemon::get(const std::string& target) {
  auto found = api_->get(target, target);
  if (!found) give_up(message(found.error()));
  return std::move(*found);
}

client::HttpResponse RunningDaemon::ask(const std::string& method, const std::string& target,
                                        const std::string& body, const std::string& type) {
  client::HttpRequest request;
  request.method = method;
  request.target = target;
  request.body = body;
  request.content_type = body.empty() ? "" : type;
  if (method == "POST") request.headers.emplace_back("Idempotency-Key", client::random_key());
  auto answer = api_->http().ask(std::move(request));
  if (!answer) give_up(message(answer.error()));
  return std::move(*answer);
}

std::string RunningDaemon::lines_svg(int lines, double length_mm) {
  std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='200mm' height='250mm' viewBox='0 0 200 250'>";
  for (int k = 0; k < lines; ++k)
    svg += fmt::format("<path fill='none' stroke='black' d='M{},{}h{}'/>", left_mm(k), top_mm(k),
                       length_mm);
  return svg + "</svg>";
}

std::string RunningDaemon::design(const std::string& svg) {
  const auto made = api_->upload("/v1/designs?name=lines", svg, "image/svg+xml", "design");
  if (!made) give_up(message(made.error()));
  return client::text_of(*made, "id");
}

std::string RunningDaemon::ready_job(const std::string& design, const std::string& device,
                                     const Json& more) {
  Json request{{"design", design}, {"options", {{"order", "keep"}}}};
  if (!device.empty()) request["device"] = device;
  request.update(more, true);
  const auto made = api_->post("/v1/jobs", request, "jobs");
  if (!made) give_up(message(made.error()));
  const std::string id = client::text_of(*made, "id");
  await_state(id, "ready");
  return id;
}

RunningDaemon::Json RunningDaemon::act(const std::string& id, const std::string& action,
                                       const Json& body) {
  auto done = api_->act(job(id), action, body);
  // After a kill nothing is armed until the database is checked, which the refusal says.
  const auto checking = [&] {
    return !done && message(done.error()).find("arm again in a moment") != std::string::npos;
  };
  if (checking())
    (void)happens([&] {
      done = api_->act(job(id), action, body);
      return !checking();
    });
  if (!done) give_up(action + ": " + message(done.error()));
  return std::move(*done);
}

bool RunningDaemon::refused(const std::string& id, const std::string& action, const Json& body) {
  const auto done = api_->act(job(id), action, body);
  return !done && done.error().kind == ErrorKind::Refused;
}

void RunningDaemon::cut(const std::string& id) {
  const Json now = job(id);
  act(id, "arm", {{"sheet", now["sheet"]}});
  act(id, "start", {{"sheet", now["sheet"]}});
}

RunningDaemon::Json RunningDaemon::await(const std::string& id,
                                         const std::function<bool(const Json&)>& holds) {
  Json now;
  const bool came = happens([&] {
    now = job(id);
    return holds(now);
  });
  if (!came) give_up("it never came: " + now.dump() + "\n" + daemon_.log());
  return now;
}

RunningDaemon::Json RunningDaemon::await_state(const std::string& id, const std::string& state) {
  return await(id, [&](const Json& now) { return now["state"] == state; });
}

void RunningDaemon::reset(const std::string& device) {
  const std::string target = "/v1/devices/" + device;
  const Json now = get(target);
  const auto done = api_->post(target + "/actions/reset", Json::object(), device, now["rev"]);
  if (!done) give_up(message(done.error()));
}

std::string RunningDaemon::device_state(const std::string& device) {
  const Json found = get("/v1/devices");
  for (const Json& one : found["items"])
    if (one["id"] == device) return client::text_of(one, "state");
  return "unknown";
}

std::string wrong_in(const nlohmann::json& ledger, int lines, const std::set<int>& cut) {
  const std::set<int> certain = members_of(ledger["certain"]),
                      doubt = members_of(ledger["in_doubt"]),
                      not_sent = members_of(ledger["not_sent"]);
  for (int k = 0; k < lines; ++k) {
    const int lists = (certain.contains(k) ? 1 : 0) + (doubt.contains(k) ? 1 : 0) +
                      (not_sent.contains(k) ? 1 : 0);
    if (lists != 1) return fmt::format("stroke {} is in {} lists", k, lists);
    if (certain.contains(k) && !cut.contains(k)) return fmt::format("stroke {} was not cut", k);
    if (not_sent.contains(k) && cut.contains(k)) return fmt::format("stroke {} was cut", k);
  }
  return {};
}

int line_at(const std::string& place, int lines) {
  for (int line = 0; line < lines; ++line)
    if (place == fmt::format("{} {}", 100 * left_mm(line), 100 * top_mm(line))) return line;
  return -1;
}

namespace {

std::set<int> lines_at(const std::vector<std::string>& places, int lines) {
  std::set<int> cut;
  for (const std::string& place : places) {
    const int line = line_at(place, lines);
    if (line < 0) give_up("the knife came down where no line is: " + place);
    if (!cut.insert(line).second) give_up(fmt::format("line {} was cut twice", line));
  }
  return cut;
}

}  // namespace

std::set<int> lines_of(const Trace& trace, int lines) { return lines_at(places_of(trace), lines); }

std::set<int> lines_cut(const std::filesystem::path& trace_folder, int lines) {
  const auto machine = find_machine("cameo3");
  const std::vector<Received> log = received_log(trace_folder / "received.log");
  if (log.empty()) return {};
  return lines_at(places_cut(log.back().bytes, *machine), lines);
}

std::size_t open_files(pid_t process) {
  std::size_t count = 0;
  std::error_code gone;
  for (const auto& entry :
       std::filesystem::directory_iterator(fmt::format("/proc/{}/fd", process), gone))
    count += entry.path().empty() ? 0 : 1;
  return count;
}

}  // namespace popcut::testing
