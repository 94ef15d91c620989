// SPDX-License-Identifier: MIT
#include "daemon/planning/worker/worker.hpp"

#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "daemon/pictures/load_graphics.hpp"
#include "daemon/pictures/pdf_page.hpp"
#include "daemon/planning/engine/engine.hpp"
#include "daemon/planning/worker/confinement.hpp"

namespace popcut::planning {
namespace {

constexpr int kBroken = 3;

class Pipes {
 public:
  Pipes(int in, int out) : in_(in), out_(out) {}

  /// No task has begun, and none will come.
  [[nodiscard]] bool has_ended() const { return ended_; }

  /// Reads frames until the one that says that nothing more comes.
  Result<WorkerTask> read() {
    TaskReader task;
    std::string block(1u << 16, '\0');
    while (!task.is_whole()) {
      const ssize_t got = ::read(in_, block.data(), block.size());
      if (got < 0 && errno == EINTR) continue;
      ended_ = got == 0 && task.at_rest();
      if (got <= 0) return fail(ErrorKind::Malformed, "pipe", "it ended within the task");
      const std::string_view bytes(block.data(), static_cast<std::size_t>(got));
      if (const Result<void> fed = task.feed(bytes); !fed) return tl::unexpected(fed.error());
    }
    return task.take();
  }

  [[nodiscard]] Result<void> write(FrameKind kind, std::string_view name, std::string_view bytes) {
    const std::string head = frame_head(kind, name, bytes.size());
    if (put(head) && put(bytes)) return {};
    return fail(ErrorKind::Unwritable, "pipe", "it is closed");
  }

  [[nodiscard]] bool say(std::string_view words) const { return put(words); }

 private:
  [[nodiscard]] bool put(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t put = ::write(out_, bytes.data(), bytes.size());
      if (put < 0 && errno == EINTR) continue;
      if (put <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(put));
    }
    return true;
  }
  int in_, out_;
  bool ended_{false};
};

/// Has the processor time's limit end this process with a code that says so. The first process of a
/// namespace would ignore the signal otherwise.
void end_when_out_of_time() {
  struct sigaction action {};
  action.sa_handler = [](int) { ::_exit(kOutOfTimeCode); };
  ::sigaction(SIGXCPU, &action, nullptr);
}

/// Has memory that runs out where nothing may be thrown end this process with a code that says so.
void end_when_out_of_memory() {
  std::set_terminate([] {
    try {
      if (const std::exception_ptr thrown = std::current_exception())
        std::rethrow_exception(thrown);
    } catch (const std::bad_alloc&) {
      ::_exit(kOutOfMemoryCode);
    } catch (...) {  // a fault of ours
    }
    std::abort();
  });
}

/// The sanitizer that looks for leaks at the end does so from a process that it would have to
/// start.
int end(int code, [[maybe_unused]] bool confined) {
#if defined(__SANITIZE_ADDRESS__)
  if (confined) ::_exit(code);
#endif
  return code;
}

/// Does one task; false: nothing could be written.
bool do_task(Pipes& pipes, bool serves) {
  const auto send = [&](FrameKind kind, std::string_view name,
                        std::string_view bytes) -> Result<void> {
    if (pipes.has_ended() && serves) return {};  // nothing was asked
    return pipes.write(kind, name, bytes);
  };
  // One that serves has its memory in pieces then, and is replaced.
  const auto spent = [&]() -> std::string_view {
    if (serves) ::_exit(kOutOfMemoryCode);
    return ", or raise planner.memory_mib in popcutd.toml";
  };
  return answer([&] { return pipes.read(); }, send, spent).has_value();
}

}  // namespace

int run_worker(int in, int out, std::string_view word) {
#ifdef M_MMAP_THRESHOLD
  mallopt(M_MMAP_THRESHOLD, 256 * 1024);  // large arrays go back at once
#endif
  const bool alone = in == STDIN_FILENO && out == STDOUT_FILENO;
  std::vector<daemon::WorkerWall> walls;
  if (alone) {
    end_when_out_of_time();
    end_when_out_of_memory();
    // What draws pages of artwork cannot be loaded later; if it is missing, the task says so.
    (void)pictures::load_graphics();
    if (word == "pdf") (void)pictures::load_pdf_reader();
    walls = confine_worker();
  }
  Pipes pipes(in, out);
  if (word == "tell") return end(pipes.say(walls_text(walls)) ? 0 : kBroken, alone);
  const bool serves = word == "serve";
  bool sent = do_task(pipes, serves);
  while (serves && sent && !pipes.has_ended()) sent = do_task(pipes, serves);
  return end(sent ? 0 : kBroken, alone);
}

}  // namespace popcut::planning
