/* SPDX-License-Identifier: MIT */
/* The drawing module: a canvas on OpenCV, drawn larger and averaged down, and OpenCV's picture files. */
#include "adapt/plot_text.h"
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>

struct skf_canvas {
  int width, height, scale; /* pixels; the sheet has scale times as many each way */
  cv::Mat sheet, mask;      /* RGB; coverage, zero between calls */
  cv::Rect clip;            /* of the sheet */
  plot::Text text;
  std::string failure; /* of the first drawing call that failed */

  skf_canvas(int w, int h, int s, const std::string &font)
      : width(w), height(h), scale(s), sheet(h * s, w * s, CV_8UC3, cv::Scalar::all(255)),
        mask(cv::Mat::zeros(h * s, w * s, CV_8U)), clip(0, 0, w * s, h * s), text(font) {}
};

namespace {

const int shift = 8; /* fractional bits of OpenCV's drawing calls: 1/256 pixel of the sheet */

void say(char error[256], const char *what) { std::snprintf(error, 256, "%.250s", what); }

/* Runs a drawing call; whatever it throws is kept for encode(). */
template <class F> void guarded(skf_canvas *c, F &&draw) {
  if (!c->failure.empty()) return;
  try {
    draw();
  } catch (const std::exception &e) {
    c->failure = e.what();
    if (c->failure.empty()) c->failure = "drawing failed";
  }
}

/* Puts a colour through the mask within `touched`, and clears the mask there. */
void blend(skf_canvas *c, cv::Rect touched, const double rgba[4]) {
  touched &= cv::Rect(0, 0, c->sheet.cols, c->sheet.rows);
  cv::Rect seen = touched & c->clip;
  for (int y = seen.y; y < seen.y + seen.height; y++) {
    const unsigned char *m = c->mask.ptr<unsigned char>(y);
    cv::Vec3b *row = c->sheet.ptr<cv::Vec3b>(y);
    for (int x = seen.x; x < seen.x + seen.width; x++) {
      if (!m[x]) continue;
      double a = rgba[3] * m[x] / 255;
      for (int k = 0; k < 3; k++)
        row[x][k] = cv::saturate_cast<unsigned char>(row[x][k] + a * (255 * rgba[k] - row[x][k]));
    }
  }
  if (touched.area() > 0) c->mask(touched).setTo(0);
}

/* Points in the sheet's fixed-point coordinates, and the rectangle that they and a line of this width touch. */
std::vector<cv::Point> fixed_points(const skf_canvas *c, const double (*xy)[2], size_t n, double width,
                                    cv::Rect &touched) {
  /* Far outside is as good as outside; the limit keeps fixed point from overflowing. */
  const double far = 20000;
  std::vector<cv::Point> out;
  double lo[2] = {far * 2, far * 2}, hi[2] = {-far * 2, -far * 2};
  for (size_t i = 0; i < n; i++) {
    double p[2];
    for (int k = 0; k < 2; k++) {
      p[k] = std::isfinite(xy[i][k]) ? std::min(far, std::max(-far, xy[i][k])) : 0;
      p[k] = p[k] * c->scale - 0.5;
      lo[k] = std::min(lo[k], p[k]), hi[k] = std::max(hi[k], p[k]);
    }
    out.emplace_back(static_cast<int>(std::lround(p[0] * (1 << shift))),
                     static_cast<int>(std::lround(p[1] * (1 << shift))));
  }
  int pad = static_cast<int>(width * c->scale) + 4;
  int x = static_cast<int>(std::floor(lo[0])) - pad, y = static_cast<int>(std::floor(lo[1])) - pad;
  touched = cv::Rect(x, y, static_cast<int>(std::ceil(hi[0])) + pad - x, static_cast<int>(std::ceil(hi[1])) + pad - y);
  return out;
}

/* OpenCV's anti-aliased areas reach this many pixels beyond their outline. */
const double border = 0.6;

/* Its own thick lines are up to two pixels too wide, and odd widths are no wider than the even ones: so each piece is
   an area, with a disc where two pieces meet and at the ends. */
void thick_line(cv::Mat &mask, const std::vector<cv::Point> &points, bool closed, double radius) {
  const int corners = 16;
  cv::Point area[corners];
  auto at = [](double x, double y) {
    return cv::Point(static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y)));
  };
  for (size_t i = 0; i < points.size(); i++) {
    cv::Point p = points[i];
    for (int k = 0; k < corners; k++)
      area[k] = at(p.x + radius * std::cos(2 * CV_PI * k / corners), p.y + radius * std::sin(2 * CV_PI * k / corners));
    cv::fillConvexPoly(mask, area, corners, 255, cv::LINE_AA, shift);
    if (i + 1 == points.size() && !closed) break;
    cv::Point q = points[(i + 1) % points.size()];
    double dx = q.x - p.x, dy = q.y - p.y, length = std::hypot(dx, dy);
    if (!(length > 0)) continue;
    dx *= radius / length, dy *= radius / length;
    cv::Point quad[4] = {at(p.x - dy, p.y + dx), at(q.x - dy, q.y + dx), at(q.x + dy, q.y - dx),
                         at(p.x + dy, p.y - dx)};
    cv::fillConvexPoly(mask, quad, 4, 255, cv::LINE_AA, shift);
  }
}

skf_canvas *create(int width, int height, const char *font, char error[256]) {
  try {
    /* Three times as fine each way up to 4 megapixels; beyond, the pixels are fine enough. */
    double pixels = static_cast<double>(width) * height;
    int scale = pixels <= 4e6 ? 3 : pixels <= 16e6 ? 2 : 1;
    return new skf_canvas(width, height, scale, font ? font : "");
  } catch (const std::exception &e) {
    say(error, e.what());
    return nullptr;
  }
}

void destroy(skf_canvas *c) { delete c; }
const char *font(const skf_canvas *c) { return c->text.name(); }

const char *const colormap_names[] = {"viridis", "magma", "inferno", "plasma", "cividis", "grey", nullptr};
const int colormap_ids[] = {cv::COLORMAP_VIRIDIS, cv::COLORMAP_MAGMA,   cv::COLORMAP_INFERNO,
                            cv::COLORMAP_PLASMA,  cv::COLORMAP_CIVIDIS, -1};

bool colormap(const char *name, unsigned char rgb[256][3]) {
  for (int i = 0; colormap_names[i]; i++) {
    if (std::strcmp(name, colormap_names[i])) continue;
    try {
      cv::Mat ramp(256, 1, CV_8U), out;
      for (int k = 0; k < 256; k++) ramp.at<unsigned char>(k) = static_cast<unsigned char>(k);
      if (colormap_ids[i] < 0)
        cv::cvtColor(ramp, out, cv::COLOR_GRAY2BGR);
      else
        cv::applyColorMap(ramp, out, colormap_ids[i]);
      for (int k = 0; k < 256; k++)
        for (int j = 0; j < 3; j++) rgb[k][j] = out.at<cv::Vec3b>(k)[2 - j];
      return true;
    } catch (const std::exception &) { return false; }
  }
  return false;
}

void clip(skf_canvas *c, double x0, double y0, double x1, double y1) {
  auto at = [&](double v, int n) {
    return static_cast<int>(std::lround(std::min(std::max(v * c->scale, 0.0), 1.0 * n)));
  };
  int left = at(x0, c->sheet.cols), top = at(y0, c->sheet.rows);
  c->clip = cv::Rect(left, top, std::max(0, at(x1, c->sheet.cols) - left), std::max(0, at(y1, c->sheet.rows) - top));
}

void image(skf_canvas *c, int x, int y, int width, int height, const unsigned char *rgb) {
  guarded(c, [&] {
    int s = c->scale;
    for (int j = std::max(0, y * s); j < std::min(c->sheet.rows, (y + height) * s); j++)
      for (int i = std::max(0, x * s); i < std::min(c->sheet.cols, (x + width) * s); i++) {
        const unsigned char *p = rgb + 3 * (static_cast<size_t>(j / s - y) * width + (i / s - x));
        c->sheet.at<cv::Vec3b>(j, i) = {p[0], p[1], p[2]};
      }
  });
}

void stroke(skf_canvas *c, const double (*xy)[2], size_t n, bool closed, double width, const double rgba[4]) {
  if (n < 2) return;
  guarded(c, [&] {
    cv::Rect touched;
    auto points = fixed_points(c, xy, n, width, touched);
    double radius = 0.5 * width * c->scale - border;
    if (radius < 0.5)
      cv::polylines(c->mask, points, closed, 255, 1, cv::LINE_AA, shift);
    else
      thick_line(c->mask, points, closed, radius * (1 << shift));
    blend(c, touched, rgba);
  });
}

void fill(skf_canvas *c, const double (*xy)[2], size_t n, const double rgba[4]) {
  if (n < 3) return;
  guarded(c, [&] {
    cv::Rect touched;
    std::vector<std::vector<cv::Point>> points = {fixed_points(c, xy, n, 1, touched)};
    cv::fillPoly(c->mask, points, 255, cv::LINE_AA, shift);
    blend(c, touched, rgba);
  });
}

void text(skf_canvas *c, skf_text_place p, const char *utf8, const double rgba[4]) {
  guarded(c, [&] {
    p.x *= c->scale, p.y *= c->scale, p.size *= c->scale;
    blend(c, c->text.draw(c->mask, p, utf8), rgba);
  });
}

skf_text_extent extent(skf_canvas *c, const char *utf8) {
  skf_text_extent e = {0, 0};
  guarded(c, [&] { e = c->text.extent(utf8); });
  return e;
}

skf_status encode_mat(const cv::Mat &bgr, const char *ending, unsigned char **bytes, size_t *n, char error[256]) {
  *bytes = nullptr, *n = 0;
  try {
    std::string name = std::string(".") + ending;
    std::vector<int> how;
    if (!std::strncmp(ending, "jp", 2)) how = {cv::IMWRITE_JPEG_QUALITY, 95};
    if (!std::strcmp(ending, "webp")) how = {cv::IMWRITE_WEBP_QUALITY, 101}; /* above 100: lossless */
    if (!std::strcmp(ending, "png")) how = {cv::IMWRITE_PNG_COMPRESSION, 6};
    std::vector<unsigned char> out;
    if (!cv::haveImageWriter("picture" + name))
      return say(error, "OpenCV has no writer for this format here"), SKF_ERR_UNSUPPORTED;
    if (!cv::imencode(name, bgr, out, how)) return say(error, "OpenCV did not write the picture"), SKF_ERR_IO;
    std::unique_ptr<unsigned char[]> copy(new unsigned char[out.size()]);
    std::memcpy(copy.get(), out.data(), out.size());
    *n = out.size(), *bytes = copy.release();
    return SKF_OK;
  } catch (const std::bad_alloc &) {
    return say(error, "out of memory"), SKF_ERR_NOMEM;
  } catch (const std::exception &e) { return say(error, e.what()), SKF_ERR_IO; }
}

skf_status encode(skf_canvas *c, const char *ending, unsigned char **bytes, size_t *n, char error[256]) {
  *bytes = nullptr, *n = 0;
  cv::Mat bgr;
  guarded(c, [&] {
    cv::Mat small = c->sheet;
    if (c->scale > 1) cv::resize(c->sheet, small, cv::Size(c->width, c->height), 0, 0, cv::INTER_AREA);
    cv::cvtColor(small, bgr, cv::COLOR_RGB2BGR);
  });
  if (!c->failure.empty()) return say(error, c->failure.c_str()), SKF_ERR_IO;
  return encode_mat(bgr, ending, bytes, n, error);
}

skf_status encode_linear(int width, int height, const float *rgb, const char *ending, unsigned char **bytes, size_t *n,
                         char error[256]) {
  try {
    cv::Mat bgr(height, width, CV_32FC3);
    for (int y = 0; y < height; y++)
      for (int x = 0; x < width; x++, rgb += 3) bgr.at<cv::Vec3f>(y, x) = {rgb[2], rgb[1], rgb[0]};
    return encode_mat(bgr, ending, bytes, n, error);
  } catch (const std::exception &e) { return say(error, e.what()), SKF_ERR_NOMEM; }
}

skf_status encode_deep(int width, int height, const unsigned short *rgb, const char *ending, unsigned char **bytes,
                       size_t *n, char error[256]) {
  try {
    cv::Mat bgr(height, width, CV_16UC3);
    for (int y = 0; y < height; y++)
      for (int x = 0; x < width; x++, rgb += 3) bgr.at<cv::Vec3w>(y, x) = {rgb[2], rgb[1], rgb[0]};
    return encode_mat(bgr, ending, bytes, n, error);
  } catch (const std::exception &e) { return say(error, e.what()), SKF_ERR_NOMEM; }
}

skf_status decode(const char *path, int *width, int *height, unsigned char **rgb, char error[256]) {
  *rgb = nullptr;
  try {
    cv::Mat bgr = cv::imread(path, cv::IMREAD_COLOR);
    if (bgr.empty()) return say(error, "not a picture that can be read"), SKF_ERR_IO;
    std::unique_ptr<unsigned char[]> out(new unsigned char[3 * bgr.total()]);
    unsigned char *p = out.get();
    for (int y = 0; y < bgr.rows; y++)
      for (int x = 0; x < bgr.cols; x++)
        for (int k = 0; k < 3; k++) *p++ = bgr.at<cv::Vec3b>(y, x)[2 - k];
    *width = bgr.cols, *height = bgr.rows, *rgb = out.release();
    return SKF_OK;
  } catch (const std::exception &e) { return say(error, e.what()), SKF_ERR_IO; }
}

void release(unsigned char *bytes) { delete[] bytes; }

} // namespace

extern "C" __attribute__((visibility("default"))) const skf_plot skf_plot_module = {
    SKF_PLOT_ABI, "opencv", create, destroy, font,   colormap,      colormap_names, clip,        image,
    stroke,       fill,     text,   extent,  encode, encode_linear, release,        encode_deep, decode};
