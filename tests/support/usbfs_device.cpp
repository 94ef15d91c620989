// SPDX-License-Identifier: MIT
#include "tests/support/usbfs_device.hpp"

#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <pty.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace popcut::testing {
namespace {

using Lock = std::lock_guard<std::recursive_mutex>;

gboolean complete(UMockdevIoctlClient* client, long result, int error = 0) {
  umockdev_ioctl_client_complete(client, result, error);
  return TRUE;
}

UMockdevIoctlData* argument(UMockdevIoctlClient* client, std::size_t bytes) {
  return umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, bytes, nullptr);
}

/// A structure that the host passed by address.
template <typename T>
T read_argument(UMockdevIoctlClient* client) {
  UMockdevIoctlData* const data = argument(client, sizeof(T));
  T value;
  std::memcpy(&value, data->data, sizeof value);
  g_object_unref(data);
  return value;
}

template <typename T>
void write_argument(UMockdevIoctlClient* client, const T& value) {
  UMockdevIoctlData* const data = argument(client, sizeof(T));
  std::memcpy(data->data, &value, sizeof value);
  g_object_unref(data);
}

usbdevfs_urb& urb_of(UMockdevIoctlData* data) {
  return *reinterpret_cast<usbdevfs_urb*>(data->data);
}

}  // namespace

UsbfsDevice::UsbfsDevice(const UsbTestbed& testbed, UsbfsShape shape)
    : testbed_(testbed), shape_(std::move(shape)), handler_(umockdev_ioctl_base_new()) {
  life_->device = this;
  g_signal_connect_data(handler_, "handle-ioctl", reinterpret_cast<GCallback>(on_ioctl), this,
                        nullptr, static_cast<GConnectFlags>(0));
}

UsbfsDevice::~UsbfsDevice() {
  unplug();
  {
    const std::lock_guard lock(life_->mutex);
    life_->device = nullptr;
  }
  g_signal_handlers_disconnect_matched(handler_, G_SIGNAL_MATCH_DATA, 0, 0, nullptr, nullptr, this);
  if (attached_) umockdev_testbed_detach_ioctl(testbed_.get(), node().c_str(), nullptr);
  g_object_unref(handler_);
}

std::string UsbfsDevice::driver() const {
  const Lock lock(mutex_);
  return driver_;
}

UsbfsDevice::Counts UsbfsDevice::counts() const {
  const Lock lock(mutex_);
  return counts_;
}

void UsbfsDevice::plug() {
  const Lock lock(mutex_);
  plugged_ = true;
  driver_ = shape_.driver;
  claimed_ = nullptr;
  endpoints_.clear();
  inward_.clear();
  // The handler first: whoever hears of the device must find it.
  if (!attached_)
    attached_ = umockdev_testbed_attach_ioctl(testbed_.get(), node().c_str(), handler_, nullptr);
  // umockdev connects even where the node may not be opened, and ends the program if it cannot.
  ::chmod((testbed_.root() + "/ioctl" + node()).c_str(), 0777);
  std::array<char, 64> name{};
  if (::openpty(&master_, &slave_, nullptr, nullptr, nullptr) != 0 ||
      ::ttyname_r(slave_, name.data(), name.size()) != 0)
    throw std::runtime_error("no pty for an emulated device");
  termios raw{};
  ::tcgetattr(slave_, &raw);
  ::cfmakeraw(&raw);
  ::tcsetattr(slave_, TCSANOW, &raw);
  ::fchmod(slave_, 0600);
  show_poll();
  const std::string path = testbed_.root() + node();
  g_mkdir_with_parents(path.substr(0, path.rfind('/')).c_str(), 0755);
  ::unlink(path.c_str());
  if (::symlink(name.data(), path.c_str()) != 0)
    throw std::runtime_error("no node for an emulated device: " + path);
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(testbed_.get(), shape_.sysfs_entry().c_str(), &error) ==
      FALSE)
    throw std::runtime_error(error->message);
}

void UsbfsDevice::plug_again() {
  const Lock lock(mutex_);
  if (!plugged_) plug();
}

void UsbfsDevice::unplug(int status) {
  const Lock lock(mutex_);
  if (!plugged_) return;
  plugged_ = false;
  while (!pending_.empty()) {
    const Transfer transfer = pending_.front();
    pending_.pop_front();
    finish(transfer, status);
  }
  ::close(slave_);
  ::close(master_);
  slave_ = master_ = -1;
  const std::string sys = "/sys" + shape_.sysfs_path();
  umockdev_testbed_uevent(testbed_.get(), sys.c_str(), "remove");
  ::unlink((testbed_.root() + node()).c_str());
  umockdev_testbed_remove_device(testbed_.get(), sys.c_str());
}

/// poll() says that the node can be written while a finished transfer waits.
void UsbfsDevice::show_poll() {
  if (slave_ >= 0) ::tcflow(slave_, finished_.empty() ? TCOOFF : TCOON);
}

void UsbfsDevice::retry() {
  const Lock lock(mutex_);
  move_data();
}

void UsbfsDevice::send_in(std::span<const std::byte> bytes) {
  const Lock lock(mutex_);
  for (const std::byte byte : bytes) inward_.push_back(static_cast<std::uint8_t>(byte));
  move_data();
}

void UsbfsDevice::fail_in(int status) {
  const Lock lock(mutex_);
  endpoints_[shape_.in_endpoint].fail = status;
  move_data();
}

void UsbfsDevice::fail_submit(int positive_errno) {
  const Lock lock(mutex_);
  fail_submit_ = positive_errno;
}

void UsbfsDevice::keep_discarded(bool keep) {
  const Lock lock(mutex_);
  keep_discarded_ = keep;
}

// Data between transfers and the device.

void UsbfsDevice::move_data() {
  if (!plugged_) return;
  if (moving_) {  // the device's own callback got here: once more after it
    again_ = true;
    return;
  }
  moving_ = true;
  do {
    again_ = false;
    move_once();
  } while (again_);
  moving_ = false;
}

void UsbfsDevice::move_once() {
  constexpr int kWaits = 1;
  std::vector<std::uint8_t> blocked;
  for (std::size_t i = 0; i < pending_.size();) {
    const std::uint8_t address = urb_of(pending_[i].urb).endpoint;
    int status = kWaits;
    if (std::find(blocked.begin(), blocked.end(), address) == blocked.end()) {
      Endpoint& endpoint = endpoints_[address];
      if (endpoint.halted)
        status = -EPIPE;
      else
        status = (address & 0x80) != 0 ? move_in(pending_[i], endpoint)
                                       : move_out(pending_[i], endpoint);
      if (status == -EPIPE) endpoint.halted = true;
    }
    if (status == kWaits) {
      blocked.push_back(address);
      ++i;
      continue;
    }
    const Transfer ended = pending_[i];
    pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(i));
    finish(ended, status);
  }
}

int UsbfsDevice::move_out(Transfer& transfer, Endpoint&) {
  const auto length = static_cast<std::size_t>(urb_of(transfer.urb).buffer_length);
  const std::span<const std::uint8_t> rest =
      std::span(transfer.buffer->data, length).subspan(transfer.done);
  const Took took = on_out ? on_out(std::as_bytes(rest)) : Took{rest.size(), 0};
  transfer.done += took.bytes;
  if (took.status != 0) return took.status;
  return transfer.done == length ? 0 : 1;
}

int UsbfsDevice::move_in(Transfer& transfer, Endpoint& endpoint) {
  if (endpoint.fail != 0) return std::exchange(endpoint.fail, 0);
  if (inward_.empty()) return 1;
  const auto length = static_cast<std::size_t>(urb_of(transfer.urb).buffer_length);
  const std::size_t count = std::min(length, inward_.size());
  std::copy_n(inward_.begin(), count, transfer.buffer->data);
  inward_.erase(inward_.begin(), inward_.begin() + static_cast<std::ptrdiff_t>(count));
  transfer.done = count;
  return 0;
}

void UsbfsDevice::finish(const Transfer& transfer, int status) {
  usbdevfs_urb& urb = urb_of(transfer.urb);
  urb.status = status;
  urb.actual_length = static_cast<int>(transfer.done);
  finished_.push_back(transfer);
  show_poll();
}

/// Control requests: what libusb may ask for on endpoint 0.
void UsbfsDevice::control(Transfer transfer) {
  std::uint8_t* const setup = transfer.buffer->data;
  const bool inward = (setup[0] & 0x80) != 0;
  const std::size_t wanted = setup[6] + 256u * setup[7];
  std::vector<std::uint8_t> reply;
  int status = 0;
  if (setup[0] == 0xa1 && setup[1] == 1)
    reply = {0x18};  // printer class, GET_PORT_STATUS: selected, no error
  else if (inward)
    status = -EPIPE;
  reply.resize(std::min(reply.size(), wanted));
  std::copy(reply.begin(), reply.end(), setup + 8);
  transfer.done = inward ? reply.size() : wanted;
  finish(transfer, status);
}

// The calls.

gboolean UsbfsDevice::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  return static_cast<UsbfsDevice*>(self)->serve(client);
}

/// A client closed its node, or died: its claims and transfers go with it.
void UsbfsDevice::on_client_gone(gpointer life, GObject* client) {
  const std::unique_ptr<std::shared_ptr<Life>> held(static_cast<std::shared_ptr<Life>*>(life));
  const std::lock_guard lock((*held)->mutex);
  if ((*held)->device != nullptr)
    (*held)->device->forget(reinterpret_cast<UMockdevIoctlClient*>(client));
}

void UsbfsDevice::forget(UMockdevIoctlClient* client) {
  const Lock lock(mutex_);
  for (std::deque<Transfer>* queue : {&pending_, &finished_})
    std::erase_if(*queue, [&](const Transfer& transfer) {
      if (transfer.client != client) return false;
      if (transfer.buffer != nullptr) g_object_unref(transfer.buffer);
      g_object_unref(transfer.urb);
      return true;
    });
  show_poll();
  if (claimed_ == client) claimed_ = nullptr;
  std::erase(clients_, client);
}

gboolean UsbfsDevice::serve(UMockdevIoctlClient* client) {
  const Lock lock(mutex_);
  if (std::find(clients_.begin(), clients_.end(), client) == clients_.end()) {
    clients_.push_back(client);
    g_object_weak_ref(reinterpret_cast<GObject*>(client), on_client_gone,
                      new std::shared_ptr<Life>(life_));
  }
  const unsigned long request = umockdev_ioctl_client_get_request(client);
  switch (request) {
    case USBDEVFS_SUBMITURB:
    case USBDEVFS_DISCARDURB:
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      return serve_transfer(client, request);
    default:
      if (!plugged_) return complete(client, -1, ENODEV);
      return serve_driver(client, request);
  }
}

gboolean UsbfsDevice::serve_driver(UMockdevIoctlClient* client, unsigned long request) {
  const auto claimed_by_other = [&] { return claimed_ != nullptr && claimed_ != client; };
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
      write_argument<std::uint32_t>(
          client, USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                      USBDEVFS_CAP_BULK_SCATTER_GATHER | USBDEVFS_CAP_REAP_AFTER_DISCONNECT);
      return complete(client, 0);
    case USBDEVFS_GET_SPEED:
      return complete(client, 2);
    case USBDEVFS_GETDRIVER: {
      auto who = read_argument<usbdevfs_getdriver>(client);
      const std::string name = claimed_ != nullptr ? "usbfs" : driver_;
      if (name.empty()) return complete(client, -1, ENODATA);
      std::fill(std::begin(who.driver), std::end(who.driver), '\0');
      name.copy(who.driver, sizeof who.driver - 1);
      write_argument(client, who);
      return complete(client, 0);
    }
    case USBDEVFS_CLAIMINTERFACE:
      if (read_argument<int>(client) != 0) return complete(client, -1, ENOENT);
      if (!driver_.empty() || claimed_by_other()) return complete(client, -1, EBUSY);
      claimed_ = client;
      return complete(client, 0);
    case USBDEVFS_DISCONNECT_CLAIM:
      if (claimed_by_other()) return complete(client, -1, EBUSY);
      if (!driver_.empty()) ++counts_.detaches;
      driver_.clear();
      claimed_ = client;
      return complete(client, 0);
    case USBDEVFS_RELEASEINTERFACE:
      if (claimed_ != client) return complete(client, -1, EINVAL);
      claimed_ = nullptr;
      return complete(client, 0);
    case USBDEVFS_IOCTL: {
      const auto inner = read_argument<usbdevfs_ioctl>(client);
      if (static_cast<unsigned>(inner.ioctl_code) == USBDEVFS_CONNECT) {
        driver_ = shape_.driver;
        ++counts_.attaches;
        return complete(client, 1);
      }
      if (static_cast<unsigned>(inner.ioctl_code) != USBDEVFS_DISCONNECT)
        return complete(client, -1, ENOTTY);
      if (driver_.empty()) return complete(client, -1, ENODATA);
      driver_.clear();
      ++counts_.detaches;
      return complete(client, 0);
    }
    case USBDEVFS_CLEAR_HALT: {
      const auto address = static_cast<std::uint8_t>(read_argument<unsigned>(client));
      endpoints_[address].halted = false;
      ++counts_.clear_halts;
      return complete(client, 0);
    }
    case USBDEVFS_RESET:
      ++counts_.resets;
      return complete(client, 0);
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
      return complete(client, 0);
    default:
      return complete(client, -1, ENOTTY);
  }
}

gboolean UsbfsDevice::serve_transfer(UMockdevIoctlClient* client, unsigned long request) {
  if (request == USBDEVFS_SUBMITURB) return submit(client);
  if (request == USBDEVFS_DISCARDURB) return discard(client);
  return reap(client);
}

gboolean UsbfsDevice::submit(UMockdevIoctlClient* client) {
  if (!plugged_) return complete(client, -1, ENODEV);
  if (fail_submit_ != 0) return complete(client, -1, std::exchange(fail_submit_, 0));
  Transfer transfer{client, argument(client, sizeof(usbdevfs_urb)), nullptr, 0};
  const usbdevfs_urb& urb = urb_of(transfer.urb);
  const bool on_endpoint_0 = urb.type == USBDEVFS_URB_TYPE_CONTROL;
  if (!on_endpoint_0 && claimed_ != client) {
    g_object_unref(transfer.urb);
    return complete(client, -1, EINVAL);
  }
  if (urb.buffer_length > 0)
    transfer.buffer =
        umockdev_ioctl_data_resolve(transfer.urb, offsetof(usbdevfs_urb, buffer),
                                    static_cast<std::size_t>(urb.buffer_length), nullptr);
  complete(client, 0);  // before anything can come of it
  if (on_endpoint_0) {
    control(transfer);
  } else {
    pending_.push_back(transfer);
    move_data();
  }
  return TRUE;
}

gboolean UsbfsDevice::discard(UMockdevIoctlClient* client) {
  ++counts_.discards;
  gulong address = 0;
  std::memcpy(&address, umockdev_ioctl_client_get_arg(client)->data, sizeof address);
  const auto found = std::find_if(pending_.begin(), pending_.end(), [&](const Transfer& transfer) {
    return transfer.client == client && transfer.urb->client_addr == address;
  });
  if (found == pending_.end()) return complete(client, -1, plugged_ ? EINVAL : ENODEV);
  if (keep_discarded_) return complete(client, 0);
  const Transfer transfer = *found;
  pending_.erase(found);
  complete(client, 0);
  finish(transfer, -ENOENT);  // with what was moved so far, as the kernel does
  return TRUE;
}

gboolean UsbfsDevice::reap(UMockdevIoctlClient* client) {
  const auto found =
      std::find_if(finished_.begin(), finished_.end(),
                   [&](const Transfer& transfer) { return transfer.client == client; });
  if (found == finished_.end()) {
    ++counts_.idle_reaps;
    return complete(client, -1, plugged_ ? EAGAIN : ENODEV);
  }
  const Transfer transfer = *found;
  finished_.erase(found);
  UMockdevIoctlData* const pointer = argument(client, sizeof(void*));
  umockdev_ioctl_data_set_ptr(pointer, 0, transfer.urb);
  g_object_unref(pointer);
  show_poll();
  complete(client, 0);
  if (transfer.buffer != nullptr) g_object_unref(transfer.buffer);
  g_object_unref(transfer.urb);
  return TRUE;
}

}  // namespace popcut::testing
