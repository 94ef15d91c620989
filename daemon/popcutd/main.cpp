// SPDX-License-Identifier: MIT
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "daemon/planning/worker/worker.hpp"
#include "daemon/popcutd/log.hpp"
#include "daemon/popcutd/options.hpp"
#include "daemon/popcutd/serve.hpp"
#include "daemon/popcutd/service_manager.hpp"
#include "daemon/popcutd/turn_away.hpp"
#include "daemon/popcutd/webhook.hpp"

namespace popcut::daemon {
namespace {

constexpr int kNeedsPerson = 78;  // EX_CONFIG: systemd does not start it again

int report(const Error& error, int code) {
  std::fprintf(stderr, "popcutd: %s\n", without_control(message(error)).c_str());
  return code;
}

/// A wrong configuration needs a person; a wrong command line has its own code.
int config_code(const Error& error) {
  return error.kind == ErrorKind::Usage ? exit_code(error.kind) : kNeedsPerson;
}

int run(int argc, char** argv) {
  const auto options = parse_options(argc, argv);
  if (!options) return report(options.error(), exit_code(options.error().kind));
  if (options->exit) return *options->exit;
  const ServiceManager manager = ServiceManager::from_environment();
  std::string file;
  const auto config = load_config(*options, file);
  if (!config) {
    if (options->check_config) return report(config.error(), config_code(config.error()));
    manager.tell_status(message(config.error()));
    turn_away(manager.sockets(), message(config.error()));
    return report(config.error(), config_code(config.error()));
  }
  if (options->check_config) {
    if (!config->webhook.url.empty())
      if (const auto target = webhook_target(config->webhook); !target)
        return report(file.empty() ? target.error() : within(file, target.error()), kNeedsPerson);
    std::printf("%s: ok\nSIGHUP reloads: %s; everything else needs a restart\n",
                file.empty() ? "no configuration file; using defaults" : file.c_str(),
                std::string(kReloadedKeys).c_str());
    return 0;
  }
  const auto log = make_log(config->log, std::getenv("JOURNAL_STREAM") != nullptr);
  return serve(*config, *options, manager, log);
}

}  // namespace
}  // namespace popcut::daemon

int main(int argc, char** argv) {
  ::umask(077);  // jobs and designs are nobody else's
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a write past the file size limit fails like a full disk
  try {
    if (argc >= 2 && argc <= 3 && std::strcmp(argv[1], "--worker") == 0)
      return popcut::planning::run_worker(0, 1, argc == 3 ? argv[2] : "");
    return popcut::daemon::run(argc, argv);
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "popcutd: internal fault: %s\n", fault.what());
  } catch (...) {
    std::fputs("popcutd: internal fault: unknown exception\n", stderr);
  }
  return 1;
}
