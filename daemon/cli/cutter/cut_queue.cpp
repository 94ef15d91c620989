// SPDX-License-Identifier: MIT
#include "daemon/cli/cutter/cut_queue.hpp"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/design/spec/spec.hpp"
#include "core/formats/fold/crease_pattern.hpp"
#include "core/text/gzip.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/input/drawing_input.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/cli/view/job_follow.hpp"
#include "daemon/cli/view/job_view.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/cli/view/progress_bar.hpp"
#include "daemon/client/api.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/pictures/pdf_page.hpp"

namespace popcut::cli {
namespace {

using client::Api;
using OrderedJson = nlohmann::ordered_json;

constexpr std::uintmax_t kMostDesignBytes = std::uintmax_t{1} << 30;

struct Upload {
  std::string bytes, media_type;
};

bool is_asset(const OrderedJson& object) {
  const auto type = object.find("type"), file = object.find("file");
  return type != object.end() && file != object.end() && file->is_string() &&
         (*type == "mesh" || *type == "grid");
}

/// Puts the id of the uploaded file in place of each name, relative to the spec's folder.
Result<void> upload_assets(Api& api, OrderedJson& value, const std::string& pointer,
                           const std::string& spec_file, const Globals& globals, bool& changed) {
  if (value.is_object() && is_asset(value)) {
    const auto name = value["file"].get<std::string>();
    const auto path = std::filesystem::path(spec_file).parent_path() / name;
    const auto bytes = read_model_file(path);
    if (!bytes) return tl::unexpected(within(spec_file, within(pointer + "/file", bytes.error())));
    if (!globals.quiet)
      fmt::print(stderr, "uploading {} ({} bytes)\n", path.string(), bytes->size());
    const auto asset = api.upload("/v1/assets", *bytes, "application/octet-stream", path.string());
    if (!asset) return tl::unexpected(asset.error());
    value["file"] = client::text_of(*asset, "id");
    changed = true;
    return {};
  }
  if (!value.is_structured()) return {};
  for (auto it = value.begin(); it != value.end(); ++it) {
    const std::string below = value.is_object()
                                  ? pointer + "/" + it.key()
                                  : fmt::format("{}/{}", pointer, std::distance(value.begin(), it));
    if (auto done = upload_assets(api, *it, below, spec_file, globals, changed); !done) return done;
  }
  return {};
}

Result<Upload> from_json(Api& api, std::string text, const std::string& file,
                         const Globals& globals) {
  // popcutd checks a pattern; a spec is small, so its errors are reported at once.
  if (text.find("\"vertices_coords\"") != std::string::npos)
    return Upload{std::move(text), "application/json"};
  if (const auto spec = parse_design_spec(text); !spec)
    return tl::unexpected(within(file, spec.error()));
  OrderedJson json = OrderedJson::parse(text);
  bool changed = false;
  if (auto done = upload_assets(api, json, "", file, globals, changed); !done)
    return tl::unexpected(done.error());
  return Upload{changed ? json.dump() : std::move(text), "application/json"};
}

Result<Upload> read_input(Api& api, const std::string& file, const Globals& globals) {
  auto text = read_file(file, kMostDesignBytes);
  if (!text) return tl::unexpected(text.error());
  const std::string ending = lower(std::filesystem::path(file).extension().string());
  if (is_gzip(*text)) text = unpacked(*text, kMostDesignBytes);
  if (text && is_crease_pattern(*text)) text = fold_of_crease_pattern(*text);
  if (!text) return tl::unexpected(within(file, text.error()));
  if (pictures::is_pdf(*text)) return Upload{std::move(*text), "application/pdf"};
  if (ending == ".dxf") return Upload{std::move(*text), "application/dxf"};
  if (ending == ".svg" || ending == ".svgz") return Upload{std::move(*text), "image/svg+xml"};
  const std::size_t first = text->find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first != std::string::npos && (*text)[first] == '<')
    return Upload{std::move(*text), "image/svg+xml"};
  if (first != std::string::npos && (*text)[first] == '{')
    return from_json(api, std::move(*text), file, globals);
  return tl::unexpected(neither_design_nor_drawing(file, *text));
}

/// The file's name as a job's: bytes that are no UTF-8, and controls, are replaced.
std::string name_of_file(const std::string& file) {
  const nlohmann::json stem = std::filesystem::path(file).stem().string();
  return shown_text(nlohmann::json::parse(json_line(stem)).get<std::string>());
}

Result<nlohmann::json> queue(Api& api, const QueueRequest& request, const Globals& globals) {
  auto upload = read_input(api, request.input, globals);
  if (!upload) return tl::unexpected(upload.error());
  const std::string name = request.name.empty() ? name_of_file(request.input) : request.name;
  std::optional<LongWork> work(std::in_place, !globals.quiet,
                               fmt::format("uploading {}", request.input));
  const auto design = api.upload("/v1/designs?name=" + percent_encoded(name), upload->bytes,
                                 upload->media_type, request.input);
  if (!design) return tl::unexpected(design.error());
  work.reset();
  nlohmann::json body{{"design", client::text_of(*design, "id")}, {"name", name}};
  if (request.copies != 1) body["copies"] = request.copies;
  if (request.priority != 0) body["priority"] = request.priority;
  if (!request.material.empty()) body["material"] = request.material;
  if (!request.device.empty()) body["device"] = request.device;
  if (!request.site.empty()) body["site"] = request.site;
  if (!request.options.empty()) body["options"] = request.options;
  return api.post("/v1/jobs", body, request.input);
}

/// The only device that could cut now.
Result<std::string> only_device(Api& api) {
  const auto devices = api.list("/v1/devices", "devices");
  if (!devices) return tl::unexpected(devices.error());
  std::vector<std::string> usable;
  for (const nlohmann::json& device : *devices) {
    const std::string state = client::text_of(device, "state");
    const bool enabled = device.value("enabled", nlohmann::json(true)) == true;
    if (enabled && state != "absent" && state != "offline")
      usable.push_back(client::text_of(device, "id"));
  }
  if (usable.size() == 1) return usable.front();
  if (usable.empty())
    return fail(ErrorKind::Refused, "--device",
                "no cutter can be used; 'popcut devices' shows why");
  return fail(
      ErrorKind::Usage, "--device",
      fmt::format("is missing; choose one of {}: {}", usable.size(), fmt::join(usable, ", ")));
}

constexpr double kPlanWaitSeconds = 10;

/// Waits for its plan, but not for long ones. Prints the warnings, or why there is none.
Result<void> say_plan(Api& api, const std::string& id) {
  using namespace std::chrono_literals;
  std::fflush(stdout);
  ProgressBar bar(true);
  const auto begun = std::chrono::steady_clock::now();
  for (double waited_s = 0; waited_s < kPlanWaitSeconds;
       waited_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count()) {
    const auto now = api.get("/v1/jobs/" + id, "job " + id);
    if (!now) return {};  // the next command says why
    const std::string state = client::text_of(*now, "state");
    if (state != "queued" && state != "planning") {
      bar.clear();
      for (const std::string& line : warning_lines(*now)) fmt::print(stderr, "warning: {}\n", line);
      return state == "failed" ? verdict(*now) : Result<void>{};
    }
    bar.show_time(job_summary(*now), waited_s);
    std::this_thread::sleep_for(100ms);
  }
  bar.clear();
  fmt::print(stderr, "popcutd still plans it\n");
  return {};
}

/// Prints the job, and with `wait` follows it to its end.
Result<void> see_through(Api& api, const nlohmann::json& job, bool wait, const Globals& globals) {
  const std::string id = client::text_of(job, "id");
  const auto print = [&](const nlohmann::json& now) {
    if (globals.json)
      print_json(now);
    else
      fmt::print("{}\n", id);
  };
  if (!globals.quiet) fmt::print(stderr, "queued '{}' as job {}\n", job_title(job), id);
  if (!wait) {
    print(job);
    if (!globals.quiet)
      if (auto planned = say_plan(api, id); !planned) return planned;
    if (!globals.quiet) fmt::print(stderr, "'popcut jobs --watch' shows what to do next\n");
    return {};
  }
  std::fflush(stderr);
  const auto last = follow_job(api, id, globals, [](const nlohmann::json&) { return false; });
  if (!last) return tl::unexpected(last.error());
  print(*last);
  return verdict(*last);
}

}  // namespace

Result<void> queue_cut(const QueueRequest& request, const Globals& globals) {
  return with_popcutd([&](Api& api) -> Result<void> {
    const auto job = queue(api, request, globals);
    if (!job) return tl::unexpected(job.error());
    return see_through(api, *job, request.wait, globals);
  });
}

Result<void> queue_test_cut(const QueueRequest& request, const Globals& globals) {
  return with_popcutd([&](Api& api) -> Result<void> {
    const auto device =
        request.device.empty() ? only_device(api) : Result<std::string>(request.device);
    if (!device) return tl::unexpected(device.error());
    nlohmann::json body = nlohmann::json::object();
    if (!request.material.empty()) body["material"] = request.material;
    const auto tested = api.act_on_device(*device, "test-cut", body);
    if (!tested) return tl::unexpected(tested.error());
    const std::string id = client::text_of(*tested, "test_job");
    const auto job = api.get("/v1/jobs/" + id, "job " + id);
    if (!job) return tl::unexpected(job.error());
    return see_through(api, *job, request.wait, globals);
  });
}

}  // namespace popcut::cli
