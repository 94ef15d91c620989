// SPDX-License-Identifier: MIT
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "tests/support/paths.hpp"

namespace popcut::testing {

/// Where the synthetic drawings are kept for all tests and benchmarks of this machine.
inline std::filesystem::path corpus_folder() {
  return std::filesystem::temp_directory_path() / "popcut-toolpath-corpus";
}

/// The synthetic drawings of the generator next to the repository, made once; empty if the
/// generator, Python or numpy is missing.
inline std::vector<std::filesystem::path> corpus() {
  namespace fs = std::filesystem;
  const fs::path generator = popcut::testing::source_file("../shared/data/drawings/gen_corpus.py");
  if (!fs::exists(corpus_folder())) {
    if (!fs::exists(generator)) return {};
    // Made aside, then renamed: several tests may run at once.
    const fs::path fresh = corpus_folder().string() + "." + std::to_string(::getpid());
    bool made = false;
    for (const char* python : {"/usr/bin/python3", "python3"}) {
      const std::string command = std::string(python) + " '" + generator.string() + "' '" +
                                  fresh.string() + "' > /dev/null 2>&1";
      made = made || std::system(command.c_str()) == 0;
    }
    std::error_code ignored;
    if (made) fs::rename(fresh, corpus_folder(), ignored);
    fs::remove_all(fresh, ignored);
    if (!fs::exists(corpus_folder())) return {};
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(corpus_folder()))
    if (entry.path().extension() == ".svg") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// The load of the machine in the last minute, printed with each measured time.
inline std::string load() {
  std::ifstream file("/proc/loadavg");
  std::string one;
  file >> one;
  return one;
}

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace popcut::testing
