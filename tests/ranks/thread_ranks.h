/* Ranks that are threads of one process: what pbf_mpi does with processes. */
#ifndef PBF_TESTS_THREAD_RANKS_H
#define PBF_TESTS_THREAD_RANKS_H

#include <pthread.h>

#include <pbf/ranks.h>

enum { MAX_THREAD_RANKS = 8 };

typedef struct thread_ranks thread_ranks;

/* One rank's end. */
typedef struct thread_rank {
  thread_ranks *all;
  uint32_t rank;
  uint64_t calls;      /* that have communicated, */
  uint64_t dies_after; /* and after which it is never heard of again; 0: it lives */
  double nap; /* seconds that it sleeps after it has communicated, each time a little more */
  uint64_t bytes_sent; /* by exchanges */
  uint64_t exchanges;  /* in two calls; what the running one is to receive: */
  uint32_t receive_count;
  const pbf_rank_message *receives;
  char reason[128];
} thread_rank;

struct thread_ranks {
  uint32_t count, arrived;
  uint64_t round;
  pthread_mutex_t lock;
  pthread_cond_t all_here;
  double patience; /* seconds to wait for others */
  int failed;
  const void *shown[MAX_THREAD_RANKS]; /* by each rank to all others */
  uint32_t shown_count[MAX_THREAD_RANKS];
  thread_rank ranks[MAX_THREAD_RANKS];
};

typedef void (*thread_rank_fn)(const pbf_ranks *ranks, void *context);

/* Calls `function` in so many threads, as ranks with this local_capacity and these shares, and
 * returns when all have ended. `dies_after`, unless null, is of each rank. */
void thread_ranks_run(uint32_t count, uint32_t local_capacity, const double *shares,
                      const uint64_t *dies_after, thread_rank_fn function, void *context);

/* 0: those that are run from now on do not exchange in two calls. */
extern int thread_ranks_overlap;

/* The first of those ranks that are host_staged. */
extern uint32_t thread_ranks_staged_from;

/* cmocka's assertions are for the thread of the test; these note what fails in any, print it, and
 * give the condition back. */
int rank_expect(int holds, const char *what, const char *file, int line);
#define EXPECT(condition) rank_expect((condition) != 0, #condition, __FILE__, __LINE__)
#define EXPECT_OK(call) rank_expect_status((call), PBF_OK, "", #call, __FILE__, __LINE__)
#define EXPECT_FAILS(call, status, words) \
  rank_expect_status((call), (status), (words), #call, __FILE__, __LINE__)
int rank_expect_status(pbf_status status, pbf_status expected, const char *words, const char *call,
                       const char *file, int line);

/* What has failed since the last look. */
int ranks_failures(void);

/* The end that a rank was given. */
thread_rank *thread_rank_of(const pbf_ranks *ranks);

#endif
