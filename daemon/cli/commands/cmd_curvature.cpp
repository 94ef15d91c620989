// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/curvature/assembly_plot.hpp"
#include "core/curvature/pattern_curvature.hpp"
#include "daemon/cli/answer.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/options/angles.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {
namespace curvature_command {
namespace {

constexpr std::size_t kMostRows = 10'000'000;  // of a table that is streamed
constexpr std::size_t kMostHeld = 1'000'000;   // of a grid that is held, for a picture or JSON

struct Options {
  std::string pattern, psi{"pi/2"}, pattern_output;
  std::string phi{"pi/4"}, r, lambda, output;
  double K{};
  std::optional<double> H;
};

Result<double> parse_phi(std::string text) {
  if (text.empty()) text = "pi/4";
  const auto phi = parse_angle(text);
  if (!phi) return fail(ErrorKind::Usage, "--phi", phi.error().detail);
  if (*phi >= 0 && *phi <= std::numbers::pi / 2) return phi;
  return fail(ErrorKind::Usage, "--phi", fmt::format("is {} rad; from 0 to pi/2", *phi));
}

tl::unexpected<Error> too_many(const std::string& place, std::size_t count, std::size_t most) {
  return fail(ErrorKind::Usage, place,
              fmt::format("asks for {} values, more than {}; give a smaller N", count, most));
}

/// To the file if one is named, else to standard output.
Result<void> put(const std::string& file, const std::function<void(std::ostream&)>& write) {
  if (!file.empty()) return write_whole_file(file, write);
  std::fflush(stdout);
  write(std::cout);
  std::cout.flush();
  return {};
}

// 1. A pattern.

void say_range(const char* name, const CurvatureRange& range, const char* unit) {
  fmt::print(stderr, "  {:<7} {:.6g} to {:.6g}{}, mean {:.6g}\n", name, range.least, range.largest,
             unit, range.mean);
}

void say_poses(std::span<const FoldVertex> vertices, const Samples& psi) {
  fmt::print(stderr, "{} inner fold vertices\n", inner_count(vertices));
  for (const std::size_t k : {std::size_t{0}, psi.count - 1}) {
    const PatternSummary all = summary_of(pattern_curvature(vertices, psi.at(k)));
    fmt::print(stderr, "psi = {:.6g} rad\n", psi.at(k));
    say_range("K", all.K, " rad");
    say_range("K_area", all.K_area, " 1/mm^2");
    say_range("H", all.H, " 1/mm");
    if (psi.count == 1) break;
  }
}

Result<void> run_pattern(const Options& options, const Globals& globals) {
  constexpr std::uintmax_t kPatternLimitBytes = 1u << 29;
  if (options.pattern.empty()) {
    return fail(ErrorKind::Usage, "command line",
                "PATTERN.fold, assembly or solve is missing; 'popcut curvature --help' explains");
  }
  const auto psi = parse_opening_samples("--psi", options.psi);
  if (!psi) return tl::unexpected(psi.error());
  const auto text = read_file(options.pattern, kPatternLimitBytes);
  if (!text) return tl::unexpected(text.error());
  const auto vertices = fold_vertices_from_fold(*text);
  if (!vertices) return tl::unexpected(within(options.pattern, vertices.error()));
  const std::size_t inner = inner_count(*vertices);
  if (inner == 0) {
    return fail(
        ErrorKind::Infeasible, options.pattern,
        "has no inner fold vertex (one with four neighbours); use at least two units for each "
        "slice and four slices");
  }
  if (psi->count > kMostRows / inner) return too_many("--psi", psi->count * inner, kMostRows);
  const bool json = globals.json || options.pattern_output.ends_with(".json");
  const auto write = [&](std::ostream& out) {
    (json ? write_curvature_json : write_curvature_csv)(*vertices, *psi, out);
  };
  if (auto done = put(options.pattern_output, write); !done) return done;
  if (!globals.quiet) say_poses(*vertices, *psi);
  return {};
}

// 2. Maps of the assembly.

nlohmann::ordered_json list_of(const Samples& samples) {
  auto list = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < samples.count; ++k) list.push_back(samples.at(k));
  return list;
}

std::string maps_json(const AssemblyMaps& maps, double phi_rad) {
  nlohmann::ordered_json json;
  json["phi_rad"] = phi_rad;
  json["r"] = list_of(maps.r);
  json["lambda"] = list_of(maps.lambda);
  for (const auto& [name, value] : {std::pair("K", &maps.K), std::pair("H", &maps.H)}) {
    auto rows = nlohmann::ordered_json::array();
    for (std::size_t row = 0; row < maps.lambda.count; ++row) {
      const auto first = value->begin() + static_cast<std::ptrdiff_t>(row * maps.r.count);
      rows.push_back(std::vector<double>(first, first + static_cast<std::ptrdiff_t>(maps.r.count)));
    }
    json[name] = std::move(rows);
  }
  return json_line(json) + '\n';
}

Result<Samples> lengths(const char* option, const std::string& text) {
  auto samples = parse_samples(option, text);
  if (!samples) return samples;
  if (samples->count > 1 && samples->from >= 0 && samples->to > samples->from) return samples;
  return fail(ErrorKind::Usage, option,
              fmt::format("'{}' is not a range of lengths; give A:B:N with 0 <= A < B", text));
}

Result<void> run_assembly(const Options& options, const Globals& globals) {
  const auto phi = parse_phi(options.phi);
  if (!phi) return tl::unexpected(phi.error());
  const auto r = lengths("--r", options.r);
  if (!r) return tl::unexpected(r.error());
  const auto lambda = lengths("--lambda", options.lambda);
  if (!lambda) return tl::unexpected(lambda.error());
  const bool picture = options.output.ends_with(".svg");
  const bool json =
      !picture && (options.output.ends_with(".json") || (globals.json && options.output.empty()));
  const std::size_t count = r->count * lambda->count,
                    most = picture || json ? kMostHeld : kMostRows;
  if (count > most) return too_many("--r and --lambda", count, most);
  const auto done = put(options.output, [&](std::ostream& out) {
    if (!picture && !json) return write_assembly_csv(*phi, *r, *lambda, out);
    Samples along_r = *r, along_lambda = *lambda;
    if (picture) {  // lines and bands need a fine grid, whatever was asked for
      constexpr std::size_t kFine = 181;
      along_r.count = std::max(along_r.count, kFine);
      along_lambda.count = std::max(along_lambda.count, kFine);
    }
    const AssemblyMaps maps = assembly_maps(*phi, along_r, along_lambda);
    out << (picture ? assembly_maps_svg(maps, *phi) : maps_json(maps, *phi));
  });
  if (!done) return done;
  if (globals.json && !options.output.empty())
    fmt::print("{}\n",
               json_line(nlohmann::ordered_json{{"file", options.output}, {"rows", count}}));
  if (!globals.quiet && !options.output.empty())
    fmt::print(stderr, "  wrote   {}\n", options.output);
  return {};
}

// 3. The assembly that has given K and H.

bool at_quarter(double phi_rad) { return std::abs(phi_rad - std::numbers::pi / 4) < 1e-12; }

void print_solution(const AssemblySolution& found, double K) {
  const Assembly& at = found.assembly;
  fmt::print("r = {:.10g}, lambda = {:.10g}, phi = {:.10g} rad\n", at.r, at.lambda, at.phi_rad);
  const double H = std::abs(found.reached.H) < 1e-13 ? 0.0 : found.reached.H;
  fmt::print("K = {:.10g} rad, H = {:.10g}, A = {:.10g} (unit widths)\n",
             std::abs(found.reached.K) < 1e-13 ? 0.0 : found.reached.K, H, found.reached.A);
  if (found.mirror)
    fmt::print("equally near, with -H: r = {:.10g}, lambda = {:.10g}\n", found.mirror->r,
               found.mirror->lambda);
  if (K < 0 && at_quarter(at.phi_rad)) {
    const double least = assembly_lambda_for(K);
    if (least < 2) {
      fmt::print("K = {:g} needs lambda >= {:.6f} or lambda <= {:.6f}\n", K, least, 2 - least);
    } else {
      fmt::print("K = {:g} needs lambda >= {:.6f}\n", K, least);
    }
  }
}

nlohmann::ordered_json solution_json(const AssemblySolution& found, double K) {
  nlohmann::ordered_json json{{"r", found.assembly.r},
                              {"lambda", found.assembly.lambda},
                              {"phi_rad", found.assembly.phi_rad},
                              {"K", found.reached.K},
                              {"H", found.reached.H},
                              {"A", found.reached.A}};
  json["mirror"] = nullptr;
  if (found.mirror) json["mirror"] = {{"r", found.mirror->r}, {"lambda", found.mirror->lambda}};
  if (K < 0 && at_quarter(found.assembly.phi_rad)) {
    const double least = assembly_lambda_for(K);
    json["lambda_at_least"] = least;
    if (least < 2) json["lambda_or_at_most"] = 2 - least;
  }
  return json;
}

Result<void> run_solve(const Options& options, const Globals& globals) {
  const auto phi = parse_phi(options.phi);
  if (!phi) return tl::unexpected(phi.error());
  const auto found = solve_assembly({options.K, options.H, *phi});
  if (!found) return tl::unexpected(within("curvature solve", found.error()));
  return answer(globals, solution_json(*found, options.K),
                [&] { print_solution(*found, options.K); });
}

// 4. The command.

constexpr const char* kHelp =
    "Print the curvature of a pattern as it opens, or of an assembly of five units.\n\n"
    "  popcut curvature sphere/pattern.fold --psi pi/2\n"
    "  popcut curvature sphere/pattern.fold --psi pi:pi/2:31 -o opening.csv\n"
    "  popcut curvature assembly --r 0.5:5:181 --lambda 0.2:3:141 -o maps.svg\n"
    "  popcut curvature solve --K -1\n\n"
    "Curvature is measured at the fold vertices: the middles of the connectors' valley folds. A\n"
    "connector is the strip that joins two slices; an inner fold vertex has all four neighbours.\n"
    "Columns: psi (the opening angle, rad), level i, connector j, x, v, z (mm), K (Gaussian\n"
    "curvature as angle defect, rad), K_area = K/A (1/mm^2, to compare with a smooth surface), H\n"
    "(mean curvature, 1/mm, positive where convex), A (area, mm^2).\n\n"
    "'assembly' and 'solve' are about the five-unit assembly of the scientific paper.";
constexpr const char* kAssemblyHelp =
    "Write maps of the curvatures K and H of the assembly over r and lambda.\n\n"
    "  popcut curvature assembly --r 0.5:5:181 --lambda 0.2:3:141 -o maps.svg\n\n"
    "r is the distance of the middle unit, lambda the scale of the diagonal pair, both in unit\n"
    "widths. The table has the columns r, lambda, K, H; r changes fastest. -o FILE.svg draws a\n"
    "picture with the zero lines (from 181 x 181 points or more), -o FILE.json writes lists, and\n"
    "without -o the table goes to standard output.";
constexpr const char* kSolveHelp =
    "Find the assembly (r and lambda) that has a given curvature K, and H if you give it.\n\n"
    "  popcut curvature solve --K -1\n"
    "  popcut curvature solve --K -0.5 --H 0\n\n"
    "Many pairs have the same K; popcut prints the one nearest to (3/sqrt 2, 1). If no pair has\n"
    "the given values, the exit code is 4 and the error shows the nearest pair.";

Option add_phi(const Command& command, Options& options) {
  return command
      .add_option("--phi", options.phi, "Direction of the middle unit, in radians or as 45deg")
      .value_text("ANGLE [pi/4]")
      .value_optional();  // 'popcut curvature assembly --phi --r ...' takes the usual one
}

}  // namespace
}  // namespace curvature_command

void register_curvature(const Command& app, const Globals& globals, Run& run) {
  using namespace curvature_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("curvature", kHelp);
  command.needs_command(0, 1);
  command.add_option("PATTERN", options->pattern, "A FOLD file of a pop-up pattern");
  command
      .add_option("--psi", options->psi,
                  "Opening angles (psi): one, or A:B:N for N angles from A to B; 1.1, pi/2 or "
                  "90deg; pi is flat, "
                  "0 closed")
      .value_text("A:B:N [pi/2]");
  command
      .add_option("-o,--output", options->pattern_output,
                  "File for the table, .csv or .json; default: standard output")
      .value_text("FILE");

  const Command assembly = command.add_command("assembly", kAssemblyHelp);
  add_phi(assembly, *options);
  assembly
      .add_option("--r", options->r,
                  "Distances of the middle unit, in unit widths: N values from A to B")
      .value_text("A:B:N")
      .required();
  assembly
      .add_option("--lambda", options->lambda,
                  "Scales of the diagonal pair of units: N values from A to B")
      .value_text("A:B:N")
      .required();
  assembly.add_option("-o,--output", options->output, "maps.csv, maps.svg or maps.json")
      .value_text("FILE");
  when_chosen(assembly, run, [options, &globals] { return run_assembly(*options, globals); });

  const Command solve = command.add_command("solve", kSolveHelp);
  add_phi(solve, *options);
  solve
      .add_option("--K", options->K,
                  "Gaussian curvature as angle defect, rad, between -2 pi and 2 pi")
      .value_text("NUMBER")
      .required();
  solve.add_option("--H", options->H, "Mean curvature, in 1/width").value_text("NUMBER");
  when_chosen(solve, run, [options, &globals] { return run_solve(*options, globals); });

  command.on_choice([options, command, &globals, &run] {
    if (command.has_chosen_command()) return;  // that one has set the work
    run = [options, &globals] { return run_pattern(*options, globals); };
  });
}

}  // namespace popcut::cli
