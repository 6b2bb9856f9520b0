/* What may end the process that runs it, in one of its own. */
#ifndef PBF_BAKE_APART_H
#define PBF_BAKE_APART_H

#include <functional>
#include <string>

namespace bake {

// The bytes that `work` returns. Throws std::runtime_error with what it throws; where it crashes, or
// takes more than so many seconds of a processor, with what has become of it.
std::string run_apart(const std::function<std::string()> &work, unsigned seconds);

}  // namespace bake

#endif
