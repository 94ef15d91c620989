// SPDX-License-Identifier: MIT
#include "daemon/popcutd/resources.hpp"

#include <fcntl.h>
#include <link.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

/// The segments of one program or library that nothing has ever written to. What the loader
/// relocates lies in those that may be written.
int give_back(dl_phdr_info* object, std::size_t, void*) {
  if (std::string_view(object->dlpi_name).starts_with("linux-")) return 0;  // the kernel's own
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  for (int k = 0; k < object->dlpi_phnum; ++k) {
    const ElfW(Phdr)& part = object->dlpi_phdr[k];
    if (part.p_type != PT_LOAD || (part.p_flags & PF_W) != 0) continue;
    const std::uintptr_t begin = (object->dlpi_addr + part.p_vaddr) & ~(page - 1);
    const std::uintptr_t end =
        (object->dlpi_addr + part.p_vaddr + part.p_memsz + page - 1) & ~(page - 1);
    ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
  }
  return 0;
}

/// A debugger writes its breakpoints into those pages.
bool is_traced() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("TracerPid:")) return std::stol(line.substr(10)) != 0;
  return false;
}

constexpr std::uint64_t kForPopcutd = std::uint64_t{256} << 20;

bool write_to(const std::string& path, const std::string& text) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
  if (file < 0) return false;
  const bool is_written = ::write(file, text.data(), text.size()) >= 0;
  ::close(file);
  return is_written;
}

/// The folder of the control group of this process; empty where there is no version 2 of them.
std::string own_control_group() {
  std::ifstream list("/proc/self/cgroup");
  for (std::string line; std::getline(list, line);)
    if (line.starts_with("0::/")) {
      std::string folder = "/sys/fs/cgroup" + line.substr(3);
      if (::access((folder + "/cgroup.procs").c_str(), F_OK) == 0) return folder;
    }
  return {};
}

/// The least limit on memory of a control group and of those above it.
std::uint64_t limit_of_group(std::string folder) {
  auto least = std::numeric_limits<std::uint64_t>::max();
  for (; folder.size() > 1 && folder != "/sys/fs/cgroup"; folder.erase(folder.rfind('/')))
    for (const char* const name : {"/memory.high", "/memory.max"}) {
      std::ifstream file(folder + name);
      if (std::uint64_t bytes = 0; file >> bytes) least = std::min(least, bytes);
    }
  return least;
}

/// Makes the groups "main" with this process and "workers" with a limit; a descriptor of what says
/// who is in the latter, or -1. Only if nobody else is in the group: then it is that of a service.
int group_for_workers(const std::string& folder, std::uint64_t bytes) {
  const std::string self = std::to_string(::getpid());
  const std::string main = folder + "/main", workers = folder + "/workers";
  std::ifstream list(folder + "/cgroup.procs");
  std::string first, second;
  if (folder.empty() || !(list >> first) || first != self || list >> second) return -1;
  for (const std::string& group : {main, workers})
    if (::mkdir(group.c_str(), 0755) != 0 && errno != EEXIST) return -1;
  if (!write_to(main + "/cgroup.procs", self)) return -1;
  int file = -1;
  if (write_to(folder + "/cgroup.subtree_control", "+memory") &&
      write_to(workers + "/memory.max", std::to_string(bytes)))
    file = ::open((workers + "/cgroup.procs").c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
  if (file < 0) write_to(folder + "/cgroup.procs", self);
  return file;
}

constexpr rlim_t kOwn = 24;  // what is open while nobody asks for anything

}  // namespace

void give_back_start() {
  ::malloc_trim(0);
  if (!is_traced()) ::dl_iterate_phdr(give_back, nullptr);
}

std::shared_ptr<planning::WorkerMemory> memory_for_workers(std::uint64_t bytes,
                                                           const std::string& folder) {
  const auto computer = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                        static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  const std::uint64_t least = std::min(computer, limit_of_group(folder));
  if (bytes == 0) bytes = least - std::min(kForPopcutd, least / 4);
  return std::make_shared<planning::WorkerMemory>(bytes, group_for_workers(folder, bytes));
}

std::shared_ptr<planning::WorkerMemory> memory_for_workers(std::uint64_t bytes) {
  return memory_for_workers(bytes, own_control_group());
}

std::string allow_descriptors(const HttpLimits& limits) {
  const auto places = static_cast<rlim_t>(limits.connections + limits.reserved_connections);
  const rlim_t besides = kOwn + kDescriptorsLeft;
  rlimit now{};
  if (::getrlimit(RLIMIT_NOFILE, &now) != 0 || now.rlim_cur >= places + besides) return "";
  now.rlim_cur = std::min(now.rlim_max, places + besides);
  (void)::setrlimit(RLIMIT_NOFILE, &now);
  if (now.rlim_cur >= places + besides) return "";
  return fmt::format(
      "this process may open {} files, which is enough for about {} clients, not for "
      "limits.connections = {}; raise the limit to {} (LimitNOFILE in the unit, or ulimit -n)",
      now.rlim_cur, now.rlim_cur > besides ? now.rlim_cur - besides : 0, limits.connections,
      places + besides);
}

}  // namespace popcut::daemon
