// SPDX-License-Identifier: MIT
#include "daemon/popcutd/resources.hpp"

#include <link.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
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

constexpr rlim_t kOwn = 24;  // what is open while nobody asks for anything

}  // namespace

void give_back_start() {
  ::malloc_trim(0);
  if (!is_traced()) ::dl_iterate_phdr(give_back, nullptr);
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
