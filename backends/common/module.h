/* The shared object that this code is in. Of libpbf and of plugins it stays loaded for the life of
 * the process; but the static library may be a part of a module that the program unloads, as a game
 * that is made anew while the engine runs. What runs the code then holds the module. */
#ifndef PBF_COMMON_MODULE_H
#define PBF_COMMON_MODULE_H

/* Until it is released by what is returned, which may be null, the module stays loaded. */
void *pbf_module_hold(void);
void pbf_module_release(void *held);

#endif
