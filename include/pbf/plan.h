/* pbf/plan.h: which stages a step has and how long they take, which arrays there are and how large
 * they are.
 *
 * The rules of pbf.h hold here, too.
 */
#ifndef PBF_PLAN_H
#define PBF_PLAN_H

#include <pbf/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Times of the stages --------------------------------------------------------------------- */

/* Stages and arrays that a solver can have. */
#define PBF_MAX_STAGES 24
#define PBF_MAX_ARRAYS 40

/* A stage, by the name that it has in the plan. */
typedef struct pbf_stage_time {
  char name[PBF_NAME_SIZE];
  double milliseconds; /* since timing was switched on */
  uint64_t runs;
} pbf_stage_time;

typedef struct pbf_timings {
  uint32_t struct_size;
  uint32_t stage_count;
  pbf_stage_time stages[PBF_MAX_STAGES];
} pbf_timings;

/* Per-stage times; off at first. Switching on clears them; while on, a device is synchronised
 * after every stage, so the sum is more than an untimed step takes. Where the plan has one launch
 * for all stages (small scenes on cuda), its time is that of the first. Changes no bit. */
PBF_API pbf_status pbf_set_timing(pbf_solver *solver, uint32_t enabled);
PBF_API pbf_status pbf_get_timings(pbf_solver *solver, pbf_timings *timings);

/* ---- Stages and memory ----------------------------------------------------------------------- */

/* A stage that a step has. */
typedef struct pbf_plan_stage {
  char name[PBF_NAME_SIZE];
  uint32_t runs_per_step;
  uint32_t launches_per_step; /* device launches; 0 on a CPU */
} pbf_plan_stage;

/* An array that the solver holds. */
typedef struct pbf_plan_array {
  char name[PBF_NAME_SIZE];
  double bytes_per_particle; /* of capacity */
  uint64_t bytes;            /* allocated now */
} pbf_plan_array;

/* What a solver runs and holds with its present parameters; nothing else exists. */
typedef struct pbf_plan {
  uint32_t struct_size;
  uint32_t stage_count;
  uint32_t array_count;
  uint32_t reserved;               /* 0 */
  char variant[PBF_NAME_SIZE * 2]; /* "3d-f32-wendland", with what the hot loop was built for */
  double bytes_per_particle;       /* sum over the arrays */
  uint64_t bytes;                  /* everything allocated now, small tables included */
  pbf_plan_stage stages[PBF_MAX_STAGES];
  pbf_plan_array arrays[PBF_MAX_ARRAYS];
} pbf_plan;

/* plan->struct_size must be set. */
PBF_API pbf_status pbf_get_plan(pbf_solver *solver, pbf_plan *plan);

#ifdef __cplusplus
}
#endif

#endif
