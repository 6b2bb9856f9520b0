rockspec_format = "3.0"
package = "pbf"
version = "scm-1"
source = { url = "." }
description = {
  summary = "Position based fluids for LuaJIT, by its FFI",
  license = "MIT",
}
dependencies = { "lua == 5.1" }
build = {
  type = "builtin",
  modules = {
    pbf = "pbf.lua", ["pbf.cdef"] = "pbf/cdef.lua", ["pbf.core"] = "pbf/core.lua", ["pbf.shapes"] = "pbf/shapes.lua",
    ["pbf.queries"] = "pbf/queries.lua", ["pbf.emission"] = "pbf/emission.lua", ["pbf.phases"] = "pbf/phases.lua",
    ["pbf.reading"] = "pbf/reading.lua", ["pbf.diffuse"] = "pbf/diffuse.lua", ["pbf.batch"] = "pbf/batch.lua",
  },
}
