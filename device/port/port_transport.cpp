// SPDX-License-Identifier: MIT
#include "device/port/port_transport.hpp"

#include <utility>  // missing in Boost 1.74's asio

#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/serial_port.hpp>

namespace popcut {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::size_t kReadBytes = 512;

Clock::time_point at(Deadline until) { return Clock::time_point(until); }

std::string group_of(const std::string& path) {
  struct stat node {};
  if (::stat(path.c_str(), &node) != 0) return "";
  std::array<char, 4096> room{};
  group entry{};
  group* found = nullptr;
  if (::getgrgid_r(node.st_gid, &entry, room.data(), room.size(), &found) != 0 || found == nullptr)
    return "";
  return entry.gr_name;
}

Error open_error(const std::string& path, const error_code& code) {
  switch (code.value()) {
    case EACCES:
    case EPERM: {
      const std::string group = group_of(path);
      return {ErrorKind::Refused, path,
              group.empty() || group == "root"
                  ? "no permission to use this port; ask an administrator for access"
                  : fmt::format("no permission to use this port; join the group {0} (sudo usermod "
                                "-aG {0} $USER, then log in again)",
                                group)};
    }
    case EBUSY:
    case EWOULDBLOCK:
      return {ErrorKind::Refused, path,
              "another program uses this port; stop that program first (it may be a CUPS queue)"};
    case ENOENT:
      return {ErrorKind::DeviceGone, path,
              "there is no such port; 'popcut devices' lists what is plugged in"};
    case ENOTTY:
    case EINVAL:
      return {ErrorKind::Refused, path, "is not a serial port; give one such as /dev/ttyUSB0"};
    default:
      return {ErrorKind::DeviceGone, path,
              fmt::format("cannot be opened ({}); check cable and power", code.message())};
  }
}

}  // namespace

/// What serial and printer ports have in common; every call ends at a deadline.
class PortTransport::Port {
 public:
  explicit Port(std::string name) : path(std::move(name)) {}
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  virtual ~Port() = default;

  struct Moved {
    std::size_t bytes{};
    error_code code;  ///< operation_aborted: the deadline passed
  };
  virtual Moved write_some(asio::const_buffer bytes, Clock::time_point until) = 0;
  virtual Moved read_some(asio::mutable_buffer room, Clock::time_point until) = 0;
  virtual int descriptor() = 0;
  /// How many of the `most` bytes given to the kernel it has not sent yet.
  virtual std::size_t queued(std::size_t most) = 0;
  [[nodiscard]] virtual std::size_t piece_bytes() const = 0;

  const std::string path;

 protected:
  asio::io_context io;
};

namespace {

template <typename Stream>
class StreamPort : public PortTransport::Port {
 public:
  explicit StreamPort(std::string name) : Port(std::move(name)), stream(io) {}

  Moved write_some(asio::const_buffer bytes, Clock::time_point until) override {
    return move(until, [&](auto done) { stream.async_write_some(bytes, done); });
  }
  Moved read_some(asio::mutable_buffer room, Clock::time_point until) override {
    return move(until, [&](auto done) { stream.async_read_some(room, done); });
  }
  int descriptor() override { return stream.native_handle(); }

  Stream stream;

 private:
  template <typename Start>
  Moved move(Clock::time_point until, Start start) {
    std::optional<Moved> moved;
    io.restart();
    start([&](const error_code& code, std::size_t bytes) { moved = Moved{bytes, code}; });
    io.poll();
    while (!moved && io.run_one_until(until) > 0) {
    }
    if (!moved) {
      error_code ignored;
      stream.cancel(ignored);
      io.restart();
      while (!moved) io.run_one();
    }
    return *moved;
  }
};

class SerialPort final : public StreamPort<asio::serial_port> {
 public:
  using StreamPort::StreamPort;
  std::size_t queued(std::size_t most) override {
    int waiting = 0;
    if (::ioctl(descriptor(), TIOCOUTQ, &waiting) != 0 || waiting < 0) return 0;
    return std::min(most, static_cast<std::size_t>(waiting));
  }
  [[nodiscard]] std::size_t piece_bytes() const override { return 256; }
};

class PrinterPort final : public StreamPort<asio::posix::stream_descriptor> {
 public:
  using StreamPort::StreamPort;
  /// The driver accepts the next piece when the last one was sent.
  std::size_t queued(std::size_t most) override {
    pollfd port{descriptor(), POLLOUT, 0};
    return ::poll(&port, 1, 0) > 0 ? 0 : most;
  }
  [[nodiscard]] std::size_t piece_bytes() const override { return 1024; }
};

/// Locks the port against other programs.
error_code lock(int descriptor) {
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return {};
  return {errno, boost::system::system_category()};
}

error_code configure(asio::serial_port& port, const SerialSettings& settings) {
  using Base = asio::serial_port_base;
  const auto flow = settings.flow == FlowControl::RtsCts    ? Base::flow_control::hardware
                    : settings.flow == FlowControl::XonXoff ? Base::flow_control::software
                                                            : Base::flow_control::none;
  error_code code;
  port.set_option(Base::character_size(8), code);
  if (!code) port.set_option(Base::parity(Base::parity::none), code);
  if (!code) port.set_option(Base::stop_bits(Base::stop_bits::one), code);
  if (!code) port.set_option(Base::flow_control(flow), code);
  return code;
}

}  // namespace

Result<std::unique_ptr<PortTransport>> PortTransport::open_serial(const std::string& path,
                                                                  const SerialSettings& settings) {
  auto port = std::make_unique<SerialPort>(path);
  error_code code;
  port->stream.open(path, code);
  if (!code) code = lock(port->descriptor());
  if (!code) code = configure(port->stream, settings);
  if (code) return tl::unexpected(open_error(path, code));
  port->stream.set_option(asio::serial_port_base::baud_rate(settings.baud), code);
  if (code)
    return fail(
        ErrorKind::Refused, path,
        fmt::format("does not support {} baud; cutters use 9600, some 19200, 38400 or 115200",
                    settings.baud));
  static_cast<void>(::ioctl(port->descriptor(), TIOCEXCL));
  return std::unique_ptr<PortTransport>(new PortTransport(std::move(port)));
}

Result<std::unique_ptr<PortTransport>> PortTransport::open_printer(const std::string& path) {
  auto port = std::make_unique<PrinterPort>(path);
  const int descriptor = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (descriptor < 0)
    return tl::unexpected(open_error(path, {errno, boost::system::system_category()}));
  struct stat node {};
  const bool device = ::fstat(descriptor, &node) == 0 && S_ISCHR(node.st_mode);
  if (!device) {
    ::close(descriptor);
    return fail(
        ErrorKind::Refused, path,
        "is not a printer port; give one such as /dev/usb/lp0, or file:NAME to write a file");
  }
  port->stream.assign(descriptor);
  if (const error_code code = lock(descriptor)) return tl::unexpected(open_error(path, code));
  return std::unique_ptr<PortTransport>(new PortTransport(std::move(port)));
}

PortTransport::PortTransport(std::unique_ptr<Port> port) : port_(std::move(port)) {}

PortTransport::~PortTransport() { settle(now() + std::chrono::seconds(5)); }

Error PortTransport::gone() const {
  return {ErrorKind::DeviceGone, port_->path,
          "the port hung up: cable or adapter unplugged, or the cutter switched off"};
}

bool PortTransport::settle(Deadline until) {
  for (;;) {
    handed_over_ = port_->queued(handed_over_);
    if (handed_over_ == 0) return true;
    if (Clock::now() >= at(until)) return false;
    std::this_thread::sleep_for(milliseconds(2));
  }
}

Transport::WriteEnd PortTransport::write(std::span<const std::byte> bytes, Deadline until) {
  WriteEnd end;
  const auto late = [&] {
    return Error{ErrorKind::Timeout, port_->path,
                 fmt::format("the port took {} of {} bytes in time; the cutter is busy or paused",
                             end.taken, bytes.size())};
  };
  while (end.taken < bytes.size()) {
    if (!settle(until) || Clock::now() >= at(until)) {
      end.error = late();
      break;
    }
    const auto piece =
        bytes.subspan(end.taken).first(std::min(bytes.size() - end.taken, port_->piece_bytes()));
    const Port::Moved moved =
        port_->write_some(asio::const_buffer(piece.data(), piece.size()), at(until));
    end.taken += moved.bytes;
    handed_over_ = moved.bytes;
    if (!moved.code) continue;
    end.error = moved.code == asio::error::operation_aborted ? late() : gone();
    break;
  }
  settle(until);
  return end;
}

Result<std::vector<std::byte>> PortTransport::read(Deadline until) {
  std::vector<std::byte> bytes(kReadBytes);
  for (;;) {
    const Port::Moved moved =
        port_->read_some(asio::mutable_buffer(bytes.data(), bytes.size()), at(until));
    if (moved.bytes > 0) {
      bytes.resize(moved.bytes);
      return bytes;
    }
    pollfd state{port_->descriptor(), 0, 0};
    const bool hung_up =
        ::poll(&state, 1, 0) > 0 && (state.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
    const bool late = moved.code == asio::error::operation_aborted;
    if (hung_up || (moved.code && !late && moved.code != asio::error::eof))
      return tl::unexpected(gone());
    if (late || Clock::now() >= at(until))
      return fail(ErrorKind::Timeout, port_->path, "no reply arrived in time");
    std::this_thread::sleep_for(milliseconds(5));  // a printer port may say "nothing" at once
  }
}

std::chrono::nanoseconds PortTransport::now() const { return Clock::now().time_since_epoch(); }

void PortTransport::wait(std::chrono::nanoseconds duration) {
  std::this_thread::sleep_for(duration);
}

std::size_t PortTransport::in_transit() const { return port_->queued(handed_over_); }

}  // namespace popcut
