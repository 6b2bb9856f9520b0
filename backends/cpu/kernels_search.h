/* Part of kernels.cpp: neighbour search over particles sorted by cell. Distances are tested for a
 * whole group against one candidate at a time. */
#ifndef PBF_CPU_KERNELS_SEARCH_H
#define PBF_CPU_KERNELS_SEARCH_H

#include "cpu/blocks.h"

/* Lanes begin … end - 1 of a group: particles that lie near each other in one row. */
typedef struct run {
  uint32_t group, begin, end;
  uint32_t row, first_cell, last_cell; /* the cells along the row */
  lane x[PBF_DIM];
} run;

/* Farther apart than this along a row, particles do not search together. */
static inline uint32_t widest_gap(const grid *g) { return 2 * g->reach + 1; }

static run run_from(const search *s, uint32_t i, uint32_t end) {
  const grid *g = s->grid;
  uint32_t first = s->cells[i], last = s->cells[end - 1], nx = g->cells[0], row = first / nx;
  if (last / nx != row || last - first > WIDTH * widest_gap(g) / 4) {
    uint32_t k = i + 1;
    while (k < end && s->cells[k] / nx == row && s->cells[k] - s->cells[k - 1] <= widest_gap(g))
      ++k;
    end = k;
    last = s->cells[end - 1];
  }
  run r = {.group = i / WIDTH,
           .begin = i % WIDTH,
           .end = (end - 1) % WIDTH + 1,
           .row = row,
           .first_cell = first - row * nx,
           .last_cell = last - row * nx};
  for (int k = 0; k < PBF_DIM; ++k) r.x[k] = lane_load(s->x.c[k] + r.group * WIDTH);
  return r;
}

/* Which of the candidates in slots begin … end - 1 of a window are neighbours of each particle of
 * the run. */
static inline u32_lanes near_mask(const search *s, const run *r, uint32_t first, uint32_t begin,
                                  uint32_t end) {
  u32_lanes near = u32_set(0);
  const lane h2 = ops<lane>::set(s->h2);
  u32_lanes bit = u32_set(slot_bit(begin));
  for (uint32_t slot = begin; slot < end; ++slot, bit = next_slot_bit(bit)) {
    lane r2 = ops<lane>::set(0);
    for (int k = 0; k < PBF_DIM; ++k) {
      lane d = r->x[k] - ops<lane>::set(s->x.c[k][first + slot - 1]);
      r2 = k ? ops<lane>::multiply_add(d, d, r2) : d * d;
    }
    near = u32_mark(near, r2, h2, bit);
  }
  u32_lanes lane_number = u32_iota();
  u32_lanes self = lane_number + u32_set(r->group * WIDTH - first + 1);
  near = near & ~u32_bit(self) & u32_below(lane_number, r->end);
  return r->begin ? near & ~u32_below(lane_number, r->begin) : near;
}

typedef struct neighbor_window {
  uint32_t first, image;
  u32_lanes near;
} neighbor_window;

/* The next window that has a neighbour, beginning with it; 0 at the end. */
static int next_window(const search *s, const run *r, candidate_range *c, neighbor_window *w) {
  while (c->next < c->end) {
    uint32_t left = c->end - c->next, size = left < SLOTS - 1 ? left : SLOTS - 1;
    u32_lanes near = near_mask(s, r, c->next, 1, 1 + size);
    uint32_t any = u32_any(near);
    c->next += size;
    if (!any) continue;
    uint32_t lead = first_slot(any) - 1;
    w->first = c->next - size + lead;
    w->image = c->image;
    w->near = slots_from(near, (int)lead);
    if (lead) {
      uint32_t more = c->end - c->next < lead ? c->end - c->next : lead;
      w->near = w->near | near_mask(s, r, w->first, 1 + size - lead, 1 + size - lead + more);
      c->next += more;
    }
    return 1;
  }
  return 0;
}

/* Puts windows together to blocks, and writes these one behind the other. */
typedef struct builder {
  uint8_t *data;
  struct list_arena *arena;
  uint64_t begin, next; /* of the group's list, in units */
  uint32_t lacking;     /* 1: no room; only counts */
  uint32_t blocks;
  uint32_t waiting; /* windows */
  neighbor_window windows[PARTS];
} builder;

/* A group's list is in one piece: what there is of it moves to where there is room for the next
 * block too. */
static __attribute__((noinline)) void move_list(builder *b, uint32_t units) {
  list_arena *arena = b->arena;
  uint64_t size = b->next - b->begin;
  if (!arena->more(arena->context, arena) || size + units > arena->end - arena->next) {
    b->lacking = 1;
    return;
  }
  memcpy(b->data + arena->next * LIST_UNIT, b->data + b->begin * LIST_UNIT, size * LIST_UNIT);
  b->begin = arena->next;
  b->next = b->begin + size;
}

static void put_block(builder *b, const neighbor_window *windows, uint32_t count) {
  block to;
  u32_lanes masks[PARTS], neighbors = u32_set(0);
  for (uint32_t part = 0; part < PARTS; ++part) {
    to.first[part] = windows[part < count ? part : 0].first;
    masks[part] = part < count ? windows[part].near : u32_set(0);
    if (part < count) neighbors = neighbors + u32_popcount(masks[part]);
  }
  to.rounds = u32_max(neighbors);
  to.image = (uint16_t)windows[0].image;
  to.parts = (uint16_t)count;
  uint32_t units = block_units(to.rounds);
  if (b->next + units > b->arena->end && !b->lacking) move_list(b, units);
  if (!b->lacking) block_write(b->data + b->next * LIST_UNIT, &to, masks);
  b->next += units;
  ++b->blocks;
}

static void put_waiting(builder *b) {
  if (b->waiting) put_block(b, b->windows, b->waiting);
  b->waiting = 0;
}

/* A block is of one image. */
static void put_window(builder *b, const neighbor_window *w) {
  if (b->waiting && b->windows[0].image != w->image) put_waiting(b);
  b->windows[b->waiting++] = *w;
  if (b->waiting == PARTS) put_waiting(b);
}

/* The windows of a run. Their order is that of a particle's neighbours, and so of all sums over
 * them: it must not depend on which particles share a group, for groups differ with the width of
 * lanes. So one row comes after another. Opposite rows come in turn: a particle near the one is far
 * from the other, so that all in a group have about as many neighbours in both. */
typedef struct run_windows {
  const search *s;
  const run *r;
  row_candidates rows;
  int next;  /* row, in this order */
  int where; /* along rows: what is beyond faces comes last */
  run moved; /* to an image, where candidates are near one */
} run_windows;

static void take_candidates(run_windows *all, int where) {
  const reached_cells from = {all->r->row, all->r->first_cell, all->r->last_cell};
  all->s->candidates(all->s, &from, where, &all->rows);
  all->where = where;
  all->next = 0;
}

static __attribute__((noinline)) const run *image_of_run(run_windows *all, uint32_t image) {
  all->moved = *all->r;
  for (int k = 0; k < PBF_DIM; ++k)
    all->moved.x[k] = all->r->x[k] + ops<lane>::set(all->s->images[image].c[k]);
  return &all->moved;
}

static int next_in_rows(run_windows *all, neighbor_window *w) {
  for (; all->next < GRID_ROWS_AROUND; ++all->next) {
    const int pair = all->next / 2, row = all->next % 2 ? GRID_ROWS_AROUND - 1 - pair : pair;
    candidate_range *c = &all->rows.in[row];
    const run *r = c->image ? image_of_run(all, c->image) : all->r;
    if (next_window(all->s, r, c, w)) return 1;
  }
  return 0;
}

static int next_of_run(run_windows *all, neighbor_window *w) {
  while (!next_in_rows(all, w)) {
    if (!all->s->grid->up[0] || all->where == BEYOND_UPPER) return 0;
    take_candidates(all, all->where + 1);
  }
  return 1;
}

static void search_run(const search *s, const run *r, builder *b) {
  run_windows all;
  all.s = s;
  all.r = r;
  take_candidates(&all, BETWEEN_FACES);
  for (neighbor_window w; next_of_run(&all, &w);) put_window(b, &w);
}

/* Where a group lies in two runs, windows of both share blocks: each lane has neighbours in one of
 * them alone. */
static void search_runs(const search *s, const run *one, const run *two, builder *b) {
  run_windows all[2];
  for (int k = 0; k < 2; ++k) {
    all[k].s = s;
    all[k].r = k ? two : one;
    take_candidates(&all[k], BETWEEN_FACES);
  }
  int found = 1;
  while (found) {
    found = 0;
    for (int k = 0; k < 2; ++k) {
      neighbor_window w;
      if (!next_of_run(&all[k], &w)) continue;
      put_window(b, &w);
      found = 1;
    }
  }
}

static void search_group(const search *s, uint32_t g, builder *b) {
  uint32_t i = g * WIDTH, stop = s->count - i < WIDTH ? s->count : i + WIDTH;
  while (i < stop) {
    run r = run_from(s, i, stop);
    i = g * WIDTH + r.end;
    if (i < stop) {
      run next = run_from(s, i, stop);
      i = g * WIDTH + next.end;
      search_runs(s, &r, &next, b);
    } else {
      search_run(s, &r, b);
    }
  }
  put_waiting(b);
}

static list_size search_groups(const search *s, uint32_t first, uint32_t last, list_arena *space) {
  builder b = {.data = s->data, .arena = space};
  list_size all = {0};
  for (uint32_t g = first; g < last; ++g) {
    b.begin = b.next = space->next;
    b.blocks = 0;
    search_group(s, g, &b);
    s->groups[g] = (group){(uint32_t)b.begin, b.blocks};
    uint64_t units = b.next - b.begin;
    all.units += units;
    if (units > all.largest) all.largest = (uint32_t)units;
    if (!b.lacking) space->next = b.next;
  }
  all.lacking = b.lacking;
  return all;
}

#endif
