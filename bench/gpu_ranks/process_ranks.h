/* Ranks that are processes of this host: what MPI would start. */
#ifndef PBF_BENCH_GPU_RANKS_PROCESS_RANKS_H
#define PBF_BENCH_GPU_RANKS_PROCESS_RANKS_H

#include <stddef.h>

#include <pbf/ranks.h>

typedef void (*process_rank_fn)(const pbf_ranks *ranks, void *context);

/* Memory that the processes have in common; zeros. */
void *process_shared(size_t bytes);

/* Calls `function` in so many processes, or with 0 in one that is no rank, and returns when all
 * have ended: 0 unless one has failed. Before it the caller may not have used a device. */
int process_ranks_run(uint32_t count, uint32_t local_capacity, process_rank_fn function,
                      void *context);

/* 1: those that are run from now on are host_staged. */
extern int process_ranks_staged;

#endif
