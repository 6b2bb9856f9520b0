#include "privilege.h"

#include <sys/auxv.h>
#include <unistd.h>

int pbf_is_elevated(const pbf_identity *identity) {
  return identity->at_secure != 0 || identity->user != identity->effective_user ||
         identity->group != identity->effective_group;
}

pbf_identity pbf_identity_of_process(void) {
  return (pbf_identity){
      .at_secure = getauxval(AT_SECURE),
      .user = getuid(),
      .effective_user = geteuid(),
      .group = getgid(),
      .effective_group = getegid(),
  };
}
