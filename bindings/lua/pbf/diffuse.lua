-- Spray, foam and bubbles, for looks; methods of a solver.
local ffi = require("ffi")
local core = require("pbf.core")
local new, invalid, run, rows_of = core.new, core.invalid, core.run, core.rows_of

local Diffuse = {}

local function default_of(self)
  local desc = new("pbf_diffuse_desc")
  run(self, "pbf_diffuse_init", desc, ffi.sizeof(desc))
  return desc
end

-- What suits the solver's dimension, smoothing_radius, spacing and gravity: a table.
function Diffuse:default_diffuse() return core.fields_of("pbf_diffuse_desc", default_of(self)) end

-- Has steps make and move them from now on: a table of what differs from default_diffuse, { capacity = 30000 } say. nil ends them.
function Diffuse:set_diffuse(fields)
  if fields == nil then return run(self, "pbf_set_diffuse", nil) end
  run(self, "pbf_set_diffuse", core.assign("diffuse", default_of(self), fields))
end

-- What they are made by, a table as set_diffuse takes it; nil where there are none.
function Diffuse:diffuse()
  if self:diffuse_info().capacity == 0 then return nil end
  local desc = new("pbf_diffuse_desc")
  run(self, "pbf_get_diffuse", desc)
  return core.fields_of("pbf_diffuse_desc", desc)
end

-- How many there are, by kind, and what became of others: a pbf_diffuse_info.
function Diffuse:diffuse_info()
  local info = new("pbf_diffuse_info")
  run(self, "pbf_get_diffuse_info", info)
  return info
end

-- All of them, the oldest first: a table of arrays of C, positions, velocities, ages, lives (times that are left to them), kinds
-- (pbf.DIFFUSE_SPRAY and so on) and ids; and how many they are.
function Diffuse:diffuse_particles()
  local count = self:diffuse_info().count
  local read, room = new("pbf_diffuse_read"), math.max(count, 1)
  local arrays = { kinds = ffi.new("uint32_t[?]", room), ids = ffi.new("uint64_t[?]", room) }
  for _, name in ipairs { "positions", "velocities" } do arrays[name] = ffi.new(self.element .. "[?]", room * self.dimension) end
  for _, name in ipairs { "ages", "lives" } do arrays[name] = ffi.new(self.element .. "[?]", room) end
  read.count = count
  for name, array in pairs(arrays) do read[name] = array end
  run(self, "pbf_read_diffuse", read)
  core.alive(arrays)
  return arrays, count
end

-- Adds your own, as many as `lives` has numbers, the times that they have; without velocities they are at rest.
function Diffuse:add_diffuse(positions, velocities, lives, count)
  local x, rows = rows_of("positions", self.element, self.dimension, positions, count)
  local times, others = rows_of("lives", self.element, 1, lives, count)
  if others ~= rows then invalid("lives has %d numbers, positions %d rows", others, rows) end
  local v
  if velocities then
    v, others = rows_of("velocities", self.element, self.dimension, velocities, count)
    if others ~= rows then invalid("velocities has %d rows, positions %d", others, rows) end
  end
  run(self, "pbf_add_diffuse", rows, x, v, times)
  core.alive(positions, velocities, lives)
end

-- Moves all of them, as where the world's origin is moved.
function Diffuse:shift_diffuse(way)
  local at, rows = rows_of("way", "double", self.dimension, way)
  if rows ~= 1 then invalid("way has %d numbers; it must have %d", rows * self.dimension, self.dimension) end
  run(self, "pbf_shift_diffuse", at)
end

return Diffuse
