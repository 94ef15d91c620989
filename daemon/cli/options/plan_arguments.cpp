// SPDX-License-Identifier: MIT
#include "daemon/cli/options/plan_arguments.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "core/plan/plan_options.hpp"
#include "daemon/cli/input/drawing_input.hpp"
#include "daemon/cli/options/option_value.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/client/command_words.hpp"
#include "daemon/files/user_tables.hpp"

namespace popcut::cli {
namespace {

using std::chrono::steady_clock;

constexpr double kSecondsPerEffort = 60.0;  // at most; on most machines it takes a few

// Shows how far the search is, and ends it when its time is over.
class Watch {
 public:
  Watch(Progress progress, double most_s) : progress_(std::move(progress)), most_s_(most_s) {}

  bool go_on(double done) {
    if (!begun_) begun_ = steady_clock::now();
    const std::chrono::duration<double> taken = steady_clock::now() - *begun_;
    tell(progress_, "searching for a short path", std::max(done, taken.count() / most_s_));
    return taken.count() < most_s_;
  }

 private:
  Progress progress_;
  double most_s_;
  std::optional<steady_clock::time_point> begun_;  // at the first question
};

// "MM [0.05]", "quick|best|keep [quick]".
std::string form_of(const PlanOption& option) {
  const std::string form = option.words.empty() ? std::string(option.form)
                                                : fmt::format("{}", fmt::join(option.words, "|"));
  return option.usual.empty() ? form : fmt::format("{} [{}]", form, option.usual);
}

std::string help_of(const PlanOption& option) {
  std::string help(option.help);
  if (option.kind == PlanOption::Kind::Number)
    help += fmt::format(" ({:g} to {:g}{}{})", option.least, option.most,
                        option.unit.empty() ? "" : " ", option.unit);
  return help;
}

Option add_option(const Command& command, const PlanOption& option, PlanArguments& arguments) {
  const std::string dashed = "--" + std::string(option.name), help = help_of(option);
  if (option.of_request)
    return command.add_option(
        dashed, option.name == "machine" ? arguments.machine : arguments.material, help);
  const auto keep = [&arguments, name = std::string(option.name)](std::string text) {
    arguments.options[name] = std::move(text);
  };
  if (option.kind == PlanOption::Kind::Flag)
    return command.add_flag(
        dashed, [keep](bool is_set) { keep(is_set ? "true" : "false"); }, help);
  const auto keep_all = [keep](const std::vector<std::string>& texts) {
    keep(fmt::format("{}", fmt::join(texts, ",")));
  };
  Option added = command.add_values(dashed, keep_all, help);
  added = option.kind == PlanOption::Kind::Lengths ? added.value_list() : added.one_value();
  return added.checked([name = std::string(option.name)](const std::string& text) {
    const auto read = read_plan_options({{name, text}});
    return read ? std::string() : read.error().detail;
  });
}

Result<PlanOptions> options_of(const PlanArguments& arguments, const Progress& progress) {
  auto options = read_plan_options(arguments.options);
  if (!options) return options;
  options->machine = arguments.machine;
  options->material = arguments.material;
  options->keep_lines = arguments.keep_lines;
  const double most_s = kSecondsPerEffort * std::max(options->order.effort, 1.0);
  options->progress = progress;
  options->order.keep_going = [watch = std::make_shared<Watch>(progress, most_s)](double done) {
    return watch->go_on(done);
  };
  return options;
}

}  // namespace

void add_plan_arguments(const Command& command, PlanArguments& arguments) {
  command
      .add_option(
          "INPUT", arguments.input,
          "A design (.json), a drawing (.fold, .svg, .dxf, .pdf, .cp ...), or the folder of a book")
      .required();
  for (const PlanOption& option : plan_option_table()) {
    const Option added = add_option(command, option, arguments);
    if (option.kind != PlanOption::Kind::Flag) added.value_text(form_of(option));
  }
}

std::string typed_plan(const PlanArguments& arguments) {
  std::string out = client::quoted(arguments.input);
  const auto add = [&](std::string_view name, const std::string& value) {
    out += fmt::format(" --{} {}", name, client::quoted(value));
  };
  if (!arguments.machine.empty()) add("machine", arguments.machine);
  if (!arguments.material.empty()) add("material", arguments.material);
  for (const PlanOption& option : plan_option_table()) {
    const auto typed = arguments.options.find(std::string(option.name));
    if (typed == arguments.options.end()) continue;
    if (option.kind != PlanOption::Kind::Flag)
      add(option.name, typed->second);
    else if (typed->second == "true")
      out += fmt::format(" --{}", option.name);
  }
  return out;
}

void say_guide(const Plan& plan, const std::string& input, int indent) {
  if (plan.glue_marks.size() == 0 || input == "-") return;
  fmt::print(stderr, "{:{}}popcut fold-guide {} -o guide    # how to glue the parts\n", "", indent,
             client::quoted(input));
}

Result<PlanJob> plan_input(const PlanArguments& arguments, bool progress) {
  return plan_input(arguments, progress, {});
}

Result<PlanJob> plan_input(const PlanArguments& arguments, bool progress,
                           const DesignVisitor& designed) {
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  LongWork work(progress, "planning");
  const auto options = options_of(arguments, work.progress());
  if (!options) return tl::unexpected(client::on_command_line(options.error()));
  // What comes through a pipe can be read once only.
  std::error_code ignored;
  const bool is_file = std::filesystem::is_regular_file(arguments.input, ignored);
  std::optional<DrawingInput> from_pipe;
  const auto read = [&](const SvgReadOptions& how) -> Result<DrawingInput> {
    if (arguments.test_shape) return planning::test_shape_input();
    if (from_pipe) return *from_pipe;
    auto input = read_drawing(arguments.input, how, tables->texts, options->material,
                              work.progress(), designed);
    if (input && !is_file) from_pipe = *input;
    return input;
  };
  auto job = planning::make_plan_job(*options, tables->texts, read, arguments.input);
  if (!job) return tl::unexpected(client::on_command_line(tables->with_file(job.error())));
  for (Warning& warning : job->plan.warnings)
    warning.message = client::in_command_words(warning.message);
  return job;
}

}  // namespace popcut::cli
