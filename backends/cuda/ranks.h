/* Part of solver.h: what a solver that is one of some ranks (pbf/ranks.h) knows of the others. Each
 * rank has a device. A rank's share is a run of the order of all particles by cell and id, and it
 * holds copies of what is near before and behind it, as on CPUs: cpu/shares.h says why. Devices
 * write into each other's memory, and tell each other by numbers that grow. Those that do not reach
 * each other's, as on two hosts, write into a mirror of it, and hosts exchange what changed there:
 * staging.h. */
#ifndef PBF_CUDA_RANKS_H
#define PBF_CUDA_RANKS_H

#include <pbf/ranks.h>

#include "cuda/particles.h"
#include "cuda/plugin.h"
#include "physics/features.h"

enum {
  RANKS_OF_CUDA = 64, /* at most */
  RANK_BINS = 8192,   /* in which cells are counted, runs of their numbers */
  RANK_GROUP = 32,    /* a share begins with a warp's particles: what a warp shares of its lists is
                         as without ranks */
  RANK_REALS = 8      /* of a particle, exchanged at once */
};

/* Places in the order of all particles, and the bins and cells of those that are held. */
struct rank_share {
  uint32_t own_first, own_last, held_first, held_last;
  uint32_t bin_first, bin_last, cell_first, cell_last;
};

/* What each rank's device finds out of all ranks' bins. */
struct rank_plan {
  rank_share shares[RANKS_OF_CUDA];
  uint32_t inbox_first[RANKS_OF_CUDA]; /* where its particles begin in those that each one gets,
                                          or, of staged ones, in its outbox */
  uint32_t sent[RANKS_OF_CUDA];        /* particles that it sends to each, … */
  uint32_t got[RANKS_OF_CUDA];         /* … and gets of each, … */
  uint32_t received;                   /* … and of all together */
  uint32_t fits;                       /* each rank has room for what it is to hold */
  unsigned long long sequence;         /* of this plan; written last */
};

/* Of the device, all in one piece. `sent` counts those that have been put for each rank. */
struct rank_control {
  rank_plan plan;
  uint32_t bins[RANK_BINS]; /* of its own particles */
  uint32_t sent[RANKS_OF_CUDA];
  uint32_t arrived; /* blocks */
  uint32_t lost;    /* a rank has not come within the time that there is */
  char *rooms[RANKS_OF_CUDA], *inboxes[RANKS_OF_CUDA]; /* of all, as this device sees them; of
                                                          staged ones mirrors, and null */
  uint64_t staged;                                     /* a bit for each of these */
};

/* What the device tells the host, in the host's memory. */
struct rank_report {
  rank_plan plan;
  uint32_t lost;
};

/* A rank's room, into which the others write: how far each has come; its bins, in turns one of two;
 * and what stages have changed of particles that this one holds, in turns one of two as well. */
static inline __host__ __device__ uint64_t *rank_arrivals(char *room) {
  return reinterpret_cast<uint64_t *>(room);
}

static inline __host__ __device__ uint64_t rank_bins_begin(uint32_t ranks, uint32_t turn,
                                                           uint32_t of) {
  return RANKS_OF_CUDA * sizeof(uint64_t) +
         ((uint64_t)turn * ranks + of) * RANK_BINS * sizeof(uint32_t);
}

static inline __host__ __device__ uint32_t *rank_bins(char *room, uint32_t ranks, uint32_t turn,
                                                      uint32_t of) {
  return reinterpret_cast<uint32_t *>(room + rank_bins_begin(ranks, turn, of));
}

static inline __host__ __device__ uint64_t rank_mail_begin(uint32_t ranks) {
  return RANKS_OF_CUDA * sizeof(uint64_t) + 2ull * ranks * RANK_BINS * sizeof(uint32_t);
}

static inline __host__ __device__ uint64_t rank_mail_bytes(uint32_t halo) {
  return (uint64_t)halo * RANK_REALS * sizeof(pbf_real);
}

/* Behind it, what its own particles add to the cells of a pressure grid, which the others read. One
 * is enough: shares, which all find together, come between one step's and the next. */
static inline __host__ __device__ uint64_t rank_sums_begin(uint32_t ranks, uint32_t halo) {
  return rank_mail_begin(ranks) + 2 * rank_mail_bytes(halo);
}

static inline __host__ __device__ unsigned long long *rank_sums(char *room, uint32_t ranks,
                                                                uint32_t halo) {
  return reinterpret_cast<unsigned long long *>(room + rank_sums_begin(ranks, halo));
}

/* A sum, a place and the moves along the axes, for each index. */
enum { RANK_SUMS = 2 + PBF_DIM };

/* And behind them, where the further compartments of each cell begin: what a thin
 * solid divides each device numbers as it comes to it. */
static inline __host__ __device__ uint64_t rank_further_begin(uint32_t ranks, uint32_t halo,
                                                              uint64_t indices) {
  return rank_sums_begin(ranks, halo) + indices * RANK_SUMS * sizeof(unsigned long long);
}

static inline __host__ __device__ uint32_t *rank_further(char *room, uint32_t ranks, uint32_t halo,
                                                         uint64_t indices) {
  return reinterpret_cast<uint32_t *>(room + rank_further_begin(ranks, halo, indices));
}

/* Behind all of that, numbers that are summed up: `numbers` of each rank, which it writes there. */
static inline uint64_t rank_numbers_begin(uint32_t ranks, uint32_t halo, uint64_t indices) {
  return rank_further_begin(ranks, halo, indices) + (indices + indices % 2) * sizeof(uint32_t);
}

/* And a byte for each of its own particles, in which others note something about it. */
static inline uint64_t rank_notes_begin(uint32_t ranks, uint32_t halo, uint64_t indices,
                                        uint64_t numbers) {
  return rank_numbers_begin(ranks, halo, indices) + ranks * numbers * sizeof(unsigned long long);
}

/* Particles that a rank gets, in the room of its lists: a field after another. */
struct rank_inbox {
  point *points;
  pbf_vec *velocities;
  uint32_t *ids;
  pbf_real *last_pressure, *overlap, *activity; /* null: none, … */
  uint8_t *phase;                               /* … as here, … */
  pbf_vec *acceleration;                        /* … and here */
};

/* Which of these there are. */
struct rank_inbox_has {
  bool last_pressure, overlap, activity, phase, acceleration;
};

/* The capacity is a multiple of RANK_GROUP. */
static inline uint64_t rank_inbox_bytes(uint32_t capacity, const rank_inbox_has &has) {
  const uint64_t numbers = (uint64_t)has.last_pressure + has.overlap + has.activity;
  const uint64_t vectors = (uint64_t)1 + has.acceleration;
  return capacity * (sizeof(point) + vectors * sizeof(pbf_vec) + sizeof(uint32_t) +
                     numbers * sizeof(pbf_real) + (uint64_t)has.phase);
}

static inline __host__ __device__ rank_inbox rank_inbox_in(char *at, uint32_t capacity,
                                                           const rank_inbox_has &has) {
  rank_inbox in;
  in.points = reinterpret_cast<point *>(at);
  in.velocities = reinterpret_cast<pbf_vec *>(in.points + capacity);
  in.acceleration = in.velocities + capacity;
  in.last_pressure =
      reinterpret_cast<pbf_real *>(in.acceleration + (has.acceleration ? capacity : 0));
  in.overlap = in.last_pressure + (has.last_pressure ? capacity : 0);
  in.activity = in.overlap + (has.overlap ? capacity : 0);
  in.ids = reinterpret_cast<uint32_t *>(in.activity + (has.activity ? capacity : 0));
  in.phase = reinterpret_cast<uint8_t *>(in.ids + capacity);
  if (!has.last_pressure) in.last_pressure = nullptr;
  if (!has.overlap) in.overlap = nullptr;
  if (!has.activity) in.activity = nullptr;
  if (!has.phase) in.phase = nullptr;
  if (!has.acceleration) in.acceleration = nullptr;
  return in;
}

/* The fields that there are, for what treats all alike. */
struct rank_inbox_field {
  char *at;
  uint64_t bytes; /* of a particle */
};

enum { RANK_INBOX_FIELDS = 8 };

static inline uint32_t rank_inbox_fields(const rank_inbox &in,
                                         rank_inbox_field fields[RANK_INBOX_FIELDS]) {
  const rank_inbox_field all[RANK_INBOX_FIELDS] = {
      {reinterpret_cast<char *>(in.points), sizeof *in.points},
      {reinterpret_cast<char *>(in.velocities), sizeof *in.velocities},
      {reinterpret_cast<char *>(in.ids), sizeof *in.ids},
      {reinterpret_cast<char *>(in.last_pressure), sizeof *in.last_pressure},
      {reinterpret_cast<char *>(in.overlap), sizeof *in.overlap},
      {reinterpret_cast<char *>(in.activity), sizeof *in.activity},
      {reinterpret_cast<char *>(in.phase), sizeof *in.phase},
      {reinterpret_cast<char *>(in.acceleration), sizeof *in.acceleration}};
  uint32_t count = 0;
  for (const rank_inbox_field &field : all)
    if (field.at) fields[count++] = field;
  return count;
}

/* Halves of the sort's scratch are of its own particles and of those that it gets. */
static inline uint64_t rank_scratch_bytes(uint32_t capacity) {
  return 5ull * capacity * sizeof(uint32_t);
}

/* What is staged in the host's memory that the device sees. */
struct rank_staging {
  bool any; /* of any two ranks */
  bool with[RANKS_OF_CUDA];
  char *memory;                 /* of all mirrors */
  char *mirrors[RANKS_OF_CUDA]; /* as the host sees them; its own is where messages come and go */
  char *outbox, *inbox;         /* particles that are sent, and got */
  uint64_t outbox_bytes, inbox_bytes;
};

struct rank_state {
  pbf_ranks link;
  uint32_t count, rank; /* count 0: it is alone */
  uint32_t total;       /* particles of all */
  double portions[RANKS_OF_CUDA];
  pbf_status failed; /* of this call; PBF_OK: it goes on */
  bool lost, told;   /* the others are out of reach; and the caller knows */
  char reason[320];
  uint64_t particles; /* a digest of what has come in */
  uint64_t settings;  /* and one of what the library keeps itself */
  uint64_t sequence;  /* of what all tell each other */
  uint32_t turn;      /* of their rooms */
  rank_control *control;
  rank_report *report; /* the host's */
  rank_report *device_report;
  char *room;
  uint32_t halo_room, cell_room; /* as on all ranks, … */
  uint64_t index_room;           /* … as are these: indices of a pressure grid, … */
  uint64_t number_room;          /* … numbers that are summed up, … */
  uint32_t note_room;            /* … and notes about particles */
  bool wakes;      /* a collider has left sleepers of its own, and those of all are to wake */
  bool all_asleep; /* on all ranks, after the last step; tally->all is 0 or not by it */
  uint32_t *cell_memory;
  rank_staging staging;
  bool one_by_one;        /* ranks share a device: none may wait there for another */
  uint32_t careful_steps; /* that are to come: kernels may be launched for the first time, … */
  bool careful_once;      /* … as in a sort outside of steps */
  bool careful;           /* the last sort, and what comes behind it, was so */
  bool changed;           /* others do not know where its room is */
  char *opened[2][RANKS_OF_CUDA];   /* by handles of other processes */
  rank_share shares[RANKS_OF_CUDA]; /* of the last sort */
  uint32_t pad;                     /* places before the first that is held */
  uint32_t first, last;             /* its own among those that are held */
  uint32_t held;                    /* the end of these */
  uint32_t inner_first, inner_last; /* of its own, those that no other rank holds */
  cudaStream_t edges;               /* where stages work on the others of its own, … */
  cudaEvent_t inner_done, edges_done[2];
  uint64_t bytes_sent; /* of stages' exchanges */
};

/* Where stages' fields come, in turns. */
static inline uint64_t rank_mail(const rank_state *r, uint32_t turn) {
  return rank_mail_begin(r->count) + turn * rank_mail_bytes(r->halo_room);
}

/* Of its room, which is as large on all ranks. */
static inline uint64_t rank_room_bytes(const rank_state *r) {
  return rank_notes_begin(r->count, r->halo_room, r->index_room, r->number_room) + r->note_room;
}

#endif
