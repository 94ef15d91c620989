// SPDX-License-Identifier: MIT
#include "daemon/model/found_card_json.hpp"

namespace popcut::daemon {

nlohmann::ordered_json figures_json(const FoundCardRecord& card) {
  nlohmann::ordered_json out{{"style", card.style},
                             {"settings", card.settings},
                             {"error", card.error},
                             {"surface", card.surface},
                             {"contour", card.contour},
                             {"cover", card.cover},
                             {"excess", card.excess},
                             {"seconds", card.seconds},
                             {"seconds_range", card.seconds_range},
                             {"cut_mm", card.cut_mm},
                             {"fold_mm", card.fold_mm},
                             {"sheet_mm", card.sheet_mm},
                             {"folds", card.folds},
                             {"shortest_fold_mm", card.shortest_fold_mm},
                             {"hand_seconds", card.hand_seconds},
                             {"label", card.label},
                             {"wobble_mm", card.wobble_mm},
                             {"looks", card.looks}};
  if (card.tabs > 0) out["tabs"] = card.tabs;
  if (card.page_mm) out["page_mm"] = *card.page_mm;
  return out;
}

}  // namespace popcut::daemon
