#include "select.h"

#include <string.h>

#include "error.h"
#include "probe.h"
#include "registry.h"
#include "text.h"

static void add_text(char *text, size_t size, const char *name, const char *reason) {
  if (text[0]) pbf_text_append(text, size, "; ");
  pbf_text_append(text, size, name);
  if (reason[0]) pbf_text_append(text, size, ": ");
  pbf_text_append(text, size, reason);
}

void pbf_candidates_add_reason(pbf_candidates *candidates, const char *name, const char *reason) {
  add_text(candidates->reason, sizeof candidates->reason, name, reason);
}

/* `reference` is for comparison: it serves only where nothing else does. */
static int is_before(const pbf_plugin *a, int32_t score_a, const pbf_plugin *b, int32_t score_b) {
  int last_a = strcmp(a->name, "reference") == 0, last_b = strcmp(b->name, "reference") == 0;
  return last_a != last_b ? last_b : score_a > score_b;
}

static void insert_at(pbf_candidates *candidates, uint32_t position, const pbf_plugin *plugin,
                      int32_t score) {
  for (uint32_t i = candidates->count++; i > position; --i) {
    candidates->plugins[i] = candidates->plugins[i - 1];
    candidates->scores[i] = candidates->scores[i - 1];
  }
  candidates->plugins[position] = plugin;
  candidates->scores[position] = score;
}

/* Equal scores keep the order of finding. The named one comes first. */
static void insert(pbf_candidates *candidates, const pbf_plugin *plugin, int32_t score,
                   const char *name) {
  uint32_t position = 0;
  if (strcmp(plugin->name, name) != 0) {
    while (position < candidates->count &&
           (strcmp(candidates->plugins[position]->name, name) == 0 ||
            !is_before(plugin, score, candidates->plugins[position], candidates->scores[position])))
      ++position;
  }
  insert_at(candidates, position, plugin, score);
}

static pbf_status check_known(const char *name) {
  char known[PBF_MESSAGE_SIZE / 2] = "auto";
  const pbf_plugin *plugin;
  for (uint32_t i = 0; (plugin = pbf_registry_entry(i)); ++i) {
    if (strcmp(plugin->name, name) == 0) return PBF_OK;
    if (plugin->name[0] && !strstr(known, plugin->name))
      add_text(known, sizeof known, plugin->name, "");
  }
  return pbf_fail(PBF_ERROR_NOT_FOUND, "desc.backend is \"%s\"; known are: %s", name, known);
}

static int is_usable(const char *name) {
  const pbf_plugin *plugin;
  for (uint32_t i = 0; (plugin = pbf_registry_entry(i)); ++i) {
    if (strcmp(plugin->name, name) == 0 && !plugin->reason[0]) return 1;
  }
  return 0;
}

pbf_checked_desc pbf_desc_for(const pbf_checked_desc *checked, const pbf_plugin *plugin) {
  pbf_checked_desc its = *checked;
  if (strcmp(checked->backend, "auto") == 0 || strcmp(checked->backend, plugin->name) == 0)
    return its;
  its.desc.device = 0;
  its.desc.stream = NULL;
  return its;
}

static void consider(const pbf_plugin *plugin, const pbf_checked_desc *checked,
                     pbf_candidates *candidates, char *all, size_t size) {
  int is_named = strcmp(plugin->name, checked->backend) == 0;
  if (candidates->named && checked->desc.strict && !is_named) return;
  const pbf_checked_desc its = pbf_desc_for(checked, plugin);
  pbf_probe_result probe = pbf_probe(plugin, &its);
  if (probe.score > 0 && candidates->count < PBF_MAX_CANDIDATES) {
    insert(candidates, plugin, probe.score, checked->backend);
    return;
  }
  add_text(all, size, plugin->name[0] ? plugin->name : plugin->path, probe.reason);
  /* A file that failed says nothing once another one of the name has loaded. */
  if (is_named && !(plugin->reason[0] && is_usable(plugin->name)))
    pbf_candidates_add_reason(candidates, plugin->name, probe.reason);
}

pbf_status pbf_select(const pbf_checked_desc *checked, pbf_candidates *candidates) {
  char all[PBF_MESSAGE_SIZE - 128] = "";
  memset(candidates, 0, sizeof *candidates);
  candidates->named = strcmp(checked->backend, "auto") != 0;
  if (candidates->named) {
    pbf_status status = check_known(checked->backend);
    if (status != PBF_OK) return status;
  }
  const pbf_plugin *plugin;
  for (uint32_t i = 0; (plugin = pbf_registry_entry(i)); ++i)
    consider(plugin, checked, candidates, all, sizeof all);
  if (candidates->count) return PBF_OK;
  return pbf_fail(PBF_ERROR_UNAVAILABLE, "no backend can serve this solver: %s", all);
}
