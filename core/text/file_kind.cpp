// SPDX-License-Identifier: MIT
#include "core/text/file_kind.hpp"

#include <array>
#include <string>

#include "core/text/words.hpp"

namespace popcut {
namespace {

using namespace std::string_view_literals;

struct Head {
  std::string_view bytes;
  std::string_view kind;
  std::size_t at{};
};

constexpr std::array kHeads{Head{"\x89PNG\r\n"sv, "a PNG picture"},
                            Head{"\xFF\xD8\xFF"sv, "a JPEG picture"},
                            Head{"GIF8"sv, "a GIF picture"},
                            Head{"WEBP"sv, "a WebP picture", 8},
                            Head{"ftypheic"sv, "a HEIC picture", 4},
                            Head{"ftypavif"sv, "an AVIF picture", 4},
                            Head{"II*\0"sv, "a TIFF picture"},
                            Head{"MM\0*"sv, "a TIFF picture"},
                            Head{"gimp xcf "sv, "a GIMP picture"},
                            Head{"8BPS"sv, "a Photoshop picture"},
                            Head{"%PDF-"sv, "a PDF document"},
                            Head{"%!PS"sv, "a PostScript document"},
                            Head{"\xC5\xD0\xD3\xC6"sv, "a PostScript document"},
                            Head{"AC10"sv, "an AutoCAD drawing (DWG)"},
                            Head{"CDR"sv, "a CorelDRAW file", 8},
                            Head{"silhouette"sv, "a Silhouette Studio file"},
                            Head{"PK\x03\x04"sv, "a ZIP archive, or a 3MF model, which is one"},
                            Head{"\x1F\x8B\x08"sv, "a gzip archive"},
                            Head{"7z\xBC\xAF\x27\x1C"sv, "a 7z archive"},
                            Head{"Rar!\x1A"sv, "a RAR archive"},
                            Head{"ply\n"sv, "a PLY model"},
                            Head{"ply\r\n"sv, "a PLY model"},
                            Head{"OFF\n"sv, "an OFF model"},
                            Head{"OFF\r\n"sv, "an OFF model"},
                            Head{"#VRML"sv, "a VRML model"},
                            Head{"ISO-10303-21;"sv, "a STEP model"},
                            Head{"Kaydara FBX Binary"sv, "an FBX model"},
                            Head{"BLENDER"sv, "a Blender file"},
                            Head{"\x7F"
                                 "ELF"sv,
                                 "a program"}};

/// Of a text in angle brackets.
std::string_view marked_up(std::string_view text) {
  const auto has = [&](std::string_view word) { return text.find(word) != text.npos; };
  if (has("<svg")) return "an SVG drawing";
  if (has("<html") || has("<HTML") || has("<!DOCTYPE html") || has("<!doctype html"))
    return "a web page (HTML)";
  if (has("<COLLADA")) return "a COLLADA model";
  if (has("<amf")) return "an AMF model";
  if (has("<X3D")) return "an X3D model";
  return "an XML text";
}

struct Advice {
  std::string_view kind;     ///< how the name of the kind begins
  std::string_view endings;  ///< of files, with blanks around each
  std::string_view advice;
};

constexpr std::string_view kModelAdvice =
    "save it as STL, OBJ or GLB, for example in Blender, and 'popcut auto' makes cards of it";
constexpr std::string_view kPictureAdvice =
    "a picture has no lines to cut; trace it, in Inkscape with Path > Trace Bitmap, and save it as "
    "SVG";
constexpr std::string_view kSvgAdvice = "export it as SVG or DXF from the program that made it";

/// What to do with a file of a kind, as a drawing.
constexpr std::array kAdvice{
    Advice{"an Illustrator file", " ai ait ",
           "in Illustrator, use File > Export > SVG; or open it in Inkscape and save it as SVG"},
    Advice{"a PDF document", " pdf ",
           "make an SVG of it: pdftocairo -svg FILE drawing.svg (Debian package poppler-utils)"},
    Advice{"a PostScript document", " eps ps epsf ",
           "make an SVG of it: inkscape --export-type=svg FILE (Debian packages inkscape and "
           "ghostscript)"},
    Advice{"an AutoCAD drawing (DWG)", " dwg ", "in your CAD program, save it as DXF"},
    Advice{"a CorelDRAW file", " cdr cmx ", "in CorelDRAW, export it as SVG or DXF"},
    Advice{"a Silhouette Studio file", " studio studio3 gsd gst ",
           "save it as SVG (Silhouette Studio Business Edition) or export the drawing from the "
           "program that made it"},
    Advice{"a Brother cutting file", " fcm ", kSvgAdvice},
    Advice{"a LightBurn project", " lbrn lbrn2 ", "in LightBurn, use File > Export > SVG or DXF"},
    Advice{"a SketchUp model", " skp ", kModelAdvice},
    Advice{"an Oriedita or ORIHIME file", " ori orh ", "save it as FOLD (.fold) or .cp"},
    Advice{"a PNG picture", " png ", kPictureAdvice},
    Advice{"a JPEG picture", " jpg jpeg ", kPictureAdvice},
    Advice{"a GIF picture", " gif ", kPictureAdvice},
    Advice{"a WebP picture", " webp ", kPictureAdvice},
    Advice{"a HEIC picture", " heic ", kPictureAdvice},
    Advice{"an AVIF picture", " avif ", kPictureAdvice},
    Advice{"a TIFF picture", " tif tiff ", kPictureAdvice},
    Advice{"a BMP picture", " bmp ", kPictureAdvice},
    Advice{"a GIMP picture", " xcf ", kPictureAdvice},
    Advice{"a Photoshop picture", " psd psb ", kPictureAdvice},
    Advice{"a Windows metafile", " emf wmf ", "open it in Inkscape and save it as SVG"},
    Advice{"a LibreOffice drawing", " odg ", "in LibreOffice Draw, export it as SVG"},
    Advice{"an Affinity file", " afdesign ", "in Affinity, use File > Export > SVG"},
    Advice{"a Sketch file", " sketch ", "in Sketch, export it as SVG"},
    Advice{"a Figma file", " fig ", "in Figma, export it as SVG"},
    Advice{"a COLLADA model", " dae ", kModelAdvice},
    Advice{"a 3MF model", " 3mf ", kModelAdvice},
    Advice{"a STEP model", " step stp ", kModelAdvice},
    Advice{"an IGES model", " iges igs ", kModelAdvice},
    Advice{"a PLY model", " ply ", kModelAdvice},
    Advice{"an FBX model", " fbx ", kModelAdvice},
    Advice{"an AMF model", " amf ", kModelAdvice},
    Advice{"an OFF model", " off ", kModelAdvice},
    Advice{"an X3D model", " x3d ", kModelAdvice},
    Advice{"a VRML model", " wrl vrml ", kModelAdvice},
    Advice{"a Blender file", " blend ", kModelAdvice},
    Advice{"a program for a cutter", " plt hpgl hpg gpgl ",
           "'popcut send FILE' sends it, and 'popcut simulate FILE -o cut' shows what it cuts"},
    Advice{"G-code", " gcode nc ngc gc tap ", kSvgAdvice},
    Advice{"an archive", " zip 7z rar tar ", "unpack it and give the drawing in it"},
    Advice{"a ZIP archive", "", "unpack it and give the drawing in it"},
    Advice{"a 7z archive", "", "unpack it and give the drawing in it"},
    Advice{"a RAR archive", "", "unpack it and give the drawing in it"},
    Advice{"a web page (HTML)", " html htm ", "save the picture in it as SVG"},
};

std::string ending_of(std::string_view file_name) {
  const std::size_t dot = file_name.find_last_of("./");
  if (dot == file_name.npos || file_name[dot] != '.') return {};
  return lower(file_name.substr(dot + 1));
}

}  // namespace

std::string_view foreign_kind(std::string_view bytes) {
  for (const Head& head : kHeads)
    if (bytes.size() >= head.at && bytes.substr(head.at, head.bytes.size()) == head.bytes)
      return head.kind;
  constexpr std::size_t kLooked = 4096;
  std::string_view text = bytes.substr(0, kLooked);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  text = trimmed(text, " \t\r\n");
  return text.starts_with('<') ? marked_up(text) : std::string_view();
}

std::string foreign_advice(std::string_view bytes, std::string_view file_name) {
  const std::string ending = ending_of(file_name);
  const std::string_view kind = foreign_kind(bytes);
  const auto sentence = [](const Advice& one) {
    return "is " + std::string(one.kind) + "; " + std::string(one.advice);
  };
  for (const Advice& one : kAdvice) {
    // Illustrator's files are PDF or PostScript inside, those of 3MF are ZIP.
    const bool by_name =
        !ending.empty() && one.endings.find(" " + ending + " ") != one.endings.npos;
    if (by_name) return sentence(one);
  }
  for (const Advice& one : kAdvice)
    if (!kind.empty() && kind.starts_with(one.kind)) return sentence(one);
  if (kind == "a program") return "is a program; give a drawing";
  return {};
}

}  // namespace popcut
