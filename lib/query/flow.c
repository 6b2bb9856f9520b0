/* How much of a volume is under water, and how that flows. */
#include <pbf/query.h>

#include <math.h>

#include "error.h"
#include "solver/handles.h"
#include "structs.h"
#include "sums.h"
#include "volume.h"

/* The volume's own grid of points: each stands for a cell of it. */
typedef struct raster {
  uint32_t counts[3];
  double step[3], width; /* the shortest step */
} raster;

enum { FEWEST = 8, MOST = 16 };

static raster raster_of(const pbf_volume_frame *frame, double spacing) {
  raster r = {{1, 1, 1}, {0, 0, 0}, INFINITY};
  for (uint32_t k = 0; k < frame->dimension; ++k) {
    const double wanted = ceil(2 * frame->half[k] / spacing);
    r.counts[k] = (uint32_t)fmin(fmax(wanted, FEWEST), MOST);
    r.step[k] = 2 * frame->half[k] / r.counts[k];
    r.width = fmin(r.width, r.step[k]);
  }
  return r;
}

/* How much of a cell of this width about a point is below the surface, as if that were flat: it is
 * as far as the density's slope says. */
static double wet_part(double density, const double gradient[3], double width) {
  double square = 0;
  for (int k = 0; k < 3; ++k) square += gradient[k] * gradient[k];
  const double beyond = density - PBF_QUERY_SURFACE, across = sqrt(square) * width;
  if (fabs(beyond) >= 0.5 * across) return beyond > 0;
  return 0.5 + beyond / across;
}

typedef struct sums {
  double points, wet, centre[3], velocity[3];
} sums;

static void add_point(pbf_query_place *place, const double point[3], double width, sums *s) {
  double gradient[3] = {0, 0, 0}, values[4];
  const double density = pbf_query_density(place, point, gradient);
  const double wet = wet_part(density, gradient, width);
  s->points += 1;
  if (!(wet > 0)) return;
  pbf_query_fields(place, point, PBF_QUERY_VELOCITIES, values);
  s->wet += wet;
  for (uint32_t k = 0; k < place->index->dimension; ++k) {
    s->centre[k] += wet * point[k];
    s->velocity[k] += wet * values[k];
  }
}

static void add_all(pbf_query_place *place, const pbf_volume_frame *frame, sums *s) {
  const raster r = raster_of(frame, place->index->spacing);
  const uint32_t cells = r.counts[0] * r.counts[1] * r.counts[2];
  for (uint32_t i = 0; i < cells; ++i) {
    const uint32_t at[3] = {i % r.counts[0], i / r.counts[0] % r.counts[1],
                            i / r.counts[0] / r.counts[1]};
    double local[3] = {0, 0, 0}, point[3];
    for (uint32_t k = 0; k < frame->dimension; ++k)
      local[k] = (at[k] + 0.5) * r.step[k] - frame->half[k];
    if (!pbf_volume_has_local(frame, local)) continue;
    for (uint32_t k = 0; k < 3; ++k) {
      point[k] = frame->position[k];
      for (uint32_t l = 0; l < frame->dimension; ++l) point[k] += frame->axes[l][k] * local[l];
    }
    add_point(place, point, r.width, s);
  }
}

static pbf_volume_flow flow_in(pbf_query_place *place, const pbf_volume_frame *frame) {
  sums s = {0};
  pbf_volume_flow flow = {.volume = pbf_volume_size(frame)};
  if (place->index->count > 0) add_all(place, frame, &s);
  for (uint32_t k = 0; k < frame->dimension; ++k) {
    flow.centre[k] = s.wet > 0 ? s.centre[k] / s.wet : frame->position[k];
    flow.velocity[k] = s.wet > 0 ? s.velocity[k] / s.wet : 0;
  }
  flow.fraction = s.wet > 0 ? s.wet / s.points : 0;
  return flow;
}

/* Numbers that are accepted each may have a product that is none. */
static pbf_status frame_in(pbf_check_kind kind, const pbf_volume *volumes, uint32_t first,
                           uint32_t index, pbf_volume_frame *frame) {
  pbf_volume volume;
  pbf_status status = pbf_volume_in(kind, "volumes", volumes, first, index, &volume);
  if (status != PBF_OK) return status;
  *frame = pbf_volume_frame_of(&volume, kind.dimension);
  if (isfinite(pbf_volume_size(frame))) return PBF_OK;
  return pbf_fail(PBF_ERROR_INVALID_ARGUMENT,
                  "volumes[%u] is so large that its volume is no number; smaller sizes would do",
                  index);
}

static pbf_status measure(pbf_solver *solver, uint32_t count, const pbf_volume *volumes,
                          pbf_volume_flow *flows) {
  pbf_query_place place = {0};
  pbf_volume_frame frame;
  pbf_status status = PBF_OK;
  if (count > 0 && !volumes) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "volumes is null");
  const uint32_t first = count > 0 ? pbf_struct_size(volumes) : 0;
  for (uint32_t i = 0; i < count && status == PBF_OK; ++i)
    status = frame_in(solver->kind, volumes, first, i, &frame);
  if (status != PBF_OK || count == 0) return status;
  if (!flows) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "flows is null");
  const uint32_t size = pbf_struct_size(flows);
  status = pbf_struct_check_size(&pbf_kind_volume_flow, size);
  if (status == PBF_OK) status = pbf_query_index_get(solver, PBF_QUERY_VELOCITIES, &place.index);
  for (uint32_t i = 0; i < count && status == PBF_OK; ++i) {
    status = frame_in(solver->kind, volumes, first, i, &frame);
    if (status != PBF_OK) return status;
    const pbf_volume_flow flow = flow_in(&place, &frame);
    pbf_struct_out(&pbf_kind_volume_flow, &flow, (char *)flows + (uint64_t)i * size, size);
  }
  return status;
}

pbf_status pbf_measure_volumes(pbf_solver *solver, uint32_t count, const pbf_volume *volumes,
                               pbf_volume_flow *flows) {
  pbf_status status = pbf_enter(solver);
  if (status != PBF_OK) return status;
  return pbf_leave(solver, measure(solver, count, volumes, flows));
}
