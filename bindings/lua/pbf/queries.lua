-- Questions by place; methods of a solver. Points are a table of numbers, or of tables of them, or an array of double
-- with its number of rows.
local ffi = require("ffi")
local core = require("pbf.core")
local C, new, need, invalid, run, rows_of = core.C, core.new, core.need, core.invalid, core.run, core.rows_of

local Queries = {}

local kinds, name_of = core.named { "box", "sphere", "capsule" }

local volumes = {}

-- An array of pbf_volume from a list of tables: shape = "box", position = {…}, half_extents = {…} and so on.
function volumes.of(what, list) return core.structs_of(what, "pbf_volume", "pbf_volume_init", kinds, list) end

function volumes.from(volume)
  local fields = core.fields_of("pbf_volume", volume)
  fields.shape = name_of(volume.shape)
  return fields
end

-- An array of the ids of the particles there, ascending, and how many.
function Queries:find_in(volume)
  local room, count = self:count(), ffi.new("uint32_t[1]")
  local ids = ffi.new("uint32_t[?]", room)
  run(self, "pbf_find_in_volume", volumes.of("volumes", { volume }), room, ids, count)
  return ids, count[0]
end

-- How much of each volume of a list is below the surface, and how that flows: an array of pbf_volume_flow, and how many.
function Queries:measure(list)
  local array, count = volumes.of("volumes", list)
  local flows = ffi.new("pbf_volume_flow[?]", math.max(count, 1))
  for i = 0, count - 1 do flows[i].struct_size = ffi.sizeof("pbf_volume_flow") end
  run(self, "pbf_measure_volumes", count, array, flows)
  return flows, count
end

local function samples_of(self, count, fields)
  local samples, arrays = new("pbf_samples"), {}
  samples.count = core.unsigned("the number of points", count)
  for _, field in ipairs(need("table", "fields", fields or { "densities", "velocities" }, "a list of names")) do
    if field ~= "densities" and field ~= "velocities" and field ~= "pressures" and field ~= "wet" then
      invalid("there is no field %s; known are: densities, velocities, pressures, wet", tostring(field))
    end
    local numbers = field == "velocities" and count * self.dimension or count
    arrays[field] = ffi.new(field == "wet" and "uint8_t[?]" or "double[?]", numbers)
    samples[field] = arrays[field]
  end
  return samples, arrays
end

-- A table of arrays of C, of the fields "densities" (over that at rest), "velocities", "pressures" and "wet" (1 or 0), and
-- the number of points.
function Queries:sample(points, fields, count)
  local x, rows = rows_of("points", "double", self.dimension, points, count)
  local samples, arrays = samples_of(self, rows, fields)
  samples.points = x
  run(self, "pbf_sample", samples)
  core.alive(x, points)
  return arrays, rows
end

-- The same at the points origin + (i, j, k) step of { counts = {…}, origin = {…}, step = {…} }; the last index is the fastest.
function Queries:sample_on_grid(grid, fields)
  local place, count = core.assign("grid", new("pbf_sample_grid"), need("table", "grid", grid, "a table")), 1
  for axis = 0, self.dimension - 1 do count = count * place.counts[axis] end
  local samples, arrays = samples_of(self, count, fields)
  run(self, "pbf_sample_on_grid", place, samples)
  return arrays, count
end

-- Arrays of the distances at which rays meet the surface, math.huge where they do not within `length`, and of its normals there,
-- and the number of rays.
function Queries:cast_rays(origins, directions, length, count)
  local x, rows = rows_of("origins", "double", self.dimension, origins, count)
  local towards, others = rows_of("directions", "double", self.dimension, directions, count)
  if rows ~= others then invalid("directions has %d rows, origins %d", others, rows) end
  local distances, normals = ffi.new("double[?]", rows), ffi.new("double[?]", rows * self.dimension)
  run(self, "pbf_cast_rays", rows, x, towards, need("number", "length", length or math.huge, "a number"), distances, normals)
  core.alive(origins, directions)
  return distances, normals, rows
end

-- An array of how high the water stands at points, against gravity, NaN where there is none, and their number.
function Queries:levels(points, count)
  local x, rows = rows_of("points", "double", self.dimension, points, count)
  local levels = ffi.new("double[?]", rows)
  run(self, "pbf_get_levels", rows, x, levels)
  core.alive(points)
  return levels, rows
end

-- Gives back the memory that queries keep.
function Queries:end_queries() run(self, "pbf_end_queries") end

return { methods = Queries, volumes = volumes }
