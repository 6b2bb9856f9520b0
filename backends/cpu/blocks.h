/* Neighbour lists of a group, in the order in which the passes over pairs read them: for each block
 * of windows the slots of each particle's neighbours, a byte a neighbour, one round after another.
 * A block that is as full as only crowds make it keeps masks instead, which take a seventh of the
 * memory; to list them anew in each pass takes a tenth of its time. */
#ifndef PBF_CPU_BLOCKS_H
#define PBF_CPU_BLOCKS_H

#include "cpu/kernels.h"
#include "cpu/simd/lanes.h"

typedef struct block {
  _Alignas(LIST_UNIT) uint32_t first[PARTS]; /* the particle in slot 1 of each window */
  uint32_t rounds;                           /* most neighbours of a particle */
  uint16_t image;                            /* of the group, from which they are there: IMAGES */
  uint16_t parts;                            /* windows */
} block;

enum { MAX_ROUNDS = PARTS * (SLOTS - 1), DENSE_ROUNDS = 28 * PARTS };

/* Bytes of a block's list or masks. */
PBF_FN uint32_t block_payload(uint32_t rounds) {
  if (rounds > DENSE_ROUNDS) return PARTS * WIDTH * sizeof(uint32_t);
  return (rounds * WIDTH + LIST_UNIT - 1) / LIST_UNIT * LIST_UNIT;
}

PBF_FN uint32_t block_units(uint32_t rounds) {
  return (uint32_t)(sizeof(block) + block_payload(rounds)) / LIST_UNIT;
}

PBF_FN void block_write(uint8_t *at, const block *b, const u32_lanes masks[PARTS]) {
  memcpy(at, b, sizeof *b);
  at += sizeof *b;
  if (b->rounds <= DENSE_ROUNDS) {
    list_set_bits(masks, b->parts, b->rounds, at);
    return;
  }
  for (int part = 0; part < PARTS; ++part)
    u32_store((uint32_t *)(void *)at + part * WIDTH, masks[part]);
}

/* A walk over the blocks of a group. */
typedef struct block_cursor {
  const uint8_t *next;
  uint32_t left;
} block_cursor;

PBF_FN block_cursor group_blocks(const lists *n, uint32_t g) {
  return (block_cursor){n->data + (uint64_t)n->groups[g].begin * LIST_UNIT, n->groups[g].blocks};
}

/* The block that the walk stands at. */
PBF_FN const block *current_block(const block_cursor *w) {
  return (const block *)(const void *)w->next;
}

static __attribute__((noinline)) const uint8_t *list_dense(const block *b, uint8_t *list) {
  u32_lanes masks[PARTS];
  for (int part = 0; part < PARTS; ++part)
    masks[part] = u32_load((const uint32_t *)(const void *)(b + 1) + part * WIDTH);
  list_set_bits(masks, b->parts, b->rounds, list);
  return list;
}

PBF_FN void skip_block(block_cursor *w) {
  const block *b = current_block(w);
  w->next += sizeof *b + block_payload(b->rounds);
  --w->left;
}

/* The block's lists, unpacked into `space` where they are not stored; the walk goes on. */
PBF_FN const uint8_t *next_list(block_cursor *w, uint8_t space[MAX_ROUNDS * WIDTH]) {
  const block *b = current_block(w);
  skip_block(w);
  return b->rounds <= DENSE_ROUNDS ? (const uint8_t *)(b + 1) : list_dense(b, space);
}

#endif
