// SPDX-License-Identifier: MIT
#include "tests/support/fault_vfs.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <sstream>

#include <sqlite3.h>
#include <unistd.h>

namespace popcut::testing {
namespace {

constexpr std::size_t kSector = 512;

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

struct Operation {
  std::int64_t offset{};
  std::string bytes;
  bool truncate{false};
};

void apply(std::string& image, const Operation& one, std::size_t bytes) {
  const auto at = static_cast<std::size_t>(one.offset);
  if (one.truncate) {
    image.resize(at);
    return;
  }
  if (image.size() < at + bytes) image.resize(at + bytes);
  std::copy_n(one.bytes.begin(), bytes, image.begin() + one.offset);
}

struct Image {
  std::string durable;
  std::vector<Operation> pending;
};

}  // namespace

struct FaultVfs::State {
  sqlite3_vfs* system{sqlite3_vfs_find(nullptr)};
  sqlite3_vfs vfs{};
  FaultVfs* owner{};
  mutable std::recursive_mutex mutex;
  std::map<std::string, Image> images;
  std::uint64_t writes{0}, syncs{0}, writes_after_failure{0};
  std::uint64_t full_from{0}, bad_sync{0}, bad_write{0}, allowance{0};
  std::string reserve;
  bool failed{false};

  // Whether this write finds the disk full.
  bool is_full(std::uint64_t bytes) {
    if (full_from == 0 || writes < full_from) return false;
    if (reserve.empty() || access(reserve.c_str(), F_OK) == 0 || allowance < bytes) return true;
    allowance -= bytes;
    return false;
  }
  int note_write(const char* path, Operation operation) {
    ++writes;
    if (failed) ++writes_after_failure;
    if (bad_write != 0 && writes == bad_write) {
      failed = true;
      return SQLITE_IOERR_WRITE;
    }
    if (!operation.truncate && is_full(operation.bytes.size())) return SQLITE_FULL;
    images[path].pending.push_back(std::move(operation));
    return SQLITE_OK;
  }
};

namespace {

using State = FaultVfs::State;

struct File {
  sqlite3_file base;
  State* state;
  const char* path;
  sqlite3_file* real;
};

File* as(sqlite3_file* file) { return reinterpret_cast<File*>(file); }
sqlite3_file* real(sqlite3_file* file) { return as(file)->real; }

int close_file(sqlite3_file* file) { return real(file)->pMethods->xClose(real(file)); }
int read_file(sqlite3_file* file, void* to, int count, sqlite3_int64 at) {
  return real(file)->pMethods->xRead(real(file), to, count, at);
}

void told(const State& state) {
  if (state.owner->after_each) state.owner->after_each();
}

int write_at(sqlite3_file* file, const void* from, int count, sqlite3_int64 at) {
  State& state = *as(file)->state;
  const std::lock_guard lock(state.mutex);
  const int code = state.note_write(
      as(file)->path,
      {at, std::string(static_cast<const char*>(from), static_cast<std::size_t>(count))});
  if (code != SQLITE_OK) return code;
  const int done = real(file)->pMethods->xWrite(real(file), from, count, at);
  told(state);
  return done;
}

int truncate_to(sqlite3_file* file, sqlite3_int64 size) {
  State& state = *as(file)->state;
  const std::lock_guard lock(state.mutex);
  const int code = state.note_write(as(file)->path, {size, {}, true});
  if (code != SQLITE_OK) return code;
  return real(file)->pMethods->xTruncate(real(file), size);
}

int sync_file(sqlite3_file* file, int) {
  State& state = *as(file)->state;
  const std::lock_guard lock(state.mutex);
  ++state.syncs;
  Image& image = state.images[as(file)->path];
  if (state.bad_sync != 0 && state.syncs == state.bad_sync) {
    // As Linux does: the pages are marked clean and gone, and the next fsync says that all is well.
    image.pending.clear();
    state.failed = true;
    return SQLITE_IOERR_FSYNC;
  }
  for (const Operation& one : image.pending) apply(image.durable, one, one.bytes.size());
  image.pending.clear();
  told(state);
  return SQLITE_OK;  // the system's own sync would only cost time
}

int file_size(sqlite3_file* file, sqlite3_int64* size) {
  return real(file)->pMethods->xFileSize(real(file), size);
}
int lock_file(sqlite3_file* file, int kind) {
  return real(file)->pMethods->xLock(real(file), kind);
}
int unlock_file(sqlite3_file* file, int kind) {
  return real(file)->pMethods->xUnlock(real(file), kind);
}
int check_lock(sqlite3_file* file, int* out) {
  return real(file)->pMethods->xCheckReservedLock(real(file), out);
}
int control(sqlite3_file* file, int what, void* with) {
  return real(file)->pMethods->xFileControl(real(file), what, with);
}
int sector_size(sqlite3_file*) { return static_cast<int>(kSector); }
int characteristics(sqlite3_file*) { return SQLITE_IOCAP_POWERSAFE_OVERWRITE; }

const sqlite3_io_methods kMethods{1,         close_file,  read_file,       write_at,    truncate_to,
                                  sync_file, file_size,   lock_file,       unlock_file, check_lock,
                                  control,   sector_size, characteristics, nullptr,     nullptr,
                                  nullptr,   nullptr,     nullptr,         nullptr};

int open_file(sqlite3_vfs* vfs, const char* path, sqlite3_file* file, int flags, int* out) {
  auto* const state = static_cast<State*>(vfs->pAppData);
  File* const one = as(file);
  one->base.pMethods = nullptr;
  one->state = state;
  one->path = path == nullptr ? "temporary" : path;
  one->real = reinterpret_cast<sqlite3_file*>(one + 1);
  const int code = state->system->xOpen(state->system, path, one->real, flags, out);
  if (code != SQLITE_OK) return code;
  one->base.pMethods = &kMethods;
  const std::lock_guard lock(state->mutex);
  state->images[one->path] = {content_of(one->path), {}};
  return SQLITE_OK;
}

int delete_file(sqlite3_vfs* vfs, const char* path, int sync) {
  auto* const state = static_cast<State*>(vfs->pAppData);
  const std::lock_guard lock(state->mutex);
  state->images.erase(path);
  return state->system->xDelete(state->system, path, sync);
}

}  // namespace

FaultVfs::FaultVfs() : state_(std::make_unique<State>()) {
  static int number = 0;
  name_ = "faults-" + std::to_string(++number);
  state_->owner = this;
  state_->vfs = *state_->system;
  state_->vfs.zName = name_.c_str();
  state_->vfs.pNext = nullptr;
  state_->vfs.szOsFile = static_cast<int>(sizeof(File)) + state_->system->szOsFile;
  state_->vfs.pAppData = state_.get();
  state_->vfs.xOpen = open_file;
  state_->vfs.xDelete = delete_file;
  sqlite3_vfs_register(&state_->vfs, 0);
}

FaultVfs::~FaultVfs() { sqlite3_vfs_unregister(&state_->vfs); }

void FaultVfs::fill_at(std::uint64_t write, const std::string& reserve, std::uint64_t bytes) {
  const std::lock_guard lock(state_->mutex);
  state_->full_from = write;
  state_->reserve = reserve;
  state_->allowance = bytes;
}
void FaultVfs::fail_sync_at(std::uint64_t sync) {
  const std::lock_guard lock(state_->mutex);
  state_->bad_sync = sync;
}
void FaultVfs::fail_write_at(std::uint64_t write) {
  const std::lock_guard lock(state_->mutex);
  state_->bad_write = write;
}
void FaultVfs::heal() {
  const std::lock_guard lock(state_->mutex);
  state_->full_from = state_->bad_sync = state_->bad_write = 0;
}
std::uint64_t FaultVfs::writes() const {
  const std::lock_guard lock(state_->mutex);
  return state_->writes;
}
std::uint64_t FaultVfs::syncs() const {
  const std::lock_guard lock(state_->mutex);
  return state_->syncs;
}
std::uint64_t FaultVfs::writes_after_failure() const {
  const std::lock_guard lock(state_->mutex);
  return state_->writes_after_failure;
}

FaultVfs::Images FaultVfs::power_cut(std::mt19937& random, double kept) const {
  const std::lock_guard lock(state_->mutex);
  Images images;
  std::uniform_real_distribution<double> chance(0, 1);
  for (const auto& [path, image] : state_->images) {
    std::string content = image.durable;
    for (const Operation& one : image.pending) {
      if (chance(random) >= kept) continue;
      std::size_t bytes = one.bytes.size();
      // A write that was under way ends with a sector.
      if (kept < 1 && chance(random) < 0.2) bytes = bytes / 2 / kSector * kSector;
      apply(content, one, bytes);
    }
    images[path] = std::move(content);
  }
  return images;
}

}  // namespace popcut::testing
