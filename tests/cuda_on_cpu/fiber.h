/* Stacks that a thread of the system switches between. */
#ifndef EMULATED_FIBER_H
#define EMULATED_FIBER_H

namespace emulated {

struct fiber;

/* One that will call run(argument) when it is first switched to; run never returns. */
fiber *new_fiber(void (*run)(void *), void *argument);
void free_fiber(fiber *f);
fiber *present_fiber();

/* Goes on there. Null: where this thread of the system is of itself. */
void switch_to(fiber *f);

}  // namespace emulated

#endif
