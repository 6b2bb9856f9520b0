/* How well a backend would serve a new solver. */
#ifndef PBF_LIB_PLUGIN_PROBE_H
#define PBF_LIB_PLUGIN_PROBE_H

#include "desc.h"
#include "plugin.h"

/* What the plugin's probe answers, with every field in range; score 0 with a reason for a candidate
 * that did not load. */
pbf_probe_result pbf_probe(const pbf_plugin *plugin, const pbf_checked_desc *checked);

#endif
