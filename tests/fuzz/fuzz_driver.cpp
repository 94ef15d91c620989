// SPDX-License-Identifier: MIT
// Runs the fuzz targets without libFuzzer: gives each one its seeds, CORPUS/TARGET/*, then ROUNDS
// inputs made from them by chance, the same ones each time. A target that breaks a promise aborts;
// the last line names it.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/targets.hpp"

namespace {

using popcut::fuzzing::Target;
using Bytes = std::vector<std::uint8_t>;

std::vector<Bytes> seeds_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Bytes> seeds{{}};
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return seeds;
}

// What a changed place becomes: bytes that parsers have reason to look at.
constexpr std::string_view kTelling = "<>\"'&;:#%(){}[],.-+eE0123456789 \n\0\xFF/=!*";

void change(Bytes& bytes, const std::vector<Bytes>& seeds, std::mt19937& random) {
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const auto at = [&](std::size_t i) { return bytes.begin() + static_cast<std::ptrdiff_t>(i); };
  const std::size_t where = below(bytes.size() + 1);
  const std::size_t room = bytes.size() - where;
  switch (below(5)) {
    case 0:
      if (room > 0) bytes[where] = static_cast<std::uint8_t>(kTelling[below(kTelling.size())]);
      break;
    case 1:
      bytes.insert(at(where), static_cast<std::uint8_t>(kTelling[below(kTelling.size())]));
      break;
    case 2:
      if (room > 0) bytes.erase(at(where), at(where + 1 + below(std::min<std::size_t>(room, 16))));
      break;
    case 3:
      if (room > 0) {
        const std::size_t n = 1 + below(std::min<std::size_t>(room, 64));
        const Bytes part(at(where), at(where + n));
        bytes.insert(at(below(bytes.size() + 1)), part.begin(), part.end());
      }
      break;
    default: {
      const Bytes& other = seeds[below(seeds.size())];
      if (other.empty()) break;
      const std::size_t from = below(other.size());
      const std::size_t n = 1 + below(std::min<std::size_t>(other.size() - from, 64));
      bytes.insert(at(where), other.begin() + static_cast<std::ptrdiff_t>(from),
                   other.begin() + static_cast<std::ptrdiff_t>(from + n));
    }
  }
}

void give(const Target& target, const Bytes& bytes) {
  // A copy that ends where the bytes end, so that a sanitizer sees who reads beyond.
  const Bytes exact(bytes);
  target.run({reinterpret_cast<const char*>(exact.data()), exact.size()});
}

void run(const Target& target, const std::filesystem::path& corpus, int most_rounds) {
  const int rounds = target.is_slow ? most_rounds / 5 : most_rounds;
  const std::vector<Bytes> seeds = seeds_of(corpus / target.name);
  std::printf("%s: %zu seeds and %d changed inputs\n", std::string(target.name).c_str(),
              seeds.size(), rounds);
  std::fflush(stdout);
  for (const Bytes& seed : seeds) give(target, seed);
  std::mt19937 random(20261121);
  for (int round = 0; round < rounds; ++round) {
    // The first seed is empty and is given once.
    Bytes bytes = seeds[seeds.size() == 1 ? 0 : 1 + random() % (seeds.size() - 1)];
    for (std::size_t n = 1 + random() % 8; n > 0; --n) change(bytes, seeds, random);
    give(target, bytes);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc < 3 ? 0 : std::atoi(argv[2]);
  if (argc < 3 || argc > 4 || rounds < 1) {
    std::fprintf(stderr, "usage: %s CORPUS ROUNDS [TARGET]\n", argv[0]);
    return 2;
  }
  bool found = false;
  for (const Target& target : popcut::fuzzing::all_targets()) {
    if (argc == 4 && target.name != argv[3]) continue;
    run(target, argv[1], rounds);
    found = true;
  }
  if (!found) std::fprintf(stderr, "there is no target %s\n", argv[3]);
  return found ? 0 : 2;
}
