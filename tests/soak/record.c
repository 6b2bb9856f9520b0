#include "record.h"

#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

record *soak_record;

const char *const fault_names[FAULT_COUNT] = {"failed allocation",
                                              "callback left",
                                              "fork",
                                              "kill",
                                              "exit with solvers",
                                              "address limit",
                                              "thread limit",
                                              "busy thread",
                                              "signal",
                                              "rounding mode",
                                              "cancel",
                                              "intruding call",
                                              "task system",
                                              "snapshot held",
                                              "damaged state",
                                              "wrong argument",
                                              "call while begun"};

void found(uint32_t actor, const char *format, ...) {
  va_list arguments;
  if (atomic_exchange(&soak_record->found, 1) == 0) {
    soak_record->found_actor = actor;
    va_start(arguments, format);
    vsnprintf(soak_record->finding, sizeof soak_record->finding, format, arguments);
    va_end(arguments);
  } else {
    sleep(1); /* for the first one, in another thread or process, to write its words */
  }
  _exit(FOUND_STATUS);
}
