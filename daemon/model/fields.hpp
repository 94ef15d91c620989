// SPDX-License-Identifier: MIT
#pragma once

// Which fields the values of popcutd have: the one list from which their rows in the database,
// their JSON and their reading follow. A field is added here, to its struct, and, if it is stored,
// to daemon/store/tables.sql.
//
// Each list calls `see(name, member)` or `see(name, member, use)` for each field, in the order of
// the API. The name is that of the column and of the JSON member; two numbers (a pair) have the
// columns NAME_1 and NAME_2.

#include <string_view>

#include "daemon/model/model.hpp"

namespace popcut::daemon {

/// What is special about a field.
struct FieldUse {
  bool is_hidden{false};     ///< stored, but not in the API
  bool is_fixed{false};      ///< stored once: no update writes it
  bool is_time{false};       ///< a number of milliseconds that the API shows as a time
  bool zero_is_null{false};  ///< in the API
};
inline constexpr FieldUse kHidden{.is_hidden = true};
inline constexpr FieldUse kFixed{.is_fixed = true};
inline constexpr FieldUse kFixedTime{.is_fixed = true, .is_time = true};
inline constexpr FieldUse kTime{.is_time = true};
inline constexpr FieldUse kZeroIsNull{.zero_is_null = true};

/// A job. Members of `JobRow` are stored; those of `Job` follow from them and are only shown.
template <typename See>
void list_fields(const JobRow*, See&& see) {
  see("id", &JobRow::id, kFixed);
  see("rev", &JobRow::rev, kFixed);  // an update adds 1
  see("state", &JobRow::state);
  see("kind", &Job::kind);
  see("reason", &JobRow::reason);
  see("asked", &JobRow::asked, kHidden);
  see("name", &JobRow::name);
  see("note", &JobRow::note);
  see("owner", &JobRow::owner, kFixed);
  see("owner_title", &Job::owner_title);
  see("operator", &JobRow::operator_name);
  see("operator_title", &Job::operator_title);
  see("requested_device", &JobRow::requested_device, kHidden);
  see("device", &JobRow::device);
  see("site", &JobRow::site);
  see("design", &JobRow::design, kFixed);
  see("plan", &JobRow::plan);
  see("material", &JobRow::material);
  see("priority", &JobRow::priority);
  see("position", &JobRow::position, kHidden);
  see("copies", &JobRow::copies, kFixed);
  see("held", &JobRow::held);
  see("sheets_total", &JobRow::sheets_total);
  see("sheet", &JobRow::sheet, kZeroIsNull);
  see("blank", &JobRow::blank);
  see("segment", &JobRow::segment);
  see("first_stroke", &JobRow::first_stroke, kHidden);
  see("paths_certain", &JobRow::paths_certain, kHidden);
  see("paths_sent", &JobRow::paths_sent, kHidden);
  see("paths_total", &JobRow::paths_total, kHidden);
  see("done_paths", &JobRow::done_paths, kHidden);
  see("done_mm", &JobRow::done_mm, kHidden);
  see("low_s", &JobRow::low_s, kHidden);
  see("high_s", &JobRow::high_s, kHidden);
  see("progress", &Job::progress);
  see("est", &Job::est);
  see("created", &JobRow::created, kFixedTime);
  see("started", &JobRow::started);
  see("finished", &JobRow::finished);
  see("outcome", &JobRow::outcome);
  see("tags", &JobRow::tags, kFixed);
  see("load", &JobRow::load);
  see("handwork", &JobRow::handwork);
  see("warnings", &JobRow::warnings);
  see("unaccepted_warnings", &JobRow::unaccepted);
  see("attention_kind", &JobRow::attention_kind, kHidden);
  see("attention_text", &JobRow::attention_text, kHidden);
  see("attention_since", &JobRow::attention_since, kHidden);
  see("deleted", &JobRow::is_deleted, kHidden);
  see("attention", &Job::attention);
  see("armed_until", &Job::armed_until);
  see("actions", &Job::actions);
  see("ways", &Job::next_actions);
}

template <typename See>
void list_fields(const JobProgress*, See&& see) {
  see("paths_certain", &JobProgress::paths_certain);
  see("paths_sent", &JobProgress::paths_sent);
  see("paths_done", &JobProgress::paths_done);
  see("paths_total", &JobProgress::paths_total);
  see("cut_mm", &JobProgress::cut_mm);
}

template <typename See>
void list_fields(const JobEstimate*, See&& see) {
  see("remaining_s", &JobEstimate::remaining_s);
}

template <typename See>
void list_fields(const Handwork*, See&& see) {
  see("folds", &Handwork::folds);
  see("shortest_fold_mm", &Handwork::shortest_fold_mm);
  see("waste", &Handwork::waste);
  see("tabs", &Handwork::tabs);
  see("fold_s", &Handwork::fold_s);
  see("label", &Handwork::label);
}

template <typename See>
void list_fields(const LoadedSheet*, See&& see) {
  see("material", &LoadedSheet::material);
  see("machine", &LoadedSheet::machine);
  see("mat", &LoadedSheet::mat);
  see("width_mm", &LoadedSheet::width_mm);
  see("length_mm", &LoadedSheet::length_mm);
  see("side", &LoadedSheet::side);
}

template <typename See>
void list_fields(const Attention*, See&& see) {
  see("kind", &Attention::kind);
  see("sheet", &Attention::sheet);
  see("total", &Attention::total);
  see("text", &Attention::text);
  see("since", &Attention::since, kTime);
  see("actions", &Attention::actions);
}

/// A sheet of a plan: a row, a member of the API's plan, and what a worker reports.
template <typename See>
void list_fields(const SheetPlan*, See&& see) {
  see("sheet", &SheetPlan::number);
  see("paths", &SheetPlan::paths);
  see("cut_mm", &SheetPlan::cut_mm);
  see("fold_mm", &SheetPlan::fold_mm);
  see("travel_mm", &SheetPlan::travel_mm);
  see("seconds", &SheetPlan::seconds);
  see("seconds_range", &SheetPlan::seconds_range);
  see("area_mm", &SheetPlan::area_mm);
  see("program_sha256", &SheetPlan::program_sha256);
  see("index_sha256", &SheetPlan::index_sha256, kHidden);
  see("mat", &SheetPlan::mat);
  see("side", &SheetPlan::side);
}

}  // namespace popcut::daemon
