// SPDX-License-Identifier: MIT
#include <chrono>
#include <cstdlib>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/commands/start_popcutd.hpp"
#include "daemon/client/api.hpp"

namespace popcut::cli {
namespace open_command {
namespace {

using client::Api;
using Json = nlohmann::json;

constexpr double kStart_s = 20;    // until a popcutd that was started answers
constexpr double kBrowser_s = 10;  // after that a browser is taken for open

bool is_set(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

// Another program has the port.
bool is_port_taken(const std::string& said) {
  return said.find("cannot listen here: Address already in use") != said.npos &&
         said.find("unix:") == said.npos;
}

// Waits until the popcutd that was started answers, or another one that was quicker.
Result<void> await(Api& api, const StartedPopcutd& started) {
  const auto begun = std::chrono::steady_clock::now();
  bool runs = true;
  while (true) {
    if (api.http().ask({.target = "/healthz", .seconds = 2})) return {};
    const double spent =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    if (!runs || spent > kStart_s) break;
    runs = is_running(started);
    std::this_thread::sleep_for(std::chrono::milliseconds(runs ? 50 : 1000));
  }
  const std::string said = last_words(started);
  return fail(ErrorKind::Refused, "popcutd",
              fmt::format("{}; its log is {}{}{}",
                          runs ? "was started and does not answer" : "was started and has ended",
                          started.log, said.empty() ? "" : ", and ends with: ", said));
}

// The popcutd that answers; where none does, and none was named, one is started.
Result<Api> api_of_running(const Globals& globals) {
  auto api = Api::from_environment();
  if (!api) return tl::unexpected(api.error());
  const auto answer = api->http().ask({.target = "/healthz", .seconds = 10});
  if (answer) return api;
  const bool is_named = is_set("POPCUT_URL") || is_set("POPCUT_TOKEN");
  if (answer.error().kind != ErrorKind::DeviceGone || is_named)
    return tl::unexpected(answer.error());
  const auto started = start_popcutd();
  if (!started) return tl::unexpected(started.error());
  if (!globals.quiet)
    fmt::print(stderr, "starting popcutd in the background; its log is {}\n", started->log);
  auto serves = await(*api, *started);
  if (!serves && is_port_taken(last_words(*started))) {
    const auto elsewhere = start_popcutd({"--listen", "127.0.0.1:0"});
    if (!elsewhere) return tl::unexpected(elsewhere.error());
    if (!globals.quiet)
      fmt::print(stderr, "another program has popcutd's port; popcutd takes a free one\n");
    serves = await(*api, *elsewhere);
  }
  if (!serves) return tl::unexpected(serves.error());
  return api;
}

// The address of the page, with a word that opens it once.
Result<std::string> address_of_page(Api& api) {
  const auto page = api.has_page();
  if (!page) return tl::unexpected(page.error());
  if (!*page)
    return fail(ErrorKind::Refused, "popcutd at " + api.http().address().text(),
                "has no page; use 'popcut jobs --watch', which "
                "shows all jobs and the next command for each");
  const auto meta = api.get("/v1/meta", "popcutd");
  if (!meta) return tl::unexpected(meta.error());
  const client::Address& address = api.http().address();
  std::string base = client::text_of(*meta, "page_url");
  if (address.path.empty()) base = fmt::format("http://{}/", address.host_header());
  if (base.empty())
    return fail(ErrorKind::Refused, "popcutd at " + address.text(),
                "listens on no TCP address, and a browser needs one; add for example "
                "listen = [\"127.0.0.1:8631\"] to popcutd.toml");
  const auto answer = api.post("/v1/session/one-shot", Json::object(), "session");
  if (!answer) return tl::unexpected(answer.error());
  return base + "#t=" + client::text_of(*answer, "one_shot");
}

Result<void> open_page(bool print_only, const Globals& globals) {
  auto api = api_of_running(globals);
  if (!api) return tl::unexpected(api.error());
  const auto url = address_of_page(*api);
  if (!url) return tl::unexpected(url.error());
  if (globals.json) {
    print_json(Json{{"url", *url}});
    return {};
  }
  const bool has_screen = is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
  // The word is not printed where a browser takes it: what is printed may end up in a log.
  if (!print_only && has_screen && run_apart({"xdg-open", *url}, kBrowser_s)) {
    if (!globals.quiet) fmt::print("opened {}\n", url->substr(0, url->find('#')));
    return {};
  }
  fmt::print("{}\n", *url);
  if (!globals.quiet)
    fmt::print(stderr,
               "{}open this address in a browser on this computer within a minute; it "
               "works once\n",
               print_only || !has_screen ? "" : "no browser was found; ");
  return {};
}

constexpr const char* kOpenHelp =
    "Open popcutd's page in the browser.\n\n"
    "If no popcutd runs, popcut starts one in the background. If another program uses the usual\n"
    "port, popcutd takes a free one.\n\n"
    "  popcut open\n"
    "  popcut open --print     # print the address, which works once, within a minute\n\n"
    "The page has the role that you have. On a tablet, open the address of popcutd and type the\n"
    "code that the tablet shows into your page.";

}  // namespace
}  // namespace open_command

void register_open(const Command& app, const Globals& globals, Run& run) {
  using namespace open_command;
  const Command open = app.add_command("open", kOpenHelp);
  auto print_only = std::make_shared<bool>(false);
  open.add_flag("--print", *print_only, "Print the address; do not open it");
  when_chosen(open, run, [print_only, &globals] { return open_page(*print_only, globals); });
}

}  // namespace popcut::cli
