/* Which backends to try for a new solver, and in which order. */
#ifndef PBF_LIB_PLUGIN_SELECT_H
#define PBF_LIB_PLUGIN_SELECT_H

#include "desc.h"
#include "plugin.h"

enum { PBF_MAX_CANDIDATES = 64 };

typedef struct pbf_candidates {
  uint32_t count;
  const pbf_plugin *plugins[PBF_MAX_CANDIDATES]; /* best first */
  int32_t scores[PBF_MAX_CANDIDATES];
  uint32_t named;   /* 1: the caller asked for one by name */
  char reason[512]; /* why the named one is not among them, or why nothing is */
} pbf_candidates;

/* PBF_ERROR_NOT_FOUND for a name of no backend, PBF_ERROR_UNAVAILABLE when no candidate is left. */
pbf_status pbf_select(const pbf_checked_desc *checked, pbf_candidates *candidates);

/* As a candidate gets it: a device and a stream are those of the backend that was asked for. */
pbf_checked_desc pbf_desc_for(const pbf_checked_desc *checked, const pbf_plugin *plugin);

/* For a candidate that failed later. */
void pbf_candidates_add_reason(pbf_candidates *candidates, const char *name, const char *reason);

#endif
