/* Part of os_posix.c, apart for its test. */
#ifndef PBF_LIB_OS_PRIVILEGE_H
#define PBF_LIB_OS_PRIVILEGE_H

#include <sys/types.h>

/* What decides whether a process may trust its environment, as the kernel reports it. */
typedef struct pbf_identity {
  unsigned long at_secure; /* getauxval(AT_SECURE), 0 where there is no such word */
  uid_t user, effective_user;
  gid_t group, effective_group;
} pbf_identity;

/* 1 when the process has rights that its caller lacks. */
int pbf_is_elevated(const pbf_identity *identity);

pbf_identity pbf_identity_of_process(void);

#endif
