// SPDX-License-Identifier: MIT
#include "daemon/client/problem_line.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/json_text.hpp"
#include "daemon/client/api.hpp"
#include "daemon/client/command_words.hpp"

namespace popcut::client {
namespace {

using Json = nlohmann::json;

std::string kind_of(const Json& problem) {
  const std::string type = text_of(problem, "type");
  return type.substr(type.rfind('/') + 1);
}

std::string allowed(const Json& problem) {
  std::string words;
  const auto list = problem.find("allowed_actions");
  if (list == problem.end() || !list->is_array()) return {};
  for (const Json& one : *list)
    if (one.is_string()) words += (words.empty() ? "" : ", ") + command_for(one.get<std::string>());
  return words;
}

/// The job that the request was about: of "/v1/jobs/01J.../actions/arm".
std::string job_of(const Json& problem) {
  const std::string path = text_of(problem, "instance");
  constexpr std::string_view kJobs = "/v1/jobs/";
  if (path.rfind(kJobs, 0) != 0) return {};
  return path.substr(kJobs.size(), path.find('/', kJobs.size()) - kJobs.size());
}

/// The commands that would do now, as they are typed; empty: popcutd offers none.
std::string commands(const Json& problem) {
  const auto ways = problem.find("ways");
  if (ways == problem.end() || !ways->is_array()) return {};
  const std::string job = job_of(problem);
  std::string all;
  for (const Json& way : *ways) {
    const std::string line = command_line_for(way, job), meaning = meaning_of(way);
    if (line.empty()) continue;
    all += (all.empty() ? "" : ", or ") + line;
    if (!meaning.empty()) all += " (" + meaning + ")";
  }
  return all.empty() ? all : "; possible now: " + all;
}

std::string watch_of(const std::string& job) {
  return fmt::format("; 'popcut jobs {} --watch' shows when it continues", job);
}

/// Where popcutd offers nothing: what shows how it goes on.
std::string where_to_look(const Json& problem, const std::string& kind) {
  const std::string job = job_of(problem), state = text_of(problem, "state");
  const bool of_device = text_of(problem, "instance").rfind("/v1/devices/", 0) == 0;
  if (kind == "not-found")
    return of_device     ? "; 'popcut devices' lists them"
           : job.empty() ? ""
                         : "; 'popcut jobs --all' lists them";
  if (kind == "queue-full") return "; 'popcut jobs' lists them";
  if (kind == "device-absent" || of_device) return "; 'popcut devices' shows when it is back";
  if (state == "done" || state == "failed" || state == "cancelled")
    return "; 'popcut jobs' lists the unfinished ones";
  if (kind != "state-conflict") return {};
  if (job.empty()) return state.empty() ? "" : "; 'popcut jobs' shows the present state";
  return watch_of(job);
}

/// Which token allows it, for those who come with one that does not.
std::string wanted_token(const std::string& detail) {
  const auto names = [&](const char* role) { return detail.find(role) != std::string::npos; };
  const char* const role = names("admin") ? "admin" : names("submitter") ? "submitter" : "operator";
  return fmt::format(
      "; 'popcut token create --role {}' creates a token for POPCUT_TOKEN, on the computer where "
      "popcutd runs",
      names("operator") ? "operator" : role);
}

/// What was given at `pointer`: as popcutd repeats it, else as it was sent; "" if neither has it.
std::string given(const Json& fault, const std::string& pointer, const Json* sent) {
  constexpr std::size_t kMostShown = 60;
  Json value = fault.value("got", Json());
  try {
    if (value.is_null() && sent != nullptr && pointer.starts_with('/'))
      value = sent->at(Json::json_pointer(pointer));
  } catch (const Json::exception&) {  // it was not sent
  }
  const std::string text = value.is_null() ? "" : json_line(value);
  return text.size() <= kMostShown ? text : "";
}

/// A value that was wrong on the command line. What an input holds, or what cannot be made of it,
/// stays what it is.
Error of_option(const Error& error, const std::string& option, const std::string& value) {
  const bool is_wrong_value = option != "INPUT" && error.kind != ErrorKind::Infeasible;
  const bool shown = value.empty() || error.detail.find(value) != std::string::npos;
  return {is_wrong_value ? ErrorKind::Usage : error.kind, option,
          shown ? error.detail : fmt::format("is {}; {}", value, error.detail)};
}

Error invalid(const Json& problem, const std::string& place, const std::string& detail,
              Subject subject, const Json* sent) {
  Error error{ErrorKind::OutOfRange, place, detail};
  const auto list = problem.find("errors");
  if (list == problem.end() || !list->is_array() || list->empty() || !list->front().is_object())
    return error;
  const Json& first = list->front();
  const std::string pointer = text_of(first, "pointer");
  const std::string code = text_of(first, "code");
  if (code == "infeasible") error.kind = ErrorKind::Infeasible;
  if (code == "malformed") error.kind = ErrorKind::Malformed;
  if (!text_of(first, "detail").empty()) error.detail = text_of(first, "detail");
  if (list->size() > 1) error.detail += fmt::format(" (and {} more)", list->size() - 1);
  if (subject == Subject::CommandLine || pointer.rfind('?', 0) == 0) {
    error.detail = in_command_words(error.detail);
    if (const std::string option = option_for(pointer); !option.empty()) {
      error = of_option(error, option, given(first, pointer, sent));
      const std::string lines = commands(problem);
      const std::string job = job_of(problem);
      const bool must_wait = lines.empty() && code == "missing" && !job.empty();
      error.detail += must_wait ? watch_of(job) : lines;
      return error;
    }
  }
  return pointer.empty() ? error : within(place, {error.kind, pointer, error.detail});
}

Error conflict(const Json& problem, const std::string& place, std::string detail) {
  const std::string state = text_of(problem, "state");
  const std::string words = allowed(problem);
  detail = in_command_words(detail);
  if (!state.empty() && detail.find(state) == std::string::npos)
    detail += fmt::format("; it is {}", state);
  if (const std::string lines = commands(problem); !lines.empty())
    detail += lines;
  else if (job_of(problem).empty() && !words.empty())
    detail += fmt::format("; possible now: {}", words);
  else
    detail += where_to_look(problem, "state-conflict");
  return {ErrorKind::Refused, place, detail};
}

}  // namespace

Error error_from(const HttpResponse& response, const std::string& place, Subject subject,
                 const Json* sent) {
  auto parsed = parse_json(response.body, 32);
  if (parsed) make_printable(*parsed);
  if (!parsed || !parsed->is_object())
    return {ErrorKind::Refused, place,
            fmt::format("popcutd answered {} without a reason; see its log", response.status)};
  const Json& problem = *parsed;
  const std::string kind = kind_of(problem);
  std::string detail = text_of(problem, "detail");
  if (detail.empty()) detail = text_of(problem, "title");
  if (response.status == 401) {
    const bool missing = detail.find("a token is required") != std::string::npos;
    return {ErrorKind::Refused, place,
            (missing ? "popcutd requires a token" : detail) +
                "; set POPCUT_TOKEN ('popcut token create --role operator' creates one, on the "
                "computer where popcutd runs)"};
  }
  if (kind == "validation") return invalid(problem, place, detail, subject, sent);
  if (kind == "malformed-json") return {ErrorKind::Malformed, place, detail};
  if (kind == "too-large" || kind == "unsupported-media")
    return {ErrorKind::OutOfRange, place, detail};
  if (kind == "state-conflict" || kind == "stale") return conflict(problem, place, detail);
  if (subject == Subject::CommandLine) detail = in_command_words(detail);
  const std::string lines = commands(problem);
  if (kind == "forbidden")
    detail += wanted_token(detail);
  else
    detail += lines.empty() ? where_to_look(problem, kind) : lines;
  return {ErrorKind::Refused, place, detail,
          kind == "not-found" ? ErrorReason::NotThere : ErrorReason::None};
}

}  // namespace popcut::client
