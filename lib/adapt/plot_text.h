/* SPDX-License-Identifier: MIT */
/* Text on an OpenCV mask: FreeType where a font is found, OpenCV's strokes otherwise. */
#ifndef SKF_ADAPT_PLOT_TEXT_H
#define SKF_ADAPT_PLOT_TEXT_H

#include "adapt/plot.h"
#include <opencv2/core.hpp>
#include <string>

struct FT_LibraryRec_;
struct FT_FaceRec_;

namespace plot {

class Text {
public:
  /* An empty name searches the usual places; throws when a named font cannot be read. */
  explicit Text(const std::string &font);
  ~Text();
  Text(const Text &) = delete;
  Text &operator=(const Text &) = delete;

  const char *name() const { return name_.c_str(); }
  /* Width and digits' height at size 1. */
  skf_text_extent extent(const char *text);
  /* Adds the text to a mask of 8 bits; place.x and y, size are in the mask's pixels. Returns the rectangle touched. */
  cv::Rect draw(cv::Mat &mask, const skf_text_place &place, const char *text);

private:
  cv::Rect draw_glyphs(cv::Mat &mask, const skf_text_place &place, const char *text);
  cv::Rect draw_strokes(cv::Mat &mask, const skf_text_place &place, const char *text);

  std::string name_;
  FT_LibraryRec_ *library_ = nullptr;
  FT_FaceRec_ *face_ = nullptr;
};

} // namespace plot

#endif
