/* How many arrays solvers have for some scenes only: arrays.def. */
#ifndef PBF_PHYSICS_SCENE_ARRAYS_H
#define PBF_PHYSICS_SCENE_ARRAYS_H

/* Of all backends. */
enum {
  PBF_SCENE_ARRAYS = 0
#define PBF_ARRAY(name, wanted, holders) +1
#include "physics/arrays.def"
};

#endif
