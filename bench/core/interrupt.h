/* Ctrl-C, or the end of the terminal, asks a command to stop at the next step and to write what it
 * has; a second one kills. */
#ifndef PBF_BENCH_INTERRUPT_H
#define PBF_BENCH_INTERRUPT_H

namespace bench {

void catch_interrupts();
bool interrupted();

}  // namespace bench

#endif
