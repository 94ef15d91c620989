// SPDX-License-Identifier: MIT
#include "daemon/http/listen.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace popcut::daemon::http {
namespace {

constexpr int kBacklog = 64;

std::string reason(int error) { return std::generic_category().message(error); }

// The addresses of the socket calls are one memory under several types.
struct Address {
  sockaddr_storage storage{};
  socklen_t size{sizeof(sockaddr_storage)};
  sockaddr* get() { return reinterpret_cast<sockaddr*>(&storage); }
  template <typename T>
  T& as() {
    return *reinterpret_cast<T*>(&storage);
  }
};

Result<Address> tcp_address(const std::string& endpoint) {
  const std::size_t colon = endpoint.rfind(':');
  const auto wrong = [&] {
    return fail(ErrorKind::Usage, endpoint,
                "is not an address to listen on; write 127.0.0.1:8631, [::1]:8631 or unix:/path");
  };
  if (colon == std::string::npos) return wrong();
  std::uint16_t port = 0;
  const char* const end = endpoint.data() + endpoint.size();
  const auto [stop, error] = std::from_chars(endpoint.data() + colon + 1, end, port);
  if (error != std::errc() || stop != end) return wrong();
  std::string host = endpoint.substr(0, colon);
  if (host == "localhost") host = "127.0.0.1";
  Address address;
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    auto& six = address.as<sockaddr_in6>();
    six.sin6_family = AF_INET6;
    six.sin6_port = htons(port);
    address.size = sizeof(sockaddr_in6);
    if (inet_pton(AF_INET6, host.substr(1, host.size() - 2).c_str(), &six.sin6_addr) != 1)
      return wrong();
    return address;
  }
  auto& four = address.as<sockaddr_in>();
  four.sin_family = AF_INET;
  four.sin_port = htons(port);
  address.size = sizeof(sockaddr_in);
  if (inet_pton(AF_INET, host.c_str(), &four.sin_addr) != 1) return wrong();
  return address;
}

Result<Address> unix_address(const std::string& path) {
  Address address;
  auto& local = address.as<sockaddr_un>();
  local.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(local.sun_path))
    return fail(ErrorKind::Usage, path,
                fmt::format("the path of a unix socket must have 1 to {} characters",
                            sizeof(local.sun_path) - 1));
  std::memcpy(local.sun_path, path.c_str(), path.size() + 1);
  address.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size() + 1);
  return address;
}

bool is_loopback(Address& address) {
  if (address.storage.ss_family == AF_INET)
    return (ntohl(address.as<sockaddr_in>().sin_addr.s_addr) >> 24) == 127;
  if (address.storage.ss_family == AF_INET6)
    return IN6_IS_ADDR_LOOPBACK(&address.as<sockaddr_in6>().sin6_addr);
  return address.storage.ss_family == AF_UNIX;
}

// Removes a stale socket file that nobody listens on; leaves anything else alone.
void remove_stale(Address& address, const std::string& path) {
  struct stat found {};
  if (::lstat(path.c_str(), &found) != 0 || !S_ISSOCK(found.st_mode)) return;
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (probe < 0) return;
  if (::connect(probe, address.get(), address.size) != 0 && errno == ECONNREFUSED)
    ::unlink(path.c_str());
  ::close(probe);
}

/// The name exists already and is not a socket.
bool is_other_file(const std::string& path) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0 && !S_ISSOCK(found.st_mode);
}

}  // namespace

Listener::Listener(Listener&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      family_(other.family_),
      is_local_(other.is_local_),
      port_(other.port_),
      name_(std::move(other.name_)),
      made_path_(std::exchange(other.made_path_, {})) {}

Listener::~Listener() {
  if (socket_ >= 0) ::close(socket_);
  if (!made_path_.empty()) ::unlink(made_path_.c_str());
}

int Listener::release() { return std::exchange(socket_, -1); }

Result<Listener> Listener::open(const std::string& endpoint, bool allow_remote) {
  constexpr std::string_view kUnix = "unix:";
  const bool is_unix = endpoint.starts_with(kUnix);
  const std::string path = is_unix ? endpoint.substr(kUnix.size()) : std::string();
  Result<Address> address = is_unix ? unix_address(path) : tcp_address(endpoint);
  if (!address) return tl::unexpected<Error>(address.error());
  const int family = address->storage.ss_family;
  Listener listener(::socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const auto refused = [&](int error) {
    return fail(ErrorKind::Refused, endpoint,
                fmt::format("cannot listen here: {}; {}", reason(error),
                            error == EADDRINUSE
                                ? "another popcutd may be running; stop it or name another address"
                                : "name another"));
  };
  if (listener.socket_ < 0) return refused(errno);
  const int on = 1;
  if (is_unix) {
    if (is_other_file(path))
      return fail(ErrorKind::Refused, endpoint, "exists and is not a socket; name another path");
    remove_stale(*address, path);
    // Linux takes the mode of the file from here, so it is never open to others, not even briefly.
    ::fchmod(listener.socket_, S_IRUSR | S_IWUSR);
  } else {
    ::setsockopt(listener.socket_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
    if (family == AF_INET6)
      ::setsockopt(listener.socket_, IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof(on));
  }
  if (!allow_remote && !is_loopback(*address))
    return fail(ErrorKind::Usage, endpoint,
                "is not a loopback address; to serve other computers, put a TLS proxy in front of "
                "popcutd and set allow_remote in the configuration");
  if (::bind(listener.socket_, address->get(), address->size) != 0) return refused(errno);
  if (is_unix) listener.made_path_ = path;
  if (::listen(listener.socket_, kBacklog) != 0) return refused(errno);
  if (auto looked = listener.look(allow_remote); !looked)
    return tl::unexpected<Error>(looked.error());
  return listener;
}

Result<Listener> Listener::adopt(int socket, bool allow_remote) {
  Listener listener(socket);
  if (auto looked = listener.look(allow_remote); !looked)
    return tl::unexpected<Error>(looked.error());
  return listener;
}

Result<void> Listener::look(bool allow_remote) {
  Address address;
  int listens = 0;
  socklen_t size = sizeof(listens);
  const bool is_socket = ::getsockname(socket_, address.get(), &address.size) == 0 &&
                         ::getsockopt(socket_, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) == 0 &&
                         listens != 0;
  if (!is_socket)
    return fail(ErrorKind::Refused, fmt::format("file descriptor {}", socket_),
                "is not a listening socket");
  if (!allow_remote && !is_loopback(address))
    return fail(ErrorKind::Usage, fmt::format("file descriptor {}", socket_),
                "listens beyond this computer; give it a loopback address");
  family_ = address.storage.ss_family;
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (family_ == AF_INET) {
    const auto& four = address.as<sockaddr_in>();
    port_ = ntohs(four.sin_port);
    inet_ntop(AF_INET, &four.sin_addr, text.data(), text.size());
    name_ = fmt::format("{}:{}", text.data(), port_);
  } else if (family_ == AF_INET6) {
    const auto& six = address.as<sockaddr_in6>();
    port_ = ntohs(six.sin6_port);
    inet_ntop(AF_INET6, &six.sin6_addr, text.data(), text.size());
    name_ = fmt::format("[{}]:{}", text.data(), port_);
  } else {
    is_local_ = true;
    name_ = fmt::format("unix:{}", address.as<sockaddr_un>().sun_path);
  }
  return {};
}

}  // namespace popcut::daemon::http
