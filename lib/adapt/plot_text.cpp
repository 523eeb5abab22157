/* SPDX-License-Identifier: MIT */
/* Text on an OpenCV mask: FreeType where a font is found, OpenCV's strokes otherwise. */
#include "adapt/plot_text.h"
#include <opencv2/imgproc.hpp>
#include <ft2build.h>
#include FT_FREETYPE_H
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace plot {

/* Metrics are asked for at this size and scaled, so that widths are the same at every size. */
static const int em = 1000;

static const char *const usual_fonts[] = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
    "/usr/local/share/fonts/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
    "/usr/share/fonts/truetype/liberation2/LiberationSans-Regular.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
    "/System/Library/Fonts/Supplemental/Arial Unicode.ttf",
};

/* The next code point; a malformed byte stands for itself. */
static unsigned next_code(const unsigned char *&s) {
  unsigned c = *s++;
  int more = c >= 0xf0 ? 3 : c >= 0xe0 ? 2 : c >= 0xc0 ? 1 : 0;
  for (int i = 0; i < more; i++)
    if ((s[i] & 0xc0) != 0x80) return c;
  if (!more) return c;
  c &= 0x3fu >> more;
  while (more--) c = c << 6 | (*s++ & 0x3fu);
  return c;
}

/* What strokes show for a code point that they lack. */
static std::string plain(const char *text) {
  static const struct {
    unsigned code;
    const char *ascii;
  } table[] = {{0x2212, "-"},     {0x2013, "-"},  {0x2014, "-"},   {0x00b7, "*"},    {0x00d7, "x"},
               {0x2207, "grad "}, {0x03a6, "U"},  {0x03c1, "rho"}, {0x03a3, "sum "}, {0x2211, "sum "},
               {0x207b, "^-"},    {0x2265, ">="}, {0x2264, "<="}};
  std::string out;
  bool raised = false;
  for (auto s = reinterpret_cast<const unsigned char *>(text); *s;) {
    unsigned c = next_code(s);
    int digit = c == 0x2070                  ? 0
                : c == 0xb9                  ? 1
                : c == 0xb2 || c == 0xb3     ? static_cast<int>(c - 0xb0)
                : c >= 0x2074 && c <= 0x2079 ? static_cast<int>(c - 0x2070)
                                             : -1;
    const char *known = nullptr;
    for (const auto &row : table)
      if (row.code == c) known = row.ascii;
    if (digit >= 0)
      out += (raised ? "" : "^") + std::to_string(digit);
    else if (known)
      out += known;
    else
      out += c < 0x80 ? static_cast<char>(c) : '?';
    raised = digit >= 0 || c == 0x207b;
  }
  return out;
}

Text::Text(const std::string &font) {
  if (FT_Init_FreeType(&library_)) library_ = nullptr;
  if (library_ && !font.empty()) {
    if (FT_New_Face(library_, font.c_str(), 0, &face_)) {
      FT_Done_FreeType(library_);
      throw std::runtime_error("the font " + font + " cannot be read");
    }
    name_ = font;
    return;
  }
  for (const char *path : usual_fonts)
    if (library_ && !FT_New_Face(library_, path, 0, &face_)) {
      name_ = path;
      return;
    }
  face_ = nullptr;
  name_ = "Hershey";
}

Text::~Text() {
  if (face_) FT_Done_Face(face_);
  if (library_) FT_Done_FreeType(library_);
}

skf_text_extent Text::extent(const char *text) {
  if (!face_) {
    int base = 0;
    cv::Size size = cv::getTextSize(plain(text), cv::FONT_HERSHEY_SIMPLEX, 1, 1, &base);
    return {size.width / 30.0, size.height / 30.0};
  }
  FT_Set_Pixel_Sizes(face_, 0, em);
  FT_Set_Transform(face_, nullptr, nullptr);
  double width = 0, height = 0;
  if (!FT_Load_Char(face_, '0', FT_LOAD_NO_HINTING)) height = static_cast<double>(face_->glyph->metrics.horiBearingY);
  for (auto s = reinterpret_cast<const unsigned char *>(text); *s;)
    if (!FT_Load_Char(face_, next_code(s), FT_LOAD_NO_HINTING))
      width += static_cast<double>(face_->glyph->linearHoriAdvance) / 1024.0;
  return {width / (64.0 * em), height / (64.0 * em)};
}

static void add_bitmap(cv::Mat &mask, const FT_Bitmap &b, int left, int top) {
  for (int r = 0; r < static_cast<int>(b.rows); r++)
    for (int c = 0; c < static_cast<int>(b.width); c++) {
      int x = left + c, y = top + r;
      if (x < 0 || y < 0 || x >= mask.cols || y >= mask.rows) continue;
      unsigned char &m = mask.at<unsigned char>(y, x);
      m = std::max(m, b.buffer[r * b.pitch + c]);
    }
}

cv::Rect Text::draw_glyphs(cv::Mat &mask, const skf_text_place &p, const char *text) {
  skf_text_extent e = extent(text);
  double c = std::cos(p.angle), s = std::sin(p.angle);
  double right = p.ax * e.width * p.size, up = p.ay * e.height * p.size;
  /* Pen in 26.6 fixed point, y up. */
  double x = 64 * (p.x - right * c + up * s), y = 64 * (-p.y - right * s - up * c);
  FT_Matrix turn = {std::lround(c * 65536), std::lround(-s * 65536), std::lround(s * 65536), std::lround(c * 65536)};
  FT_Set_Char_Size(face_, 0, std::lround(64 * p.size), 72, 72);
  cv::Rect touched;
  for (auto t = reinterpret_cast<const unsigned char *>(text); *t;) {
    FT_Vector pen = {std::lround(x), std::lround(y)};
    FT_Set_Transform(face_, &turn, &pen);
    if (FT_Load_Char(face_, next_code(t), FT_LOAD_NO_HINTING | FT_LOAD_RENDER)) continue;
    const FT_GlyphSlot g = face_->glyph;
    add_bitmap(mask, g->bitmap, g->bitmap_left, -g->bitmap_top);
    touched |=
        cv::Rect(g->bitmap_left, -g->bitmap_top, static_cast<int>(g->bitmap.width), static_cast<int>(g->bitmap.rows));
    double advance = static_cast<double>(g->linearHoriAdvance) / 1024.0;
    x += advance * c, y += advance * s;
  }
  return touched & cv::Rect(0, 0, mask.cols, mask.rows);
}

cv::Rect Text::draw_strokes(cv::Mat &mask, const skf_text_place &p, const char *text) {
  std::string ascii = plain(text);
  double scale = p.size / 30;
  int base = 0, thick = std::max(1, static_cast<int>(std::lround(p.size / 16)));
  cv::Size size = cv::getTextSize(ascii, cv::FONT_HERSHEY_SIMPLEX, scale, thick, &base);
  int pad = base + thick + 2;
  cv::Mat box = cv::Mat::zeros(size.height + 2 * pad, size.width + 2 * pad, CV_8U);
  cv::putText(box, ascii, {pad, pad + size.height}, cv::FONT_HERSHEY_SIMPLEX, scale, 255, thick, cv::LINE_AA);
  cv::Point2d anchor(pad + p.ax * size.width, pad + (1 - p.ay) * size.height);
  cv::Mat m = cv::getRotationMatrix2D(anchor, p.angle * 180 / CV_PI, 1);
  m.at<double>(0, 2) += p.x - anchor.x, m.at<double>(1, 2) += p.y - anchor.y;
  cv::Mat layer;
  cv::warpAffine(box, layer, m, mask.size(), cv::INTER_LINEAR);
  mask = cv::max(mask, layer);
  return {0, 0, mask.cols, mask.rows};
}

cv::Rect Text::draw(cv::Mat &mask, const skf_text_place &place, const char *text) {
  return face_ ? draw_glyphs(mask, place, text) : draw_strokes(mask, place, text);
}

} // namespace plot
