/* Checks and times one backend (default "cuda") through the public API alone, for machines that
 * have a GPU and little else:
 *
 *   gpu_check verify [SCENE|PART] distance to the float64 reference, every kind of scene; PART is
 *                                 2d-f32, 2d-f64, 3d-f32, 3d-f64 or large
 *   gpu_check same                the same bits in two runs, and after saving and loading
 *   gpu_check random FIRST COUNT  scenes drawn from these seeds, held against the reference
 *   gpu_check exercise            every call and stage once, small, for compute-sanitizer
 *   gpu_check time SCENE N [H/D [EXTRA]]
 *                                 report-30k or shallow-dam-break: time, error, plan, stages
 *
 *   gpu_check solids N COUNT SHAPE [move]
 *                                 a dam breaks over so many boxes, hulls or meshes: the same
 *
 * EXTRA is f64, or the name of an optional parameter, which is turned on, periodic (along z), or
 * emitter, drain, reservoir or flow, which is all three.
 * Prints one JSON object a line. Exit code 1 when a check failed, 2 when there is no device. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "flow.h"
#include "solver.h"

static int usage(void) {
  fprintf(stderr,
          "usage: gpu_check verify [SCENE | PART] | same | random FIRST COUNT | exercise | time "
          "SCENE N [H/D [f64 | "
          "optional parameter | periodic | emitter | drain | reservoir | flow]] | solids N COUNT "
          "box|hull|mesh [move]\n");
  return 2;
}

/* argv: scene, number of particles, and perhaps the support in spacings and what is extra. */
static int time_named(int argc, char **argv) {
  uint32_t particles = (uint32_t)strtoul(argv[1], NULL, 10);
  double support = argc > 2 ? strtod(argv[2], NULL) : 1 / 0.6;
  const char *extra = argc > 3 ? argv[3] : "";
  uint32_t precision = strcmp(extra, "f64") == 0 ? PBF_FLOAT64 : PBF_FLOAT32;
  scene s = shallow_dam_break(particles, support), report = report_30k();
  s.extra = extra;
  s.flow = is_flow(extra) ? extra : NULL;
  if (strcmp(extra, "periodic") == 0)
    s.params.periodic = PBF_PERIODIC_Z;
  else if (extra[0] && precision == PBF_FLOAT32 && !s.flow && !add_optional(&s, extra))
    return usage();
  if (strcmp(argv[0], report.name) == 0)
    time_scene(&report, precision, 0, 100);
  else
    time_scene(&s, precision, particles > 5000000 ? 30 : 150, particles > 5000000 ? 20 : 100);
  return 0;
}

int main(int argc, char **argv) {
  const char *command = argc > 1 ? argv[1] : "";
  int failures = 0;
  if (getenv("PBF_CHECK_BACKEND")) checked_backend = getenv("PBF_CHECK_BACKEND");
  if (strcmp(command, "verify") == 0) {
    failures = verify_all(argc > 2 ? argv[2] : NULL);
  } else if (strcmp(command, "same") == 0) {
    failures = same_all();
  } else if (strcmp(command, "random") == 0 && argc > 3) {
    failures = random_all(strtoull(argv[2], NULL, 10), strtoull(argv[3], NULL, 10));
  } else if (strcmp(command, "exercise") == 0) {
    exercise_all();
  } else if (strcmp(command, "time") == 0 && argc > 3) {
    return time_named(argc - 2, argv + 2);
  } else if (strcmp(command, "solids") == 0 && argc > 4) {
    const uint32_t particles = (uint32_t)strtoul(argv[2], NULL, 10);
    const uint32_t solids = (uint32_t)strtoul(argv[3], NULL, 10);
    return time_solids(particles, solids, argv[4], argc > 5) ? 0 : usage();
  } else {
    return usage();
  }
  return failures != 0;
}
