// SPDX-License-Identifier: MIT
#include "device/usb/usb_transport.hpp"

#include <algorithm>

#include "device/usb/usb_line.hpp"

namespace popcut {
namespace {

// A multiple of every packet size. Small enough that little is in doubt when a cable is unplugged,
// large enough that the pause between transfers (below 1 ms) never empties a cutter's buffer.
constexpr std::size_t kTransferBytes = 4096;

}  // namespace

UsbTransport::UsbTransport(std::shared_ptr<UsbLine> line) : line_(std::move(line)) {}
UsbTransport::~UsbTransport() { UsbLine::retire(std::move(line_)); }

Transport::WriteEnd UsbTransport::write(std::span<const std::byte> bytes, Deadline until) {
  WriteEnd end;
  while (end.taken < bytes.size()) {
    const std::span<const std::byte> rest = bytes.subspan(end.taken);
    WriteEnd piece = line_->send(rest.first(std::min(rest.size(), kTransferBytes)), until);
    end.taken += piece.taken;
    if (!piece.error) continue;
    end.error = std::move(piece.error);
    end.in_doubt = piece.in_doubt;
    break;
  }
  return end;
}

Result<std::vector<std::byte>> UsbTransport::read(Deadline until) { return line_->receive(until); }

std::chrono::nanoseconds UsbTransport::now() const {
  return std::chrono::steady_clock::now().time_since_epoch();
}

void UsbTransport::wait(std::chrono::nanoseconds duration) { line_->rest(duration); }

bool UsbTransport::answers() const { return line_->device().interface.in_endpoint != 0; }

const UsbDevice& UsbTransport::device() const { return line_->device(); }

const std::string& UsbTransport::displaced_driver() const { return line_->displaced_driver(); }

}  // namespace popcut
