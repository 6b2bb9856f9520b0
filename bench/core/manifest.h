/* dump.json: what pbf-check must know of a run besides positions and velocities. */
#ifndef PBF_BENCH_MANIFEST_H
#define PBF_BENCH_MANIFEST_H

#include <pbf/pbf.h>

#include <nlohmann/json.hpp>
#include <string>

#include "scene/scene.h"

namespace bench {

nlohmann::json manifest_of(const Scene &scene, const pbf_info &info);
void write_manifest(const std::string &path, const Scene &scene, const pbf_info &info);

}  // namespace bench

#endif
