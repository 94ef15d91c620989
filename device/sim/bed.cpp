// SPDX-License-Identifier: MIT
#include "device/sim/bed.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace popcut {
namespace {

/// What the simulator knows of a bed, on its own authority. Never fill this from
/// core/data/machines.json: what both have wrong, no test can see.
struct BedFacts {
  std::string_view machine;
  char first;  ///< 'f': the first coordinate runs along the feed; 'c': along the carriage
  double step_mm;
  double carriage_mm, feed_mm;
};

// GPGL: the recordings move (feed, carriage) in 0.05 mm, and U answers feed first. Reach:
// inkscape-silhouette's table of devices. HPGL and CAMM-GL: 0.025 mm; Ioline's manual, a GCC that
// answers OH with 0,0,1000000,7454 (25 m of feed, 186 mm of carriage) and inkcut #140 have X along
// the feed; inkcut exchanges the axes for a STIKA.
constexpr std::array<BedFacts, 34> kBeds{{
    {"cameo", 'f', 0.05, 304, 3000},
    {"cameo2", 'f', 0.05, 304, 3000},
    {"cameo3", 'f', 0.05, 304.8, 3000},
    {"cameo4", 'f', 0.05, 304.8, 3000},
    {"cameo4-plus", 'f', 0.05, 372, 3000},
    {"cameo4-pro", 'f', 0.05, 600, 3000},
    {"cameo5", 'f', 0.05, 330.2, 3000},
    {"cameo5-plus", 'f', 0.05, 372, 3000},
    {"cameo5-alpha", 'f', 0.05, 330.2, 3000},
    {"cameo5-alpha-plus", 'f', 0.05, 372, 3000},
    {"cameo-pro-mk2", 'f', 0.05, 609, 18290},
    {"portrait", 'f', 0.05, 206, 3000},
    {"portrait2", 'f', 0.05, 203, 3000},
    {"portrait3", 'f', 0.05, 203, 18290},
    {"portrait4", 'f', 0.05, 216, 18290},
    {"curio", 'f', 0.05, 215.9, 304.8},
    {"silhouette-sd1", 'f', 0.05, 203, 1000},
    {"silhouette-sd2", 'f', 0.05, 203, 1000},
    {"craft-robo-cc200", 'f', 0.05, 200, 1000},
    {"craft-robo-cc300", 'f', 0.05, 203, 1000},
    {"hpgl-generic", 'f', 0.025, 600, 5000},
    {"hpgl-clone", 'f', 0.025, 600, 5000},
    {"hpgl-ud", 'f', 0.025, 600, 5000},
    {"mh-721", 'f', 0.025, 600, 5000},
    {"camm-1", 'f', 0.025, 600, 5000},
    {"camm-2", 'f', 0.025, 600, 5000},
    {"stika-sv15", 'c', 0.025, 340, 1000},
    {"stika-sv12", 'c', 0.025, 250, 1000},
    {"stika-sv8", 'c', 0.025, 160, 1000},
    {"pnc-900", 'f', 0.025, 304.8, 5000},
    {"graphtec-ce5000", 'f', 0.025, 600, 5000},
    {"graphtec-fc8000", 'f', 0.025, 1300, 7000},
    {"gcc-bobcat", 'f', 0.025, 600, 5000},
    {"vevor-cutter", 'f', 0.025, 600, 5000},
}};

const BedFacts* find_bed(std::string_view machine) {
  const auto* found = std::find_if(kBeds.begin(), kBeds.end(),
                                   [&](const BedFacts& bed) { return bed.machine == machine; });
  return found == kBeds.end() ? nullptr : found;
}

}  // namespace

Bed::Bed(const Machine& machine, double page_length_mm)
    : feed_step_mm_(machine.unit_mm * machine.scale_feed),
      carriage_step_mm_(machine.unit_mm * machine.scale_carriage),
      feed_first_(machine.axes == Axes::FeedCarriage),
      feed_up_(machine.feed_up()),
      carriage_mm_(machine.width_mm),
      feed_mm_(machine.length_mm),
      left_mm_(machine.margin_left_mm),
      top_mm_(machine.margin_top_mm),
      page_length_mm_(page_length_mm) {
  const BedFacts* own = machine.built_in ? find_bed(machine.name) : nullptr;
  if (own == nullptr) return;
  feed_step_mm_ = carriage_step_mm_ = own->step_mm;
  feed_first_ = own->first == 'f';
  feed_up_ = !feed_first_;  // else the sheet would come out as its mirror image
  carriage_mm_ = own->carriage_mm;
  feed_mm_ = own->feed_mm;
}

PagePoint Bed::to_page(MachinePoint point) const {
  const double along = (feed_first_ ? point.a : point.b) * feed_step_mm_ - top_mm_;
  const double across = (feed_first_ ? point.b : point.a) * carriage_step_mm_ - left_mm_;
  return {across, feed_up_ ? page_length_mm_ - along : along};
}

MachinePoint Bed::to_machine(PagePoint place) const {
  const double along = (feed_up_ ? page_length_mm_ - place.y : place.y) + top_mm_;
  const double across = place.x + left_mm_;
  const double feed = along / feed_step_mm_, carriage = across / carriage_step_mm_;
  return feed_first_ ? MachinePoint{feed, carriage} : MachinePoint{carriage, feed};
}

Window Bed::reach() const {
  if (feed_up_) return {0, page_length_mm_ - feed_mm_, carriage_mm_, page_length_mm_};
  return {0, 0, carriage_mm_, feed_mm_};
}

bool has_own_bed(std::string_view machine) { return find_bed(machine) != nullptr; }

}  // namespace popcut
