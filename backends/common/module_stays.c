/* Of code that is never unloaded, or in no module. */
#include "common/module.h"

void *pbf_module_hold(void) { return 0; }

void pbf_module_release(void *held) { (void)held; }
