// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace popcut::test {

/// The synthetic drawings of the generator beside the repository, made once in the working
/// directory; empty where the generator, Python or numpy is absent.
inline std::vector<std::filesystem::path> corpus() {
  namespace fs = std::filesystem;
  const fs::path generator = POPCUT_SOURCE_DIR "/../shared/data/drawings/gen_corpus.py";
  const fs::path folder = fs::current_path() / "corpus";
  if (!fs::exists(generator)) return {};
  if (!fs::exists(folder / "done")) {
    bool made = false;
    for (const char* python : {"/usr/bin/python3", "python3"}) {
      const std::string command = std::string(python) + " '" + generator.string() + "' '" +
                                  folder.string() + "' > /dev/null 2>&1";
      made = made || std::system(command.c_str()) == 0;
    }
    if (!made) return {};
    std::ofstream(folder / "done") << "all files are there\n";
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".svg") files.push_back(entry.path());
  return files;
}

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace popcut::test
