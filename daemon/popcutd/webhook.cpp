// SPDX-License-Identifier: MIT
#include "daemon/popcutd/webhook.hpp"

#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "daemon/client/http_client.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/http/api/render.hpp"
#include "daemon/model/wall_clock.hpp"
#include "daemon/store/state_folder.hpp"

namespace popcut::daemon {
namespace {

constexpr std::chrono::milliseconds kLookAnyway{30'000}, kLongestPause{300'000};
constexpr int kAtOnce = 50;

}  // namespace

Result<WebhookTarget> webhook_target(const WebhookConfig& config) {
  constexpr std::string_view kHttp = "http://";
  constexpr std::size_t kShortestSecret = 16;
  if (config.url.rfind(kHttp, 0) != 0)
    return fail(ErrorKind::OutOfRange, "webhook.url", "must begin with http://");
  const std::string rest = config.url.substr(kHttp.size());
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  WebhookTarget target{rest.substr(0, slash), slash < rest.size() ? rest.substr(slash) : "/", {}};
  const bool plain = std::all_of(target.path.begin(), target.path.end(),
                                 [](char c) { return c > ' ' && c < 0x7f && c != '#'; });
  if (!plain || !client::parse_address("http://" + target.host_port))
    return fail(
        ErrorKind::OutOfRange, "webhook.url",
        fmt::format("\"{}\" is not an address; give one such as http://localhost:9000/popcut",
                    config.url));
  if (std::find(config.allow.begin(), config.allow.end(), target.host_port) == config.allow.end())
    return fail(ErrorKind::OutOfRange, "webhook.url",
                fmt::format("{} is not allowed; add it to webhook.allow", target.host_port));
  auto secret = read_whole(config.secret_file, 4096);
  if (!secret) return tl::unexpected(within("webhook.secret_file", secret.error()));
  target.secret = secret->substr(0, secret->find_last_not_of("\n\r ") + 1);
  if (target.secret.size() < kShortestSecret)
    return fail(
        ErrorKind::OutOfRange, "webhook.secret_file",
        fmt::format("{} contains fewer than {} characters", config.secret_file, kShortestSecret));
  return target;
}

std::string webhook_signature(std::string_view secret, std::string_view timestamp,
                              std::string_view body) {
  std::string text(timestamp);
  text.push_back('.');
  text += body;
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
       reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data(), &size);
  return "sha256=" + hex_of({reinterpret_cast<const char*>(digest.data()), size});
}

struct Webhook::Impl {
  Impl(WebhookTarget where, std::string file, Source from, const Patience& granted)
      : patience(granted),
        target(std::move(where)),
        cursor_file(std::move(file)),
        source(std::move(from)),
        client({*client::parse_address("http://" + target.host_port)}, "") {
    client.set_tries(0);
    const auto kept = read_whole(cursor_file, 64);
    if (kept)
      taken = std::strtoll(kept->c_str(), nullptr, 10);
    else
      taken = source.last_event();
    thread = std::thread([this] { run(); });
  }

  void run() {
    std::chrono::milliseconds pause = patience.pause;
    while (!ended()) {
      if (!taken) taken = source.last_event();
      if (!taken) {
        rest(patience.pause, false);
        continue;
      }
      const std::vector<Event> events = source.events(*taken, kAtOnce);
      bool all = true;
      for (const Event& event : events) {
        all = !ended() && send(event);
        if (!all) break;
        taken = event.seq;
        (void)write_file(cursor_file, std::to_string(event.seq));  // at worst it is sent again
        pause = patience.pause;
      }
      if (all && !events.empty()) continue;
      rest(all ? kLookAnyway : pause, all);
      if (!all) pause = std::min(pause * 2, kLongestPause);
    }
  }

  bool send(const Event& event) {
    const std::string body = http::event_json(event);
    const std::string timestamp = std::to_string(wall_clock_ms() / 1000);
    client::HttpRequest request{"POST", target.path, body, "application/json"};
    request.seconds = patience.answer_s;
    request.most_bytes = patience.answer_bytes;
    request.headers = {{"Popcut-Event", std::to_string(event.seq)},
                       {"Popcut-Timestamp", timestamp},
                       {"Popcut-Signature", webhook_signature(target.secret, timestamp, body)}};
    const auto answer = client.ask(std::move(request));
    const bool taken_by = answer && answer->status >= 200 && answer->status < 300;
    if (taken_by == well) return taken_by;
    well = taken_by;
    source.log(
        well ? fmt::format("webhook: {} accepts events again", target.host_port)
             : fmt::format("webhook: event {} was not accepted ({}); popcutd will retry", event.seq,
                           answer ? std::to_string(answer->status) : message(answer.error())));
    return taken_by;
  }

  bool ended() {
    const std::lock_guard hold(lock);
    return stop;
  }
  void rest(std::chrono::milliseconds longest, bool until_woken) {
    std::unique_lock hold(lock);
    changed.wait_for(hold, longest, [&] { return stop || (until_woken && woken); });
    woken = false;
  }

  Patience patience;
  WebhookTarget target;
  std::string cursor_file;
  Source source;
  client::HttpClient client;
  std::optional<std::int64_t> taken{};  ///< the last event; nothing while it is not known
  bool well{true};
  std::mutex lock;
  std::condition_variable changed;
  bool stop{false}, woken{false};
  std::thread thread;
};

Webhook::Webhook(WebhookTarget target, std::string cursor_file, Source source,
                 const Patience& patience)
    : impl_(std::make_unique<Impl>(std::move(target), std::move(cursor_file), std::move(source),
                                   patience)) {}

Webhook::~Webhook() {
  {
    const std::lock_guard hold(impl_->lock);
    impl_->stop = true;
  }
  impl_->changed.notify_all();
  impl_->thread.join();
}

void Webhook::wake() {
  const std::lock_guard hold(impl_->lock);
  impl_->woken = true;
  impl_->changed.notify_all();
}

}  // namespace popcut::daemon
