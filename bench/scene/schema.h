/* The scene format is what bench/scenes/scene.schema.json says, which is built into the program. */
#ifndef PBF_BENCH_SCHEMA_H
#define PBF_BENCH_SCHEMA_H

#include "scene/document.h"

namespace bench {

// Throws the error of the innermost value that the schema refuses.
void check_against_schema(const Document &document);

}  // namespace bench

#endif
