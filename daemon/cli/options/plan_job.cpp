// SPDX-License-Identifier: MIT
#include "daemon/cli/options/plan_job.hpp"

#include <CLI/CLI.hpp>

#include "daemon/cli/drawing_input.hpp"
#include "daemon/cli/options/knife_option.hpp"
#include "daemon/cli/options/mark_option.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/options/order_option.hpp"
#include "daemon/cli/options/split_option.hpp"
#include "daemon/files/user_tables.hpp"

namespace popcut::cli {

Result<PlanJob> make_plan_job(const PlanJobOptions& options) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  planning::PlanWords words = options;
  words.order.keep_going = watched_search(options.order);
  const auto read = [&](const SvgReadOptions& how) {
    return options.drawing ? Result<DrawingInput>(DrawingInput{*options.drawing, std::nullopt})
                           : read_drawing(options.input, how);
  };
  auto job = planning::make_plan_job(words, tables->texts, read, options.input);
  if (!job) return tl::unexpected(tables->with_file(job.error()));
  return job;
}

void add_plan_options(CLI::App& command, PlanJobOptions& options) {
  const auto text = [&](const char* name, std::string& value, const char* help, const char* shown) {
    command.add_option(name, value, help)->option_text(shown);
  };
  command.add_option("INPUT", options.input, "A SPEC (.json) or a drawing (.fold, .svg, .dxf)")
      ->required();
  text("--machine", options.machine, "The cutter; 'popcut machines' lists them", "NAME [cameo3]");
  text("--material", options.material, "What is cut; 'popcut materials' lists them",
       "NAME [paper-220]");
  text("--mat", options.mat,
       "A mat of the machine, or a size in mm, cm or in; without --machine the area of an ideal "
       "plotter",
       "NAME|WxH");
  text("--at", options.at, "Where the drawing's upper left corner goes, mm", "X,Y");
  add_order_options(command, options.order);
  text("--dialect", options.dialect, "gpgl or hpgl; without --machine it picks the machine",
       "WORD");
  text("--svg-profile", options.svg_profile,
       "What strokes of an SVG mean: popcut, origami-sim, lightburn, cricut, boxes-py, plain ...",
       "WORD [popcut]");
  add_knife_options(command, options.knife);
  add_split_options(command, options.split);
  add_mark_options(command, options.marks);
  real_number(
      command.add_option("--curve-tolerance", options.curve_tolerance_mm,
                         "How far a curve of a drawing may be from the lines that are cut, in mm"),
      0.001, 1, "mm")
      ->option_text("MM [0.02]");
  real_number(command.add_option("--svg-dpi", options.svg_dpi,
                                 "Units (px) of an SVG to the inch; 72 for old Illustrator files"),
              1, 10'000)
      ->option_text("N [96]");
  command.add_flag("--clip", options.clip,
                   "Cut off what lies outside of the area instead of refusing");
}

}  // namespace popcut::cli
