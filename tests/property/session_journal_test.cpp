// SPDX-License-Identifier: MIT
#include <atomic>
#include <random>

#include <catch2/catch.hpp>

#include "device/session/session.hpp"
#include "tests/support/ledger_checks.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/sim_bench.hpp"

namespace session_journal_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

SimJob small_buffer_job(const char* name, std::mt19937& random, std::size_t strokes) {
  Machine target = machine(name);
  target.buffer_bytes = 600;  // small, so that back-pressure and the buffer rule matter
  return {std::move(target), random, strokes, 300};
}

/// A journal that is kept in memory, and the cable between it and a cutter: no byte of a stroke
/// that was not written down may as much as be offered.
class Witness final : public Transport {
 public:
  Witness(SimTransport& cable, const EncodedProgram& program) : cable_(cable), program_(program) {}

  WriteEnd write(std::span<const std::byte> bytes, Deadline until) override {
    const auto all = program_.view();
    const bool of_program = std::less_equal<>()(all.data(), bytes.data()) &&
                            std::less<>()(bytes.data(), all.data() + all.size());
    if (of_program) {
      const auto begin = static_cast<std::uint64_t>(bytes.data() - all.data());
      const std::uint64_t end = begin + bytes.size();
      for (std::size_t k = 0; k < program_.strokes.size(); ++k) {
        const ByteRange& stroke = program_.strokes[k];
        if (stroke.begin < std::min(end, stroke.end) &&
            begin<stroke.end&& static_cast<std::int64_t>(k)> intended)
          wrong =
              fmt::format("bytes of stroke {} were sent, but {} is the last intended", k, intended);
      }
    }
    return cable_.write(bytes, until);
  }
  Result<std::vector<std::byte>> read(Deadline until) override { return cable_.read(until); }
  std::chrono::nanoseconds now() const override { return cable_.now(); }
  void wait(std::chrono::nanoseconds duration) override { cable_.wait(duration); }

  /// The hooks of a session; the n-th call of either fails, from 0.
  void watch(SessionOptions& options, std::uint64_t fails_at) {
    options.intend = [this, fails_at](std::int64_t last) -> Result<void> {
      if (failed) wrong = "the journal was asked again after it had failed";
      if (last <= intended) wrong = "the same strokes are intended twice";
      if (calls++ == fails_at) return refuse_to_write();
      intended = last;
      return {};
    };
    options.settle = [this, fails_at](std::int64_t sure, std::int64_t got,
                                      std::uint64_t) -> Result<void> {
      if (failed) wrong = "the journal was asked again after it had failed";
      if (sure < certain || got < taken || sure > got || got > intended)
        wrong = fmt::format("certain {}, taken {}, intended {}", sure, got, intended);
      if (calls++ == fails_at) return refuse_to_write();
      certain = sure;
      taken = got;
      return {};
    };
  }

  std::int64_t intended{-1}, certain{-1}, taken{-1};
  std::uint64_t calls{};
  bool failed{false};
  std::string wrong;

 private:
  Result<void> refuse_to_write() {
    failed = true;
    return fail(ErrorKind::Unwritable, "journal", "the disk is full");
  }
  SimTransport& cable_;
  const EncodedProgram& program_;
};

constexpr std::uint64_t kNever = ~std::uint64_t{0};

}  // namespace

TEST_CASE("no byte of a stroke is sent before its intent is in the journal", "[device][journal]") {
  std::uint64_t calls = 0, strokes = 0, broken = 0;
  const auto seeds = static_cast<std::uint32_t>(testing::rounds(300));
  for (const char* name : {"cameo3", "cameo", "hpgl-generic"}) {
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
      CAPTURE(name, seed);
      std::mt19937 random(seed);
      const SimJob job = small_buffer_job(name, random, 40);
      const bool faulty = seed % 3 != 0;
      SimTransport cable =
          job.cable(faulty ? random_faults(seed, 1 + seed % 2, job.program.bytes.size())
                           : std::vector<SimFault>());
      Witness witness(cable, job.program);
      SessionOptions options;
      options.stuck_s = 20;
      options.pause_limit_s = 60;
      const std::uint64_t fails_at = seed % 4 == 1 ? random() % 40 : kNever;
      witness.watch(options, fails_at);
      const SessionEnd end = run_session(witness, job.machine, job.program, options);
      CHECK(witness.wrong.empty());
      INFO(witness.wrong);
      calls += witness.calls;
      strokes += job.program.strokes.size();
      // What was taken is told before the end, and no fate says more than the journal.
      for (std::size_t k = 0; k < end.fates.size(); ++k) {
        const auto n = static_cast<std::int64_t>(k);
        if (end.fates[k] != StrokeFate::NotSent) {
          CHECK(n <= witness.intended);
        }
        if (n <= witness.certain && job.program.strokes[k].begin != job.program.strokes[k].end) {
          CHECK(end.fates[k] == StrokeFate::Certain);
        }
      }
      if (!witness.failed) continue;
      ++broken;
      REQUIRE(end.error);
      if (faulty) continue;
      // The job ended with the journal's word, at the end of a stroke, with the tool up.
      CHECK(end.error->kind == ErrorKind::Unwritable);
      CHECK_FALSE(cable.cutter().tool_down());
      CHECK(cable.cutter().trace().unknown.empty());
      const CutLines cut =
          cut_lines(cable.cutter().trace(), MeantLines(job.path, job.machine.unit_mm));
      CHECK(cut.wrong.empty());
      CHECK(cut.begun == cut.whole);
    }
  }
  CHECK(broken > seeds / 3);
  std::printf("journal: %.1f calls for %.1f strokes a job\n",
              static_cast<double>(calls) / (3 * seeds), static_cast<double>(strokes) / (3 * seeds));
}

TEST_CASE("resuming from a stroke draws the rest with its settings", "[device][journal]") {
  const auto seeds = static_cast<std::uint32_t>(testing::rounds(60));
  for (const char* name : {"cameo3", "cameo", "cameo4", "hpgl-generic"}) {
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
      CAPTURE(name, seed);
      std::mt19937 random(seed);
      const SimJob job = small_buffer_job(name, random, 30);
      SimTransport whole = job.cable();
      REQUIRE_FALSE(run_session(whole, job.machine, job.program).error);
      const std::size_t first = random() % job.program.strokes.size();
      CAPTURE(first);
      SimTransport cable = job.cable();
      Witness witness(cable, job.program);
      SessionOptions options;
      options.first_stroke = first;
      witness.watch(options, kNever);
      std::uint64_t most_strokes = 0;
      options.progress = [&](const SessionProgress& p) { most_strokes = p.strokes; };
      const SessionEnd end = run_session(witness, job.machine, job.program, options);
      INFO((end.error ? message(*end.error) : std::string()));
      REQUIRE_FALSE(end.error);
      CHECK(witness.wrong.empty());
      CHECK(most_strokes == job.program.strokes.size());
      CHECK(witness.taken + 1 == static_cast<std::int64_t>(job.program.strokes.size()));
      REQUIRE(end.fates.size() == job.program.strokes.size());
      std::size_t left_out = 0;  // of those that are drawn at all
      for (std::size_t k = 0; k < first; ++k) {
        CHECK(end.fates[k] == StrokeFate::NotSent);
        left_out += job.program.strokes[k].begin != job.program.strokes[k].end ? 1 : 0;
      }
      // Stroke for stroke the tail of the whole trace, also in force, speed and tool.
      const Trace& all = whole.cutter().trace();
      const Trace& rest = cable.cutter().trace();
      CHECK(rest.unknown.empty());
      REQUIRE(rest.strokes.size() + left_out == all.strokes.size());
      for (std::size_t k = 0; k < rest.strokes.size(); ++k) {
        const TraceStroke& a = all.strokes[k + left_out];
        const TraceStroke& b = rest.strokes[k];
        REQUIRE(a.count == b.count);
        CHECK(a.tool == b.tool);
        CHECK(a.force_steps == b.force_steps);
        CHECK(a.speed_mm_s == b.speed_mm_s);
        for (std::uint32_t i = 0; i < a.count; ++i)
          CHECK(all.points_of(a)[i] == rest.points_of(b)[i]);
      }
    }
  }
}

TEST_CASE("resuming from a stroke that does not exist is refused", "[device][journal]") {
  std::mt19937 random(1);
  const SimJob job = small_buffer_job("cameo3", random, 5);
  SimTransport cable = job.cable();
  SessionOptions options;
  options.first_stroke = 5;
  const SessionEnd end = run_session(cable, job.machine, job.program, options);
  REQUIRE(end.error);
  CHECK(end.error->kind == ErrorKind::OutOfRange);
  CHECK(cable.cutter().accepted_bytes() == 0);
  CHECK(end.fates == std::vector<StrokeFate>(5, StrokeFate::NotSent));
}

}  // namespace session_journal_test
