/* What runs when the library or a plugin is loaded, and when it is unloaded or the program ends. In
 * a program that has them linked in, its own global objects may make solvers before main begins:
 * the library's constructors come before those of all that ask for no priority, and its destructors
 * after them. */
#ifndef PBF_COMMON_AT_LOAD_H
#define PBF_COMMON_AT_LOAD_H

#if defined(__ELF__) /* its linkers sort them by priority */
#define PBF_CONSTRUCTOR \
  __attribute__((constructor(101))) /* the first that is not the C library's */
#define PBF_DESTRUCTOR __attribute__((destructor(101)))
#else
#define PBF_CONSTRUCTOR __attribute__((constructor))
#define PBF_DESTRUCTOR __attribute__((destructor))
#endif

#endif
