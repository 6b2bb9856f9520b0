/* A task system as engines have one, which runs a task in one of the ways that desc.h allows. */
#ifndef PBF_TESTS_SOAK_TASKS_H
#define PBF_TESTS_SOAK_TASKS_H

#include <pbf/pbf.h>

/* Starts `threads` workers, as many as can be had; returns how many. */
uint32_t tasks_begin(uint32_t threads);
void tasks_end(void);

/* In the child of a fork, which has none of the workers. */
void tasks_after_fork(void);

/* For pbf_desc; `user` is not looked at. */
void *tasks_enqueue(void *user, pbf_task_fn run, void *task, uint32_t items, uint32_t min_range);
void tasks_finish(void *user, void *handle);

#endif
