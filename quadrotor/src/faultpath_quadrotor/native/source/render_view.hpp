// Where a camera sees a prism, and among which pixels; `perception/render.py` is the reference.
#pragma once

#include "simd.hpp"

extern "C" {

struct Camera {
  int64_t height, width;  // pixels; a row is whole vectors, at most 64 pixels
  const float* left;      // [width], how far each column's rays go left per metre forward
  const float* up;        // [height]
  const double* planes;   // [6][4], inward normals of the view and offsets
  float range;
};

// One prism; the first of a scene is its arena.
struct Solid {
  double cosine, sine;
  double offset[3];
  double half[3];
  double rounding;
  double sign;
  double low, high;  // heights between which it can be seen, from its centre
};

}  // extern "C"

namespace {

constexpr double NEAR_M = 0.05;  // before it, perspective bounds nothing

// A solid as the camera sees it; coordinates along the prism's axes.
struct View {
  double eye[3];
  double axes[3][3];  // [prism][camera: forward, left, up]
};

// Pixels among which all of a solid lies; columns in vectors.
struct Window {
  int64_t top, bottom, first, last;
};

INLINE View view_of(const Solid& solid, const double* position, const double* rotation,
                    int64_t lanes) {
  const double along[3][3] = {
      {solid.cosine, solid.sine, 0.0}, {-solid.sine, solid.cosine, 0.0}, {0.0, 0.0, 1.0}};
  View view;
  for (int i = 0; i < 3; ++i) {
    const double* to = along[i];
    view.eye[i] = to[0] * position[0] + to[1] * position[lanes] + to[2] * position[2 * lanes] -
                  solid.offset[i];
    for (int j = 0; j < 3; ++j)
      view.axes[i][j] = to[0] * rotation[j * lanes] + to[1] * rotation[(3 + j) * lanes] +
                        to[2] * rotation[(6 + j) * lanes];
  }
  return view;
}

// The box around what can be seen of a solid, from the camera.
INLINE void bounding(const Solid& solid, const View& view, double* middle, double* half) {
  for (int i = 0; i < 3; ++i) {
    middle[i] = -view.eye[i];
    half[i] = solid.half[i] + solid.rounding;
  }
  middle[2] += (solid.high + solid.low) / 2;
  half[2] = (solid.high - solid.low) / 2;
}

// Whether any of it may be in the image: for each plane, whether the furthest corner is inside.
INLINE bool seen(const Camera& camera, const View& view, const double* middle,
                 const double* half) {
  for (int p = 0; p < 6; ++p) {
    const double* plane = camera.planes + 4 * p;
    double furthest = plane[3];
    for (int i = 0; i < 3; ++i) {
      const double* axis = view.axes[i];
      const double normal = plane[0] * axis[0] + plane[1] * axis[1] + plane[2] * axis[2];
      furthest += normal * middle[i] + __builtin_fabs(normal) * half[i];
    }
    if (!(furthest >= 0)) return false;
  }
  return true;
}

INLINE int64_t pixel(double place, int64_t count) {
  const double most = static_cast<double>(count);
  return static_cast<int64_t>(place < 0 ? 0 : place < most ? place : most);
}

// Where slopes of this range begin and end among those of the pixels, which fall; a pixel more on
// both sides.
INLINE void span(const float* slopes, int64_t count, double least, double most, int64_t& begin,
                 int64_t& end) {
  const double step = static_cast<double>(slopes[0]) - slopes[1];
  begin = pixel((slopes[0] - most) / step - 1.0, count);
  end = pixel((slopes[0] - least) / step + 3.0, count);
}

INLINE Window window_of(const Camera& camera, const View& view, const double* middle,
                        const double* half) {
  double least[2] = {__builtin_inf(), __builtin_inf()};
  double most[2] = {-__builtin_inf(), -__builtin_inf()};
  for (int corner = 0; corner < 8; ++corner) {
    double at[3] = {};
    for (int i = 0; i < 3; ++i) {
      const double side = middle[i] + ((corner >> i) & 1 ? half[i] : -half[i]);
      for (int j = 0; j < 3; ++j) at[j] += view.axes[i][j] * side;
    }
    if (at[0] < NEAR_M) return {0, camera.height, 0, camera.width / LANES};
    for (int j = 0; j < 2; ++j) {
      const double slope = at[1 + j] / at[0];
      least[j] = slope < least[j] ? slope : least[j];
      most[j] = slope > most[j] ? slope : most[j];
    }
  }
  Window window;
  span(camera.up, camera.height, least[1], most[1], window.top, window.bottom);
  span(camera.left, camera.width, least[0], most[0], window.first, window.last);
  window.first /= LANES;
  window.last = (window.last + LANES - 1) / LANES;
  return window;
}

}  // namespace
