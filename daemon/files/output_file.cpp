// SPDX-License-Identifier: MIT
#include "daemon/files/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include <unistd.h>

namespace popcut::cli {

Result<void> write_whole_file(const std::filesystem::path& path,
                              const std::function<void(std::ostream&)>& write) {
  namespace fs = std::filesystem;
  const auto unwritable = [&](const std::string& why) {
    return fail(ErrorKind::Unwritable, path.string(), why + "; give a file that can be written");
  };
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) return unwritable("is a folder");
  const bool direct = fs::exists(status) && !fs::is_regular_file(status);
  // A link stays a link: the file that it names is replaced.
  const fs::path target = fs::is_regular_file(status) ? fs::canonical(path, error) : path;
  fs::path aside = target;
  if (!direct) aside += ".part-" + std::to_string(getpid());
  errno = 0;
  std::ofstream out(aside, std::ios::binary | std::ios::trunc);
  if (out) write(out);
  out.close();
  if (!out) {
    const std::string why = errno != 0 ? std::strerror(errno) : "cannot be written";
    if (!direct) fs::remove(aside, error);
    return unwritable(why);
  }
  if (direct) return {};
  fs::rename(aside, target, error);
  if (!error) return {};
  const std::string why = error.message();
  fs::remove(aside, error);
  return unwritable(why);
}

}  // namespace popcut::cli
