// SPDX-License-Identifier: MIT
// Part of core/formats/write/pattern_files.hpp.
#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <hpdf.h>

#include "core/formats/write/pattern_files.hpp"

namespace popcut {
namespace {

constexpr double kPointsPerMm = 72.0 / 25.4;
constexpr double kLargestPageMm = 14400.0 / kPointsPerMm;
constexpr double kTextPt = 10.0;

struct Style {
  EdgeRole role;
  HPDF_REAL red, green, blue;
  std::vector<HPDF_UINT16> dashes_pt;
};

HPDF_REAL real(double value) { return static_cast<HPDF_REAL>(value); }

/// The sheet's place on the page: points, y up, from the page's lower left corner.
struct Placement {
  double height_mm;
  [[nodiscard]] static HPDF_REAL x(double v) { return real((kPdfMarginMm + v) * kPointsPerMm); }
  [[nodiscard]] HPDF_REAL y(double u) const {
    return real((height_mm - kPdfMarginMm - u) * kPointsPerMm);
  }
};

void draw_lines(HPDF_Page page, const Pattern& pattern, const Placement& at, const Style& style) {
  HPDF_Page_SetRGBStroke(page, style.red, style.green, style.blue);
  HPDF_Page_SetDash(page, style.dashes_pt.empty() ? nullptr : style.dashes_pt.data(),
                    static_cast<HPDF_UINT>(style.dashes_pt.size()), 0);
  bool any = false;
  for (const SheetLine& line : pattern.lines) {
    if (line.role != style.role) continue;
    HPDF_Page_MoveTo(page, Placement::x(line.v0), at.y(line.u0));
    HPDF_Page_LineTo(page, Placement::x(line.v1), at.y(line.u1));
    any = true;
  }
  if (any) HPDF_Page_Stroke(page);
}

/// `text` in characters of the built-in fonts; others become question marks.
std::string plain(const std::string& text) {
  std::string ascii;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0u) == 0x80u) continue;  // continuation byte of UTF-8
    ascii += byte < 0x20 || byte > 0x7e ? '?' : c;
  }
  constexpr std::size_t kLongest = 120;
  return ascii.substr(0, kLongest);
}

void write_text(HPDF_Page page, double x_mm, double y_mm, const std::string& text) {
  HPDF_Page_BeginText(page);
  HPDF_Page_TextOut(page, real(x_mm * kPointsPerMm), real(y_mm * kPointsPerMm), text.c_str());
  HPDF_Page_EndText(page);
}

/// Draws a bar with end ticks below the sheet, and its length as text.
void draw_bar(HPDF_Page page, double sheet_width_mm) {
  const double length_mm = sheet_width_mm >= 100.0 ? 100.0 : sheet_width_mm >= 50.0 ? 50.0 : 10.0;
  constexpr double kBarMm = 8.0, kTickMm = 1.5;
  const auto line = [&](double x0, double y0, double x1, double y1) {
    HPDF_Page_MoveTo(page, real(x0 * kPointsPerMm), real(y0 * kPointsPerMm));
    HPDF_Page_LineTo(page, real(x1 * kPointsPerMm), real(y1 * kPointsPerMm));
  };
  HPDF_Page_SetRGBStroke(page, 0, 0, 0);
  HPDF_Page_SetDash(page, nullptr, 0, 0);
  const double left = kPdfMarginMm, right = kPdfMarginMm + length_mm;
  line(left, kBarMm, right, kBarMm);
  line(left, kBarMm - kTickMm, left, kBarMm + kTickMm);
  line(right, kBarMm - kTickMm, right, kBarMm + kTickMm);
  HPDF_Page_Stroke(page);
  write_text(page, left, 2.5, fmt::format("{:.0f} mm", length_mm));
}

void draw(HPDF_Doc pdf, const Pattern& pattern, double width_mm, double height_mm) {
  HPDF_SetCompressionMode(pdf, HPDF_COMP_ALL);
  HPDF_SetInfoAttr(pdf, HPDF_INFO_TITLE, plain(pattern.name).c_str());
  HPDF_SetInfoAttr(pdf, HPDF_INFO_CREATOR, "popcut");
  HPDF_Page page = HPDF_AddPage(pdf);
  HPDF_Page_SetWidth(page, real(width_mm * kPointsPerMm));
  HPDF_Page_SetHeight(page, real(height_mm * kPointsPerMm));
  HPDF_Page_SetFontAndSize(page, HPDF_GetFont(pdf, "Helvetica", nullptr), real(kTextPt));
  HPDF_Page_SetLineWidth(page, real(0.2 * kPointsPerMm));
  const std::array<Style, 4> styles{{{EdgeRole::Mountain, 1, 0, 0, {8, 3, 2, 3}},
                                     {EdgeRole::Valley, 0, 0, 1, {6, 3}},
                                     {EdgeRole::Slit, 0, 0, 0, {}},
                                     {EdgeRole::Outline, 0, 0, 0, {}}}};
  const Placement at{height_mm};
  for (const Style& style : styles) draw_lines(page, pattern, at, style);
  draw_bar(page, pattern.width_mm);
  write_text(page, kPdfMarginMm, height_mm - 10.0, plain(pattern.name));
}

/// The finished document, from the library's memory stream.
std::string saved(HPDF_Doc pdf) {
  std::string bytes;
  if (HPDF_SaveToStream(pdf) != HPDF_OK) return bytes;
  HPDF_ResetStream(pdf);
  bytes.resize(HPDF_GetStreamSize(pdf));
  std::size_t read = 0;
  while (read < bytes.size()) {
    auto block = static_cast<HPDF_UINT32>(std::min<std::size_t>(bytes.size() - read, 1u << 20));
    HPDF_ReadFromStream(pdf, reinterpret_cast<HPDF_BYTE*>(bytes.data() + read), &block);
    if (block == 0) return {};
    read += block;
  }
  return bytes;
}

void remember_error(HPDF_STATUS code, HPDF_STATUS, void* first) {
  auto& kept = *static_cast<HPDF_STATUS*>(first);
  if (kept == HPDF_OK) kept = code;
}

}  // namespace

Result<std::string> pattern_pdf(const Pattern& pattern) {
  const double width_mm = pattern.width_mm + 2 * kPdfMarginMm;
  const double height_mm = pattern.wall_mm + pattern.ground_mm + 2 * kPdfMarginMm;
  if (!(width_mm <= kLargestPageMm && height_mm <= kLargestPageMm)) {
    return fail(ErrorKind::Infeasible, "pdf",
                fmt::format("a page of {:.0f} x {:.0f} mm is larger than PDF allows; make the "
                            "pattern smaller than {:.0f} mm, or omit pdf from the formats",
                            width_mm, height_mm, kLargestPageMm - 2 * kPdfMarginMm));
  }
  HPDF_STATUS first_error = HPDF_OK;
  const std::unique_ptr<_HPDF_Doc_Rec, decltype(&HPDF_Free)> pdf(
      HPDF_New(remember_error, &first_error), &HPDF_Free);
  if (!pdf) return fail(ErrorKind::Internal, "pdf", "the PDF library did not start");
  draw(pdf.get(), pattern, width_mm, height_mm);
  std::string bytes = saved(pdf.get());
  if (first_error != HPDF_OK || bytes.empty()) {
    return fail(ErrorKind::Internal, "pdf",
                fmt::format("the PDF library failed with code 0x{:04x}", first_error));
  }
  return bytes;
}

}  // namespace popcut
