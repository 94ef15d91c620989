// SPDX-License-Identifier: MIT
#include "tests/bench/http_load.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sqlite3.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <utility>

#include "daemon/asio.hpp"

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

namespace popcut::testing {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point then) {
  return std::chrono::duration<double, std::milli>(Clock::now() - then).count();
}

int connected(const Endpoint& endpoint) {
  const bool local = !endpoint.unix_socket.empty();
  const int socket = ::socket(local ? AF_UNIX : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::strncpy(name.sun_path, endpoint.unix_socket.c_str(), sizeof name.sun_path - 1);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(endpoint.port);
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int one = 1;
  if (!local) ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  const auto* const address =
      local ? reinterpret_cast<const sockaddr*>(&name) : reinterpret_cast<const sockaddr*>(&place);
  if (::connect(socket, address, local ? sizeof name : sizeof place) == 0) return socket;
  ::close(socket);
  throw std::runtime_error("nobody listens there");
}

void serve_bare(boost::asio::ip::tcp::socket socket, const std::string& body) {
  namespace http = boost::beast::http;
  boost::beast::flat_buffer buffer;
  boost::system::error_code ec;
  for (;;) {
    http::request<http::string_body> request;
    http::read(socket, buffer, request, ec);
    if (ec) return;
    http::response<http::string_body> response{http::status::ok, 11};
    response.set(http::field::content_type, "application/json");
    response.body() = body;
    response.prepare_payload();
    http::write(socket, response, ec);
    if (ec) return;
  }
}

void run_bare(int port_to, std::size_t bytes) {
  namespace asio = boost::asio;
  asio::io_context io;
  asio::ip::tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
  const std::uint16_t port = acceptor.local_endpoint().port();
  if (::write(port_to, &port, sizeof port) != sizeof port) return;
  const std::string body = '"' + std::string(bytes - 2, 'x') + '"';
  for (;;) {
    asio::ip::tcp::socket socket = acceptor.accept();
    socket.set_option(asio::ip::tcp::no_delay(true));
    std::thread(serve_bare, std::move(socket), body).detach();
  }
}

}  // namespace

KeptConnection::KeptConnection(const Endpoint& endpoint) : socket_(connected(endpoint)) {}
KeptConnection::KeptConnection(KeptConnection&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), text_(std::move(other.text_)) {}
KeptConnection::~KeptConnection() {
  if (socket_ >= 0) ::close(socket_);
}

bool KeptConnection::more() {
  const std::size_t had = text_.size();
  constexpr std::size_t kPiece = 1 << 18;
  text_.resize(had + kPiece);
  const ssize_t got = ::recv(socket_, text_.data() + had, kPiece, 0);
  text_.resize(had + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return got > 0;
}

KeptConnection::Answer KeptConnection::ask(std::string_view request) {
  text_.clear();
  while (!request.empty()) {
    const ssize_t sent = ::send(socket_, request.data(), request.size(), MSG_NOSIGNAL);
    if (sent <= 0) return {};
    request.remove_prefix(static_cast<std::size_t>(sent));
  }
  std::size_t end = 0;
  while ((end = text_.find("\r\n\r\n")) == std::string::npos)
    if (!more()) return {};
  Answer answer;
  std::from_chars(text_.data() + 9, text_.data() + 12, answer.status);
  std::size_t length = 0;
  const std::size_t at = text_.find("Content-Length: ");
  if (at < end) std::from_chars(text_.data() + at + 16, text_.data() + end, length);
  while (text_.size() < end + 4 + length)
    if (!more()) return {};
  answer.body = std::string_view(text_).substr(end + 4, length);
  return answer;
}

double LoadFigures::within(double part) const {
  if (milliseconds.empty()) return 0;
  const auto at = static_cast<std::size_t>(part * static_cast<double>(milliseconds.size()));
  return milliseconds[std::min(at, milliseconds.size() - 1)];
}

LoadFigures load(const Endpoint& endpoint, int clients, double seconds, int status,
                 const std::function<std::string(int client, int k)>& request) {
  std::vector<LoadFigures> parts(static_cast<std::size_t>(clients));
  std::vector<std::thread> threads;
  const Clock::time_point begun = Clock::now();
  for (int client = 0; client < clients; ++client)
    threads.emplace_back([&, client] {
      LoadFigures& own = parts[static_cast<std::size_t>(client)];
      KeptConnection connection(endpoint);
      for (int k = 0; ms_since(begun) < 1000 * seconds; ++k) {
        const std::string text = request(client, k);
        const Clock::time_point asked = Clock::now();
        const int got = connection.ask(text).status;
        own.milliseconds.push_back(ms_since(asked));
        ++own.requests;
        if (got != status) ++own.failures;
        if (got == 0) return;
      }
    });
  for (std::thread& thread : threads) thread.join();
  LoadFigures all;
  all.clients = clients;
  all.seconds = ms_since(begun) / 1000;
  for (const LoadFigures& part : parts) {
    all.requests += part.requests;
    all.failures += part.failures;
    all.milliseconds.insert(all.milliseconds.end(), part.milliseconds.begin(),
                            part.milliseconds.end());
  }
  std::sort(all.milliseconds.begin(), all.milliseconds.end());
  return all;
}

BareServer::BareServer(std::size_t bytes) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
  process_ = ::fork();
  if (process_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    run_bare(ends[1], bytes);
    ::_exit(1);
  }
  ::close(ends[1]);
  const bool told = ::read(ends[0], &port_, sizeof port_) == sizeof port_;
  ::close(ends[0]);
  if (!told) throw std::runtime_error("the bare server does not start");
}

BareServer::~BareServer() {
  ::kill(process_, SIGKILL);
  ::waitpid(process_, nullptr, 0);
}

std::vector<double> bare_commits(const std::string& file, int count, std::size_t bytes) {
  sqlite3* db = nullptr;
  if (sqlite3_open(file.c_str(), &db) != SQLITE_OK) throw std::runtime_error("no database");
  const auto run = [&](const std::string& sql) {
    if (sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
      throw std::runtime_error(sqlite3_errmsg(db));
  };
  run("PRAGMA locking_mode=EXCLUSIVE; PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL;"
      "CREATE TABLE row(id INTEGER PRIMARY KEY, word TEXT, text TEXT);"
      "CREATE INDEX row_word ON row(word);");
  const std::string text(bytes, 'x');
  std::vector<double> all;
  for (int k = 0; k < count; ++k) {
    const Clock::time_point begun = Clock::now();
    run("BEGIN IMMEDIATE; INSERT INTO row(word, text) VALUES('" + std::to_string(k * 7919 % 10007) +
        "', '" + text + "'); COMMIT;");
    all.push_back(ms_since(begun));
  }
  sqlite3_close(db);
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace popcut::testing
