/* Tasks that are open in callers' task systems, by number: an item may run after its task has
 * ended, of a system that does not wait for all, and then finds none. A table, not a list through
 * what tasks are of: that is on stacks, which are gone where a callback has left its call by a
 * longjmp or an exception. Guarded by a lock of those that have one. */
#ifndef PBF_COMMON_OPEN_TASKS_H
#define PBF_COMMON_OPEN_TASKS_H

#include <stddef.h>
#include <stdint.h>

/* At once: calls that run, and those that were left. */
enum { PBF_MAX_OPEN_TASKS = 64 };

typedef struct pbf_open_task {
  uintptr_t number; /* 0: the place is free */
  void *of;         /* on its caller's stack */
} pbf_open_task;

typedef struct pbf_open_tasks {
  pbf_open_task places[PBF_MAX_OPEN_TASKS];
  uintptr_t so_far;
} pbf_open_tasks;

/* Its number, which a task system has for an address; 0: there is no place left. */
static inline uintptr_t pbf_open_tasks_add(pbf_open_tasks *tasks, void *of) {
  uint32_t k = 0;
  while (k < PBF_MAX_OPEN_TASKS && tasks->places[k].number) ++k;
  if (k == PBF_MAX_OPEN_TASKS) return 0;
  tasks->places[k].number = ++tasks->so_far * PBF_MAX_OPEN_TASKS + k;
  tasks->places[k].of = of;
  return tasks->places[k].number;
}

static inline pbf_open_task *pbf_open_tasks_find(pbf_open_tasks *tasks, uintptr_t number) {
  pbf_open_task *task = &tasks->places[number % PBF_MAX_OPEN_TASKS];
  return number && task->number == number ? task : NULL;
}

/* What it is of; null where it is not open. */
static inline void *pbf_open_tasks_of(pbf_open_tasks *tasks, uintptr_t number) {
  const pbf_open_task *task = pbf_open_tasks_find(tasks, number);
  return task ? task->of : NULL;
}

/* 0: it was not open, since all were forgotten. */
static inline int pbf_open_tasks_remove(pbf_open_tasks *tasks, uintptr_t number) {
  pbf_open_task *task = pbf_open_tasks_find(tasks, number);
  if (task) task->number = 0;
  return task != NULL;
}

/* In a process that has none of the threads that may be inside. */
static inline void pbf_open_tasks_forget(pbf_open_tasks *tasks) {
  for (uint32_t k = 0; k < PBF_MAX_OPEN_TASKS; ++k) tasks->places[k].number = 0;
}

#endif
