#include "os_privilege.h"

#include <unistd.h>

#if defined(__linux__)
#include <sys/auxv.h>
#endif

int pbf_is_elevated(const pbf_identity *identity) {
  return identity->at_secure != 0 || identity->user != identity->effective_user ||
         identity->group != identity->effective_group;
}

static unsigned long word_of_kernel(void) {
#if defined(__linux__)
  return getauxval(AT_SECURE);
#else
  return 0;
#endif
}

pbf_identity pbf_identity_of_process(void) {
  return (pbf_identity){
      .at_secure = word_of_kernel(),
      .user = getuid(),
      .effective_user = geteuid(),
      .group = getgid(),
      .effective_group = getegid(),
  };
}
