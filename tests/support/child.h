/* A part of a test that may be ended by a signal, in a process of its own. */
#ifndef PBF_TESTS_SUPPORT_CHILD_H
#define PBF_TESTS_SUPPORT_CHILD_H

#include <signal.h>
#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

/* The child exits with what `run` returns: as waitpid tells, so 0 is 0 and not ended otherwise. */
static inline int test_status_of_child(int (*run)(void *context), void *context) {
  int status = -1;
  fflush(NULL);
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGSEGV, SIG_DFL); /* which is an answer, and not to be caught */
    signal(SIGBUS, SIG_DFL);
    _exit(run(context));
  }
  return child > 0 && waitpid(child, &status, 0) == child ? status : -1;
}

#endif
