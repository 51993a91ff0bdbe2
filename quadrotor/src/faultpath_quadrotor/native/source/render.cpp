// Depth images: rays against the prisms of a scene, a vector of pixels of a row at a time.
//
// `perception/render.py` is the reference. Operations are the same in the same order, none fused,
// and what is left out (solids out of view, pixels beside a solid) could not have changed a pixel.
// So the bits are the same but for torch's square roots, which are not always rounded correctly.
#include "render_view.hpp"

namespace {

constexpr int MOST_COLUMNS = 64 / LANES;  // vectors a row
constexpr float NOT_ZERO = 1e-20f;  // added to directions: an exact zero gets an inverse

// Where rays enter and leave something.
struct Interval {
  Vector enter, leave;
};

// Maxima and minima that a number which is none goes through.
INLINE Vector later(Vector a, Vector b) { return select(a < b, b, a); }
INLINE Vector sooner(Vector a, Vector b) { return select(a > b, b, a); }

INLINE Interval common(Interval a, Interval b) {
  return {later(a.enter, b.enter), sooner(a.leave, b.leave)};
}

// One slab |coordinate| <= half; `direction` is how fast rays go along it.
INLINE Interval slab(Vector direction, float eye, float half) {
  const Vector inverse = 1.0f / (direction + NOT_ZERO);
  const Vector radius = absolute(inverse) * half, middle = inverse * -eye;
  return {middle - radius, middle + radius};
}

// The chord of a circle about the axis.
INLINE Interval chord(Vector x, Vector y, const float* eye, float radius) {
  const Vector along = -(x * eye[0] + y * eye[1]);
  const Vector across = y * eye[0] - x * eye[1];
  const Vector square = x * x + y * y + NOT_ZERO;
  const Vector reach = square * (radius * radius) - across * across;
  const Vector root = sqrt(later(reach, splat(0.0f)));
  return {(along - root) / square, select(reach < 0.0f, splat(-1.0f), (along + root) / square)};
}

// A solid in single precision, with what of the rays does not change along a column.
struct Drawn {
  float eye[3], half[3], rounding;
  float up[3];  // what a row's slope adds to each coordinate
  Vector columns[3][MOST_COLUMNS];
};

INLINE void prepare(const Camera& camera, const Solid& solid, const View& view,
                    const Window& window, Drawn& drawn) {
  drawn.rounding = static_cast<float>(solid.rounding);
  for (int i = 0; i < 3; ++i) {
    drawn.eye[i] = static_cast<float>(view.eye[i]);
    drawn.half[i] = static_cast<float>(solid.half[i]);
    drawn.up[i] = static_cast<float>(view.axes[i][2]);
    const float forward = static_cast<float>(view.axes[i][0]);
    const float left = static_cast<float>(view.axes[i][1]);
    for (int64_t v = window.first; v < window.last; ++v)
      drawn.columns[i][v] = forward + load(camera.left + v * LANES) * left;
  }
}

// Calls `shade` with place and interval of every vector of pixels in the window.
template <typename Cut, typename Shade>
INLINE void sweep(const Camera& camera, const Window& window, const Drawn& drawn, Cut cut,
                  Shade shade) {
  for (int64_t row = window.top; row < window.bottom; ++row) {
    float raised[3];
    for (int i = 0; i < 3; ++i) raised[i] = drawn.up[i] * camera.up[row];
    for (int64_t v = window.first; v < window.last; ++v) {
      Vector direction[3];
      for (int i = 0; i < 3; ++i) direction[i] = drawn.columns[i][v] + raised[i];
      shade(row * camera.width + v * LANES, cut(direction));
    }
  }
}

INLINE void draw_arena(const Camera& camera, const Drawn& drawn, const Window& window,
                       float* image) {
  const auto cut = [&](const Vector* direction) {
    Interval inside = slab(direction[0], drawn.eye[0], drawn.half[0]);
    for (int i = 1; i < 3; ++i)
      inside = common(inside, slab(direction[i], drawn.eye[i], drawn.half[i]));
    return inside;
  };
  sweep(camera, window, drawn, cut, [&](int64_t at, Interval inside) {
    store(image + at, sooner(later(inside.leave, splat(0.0f)), splat(camera.range)));
  });
}

INLINE void draw_solid(const Camera& camera, const Drawn& drawn, const Window& window,
                       float* image) {
  const auto shade = [&](int64_t at, Interval inside) {
    const Vector enter = later(inside.enter, splat(0.0f));
    const Vector depth = select(enter > inside.leave, splat(camera.range), enter);
    store(image + at, sooner(load(image + at), depth));
  };
  const auto heights = [&](const Vector* direction) {
    return slab(direction[2], drawn.eye[2], drawn.half[2]);
  };
  if (drawn.rounding > 0) {
    const auto pillar = [&](const Vector* direction) {
      return common(heights(direction),
                    chord(direction[0], direction[1], drawn.eye, drawn.rounding));
    };
    sweep(camera, window, drawn, pillar, shade);
  } else {
    const auto box = [&](const Vector* direction) {
      const Interval plan = common(slab(direction[0], drawn.eye[0], drawn.half[0]),
                                   slab(direction[1], drawn.eye[1], drawn.half[1]));
      return common(plan, heights(direction));
    };
    sweep(camera, window, drawn, box, shade);
  }
}

void render(const Camera& camera, const Solid* solids, int64_t count, const double* position,
            const double* rotation, int64_t lanes, float* image) {
  Drawn drawn;
  const Window whole = {0, camera.height, 0, camera.width / LANES};
  prepare(camera, solids[0], view_of(solids[0], position, rotation, lanes), whole, drawn);
  draw_arena(camera, drawn, whole, image);
  for (int64_t k = 1; k < count; ++k) {
    if (solids[k].sign < 0) continue;
    const View view = view_of(solids[k], position, rotation, lanes);
    double middle[3], half[3];
    bounding(solids[k], view, middle, half);
    if (!seen(camera, view, middle, half)) continue;
    const Window window = window_of(camera, view, middle, half);
    prepare(camera, solids[k], view, window, drawn);
    draw_solid(camera, drawn, window, image);
  }
}

}  // namespace

// `solids` [scenes][count], `position` [3][lanes], `rotation` [9][lanes], a lane a scene;
// `images` [scenes][height][width].
extern "C" __attribute__((visibility("default"))) void faultpath_render(
    const Camera* camera, const Solid* solids, int64_t count, int64_t scenes,
    const double* position, const double* rotation, int64_t lanes, float* images) {
  for (int64_t s = 0; s < scenes; ++s)
    render(*camera, solids + s * count, count, position + s, rotation + s, lanes,
           images + s * camera->height * camera->width);
}
