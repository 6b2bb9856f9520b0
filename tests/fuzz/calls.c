/* Sequences of calls on the C API, right ones and wrong ones in any order, on two backends at once.
 */
#include <dlpack/dlpack.h>
#include <math.h>

#include "draw.h"
#include "target.h"
#include "twins.h"

enum { MOST_CALLS = 48, MOST_AT_ONCE = 16 };

/* What one call is made with; both twins get the same. */
typedef struct arguments {
  kind k;
  uint32_t first, count;
  _Alignas(8) unsigned char x[MOST_AT_ONCE * 3 * 8], v[MOST_AT_ONCE * 3 * 8];
  int with_velocities;
  uint32_t ids[MOST_AT_ONCE];
  pbf_params params;
  pbf_collider colliders[3];
  double duration, lower[3], upper[3];
  pbf_read_desc read;
  pbf_anisotropy_desc wanted;
  uint32_t field, room;
} arguments;

static void draw_numbers(input *in, const arguments *a, double low, double high, void *out,
                         int *wild) {
  uint32_t numbers = MOST_AT_ONCE * a->k.dimension;
  int bad = take_u8(in) > 0xe8;
  for (uint32_t i = 0; i < a->count * a->k.dimension && i < numbers; ++i)
    put_number(out, i, a->k.precision, take_from(in, low, high));
  if (!bad || a->count == 0) return;
  *wild = 1;
  put_number(out, take_u8(in) % (a->count * a->k.dimension), a->k.precision, draw_wild(in));
}

/* ---- The calls ---- */

static pbf_status add(pbf_solver *s, void *context) {
  arguments *a = context;
  uint32_t first = 0;
  return pbf_add_particles(s, a->count, a->x, a->with_velocities ? a->v : NULL, &first);
}

static pbf_status drop(pbf_solver *s, void *context) {
  arguments *a = context;
  return pbf_remove_particles(s, a->count, a->ids);
}

static pbf_status set_params(pbf_solver *s, void *context) {
  return pbf_set_params(s, &((arguments *)context)->params);
}

static pbf_status set_colliders(pbf_solver *s, void *context) {
  arguments *a = context;
  return pbf_set_colliders(s, a->count, a->colliders);
}

static pbf_status move_colliders(pbf_solver *s, void *context) {
  arguments *a = context;
  return pbf_move_colliders(s, a->count, a->colliders, a->duration);
}

static pbf_status set_positions(pbf_solver *s, void *context) {
  arguments *a = context;
  return pbf_set_positions(s, a->first, a->count, a->x);
}

static pbf_status set_velocities(pbf_solver *s, void *context) {
  arguments *a = context;
  if (!a->with_velocities) return pbf_set_velocities(s, a->first, a->count, a->v);
  return pbf_write(s, &(pbf_write_desc){.struct_size = sizeof(pbf_write_desc),
                                        .field = PBF_FIELD_VELOCITY,
                                        .first = a->first,
                                        .count = a->count,
                                        .data = a->v});
}

static pbf_status get_rows(pbf_solver *s, void *context) {
  arguments *a = context;
  _Alignas(8) unsigned char out[TWIN_CAPACITY * 3 * 8];
  if (a->field == 0) return pbf_get_positions(s, a->first, a->count, out);
  if (a->field == 1) return pbf_get_velocities(s, a->first, a->count, out);
  if (a->field == 2) return pbf_get_densities(s, a->first, a->count, out);
  if (a->field == 4) return pbf_get_pressures(s, a->first, a->count, out);
  return pbf_get_ids(s, a->first, a->count, (uint32_t *)(void *)out);
}

static pbf_status map(pbf_solver *s, void *context) {
  pbf_view view = {.struct_size = sizeof view};
  return pbf_map(s, ((arguments *)context)->field, &view);
}

static pbf_status unmap(pbf_solver *s, void *context) {
  return pbf_unmap(s, ((arguments *)context)->field);
}

static pbf_status export_and_delete(pbf_solver *s, void *context) {
  DLManagedTensor *tensor = NULL;
  pbf_status status = pbf_export_dlpack(s, ((arguments *)context)->field, &tensor);
  if (status == PBF_OK) {
    insist(pbf_step(s, 1) == PBF_ERROR_STATE);
    tensor->deleter(tensor);
  }
  return status;
}

static pbf_status load_garbage(pbf_solver *s, void *context) {
  arguments *a = context;
  return pbf_load(s, a->x, a->count * 8);
}

static pbf_status save_and_load(pbf_solver *s, void *context) {
  _Alignas(8) static unsigned char buffer[1 << 16];
  uint64_t size = sizeof buffer;
  (void)context;
  insist(pbf_save(s, buffer, &size) == PBF_OK);
  return pbf_load(s, buffer, size);
}

static pbf_status remove_in_box(pbf_solver *s, void *context) {
  arguments *a = context;
  uint32_t count = 0;
  return pbf_remove_in_box(s, a->lower, a->upper, &count);
}

/* What is given are ids that there are, ascending; nothing is written beyond. */
static pbf_status find_in_box(pbf_solver *s, void *context) {
  arguments *a = context;
  uint32_t ids[MOST_AT_ONCE + 1] = {0}, count = 0, all = 0;
  ids[a->room] = 0xa5a5a5a5u;
  pbf_status status = pbf_find_in_box(s, a->lower, a->upper, a->room, ids, &count);
  insist(ids[a->room] == 0xa5a5a5a5u && pbf_get_count(s, &all) == PBF_OK && count <= all);
  for (uint32_t i = 1; i < count && i < a->room; ++i) insist(ids[i - 1] < ids[i]);
  return status;
}

/* Numbers, and nothing beyond them. */
static pbf_status read_fields(pbf_solver *s, void *context) {
  arguments *a = context;
  _Alignas(8) unsigned char out[TWIN_CAPACITY * 8 * 8 + 64];
  pbf_read_desc read = a->read;
  memset(out, 0xa5, sizeof out);
  read.data = out;
  pbf_status status = pbf_read(s, &read);
  for (size_t i = status == PBF_OK ? sizeof out - 64 : 0; i < sizeof out; ++i)
    insist(out[i] == 0xa5);
  return status;
}

/* Of places as wild as they come: numbers, and nothing beyond them. */
static pbf_status get_anisotropies(pbf_solver *s, void *context) {
  arguments *a = context;
  _Alignas(8) unsigned char x[TWIN_CAPACITY * 3 * 8 + 64], shapes[TWIN_CAPACITY * 9 * 8 + 64];
  pbf_anisotropy_desc wanted = a->wanted;
  memset(x, 0xa5, sizeof x);
  memset(shapes, 0xa5, sizeof shapes);
  wanted.positions = x;
  wanted.stretches = shapes;
  const pbf_status status = pbf_get_anisotropies(s, &wanted);
  const uint32_t rows = status == PBF_OK ? wanted.count : 0, row = a->k.dimension * a->k.precision;
  for (size_t i = rows * row; i < sizeof x; ++i) insist(x[i] == 0xa5);
  for (size_t i = rows * row * a->k.dimension; i < sizeof shapes; ++i) insist(shapes[i] == 0xa5);
  return status;
}

static pbf_status keep_previous(pbf_solver *s, void *context) {
  return pbf_keep_previous(s, ((arguments *)context)->room);
}

static pbf_status set_snapshots(pbf_solver *s, void *context) {
  return pbf_set_snapshots(s, ((arguments *)context)->room);
}

/* The one of the last step, or of the request, held over a call. */
static pbf_status hold_snapshot(pbf_solver *s, void *context) {
  pbf_snapshot held = {.struct_size = sizeof held};
  pbf_status status = pbf_acquire_snapshot(s, &held);
  (void)context;
  if (status != PBF_OK) return status;
  insist(held.owner && held.count <= TWIN_CAPACITY);
  insist(pbf_set_snapshots(s, 0) == PBF_ERROR_STATE);
  for (uint32_t i = 1; i < held.count; ++i) insist(held.ids[i - 1] < held.ids[i]);
  insist(pbf_release_snapshot(&held) == PBF_OK && !held.owner);
  return PBF_OK;
}

static uint64_t step_of(pbf_solver *s) {
  pbf_info info = {.struct_size = sizeof info};
  insist(pbf_get_info(s, &info) == PBF_OK);
  return info.step;
}

/* A step in two calls, which another one in between may cancel: then it is made anew. */
static pbf_status begin_and_end(pbf_solver *s, void *context) {
  uint32_t count;
  const uint64_t before = step_of(s);
  pbf_status status = pbf_begin_step(s, 1);
  if (status != PBF_OK) return status;
  insist(pbf_get_count(s, &count) == PBF_ERROR_BUSY && pbf_step(s, 1) == PBF_ERROR_BUSY);
  if (((arguments *)context)->room) insist(pbf_cancel(s) == PBF_OK);
  status = pbf_end_step(s);
  if (status != PBF_ERROR_CANCELLED) return status;
  return step_of(s) == before ? pbf_step(s, 1) : PBF_OK;
}

/* ---- Drawing them ---- */

static void draw_ids(input *in, const twins *t, arguments *a) {
  uint32_t present[TWIN_CAPACITY], count = twins_count(t);
  insist(pbf_get_ids(t->solver[0], 0, count, present) == PBF_OK);
  a->count = take_u8(in) % (MOST_AT_ONCE + 1);
  uint8_t start = take_u8(in), stride = take_u8(in) | 1;
  for (uint32_t i = 0; i < a->count; ++i)
    a->ids[i] = count ? present[(start + i * stride) % count] : i;
  if (start > 0xf0 && a->count) a->ids[start % a->count] = take_u32(in);
}

static void draw_rows(input *in, const twins *t, arguments *a) {
  uint8_t how = take_u8(in);
  uint32_t count = twins_count(t);
  a->first = count ? how % count : 0;
  a->count = count ? (how / 8) % (count - a->first + 1) : 0;
  if (how > 0xf0) a->first = take_u32(in);
  if (how > 0xf8) a->count = take_u32(in);
}

static void draw_some_colliders(input *in, arguments *a, int *wild) {
  a->count = take_u8(in) % 4;
  for (uint32_t i = 0; i < a->count; ++i) *wild |= draw_collider(in, &a->colliders[i]);
}

static void draw_box(input *in, arguments *a) {
  for (int k = 0; k < 3; ++k) {
    const uint8_t how = take_u8(in);
    a->lower[k] = how & 1 ? -INFINITY : take_from(in, 0, 1);
    a->upper[k] = how & 2 ? INFINITY : a->lower[k] + take_from(in, -0.05, 0.6);
    if (how > 0xf8) a->lower[k] = draw_wild(in);
  }
  a->room = take_u8(in) % (MOST_AT_ONCE + 1);
}

static void draw_read(input *in, const twins *t, arguments *a) {
  static const uint32_t types[] = {0, PBF_TYPE_FLOAT32, PBF_TYPE_FLOAT64, PBF_TYPE_UINT32};
  draw_rows(in, t, a);
  a->read = (pbf_read_desc){.struct_size = sizeof a->read,
                            .field = take_u8(in) % 7,
                            .first = a->first,
                            .count = a->count,
                            .element_type = types[take_u8(in) % 4],
                            .components = take_u8(in) % 6,
                            .w = take_u8(in) % 5,
                            .order = take_u8(in) % 4 == 0,
                            .stride = 4 * (take_u8(in) % 17)};
  if (take_u8(in) % 2) a->read.behind = take_from(in, -0.1, 1.1);
  if (take_u8(in) > 0xf0) a->read.w_value = draw_wild(in);
}

static void draw_wanted(input *in, const twins *t, arguments *a) {
  draw_rows(in, t, a);
  a->wanted = (pbf_anisotropy_desc){.struct_size = sizeof a->wanted,
                                    .first = a->first,
                                    .count = a->count,
                                    .min_neighbors = take_u8(in) % 40,
                                    .smoothing = take_from(in, -0.1, 1.1)};
  if (take_u8(in) % 2) a->wanted.radius = take_from(in, 0, 0.5);
  if (take_u8(in) % 2) a->wanted.max_ratio = take_from(in, 0.9, 20);
  if (take_u8(in) > 0xf0) a->wanted.lone_scale = draw_wild(in);
}

/* Which instruction sets there are is the machine's to say: a solver, or a sentence. */
static void make_another(input *in, kind k) {
  static const char *const sets[] = {NULL, "scalar", "sse2", "avx2", "avx512", "", "AVX2", "x"};
  pbf_desc desc;
  pbf_solver *solver = NULL;
  insist(pbf_desc_init(&desc, sizeof desc) == PBF_OK);
  desc.dimension = k.dimension;
  desc.precision = k.precision;
  desc.capacity = 4;
  desc.backend = take_u8(in) & 1 ? "serial" : "reference";
  desc.strict = 1;
  desc.isa = sets[take_u8(in) % 8];
  desc.threads = take_u8(in) % 4;
  desc.device = take_u8(in) > 0xe0;
  if (take_u8(in) > 0xe0) desc.enqueue_task = twins_enqueue;
  desc.determinism = take_u8(in) % 4; /* two of them are none */
  pbf_status status = pbf_create(&desc, NULL, &solver);
  insist((status == PBF_OK) == (solver != NULL) && (status == PBF_OK || pbf_last_error()[0]));
  pbf_destroy(solver);
}

static void change_params(input *in, twins *t, arguments *a) {
  int wild = 0;
  a->params.struct_size = sizeof a->params;
  insist(pbf_get_params(t->solver[0], &a->params) == PBF_OK);
  if (take_u8(in) % 8 == 0) { /* back to where distances can be stated, but for the particles */
    const double kept = a->params.prestabilization;
    insist(pbf_params_init(&a->params, sizeof a->params) == PBF_OK);
    a->params.prestabilization = kept;
  } else {
    wild = draw_params(in, &a->params);
  }
  if (twins_call(t, set_params, a) == PBF_OK) t->wild |= wild;
  t->placed = 1; /* walls may have jumped, steps become shorter */
}

/* As most runs do: places at random take hundreds of iterations to part. */
static void forgo_prestabilization(twins *t) {
  arguments a = {.k = t->k, .params = {.struct_size = sizeof a.params}};
  insist(pbf_get_params(t->solver[0], &a.params) == PBF_OK);
  a.params.prestabilization = 0;
  insist(twins_call(t, set_params, &a) == PBF_OK);
}

static void call_with_particles(input *in, twins *t, arguments *a, unsigned which) {
  int wild = 0;
  twin_call calls[] = {add, set_positions, set_velocities};
  draw_rows(in, t, a);
  if (which == 0) a->count = take_u8(in) % (MOST_AT_ONCE + 1);
  if (a->count > MOST_AT_ONCE && a->count <= TWIN_CAPACITY) a->count = MOST_AT_ONCE;
  if (a->count <= MOST_AT_ONCE) {
    a->with_velocities = take_u8(in) & 1;
    draw_numbers(in, a, 0.21, 0.79, a->x, &wild);
    draw_numbers(in, a, -4, 4, a->v, &wild);
  }
  if (twins_call(t, calls[which], a) != PBF_OK) return;
  t->wild |= wild;
  t->placed = 1;
}

static void step_some(input *in, twins *t) {
  uint8_t how = take_u8(in);
  for (int steps = 1 + how % 3; steps > 0; --steps) {
    if (twins_step(t, how & 0x80) != PBF_OK) return;
  }
}

static void call(input *in, twins *t) {
  arguments a = {.k = t->k};
  int wild = 0;
  switch (take_u8(in) % 27) {
    case 0:
    case 1:
      call_with_particles(in, t, &a, 0);
      break;
    case 2:
      call_with_particles(in, t, &a, 1);
      break;
    case 3:
      call_with_particles(in, t, &a, 2);
      break;
    case 4:
      draw_ids(in, t, &a);
      twins_call(t, drop, &a);
      break;
    case 5:
    case 6:
      change_params(in, t, &a);
      break;
    case 7:
      draw_some_colliders(in, &a, &wild);
      if (twins_call(t, set_colliders, &a) == PBF_OK) t->wild |= wild;
      t->placed = 1;
      a.duration = take_u8(in) > 0xf0 ? draw_wild(in) : take_from(in, 0.001, 0.1);
      if (a.count % 2) twins_call(t, move_colliders, &a);
      break;
    case 8:
      draw_rows(in, t, &a);
      a.field = take_u8(in) % 5;
      twins_call(t, get_rows, &a);
      break;
    case 9:
      a.field = take_u8(in) % 6;
      if (twins_call(t, map, &a) == PBF_OK && take_u8(in) % 4) twins_call(t, unmap, &a);
      break;
    case 10:
      a.field = take_u8(in) % 6;
      twins_call(t, take_u8(in) & 1 ? unmap : export_and_delete, &a);
      break;
    case 11:
      twins_call(t, take_u8(in) % 4 ? save_and_load : load_garbage, &a);
      break;
    case 12:
      twins_compare_reports(t);
      break;
    case 13:
      draw_box(in, &a);
      twins_call_apart(t, take_u8(in) & 1 ? remove_in_box : find_in_box, &a);
      break;
    case 14:
    case 15:
      draw_read(in, t, &a);
      twins_call(t, read_fields, &a);
      break;
    case 16:
      a.room = take_u8(in) % 3;
      twins_call(t, keep_previous, &a);
      break;
    case 17:
      a.room = take_u8(in) % 6;
      twins_call(t, take_u8(in) & 1 ? set_snapshots : hold_snapshot, &a);
      break;
    case 18:
    case 19:
      a.room = take_u8(in) & 1;
      twins_call(t, begin_and_end, &a);
      t->overlapped |= t->placed;
      twins_note_lost(t);
      break;
    case 26:
      draw_wanted(in, t, &a);
      twins_call(t, get_anisotropies, &a);
      break;
    case 20:
      make_another(in, t->k);
      break;
    default:
      step_some(in, t);
      break;
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  input in = {data, size, 0};
  uint32_t count;
  const uint8_t kinds = take_u8(&in);
  const uint32_t determinism =
      kinds >> 3 & 1 ? PBF_DETERMINISM_PER_MACHINE : PBF_DETERMINISM_ACROSS_MACHINES;
  twins t = twins_make(kind_of(kinds), kinds >> 2 & 1, determinism);
  if (take_u8(&in) % 8) forgo_prestabilization(&t);
  for (int calls = 0; calls < MOST_CALLS && !t.lost && !input_ended(&in); ++calls) call(&in, &t);
  twins_destroy(&t);
  for (int i = 0; i < TWINS; ++i)
    insist(pbf_get_count(t.solver[i], &count) == PBF_ERROR_INVALID_ARGUMENT);
  return 0;
}
