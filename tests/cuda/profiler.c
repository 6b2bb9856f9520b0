/* What a profiler has NVTX load: counts the ranges of the domain "pbf" by their names. */
#include "profiler.h"

#include <string.h>

/* Its types of what it calls in the library that it loads, too. */
#include <nvtx3/nvToolsExt.h>

static profile seen;
static nvtxDomainHandle_t the_domain;

static nvtxDomainHandle_t create(const char *name) {
  static int domain;
  if (strcmp(name, "pbf") == 0) the_domain = (nvtxDomainHandle_t)&domain;
  return the_domain;
}

static int push(nvtxDomainHandle_t domain, const nvtxEventAttributes_t *attributes) {
  if (!domain || domain != the_domain) return -1;
  if (attributes->messageType == NVTX_MESSAGE_TYPE_ASCII && seen.names < PROFILE_NAMES) {
    uint32_t k = 0;
    while (k < seen.names && strcmp(seen.name[k], attributes->message.ascii) != 0) ++k;
    if (k == seen.names) strncpy(seen.name[seen.names++], attributes->message.ascii, 31);
    ++seen.count[k];
  }
  if (++seen.depth > seen.deepest) seen.deepest = seen.depth;
  return seen.depth - 1;
}

static int pop(nvtxDomainHandle_t domain) {
  return domain && domain == the_domain ? --seen.depth : -1;
}

__attribute__((visibility("default"))) int InitializeInjectionNvtx2(
    NvtxGetExportTableFunc_t tables);
__attribute__((visibility("default"))) const profile *profile_seen(void);

int InitializeInjectionNvtx2(NvtxGetExportTableFunc_t tables) {
  const NvtxExportTableCallbacks *callbacks = tables(NVTX_ETID_CALLBACKS);
  NvtxFunctionTable functions = NULL;
  unsigned size = 0;
  if (!callbacks || !callbacks->GetModuleFunctionTable(NVTX_CB_MODULE_CORE2, &functions, &size) ||
      size <= NVTX_CBID_CORE2_DomainCreateA)
    return 0;
  *functions[NVTX_CBID_CORE2_DomainCreateA] = (NvtxFunctionPointer)create;
  *functions[NVTX_CBID_CORE2_DomainRangePushEx] = (NvtxFunctionPointer)push;
  *functions[NVTX_CBID_CORE2_DomainRangePop] = (NvtxFunctionPointer)pop;
  return 1;
}

const profile *profile_seen(void) { return &seen; }
