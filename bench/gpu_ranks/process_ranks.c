#define _GNU_SOURCE
#include "process_ranks.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MAX_RANKS = 8, BOARD = 64 << 20 };

/* What a rank shows the others: messages, each behind its receiver and its bytes. */
typedef struct board {
  uint64_t bytes;
  char data[BOARD];
} board;

typedef struct common {
  pthread_barrier_t all_here;
  board boards[MAX_RANKS];
} common;

typedef struct process_rank {
  common *all;
  uint32_t rank, count;
  const char *why;
} process_rank;

void *process_shared(size_t bytes) {
  void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) exit(1);
  return memory;
}

static pbf_status all_gather(void *user, const void *mine, void *all, uint64_t bytes) {
  process_rank *me = user;
  memcpy(me->all->boards[me->rank].data, mine, bytes);
  pthread_barrier_wait(&me->all->all_here);
  for (uint32_t r = 0; r < me->count; ++r)
    memcpy((char *)all + r * bytes, me->all->boards[r].data, bytes);
  pthread_barrier_wait(&me->all->all_here);
  return PBF_OK;
}

static pbf_status sum(void *user, uint32_t *values, uint64_t count) {
  process_rank *me = user;
  memcpy(me->all->boards[me->rank].data, values, count * sizeof *values);
  pthread_barrier_wait(&me->all->all_here);
  for (uint64_t k = 0; k < count; ++k) {
    values[k] = 0;
    for (uint32_t r = 0; r < me->count; ++r)
      values[k] += ((const uint32_t *)me->all->boards[r].data)[k];
  }
  pthread_barrier_wait(&me->all->all_here);
  return PBF_OK;
}

static pbf_status show(process_rank *me, uint32_t count, const pbf_rank_message *sends) {
  board *mine = &me->all->boards[me->rank];
  mine->bytes = 0;
  for (uint32_t k = 0; k < count; ++k) {
    const uint64_t head[2] = {sends[k].rank, sends[k].bytes};
    if (mine->bytes + sizeof head + sends[k].bytes > BOARD) {
      me->why = "messages are longer than there is room for";
      return PBF_ERROR_UNAVAILABLE;
    }
    memcpy(mine->data + mine->bytes, head, sizeof head);
    memcpy(mine->data + mine->bytes + sizeof head, sends[k].data, sends[k].bytes);
    mine->bytes += sizeof head + sends[k].bytes;
  }
  return PBF_OK;
}

/* The message that comes next to this rank, from `*at` on; null: there is none. */
static const char *next_message(const process_rank *me, uint32_t from, uint64_t *at,
                                uint64_t bytes) {
  const board *its = &me->all->boards[from];
  while (*at < its->bytes) {
    uint64_t head[2];
    memcpy(head, its->data + *at, sizeof head);
    const char *data = its->data + *at + sizeof head;
    *at += sizeof head + head[1];
    if (head[0] == me->rank) return head[1] == bytes ? data : NULL;
  }
  return NULL;
}

static pbf_status exchange(void *user, uint32_t send_count, const pbf_rank_message *sends,
                           uint32_t receive_count, const pbf_rank_message *receives) {
  process_rank *me = user;
  uint64_t at[MAX_RANKS] = {0};
  pbf_status status = show(me, send_count, sends);
  pthread_barrier_wait(&me->all->all_here);
  for (uint32_t k = 0; k < receive_count && status == PBF_OK; ++k) {
    const uint32_t from = receives[k].rank;
    const char *data = next_message(me, from, &at[from], receives[k].bytes);
    if (data) memcpy(receives[k].data, data, receives[k].bytes);
    if (!data) me->why = "a message is not that which was expected";
    if (!data) status = PBF_ERROR_UNAVAILABLE;
  }
  pthread_barrier_wait(&me->all->all_here);
  return status;
}

int process_ranks_staged;

static const char *reason(void *user) { return ((process_rank *)user)->why; }

static void be_rank(process_rank *me, uint32_t local_capacity, process_rank_fn function,
                    void *context) {
  const pbf_ranks ranks = {.struct_size = sizeof ranks,
                           .rank = me->rank,
                           .count = me->count,
                           .local_capacity = local_capacity,
                           .user = me,
                           .all_gather = all_gather,
                           .sum = sum,
                           .exchange = exchange,
                           .reason = reason,
                           .host_staged = process_ranks_staged != 0};
  function(me->count ? &ranks : NULL, context);
  fflush(stdout);
  _exit(0);
}

int process_ranks_run(uint32_t count, uint32_t local_capacity, process_rank_fn function,
                      void *context) {
  common *all = process_shared(sizeof *all);
  pthread_barrierattr_t shared;
  int failed = 0;
  pthread_barrierattr_init(&shared);
  pthread_barrierattr_setpshared(&shared, PTHREAD_PROCESS_SHARED);
  pthread_barrier_init(&all->all_here, &shared, count ? count : 1);
  fflush(stdout);
  for (uint32_t r = 0; r < (count ? count : 1); ++r) {
    process_rank me = {.all = all, .rank = r, .count = count};
    const pid_t child = fork();
    if (child < 0) exit(1);
    if (child == 0) be_rank(&me, local_capacity, function, context);
  }
  for (uint32_t r = 0; r < (count ? count : 1); ++r) {
    int status = 0;
    failed |= wait(&status) < 0 || status != 0;
  }
  munmap(all, sizeof *all);
  return failed;
}
