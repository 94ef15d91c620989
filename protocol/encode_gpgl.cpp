// SPDX-License-Identifier: MIT
// Part of protocol/encode.hpp.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "protocol/be_delta.hpp"
#include "protocol/encode.hpp"
#include "protocol/gpgl_variants.hpp"
#include "protocol/stroke_encoder.hpp"

namespace popcut {
namespace {

/// Pen or blade for the holders 1, 2, ... up to the highest that is used.
std::vector<ToolKind> holders_of(const Toolpath& toolpath, const JobOptions& options) {
  std::uint8_t highest = 1;
  for (const Stroke& stroke : toolpath.strokes) highest = std::max(highest, stroke.tool);
  std::vector<bool> used(highest + 1U), cuts(highest + 1U);
  for (const Stroke& stroke : toolpath.strokes) {
    used[stroke.tool] = true;
    if (stroke.operation != Operation::Draw) cuts[stroke.tool] = true;
  }
  std::vector<ToolKind> kinds = options.holders;
  for (std::size_t tool = kinds.size() + 1; tool <= highest; ++tool)
    kinds.push_back(used[tool] && !cuts[tool] ? ToolKind::Pen : ToolKind::Blade);
  return kinds;
}

bool draws_binary(const JobOptions& options, const GpglVariant& variant) {
  return !options.fractions && (options.draw == DrawForm::Binary ||
                                (options.draw == DrawForm::Usual && variant.binary_draw));
}

class GpglEncoder final : public StrokeEncoder {
 public:
  GpglEncoder(const Toolpath& toolpath, const Machine& machine, const Material& material,
              const JobOptions& options, const GpglVariant& variant, const PageMap& map)
      : StrokeEncoder(toolpath, machine, map, options.feed_out_mm, options.fractions ? 100 : 1,
                      draws_binary(options, variant) ? 4 : 12),
        material_(material),
        options_(options),
        variant_(variant),
        kinds_(holders_of(toolpath, options)),
        known_(kinds_.size() + 1),
        binary_(draws_binary(options, variant)) {}

 private:
  [[nodiscard]] std::int64_t units(double mm) const { return std::llround(mm / machine_.unit_mm); }

  [[nodiscard]] double page_width() const {
    return options_.page_width_mm > 0 ? options_.page_width_mm : machine_.width_mm;
  }
  [[nodiscard]] double page_length() const {
    return options_.page_length_mm > 0 ? options_.page_length_mm : machine_.length_mm;
  }

  [[nodiscard]] Result<void> check_job() const override {
    constexpr double kLongest = 1e6;
    for (const double mm :
         {page_width(), page_length(), options_.window_top_mm, options_.window_left_mm,
          machine_.margin_top_mm, machine_.margin_left_mm}) {
      if (!(std::abs(mm) < kLongest))
        return fail(
            ErrorKind::OutOfRange, "",
            fmt::format("a page, window or margin of {} mm; it must be less than 1 km", mm));
    }
    if (machine_.autoblade && (material_.autoblade_depth < 0 || material_.autoblade_depth > 10))
      return fail(ErrorKind::OutOfRange, "/autoblade_depth",
                  fmt::format("an autoblade depth of {} for {}; it must be 0 to 10",
                              material_.autoblade_depth, material_.name));
    if (!(material_.blade_offset_mm >= 0 && material_.blade_offset_mm < 100))
      return fail(ErrorKind::OutOfRange, "/blade_offset_mm",
                  fmt::format("a blade offset of {} mm for {}; it must be 0 to 100, usually 0.9",
                              material_.blade_offset_mm, material_.name));
    return {};
  }

  void set_job_values() {
    const double bottom = page_length() + std::max(machine_.margin_top_mm, 0.0);
    const double right = page_width() + std::max(machine_.margin_left_mm, 0.0);
    values_["mat"] = options_.mat_code;
    if (!options_.mat_code && !machine_.mats.empty()) values_["mat"] = 0;
    values_["top"] = units(options_.window_top_mm);
    values_["left"] = units(options_.window_left_mm);
    // The window must hold the page where the machine's margins put it.
    if (page_length() > 0) values_["bottom"] = units(bottom / machine_.scale_feed);
    if (page_width() > 0) values_["right"] = units(right / machine_.scale_carriage);
    if (machine_.tool_holders > 1) values_["park"] = 0;
    if (machine_.firmware_blade_offset) {
      values_["offset"] = units(material_.blade_offset_mm);
      values_["zero_offset"] = 0;
    }
    values_["lift"] = options_.corner_lift ? 1 : 0;
    values_["extend_start"] = options_.corner_start_tenths.value_or(variant_.corner_tenths);
    values_["extend_end"] = options_.corner_end_tenths.value_or(variant_.corner_tenths);
    if (options_.track_enhancing) values_["track"] = *options_.track_enhancing ? 0 : 1;
  }

  void set_stroke_values(const StrokeSteps& steps) {
    values_["tool"] = steps.tool;
    if (machine_.tool_holders > 1) values_["holder"] = steps.tool;
    values_["force"] = steps.force;
    values_["speed"] = steps.speed;
    const bool taps = machine_.autoblade && options_.autoblade && steps.tool == 1;
    values_["depth"] = taps ? std::optional<std::int64_t>(material_.autoblade_depth) : std::nullopt;
  }

  std::vector<std::uint64_t> write_tool(const StrokeSteps& steps) {
    known_[static_cast<std::size_t>(steps.tool)] = steps;
    tool_ = steps.tool;
    const bool pen = kinds_[static_cast<std::size_t>(steps.tool) - 1] == ToolKind::Pen;
    return write_settings(program_.bytes, pen ? variant_.pen : variant_.blade, values_);
  }

  void write_setup(const StrokeSteps& first) override {
    program_.ask_blade = options_.ask_blade;
    set_job_values();
    set_stroke_values(first);
    std::vector<std::uint64_t> ends = write_settings(program_.bytes, variant_.start, values_);
    for (const std::uint64_t end : write_tool(first)) ends.push_back(end);
    std::uint64_t begin = 0;
    for (const std::uint64_t end : ends) {
      program_.setup.push_back({begin, end});
      begin = end;
    }
  }

  void write_search() override {
    if (!options_.marks) return;
    program_.bytes += mark_search(*options_.marks, machine_);
    for (const double mm : machine_.marks.again_mm)
      program_.search_again.push_back(units(mm / machine_.scale_feed));
  }

  void write_changes(const StrokeSteps& steps) override {
    std::optional<StrokeSteps>& known = known_[static_cast<std::size_t>(steps.tool)];
    const bool same =
        steps.tool == tool_ && known && known->force == steps.force && known->speed == steps.speed;
    if (same) return;
    set_stroke_values(steps);
    if (steps.tool != tool_) write_settings(program_.bytes, variant_.select, values_);
    // Settings without a holder's number apply to all holders, so another holder needs its own
    // again.
    const bool per_holder = variant_.force.find("{tool}") != std::string_view::npos;
    if (!known || (steps.tool != tool_ && !per_holder)) {
      write_tool(steps);
      return;
    }
    if (known->force != steps.force) write_settings(program_.bytes, variant_.force, values_);
    if (known->speed != steps.speed) write_settings(program_.bytes, variant_.speed, values_);
    known = steps;
    tool_ = steps.tool;
  }

  void write_line() override {
    write_point('M', line_.front());
    if (binary_)
      write_deltas();
    else
      for (std::size_t k = 1; k < line_.size(); ++k) write_point('D', line_[k]);
  }

  void write_trailer() override { write_settings(program_.bytes, variant_.trailer, values_); }

  // As Silhouette Studio feeds out: the next job counts from there.
  void write_feed_out(GridPoint point) override {
    write_point('M', point);
    program_.bytes += "SO0";
    program_.bytes += kEtx;
  }

  void write_point(char letter, GridPoint point) {
    program_.bytes += letter;
    append_point(point);
    program_.bytes += kEtx;
  }

  /// Consecutive deltas of the same form share a command. A delta too long for any form is sent as
  /// D.
  void write_deltas() {
    std::string& bytes = program_.bytes;
    const DeltaForm* open = nullptr;
    std::size_t begin = 0;
    const auto close = [&] {
      if (open != nullptr) bytes += kEtx;
      open = nullptr;
    };
    for (std::size_t k = 1; k < line_.size(); ++k) {
      const std::int64_t feed = line_[k].a - line_[k - 1].a;
      const std::int64_t carriage = line_[k].b - line_[k - 1].b;
      const DeltaForm* form = shortest_form(feed, carriage);
      if (form == nullptr) {
        close();
        write_point('D', line_[k]);
        continue;
      }
      const std::size_t after = bytes.size() - begin + static_cast<std::size_t>(form->digits) + 1;
      if (form != open || after > kMaxCommandBytes) {
        close();
        begin = bytes.size();
        bytes += "BE";
        bytes += static_cast<char>('0' + form->number);
        open = form;
      }
      put_delta(*form, feed, carriage, [&](char byte) { bytes += byte; });
    }
    close();
  }

  const Material& material_;
  const JobOptions& options_;
  const GpglVariant& variant_;
  const std::vector<ToolKind> kinds_;              ///< in holder 1, 2, ...
  std::vector<std::optional<StrokeSteps>> known_;  ///< settings last sent, by holder
  int tool_{};
  bool binary_;
  SettingValues values_;
};

}  // namespace

std::string mark_search(const MarkLayout& marks, const Machine& machine) {
  const auto units = [&](double mm) -> std::int64_t { return std::llround(mm / machine.unit_mm); };
  // The marks are printed at true size; a machine whose lines come out long needs fewer steps.
  const auto along = [&](double mm) { return units(mm / machine.scale_feed); };
  const auto across = [&](double mm) { return units(mm / machine.scale_carriage); };
  const std::int64_t arm = units(marks.arm_mm), line = units(marks.line_mm);
  std::string text = fmt::format("TB50,0;TB99;TB52,{};TB51,{};TB53,{};", marks.style,
                                 marks.arm_first ? arm : line, marks.arm_first ? line : arm);
  if (!marks.arm_first) text += "TB54,0,0;";
  text +=
      fmt::format("TB55,1;TB{},{},{},{},{};", marks.four_corners ? 124 : 123,
                  along(marks.height_mm), across(marks.width_mm),
                  along(marks.top_mm + machine.margin_top_mm - machine.marks.before_top_mm),
                  across(marks.left_mm + machine.margin_left_mm - machine.marks.before_left_mm));
  std::replace(text.begin(), text.end(), ';', kEtx);
  return text;
}

Result<EncodedProgram> encode_gpgl(const Toolpath& toolpath, const Machine& machine,
                                   const Material& material, const JobOptions& options) {
  const GpglVariant* variant = find_gpgl_variant(machine.variant);
  if (variant == nullptr) {
    std::vector<std::string_view> names;
    for (const GpglVariant& known : gpgl_variants()) names.push_back(known.name);
    return fail(ErrorKind::OutOfRange, "/variant",
                fmt::format("\"{}\" is not a variant of GPGL; known variants: {}", machine.variant,
                            fmt::join(names, ", ")));
  }
  if (options.fractions && options.draw == DrawForm::Binary)
    return fail(ErrorKind::OutOfRange, "",
                "fractions cannot be drawn with BE, which takes whole units; use D");
  Result<PageMap> map = page_map(machine, options.page_length_mm);
  if (!map) return tl::unexpected(map.error());
  if (options.marks) {
    if (auto clear = check_marks(*options.marks, toolpath); !clear)
      return tl::unexpected(clear.error());
    // Once found, the marks' corner is zero.
    map->margin_left_mm = -options.marks->left_mm;
    map->margin_top_mm = -options.marks->top_mm;
  }
  return GpglEncoder(toolpath, machine, material, options, *variant, *map).run();
}

}  // namespace popcut
