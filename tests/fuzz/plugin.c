/* A plugin that lies, about itself and in every call: the host refuses what it can know to be a
 * lie, gives known statuses and ended texts only, and keeps its own books. Linked with the
 * library's own objects, so that the negotiation can be had more than once a process. */
#include <dlfcn.h>
#include <string.h>

#include "insist.h"
#include "liar.h"
#include "plugin/plugin_file.h"
#include "plugin/probe.h"
#include "status.h"
#include "target.h"

enum { MOST_PARTICLES = 64 };

static liar_control *control;

/* Loads the plugin honestly, once: it is then a backend as any other. */
static void set_up(void) {
  if (control) return;
  insist(pbf_load_backend(PBF_LIAR_FILE) == PBF_OK);
  void *library = dlopen(PBF_LIAR_FILE, RTLD_NOW | RTLD_NOLOAD);
  insist(library != NULL);
  *(void **)&control = dlsym(library, "liar");
  insist(control != NULL);
}

static void insist_on_text(const char *text, size_t size) { insist(memchr(text, 0, size) != NULL); }

static void negotiate(void) {
  pbf_plugin plugin;
  pbf_checked_desc desc;
  control->lies_in_answer = 1;
  pbf_status status = pbf_plugin_load(PBF_LIAR_FILE, NULL, &plugin);
  control->lies_in_answer = 0;
  insist(pbf_status_is_known(status));
  insist((status == PBF_OK) == (plugin.reason[0] == 0));
  insist_on_text(plugin.name, sizeof plugin.name);
  insist_on_text(plugin.build_id, sizeof plugin.build_id);
  insist_on_text(plugin.reason, sizeof plugin.reason);
  if (status != PBF_OK) return;
  insist(plugin.name[0] && strcmp(plugin.name, "auto") != 0);
  insist(pbf_desc_check(NULL, &desc) == PBF_OK);
  pbf_probe_result probe = pbf_probe(&plugin, &desc);
  insist(probe.score >= 0 && (probe.score > 0) == (probe.reason[0] == 0));
  insist_on_text(probe.device_name, sizeof probe.device_name);
  insist_on_text(probe.reason, sizeof probe.reason);
}

static pbf_solver *create(input *in) {
  pbf_desc desc;
  pbf_solver *solver = NULL;
  insist(pbf_desc_init(&desc, sizeof desc) == PBF_OK);
  desc.backend = "liar";
  desc.strict = 1;
  desc.capacity = MOST_PARTICLES;
  desc.dimension = take_u8(in) & 1 ? 2 : 3;
  pbf_status status = pbf_create(&desc, NULL, &solver);
  insist((status == PBF_OK) == (solver != NULL));
  insist(pbf_status_is_known(status));
  return solver;
}

static pbf_status report(pbf_solver *s, unsigned which) {
  pbf_stats stats = {.struct_size = sizeof stats};
  pbf_plan plan = {.struct_size = sizeof plan};
  pbf_info info = {.struct_size = sizeof info};
  pbf_timings timings = {.struct_size = sizeof timings};
  pbf_status status = PBF_OK;
  if (which == 0) status = pbf_get_stats(s, &stats);
  if (which == 1) status = pbf_get_plan(s, &plan);
  if (which == 2) status = pbf_get_info(s, &info);
  if (which == 3) status = pbf_get_timings(s, &timings);
  insist(plan.stage_count <= PBF_MAX_STAGES && plan.array_count <= PBF_MAX_ARRAYS);
  insist(timings.stage_count <= PBF_MAX_STAGES);
  insist(stats.struct_size == sizeof stats && plan.struct_size == sizeof plan);
  insist_on_text(plan.variant, sizeof plan.variant);
  insist_on_text(plan.stages[0].name, PBF_NAME_SIZE);
  insist_on_text(plan.arrays[0].name, PBF_NAME_SIZE);
  insist_on_text(info.device_name, sizeof info.device_name);
  insist_on_text(timings.stages[0].name, PBF_NAME_SIZE);
  return status;
}

static pbf_status map(pbf_solver *s, uint32_t field) {
  pbf_view view = {.struct_size = sizeof view};
  uint32_t count = 0;
  pbf_status status = pbf_map(s, field, &view);
  if (status != PBF_OK) return status;
  insist(pbf_get_count(s, &count) == PBF_OK);
  insist(view.struct_size == sizeof view && view.field == field && view.count == count);
  insist(count == 0 || (view.data && view.ids));
  insist(pbf_unmap(s, field) == PBF_OK);
  return status;
}

static pbf_status save_and_load(pbf_solver *s) {
  _Alignas(8) static unsigned char buffer[1 << 16];
  uint64_t size = sizeof buffer;
  pbf_status status = pbf_save(s, buffer, &size);
  return status == PBF_OK ? pbf_load(s, buffer, size) : status;
}

static pbf_status call(pbf_solver *s, input *in) {
  static const float positions[3 * 4];
  float out[MOST_PARTICLES * 3];
  uint32_t ids[MOST_PARTICLES], count = 0;
  uint64_t hash;
  pbf_collider ball;
  pbf_params params = {.struct_size = sizeof params};
  insist(pbf_get_count(s, &count) == PBF_OK);
  switch (take_u8(in) % 14) {
    case 0:
    case 1:
      return pbf_add_particles(s, take_u8(in) % 5, positions, NULL, NULL);
    case 2:
      insist(pbf_get_ids(s, 0, count, ids) == PBF_OK);
      return pbf_remove_particles(s, take_u8(in) % (count + 1), ids);
    case 3:
    case 4:
      return pbf_step(s, take_u8(in));
    case 5:
      return pbf_get_positions(s, 0, count, out);
    case 6:
      return pbf_set_velocities(s, 0, count < 4 ? count : 4, positions);
    case 7:
      insist(pbf_get_params(s, &params) == PBF_OK);
      return pbf_set_params(s, &params);
    case 8:
      insist(pbf_collider_init(&ball, sizeof ball, PBF_COLLIDER_SPHERE) == PBF_OK);
      return pbf_set_colliders(s, take_u8(in) & 1, &ball);
    case 9:
      return map(s, 1 + take_u8(in) % 3);
    case 10:
      return save_and_load(s);
    case 11:
      return pbf_hash(s, &hash);
    case 12:
      return pbf_set_timing(s, 1);
    default:
      return report(s, take_u8(in) % 4);
  }
}

static uint64_t steps_of(pbf_solver *s, uint32_t *count) {
  pbf_info info = {.struct_size = sizeof info};
  control->lies = NULL;
  insist(pbf_get_count(s, count) == PBF_OK);
  insist(pbf_get_info(s, &info) == PBF_OK);
  return info.step;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  input in = {data, size, 0};
  uint32_t before, after;
  set_up();
  control->lies = &in;
  negotiate();
  pbf_solver *solver = create(&in);
  for (int calls = 0; solver && calls < 64 && !input_ended(&in); ++calls) {
    uint64_t steps = steps_of(solver, &before);
    control->lies = &in;
    pbf_status status = call(solver, &in);
    insist(pbf_status_is_known(status));
    insist(status == PBF_OK || pbf_last_error()[0]);
    insist(steps_of(solver, &after) <= steps + 255);
    if (status != PBF_OK) insist(after == before);
  }
  control->lies = NULL;
  pbf_destroy(solver);
  return 0;
}
