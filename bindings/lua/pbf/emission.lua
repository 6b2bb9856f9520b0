-- What comes and goes in each step; methods of a solver.
local core = require("pbf.core")
local volumes = require("pbf.queries").volumes
local new, run = core.new, core.run

local Emission = {}

local kinds, name_of = core.named { "rectangle", "disc" }

-- Replaces all emitters, by a list of tables: shape = "disc", position = {…}, velocity = {…}, radius = … and so on.
function Emission:set_emitters(list)
  local array, count = core.structs_of("emitters", "pbf_emitter", "pbf_emitter_init", kinds, list)
  run(self, "pbf_set_emitters", count, array)
end

-- A list of tables, as set_emitters takes it.
function Emission:emitters()
  local list = {}
  for index = 0, self:in_out().emitters - 1 do
    local emitter = new("pbf_emitter")
    run(self, "pbf_get_emitter", index, emitter)
    list[#list + 1] = core.fields_of("pbf_emitter", emitter)
    list[#list].shape = name_of(emitter.shape)
  end
  return list
end

-- What is in one of these volumes when a step begins is removed: shape = "box", position = {…}, half_extents = {…} and so on.
function Emission:set_drains(list)
  local array, count = volumes.of("drains", list)
  run(self, "pbf_set_drains", count, array)
end

function Emission:drains()
  local list = {}
  for index = 0, self:in_out().drains - 1 do
    local drain = new("pbf_volume")
    run(self, "pbf_get_drain", index, drain)
    list[#list + 1] = volumes.from(drain)
  end
  return list
end

-- Open boundaries of given level or pressure: position = {…}, half_extents = {…}, depth = … and so on. What came and went, which
-- reservoirs() tells, is not looked at.
function Emission:set_reservoirs(list)
  local array, count = core.structs_of("reservoirs", "pbf_reservoir", "pbf_reservoir_init", nil, list)
  run(self, "pbf_set_reservoirs", count, array)
end

function Emission:reservoirs()
  local list = {}
  for index = 0, core.number_of(self, "uint32_t", "pbf_get_reservoir_count") - 1 do
    local reservoir = new("pbf_reservoir")
    run(self, "pbf_get_reservoir", index, reservoir)
    list[#list + 1] = core.fields_of("pbf_reservoir", reservoir)
  end
  return list
end

-- What came and went, in particles: a pbf_in_out.
function Emission:in_out()
  local in_out = new("pbf_in_out")
  run(self, "pbf_get_in_out", in_out)
  return in_out
end

return Emission
