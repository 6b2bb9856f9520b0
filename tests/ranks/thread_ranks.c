#include "thread_ranks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <stdatomic.h>
#include <time.h>

/* 0 when not all have come within the time that there is. */
static int meet_others(thread_ranks *all) {
  struct timespec end;
  clock_gettime(CLOCK_REALTIME, &end);
  end.tv_sec += (time_t)all->patience;
  end.tv_nsec += (long)(1e9 * (all->patience - (double)(time_t)all->patience));
  if (end.tv_nsec >= 1000000000) end.tv_nsec -= 1000000000, ++end.tv_sec;
  pthread_mutex_lock(&all->lock);
  const uint64_t round = all->round;
  if (++all->arrived == all->count) {
    all->arrived = 0;
    ++all->round;
    pthread_cond_broadcast(&all->all_here);
  }
  while (all->round == round && !all->failed)
    if (pthread_cond_timedwait(&all->all_here, &all->lock, &end)) {
      all->failed |= all->round == round;
      pthread_cond_broadcast(&all->all_here);
      break;
    }
  const int ok = all->round != round;
  pthread_mutex_unlock(&all->lock);
  return ok;
}

/* Those that wait end at once, as where a connection is lost. */
static void tell_of_a_death(thread_ranks *all) {
  pthread_mutex_lock(&all->lock);
  all->failed = 1;
  pthread_cond_broadcast(&all->all_here);
  pthread_mutex_unlock(&all->lock);
}

static pbf_status fail(thread_rank *me, const char *why) {
  snprintf(me->reason, sizeof me->reason, "%s", why);
  return PBF_ERROR_UNAVAILABLE;
}

/* So that what a rank does between two looks at a clock takes longer than on others, by a little.
 */
static void nap(thread_rank *me) {
  const struct timespec a_while = {0, (long)(1e9 * me->nap)};
  if (me->nap > 0) nanosleep(&a_while, NULL);
  me->nap *= 1.001;
}

/* Shows the others something, which they may look at until `end`. */
static pbf_status begin(thread_rank *me, const void *shown, uint32_t count) {
  if (me->dies_after && ++me->calls > me->dies_after) {
    tell_of_a_death(me->all);
    return fail(me, "this rank is dead");
  }
  me->all->shown[me->rank] = shown;
  me->all->shown_count[me->rank] = count;
  return meet_others(me->all) ? PBF_OK : fail(me, "a rank has not answered");
}

static pbf_status end(thread_rank *me) {
  if (!meet_others(me->all)) return fail(me, "a rank has not answered");
  nap(me);
  return PBF_OK;
}

static pbf_status all_gather(void *user, const void *mine, void *all, uint64_t bytes) {
  thread_rank *me = user;
  pbf_status status = begin(me, mine, 0);
  if (status != PBF_OK) return status;
  for (uint32_t r = 0; r < me->all->count; ++r)
    memcpy((char *)all + r * bytes, me->all->shown[r], bytes);
  return end(me);
}

static pbf_status sum(void *user, uint32_t *values, uint64_t count) {
  thread_rank *me = user;
  uint32_t *sums = calloc(count, sizeof *sums);
  if (!sums) return fail(me, "no memory");
  pbf_status status = begin(me, values, 0);
  for (uint32_t r = 0; r < me->all->count && status == PBF_OK; ++r)
    for (uint64_t k = 0; k < count; ++k) sums[k] += ((const uint32_t *)me->all->shown[r])[k];
  if (status == PBF_OK) status = end(me);
  if (status == PBF_OK) memcpy(values, sums, count * sizeof *sums);
  free(sums);
  return status;
}

/* The message number `at` that a rank sends to this one; null: there is none. */
static const pbf_rank_message *sent_to(const thread_rank *me, uint32_t from, uint32_t at) {
  const pbf_rank_message *list = me->all->shown[from];
  for (uint32_t k = 0; k < me->all->shown_count[from]; ++k)
    if (list[k].rank == me->rank && at-- == 0) return &list[k];
  return NULL;
}

/* Once all have shown what they send. */
static const char *receive(thread_rank *me, uint32_t receive_count,
                           const pbf_rank_message *receives) {
  uint32_t taken[MAX_THREAD_RANKS] = {0};
  const char *broken = NULL;
  for (uint32_t k = 0; k < receive_count; ++k) {
    const uint32_t from = receives[k].rank;
    const pbf_rank_message *message = sent_to(me, from, taken[from]++);
    if (!message || message->bytes != receives[k].bytes)
      broken = "a message is not that which was expected";
    else
      memcpy(receives[k].data, message->data, message->bytes);
  }
  for (uint32_t r = 0; r < me->all->count; ++r)
    if (sent_to(me, r, taken[r])) broken = "a message was not expected";
  return broken;
}

static pbf_status exchange(void *user, uint32_t send_count, const pbf_rank_message *sends,
                           uint32_t receive_count, const pbf_rank_message *receives) {
  thread_rank *me = user;
  for (uint32_t k = 0; k < send_count; ++k) me->bytes_sent += sends[k].bytes;
  pbf_status status = begin(me, sends, send_count);
  if (status != PBF_OK) return status;
  const char *broken = receive(me, receive_count, receives);
  status = end(me);
  return broken ? fail(me, broken) : status;
}

/* Messages arrive as early as they can, or as late, by turns: neither may matter. */
static pbf_status begin_exchange(void *user, uint32_t send_count, const pbf_rank_message *sends,
                                 uint32_t receive_count, const pbf_rank_message *receives) {
  thread_rank *me = user;
  const char *broken = NULL;
  for (uint32_t k = 0; k < send_count; ++k) me->bytes_sent += sends[k].bytes;
  me->receive_count = receive_count;
  me->receives = receives;
  pbf_status status = begin(me, sends, send_count);
  if (status != PBF_OK) return status;
  if (++me->exchanges % 2) broken = receive(me, receive_count, receives);
  return broken ? fail(me, broken) : PBF_OK;
}

static pbf_status end_exchange(void *user) {
  thread_rank *me = user;
  const char *broken = NULL;
  if (me->exchanges % 2 == 0) broken = receive(me, me->receive_count, me->receives);
  pbf_status status = end(me);
  return broken ? fail(me, broken) : status;
}

int thread_ranks_overlap = 1;
uint32_t thread_ranks_staged_from = MAX_THREAD_RANKS;

static const char *reason(void *user) { return ((thread_rank *)user)->reason; }

thread_rank *thread_rank_of(const pbf_ranks *ranks) { return ranks->user; }

typedef struct thread_call {
  pbf_ranks ranks;
  thread_rank_fn function;
  void *context;
} thread_call;

static void *call(void *context) {
  thread_call *c = context;
  c->function(&c->ranks, c->context);
  return NULL;
}

void thread_ranks_run(uint32_t count, uint32_t local_capacity, const double *shares,
                      const uint64_t *dies_after, thread_rank_fn function, void *context) {
  thread_ranks all = {.count = count, .patience = 120};
  thread_call calls[MAX_THREAD_RANKS];
  pthread_t threads[MAX_THREAD_RANKS];
  pthread_mutex_init(&all.lock, NULL);
  pthread_cond_init(&all.all_here, NULL);
  for (uint32_t r = 0; r < count; ++r) {
    all.ranks[r] = (thread_rank){.all = &all, .rank = r};
    if (dies_after) all.ranks[r].dies_after = dies_after[r];
    const pbf_ranks ranks = {.struct_size = sizeof ranks,
                             .rank = r,
                             .count = count,
                             .local_capacity = local_capacity,
                             .user = &all.ranks[r],
                             .all_gather = all_gather,
                             .sum = sum,
                             .exchange = exchange,
                             .reason = reason,
                             .shares = shares,
                             .begin_exchange = thread_ranks_overlap ? begin_exchange : NULL,
                             .end_exchange = thread_ranks_overlap ? end_exchange : NULL,
                             .host_staged = r >= thread_ranks_staged_from};
    calls[r] = (thread_call){ranks, function, context};
    if (pthread_create(&threads[r], NULL, call, &calls[r])) abort();
  }
  for (uint32_t r = 0; r < count; ++r) pthread_join(threads[r], NULL);
  pthread_cond_destroy(&all.all_here);
  pthread_mutex_destroy(&all.lock);
}

static atomic_int failures;

int rank_expect(int holds, const char *what, const char *file, int line) {
  if (holds) return 1;
  fprintf(stderr, "%s:%d: %s does not hold\n", file, line, what);
  atomic_fetch_add(&failures, 1);
  return 0;
}

int rank_expect_status(pbf_status status, pbf_status expected, const char *words, const char *call,
                       const char *file, int line) {
  if (status == expected && (expected == PBF_OK || strstr(pbf_last_error(), words))) return 1;
  fprintf(stderr, "%s:%d: %s: %s (\"%s\"), expected %s with \"%s\"\n", file, line, call,
          pbf_status_string(status), pbf_last_error(), pbf_status_string(expected), words);
  atomic_fetch_add(&failures, 1);
  return 0;
}

int ranks_failures(void) { return atomic_exchange(&failures, 0); }
