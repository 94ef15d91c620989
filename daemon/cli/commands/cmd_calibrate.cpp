// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "core/calibrate/measured.hpp"
#include "core/hands/strip.hpp"
#include "core/layout/sheet.hpp"
#include "core/plan/knife/blade.hpp"
#include "core/print/pages.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/cutter/cut_device.hpp"
#include "daemon/cli/cutter/cut_session.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/files/user_tables.hpp"
#include "daemon/pictures/pdf.hpp"
#include "device/session/session.hpp"

namespace popcut::cli {
namespace calibrate_command {
namespace {

namespace measure = popcut::calibrate;

struct Options {
  std::string device, machine, treat_as, name, material{"paper-220"}, mat, steps, folder;
  bool autoblade{false}, hands{false};
  std::string times;
};

constexpr const char* kSteps = "axes,ruler,time,force";

/// The conversation with the person at the machine.
class Person {
 public:
  /// A line of the person's; an error at the end of the input.
  [[nodiscard]] Result<std::string> line(const std::string& question) const {
    fmt::print(stderr, "{} ", question);
    std::fflush(stderr);
    std::string answer;
    if (std::getline(std::cin, answer)) {
      if (isatty(STDIN_FILENO) != 1) fmt::print(stderr, "{}\n", shown_text(answer));
      return answer;
    }
    fmt::print(stderr, "\n");
    return fail(ErrorKind::Refused, "", "stopped without an answer; your table is as it was");
  }

  /// A number from `least` to `most`; asks again until it is one.
  [[nodiscard]] Result<double> number(const std::string& question, double least,
                                      double most) const {
    for (;;) {
      const auto answer = line(question);
      if (!answer) return tl::unexpected(answer.error());
      std::string text = *answer;
      std::replace(text.begin(), text.end(), ',', '.');
      try {
        std::size_t end = 0;
        const double value = std::stod(text, &end);
        if (end == text.size() && value >= least && value <= most) return value;
      } catch (const std::exception&) {  // not a number
      }
      fmt::print(stderr, "  give a number from {:g} to {:g}\n", least, most);
    }
  }

  [[nodiscard]] Result<measure::Way> way(const std::string& question) const {
    constexpr std::array<std::string_view, 4> kWays{"right", "left", "up", "down"};
    for (;;) {
      const auto answer = line(question + " [right/left/up/down]");
      if (!answer) return tl::unexpected(answer.error());
      for (std::size_t k = 0; k < kWays.size(); ++k)
        if (!answer->empty() && kWays[k].starts_with(*answer)) return static_cast<measure::Way>(k);
      fmt::print(stderr, "  answer right, left, up or down\n");
    }
  }

  [[nodiscard]] Result<bool> yes(const std::string& question) const {
    return line(question + " [y/N]").map([](const std::string& answer) {
      return answer == "y" || answer == "Y" || answer == "yes";
    });
  }
};

/// One evening at a machine.
class Calibration {
 public:
  Calibration(const Options& options, const Globals& globals, CutTarget target, Machine machine,
              Material material, Mat mat, std::optional<OutputFolder> folder)
      : options_(options),
        globals_(globals),
        target_(std::move(target)),
        known_(std::move(machine)),
        material_(std::move(material)),
        mat_(std::move(mat)),
        folder_(std::move(folder)) {}

  [[nodiscard]] const measure::Measured& measured() const { return measured_; }

  Result<Machine> run() {
    using Step = Result<void> (Calibration::*)();
    const std::array<std::pair<std::string_view, Step>, 4> steps{{{"axes", &Calibration::axes},
                                                                  {"ruler", &Calibration::ruler},
                                                                  {"time", &Calibration::time},
                                                                  {"force", &Calibration::force}}};
    for (const auto& [name, step] : steps)
      if (wanted(name))
        if (const auto done = (this->*step)(); !done) return tl::unexpected(done.error());
    if (folder_)
      if (const auto kept = folder_->commit("popcut calibrate " POPCUT_VERSION); !kept)
        return tl::unexpected(kept.error());
    return known_;
  }

 private:
  [[nodiscard]] bool wanted(std::string_view step) const {
    std::string_view list = options_.steps;
    while (!list.empty())
      if (take_word(list, ",") == step) return true;
    return false;
  }
  [[nodiscard]] std::array<double, 2> area() const { return {mat_.width_mm, mat_.length_mm}; }
  [[nodiscard]] double blade_offset_mm() const {
    return known_.firmware_blade_offset ? material_.blade_offset_mm : 0;
  }

  /// What the axis has to do so that the tip of the blade cuts `path`.
  [[nodiscard]] Toolpath for_the_axis(const Toolpath& path) const {
    const double offset = host_blade_offset_mm(known_, material_);
    if (offset <= 0) return path;
    Toolpath axis;
    Blade blade{.offset_mm = offset};
    for (Stroke stroke : path.strokes) {
      const auto first = static_cast<std::uint32_t>(axis.points.size());
      append_axis_path(path.points_of(stroke), blade, axis.points);
      stroke.first = first;
      stroke.count = static_cast<std::uint32_t>(axis.points.size()) - first;
      axis.strokes.push_back(stroke);
    }
    return axis;
  }

  [[nodiscard]] Result<void> load(const std::string& what, double minutes) const {
    const auto ready = person_.line(fmt::format(
        "\n{}\nLoad a sheet ({}, at least {:g} x {:g} mm{}), then press Enter to cut, about {:.0f} "
        "min.",
        what, material_.title, mat_.width_mm, mat_.length_mm,
        on_a_mat() ? ", on the " + mat_.name + " mat" : "", std::ceil(minutes)));
    if (!ready) return tl::unexpected(ready.error());
    if (!ready->empty())
      return fail(ErrorKind::Refused, "", "stopped as you asked; your table is as it was");
    return {};
  }

  Result<SessionEnd> cut(const Toolpath& path, const std::string& name, const Material& material) {
    JobOptions job = on_mat(mat_);
    if (!mat_.code) job.mat_code.reset();
    job.autoblade = options_.autoblade && known_.autoblade;
    job.track_enhancing = false;
    const auto program = encode(path, known_, material, job);
    if (!program) return tl::unexpected(program.error());
    SessionOptions how;
    how.poll_s = 0.1;
    how.timed = true;
    auto sent = send_program(target_, known_, {*program, name, area(), 30}, !globals_.quiet, how);
    if (!sent) return tl::unexpected(sent.error());
    SessionEnd& end = sent->end;
    if (folder_) {
      const char* ending = program->dialect == Dialect::Hpgl ? "hpgl" : "gpgl";
      if (const auto kept = folder_->add(fmt::format("{}.{}", name, ending), program->bytes); !kept)
        return tl::unexpected(kept.error());
      if (sent->trace)
        if (const auto kept = folder_->add(name + ".svg", trace_svg(*sent->trace)); !kept)
          return tl::unexpected(kept.error());
    }
    if (end.error) return tl::unexpected(within(name, *end.error));
    if (end.cancelled || sent->stop_asked)
      return fail(ErrorKind::Refused, name,
                  "stopped as you asked, with the tool up and parked; your table is as it was");
    return std::move(end);
  }
  Result<void> cut(const Toolpath& path, const std::string& name) {
    return cut(for_the_axis(path), name, material_).map([](const SessionEnd&) {});
  }

  Result<void> axes() {
    if (const auto ready = load("Axes: two short lines from one corner. The line with one tick at "
                                "its end should run to the right, the line with two ticks down.",
                                0.2);
        !ready)
      return ready;
    if (const auto done = cut(measure::short_angle().path(material_.cut), "axes"); !done)
      return done;
    fmt::print(
        stderr,
        "Look at the sheet with the cut side up, and the edge that went in first away from you.\n");
    for (;;) {
      const auto one = person_.way("From the corner, the line with one tick runs");
      if (!one) return tl::unexpected(one.error());
      const auto two = person_.way("The line with two ticks runs");
      if (!two) return tl::unexpected(two.error());
      const auto found = measure::with_ways(known_, *one, *two);
      if (!found) {
        fmt::print(stderr, "  {}\n", message(found.error()));
        continue;
      }
      const bool same = found->axes == known_.axes && found->mirrored == known_.mirrored;
      fmt::print(stderr, "  axes     {}\n",
                 same ? "as popcut thought"
                      : fmt::format("{}{}; popcut thought {}{}", axes_name(found->axes),
                                    found->mirrored ? ", mirrored" : "", axes_name(known_.axes),
                                    known_.mirrored ? ", mirrored" : ""));
      known_ = *found;
      measured_.axes = true;
      return {};
    }
  }

  Result<void> ruler() {
    const auto angle = measure::long_angle(area());
    if (!angle) return tl::unexpected(angle.error());
    if (const auto ready = load("Ruler: the same lines, longer, to measure. Take a new sheet, and "
                                "a steel ruler.",
                                0.5);
        !ready)
      return ready;
    if (const auto done = cut(angle->path(material_.cut), "ruler"); !done) return done;
    fmt::print(stderr, "Measure in mm, to a tenth if you can.\n");
    for (;;) {
      measure::Ruled ruled;
      const std::array<std::pair<std::string, double*>, 4> questions{
          {{fmt::format("Length of the line with one tick ({:g} was sent):", angle->right_mm),
            &ruled.right_mm},
           {fmt::format("Length of the line with two ticks ({:g} was sent):", angle->down_mm),
            &ruled.down_mm},
           {fmt::format("From the {} left edge to the corner ({:g} was sent):", sheet_or_mat(),
                        angle->corner.x),
            &ruled.from_left_mm},
           {fmt::format("From the {} upper edge to the corner ({:g} was sent):", sheet_or_mat(),
                        angle->corner.y),
            &ruled.from_top_mm}}};
      for (const auto& [question, mm] : questions) {
        const auto answer = person_.number(question, -100, 10'000);
        if (!answer) return tl::unexpected(answer.error());
        *mm = *answer;
      }
      std::vector<std::string> remarks;
      const auto found = measure::with_ruled(known_, *angle, ruled, mat_.length_mm, remarks);
      if (!found) {
        fmt::print(stderr, "  {}\n", message(found.error()));
        continue;
      }
      known_ = *found;
      measured_.places = true;
      fmt::print(stderr,
                 "  scale    100 mm came out as {:.2f} mm along the carriage, {:.2f} mm along the "
                 "feed\n  margins  {:.2f} mm at the left, {:.2f} mm at the top\n",
                 100 * known_.scale_carriage, 100 * known_.scale_feed, known_.margin_left_mm,
                 known_.margin_top_mm);
      for (const std::string& remark : remarks) fmt::print(stderr, "  {}\n", remark);
      return square();
    }
  }

  /// A square in the corner, to see that it is right now.
  Result<void> square() {
    if (const auto ready = load("Square: 20 mm wide, 10 mm from the left and upper edge, to check. "
                                "Take a new sheet.",
                                0.2);
        !ready)
      return ready;
    if (const auto done = cut(measure::corner_square(material_.cut), "square"); !done) return done;
    const auto left = person_.number("From the left edge to the square (10 was sent):", -100, 200);
    if (!left) return tl::unexpected(left.error());
    const auto top = person_.number("From the upper edge to the square (10 was sent):", -100, 200);
    if (!top) return tl::unexpected(top.error());
    const double off = std::max(std::abs(*left - 10), std::abs(*top - 10));
    fmt::print(stderr, "  square   {:.1f} mm off{}\n", off,
               off <= 0.5 ? ""
                          : "; load each sheet against the same marks, then run 'popcut calibrate "
                            "--steps ruler' again");
    return {};
  }

  /// Whether the area is that of a mat, and not of a paper.
  [[nodiscard]] bool on_a_mat() const {
    return std::any_of(known_.mats.begin(), known_.mats.end(),
                       [&](const Mat& mat) { return mat.name == mat_.name; });
  }
  [[nodiscard]] std::string sheet_or_mat() const { return on_a_mat() ? "mat's" : "sheet's"; }

  Result<void> time() {
    const auto runs = measure::timed_runs(known_, material_.cut, area());
    if (!runs) return tl::unexpected(runs.error());
    double seconds = 0;
    for (const auto& run : *runs)
      seconds += measure::run_seconds(run, known_, blade_offset_mm()) + 5;
    const bool answers = known_.language == "gpgl";
    if (const auto ready =
            load(fmt::format("Time: {} short runs{}. Take a new sheet; it is cut up afterwards.",
                             runs->size(),
                             answers ? ", which popcut times itself"
                                     : ". This machine reports nothing, so have a stopwatch ready"),
                 seconds / 60);
        !ready)
      return ready;
    std::vector<measure::Timing> timings;
    std::vector<double> trailers_s;
    double setup_s = 0;
    for (std::size_t k = 0; k < runs->size(); ++k) {
      const measure::TimedRun& run = (*runs)[k];
      if (!answers) {
        const auto ready = person_.line(
            fmt::format("Run {}, {}: press Enter, and start the watch when it begins to move.",
                        k + 1, run.name));
        if (!ready) return tl::unexpected(ready.error());
      }
      const auto end = cut(run.path, fmt::format("time-{}", k + 1), material_);
      if (!end) return tl::unexpected(end.error());
      double took = end->geometry_s;
      if (!answers) {
        const auto watched = person_.number(
            "Seconds until it had finished its last line, without the way back:", 0.5, 7200);
        if (!watched) return tl::unexpected(watched.error());
        took = *watched;
      }
      timings.push_back({&run, took});
      setup_s += end->setup_s / static_cast<double>(runs->size());
      trailers_s.push_back(end->trailer_s);
      if (!globals_.quiet)
        fmt::print(stderr, "  {:<24} {:6.1f} s, {:.1f} s expected\n", run.name, took,
                   measure::run_seconds(run, known_, blade_offset_mm()));
    }
    const auto fit = measure::fit_motion(known_, timings, blade_offset_mm());
    if (!fit) return tl::unexpected(fit.error());
    const bool taps = options_.autoblade && known_.autoblade;
    known_ = fit->machine;
    measured_.motion = true;
    if (answers) {
      if (!taps) known_.motion.setup_s = std::clamp(setup_s, 0.0, 600.0);
      double trailer_s = 0;
      for (std::size_t k = 0; k < runs->size(); ++k)
        trailer_s += measure::parking_seconds((*runs)[k], trailers_s[k], known_);
      known_.motion.trailer_s = std::min(trailer_s / static_cast<double>(runs->size()), 600.0);
    }
    fmt::print(stderr,
               "  motion   {:.0f} mm/s^2, {:.0f} mm/s with the tool up; the runs are explained "
               "within {:.1f} %, another job within {:.1f} %\n",
               known_.motion.accel_mm_s2, known_.motion.travel_mm_s, 100 * fit->worst,
               100 * fit->checked);
    return {};
  }

  Result<void> force() {
    MaterialForce found{material_.name, material_.cut.force_gf, std::nullopt};
    const auto steps = measure::force_steps(known_, material_.cut);
    if (!steps) {
      fmt::print(stderr, "\nForce: {}\n", message(steps.error()));
      return {};
    }
    if (const auto ready =
            load("Force: a row of squares, the first with the least force. Take a new sheet of "
                 "the material that you will cut.",
                 1);
        !ready)
      return ready;
    if (const auto done = cut(steps->path, "force"); !done) return done;
    const auto square = person_.number(
        fmt::format("The first square that came out clean all round: 1 to {}, or 0 for none:",
                    steps->force_gf.size()),
        0, static_cast<double>(steps->force_gf.size()));
    if (!square) return tl::unexpected(square.error());
    const auto index = static_cast<std::size_t>(std::lround(*square));
    if (index == 0) {
      fmt::print(stderr,
                 "  force    none of {:g} to {:g} gf cuts {}: use more passes (docs/knife.md), or "
                 "another blade\n",
                 steps->force_gf.front(), steps->force_gf.back(), material_.name);
      return {};
    }
    found.cut_gf = steps->force_gf[index - 1];
    fmt::print(stderr, "  force    {:g} gf for {} (popcut thought {:g})\n", found.cut_gf,
               material_.name, material_.cut.force_gf);
    if (options_.autoblade && known_.autoblade)
      if (const auto depth = find_depth(found); !depth) return depth;
    std::erase_if(known_.forces,
                  [&](const MaterialForce& force) { return force.material == material_.name; });
    known_.forces.push_back(found);
    measured_.force = true;
    return {};
  }

  Result<void> find_depth(MaterialForce& found) {
    if (const auto ready = load("Depth: squares, each with the blade a step deeper. Use the same "
                                "sheet if it still holds.",
                                2);
        !ready)
      return ready;
    ToolSettings tool = material_.cut;
    tool.force_gf = found.cut_gf;
    Material deeper = material_;
    const int first = std::max(1, material_.autoblade_depth - 2);
    const int last = std::min(10, material_.autoblade_depth + 3);
    for (int depth = first; depth <= last; ++depth) {
      deeper.autoblade_depth = depth;
      const auto done =
          cut(measure::depth_square(tool, depth - first), fmt::format("depth-{}", depth), deeper);
      if (!done) return tl::unexpected(done.error());
    }
    const auto square =
        person_.number(fmt::format("The first square that came out clean: 1 to {}, or 0 for none:",
                                   last - first + 1),
                       0, last - first + 1);
    if (!square) return tl::unexpected(square.error());
    if (const int index = static_cast<int>(std::lround(*square)); index > 0) {
      found.depth = first + index - 1;
      fmt::print(stderr, "  depth    {} (popcut thought {})\n", *found.depth,
                 material_.autoblade_depth);
    }
    return {};
  }

  const Options& options_;
  const Globals& globals_;
  CutTarget target_;
  Machine known_;
  Material material_;
  Mat mat_;
  std::optional<OutputFolder> folder_;
  Person person_;
  measure::Measured measured_;
};

Result<void> check_steps(const std::string& steps) {
  std::string_view list = steps;
  while (!list.empty()) {
    const std::string_view step = take_word(list, ",");
    if (step != "axes" && step != "ruler" && step != "time" && step != "force")
      return fail(ErrorKind::Usage, "--steps",
                  fmt::format("\"{}\" is not a step; use some of {}",
                              shown_text(step.substr(0, 40)), kSteps));
  }
  return {};
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  return fmt::format("{:%Y-%m-%d}", fmt::localtime(now));
}

/// Puts the machine into the user's table, once it reads well there.
Result<void> keep(const Machine& machine, const std::string& row) {
  const auto own = own_table("machines.json");
  if (!own) return tl::unexpected(own.error());
  const auto text = measure::table_with(own->text, row);
  if (!text) return tl::unexpected(within(own->file, text.error()));
  auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  const auto place = std::find(tables->files.begin(), tables->files.end(), own->file);
  if (place == tables->files.end()) {
    tables->files.push_back(own->file);
    tables->texts.push_back(*text);
  } else {
    tables->texts[static_cast<std::size_t>(place - tables->files.begin())] = *text;
  }
  if (const auto read = find_machine(machine.name, tables->texts); !read)
    return tl::unexpected(tables->with_file(read.error()));
  if (const auto written = write_own_table("machines.json", *text); !written) return written;
  fmt::print(stderr,
             "Written to {}; 'popcut machines {}' shows it. For popcutd, copy the row to "
             "/etc/popcut/machines.json.\n",
             own->file, machine.name);
  return {};
}

// A person's own time to fold.

constexpr double kMostTime_s = 3600;

Result<void> write_strip(const std::string& into) {
  const Pattern strip = hands::folding_strip();
  const auto pages = pattern_pages(strip);
  if (!pages) return tl::unexpected(pages.error());
  const auto pdf = pdf_of_pages(*pages, strip.name);
  if (!pdf) return tl::unexpected(pdf.error());
  auto folder = OutputFolder::open(into);
  if (!folder) return tl::unexpected(folder.error());
  if (auto done = folder->add("folding-test.pdf", *pdf); !done) return done;
  if (auto done = folder->add("folding-test.svg", pages->front().svg); !done) return done;
  if (auto done = folder->commit("popcut calibrate " POPCUT_VERSION); !done) return done;
  fmt::print(stderr,
             "  wrote    folding-test.pdf folding-test.svg in {0}\n"
             "  next     print it on card at actual size, and cut the solid lines\n"
             "           fold the flaps of each length, time them together, then run\n"
             "           popcut calibrate --hands\n",
             into);
  return {};
}

Result<void> keep_hands(const std::array<double, hands::kStrip.size()>& times_s) {
  constexpr const char* kFile = "hands.json";
  const std::string text = hands::own_hands_json(times_s);
  if (const auto read = hands::hands_of({text}); !read) return tl::unexpected(read.error());
  const auto table = own_table(kFile);
  if (!table) return tl::unexpected(table.error());
  if (const auto written = write_own_table(kFile, text); !written) return written;
  fmt::print(stderr, "Written to {}; design, plan, auto and fold-guide count with it.\n",
             table->file);
  return {};
}

Result<std::array<double, hands::kStrip.size()>> read_times(std::string_view list) {
  constexpr std::string_view kWanted =
      "give the seconds for all folds of each of the four lengths, the longest first, such as "
      "18,22,55,100";
  std::array<double, hands::kStrip.size()> times_s{};
  for (double& time_s : times_s) {
    const std::string_view word = trimmed(take_word(list, ","));
    if (!read_number(word, time_s) || !(time_s > 0 && time_s <= kMostTime_s))
      return fail(ErrorKind::Usage, "--times",
                  fmt::format("\"{}\" is no time from 0 to {:g} s; {}",
                              shown_text(word.substr(0, 40)), kMostTime_s, kWanted));
  }
  if (!list.empty())
    return fail(ErrorKind::Usage, "--times", fmt::format("has too many numbers; {}", kWanted));
  return times_s;
}

Result<void> calibrate_hands(const Options& options, const Globals& globals) {
  if (!options.device.empty() || !options.machine.empty())
    return fail(ErrorKind::Usage, "--hands", "measures a person; leave --device and --machine out");
  if (!options.folder.empty()) return write_strip(options.folder);
  if (!options.times.empty()) {
    const auto given = read_times(options.times);
    if (!given) return tl::unexpected(given.error());
    if (globals.json) fmt::print("{}", hands::own_hands_json(*given));
    return keep_hands(*given);
  }
  std::array<double, hands::kStrip.size()> times_s{};
  const Person person;
  fmt::print(stderr,
             "Fold the strip of 'popcut calibrate --hands -o DIR', each length for itself, "
             "and time it.\n");
  for (std::size_t k = 0; k < times_s.size(); ++k) {
    const auto answer =
        person.number(fmt::format("Seconds for the {} folds of {:g} mm:", hands::kStrip[k].folds,
                                  hands::kStrip[k].length_mm),
                      0.1, kMostTime_s);
    if (!answer) return tl::unexpected(answer.error());
    times_s[k] = *answer;
  }
  if (globals.json) fmt::print("{}", hands::own_hands_json(times_s));
  const auto wanted = person.yes("\nKeep this as your table?");
  if (!wanted) return tl::unexpected(wanted.error());
  if (*wanted) return keep_hands(times_s);
  fmt::print(stderr, "Nothing was written.\n");
  return {};
}

Result<void> run_calibrate(const Options& options, const Globals& globals) {
  if (options.hands) return calibrate_hands(options, globals);
  if (!options.times.empty())
    return fail(ErrorKind::Usage, "--times", "is about your own folding; add --hands");
  if (const auto valid = check_steps(options.steps); !valid) return valid;
  constexpr std::string_view kNameBytes =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  if (options.name.find_first_not_of(kNameBytes) != std::string::npos || options.name.size() > 60)
    return fail(ErrorKind::Usage, "--as",
                "is not a valid name; use up to 60 letters, digits, dots and hyphens");
  const bool simulated = options.device.empty() || options.device.starts_with("sim:");
  // A simulated machine may be another than the one that popcut takes it for.
  auto target = choose_target(
      {options.device, simulated && !options.device.empty() ? std::string() : options.machine,
       options.treat_as});
  if (!target) return tl::unexpected(target.error());
  if (target->device.kind == DeviceKind::File)
    return fail(ErrorKind::Usage, "--device", "is a file; calibrate needs a cutter");
  if (target->real() && (isatty(STDIN_FILENO) != 1 || isatty(STDERR_FILENO) != 1))
    return fail(ErrorKind::Refused, "",
                "cannot ask whether to start, because this is not a terminal; run it where you see "
                "the machine");
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  Machine machine = target->machine;
  if (target->simulated() && !options.machine.empty()) {
    const auto found = find_driven_machine(options.machine, tables->texts);
    if (!found) return tl::unexpected(tables->with_file(found.error(), "--machine"));
    machine = *found;
    if (machine.language != target->machine.language)
      return fail(ErrorKind::Usage, "--machine",
                  fmt::format("speaks {}, and {} does not understand it; name one that speaks {}",
                              machine.language, target->device.text, target->machine.language));
  }
  const auto material = find_material(options.material, tables->texts);
  if (!material) return tl::unexpected(tables->with_file(material.error(), "--material"));
  if (options.autoblade && !machine.autoblade)
    return fail(ErrorKind::Usage, "--autoblade", machine.title + " cannot hold one; leave it out");
  const bool small = machine.width_mm < 210 || machine.length_mm < 297;
  const std::string usual =
      !machine.mats.empty() ? ""
      : small ? fmt::format("{:g}x{:g}", std::floor(std::min(machine.width_mm, 210.0)),
                            std::floor(std::min(machine.length_mm, 297.0)))
              : "A4";
  const auto mat = choose_mat(machine, options.mat.empty() ? usual : options.mat);
  if (!mat) return tl::unexpected(within("--mat", mat.error()));
  std::optional<OutputFolder> folder;
  if (!options.folder.empty()) {
    auto opened = OutputFolder::open(options.folder);
    if (!opened) return tl::unexpected(opened.error());
    folder = std::move(*opened);
  }
  fmt::print(stderr,
             "Calibrating {} at {}. popcut writes nothing until you agree at the end.\n"
             "When popcut waits for a sheet, any answer except Enter stops.\n",
             shown_text(machine.title), shown_text(target->device.text));
  Calibration calibration(options, globals, std::move(*target), machine, *material, *mat,
                          std::move(folder));
  auto found = calibration.run();
  if (!found) return tl::unexpected(found.error());
  found->calibrated = today();
  if (!options.name.empty()) found->name = options.name;
  const measure::Measured& done = calibration.measured();
  if (!done.axes && !done.places && !done.motion && !done.force) {
    fmt::print(stderr, "Nothing was measured, and nothing is written.\n");
    return {};
  }
  const std::string row = measure::machine_row(*found, machine, done);
  if (globals.json) fmt::print("{}\n", row);
  const auto wanted =
      Person().yes(fmt::format("\nKeep this as machine {} in your table?", found->name));
  if (!wanted) return tl::unexpected(wanted.error());
  if (*wanted) return keep(*found, row);
  fmt::print(stderr, "Nothing was written.\n");
  return {};
}

constexpr const char* kHelp =
    "Measure your cutter, so that it cuts where and when popcut says.\n\n"
    "  popcut calibrate --device usb:51053P\n"
    "  popcut calibrate --device serial:/dev/ttyUSB0 --machine vevor-cutter --as mine\n"
    "  popcut calibrate --device usb:51053P --steps force --material card-300\n\n"
    "Allow half an hour. You need a steel ruler and five sheets of the paper that you cut. popcut\n"
    "cuts; you measure and answer:\n\n"
    "  axes   two short lines: does the machine exchange or mirror them?\n"
    "  ruler  two long lines: margins and scale; then a square in the corner, to check\n"
    "  time   seven short runs: how fast it moves (with a stopwatch if it reports nothing)\n"
    "  force  squares with growing force (and blade depth, with --autoblade): what your paper "
    "needs\n\n"
    "The result is a row in ~/.config/popcut/machines.json. popcut writes nothing until you\n"
    "agree. To practise, simulate a machine whose settings are wrong:\n\n"
    "  popcut calibrate --device sim:stika-sv15 --machine vevor-cutter --as practice -o "
    "practice\n\n"
    "To measure how long you take to fold, you need no cutter:\n\n"
    "  popcut calibrate --hands -o strip    # ten folds of four lengths, to print and cut\n"
    "  popcut calibrate --hands             # asks for your times, and keeps them\n\n"
    "The result is ~/.config/popcut/hands.json. design, plan, auto and fold-guide use its times.";

}  // namespace
}  // namespace calibrate_command

void register_calibrate(const Command& app, const Globals& globals, Run& run) {
  using namespace calibrate_command;
  auto options = std::make_shared<Options>();
  options->steps = kSteps;
  const Command command = app.add_command("calibrate", kHelp);
  command.add_option("--device", options->device, "The cutter; 'popcut devices' lists them")
      .value_text("ID [sim:cameo3]");
  command
      .add_option("--machine", options->machine,
                  "The machine, if the cutter does not report its model")
      .value_text("NAME");
  command
      .add_option("--treat-as", options->treat_as,
                  "Drive an unknown cutter as if it were this machine, such as cameo4")
      .value_text("NAME");
  command.add_option("--as", options->name, "Name of the row; default: the machine's own name")
      .value_text("NAME");
  command.add_option("--material", options->material, "What you cut")
      .value_text("NAME [paper-220]");
  command
      .add_option("--mat", options->mat,
                  "A mat of the machine, a paper such as A4, or a size; default: the machine's "
                  "mat, else A4")
      .value_text("NAME|WxH");
  command.add_option("--steps", options->steps, "What to do, in this order")
      .value_text(fmt::format("LIST [{}]", kSteps));
  command.add_flag("--autoblade", options->autoblade,
                   "There is an autoblade in the first holder: try its depths too");
  command.add_flag("--hands", options->hands, "Measure how long you take to fold, not a cutter");
  command
      .add_option("--times", options->times,
                  "With --hands: seconds for all folds of each length, the longest first")
      .value_text("A,B,C,D");
  command
      .add_option("-o,--output", options->folder,
                  "Folder for the programs, and for pictures of what a simulated knife did; with "
                  "--hands for the strip")
      .value_text("DIR");
  when_chosen(command, run, [options, &globals] { return run_calibrate(*options, globals); });
}

}  // namespace popcut::cli
