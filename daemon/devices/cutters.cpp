// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "daemon/devices/cutter.hpp"
#include "daemon/devices/make_cutters.hpp"
#include "device/usb/usb_bus.hpp"
#include "device/usb/usb_error.hpp"

namespace popcut::daemon {
namespace {

using std::chrono::steady_clock;

constexpr auto kGiveUp = std::chrono::seconds(3);  // for a trailer, beyond the time for strokes
constexpr auto kLook = std::chrono::seconds(2);    // at ports, which tell nothing by themselves

class CutterSet final : public Cutters {
 public:
  explicit CutterSet(CuttersOptions options) : options_(std::move(options)) {
    if (options_.devices.empty()) options_.devices.push_back({.id = "sim:cameo3"});
  }

  ~CutterSet() override {
    if (bus_) bus_->on_change({});
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_all();
    if (keeper_.joinable()) keeper_.join();
    const std::lock_guard lock(mutex_);
    for (const auto& cutter : cutters_) cutter->cancel();  // all at once, not one after another
    cutters_.clear();
  }
  CutterSet(const CutterSet&) = delete;
  CutterSet& operator=(const CutterSet&) = delete;

  Result<void> begin() {
    auto machines = all_machines(options_.tables);
    if (!machines) return tl::unexpected(machines.error());
    machines_ = std::move(*machines);
    for (const DeviceConfig& config : options_.devices)
      if (auto added = add_configured(config); !added) return added;
    if (options_.usb) {
      // Without USB (a container) there are the other devices.
      if (auto bus = UsbBus::open()) {
        bus_ = std::make_shared<UsbBus>(std::move(*bus));
        bus_->on_change([this] {
          {
            const std::lock_guard lock(mutex_);
            look_ = true;
          }
          wake_.notify_all();
        });
      }
    }
    look_around();
    if (bus_ || has_ports()) keeper_ = std::thread([this] { keep(); });
    return {};
  }

  void on_change(std::function<void()> changed) override {
    const std::lock_guard lock(listener_mutex_);
    listener_ = std::move(changed);
  }

  [[nodiscard]] std::vector<DeviceRecord> list() const override {
    const std::lock_guard lock(mutex_);
    std::vector<DeviceRecord> records;
    for (const auto& cutter : cutters_) records.push_back(cutter->record());
    return records;
  }

  [[nodiscard]] Result<Machine> machine(const std::string& device) const override {
    return find(device).map([](const Cutter* cutter) { return cutter->machine(); });
  }
  Result<void> cut(CutOrder order, std::shared_ptr<CutJournal> journal) override {
    const auto cutter = find(order.device);
    if (!cutter) return tl::unexpected(cutter.error());
    {
      const std::lock_guard lock(mutex_);
      if (stopped_)
        return fail(ErrorKind::Refused, order.device, "popcutd is stopping; start it again later");
    }
    return (*cutter)->cut(std::move(order), std::move(journal));
  }
  void pause(const std::string& device) override {
    if (const auto cutter = find(device)) (*cutter)->pause(true);
  }
  void resume(const std::string& device) override {
    if (const auto cutter = find(device)) (*cutter)->pause(false);
  }
  void cancel(const std::string& device) override {
    if (const auto cutter = find(device)) (*cutter)->cancel();
  }
  Result<void> reset(const std::string& device) override {
    const auto cutter = find(device);
    if (!cutter) return tl::unexpected(cutter.error());
    return (*cutter)->reset();
  }

  void stop_all(double seconds) override {
    std::vector<Cutter*> all;
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
      for (const auto& cutter : cutters_) all.push_back(cutter.get());
    }
    for (Cutter* cutter : all) cutter->cancel();
    const auto until = steady_clock::now() + std::chrono::duration_cast<steady_clock::duration>(
                                                 std::chrono::duration<double>(seconds));
    const auto busy = [&] {
      return !std::all_of(all.begin(), all.end(), [](const Cutter* c) { return c->at_rest(); });
    };
    const auto wait_until = [&](steady_clock::time_point end) {
      while (busy() && steady_clock::now() < end)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    };
    wait_until(until);
    // Strokes may be longer than anybody waits.
    for (Cutter* cutter : all) cutter->give_up();
    wait_until(until + kGiveUp);
  }

  [[nodiscard]] std::string metrics() const override {
    std::vector<std::pair<std::string, LineFigures::Shown>> all;
    {
      const std::lock_guard lock(mutex_);
      for (const auto& cutter : cutters_)
        all.emplace_back(cutter->device().text, cutter->figures().shown());
    }
    return line_metrics(all);
  }

  [[nodiscard]] bool alive() const override {
    const std::lock_guard lock(mutex_);
    const auto now = steady_clock::now();
    const auto stuck = std::chrono::duration<double>(options_.stuck_s);
    return std::all_of(cutters_.begin(), cutters_.end(),
                       [&](const auto& cutter) { return now - cutter->beat() < stuck; });
  }

 private:
  /// Cutters stay until the end, so the pointer stays valid.
  [[nodiscard]] Result<Cutter*> find(const std::string& id) const {
    const std::lock_guard lock(mutex_);
    for (const auto& cutter : cutters_)
      if (cutter->device().text == id) return cutter.get();
    return fail(ErrorKind::DeviceGone, id, "there is no such device; see the list of devices");
  }

  void add(CutterLine line, bool enabled) {
    auto cutter =
        std::make_unique<Cutter>(std::move(line), enabled, options_.session, [this] { tell(); });
    const std::lock_guard lock(mutex_);
    cutters_.push_back(std::move(cutter));
  }

  Result<void> add_configured(const DeviceConfig& config) {
    if (find(config.id)) return fail(ErrorKind::Usage, config.id, "occurs twice; remove one");
    if (config.id.rfind("usb:", 0) == 0) {
      usb_settings_[config.id] = config;
      return {};
    }
    auto line = configured_line(config, options_.tables);
    if (!line) return tl::unexpected(line.error());
    add(std::move(*line), config.enabled);
    return {};
  }

  [[nodiscard]] bool has_ports() const {
    const std::lock_guard lock(mutex_);
    return std::any_of(cutters_.begin(), cutters_.end(), [](const auto& cutter) {
      return cutter->device().kind != DeviceKind::Simulated;
    });
  }

  /// Under the lock, so that no call is running when `on_change` returns.
  void tell() {
    const std::lock_guard lock(listener_mutex_);
    if (listener_) listener_();
  }

  /// Looks again when the bus says so, and now and then.
  void keep() {
    std::unique_lock lock(mutex_);
    while (!stopping_) {
      wake_.wait_for(lock, kLook, [&] { return stopping_ || look_; });
      if (stopping_) return;
      look_ = false;
      lock.unlock();
      try {
        look_around();
      } catch (const std::exception&) {  // no memory; an exception here would end popcutd
      }
      lock.lock();
    }
  }

  void look_around() {
    std::vector<Cutter*> all;
    {
      const std::lock_guard lock(mutex_);
      for (const auto& cutter : cutters_) all.push_back(cutter.get());
    }
    for (Cutter* cutter : all) look_at_port(*cutter);
    if (bus_) look_at_bus(all);
  }

  static void look_at_port(Cutter& cutter) {
    const DeviceId& device = cutter.device();
    if (device.kind != DeviceKind::Serial && device.kind != DeviceKind::Printer) return;
    const bool there = ::access(device.name.c_str(), F_OK) == 0;
    const bool usable = ::access(device.name.c_str(), R_OK | W_OK) == 0;
    cutter.set_presence(there, there && !usable ? "popcutd has no permission to open " +
                                                      device.name + "; grant it access"
                                                : std::string());
  }

  void look_at_bus(const std::vector<Cutter*>& all) {
    const std::vector<UsbDevice> devices = bus_->devices();
    const auto plugged = [&](const std::string& id) {
      return std::find_if(devices.begin(), devices.end(),
                          [&](const UsbDevice& device) { return device.id == id; });
    };
    for (Cutter* cutter : all) {
      if (cutter->device().kind != DeviceKind::Usb) continue;
      const auto device = plugged(cutter->device().text);
      if (device == devices.end())
        cutter->set_presence(false, "");
      else if (!cutter->busy())  // while it cuts, popcutd itself has it open
        cutter->set_presence(true, hindrance(*device), device->node);
    }
    for (const UsbDevice& device : devices)
      if (!find(device.id)) add_plugged(device);
  }

  static std::string hindrance(const UsbDevice& device) {
    const Result<void> usable = may_be_used(device);
    return usable ? std::string() : usable.error().detail;
  }

  void add_plugged(const UsbDevice& device) {
    const auto settings = usb_settings_.find(device.id);
    const DeviceConfig config = settings == usb_settings_.end() ? DeviceConfig{} : settings->second;
    const std::string& named = config.treat_as.empty() ? config.machine : config.treat_as;
    const auto fits = recognise(device, machines_);
    const Machine* machine = fits.empty() ? nullptr : fits.front();
    for (const Machine& known : machines_)
      if (!named.empty() && known.name == named) machine = &known;
    if (machine == nullptr) return;  // a printer, say
    const auto id = parse_device_id(device.id);
    if (!id) return;
    CutterLine line{*id, *machine, 0, {}, {}, bus_};
    if (!config.treat_as.empty()) line.machine.identity.clear();
    add(std::move(line), config.enabled);
    if (const auto added = find(device.id))
      (*added)->set_presence(true, hindrance(device), device.node);
    tell();
  }

  CuttersOptions options_;
  std::vector<Machine> machines_;
  std::map<std::string, DeviceConfig> usb_settings_;
  std::shared_ptr<UsbBus> bus_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<std::unique_ptr<Cutter>> cutters_;
  bool stopping_{false}, stopped_{false}, look_{false};
  std::mutex listener_mutex_;
  std::function<void()> listener_;
  std::thread keeper_;
};

}  // namespace

Result<std::unique_ptr<Cutters>> make_cutters(CuttersOptions options) {
  auto cutters = std::make_unique<CutterSet>(std::move(options));
  if (auto begun = cutters->begin(); !begun) return tl::unexpected(begun.error());
  return cutters;
}

}  // namespace popcut::daemon
