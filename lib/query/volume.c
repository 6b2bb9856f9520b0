#include "volume.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "error.h"
#include "structs.h"

#define REAL(member, components, range) \
  { #member, offsetof(pbf_volume, member), components, range, 0 }

static const double pi = 3.14159265358979323846;

static const pbf_count_rule shape_rule = {
    "shape", offsetof(pbf_volume, shape), 0, PBF_VOLUME_CAPSULE, " (PBF_VOLUME_…)", 0};
static const pbf_real_rule position_rule = REAL(position, 3, PBF_ANY);
static const pbf_real_rule box_rule = REAL(half_extents, 3, PBF_ABOVE_ZERO);
static const pbf_real_rule radius_rule = REAL(radius, 1, PBF_ABOVE_ZERO);
static const pbf_real_rule length_rule = REAL(half_length, 1, PBF_AT_LEAST_ZERO);

static double norm(const double *v, uint32_t components) {
  double sum = 0;
  for (uint32_t i = 0; i < components; ++i) sum += v[i] * v[i];
  return sqrt(sum);
}

/* ---- Checks ---------------------------------------------------------------------------------- */

static pbf_status check_capsule(const pbf_volume *volume, const char *label, pbf_check_kind kind) {
  pbf_status status = pbf_check_axis(volume->axis, label, kind.dimension);
  return status == PBF_OK ? pbf_check_real(&length_rule, label, volume, kind) : status;
}

/* Of the precision that queries have. */
pbf_status pbf_volume_check(const pbf_volume *volume, const char *label, uint32_t dimension) {
  const pbf_check_kind kind = {dimension, PBF_FLOAT64};
  pbf_status status = pbf_check_count(&shape_rule, label, volume);
  if (status == PBF_OK) status = pbf_check_real(&position_rule, label, volume, kind);
  if (status == PBF_OK) status = pbf_check_orientation(volume->orientation, label, dimension);
  if (status == PBF_OK)
    status = pbf_check_real(volume->shape == PBF_VOLUME_BOX ? &box_rule : &radius_rule, label,
                            volume, kind);
  if (status == PBF_OK && volume->shape == PBF_VOLUME_CAPSULE)
    status = check_capsule(volume, label, kind);
  return status;
}

pbf_status pbf_volume_in(pbf_check_kind kind, const char *name, const pbf_volume *theirs,
                         uint32_t first, uint32_t index, pbf_volume *ours) {
  char label[64];
  pbf_status status = pbf_struct_in_array(&pbf_kind_volume, name, theirs, first, index, ours);
  snprintf(label, sizeof label, "%s[%u]", name, index);
  return status == PBF_OK ? pbf_volume_check(ours, label, kind.dimension) : status;
}

pbf_status pbf_volumes_in(pbf_check_kind kind, const char *name, uint32_t count,
                          const pbf_volume *theirs, pbf_volume *ours) {
  if (count > 0 && !theirs) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "%s is null", name);
  const uint32_t first = count > 0 ? pbf_struct_size(theirs) : 0;
  pbf_status status = PBF_OK;
  for (uint32_t i = 0; i < count && status == PBF_OK; ++i)
    status = pbf_volume_in(kind, name, theirs, first, i, &ours[i]);
  return status;
}

/* ---- Shapes ---------------------------------------------------------------------------------- */

/* Rows are what the frame's axes are in the world. */
static void axes_of(const double q[4], double axes[3][3]) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  const double rows[3][3] = {
      {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
      {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
      {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)},
  };
  memcpy(axes, rows, sizeof rows);
}

/* Turns the frame such that its first axis is that of the capsule. */
static void align(pbf_volume_frame *frame, const pbf_volume *volume) {
  const double length = norm(volume->axis, frame->dimension);
  double d[3] = {0, 0, 0}, (*axes)[3] = frame->axes;
  uint32_t least = 0;
  for (uint32_t k = 0; k < frame->dimension; ++k)
    for (uint32_t l = 0; l < frame->dimension; ++l) d[k] += volume->axis[l] / length * axes[l][k];
  for (uint32_t k = 1; k < 3; ++k) least = fabs(d[k]) < fabs(d[least]) ? k : least;
  if (frame->dimension == 2) least = 2;
  const double across = sqrt(1 - fmin(d[least] * d[least], 1));
  for (uint32_t k = 0; k < 3; ++k) { /* the third: along `least`, less what of it goes along d */
    axes[0][k] = d[k];
    axes[2][k] = ((k == least) - d[least] * d[k]) / across;
  }
  for (uint32_t k = 0; k < 3; ++k)
    axes[1][k] = axes[2][(k + 1) % 3] * d[(k + 2) % 3] - axes[2][(k + 2) % 3] * d[(k + 1) % 3];
}

pbf_volume_frame pbf_volume_frame_of(const pbf_volume *volume, uint32_t dimension) {
  pbf_volume_frame frame = {.shape = volume->shape, .dimension = dimension};
  axes_of(volume->orientation, frame.axes);
  for (uint32_t k = 0; k < dimension; ++k) {
    frame.position[k] = volume->position[k];
    frame.half[k] = volume->shape == PBF_VOLUME_BOX ? volume->half_extents[k] : volume->radius;
  }
  if (volume->shape != PBF_VOLUME_BOX) frame.radius = volume->radius;
  if (volume->shape != PBF_VOLUME_CAPSULE) return frame;
  frame.half_length = volume->half_length;
  frame.half[0] += volume->half_length;
  align(&frame, volume);
  return frame;
}

int pbf_volume_has_local(const pbf_volume_frame *frame, const double *local) {
  if (frame->shape == PBF_VOLUME_BOX) {
    for (uint32_t k = 0; k < frame->dimension; ++k)
      if (!(fabs(local[k]) <= frame->half[k])) return 0;
    return 1;
  }
  const double beyond = fmax(fabs(local[0]) - frame->half_length, 0);
  double square = beyond * beyond;
  for (uint32_t k = 1; k < frame->dimension; ++k) square += local[k] * local[k];
  return square <= frame->radius * frame->radius;
}

int pbf_volume_has(const pbf_volume_frame *frame, const double *point) {
  double local[3] = {0, 0, 0};
  for (uint32_t k = 0; k < frame->dimension; ++k)
    for (uint32_t l = 0; l < frame->dimension; ++l)
      local[k] += frame->axes[k][l] * (point[l] - frame->position[l]);
  return pbf_volume_has_local(frame, local);
}

pbf_backend_box pbf_volume_box(const pbf_volume_frame *frame, double margin) {
  pbf_backend_box box = {{0}, {0}};
  for (uint32_t k = 0; k < frame->dimension; ++k) {
    double reach = margin;
    for (uint32_t axis = 0; axis < frame->dimension; ++axis)
      reach += fabs(frame->axes[axis][k]) * frame->half[axis];
    reach += 1e-9 * (reach + fabs(frame->position[k]));
    box.lower[k] = frame->position[k] - reach;
    box.upper[k] = frame->position[k] + reach;
  }
  return box;
}

double pbf_volume_size(const pbf_volume_frame *frame) {
  const double r = frame->radius, l = 2 * frame->half_length;
  const int is_3d = frame->dimension == 3;
  if (frame->shape == PBF_VOLUME_BOX)
    return 4 * frame->half[0] * frame->half[1] * (is_3d ? 2 * frame->half[2] : 1);
  const double ball = is_3d ? 4 * pi * r * r * r / 3 : pi * r * r;
  return ball + l * (is_3d ? pi * r * r : 2 * r);
}

static pbf_volume initial_of(uint32_t shape) {
  return (pbf_volume){.struct_size = sizeof(pbf_volume),
                      .shape = shape,
                      .orientation = {0, 0, 0, 1},
                      .half_extents = {1, 1, 1},
                      .axis = {0, 1, 0},
                      .radius = 1,
                      .half_length = 1};
}

void pbf_volume_clean(pbf_volume *volume, uint32_t dimension) {
  const pbf_volume initial = initial_of(volume->shape);
  const int is_box = volume->shape == PBF_VOLUME_BOX;
  const int is_capsule = volume->shape == PBF_VOLUME_CAPSULE;
  for (uint32_t k = dimension; k < 3; ++k) {
    volume->position[k] = initial.position[k];
    volume->axis[k] = initial.axis[k];
  }
  for (uint32_t k = is_box ? dimension : 0; k < 3; ++k)
    volume->half_extents[k] = initial.half_extents[k];
  if (is_box) volume->radius = initial.radius;
  if (!is_capsule) memcpy(volume->axis, initial.axis, sizeof initial.axis);
  if (!is_capsule) volume->half_length = initial.half_length;
}

pbf_status pbf_volume_init(pbf_volume *volume, uint32_t struct_size, uint32_t shape) {
  pbf_status status = pbf_struct_check_size(&pbf_kind_volume, struct_size);
  if (status != PBF_OK) return status;
  const pbf_volume initial = initial_of(shape);
  if (!volume) return pbf_fail(PBF_ERROR_INVALID_ARGUMENT, "volume is null");
  status = pbf_check_count(&shape_rule, "volume", &initial);
  if (status != PBF_OK) return status;
  pbf_struct_out(&pbf_kind_volume, &initial, volume, struct_size);
  return PBF_OK;
}
