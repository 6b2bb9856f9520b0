-- What renderers take; methods of a solver.
local ffi = require("ffi")
local core = require("pbf.core")
local C, new, need, run, invalid = core.C, core.new, core.need, core.run, core.invalid

local Reading = {}

local fields = { position = C.PBF_FIELD_POSITION, velocity = C.PBF_FIELD_VELOCITY, density = C.PBF_FIELD_DENSITY,
                 pressure = C.PBF_FIELD_PRESSURE, id = C.PBF_FIELD_ID }

-- How many rows there are from options.first on, unless options.count says it.
local function count_of(self, options)
  local first = core.unsigned("first", options.first or 0)
  return options.count and core.unsigned("count", options.count) or math.max(0, self:count() - first)
end

-- A field ("position", "velocity", "density", "pressure" or "id") in an array of its own, and the number of rows. options:
-- first, count; components; element, "float" or "double"; w, pbf.W_SPEED and so on, or w_value, the fourth of four numbers;
-- order; behind, how far back between the last two steps (keep_previous).
function Reading:read(field, options)
  options = need("table", "options", options or {}, "a table")
  if not fields[field] then invalid("the field is %s; known are: position, velocity, density, pressure, id", tostring(field)) end
  local types = { float = C.PBF_TYPE_FLOAT32, double = C.PBF_TYPE_FLOAT64, uint32_t = C.PBF_TYPE_UINT32 }
  local read, set = new("pbf_read_desc"), {}
  for name, value in pairs(options) do
    if name ~= "element" then set[name] = value end
    if name == "stride" or name == "data" or name == "element_type" or name == "field" then invalid("there is no option %s", name) end
  end
  core.assign("options", read, set)
  local element = options.element or (field == "id" and "uint32_t" or self.element)
  if not types[element] then invalid("element is %s; known are: float, double", tostring(element)) end
  local width = (field == "position" or field == "velocity") and self.dimension or 1
  if read.components > 4 then invalid("options.components is %d; it must be at most 4", read.components) end
  local count = count_of(self, options)
  local array = ffi.new(element .. "[?]", math.max(1, count * math.max(width, read.components)))
  read.field, read.count, read.element_type, read.data = fields[field], count, types[element], array
  run(self, "pbf_read", read)
  return array, count
end

-- Keeps the positions from before the last step, for read's behind.
function Reading:keep_previous(enabled) run(self, "pbf_keep_previous", enabled and 1 or 0) end

-- Arrays of smoothed positions and of matrices, dimension squared numbers each, and how many they are. options: first, count,
-- min_neighbors, radius, smoothing, max_ratio, lone_scale.
function Reading:anisotropies(options)
  options = need("table", "options", options or {}, "a table")
  if options.positions ~= nil or options.stretches ~= nil then invalid("positions and stretches are given back") end
  local wanted, count = core.assign("options", new("pbf_anisotropy_desc"), options), count_of(self, options)
  local positions = ffi.new(self.element .. "[?]", math.max(1, count * self.dimension))
  local stretches = ffi.new(self.element .. "[?]", math.max(1, count * self.dimension ^ 2))
  wanted.count, wanted.positions, wanted.stretches = count, positions, stretches
  run(self, "pbf_get_anisotropies", wanted)
  return positions, stretches, count
end

return Reading
