// SPDX-License-Identifier: MIT
#include "device/usb/usb_line.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

#include "device/usb/usb_error.hpp"
#include "device/usb/usb_shared.hpp"

namespace popcut {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kInBytes = 512;           // a multiple of every packet size up to 512
constexpr std::size_t kMostUnread = 64 * 1024;  // of a device that never stops sending
constexpr int kMostEmpty = 16;                  // transfers without a byte, in a row
constexpr int kMostFaults = 10;                 // failed transfers inward, in a row
constexpr milliseconds kBetweenFaults{50};
// A cancelled transfer returns within microseconds; a controller that hangs never returns it.
constexpr milliseconds kComeBack{2000};
// The hub reports an unplugged device about 100 ms after a transfer has failed.
constexpr milliseconds kGoneSoon{500};

Error of(ErrorKind kind, const UsbDevice& device, std::string detail,
         ErrorReason reason = ErrorReason::None) {
  return {kind, device.id, std::move(detail), reason};
}

std::chrono::steady_clock::time_point at(Deadline until) {
  return std::chrono::steady_clock::time_point(until);
}

}  // namespace

Result<std::shared_ptr<UsbLine>> UsbLine::claim(std::shared_ptr<UsbBus::Shared> bus,
                                                libusb_device_handle* handle,
                                                const UsbDevice& device) {
  std::shared_ptr<UsbLine> line(new UsbLine(std::move(bus), handle, device));
  if (const Result<void> taken = line->take_over(); !taken) return tl::unexpected(taken.error());
  return line;
}

UsbLine::UsbLine(std::shared_ptr<UsbBus::Shared> bus, libusb_device_handle* handle,
                 const UsbDevice& device)
    : bus_(std::move(bus)), handle_(handle), device_(device) {
  bus_->add(this);
}

Result<void> UsbLine::take_over() {
  const UsbInterface& interface = device_.interface;
  const UsbUse before = usb_use(device_);
  // The driver gets it back at the end. Where this is not supported, claiming fails.
  static_cast<void>(libusb_set_auto_detach_kernel_driver(handle_, 1));
  int configuration = 0;
  int code = libusb_get_configuration(handle_, &configuration);
  if (code == 0 && configuration == 0) code = libusb_set_configuration(handle_, 1);
  if (code == 0) code = libusb_claim_interface(handle_, interface.number);
  if (code != 0) return tl::unexpected(usb_error(code, device_, "claimed"));
  claimed_ = true;
  if (before.driver != "usbfs") displaced_ = before.driver;
  if (interface.alternate != 0) {
    code = libusb_set_interface_alt_setting(handle_, interface.number, interface.alternate);
    if (code != 0) return tl::unexpected(usb_error(code, device_, "set up"));
  }
  out_ = libusb_alloc_transfer(0);
  in_ = libusb_alloc_transfer(0);
  if (out_ == nullptr || in_ == nullptr)
    return tl::unexpected(usb_error(LIBUSB_ERROR_NO_MEM, device_, "used"));
  in_buffer_.resize(std::max<std::size_t>(kInBytes, interface.max_packet_bytes));
  if (interface.in_endpoint != 0) listen();
  return {};
}

/// Cancels both transfers and waits for them; false if the controller keeps one.
bool UsbLine::call_back() {
  constexpr int kTries = 50;
  std::unique_lock lock(mutex_);
  closing_ = true;
  // More than one try: a callback that did not see `closing_` may submit a transfer again.
  for (int i = 0; i < kTries && (out_busy_ || in_busy_); ++i) {
    const bool out = out_busy_;
    const bool in = in_busy_;
    lock.unlock();
    if (out) libusb_cancel_transfer(out_);
    if (in) libusb_cancel_transfer(in_);
    lock.lock();
    changed_.wait_for(lock, kComeBack / kTries, [&] { return !out_busy_ && !in_busy_; });
  }
  return !out_busy_ && !in_busy_;
}

namespace {

/// Lines whose transfers a controller keeps. Never destroyed: it may still write to them.
struct Kept {
  std::mutex mutex;
  std::vector<std::shared_ptr<UsbLine>> lines;
};

Kept& kept() {
  static auto* const all = new Kept;
  return *all;
}

}  // namespace

void UsbLine::retire(std::shared_ptr<UsbLine> line) {
  if (line->call_back()) return;
  const std::lock_guard lock(kept().mutex);
  kept().lines.push_back(std::move(line));
}

void UsbLine::release_retired() {
  std::vector<std::shared_ptr<UsbLine>> back;
  const std::lock_guard lock(kept().mutex);
  std::erase_if(kept().lines, [&](std::shared_ptr<UsbLine>& line) {
    const std::lock_guard line_lock(line->mutex_);
    if (line->out_busy_ || line->in_busy_) return false;
    back.push_back(line);
    return true;
  });
}

UsbLine::~UsbLine() {
  bus_->remove(this);
  if (claimed_) libusb_release_interface(handle_, device_.interface.number);
  libusb_close(handle_);
  libusb_free_transfer(out_);
  libusb_free_transfer(in_);
}

// 1. Out.

Transport::WriteEnd UsbLine::send(std::span<const std::byte> piece, Deadline until) {
  if (failed_) return {0, failed_};
  if (Clock::now() >= at(until))
    return {0,
            of(ErrorKind::Timeout, device_, "there was no time left for the cutter to take data")};
  out_buffer_.resize(piece.size());
  std::transform(piece.begin(), piece.end(), out_buffer_.begin(),
                 [](std::byte byte) { return static_cast<unsigned char>(byte); });
  libusb_fill_bulk_transfer(out_, handle_, device_.interface.out_endpoint, out_buffer_.data(),
                            static_cast<int>(piece.size()), out_done, this, 0);
  {
    const std::lock_guard lock(mutex_);
    if (gone_) {
      failed_ = gone();
      return {0, failed_};
    }
    out_busy_ = true;
  }
  if (const int code = libusb_submit_transfer(out_); code != 0) {
    const std::lock_guard lock(mutex_);
    out_busy_ = false;
    Error error = usb_error(code, device_, "sent to");
    if (error.kind == ErrorKind::DeviceGone) return fail_for_good(0, 0, std::move(error));
    return {0, std::move(error)};
  }
  if (!come_back(until))
    return fail_for_good(
        0, piece.size(),
        of(ErrorKind::DeviceGone, device_,
           "the USB controller does not return a transfer; unplug the cutter, then "
           "restart popcut"));
  return judge(piece.size());
}

bool UsbLine::come_back(Deadline until) {
  std::unique_lock lock(mutex_);
  const auto back = [&] { return !out_busy_; };
  if (changed_.wait_until(lock, at(until), back)) return true;
  lock.unlock();
  libusb_cancel_transfer(out_);  // it may just have ended by itself, which is fine
  lock.lock();
  return changed_.wait_for(lock, kComeBack, back);
}

Transport::WriteEnd UsbLine::judge(std::size_t length) {
  const std::size_t taken = std::min(length, static_cast<std::size_t>(out_->actual_length));
  const std::size_t rest = length - taken;
  switch (out_->status) {
    case LIBUSB_TRANSFER_COMPLETED:
    case LIBUSB_TRANSFER_CANCELLED:
    case LIBUSB_TRANSFER_TIMED_OUT:
      if (taken == length) return {taken, std::nullopt};
      return {taken, of(ErrorKind::Timeout, device_,
                        fmt::format("the cutter took {} of {} bytes in time; it is busy or paused",
                                    taken, length))};
    case LIBUSB_TRANSFER_STALL:
      libusb_clear_halt(handle_, device_.interface.out_endpoint);
      return {
          taken,
          of(ErrorKind::Refused, device_,
             "the cutter stalled while receiving data; switch it off and on, check the sheet, then "
             "start again",
             ErrorReason::Stalled),
          std::min<std::size_t>(rest, device_.interface.max_packet_bytes)};
    case LIBUSB_TRANSFER_NO_DEVICE:
      return fail_for_good(taken, rest, gone());
    default:
      break;
  }
  // An unplugged device often shows as a failed transfer first.
  std::unique_lock lock(mutex_);
  const bool left = changed_.wait_for(lock, kGoneSoon, [&] { return gone_; });
  return fail_for_good(
      taken, rest,
      left ? gone()
           : of(ErrorKind::DeviceGone, device_,
                "a transfer failed on the bus; check cable and hub, switch the cutter off and on"));
}

Transport::WriteEnd UsbLine::fail_for_good(std::size_t taken, std::size_t in_doubt, Error error) {
  failed_ = std::move(error);
  return {taken, failed_, in_doubt};
}

Error UsbLine::gone() const {
  return of(ErrorKind::DeviceGone, device_,
            "the cutter was unplugged or switched off; check cable and power");
}

void UsbLine::out_done(libusb_transfer* transfer) {
  UsbLine& line = *static_cast<UsbLine*>(transfer->user_data);
  const std::lock_guard lock(line.mutex_);
  line.out_busy_ = false;
  line.gone_ = line.gone_ || transfer->status == LIBUSB_TRANSFER_NO_DEVICE;
  line.changed_.notify_all();
}

// 2. In.

/// Submits a transfer that waits for incoming bytes.
void UsbLine::listen() {
  {
    const std::lock_guard lock(mutex_);
    if (in_busy_ || gone_ || closing_) return;
    in_busy_ = true;
  }
  libusb_fill_bulk_transfer(in_, handle_, device_.interface.in_endpoint, in_buffer_.data(),
                            static_cast<int>(in_buffer_.size()), in_done, this, 0);
  const int code = libusb_submit_transfer(in_);
  if (code == 0) return;
  const std::lock_guard lock(mutex_);
  in_busy_ = false;
  gone_ = gone_ || code == LIBUSB_ERROR_NO_DEVICE;
  inward_ = Inward::Failed;
  ++in_faults_;
  changed_.notify_all();
}

void UsbLine::take_in(const libusb_transfer& transfer) {
  in_busy_ = false;
  switch (transfer.status) {
    case LIBUSB_TRANSFER_COMPLETED:
    case LIBUSB_TRANSFER_CANCELLED:
    case LIBUSB_TRANSFER_TIMED_OUT:
      in_faults_ = 0;
      break;
    case LIBUSB_TRANSFER_STALL:
      inward_ = Inward::Stalled;
      ++in_faults_;
      break;
    case LIBUSB_TRANSFER_OVERFLOW:
      inward_ = Inward::Overflowed;
      ++in_faults_;
      break;
    case LIBUSB_TRANSFER_NO_DEVICE:
      gone_ = true;
      break;
    default:
      inward_ = Inward::Failed;
      ++in_faults_;
  }
  const std::span<const unsigned char> bytes(transfer.buffer,
                                             static_cast<std::size_t>(transfer.actual_length));
  in_empty_ = bytes.empty() ? in_empty_ + 1 : 0;
  for (const unsigned char byte : bytes) received_.push_back(static_cast<std::byte>(byte));
}

void UsbLine::in_done(libusb_transfer* transfer) {
  UsbLine& line = *static_cast<UsbLine*>(transfer->user_data);
  bool again = false;
  {
    const std::lock_guard lock(line.mutex_);
    line.take_in(*transfer);
    again = transfer->status == LIBUSB_TRANSFER_COMPLETED && line.in_empty_ < kMostEmpty &&
            line.received_.size() < kMostUnread && !line.closing_ && !line.gone_;
    line.in_busy_ = again;
    line.changed_.notify_all();
  }
  if (!again) return;
  const int code = libusb_submit_transfer(transfer);
  if (code == 0) return;
  const std::lock_guard lock(line.mutex_);
  line.in_busy_ = false;
  line.gone_ = line.gone_ || code == LIBUSB_ERROR_NO_DEVICE;
  line.changed_.notify_all();
}

ErrorReason UsbLine::reason_of(Inward state) {
  if (state == Inward::Stalled) return ErrorReason::Stalled;
  return state == Inward::Overflowed ? ErrorReason::Overflow : ErrorReason::None;
}

/// After a stall or a failed transfer inward. Such a transfer sends nothing to the device, so
/// trying again is safe.
Result<void> UsbLine::mend_inward(std::unique_lock<std::mutex>& lock, Deadline until) {
  const Inward state = inward_;
  if (state == Inward::Fine) return {};
  if (in_faults_ > kMostFaults)
    return tl::unexpected(of(ErrorKind::Refused, device_,
                             "the cutter's replies do not arrive; check cable and hub, "
                             "switch the cutter off and on",
                             reason_of(state)));
  const auto next_try = std::min(Clock::now() + kBetweenFaults, at(until));
  changed_.wait_until(lock, next_try, [&] { return gone_; });
  inward_ = Inward::Fine;
  lock.unlock();
  if (state == Inward::Stalled) libusb_clear_halt(handle_, device_.interface.in_endpoint);
  lock.lock();
  return {};
}

Result<std::vector<std::byte>> UsbLine::receive(Deadline until) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (!received_.empty()) {
      std::vector<std::byte> bytes;
      bytes.swap(received_);
      return bytes;
    }
    if (gone_) return tl::unexpected(gone());
    if (device_.interface.in_endpoint != 0) {
      if (const Result<void> mended = mend_inward(lock, until); !mended)
        return tl::unexpected(mended.error());
      lock.unlock();
      listen();
      lock.lock();
    }
    if (Clock::now() >= at(until) && received_.empty())
      return fail(ErrorKind::Timeout, device_.id, "no reply arrived in time");
    // Empty transfers are submitted again after a millisecond, not at once.
    const bool hasty = in_empty_ >= kMostEmpty;
    const auto most = hasty ? std::min(at(until), Clock::now() + milliseconds(1)) : at(until);
    if (hasty)
      changed_.wait_until(lock, most, [&] { return gone_ || !received_.empty(); });
    else
      changed_.wait_until(lock, most, [&] { return gone_ || !received_.empty() || !in_busy_; });
  }
}

void UsbLine::rest(std::chrono::nanoseconds duration) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, duration, [&] { return gone_; });
}

void UsbLine::mark_gone() {
  const std::lock_guard lock(mutex_);
  gone_ = true;
  changed_.notify_all();
}

}  // namespace popcut
