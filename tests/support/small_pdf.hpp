// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace popcut::testing {

/// A PDF of pages of 288 x 288 points (101.6 mm), each with its content stream, and with optional
/// content groups ("layers") that a stream names /L0, /L1, ... `hidden` ones are off.
inline std::string small_pdf(const std::vector<std::string>& pages,
                             const std::vector<std::string>& layers = {},
                             const std::vector<std::size_t>& hidden = {}) {
  const auto number = [](std::size_t n) { return std::to_string(n); };
  const std::size_t first_layer = 3, first_page = first_layer + layers.size();
  const auto list = [&](const std::vector<std::size_t>& ones) {
    std::string out = "[";
    for (const std::size_t k : ones) out += number(first_layer + k) + " 0 R ";
    return out + "]";
  };
  std::vector<std::size_t> all;
  std::string named, kids;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    all.push_back(k);
    named += "/L" + number(k) + " " + number(first_layer + k) + " 0 R ";
  }
  for (std::size_t k = 0; k < pages.size(); ++k) kids += number(first_page + 2 * k) + " 0 R ";
  std::vector<std::string> objects{
      "<</Type/Catalog/Pages 2 0 R" +
          (layers.empty() ? ""
                          : "/OCProperties<</OCGs" + list(all) + "/D<</Order" + list(all) + "/OFF" +
                                list(hidden) + ">>>>") +
          ">>",
      "<</Type/Pages/Count " + number(pages.size()) + "/Kids[" + kids + "]>>"};
  for (const std::string& name : layers) objects.push_back("<</Type/OCG/Name(" + name + ")>>");
  for (const std::string& content : pages) {
    objects.push_back("<</Type/Page/Parent 2 0 R/MediaBox[0 0 288 288]/Contents " +
                      number(objects.size() + 2) + " 0 R/Resources<</Properties<<" + named +
                      ">>/Font<</F<</Type/Font/Subtype/Type1/BaseFont/Helvetica>>>>>>>>");
    objects.push_back("<</Length " + number(content.size()) + ">>\nstream\n" + content +
                      "\nendstream");
  }
  std::string out = "%PDF-1.5\n", table;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    std::string at = number(out.size());
    table += std::string(10 - at.size(), '0') + at + " 00000 n \n";
    out += number(k + 1) + " 0 obj\n" + objects[k] + "\nendobj\n";
  }
  const std::string size = number(objects.size() + 1), start = number(out.size());
  return out + "xref\n0 " + size + "\n0000000000 65535 f \n" + table + "trailer\n<</Size " + size +
         "/Root 1 0 R>>\nstartxref\n" + start + "\n%%EOF\n";
}

}  // namespace popcut::testing
