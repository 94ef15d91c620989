// SPDX-License-Identifier: MIT
#include "device/port/ports.hpp"

#include <dirent.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include <fmt/format.h>

namespace popcut {
namespace {

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  DIR* const open = ::opendir(folder.c_str());
  if (open == nullptr) return names;
  while (const dirent* entry = ::readdir(open)) names.emplace_back(entry->d_name);
  ::closedir(open);
  std::sort(names.begin(), names.end());
  return names;
}

void add_ports(std::vector<PortInfo>& ports, const std::string& folder, const char* kind,
               std::initializer_list<const char*> prefixes) {
  for (const std::string& name : names_in(folder))
    for (const char* prefix : prefixes)
      if (name.rfind(prefix, 0) == 0) {
        const std::string path = folder + "/" + name;
        ports.push_back(
            {fmt::format("{}:{}", kind, path), path, ::access(path.c_str(), R_OK | W_OK) == 0});
      }
}

std::string link_target(const std::string& path) {
  std::array<char, 1024> target{};
  const ssize_t length = ::readlink(path.c_str(), target.data(), target.size());
  return length <= 0 ? "" : std::string(target.data(), static_cast<std::size_t>(length));
}

std::string program_name(const std::string& process) {
  std::FILE* const file = std::fopen(("/proc/" + process + "/comm").c_str(), "re");
  if (file == nullptr) return "a program";
  std::array<char, 64> line{};
  const char* const got = std::fgets(line.data(), static_cast<int>(line.size()), file);
  std::fclose(file);
  std::string name = got == nullptr ? "a program" : got;
  std::erase_if(name, [](char c) { return c < ' ' || c > '~'; });
  return name;
}

}  // namespace

std::vector<PortInfo> list_ports() {
  std::vector<PortInfo> ports;
  add_ports(ports, "/dev", "serial", {"ttyUSB", "ttyACM"});
  add_ports(ports, "/dev/usb", "lp", {"lp"});
  return ports;
}

std::vector<std::string> who_has_open(const std::vector<std::string>& paths) {
  std::vector<std::string> programs;
  const std::string self = fmt::format("{}", ::getpid());
  for (const std::string& process : names_in("/proc")) {
    const bool number =
        std::all_of(process.begin(), process.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!number || process == self) continue;
    const std::string folder = "/proc/" + process + "/fd";
    for (const std::string& descriptor : names_in(folder)) {
      const std::string target = link_target(folder + "/" + descriptor);
      if (std::find(paths.begin(), paths.end(), target) == paths.end()) continue;
      programs.push_back(fmt::format("{} ({})", program_name(process), process));
      break;
    }
  }
  return programs;
}

}  // namespace popcut
