/* Where scene files lie. */
#ifndef PBF_BENCH_FIND_H
#define PBF_BENCH_FIND_H

#include <string>

namespace bench {

// `name` is a file's path (it has a '/' or ends in ".json") or the name of a scene that comes with
// the program. Throws Error with near names.
std::string find_scene_file(const std::string &name);

}  // namespace bench

#endif
