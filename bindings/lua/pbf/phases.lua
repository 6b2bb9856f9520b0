-- Several fluids in one solver; methods of it.
local ffi = require("ffi")
local core = require("pbf.core")
local run = core.run

local Phases = {}

-- Replaces all phases, by a list of tables: rest_density = … and so on; with none all particles are alike again.
function Phases:set_phases(list)
  local array, count = core.structs_of("phases", "pbf_phase", "pbf_phase_init", nil, list)
  run(self, "pbf_set_phases", count, array)
end

-- A list of tables, as set_phases takes it.
function Phases:phases()
  local list = {}
  for index = 0, core.number_of(self, "uint32_t", "pbf_get_phase_count") - 1 do
    local phase = core.new("pbf_phase")
    run(self, "pbf_get_phase", index, phase)
    list[#list + 1] = core.fields_of("pbf_phase", phase)
  end
  return list
end

-- Which phase particles are of, the first one 0, from row `first` on.
function Phases:set_particle_phases(phases, first, count)
  local array, rows = core.rows_of("phases", "uint32_t", 1, phases, count)
  run(self, "pbf_set_particle_phases", core.unsigned("first", first or 0), rows, array)
  core.alive(phases)
end

-- An array of C, and how many particles are in it.
function Phases:particle_phases()
  local count = self:count()
  local phases = ffi.new("uint32_t[?]", count)
  run(self, "pbf_get_particle_phases", 0, count, phases)
  return phases, count
end

return Phases
