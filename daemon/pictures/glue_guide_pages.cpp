// SPDX-License-Identifier: MIT
#include "daemon/pictures/glue_guide_pages.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/artwork/lit_picture.hpp"
#include "core/geometry/triangulate.hpp"
#include "core/print/footer.hpp"
#include "core/print/step_pages.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/utf8.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/pictures/image_reader.hpp"

namespace popcut {
namespace glue_pages_parts {
namespace {

constexpr std::size_t kStepsAPage = 6, kWidePx = 420;
constexpr Colour kPaper{238, 234, 226, 255}, kLit{255, 214, 120, 255}, kTab{240, 140, 50, 255};

/// The looks of the triangles in a picture, by number.
enum Look : std::uint32_t { Paper, Lit, Tab };

class StepDrawer {
 public:
  explicit StepDrawer(const judge::GlueGuide& guide) : guide_(guide) {
    for (std::size_t p = 0; p < guide.parts.size(); ++p) {
      std::vector<Vec2>& at = flat_.emplace_back();
      const Pattern& sheet = guide.parts[p].sheet;
      for (const PatternVertex& v : sheet.vertices) at.emplace_back(sheet.u(v), v.v);
      if (p > 0) front_ += facing(p, guide.parts[p].open);
    }
    is_tab_.resize(guide.parts.size());
    for (std::size_t p = 0; p < guide.parts.size(); ++p)
      is_tab_[p].assign(guide.parts[p].sheet.faces(), false);
    for (const judge::GlueTab& tab : guide.tabs) is_tab_[tab.part][tab.face] = true;
  }

  [[nodiscard]] Result<std::string> step_svg(std::size_t k, const PageCell& cell) const {
    const judge::GlueStep& step = guide_.steps[k];
    PageCell rest;
    std::string svg = step_words_svg(k + 1, step.words, cell, rest);
    if (rest.height <= 5) return svg;
    const double half = (rest.width - 1.5) / 2;
    const PageCell left{rest.x, rest.y, half, rest.height},
        right{rest.x + half + 1.5, rest.y, half, rest.height};
    const bool is_fold = step.kind == judge::GlueStepKind::Fold,
               is_slide = step.kind == judge::GlueStepKind::Slide;
    if (is_slide && step.slots.empty()) {  // nothing is there that it could go onto
      auto all = picture_svg(put_together(step), rest);
      if (!all) return all;
      return svg + *all;
    }
    auto picture = picture_svg(is_fold    ? folded(step)
                               : is_slide ? put_together(step)
                                          : glued(step),
                               left);
    if (!picture) return picture;
    svg += *picture;
    if (is_fold || is_slide) return svg + sheet_svg(step, step.part, right);
    std::vector<std::size_t> shown;  // what is glued on
    for (const std::size_t t : step.tabs)
      for (const std::size_t p : {guide_.tabs[t].part, guide_.tabs[t].on_part})
        if ((p != step.part || guide_.tabs[t].part == guide_.tabs[t].on_part) &&
            std::find(shown.begin(), shown.end(), p) == shown.end())
          shown.push_back(p);
    for (std::size_t n = 0; n < shown.size(); ++n) {
      const double high = right.height / static_cast<double>(shown.size());
      svg += sheet_svg(step, shown[n],
                       {right.x, right.y + static_cast<double>(n) * high, right.width, high - 0.5});
    }
    return svg;
  }

 private:
  struct Scene {
    ColourMesh mesh;
    Vec3 toward;
  };

  /// The direction that the printed side of a part looks to, times its area.
  [[nodiscard]] Vec3 facing(std::size_t part, const std::vector<Eigen::Isometry3d>& pose) const {
    Vec3 out{0.0, 0.0, 0.0};
    for (std::size_t f = 0; f < pose.size(); ++f)
      out +=
          twice_area(flat_[part], guide_.parts[part].sheet.face(f)) * Vec3(pose[f].linear().col(2));
    return out;
  }

  void add(std::size_t part, const std::vector<Eigen::Isometry3d>& pose, Look look,
           const std::vector<std::uint32_t>& tabs, ColourMesh& mesh) const {
    const Pattern& sheet = guide_.parts[part].sheet;
    for (std::size_t f = 0; f < sheet.faces(); ++f) {
      std::vector<Triangle> cut;
      if (!triangulate(flat_[part], sheet.face(f), cut)) continue;
      const bool is_tab = std::find(tabs.begin(), tabs.end(), f) != tabs.end();
      for (const Triangle& t : cut) {
        const auto at = [&](std::uint32_t v) {
          return Vec3(pose[f] * Vec3{flat_[part][v].x(), flat_[part][v].y(), 0.0});
        };
        mesh.soup.add(at(t[0]), at(t[1]), at(t[2]));
        mesh.surfacing_of.push_back(is_tab ? Tab : look);
      }
    }
  }

  /// Seen from the front, a little from beside and from above.
  [[nodiscard]] Scene empty() const {
    Scene scene{{}, toward_front() + Vec3(0.45, 0.0, 0.65)};
    for (const Colour& colour : {kPaper, kLit, kTab}) scene.mesh.surfacings.push_back({colour});
    return scene;
  }

  /// A part alone, as it stands on the open card; the card itself half open.
  [[nodiscard]] Scene folded(const judge::GlueStep& step) const {
    const judge::GluePart& part = guide_.parts[step.part];
    Scene scene = empty();
    std::vector<std::uint32_t> tabs;
    for (std::uint32_t f = 0; f < part.sheet.faces(); ++f)
      if (is_tab_[step.part][f]) tabs.push_back(f);
    if (step.part == 0)
      add(0, part.half_open, Paper, tabs, scene.mesh);
    else
      add(step.part, part.open, Lit, tabs, scene.mesh);
    return scene;
  }

  /// The card as far as it is glued, from the front.
  [[nodiscard]] Scene glued(const judge::GlueStep& step) const {
    Scene scene = empty();
    std::vector<std::vector<std::uint32_t>> tabs(guide_.parts.size());
    for (const std::size_t t : step.tabs) tabs[guide_.tabs[t].part].push_back(guide_.tabs[t].face);
    for (const std::size_t p : step.standing)
      add(p, guide_.parts[p].open, Paper, tabs[p], scene.mesh);
    add(step.part, guide_.parts[step.part].open, Lit, tabs[step.part], scene.mesh);
    for (const std::size_t p : step.with) add(p, guide_.parts[p].open, Lit, tabs[p], scene.mesh);
    return scene;
  }

  /// Parts that slide onto what is there, a little above their places.
  [[nodiscard]] Scene put_together(const judge::GlueStep& step) const {
    Scene scene = empty();
    scene.toward.z() += 0.3;  // slots are seen better from above
    for (const std::size_t p : step.standing) add(p, guide_.parts[p].open, Paper, {}, scene.mesh);
    constexpr double kAbove_mm = 4.0;
    double slot_mm = 0.0;
    for (const std::size_t k : step.slots)
      slot_mm = std::max(slot_mm, norm(Vec2(guide_.slots[k].line[1] - guide_.slots[k].line[0])));
    const Eigen::Isometry3d raise(
        Eigen::Translation3d(Vec3((step.slots.empty() ? 0.0 : slot_mm + kAbove_mm) * step.up)));
    const auto add_raised = [&](std::size_t part) {
      std::vector<Eigen::Isometry3d> pose = guide_.parts[part].open;
      for (Eigen::Isometry3d& face : pose) face = raise * face;
      add(part, pose, Lit, {}, scene.mesh);
    };
    add_raised(step.part);
    for (const std::size_t p : step.with) add_raised(p);
    return scene;
  }

  /// Along the spine, to where the printed sides of what stands look.
  [[nodiscard]] Vec3 toward_front() const { return {0.0, front_.y() > 0.0 ? 1.0 : -1.0, 0.0}; }

  [[nodiscard]] static Result<std::string> picture_svg(const Scene& scene, const PageCell& place) {
    PictureLook look;
    look.toward = scene.toward;
    look.width_px = kWidePx;
    look.height_px = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::llround(kWidePx * place.height / place.width)));
    const auto png = png_of_image(lit_picture(scene.mesh, look));
    if (!png) return png;
    return fmt::format(
        "<image x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" "
        "href=\"data:image/png;base64,{}\"/>\n",
        place.x, place.y, place.width, place.height, daemon::base64(*png));
  }

  // Flat sheets: u to the right, v up, as they are seen from the printed side.

  static void put(std::string& d, char command, const Vec2& p) {
    d += fmt::format("{}{:.2f} {:.2f}", command, p.x(), -p.y());
  }
  static std::string area(const std::vector<Vec2>& outline) {
    std::string d;
    for (std::size_t k = 0; k < outline.size(); ++k) put(d, k == 0 ? 'M' : 'L', outline[k]);
    return d + "Z";
  }
  static Vec2 middle_of(const std::vector<Vec2>& outline) {
    Vec2 sum{0.0, 0.0};
    for (const Vec2& p : outline) sum += p;
    return sum / static_cast<double>(outline.size());
  }

  /// A sheet with the folds of the step, the tabs of the part and the outlines on it. Letters are
  /// as high on the page, whatever the size of the sheet.
  [[nodiscard]] std::string sheet_svg(const judge::GlueStep& step, std::size_t part,
                                      const PageCell& place) const {
    const Pattern& sheet = guide_.parts[part].sheet;
    Box box;
    for (const Vec2& p : flat_[part]) box.add({p.x(), -p.y()});
    if (!(box.width() > 0 && box.height() > 0)) return {};
    const double scale = std::min(place.width / box.width(), place.height / box.height());
    const double mm = 1 / scale, width = scale * box.width(), height = scale * box.height();
    std::string cuts, folds;
    for (const PatternEdge& e : sheet.edges) {
      const bool is_cut = e.role == EdgeRole::Slit || e.role == EdgeRole::Outline;
      put(is_cut ? cuts : folds, 'M', flat_[part][e.from]);
      put(is_cut ? cuts : folds, 'L', flat_[part][e.to]);
    }
    std::string svg = fmt::format(
        "<svg x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" viewBox=\"{:.3f} {:.3f} "
        "{:.3f} {:.3f}\" overflow=\"visible\">\n",
        place.x + (place.width - width) / 2, place.y + (place.height - height) / 2, width, height,
        box.x0, box.y0, box.width(), box.height());
    const bool is_fold = step.kind == judge::GlueStepKind::Fold;
    std::string letters;
    const auto letter = [&](const Vec2& at, const std::string& name, bool is_new) {
      letters += fmt::format(
          "<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:.2f}\" "
          "text-anchor=\"middle\"{}>{}</text>\n",
          at.x(), -at.y() + 0.9 * mm, 2.6 * mm,
          is_new ? " font-weight=\"bold\"" : " fill=\"#909090\"", name);
    };
    for (std::size_t t = 0; t < guide_.tabs.size(); ++t) {
      const judge::GlueTab& tab = guide_.tabs[t];
      const bool is_new = std::find(step.tabs.begin(), step.tabs.end(), t) != step.tabs.end();
      const bool later = !is_fold && !is_new && (step.tabs.empty() || t > step.tabs.back());
      if (tab.part == part) {
        svg += fmt::format("<path d=\"{}\" fill=\"{}\"/>\n", area(tab.outline),
                           is_new || is_fold ? "#f6b36c" : "#ececec");
        letter(middle_of(tab.outline), tab.letter, is_new || is_fold);
      }
      if (tab.on_part == part && !is_fold && !later) {
        svg +=
            fmt::format("<path d=\"{}\" fill=\"{}\" stroke=\"#707070\" stroke-width=\"{:.3f}\"/>\n",
                        area(tab.place), is_new ? "#f6b36c" : "#ececec", 0.12 * mm);
        letter(middle_of(tab.place), tab.letter, is_new);
      }
    }
    svg += fmt::format(
        "<path d=\"{}\" fill=\"none\" stroke=\"#b4b4b4\" stroke-width=\"{:.3f}\" "
        "stroke-dasharray=\"{:.3f} {:.3f}\"/>\n<path d=\"{}\" fill=\"none\" stroke=\"#404040\" "
        "stroke-width=\"{:.3f}\"/>\n",
        folds, 0.12 * mm, 0.6 * mm, 0.6 * mm, cuts, 0.15 * mm);
    for (const std::uint32_t k : step.folds)
      svg += fold_svg(sheet, guide_.parts[part].folds.folds[k], mm);
    for (const std::size_t k : step.slots) svg += slot_svg(guide_.slots[k], mm);
    return svg + letters + "</svg>\n";
  }

  /// A slot, and the name of what goes into it, beyond its closed end.
  [[nodiscard]] std::string slot_svg(const judge::GlueSlot& slot, double mm) const {
    std::string d;
    put(d, 'M', slot.line[0]);
    put(d, 'L', slot.line[1]);
    const Vec2 at = slot.line[1] + 4.5 * mm * unit(Vec2(slot.line[1] - slot.line[0]));
    const std::string name = xml_escaped(shown_text(guide_.parts[slot.onto].name));
    return fmt::format(
        "<path d=\"{}\" fill=\"none\" stroke=\"#f6b36c\" stroke-width=\"{:.3f}\"/>\n"
        "<text transform=\"translate({:.2f} {:.2f}) rotate(-90)\" font-size=\"{:.2f}\" "
        "text-anchor=\"middle\" font-weight=\"bold\">{}</text>\n",
        d, 1.2 * mm, at.x() + 0.9 * mm, -at.y(), 2.6 * mm, name);
  }

  static std::string fold_svg(const Pattern& sheet, const hands::GuideFold& fold, double mm) {
    std::string d, dashes;
    put(d, 'M', {sheet.u(fold.from), fold.from.v});
    put(d, 'L', {sheet.u(fold.to), fold.to.v});
    constexpr double kWider = 2.0;  // than lines of pages
    for (const double dash :
         fold_dashes_mm(fold.is_mountain() ? Operation::FoldMountain : Operation::FoldValley,
                        fold.length_mm() / mm * kWider))
      dashes += fmt::format("{:.3f} ", dash * mm / kWider);
    return fmt::format(
        "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:.3f}\" "
        "stroke-dasharray=\"{}\"/>\n",
        d, fold.is_mountain() ? kMountainInk : kValleyInk, 0.6 * mm, dashes);
  }

  const judge::GlueGuide& guide_;
  std::vector<std::vector<Vec2>> flat_;    ///< one a part
  std::vector<std::vector<bool>> is_tab_;  ///< one a face of a part
  Vec3 front_{0.0, 0.0, 0.0};
};

}  // namespace
}  // namespace glue_pages_parts

Result<std::vector<PrintedPage>> glue_guide_pages(const judge::GlueGuide& guide,
                                                  std::array<double, 2> page_mm) {
  using namespace glue_pages_parts;
  const StepDrawer drawer(guide);
  return step_pages("How to make " + page_name(guide.name), page_mm, guide.steps.size(),
                    kStepsAPage,
                    [&](std::size_t k, const PageCell& cell) { return drawer.step_svg(k, cell); });
}

}  // namespace popcut
