// SPDX-License-Identifier: MIT
#include "daemon/popcutd/serve.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/result.hpp"
#include "daemon/config/config.hpp"
#include "daemon/devices/make_cutters.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/files/user_tables.hpp"
#include "daemon/fleet/fleet_files.hpp"
#include "daemon/fleet/fleet_schema.hpp"
#include "daemon/fleet/postgres_database.hpp"
#include "daemon/http/server.hpp"
#include "daemon/planning/planner.hpp"
#include "daemon/planning/program_file.hpp"
#include "daemon/planning/worker/confinement.hpp"
#include "daemon/popcutd/log.hpp"
#include "daemon/popcutd/pulse.hpp"
#include "daemon/popcutd/resources.hpp"
#include "daemon/popcutd/turn_away.hpp"
#include "daemon/popcutd/webhook.hpp"
#include "daemon/previews/previewer.hpp"
#include "daemon/service/live/live_service.hpp"
#include "daemon/service/service_store.hpp"
#include "daemon/store/state_folder.hpp"
#include "protocol/encode.hpp"

namespace popcut::daemon {
namespace {

// The program of a sheet (from 1) as it was stored with the plan in `folder`: its bytes and the
// index over them.
//
// @retval Malformed, OutOfRange, CheckFailed  a file is absent, or not what was written
Result<StoredProgram> stored_program(const std::string& folder, int sheet) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
  const std::string stem = fmt::format("{}/sheet-{:02}", folder, sheet);
  const auto index = read_whole(folder + "/" + index_name(sheet), kMostBytes);
  if (!index) return tl::unexpected(index.error());
  std::error_code ignored;
  const bool hpgl = std::filesystem::exists(stem + ".hpgl", ignored);
  auto bytes = read_whole(stem + (hpgl ? ".hpgl" : ".gpgl"), kMostBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<EncodedProgram> program = planning::read_program(*index, std::move(*bytes));
  if (!program) return tl::unexpected(program.error());
  return StoredProgram{std::move(*program), sha256_hex(*index)};
}

std::string device_text(const DeviceConfig& device) {
  if (!device.enabled) return device.id + " (disabled)";
  if (device.id.rfind("sim:", 0) != 0) return device.id;
  return device.time_scale > 0
             ? fmt::format("{} ({:g} times as fast as the machine)", device.id, device.time_scale)
             : device.id + " (at once)";
}

// What popcutd prints at a terminal when it is ready: addresses, cutters, and what to type
// next.
std::string greeting(const Config& config, const std::vector<std::string>& endpoints) {
  std::string text = fmt::format("popcutd {} is ready at", POPCUT_VERSION);
  for (const std::string& one : endpoints) {
    const bool path = one.rfind("unix:", 0) == 0;
    text += path ? "\n  " + one.substr(5) : "\n  http://" + one;
  }
  text += "\nCutters";
  for (const DeviceConfig& device : config.devices) text += "\n  " + device_text(device);
  text += fmt::format("\nJobs are stored in {}\n", config.state);
  text +=
      "\nNext, in another terminal:\n  popcut cut sphere.json --wait     # queue it; it tells you "
      "when to act\n  popcut arm; popcut start          # after you have loaded the sheet: cut "
      "it\n  popcut jobs --watch               # follow all jobs\nPress Ctrl-C to stop popcutd; a "
      "running cut stops at the end of its stroke.\n\n";
  return text;
}

using Clock = std::chrono::steady_clock;

constexpr const char* kWorkerProgram = "/proc/self/exe";
constexpr int kNeedsPerson = 78;
constexpr double kStopSeconds = 30;   // within the unit's TimeoutStopSec
constexpr double kStuckSeconds = 10;  // a thread that has not turned for so long is stuck
constexpr double kQuickSeconds =
    2;  // however soon the watchdog wants to know; threads idle for 1 s
constexpr double kLookSeconds = 0.5;

/// Why it does not start, or no more runs.
struct StartFailure {
  int code{};
  std::string text;
};

double since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

int code_of(const Error& error) {
  switch (error.kind) {
    case ErrorKind::Refused:
    case ErrorKind::Unwritable:
    case ErrorKind::Internal:
      return exit_code(error.kind);
    default:
      return kNeedsPerson;
  }
}

std::map<std::string, std::vector<std::string>> materials_of(const Config& config) {
  std::map<std::string, std::vector<std::string>> materials;
  for (const DeviceConfig& device : config.devices)
    if (!device.materials.empty()) materials[device.id] = device.materials;
  return materials;
}

LocalUsers users_of(const Config& config) {
  LocalUsers users;
  for (const UserRule& rule : config.users.empty() ? default_users() : config.users) {
    if (rule.uid) users.users[*rule.uid] = rule.role;
    if (rule.gid) users.groups[*rule.gid] = rule.role;
  }
  return users;
}

/// All parts, in the order in which they need each other.
class Daemon {
 public:
  Daemon(Config config, std::shared_ptr<spdlog::logger> log)
      : config_(std::move(config)), log_(std::move(log)) {}
  ~Daemon() { stop(); }
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  [[nodiscard]] std::optional<StartFailure> start(const ServiceManager& manager);
  void stop();
  void beat() { pulse_.ask(*thread_, *service_); }
  [[nodiscard]] bool alive() const {
    return pulse_.alive(stuck_s_) && http_->alive(stuck_s_) && cutters_->alive();
  }
  [[nodiscard]] std::string status() const { return pulse_.status(); }
  /// What the check of the database found wrong while it was served; empty: nothing so far.
  [[nodiscard]] std::string damage() const {
    const std::lock_guard hold(damage_lock_);
    return damage_;
  }
  [[nodiscard]] std::vector<std::string> endpoints() const { return http_->endpoints(); }
  /// Takes of `wanted` what may change while it runs; nothing of it touches a cut.
  ///
  /// @retval as `webhook_target`  nothing is taken then
  [[nodiscard]] Result<void> retune(const Config& wanted);

 private:
  [[nodiscard]] std::optional<StartFailure> open_state();
  [[nodiscard]] std::optional<StartFailure> open_fleet();
  void begin_listening();
  [[nodiscard]] std::optional<StartFailure> open_devices();
  [[nodiscard]] std::optional<StartFailure> open_service();
  void check_database();
  void log_changes();
  [[nodiscard]] std::optional<StartFailure> open_webhook();
  void begin_webhook(WebhookTarget target);
  void end_webhook();
  [[nodiscard]] std::optional<StartFailure> open_http(const ServiceManager& manager);
  Config config_;
  std::shared_ptr<spdlog::logger> log_;
  std::vector<std::string> tables_{};
  PostgresDatabase::Options fleet_{};
  PostgresDatabase* shared_{};  ///< of the store
  std::unique_ptr<Store> store_{};
  std::unique_ptr<ServiceThread> thread_{};
  std::unique_ptr<Planner> planner_{};
  std::shared_ptr<Previewer> previewer_{};
  std::shared_future<std::vector<WorkerWall>> worker_walls_{};
  std::unique_ptr<Cutters> cutters_{};
  std::unique_ptr<LiveService> service_{};
  std::unique_ptr<Webhook> webhook_{};
  std::unique_ptr<HttpServer> http_{};
  std::thread checker_{};
  std::jthread ear_{};
  mutable std::mutex damage_lock_{};
  std::string damage_{};
  Pulse pulse_{};
  double stuck_s_{kStuckSeconds};
};

std::optional<StartFailure> Daemon::start(const ServiceManager& manager) {
  // Half of what the watchdog grants, so that it is not fed in vain.
  if (const auto watchdog = manager.watchdog_s())
    stuck_s_ = std::clamp(*watchdog / 2, kQuickSeconds, kStuckSeconds);
  auto tables = cli::read_user_tables();
  if (!tables) return StartFailure{kNeedsPerson, message(tables.error())};
  tables_ = std::move(tables->texts);
  manager.tell("EXTEND_TIMEOUT_USEC=120000000\nSTATUS=opening the database");
  if (auto failure = open_state()) return failure;
  if (auto failure = open_devices()) return failure;
  if (auto failure = open_service()) return failure;
  begin_listening();
  check_database();
  log_changes();
  if (auto failure = open_webhook()) return failure;
  return open_http(manager);
}

std::optional<StartFailure> Daemon::open_state() {
  if (!config_.fleet.database.empty()) return open_fleet();
  StoreOptions options;
  options.folder = config_.state;
  options.check_later = true;
  auto store = Store::open(std::move(options));
  if (!store) return StartFailure{code_of(store.error()), message(store.error())};
  store_ = std::move(*store);
  return std::nullopt;
}

std::string machine_name() {
  std::array<char, 65> name{};
  (void)gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::optional<StartFailure> Daemon::open_fleet() {
  if (config_.fleet.node.empty()) config_.fleet.node = machine_name();
  fleet_.url = config_.fleet.database;
  fleet_.name = "popcutd " + config_.fleet.node;
  if (!config_.fleet.password_file.empty()) {
    auto secret = read_whole(config_.fleet.password_file, 4096);
    if (!secret)
      return StartFailure{kNeedsPerson, "fleet.password_file: " + message(secret.error())};
    fleet_.password = secret->substr(0, secret->find('\n'));
  }
  std::unique_ptr<PostgresDatabase> database;
  try {
    database = std::make_unique<PostgresDatabase>(fleet_, false);
    if (database->is_refused())
      return StartFailure{kNeedsPerson,
                          fmt::format("fleet.database: {}; 'popcut doctor' says what is wrong",
                                      database->why_away())};
    if (database->is_there()) {
      if (const std::string misfit = schema_misfit(*database); !misfit.empty())
        return StartFailure{kNeedsPerson, "fleet.database: " + misfit};
    } else {
      log_->warn("the fleet's database does not answer; serving what is local until it does: {}",
                 database->why_away());
    }
  } catch (const StoreFault& fault) {
    return StartFailure{kNeedsPerson, fmt::format("fleet.database: {}", fault.what())};
  }
  shared_ = database.get();
  StoreOptions options;
  options.folder = config_.state;
  auto store = Store::over(std::move(options), std::move(database));
  if (!store) return StartFailure{code_of(store.error()), message(store.error())};
  store_ = std::move(*store);
  store_->share_files(make_fleet_files(store_->database(), store_->folder(), fleet_));
  return std::nullopt;
}

/// What other nodes tell wakes this one; without it, it looks once a second.
void Daemon::begin_listening() {
  if (fleet_.url.empty()) return;
  ear_ = std::jthread([this](const std::stop_token& stop) {
    constexpr double kListenSeconds = 0.5;
    PostgresDatabase database(fleet_, false);
    bool was_there = false;
    // All events that are there are heard in one turn: over a slow network turns would pile up.
    const auto is_called = std::make_shared<std::atomic<bool>>(false);
    while (!stop.stop_requested()) {
      const bool is_there =
          database.listen("popcut", kListenSeconds, [this, is_called](const std::string& news) {
            if (news == config_.fleet.node) return;
            const bool is_event = news != kAccessChanged;
            if (is_event && is_called->exchange(true)) return;
            thread_->post(ServiceThread::Lane::Asking, [this, news, is_event, is_called] {
              if (is_event) is_called->store(false);
              service_->on_fleet_notice(news);
            });
          });
      // What was said meanwhile was not heard.
      if (is_there && !was_there)
        thread_->post(ServiceThread::Lane::Asking, [this] {
          service_->on_fleet_notice(kAccessChanged);
          service_->on_fleet_notice("");
        });
      was_there = is_there;
      if (!is_there) std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
  });
}

/// Tries on this machine how workers are confined, and logs it. The start does not wait for it.
std::vector<WorkerWall> tell_confinement(const std::shared_ptr<spdlog::logger>& log) {
  const auto walls = planning::try_confinement(kWorkerProgram);
  if (!walls) {
    log->warn("how workers are confined is not known: {}", message(walls.error()));
    return {};
  }
  const bool listed = std::any_of(walls->begin(), walls->end(), [](const WorkerWall& wall) {
    return wall.name == "seccomp" && wall.holds();
  });
  log->log(listed ? spdlog::level::info : spdlog::level::warn, "{}",
           planning::confinement_text(*walls));
  return *walls;
}

std::optional<StartFailure> Daemon::open_devices() {
  PlanningLimits limits;
  limits.processes = config_.planner.processes;
  limits.cpu_s = config_.planner.cpu_s;
  limits.wall_s = config_.planner.wall_s;
  limits.memory_bytes = config_.planner.memory_bytes;
  limits.output_bytes = config_.planner.output_bytes;
  limits.check_s = config_.planner.check_s;
  limits.together = memory_for_workers(config_.planner.together_bytes);
  limits.report = [log = log_](const std::string& line) { log->warn(line); };
  planner_ = make_planner(limits, kWorkerProgram);
  PreviewLimits shown;
  shown.slow.cpu_s = std::min(shown.slow.cpu_s, limits.cpu_s);
  shown.slow.wall_s = std::min(shown.slow.wall_s, limits.wall_s);
  shown.slow.memory_bytes = limits.memory_bytes;
  shown.slow.output_bytes = std::min(shown.slow.output_bytes, limits.output_bytes);
  shown.quick.memory_bytes = std::min(shown.quick.memory_bytes, limits.memory_bytes);
  for (PlanningLimits* const some : {&shown.quick, &shown.slow})
    some->together = limits.together, some->report = limits.report;
  previewer_ = make_previewer(shown, kWorkerProgram);
  worker_walls_ = std::async(std::launch::async, tell_confinement, log_);
  CuttersOptions options;
  options.tables = tables_;
  options.devices = config_.devices;
  options.stuck_s = stuck_s_;
  auto cutters = make_cutters(std::move(options));
  if (!cutters) return StartFailure{exit_code(cutters.error().kind), message(cutters.error())};
  cutters_ = std::move(*cutters);
  return std::nullopt;
}

/// Where people at other machines reach its page, as far as the configuration tells.
std::string reached_at(const Config& config) {
  for (const std::string& text : config.listen) {
    const Result<ListenAddress> address = parse_listen(text, true);
    if (address && address->port != 0 && !parse_listen(text, false)) return "http://" + text;
  }
  return {};
}

std::optional<StartFailure> Daemon::open_service() {
  thread_ =
      std::make_unique<ServiceThread>([log = log_](const std::string& line) { log->error(line); });
  ServiceOptions options;
  options.queue_jobs = config_.queue_jobs;
  options.jobs_each = config_.jobs_each;
  options.plans_each = config_.plans_each;
  options.sheets_per_job = config_.sheets_per_job;
  options.plans_at_once = config_.planner.processes;
  options.device_materials = materials_of(config_);
  options.users = users_of(config_);
  options.tables = tables_;
  options.read_program = stored_program;
  options.previewer = previewer_;
  options.fleet.node = config_.fleet.node;
  options.fleet.url = config_.fleet.url;
  options.fleet.site = config_.fleet.site;
  options.fleet.version = POPCUT_VERSION;
  options.fleet.lease_s = config_.fleet.lease_s;
  options.fleet.beat_s = config_.fleet.beat_s;
  if (options.fleet.url.empty()) options.fleet.url = reached_at(config_);
  options.log = [log = log_](const std::string& line) { log->info(line); };
  auto service = make_service(*store_, *thread_, *planner_, *cutters_, std::move(options));
  if (!service) return StartFailure{code_of(service.error()), message(service.error())};
  service_ = std::move(*service);
  return std::nullopt;
}

/// After a kill all pages of the database are checked, beside what is served meanwhile. Damage ends
/// popcutd: nothing was armed yet.
void Daemon::check_database() {
  if (store_->checked()) return;
  checker_ = std::thread([this] {
    std::optional<std::string> damage = store_->damage_of_copy();
    try {
      if (!damage)
        thread_->run(ServiceThread::Lane::Asking, [&] { damage = store_->damage_in_place(); });
    } catch (const StoreFault& fault) {
      damage = fmt::format("cannot be read: {}", fault.what());
    }
    if (!damage) return;  // popcutd is stopping
    std::string text;
    if (!damage->empty()) {
      store_->mark_suspect();
      text = store_->set_aside_as(*damage);
      const std::lock_guard hold(damage_lock_);
      damage_ = text;
    }
    thread_->post(ServiceThread::Lane::Asking, [this, text] { service_->check_ended(text); });
  });
}

/// What becomes of each job, with its id.
void Daemon::log_changes() {
  thread_->run(ServiceThread::Lane::Asking, [this] {
    service_->operations.listen([log = log_](const Event& event) {
      if (const std::string line = change_line(event); !line.empty()) log->info(line);
    });
  });
}

std::optional<StartFailure> Daemon::open_webhook() {
  // Always, since one may come with SIGHUP.
  thread_->run(ServiceThread::Lane::Asking, [this] {
    service_->operations.listen([this](const Event& event) {
      if (event.seq > 0 && webhook_) webhook_->wake();
    });
  });
  if (config_.webhook.url.empty()) return std::nullopt;
  auto target = webhook_target(config_.webhook);
  if (!target) return StartFailure{kNeedsPerson, message(target.error())};
  begin_webhook(std::move(*target));
  return std::nullopt;
}

void Daemon::begin_webhook(WebhookTarget target) {
  Webhook::Source source;
  source.events = [this](std::int64_t after, int most) {
    std::vector<Event> events;
    try {
      thread_->run(ServiceThread::Lane::Asking, [&] {
        if (auto found = service_->operations.events(after, most, "")) events = std::move(*found);
      });
    } catch (const std::exception&) {  // no memory; it asks again
    }
    return events;
  };
  source.last_event = [this] {
    std::optional<std::int64_t> last;
    try {
      thread_->run(ServiceThread::Lane::Asking, [&] { last = service_->operations.last_event(); });
    } catch (const std::exception&) {  // the database does not answer; it asks again
    }
    return last;
  };
  source.log = [log = log_](const std::string& line) { log->warn(line); };
  auto webhook = std::make_unique<Webhook>(std::move(target), store_->folder().at("webhook"),
                                           std::move(source));
  thread_->run(ServiceThread::Lane::Asking, [&] { webhook_ = std::move(webhook); });
}

void Daemon::end_webhook() {
  std::unique_ptr<Webhook> webhook;
  if (thread_)  // on whose thread it is woken
    thread_->run(ServiceThread::Lane::Asking, [&] { webhook = std::move(webhook_); });
}

Result<void> Daemon::retune(const Config& wanted) {
  // The secret may have changed in its file, so a webhook is always started again.
  std::optional<WebhookTarget> target;
  if (!wanted.webhook.url.empty()) {
    auto found = webhook_target(wanted.webhook);
    if (!found) return tl::unexpected(found.error());
    target = std::move(*found);
  }
  http_->retune({wanted.allowed_hosts, wanted.allowed_origins, users_of(wanted), wanted.limits});
  thread_->run(ServiceThread::Lane::Asking, [&] {
    service_->retune({.queue_jobs = wanted.queue_jobs,
                      .jobs_each = wanted.jobs_each,
                      .plans_each = wanted.plans_each,
                      .sheets_per_job = wanted.sheets_per_job,
                      .device_materials = materials_of(wanted),
                      .users = users_of(wanted)});
  });
  end_webhook();
  if (target) begin_webhook(std::move(*target));
  if (const std::string few = allow_descriptors(wanted.limits); !few.empty()) log_->warn("{}", few);
  return {};
}

std::optional<StartFailure> Daemon::open_http(const ServiceManager& manager) {
  HttpOptions options;
  options.inherited = manager.sockets();
  if (options.inherited.empty()) {
    for (const std::string& address : config_.listen)
      options.listen.push_back({address, !config_.listen_given && address.front() == '['});
    if (!config_.socket.empty()) options.listen.push_back({"unix:" + config_.socket, false});
  }
  options.allow_remote = config_.allow_remote;
  options.hosts = config_.allowed_hosts;
  options.origins = config_.allowed_origins;
  options.users = users_of(config_);
  if (!config_.fleet.database.empty()) options.machine = "@" + config_.fleet.node;
  options.limits = config_.limits;
  options.incoming_folder = store_->folder().at("incoming");
  options.build = POPCUT_VERSION;
  options.worker_walls = [walls = worker_walls_] {
    const bool known = walls.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    return known ? walls.get() : std::vector<WorkerWall>();
  };
  options.service = service_.get();
  options.on_service = [this](std::function<void()> work) {
    return thread_->post(ServiceThread::Lane::Asking, std::move(work));
  };
  options.on_service_urgent = [this](std::function<void()> work) {
    return thread_->post(ServiceThread::Lane::Urgent, std::move(work));
  };
  if (shared_ != nullptr) options.on_knife = [this] { shared_->hurry(); };
  options.log = log_;
  http_ = std::make_unique<HttpServer>(std::move(options));
  if (auto started = http_->start(); !started)
    return StartFailure{exit_code(ErrorKind::Refused), message(started.error())};
  return std::nullopt;
}

void Daemon::stop() {
  if (service_) thread_->run(ServiceThread::Lane::Cutting, [this] { service_->stopping(); });
  if (cutters_) cutters_->stop_all(kStopSeconds);
  ear_ = {};  // asks it to stop, and waits
  if (service_) thread_->run(ServiceThread::Lane::Cutting, [this] { service_->leave_fleet(); });
  if (http_) http_->stop();
  end_webhook();
  planner_.reset();
  if (previewer_) previewer_->stop();
  if (thread_) thread_->stop();
  if (checker_.joinable()) checker_.join();
  http_.reset();
  service_.reset();
  cutters_.reset();  // one that is stuck may still want to write down how its cut ended
  thread_.reset();
  store_.reset();
}

/// Signals come to who waits for them, and to no other thread.
class Signals {
 public:
  Signals() {
    sigemptyset(&set_);
    for (const int one : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set_, one);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }
  /// The signal that came within `seconds`, or 0.
  [[nodiscard]] int wait(double seconds) const {
    timespec time{};
    time.tv_sec = static_cast<time_t>(seconds);
    time.tv_nsec = static_cast<long>((seconds - static_cast<double>(time.tv_sec)) * 1e9);
    const int got = sigtimedwait(&set_, nullptr, &time);
    return got > 0 ? got : 0;
  }

 private:
  sigset_t set_{};
};

void reload(Daemon& daemon, const DaemonOptions& options, const Config& running,
            const ServiceManager& manager, spdlog::logger& log) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  manager.tell(
      fmt::format("RELOADING=1\nMONOTONIC_USEC={}", now.tv_sec * 1'000'000 + now.tv_nsec / 1000));
  std::string file;
  const auto config = load_config(options, file);
  const Result<void> taken =
      config ? daemon.retune(*config) : Result<void>(tl::unexpected(config.error()));
  if (!taken) {
    log.error("the configuration was not loaded; nothing has changed: {}", message(taken.error()));
  } else {
    set_level(log, config->log.level);
    if (const auto later = restart_keys(running, *config); !later.empty())
      log.warn("changed, but used only after a restart: {}", fmt::join(later, ", "));
    log.info("configuration reloaded: {}", kReloadedKeys);
  }
  manager.tell("READY=1");
}

/// The program on the disk is another one now: an upgrade waits for a restart.
bool replaced() {
  constexpr std::string_view kGone = " (deleted)";
  std::array<char, 4096> link{};
  const ssize_t size = readlink("/proc/self/exe", link.data(), link.size());
  return size > 0 && std::string_view(link.data(), static_cast<std::size_t>(size)).ends_with(kGone);
}

/// Until somebody ends it.
void watch(Daemon& daemon, const Config& config, const DaemonOptions& options,
           const ServiceManager& manager, const Signals& signals, spdlog::logger& log) {
  const double watchdog = manager.watchdog_s().value_or(0);
  const double step = watchdog > 0 ? std::min(kLookSeconds, watchdog / 4) : kLookSeconds;
  auto fed = Clock::now();
  std::string shown;
  bool well = true;
  for (;;) {
    const int signal = signals.wait(step);
    if (signal == SIGHUP) reload(daemon, options, config, manager, log);
    if (signal == SIGINT || signal == SIGTERM || !daemon.damage().empty()) return;
    daemon.beat();
    const bool alive = daemon.alive();
    if (alive != well)
      log.error("{}", alive ? "all threads are responding again" : "a thread is not responding");
    well = alive;
    if (alive && watchdog > 0 && since(fed) > watchdog / 3) {
      manager.tell("WATCHDOG=1");
      fed = Clock::now();
    }
    std::string status = daemon.status();
    if (!status.empty() && replaced()) status += "; restart popcutd to use the new version";
    if (status != shown && !status.empty()) manager.tell_status(shown = status);
  }
}

}  // namespace

int serve(const Config& config, const DaemonOptions& options, const ServiceManager& manager,
          const std::shared_ptr<spdlog::logger>& log) {
  const Signals signals;
  if (const std::string few = allow_descriptors(config.limits); !few.empty()) log->warn("{}", few);
  Daemon daemon(config, log);
  if (const auto failure = daemon.start(manager)) {
    std::fprintf(stderr, "popcutd: %s\n", without_control(failure->text).c_str());
    manager.tell_status(failure->text);
    if (failure->code == kNeedsPerson) turn_away(manager.sockets(), failure->text);
    return failure->code;
  }
  if (isatty(STDERR_FILENO) == 1) fmt::print(stderr, "{}", greeting(config, daemon.endpoints()));
  log->info("serving at {}", fmt::join(daemon.endpoints(), ", "));
  manager.tell("READY=1\nSTATUS=serving");
  give_back_start();
  watch(daemon, config, options, manager, signals, *log);
  log->info("stopping; cuts stop at the end of their stroke");
  manager.tell(fmt::format("STOPPING=1\nEXTEND_TIMEOUT_USEC={:.0f}", (kStopSeconds + 10) * 1e6));
  daemon.stop();
  if (const std::string damage = daemon.damage(); !damage.empty()) {
    std::fprintf(stderr, "popcutd: %s\n", without_control(damage).c_str());
    manager.tell_status(damage);
    return kNeedsPerson;
  }
  log->info("stopped");
  return 0;
}

}  // namespace popcut::daemon
