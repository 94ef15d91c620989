// SPDX-License-Identifier: MIT
#include "tests/support/raw_http.hpp"

#include <arpa/inet.h>
#include <linux/capability.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

using Clock = std::chrono::steady_clock;

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::map<std::string, std::string> headers_of(std::string_view head) {
  std::map<std::string, std::string> out;
  while (!head.empty()) {
    const std::size_t end = head.find("\r\n");
    const std::string_view line = head.substr(0, end);
    const std::size_t colon = line.find(": ");
    if (colon != std::string_view::npos)
      out[lower(std::string(line.substr(0, colon)))] = std::string(line.substr(colon + 2));
    if (end == std::string_view::npos) break;
    head.remove_prefix(end + 2);
  }
  return out;
}

}  // namespace

std::string WireResponse::problem() const {
  constexpr std::string_view kBefore = "https://popcut.invalid/p/";
  const std::size_t at = body.find(kBefore);
  if (at == std::string::npos) return {};
  const std::size_t begin = at + kBefore.size();
  return body.substr(begin, body.find('"', begin) - begin);
}

RawConnection::RawConnection(std::uint16_t port, bool six)
    : socket_(::socket(six ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in four{};
  four.sin_family = AF_INET;
  four.sin_port = htons(port);
  four.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  sockaddr_in6 loop{};
  loop.sin6_family = AF_INET6;
  loop.sin6_port = htons(port);
  loop.sin6_addr = in6addr_loopback;
  const auto* const address =
      six ? reinterpret_cast<const sockaddr*>(&loop) : reinterpret_cast<const sockaddr*>(&four);
  if (::connect(socket_, address, six ? sizeof(loop) : sizeof(four)) != 0)
    throw std::runtime_error("cannot connect to the server");
}

RawConnection::RawConnection(const std::string& unix_path)
    : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, unix_path.c_str(), sizeof(address.sun_path) - 1);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0)
    throw std::runtime_error("cannot connect to the unix socket");
}

std::optional<RawConnection> RawConnection::as_user(unsigned uid, const std::string& unix_path) {
  if (::geteuid() != 0) return std::nullopt;
  std::optional<RawConnection> made;
  // The bare system calls are of this thread alone, which ends with it. It keeps the right to pass
  // through folders that are root's.
  std::thread([&] {
    __user_cap_header_struct head{_LINUX_CAPABILITY_VERSION_3, 0};
    __user_cap_data_struct rights[2]{};
    if (::syscall(SYS_capget, &head, rights) != 0 || ::syscall(SYS_setresuid, -1, uid, -1) != 0)
      return;
    rights[0].effective = 1U << CAP_DAC_OVERRIDE;
    rights[1].effective = 0;
    if (::syscall(SYS_capset, &head, rights) == 0) made.emplace(RawConnection(unix_path));
  }).join();
  return made;
}

RawConnection::RawConnection(RawConnection&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), pending_(std::move(other.pending_)) {}

RawConnection::~RawConnection() {
  if (socket_ >= 0) ::close(socket_);
}

bool RawConnection::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

bool RawConnection::more(double seconds) {
  pollfd wait{socket_, POLLIN, 0};
  if (::poll(&wait, 1, static_cast<int>(std::max(seconds, 0.0) * 1000)) <= 0) return false;
  char buffer[65536];
  const ssize_t got = ::recv(socket_, buffer, sizeof(buffer), 0);
  if (got <= 0) return false;
  pending_.append(buffer, static_cast<std::size_t>(got));
  return true;
}

WireResponse RawConnection::receive(double seconds, bool is_head) {
  const auto until = Clock::now() + std::chrono::duration<double>(seconds);
  const auto left = [&] { return std::chrono::duration<double>(until - Clock::now()).count(); };
  std::size_t end = 0;
  while ((end = pending_.find("\r\n\r\n")) == std::string::npos)
    if (!more(left())) return {};
  WireResponse response;
  const std::string head = pending_.substr(0, end);
  if (head.size() > 12) response.status = std::atoi(head.c_str() + 9);
  response.headers = headers_of(head);
  pending_.erase(0, end + 4);
  if (response.status == 100) return receive(left(), is_head);
  const auto length = response.headers.find("content-length");
  if (length == response.headers.end() || is_head) return response;
  const std::size_t size = std::strtoull(length->second.c_str(), nullptr, 10);
  while (pending_.size() < size)
    if (!more(left())) break;
  response.body = pending_.substr(0, size);
  pending_.erase(0, size);
  return response;
}

std::string RawConnection::receive_until(std::string_view ending, double seconds) {
  const auto until = Clock::now() + std::chrono::duration<double>(seconds);
  while (pending_.find(ending) == std::string::npos) {
    const double left = std::chrono::duration<double>(until - Clock::now()).count();
    if (left <= 0 || !more(left)) break;
  }
  const std::size_t end = pending_.find(ending);
  const std::size_t size = end == std::string::npos ? pending_.size() : end + ending.size();
  std::string out = pending_.substr(0, size);
  pending_.erase(0, size);
  return out;
}

bool RawConnection::closes(double seconds) {
  const auto until = Clock::now() + std::chrono::duration<double>(seconds);
  while (true) {
    const double left = std::chrono::duration<double>(until - Clock::now()).count();
    pollfd wait{socket_, POLLIN, 0};
    if (left <= 0 || ::poll(&wait, 1, static_cast<int>(left * 1000)) <= 0) return false;
    char buffer[4096];
    if (::recv(socket_, buffer, sizeof(buffer), 0) <= 0) return true;
  }
}

void RawConnection::reset() {
  const linger now{1, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &now, sizeof(now));
  ::close(std::exchange(socket_, -1));
}

void RawConnection::shrink_buffer(int bytes) {
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof(bytes));
}

Service with_devices(const Service& service, Devices& devices) {
  return {service.access,  service.designs, service.plans,     service.searches,  service.jobs,
          service.cutting, devices,         service.materials, service.operations};
}

ServiceForHttp::ServiceForHttp() {
  bench.options.previewer = previewer;
  bench.options.wall_ms = [this, now = bench.options.wall_ms] {
    if (!has_clock) throw std::runtime_error("there is no clock");
    return now();
  };
  if (const std::string fault = bench.start(); !fault.empty()) throw std::runtime_error(fault);
  for (const Role role : {Role::Viewer, Role::Submitter, Role::Operator, Role::Admin})
    renew_token(role);
  devices_.emplace(bench.service().devices);
  service_.emplace(with_devices(bench.service(), *devices_));
}

LiveServer::LiveServer(const std::function<void(HttpOptions&)>& change) {
  socket_path_ = bench.folder() + "/popcut.sock";
  incoming_ = bench.folder() + "/incoming";
  HttpOptions options;
  options.listen = {{"127.0.0.1:0"}, {"unix:" + socket_path_}};
  options.incoming_folder = incoming_;
  options.build = "0.0-test";
  options.service = &service();
  using Lane = ServiceThread::Lane;
  options.on_service = [this](std::function<void()> work) {
    return bench.thread().post(Lane::Asking, std::move(work));
  };
  options.on_service_urgent = [this](std::function<void()> work) {
    return bench.thread().post(Lane::Urgent, std::move(work));
  };
  // Suites ask more often than people; one case proves the defaults.
  options.limits.rate_per_s = 1e6;
  options.limits.rate_burst = 1e6;
  if (change) change(options);
  server_ = std::make_unique<HttpServer>(std::move(options));
  if (const auto started = server_->start(); !started)
    throw std::runtime_error(message(started.error()));
}

LiveServer::~LiveServer() {
  server_->stop(0.2);
  bench.stop();
}

void ServiceForHttp::renew_token(Role role) {
  const std::string name(name_of(role));
  tokens_[name] = bench.on([&](LiveService& service) {
    return service.access.create_token(bench.admin, name, role, std::nullopt).value().text;
  });
}

Principal ServiceForHttp::principal(Role role) const {
  const std::string id = token_id(std::string(name_of(role)));
  return {.name = "token:" + id, .role = role, .credential = id};
}

void ServiceForHttp::put_texts(const std::string& job, const std::string& name,
                               const std::string& note) {
  ask([&](LiveService&) {
    bench.store().database().run("UPDATE job SET name=?, note=? WHERE id=?", name, note, job);
  });
}

void ServiceForHttp::tell(const std::string& job, int times) {
  static std::atomic<int> number{0};
  ask([&](LiveService& service) {
    const IdempotentRequest once{fmt::format("tell-events-{:06}", ++number), ""};
    const auto effect = [&] {
      std::int64_t rev = service.jobs.brief(job).value().rev;
      for (int i = 0; i < times; ++i)
        rev = service.jobs.patch(bench.tutor, job, rev, {.priority = i % 2}).value().rev;
      return Rendered{};
    };
    service.operations.once(bench.tutor, once, effect).value();
  });
}

std::int64_t ServiceForHttp::jobs() {
  return bench.on([](LiveService& service) {
    return static_cast<std::int64_t>(service.jobs.list({}, {}).value().items.size());
  });
}

std::int64_t ServiceForHttp::last_event() {
  return bench.on([](LiveService& service) { return service.operations.last_event(); });
}

std::size_t LiveServer::spools() const {
  std::error_code none;
  const std::filesystem::directory_iterator all(incoming_, none);
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

std::string LiveServer::request(std::string_view method, std::string_view target,
                                std::string_view role, std::string_view more,
                                std::string_view body) const {
  std::string out =
      fmt::format("{} {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{}", method, target, port(), more);
  if (!role.empty()) out += fmt::format("Authorization: Bearer {}\r\n", token(std::string(role)));
  if (!body.empty()) out += fmt::format("Content-Length: {}\r\n", body.size());
  return fmt::format("{}\r\n{}", out, body);
}

WireResponse LiveServer::fetch(std::string_view method, std::string_view target,
                               std::string_view role, std::string_view more,
                               std::string_view body) const {
  RawConnection connection = connect();
  connection.send(request(method, target, role, more, body));
  return connection.receive(60, method == "HEAD");
}

std::string acting(std::string_view if_match) {
  static std::atomic<int> number{0};
  std::string out = fmt::format(
      "Content-Type: application/json\r\nIdempotency-Key: test-key-{:012}\r\n", ++number);
  if (!if_match.empty()) out += fmt::format("If-Match: {}\r\n", if_match);
  return out;
}

}  // namespace popcut::daemon
