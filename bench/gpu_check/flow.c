#include "flow.h"

#include <string.h>

#include <pbf/emit.h>

#include "solver.h"

static double between(const scene *s, int axis, double part) {
  const double lower = s->params.domain_min[axis];
  return lower + part * (s->params.domain_max[axis] - lower);
}

static void add_emitter(const scene *s, pbf_solver *solver) {
  pbf_emitter e;
  must(pbf_emitter_init(&e, sizeof e, PBF_EMITTER_RECTANGLE), "pbf_emitter_init");
  for (int k = 0; k < 3; ++k) e.position[k] = between(s, k, k == 1 ? 0.8 : 0.5);
  e.half_width = e.half_height = 4 * s->spacing;
  e.recycle = 1;
  must(pbf_set_emitters(solver, 1, &e), "pbf_set_emitters");
}

static void add_drain(const scene *s, pbf_solver *solver) {
  pbf_volume v;
  must(pbf_volume_init(&v, sizeof v, PBF_VOLUME_SPHERE), "pbf_volume_init");
  for (int k = 0; k < 3; ++k) v.position[k] = between(s, k, k == 0 ? 1 : 0);
  v.radius = 3 * s->spacing;
  must(pbf_set_drains(solver, 1, &v), "pbf_set_drains");
}

static void add_reservoir(const scene *s, pbf_solver *solver) {
  pbf_reservoir r;
  must(pbf_reservoir_init(&r, sizeof r), "pbf_reservoir_init");
  for (int k = 0; k < 3; ++k) {
    r.half_extents[k] = 3 * s->spacing;
    r.position[k] = s->params.domain_min[k] + r.half_extents[k];
  }
  r.depth = 4 * s->spacing;
  must(pbf_set_reservoirs(solver, 1, &r), "pbf_set_reservoirs");
}

static const struct {
  const char *name;
  void (*add)(const scene *s, pbf_solver *solver);
} kinds[] = {{"emitter", add_emitter}, {"drain", add_drain}, {"reservoir", add_reservoir}};

enum { KINDS = sizeof kinds / sizeof *kinds };

int is_flow(const char *name) {
  int is = strcmp(name, "flow") == 0;
  for (int k = 0; k < KINDS; ++k) is |= strcmp(name, kinds[k].name) == 0;
  return is;
}

void add_flow(const scene *s, pbf_solver *solver) {
  if (!s->flow) return;
  for (int k = 0; k < KINDS; ++k)
    if (strcmp(s->flow, "flow") == 0 || strcmp(s->flow, kinds[k].name) == 0)
      kinds[k].add(s, solver);
}
