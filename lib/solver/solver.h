/* What the host keeps of a solver, and the door through which every call enters it. */
#ifndef PBF_LIB_SOLVER_H
#define PBF_LIB_SOLVER_H

#include "check.h"
#include "plugin/plugin.h"

enum { PBF_FIELD_COUNT = PBF_FIELD_PRESSURE + 1 };

struct pbf_solver {
  /* Guarded by the lock in handles.c. */
  pbf_solver *next_live;
  uint32_t references; /* the handle, a running call, every exported tensor */
  uint32_t inside;     /* 1: a call is running */
  uint32_t exported;   /* tensors whose deleter has not run */

  /* Of the call that is inside. */
  pbf_allocator allocator;
  pbf_log_fn log;
  void *log_user;
  const pbf_plugin *plugin;
  pbf_backend_api api; /* the table of this solver's variant */
  pbf_backend_solver *backend;
  pbf_check_kind kind;
  uint32_t capacity;
  int32_t device;
  uint32_t fell_back;
  char fallback_reason[256];

  pbf_params params; /* as the caller set them */

  uint32_t collider_count;
  pbf_collider *colliders; /* as set, at collider_time; null when there are none */
  double collider_time;

  uint32_t count;
  uint64_t next_id;
  uint32_t *ids; /* ascending, room for capacity; null while they are 0 … count - 1 */

  /* time = time_base + steps_since * time_step: no sum of roundings. */
  uint64_t step;
  uint64_t steps_since;
  double time_base;

  uint32_t placed; /* particles placed since the last step, see pbf_note_placed */

  uint64_t generation;
  uint32_t mapped[PBF_FIELD_COUNT];
};

/* Fails for null, for what is no live solver, and with PBF_ERROR_BUSY. Every success wants one
 * pbf_leave, which gives `status` back. */
pbf_status pbf_enter(pbf_solver *solver);
pbf_status pbf_leave(pbf_solver *solver, pbf_status status);

/* Makes the handle valid, with one reference: the handle itself. */
void pbf_solver_publish(pbf_solver *solver);

/* An exported tensor keeps the solver's memory alive. */
void pbf_solver_add_export(pbf_solver *solver);
void pbf_solver_drop_export(pbf_solver *solver);

/* Fails with PBF_ERROR_STATE while a view is mapped or a tensor exported. */
pbf_status pbf_check_unmapped(pbf_solver *solver);

double pbf_solver_time(const pbf_solver *solver);

/* Tells the backend what the time is, for where walls and colliders stand in densities and
 * statistics: after any change of it that was no step of the backend's. In step.c. */
pbf_status pbf_solver_tell_time(pbf_solver *solver, double time);

/* From now on steps have another length. */
void pbf_solver_rebase_time(pbf_solver *solver);

/* What a backend's function returned, made into what the caller gets: a known code, and a sentence
 * where the backend gave none. */
pbf_status pbf_backend_result(const pbf_solver *solver, pbf_status status, const char *function);

/* Fails where the backend, or the way in which it solves now, keeps no pressures. */
pbf_status pbf_check_pressures(const pbf_solver *solver);

/* Bytes of one component of a position. */
uint32_t pbf_element_size(const pbf_solver *solver);

#endif
