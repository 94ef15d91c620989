// SPDX-License-Identifier: MIT
#include "daemon/http/api/message.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http {
namespace {

constexpr std::array<std::pair<Method, std::string_view>, 7> kMethods{{
    {Method::Get, "GET"},
    {Method::Head, "HEAD"},
    {Method::Post, "POST"},
    {Method::Put, "PUT"},
    {Method::Patch, "PATCH"},
    {Method::Delete, "DELETE"},
    {Method::Options, "OPTIONS"},
}};

std::optional<std::string_view> find_header(const std::vector<Header>& headers,
                                            std::string_view lower_name) {
  for (const Header& header : headers)
    if (header.name == lower_name) return header.value;
  return std::nullopt;
}

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 || byte == 0x7F;
}

// "Sat, 21 Nov 2026 10:00:00 GMT".
std::string http_date(std::time_t now) {
  return fmt::format("{:%a, %d %b %Y %H:%M:%S} GMT", fmt::gmtime(now));
}

std::string without_controls(std::string_view value) {
  std::string out(value);
  std::replace_if(out.begin(), out.end(), is_control, ' ');
  return out;
}

}  // namespace

std::string_view name_of(Method method) {
  for (const auto& [known, name] : kMethods)
    if (known == method) return name;
  return "another method";
}

Method method_from(std::string_view name) {
  for (const auto& [method, known] : kMethods)
    if (known == name) return method;
  return Method::Other;
}

std::optional<std::string_view> RequestHead::header(std::string_view lower_name) const {
  return find_header(headers, lower_name);
}

std::optional<std::string_view> Request::header(std::string_view lower_name) const {
  return find_header(headers, lower_name);
}

std::string_view Request::path() const {
  const std::string_view whole = target;
  return whole.substr(0, whole.find('?'));
}

struct Reply::State {
  explicit State(std::function<void(Response)> how) : send(std::move(how)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (answered.exchange(true)) return;
    try {
      send(problem_response(
          Problem{ProblemKind::Internal, "the request was dropped without a reply"}, "", ""));
    } catch (...) {  // a destructor ends here; the client's patience ends the request
    }
  }
  std::function<void(Response)> send;
  std::atomic<bool> answered{false};
};

void Departure::then(std::function<void()> what) {
  {
    const std::lock_guard lock(mutex_);
    if (!has_happened_) {
      what_ = std::move(what);
      return;
    }
  }
  what();
}

void Departure::happens() {
  std::function<void()> what;
  {
    const std::lock_guard lock(mutex_);
    if (has_happened_) return;
    has_happened_ = true;
    what.swap(what_);
  }
  if (what) what();
}

Reply::Reply(std::function<void(Response)> send)
    : state_(std::make_shared<State>(std::move(send))) {}

void Reply::operator()(Response response) const {
  if (!state_->answered.exchange(true)) state_->send(std::move(response));
}

Response problem_response(const Problem& problem, std::string_view instance,
                          std::string_view request_id) {
  JsonObject body;
  body.text("type", fmt::format("https://popcut.invalid/p/{}", slug_of(problem.kind)))
      .text("title", title_of(problem.kind))
      .number("status", status_of(problem.kind))
      .text("detail", problem.detail)
      .text("instance", instance.substr(0, instance.find('?')))
      .text("request_id", request_id);
  if (!problem.errors.empty()) {
    std::vector<JsonObject> errors;
    for (const RequestFault& fault : problem.errors) {
      errors.emplace_back()
          .text("pointer", fault.pointer)
          .text("code", fault.code)
          .text("detail", fault.detail);
      if (!fault.got.empty()) errors.back().json("got", fault.got);
    }
    body.objects("errors", errors);
  }
  if (problem.rev) body.number("rev", *problem.rev);
  if (!problem.state.empty())
    body.text("state", problem.state).texts("allowed_actions", problem.allowed_actions);
  if (!problem.next_actions.empty()) body.objects("ways", json_of(problem.next_actions));
  if (!problem.asks.empty()) body.json("asks", problem.asks);
  if (!problem.warnings.empty()) body.warnings("warnings", problem.warnings);
  Response response;
  response.status = status_of(problem.kind);
  response.content_type = "application/problem+json";
  response.body = body.whole();
  if (problem.retry_after_s)
    response.headers.push_back({"Retry-After", std::to_string(*problem.retry_after_s)});
  if (problem.rev) response.headers.push_back({"ETag", fmt::format("\"{}\"", *problem.rev)});
  if (problem.kind == ProblemKind::Unauthenticated)
    response.headers.push_back({"WWW-Authenticate", "Bearer realm=\"popcut\""});
  return response;
}

Response problem_response(const Problem& problem, const Request& request) {
  return problem_response(problem, request.target, request.id);
}

std::string response_head(const Response& response, std::string_view request_id,
                          std::optional<std::uint64_t> length, bool close) {
  std::string head = fmt::format("HTTP/1.1 {} {}\r\n", response.status, reason_of(response.status));
  const auto add = [&head](std::string_view name, std::string_view value) {
    head += fmt::format("{}: {}\r\n", name, without_controls(value));
  };
  bool has_policy = false, has_cache = false;
  for (const Header& header : response.headers) {
    add(header.name, header.value);
    has_policy = has_policy || header.name == "Content-Security-Policy";
    has_cache = has_cache || header.name == "Cache-Control";
  }
  if (!response.content_type.empty()) add("Content-Type", response.content_type);
  if (!has_policy) add("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'");
  if (!has_cache) add("Cache-Control", "no-store");
  add("X-Content-Type-Options", "nosniff");
  add("Referrer-Policy", "no-referrer");
  add("Cross-Origin-Resource-Policy", "same-origin");
  add("X-Request-Id", request_id);
  add("Date", http_date(std::time(nullptr)));
  if (length) add("Content-Length", std::to_string(*length));
  if (close) add("Connection", "close");
  head += "\r\n";
  return head;
}

std::string_view reason_of(int status) {
  constexpr std::array<std::pair<int, std::string_view>, 26> kReasons{{
      {200, "OK"},
      {201, "Created"},
      {202, "Accepted"},
      {204, "No Content"},
      {304, "Not Modified"},
      {400, "Bad Request"},
      {401, "Unauthorized"},
      {403, "Forbidden"},
      {404, "Not Found"},
      {405, "Method Not Allowed"},
      {408, "Request Timeout"},
      {409, "Conflict"},
      {411, "Length Required"},
      {412, "Precondition Failed"},
      {413, "Content Too Large"},
      {415, "Unsupported Media Type"},
      {417, "Expectation Failed"},
      {421, "Misdirected Request"},
      {422, "Unprocessable Content"},
      {428, "Precondition Required"},
      {429, "Too Many Requests"},
      {431, "Request Header Fields Too Large"},
      {500, "Internal Server Error"},
      {501, "Not Implemented"},
      {503, "Service Unavailable"},
      {507, "Insufficient Storage"},
  }};
  for (const auto& [known, reason] : kReasons)
    if (known == status) return reason;
  return "Unknown";
}

std::string for_log(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    // C1 in UTF-8: C2 80 .. C2 9F
    const bool is_c1 = byte == 0xC2 && i + 1 < text.size() &&
                       static_cast<unsigned char>(text[i + 1]) >= 0x80 &&
                       static_cast<unsigned char>(text[i + 1]) <= 0x9F;
    if (is_c1)
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[++i]));
    else if (is_control(text[i]))
      out += fmt::format("\\x{:02x}", byte);
    else
      out += text[i];
  }
  return out;
}

}  // namespace popcut::daemon::http
