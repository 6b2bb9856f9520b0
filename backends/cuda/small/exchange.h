/* Part of scene.h: values that particles hand from block to block within a launch, each in one word
 * of memory with the number of the pass that made it. Whoever needs a value reads the word until
 * the number is right: no barrier, no fence, and a block waits for its neighbours alone.
 *
 * No block is ahead of a neighbour by more than one publication, as each needs the other's last
 * one. So positions, which are read until the pass is over, have two words that take turns; a
 * lambda has one: the next follows the positions that it made. */
#ifndef PBF_CUDA_SMALL_EXCHANGE_H
#define PBF_CUDA_SMALL_EXCHANGE_H

#include "cuda/ptx.h"
#include "physics/real.h"

struct particle_exchange {
  ulonglong2 *positions[2]; /* 16 bytes: coordinates and number; of even and odd numbers */
  unsigned long long *lambdas;
};

static __device__ __forceinline__ unsigned long long word_of(uint32_t low, uint32_t high) {
  return low | (unsigned long long)high << 32;
}

static __device__ __forceinline__ void publish_position(const particle_exchange &e, uint32_t i,
                                                        pbf_vec x, uint32_t pass) {
  uint32_t last = PBF_DIM == 3 ? __float_as_uint((float)x.c[PBF_DIM - 1]) : 0;
  const ulonglong2 whole = {word_of(__float_as_uint((float)x.c[0]), __float_as_uint((float)x.c[1])),
                            word_of(last, pass)};
  store_relaxed(e.positions[pass % 2] + i, whole);
}

static __device__ __forceinline__ pbf_vec position_in(ulonglong2 word) {
  pbf_vec x;
  x.c[PBF_DIM - 1] = __uint_as_float((uint32_t)word.y);
  x.c[0] = __uint_as_float((uint32_t)word.x);
  x.c[1] = __uint_as_float((uint32_t)(word.x >> 32));
  return x;
}

/* A position that lies ready: what it was before the barrier that all have passed. */
static __device__ __forceinline__ pbf_vec ready_position(const ulonglong2 *positions, uint32_t i) {
  return position_in(positions[i]);
}

/* The positions of N particles, once all are of `pass`. */
template <int N>
static __device__ __forceinline__ void await_positions(const particle_exchange &e,
                                                       const uint32_t (&particles)[N],
                                                       uint32_t pass, pbf_vec (&positions)[N]) {
  const ulonglong2 *from = e.positions[pass % 2];
  bool all;
  do {
    ulonglong2 words[N];
#pragma unroll
    for (int k = 0; k < N; ++k) words[k] = load_relaxed(from + particles[k]);
    all = true;
#pragma unroll
    for (int k = 0; k < N; ++k) {
      all = all && (uint32_t)(words[k].y >> 32) == pass;
      positions[k] = position_in(words[k]);
    }
  } while (!all);
}

static __device__ __forceinline__ void publish_lambda(const particle_exchange &e, uint32_t i,
                                                      pbf_real lambda, uint32_t pass) {
  store_relaxed(e.lambdas + i, word_of(__float_as_uint((float)lambda), pass));
}

/* The lambdas of N particles, once all are of `pass`. */
template <int N>
static __device__ __forceinline__ void await_lambdas(const particle_exchange &e,
                                                     const uint32_t (&particles)[N], uint32_t pass,
                                                     pbf_real (&lambdas)[N]) {
  bool all;
  do {
    unsigned long long words[N];
#pragma unroll
    for (int k = 0; k < N; ++k) words[k] = load_relaxed(e.lambdas + particles[k]);
    all = true;
#pragma unroll
    for (int k = 0; k < N; ++k) {
      all = all && (uint32_t)(words[k] >> 32) == pass;
      lambdas[k] = __uint_as_float((uint32_t)words[k]);
    }
  } while (!all);
}

/* The number of no pass, before the first: the words may hold anything. */
static __device__ __forceinline__ void forget(const particle_exchange &e, uint32_t i) {
  for (int k = 0; k < 2; ++k) store_relaxed(e.positions[k] + i, ulonglong2{0, 0});
  publish_lambda(e, i, 0, 0);
}

#endif
