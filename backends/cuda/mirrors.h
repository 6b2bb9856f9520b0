/* What images in the domain's walls add to a particle's sums: physics/mirrors.h. */
#ifndef PBF_CUDA_MIRRORS_H
#define PBF_CUDA_MIRRORS_H

#include "cuda/lists.h"
#include "cuda/sums.h"

/* The walls in which a particle has images near, its own or others'. */
struct wall_images {
  uint32_t codes; /* a bit for each image: a digit to base 3 an axis, … */
  pbf_real twice[2][PBF_DIM];
};

/* … 0 in no wall, 1 in the lower one and 2 in the upper one. */
static __device__ __forceinline__ uint32_t code_of(int walls) {
  uint32_t code = 0;
  for (int k = PBF_DIM - 1; k >= 0; --k)
    code = 3 * code + (walls & PBF_UPPER_WALL(k) ? 2 : walls & PBF_LOWER_WALL(k) ? 1 : 0);
  return code;
}

static __device__ __forceinline__ bool has_images(const pbf_walls &walls, pbf_vec x) {
  bool near = false;
  for (int k = 0; k < PBF_DIM; ++k)
    near |= x.c[k] - walls.lower.c[k] < walls.reach || walls.upper.c[k] - x.c[k] < walls.reach;
  return PBF_MIRRORS && walls.reach > 0 && near;
}

static __device__ __forceinline__ wall_images images_at(const pbf_walls &walls, pbf_vec x) {
  wall_images images = {};
  if (!has_images(walls, x)) return images;
  const pbf_mirrors mirrors = pbf_mirrors_near(&walls, x, x);
  for (int k = 0; k < mirrors.count; ++k) images.codes |= 1u << code_of(mirrors.walls[k]);
  for (int k = 0; k < PBF_DIM; ++k) {
    images.twice[0][k] = 2 * (x.c[k] - walls.lower.c[k]);
    images.twice[1][k] = 2 * (x.c[k] - walls.upper.c[k]);
  }
  return images;
}

/* Whether any lane of the warp, which all call it, has some. */
static __device__ __forceinline__ bool warp_has(const wall_images &images) {
  return PBF_MIRRORS && __any_sync(~0u, images.codes != 0);
}

/* Calls visit(image's x_i - x_j, r²) for the images nearer than h of a neighbour at x_ij, or with 0
 * of the particle itself. A neighbour nearer than h alone can have any. */
template <class Visit>
static __device__ __forceinline__ void for_images(const wall_images &images, pbf_real h2,
                                                  pbf_vec x_ij, Visit visit) {
  if (!images.codes || !(pbf_dot(x_ij, x_ij) < h2)) return;
  /* Each axis in both walls: what an image takes of them is in registers, and selected. */
  constexpr int LOWER = PBF_LOWER_WALL(0) | PBF_LOWER_WALL(1) | PBF_LOWER_WALL(2);
  pbf_real twice[2][PBF_DIM], in[2][PBF_DIM];
  for (int k = 0; k < PBF_DIM; ++k)
    for (int upper = 0; upper < 2; ++upper) twice[upper][k] = images.twice[upper][k];
  pbf_pair_image(LOWER, twice, x_ij.c, in[0]);
  pbf_pair_image(LOWER << 1, twice, x_ij.c, in[1]);
#pragma unroll 1
  for (uint32_t left = images.codes; left; left &= left - 1) {
    uint32_t code = (uint32_t)__ffs((int)left) - 1;
    pbf_vec image;
    for (int k = 0; k < PBF_DIM; ++k, code /= 3) {
      uint32_t digit = code % 3;
      image.c[k] = digit == 0 ? x_ij.c[k] : digit == 1 ? in[0][k] : in[1][k];
    }
    pbf_real r2 = pbf_dot(image, image);
    if (r2 < h2) visit(image, r2);
  }
}

/* V W of the images of one neighbour. */
template <int FEATURES>
static __device__ __forceinline__ pbf_real image_density(const pbf_constants *c,
                                                         const wall_images &images, pbf_vec x_ij) {
  pbf_real density = 0;
  for_images(images, c->h2, x_ij, [&](pbf_vec, pbf_real r2) {
    density += c->wall_weight * pbf_pair_density(FEATURES, c, r2);
  });
  return density;
}

/* Those that particle i at x has in an iteration; none where it does not solve. */
static __device__ __forceinline__ wall_images images_in(const iteration_extras &extras, uint32_t i,
                                                        pbf_vec x) {
  if (PBF_SLEEP && extras.rest.unrest && pbf_is_idle(extras.rest.unrest[i])) return {};
  return images_at(extras.obstacles.walls, x);
}

/* The iterations' own kernels are short of registers and of time, and most particles have no
 * images: these are summed up apart, just before. Of a solve that is over nobody reads them. */
template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    image_lambda_kernel(neighborhood n, iteration_extras extras, image_sums *all) {
  uint32_t i = thread_index(), own = min(i, n.particles.count - 1);
  const pbf_constants *c = &n.constants;
  if (PBF_TOLERANCE && extras.watch.watch && is_over(extras.watch)) return;
  pbf_vec x = position_of(load(n.particles.points, own));
  const wall_images images = images_in(extras, own, x);
  image_sums sums = {};
  auto add = [&](pbf_vec x_ij) {
    for_images(images, c->h2, x_ij, [&](pbf_vec image, pbf_real r2) {
      pbf_real value, slope;
      pbf_pair_kernel(FEATURES, c, r2, &value, &slope);
      sums.density += c->wall_weight * value;
      sums.slope2 += c->wall_weight * slope * r2 * slope;
      sums.gradient = pbf_add_scaled(sums.gradient, c->wall_weight * slope, image);
    });
  };
  if (warp_has(images)) {
    add({{0}});
    for_points(n.particles, n.grid, n.lists, i,
               [&](const point &other) { add(pbf_sub(x, position_of(other))); });
  }
  if (i < n.particles.count) all[i] = sums;
}

template <int FEATURES>
static __global__ void __launch_bounds__(PBF_BLOCK)
    image_move_kernel(neighborhood n, iteration_extras extras, pbf_vec *moves) {
  uint32_t i = thread_index(), own = min(i, n.particles.count - 1);
  const pbf_constants *c = &n.constants;
  if (PBF_TOLERANCE && extras.watch.watch && is_over(extras.watch)) return;
  const point here = load(n.particles.points, own);
  pbf_vec x = position_of(here), sum = {{0}};
  const wall_images images = images_in(extras, own, x);
  auto add = [&](pbf_vec x_ij, pbf_real lambdas) {
    for_images(images, c->h2, x_ij, [&](pbf_vec image, pbf_real r2) {
      pbf_real value, slope, factor = lambdas;
      pbf_pair_kernel(FEATURES, c, r2, &value, &slope);
      if (FEATURES & PBF_FEATURE_SCORR) factor += pbf_pair_scorr(c, value);
      sum = pbf_add_scaled(sum, c->wall_weight * factor * slope, image);
    });
  };
  if (warp_has(images)) {
    add({{0}}, here.lambda + here.lambda);
    for_points(n.particles, n.grid, n.lists, i, [&](const point &other) {
      add(pbf_sub(x, position_of(other)), here.lambda + other.lambda);
    });
  }
  if (i < n.particles.count) moves[i] = sum;
}

#endif
