// SPDX-License-Identifier: MIT
// Previews of a real popcutd: beside a cut, in the middle of its end, and that nothing stays.
#include <dirent.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"
#include "tests/support/raw_http.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/running_daemon.hpp"
#include "tests/support/small_pdf.hpp"
#include "tests/support/timing.hpp"

namespace preview_test {

using namespace popcut::testing;
using popcut::daemon::RawConnection;
using popcut::daemon::WireResponse;
using Json = nlohmann::json;

namespace {

const std::string kMore = "previews_per_s = 100000\npictures_per_s = 100000\n";

Json sphere(int slices, int units) {
  return {{"popcut", 1},
          {"surface", {{"type", "revolution"}, {"radius", "sqrt(70^2 - (y - 45)^2)"}}},
          {"units_per_slice", units},
          {"slices", slices},
          {"widths_mm", 90.0 / slices},
          {"min_panel_mm", 0.2},
          {"lattice", "conformal"}};
}

std::string wanted(const Json& spec, const std::string& quality, const std::string& more = "") {
  const std::string body = Json{{"spec", spec}, {"quality", quality}}.dump();
  return fmt::format(
      "POST /v1/preview HTTP/1.1\r\nHost: popcut\r\nContent-Type: application/json\r\n"
      "Content-Length: {}\r\n{}\r\n{}",
      body.size(), more, body);
}

/// Processes whose parent is `parent`.
std::vector<int> children_of(int parent) {
  std::vector<int> found;
  const std::string folder = fmt::format("/proc/{}/task", parent);
  for (const auto& task : std::filesystem::directory_iterator(folder)) {
    std::ifstream list(task.path() / "children");
    for (int pid = 0; list >> pid;) found.push_back(pid);
  }
  return found;
}

std::vector<std::string> files_below(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& one : std::filesystem::recursive_directory_iterator(folder))
    if (one.is_regular_file()) files.push_back(one.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// How many waits of a cutter's stream took longer than `bucket`.
long waits_above(const std::string& metrics, const std::string& bucket) {
  const auto value = [&](const std::string& name) {
    const std::size_t at = metrics.find(name + " ");
    REQUIRE(at != std::string::npos);
    return std::stol(metrics.substr(at + name.size() + 1));
  };
  return value("popcut_stream_wait_seconds_count") -
         value(fmt::format("popcut_stream_wait_seconds_bucket{{le=\"{}\"}}", bucket));
}

}  // namespace

TEST_CASE("a preview leaves no row, no event and no file", "[popcutd][preview]") {
  RunningDaemon desk(0, kMore);
  desk.open();
  const std::size_t events = desk.get("/v1/events?after=0&limit=200")["items"].size();
  const auto files = files_below(desk.daemon().state());
  RawConnection page(desk.daemon().socket());
  for (const char* quality : {"draft", "exact"}) {
    REQUIRE(page.send(wanted(sphere(6, 5), quality)));
    const WireResponse blob = page.receive();
    REQUIRE(blob.status == 200);
    CHECK(blob.headers.at("content-type") == "application/vnd.popcut.lattice");
    CHECK(blob.headers.at("cache-control") == "no-store");
    CHECK(blob.body.substr(0, 4) == "PCLB");
  }
  CHECK(desk.get("/v1/designs")["items"].empty());
  CHECK(desk.get("/v1/events?after=0&limit=200")["items"].size() == events);
  CHECK(files_below(desk.daemon().state()) == files);
}

TEST_CASE("a material of the user is known in previews and files as it is in plans",
          "[popcutd][preview]") {
  RunningDaemon desk(0, kMore);
  desk.open();
  RawConnection admin(desk.daemon().socket());
  const auto put = [&](const std::string& row, const std::string& match) {
    REQUIRE(
        admin.send(fmt::format("PUT /v1/materials/board HTTP/1.1\r\nHost: popcut\r\n"
                               "Content-Type: application/json\r\n{}\r\n"
                               "Content-Length: {}\r\n\r\n{}",
                               match, row.size(), row)));
    const WireResponse stored = admin.receive();
    INFO(stored.body);
    REQUIRE(stored.status / 100 == 2);
  };
  const auto fetch = [&](const std::string& target) {
    REQUIRE(admin.send("GET " + target + " HTTP/1.1\r\nHost: popcut\r\n\r\n"));
    return admin.receive(60);
  };
  put(R"({"like":"paper-220","title":"Board","thickness_mm":2})", "If-None-Match: *");
  Json spec = sphere(6, 5);
  spec["material"] = "board";
  // It is as thick as it is, and the least panel is its own.
  REQUIRE(admin.send(wanted(spec, "exact")));
  const WireResponse blob = admin.receive(60);
  REQUIRE(blob.status == 200);
  CHECK(blob.body.find("\"board: ") != std::string::npos);
  const auto stored = desk.ask("POST", "/v1/designs", spec.dump());
  REQUIRE(stored.status == 201);
  const std::string design = "/v1/designs/" + Json::parse(stored.body)["id"].get<std::string>();
  const WireResponse report = fetch(design + "/files/report.json");
  INFO(report.body);
  CHECK(report.status == 200);
  CHECK(report.body.find("board: ") != std::string::npos);
  const WireResponse lattice = fetch(design + "/lattice");
  CHECK(lattice.body.find("\"board: ") != std::string::npos);
  // What a page has kept is old once the material is another.
  put(R"({"like":"paper-220","title":"Board","thickness_mm":0.1})", "If-Match: \"1\"");
  CHECK(fetch(design + "/lattice").headers.at("etag") != lattice.headers.at("etag"));
  CHECK(fetch(design + "/files/report.json").headers.at("etag") != report.headers.at("etag"));
}

TEST_CASE("a page that closes at any moment leaves nothing at work",
          "[popcutd][preview][seconds]") {
  RunningDaemon desk(0, kMore);
  desk.open();
  const std::string body = wanted(sphere(50, 40), "exact");
  for (const int ms : {0, 1, 3, 10, 30, 100}) {
    RawConnection page(desk.daemon().socket());
    REQUIRE(page.send(body));
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
  }
  const auto begun = std::chrono::steady_clock::now();
  RawConnection page(desk.daemon().socket());
  REQUIRE(page.send(wanted(sphere(4, 3), "draft")));
  CHECK(page.receive().status == 200);
  CHECK(in_time(begun, 5));  // and not after six exact ones
  for (std::size_t cut = 1; cut < body.size(); cut += 97) {
    RawConnection half(desk.daemon().socket());
    REQUIRE(half.send(body.substr(0, cut)));
  }
  REQUIRE(page.send(wanted(sphere(4, 3), "draft")));
  CHECK(page.receive().status == 200);
}

TEST_CASE("a cut does not wait for a hundred previews", "[popcutd][preview][seconds]") {
  RunningDaemon desk(1, kMore + "json_bytes = 262144\nconnections = 256\n");
  desk.open();
  const std::string job = desk.ready_job(desk.design(RunningDaemon::lines_svg(300)));
  desk.cut(job);
  std::atomic<int> answered{0}, good{0};
  std::vector<std::thread> pages;
  for (int k = 0; k < 100; ++k)
    pages.emplace_back([&, k] {
      RawConnection page(desk.daemon().socket());
      const std::string key = fmt::format("Preview-Key: page-{:011}\r\n", k % 8);
      if (!page.send(wanted(sphere(20, 20), k % 2 == 0 ? "draft" : "exact", key))) return;
      const WireResponse response = page.receive(60);
      ++answered;
      if (response.status == 200) ++good;
    });
  for (std::thread& page : pages) page.join();
  CHECK(answered == 100);
  CHECK(good > 0);
  const std::string metrics = desk.ask("GET", "/metrics").body;
  INFO(metrics.substr(metrics.find("popcut_stream_wait_seconds"), 800));
  // All previews together take many seconds; on a busy computer a turn alone may take a tenth.
  if (judges_time()) CHECK(waits_above(metrics, "1") == 0);
  const Json state = desk.job(job)["state"];
  CHECK((state == "cutting" || state == "done"));
  CHECK(children_of(desk.daemon().pid()).size() <= 2);
}

TEST_CASE("popcutd that ends during previews leaves no process", "[popcutd][preview][seconds]") {
  for (const int signal : {SIGTERM, SIGKILL}) {
    RunningDaemon desk(0, kMore);
    desk.open();
    RawConnection page(desk.daemon().socket());
    REQUIRE(page.send(wanted(sphere(50, 40), "exact")));
    std::vector<int> workers;
    REQUIRE(comes_true([&] {
      workers = children_of(desk.daemon().pid());
      return workers.size() == 1;
    }));
    const int worker = workers.front();
    const auto begun = std::chrono::steady_clock::now();
    desk.daemon().signal(signal);
    const int code = desk.daemon().wait();
    CHECK(code == (signal == SIGTERM ? 0 : 128 + SIGKILL));
    CHECK(in_time(begun, 10));
    CHECK(comes_true([&] { return ::kill(worker, 0) != 0; }));
  }
}

TEST_CASE("the lattice of a stored design is kept by who has it", "[popcutd][preview]") {
  RunningDaemon desk(0, kMore);
  desk.open();
  const auto made = desk.ask("POST", "/v1/designs", sphere(6, 5).dump());
  REQUIRE(made.status == 201);
  const std::string id = Json::parse(made.body)["id"];
  RawConnection page(desk.daemon().socket());
  const auto get = [&](const std::string& more) {
    REQUIRE(page.send("GET /v1/designs/" + id + "/lattice HTTP/1.1\r\nHost: popcut\r\n" + more +
                      "\r\n"));
    return page.receive();
  };
  const WireResponse first = get("");
  CHECK(first.status == 200);
  CHECK(first.body.substr(0, 4) == "PCLB");
  const std::string etag = first.headers.at("etag");
  const WireResponse again = get("If-None-Match: " + etag + "\r\n");
  CHECK(again.status == 304);
  CHECK(again.headers.at("etag") == etag);
  CHECK(again.headers.at("cache-control") == "private, max-age=86400");
  CHECK(get("").body == first.body);
}

TEST_CASE("a PDF is a design like any drawing", "[popcutd][preview][pdf]") {
  RunningDaemon desk(0, kMore);
  desk.open();
  const std::string pdf = small_pdf(
      {"/OC /L0 BDC 72 72 144 144 re S EMC /OC /L1 BDC 72 144 m 216 144 l S EMC"}, {"Cut", "Fold"});
  const auto made = desk.ask("POST", "/v1/designs?name=card", pdf, "application/pdf");
  CAPTURE(made.body);
  REQUIRE(made.status == 201);
  const Json design = Json::parse(made.body);
  CHECK(design["kind"] == "pdf");
  const std::string id = design["id"].get<std::string>();
  for (const char* name : {"preview.svg", "deployed.svg", "pattern.svg", "lattice"}) {
    CAPTURE(name);
    CHECK(desk.ask("GET", "/v1/designs/" + id + "/" + name).status == 200);
  }
  CHECK(desk.ask("GET", "/v1/designs/" + id + "/content").body == pdf);
  const auto broken = desk.ask("POST", "/v1/designs", "%PDF-1.4 nothing", "application/pdf");
  CHECK(broken.status == 422);
  CHECK(broken.body.find("is a PDF that cannot be read") != std::string::npos);
}

TEST_CASE("pictures are made once, kept, and gone with their design", "[popcutd][preview]") {
  RunningDaemon desk(0, kMore);
  desk.open();
  const auto upload = [&](const Json& spec) {
    const auto made = desk.ask("POST", "/v1/designs", spec.dump());
    REQUIRE(made.status == 201);
    return Json::parse(made.body)["id"].get<std::string>();
  };
  const std::string id = upload(sphere(6, 5));
  RawConnection page(desk.daemon().socket());
  const auto get = [&](const std::string& design, const std::string& name,
                       const std::string& more = "") {
    REQUIRE(page.send("GET /v1/designs/" + design + "/" + name + " HTTP/1.1\r\nHost: popcut\r\n" +
                      more + "\r\n"));
    return page.receive();
  };
  for (const char* name : {"deployed.svg", "pattern.svg", "preview.svg"}) {
    CAPTURE(name);
    const WireResponse picture = get(id, name);
    CHECK(picture.status == 200);
    CHECK(picture.headers.at("content-type") == "image/svg+xml");
    CHECK(picture.headers.at("content-security-policy").find("sandbox") != std::string::npos);
    CHECK(picture.headers.at("cache-control") == "private, max-age=86400");
    const std::string etag = picture.headers.at("etag");
    CHECK(get(id, name, "If-None-Match: " + etag + "\r\n").status == 304);
    CHECK(get(id, name).body == picture.body);
  }
  const auto kept = [&](const std::string& design) {
    const auto files = files_below(desk.daemon().state() + "/previews");
    return std::count_if(files.begin(), files.end(), [&](const std::string& file) {
      return file.find(design) != std::string::npos;
    });
  };
  CHECK(kept(id) == 3);
  // One that cannot be made has a picture that says so, and is not tried again.
  Json never = sphere(6, 5);
  never["surface"]["radius"] = "0 - 5";
  const std::string wrong = upload(never);
  const WireResponse none = get(wrong, "deployed.svg");
  CHECK(none.status == 200);
  CHECK(none.body.find("no preview") != std::string::npos);
  CHECK(kept(wrong) == 3);
  CHECK(desk.ask("DELETE", "/v1/designs/" + id).status == 204);
  CHECK(comes_true([&] { return kept(id) == 0; }));
  CHECK(get(id, "deployed.svg").status == 404);
}

TEST_CASE("files of a design are those of popcut design, byte for byte", "[popcutd][preview]") {
  RunningDaemon desk(0, kMore);
  desk.open();
  Json spec = sphere(6, 5);
  spec["name"] = "a <ball> & more";
  const auto made = desk.ask("POST", "/v1/designs", spec.dump());
  REQUIRE(made.status == 201);
  const std::string id = Json::parse(made.body)["id"];
  const std::filesystem::path folder = desk.daemon().folder() / "files";
  write_file(desk.daemon().folder() / "spec.json", spec.dump());
  const Ran ran = run_program({popcut_program(), "design", "spec.json", "-q", "-o", folder.string(),
                               "--formats", "fold,svg,cut,dxf,csv,glb,stl,picture,poster,report"},
                              desk.daemon().folder() / "");
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  REQUIRE(run_program({popcut_program(), "fold-guide", "spec.json", "-q", "-o", folder.string()},
                      desk.daemon().folder() / "")
              .exit == 0);
  RawConnection page(desk.daemon().socket());
  const auto get = [&](const std::string& name, const std::string& more = "") {
    REQUIRE(page.send("GET /v1/designs/" + id + "/files/" + name + " HTTP/1.1\r\nHost: popcut\r\n" +
                      more + "\r\n"));
    return page.receive();
  };
  std::filesystem::copy_file(folder / "deploy/psi_060.stl", folder / "deployed.stl");
  for (const char* name :
       {"pattern.fold", "pattern.svg", "cut.svg", "pattern.dxf", "segments.csv", "deploy.glb",
        "deployed.stl", "deployed.svg", "poster.svg", "fold-guide.json"}) {
    CAPTURE(name);
    const WireResponse file = get(name);
    CHECK(file.status == 200);
    CHECK(file.headers.at("content-disposition") ==
          std::string("attachment; filename=\"") + name + "\"");
    CHECK(file.body == text_of_file(folder / name));
    CHECK(get(name, "If-None-Match: " + file.headers.at("etag") + "\r\n").status == 304);
  }
  // Only how long it took is not the same.
  Json report = Json::parse(get("report.json").body),
       expected = Json::parse(text_of_file(folder / "report.json"));
  report.erase("seconds");
  expected.erase("seconds");
  CHECK(report == expected);
  CHECK(get("spec.json").body == spec.dump());
  for (const char* name : {"preview.svg", "pattern.exe", "unsound.json", "..."})
    CHECK(get(name).status == 404);
  CHECK(get("..%2fpopcut.db").status == 400);
  CHECK(get("cut.svg?part=2").status == 422);
  CHECK(get("cut.svg?part=0").status == 422);
  const std::string drawing = desk.design(RunningDaemon::lines_svg(3));
  CHECK(desk.ask("GET", "/v1/designs/" + drawing + "/files/pattern.fold").status == 404);
}

namespace {

/// The rows of a PDF's page above its bar, in grey (poppler).
std::string rows_above_bar(const std::filesystem::path& folder, const std::string& pdf) {
  const Ran ran =
      run_program({"/usr/bin/pdftoppm", "-r", "72", "-gray", "-singlefile", pdf, "page"}, folder);
  CAPTURE(ran.err);
  REQUIRE(ran.exit == 0);
  const std::string page = text_of_file(folder / "page.pgm");
  return page.substr(0, page.size() * 9 / 10);
}

}  // namespace

TEST_CASE("the artwork of a planned sheet is that of popcut print, and so is the program",
          "[popcutd][preview][artwork]") {
  RunningDaemon desk(0, kMore);
  desk.open();
  const std::filesystem::path folder = desk.daemon().folder().path();
  // A house with its roof in another colour.
  std::string obj;
  for (const char* corner :
       {"40 10 0", "40 60 0", "40 60 40", "40 10 40", "40 35 65", "0 10 40", "0 35 65", "0 60 40"})
    obj += fmt::format("v {} {}\n", corner, corner[0] == '0' ? "0.9 0.3 0.1" : "0.1 0.4 0.8");
  obj += "f 1 2 3 4\nf 4 3 5\nf 6 4 5 7\nf 8 7 5 3\n";
  write_file(folder / "house.obj", obj);
  Json spec{
      {"popcut", 1}, {"style", "facets"}, {"surface", {{"type", "mesh"}, {"file", "house.obj"}}}};
  write_file(folder / "house.json", spec.dump());
  const Ran ran = run_program({popcut_program(), "print", "house.json", "--machine", "cameo3",
                               "--dpi", "100", "-q", "-o", "printed"},
                              folder);
  INFO(ran.err);
  REQUIRE(ran.exit == 0);

  const auto put = [&](const std::string& target, const std::string& bytes,
                       const std::string& type) {
    const auto made = desk.ask("POST", target, bytes, type);
    REQUIRE((made.status == 201 || made.status == 202));
    return Json::parse(made.body)["id"].get<std::string>();
  };
  spec["surface"]["file"] = put("/v1/assets?name=house.obj", obj, "application/octet-stream");
  const std::string design = put("/v1/designs", spec.dump(), "application/json");
  const std::string plan =
      put("/v1/designs/" + design + "/plan", R"({"machine": "cameo3", "options": {"marks": true}})",
          "application/json");
  const std::string sheets = "/v1/plans/" + plan + "/sheets/";
  REQUIRE(happens([&] { return desk.get("/v1/plans/" + plan)["state"] == "planned"; }));
  CHECK(desk.ask("GET", sheets + "1/program").body ==
        text_of_file(folder / "printed/sheet-01.gpgl"));
  const auto page = desk.ask("GET", sheets + "1/artwork.pdf?dpi=100");
  REQUIRE(page.status == 200);
  write_file(folder / "page.pdf", page.body);
  const std::string shown = rows_above_bar(folder, "page.pdf");
  CHECK(shown == rows_above_bar(folder, "printed/sheet-01.pdf"));
  const auto grey = [&](int least, int most) {
    return std::count_if(shown.begin(), shown.end(), [&](char pixel) {
      return static_cast<unsigned char>(pixel) >= least &&
             static_cast<unsigned char>(pixel) <= most;
    });
  };
  CHECK(grey(60, 160) > 5000);  // the house
  CHECK(grey(0, 20) > 100);     // the marks

  const auto refused = [&](const std::string& target, int status, const std::string& words) {
    const auto answer = desk.ask("GET", target);
    CHECK(answer.status == status);
    CHECK_THAT(answer.body, Catch::Contains(words));
  };
  refused(sheets + "2/artwork.pdf", 404, "no sheet 2");
  refused(sheets + "1/artwork.pdf?mode=flat", 422, "?mode");
  refused(sheets + "1/artwork.pdf?dpi=5", 422, "?dpi");
  refused(sheets + "1/artwork.pdf?model=vase", 404, "no asset");
  const std::string named =
      put("/v1/assets?name=named.obj", "mtllib a.mtl\n" + obj, "application/octet-stream");
  refused(sheets + "1/artwork.pdf?model=" + named, 422, "as one GLB");
  const std::string picture =
      put("/v1/assets?name=a.png", "\x89PNG\r\n\x1a\n" + std::string(500, '\0'),
          "application/octet-stream");
  refused(sheets + "1/artwork.pdf?model=" + picture, 422,
          "?model: is a PNG picture; give a 3D model");
  const std::string away =
      put("/v1/assets?name=away.obj", "v 900 900 900\nv 920 900 900\nv 900 920 900\nf 1 2 3\n",
          "application/octet-stream");
  refused(sheets + "1/artwork.pdf?model=" + away, 422, "nothing of the model is seen");
  const std::string drawing = desk.design(RunningDaemon::lines_svg(3));
  const std::string drawn =
      put("/v1/designs/" + drawing + "/plan", R"({"machine": "cameo3"})", "application/json");
  REQUIRE(happens([&] { return desk.get("/v1/plans/" + drawn)["state"] == "planned"; }));
  refused("/v1/plans/" + drawn + "/sheets/1/artwork.pdf", 404, "of a drawing");
}

namespace {

/// The JSON before the arrays of a lattice blob.
Json head_of(const std::string& blob) {
  REQUIRE(blob.substr(0, 4) == "PCLB");
  const auto byte = [&](std::size_t at) {
    return static_cast<std::size_t>(static_cast<unsigned char>(blob.at(at)));
  };
  return Json::parse(blob.substr(12, byte(8) + (byte(9) << 8) + (byte(10) << 16)));
}

Json wood(const char* layers) {
  return {
      {"popcut", 1},
      {"name", "wood"},
      {"style", "layers"},
      {"surface",
       {{"type", "implicit"},
        {"f", "min(sqrt((x-60)^2+(y-30)^2+(z-20)^2)-18,max(abs(x-25)-5,max(abs(y-45)-30,z-50)))"}}},
      {"layers", Json::parse(layers)}};
}

}  // namespace

TEST_CASE("a card of layers is shown, kept, exported, planned and printed with all its parts",
          "[popcutd][preview][parts]") {
  RunningDaemon desk(0, kMore);
  desk.open();
  const std::filesystem::path folder = desk.daemon().folder().path();
  const Json spec = wood(R"({"layers": 3, "length_mm": 80})");
  RawConnection page(desk.daemon().socket());
  for (const char* quality : {"draft", "exact"}) {
    // With sanitizers it takes more than the 10 s that popcutd allows a draft.
    if (kWithSanitizer && std::string_view(quality) == "draft") continue;
    CAPTURE(quality);
    REQUIRE(page.send(wanted(spec, quality)));
    const WireResponse blob = page.receive();
    REQUIRE(blob.status == 200);
    const Json head = head_of(blob.body);
    CHECK(head["quality"] == quality);
    CHECK(head["motion"] == "frames");
    CHECK(head["report"]["style"] == "layers");
    REQUIRE(head["parts"].size() == head["report"]["pieces"]);
    CHECK(head["parts"][0]["name"] == "card");
    CHECK(head["parts"][1]["name"] == "layer-1");
    CHECK(head["parts"][1]["tabs"] == 2);
    CHECK(head["arrays"].contains("face_part"));
  }
  // So is a house of boxes.
  const auto house =
      desk.ask("POST", "/v1/assets?name=house.glb", text_of_file(source_file("examples/house.glb")),
               "application/octet-stream");
  REQUIRE(house.status == 201);
  REQUIRE(
      page.send(wanted({{"popcut", 1},
                        {"style", "boxes"},
                        {"surface", {{"type", "mesh"}, {"file", Json::parse(house.body)["id"]}}},
                        {"scale_mm", 1000},
                        {"rotate_deg", {90, 0, 90}}},
                       "exact")));
  const WireResponse boxes = page.receive();
  CAPTURE(boxes.body.substr(0, 300));
  REQUIRE(boxes.status == 200);
  CHECK(head_of(boxes.body)["report"]["style"] == "boxes");
  CHECK(head_of(boxes.body)["parts"][1]["name"] == "box-1");
  // What cannot be made is an error at the place in the spec.
  REQUIRE(page.send(wanted(wood(R"({"length_mm": 80, "spine_mm": 50})"), "exact")));
  const WireResponse narrow = page.receive();
  CHECK(narrow.status == 422);
  CHECK_THAT(narrow.body,
             Catch::Contains(R"("pointer":"/layers/spine_mm")") && Catch::Contains("at least"));

  const auto put = [&](const std::string& target, const std::string& bytes) {
    const auto made = desk.ask("POST", target, bytes);
    REQUIRE((made.status == 201 || made.status == 202));
    return "/v1/designs/" + Json::parse(made.body)["id"].get<std::string>();
  };
  const std::string design = put("/v1/designs", spec.dump());
  const Json stored = head_of(desk.ask("GET", design + "/lattice").body);
  CHECK(stored["quality"] == "stored");
  CHECK(stored["parts"].size() == 4);
  CHECK_THAT(desk.ask("GET", design + "/deployed.svg").body,
             Catch::Contains("data:image/png;base64,"));
  CHECK_THAT(desk.ask("GET", design + "/pattern.svg").body, Catch::Contains("<path"));
  write_file(folder / "spec.json", spec.dump());
  REQUIRE(run_program({popcut_program(), "design", "spec.json", "-q", "-o", "files", "--formats",
                       "fold,svg,cut,dxf,report"},
                      folder)
              .exit == 0);
  REQUIRE(run_program({popcut_program(), "fold-guide", "spec.json", "-q", "-o", "files"}, folder)
              .exit == 0);
  for (const char* name : {"pattern.fold", "cut.svg", "pattern.dxf", "fold-guide.json"}) {
    CAPTURE(name);
    const auto file = desk.ask("GET", design + "/files/" + name);
    CHECK(file.status == 200);
    CHECK(file.body == text_of_file(folder / "files" / name));
  }
  Json report = Json::parse(desk.ask("GET", design + "/files/report.json").body),
       expected = Json::parse(text_of_file(folder / "files/report.json"));
  report.erase("seconds");
  expected.erase("seconds");
  CHECK(report == expected);
  const auto animation = desk.ask("GET", design + "/files/deploy.glb");
  CHECK(animation.status == 422);
  CHECK_THAT(animation.body, Catch::Contains("is for cards of one sheet"));

  // Its file from elsewhere: what verify says of it, and the same parts.
  const std::string file = put("/v1/designs", text_of_file(folder / "files/pattern.fold"));
  const Json opened = head_of(desk.ask("GET", file + "/lattice").body);
  CHECK(opened["parts"] == stored["parts"]);
  CHECK(opened["warnings"].empty());
  for (const char* check : {"joints", "tabs", "opening", "degrees_of_freedom", "crossing"})
    CHECK(std::count(opened["judged"].begin(), opened["judged"].end(), check) == 1);

  const auto planned =
      desk.ask("POST", design + "/plan", R"({"machine": "cameo3", "options": {"marks": true}})");
  REQUIRE(planned.status == 202);
  const std::string plan = "/v1/plans/" + Json::parse(planned.body)["id"].get<std::string>();
  REQUIRE(happens([&] { return desk.get(plan)["state"] == "planned"; }));
  CHECK(desk.get(plan)["handwork"]["tabs"] == 6);
  const auto printed = desk.ask("GET", plan + "/sheets/1/artwork.pdf?dpi=60");
  CHECK(printed.status == 200);
  CHECK(printed.body.substr(0, 5) == "%PDF-");
}

}  // namespace preview_test
