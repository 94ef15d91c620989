// SPDX-License-Identifier: MIT
#include "daemon/fleet/fleet_files.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "daemon/digest/digest.hpp"

namespace popcut::daemon {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPartBytes = 512u << 10;
constexpr std::int64_t kSmallBytes = 2 << 20;  // fetched in a few milliseconds

std::string hex_of(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(bytes.size() * 2);
  for (const char byte : bytes) {
    text += kDigits[static_cast<unsigned char>(byte) >> 4];
    text += kDigits[static_cast<unsigned char>(byte) & 15];
  }
  return text;
}

std::string bytes_of(std::string_view hex) {
  const auto value = [](char digit) { return digit <= '9' ? digit - '0' : digit - 'a' + 10; };
  std::string bytes;
  bytes.reserve(hex.size() / 2);
  for (std::size_t at = 0; at + 1 < hex.size(); at += 2)
    bytes += static_cast<char>(value(hex[at]) << 4 | value(hex[at + 1]));
  return bytes;
}

// All names that begin so: up to this one.
std::string end_of(std::string beginning) {
  ++beginning.back();
  return beginning;
}

struct Head {
  std::string sha256;
  std::int64_t bytes{};
};

std::optional<Head> head_of(Database& database, const std::string& name) {
  return first_of(database.rows("SELECT sha256, bytes FROM blob WHERE path=?", name),
                  [](const Rows& rows) {
                    return Head{rows.text(0), rows.integer(1)};
                  });
}

void for_each_part(const std::string& place,
                   const std::function<void(std::int64_t seq, std::string_view bytes)>& one) {
  std::ifstream file(place, std::ios::binary);
  std::string part(kPartBytes, '\0');
  for (std::int64_t seq = 0; file; ++seq) {
    file.read(part.data(), static_cast<std::streamsize>(part.size()));
    if (file.gcount() == 0) return;
    one(seq, std::string_view(part).substr(0, static_cast<std::size_t>(file.gcount())));
  }
}

void put(Database& database, const std::string& name, const std::string& place,
         std::int64_t bytes) {
  Sha256 whole;
  for_each_part(place, [&](std::int64_t, std::string_view part) { whole.add(part); });
  const std::string digest = whole.hex();
  const std::optional<Head> before = head_of(database, name);
  if (before && before->sha256 == digest) return;
  Transaction all(database);
  // A plan that another node began is made again here, and need not come out the same.
  database.run("DELETE FROM blob WHERE path=? AND sha256!=?", name, digest);
  database.run(
      "INSERT INTO blob(path, sha256, bytes, created) VALUES(?, ?, ?, clock_ms()) ON CONFLICT DO "
      "NOTHING",
      name, digest, bytes);
  for_each_part(place, [&](std::int64_t seq, std::string_view part) {
    database.run(
        "INSERT INTO blob_part(path, seq, data) VALUES(?, ?, decode(?, 'hex')) ON CONFLICT DO "
        "NOTHING",
        name, seq, hex_of(part));
  });
  all.commit();
}

bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

// Reads a part at a time; only what is whole gets its name. The next start removes what has a name
// that begins with ".new-".
Result<void> bring(Database& database, const StateFolder& folder, const std::string& name,
                   const Head& head) {
  const std::string place = folder.at(name);
  std::error_code failed;
  fs::create_directories(fs::path(place).parent_path(), failed);
  const std::string fresh =
      (fs::path(place).parent_path() / (".new-" + sha256_hex(random_bytes(8)))).string();
  Sha256 digest;
  const int file =
      ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  bool is_written = file >= 0;
  try {
    for (std::int64_t seq = 0, taken = 0; is_written && taken < head.bytes; ++seq) {
      Rows part = database.rows("SELECT encode(data, 'hex') FROM blob_part WHERE path=? AND seq=?",
                                name, seq);
      const std::string bytes = part.next() ? bytes_of(part.text(0)) : std::string();
      if (bytes.empty()) break;
      digest.add(bytes);
      is_written = write_all(file, bytes);
      taken += static_cast<std::int64_t>(bytes.size());
    }
  } catch (...) {
    if (file >= 0) ::close(file);
    remove_tree(fresh);
    throw;
  }
  if (file >= 0) ::close(file);
  if (!is_written) {
    remove_tree(fresh);
    return fail(ErrorKind::Unwritable, place, "cannot be written; is the disk full?");
  }
  if (digest.hex() != head.sha256) {
    remove_tree(fresh);
    return fail(ErrorKind::CheckFailed, name,
                "in the fleet's database is not what was stored there: its digest differs");
  }
  return keep_file(fresh, place);
}

class FleetFiles final : public SharedFiles {
 public:
  FleetFiles(Database& service, const StateFolder& folder, PostgresDatabase::Options own)
      : service_(service), folder_(folder), own_(std::move(own)) {
    own_.name += " files";
    worker_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
  }
  ~FleetFiles() override {
    {
      // Under the lock, so that the worker is either before its look or waits already.
      const std::lock_guard hold(lock_);
      worker_.request_stop();
    }
    wake_.notify_all();
  }
  FleetFiles(const FleetFiles&) = delete;
  FleetFiles& operator=(const FleetFiles&) = delete;

  Result<void> keep(const std::string& name, const std::string& place) override {
    const std::string from = place.empty() ? folder_.at(name) : place;
    std::error_code ignored;
    if (!fs::is_directory(from, ignored)) return keep_one(name, from);
    for (const auto& entry : fs::directory_iterator(from, ignored))
      if (entry.is_regular_file(ignored))
        if (Result<void> kept =
                keep_one(name + "/" + entry.path().filename().string(), entry.path().string());
            !kept)
          return kept;
    return {};
  }

  bool keep_small(const std::string& name) override {
    std::error_code failed;
    const auto bytes = static_cast<std::int64_t>(fs::file_size(folder_.at(name), failed));
    if (failed || bytes > kSmallBytes) return false;
    put(service_, name, folder_.at(name), bytes);
    return true;
  }

  Found fetch(const std::string& name) override {
    std::error_code ignored;
    if (fs::exists(folder_.at(name), ignored)) return Found::Here;
    const std::optional<Head> head = head_of(service_, name);
    if (!head) return Found::Absent;
    if (head->bytes <= kSmallBytes) {
      if (const Result<void> brought = bring(service_, folder_, name, *head); !brought)
        throw StoreFault(
            brought.error().kind == ErrorKind::CheckFailed ? FaultKind::Refused : FaultKind::Full,
            message(brought.error()));
      return Found::Here;
    }
    const std::lock_guard hold(lock_);
    if (coming_.insert(name).second) {
      wanted_.push_back(name);
      wake_.notify_one();
    }
    return Found::Coming;
  }

  std::vector<std::string> names(const std::string& beginning) override {
    return all_of(service_.rows("SELECT path FROM blob WHERE path>=? AND path<? ORDER BY path",
                                beginning, end_of(beginning)),
                  first_text);
  }

  void forget(const std::string& beginning) override {
    service_.run("DELETE FROM blob WHERE path>=? AND path<?", beginning, end_of(beginning));
  }

 private:
  // One connection for all threads but the service's; one of them at a time.
  PostgresDatabase& own_line() {
    if (!line_) line_ = std::make_unique<PostgresDatabase>(own_, false);
    return *line_;
  }

  Result<void> keep_one(const std::string& name, const std::string& place) {
    std::error_code failed;
    const auto bytes = static_cast<std::int64_t>(fs::file_size(place, failed));
    if (failed) return fail(ErrorKind::Unwritable, place, "cannot be read");
    const std::lock_guard hold(line_lock_);
    try {
      put(own_line(), name, place, bytes);
      return {};
    } catch (const StoreFault& fault) {
      return fail(
          ErrorKind::Unwritable, name,
          fmt::format("cannot be stored in the fleet's database: {}",
                      fault.kind() == FaultKind::Full
                          ? "its disk is full; ask its administrator, and try again when it has "
                            "space"
                          : fault.what()));
    }
  }

  void work(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::string name;
      {
        std::unique_lock hold(lock_);
        wake_.wait(hold, [&] { return stop.stop_requested() || !wanted_.empty(); });
        if (stop.stop_requested()) return;
        name = wanted_.front();
        wanted_.pop_front();
      }
      try {
        const std::lock_guard hold(line_lock_);
        PostgresDatabase& line = own_line();
        if (const std::optional<Head> head = head_of(line, name))
          (void)bring(line, folder_, name, *head);
      } catch (const std::exception&) {  // asked for again
      }
      const std::lock_guard hold(lock_);
      coming_.erase(name);
    }
  }

  Database& service_;
  const StateFolder& folder_;
  PostgresDatabase::Options own_;
  std::mutex line_lock_;
  std::unique_ptr<PostgresDatabase> line_;
  std::mutex lock_;
  std::condition_variable wake_;
  std::deque<std::string> wanted_;
  std::set<std::string> coming_;
  std::jthread worker_;
};

}  // namespace

std::unique_ptr<SharedFiles> make_fleet_files(Database& service, const StateFolder& folder,
                                              PostgresDatabase::Options own) {
  return std::make_unique<FleetFiles>(service, folder, std::move(own));
}

}  // namespace popcut::daemon
