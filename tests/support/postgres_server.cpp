// SPDX-License-Identifier: MIT
#include "tests/support/postgres_server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <grp.h>
#include <netinet/in.h>
#include <poll.h>
#include <pwd.h>
#include <sys/prctl.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <pqxx/pqxx>

#include "tests/support/process.hpp"

namespace popcut::testing {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kPatience{60};

[[nodiscard]] bool comes_true(const std::function<bool()>& holds,
                              std::chrono::milliseconds patience = kPatience) {
  const auto until = Clock::now() + patience;
  while (!holds()) {
    if (Clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

// ---- Where PostgreSQL is, and whose processes its are

/// The folder of the newest initdb; empty: none.
fs::path find_programs() {
  fs::path newest;
  int version = 0;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator("/usr/lib/postgresql", none)) {
    const int its = std::atoi(entry.path().filename().c_str());
    if (its > version && fs::exists(entry.path() / "bin/initdb", none)) {
      version = its;
      newest = entry.path() / "bin";
    }
  }
  if (!newest.empty()) return newest;
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (fs::exists(fs::path(folder) / "initdb", none) &&
        fs::exists(fs::path(folder) / "postgres", none))
      return folder;
  return {};
}

const fs::path& programs() {
  static const fs::path found = find_programs();
  return found;
}

/// PostgreSQL refuses to run as root.
struct Account {
  uid_t user;
  gid_t group;
  bool other;  ///< than the test's own
};

std::optional<Account> find_account() {
  if (::geteuid() != 0) return Account{::geteuid(), ::getegid(), false};
  const passwd* const nobody = ::getpwnam("nobody");
  if (nobody == nullptr) return {};
  return Account{nobody->pw_uid, nobody->pw_gid, true};
}

const Account& account() {
  static const std::optional<Account> found = find_account();
  if (!found)
    throw std::runtime_error("PostgreSQL does not run as root, and there is no user nobody");
  return *found;
}

/// A new folder that belongs to the account.
fs::path new_folder(const fs::path& where) {
  std::string name = (where / "popcut-postgres-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    throw std::runtime_error("no folder for PostgreSQL in " + where.string());
  if (account().other && ::chown(name.c_str(), account().user, account().group) != 0)
    throw std::runtime_error(name + " cannot be given to the user of PostgreSQL");
  return name;
}

/// In memory if much is free there: a killed process does not harm what it holds.
fs::path place_for(const PostgresOptions& options) {
  if (!options.place.empty()) return options.place;
  const fs::path memory = "/dev/shm";
  struct statvfs space {};
  const bool roomy = ::access(memory.c_str(), W_OK | X_OK) == 0 &&
                     ::statvfs(memory.c_str(), &space) == 0 &&
                     space.f_bavail * space.f_frsize > (std::uint64_t{1} << 30);
  return roomy && !options.disk ? memory : fs::temp_directory_path();
}

// ---- Processes. What runs between fork and exec may be a copy of a program with many threads, so
// it allocates nothing.

/// A program, its arguments, and no more of this process' environment than it needs.
class Command {
 public:
  explicit Command(std::vector<std::string> words, const std::vector<std::string>& more = {})
      : words_(std::move(words)) {
    variables_.insert(variables_.end(), more.begin(), more.end());
    for (std::string& word : words_) arguments_.push_back(word.data());
    for (std::string& one : variables_) environment_.push_back(one.data());
    arguments_.push_back(nullptr);
    environment_.push_back(nullptr);
  }
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;
  /// @param at_death  the signal that it gets when its parent dies
  [[noreturn]] void execute(const Account& as, int at_death = 0) {
    if (as.other &&
        (::setgroups(0, nullptr) != 0 || ::setgid(as.group) != 0 || ::setuid(as.user) != 0))
      ::_exit(126);
    ::prctl(PR_SET_PDEATHSIG, at_death);  // a change of the user takes it back
    ::execve(arguments_[0], arguments_.data(), environment_.data());
    ::_exit(127);
  }
  [[nodiscard]] const std::string& name() const { return words_[0]; }

 private:
  std::vector<std::string> words_;
  std::vector<std::string> variables_{"PATH=/usr/bin:/bin", "LC_ALL=C", "TZ=UTC"};
  std::vector<char*> arguments_, environment_;
};

/// Leaves the child only these: null as its input, `log` as its outputs, and `kept` as number 3.
void take_descriptors(const char* input, const char* log, int kept) {
  const int in = ::open(input, O_RDONLY);
  const int out = ::open(log, O_WRONLY | O_CREAT | O_APPEND, 0600);
  if (in < 0 || out < 0 || ::dup2(in, 0) < 0 || ::dup2(out, 1) < 0 || ::dup2(out, 2) < 0 ||
      (kept >= 0 && ::dup2(kept, 3) < 0))
    ::_exit(126);
  ::close_range(kept >= 0 ? 4 : 3, ~0U, 0);
}

/// Catch2 and sanitizers have handlers, a test may block signals.
void take_default_signals() {
  for (int number = 1; number < 32; ++number) ::signal(number, SIG_DFL);
  ::signal(SIGPIPE, SIG_IGN);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// Runs a program as the account, to its end; throws with what it said if it fails.
void run_as_account(std::vector<std::string> words, const fs::path& log,
                    const fs::path& input = "/dev/null") {
  Command command(std::move(words));
  const Account as = account();
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    take_default_signals();
    take_descriptors(input.c_str(), log.c_str(), -1);
    command.execute(as);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (status != 0)
    throw std::runtime_error(fmt::format("{} fails: {}", command.name(), text_of_file(log)));
}

/// Calls `one` with each child of a process that has one thread.
template <typename Each>
void for_children(pid_t parent, const Each& one) {
  std::array<char, 64> name{};
  char* end = name.data() + name.size() - 1;
  const auto put = [&](const char* text, std::size_t length) {
    end -= length;
    std::copy(text, text + length, end);
  };
  const auto put_number = [&] {
    for (pid_t rest = parent; rest > 0; rest /= 10) *--end = static_cast<char>('0' + rest % 10);
  };
  put("/children", 9);
  put_number();
  put("/task/", 6);
  put_number();
  put("/proc/", 6);
  const int file = ::open(end, O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  std::array<char, 4096> bytes{};
  pid_t child = 0;
  for (ssize_t count; (count = ::read(file, bytes.data(), bytes.size())) > 0;)
    for (ssize_t i = 0; i < count; ++i) {
      const char c = bytes[static_cast<std::size_t>(i)];
      if (c >= '0' && c <= '9') {
        child = 10 * child + (c - '0');
      } else if (child > 0) {
        one(child);
        child = 0;
      }
    }
  ::close(file);
}

void signal_children(pid_t parent, int number) {
  for_children(parent, [number](pid_t child) { ::kill(child, number); });
}

// The warden: a process between test and server. It ends the server when the test tells it or is
// gone, even while it is frozen, and it ends when all processes of the server have. It inherits
// those whose parent, the postmaster, is gone.

constexpr char kQuit = 'q', kKill = 'k';

[[nodiscard]] bool has_ended(pid_t child) {
  siginfo_t about{};
  return ::waitid(P_PID, static_cast<id_t>(child), &about, WEXITED | WNOHANG | WNOWAIT) != 0 ||
         about.si_pid == child;
}

[[nodiscard]] bool ends_within(pid_t process, int milliseconds) {
  const int handle = static_cast<int>(::syscall(SYS_pidfd_open, process, 0));
  if (handle < 0) return true;
  pollfd wait{handle, POLLIN, 0};
  const bool ended = ::poll(&wait, 1, milliseconds) != 0;
  ::close(handle);
  return ended;
}

/// What the test says, or 0: it is gone, or -1: the server has ended before.
int order_or_end(int from_test, pid_t postmaster) {
  const int handle = static_cast<int>(::syscall(SYS_pidfd_open, postmaster, 0));
  std::array<pollfd, 2> wait{{{from_test, POLLIN, 0}, {handle, POLLIN, 0}}};
  while (::poll(wait.data(), 2, -1) < 0 && errno == EINTR) {
  }
  char order = 0;
  if (wait[0].revents == 0) return -1;
  return ::read(from_test, &order, 1) == 1 ? order : 0;
}

[[noreturn]] void guard(Command& server, Command& removal, const Account& as, const char* log,
                        int from_test) {
  ::setsid();  // Ctrl-C is for the test
  take_default_signals();
  take_descriptors("/dev/null", log, from_test);
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  const pid_t warden = ::getpid(), postmaster = ::fork();
  if (postmaster == 0) {
    ::close(3);
    server.execute(as, SIGQUIT);
  }
  if (postmaster < 0 || ::write(3, &postmaster, sizeof postmaster) != sizeof postmaster)
    ::_exit(126);
  const int order = order_or_end(3, postmaster);
  if (order == kKill) ::kill(postmaster, SIGKILL);
  if (order == kQuit || order == 0) {
    ::kill(postmaster, SIGQUIT);  // so that it gives its shared memory back
    ::kill(postmaster, SIGCONT);
    signal_children(postmaster, SIGCONT);
    if (!ends_within(postmaster, 10000)) ::kill(postmaster, SIGKILL);
  }
  ::waitpid(postmaster, nullptr, 0);
  // What it left ends by itself unless it is stopped.
  do {
    signal_children(warden, SIGKILL);
  } while (::waitpid(-1, nullptr, 0) > 0);
  if (order == 0) removal.execute({0, 0, false});
  ::_exit(0);
}

// ---- A new cluster

/// A cluster as initdb makes it, in one file; made once for a version of PostgreSQL.
fs::path packed_cluster() {
  struct stat program {};
  ::stat((programs() / "initdb").c_str(), &program);
  const std::string version =
      fmt::format("{}", std::hash<std::string>{}(fmt::format("{} {} {}", programs().string(),
                                                             program.st_mtime, program.st_size)));
  return fs::temp_directory_path() / fmt::format("popcut-postgres-{}-{}.tar", ::geteuid(), version);
}

[[nodiscard]] bool is_ours(const fs::path& file) {
  struct stat of {};
  return ::lstat(file.c_str(), &of) == 0 && S_ISREG(of.st_mode) && of.st_uid == ::geteuid() &&
         (of.st_mode & 022) == 0;
}

void pack_cluster(const fs::path& packed) {
  const fs::path folder = new_folder(fs::temp_directory_path()), log = folder / "log";
  const std::string data = folder / "data", file = folder / "packed";
  run_as_account({programs() / "initdb", "-D", data, "-E", "UTF8", "--locale=C", "-U", "postgres",
                  "--auth=trust", "--no-sync", "--no-instructions", "--wal-segsize=1"},
                 log);
  run_as_account({"/bin/tar", "-cf", file, "-C", data, "."}, log);
  if ((account().other && ::chown(file.c_str(), ::geteuid(), ::getegid()) != 0) ||
      ::chmod(file.c_str(), 0600) != 0 || ::rename(file.c_str(), packed.c_str()) != 0)
    throw std::runtime_error(packed.string() + " cannot be made; remove it");
  fs::remove_all(folder);
}

void unpack_cluster(const fs::path& folder) {
  const fs::path packed = packed_cluster(), data = folder / "data", log = folder / "log";
  for (bool again : {true, false}) {
    if (!is_ours(packed)) pack_cluster(packed);
    fs::create_directory(data);
    fs::permissions(data, fs::perms::owner_all);
    if (account().other && ::chown(data.c_str(), account().user, account().group) != 0)
      throw std::runtime_error(data.string() + " cannot be given to the user of PostgreSQL");
    try {
      run_as_account({"/bin/tar", "-xf", "-", "-C", data}, log, packed);
      return;
    } catch (const std::runtime_error&) {  // a half file, as after a power cut
      if (!again) throw;
      fs::remove_all(data);
      fs::remove(packed);
    }
  }
}

/// A port that nobody has now.
std::uint16_t free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const plain = reinterpret_cast<sockaddr*>(&address);
  const bool bound = ::bind(socket, plain, size) == 0 && ::getsockname(socket, plain, &size) == 0;
  ::close(socket);
  if (!bound) throw std::runtime_error("no free port on 127.0.0.1");
  return ntohs(address.sin_port);
}

/// For a URL.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.'
               ? std::string(1, c)
               : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return out;
}

/// The letter of /proc/PID/stat; 0: there is none.
char state_of(pid_t process) {
  const std::string text = text_of_file(fmt::format("/proc/{}/stat", process));
  const std::size_t name_end = text.rfind(')');
  return name_end == std::string::npos || name_end + 2 >= text.size() ? '\0' : text[name_end + 2];
}

void stop_process(pid_t process) {
  ::kill(process, SIGSTOP);
  const auto stands = [process] {
    const char state = state_of(process);
    return state == 'T' || state == 'Z' || state == '\0';
  };
  if (!comes_true(stands)) throw std::runtime_error("a process of PostgreSQL does not stop");
}

/// Lines of postmaster.pid: process, folder, start, port, socket, address, shared memory, state.
std::vector<std::string> lines_of(const fs::path& file) {
  std::istringstream text(text_of_file(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

}  // namespace

std::string PostgresServer::why_not() {
  if (programs().empty()) return "no PostgreSQL here, neither in /usr/lib/postgresql nor in PATH";
  if (!find_account()) return "PostgreSQL does not run as root, and there is no user nobody";
  return {};
}

PostgresServer::PostgresServer(PostgresOptions options)
    : options_(std::move(options)), kept_in_(new_folder(place_for(options_))) {
  if (const std::string why = why_not(); !why.empty()) throw std::runtime_error(why);
  unpack_cluster(folder_);
  for (int tries_left = 2;; --tries_left) {
    if (options_.tcp) port_ = free_port();
    try {
      start();
      return;
    } catch (const std::runtime_error&) {
      // Somebody else has taken the port meanwhile.
      if (tries_left == 0 || !says(log(), "Address already in use")) throw;
    }
  }
}

PostgresServer PostgresServer::standby_of(PostgresServer& primary, Commits commits) {
  return {primary, commits};
}

PostgresServer::PostgresServer(PostgresServer& primary, Commits commits)
    : options_(primary.options_), kept_in_(new_folder(place_for(options_))) {
  if (options_.tcp) port_ = free_port();
  const std::string name = "standby_" + folder_.filename().string().substr(16);
  const std::string from = fmt::format("host={} port={} user=postgres application_name={}",
                                       primary.folder_.string(), primary.port_, name);
  run_as_account({programs() / "pg_basebackup", "-D", data(), "-d", from, "-c", "fast", "-X",
                  "stream", "-R", "--no-sync"},
                 folder_ / "log");
  start();
  if (commits == Commits::Synchronous)
    primary.configure("synchronous_standby_names = '\"" + name + "\"'");
  const std::string state = commits == Commits::Synchronous ? "sync" : "async";
  const auto follows = [&] {
    return primary.run_sql(
               "SELECT sync_state FROM pg_stat_replication WHERE state = 'streaming' "
               "AND application_name = '" +
               name + "'") == state;
  };
  if (!comes_true(follows)) throw std::runtime_error("the standby does not follow:\n" + log());
}

PostgresServer PostgresServer::of_another(const fs::path& folder) { return PostgresServer(folder); }

PostgresServer::PostgresServer(const fs::path& folder) : kept_in_(folder, true) {}

PostgresServer::~PostgresServer() { dismiss(kQuit); }

PostgresServer::Removed::~Removed() {
  if (kept) return;
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

std::string PostgresServer::url(const std::string& database, const std::string& user) const {
  return postgres_url(folder_.string(), port_, database, user);
}

std::string PostgresServer::tcp_url(const std::string& database, const std::string& user,
                                    const std::string& password) const {
  if (!options_.tcp) throw std::runtime_error("the server was not asked for tcp");
  return postgres_url("127.0.0.1", port_, database, user, password);
}

std::string PostgresServer::socket() const { return folder_ / fmt::format(".s.PGSQL.{}", port_); }

std::string PostgresServer::log() const { return text_of_file(folder_ / "log"); }

std::string PostgresServer::create_database(const std::string& name) {
  run_sql(fmt::format("CREATE DATABASE \"{}\" TEMPLATE template0", name));
  return url(name);
}

std::string PostgresServer::run_sql(const std::string& sql, const std::string& database) const {
  return testing::run_sql(url(database), sql);
}

std::string PostgresServer::dump(const std::string& database) const {
  const fs::path file = folder_ / "dump", log = folder_ / "dump.log";
  run_as_account({programs() / "pg_dump", "--format=custom", "--file", file, url(database)}, log);
  return text_of_file(file);
}

void PostgresServer::restore(const std::string& database, const std::string& dump) {
  const fs::path file = folder_ / "dump", log = folder_ / "dump.log";
  write_file(file, dump);
  run_sql(fmt::format("DROP DATABASE IF EXISTS \"{}\" WITH (FORCE)", database));
  create_database(database);
  run_as_account({programs() / "pg_restore", "--dbname", url(database), file}, log);
}

// The postmaster tells its children when it has read the file itself, before it takes the next
// client. The checkpointer, which tells those that commit whether to wait for a standby, has read
// it when it has made a checkpoint.
void PostgresServer::configure(const std::string& line) {
  lines_.push_back(line);
  write_configuration();
  if (!running()) return;
  const std::string before = run_sql("SELECT pg_conf_load_time()");
  ::kill(postmaster_, SIGHUP);
  if (!comes_true([&] { return run_sql("SELECT pg_conf_load_time()") != before; }))
    throw std::runtime_error("PostgreSQL does not read its configuration:\n" + log());
  run_sql("CHECKPOINT");
}

void PostgresServer::write_configuration() const {
  const char* const synced = options_.fsync ? "on" : "off";
  std::string text = options_.more + fmt::format(R"(
listen_addresses = '{}'
port = {}
unix_socket_directories = '{}'
fsync = {}
full_page_writes = {}
)",
                                                 options_.tcp ? "127.0.0.1" : "", port_,
                                                 folder_.string(), synced, synced);
  for (const std::string& line : lines_) text += line + "\n";
  // A file that is there at once with all of its text, since the server may be reading it.
  write_file(folder_ / "configuration.new", R"(shared_buffers = 16MB
max_connections = 200
dynamic_shared_memory_type = mmap
min_wal_size = 4MB
max_wal_size = 64MB
wal_keep_size = 64MB
wal_retrieve_retry_interval = 100ms
max_logical_replication_workers = 0
autovacuum = off
jit = off
log_checkpoints = off
timezone = 'UTC'
log_timezone = 'UTC'
)" + text);
  write_file(folder_ / "access",
             "local all all trust\nlocal replication all trust\nhost all all 127.0.0.1/32 "
             "scram-sha-256\n");
  for (const char* name : {"configuration.new", "access"})
    fs::permissions(folder_ / name, fs::perms{0644});
  fs::rename(folder_ / "configuration.new", folder_ / "configuration");
}

void PostgresServer::start() {
  if (running()) throw std::runtime_error("PostgreSQL runs already");
  write_configuration();
  launch();
  if (comes_true([this] { return ready() || has_ended(warden_); }) && ready()) return;
  dismiss(kKill);
  throw std::runtime_error("PostgreSQL does not start:\n" + log());
}

void PostgresServer::launch() {
  Command server({programs() / "postgres", "-D", data(), "-c",
                  "config_file=" + (folder_ / "configuration").string(), "-c",
                  "hba_file=" + (folder_ / "access").string()},
                 options_.environment);
  Command removal({"/bin/rm", "-rf", folder_});
  const std::string log = folder_ / "log";
  const Account as = account();
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw std::runtime_error("no sockets");
  warden_ = ::fork();
  if (warden_ == 0) guard(server, removal, as, log.c_str(), ends[1]);
  ::close(ends[1]);
  to_warden_ = ends[0];
  if (warden_ < 0 || ::read(to_warden_, &postmaster_, sizeof postmaster_) != sizeof postmaster_)
    throw std::runtime_error("PostgreSQL cannot be started");
}

bool PostgresServer::ready() const {
  const std::vector<std::string> lines = lines_of(data() / "postmaster.pid");
  return lines.size() >= 8 && lines[0] == std::to_string(postmaster_) &&
         lines[7].substr(0, 5) == "ready";
}

void PostgresServer::stop(Stop how) {
  if (!running()) return;
  thaw();
  ::kill(postmaster_, how == Stop::Smart ? SIGTERM : how == Stop::Fast ? SIGINT : SIGQUIT);
  const bool ended = comes_true([this] { return has_ended(warden_); });
  if (!ended) kill();
  join();
  if (!ended) throw std::runtime_error("PostgreSQL does not stop:\n" + log());
}

void PostgresServer::kill() { dismiss(kKill); }

void PostgresServer::dismiss(char how) {
  if (!running()) return;
  const ssize_t told = ::send(to_warden_, &how, 1, MSG_NOSIGNAL);  // none: it has ended already
  static_cast<void>(told);
  join();
  // A killed server cannot give this back; one that starts again would.
  const std::vector<std::string> lines = lines_of(data() / "postmaster.pid");
  if (lines.size() < 7) return;
  std::istringstream memory(lines[6]);
  unsigned long key = 0;
  int id = 0;
  if (memory >> key >> id) ::shmctl(id, IPC_RMID, nullptr);
}

void PostgresServer::join() {
  if (!running()) return;
  ::waitpid(warden_, nullptr, 0);
  ::close(to_warden_);
  warden_ = postmaster_ = to_warden_ = -1;
  frozen_ = false;
}

// The postmaster comes first, so that it does not make new children meanwhile.
void PostgresServer::freeze() {
  if (!running()) return;
  stop_process(postmaster_);
  for_children(postmaster_, stop_process);
  frozen_ = true;
}

void PostgresServer::thaw() {
  if (!running() || !frozen_) return;
  signal_children(postmaster_, SIGCONT);
  ::kill(postmaster_, SIGCONT);
  frozen_ = false;
}

void PostgresServer::stop_following() {
  run_sql("ALTER SYSTEM SET primary_conninfo = ''");
  run_sql("SELECT pg_reload_conf()");
  const auto stands = [&] { return run_sql("SELECT count(*) FROM pg_stat_wal_receiver") == "0"; };
  if (!comes_true(stands)) throw std::runtime_error("the standby still follows:\n" + log());
}

void PostgresServer::promote() {
  if (run_sql("SELECT pg_promote(true, 60)") != "t")
    throw std::runtime_error("the standby is not promoted:\n" + log());
}

namespace {

/// The server that CTest started; empty: there is none, or it is gone.
fs::path folder_of_all() {
  const char* const file = std::getenv("POPCUT_TEST_POSTGRES");
  if (file == nullptr) return {};
  std::ifstream in(file);
  std::string folder;
  std::getline(in, folder);
  try {
    if (!folder.empty()) run_sql(postgres_url(folder, 5432, "postgres", "postgres"), "SELECT 1");
    return folder;
  } catch (const pqxx::broken_connection&) {
    return {};
  }
}

}  // namespace

PostgresServer& shared_postgres() {
  static PostgresServer server = [] {
    const fs::path folder = folder_of_all();
    return folder.empty() ? PostgresServer() : PostgresServer::of_another(folder);
  }();
  return server;
}

// The lock is of the database `postgres`, which all take for this.
void add_node_role(const PostgresServer& server, const std::string& login,
                   const std::string& password) {
  server.run_sql(
      fmt::format("SELECT pg_advisory_xact_lock(5432); "
                  "DO $$ BEGIN IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname='{0}') THEN "
                  "CREATE ROLE {0} LOGIN {1}; GRANT popcut_node TO {0}; END IF; END $$",
                  login, password.empty() ? "" : "PASSWORD '" + password + "'"));
}

FreshDatabase::FreshDatabase(PostgresServer& server) : server_(server) {
  static int count = 0;
  name_ = fmt::format("fresh_{}_{}", ::getpid(), ++count);
  server_.create_database(name_);
}

FreshDatabase::~FreshDatabase() {
  try {
    server_.run_sql(fmt::format("DROP DATABASE \"{}\" WITH (FORCE)", name_));
  } catch (const std::exception&) {  // the server is gone, and the database with it
  }
}

std::string postgres_url(const std::string& host, std::uint16_t port, const std::string& database,
                         const std::string& user, const std::string& password) {
  return fmt::format("postgresql://{}{}@/{}?host={}&port={}&sslmode=disable&gssencmode=disable",
                     escaped(user), password.empty() ? "" : ":" + escaped(password),
                     escaped(database), escaped(host), port);
}

std::string run_sql(const std::string& url, const std::string& sql) {
  pqxx::connection connection(url);
  pqxx::nontransaction work(connection);
  const pqxx::result rows = work.exec(sql);
  std::vector<std::string> lines;
  for (const auto& row : rows) {
    std::vector<std::string> fields;
    for (const auto& field : row) fields.emplace_back(field.c_str());
    lines.push_back(fmt::format("{}", fmt::join(fields, "|")));
  }
  return fmt::format("{}", fmt::join(lines, "\n"));
}

}  // namespace popcut::testing
