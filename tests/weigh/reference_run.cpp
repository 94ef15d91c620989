// The unit of './run weigh' for the suite: what running this program costs. It does what tests do
// most: compute with numbers and texts, and start programs. Starting is a small part, as it is of
// the suite: virtual machines differ tenfold in what it costs. It must never change: a change
// makes all budgets wrong.
#include <sys/wait.h>
#include <unistd.h>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

namespace {

double relaxed(std::size_t size) {
  std::vector<double> field(size * size);
  for (std::size_t k = 0; k < field.size(); ++k) field[k] = std::sin(static_cast<double>(k));
  for (int round = 0; round < 60; ++round)
    for (std::size_t i = 1; i + 1 < size; ++i)
      for (std::size_t j = 1; j + 1 < size; ++j)
        field[i * size + j] = 0.25 * (field[(i - 1) * size + j] + field[(i + 1) * size + j] +
                                      field[i * size + j - 1] + field[i * size + j + 1]);
  return field[size + 1];
}

std::size_t counted_words() {
  std::map<std::string, int> counts;
  std::uint32_t state = 1;
  for (int k = 0; k < 300000; ++k) {
    state = state * 1664525U + 1013904223U;
    ++counts["word " + std::to_string(state >> 20)];
  }
  return counts.size();
}

bool started() {
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/true", "true", static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

}  // namespace

int main() {
  double number = 0.0;
  std::size_t words = 0;
  for (int k = 0; k < 3; ++k) {
    number += relaxed(700);
    words += counted_words();
  }
  for (int k = 0; k < 20; ++k)
    if (!started()) return 1;
  std::printf("%g %zu\n", number, words);
  return 0;
}
