// SPDX-License-Identifier: MIT
#include "daemon/client/api.hpp"

#include <cstdlib>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"
#include "daemon/client/command_words.hpp"

namespace popcut::client {
namespace {

using Json = nlohmann::json;

constexpr const char* kOpenStates = "queued,planning,ready,armed,cutting,paused,interrupted";
constexpr std::size_t kIdLength = 26;

std::string upper(std::string text) {
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return text;
}

std::string id_of(const Json& job) { return text_of(job, "id"); }

std::string titled(const Json& job) {
  const std::string name = text_of(job, "name");
  return name.empty() ? id_of(job) : fmt::format("{} ({})", id_of(job), name);
}

std::string names_of(const std::vector<const Json*>& jobs) {
  constexpr std::size_t kMost = 5;
  std::string names;
  for (std::size_t k = 0; k < std::min(jobs.size(), kMost); ++k)
    names += (k > 0 ? ", " : "") + titled(*jobs[k]);
  if (jobs.size() > kMost) names += fmt::format(" and {} more", jobs.size() - kMost);
  return names;
}

/// The command for each job. Which of its paths a sheet goes on from is seen first.
std::string commands_of(const std::string& action, const std::vector<const Json*>& jobs) {
  constexpr std::size_t kMost = 5;
  const std::string command = action == "resume-from" ? "jobs" : command_for(action);
  std::string lines;
  for (std::size_t k = 0; k < std::min(jobs.size(), kMost); ++k) {
    const std::string name = text_of(*jobs[k], "name");
    lines += fmt::format("{}popcut {} {}{}", k > 0 ? ", or " : "", command, id_of(*jobs[k]),
                         name.empty() ? "" : fmt::format(" ({})", name));
  }
  if (jobs.size() > kMost) lines += fmt::format(", or {} more", jobs.size() - kMost);
  return lines;
}

bool looks_the_same(const Json& a, const Json& b) {
  for (const char* key : {"state", "sheet", "blank", "segment"})
    if (a.value(key, Json()) != b.value(key, Json())) return false;
  return true;
}

std::vector<const Json*> beginning_with(const std::vector<Json>& jobs, const std::string& prefix) {
  std::vector<const Json*> fitting;
  for (const Json& job : jobs)
    if (id_of(job).rfind(prefix, 0) == 0) fitting.push_back(&job);
  return fitting;
}

bool may(const Json& job, const std::string& action) {
  const auto list = job.find("actions");
  if (list == job.end() || !list->is_array()) return false;
  for (const Json& one : *list)
    if (one == action) return true;
  return false;
}

}  // namespace

void make_printable(Json& value) {
  if (value.is_string()) value = shown_lines(value.get_ref<const std::string&>());
  if (value.is_object()) {
    Json plain = Json::object();
    for (auto& [name, one] : value.items()) {
      make_printable(one);
      plain[shown_text(name)] = std::move(one);
    }
    value = std::move(plain);
  }
  if (value.is_array())
    for (Json& one : value) make_printable(one);
}

std::string shown_lines(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const bool is_crlf = end < text.size() && end > at && text[end - 1] == '\r';  // as CSV has it
    out += shown_text(text.substr(at, end - at - (is_crlf ? 1 : 0)));
    if (is_crlf) out += '\r';
    if (end < text.size()) out += '\n';
    at = end + 1;
  }
  return out;
}

std::string text_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::int64_t revision_of(const Json& object) {
  const auto found = object.find("rev");
  return found != object.end() && found->is_number_integer() ? found->get<std::int64_t>() : 0;
}

Result<Api> Api::from_environment() {
  const Environment environment = [](const char* name) -> const char* { return std::getenv(name); };
  auto where = addresses(environment);
  if (!where) return tl::unexpected(where.error());
  auto token = bearer_token(environment);
  if (!token) return tl::unexpected(token.error());
  return Api(HttpClient(std::move(*where), std::move(*token)));
}

Result<Json> Api::read(Result<HttpResponse> response, const std::string& place, Subject subject,
                       const Json* sent) {
  if (!response) return tl::unexpected(response.error());
  if (response->status >= 300) return tl::unexpected(error_from(*response, place, subject, sent));
  if (response->body.empty()) return Json::object();
  auto json = parse_json(response->body, 64);
  if (json) make_printable(*json);
  if (json) return json;
  return fail(ErrorKind::Refused, http_.address().text(),
              "the server there is not popcutd (it sends no JSON); check POPCUT_URL");
}

Result<Json> Api::get(const std::string& target, const std::string& place) {
  return read(http_.ask({"GET", target}), place);
}

Result<std::string> Api::get_text(const std::string& target, const std::string& accept,
                                  const std::string& place) {
  auto response = http_.ask({"GET", target, {}, {}, {{"Accept", accept}}});
  if (!response) return tl::unexpected(response.error());
  if (response->status >= 300) return tl::unexpected(error_from(*response, place));
  return shown_lines(response->body);
}

Result<Json> Api::post(const std::string& target, const Json& body, const std::string& place,
                       std::int64_t rev) {
  const std::string text = json_line(body);
  HttpRequest request{"POST", target, text, "application/json"};
  if (rev >= 0) request.headers.emplace_back("If-Match", fmt::format("\"{}\"", rev));
  return read(http_.ask(std::move(request)), place, Subject::CommandLine, &body);
}

Result<Json> Api::upload(const std::string& target, const std::string& bytes,
                         const std::string& media_type, const std::string& place) {
  constexpr double kUploadSeconds = 900;  // a design is read before popcutd answers
  HttpRequest request{"POST", target, bytes, media_type};
  request.seconds = kUploadSeconds;
  return read(http_.ask(std::move(request)), place, Subject::File);
}

Result<void> Api::remove(const std::string& target, const std::string& place) {
  const auto done = read(http_.ask({"DELETE", target}), place);
  if (!done) return tl::unexpected(done.error());
  return {};
}

Result<std::vector<Json>> Api::list(const std::string& target, const std::string& place,
                                    std::size_t most) {
  std::vector<Json> items;
  std::string cursor;
  do {
    std::string page = target + (target.find('?') == std::string::npos ? "?" : "&") +
                       fmt::format("limit={}", std::min<std::size_t>(200, most - items.size()));
    if (!cursor.empty()) page += "&cursor=" + percent_encoded(cursor);
    auto got = get(page, place);
    if (!got) return tl::unexpected(got.error());
    if (!got->is_object() || !got->contains("items") || !(*got)["items"].is_array())
      return fail(ErrorKind::Refused, http_.address().text(),
                  "the server there is not popcutd; check POPCUT_URL");
    for (Json& one : (*got)["items"]) items.push_back(std::move(one));
    cursor = got->contains("next_cursor") && (*got)["next_cursor"].is_string()
                 ? (*got)["next_cursor"].get<std::string>()
                 : std::string();
  } while (!cursor.empty() && items.size() < most);
  return items;
}

Result<std::vector<Json>> Api::open_jobs() {
  return list(std::string("/v1/jobs?state=") + kOpenStates, "jobs");
}

Result<Json> Api::find_job(const std::string& word) {
  const std::string prefix = upper(word);
  const std::string place = "job " + word;
  if (prefix.empty() ||
      prefix.find_first_not_of("0123456789ABCDEFGHJKMNPQRSTVWXYZ") != std::string::npos ||
      prefix.size() > kIdLength)
    return fail(
        ErrorKind::Usage, place,
        "is not a job id; 'popcut jobs' lists them, and the first letters of one are enough");
  if (prefix.size() == kIdLength) return get("/v1/jobs/" + prefix, place);
  for (const bool all : {false, true}) {
    const auto jobs = all ? list("/v1/jobs", place) : open_jobs();
    if (!jobs) return tl::unexpected(jobs.error());
    const auto fitting = beginning_with(*jobs, prefix);
    // A list leaves out how a job can go on.
    if (fitting.size() == 1) return get("/v1/jobs/" + id_of(*fitting.front()), place);
    if (fitting.size() > 1)
      return fail(
          ErrorKind::Usage, place,
          fmt::format("matches {} jobs: {}; give more letters", fitting.size(), names_of(fitting)));
  }
  return fail(ErrorKind::Refused, place, "there is no such job; 'popcut jobs --all' lists them");
}

Result<Json> Api::only_job_for(const std::string& action) {
  const auto jobs = open_jobs();
  if (!jobs) return tl::unexpected(jobs.error());
  std::vector<const Json*> fitting;
  for (const Json& job : *jobs)
    if (may(job, action)) fitting.push_back(&job);
  if (fitting.size() == 1) return *fitting.front();
  if (fitting.empty())
    return fail(
        ErrorKind::Refused, "",
        fmt::format("'{}' is not possible for any job now; 'popcut jobs' shows what each waits for",
                    action));
  return fail(ErrorKind::Usage, "command line",
              fmt::format("'{}' is possible for {} jobs; name one of them: {}", action,
                          fitting.size(), commands_of(action, fitting)));
}

Result<Json> Api::act(const Json& job, const std::string& action, const Json& body) {
  constexpr int kTries = 5;
  const std::string id = id_of(job);
  const std::string target = fmt::format("/v1/jobs/{}/actions/{}", id, action);
  Json seen = job;
  for (int k = 0;; ++k) {
    auto done = post(target, body, "job " + id, revision_of(seen));
    if (done || k + 1 == kTries || done.error().kind != ErrorKind::Refused) return done;
    auto now = get("/v1/jobs/" + id, "job " + id);
    if (!now) return done;
    const bool moved_on = revision_of(*now) != revision_of(seen);
    // Pausing and cancelling are meant whatever has become of it.
    const bool always = action == "pause" || action == "cancel";
    if (!moved_on || !(always || looks_the_same(*now, job))) return done;
    seen = std::move(*now);
  }
}

Result<Json> Api::act_on_device(const std::string& id, const std::string& action,
                                const Json& body) {
  constexpr int kTries = 5;
  const std::string place = "device " + id, target = "/v1/devices/" + percent_encoded(id);
  for (int k = 0;; ++k) {
    const auto device = get(target, place);
    if (!device) return device;
    const std::int64_t rev = revision_of(*device);
    auto done = post(target + "/actions/" + action, body, place, rev);
    // It may have come, gone or begun to cut in between: what was asked is meant all the same.
    if (done || k + 1 == kTries || done.error().kind != ErrorKind::Refused) return done;
    const auto now = get(target, place);
    if (!now || revision_of(*now) == rev) return done;
  }
}

Result<Json> Api::patch(const Json& job, const Json& members) {
  const std::string id = id_of(job), text = json_line(members);
  HttpRequest request{"PATCH", "/v1/jobs/" + id, text, "application/json"};
  request.headers.emplace_back("If-Match", fmt::format("\"{}\"", revision_of(job)));
  return read(http_.ask(std::move(request)), "job " + id, Subject::CommandLine, &members);
}

Result<bool> Api::has_page() {
  auto response = http_.ask({"HEAD", "/"});
  if (!response) return tl::unexpected(response.error());
  return response->status == 200;
}

}  // namespace popcut::client
